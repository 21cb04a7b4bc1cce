//! What an experiment has to know of a model: what moves by itself, what is driven, where everything is at the start.

use hwasp_mujoco::engine::{BodyId, Drive, Files, Inventory, JointType, Simulation, Spec};
use hwasp_problem::AnyError;

use super::close::close;
use super::told;
use crate::anatomy::Anatomy;
use crate::robot::Additions;

/// The most that a base is lifted so that the robot stands on the floor, m.
const HIGHEST: f64 = 100.0;
/// Acceleration of gravity, m/s².
const GRAVITY: f64 = 9.81;

/// A model at its start, with what was added to it.
pub(super) struct Facts {
    pub(super) additions: Additions,
    pub(super) spec: Spec,
    pub(super) anatomy: Anatomy,
    pub(super) has: Inventory,
    pub(super) keyframe: Option<String>,
    /// Where the base is put so that the robot stands on the floor that was added: its coordinate and m.
    pub(super) lifted: Option<(usize, f64)>,
    /// Coordinates that were put where the model's loops are closed.
    pub(super) closing: Vec<usize>,
    pub(super) simulation: Simulation,
    /// Whether an actuator drives the joint.
    pub(super) driven: Vec<bool>,
    /// Bodies that actuators move by themselves.
    moved: Vec<BodyId>,
}

impl Facts {
    pub(super) fn read(main: &str, files: &Files) -> Result<Self, AnyError> {
        let mut spec = Spec::parse(main, files)?;
        let bare = spec.compile()?;
        let additions = additions(&spec, bare, main)?;
        additions.add(&mut spec).map_err(|(_, error)| error)?;
        let mut simulation = spec.compile()?;
        let (anatomy, has) = (Anatomy::of(&simulation), simulation.inventory());
        let usual = |name: &&String| {
            let name = name.to_lowercase();
            ["home", "stand", "start", "init"].iter().any(|word| name == *word || name.starts_with(&format!("{word}_")))
        };
        let keyframe = anatomy.keyframes.iter().find(usual).cloned();
        if let Some(name) = &keyframe {
            simulation.set_keyframe(simulation.keyframe(name)?);
            simulation.ctrl_mut().fill(0.0);
        }
        let lifted = if additions.free_base { stand(&mut simulation, &has) } else { None };
        let sound = |simulation: &mut Simulation| {
            simulation.forward().map_err(|fault| {
                told(&format!("the model cannot be simulated at its start: {fault}"), "see that it simulates by itself")
            })
        };
        sound(&mut simulation)?;
        let closing = close(&mut spec, &mut simulation);
        sound(&mut simulation)?;
        let (driven, moved) = driven(&simulation, &has);
        Ok(Self { additions, spec, anatomy, has, keyframe, lifted, closing, simulation, driven, moved })
    }

    /// Whether a body is `of` or belongs to it.
    pub(super) fn is_below(&self, body: BodyId, of: BodyId) -> bool {
        let mut at = Some(body);
        while let Some(body) = at {
            if body == of {
                return true;
            }
            at = self.has.bodies[body.index()].parent;
        }
        false
    }

    /// Whether actuators move a body that is `of` or belongs to it.
    pub(super) fn moves_itself(&self, of: BodyId) -> bool {
        self.moved.iter().any(|&body| self.is_below(body, of))
    }

    /// Whether a body is moved by actuators, itself or with what it belongs to.
    pub(super) fn is_moved(&self, body: BodyId) -> bool {
        self.moved.iter().any(|&moved| self.is_below(body, moved))
    }

    /// One number of the model as its text has it, by the path of the field; 0 where there is none.
    pub(super) fn field(&self, path: &str) -> f64 {
        field(&self.spec, path)
    }

