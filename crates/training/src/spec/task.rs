//! `[task]`: the problem and its physics.

use hwasp_core::Dimension;
use hwasp_tasks::hand::HandRange;
use serde::Serialize;

use super::grasp::GraspProblem;
use super::names::named;
use super::own::{OwnProblem, OwnTask, registered};
use super::quantity;
use super::section::Section;
use super::suggest::listed;

/// The most springs or bar segments of an experiment.
pub const MOST_SEGMENTS: usize = 10_000;

/// The longest episode, steps.
pub const MOST_STEPS: usize = 100_000;

named! {
    /// Which problem is to be solved.
    pub enum ProblemKind {
        /// Springs' stiffnesses, `stiffness`.
        Stiffness = "stiffness",
        /// Lengths of a bar's segments, `bar-length`.
        BarLength = "bar-length",
        /// The gear of a point on a rail, `reach`.
        Reach = "reach",
        /// The gear of a pendulum that has to be swung up, `pendulum`.
        Pendulum = "pendulum",
        /// An underactuated hand that moves up and down, `z-grasp`.
        ZGrasp = "z-grasp",
        /// The same hand, moving in space, `3d-grasp`.
        SpatialGrasp = "3d-grasp",
    }
}

named! {
    /// How the bar acts on the masses.
    pub enum InterfaceKind {
        /// By the forces of a softened interface.
        Soft = "soft",
        /// By its length.
        Rigid = "rigid",
    }
}

named! {
    /// How the reward passes from reaching the goal to sparing the motor.
    pub enum RewardKind {
        /// By a logistic function.
        Soft = "soft",
        /// At once.
        Hard = "hard",
    }
}

/// `[task]`.
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `problem` | required | `stiffness`, `bar-length`, `reach`, `pendulum`, `z-grasp`, `3d-grasp`, or [one of your own](own_mechanism.md) | |
/// | `horizon` | 1000 (reach: 30, pendulum: 200, grasps: 500) | steps of an episode | 1 to 100 000 |
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TaskSpec {
    /// Steps of an evaluation episode, and the most of a training one.
    pub horizon: usize,
    /// The problem with its own settings.
    #[serde(flatten)]
    pub problem: Problem,
}

/// A problem with the settings that it alone has.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "problem", rename_all = "kebab-case")]
pub enum Problem {
    /// The springs are the design.
    Stiffness(StiffnessProblem),
    /// The bar is the design.
    BarLength(BarProblem),
    /// The gear is the design.
    Reach(ReachProblem),
    /// The gear is the design; the rest is the classic problem, and there is nothing to set.
    Pendulum,
    /// The hand's transmission is the design; the palm moves up and down.
    ZGrasp(GraspProblem),
    /// The same, and the palm moves in space.
    #[serde(rename = "3d-grasp")]
    SpatialGrasp(GraspProblem),
    /// One that the program brings along; it writes its own name.
    #[serde(untagged)]
    Own(Box<OwnTask>),
}

/// What both mass-spring problems have.
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `segments` | 10 | springs or segments, n | 1 to 10 000 |
/// | `reward` | "soft" | `soft` or `hard` | |
/// | `effort_clip` | "none" | what the plant takes of each force of the law | 0.001 to 1000 N |
/// | `mass_1`, `mass_2` | "0.1 kg" | upper and lower mass | 0.001 to 100 kg |
/// | `goal` | "0.2 m" | where the lower mass has to be | 0 to 10 m |
/// | `motor_limit` | "5 N" | the motor pulls and pushes at most so much | 0.001 to 1000 N |
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MassSpringSpec {
    /// Springs or bar segments, n.
    pub segments: usize,
    /// How the reward switches.
    pub reward: RewardKind,
    /// The plant clips each force of the law to ± this, N (the authors' in-policy setting); none by default.
    #[serde(serialize_with = "quantity::newtons_or_none")]
    pub effort_clip: Option<f64>,
    /// Upper mass, kg.
    #[serde(serialize_with = "quantity::kilograms")]
    pub mass_1: f64,
    /// Lower mass, kg.
    #[serde(serialize_with = "quantity::kilograms")]
    pub mass_2: f64,
    /// Where the lower mass has to be, m below the ceiling.
    #[serde(serialize_with = "quantity::metres")]
    pub goal: f64,
    /// The motor's limit of either sign, N.
    #[serde(serialize_with = "quantity::newtons")]
    pub motor_limit: f64,
}

