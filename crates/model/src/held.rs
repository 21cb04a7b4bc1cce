//! Springs of the law that push late, because a law's efforts are held for a step.
//!
//! A spring of stiffness k whose effort is held for a time dt acts as if it were half of that late: beside its pull it drives the
//! joint by k·dt/2 times the velocity. Where damping does not take that away, the joint swings more and more.

use hwasp_settings::text::printable;

use crate::columns::{Column, Reading};
use crate::corners::begun;
use crate::robot::{Robot, Target};

/// The step of differences, rad and m.
const STEP: f64 = 1e-6;
/// Swings that take longer to grow by e are none to warn of, s.
const SLOW: f64 = 10.0;

/// What is to be said of the springs of a law, in the middle of the design and of the commands.
pub(crate) fn doubts(robot: &Robot) -> Vec<String> {
    if !robot.targets.iter().any(|target| matches!(target, Target::Joint(_))) {
        return Vec::new();
    }
    let design = robot.law.design().middle();
    // A model that cannot be made there was refused before.
    let Ok((mut body, mut values)) = begun(robot, &design) else { return Vec::new() };
    body.read(&mut values);
    let command: Vec<f64> = robot.env.command.iter().map(|port| 0.5 * (port.lo + port.hi)).collect();
    let state: Vec<f64> = robot.states.iter().map(|&at| values[at]).collect();
    // How an effort follows a state.
    let slope = |effort: usize, reading: Reading| -> f64 {
        let read = |&at: &usize| robot.columns[at] == Column::Engine(reading);
        let Some(at) = robot.states.iter().position(read) else { return 0.0 };
        let moved = [STEP, -STEP].map(|by| {
            let (mut state, mut efforts) = (state.clone(), vec![0.0; robot.targets.len()]);
            state[at] += by;
            robot.law.effort(&design, &command, &state, &mut efforts);
            efforts[effort]
        });
        (moved[0] - moved[1]) / (2.0 * STEP)
    };
    let (has, period) = (body.simulation().inventory(), robot.env.time_step);
    let mut inertia = vec![0.0; has.nv * has.nv];
    body.simulation().mass_matrix(&mut inertia);
    let mut doubts = Vec::new();
    for (effort, target) in robot.targets.iter().enumerate() {
        let Target::Joint(dof) = *target else { continue };
        let Some((i, joint)) = has.joints.iter().enumerate().find(|(_, joint)| joint.address.dof.start == dof) else {
            continue;
        };
        let stiffness = -slope(effort, Reading::Position(joint.address.qpos.start));
        let damping = joint.damping - slope(effort, Reading::Velocity(dof));
        let drive = 0.5 * stiffness * period;
        let growth = 2.0 * inertia[dof * has.nv + dof] / (drive - damping);
        // Not a number where the law is none.
        if !(drive > damping && growth < SLOW) {
            continue;
        }
        let name =
            joint.name.as_ref().map_or_else(|| format!("joint.#{i}"), |name| format!("joint.{}", printable(name)));
        let turn = if joint.kind == hwasp_mujoco::engine::JointType::Slide {
            ["N/m", "N*s/m"]
        } else {
            ["N*m/rad", "N*m*s/rad"]
        };
        doubts.push(format!(
            "the law's spring on {name} has {stiffness:.3} {} in the middle of the design, and is held for {:.3} ms: that drives the \
             joint\nby {drive:.3} {}, its damping is {damping:.3}, and swings grow by e in about {growth:.2} s\ntake a shorter step \
             (task.frame_skip), damp the joint, or let the model have the spring: {name}.stiffness",
            turn[0],
            1e3 * period,
            turn[1],
        ));
    }
    doubts
}
