//! The controller: registers, program, safety, and the arm that it moves.

use hwasp_drivers::Pose;
use nalgebra::{Isometry3, Vector3};

use super::faults::Faults;
use super::kinematics::{frame_of, pose_of, turned};
use super::motion::{Body, HARD};
use super::script::{Machine, compile};
use super::settings::UrEmulatorSettings;

/// Registers of each kind.
pub(super) const REGISTERS: usize = 48;
/// A protective stop can be unlocked after so long, s (vendor's manual of the dashboard).
const LOOK_FIRST: f64 = 5.0;

/// Numbers, whole numbers and bits that clients and programs share.
#[derive(Clone, Debug)]
pub(super) struct Registers {
    pub(crate) reals: [f64; REGISTERS],
    pub(crate) wholes: [i32; REGISTERS],
    pub(crate) bits: [bool; 128],
}

impl Default for Registers {
    fn default() -> Self {
        Self { reals: [0.0; REGISTERS], wholes: [0; REGISTERS], bits: [false; 128] }
    }
}

/// What the arm's safety says, by the vendor's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SafetyMode {
    Normal = 1,
    ProtectiveStop = 3,
    EmergencyStop = 7,
}

/// What the arm can be told to show of itself: what clients read at one moment.
#[derive(Clone, Debug)]
pub(super) struct Shown {
    pub(crate) q: [f64; 6],
    pub(crate) qd: [f64; 6],
    pub(crate) tool: Pose,
    pub(crate) tool_speed: [f64; 6],
}

/// Everything behind the ports.
#[derive(Debug)]
pub(super) struct Controller {
    pub(crate) settings: UrEmulatorSettings,
    pub(crate) clock: f64,
    /// ms since the last period.
    since: u32,
    pub(crate) body: Body,
    pub(crate) tcp: Isometry3<f64>,
    pub(crate) payload: (f64, [f64; 3]),
    pub(crate) inputs: Registers,
    pub(crate) outputs: Registers,
    pub(crate) program: Option<Machine>,
    pub(crate) paused: bool,
    pub(crate) safety: SafetyMode,
    stopped_at: f64,
    pub(crate) faults: Faults,
    frozen: Option<Shown>,
    tool_speed: [f64; 6],
    /// What programs and the controller said, newest last.
    pub(crate) log: Vec<String>,
    /// Of the trembling of encoders.
    tremble: u32,
}

impl Controller {
    pub(crate) fn new(settings: UrEmulatorSettings) -> Self {
        Self {
            settings,
            clock: 100.0,
            since: 0,
            body: Body::new(settings.generation.lengths(), settings.joints),
            tcp: Isometry3::identity(),
            payload: (0.0, [0.0; 3]),
            inputs: Registers::default(),
            outputs: Registers::default(),
            program: None,
            paused: false,
            safety: SafetyMode::Normal,
            stopped_at: 0.0,
            faults: Faults::default(),
            frozen: None,
            tool_speed: [0.0; 6],
            log: Vec::new(),
            tremble: 1,
        }
    }

    /// One period of the controller, s.
    pub(crate) fn period(&self) -> f64 {
        f64::from(self.settings.generation.period()) * 1e-3
    }

    /// The tool in the base.
    pub(crate) fn frame(&self) -> Isometry3<f64> {
        self.body.lengths.forward(&self.body.q) * self.tcp
    }

    /// Goes on by 1 ms; true when a period of the controller is over.
    pub(crate) fn millisecond(&mut self) -> bool {
        let dt = 1e-3;
        let before = self.frame();
        self.clock += dt;
        if let Err(cause) = self.body.advance(dt) {
            self.say(format!("stopped: {cause}"));
            self.protective_stop();
        }
        let after = self.frame();
        let shift = (after.translation.vector - before.translation.vector) / dt;
        let turn = turned(&before, &after) / dt;
        self.tool_speed = [shift.x, shift.y, shift.z, turn.x, turn.y, turn.z];
        self.since += 1;
        if self.since < self.settings.generation.period() {
            return false;
        }
        self.since = 0;
        self.run();
        true
    }

    fn run(&mut self) {
        if self.paused || self.safety != SafetyMode::Normal {
            return;
        }
        let Some(mut program) = self.program.take() else {
            return;
        };
        let period = self.period();
        match program.tick(self, period) {
            // What a program starts in its place stays.
            Ok(true) if self.program.is_none() => self.program = Some(program),
            Ok(true) => {}
            Ok(false) => self.body.stop(HARD),
            Err(cause) => {
                self.say(cause);
                self.body.stop(HARD);
            }
        }
    }