/// The springs are the design.
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `stiffness_total_max` | "100 N/m" | the most of all springs together | 0.001 to 1e6 N/m |
/// | `bar` | "0.1 m" | length of the bar | 0 to 10 m |
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StiffnessProblem {
    /// What both problems have.
    #[serde(flatten)]
    pub base: MassSpringSpec,
    /// The most of all springs together, N/m; one spring is in [0, this / n].
    #[serde(serialize_with = "quantity::newtons_per_metre")]
    pub stiffness_total_max: f64,
    /// Length of the bar between the masses, m.
    #[serde(serialize_with = "quantity::metres")]
    pub bar: f64,
}

/// The bar is the design.
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `interface` | "soft" | `soft` or `rigid` | |
/// | `length_total_max` | "0.5 m" | the most of all segments together | 0.001 to 10 m |
/// | `spring` | "20 N/m" | stiffness of the spring | 0.001 to 1e6 N/m |
/// | `interface_stiffness` | "200 N/m" | of the softened interface | 0.001 to 1e6 N/m |
/// | `interface_damping` | "10 N·s/m" | of the softened interface | 0 to 1e5 N·s/m |
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BarProblem {
    /// What both problems have.
    #[serde(flatten)]
    pub base: MassSpringSpec,
    /// How the bar acts on the masses.
    pub interface: InterfaceKind,
    /// The most of all segments together, m; one segment is in [0, this / n].
    #[serde(serialize_with = "quantity::metres")]
    pub length_total_max: f64,
    /// Stiffness of the spring, N/m.
    #[serde(serialize_with = "quantity::newtons_per_metre")]
    pub spring: f64,
    /// Stiffness of the softened interface, N/m.
    #[serde(serialize_with = "quantity::newtons_per_metre")]
    pub interface_stiffness: f64,
    /// Damping of the softened interface, N·s/m.
    #[serde(serialize_with = "quantity::newton_seconds_per_metre")]
    pub interface_damping: f64,
}

/// The gear of a point on a rail is the design. `goal` ("0.25 m"; -1 to 1 m) is all there is to set.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReachProblem {
    /// Where the point has to be, m.
    #[serde(serialize_with = "quantity::metres")]
    pub goal: f64,
}

/// A group of design parameters that a problem has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroupSpec {
    /// Its name: `stiffness`, `length`, `gear` or one of the hand's twelve.
    pub name: &'static str,
    /// The index of its first parameter in the design.
    pub first: usize,
    /// What it measures.
    pub dimension: Dimension,
    /// How many there are.
    pub count: usize,
    /// Lower limit of each, SI.
    pub lo: f64,
    /// Upper limit of each, SI.
    pub hi: f64,
}

/// What `task.problem` may name.
#[derive(Clone, Copy)]
enum Chosen {
    Kind(ProblemKind),
    Own(&'static OwnProblem),
}

impl TaskSpec {
    /// What experiments call the problem.
    pub fn name(&self) -> &'static str {
        let kind = match &self.problem {
            Problem::Stiffness(_) => ProblemKind::Stiffness,
            Problem::BarLength(_) => ProblemKind::BarLength,
            Problem::Reach(_) => ProblemKind::Reach,
            Problem::Pendulum => ProblemKind::Pendulum,
            Problem::ZGrasp(_) => ProblemKind::ZGrasp,
            Problem::SpatialGrasp(_) => ProblemKind::SpatialGrasp,
            Problem::Own(own) => return own.name(),
        };
        kind.name()
    }

    /// Numbers that the controller sees.
    pub fn observations(&self) -> usize {
        match &self.problem {
            Problem::Reach(_) => 1,
            Problem::Stiffness(_) | Problem::BarLength(_) => 2,
            Problem::Pendulum => 3,
            Problem::ZGrasp(_) | Problem::SpatialGrasp(_) => 11,
            Problem::Own(own) => own.env().observation.len(),
        }
    }

