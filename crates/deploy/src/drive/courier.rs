//! A motor on a thread of its own, so that nobody waits for its line.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use hwasp_drivers::{DriverError, Motor, MotorState};

/// What is to be done, and what was heard.
#[derive(Debug)]
struct Mail {
    /// The newest goal, rad and A, until it is sent.
    goal: Option<(f64, f64)>,
    /// The newest word about torque, until it is sent.
    torque: Option<bool>,
    /// The newest answer.
    state: Option<MotorState>,
    /// What went wrong last, until it is told.
    error: Option<DriverError>,
    /// When whoever drives was last heard of.
    alive: Instant,
    end: bool,
}

/// Talks to a motor on a thread of its own: whoever drives leaves goals and takes the newest answer, and waits for neither.
///
/// It talks only as long as it hears from whoever drives. One that hangs is heard no more, the courier falls silent, and the motor
/// stops by its own watchdog.
#[derive(Debug)]
pub struct Courier {
    mail: Arc<Mutex<Mail>>,
    thread: Option<JoinHandle<()>>,
    device: String,
    /// When the answer was given that was handed on last.
    told: Option<Instant>,
}

/// How often the motor is talked to.
const PERIOD: Duration = Duration::from_millis(5);
/// For how long whoever drives may be silent.
const LEASE: Duration = Duration::from_millis(50);

fn open(mail: &Mutex<Mail>) -> MutexGuard<'_, Mail> {
    // A thread that ended by a panic leaves nothing half done in a mail.
    mail.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Courier {
    /// To this motor, which messages call `device`.
    pub fn new(mut motor: Box<dyn Motor>, device: &str) -> std::io::Result<Self> {
        let mail = Mail { goal: None, torque: None, state: None, error: None, alive: Instant::now(), end: false };
        let mail = Arc::new(Mutex::new(mail));
        let own = Arc::clone(&mail);
        let thread = std::thread::Builder::new().name("motor".to_owned()).spawn(move || carry(&own, motor.as_mut()))?;
        Ok(Self { mail, thread: Some(thread), device: device.to_owned(), told: None })
    }
}

fn carry(mail: &Mutex<Mail>, motor: &mut dyn Motor) {
    loop {
        let begun = Instant::now();
        let (goal, torque) = {
            let mut mail = open(mail);
            if mail.end {
                return;
            }
            let silent = mail.alive.elapsed() > LEASE && mail.torque.is_none();
            if silent {
                drop(mail);
                std::thread::sleep(PERIOD);
                continue;
            }
            (mail.goal.take(), mail.torque.take())
        };
        let sent = torque
            .map_or(Ok(()), |on| motor.torque(on))
            .and(goal.map_or(Ok(()), |(at, current)| motor.goal(at, current)));
        // A motor that refuses a goal says why in its state.
        let heard = motor.state();
        {
            let mut mail = open(mail);
            match (sent, heard) {
                (Ok(()), Ok(state)) => mail.state = Some(state),
                (Err(error), heard) => {
                    mail.state = heard.ok().or(mail.state);
                    mail.error = Some(error);
                }
                (Ok(()), Err(error)) => mail.error = Some(error),
            }
        }
        std::thread::sleep(PERIOD.saturating_sub(begun.elapsed()));
    }
}

impl Motor for Courier {
    fn state(&mut self) -> Result<MotorState, DriverError> {
        let mut mail = open(&self.mail);
        mail.alive = Instant::now();
        // What went wrong is told where nothing newer was heard; a broken line always.
        let news = mail.state.filter(|state| self.told != Some(state.at));
        let broken = matches!(mail.error, Some(DriverError::Line { .. }));
        let error = mail.error.take().filter(|_| broken || news.is_none());
        self.told = mail.state.map(|state| state.at);
        match error {
            Some(error) => Err(error),
            None => mail.state.ok_or_else(|| DriverError::Timeout {
                device: self.device.clone(),
                what: "first answer",
                waited: Duration::ZERO,
            }),
        }
    }

    fn goal(&mut self, position: f64, current: f64) -> Result<(), DriverError> {
        let mut mail = open(&self.mail);
        (mail.goal, mail.alive) = (Some((position, current)), Instant::now());
        Ok(())
    }

    fn torque(&mut self, on: bool) -> Result<(), DriverError> {
        let deadline = Instant::now() + Duration::from_millis(500);
        {
            let mut mail = open(&self.mail);
            mail.torque = Some(on);
            mail.error = None;
            if !on {
                mail.goal = None;
            }
        }
        // This one is waited for: whoever frees a motor wants to know.
        while Instant::now() < deadline {
            std::thread::sleep(Duration::from_millis(1));
            let mut mail = open(&self.mail);
            mail.alive = Instant::now();
            if let Some(error) = mail.error.take() {
                return Err(error);
            }
            if mail.torque.is_none() && mail.state.is_some_and(|state| state.torque == on) {
                return Ok(());
            }
        }
        Err(DriverError::Timeout { device: self.device.clone(), what: "torque", waited: Duration::from_millis(500) })
    }
}

impl Drop for Courier {
    fn drop(&mut self) {
        open(&self.mail).end = true;
        if let Some(thread) = self.thread.take() {
            // One that ended by a panic has told of it.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A motor whose every third exchange fails, and which counts what it is told.
    struct Flaky {
        asked: Arc<Mutex<(u32, Vec<f64>)>>,
    }

    fn state() -> MotorState {
        MotorState {
            at: Instant::now(),
            position: 0.0,
            velocity: 0.0,
            current: 0.0,
            voltage: 12.0,
            temperature: 30.0,
            hardware_error: 0,
            torque: false,
        }
    }

    impl Motor for Flaky {
        fn state(&mut self) -> Result<MotorState, DriverError> {
            let mut asked = self.asked.lock().unwrap();
            asked.0 += 1;
            if asked.0.is_multiple_of(3) {
                let (device, cause) = ("motor".to_owned(), "the checksum is wrong".to_owned());
                return Err(DriverError::Protocol { device, what: "read", cause });
            }
            Ok(state())
        }

        fn goal(&mut self, position: f64, _: f64) -> Result<(), DriverError> {
            self.asked.lock().unwrap().1.push(position);
            Ok(())
        }

        fn torque(&mut self, _: bool) -> Result<(), DriverError> {
            Ok(())
        }
    }

    #[test]
    fn answers_are_fresh_although_some_are_lost() {
        let asked = Arc::default();
        let mut courier = Courier::new(Box::new(Flaky { asked: Arc::clone(&asked) }), "motor").unwrap();
        std::thread::sleep(Duration::from_millis(40));
        for i in 0..20 {
            courier.goal(f64::from(i), 0.1).unwrap();
            std::thread::sleep(Duration::from_millis(10));
            // One exchange of two in a step works: what it said is handed on, not what the other lost.
            assert!(courier.state().is_ok_and(|state| state.at.elapsed() < Duration::from_secs(1)));
        }
        let goals = asked.lock().unwrap().1.clone();
        assert!(goals.windows(2).all(|pair| pair[0] < pair[1]) && goals.len() > 5, "{goals:?}");
    }

    #[test]
    fn it_falls_silent_with_whoever_drives() {
        let asked: Arc<Mutex<(u32, Vec<f64>)>> = Arc::default();
        let _courier = Courier::new(Box::new(Flaky { asked: Arc::clone(&asked) }), "motor").unwrap();
        std::thread::sleep(4 * LEASE);
        let by_then = asked.lock().unwrap().0;
        std::thread::sleep(4 * LEASE);
        assert_eq!(asked.lock().unwrap().0, by_then);
    }
}
