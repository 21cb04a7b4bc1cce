//! The checker lets a sound environment pass, and names each fault of a broken one.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use hwasp_core::{
    CommandPort, DesignGroup, DesignSpace, Dimension, End, EnvFault, EnvSpec, Environment, Hardware, Initial, Law,
    Port, Ports, Step, Stream, check_env,
};
use hwasp_diff::Scalar;
use rand::RngExt;

/// A motor with a gear.
struct Gear(DesignSpace);

impl Hardware for Gear {
    fn design(&self) -> &DesignSpace {
        &self.0
    }
    fn ports(&self) -> Ports {
        Ports { command: vec!["motor".into()], state: vec!["x".into()], effort: vec!["force".into()] }
    }
    fn effort<T: Scalar>(&self, design: &[T], command: &[T], _state: &[T], effort: &mut [T]) {
        effort[0] = command[0] * design[0];
    }
}

fn law() -> Law {
    let group = DesignGroup {
        name: "gear".into(),
        dimension: Dimension::None,
        lo: 0.1,
        hi: 2.0,
        count: 1,
        initial: Initial::Value(1.0),
    };
    Law::new(Gear(DesignSpace::new(vec![group]).expect("one group with sane limits")))
}

/// One way of being wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Wrong {
    Nothing,
    Unnamed,
    Twice,
    NoObservation,
    Limits,
    ZeroHorizon,
    Timeless,
    OtherEffort,
    NanReward,
    Unwritten,
    OwnGenerator,
    FixedStart,
    Memory,
    Shared,
    NoLimits,
    LateEnd,
    EarlyEnd,
    NoEnd,
    DeafToHorizon,
    StrongGear,
    /// Nothing, in a world that is made from the gear.
    Shaped,
    ShapedByNobody,
    ShapedInSecret,
    OldShape,
    UnreadCommand,
}

/// A point pushed about, wrong in one way.
struct Point {
    wrong: Wrong,
    spec: EnvSpec,
    shared: Arc<AtomicUsize>,
    x: f64,
    taken: usize,
    /// What the world is made from.
    gear: Option<f64>,
}

const HORIZON: usize = 20;

impl Point {
    fn new(wrong: Wrong, shared: Arc<AtomicUsize>, horizon: Option<usize>) -> Self {
        let port = |name: &str| Port { name: name.into(), dimension: Dimension::None };
        let mut spec = EnvSpec {
            observation: vec![port("x"), port("2x")],
            state: vec![port("x")],
            context: vec![],
            effort: vec![port("force")],
            command: vec![CommandPort {
                name: "motor".into(),
                dimension: Dimension::None,
                lo: -1.0,
                hi: 1.0,
                direct: true,
            }],
            horizon: horizon.unwrap_or(HORIZON),
            time_step: 0.1,
            shaped_by: vec![],
            terms: vec![],
        };
        match wrong {
            Wrong::Unnamed => spec.observation[1] = port(" "),
            Wrong::Twice => spec.observation[1] = port("x"),
            Wrong::NoObservation => spec.observation.clear(),
            Wrong::Limits => spec.command[0].hi = f64::INFINITY,
            Wrong::ZeroHorizon => spec.horizon = 0,
            Wrong::Timeless => spec.time_step = 0.0,
            Wrong::OtherEffort => spec.effort[0] = port("torque"),
            Wrong::DeafToHorizon => spec.horizon = HORIZON,
            Wrong::Shaped | Wrong::OldShape => spec.shaped_by = vec!["gear".into()],
            Wrong::ShapedByNobody => spec.shaped_by = vec!["shank".into()],
            Wrong::UnreadCommand => {
                spec.command.push(CommandPort { name: "brake".into(), direct: false, ..spec.command[0].clone() });
            }
            _ => {}
        }
        Self { wrong, spec, shared, x: 0.0, taken: 0, gear: None }
    }

    fn count(&self) -> f64 {
        self.shared.fetch_add(1, Ordering::Relaxed) as f64
    }
}

impl Environment for Point {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }
    fn set_design(&mut self, design: &[f64]) {
        self.gear = match self.wrong {
            Wrong::Shaped | Wrong::ShapedInSecret => Some(design[0]),
            Wrong::OldShape => self.gear.or(Some(design[0])),
            _ => None,
        };
    }
    fn reset(&mut self, rng: &mut Stream) {
        self.taken = 0;
        self.x = match self.wrong {
            Wrong::FixedStart => 0.5,
            Wrong::OwnGenerator => self.count(),
            // What was there before counts a little.
            Wrong::Memory => rng.random::<f64>() + 1e-9 * f64::from(u8::from(self.x.abs() > 1.0)),
            _ => rng.random(),
        };
    }
    fn observe(&self, out: &mut [f64]) {
        out[0] = self.x;
        if self.wrong != Wrong::Unwritten {
            out[1] = 2.0 * self.x;
        }
    }
    fn state(&self, out: &mut [f64]) {
        out[0] = self.x;
    }
    fn step(&mut self, effort: &[f64], command: &[f64]) -> Step {
        let limited = command[0].clamp(-1.0, 1.0);
        self.x += effort[0] * self.gear.unwrap_or(1.0)
            + 0.1 * if self.wrong == Wrong::NoLimits { command[0] } else { limited };
        if self.wrong == Wrong::Shared {
            self.x += 1e-12 * self.count();
        }
        self.taken += 1;
        let last = match self.wrong {
            Wrong::LateEnd => self.spec.horizon + 1,
            Wrong::EarlyEnd => self.spec.horizon - 1,
            Wrong::NoEnd => usize::MAX,
            _ => self.spec.horizon,
        };
        let broken = match self.wrong {
            Wrong::NanReward => self.taken == 5,
            Wrong::StrongGear => effort[0].abs() > 1.5 * limited.abs(),
            _ => false,
        };
        let reward = if broken { f64::NAN } else { -self.x.abs() };
        Step { reward, end: (self.taken == last).then_some(End::Truncated) }
    }
}

