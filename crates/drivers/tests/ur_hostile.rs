//! Controllers that send what no controller sends: each ends in an error that says what was wrong, never in a hang.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use hwasp_drivers::ur::wire::{Frame, Frames, kind};
use hwasp_drivers::ur::{Dashboard, UrArm, UrSettings};
use hwasp_drivers::{Arm, DriverError};

/// Bytes of a good packet: 8 + 3·48 + 3·4 + 4·4, with tool and payload 56 more.
const PACKET: usize = 8 + 144 + 12 + 16 + 56;

/// What a controller answers.
#[derive(Clone)]
struct Script {
    protocol: Vec<u8>,
    version: Vec<u8>,
    outputs: Vec<u8>,
    /// The answer when it is asked for less.
    fewer: Vec<u8>,
    inputs: Vec<u8>,
    start: Vec<u8>,
    /// After the first good packet; then it keeps the line open, or closes it.
    then: Vec<u8>,
    closes: bool,
}

fn kinds(number: u8, words: &str) -> Vec<u8> {
    [&[number][..], words.as_bytes()].concat()
}

impl Script {
    fn good() -> Self {
        let outputs = "DOUBLE,VECTOR6D,VECTOR6D,VECTOR6D,INT32,INT32,UINT32,INT32,INT32,INT32,INT32,VECTOR6D,DOUBLE";
        Self {
            protocol: vec![1],
            version: [3_u32, 15, 8, 1].iter().flat_map(|part| part.to_be_bytes()).collect(),
            outputs: kinds(1, outputs),
            fewer: Vec::new(),
            inputs: kinds(1, &["INT32,INT32,INT32", &",DOUBLE".repeat(7)].concat()),
            start: vec![1],
            then: Vec::new(),
            closes: false,
        }
    }
}

/// Serves one client, or one that comes again to ask for less.
fn serve(script: Script) -> (UrSettings, JoinHandle<()>) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let mut settings = UrSettings::new("127.0.0.1");
    settings.rtde_port = listener.local_addr().expect("an address").port();
    settings.answer = Duration::from_millis(1500);
    settings.oldest = Duration::from_millis(900);
    let server = std::thread::spawn(move || {
        for _ in 0..if script.fewer.is_empty() { 1 } else { 2 } {
            let (stream, _) = listener.accept().expect("a client");
            answer(stream, &script);
        }
    });
    (settings, server)
}

fn answer(mut stream: TcpStream, script: &Script) {
    let (mut frames, mut bytes) = (Frames::default(), [0; 2048]);
    loop {
        let frame = loop {
            if let Some(frame) = frames.take().expect("frames of ours") {
                break frame;
            }
            match stream.read(&mut bytes) {
                Ok(count) if count > 0 => frames.push(&bytes[..count]),
                _ => return,
            }
        };
        let answer = match frame.kind {
            kind::PROTOCOL => &script.protocol,
            kind::CONTROLLER => &script.version,
            kind::OUTPUTS if frame.body.ends_with(b"payload") => &script.outputs,
            kind::OUTPUTS => &script.fewer,
            kind::INPUTS => &script.inputs,
            kind::START => &script.start,
            _ => continue,
        };
        let _ = stream.write_all(&Frame::bytes(frame.kind, answer).expect("short"));
        if frame.kind == kind::START {
            let mut packet = vec![1];
            packet.resize(if script.fewer.is_empty() { 1 + PACKET } else { 1 + PACKET - 56 }, 0);
            let _ = stream.write_all(&Frame::bytes(kind::DATA, &packet).expect("short"));
            let _ = stream.write_all(&script.then);
            if script.closes {
                return;
            }
        }
    }
}

/// What comes of connecting and of the state that follows.
fn outcome(script: Script) -> DriverError {
    let (settings, server) = serve(script);
    let begin = Instant::now();
    let cause = match UrArm::connect(&settings) {
        Err(cause) => cause,
        Ok(mut arm) => loop {
            match arm.state() {
                Err(cause) => break cause,
                Ok(_) => std::thread::sleep(Duration::from_millis(5)),
            }
        },
    };
    assert!(begin.elapsed() < Duration::from_secs(30), "it does not hang: {cause}");
    server.join().expect("the server ends with its client");
    cause
}

