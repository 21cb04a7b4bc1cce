//! A dry run: the same loop over the emulated bench, a process of its own with the hand's physics behind it, and the objects of
//! held-out episodes.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use hwasp_emulators::bench::{BenchSettings, HandSettings, object_text};
use hwasp_emulators::hand::{Planted, held_out};
use hwasp_export::Deployed;
use hwasp_grasp::{Grasp, Object, settings_of};
use hwasp_tasks::grasp::GraspTaskSettings;
use serde_json::Value;

use crate::controller::hand;
use crate::error::{DeployError, file};
use crate::rig::Rig;
use crate::run::{Placed, Stage};

/// The process with the emulators.
#[derive(Debug)]
pub struct BenchProcess {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

fn wrong(what: impl std::fmt::Display) -> DeployError {
    DeployError::Bench { what: what.to_string() }
}

impl BenchProcess {
    /// Starts it by `command`, to which the path of its settings is added: `settings` is where they are written. Returns it with
    /// the rig that reaches it: that of `rig`, at the ports of the emulators. The hand differs from its description by `planted`.
    ///
    /// # Errors
    /// Where it does not start.
    pub fn start(
        mut command: Command,
        settings: &Path,
        deployed: &Deployed,
        rig: &Rig,
        planted: &Planted,
    ) -> Result<(Self, Rig), DeployError> {
        let text = serde_json::to_string(&bench_settings(deployed, rig, planted)?).map_err(wrong)?;
        std::fs::write(settings, text).map_err(file("written", settings))?;
        let mut child = command
            .arg(settings)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| wrong(format!("it does not start: {error}")))?;
        let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(wrong("it has no standard input or output"));
        };
        let mut process = Self { child, input, output: BufReader::new(output) };
        let ready = process.answer()?;
        let port = |name: &str| ready["arm"][name].as_u64().ok_or_else(|| wrong(format!("it tells no port {name}")));
        let mut reached = rig.clone();
        "127.0.0.1".clone_into(&mut reached.arm.host);
        (reached.arm.rtde_port, reached.arm.dashboard_port) = (port("rtde")?, port("dashboard")?);
        reached.arm.script_port = port("script")?;
        let motor = ready["motor"]["port"].as_str().ok_or_else(|| wrong("it tells no port of the motor"))?;
        reached.motor.port = motor.into();
        // What is emulated answers within a millisecond, at its own speed and number.
        (reached.motor.baud, reached.motor.id) = (1_000_000, 1);
        Ok((process, reached))
    }

    /// Gives an order, and returns the answer.
    ///
    /// # Errors
    /// What it says against it.
    pub fn order(&mut self, order: &str) -> Result<Value, DeployError> {
        writeln!(self.input, "{order}").and_then(|()| self.input.flush()).map_err(wrong)?;
        self.answer()
    }

    fn answer(&mut self) -> Result<Value, DeployError> {
        let mut line = String::new();
        let length = self.output.read_line(&mut line).map_err(wrong)?;
        if length == 0 {
            return Err(wrong("it has ended; what it said before stands above"));
        }
        let answer: Value = serde_json::from_str(&line).map_err(wrong)?;
        match answer["error"].as_str() {
            Some(error) => Err(wrong(error)),
            None => Ok(answer),
        }
    }
}

