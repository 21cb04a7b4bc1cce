//! The bench as a process: arm, motor and world in real time, ordered about line by line.
//!
//! # Lines
//! It writes one line when it is ready, and one for each line that it reads. All of them are JSON.
//!
//! | order | answer |
//! |---|---|
//! | (none: the start) | `{"ready": true, "motor": {"port", "id", "baud"}, "arm": {"rtde", "dashboard", "script", "realtime"}}`; `arm` is null without one |
//! | `state` | `{"time", "lost", "tool", "spool", "hand"}`, all SI; `hand` is null without one |
//! | `object SEED INDEX` | puts the object of this episode of evaluation there: `{"object", "palm"}`, the latter where the palm starts in the world, m |
//! | `object {"kind": …}` | puts this object there: the fields that an answer has |
//! | `fault arm TEXT`, `fault motor TEXT` | `{"ok": true}`; what there is: [`ur`](crate::ur), [`dynamixel`](crate::dynamixel) |
//! | `quit`, or the end of input | `{"ok": true}`, and the end |
//!
//! What cannot be done is answered by `{"error": "why"}`, and the bench goes on.

mod orders;
mod settings;
mod tell;

use std::io::{self, BufRead, Write};
use std::sync::mpsc::{self, TryRecvError};
use std::thread;
use std::time::{Duration, Instant};

use hwasp_drivers::Pose;
use serde_json::{Value, json};

pub use settings::{BenchError, BenchSettings, HandSettings};
pub use tell::object as object_text;

use crate::dynamixel::DynamixelEmulator;
use crate::hand::HandWorld;
use crate::ur::UrEmulator;
use crate::world::{FreeSpool, STEP, SpoolState, World};
use orders::{Device, Order};

/// Whether a fault can be ordered: one of `arm` or `motor`, such as `motor heat 80`.
///
/// # Errors
/// What faults there are.
pub fn check_fault(text: &str) -> Result<(), String> {
    orders::fault(text).map(drop)
}

/// How far the bench may be behind real time before it gives the time up: what spoke in the meantime shall not find its
/// watchdog tripped by a bench that hurries.
const PATIENCE: Duration = Duration::from_millis(10);

/// What stands behind the emulators.
#[derive(Debug)]
pub enum BenchWorld {
    /// A spool with nothing on it.
    Free(FreeSpool),
    /// The hand of a design.
    Hand(Box<HandWorld>),
}

/// A motor, an arm if there is one, and what is between them.
#[derive(Debug)]
pub struct Bench {
    arm: Option<UrEmulator>,
    motor: DynamixelEmulator,
    world: BenchWorld,
    spool: SpoolState,
    steps: u64,
    /// Given up, s.
    lost: f64,
}

impl Bench {
    /// A bench of these devices. Without an arm the tool stands at the origin of its base.
    pub fn new(arm: Option<UrEmulator>, motor: DynamixelEmulator, world: BenchWorld) -> Self {
        Self { arm, motor, world, spool: SpoolState::default(), steps: 0, lost: 0.0 }
    }

    fn tool(&self) -> Pose {
        self.arm.as_ref().map(UrEmulator::tool).unwrap_or_default()
    }

    /// Goes on by 1 ms.
    fn step(&mut self) {
        if let Some(arm) = &mut self.arm {
            arm.advance(STEP);
        }
        let (tool, drive) = (self.tool(), self.motor.drive());
        self.spool = match &mut self.world {
            BenchWorld::Free(spool) => spool.step(&tool, drive),
            BenchWorld::Hand(hand) => hand.step(&tool, drive),
        };
        self.motor.tell(self.spool);
        self.motor.advance(STEP);
        self.steps += 1;
    }

    fn ready(&self) -> Value {
        let (id, baud) = self.motor.identity();
        let arm = self.arm.as_ref().map(|arm| {
            let ports = arm.ports();
            json!({
                "rtde": ports.rtde, "dashboard": ports.dashboard, "script": ports.script, "realtime": ports.realtime
            })
        });
        json!({"ready": true, "motor": {"port": self.motor.path(), "id": id, "baud": baud}, "arm": arm})
    }

    /// Does what a line orders. Returns the answer, and whether that was all.
    fn obey(&mut self, line: &str) -> (Value, bool) {
        match orders::read(line).and_then(|order| self.follow(order)) {
            Ok(Some(answer)) => (answer, false),
            Ok(None) => (json!({"ok": true}), true),
            Err(error) => (json!({"error": error}), false),
        }
    }

    fn follow(&mut self, order: Order) -> Result<Option<Value>, String> {
        let done = Ok(Some(json!({"ok": true})));
        let no_hand = "there is no hand behind this bench, and so no object";
        match order {
            Order::State => {
                let hand = match &self.world {
                    BenchWorld::Free(_) => None,
                    BenchWorld::Hand(hand) => Some(tell::hand(&hand.look())),
                };
                Ok(Some(json!({
                    "time": STEP * self.steps as f64,
                    "lost": self.lost,
                    "tool": tell::pose(&self.tool()),
                    "spool": tell::spool(&self.spool),
                    "hand": hand,
                })))
            }
            Order::Fault(Device::Arm, text) => {
                self.arm.as_mut().ok_or("there is no arm on this bench")?.inject(&text)?;
                done
            }
            Order::Fault(Device::Motor, text) => {
                self.motor.inject(&text)?;
                done
            }
            Order::Draw(seed, index) => {
                let tool = self.tool();
                let BenchWorld::Hand(hand) = &mut self.world else { return Err(no_hand.into()) };
                let (object, palm) = hand.drawn(seed, index);
                let answer = json!({"object": tell::object(&object), "palm": palm});
                hand.put(object, &tool).map_err(|error| error.to_string())?;
                Ok(Some(answer))
            }
            Order::Put(object) => {
                let tool = self.tool();
                let BenchWorld::Hand(hand) = &mut self.world else { return Err(no_hand.into()) };
                hand.put(object, &tool).map_err(|error| error.to_string())?;
                done
            }
            Order::Quit => Ok(None),
        }
    }
}

/// Runs a bench in real time until it is told to quit, or until there is nobody left to tell it.
///
/// # Errors
/// Where answers cannot be written.
pub fn run_bench(mut bench: Bench, input: impl BufRead + Send + 'static, output: &mut impl Write) -> io::Result<()> {
    let mut say = |answer: &Value| {
        writeln!(output, "{answer}")?;
        output.flush()
    };
    // It waits for lines where the bench does not. It ends with the process, or with its input.
    let (send, lines) = mpsc::channel();
    thread::Builder::new().name("orders".into()).spawn(move || {
        for line in input.lines().map_while(Result::ok) {
            if send.send(line).is_err() {
                break;
            }
        }
    })?;
    say(&bench.ready())?;
    let (mut began, mut steps) = (Instant::now(), 0_u64);
    loop {
        match lines.try_recv() {
            Ok(line) => {
                let (answer, ends) = bench.obey(&line);
                say(&answer)?;
                if ends {
                    return Ok(());
                }
            }
            Err(TryRecvError::Empty) => {}
            Err(TryRecvError::Disconnected) => return Ok(()),
        }
        bench.step();
        steps += 1;
        let due = Duration::from_secs_f64(STEP * steps as f64);
        let past = began.elapsed();
        let late = past.saturating_sub(due);
        if late > PATIENCE {
            bench.lost += late.as_secs_f64();
            (began, steps) = (Instant::now(), 0);
        }
        thread::sleep(due.saturating_sub(past));
    }
}