fn says(script: Script, word: &str) {
    let cause = outcome(script);
    assert!(cause.to_string().contains(word), "{cause:?} does not say {word:?}");
}

#[test]
fn refusals_and_odd_answers_of_the_beginning() {
    let good = Script::good;
    says(Script { protocol: vec![0], ..good() }, "version 2 of the protocol is not known");
    says(Script { protocol: vec![], ..good() }, "protocol of RTDE: the body ends after 0 bytes; 1 are needed");
    says(Script { version: vec![0, 0, 0], ..good() }, "version of the controller: the body ends after 3 bytes");
    says(Script { outputs: kinds(0, "NOT_FOUND"), ..good() }, "names were sent, 1 types came back");
    says(Script { outputs: kinds(1, "DOUBLE"), ..good() }, "names were sent, 1 types came back");
    says(Script { outputs: vec![1, 0xff, 0xfe], ..good() }, "the body is no text");
    says(Script { outputs: vec![], ..good() }, "recipe of outputs: the body ends");
    let wrong = "DOUBLE,DOUBLE,VECTOR6D,VECTOR6D,INT32,INT32,UINT32,INT32,INT32,INT32,INT32";
    says(Script { outputs: kinds(1, wrong), ..good() }, "types came back");
    let mut used = good();
    used.inputs = kinds(0, &["IN_USE,INT32,INT32", &",DOUBLE".repeat(7)].concat());
    says(used, "input_int_register_36 is in use by another client or a field bus");
    let mut old = good();
    old.inputs = kinds(0, &["NOT_FOUND,INT32,INT32", &",DOUBLE".repeat(7)].concat());
    says(old, "input_int_register_36 is not known to the controller: update it");
    says(Script { start: vec![0], ..good() }, "the controller does not start to send");
}

#[test]
fn a_silent_controller_is_told_in_time() {
    // It stays silent from the first question on: this listener answers nothing.
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let mut settings = UrSettings::new("127.0.0.1");
    settings.rtde_port = listener.local_addr().expect("an address").port();
    settings.answer = Duration::from_millis(200);
    let cause = UrArm::connect(&settings).unwrap_err();
    assert!(matches!(cause, DriverError::Timeout { what: "protocol of RTDE", .. }), "{cause}");
}

#[test]
fn broken_packets_end_the_connection_with_their_reason() {
    let then = |bytes: Vec<u8>| Script { then: bytes, ..Script::good() };
    let data = |length: usize, number: u8| {
        let mut body = vec![number];
        body.resize(length, 0);
        Frame::bytes(kind::DATA, &body).expect("short")
    };
    says(then(vec![0, 0, b'U']), "a frame says that it is 0 bytes long");
    says(then(vec![0, 2, b'U']), "a frame says that it is 2 bytes long");
    says(then(data(1 + PACKET - 1, 1)), "the body ends after 7 bytes; 8 are needed");
    says(then(data(1 + PACKET + 5, 1)), "the body has 5 bytes too many");
    says(then(data(1, 1)), "the body ends after 0 bytes; 8 are needed");
    says(then(Frame::bytes(kind::DATA, &[]).expect("short")), "the body ends after 0 bytes; 1 are needed");
    says(then(data(1 + PACKET, 9)), "a packet of recipe 9; ours is 1");
    says(then(Frame::bytes(b'X', &[1, 2, 3]).expect("short")), "a frame of kind 88 came unasked");
    says(then(Frame::bytes(kind::OUTPUTS, &[1]).expect("short")), "a frame of kind 79 came unasked");
    says(then(vec![0xff; 70_000]), "a frame of kind 255 came unasked");
}

#[test]
fn a_packet_that_never_ends_or_a_line_that_closes_is_told() {
    let half = |closes| Script { then: vec![0xff, 0xff, b'U', 1, 2, 3], closes, ..Script::good() };
    assert!(matches!(outcome(half(false)), DriverError::Timeout { what: "state", .. }));
    assert!(matches!(outcome(half(true)), DriverError::Line { .. }));
}

