//! Where the object is: told once, carried with the palm, or told by a tracker.

use std::io::ErrorKind;
use std::net::{Ipv4Addr, UdpSocket};
use std::time::{Duration, Instant};

use hwasp_settings::choice;
use hwasp_tasks::grasp::CarriedObject;
use serde::Deserialize;

use crate::error::DeployError;

choice! {
    /// How it is known where the object is.
    pub enum ObjectKnown {
        /// Told at the start, and nothing else.
        Fixed = "fixed",
        /// Told at the start, and carried with the palm once the grasp is felt.
        Carried = "carried",
        /// Told all the time, by a program that sees it.
        Tracker = "tracker",
    }
}

/// Where the object is taken to be in an episode.
#[derive(Debug)]
pub enum Object {
    /// Where it was told.
    Fixed([f64; 3]),
    /// With the palm once it is felt.
    Carried(CarriedObject),
    /// Where a tracker says.
    Tracked(Tracker),
}

impl Object {
    /// Where it is, m, with the palm at `palm`, m, and the motor's torque reading `torque`, N·m; and how old that is, where it can
    /// grow old. To be asked once a step.
    pub fn place(&mut self, palm: [f64; 3], torque: f64, now: Instant) -> ([f64; 3], Option<Duration>) {
        match self {
            Self::Fixed(told) => (*told, None),
            Self::Carried(object) => (object.place(palm, torque), None),
            Self::Tracked(tracker) => tracker.newest(now),
        }
    }
}

/// What a tracker sends.
#[derive(Debug, Deserialize)]
struct Word {
    /// The object's centre in the task's world, m.
    position: [f64; 3],
    /// Of the tracker's own clock, s.
    time: f64,
}

/// The longest word, bytes.
const LONGEST: usize = 1024;

/// A port to which a program sends where the object is: `{"position":[x,y,z],"time":t}`, one a packet, from this computer alone.
#[derive(Debug)]
pub struct Tracker {
    socket: UdpSocket,
    place: [f64; 3],
    /// Of the tracker's clock; words that are older than one before are left out.
    time: f64,
    at: Option<Instant>,
    began: Instant,
}

impl Tracker {
    /// Listens on a port of this computer, 0 for any.
    ///
    /// # Errors
    /// Where another program has it.
    pub fn listen(port: u16, now: Instant) -> Result<Self, DeployError> {
        let refused = |source: std::io::Error| DeployError::Value {
            name: "object.tracker_port",
            value: format!("{port} ({source})"),
            limits: "a port that is free: end the program that has it, or set another".to_owned(),
        };
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, port)).map_err(refused)?;
        socket.set_nonblocking(true).map_err(refused)?;
        Ok(Self { socket, place: [f64::NAN; 3], time: f64::NEG_INFINITY, at: None, began: now })
    }

    /// The port that it listens on.
    pub fn port(&self) -> Option<u16> {
        self.socket.local_addr().ok().map(|address| address.port())
    }

    /// The newest place and its age.
    fn newest(&mut self, now: Instant) -> ([f64; 3], Option<Duration>) {
        let mut word = [0; LONGEST];
        loop {
            match self.socket.recv(&mut word) {
                Ok(length) => self.hear(&word[..length], now),
                // A sender that went away is told by some systems at the next call.
                Err(error) if error.kind() == ErrorKind::ConnectionReset => {}
                Err(_) => break,
            }
        }
        (self.place, Some(now.saturating_duration_since(self.at.unwrap_or(self.began))))
    }

    /// Words that make no sense, and those that are older than one before, leave the place as old as it is.
    fn hear(&mut self, word: &[u8], now: Instant) {
        let Ok(Word { position, time }) = serde_json::from_slice(word) else { return };
        if time.is_finite() && time > self.time && position.iter().all(|x: &f64| x.is_finite() && x.abs() < 10.0) {
            (self.place, self.time, self.at) = (position, time, Some(now));
        }
    }

    /// Waits for a first word.
    ///
    /// # Errors
    /// Where none comes in time.
    pub fn first(&mut self, patience: Duration) -> Result<[f64; 3], DeployError> {
        let until = Instant::now() + patience;
        while Instant::now() < until {
            let (place, _) = self.newest(Instant::now());
            if self.at.is_some() {
                return Ok(place);
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        Err(DeployError::Value {
            name: "--object",
            value: format!("tracker (nothing came to UDP port {})", self.port().unwrap_or(0)),
            limits: "heard: start the program that sends {\"position\":[x,y,z],\"time\":t} to this computer".to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tracker_is_heard_and_grows_old() {
        let mut tracker = Tracker::listen(0, Instant::now()).unwrap();
        let sender = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        sender.connect((Ipv4Addr::LOCALHOST, tracker.port().unwrap())).unwrap();
        sender.send(br#"{"position":[0.01,0.02,0.03],"time":5.0}"#).unwrap();
        assert_eq!(tracker.first(Duration::from_secs(5)).unwrap(), [0.01, 0.02, 0.03]);
        // Nonsense, what is no number, and what is older than the last word: none of them is news.
        for word in [
            "",
            "{}",
            r#"{"position":[1,2],"time":6}"#,
            r#"{"position":[0,0,1e9],"time":7}"#,
            r#"{"position":[9,9,9],"time":4.5}"#,
        ] {
            sender.send(word.as_bytes()).unwrap();
        }
        std::thread::sleep(Duration::from_millis(30));
        let (place, age) = tracker.newest(Instant::now());
        assert_eq!(place, [0.01, 0.02, 0.03]);
        assert!(age.unwrap() >= Duration::from_millis(30), "{age:?}");
        sender.send(br#"{"position":[0.1,0,0],"time":5.1}"#).unwrap();
        std::thread::sleep(Duration::from_millis(10));
        let (place, age) = tracker.newest(Instant::now());
        assert!(place == [0.1, 0.0, 0.0] && age.unwrap() < Duration::from_millis(25), "{place:?} {age:?}");
    }

    #[test]
    fn a_port_is_listened_on_once() {
        let first = Tracker::listen(0, Instant::now()).unwrap();
        let error = Tracker::listen(first.port().unwrap(), Instant::now()).unwrap_err().to_string();
        assert!(error.starts_with("object.tracker_port = ") && error.contains("is free"), "{error}");
    }
}
