//! An arm and a motor in virtual time, which fail when they are told to.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use hwasp_deploy::clock::Clock;
use hwasp_deploy::controller::Spool;
use hwasp_deploy::record::{Event, Sink, Step};
use hwasp_deploy::rig::{Rig, Winding};
use hwasp_drivers::{Arm, ArmMode, ArmState, DriverError, Motor, MotorState, Pose, Safety};
use hwasp_tasks::hand::TransmissionDescription;

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault {
    None,
    /// No more packets of the arm.
    ArmSilent,
    /// Its line breaks.
    ArmCut,
    /// It says the same for ever.
    ArmFrozen,
    /// Its packets are so late, ms.
    ArmLate(u64),
    Protective,
    Emergency,
    /// Another stop by the arm's safety.
    SafetyStop,
    /// Its brakes close.
    ArmIdle,
    /// It says what is no number.
    ArmNan,
    /// It jumps out of its workspace.
    ArmOutside,
    /// It races, m/s.
    ArmFast(f64),
    /// It is fast in one packet alone.
    ArmFastOnce,
    /// It does not follow.
    ArmStays,
    /// No more answers of the motor.
    MotorSilent,
    MotorCut,
    /// One wrong checksum in so many answers.
    WrongCrc(u32),
    /// Answers are so late, ms.
    MotorLate(u64),
    /// Its position stays what it was.
    StuckRegister,
    MotorNan,
    /// So much current, A, for so long, s.
    Current(f64, f64),
    /// °C.
    Heat(f64),
    /// V.
    Voltage(f64),
    HardwareError(u8),
    /// Its torque is off.
    MotorFree,
    /// Its position jumps by so much tendon, m.
    Jump(f64),
    FullDisk,
    Interrupt,
    InterruptTwice,
    /// The computer does nothing else for so long, ms.
    Overrun(u64),
}

/// Arm, motor and time.
pub(crate) struct World {
    pub(crate) begin: Instant,
    pub(crate) now: Instant,
    pub(crate) onset: Duration,
    pub(crate) fault: Fault,
    /// Where the palm is sent and is, in the task's world.
    pub(crate) target: [f64; 3],
    pub(crate) palm: [f64; 3],
    pub(crate) speed: [f64; 3],
    pub(crate) stopped_at: Option<Duration>,
    pub(crate) servos: u32,
    pub(crate) goal: f64,
    pub(crate) wound: f64,
    pub(crate) torque: bool,
    pub(crate) freed_at: Option<Duration>,
    kept_arm: Option<ArmState>,
    kept_motor: Option<MotorState>,
    frozen_wound: Option<f64>,
    answers: u32,
    pub(crate) interrupts: Arc<AtomicU32>,
    pub(crate) overran: bool,
    /// What is held: winding beyond it needs force. m
    pub(crate) object_at: f64,
    pub(crate) rig: Rig,
    pub(crate) spool: Spool,
    history: Vec<(Instant, ArmState)>,
    answered: Vec<(Instant, MotorState)>,
}

/// Stiffness of three tendons, N/m.
const STIFFNESS: f64 = 15_000.0;

pub(crate) type Shared = Arc<Mutex<World>>;

pub(crate) fn world(fault: Fault, onset: Duration) -> Shared {
    let (begin, rig) = (Instant::now(), Rig::default());
    let spool = Spool::new(&TransmissionDescription::default(), Winding::Positive, 1.0, 1.0);
    Arc::new(Mutex::new(World {
        begin,
        now: begin,
        onset,
        fault,
        target: [0.0, 0.0, 0.3],
        palm: [0.0, 0.0, 0.3],
        speed: [0.0; 3],
        stopped_at: None,
        servos: 0,
        goal: 0.0,
        wound: 0.0,
        torque: false,
        freed_at: None,
        kept_arm: None,
        kept_motor: None,
        frozen_wound: None,
        answers: 0,
        interrupts: Arc::new(AtomicU32::new(0)),
        overran: false,
        object_at: 0.006,
        rig,
        spool,
        history: Vec::with_capacity(100_000),
        answered: Vec::with_capacity(100_000),
    }))
}

fn lock(world: &Shared) -> MutexGuard<'_, World> {
    world.lock().unwrap()
}

impl World {
    pub(crate) fn age(&self) -> Duration {
        self.now - self.begin
    }

    pub(crate) fn faulty(&self) -> bool {
        self.fault != Fault::None && self.age() >= self.onset
    }

