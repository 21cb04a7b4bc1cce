//! Who may come in.
//!
//! A page of some other site that is open in the same browser can send requests here, and by a name of its own that leads to
//! this machine (DNS rebinding) it could even read the answers. So the name that was asked for has to be one of this server,
//! and requests that a browser makes for another site are refused. Where the server can be reached from other machines, data
//! need a token besides.

use std::fmt::Write;
use std::net::{IpAddr, SocketAddr};

use hyper::header::{AUTHORIZATION, HOST, HeaderMap, HeaderName, ORIGIN};

/// Random bytes of a token.
const TOKEN_BYTES: usize = 24;

/// The door of a server.
#[derive(Debug)]
pub(crate) struct Door {
    loopback: bool,
    /// Names besides those of this machine for itself, in lower case.
    names: Vec<String>,
    pub(crate) token: Option<String>,
}

/// Why somebody stays outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Refusal {
    /// The server is not called so.
    Host,
    /// It was another site that asked.
    Site,
    /// The token is missing or wrong.
    Token,
}

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// A file of the page, which has nothing of any run.
    Page,
    Data,
}

impl Door {
    /// Of a server at this address, which `names` lead to.
    pub(crate) fn new(address: SocketAddr, names: &[String]) -> Result<Self, getrandom::Error> {
        let loopback = address.ip().is_loopback();
        let token = if loopback { None } else { Some(token()?) };
        Ok(Self { loopback, names: names.iter().map(|name| name.to_lowercase()).collect(), token })
    }

    pub(crate) fn check(&self, headers: &HeaderMap, wanted: Wanted) -> Result<(), Refusal> {
        let host = only(headers, HOST).filter(|host| self.knows(host)).ok_or(Refusal::Host)?;
        if headers.contains_key(ORIGIN) {
            let same = |origin: &str| origin.strip_prefix("http://") == Some(host);
            only(headers, ORIGIN).filter(|origin| same(origin)).ok_or(Refusal::Site)?;
        }
        let told = |name: &'static str| headers.get(name).map(|value| value.to_str().unwrap_or("?"));
        let own = matches!(told("sec-fetch-site"), None | Some("same-origin" | "none"));
        // Whoever follows a link from elsewhere may see the page.
        let visit = wanted == Wanted::Page
            && told("sec-fetch-mode") == Some("navigate")
            && told("sec-fetch-dest") == Some("document");
        if !own && !visit {
            return Err(Refusal::Site);
        }
        match &self.token {
            Some(token) if wanted == Wanted::Data => {
                let given = only(headers, AUTHORIZATION).and_then(|value| value.strip_prefix("Bearer "));
                given.filter(|given| alike(given.as_bytes(), token.as_bytes())).map(|_| ()).ok_or(Refusal::Token)
            }
            _ => Ok(()),
        }
    }

    /// Whether this server is called so. Ports do not matter: that of a tunnel is another one, and names are what rebinding needs.
    fn knows(&self, host: &str) -> bool {
        let name = match host.rsplit_once(':') {
            Some((name, port)) if !port.contains(']') => {
                if port.parse::<u16>().is_err() {
                    return false;
                }
                name
            }
            _ => host,
        };
        let name = name.to_lowercase();
        let address = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(&name);
        match address.parse::<IpAddr>() {
            Ok(address) => address.is_loopback() || !self.loopback,
            Err(_) => name == "localhost" || self.names.contains(&name),
        }
    }
}

/// The value of a header that comes once.
fn only(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    let mut values = headers.get_all(name).iter();
    let value = values.next()?;
    if values.next().is_some() { None } else { value.to_str().ok() }
}

/// Whether two texts are the same, in a time that depends on their lengths alone.
fn alike(a: &[u8], b: &[u8]) -> bool {
    let differ = a.iter().zip(b).fold(0, |differ, (a, b)| std::hint::black_box(differ | (a ^ b)));
    a.len() == b.len() && differ == 0
}

