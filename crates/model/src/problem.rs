//! The problem `model`: any robot, from a file.

use std::any::Any;
use std::sync::Arc;

use hwasp_problem::{
    AnyError, Built, Changed, FaultsTold, Mechanism, ModelFile, ModelFormat, Preset, Problem, Role, StandIn,
    StandInKind, Words, World,
};
use hwasp_settings::Folder;

use crate::environment::ModelEnvironments;
use crate::manual::manual;
use crate::robot::Robot;
use crate::settings::ModelSettings;

/// A problem from a model and formulas.
#[derive(Clone, Copy, Debug)]
pub struct ModelProblem;

impl Problem for ModelProblem {
    type Settings = ModelSettings;

    fn name(&self) -> &'static str {
        "model"
    }

    fn defaults(&self) -> ModelSettings {
        ModelSettings::default()
    }

    fn presets(&self) -> Vec<Preset> {
        vec![
            Preset::new("balanced-arm", include_str!("../../../experiments/balanced-arm.toml"))
                .with_files(&[("robots/arm.xml", include_str!("../../../experiments/robots/arm.xml"))]),
            Preset::new("five-bar", include_str!("../../../experiments/five-bar.toml"))
                .with_files(&[("robots/five_bar.xml", include_str!("../../../experiments/robots/five_bar.xml"))]),
            Preset::new("hopper", include_str!("../../../experiments/hopper.toml"))
                .with_files(&[("robots/hopper.xml", include_str!("../../../experiments/robots/hopper.xml"))]),
            Preset::new("tendon-gripper", include_str!("../../../experiments/tendon-gripper.toml"))
                .with_files(&[("robots/gripper.xml", include_str!("../../../experiments/robots/gripper.xml"))]),
        ]
    }

    fn begin(&self, folder: &Folder, file: &str, name: &str) -> Option<Result<String, AnyError>> {
        Some(crate::begin::begin(folder, file, name))
    }

    fn build(&self, settings: &ModelSettings) -> Result<Built, AnyError> {
        let Some(robot) = &settings.robot else { return Err(FaultsTold.into()) };
        let world = |own_law| {
            let environments = ModelEnvironments { robot: Arc::clone(robot), own_law };
            World::described(robot.law.clone(), robot.env.clone(), Arc::new(environments))
        };
        let mut built = Built::of(world(false), world(false));
        if !robot.env.effort.is_empty() {
            let fast = world(true);
            let make = Arc::new(move |_: &[f64]| Ok(fast.clone()));
            built.stand_in = Some(StandIn { kind: StandInKind::FastLaw, make });
        }
        built.mechanism = Some(Arc::new(Model(Arc::clone(robot))));
        built.files = Arc::clone(&settings.files);
        built.effort_std = effort_std(robot);
        built.words = words(settings, robot);
        built.manual = manual(settings, robot);
        Ok(built)
    }
}

/// What the robot is, what the parameters of its design do, the terms of the reward and what ends an episode.
fn words(settings: &ModelSettings, robot: &Robot) -> Words {
    let names = robot.law.design().names();
    let design: Vec<(String, String)> = names.into_iter().zip(robot.uses.iter().cloned()).collect();
    let ports = |role, of: Vec<(String, String)>| of.into_iter().map(move |(name, meaning)| (role, name, meaning));
    let purpose = ports(Role::Reward, settings.reward.clone()).chain(ports(Role::End, settings.ends.clone()));
    let ports = ports(Role::Design, design).chain(purpose).collect();
    Words { about: about(settings, robot), ports }
}

/// The robot, its purpose and what of it is designed.
fn about(settings: &ModelSettings, robot: &Robot) -> String {
    let inventory = robot.simulation().inventory();
    let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    let mut parts = vec![count(inventory.joints.len(), "joint"), count(inventory.actuators.len(), "actuator")];
    parts.extend((!inventory.tendons.is_empty()).then(|| count(inventory.tendons.len(), "tendon")));
    let mass = inventory.bodies.first().map_or(0.0, |world| world.subtree_mass);
    let design: Vec<&str> = settings.design.iter().map(|parameter| &*parameter.name).collect();
    let shaping = match &robot.env.shaped_by[..] {
        [] => String::new(),
        shaping => format!(" The model is made from {}.", listed(shaping.iter().map(String::as_str))),
    };
    format!(
        "The robot is {}: {}, {:.3} kg as the design begins. The reward is the sum of {}. {}{shaping}",
        settings.model,
        parts.join(", "),
        mass,
        listed(robot.env.terms.iter().map(String::as_str)),
        if design.is_empty() { "Nothing is designed.".to_owned() } else { format!("Designed: {}.", listed(design)) },
    )
}

