//! The motor itself: where it goes, what it feels, and when it stops.

use super::faults::{self, Faults, Order};
use super::memory::{CURRENT_MODE, EXTENDED_MODE, Memory, POSITION_MODE, PWM_MODE, Refusal, TRIPPED, VELOCITY_MODE};
use super::profile::Profile;
use super::table::{self, Register};
use crate::world::{SpoolDrive, SpoolState};

/// Ticks of a turn.
const TURN: f64 = 4096.0;
/// Ticks per radian.
const TICKS: f64 = TURN / std::f64::consts::TAU;
/// A tick of current, A.
const CURRENT_TICK: f64 = 2.69e-3;
/// A tick of speed, 0.229 turns a minute, in ticks a second.
const SPEED_TICK: f64 = 0.229 / 60.0 * TURN;
/// A tick of acceleration, 214.577 turns/min², in ticks/s².
const ACCELERATION_TICK: f64 = 214.577 / 3600.0 * TURN;
/// The speed without load at 12 V, 77 turns a minute, in ticks a second.
const FASTEST: f64 = 77.0 / 60.0 * TURN;
/// The current at stall and 12 V, A.
const STALL: f64 = 2.3;
/// The voltage where nothing else is said, V.
const VOLTAGE: f64 = 12.0;
/// How warm it is without current, °C, how much warmer 1 A makes it, and how long that takes, s. Rough figures.
const HEAT: [f64; 3] = [28.0, 12.0, 300.0];
/// For how long it says nothing after a restart, s.
const RESTART: f64 = 0.3;
/// How far ahead of the spool the motor pulls where it has no position to go to, ticks.
const LEAD: f64 = 100.0;

/// A motor and its spool.
#[derive(Debug)]
pub(super) struct Device {
    pub(super) memory: Memory,
    pub(super) faults: Faults,
    /// What waits for an action: address and bytes.
    pub(super) registered: Option<(usize, Vec<u8>)>,
    /// s since the start.
    time: f64,
    /// When an instruction was last heard, s.
    heard: f64,
    /// Until when it starts, s.
    starts_until: f64,
    spool: SpoolState,
    /// From the encoder's ticks to those of the register, whole turns.
    offset: f64,
    path: Profile,
    temperature: f64,
    random: u64,
}

impl Device {
    pub(super) fn new(id: u8, baud: u8) -> Self {
        let mut memory = Memory::new();
        memory.set(&table::ID, i32::from(id));
        memory.set(&table::BAUD_RATE, i32::from(baud));
        Self {
            memory,
            faults: Faults::default(),
            registered: None,
            time: 0.0,
            heard: 0.0,
            starts_until: 0.0,
            spool: SpoolState::default(),
            offset: 0.0,
            path: Profile::default(),
            temperature: HEAT[0],
            random: 0x2545_F491_4F6C_DD1D,
        }
    }

    fn get(&self, register: &Register) -> f64 {
        f64::from(self.memory.get(register))
    }

    fn torque(&self) -> bool {
        self.memory.get(&table::TORQUE_ENABLE) != 0
    }

    fn sign(&self) -> f64 {
        if self.memory.get(&table::DRIVE_MODE) & 1 == 0 { 1.0 } else { -1.0 }
    }

    /// Where it is, in ticks of its registers.
    fn position(&self) -> f64 {
        self.sign() * TICKS * self.spool.position + self.offset + self.get(&table::HOMING_OFFSET)
    }

    /// Whether it answers at all.
    pub(super) fn is_awake(&self) -> bool {
        !self.faults.silent && self.time >= self.starts_until
    }

    /// An instruction came, for whomever: the watchdog is content.
    pub(super) fn hear(&mut self) {
        self.heard = self.time;
    }

    /// Whether something goes wrong that goes wrong in this share of cases.
    pub(super) fn happens(&mut self, share: f64) -> bool {
        // SplitMix64 (Steele, Lea and Flood, OOPSLA 2014).
        self.random = self.random.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.random;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 <= share && share > 0.0
    }