    /// Starts a program in the place of whichever runs, as the controller does with what it is sent.
    pub(crate) fn start(&mut self, text: &str) {
        if self.faults.local || self.faults.idle || self.safety != SafetyMode::Normal {
            self.say("a program was refused".to_owned());
            return;
        }
        match compile(text) {
            Ok(program) => {
                self.body.stop(HARD);
                self.paused = false;
                self.program = Some(Machine::new(program));
            }
            Err(cause) => self.say(format!("a program was not understood: {cause}")),
        }
    }

    pub(crate) fn stop_program(&mut self) {
        self.program = None;
        self.paused = false;
        self.body.stop(HARD);
    }

    pub(crate) fn protective_stop(&mut self) {
        if self.safety == SafetyMode::Normal {
            self.safety = SafetyMode::ProtectiveStop;
            self.stopped_at = self.clock;
            self.paused = self.program.is_some();
            self.body.stop(HARD);
        }
    }

    pub(crate) fn emergency_stop(&mut self) {
        self.safety = SafetyMode::EmergencyStop;
        self.stop_program();
    }

    /// What the dashboard says to "unlock protective stop". The program stays paused.
    pub(crate) fn unlock(&mut self) -> &'static str {
        if self.safety != SafetyMode::ProtectiveStop || self.clock - self.stopped_at >= LOOK_FIRST {
            if self.safety == SafetyMode::ProtectiveStop {
                self.safety = SafetyMode::Normal;
            }
            return "Protective stop releasing";
        }
        "Cannot unlock protective stop until 5s after occurrence. Always inspect cause of protective stop before unlocking"
    }

    /// Faults of line and arm are over; what ran does not go on by itself.
    pub(crate) fn clear(&mut self) {
        self.faults = Faults::default();
        self.frozen = None;
        if self.safety != SafetyMode::Normal {
            self.stop_program();
            self.safety = SafetyMode::Normal;
        }
    }

    pub(crate) fn freeze(&mut self) {
        self.frozen = Some(self.shown());
    }

    /// What clients read now. At rest encoders tremble in their last bits, as real ones do.
    pub(crate) fn shown(&mut self) -> Shown {
        if let Some(frozen) = &self.frozen {
            return frozen.clone();
        }
        self.tremble = self.tremble.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let mut q = self.body.q;
        for (joint, angle) in q.iter_mut().enumerate() {
            *angle += f64::from((self.tremble >> (8 + 3 * joint)) & 7) * 1e-7 - 3.5e-7;
        }
        let tool = pose_of(&(self.body.lengths.forward(&q) * self.tcp));
        let mut shown = Shown { q, qd: self.body.qd, tool, tool_speed: self.tool_speed };
        if self.faults.nan {
            shown.tool = Pose { position: [f64::NAN; 3], rotation: [f64::NAN; 3] };
        }
        shown
    }

    pub(crate) fn set_tcp(&mut self, tcp: &[f64; 6]) {
        let [x, y, z, a, b, c] = *tcp;
        self.tcp = frame_of(&Pose { position: [x, y, z], rotation: [a, b, c] });
    }

    /// Joints that bring the tool to a pose.
    pub(crate) fn reach(&self, pose: &[f64; 6], near: &[f64; 6]) -> Option<[f64; 6]> {
        let [x, y, z, a, b, c] = *pose;
        let tool = frame_of(&Pose { position: [x, y, z], rotation: [a, b, c] });
        self.body.lengths.inverse(&(tool * self.tcp.inverse()), near)
    }

    pub(crate) fn say(&mut self, text: String) {
        if self.log.len() >= 1000 {
            self.log.remove(0);
        }
        self.log.push(text);
    }

    /// 0 while it stops, 1 stopped, 2 plays, 4 paused.
    pub(crate) fn runtime_state(&self) -> u32 {
        match &self.program {
            Some(_) if self.paused => 4,
            Some(_) => 2,
            None if self.body.still() => 1,
            None => 0,
        }
    }

    /// 7 runs, 5 is idle, 3 is without power.
    pub(crate) fn robot_mode(&self) -> i32 {
        match self.safety {
            SafetyMode::EmergencyStop => 3,
            _ if self.faults.idle => 5,
            _ => 7,
        }
    }

    /// Speed of the tool's point, m/s.
    pub(crate) fn speed(&self) -> f64 {
        let [x, y, z, ..] = self.tool_speed;
        Vector3::new(x, y, z).norm()
    }
}
