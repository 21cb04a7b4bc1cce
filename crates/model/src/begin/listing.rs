//! What the model has, as comments: everything that formulas can name.

use std::fmt::Write;

use hwasp_mujoco::engine::{Drive, JointType, Kind};
use hwasp_settings::text::{printable, show};

use super::facts::{Facts, digits};

/// The most elements of a kind that are listed.
const MOST: usize = 24;

/// The comments.
pub(super) fn listing(facts: &Facts) -> String {
    let mut text = "# What the model has:\n".to_owned();
    let has = &facts.has;
    let all = |count: usize| 0..count;
    put(&mut text, facts, "joint", all(has.joints.len()), |i| {
        let joint = &has.joints[i];
        let (kind, per, unit) = match joint.kind {
            JointType::Hinge => ("hinge", 180.0 / std::f64::consts::PI, "deg"),
            JointType::Slide => ("slide", 1.0, "m"),
            JointType::Ball => ("ball", 1.0, ""),
            JointType::Free => ("free", 1.0, ""),
        };
        match joint.range {
            Some([low, high]) if !unit.is_empty() => {
                let [low, high] = [low, high].map(|end| show(digits(per * end, 4)));
                format!("{kind}, {low} to {high} {unit}")
            }
            _ => kind.to_owned(),
        }
    });
    put(&mut text, facts, "actuator", all(has.actuators.len()), |i| {
        let actuator = &has.actuators[i];
        let drives = match &actuator.drives {
            Drive::Joint(joint, _) => facts.word("joint", *joint),
            Drive::Tendon(tendon, _) => facts.word("tendon", tendon.index()),
            Drive::Site(site, _) => facts.word("site", site.index()),
            Drive::Other(what) => (*what).to_owned(),
        };
        let (limits, gear) = (facts.limits(i).0.map(|end| show(digits(end, 4))), show(digits(actuator.gear, 4)));
        let how = if facts.is_servo(i) { "is told where to go" } else { "drives" };
        format!("{how}: {drives}, command {} to {}, gear {gear}", limits[0], limits[1])
    });
    put(&mut text, facts, "tendon", all(has.tendons.len()), |i| {
        let tendon = &has.tendons[i];
        let length = show(digits(facts.simulation.tendon_length(tendon.id), 3));
        match tendon.range {
            Some([low, high]) => {
                format!("{} to {} m, {length} m at the start", show(digits(low, 3)), show(digits(high, 3)))
            }
            None => format!("{length} m at the start"),
        }
    });
    put(&mut text, facts, "sensor", all(has.sensors.len()), |i| {
        let sensor = &has.sensors[i];
        let unit = sensor.quantity.unit();
        let count = sensor.values.len();
        format!("{}, {count} {}", sensor.kind, if unit.is_empty() { "in no unit" } else { unit })
    });
    put(&mut text, facts, "site", all(has.sites.len()), |_| "a place".to_owned());
    put(&mut text, facts, "body", 1..has.bodies.len(), |i| format!("{} kg", show(digits(has.bodies[i].mass, 3))));
    put(&mut text, facts, "geom", all(has.geoms.len()), |i| {
        let touches = if has.geoms[i].collides { "" } else { ", touches nothing" };
        format!("{}{touches}", has.geoms[i].shape)
    });
    let keyframes: Vec<String> = facts.anatomy.keyframes.iter().map(|name| printable(name)).collect();
    if !keyframes.is_empty() {
        let _ = writeln!(text, "#   {:<24} {}", Kind::Keyframe, keyframes.join(", "));
    }
    text
}

/// The elements of a kind, one a line.
fn put(text: &mut String, facts: &Facts, kind: &str, indices: std::ops::Range<usize>, about: impl Fn(usize) -> String) {
    let count = indices.len();
    for i in indices.take(MOST) {
        let _ = writeln!(text, "#   {:<24} {}", facts.word(kind, i), about(i));
    }
    if count > MOST {
        let _ = writeln!(text, "#   and {} more of the kind {kind}", count - MOST);
    }
}
