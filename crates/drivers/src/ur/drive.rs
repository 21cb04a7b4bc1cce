//! The arm as what runs a robot sees it.

use std::net::{Shutdown, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use super::dashboard::Dashboard;
use super::link::{Link, Newest};
use super::reading::Reading;
use super::registers::{Command, Doing, VERSION};
use super::settings::UrSettings;
use super::stuck::Stillness;
use super::{script, tcp};
use crate::arm::{Arm, ArmMode, ArmState, Pose, Safety};
use crate::error::DriverError;

/// A straight move has arrived within this, m and rad.
const ARRIVED: (f64, f64) = (1e-3, 5e-3);

/// An arm of Universal Robots. It tells its state from [`UrArm::connect`] on, and follows from [`UrArm::start`] on.
#[derive(Debug)]
pub struct UrArm {
    pub(super) link: Link,
    pub(super) settings: UrSettings,
    number: i32,
    beat: i32,
    command: Command,
    target: Pose,
    stillness: Stillness,
    /// The last beat that the program has heard, and since when that has been the last.
    heard: (i32, Instant),
    interrupted: Arc<AtomicBool>,
}

impl UrArm {
    /// Connects and reads; nothing moves, no program is sent.
    pub fn connect(settings: &UrSettings) -> Result<Self, DriverError> {
        settings.check()?;
        let link = Link::connect(settings)?;
        // Registers keep their values while clients come and go: numbers that nobody used before tell old from new.
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Ok(Self {
            link,
            settings: settings.clone(),
            number: (since.as_millis() & 0x3fff_ffff) as i32,
            beat: 0,
            command: Command::Stand,
            target: Pose::default(),
            stillness: Stillness::default(),
            heard: (0, Instant::now()),
            interrupted: Arc::default(),
        })
    }

    /// Sends the program and waits until it stands ready. Refused unless brakes are released, its safety has nothing to say, and
    /// the controller takes programs from outside. After a stop of any kind a person decides to call this again.
    pub fn start(&mut self) -> Result<(), DriverError> {
        let what = "starting the program";
        let reading = self.fresh()?.reading;
        self.ready(what, &reading)?;
        if Dashboard::connect(&self.settings)?.remote()? == Some(false) {
            return Err(self.refused(what, "the arm is in local control: switch its teach pendant to remote control"));
        }
        self.stillness = Stillness::default();
        self.order(Command::Stand, true, 0.0)?;
        // Two packets later the registers are the controller's.
        let (count, _) = self.link.newest()?;
        self.link.after(count + 1, self.settings.answer)?;
        let mut stream = tcp::connect(&self.settings, self.settings.script_port, what)?;
        let text = script::program(&self.settings, if self.link.version[0] >= 5 { 0.002 } else { 0.008 });
        std::io::Write::write_all(&mut stream, text.as_bytes())
            .map_err(|cause| tcp::broken(&self.settings, what, &cause))?;
        let until = Instant::now() + self.settings.answer;
        let ours = |reading: &Reading| {
            reading.plays()
                && reading.program == VERSION
                && reading.taken == self.number
                && Doing::of(reading.doing) == Some(Doing::Standing)
        };
        let mut count = count;
        loop {
            let (next, newest) = self.link.after(count, self.settings.answer)?;
            if ours(&newest.reading) {
                break;
            }
            if Instant::now() > until {
                return Err(DriverError::Timeout {
                    device: self.settings.device(),
                    what,
                    waited: self.settings.answer,
                });
            }
            count = next;
        }
        close(&stream);
        Ok(())
    }

    /// Ends the program; the arm stands.
    pub fn end(&mut self) -> Result<(), DriverError> {
        self.order(Command::End, true, 0.0)
    }

    /// Set to true by whoever wants a straight move to end early (Ctrl-C): it stops then, and says that it was interrupted.
    /// No other begins until it is false again.
    pub fn interrupt(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.interrupted)
    }

    /// The newest packet as it came, for checks and logs.
    pub fn reading(&self) -> Result<Reading, DriverError> {
        Ok(self.link.newest()?.1.reading)
    }

    /// The newest packet, if it is fresh and its values are numbers.
    fn fresh(&self) -> Result<Newest, DriverError> {
        let newest = self.link.newest()?.1;
        let device = || self.settings.device();
        let waited = newest.at.elapsed() + newest.late;
        if waited > self.settings.oldest {
            return Err(DriverError::Timeout { device: device(), what: "state", waited });
        }
        if let Some((name, value)) = newest.reading.nonsense() {
            let cause = format!("{name} is {value}");
            return Err(DriverError::Protocol { device: device(), what: "state", cause });
        }
        Ok(newest)
    }

    /// Brakes are released and safety is silent.
    fn ready(&self, what: &'static str, reading: &Reading) -> Result<(), DriverError> {
        match reading.safety() {
            Safety::Normal | Safety::Reduced => {}
            Safety::ProtectiveStop => {
                let cause = "protective stop: look at the arm, unlock it by hand, then start again";
                return Err(self.refused(what, cause));
            }
            Safety::EmergencyStop => {
                return Err(self.refused(what, "emergency stop: make it safe, release the button, then start again"));
            }
            Safety::Stopped => {
                return Err(self.refused(what, &format!("its safety has stopped it (mode {})", reading.safety_mode)));
            }
        }
        match reading.mode() {
            ArmMode::Running => Ok(()),
            ArmMode::Idle => Err(self.refused(what, "the arm is idle: release its brakes at the teach pendant")),
            ArmMode::Off => {
                Err(self.refused(what, &format!("the arm is off (mode {}): switch it on", reading.robot_mode)))
            }
        }
    }

    /// Our program plays. What it did last tells why it does not.
    fn driven(&self, what: &'static str, reading: &Reading) -> Result<(), DriverError> {
        self.ready(what, reading)?;
        let watchdog = self.settings.watchdog.as_millis();
        match Doing::of(reading.doing) {
            _ if reading.program != VERSION => Err(self.refused(what, "its program does not run: start it")),
            Some(Doing::Deserted) => Err(self
                .refused(what, &format!("the program heard nothing for {watchdog} ms and has ended: start it again"))),
            Some(Doing::Ended) => Err(self.refused(what, "the program was told to end: start it again")),
            _ if !reading.plays() => Err(self.refused(what, "the controller has stopped the program: start it again")),
            _ => Ok(()),
        }
    }

    /// The program hears our heart. Another that plays in its place does not.
    fn heard(&mut self, what: &'static str, reading: &Reading) -> Result<(), DriverError> {
        if self.heard.0 != reading.heard {
            self.heard = (reading.heard, Instant::now());
        }
        if self.heard.1.elapsed() > self.settings.watchdog + self.settings.oldest {
            return Err(self.refused(what, "the program takes no orders: another one may play; start it again"));
        }
        Ok(())
    }

    /// Sends a command; `new` gives it a number of its own. Every order is a beat of the heart.
    fn order(&mut self, command: Command, new: bool, speed: f64) -> Result<(), DriverError> {
        self.command = command;
        self.beat = self.beat.wrapping_add(1);
        if new {
            self.number = (self.number + 1) & 0x3fff_ffff;
            self.heard.1 = Instant::now();
        }
        self.link.order(command, self.number, self.beat, &self.target, speed)
    }

    fn refused(&self, what: &'static str, cause: &str) -> DriverError {
        DriverError::Refused { device: self.settings.device(), what, cause: cause.to_owned() }
    }

    fn uninterrupted(&self) -> Result<(), DriverError> {
        if self.interrupted.load(Ordering::Relaxed) {
            return Err(self.refused("straight move", "it was interrupted"));
        }
        Ok(())
    }

    /// Waits until the move is over: it has arrived, or says why not.
    fn arrive(&mut self, target: &Pose, speed: f64, patience: Duration) -> Result<(), DriverError> {
        let what = "straight move";
        let until = Instant::now() + patience;
        let mut count = self.link.newest()?.0;
        loop {
            count = self.link.after(count, self.settings.oldest)?.0;
            let state = self.state()?;
            let reading = self.link.newest()?.1.reading;
            self.driven(what, &reading)?;
            self.heard(what, &reading)?;
            self.uninterrupted()?;
            if reading.taken == self.number && Doing::of(reading.doing) == Some(Doing::Standing) {
                let (away, turned) = (state.tool.distance(target), state.tool.turn(target));
                if away <= ARRIVED.0 && turned <= ARRIVED.1 {
                    return Ok(());
                }
                return Err(
                    self.refused(what, &format!("it ended {away:.4} m and {turned:.4} rad away from its target"))
                );
            }
            if Instant::now() > until {
                return Err(DriverError::Timeout { device: self.settings.device(), what, waited: patience });
            }
            self.order(Command::Move, false, speed)?;
        }
    }
}

