//! The page that follows trainings, served by real processes.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};

use crate::sandbox::{Sandbox, TINY};

/// The program, and the address of its page, which is the last word of a line.
fn serve(sandbox: &Sandbox, line: &str) -> (Child, String) {
    let mut child = sandbox.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let (out, err) = (child.stdout.take().unwrap(), child.stderr.take().unwrap());
    let lines: Box<dyn Read + Send> = if line.starts_with("watch") { Box::new(out) } else { Box::new(err) };
    let mut lines = BufReader::new(lines).lines().map(Result::unwrap);
    let told = lines.find(|line| line.contains("http://")).unwrap();
    // What it goes on to say is read, so that it does not wait.
    std::thread::spawn(move || lines.for_each(drop));
    let url = told.split_whitespace().last().unwrap().to_owned();
    (child, url)
}

/// What is at a path of the page.
fn get(url: &str, path: &str) -> String {
    let address = url.trim_start_matches("http://").trim_end_matches('/');
    let mut stream = TcpStream::connect(address).unwrap();
    write!(stream, "GET {path} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n").unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

fn interrupt(mut child: Child) -> Option<i32> {
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    child.wait().unwrap().code()
}

#[test]
fn runs_are_watched_until_ctrl_c() {
    let sandbox = Sandbox::with_run("watched");
    let (child, url) = serve(&sandbox, "watch run nowhere --port 0");
    assert!(get(&url, "/").contains("<title>hwasp watch</title>"));
    let list = get(&url, "/api/runs");
    assert!(list.contains("\"label\":\"run\"") && list.contains("\"waiting\":[\"nowhere\"]"), "{list}");
    let port = url.rsplit(':').next().unwrap().trim_end_matches('/');
    let second = sandbox.run(&format!("watch run --port {port}"));
    let told = String::from_utf8_lossy(&second.stderr);
    assert!(second.status.code() == Some(2) && told.contains("another program has this port"), "{told}");
    assert_eq!(interrupt(child), Some(0));
}

/// A port that is taken is told before the run folder is made.
#[test]
fn a_training_is_watched_and_stays_to_be_looked_at() {
    let sandbox = Sandbox::new("trained-and-watched");
    let (child, url) = serve(&sandbox, &format!("{TINY} --out run --watch=127.0.0.1:0"));
    let finished = || get(&url, "/api/runs").contains("\"state\":\"finished\"");
    let mut looks = 0;
    while !finished() {
        looks += 1;
        assert!(looks < 600, "{}", get(&url, "/api/runs"));
        std::thread::sleep(std::time::Duration::from_millis(100));
    }
    let address = url.trim_start_matches("http://").trim_end_matches('/');
    let second = sandbox.run(&format!("{TINY} --out other --watch={address}"));
    assert_eq!((second.status.code(), sandbox.path("other").exists()), (Some(2), false));
    assert_eq!(interrupt(child), Some(0));
}