fn fault(wrong: Wrong, fixed_start: bool) -> Result<(), EnvFault> {
    let shared = Arc::new(AtomicUsize::new(0));
    let make = move |horizon: Option<usize>| -> Box<dyn Environment> {
        Box::new(Point::new(wrong, Arc::clone(&shared), horizon))
    };
    check_env(&make, &law(), fixed_start)
}

#[test]
fn a_sound_environment_passes() {
    assert_eq!(fault(Wrong::Nothing, false), Ok(()));
    assert_eq!(fault(Wrong::FixedStart, true), Ok(()));
}

#[test]
fn names_limits_horizon_and_time_step() {
    assert_eq!(fault(Wrong::Unnamed, false), Err(EnvFault::Unnamed { kind: "observation", index: 1 }));
    assert_eq!(fault(Wrong::Twice, false), Err(EnvFault::Twice { kind: "observation", name: "x".into() }));
    assert_eq!(fault(Wrong::NoObservation, false), Err(EnvFault::NoPort { kind: "observation" }));
    assert_eq!(
        fault(Wrong::Limits, false),
        Err(EnvFault::Limits { name: "motor".into(), lo: -1.0, hi: f64::INFINITY })
    );
    assert_eq!(fault(Wrong::ZeroHorizon, false), Err(EnvFault::Horizon));
    assert_eq!(fault(Wrong::Timeless, false), Err(EnvFault::TimeStep { time_step: 0.0 }));
    assert_eq!(
        fault(Wrong::OtherEffort, false).unwrap_err().to_string(),
        r#"the law's effort ports are ["force"], the environment's ["torque"]"#
    );
}

/// A world may be made from the design, if it says from what of it; and is made anew for each episode.
#[test]
fn worlds_say_what_they_are_made_from() {
    assert_eq!(fault(Wrong::Shaped, false), Ok(()));
    assert_eq!(
        fault(Wrong::ShapedByNobody, false).unwrap_err().to_string(),
        r#"the world's model is made from `shank`, but the design has ["gear"]"#
    );
    let secret = fault(Wrong::ShapedInSecret, false).unwrap_err();
    assert!(matches!(secret, EnvFault::Differs { cause, step: 1, .. } if cause.contains("`shaped_by`")), "{secret}");
    let old = fault(Wrong::OldShape, false).unwrap_err();
    assert!(matches!(old, EnvFault::Differs { cause, .. } if cause.contains("a reset leaves nothing")), "{old}");
}

/// An environment may have commands that the law does not read; somebody has to.
#[test]
fn somebody_reads_each_command() {
    assert_eq!(fault(Wrong::UnreadCommand, false), Err(EnvFault::Unread { name: "brake".into() }));
}

#[test]
fn values_are_finite_and_written() {
    let reward = fault(Wrong::NanReward, false).unwrap_err();
    assert!(matches!(reward, EnvFault::NotFinite { kind: "reward", step: 5, .. }), "{reward}");
    let unwritten = fault(Wrong::Unwritten, false).unwrap_err();
    assert!(matches!(unwritten, EnvFault::NotFinite { kind: "observation", index: 1, step: 0, .. }), "{unwritten}");
}

/// Designs were drawn as the law begins: where it begins at a given value, all episodes had that one, and what only other
/// designs break was not found. The law here begins with a gear of 1, and one above 1.5 breaks the environment.
#[test]
fn designs_are_random_where_the_law_begins_at_one() {
    let gear = fault(Wrong::StrongGear, false).unwrap_err();
    assert!(matches!(gear, EnvFault::NotFinite { kind: "reward", .. }), "{gear}");
}

#[test]
fn starts_follow_the_stream() {
    assert_eq!(fault(Wrong::FixedStart, false), Err(EnvFault::Starts { distinct: 1, streams: 8, fixed: false }));
    assert_eq!(fault(Wrong::Nothing, true), Err(EnvFault::Starts { distinct: 8, streams: 8, fixed: true }));
    let own = fault(Wrong::OwnGenerator, false).unwrap_err();
    assert!(matches!(own, EnvFault::Differs { cause: "the same stream starts both", step: 0, .. }), "{own}");
}

#[test]
fn episodes_repeat() {
    for wrong in [Wrong::Memory, Wrong::Shared] {
        let error = fault(wrong, false).unwrap_err();
        assert!(matches!(error, EnvFault::Differs { .. }), "{wrong:?}: {error}");
    }
}

#[test]
fn commands_are_limited() {
    let error = fault(Wrong::NoLimits, false).unwrap_err();
    let EnvFault::Differs { cause, step: 1, .. } = error else { panic!("{error}") };
    assert_eq!(cause, "one command is at its limit, the other beyond");
}

#[test]
fn episodes_end_at_the_horizon() {
    let end = |horizon, step, end, expected| Err(EnvFault::End { horizon, step, end, expected });
    assert_eq!(fault(Wrong::LateEnd, false), end(HORIZON, HORIZON, None, Some(End::Truncated)));
    assert_eq!(fault(Wrong::EarlyEnd, false), end(HORIZON, HORIZON - 1, Some(End::Truncated), None));
    assert_eq!(fault(Wrong::NoEnd, false), end(HORIZON, HORIZON, None, Some(End::Truncated)));
    assert_eq!(fault(Wrong::DeafToHorizon, false), Err(EnvFault::Override { asked: 1, found: HORIZON }));
}