    /// What it does to the spool.
    pub(super) fn drive(&self) -> SpoolDrive {
        if !self.torque() {
            return SpoolDrive::Free;
        }
        let most = CURRENT_TICK * self.get(&table::CURRENT_LIMIT);
        let current = match self.memory.get(&table::OPERATING_MODE) {
            VELOCITY_MODE | POSITION_MODE | EXTENDED_MODE => most,
            PWM_MODE => most.min(STALL * self.get(&table::GOAL_PWM).abs() / 885.0),
            _ => CURRENT_TICK * self.get(&table::GOAL_CURRENT).abs(),
        };
        let ticks = self.path.position - self.offset - self.get(&table::HOMING_OFFSET);
        SpoolDrive::Position { goal: self.sign() * ticks / TICKS, current }
    }

    /// What the spool does to it.
    pub(super) fn tell(&mut self, spool: SpoolState) {
        self.spool = spool;
        self.show();
    }

    /// Goes on by `dt`, s.
    pub(super) fn advance(&mut self, dt: f64) {
        self.time += dt;
        self.watch();
        let current = if self.torque() { self.spool.current } else { 0.0 };
        let [ambient, warmer, slowness] = HEAT;
        self.temperature += (ambient + warmer * current * current - self.temperature) * dt / slowness;
        self.feel();
        self.go(dt);
        self.show();
    }

    /// The bus watchdog: where nobody has spoken for too long, the motor stands still and takes no goals.
    fn watch(&mut self) {
        let patience = self.memory.get(&table::BUS_WATCHDOG);
        // A little beyond the limit, since times are sums.
        let late = self.time - self.heard > 0.020 * f64::from(patience) + 1e-9;
        if self.torque() && (1..TRIPPED).contains(&patience) && late {
            self.memory.set(&table::BUS_WATCHDOG, TRIPPED);
            for register in [table::PROFILE_ACCELERATION, table::PROFILE_VELOCITY, table::GOAL_VELOCITY] {
                self.memory.set(&register, 0);
            }
            match self.memory.get(&table::OPERATING_MODE) {
                CURRENT_MODE => self.memory.set(&table::GOAL_CURRENT, 0),
                PWM_MODE => self.memory.set(&table::GOAL_PWM, 0),
                _ => self.stand(),
            }
        }
    }

    /// Its goal becomes where it is.
    fn stand(&mut self) {
        let here = self.position().round();
        self.memory.set(&table::GOAL_POSITION, here as i32);
        self.path = Profile { position: here, velocity: 0.0 };
    }

    /// Hardware errors of what it feels; torque goes where the mask says so.
    fn feel(&mut self) {
        if self.faults.temperature.unwrap_or(self.temperature) > self.get(&table::TEMPERATURE_LIMIT) {
            self.fail(faults::OVERHEATING);
        }
        let voltage = 10.0 * self.faults.voltage.unwrap_or(VOLTAGE);
        if !(self.get(&table::MIN_VOLTAGE)..=self.get(&table::MAX_VOLTAGE)).contains(&voltage) {
            self.fail(faults::WRONG_VOLTAGE);
        }
    }

    fn fail(&mut self, bit: u8) {
        let errors = self.memory.get(&table::HARDWARE_ERROR) | i32::from(bit);
        self.memory.set(&table::HARDWARE_ERROR, errors);
        if self.is_shut_down() {
            self.memory.set(&table::TORQUE_ENABLE, 0);
        }
    }

    fn is_shut_down(&self) -> bool {
        self.memory.get(&table::HARDWARE_ERROR) & self.memory.get(&table::SHUTDOWN) != 0
    }

    /// Moves what the controller inside goes after.
    fn go(&mut self, dt: f64) {
        let here = self.position();
        if !self.torque() {
            self.path = Profile { position: here, velocity: 0.0 };
            return;
        }
        let fastest = FASTEST * self.faults.voltage.unwrap_or(VOLTAGE) / VOLTAGE;
        let or = |value: f64, otherwise: f64| if value > 0.0 { value } else { otherwise };
        let acceleration = or(ACCELERATION_TICK * self.get(&table::PROFILE_ACCELERATION), f64::INFINITY);
        match self.memory.get(&table::OPERATING_MODE) {
            VELOCITY_MODE => {
                let speed = (SPEED_TICK * self.get(&table::GOAL_VELOCITY)).clamp(-fastest, fastest);
                self.path.speed_up(speed, acceleration, dt);
                self.path.position = self.path.position.clamp(here - LEAD, here + LEAD);
            }
            mode @ (CURRENT_MODE | PWM_MODE) => {
                let goal = if mode == PWM_MODE { &table::GOAL_PWM } else { &table::GOAL_CURRENT };
                let ahead = self.memory.get(goal).signum();
                self.path = Profile { position: here + LEAD * f64::from(ahead), velocity: 0.0 };
            }
            _ => {
                let speed = or(SPEED_TICK * self.get(&table::PROFILE_VELOCITY), fastest).min(fastest);
                self.path.approach(self.get(&table::GOAL_POSITION), speed, acceleration, dt);
            }
        }
    }

