//! What is at which path.

use std::path::PathBuf;

use hwasp_live::{StartError, listen};

use crate::client::{ask, empty, get, serve, trained};

#[test]
fn the_page_and_what_it_is_made_of() {
    let server = serve(&[]);
    let page = get(&server, "/").text();
    // Whatever the page names is there.
    let mut named: Vec<&str> = page.split('"').filter(|word| word.starts_with('/')).collect();
    let modules = ["/words.js", "/chart.js", "/panels.js", "/robot.js", "/server.js"];
    named.extend(modules);
    assert_eq!(named.len(), 10, "{named:?}");
    let mut bytes = page.len();
    for path in named {
        let answer = get(&server, path);
        let kind = answer.header("content-type").unwrap();
        let wanted = [(".js", "text/javascript"), (".css", "text/css"), (".svg", "image/svg+xml")];
        let wanted = wanted.iter().find(|(end, _)| path.ends_with(end)).unwrap().1;
        assert!(answer.status == 200 && kind.starts_with(wanted), "{path}: {}", answer.head);
        bytes += answer.body.len();
    }
    assert!(bytes < 150_000, "{bytes}");
}

#[test]
fn every_answer_forbids_what_a_page_should_not_do() {
    let server = serve(&[]);
    for path in ["/", "/app.js", "/api/runs", "/nothing"] {
        let answer = get(&server, path);
        let policy = answer.header("content-security-policy").unwrap();
        for part in ["default-src 'none'", "script-src 'self'", "frame-ancestors 'none'", "form-action 'none'"] {
            assert!(policy.contains(part), "{path}: {policy}");
        }
        for (name, value) in [
            ("x-content-type-options", "nosniff"),
            ("cache-control", "no-store"),
            ("referrer-policy", "no-referrer"),
            ("cross-origin-resource-policy", "same-origin"),
        ] {
            assert_eq!(answer.header(name), Some(value), "{path}");
        }
        assert_eq!(answer.header("access-control-allow-origin"), None, "{path}");
    }
}

#[test]
fn only_get_is_answered() {
    let server = serve(&[]);
    for method in ["POST", "PUT", "DELETE", "HEAD", "OPTIONS", "PATCH", "TRACE", "BREW"] {
        for path in ["/", "/api/runs"] {
            let answer = ask(&server, method, path, &[("Content-Length", "0")]);
            assert_eq!((answer.status, answer.header("allow")), (405, Some("GET")), "{method} {path}");
        }
    }
}

#[test]
fn nothing_is_anywhere_else() {
    let folder = empty("elsewhere");
    trained(&folder.join("run"));
    let server = serve(&[folder.join("run")]);
    for path in [
        "/api",
        "/api/",
        "/api/runs/",
        "/api/runs/1",
        "/api/runs/0/",
        "/api/runs/0/log",
        "/api/runs/+0",
        "/api/runs/-1",
        "/api/runs/0x0",
        "/api/runs/00000000000000000000000000",
        "/api/runs/0/episode/",
        "/api/runs/0/cost",
        "/api/runs/0/cost/last/",
        "/API/runs",
        "/index.html",
        "//",
        "/app.js/",
        "/%2e%2e/app.js",
        "/../Cargo.toml",
        "/..%2f..%2fetc%2fpasswd",
        "/api/runs/0/../../../metrics.csv",
        "/api/runs/0/metrics.csv",
        "/api/runs/..%2f..%2f",
        "/api/runs/0%00",
        "/.git/config",
        "*",
        "/page/index.html",
        "/src/lib.rs",
    ] {
        let answer = get(&server, path);
        assert_eq!(answer.status, 404, "{path}: {}", answer.text());
        assert!(answer.json()["error"].is_string(), "{path}");
    }
    // Those of a proxy are not for this server.
    assert_eq!(get(&server, "http://localhost/api/runs").status, 400);
}

#[test]
fn what_is_too_long_is_refused() {
    let server = serve(&[]);
    assert_eq!(get(&server, &format!("/api/runs?since={}", "x".repeat(8000))).status, 200);
    assert_eq!(get(&server, &format!("/api/runs?since={}", "x".repeat(9000))).status, 414);
    assert_eq!(ask(&server, "GET", "/", &[("X", &"x".repeat(60_000))]).status, 431);
    assert_eq!(get(&server, "/").status, 200);
}

#[test]
fn a_port_that_is_taken_is_told() {
    let server = serve(&[]);
    let address = server.address();
    let error = listen(address, 0).unwrap_err();
    assert_eq!(error.to_string(), format!("{address} cannot be listened at: another program has this port"));
    assert!(matches!(error, StartError::Listen { .. }));
    assert_ne!(listen(address, 9).unwrap().local_addr().unwrap(), address);
    let none: &[PathBuf] = &[];
    let url = serve(none).url();
    assert!(url.starts_with("http://127.0.0.1:") && url.ends_with('/'), "{url}");
}
