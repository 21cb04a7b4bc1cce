//! Drawings: what is merged, what is kept apart, and that the picture is well formed.

use hwasp_diff::{GraphStyle, Program, Scalar, Var};

/// Springs in parallel with squashed stiffnesses, as plain arithmetic.
fn springs(count: usize) -> Program {
    let names: Vec<_> = (0..count).map(|i| format!("stiffness[{i}]")).collect();
    Program::trace(&names, &["push", "position"], |u, c| {
        let stiffness: Var<'_> = u.iter().map(|&k| k.sigmoid() * (90.0 - 10.0) + 10.0).sum();
        vec![("force".into(), c[0] - stiffness * c[1])]
    })
}

/// A tendon over pulleys against joint springs: several rows, limits, single members of a group.
fn tendon() -> Program {
    let names = ["radius[0]", "radius[1]", "joint stiffness[0]", "joint stiffness[1]", "tendon stiffness", "damping"];
    Program::trace(&names, &["pull", "angle[0]", "angle[1]", "rate[0]", "rate[1]"], |u, c| {
        let travel: Var<'_> = (0..2).map(|i| u[i] * c[1 + i]).sum();
        let tension = ((c[0] - travel) * u[4]).clamp(0.0, 200.0);
        let torque = |i: usize| tension * u[i] - u[2 + i] * c[1 + i] - u[5] * c[3 + i];
        vec![("torque[0]".into(), torque(0)), ("torque[1]".into(), torque(1)), ("tension".into(), tension)]
    })
}

fn style() -> GraphStyle {
    GraphStyle {
        title: "Tendon & pulleys".into(),
        units: [("radius", "m"), ("pull", "m"), ("angle", "rad"), ("torque", "N·m"), ("tension", "N")]
            .map(|(name, unit)| (name.into(), unit.into()))
            .to_vec(),
        column_legend: "command, state".into(),
        ..GraphStyle::default()
    }
}

#[test]
fn two_springs() {
    insta::assert_snapshot!(springs(2).to_dot());
}

#[test]
fn a_tendon() {
    insta::assert_snapshot!(tendon().to_dot_with(&style()));
}

/// The drawing of ten springs has as many nodes as that of two.
#[test]
fn groups_are_drawn_once() {
    let nodes = |dot: &str| dot.lines().filter(|line| line.contains("[label=") && !line.contains("->")).count();
    assert_eq!(nodes(&springs(2).to_dot()), nodes(&springs(10).to_dot()));
    assert!(springs(10).to_dot().contains("stiffness [10]"));
}

/// An operation done on some members only is drawn for those, with their indices.
#[test]
fn parts_of_a_group_stay_apart() {
    let program = Program::trace(&["k[0]", "k[1]", "k[2]"], &["x"], |u, c| {
        vec![("y".into(), u[0].exp() + u[1].exp() * c[0] + u[2]), ("z".into(), u[0] + u[1] - c[0])]
    });
    let dot = program.to_dot();
    assert_eq!(dot.matches("label=\"exp\"").count(), 2, "{dot}");
    for label in ["\"[0]\"", "\"[1]\"", "\"[2]\"", "\"[0 … 1]\"", "\"−\""] {
        assert!(dot.contains(label), "{label} in\n{dot}");
    }
}

/// Every element that is opened is closed, text is escaped, nothing is NaN.
#[test]
fn svg_is_well_formed() {
    let empty = Program::trace(&[] as &[&str], &[] as &[&str], |_, _| Vec::new());
    for svg in [springs(10).to_svg(), tendon().to_svg_with(&style()), empty.to_svg()] {
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
        for tag in ["svg", "g", "text"] {
            let opened = svg.matches(&format!("<{tag} ")).count() + svg.matches(&format!("<{tag}>")).count();
            assert_eq!(opened, svg.matches(&format!("</{tag}>")).count(), "{tag}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
    assert!(tendon().to_svg_with(&style()).contains("Tendon &amp; pulleys"));
}