    /// How many commands the controller gives.
    pub fn commands(&self) -> usize {
        match &self.problem {
            Problem::Reach(_) | Problem::Stiffness(_) | Problem::BarLength(_) | Problem::Pendulum => 1,
            Problem::ZGrasp(_) => 2,
            Problem::SpatialGrasp(_) => 4,
            Problem::Own(own) => own.env().command.len(),
        }
    }

    /// What the law hands to the plant.
    pub fn effort_dimension(&self) -> Dimension {
        match &self.problem {
            Problem::Reach(_) => Dimension::Speed,
            Problem::Pendulum | Problem::ZGrasp(_) | Problem::SpatialGrasp(_) => Dimension::Torque,
            Problem::BarLength(bar) if bar.interface == InterfaceKind::Rigid => Dimension::Length,
            Problem::Own(own) => own.env().effort.first().map_or(Dimension::None, |port| port.dimension),
            _ => Dimension::Force,
        }
    }

    /// The design parameters, named and limited as the problem's law has them.
    pub fn groups(&self) -> Vec<GroupSpec> {
        let one = |name, dimension, count, lo, hi| vec![GroupSpec { name, first: 0, dimension, count, lo, hi }];
        match &self.problem {
            Problem::Stiffness(p) => {
                let hi = p.stiffness_total_max / p.base.segments as f64;
                one("stiffness", Dimension::Stiffness, p.base.segments, 0.0, hi)
            }
            Problem::BarLength(p) => {
                let hi = p.length_total_max / p.base.segments as f64;
                one("length", Dimension::Length, p.base.segments, 0.0, hi)
            }
            Problem::Reach(_) => one("gear", Dimension::None, 1, 0.1, 2.0),
            Problem::Pendulum => one("gear", Dimension::None, 1, 0.5, 2.0),
            Problem::ZGrasp(p) | Problem::SpatialGrasp(p) => HandRange::from(p.range)
                .parameters()
                .into_iter()
                .enumerate()
                .map(|(first, p)| GroupSpec {
                    name: p.name,
                    first,
                    dimension: p.dimension,
                    count: 1,
                    lo: p.limits.0,
                    hi: p.limits.1,
                })
                .collect(),
            Problem::Own(own) => own.groups(),
        }
    }

    /// Reads the table; what is wrong in it becomes the default. None where the problem itself is not known.
    pub(super) fn read(mut s: Section<'_>) -> Option<Self> {
        // Those of the program first: they are what it was made for.
        let own = registered().iter().map(|&own| (own.name(), Chosen::Own(own)));
        let choices: Vec<_> =
            own.chain(ProblemKind::ALL.iter().map(|&(name, kind)| (name, Chosen::Kind(kind)))).collect();
        if s.origin("problem").is_none() {
            let hint = format!("set `problem` in [task] to one of {}", listed(choices.iter().map(|(name, _)| *name)));
            s.clash("problem", "task.problem is missing".into(), &hint);
        }
        let kind = match s.choice("problem", &choices)? {
            Chosen::Kind(kind) => kind,
            Chosen::Own(own) => {
                let read = own.read(&mut s);
                s.finish();
                return read.map(|(horizon, own)| Self { horizon, problem: Problem::Own(Box::new(own)) });
            }
        };
        let usual = match kind {
            ProblemKind::Stiffness | ProblemKind::BarLength => 1000,
            ProblemKind::Reach => 30,
            ProblemKind::Pendulum => 200,
            ProblemKind::ZGrasp | ProblemKind::SpatialGrasp => 500,
        };
        let horizon = s.count("horizon", usual, 1..=MOST_STEPS);
        refuse_foreign(&mut s, kind);
        let problem = match kind {
            ProblemKind::Stiffness => Problem::Stiffness(StiffnessProblem {
                base: MassSpringSpec::read(&mut s),
                stiffness_total_max: s.quantity("stiffness_total_max", Dimension::Stiffness, 100.0, &(1e-3..=1e6)),
                bar: s.quantity("bar", Dimension::Length, 0.1, &(0.0..=10.0)),
            }),
            ProblemKind::BarLength => Problem::BarLength(BarProblem::read(&mut s)),
            ProblemKind::Reach => {
                Problem::Reach(ReachProblem { goal: s.quantity("goal", Dimension::Length, 0.25, &(-1.0..=1.0)) })
            }
            ProblemKind::Pendulum => Problem::Pendulum,
            ProblemKind::ZGrasp => Problem::ZGrasp(GraspProblem::read(&mut s, false)),
            ProblemKind::SpatialGrasp => Problem::SpatialGrasp(GraspProblem::read(&mut s, true)),
        };
        s.finish();
        Some(Self { horizon, problem })
    }
}

