//! The grasping problems as experiment files name them.

use std::sync::Arc;

use hwasp_core::{Law, MakeEnvironment};
use hwasp_problem::{AnyError, Built, Preset, Problem, Role, StandIn, StandInKind, Words, World};

use super::env::env_spec;
use super::manual::manual;
use super::rules::{HORIZON, PALM_STEP};
use super::{GraspTaskSettings, ObjectSensed, TravelSensed, Viewpoint};
use crate::hand::{DESIGN_LEN, PalmMotion, TendonHand, names};

/// Which environments of a grasping problem are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scene {
    /// With the aids to training that the settings ask for.
    Training,
    /// Without.
    Deployment,
    /// On the hand with the engine's own tendons, springs and pulleys of this design (SI).
    Native([f64; DESIGN_LEN]),
}

/// Makes environments in an engine.
pub type Engine = fn(&GraspTaskSettings, Scene) -> Result<Arc<dyn MakeEnvironment>, AnyError>;

/// `z-grasp` or `3d-grasp`: the hand's transmission is the design. Without an engine it can be read, drawn and exported, and
/// says of its worlds that they need one.
#[derive(Clone, Copy, Debug)]
pub struct GraspProblem {
    palm: PalmMotion,
    engine: Option<Engine>,
}

impl GraspProblem {
    /// `z-grasp`: the palm moves up and down.
    pub fn vertical(engine: Option<Engine>) -> Self {
        Self { palm: PalmMotion::Vertical, engine }
    }

    /// `3d-grasp`: the palm moves in space.
    pub fn spatial(engine: Option<Engine>) -> Self {
        Self { palm: PalmMotion::Spatial, engine }
    }
}

/// The physics of a scene, once they are asked for.
fn world(problem: GraspProblem, law: &Law, task: &GraspTaskSettings, scene: Scene) -> World {
    let name = Problem::name(&problem).to_owned();
    let (task, env) =
        (task.clone(), env_spec(&task.hand(), problem.palm, task.bench.travel_sensed, PALM_STEP, HORIZON));
    World::later(law.clone(), env, move || {
        match problem.engine {
        Some(engine) => engine(&task, scene),
        None => Err(format!(
            "{name} needs the MuJoCo engine, and this program was built without it: build it with the feature \"mujoco\""
        )
        .into()),
    }
    })
}

impl Problem for GraspProblem {
    type Settings = GraspTaskSettings;

    fn name(&self) -> &'static str {
        match self.palm {
            PalmMotion::Vertical => "z-grasp",
            PalmMotion::Spatial => "3d-grasp",
        }
    }

    fn defaults(&self) -> GraspTaskSettings {
        GraspTaskSettings::new(self.palm)
    }

    fn build(&self, task: &GraspTaskSettings) -> Result<Built, AnyError> {
        let problem = *self;
        let law = Law::new(TendonHand::new(&task.hand().transmission, &task.law())?);
        let scene = |scene| world(problem, &law, task, scene);
        let (training, deployment) = (scene(Scene::Training), scene(Scene::Deployment));
        let (own, native_law) = (task.clone(), law.clone());
        let stand_in = move |design: &[f64]| {
            let wanted = design.len();
            let design = design.try_into().map_err(|_| format!("a hand has {DESIGN_LEN} parameters, not {wanted}"))?;
            Ok(world(problem, &native_law, &own, Scene::Native(design)))
        };
        Ok(Built {
            effort_std: vec![Some(0.02); training.env.effort.len()],
            words: words(task),
            manual: manual(task),
            mechanism: Some(Arc::new(task.hand())),
            stand_in: Some(StandIn { kind: StandInKind::NativeTendons, make: Arc::new(stand_in) }),
            ..Built::of(training, deployment)
        })
    }

    fn presets(&self) -> Vec<Preset> {
        match self.palm {
            PalmMotion::Vertical => vec![
                Preset::new("z-grasp", include_str!("../../../../experiments/z-grasp.toml")),
                Preset::new("z-grasp-60n", include_str!("../../../../experiments/z-grasp-60n.toml")),
                Preset::new("z-grasp-bench", include_str!("../../../../experiments/z-grasp-bench.toml")),
                Preset::new("3d-grasp-hold", include_str!("../../../../experiments/3d-grasp-hold.toml")),
            ],
            PalmMotion::Spatial => vec![
                Preset::new("3d-grasp", include_str!("../../../../experiments/3d-grasp.toml")),
                Preset::new("3d-grasp-way", include_str!("../../../../experiments/3d-grasp-way.toml")),
                Preset::new("3d-grasp-join", include_str!("../../../../experiments/3d-grasp-join.toml")),
                Preset::new("3d-approach", include_str!("../../../../experiments/3d-approach.toml")),
                Preset::new("3d-grasp-bench", include_str!("../../../../experiments/3d-grasp-bench.toml")),
            ],
        }
    }
}

