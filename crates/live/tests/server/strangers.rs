//! Requests of other sites, of other machines, and of nobody in particular.

use std::fs;
use std::io::Write;
use std::net::TcpStream;
use std::os::unix::fs::symlink;
use std::sync::OnceLock;
use std::time::Duration;

use hwasp_live::Server;
use proptest::prelude::*;

use crate::client::{PATIENCE, ask, connect, empty, get, send, serve, serve_at, trained};

#[test]
fn other_names_and_other_sites_are_refused() {
    let server = serve_at("127.0.0.1:0", &[], &["box.lan"]);
    let port = server.address().port();
    let status = |headers: &[(&str, &str)], path| ask(&server, "GET", path, headers).status;
    let own = format!("127.0.0.1:{port}");
    let origin = format!("http://{own}");
    assert_eq!(status(&[("Host", &own), ("Origin", &origin), ("Sec-Fetch-Site", "same-origin")], "/api/runs"), 200);
    assert_eq!(status(&[("Host", "box.lan")], "/api/runs"), 200);
    for path in ["/", "/app.js", "/api/runs", "/nothing"] {
        assert_eq!(status(&[("Host", "evil.example")], path), 421, "{path}");
        assert_eq!(status(&[("Host", &own), ("Origin", "http://evil.example")], path), 403, "{path}");
        assert_eq!(status(&[("Sec-Fetch-Site", "cross-site")], path), 403, "{path}");
    }
    let none = send(server.address(), b"GET /api/runs HTTP/1.0\r\n\r\n", PATIENCE).unwrap();
    assert_eq!(none.status, 421);
}

#[test]
fn a_server_for_other_machines_wants_its_token() {
    let folder = empty("token");
    let params = trained(&folder.join("run"));
    let server = serve_at("0.0.0.0:0", &[folder], &[]);
    let token = server.token().unwrap().to_owned();
    assert_eq!(server.url(), format!("http://localhost:{}/#token={token}", server.address().port()));
    let status = |headers: &[(&str, &str)], path| ask(&server, "GET", path, headers).status;
    assert_eq!(status(&[("Host", "192.168.7.7:1")], "/"), 200);
    let right = format!("Bearer {token}");
    assert_eq!(status(&[("Authorization", &right)], "/api/runs/0"), 200);
    for path in ["/api/runs", "/api/runs/0", "/api/runs/0/episode", "/api/runs/0/what-if?x=1", "/nothing"] {
        assert_eq!(status(&[], path), 401, "{path}");
        assert_eq!(status(&[("Authorization", &right[..right.len() - 1])], path), 401, "{path}");
        assert_eq!(status(&[("Host", "evil.example"), ("Authorization", &right)], path), 421, "{path}");
    }
    assert_eq!(status(&[], &format!("/api/runs?token={token}")), 401);
    assert!(!params.is_empty());
}

/// A run folder may come from somebody else: links in it lead nowhere.
#[test]
fn links_do_not_lead_out_of_a_run_folder() {
    let folder = empty("links");
    let secret = folder.join("secret");
    fs::write(&secret, "iteration,the secret\nthe secret\n").unwrap();
    let run = folder.join("run");
    trained(&run);
    for file in ["train.log", "metrics.csv", "provenance.json", "summary.json"] {
        let _ = fs::remove_file(run.join(file));
        symlink(&secret, run.join(file)).unwrap();
    }
    let server = serve(std::slice::from_ref(&folder));
    for path in ["/api/runs", "/api/runs/0", "/api/runs/0/episode"] {
        let answer = get(&server, path);
        assert!(!answer.text().contains("secret\\n") && !answer.text().contains("the secret"), "{}", answer.text());
    }
    assert_eq!(get(&server, "/api/runs/0").json()["log"].as_array().unwrap().len(), 0);
    // A folder that is one leads to no run, either.
    symlink(&run, folder.join("run-2")).unwrap();
    assert_eq!(get(&server, "/api/runs").json()["runs"].as_array().unwrap().len(), 1);
}

/// Clients that open connections and say nothing lose their places after five seconds.
#[test]
fn silent_clients_do_not_shut_others_out() {
    let server = serve(&[]);
    let _silent: Vec<TcpStream> = (0..100)
        .map(|i| {
            let mut stream = connect(server.address());
            if i % 2 == 0 {
                stream.write_all(b"GET / HTTP/1.1\r\nHost: local").unwrap();
            }
            stream
        })
        .collect();
    assert_eq!(get(&server, "/api/runs").status, 200);
}

/// What no request may ever bring back.
const SECRET: &str = "7f1c-this-stands-beside-the-run";

fn server_of_strangers() -> &'static Server {
    static SERVER: OnceLock<Server> = OnceLock::new();
    SERVER.get_or_init(|| {
        let folder = empty("fuzzed");
        fs::write(folder.join("secret.txt"), SECRET).unwrap();
        trained(&folder.join("run"));
        fs::write(folder.join("run").join("notes.txt"), SECRET).unwrap();
        serve(&[folder.join("run")])
    })
}

/// Pieces of which requests are made, with bytes at random between them.
fn piece() -> impl Strategy<Value = Vec<u8>> {
    let known: &'static [&str] = &[
        "GET ",
        "POST ",
        "HEAD ",
        "/",
        "/api/runs",
        "/api/runs/0",
        "/episode",
        "/what-if?",
        "/cost/last?",
        "..",
        "%2e%2e%2f",
        "secret.txt",
        "notes.txt",
        "since=",
        ".",
        "point=0.1",
        "&",
        "=",
        "NaN",
        "1e309",
        " HTTP/1.1\r\n",
        " HTTP/1.0\r\n",
        "Host: localhost\r\n",
        "Host: \r\n",
        "\r\n",
        "\r\n\r\n",
        "Content-Length: 5\r\n",
        "Transfer-Encoding: chunked\r\n",
        "Connection: keep-alive\r\n",
        "Connection: Upgrade\r\nUpgrade: h2c\r\n",
        "Expect: 100-continue\r\n",
        "If-None-Match: \"x\"\r\n",
        "Origin: null\r\n",
        "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
        "\u{0}",
        "ä",
    ];
    prop_oneof![
        8 => prop::sample::select(known).prop_map(|text| text.as_bytes().to_vec()),
        1 => prop::collection::vec(any::<u8>(), 0..40),
        1 => (prop::sample::select(&b"A/%\r\n:"[..]), 0..40_000_usize).prop_map(|(byte, times)| vec![byte; times]),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn whatever_is_sent_it_answers_or_closes(pieces in prop::collection::vec(piece(), 0..24), sound in any::<bool>()) {
        let server = server_of_strangers();
        let mut bytes = if sound { b"GET /api/runs/0".to_vec() } else { Vec::new() };
        bytes.extend(pieces.concat());
        if sound {
            bytes.extend(b" HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
        }
        let answer = send(server.address(), &bytes, Duration::from_millis(40));
        if let Some(answer) = answer {
            prop_assert!(!String::from_utf8_lossy(&answer.body).contains(SECRET));
            prop_assert!((100..600).contains(&answer.status));
        }
        prop_assert_eq!(get(server, "/api/runs").status, 200);
    }
}
