//! What can be said of a rig before anything moves.

use std::time::{Duration, Instant};

use hwasp_drivers::{Arm, Dynamixel, DynamixelSettings, Motor};
use hwasp_settings::choice;

use crate::devices::{arm_settings, motor_settings};
use crate::rig::Rig;

choice! {
    /// How a look at something went.
    pub enum Mark {
        /// As it should be.
        Good = "good",
        /// To be looked at by a person.
        Odd = "odd",
        /// Nothing should move before it is mended.
        Bad = "bad",
    }
}

/// Something that was looked at.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// What.
    pub what: &'static str,
    /// How it went.
    pub mark: Mark,
    /// What was found, and the way out.
    pub found: String,
}

/// The reach of a UR5, m.
const REACH: f64 = 0.85;
/// Nearer to its axis the arm does not get, m.
const NEAREST: f64 = 0.15;

/// Looks at arm and motor. Nothing moves; in the motor torque is switched off, and nothing that it keeps is changed.
pub fn check(rig: &Rig) -> Vec<Look> {
    let mut looks = reach(rig);
    arm(rig, &mut looks);
    motor(rig, &mut looks);
    looks
}

fn look(what: &'static str, mark: Mark, found: impl Into<String>) -> Look {
    Look { what, mark, found: found.into() }
}

/// Whether the arm comes to all of the workspace, by its reach alone.
pub fn reach(rig: &Rig) -> Vec<Look> {
    let (frame, [x, y, z]) = (rig.frame(), rig.limits.workspace);
    let mut farthest = 0.0_f64;
    for corner in 0..8 {
        let place = [x[corner & 1], y[corner >> 1 & 1], z[corner >> 2]];
        let [px, py, pz] = frame.pose(place).position;
        // The flange is above the palm by the hand's length.
        let flange = pz + rig.arm.tcp_position[2];
        farthest = farthest.max((px * px + py * py + flange * flange).sqrt());
    }
    // The place of the workspace that is nearest to the arm's axis, which need be no corner.
    let [ax, ay, _] = frame.place(&hwasp_drivers::Pose::default());
    let nearest = (ax - ax.clamp(x[0], x[1])).hypot(ay - ay.clamp(y[0], y[1]));
    let bad = farthest > REACH || nearest < NEAREST;
    let told = format!(
        "corners of the workspace are up to {farthest:.2} m from the base and down to {nearest:.2} m from its axis"
    );
    let hint = if bad { ": bring [world] position nearer, or make the workspace smaller" } else { "" };
    vec![look("reach", if bad { Mark::Bad } else { Mark::Good }, format!("{told}; a UR5 has {REACH} m{hint}"))]
}

fn arm(rig: &Rig, looks: &mut Vec<Look>) {
    let mut arm = match hwasp_drivers::ur::UrArm::connect(&arm_settings(rig)) {
        Ok(arm) => arm,
        Err(error) => return looks.push(look("arm", Mark::Bad, error.to_string())),
    };
    match arm.facts() {
        Err(error) => looks.push(look("arm", Mark::Bad, error.to_string())),
        Ok(facts) => {
            let [major, minor, bugfix, _] = facts.controller;
            let serial = facts.serial_number.as_deref().unwrap_or("not told");
            looks.push(look(
                "arm",
                Mark::Good,
                format!("{}, controller {major}.{minor}.{bugfix}, serial number {serial}", facts.polyscope),
            ));
            let (on, safe) = (facts.robot_mode == "RUNNING", facts.safety_mode == "NORMAL");
            let mode = format!("{}, safety {}, program {}", facts.robot_mode, facts.safety_mode, facts.program_state);
            looks.push(look("arm mode", if on && safe { Mark::Good } else { Mark::Bad }, mode));
            if facts.remote == Some(false) {
                looks.push(look(
                    "arm control",
                    Mark::Bad,
                    "it is in local control: switch the teach pendant to remote control",
                ));
            }
            let fits = |found: f64, wanted: f64, most: f64| {
                if (found - wanted).abs() <= most { Mark::Good } else { Mark::Odd }
            };
            if let Some(payload) = facts.payload {
                let told = format!(
                    "{payload:.2} kg are active, rig.toml says {:.2} kg: its program sets them",
                    rig.arm.payload
                );
                looks.push(look("payload", fits(payload, rig.arm.payload, 0.05), told));
            }
        }
    }
    clock(rig, &mut arm, looks);
}

