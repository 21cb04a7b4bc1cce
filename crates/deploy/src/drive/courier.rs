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

impl Mail {
    /// What to hand on, `told` being when the answer was given that was handed on last; none before the first answer. What went
    /// wrong is told where nothing newer was heard; a broken line always.
    fn newest(&mut self, told: &mut Option<Instant>) -> Option<Result<MotorState, DriverError>> {
        let news = self.state.is_some_and(|state| *told != Some(state.at));
        let broken = matches!(self.error, Some(DriverError::Line { .. }));
        let error = self.error.take().filter(|_| broken || !news);
        *told = self.state.map(|state| state.at);
        error.map(Err).or(self.state.map(Ok))
    }
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
        mail.newest(&mut self.told).unwrap_or_else(|| {
            Err(DriverError::Timeout { device: self.device.clone(), what: "first answer", waited: Duration::ZERO })
        })
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

    /// A motor that counts how often it is asked.
    struct Counting(Arc<Mutex<u32>>);

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

    impl Motor for Counting {
        fn state(&mut self) -> Result<MotorState, DriverError> {
            *self.0.lock().unwrap() += 1;
            Ok(state())
        }

        fn goal(&mut self, _: f64, _: f64) -> Result<(), DriverError> {
            Ok(())
        }

        fn torque(&mut self, _: bool) -> Result<(), DriverError> {
            Ok(())
        }
    }

    #[test]
    fn what_is_fresh_is_handed_on_although_some_answers_are_lost() {
        let lost = || {
            let (device, cause) = ("motor".to_owned(), "the checksum is wrong".to_owned());
            Some(DriverError::Protocol { device, what: "read", cause })
        };
        let cut =
            || Some(DriverError::Line { device: "motor".to_owned(), what: "read", cause: "it is gone".to_owned() });
        let alive = Instant::now();
        let mut mail = Mail { goal: None, torque: None, state: None, error: None, alive, end: false };
        let mut told = None;
        assert!(mail.newest(&mut told).is_none());
        mail.error = lost();
        assert!(mail.newest(&mut told).is_some_and(|news| news.is_err()));
        // One exchange of two worked since: what it said counts, not what the other lost.
        (mail.state, mail.error) = (Some(state()), lost());
        assert!(mail.newest(&mut told).is_some_and(|news| news.is_ok()));
        mail.error = lost();
        assert!(mail.newest(&mut told).is_some_and(|news| news.is_err()));
        // Nothing new, and nothing wrong: it is as old as it is.
        assert!(mail.newest(&mut told).is_some_and(|news| news.is_ok()));
        (mail.state, mail.error) = (Some(MotorState { at: alive + LEASE, ..state() }), cut());
        assert!(mail.newest(&mut told).is_some_and(|news| matches!(news, Err(DriverError::Line { .. }))));
    }

    #[test]
    fn it_falls_silent_with_whoever_drives() {
        let asked = Arc::new(Mutex::new(0));
        let _courier = Courier::new(Box::new(Counting(Arc::clone(&asked))), "motor").unwrap();
        std::thread::sleep(4 * LEASE);
        let by_then = *asked.lock().unwrap();
        std::thread::sleep(4 * LEASE);
        assert_eq!(*asked.lock().unwrap(), by_then);
    }
}
