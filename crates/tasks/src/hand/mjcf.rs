//! The hand, the object and the floor as a `MuJoCo` model, generated from the description.

mod drive;
mod parts;
mod settings;

pub use drive::Drive;
pub(super) use parts::link_colour;

use super::description::HandDescription;
use super::error::{HandError, positive, within};
use super::names::{DIGITS, KINDS};
use super::xml::Element;

/// What of the model can be chosen beside the hand itself.
#[derive(Clone, Debug, PartialEq)]
pub struct MjcfOptions {
    /// What moves the joints.
    pub drive: Drive,
    /// Whether there is gravity. Checks of the free mechanism turn it off.
    pub gravity: bool,
    /// Whether there is an object.
    pub object: bool,
}

impl Default for MjcfOptions {
    fn default() -> Self {
        Self { drive: Drive::JointTorque, gravity: true, object: true }
    }
}

/// The model in `MuJoCo`'s XML. Everything in it that code needs to find has a name in [`names`](super::names).
pub fn mjcf(hand: &HandDescription, options: &MjcfOptions) -> Result<String, HandError> {
    hand.check()?;
    if let Drive::NativeTendon { design } = &options.drive {
        for (i, &value) in design.iter().enumerate() {
            let kind = KINDS[i % 4];
            match i / 4 {
                0 => positive(&format!("{kind}_radius"), value, "m")?,
                1 => positive(&format!("{kind}_stiffness"), value, "N·m/rad")?,
                _ => within(&format!("{kind}_preload"), value, 0.0, f64::MAX, "rad")?,
            }
        }
    }
    let palm = parts::palm(hand).with_all((0..DIGITS.len()).map(|digit| parts::digit(hand, digit, &options.drive)));
    let world = Element::new("worldbody")
        .with(parts::light())
        .with(parts::camera(hand))
        .with(parts::floor(hand))
        .with(palm)
        .with_all(options.object.then(|| parts::object(hand)));
    let model = Element::new("mujoco")
        .set("model", "underactuated hand")
        .with(Element::new("compiler").set("angle", "radian").set("autolimits", true))
        .with(settings::option(hand, options.gravity))
        .with(settings::visual())
        .with(settings::asset())
        .with(world)
        .with_all(drive::tendons(&options.drive))
        .with_all(drive::motor(hand, &options.drive))
        .with(drive::actuators(hand, &options.drive))
        .with(parts::home(hand, options));
    Ok(model.to_text())
}

#[cfg(test)]
mod tests {
    use super::super::names;
    use super::super::space::PAPER_HWASP;
    use super::*;

    fn text(options: &MjcfOptions) -> String {
        mjcf(&HandDescription::default(), options).unwrap()
    }

    /// Every element is closed in the order it was opened, and every quote is paired.
    fn well_formed(text: &str) -> bool {
        let mut open = Vec::new();
        for tag in text.split('<').skip(1) {
            let Some((tag, rest)) = tag.split_once('>') else { return false };
            if !rest.trim().is_empty() || tag.matches('"').count() % 2 != 0 {
                return false;
            }
            let name = tag.trim_start_matches('/').split([' ', '/']).next().unwrap_or_default();
            if tag.starts_with('/') {
                if open.pop() != Some(name) {
                    return false;
                }
            } else if !tag.ends_with('/') {
                open.push(name);
            }
        }
        open.is_empty()
    }

    #[test]
    fn every_name_is_there_once() {
        let torque = text(&MjcfOptions::default());
        let drive = Drive::NativeTendon { design: PAPER_HWASP };
        let native = text(&MjcfOptions { drive, ..MjcfOptions::default() });
        let named = |text: &str, name: &str| text.matches(&format!(" name=\"{name}\"")).count();
        let both =
            [names::PALM, names::PALM_GEOM, names::OBJECT, names::OBJECT_JOINT, names::OBJECT_GEOM, names::FLOOR];
        let lists =
            [&names::JOINTS[..], &names::LINK_BODIES, &names::LINK_GEOMS, &names::PALM_JOINTS, &names::PALM_ACTUATORS];
        for name in both.iter().chain(&[names::CAMERA, names::HOME]).chain(lists.into_iter().flatten()) {
            assert_eq!((named(&torque, name), named(&native, name)), (1, 1), "{name}");
        }
        for name in names::TORQUE_ACTUATORS {
            assert_eq!((named(&torque, name), named(&native, name)), (1, 0), "{name}");
        }
        for name in names::TENDONS.iter().chain(&names::TENDON_ACTUATORS) {
            assert_eq!((named(&torque, name), named(&native, name)), (0, 1), "{name}");
        }
        assert!(well_formed(&torque) && well_formed(&native));
        assert!(!well_formed(&torque.replace("</worldbody>", "")));
    }

    #[test]
    fn springs_and_pulleys_are_those_of_the_design() {
        let drive = Drive::NativeTendon { design: PAPER_HWASP };
        let native = text(&MjcfOptions { drive, ..MjcfOptions::default() });
        assert_eq!(native.matches(r#"stiffness="0.0062" springref="-2""#).count(), 1);
        assert_eq!(native.matches(r#"stiffness="0.0059" springref="-1.1""#).count(), 2);
        assert!(native.contains(r#"<joint joint="finger2_distal" coef="0.0026"/>"#));
        assert!(native.contains(r#"gainprm="5000" biastype="affine" biasprm="0 -5000 0""#));
        assert!(!text(&MjcfOptions::default()).contains("springref"));
    }

    #[test]
    fn fixtures_leave_out_what_they_say() {
        let bare = text(&MjcfOptions { gravity: false, object: false, ..MjcfOptions::default() });
        assert!(!bare.contains(names::OBJECT) && bare.contains(r#"gravity="0 0 0""#));
        assert!(text(&MjcfOptions::default()).contains(r#"gravity="0 0 -9.81""#));
    }

    #[test]
    fn impossible_tendons_are_refused() {
        let mut design = PAPER_HWASP;
        design[6] = -0.1;
        let options = MjcfOptions { drive: Drive::NativeTendon { design }, ..MjcfOptions::default() };
        let error = mjcf(&HandDescription::default(), &options).unwrap_err().to_string();
        assert_eq!(error, "finger_proximal_stiffness = -0.1 N·m/rad is not a positive finite number");
    }
}