/// How often states come, and whether the arm's clock goes as ours.
fn clock(rig: &Rig, arm: &mut dyn Arm, looks: &mut Vec<Look>) {
    let (begin, lasts) = (Instant::now(), Duration::from_secs(1));
    let (mut first, mut last, mut count, mut oldest) = (None, None, 0_u32, Duration::ZERO);
    while begin.elapsed() < lasts {
        match arm.state() {
            Ok(state) => {
                oldest = oldest.max(state.at.elapsed());
                if last.is_none_or(|(_, clock)| clock != state.clock) {
                    (last, count) = (Some((state.at, state.clock)), count + 1);
                    first.get_or_insert((state.at, state.clock));
                }
            }
            Err(error) => return looks.push(look("arm data", Mark::Bad, error.to_string())),
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    let (Some((at0, clock0)), Some((at1, clock1))) = (first, last) else { return };
    let (ours, theirs) = ((at1 - at0).as_secs_f64(), clock1 - clock0);
    let drift = theirs - ours;
    let bad = drift.abs() > 0.02
        || f64::from(count) < 0.9 * rig.arm.rate.min(125.0)
        || oldest.as_secs_f64() > rig.limits.arm_stale;
    let told = format!(
        "{count} states in a second, up to {:.0} ms old; its clock went {theirs:.3} s in {ours:.3} s of ours",
        1e3 * oldest.as_secs_f64()
    );
    looks.push(look("arm data", if bad { Mark::Odd } else { Mark::Good }, told));
    if let Ok(state) = arm.state() {
        let (frame, limits) = (rig.frame(), &rig.limits);
        let place = frame.place(&state.tool);
        let inside = (0..3).all(|i| (limits.workspace[i][0]..=limits.workspace[i][1]).contains(&place[i]));
        let tilt = state.tool.turn(&frame.pose(place)).to_degrees();
        let [x, y, z] = place.map(|x| 1e3 * x);
        let told = format!("palm at {x:.0}, {y:.0}, {z:.0} mm of the world, turned by {tilt:.1}° from palm down");
        looks.push(look("palm", if inside && tilt < 2.0 { Mark::Good } else { Mark::Odd }, told));
    }
}

fn motor(rig: &Rig, looks: &mut Vec<Look>) {
    let settings: DynamixelSettings = motor_settings(rig);
    let mut motor = match Dynamixel::open(settings.clone()) {
        Ok(motor) => motor,
        Err(error) => {
            let other = Dynamixel::find_baud(&settings).ok().flatten();
            let hint = other
                .map_or_else(String::new, |baud| format!("; it answers at {baud} bits per second: set [motor] baud"));
            return looks.push(look("motor", Mark::Bad, format!("{error}{hint}")));
        }
    };
    match motor.identify() {
        Ok(who) => looks.push(look("motor", Mark::Good, format!("model {}, firmware {}", who.model, who.firmware))),
        Err(error) => return looks.push(look("motor", Mark::Bad, error.to_string())),
    }
    let as_it_has_to_be = motor.differences();
    let ready = matches!(&as_it_has_to_be, Ok(differences) if differences.is_empty());
    match as_it_has_to_be {
        Ok(differences) if differences.is_empty() => {
            looks.push(look("motor settings", Mark::Good, "as they have to be"));
        }
        Ok(differences) => {
            let told: Vec<_> =
                differences.iter().map(|d| format!("{} is {}, to be {}", d.name, d.found, d.wanted)).collect();
            looks.push(look(
                "motor settings",
                Mark::Odd,
                format!("{}; `hwasp deploy calibrate` sets them", told.join(", ")),
            ));
        }
        Err(error) => looks.push(look("motor settings", Mark::Bad, error.to_string())),
    }
    if !ready {
        return;
    }
    if let Err(error) = motor.prepare() {
        return looks.push(look("motor", Mark::Bad, error.to_string()));
    }
    let (mut worst, mut state) = (Duration::ZERO, None);
    for _ in 0..50 {
        let begin = Instant::now();
        match motor.state() {
            Ok(found) => state = Some(found),
            Err(error) => return looks.push(look("motor answers", Mark::Bad, error.to_string())),
        }
        worst = worst.max(begin.elapsed());
    }
    let slow = worst > Duration::from_millis(5);
    let hint = if slow { ": set the adapter's latency timer to 1 ms" } else { "" };
    let told = format!("within {:.1} ms at worst of 50{hint}", 1e3 * worst.as_secs_f64());
    looks.push(look("motor answers", if slow { Mark::Odd } else { Mark::Good }, told));
    if let Some(state) = state {
        let [lo, hi] = rig.limits.voltage;
        let good = state.hardware_error == 0
            && (lo..=hi).contains(&state.voltage)
            && state.temperature < rig.limits.temperature;
        let told =
            format!("{:.1} V, {:.0} °C, hardware error {}", state.voltage, state.temperature, state.hardware_error);
        looks.push(look("motor state", if good { Mark::Good } else { Mark::Bad }, told));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_workspace_out_of_reach_is_told() {
        let mut rig = Rig::default();
        assert_eq!(reach(&rig)[0].mark, Mark::Good, "{:?}", reach(&rig));
        rig.world.position = [0.8, 0.0, 0.0];
        assert_eq!(reach(&rig)[0].mark, Mark::Bad);
        for beside in [0.05, 0.2, -0.25] {
            rig.world.position = [beside, 0.0, 0.0];
            assert_eq!(reach(&rig)[0].mark, Mark::Bad, "{beside} m");
        }
    }
}
