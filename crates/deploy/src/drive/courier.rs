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
        Ok(Self { mail, thread: Some(thread), device: device.to_owned() })
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
        let heard = sent.and_then(|()| motor.state());
        {
            let mut mail = open(mail);
            match heard {
                Ok(state) => mail.state = Some(state),
                Err(error) => mail.error = Some(error),
            }
        }
        std::thread::sleep(PERIOD.saturating_sub(begun.elapsed()));
    }
}

impl Motor for Courier {
    fn state(&mut self) -> Result<MotorState, DriverError> {
        let mut mail = open(&self.mail);
        mail.alive = Instant::now();
        match mail.error.take() {
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
