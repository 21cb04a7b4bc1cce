//! A scene as a page.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, PreEscaped, html};
use sha2::{Digest, Sha256};

use crate::scene::Scene;
use crate::viewer::{VIEWER_CSS, VIEWER_JS};

const PAGE_CSS: &str = include_str!("page.css");
/// Shows the scene that stands in the page.
const START: &str =
    "hwaspViewer(document.getElementById(\"view\"), JSON.parse(document.getElementById(\"scene\").textContent));";

/// A scene as one HTML file that loads nothing.
pub fn page(scene: &Scene) -> String {
    let policy = format!(
        "default-src 'none'; style-src '{}' '{}'; script-src '{}' '{}'",
        source_hash(VIEWER_CSS),
        source_hash(PAGE_CSS),
        source_hash(VIEWER_JS),
        source_hash(START)
    );
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(policy);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta name="generator" content=(concat!("hwasp ", env!("CARGO_PKG_VERSION")));
                title { (scene.title()) " · hwasp" }
                style { (PreEscaped(VIEWER_CSS)) }
                style { (PreEscaped(PAGE_CSS)) }
            }
            body {
                header { h1 { (scene.title()) } }
                main id="view" { noscript { p { "This page draws with a script. Turn scripts on to see the episodes move." } } }
                script id="scene" type="application/json" { (PreEscaped(data(&scene.json()))) }
                script { (PreEscaped(VIEWER_JS)) }
                script { (PreEscaped(START)) }
            }
        }
    };
    page.into_string() + "\n"
}

/// JSON as it may stand in a script element of a page: nothing in it ends the element.
pub fn data(json: &str) -> String {
    json.replace('<', "\\u003c")
}

/// How a content security policy names a script or a style that stands in the page itself.
pub fn source_hash(text: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(text.as_bytes())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_is_said_is_text() {
        let evil = "</script></title><script>alert(1)</script>\"'&<!--";
        let html = page(&Scene::new(evil, &[]));
        // Data, viewer, start.
        assert_eq!((html.matches("<script").count(), html.matches("</script").count()), (3, 3), "{html}");
        assert!(!html.contains("<!--") && html.contains("&lt;script&gt;alert(1)&lt;/script&gt;"));
        let data = html.split("type=\"application/json\">").nth(1).unwrap().split("</script>").next().unwrap();
        assert_eq!(serde_json::from_str::<serde_json::Value>(data).unwrap()["title"], evil);
    }

    /// Every script and style of the page is named by its policy, which forbids all else, the network too.
    #[test]
    fn the_policy_names_what_is_there() {
        let html = page(&Scene::new("a hand", &[]));
        let policy = html.split("Content-Security-Policy\" content=\"").nth(1).unwrap().split('"').next().unwrap();
        assert!(policy.starts_with("default-src 'none'; "), "{policy}");
        for (open, close) in [("<style>", "</style>"), ("<script>", "</script>")] {
            for part in html.split(open).skip(1) {
                let hash = source_hash(part.split(close).next().unwrap());
                assert!(policy.contains(&hash), "{hash} is missing in {policy}");
            }
        }
        for address in ["http:", "https:", "//cdn", "@import", "url("] {
            assert!(!html.contains(address), "{address}");
        }
    }

    /// As `openssl dgst -sha256 -binary | base64` has it.
    #[test]
    fn hashes_are_those_of_the_policy() {
        assert_eq!(source_hash(""), "sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU=");
    }
}
