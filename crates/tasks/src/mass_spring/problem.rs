//! Both mass-spring problems as experiment files name them.

use hwasp_core::Dimension;
use hwasp_problem::{AnyError, Built, Preset, Problem, Role, Words, World};
use hwasp_settings::{Fields, Settings, choice};

use super::{Interface, MassSpring, MassSpringSettings};

/// The most springs or bar segments of an experiment.
const MOST_SEGMENTS: usize = 10_000;

choice! {
    /// How the reward passes from reaching the goal to sparing the motor.
    pub enum RewardKind {
        /// By a logistic function.
        Soft = "soft",
        /// At once.
        Hard = "hard",
    }
}

choice! {
    /// How the bar acts on the masses.
    pub enum InterfaceKind {
        /// By the forces of a softened interface.
        Soft = "soft",
        /// By its length.
        Rigid = "rigid",
    }
}

/// What both mass-spring problems have in `[task]`.
#[derive(Clone, Debug, PartialEq)]
pub struct MassSpringBase {
    /// Springs or bar segments, n.
    pub segments: usize,
    /// How the reward switches.
    pub reward: RewardKind,
    /// The plant clips each force of the law to ± this, N (the authors' in-policy setting); none by default.
    pub effort_clip: Option<f64>,
    /// Upper mass, kg.
    pub mass_1: f64,
    /// Lower mass, kg.
    pub mass_2: f64,
    /// Where the lower mass has to be, m below the ceiling.
    pub goal: f64,
    /// The motor's limit of either sign, N.
    pub motor_limit: f64,
}

impl Default for MassSpringBase {
    fn default() -> Self {
        let paper = MassSpringSettings::default();
        Self {
            segments: paper.count,
            reward: RewardKind::Soft,
            effort_clip: None,
            mass_1: paper.upper_mass,
            mass_2: paper.lower_mass,
            goal: paper.goal,
            motor_limit: paper.max_current * paper.torque_constant / paper.shaft_radius,
        }
    }
}

impl MassSpringBase {
    fn settings(&self) -> MassSpringSettings {
        let paper = MassSpringSettings::default();
        // The experiment names the force; the motor's constants stay and its current gives it.
        let max_current = self.motor_limit * paper.shaft_radius / paper.torque_constant;
        let settings = MassSpringSettings {
            count: self.segments,
            upper_mass: self.mass_1,
            lower_mass: self.mass_2,
            goal: self.goal,
            max_current,
            effort_limit: self.effort_clip,
            ..paper
        };
        match self.reward {
            RewardKind::Soft => settings,
            RewardKind::Hard => settings.with_hard_reward(),
        }
    }
}

impl Settings for MassSpringBase {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        let (mass, force) = (1e-3..=100.0, 1e-3..=1000.0);
        fields.count("segments", &mut self.segments, 1..=MOST_SEGMENTS, "springs or segments, n");
        fields.choice("reward", &mut self.reward, "how it passes from reaching the goal to sparing the motor");
        let about = "what the plant takes of each force of the law";
        fields.optional_quantity("effort_clip", &mut self.effort_clip, (Dimension::Force, 5.0), force.clone(), about);
        fields.quantity("mass_1", &mut self.mass_1, Dimension::Mass, mass.clone(), "upper mass");
        fields.quantity("mass_2", &mut self.mass_2, Dimension::Mass, mass, "lower mass");
        fields.quantity("goal", &mut self.goal, Dimension::Length, 0.0..=10.0, "where the lower mass has to be");
        let about = "the motor pulls and pushes at most so much";
        fields.quantity("motor_limit", &mut self.motor_limit, Dimension::Force, force, about);
    }
}

fn built(training: &MassSpring, deployment: &MassSpring, words: Words) -> Built {
    let world = |problem: &MassSpring| World::new(problem.law(), problem.clone());
    Built { optimum: vec![Some(deployment.optimum())], words, ..Built::of(world(training), world(deployment)) }
}

fn words(about: String) -> Words {
    let seen = [("y1", "the upper mass below the ceiling"), ("v1", "speed of the upper mass, downwards")];
    let read =
        [seen[0], seen[1], ("y2", "the lower mass below the ceiling"), ("v2", "speed of the lower mass, downwards")];
    let done = [
        ("effort", "springs and motor together on both masses, downwards"),
        ("length", "length of the bar between the masses"),
        ("interface1", "the bar's pull on the upper mass, downwards"),
        ("interface2", "the same on the lower mass"),
    ];
    Words::about(about)
        .with(Role::Observation, &seen)
        .with(Role::State, &read)
        .with(Role::Command, &[("motor", "pull of the motor's string, downwards")])
        .with(Role::Effort, &done)
}

/// `stiffness`: parallel springs are the design.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stiffness;

/// What [`Stiffness`] has in `[task]`.
#[derive(Clone, Debug, PartialEq)]
pub struct StiffnessTask {
    /// What both problems have.
    pub base: MassSpringBase,
    /// The most of all springs together, N/m; one spring is in [0, this / n].
    pub stiffness_total_max: f64,
    /// Length of the bar between the masses, m.
    pub bar: f64,
}

impl Settings for StiffnessTask {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        self.base.fields(fields);
        let about = "the most of all springs together; one of them has at most its share";
        fields.quantity("stiffness_total_max", &mut self.stiffness_total_max, Dimension::Stiffness, 1e-3..=1e6, about);
        fields.quantity("bar", &mut self.bar, Dimension::Length, 0.0..=10.0, "length of the bar");
    }
}

impl Problem for Stiffness {
    type Settings = StiffnessTask;