    /// The name of an element in a formula or path: `joint.knee`, `joint."left knee"`, `joint.#2`.
    pub(super) fn word(&self, kind: &str, index: usize) -> String {
        let a = &self.anatomy;
        let name = match kind {
            "joint" => a.joints[index].name.as_str(),
            "body" => &a.bodies[index],
            "geom" => &a.geoms[index],
            "site" => &a.sites[index],
            "tendon" => &a.tendons[index],
            "sensor" => &a.sensors[index].name,
            _ => &a.actuators[index].name,
        };
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') && name.chars().all(plain) {
            format!("{kind}.{name}")
        } else if name.is_empty() || name.contains(|c: char| c.is_control() || "\"'\\".contains(c)) {
            format!("{kind}.#{index}")
        } else {
            format!("{kind}.\"{name}\"")
        }
    }

    /// What a hinge or slide has to move at the start, kg·m² or kg.
    pub(super) fn inertia(&self, joint: usize) -> f64 {
        let (dof, count) = (self.has.joints[joint].address.dof.start, self.has.nv);
        let mut matrix = vec![0.0; count * count];
        self.simulation.mass_matrix(&mut matrix);
        matrix[dof * count + dof]
    }

    /// Whether an actuator is told where to go, and not how hard to push.
    pub(super) fn is_servo(&self, actuator: usize) -> bool {
        self.field(&format!("actuator.#{actuator}.biasprm[1]")) != 0.0
    }

    /// Limits of a command: the model's, or what makes sense.
    pub(super) fn limits(&self, actuator: usize) -> ([f64; 2], bool) {
        let entry = &self.has.actuators[actuator];
        if let Some(limits) = entry.control_range {
            return (limits, true);
        }
        let range = match entry.drives {
            Drive::Joint(joint, _) if self.is_servo(actuator) => self.has.joints[joint].range,
            _ => None,
        };
        (range.unwrap_or([-1.0, 1.0]), false)
    }
}

fn field(spec: &Spec, path: &str) -> f64 {
    path.parse().ok().and_then(|path| spec.field(&path).ok()).unwrap_or(0.0)
}

/// What a model lacks: motors where it has no actuator; where a URDF has several limbs, a free base and a floor.
fn additions(spec: &Spec, mut bare: Simulation, main: &str) -> Result<Additions, AnyError> {
    let has = bare.inventory();
    if has.joints.is_empty() {
        let hint = "a joint lets a body move: <joint name=\"knee\" type=\"hinge\" axis=\"0 1 0\"/>";
        return Err(told(&format!("nothing in {main} moves: it has no joint"), hint));
    }
    let mut additions = Additions::default();
    if !has.actuators.is_empty() {
        return Ok(additions);
    }
    // Positions of bodies; a start that cannot be simulated is told later.
    let _ = bare.forward();
    for (i, joint) in has.joints.iter().enumerate() {
        let (JointType::Hinge | JointType::Slide, Some(name)) = (joint.kind, &joint.name) else { continue };
        let written = field(spec, &format!("joint.#{i}.actuatorfrcrange[1]"));
        let gear = if written > 0.0 { written } else { strength(&bare, &has, i) };
        additions.motors.push((name.clone(), gear, [-1.0, 1.0]));
    }
    if additions.motors.is_empty() {
        let single =
            |joint: &hwasp_mujoco::engine::JointEntry| matches!(joint.kind, JointType::Hinge | JointType::Slide);
        let (lack, hint) = if has.joints.iter().any(single) {
            ("and no joint with a name for a motor", "give its hinges and slides names, or add actuators to the model")
        } else {
            (
                "and motors are added to hinges and slides, of which it has none",
                "add actuators to the model: <motor site=\"…\" gear=\"0 0 1 0 0 0\"/> pushes at a place, <motor joint=\"…\" \
                 gear=\"1 0 0\"/> turns a ball about an axis",
            )
        };
        return Err(told(&format!("nothing drives {main}: it has no actuator, {lack}"), hint));
    }
    // Only models without actuators come this far, as URDF are: of a robot with one base, limbs make legs or wheels of it.
    let bases: Vec<BodyId> =
        has.bodies.iter().filter(|body| body.parent.is_some_and(|p| p.index() == 0)).map(|body| body.id).collect();
    if let ([base], false) = (&bases[..], has.joints.iter().any(|joint| joint.kind == JointType::Free)) {
        let is_limb = |joint: &&hwasp_mujoco::engine::JointEntry| has.bodies[joint.body.index()].parent == Some(*base);
        let held = has.joints.iter().any(|joint| joint.body == *base);
        if !held && has.joints.iter().filter(is_limb).count() > 1 {
            additions.free_base = true;
            additions.floor = !has.geoms.iter().any(|geom| geom.shape == "plane");
        }
    }
    Ok(additions)
}