#[test]
fn numbers_that_are_none_are_errors_of_their_packet() {
    let mut packet = vec![1];
    packet.resize(1 + PACKET, 0);
    packet[1..9].copy_from_slice(&f64::NAN.to_be_bytes());
    let then = Frame::bytes(kind::DATA, &packet).expect("short");
    says(Script { then, ..Script::good() }, "timestamp is NaN");
    packet[1..9].copy_from_slice(&f64::MIN.to_be_bytes());
    let then = Frame::bytes(kind::DATA, &packet).expect("short");
    assert!(
        matches!(outcome(Script { then, ..Script::good() }), DriverError::Timeout { .. }),
        "a clock that jumps is late"
    );
}

#[test]
fn words_to_a_person_are_passed_over() {
    let text = Frame::bytes(kind::TEXT, b"\x02hi\x04RTDE\x03").expect("short");
    let mut packet = vec![1];
    packet.resize(1 + PACKET, 0);
    let data = Frame::bytes(kind::DATA, &packet).expect("short");
    let (settings, server) = serve(Script { then: [text, data].concat(), ..Script::good() });
    let arm = UrArm::connect(&settings).expect("an arm");
    assert_eq!(arm.reading().expect("a packet").robot_mode, 0);
    drop(arm);
    server.join().expect("the server ends");
}

#[test]
fn an_older_controller_is_asked_for_less() {
    let fewer = "DOUBLE,VECTOR6D,VECTOR6D,VECTOR6D,INT32,INT32,UINT32,INT32,INT32,INT32,INT32";
    let outputs = kinds(0, &[fewer, ",NOT_FOUND,NOT_FOUND"].concat());
    let (settings, server) = serve(Script { outputs, fewer: kinds(1, fewer), ..Script::good() });
    let arm = UrArm::connect(&settings).expect("an arm");
    let reading = arm.reading().expect("a packet");
    assert_eq!((reading.tcp, reading.payload), (None, None));
    drop(arm);
    server.join().expect("the server ends");
    let wrong = kinds(1, &fewer.replacen("VECTOR6D", "DOUBLE", 1));
    let outputs = kinds(0, &[fewer, ",NOT_FOUND,NOT_FOUND"].concat());
    says(Script { outputs, fewer: wrong, ..Script::good() }, "actual_q has the type DOUBLE, not VECTOR6D");
}

/// A dashboard that says this, and then nothing.
fn dashboard(says: &'static [u8], closes: bool) -> DriverError {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let mut settings = UrSettings::new("127.0.0.1");
    settings.dashboard_port = listener.local_addr().expect("an address").port();
    settings.answer = Duration::from_millis(300);
    let server = std::thread::spawn(move || {
        let (mut stream, _): (TcpStream, _) = listener.accept().expect("a client");
        let _ = stream.write_all(says);
        if !closes {
            let _ = stream.read_to_end(&mut Vec::new());
        }
    });
    let mode = Dashboard::connect(&settings).and_then(|mut dashboard| dashboard.robot_mode());
    let cause = mode.expect_err("no dashboard");
    server.join().expect("the server ends");
    cause
}

#[test]
fn dashboards_that_say_odd_things_are_told() {
    const HELLO: &[u8] = b"Connected: Universal Robots Dashboard Server\nI know not\n";
    assert!(dashboard(b"HTTP/1.1 400 Bad Request\r\n", false).to_string().contains("HTTP/1.1 400"));
    assert!(dashboard(&[b'x'; 5000], false).to_string().contains("a line without an end"));
    assert!(dashboard(&[0xff, b'\n'], false).to_string().contains("greeting of the dashboard"));
    assert!(matches!(dashboard(b"Connected", false), DriverError::Timeout { .. }));
    assert!(matches!(dashboard(b"Connected", true), DriverError::Line { .. }));
    assert!(dashboard(HELLO, false).to_string().contains("robotmode: the answer is \"I know not\""));
}