    /// Writes what it feels into the registers.
    fn show(&mut self) {
        let torque = self.torque();
        let measured = if torque { self.spool.current } else { 0.0 };
        let current = self.faults.current.unwrap_or(self.sign() * measured);
        let speed = self.sign() * TICKS * self.spool.velocity;
        let position = self.position().round();
        let moving = (speed / SPEED_TICK).abs() > self.get(&table::MOVING_THRESHOLD);
        let on_the_way = torque && self.path.velocity != 0.0;
        let arrived = torque && (self.get(&table::GOAL_POSITION) - position).abs() < 20.0;
        let pwm = 885.0 * (measured / STALL + speed / FASTEST);
        for (register, value) in [
            (table::REALTIME_TICK, (1e3 * self.time) % 32_768.0),
            (table::MOVING, f64::from(u8::from(moving))),
            (table::MOVING_STATUS, f64::from(u8::from(arrived) | (u8::from(on_the_way) << 1))),
            (table::PRESENT_PWM, pwm.clamp(-885.0, 885.0)),
            (table::PRESENT_CURRENT, (current / CURRENT_TICK).round()),
            (table::PRESENT_VELOCITY, (speed / SPEED_TICK).round()),
            (table::PRESENT_POSITION, position),
            (table::VELOCITY_TRAJECTORY, (self.path.velocity / SPEED_TICK).round()),
            (table::POSITION_TRAJECTORY, self.path.position.round()),
            (table::PRESENT_VOLTAGE, (10.0 * self.faults.voltage.unwrap_or(VOLTAGE)).round()),
            (table::PRESENT_TEMPERATURE, self.faults.temperature.unwrap_or(self.temperature).round()),
        ] {
            self.memory.set(&register, value as i32);
        }
        for &(register, value) in &self.faults.stuck {
            self.memory.set(register, value);
        }
    }

    /// Writes registers, and does what follows from it.
    pub(super) fn write(&mut self, address: usize, data: &[u8]) -> Result<(), Refusal> {
        let before = self.memory.clone();
        let written = self.memory.write(address, data)?;
        for register in written {
            let changed = before.get(register) != self.memory.get(register);
            if *register == table::TORQUE_ENABLE && self.is_shut_down() {
                // Only a reboot helps. It says so by its alert, and by nothing else.
                self.memory.set(&table::TORQUE_ENABLE, 0);
            }
            if *register == table::OPERATING_MODE && changed {
                self.memory.set(&table::GOAL_CURRENT, self.memory.get(&table::CURRENT_LIMIT));
                self.memory.set(&table::GOAL_PWM, self.memory.get(&table::PWM_LIMIT));
                self.memory.set(&table::GOAL_VELOCITY, 0);
                if self.memory.get(register) == POSITION_MODE {
                    self.forget_turns();
                }
                self.stand();
            }
        }
        self.show();
        Ok(())
    }

    /// Counts turns from this one on. Not while it turns.
    pub(super) fn clear_turns(&mut self) -> Result<(), Refusal> {
        if self.memory.get(&table::MOVING) != 0 {
            return Err(Refusal::Failed);
        }
        self.forget_turns();
        self.stand();
        self.show();
        Ok(())
    }

    fn forget_turns(&mut self) {
        let turns = (self.sign() * TICKS * self.spool.position / TURN).floor();
        self.offset = -turns * TURN;
    }

    /// Power off and on.
    pub(super) fn restart(&mut self) {
        self.memory.restart();
        self.registered = None;
        self.starts_until = self.time + RESTART;
        self.forget_turns();
        self.stand();
        self.show();
    }

    /// A fault by its text.
    pub(super) fn inject(&mut self, text: &str) -> Result<Order, String> {
        let order = self.faults.take(text)?;
        match order {
            Order::Stick(register) => self.faults.stuck.push((register, self.memory.get(register))),
            Order::Fail(bit) => self.fail(bit),
            Order::Restart => self.restart(),
            Order::Nothing | Order::Cut => {}
        }
        self.feel();
        self.show();
        Ok(order)
    }
}
