//! Laws that are data: the same bits as laws that are code, in the simulator and in a policy.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use std::sync::Arc;

use allocation_counter::measure;
use hwasp_core::{DesignSpace, EpisodeKind, Episodes, HardwarePolicy, Initial, Law, Ports, Sampler, Serial, Threads};
use hwasp_diff::Program;

/// The winch as a program and nothing else.
fn winch() -> Law {
    let code = Law::new(common::Winch::new());
    from(&code, code.program().as_ref().clone()).unwrap()
}

fn from(law: &Law, program: Program) -> Result<Law, hwasp_core::LawError> {
    Law::from_program(program, law.design().clone(), law.ports().clone())
}

/// A law could only come from Rust that is compiled into the program: one that is read from a file had no way in.
#[test]
fn a_program_acts_as_the_law_it_was_traced_from() {
    let (code, data) = (Law::new(common::Winch::new()), winch());
    let designs: Vec<Vec<f64>> =
        (0..4).map(|i| common::irregular(4, i).iter().map(|&x| 2.0 + f64::from(x)).collect()).collect();
    for step in 0..20 {
        let inputs: Vec<f64> = common::irregular(4, 10 + step).iter().map(|&x| f64::from(x)).collect();
        // The same design several times in a row, and others in between.
        for design in [&designs[0], &designs[0], &designs[step % 4]] {
            let (mut wanted, mut found) = ([0.0; 2], [f64::NAN; 2]);
            code.effort(design, &inputs[..2], &inputs[2..], &mut wanted);
            data.effort(design, &inputs[..2], &inputs[2..], &mut found);
            assert_eq!(found.map(f64::to_bits), wanted.map(f64::to_bits), "{design:?}, {inputs:?}");
        }
    }
    assert!(Arc::ptr_eq(data.program(), data.clone().program()), "the program is traced once and shared");
    assert_eq!(format!("{:?}", data.program()), format!("{:?}", code.program()));
}

#[test]
fn a_policy_of_a_program_is_the_policy_of_its_law() {
    for placements in common::all_placements() {
        let with = |law: Law| {
            let spec = hwasp_core::PolicySpec { law, ..common::policy_spec(placements.clone()) };
            Arc::new(HardwarePolicy::new(spec, &common::env_spec()).unwrap())
        };
        let (code, data) = (with(Law::new(common::Winch::new())), with(winch()));
        assert_eq!(format!("{:?}", data.program()), format!("{:?}", code.program()));
        let params = code.init(1, 1.0);
        let episodes = Episodes { seed: 7, iteration: 3, indices: 0..40, progress: 0.3, kind: EpisodeKind::Training };
        let reference = Sampler::new(code, common::make(), None).collect(&Serial, &params, &episodes).unwrap();
        let sampler = Sampler::new(data, common::make(), None);
        let two = Threads::new(2).unwrap();
        for executor in [&Serial as &dyn hwasp_core::Executor, &two] {
            let batch = sampler.collect(executor, &params, &episodes).unwrap();
            assert_eq!(common::bits(&batch), common::bits(&reference));
        }
    }
}

#[test]
fn steps_of_a_program_do_not_allocate() {
    let law = winch();
    let mut effort = [0.0; 2];
    law.effort(&[1.0, 2.0, 3.0, 4.0], &[0.1, 0.2], &[0.3, 0.4], &mut effort);
    let counted = measure(|| {
        for step in 0..20 {
            let gear = 1.0 + 0.01 * f64::from(step / 2);
            law.effort(&[gear, 2.0, 3.0, 4.0], &[0.1, 0.2], &[0.3, 0.4], &mut effort);
        }
    });
    assert_eq!(counted.count_total, 0, "{counted:?}");
}

#[test]
fn a_program_with_other_names_is_no_law() {
    let law = winch();
    let uniforms = ["gear[0]", "gear[1]", "spring[0]", "spring[1]"];
    let columns = ["left", "right", "x", "v"];
    let refused = |uniforms: &[&str], columns: &[&str], outputs: &[&str]| {
        let program =
            Program::trace(uniforms, columns, |u, _| outputs.iter().map(|o| ((*o).to_owned(), u[0])).collect());
        from(&law, program).unwrap_err().to_string()
    };
    assert_eq!(
        refused(&["gear[0]", "gear[1]", "spring[1]", "spring[0]"], &columns, &["pull", "push"]),
        "design parameters: number 3 is `spring[1]` in the program, but `spring[0]` in the law"
    );
    assert_eq!(
        refused(&uniforms, &["x", "v", "left", "right"], &["pull", "push"]),
        "commands and states: number 1 is `x` in the program, but `left` in the law"
    );
    assert_eq!(
        refused(&uniforms, &columns, &["pull"]),
        r#"efforts: the program has 1, the law needs 2; ["pull"] against ["pull", "push"]"#
    );
}

/// A mechanism may be approximated; what to build is then another program, and the design itself without one.
#[test]
fn a_second_program_says_what_to_build() {
    let law = winch();
    let design = [1.0, 2.0, 3.0, 4.0];
    assert_eq!(law.as_built(&design), design);
    let names = law.design().names();
    let softer = |outputs: usize| {
        Program::trace(&names, &[""; 0], |u, _| {
            let built = u.iter().enumerate().map(|(i, &u)| if i < 2 { u } else { u * 0.5 });
            names.iter().cloned().zip(built).take(outputs).collect()
        })
    };
    assert_eq!(law.clone().building(softer(4)).unwrap().as_built(&design), [1.0, 2.0, 1.5, 2.0]);
    let refused = law.building(softer(3)).unwrap_err().to_string();
    assert!(refused.starts_with("design parameters to build: the program has 3, the law needs 4; "), "{refused}");
}

#[test]
fn a_law_without_a_design_is_a_law() {
    let program = Program::trace(&[""; 0], &["pull", "x"], |_, c| vec![("force".into(), c[0] - c[1])]);
    let ports = Ports { command: vec!["pull".into()], state: vec!["x".into()], effort: vec!["force".into()] };
    let law = Law::from_program(program, DesignSpace::new(vec![]).unwrap(), ports).unwrap();
    let mut force = [0.0];
    law.effort(&[], &[3.0], &[1.0], &mut force);
    assert_eq!(force, [2.0]);
}

/// Fewer starts than groups dropped the other groups of the design without a word.
#[test]
fn a_law_begins_with_one_start_per_group() {
    let one = Initial::Value(2.0);
    let law = winch().beginning(&[one, Initial::Value(5.0)]).unwrap();
    assert_eq!(law.design().groups().iter().map(|g| g.initial).collect::<Vec<_>>(), [one, Initial::Value(5.0)]);
    for given in [0, 1, 3] {
        let refused = law.clone().beginning(&vec![one; given]).unwrap_err();
        assert_eq!(refused.to_string(), format!("{given} starts for 2 groups of design parameters"));
    }
}
