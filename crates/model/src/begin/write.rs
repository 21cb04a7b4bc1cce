//! The text of the experiment.

use std::fmt::Write;

use hwasp_mujoco::engine::{Drive, JointType};
use hwasp_settings::text::{printable, shorten, show};

use super::facts::{Facts, digits};
use super::listing::listing;
use super::purpose::{Purpose, is_flat};

/// Time of an environment step that is aimed at, s.
const STEP: f64 = 0.02;
/// Steps of an episode.
const HORIZON: usize = 500;
/// The stiffness of a spring that is held over a step, as a share of inertia over the step's square. From 2 on it shakes without
/// friction.
const HELD: f64 = 0.2;
/// The most numbers that a formula lists.
const MOST_LISTED: usize = 30;

/// What follows the tables of `[task]`.
const TRAINING: &str = "\
[controller]
hidden = [64, 64]
output_gain = 0.1
normalize_observations = true

[ppo]
learning_rate = 3e-4
epochs = 10
minibatch_rows = 64

[train]
env_steps = 1_000_000
steps_per_iteration = 4000 # in 4 lanes, each of which runs one episode after the other
episodes_per_iteration = 4
episode_steps = 500
evaluation_episodes = 100

# Searches have no training that gathers statistics of what is seen; ars has a filter of its own.
[methods.cmaes.controller]
normalize_observations = false

[methods.cmaes.cmaes]
separable = true

[methods.ars.controller]
normalize_observations = false
";

/// Simulation steps of an environment step, and its time, s.
fn step(facts: &Facts) -> (f64, f64) {
    let time = facts.anatomy.timestep;
    let skip = (STEP / time).round().clamp(1.0, 10_000.0);
    (skip, digits(skip * time, 6))
}