fn words(task: &GraspTaskSettings) -> Words {
    let motion = match task.palm {
        PalmMotion::Vertical => "up and down",
        PalmMotion::Spatial => "in space",
    };
    let place = match (task.viewpoint, task.bench.object_sensed) {
        (Viewpoint::World, ObjectSensed::Tracked) => "the object's centre in the world",
        (Viewpoint::World, ObjectSensed::Carried) => {
            "the object's centre in the world: where it was at the start, and with the palm once the grasp is felt"
        }
        (Viewpoint::World, ObjectSensed::Fixed) => "the object's centre in the world at the start",
        (Viewpoint::Palm, ObjectSensed::Tracked) => "the object's centre from the palm",
        (Viewpoint::Palm, ObjectSensed::Carried) => {
            "the object's centre from the palm: from where it was at the start, and unchanged once the grasp is felt"
        }
        (Viewpoint::Palm, ObjectSensed::Fixed) => "from the palm to where the object's centre was at the start",
    };
    let wound = match task.bench.travel_sensed {
        TravelSensed::Commanded => "tendon wound so far, the sum of the commands",
        TravelSensed::Encoder | TravelSensed::Both => "tendon on the spool, by the motor's encoder",
    };
    let axes = |name: &str, meaning: &'static str| ["x", "y", "z"].map(|axis| (format!("{name}_{axis}"), meaning));
    let mut seen = Vec::new();
    seen.extend(axes("palm", "the palm in the world, z upwards from the floor"));
    seen.extend(axes("object", place));
    seen.extend(axes("size", "the object's bounding box as it lies at the start"));
    seen.push(("motor_travel".to_owned(), wound));
    seen.push(("motor_torque".to_owned(), "torque of the motor in the last period"));
    if task.bench.travel_sensed == TravelSensed::Both {
        seen.push(("motor_travel_target".to_owned(), "tendon to be on the spool, the sum of the commands"));
    }
    let of_joints = |what: &str, meaning: &'static str| names::JOINTS.map(|joint| (format!("{joint}_{what}"), meaning));
    let mut read = vec![("motor_travel".to_owned(), "tendon wound so far")];
    read.extend(of_joints("angle", "angle of the joint, 0 open, closing"));
    let mut given = axes("palm", "motion of the palm's target in this period").to_vec();
    given.push(("motor".to_owned(), "tendon to wind in this period"));
    let mut done = of_joints("torque", "torque about the joint, closing").to_vec();
    done.push(("motor_torque".to_owned(), "torque of the motor"));
    let about = format!(
        "One motor winds three tendons, which close a thumb and two fingers of two links each against springs in the joints; the \
         palm moves {motion}. The hand has to come down to an object, grasp it and lift it. Pulley radius, spring stiffness and \
         spring preload at four kinds of joints are the design; the two fingers share theirs."
    );
    let roles = [(Role::Observation, seen), (Role::State, read), (Role::Command, given), (Role::Effort, done)];
    roles.into_iter().fold(Words::about(about), |words, (role, ports)| {
        let ports: Vec<(&str, &str)> = ports.iter().map(|(name, meaning)| (name.as_str(), *meaning)).collect();
        words.with(role, &ports)
    })
}