    /// One millisecond.
    fn tick(&mut self) {
        self.now += Duration::from_millis(1);
        let faulty = self.faulty();
        let stays = faulty
            && matches!(
                self.fault,
                Fault::ArmStays | Fault::Protective | Fault::Emergency | Fault::ArmIdle | Fault::SafetyStop
            );
        for axis in 0..3 {
            let before = self.palm[axis];
            if self.stopped_at.is_none() && !stays {
                self.palm[axis] += (self.target[axis] - before) * 0.05;
            }
            self.speed[axis] = (self.palm[axis] - before) / 1e-3;
        }
        if self.torque {
            // The spool follows at 40 mm/s where its current suffices.
            let most = self.spool.current * self.spool.torque_per_current / self.spool.radius;
            let reach = self.object_at + most / STIFFNESS;
            self.wound += (self.goal - self.wound).clamp(-4e-5, 4e-5);
            self.wound = self.wound.min(reach);
        }
        match self.fault {
            Fault::Interrupt if faulty => self.interrupts.store(1, Ordering::Relaxed),
            Fault::InterruptTwice if faulty => self.interrupts.store(2, Ordering::Relaxed),
            _ => {}
        }
        let (arm, motor) = (self.arm_now(), self.motor_now());
        self.history.push((self.now, arm));
        self.answered.push((self.now, motor));
    }

    fn arm_now(&self) -> ArmState {
        ArmState {
            at: self.now,
            clock: self.age().as_secs_f64(),
            tool: self.rig.frame().pose(self.palm),
            tool_speed: self.speed,
            joints: [0.1; 6],
            mode: ArmMode::Running,
            safety: Safety::Normal,
        }
    }

    fn motor_now(&self) -> MotorState {
        let force = (STIFFNESS * (self.wound - self.object_at)).max(0.0);
        MotorState {
            at: self.now,
            position: self.spool.position(self.wound),
            velocity: 0.0,
            current: if self.torque { force * self.spool.radius / self.spool.torque_per_current } else { 0.0 },
            voltage: 12.0,
            temperature: 35.0,
            hardware_error: 0,
            torque: self.torque,
        }
    }
}

#[derive(Clone)]
pub(crate) struct VirtualClock(pub(crate) Shared);

impl Clock for VirtualClock {
    fn now(&self) -> Instant {
        lock(&self.0).now
    }

    fn sleep_until(&self, then: Instant) {
        let mut world = lock(&self.0);
        if let (Fault::Overrun(ms), true, false) = (world.fault, world.faulty(), world.overran) {
            world.overran = true;
            for _ in 0..ms {
                world.tick();
            }
        }
        while world.now < then {
            world.tick();
        }
    }
}

pub(crate) struct FakeArm(pub(crate) Shared);

fn line(device: &str) -> DriverError {
    DriverError::Line { device: device.to_owned(), what: "reading", cause: "the cable is cut".to_owned() }
}

impl Arm for FakeArm {
    fn state(&mut self) -> Result<ArmState, DriverError> {
        let mut world = lock(&self.0);
        let mut state = world.arm_now();
        if !world.faulty() {
            world.kept_arm = Some(state);
            return Ok(state);
        }
        let kept = world.kept_arm.unwrap_or(state);
        match world.fault {
            Fault::ArmSilent => return Ok(kept),
            Fault::ArmCut => return Err(line("arm")),
            Fault::ArmFrozen => state = ArmState { at: state.at, ..kept },
            Fault::ArmLate(ms) => {
                let then = world.now.checked_sub(Duration::from_millis(ms)).unwrap_or(world.begin);
                state = world.history.iter().rev().find(|(at, _)| *at <= then).map_or(kept, |(_, state)| *state);
            }
            Fault::Protective => state.safety = Safety::ProtectiveStop,
            Fault::Emergency => state.safety = Safety::EmergencyStop,
            Fault::SafetyStop => state.safety = Safety::Stopped,
            Fault::ArmIdle => state.mode = ArmMode::Idle,
            Fault::ArmNan => state.tool.position[1] = f64::NAN,
            Fault::ArmOutside => state.tool = world.rig.frame().pose([0.19, 0.0, 0.3]),
            Fault::ArmFast(speed) => state.tool_speed = [0.0, speed, 0.0],
            Fault::ArmFastOnce if world.age() < world.onset + Duration::from_millis(10) => state.tool_speed = [1.0; 3],
            _ => {}
        }
        Ok(state)
    }