impl MassSpringSpec {
    fn read(s: &mut Section<'_>) -> Self {
        let mass = 1e-3..=100.0;
        let force = 1e-3..=1000.0;
        Self {
            segments: s.count("segments", 10, 1..=MOST_SEGMENTS),
            reward: s.choice("reward", RewardKind::ALL).unwrap_or(RewardKind::Soft),
            effort_clip: s.optional_quantity("effort_clip", Dimension::Force, 5.0, &force),
            mass_1: s.quantity("mass_1", Dimension::Mass, 0.1, &mass),
            mass_2: s.quantity("mass_2", Dimension::Mass, 0.1, &mass),
            goal: s.quantity("goal", Dimension::Length, 0.2, &(0.0..=10.0)),
            motor_limit: s.quantity("motor_limit", Dimension::Force, 5.0, &force),
        }
    }
}

impl BarProblem {
    fn read(s: &mut Section<'_>) -> Self {
        let stiffness = 1e-3..=1e6;
        let problem = Self {
            base: MassSpringSpec::read(s),
            interface: s.choice("interface", InterfaceKind::ALL).unwrap_or(InterfaceKind::Soft),
            length_total_max: s.quantity("length_total_max", Dimension::Length, 0.5, &(1e-3..=10.0)),
            spring: s.quantity("spring", Dimension::Stiffness, 20.0, &stiffness),
            interface_stiffness: s.quantity("interface_stiffness", Dimension::Stiffness, 200.0, &stiffness),
            interface_damping: s.quantity("interface_damping", Dimension::Damping, 10.0, &(0.0..=1e5)),
        };
        if problem.interface == InterfaceKind::Rigid && problem.base.effort_clip.is_some() {
            let message = "task.effort_clip limits forces, but the effort of a rigid interface is a length".into();
            s.clash("effort_clip", message, "leave effort_clip out, or set interface = \"soft\"");
        }
        problem
    }
}

/// Keys that some problem has, and this one has not.
fn refuse_foreign(s: &mut Section<'_>, kind: ProblemKind) {
    const SPRINGS: &[&str] = &["stiffness_total_max", "bar"];
    const BAR: &[&str] = &["interface", "length_total_max", "spring", "interface_stiffness", "interface_damping"];
    const BOTH: &[&str] = &["segments", "reward", "effort_clip", "mass_1", "mass_2", "motor_limit"];
    const GOAL: &[&str] = &["goal"];
    const GRASP: &[&str] = GraspProblem::KEYS;
    let foreign: &[(&[&'static str], &str)] = match kind {
        ProblemKind::Stiffness => &[(BAR, "bar-length"), (GRASP, "z-grasp or 3d-grasp")],
        ProblemKind::BarLength => &[(SPRINGS, "stiffness"), (GRASP, "z-grasp or 3d-grasp")],
        ProblemKind::Reach => &[
            (SPRINGS, "stiffness"),
            (BAR, "bar-length"),
            (BOTH, "stiffness or bar-length"),
            (GRASP, "z-grasp or 3d-grasp"),
        ],
        ProblemKind::Pendulum => &[
            (SPRINGS, "stiffness"),
            (BAR, "bar-length"),
            (BOTH, "stiffness or bar-length"),
            (GOAL, "stiffness, bar-length or reach"),
            (GRASP, "z-grasp or 3d-grasp"),
        ],
        ProblemKind::ZGrasp | ProblemKind::SpatialGrasp => &[
            (SPRINGS, "stiffness"),
            (BAR, "bar-length"),
            (BOTH, "stiffness or bar-length"),
            (GOAL, "stiffness, bar-length or reach"),
        ],
    };
    for (keys, owner) in foreign {
        for key in *keys {
            s.refuse(key, &format!("it is for problem = {owner}, and this is {kind}"));
        }
    }
}
