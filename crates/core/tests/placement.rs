//! Placements that cannot be are refused with the numbers.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use hwasp_core::{HardwarePolicy, ParamKind, Placement};

fn refused(placements: Vec<Placement>) -> String {
    common::policy(placements).unwrap_err().to_string()
}

#[test]
fn there_is_one_place_per_parameter() {
    assert_eq!(refused(vec![Placement::Graph; 3]), "3 placements for 4 design parameters");
    assert_eq!(refused(vec![Placement::Action; 5]), "5 placements for 4 design parameters");
}

#[test]
fn fixed_values_are_within_their_limits() {
    let fixed = |value| refused(vec![Placement::Graph, Placement::Action, Placement::Graph, Placement::Fixed(value)]);
    assert_eq!(fixed(0.5), "spring[1] fixed at 0.5 is outside its limits [1, 9]");
    assert_eq!(fixed(9.5), "spring[1] fixed at 9.5 is outside its limits [1, 9]");
    assert_eq!(fixed(f64::NAN), "spring[1] fixed at NaN is outside its limits [1, 9]");
    for limit in [1.0, 9.0] {
        assert!(
            common::policy(vec![Placement::Fixed(2.0), Placement::Graph, Placement::Graph, Placement::Fixed(limit)])
                .is_ok()
        );
    }
}

/// A manufacturing error near a limit was simulated smaller than it was printed: what is built was held to the limits of what may
/// be chosen.
#[test]
fn what_is_built_may_lie_outside_of_the_limits() {
    let built =
        |value| vec![Placement::Built(2.0), Placement::Built(3.0), Placement::Built(4.0), Placement::Built(value)];
    for value in [0.5, 9.5] {
        let policy = common::policy(built(value)).unwrap();
        assert_eq!(policy.design(&policy.init(0, 1.0)), [2.0, 3.0, 4.0, value]);
    }
    assert!(refused(built(f64::NAN)).starts_with("spring[1] fixed at NaN is outside"));
}

#[test]
fn law_and_environment_have_the_same_ports() {
    let refused = |change: fn(&mut hwasp_core::EnvSpec)| {
        let mut env = common::env_spec();
        change(&mut env);
        HardwarePolicy::new(common::policy_spec(vec![Placement::Graph; 4]), &env).unwrap_err().to_string()
    };
    assert_eq!(
        refused(|env| env.command[1].name = "middle".into()),
        r#"the law's command ports are ["left", "right"], the environment's are ["left", "middle"]"#
    );
    // The same names in another order are other ports.
    assert_eq!(
        refused(|env| env.state.swap(0, 1)),
        r#"the law's state ports are ["x", "v"], the environment's are ["v", "x"]"#
    );
    assert_eq!(
        refused(|env| env.effort.truncate(1)),
        r#"the law's effort ports are ["pull", "push"], the environment's are ["pull"]"#
    );
}

/// Design parameters in the action, then efforts if anything is in the graph, then commands. Groups of parameters had names
/// that learners compared with words of their own: one that was spelt otherwise was optimised as the controller.
#[test]
fn actions_are_laid_out_by_placement() {
    use Placement::{Action, Fixed, Graph};
    for (placements, names, free) in [
        (vec![Graph; 4], vec!["pull", "push", "left", "right"], 4),
        (vec![Action; 4], vec!["gear[0]", "gear[1]", "spring[0]", "spring[1]", "left", "right"], 4),
        (vec![Fixed(1.0); 4], vec!["left", "right"], 0),
        (vec![Graph, Action, Fixed(2.0), Action], vec!["gear[1]", "spring[1]", "pull", "push", "left", "right"], 3),
    ] {
        let policy = common::policy(placements).unwrap();
        assert_eq!(policy.action_names(), names);
        let groups: Vec<_> = hwasp_core::Policy::groups(&policy).iter().map(|g| (g.kind, g.range.len())).collect();
        // 3·7 + 7, 7·5 + 5 and 5·2 + 2 weights and biases.
        assert_eq!(groups, [(ParamKind::Controller, 80), (ParamKind::Design, free), (ParamKind::LogStd, names.len())]);
    }
}