    fn servo(&mut self, target: &Pose) -> Result<(), DriverError> {
        let mut world = lock(&self.0);
        if world.fault == Fault::ArmCut && world.faulty() {
            return Err(line("arm"));
        }
        assert!(world.stopped_at.is_none(), "a stopped arm is sent nowhere");
        world.target = world.rig.frame().place(target);
        world.servos += 1;
        Ok(())
    }

    fn move_to(&mut self, _: &Pose, _: f64) -> Result<(), DriverError> {
        panic!("everything moves through the loop");
    }

    fn stop(&mut self) -> Result<(), DriverError> {
        let mut world = lock(&self.0);
        if world.fault == Fault::ArmCut && world.faulty() {
            return Err(line("arm"));
        }
        let age = world.age();
        world.stopped_at.get_or_insert(age);
        Ok(())
    }
}

pub(crate) struct FakeMotor(pub(crate) Shared);

impl FakeMotor {
    fn reachable(world: &World) -> Result<(), DriverError> {
        let waited = Duration::from_millis(20);
        match world.fault {
            Fault::MotorCut if world.faulty() => Err(line("motor")),
            Fault::MotorSilent if world.faulty() => {
                Err(DriverError::Timeout { device: "motor".to_owned(), what: "read", waited })
            }
            _ => Ok(()),
        }
    }
}

impl Motor for FakeMotor {
    fn state(&mut self) -> Result<MotorState, DriverError> {
        let mut world = lock(&self.0);
        Self::reachable(&world)?;
        let mut state = world.motor_now();
        if !world.faulty() {
            world.kept_motor = Some(state);
            return Ok(state);
        }
        world.answers += 1;
        let since = world.age().saturating_sub(world.onset).as_secs_f64();
        match world.fault {
            Fault::WrongCrc(every) if world.answers.is_multiple_of(every) => {
                let cause = "the checksum is wrong".to_owned();
                return Err(DriverError::Protocol { device: "motor".to_owned(), what: "read", cause });
            }
            Fault::MotorLate(ms) => {
                let then = world.now.checked_sub(Duration::from_millis(ms)).unwrap_or(world.begin);
                let kept = world.kept_motor.unwrap_or(state);
                state = world.answered.iter().rev().find(|(at, _)| *at <= then).map_or(kept, |(_, state)| *state);
            }
            Fault::StuckRegister => {
                let wound = world.wound;
                let frozen = *world.frozen_wound.get_or_insert(wound);
                state.position = world.spool.position(frozen);
                state.current = 0.1;
            }
            Fault::MotorNan => state.current = f64::NAN,
            Fault::Current(amperes, seconds) if since < seconds => state.current = amperes,
            Fault::Heat(temperature) => state.temperature = temperature,
            Fault::Voltage(voltage) => state.voltage = voltage,
            Fault::HardwareError(bits) => state.hardware_error = bits,
            Fault::MotorFree => state.torque = false,
            Fault::Jump(tendon) => state.position += tendon / world.spool.radius,
            _ => {}
        }
        Ok(state)
    }

    fn goal(&mut self, position: f64, current: f64) -> Result<(), DriverError> {
        let mut world = lock(&self.0);
        Self::reachable(&world)?;
        assert!(position.is_finite() && current > 0.0, "{position} rad, {current} A");
        world.goal = world.spool.wound(position);
        Ok(())
    }

    fn torque(&mut self, on: bool) -> Result<(), DriverError> {
        let mut world = lock(&self.0);
        Self::reachable(&world)?;
        let age = world.age();
        if world.torque && !on {
            world.freed_at.get_or_insert(age);
        }
        world.torque = on;
        Ok(())
    }
}

/// Keeps events and steps.
pub(crate) struct Kept {
    pub(crate) world: Shared,
    pub(crate) events: Arc<Mutex<Vec<(f64, Event)>>>,
    pub(crate) steps: Arc<Mutex<Vec<Step>>>,
}

impl Sink for Kept {
    fn step(&mut self, step: &Step) {
        self.steps.lock().unwrap().push(*step);
    }

    fn event(&mut self, time: f64, _: u32, event: Event) {
        self.events.lock().unwrap().push((time, event));
    }

    fn lost(&self) -> bool {
        let world = lock(&self.world);
        world.fault == Fault::FullDisk && world.faulty()
    }
}