impl Arm for UrArm {
    /// Never waits: the newest packet, or why there is none. Late packets, values that are no numbers, and a pose that does not
    /// change though it should are errors.
    fn state(&mut self) -> Result<ArmState, DriverError> {
        let Newest { at, reading, .. } = self.fresh()?;
        let moves = matches!(self.command, Command::Follow | Command::Move)
            && matches!(reading.safety(), Safety::Normal | Safety::Reduced)
            && matches!(Doing::of(reading.doing), Some(Doing::Following | Doing::Moving));
        if let Some(away) = self.stillness.stuck(at, &reading.tool, moves.then_some(&self.target), self.settings.stuck)
        {
            let cause = format!("the pose stays the same to the last bit, {away:.4} m from where it is sent");
            return Err(DriverError::Protocol { device: self.settings.device(), what: "state", cause });
        }
        Ok(ArmState {
            at,
            clock: reading.clock,
            tool: reading.tool,
            tool_speed: reading.tool_speed,
            joints: reading.joints,
            mode: reading.mode(),
            safety: reading.safety(),
        })
    }

    /// Refused while the program does not play, or when the arm's safety has stopped it; it then begins again by
    /// [`UrArm::start`] alone.
    fn servo(&mut self, target: &Pose) -> Result<(), DriverError> {
        self.settings.check_target(target)?;
        let reading = self.fresh()?.reading;
        self.driven("following", &reading)?;
        if self.command == Command::Follow {
            self.heard("following", &reading)?;
        }
        self.settings.check_leap(target, &reading.tool)?;
        self.target = *target;
        self.order(Command::Follow, self.command != Command::Follow, 0.0)
    }