/// What a motor needs to hold what its joint carries, twice, N·m or N, of two digits.
fn strength(simulation: &Simulation, has: &Inventory, joint: usize) -> f64 {
    let body = has.joints[joint].body;
    let weight = GRAVITY * has.bodies[body.index()].subtree_mass;
    let arm = if has.joints[joint].kind == JointType::Slide {
        1.0
    } else {
        let at = simulation.body_position(body);
        let mut farthest = 0.1_f64;
        for other in &has.bodies {
            let mut above = other.parent;
            while above.is_some_and(|above| above != body) {
                above = above.and_then(|above| has.bodies[above.index()].parent);
            }
            if other.id == body || above == Some(body) {
                let centre = simulation.body_center(other.id);
                let distance = (0..3).map(|k| (centre[k] - at[k]).powi(2)).sum::<f64>().sqrt();
                farthest = farthest.max(distance);
            }
        }
        farthest
    };
    digits(2.0 * weight * arm, 2).max(0.01)
}

/// A number with so many digits.
pub(super) fn digits(value: f64, count: usize) -> f64 {
    format!("{value:.*e}", count.saturating_sub(1)).parse().unwrap_or(value)
}

/// Lifts a free base until nothing touches the floor any more; where that is, if it has to be lifted.
fn stand(simulation: &mut Simulation, has: &Inventory) -> Option<(usize, f64)> {
    let at = simulation.joint("root").ok()?.qpos.start + 2;
    let floor = has.geoms.iter().find(|geom| geom.shape == "plane")?.id;
    let mut touches = |height: f64| {
        simulation.qpos_mut()[at] = height;
        // What cannot be simulated here is told where the start is computed.
        let _ = simulation.forward();
        simulation.contacts().any(|contact| contact.geoms.contains(&floor))
    };
    if !touches(0.0) {
        return None;
    }
    let (mut low, mut high) = (0.0, 0.1);
    while touches(high) {
        (low, high) = (high, 2.0 * high);
        if high > HIGHEST {
            return None;
        }
    }
    for _ in 0..12 {
        let middle = 0.5 * (low + high);
        if touches(middle) { low = middle } else { high = middle }
    }
    let height = (1e3 * high).ceil() / 1e3;
    touches(height);
    Some((at, height))
}

/// Which joints actuators drive, and which bodies.
fn driven(simulation: &Simulation, has: &Inventory) -> (Vec<bool>, Vec<BodyId>) {
    let mut driven = vec![false; has.joints.len()];
    let mut moved = Vec::new();
    let mut moment = vec![0.0; has.nv];
    for actuator in &has.actuators {
        match actuator.drives {
            Drive::Joint(joint, _) => driven[joint] = true,
            Drive::Tendon(tendon, _) => {
                simulation.tendon_moment(tendon, &mut moment);
                for (own, joint) in driven.iter_mut().zip(&has.joints) {
                    *own |= joint.address.dof.clone().any(|dof| moment[dof] != 0.0);
                }
            }
            Drive::Site(site, _) => moved.push(has.sites[site.index()].body),
            Drive::Other(_) => {}
        }
    }
    moved.extend(has.joints.iter().zip(&driven).filter(|(_, driven)| **driven).map(|(joint, _)| joint.body));
    (driven, moved)
}