fn token() -> Result<String, getrandom::Error> {
    let mut bytes = [0; TOKEN_BYTES];
    getrandom::fill(&mut bytes)?;
    Ok(bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn door(address: &str, names: &[&str]) -> Door {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        Door::new(address.parse().unwrap(), &names).unwrap()
    }

    fn headers(pairs: &[(&'static str, &str)]) -> HeaderMap {
        let mut headers = HeaderMap::new();
        for (name, value) in pairs {
            headers.append(*name, value.parse().unwrap());
        }
        headers
    }

    #[test]
    fn on_loopback_only_its_own_names_lead_in() {
        let door = door("127.0.0.1:8437", &["box.lan"]);
        for host in ["127.0.0.1:8437", "localhost", "LOCALHOST:9000", "[::1]:8437", "[::1]", "127.0.0.2", "box.lan:1"] {
            assert_eq!(door.check(&headers(&[("host", host)]), Wanted::Data), Ok(()), "{host}");
        }
        for host in [
            "evil.example",
            "localhost.evil.example",
            "127.0.0.1.evil.example:8437",
            "10.0.0.5",
            "",
            "localhost:x",
            "localhost.",
            "[::1",
        ] {
            assert_eq!(door.check(&headers(&[("host", host)]), Wanted::Page), Err(Refusal::Host), "{host}");
        }
        assert_eq!(door.check(&headers(&[]), Wanted::Page), Err(Refusal::Host));
        let two = headers(&[("host", "localhost"), ("host", "localhost")]);
        assert_eq!(door.check(&two, Wanted::Page), Err(Refusal::Host));
    }

    #[test]
    fn other_sites_stay_outside() {
        let door = door("127.0.0.1:8437", &[]);
        let ask = |pairs: &[(&'static str, &str)], wanted| {
            door.check(&headers(&[&[("host", "localhost:8437")], pairs].concat()), wanted)
        };
        assert_eq!(
            ask(&[("origin", "http://localhost:8437"), ("sec-fetch-site", "same-origin")], Wanted::Data),
            Ok(())
        );
        for origin in ["http://evil.example", "null", "http://localhost:9999", "https://localhost:8437"] {
            assert_eq!(ask(&[("origin", origin)], Wanted::Data), Err(Refusal::Site), "{origin}");
        }
        for site in ["cross-site", "same-site", "?"] {
            assert_eq!(ask(&[("sec-fetch-site", site)], Wanted::Data), Err(Refusal::Site), "{site}");
        }
        let link = [("sec-fetch-site", "cross-site"), ("sec-fetch-mode", "navigate"), ("sec-fetch-dest", "document")];
        assert_eq!((ask(&link, Wanted::Page), ask(&link, Wanted::Data)), (Ok(()), Err(Refusal::Site)));
        let frame = [("sec-fetch-site", "cross-site"), ("sec-fetch-mode", "navigate"), ("sec-fetch-dest", "iframe")];
        assert_eq!(ask(&frame, Wanted::Page), Err(Refusal::Site));
    }

    #[test]
    fn elsewhere_than_on_loopback_data_need_a_token() {
        let door = door("0.0.0.0:8437", &["box.lan"]);
        let token = door.token.clone().unwrap();
        assert_eq!(token.len(), 48);
        let ask = |value: Option<&str>, host: &str, wanted| {
            let mut pairs = vec![("host", host)];
            pairs.extend(value.map(|value| ("authorization", value)));
            door.check(&headers(&pairs), wanted)
        };
        let right = format!("Bearer {token}");
        assert_eq!(ask(Some(&right), "10.0.0.5:8437", Wanted::Data), Ok(()));
        assert_eq!(ask(None, "box.lan:8437", Wanted::Page), Ok(()));
        for wrong in [None, Some("Bearer "), Some(&right[..54]), Some(&token), Some(&right.replace('B', "b"))] {
            assert_eq!(ask(wrong, "box.lan", Wanted::Data), Err(Refusal::Token), "{wrong:?}");
        }
        assert_eq!(ask(Some(&format!("{right}0")), "box.lan", Wanted::Data), Err(Refusal::Token));
        assert_eq!(ask(Some(&right), "evil.example", Wanted::Data), Err(Refusal::Host));
        assert_ne!(Some(token), self::door("0.0.0.0:8437", &[]).token);
    }
}
