//! What URDF lacks: a floor, motors, a base that is free.

use mujoco_rs::mujoco_c::mjtLimited;
use mujoco_rs::prelude::{MjtGeomBase, MjtJoint, MjtTrn, SpecElement, SpecItem};
use mujoco_rs::wrappers::mj_editing::MjsJoint;

use super::super::Kind;
use super::find::{body_mut, parent};
use super::{Element, Spec, SpecError};

impl Spec {
    /// Adds a floor: a plane without end at height 0, named `floor`.
    ///
    /// # Errors
    ///
    /// The model has a geom of that name.
    pub fn add_floor(&mut self) -> Result<(), SpecError> {
        self.new_name(Kind::Geom, "floor")?;
        let floor = self.inner.world_body_mut().add_geom();
        floor.set_type(MjtGeomBase::mjGEOM_PLANE);
        // Two sides without end; the third number is the distance of lines in pictures, m.
        *floor.size_mut() = [0.0, 0.0, 1.0];
        named(floor, "floor")
    }

    /// Adds a motor that drives a hinge or a slide: its torque (N·m) or force (N) is `gear` times its control, which is
    /// held within `limits`.
    ///
    /// # Errors
    ///
    /// The model has no such joint, the joint is of another type, the name is taken or empty, or a number is not finite
    /// and within 1e9, or the limits are none.
    pub fn add_motor(&mut self, joint: &str, name: &str, gear: f64, limits: [f64; 2]) -> Result<(), SpecError> {
        let place = self.place(Kind::Joint, &Element::Name(joint.to_owned()))?;
        let kind = self.inner.joint_iter().nth(place).map(MjsJoint::type_);
        if !matches!(kind, Some(MjtJoint::mjJNT_HINGE | MjtJoint::mjJNT_SLIDE)) {
            return Err(SpecError::Addition(format!(
                "a motor drives a hinge or a slide; `{joint}` is a ball or free joint"
            )));
        }
        self.new_name(Kind::Actuator, name)?;
        let [low, high] = limits;
        let within = |value: f64| value.abs() <= 1e9;
        if !within(gear) {
            return Err(SpecError::Addition(format!("the gear {gear} of the motor `{name}` is outside [-1e9, 1e9]")));
        }
        if !(within(low) && within(high) && low < high) {
            return Err(SpecError::Addition(format!(
                "the limits [{low}, {high}] of the motor `{name}` are no range within [-1e9, 1e9]"
            )));
        }
        let motor = self.inner.add_actuator();
        motor.set_to_motor();
        motor.set_trntype(MjtTrn::mjTRN_JOINT);
        motor.set_target(joint);
        // What the default class says does not count.
        *motor.gear_mut() = [gear, 0.0, 0.0, 0.0, 0.0, 0.0];
        *motor.ctrlrange_mut() = limits;
        motor.set_ctrllimited(mjtLimited::mjLIMITED_TRUE);
        named(motor, name)
    }

    /// Lets the base of the robot move freely, by a free joint named `root`. The base is the only body in the world.
    ///
    /// # Errors
    ///
    /// There are several bodies in the world or none, the base has joints already, or a joint is called `root`.
    pub fn free_base(&mut self) -> Result<(), SpecError> {
        let refuse = |reason: String| Err(SpecError::Addition(reason));
        let spec = &self.inner;
        let in_world =
            |&(place, body): &(usize, &_)| place > 0 && parent(spec, body).is_some_and(|(parent, _)| parent == 0);
        let bases: Vec<(usize, String)> = spec
            .body_iter()
            .enumerate()
            .filter(in_world)
            .map(|(place, body)| (place, body.name().to_owned()))
            .collect();
        let (place, base) = match &bases[..] {
            [(place, base)] => (*place, base.clone()),
            [] => return refuse("the model has no body that could be let free".to_owned()),
            several => {
                let names: Vec<&str> = several.iter().map(|(_, name)| name.as_str()).collect();
                return refuse(format!(
                    "the world has several bodies ({}); only a robot with one base can be let free",
                    names.join(", ")
                ));
            }
        };
        if spec.joint_iter().any(|joint| parent(spec, joint).is_some_and(|(parent, _)| parent == place)) {
            return refuse(format!("the base `{base}` has a joint already"));
        }
        self.new_name(Kind::Joint, "root")?;
        let base = body_mut(&mut self.inner, place).expect("the place was found a moment ago");
        named(base.add_free_joint(), "root")
    }

    fn new_name(&self, kind: Kind, name: &str) -> Result<(), SpecError> {
        let taken = match kind {
            // Their names here may be those of joints.
            Kind::Actuator => self.inner.actuator_iter().any(|actuator| actuator.name() == name),
            _ => self.names(kind).iter().any(|known| known == name),
        };
        if taken {
            Err(SpecError::Addition(format!("the name `{name}` is taken by another {kind}")))
        } else if name.is_empty() || name.contains(char::is_control) {
            Err(SpecError::Addition(format!("{name:?} is no name (for the new {kind})")))
        } else {
            Ok(())
        }
    }
}

fn named(item: &mut impl SpecItem, name: &str) -> Result<(), SpecError> {
    item.set_name(name).map_err(|error| SpecError::Addition(format!("MuJoCo does not take the name `{name}`: {error}")))
}