/// Names in a sentence: `a, b and c`.
fn listed<'n>(names: impl IntoIterator<Item = &'n str>) -> String {
    let names: Vec<&str> = names.into_iter().collect();
    match &names[..] {
        [] => String::new(),
        [only] => (*only).to_owned(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// The share of what commands can do to an effort that it is explored by, as commands are by a share of their range.
const EXPLORED: f64 = 0.15;

/// How far the commands move each effort of the law in the middle of the design, at rest, times [`EXPLORED`]; where they do not
/// move it, how far the parameters of the design do; none where neither does.
fn effort_std(robot: &Robot) -> Vec<Option<f64>> {
    let (space, ports) = (robot.law.design(), &robot.env.command);
    let design = space.middle();
    let middle: Vec<f64> = ports.iter().map(|port| 0.5 * (port.lo + port.hi)).collect();
    let state = vec![0.0; robot.states.len()];
    let count = robot.env.effort.len();
    let mut effort = vec![0.0; count];
    let mut widen = |ranges: &mut [[f64; 2]], design: &[f64], command: &[f64]| {
        robot.law.effort(design, command, &state, &mut effort);
        for (range, &effort) in ranges.iter_mut().zip(&effort) {
            *range = [range[0].min(effort), range[1].max(effort)];
        }
    };
    let nowhere = [f64::INFINITY, f64::NEG_INFINITY];
    let (mut commanded, mut designed) = (vec![nowhere; count], vec![nowhere; count]);
    for (i, port) in ports.iter().enumerate() {
        for end in [port.lo, port.hi] {
            let mut command = middle.clone();
            command[i] = end;
            widen(&mut commanded, &design, &command);
        }
    }
    for i in 0..space.len() {
        let (low, high) = space.bounds(i);
        for end in [low, high] {
            let mut design = design.clone();
            design[i] = end;
            widen(&mut designed, &design, &middle);
        }
    }
    let spread = |[low, high]: [f64; 2]| Some(EXPLORED * (high - low)).filter(|std| (1e-6..=1e4).contains(std));
    commanded
        .into_iter()
        .zip(designed)
        .map(|(commanded, designed)| spread(commanded).or_else(|| spread(designed)))
        .collect()
}

/// The model as what is built.
#[derive(Debug)]
struct Model(Arc<Robot>);

impl Mechanism for Model {
    fn as_any(&self) -> &dyn Any {
        self
    }

    fn formats(&self) -> Vec<ModelFormat> {
        vec![ModelFormat::Mjcf]
    }

    fn changes(&self, before: &[f64], after: &[f64]) -> Result<Vec<Changed>, AnyError> {
        crate::changes::changes(&self.0, before, after)
    }

    fn doubts(&self) -> Vec<String> {
        crate::held::doubts(&self.0)
    }

    /// The model with the design, and the files that it refers to.
    fn write(&self, format: ModelFormat, design: &[f64]) -> Result<Vec<ModelFile>, AnyError> {
        if format != ModelFormat::Mjcf {
            return Err("a model is written as MJCF".into());
        }
        let robot = &self.0;
        let mut making = robot.additions.spec(&robot.main, &robot.files)?;
        if let Some(shaping) = &robot.shaping {
            let columns = crate::corners::columns(robot, design, 0.0, 1.0);
            for (field, value) in shaping.fields.iter().zip(shaping.formula.run(design, &columns)) {
                making.set(field, value)?;
            }
        }
        let text = making.to_mjcf()?;
        let assets = || {
            robot.files.iter().filter(|(path, _)| {
                let ending = path.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
                !matches!(ending.as_str(), "xml" | "urdf" | "mjcf")
            })
        };
        // The model looks for its files from where it lies. Its own folder goes without saying, unless a file lies elsewhere.
        let folder = robot.main.rfind('/').map_or("", |end| &robot.main[..=end]);
        let dropped = if assets().all(|(path, _)| path.starts_with(folder)) { folder.len() } else { 0 };
        let main = ModelFile { name: format!("{}robot.xml", &folder[dropped..]), contents: text.into_bytes() };
        let assets =
            assets().map(|(path, bytes)| ModelFile { name: path[dropped..].to_owned(), contents: bytes.to_vec() });
        Ok(std::iter::once(main).chain(assets).collect())
    }
}