    fn move_to(&mut self, target: &Pose, speed: f64) -> Result<(), DriverError> {
        self.settings.check_target(target)?;
        self.settings.check_speed(speed)?;
        self.uninterrupted()?;
        let reading = self.fresh()?.reading;
        self.driven("straight move", &reading)?;
        self.target = *target;
        self.order(Command::Move, true, speed)?;
        // Ramps, and a turn at 0.2 rad/s at least, thrice, and what a start takes.
        let way = target.distance(&reading.tool) / speed
            + target.turn(&reading.tool) / 0.2
            + speed / self.settings.acceleration;
        let end = self.arrive(target, speed, Duration::from_secs_f64(3.0 * way + 1.0));
        match end {
            Ok(()) => self.command = Command::Stand,
            // It may still move: whatever happened, it is told to stand.
            Err(_) => drop(self.stop()),
        }
        end
    }

    fn stop(&mut self) -> Result<(), DriverError> {
        self.order(Command::Stand, true, 0.0)
    }
}

impl Drop for UrArm {
    fn drop(&mut self) {
        // A line that is gone does as well: the heart stops with it.
        let _ = self.end();
    }
}

/// What the controller has sent on this port is read to its end first: closing over unread bytes would reset the connection,
/// and could take the program with it.
fn close(mut stream: &TcpStream) {
    let _ = stream.shutdown(Shutdown::Write);
    let _ = stream.set_nonblocking(true);
    let mut bytes = [0; 4096];
    while std::io::Read::read(&mut stream, &mut bytes).is_ok_and(|count| count > 0) {}
}