/// A text in TOML.
fn quoted(text: &str) -> String {
    if text.contains('"') && !text.contains('\'') {
        return format!("'{text}'");
    }
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

/// The experiment.
pub(super) fn experiment(facts: &Facts, purpose: &Purpose, main: &str, name: &str) -> String {
    let (skip, step) = step(facts);
    let mut text = format!(
        "# Written by `hwasp init` for {}. Everything in it may be changed: docs/own_robot.md says what else there is.\n\
         name = {}\ndescription = {}\n\n[task]\nproblem = \"model\"\nmodel = {}\n\
         frame_skip = {skip} # steps of the simulation in one of the environment, which takes {} ms\n\
         horizon = {HORIZON} # steps of an episode: {} s\n",
        printable(main),
        quoted(&shorten(name, 90)),
        quoted(purpose.sentence()),
        quoted(main),
        show(digits(1e3 * step, 6)),
        show(digits(step * HORIZON as f64, 4)),
    );
    // Writing to a string cannot fail.
    if let Some(keyframe) = &facts.keyframe {
        let _ = writeln!(text, "keyframe = {}", quoted(keyframe));
    }
    if facts.additions.free_base {
        text.push_str("base = \"free\" # it has several limbs; \"fixed\" holds it to the world\n");
    }
    if facts.additions.floor {
        text.push_str("floor = true # a plane at height 0\n");
    }
    let observed: Vec<String> = observed(facts, purpose).iter().map(|formula| quoted(formula)).collect();
    let _ = writeln!(text, "observe = [{}]", observed.join(", "));
    match purpose {
        Purpose::Forward { fallen: Some((base, height)), .. } => {
            let ends = quoted(&format!("{base}.pos.z < {} m", show(*height)));
            let _ = writeln!(text, "ends = {ends} # it has fallen: half of its height at the start");
        }
        Purpose::Reach { tip, target, within } => {
            let success = quoted(&format!("norm({target}.pos - {tip}.pos) < {} m", show(*within)));
            let _ = writeln!(text, "success = {success} # at the end of an episode");
        }
        Purpose::Pose => text.push_str("success = \"norm(joint.*.pos - goal) < 0.1\" # at the end of an episode\n"),
        _ => {}
    }
    text.push_str("# observation_delay = \"20 ms\"\n");
    motors(facts, &mut text);
    rewards(facts, purpose, &mut text);
    if let Purpose::Pose = purpose {
        goal(facts, &mut text);
    }
    starts(facts, purpose, &mut text);
    design(facts, &mut text);
    let _ = write!(text, "\n{}\n{TRAINING}", listing(facts));
    text
}

/// Slices of `joint.*.pos` without some coordinates, in order.
fn runs(facts: &Facts, without: &[usize]) -> Vec<String> {
    let count = facts.has.nq;
    let mut runs = Vec::new();
    let mut from = 0;
    let ends: Vec<usize> = (0..count).filter(|at| without.contains(at)).chain([count]).collect();
    for end in ends {
        if from < end {
            runs.push(match (from, end) {
                (0, end) if end == count => "joint.*.pos".to_owned(),
                (from, end) if end == count => format!("joint.*.pos[{from}:]"),
                (from, end) => format!("joint.*.pos[{from}:{end}]"),
            });
        }
        from = end + 1;
    }
    runs
}

/// What the controller sees: all positions but where the robot is on the floor, all velocities, and what it is to come to.
fn observed(facts: &Facts, purpose: &Purpose) -> Vec<String> {
    let mut without = Vec::new();
    if let Purpose::Forward { joint, .. } = purpose {
        let base = &facts.has.joints[*joint];
        if base.kind == JointType::Free {
            without.extend([base.address.qpos.start, base.address.qpos.start + 1]);
        } else {
            without.extend((0..facts.has.nq).filter(|&at| is_flat(facts, at)));
        }
    }
    let mut observed = runs(facts, &without);
    observed.push("clip(joint.*.vel, -10, 10)".to_owned());
    match purpose {
        Purpose::Reach { tip, target: other, .. } | Purpose::Lift { tip, object: other, .. } => {
            observed.push(format!("{other}.pos - {tip}.pos"));
        }
        Purpose::Pose => observed.push("goal - joint.*.pos".to_owned()),
        Purpose::Forward { .. } | Purpose::Stay => {}
    }
    observed
}

/// Motors that were added, and limits of commands that the model does not have.
fn motors(facts: &Facts, text: &mut String) {
    if !facts.additions.motors.is_empty() {
        text.push_str("\n[task.motors] # the gear is the torque or force at a command of 1, N*m or N\n");
    }
    for (joint, gear, [low, high]) in &facts.additions.motors {
        let (gear, joint) = (show(*gear), quoted(joint));
        let _ = writeln!(text, "{joint} = {{ limits = [{}, {}], gear = {gear} }}", show(*low), show(*high));
    }
    let unlimited: Vec<usize> = (0..facts.has.actuators.len()).filter(|&i| !facts.limits(i).1).collect();
    if !unlimited.is_empty() {
        text.push_str("\n[task.commands] # the model does not limit these\n");
    }
    for i in unlimited {
        let ([low, high], _) = facts.limits(i);
        let name = quoted(&facts.anatomy.actuators[i].name);
        let _ = writeln!(text, "{name} = {{ limits = [{}, {}] }}", show(digits(low, 4)), show(digits(high, 4)));
    }
}

fn rewards(facts: &Facts, purpose: &Purpose, text: &mut String) {
    text.push_str("\n[task.reward] # named terms: the reward of a step is their sum, and each has a curve\n");
    match purpose {
        Purpose::Forward { joint, fallen } => {
            let (word, x) = (facts.word("joint", *joint), facts.has.joints[*joint].kind == JointType::Free);
            let component = if x { ".x" } else { "" };
            let _ = writeln!(text, "forward = {} # m/s", quoted(&format!("diff({word}.pos{component}) / dt")));
            if fallen.is_some() {
                text.push_str("alive = 1\n");
            }
        }
        Purpose::Lift { tip, object, height } => {
            let _ = writeln!(text, "near = {} # m", quoted(&format!("-norm({object}.pos - {tip}.pos)")));
            let up = format!("10 * clip({object}.pos.z - {} m, 0, 0.2)", show(digits(*height, 3)));
            let _ = writeln!(text, "lifted = {}", quoted(&up));
        }
        Purpose::Reach { tip, target, .. } => {
            let _ = writeln!(text, "near = {} # m", quoted(&format!("-norm({target}.pos - {tip}.pos)")));
        }
        Purpose::Pose => text.push_str("near = \"-norm(joint.*.pos - goal)\"\n"),
        Purpose::Stay => {
            let start: Vec<f64> = facts.simulation.qpos().iter().map(|&at| digits(at, 4) + 0.0).collect();
            let away = if start.iter().all(|&at| at == 0.0) {
                "joint.*.pos".to_owned()
            } else if start.len() <= MOST_LISTED {
                format!("(joint.*.pos - [{}])", start.iter().map(|&at| show(at)).collect::<Vec<_>>().join(", "))
            } else {
                "(joint.*.vel)".to_owned()
            };
            let _ = writeln!(text, "stay = {} # 1 at the start", quoted(&format!("exp(-sum({away}^2))")));
        }
    }
    let _ = writeln!(text, "effort = {}", quoted(&effort(facts)));
}

/// A price of effort that is 0.05 where every command is at its limit.
fn effort(facts: &Facts) -> String {
    let actuators = 0..facts.has.actuators.len();
    // Where a motor is told where to go, to move the goal is what costs.
    let command = if actuators.clone().any(|i| facts.is_servo(i)) { "diff(command)" } else { "command" };
    let largest: Vec<f64> =
        actuators.map(|i| facts.limits(i).0.map(f64::abs).into_iter().fold(0.0, f64::max)).collect();
    let share = if largest.iter().all(|&limit| limit == 1.0) {
        command.to_owned()
    } else if largest.iter().all(|&limit| limit == largest[0]) {
        format!("({command} / {})", show(digits(largest[0], 4)))
    } else if largest.len() <= MOST_LISTED {
        let limits: Vec<String> = largest.iter().map(|&limit| show(digits(limit, 4))).collect();
        format!("({command} / [{}])", limits.join(", "))
    } else {
        format!("({command} / {})", show(digits(largest.iter().copied().fold(0.0, f64::max), 4)))
    };
    format!("-0.05 * mean({share}^2)")
}

/// Where the joints shall come: within their limits, or near their start.
fn goal(facts: &Facts, text: &mut String) {
    let ends = facts.has.joints.iter().map(|joint| {
        let start = facts.simulation.qpos()[joint.address.qpos.start];
        let near = if joint.kind == JointType::Slide { 0.1 } else { 1.0 };
        let [low, high] = joint.range.unwrap_or([start - near, start + near]);
        let margin = 0.1 * (high - low);
        [digits(low + margin, 3) + 0.0, digits(high - margin, 3) + 0.0]
    });
    let ends: Vec<[f64; 2]> = ends.collect();
    let list = |end: usize| {
        let numbers: Vec<String> = ends.iter().map(|ends| show(ends[end])).collect();
        if let [only] = &numbers[..] { only.clone() } else { format!("[{}]", numbers.join(", ")) }
    };
    let drawn = quoted(&format!("uniform({}, {})", list(0), list(1)));
    let _ = write!(text, "\n[task.random] # drawn when an episode starts\ngoal = {drawn}\n");
}

/// Where episodes start: near the model's own start, loops closed, a target anywhere in the middle of its range, a lifted base on the floor.
fn starts(facts: &Facts, purpose: &Purpose, text: &mut String) {
    text.push_str("\n[task.start]\n");
    let mut apart: Vec<(usize, String, String)> = Vec::new();
    if let Some((at, height)) = facts.lifted {
        apart.push((at, format!("{}.pos.z", facts.word("joint", 0)), format!("{} m", show(height))));
    }
    if let Purpose::Reach { .. } = purpose {
        for (i, joint) in facts.has.joints.iter().enumerate() {
            let (JointType::Hinge | JointType::Slide, Some([low, high])) = (joint.kind, joint.range) else { continue };
            if facts.is_moved(joint.body) {
                continue;
            }
            let [low, high] = [0.75 * low + 0.25 * high, 0.25 * low + 0.75 * high].map(|end| show(digits(end, 3)));
            let drawn = format!("uniform({low}, {high})");
            apart.push((joint.address.qpos.start, format!("{}.pos", facts.word("joint", i)), drawn));
        }
    }
    for &at in &facts.closing {
        let found = facts.has.joints.iter().position(|joint| joint.address.qpos == (at..at + 1));
        let name = found.map_or_else(|| format!("qpos[{at}]"), |joint| format!("{}.pos", facts.word("joint", joint)));
        if apart.iter().all(|(other, ..)| *other != at) {
            apart.push((at, name, show(digits(facts.simulation.qpos()[at], 7))));
        }
    }
    let near = if let Purpose::Reach { .. } = purpose { 0.1 } else { 0.01 };
    let without: Vec<usize> = apart.iter().map(|(at, ..)| *at).collect();
    for run in runs(facts, &without) {
        let _ = writeln!(text, "{} = {}", quoted(&run), quoted(&format!("{run} + uniform(-{near}, {near})")));
    }
    for (at, name, value) in apart {
        let about = if facts.closing.contains(&at) { " # where the model's loops are closed" } else { "" };
        let _ = writeln!(text, "{} = {}{about}", quoted(&name), quoted(&value));
    }
    text.push_str("\"joint.*.vel\" = \"uniform(-0.01, 0.01)\"\n");
}

/// A law and a design for the first joint that is driven, a hinge where there is one, as comments: a spring beside its motor, and the motor's gear.
fn design(facts: &Facts, text: &mut String) {
    let is = |joint: usize, kind: JointType| facts.has.joints[joint].kind == kind;
    let single = |joint: usize| is(joint, JointType::Hinge) || is(joint, JointType::Slide);
    let driving = |kind: JointType| {
        let drives = |drive: &Drive| matches!(drive, Drive::Joint(joint, _) if is(*joint, kind));
        facts.has.actuators.iter().position(|actuator| drives(&actuator.drives))
    };
    let motor = driving(JointType::Hinge).or_else(|| driving(JointType::Slide));
    let joint = match motor.map(|motor| &facts.has.actuators[motor].drives) {
        Some(Drive::Joint(joint, _)) => Some(*joint),
        _ => (0..facts.has.joints.len()).find(|&joint| facts.driven[joint] && single(joint)),
    };
    let Some(joint) = joint else { return };
    let (entry, word) = (&facts.has.joints[joint], facts.word("joint", joint));
    let slides = entry.kind == JointType::Slide;
    let (unit, stiffness) = if slides { ("m", "N/m") } else { ("rad", "N*m/rad") };
    let start = facts.simulation.qpos()[entry.address.qpos.start];
    let wide = if slides { 0.1 } else { 1.0 };
    let [low, high] = entry.range.unwrap_or([start - wide, start + wide]).map(|end| digits(end, 3) + 0.0);
    let gear = motor.map(|motor| digits(facts.has.actuators[motor].gear, 3)).filter(|gear| *gear != 0.0);
    // A spring that can hold against the motor at one radian or a tenth of a metre.
    let push = gear.map_or(10.0, |gear| {
        let limits = facts.limits(motor.unwrap_or_default()).0;
        (gear * limits[1].abs().max(limits[0].abs())).abs()
    });
    // The law holds its efforts over a step: a stiffer spring would shake what it moves.
    let stiffest = HELD * facts.inertia(joint) / step(facts).1.powi(2);
    let most = digits((push / wide).min(stiffest).clamp(1e-6, 1e6), 2);
    let mut lines = vec![
        "[task.law]".to_owned(),
        format!("{} = {}", quoted(&word), quoted(&format!("-stiffness * ({word}.pos - rest)"))),
        String::new(),
        "[task.design]".to_owned(),
        format!("stiffness = {{ limits = [0, \"{} {stiffness}\"] }}", show(most)),
        format!("rest = {{ limits = [\"{} {unit}\", \"{} {unit}\"] }}", show(low), show(high)),
    ];
    if let (Some(motor), Some(gear)) = (motor, gear) {
        let mut limits = [0.5 * gear, 2.0 * gear].map(|end| digits(end, 3));
        limits.sort_by(f64::total_cmp);
        let sets = format!("actuator.#{motor}.gear = gear");
        let [low, high] = limits.map(show);
        lines.push(format!("gear = {{ limits = [{low}, {high}], initial = {}, sets = [\"{sets}\"] }}", show(gear)));
    }
    let _ = write!(
        text,
        "\n# A design to begin with: a spring beside the motor of {word}, and the motor's gear. Take away the `# ` of these \
         lines,\n# and they are designed together with the controller.\n"
    );
    for line in lines {
        let _ = writeln!(text, "{}", format!("# {line}").trim_end());
    }
}