    fn name(&self) -> &'static str {
        "stiffness"
    }

    fn defaults(&self) -> StiffnessTask {
        let MassSpringSettings { max_total_stiffness, bar_length, .. } = MassSpringSettings::default();
        let base = MassSpringBase::default();
        StiffnessTask { base, stiffness_total_max: max_total_stiffness, bar: bar_length }
    }

    fn build(&self, task: &StiffnessTask) -> Result<Built, AnyError> {
        let settings = MassSpringSettings {
            max_total_stiffness: task.stiffness_total_max,
            bar_length: task.bar,
            ..task.base.settings()
        };
        let deployment = MassSpring::stiffness(MassSpringSettings { effort_limit: None, ..settings.clone() })?;
        let words = words(format!(
            "Two masses hang under {} parallel springs, and a motor pulls. The lower mass has to be brought to a height and held \
             there with as little motor as possible. The stiffness of each spring is the design.",
            task.base.segments
        ));
        Ok(built(&MassSpring::stiffness(settings)?, &deployment, words))
    }

    fn presets(&self) -> Vec<Preset> {
        vec![
            Preset::new("mass-spring", include_str!("../../../../experiments/mass-spring.toml")),
            Preset::new("mass-spring-50", include_str!("../../../../experiments/mass-spring-50.toml")),
            Preset::new("mass-spring-td3", include_str!("../../../../experiments/mass-spring-td3.toml")),
            Preset::new("paper/mass-spring", include_str!("../../../../experiments/paper/mass-spring.toml")),
            Preset::new("paper/mass-spring-50", include_str!("../../../../experiments/paper/mass-spring-50.toml")),
        ]
    }
}

/// `bar-length`: a bar of segments is the design.
#[derive(Clone, Copy, Debug, Default)]
pub struct BarLength;

/// What [`BarLength`] has in `[task]`.
#[derive(Clone, Debug, PartialEq)]
pub struct BarLengthTask {
    /// What both problems have.
    pub base: MassSpringBase,
    /// How the bar acts on the masses in training.
    pub interface: InterfaceKind,
    /// The most of all segments together, m; one segment is in [0, this / n].
    pub length_total_max: f64,
    /// Stiffness of the spring, N/m.
    pub spring: f64,
    /// Stiffness of the softened interface, N/m.
    pub interface_stiffness: f64,
    /// Damping of the softened interface, N·s/m.
    pub interface_damping: f64,
}

impl Settings for BarLengthTask {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        let stiffness = || 1e-3..=1e6;
        self.base.fields(fields);
        fields.choice("interface", &mut self.interface, "how the bar acts on the masses in training");
        let about = "the most of all segments together; one of them has at most its share";
        fields.quantity("length_total_max", &mut self.length_total_max, Dimension::Length, 1e-3..=10.0, about);
        fields.quantity("spring", &mut self.spring, Dimension::Stiffness, stiffness(), "stiffness of the spring");
        let about = "of the softened interface";
        let softness = &mut self.interface_stiffness;
        fields.quantity("interface_stiffness", softness, Dimension::Stiffness, stiffness(), about);
        fields.quantity("interface_damping", &mut self.interface_damping, Dimension::Damping, 0.0..=1e5, about);
        let clipped = self.interface == InterfaceKind::Rigid && self.base.effort_clip.is_some();
        fields.check("effort_clip", !clipped, || {
            (
                "task.effort_clip limits forces, but the effort of a rigid interface is a length".into(),
                "leave effort_clip out, or set interface = \"soft\"".into(),
            )
        });
    }
}

impl Problem for BarLength {
    type Settings = BarLengthTask;

    fn name(&self) -> &'static str {
        "bar-length"
    }

    fn defaults(&self) -> BarLengthTask {
        let paper = MassSpringSettings::default();
        BarLengthTask {
            base: MassSpringBase::default(),
            interface: InterfaceKind::Soft,
            length_total_max: paper.max_total_length,
            spring: paper.spring_stiffness,
            interface_stiffness: paper.interface_stiffness,
            interface_damping: paper.interface_damping,
        }
    }

    fn build(&self, task: &BarLengthTask) -> Result<Built, AnyError> {
        let settings = MassSpringSettings {
            max_total_length: task.length_total_max,
            spring_stiffness: task.spring,
            interface_stiffness: task.interface_stiffness,
            interface_damping: task.interface_damping,
            ..task.base.settings()
        };
        let interface = match task.interface {
            InterfaceKind::Soft => Interface::Soft,
            InterfaceKind::Rigid => Interface::Rigid,
        };
        // The bar that is built is rigid and nothing clips its forces.
        let deployment = MassSpringSettings { effort_limit: None, ..settings.clone() };
        let words = words(format!(
            "Two masses hang under a spring, a bar of {} segments between them, and a motor pulls. The lower mass has to be \
             brought to a height and held there with as little motor as possible. The length of each segment is the design.",
            task.base.segments
        ));
        Ok(built(&MassSpring::bar(settings, interface)?, &MassSpring::bar(deployment, Interface::Rigid)?, words))
    }

    fn presets(&self) -> Vec<Preset> {
        vec![
            Preset::new("bar-length", include_str!("../../../../experiments/bar-length.toml")),
            Preset::new("bar-length-50", include_str!("../../../../experiments/bar-length-50.toml")),
            Preset::new("bar-length-td3", include_str!("../../../../experiments/bar-length-td3.toml")),
            Preset::new("paper/bar-length", include_str!("../../../../experiments/paper/bar-length.toml")),
            Preset::new("paper/bar-length-50", include_str!("../../../../experiments/paper/bar-length-50.toml")),
        ]
    }
}
