//! The laws: their derivatives, what they say should be built, and what settings they refuse.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_core::{DesignError, Initial, Law};
use hwasp_diff::{GradCheckSettings, gradcheck};
use hwasp_tasks::mass_spring::{Interface, MassSpring, MassSpringError, MassSpringSettings};
use hwasp_tasks::pendulum::{Pendulum, PendulumSettings};
use hwasp_tasks::reach::{Gear, Reach, ReachError, ReachSettings};
use proptest::prelude::*;

fn paper(count: usize) -> MassSpringSettings {
    MassSpringSettings { count, ..MassSpringSettings::default() }
}

fn soft_bar(count: usize) -> Law {
    MassSpring::bar(paper(count), Interface::Soft).expect("the paper's numbers are sound").law()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Reverse, tangent and finite differences agree at random designs, commands and states.
    #[test]
    fn laws_have_the_derivatives_they_should(
        part in prop::collection::vec(0.0..1.0f64, 50),
        (motor, y1, v1) in (-5.0..5.0f64, 0.0..0.5f64, -2.0..2.0f64),
        (y2, v2) in (0.0..0.5f64, -2.0..2.0f64),
        count in prop::sample::select(vec![1usize, 10, 50]),
    ) {
        let laws = [
            (MassSpring::stiffness(paper(count)).unwrap().law(), vec![motor, y1, v1, y2, v2]),
            (soft_bar(count), vec![motor, y1, v1, y2, v2]),
            (MassSpring::bar(paper(count), Interface::Rigid).unwrap().law(), vec![motor, y1, v1, y2, v2]),
            (Reach::new(ReachSettings::default()).unwrap().law(), vec![motor / 5.0, y1]),
            (Pendulum::new(&PendulumSettings::default()).unwrap().law(), vec![0.4 * motor, y1, v1]),
        ];
        for (law, columns) in laws {
            let design: Vec<f64> = (0..law.design().len())
                .map(|i| {
                    let (lo, hi) = law.design().bounds(i);
                    lo + (hi - lo) * part[i]
                })
                .collect();
            let checked = gradcheck(law.program(), &design, &columns, &GradCheckSettings::default());
            prop_assert!(checked.is_ok(), "{:?}: {}", law.ports().effort, checked.unwrap_err());
        }
    }

    /// The built bar is longer by the stretch where there is room, and within its limits everywhere.
    #[test]
    fn the_built_bar_makes_up_for_the_stretch(part in prop::collection::vec(0.0..=1.0f64, 10)) {
        let law = soft_bar(10);
        let design: Vec<f64> = part.iter().map(|part| part * 0.05).collect();
        let built = law.as_built(&design);
        let (total, wanted) = (built.iter().sum::<f64>(), design.iter().sum::<f64>() + 0.0098);
        prop_assert!((total - wanted.min(0.5)).abs() < 1e-12, "{total} m is not {wanted} m");
        for (built, design) in built.iter().zip(&design) {
            prop_assert!(built >= design && *built <= 0.05 + 1e-15);
        }
    }
}

#[test]
fn the_stretch_is_spread_evenly() {
    for built in soft_bar(10).as_built(&[0.0092; 10]) {
        assert!((built - (0.0092 + 0.00098)).abs() < 1e-15, "{built}");
    }
}

#[test]
fn springs_and_rigid_bars_are_built_as_designed() {
    let springs = MassSpring::stiffness(paper(3)).unwrap().law();
    assert_eq!(springs.as_built(&[1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
    let bar = MassSpring::bar(paper(3), Interface::Rigid).unwrap().law();
    assert_eq!(bar.as_built(&[0.01, 0.02, 0.03]), [0.01, 0.02, 0.03]);
}

/// What is built of a soft bar holds the mass where the soft one did.
#[test]
fn the_built_optimum_is_the_rigid_optimum() {
    let soft = MassSpring::bar(paper(10), Interface::Soft).unwrap();
    let rigid = MassSpring::bar(paper(10), Interface::Rigid).unwrap();
    let built = soft.law().as_built(&[soft.optimum() / 10.0; 10]);
    assert!((built.iter().sum::<f64>() - rigid.optimum()).abs() < 1e-12);
    assert!((rigid.optimum() - 0.102).abs() < 1e-12);
    assert!((soft.optimum() - 0.0922).abs() < 1e-12);
    assert!((MassSpring::stiffness(paper(10)).unwrap().optimum() - 19.6).abs() < 1e-12);
}

#[test]
fn limits_are_shared_among_the_parameters() {
    for count in [1, 10, 50] {
        let springs = MassSpring::stiffness(paper(count)).unwrap().law();
        assert_eq!(springs.design().len(), count);
        assert_eq!(springs.design().bounds(count - 1), (0.0, 100.0 / count as f64));
        assert_eq!(soft_bar(count).design().bounds(0), (0.0, 0.5 / count as f64));
    }
}

#[test]
fn impossible_settings_are_refused_with_numbers() {
    let refused = |change: fn(&mut MassSpringSettings)| {
        let mut settings = MassSpringSettings::default();
        change(&mut settings);
        let error = MassSpring::stiffness(settings.clone()).unwrap_err();
        for interface in [Interface::Soft, Interface::Rigid] {
            assert!(MassSpring::bar(settings.clone(), interface).is_err());
        }
        error.to_string()
    };
    assert_eq!(refused(|s| s.count = 0), "count = 0, but at least 1 is needed");
    assert_eq!(refused(|s| s.lower_mass = -0.1), "lower_mass = -0.1 kg is not a positive finite number");
    assert_eq!(refused(|s| s.upper_mass = f64::NAN), "upper_mass = NaN kg is not a positive finite number");
    assert_eq!(
        refused(|s| s.max_total_stiffness = -100.0),
        "max_total_stiffness = -100 N/m is not a positive finite number"
    );
    assert_eq!(refused(|s| s.gravity = -9.8), "gravity = -9.8 m/s² is not a finite number of at least 0");
    assert_eq!(refused(|s| s.effort_limit = Some(0.0)), "effort_limit = 0 N is not a positive finite number");
    assert_eq!(
        refused(|s| s.bar_reward.speed = f64::INFINITY),
        "bar_reward.speed = inf s/m is not a finite number of at least 0"
    );
    let start = MassSpringSettings { initial: Initial::Value(11.0), ..MassSpringSettings::default() };
    assert!(matches!(
        MassSpring::stiffness(start),
        Err(MassSpringError::Design(DesignError::Start { value: 11.0, hi: 10.0, .. }))
    ));
}

#[test]
fn reach_refuses_impossible_settings() {
    let of = |settings| Reach::new(settings).unwrap_err().to_string();
    let base = ReachSettings::default;
    assert_eq!(of(ReachSettings { goal: 1.5, ..base() }), "goal = 1.5 is outside of [-1, 1]");
    assert_eq!(Reach::new(ReachSettings { horizon: 0, ..base() }).unwrap_err(), ReachError::Horizon);
    assert!(Reach::new(ReachSettings { time_step: f64::NAN, ..base() }).is_err());
    assert!(Reach::new(ReachSettings { initial: Initial::Value(Gear::MAX), ..base() }).is_err());
}
