//! Runs, servers and requests for the tests.

use std::fs;
use std::io::{Read, Write};
use std::net::{Shutdown, SocketAddr, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use hwasp_core::Serial;
use hwasp_experiment::Experiment;
use hwasp_live::{Options, Server, listen};
use hwasp_runs::{Keeping, Provenance, RunFolder, no_extras};
use hwasp_training::{Assembly, Observer, train};
use serde_json::Value;

/// The longest time that a test waits for an answer.
pub(crate) const PATIENCE: Duration = Duration::from_secs(90);

/// A folder of a test's own, where nothing is.
pub(crate) fn empty(name: &str) -> PathBuf {
    let path = hwasp_testing::empty(env!("CARGO_TARGET_TMPDIR"), &format!("live-{name}"));
    fs::create_dir_all(&path).unwrap();
    path
}

/// A training of some hundredths of a second.
pub(crate) fn experiment() -> Experiment {
    hwasp_testing::small("hwasp", &[])
}

/// Begins a run folder.
pub(crate) fn begin(path: &Path, experiment: &Experiment, keeping: Keeping) -> RunFolder {
    RunFolder::create(path, experiment, &Provenance::new(vec!["hwasp".into()], 1, experiment.seed), keeping).unwrap()
}

/// Trains a run into a folder to its end; returns its parameters.
pub(crate) fn trained(path: &Path) -> Vec<f32> {
    trained_as(path, &experiment())
}

pub(crate) fn trained_as(path: &Path, experiment: &Experiment) -> Vec<f32> {
    let assembly = Assembly::new(experiment).unwrap();
    let mut folder = begin(path, experiment, Keeping::default());
    let observer: &mut dyn Observer = &mut folder;
    let trained = train(&assembly, &Serial, observer, &AtomicBool::new(false)).unwrap();
    folder.finish(&assembly, &trained, &no_extras).unwrap();
    trained.params
}

/// A server on loopback for these folders.
pub(crate) fn serve(runs: &[PathBuf]) -> Server {
    serve_at("127.0.0.1:0", runs, &[])
}

pub(crate) fn serve_at(address: &str, runs: &[PathBuf], names: &[&str]) -> Server {
    let names = names.iter().map(|name| (*name).to_owned()).collect();
    let options = Options { runs: runs.to_vec(), names };
    Server::start(listen(address.parse().unwrap(), 0).unwrap(), options, hwasp_testing::catalogue()).unwrap()
}

/// An answer.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) head: String,
    pub(crate) body: Vec<u8>,
}

impl Answer {
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap()
    }

    pub(crate) fn text(&self) -> String {
        String::from_utf8(self.body.clone()).unwrap()
    }

    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        let found =
            self.head.lines().find_map(|line| line.split_once(": ").filter(|(n, _)| n.eq_ignore_ascii_case(name)));
        found.map(|(_, value)| value)
    }
}

pub(crate) fn connect(address: SocketAddr) -> TcpStream {
    let address =
        if address.ip().is_unspecified() { SocketAddr::new([127, 0, 0, 1].into(), address.port()) } else { address };
    TcpStream::connect(address).unwrap()
}

/// Sends bytes, and reads until the server closes; none where it answers nothing. It may close before all is sent. One that says
/// nothing for a time of `patience` is told that nothing more will come.
pub(crate) fn send(address: SocketAddr, bytes: &[u8], patience: Duration) -> Option<Answer> {
    let mut stream = connect(address);
    let _ = stream.write_all(bytes);
    stream.set_read_timeout(Some(patience)).unwrap();
    let mut answer = Vec::new();
    if stream.read_to_end(&mut answer).is_err() {
        let _ = stream.shutdown(Shutdown::Write);
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let _ = stream.read_to_end(&mut answer);
    }
    let end = answer.windows(4).position(|four| four == b"\r\n\r\n")?;
    let head = String::from_utf8(answer[..end].to_vec()).unwrap();
    let status = head.split(' ').nth(1).unwrap().parse().unwrap();
    Some(Answer { status, head, body: answer[end + 4..].to_vec() })
}

/// Asks with these headers besides the usual ones.
pub(crate) fn ask(server: &Server, method: &str, target: &str, headers: &[(&str, &str)]) -> Answer {
    let usual = [("Connection", "close"), ("Host", "localhost")];
    let usual = usual.iter().filter(|(name, _)| headers.iter().all(|(given, _)| given != name));
    let lines: Vec<String> = usual.chain(headers).map(|(name, value)| format!("{name}: {value}\r\n")).collect();
    let request = format!("{method} {target} HTTP/1.1\r\n{}\r\n", lines.concat());
    send(server.address(), request.as_bytes(), PATIENCE).unwrap()
}

pub(crate) fn get(server: &Server, target: &str) -> Answer {
    ask(server, "GET", target, &[])
}

/// Asks until the answer is as wanted.
pub(crate) fn wait(server: &Server, target: &str, wanted: impl Fn(&Value) -> bool) -> Value {
    for _ in 0..200 {
        let value = get(server, target).json();
        if wanted(&value) {
            return value;
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    panic!("{target}: {}", get(server, target).text());
}