impl Drop for BenchProcess {
    fn drop(&mut self) {
        // It ends by itself with its input; one that does not is ended.
        let _ = writeln!(self.input, "quit");
        let _ = self.input.flush();
        for _ in 0..100 {
            if matches!(self.child.try_wait(), Ok(Some(_)) | Err(_)) {
                return;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The bench of a rig with the hand of a run.
fn bench_settings(deployed: &Deployed, rig: &Rig, planted: &Planted) -> Result<BenchSettings, DeployError> {
    let transmission = &hand(deployed.spec())?.transmission;
    let design = deployed.design().try_into().map_err(|_| wrong("the design is none of a hand"))?;
    let &Planted { torque_gain, tendon_stiffness, friction, slack, delay, zero } = planted;
    Ok(BenchSettings {
        arm: Some(if rig.arm.rate > 125.0 { "e-series" } else { "cb3" }.to_owned()),
        hand: Some(HandSettings {
            design,
            tension_limit: Some(transmission.tension_limit),
            // The base in the world: what the world is in the base, the other way round.
            base_position: rig.frame().place(&hwasp_drivers::Pose::default()),
            base_rotation: rig.world.rotation.map(|r| -r),
            palm: [0.0; 3],
            compliant: false,
            torque_gain,
            tendon_stiffness: Some(tendon_stiffness.unwrap_or(transmission.tendon_stiffness)),
            friction,
            slack,
            delay,
            zero,
        }),
        ..BenchSettings::default()
    })
}

/// Draws the objects of held-out episodes, as `hwasp eval` has them: by seed and index.
pub struct HeldOut {
    grasp: Grasp,
    seed: u64,
}

impl HeldOut {
    /// Of a run.
    ///
    /// # Errors
    /// Where it has no grasps.
    pub fn new(deployed: &Deployed, seed: Option<u64>) -> Result<Self, DeployError> {
        let spec = deployed.spec();
        let no_hand = || DeployError::NoHand { problem: spec.task.name().to_owned() };
        let settings = spec.task.settings::<GraspTaskSettings>().ok_or_else(no_hand)?;
        let grasp = Grasp::new(settings_of(settings)).map_err(wrong)?;
        Ok(Self { grasp, seed: seed.unwrap_or(spec.train.evaluation_seed) })
    }

    /// The object of an episode, and where the palm starts above it, m.
    pub fn draw(&self, index: u64) -> (Object, [f64; 3]) {
        held_out(&self.grasp, self.seed, index)
    }
}

/// Puts held-out objects onto the emulated bench, and looks at them.
pub struct DryStage {
    bench: Arc<Mutex<BenchProcess>>,
    held_out: HeldOut,
    /// Ordered once, so long after the first object was placed.
    fault: Option<(Duration, String)>,
}

impl DryStage {
    /// On this bench.
    pub fn new(bench: BenchProcess, held_out: HeldOut) -> Self {
        Self { bench: Arc::new(Mutex::new(bench)), held_out, fault: None }
    }

    /// Orders a fault of arm or motor, such as `motor heat 80`, so long after the first object is there.
    #[must_use]
    pub fn with_fault(self, after: Duration, fault: &str) -> Self {
        Self { fault: Some((after, format!("fault {fault}"))), ..self }
    }

    fn order(&self, order: &str) -> Result<Value, DeployError> {
        self.bench.lock().unwrap_or_else(PoisonError::into_inner).order(order)
    }
}

impl Stage for DryStage {
    fn place(&mut self, episode: u32) -> Result<Placed, DeployError> {
        let (object, palm) = self.held_out.draw(u64::from(episode));
        let size = object.bounding_box();
        let [x, y] = object.place;
        let shape = Some(object.kind);
        self.order(&format!("object {}", object_text(&object)))?;
        if let Some((after, fault)) = self.fault.take() {
            let bench = Arc::clone(&self.bench);
            std::thread::spawn(move || {
                std::thread::sleep(after);
                // What the bench says against it shows in a run that goes on as if nothing were.
                if let Err(error) = bench.lock().unwrap_or_else(PoisonError::into_inner).order(&fault) {
                    tracing::error!("{error}");
                }
            });
        }
        Ok(Placed { size, place: [x, y, 0.5 * size[2]], shape, start: Some(palm) })
    }

    fn held(&mut self, _: u32) -> Result<Option<bool>, DeployError> {
        let state = self.order("state")?;
        if let Some(fault) = state["hand"]["fault"].as_str() {
            return Err(wrong(format!("its physics broke down: {fault}")));
        }
        Ok(state["hand"]["success"].as_bool())
    }
}
