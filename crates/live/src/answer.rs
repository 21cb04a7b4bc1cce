//! What is said to a browser.

use http_body_util::Full;
use hyper::body::Bytes;
use hyper::header::HeaderValue;
use hyper::{Response, StatusCode, header};
use serde::Serialize;

/// The page loads what this server has, and nothing else; nobody may put it into a frame.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data:; \
                      base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// An answer without its headers.
#[derive(Clone, Debug)]
pub(crate) struct Answer {
    pub(crate) status: StatusCode,
    kind: &'static str,
    body: Bytes,
    /// What tells it from what is answered later.
    tag: Option<String>,
}

/// What went wrong, as a page reads it.
#[derive(Serialize)]
struct Fault<'a> {
    error: &'a str,
}

impl Answer {
    /// A file of the page.
    pub(crate) fn file(kind: &'static str, text: &'static str) -> Self {
        Self { status: StatusCode::OK, kind, body: Bytes::from_static(text.as_bytes()), tag: None }
    }

    /// A value.
    pub(crate) fn json(value: &impl Serialize) -> Self {
        Self::text(StatusCode::OK, value)
    }

    /// Why there is none.
    pub(crate) fn fault(status: StatusCode, error: &str) -> Self {
        Self::text(status, &Fault { error })
    }

    fn text(status: StatusCode, value: &impl Serialize) -> Self {
        match serde_json::to_vec(value) {
            Ok(text) => Self { status, kind: "application/json", body: text.into(), tag: None },
            Err(error) => {
                let text = format!("{{\"error\":\"an answer cannot be written: {error:?}\"}}");
                Self {
                    status: StatusCode::INTERNAL_SERVER_ERROR,
                    kind: "application/json",
                    body: text.into(),
                    tag: None,
                }
            }
        }
    }

    /// The same with a tag.
    pub(crate) fn tagged(self, tag: String) -> Self {
        Self { tag: Some(tag), ..self }
    }

    /// Nothing is new.
    pub(crate) fn unchanged(tag: String) -> Self {
        let status = StatusCode::NOT_MODIFIED;
        Self { status, kind: "application/json", body: Bytes::new(), tag: Some(tag) }
    }

    /// Bytes of the body.
    pub(crate) fn len(&self) -> usize {
        self.body.len()
    }

    /// With its headers.
    pub(crate) fn response(self) -> Response<Full<Bytes>> {
        let mut response = Response::new(Full::new(self.body));
        *response.status_mut() = self.status;
        let headers = response.headers_mut();
        for (name, value) in [
            (header::CONTENT_TYPE, self.kind),
            (header::CONTENT_SECURITY_POLICY, POLICY),
            (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
            (header::REFERRER_POLICY, "no-referrer"),
            (header::CACHE_CONTROL, "no-store"),
        ] {
            headers.insert(name, HeaderValue::from_static(value));
        }
        for name in ["cross-origin-opener-policy", "cross-origin-resource-policy"] {
            headers.insert(name, HeaderValue::from_static("same-origin"));
        }
        if self.status == StatusCode::METHOD_NOT_ALLOWED {
            headers.insert(header::ALLOW, HeaderValue::from_static("GET"));
        }
        if self.status == StatusCode::SERVICE_UNAVAILABLE {
            headers.insert(header::RETRY_AFTER, HeaderValue::from_static("1"));
        }
        if let Some(tag) = self.tag.and_then(|tag| HeaderValue::try_from(tag).ok()) {
            headers.insert(header::ETAG, tag);
        }
        response
    }
}
