//! What a model can be rewarded for, from what it is.

use hwasp_mujoco::engine::{BodyId, JointType};

use super::facts::{Facts, digits};

/// The share of its height at the start below which a robot has fallen.
const FALLEN: f64 = 0.5;
/// The least height of a robot that stands, as a share of its size: what lies cannot fall.
const STANDING: f64 = 0.25;

/// What is rewarded.
pub(super) enum Purpose {
    /// A base that nothing holds comes forward along its joint; it has fallen below a height, m.
    Forward { joint: usize, fallen: Option<(String, f64)> },
    /// A tip brings an object up.
    Lift { tip: String, object: String, height: f64 },
    /// A tip comes to a target, from within a distance, m.
    Reach { tip: String, target: String, within: f64 },
    /// Every joint comes to an angle or place that is drawn for the episode.
    Pose,
    /// Everything stays where it starts.
    Stay,
}

impl Purpose {
    pub(super) fn of(facts: &Facts) -> Self {
        let base = facts.has.joints.iter().position(|joint| {
            let slides = joint.kind == JointType::Slide && is_flat(facts, joint.address.qpos.start);
            (joint.kind == JointType::Free || slides) && facts.moves_itself(joint.body)
        });
        // A body that actuators slide along the floor is none that moves by itself.
        let slid = |base: usize| {
            let mut own = facts.has.joints.iter().zip(&facts.driven);
            own.any(|(joint, driven)| {
                *driven && joint.kind == JointType::Slide && joint.body == facts.has.joints[base].body
            })
        };
        let base = base.filter(|&joint| !facts.driven[joint] && !slid(joint));
        match base {
            // A body with propellers should hold its place.
            Some(_) if facts.driven.iter().all(|driven| !driven) => return Self::Stay,
            Some(joint) => return Self::Forward { joint, fallen: fallen(facts, facts.has.joints[joint].body) },
            None => {}
        }
        if let Some((tip, at)) = tip(facts) {
            if let Some((target, place)) = target(facts) {
                let distance = (0..3).map(|k| (place[k] - at[k]).powi(2)).sum::<f64>().sqrt();
                return Self::Reach { tip, target, within: digits(0.1 * distance.max(0.05), 1) };
            }
            let object =
                facts.has.joints.iter().find(|joint| joint.kind == JointType::Free && !facts.is_moved(joint.body));
            if let Some(object) = object {
                let height = facts.simulation.body_position(object.body)[2];
                return Self::Lift { tip, object: facts.word("body", object.body.index()), height };
            }
        }
        let plain = |(joint, driven): (&hwasp_mujoco::engine::JointEntry, &bool)| {
            *driven && matches!(joint.kind, JointType::Hinge | JointType::Slide)
        };
        if facts.has.joints.iter().zip(&facts.driven).all(plain) { Self::Pose } else { Self::Stay }
    }

    /// In a sentence.
    pub(super) fn sentence(&self) -> &'static str {
        match self {
            Self::Forward { .. } => "Move forward.",
            Self::Lift { .. } => "Take the object and lift it.",
            Self::Reach { .. } => "Bring the tip to the target.",
            Self::Pose => "Bring the joints to a pose that is drawn for each episode.",
            Self::Stay => "Stay where the episode starts.",
        }
    }
}

/// Whether the slide of a coordinate is level and not driven.
pub(super) fn is_flat(facts: &Facts, coordinate: usize) -> bool {
    let joint = facts.has.joints.iter().position(|joint| joint.address.qpos.contains(&coordinate));
    joint.is_some_and(|joint| {
        let slides = facts.has.joints[joint].kind == JointType::Slide && !facts.driven[joint];
        slides && facts.field(&format!("joint.#{joint}.axis.z")).abs() < 0.5
    })
}

/// Below which height a robot has fallen, where it can fall: it stands above a floor, and nothing holds it up.
fn fallen(facts: &Facts, base: BodyId) -> Option<(String, f64)> {
    let floor = facts.has.geoms.iter().any(|geom| geom.collides && matches!(geom.shape, "plane" | "hfield"));
    let falls = facts.has.joints.iter().enumerate().any(|(i, joint)| {
        let upright = joint.kind == JointType::Slide && facts.field(&format!("joint.#{i}.axis.z")).abs() > 0.9;
        joint.body == base && (joint.kind == JointType::Free || upright)
    });
    let at = facts.simulation.body_position(base);
    let own = facts.has.bodies.iter().filter(|body| facts.is_below(body.id, base));
    let size = own.map(|body| {
        let place = facts.simulation.body_position(body.id);
        (0..3).map(|k| (place[k] - at[k]).powi(2)).sum::<f64>().sqrt()
    });
    let size = size.fold(0.0, f64::max);
    let stands = floor && falls && facts.has.gravity[2] < 0.0 && at[2] > STANDING * size;
    stands.then(|| (facts.word("body", base.index()), digits(FALLEN * at[2], 2)))
}

/// The end of what is driven, and where it is: a site that is called so, or the body with the most bodies before it.
fn tip(facts: &Facts) -> Option<(String, [f64; 3])> {
    const WORDS: [&str; 7] = ["tip", "end", "ee", "grip", "tool", "hand", "finger"];
    let called = |name: &str| WORDS.iter().any(|word| name.to_lowercase().contains(word));
    let mut sites = facts.has.sites.iter().enumerate().filter(|(_, site)| facts.is_moved(site.body));
    if let Some((i, site)) = sites.rfind(|(_, site)| site.name.as_deref().is_some_and(called)) {
        return Some((facts.word("site", i), facts.simulation.site_position(site.id)));
    }
    let depth = |mut body: BodyId| {
        let mut depth = 0;
        while let Some(parent) = facts.has.bodies[body.index()].parent {
            (body, depth) = (parent, depth + 1);
        }
        depth
    };
    let last = facts.has.bodies.iter().filter(|body| facts.is_moved(body.id)).max_by_key(|body| depth(body.id))?;
    Some((facts.word("body", last.id.index()), facts.simulation.body_position(last.id)))
}

/// What is called a target and is not moved by the robot, and where it is.
fn target(facts: &Facts) -> Option<(String, [f64; 3])> {
    let called = |name: &Option<String>| {
        name.as_deref().is_some_and(|name| ["target", "goal"].iter().any(|word| name.to_lowercase().contains(word)))
    };
    let body = facts.has.bodies.iter().find(|body| called(&body.name) && !facts.is_moved(body.id));
    if let Some(body) = body {
        return Some((facts.word("body", body.id.index()), facts.simulation.body_position(body.id)));
    }
    let (i, site) = facts.has.sites.iter().enumerate().find(|(_, s)| called(&s.name) && !facts.is_moved(s.body))?;
    Some((facts.word("site", i), facts.simulation.site_position(site.id)))
}
