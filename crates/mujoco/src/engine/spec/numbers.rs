//! The numbers themselves, in the engine's specification, by field and index. The table in [`super::fields`] says which there
//! are; angles are as the text has them.

use mujoco_rs::prelude::MjOption;
use mujoco_rs::wrappers::mj_editing::{MjsActuator, MjsBody, MjsEquality, MjsGeom, MjsJoint, MjsSite, MjsTendon};

/// Something with numbers that have names.
pub(super) trait Numbers {
    /// One number of a field.
    ///
    /// # Panics
    ///
    /// If the table of fields has no such field or index.
    fn number(&self, field: &str, index: usize) -> f64;

    /// Writes one number of a field.
    ///
    /// # Panics
    ///
    /// As [`Self::number`].
    fn set_number(&mut self, field: &str, index: usize, value: f64);
}

/// `name` is MJCF's; then what reads all numbers of the field, and what gives them to be written.
macro_rules! numbers {
    ($type:ty: $($name:literal => $read:expr, $write:expr;)*) => {
        impl Numbers for $type {
            fn number(&self, field: &str, index: usize) -> f64 {
                match field {
                    $($name => {
                        let read: fn(&$type, usize) -> f64 = $read;
                        read(self, index)
                    })*
                    other => unreachable!("the table of fields has `{other}`, and nothing reads it"),
                }
            }

            fn set_number(&mut self, field: &str, index: usize, value: f64) {
                match field {
                    $($name => {
                        let write: fn(&mut $type, usize, f64) = $write;
                        write(self, index, value);
                    })*
                    other => unreachable!("the table of fields has `{other}`, and nothing writes it"),
                }
            }
        }
    };
}

numbers! {
    MjsBody:
    "pos" => |b, i| b.pos()[i], |b, i, v| b.pos_mut()[i] = v;
    "quat" => |b, i| b.quat()[i], |b, i, v| b.quat_mut()[i] = v;
    "euler" => |b, i| b.alt().euler[i], |b, i, v| b.alt_mut().euler[i] = v;
    "mass" => |b, _| b.mass(), |b, _, v| b.set_mass(v);
    "ipos" => |b, i| b.ipos()[i], |b, i, v| b.ipos_mut()[i] = v;
    "inertia" => |b, i| b.inertia()[i], |b, i, v| b.inertia_mut()[i] = v;
    "fullinertia" => |b, i| b.fullinertia()[i], |b, i, v| b.fullinertia_mut()[i] = v;
    "gravcomp" => |b, _| b.gravcomp(), |b, _, v| b.set_gravcomp(v);
}

numbers! {
    MjsGeom:
    "pos" => |g, i| g.pos()[i], |g, i, v| g.pos_mut()[i] = v;
    "quat" => |g, i| g.quat()[i], |g, i, v| g.quat_mut()[i] = v;
    "euler" => |g, i| g.alt().euler[i], |g, i, v| g.alt_mut().euler[i] = v;
    "size" => |g, i| g.size()[i], |g, i, v| g.size_mut()[i] = v;
    "fromto" => |g, i| g.fromto()[i], |g, i, v| g.fromto_mut()[i] = v;
    "mass" => |g, _| g.mass(), |g, _, v| g.set_mass(v);
    "density" => |g, _| g.density(), |g, _, v| g.set_density(v);
    "friction" => |g, i| g.friction()[i], |g, i, v| g.friction_mut()[i] = v;
    "solref" => |g, i| g.solref()[i], |g, i, v| g.solref_mut()[i] = v;
    "solimp" => |g, i| g.solimp()[i], |g, i, v| g.solimp_mut()[i] = v;
    "margin" => |g, _| g.margin(), |g, _, v| g.set_margin(v);
    "gap" => |g, _| g.gap(), |g, _, v| g.set_gap(v);
}

numbers! {
    MjsSite:
    "pos" => |s, i| s.pos()[i], |s, i, v| s.pos_mut()[i] = v;
    "quat" => |s, i| s.quat()[i], |s, i, v| s.quat_mut()[i] = v;
    "euler" => |s, i| s.alt().euler[i], |s, i, v| s.alt_mut().euler[i] = v;
    "size" => |s, i| s.size()[i], |s, i, v| s.size_mut()[i] = v;
    "fromto" => |s, i| s.fromto()[i], |s, i, v| s.fromto_mut()[i] = v;
}

numbers! {
    MjsJoint:
    "pos" => |j, i| j.pos()[i], |j, i, v| j.pos_mut()[i] = v;
    "axis" => |j, i| j.axis()[i], |j, i, v| j.axis_mut()[i] = v;
    "stiffness" => |j, i| j.stiffness()[i], |j, i, v| j.stiffness_mut()[i] = v;
    "damping" => |j, i| j.damping()[i], |j, i, v| j.damping_mut()[i] = v;
    "springref" => |j, _| j.springref(), |j, _, v| j.set_springref(v);
    "ref" => |j, _| *j.ref_(), |j, _, v| *j.ref_mut() = v;
    "armature" => |j, _| j.armature(), |j, _, v| j.set_armature(v);
    "frictionloss" => |j, _| j.frictionloss(), |j, _, v| j.set_frictionloss(v);
    "range" => |j, i| j.range()[i], |j, i, v| j.range_mut()[i] = v;
    "actuatorfrcrange" => |j, i| j.actfrcrange()[i], |j, i, v| j.actfrcrange_mut()[i] = v;
    "margin" => |j, _| j.margin(), |j, _, v| j.set_margin(v);
    "solreflimit" => |j, i| j.solref_limit()[i], |j, i, v| j.solref_limit_mut()[i] = v;
    "solimplimit" => |j, i| j.solimp_limit()[i], |j, i, v| j.solimp_limit_mut()[i] = v;
}

numbers! {
    MjsActuator:
    "gear" => |a, i| a.gear()[i], |a, i, v| a.gear_mut()[i] = v;
    "ctrlrange" => |a, i| a.ctrlrange()[i], |a, i, v| a.ctrlrange_mut()[i] = v;
    "forcerange" => |a, i| a.forcerange()[i], |a, i, v| a.forcerange_mut()[i] = v;
    "actrange" => |a, i| a.actrange()[i], |a, i, v| a.actrange_mut()[i] = v;
    "gainprm" => |a, i| a.gainprm()[i], |a, i, v| a.gainprm_mut()[i] = v;
    "biasprm" => |a, i| a.biasprm()[i], |a, i, v| a.biasprm_mut()[i] = v;
    "dynprm" => |a, i| a.dynprm()[i], |a, i, v| a.dynprm_mut()[i] = v;
    "armature" => |a, _| a.armature(), |a, _, v| a.set_armature(v);
    "damping" => |a, i| a.damping()[i], |a, i, v| a.damping_mut()[i] = v;
    "cranklength" => |a, _| a.cranklength(), |a, _, v| a.set_cranklength(v);
}

numbers! {
    MjsTendon:
    "stiffness" => |t, i| t.stiffness()[i], |t, i, v| t.stiffness_mut()[i] = v;
    "damping" => |t, i| t.damping()[i], |t, i, v| t.damping_mut()[i] = v;
    "springlength" => |t, i| t.springlength()[i], |t, i, v| t.springlength_mut()[i] = v;
    "range" => |t, i| t.range()[i], |t, i, v| t.range_mut()[i] = v;
    "actuatorfrcrange" => |t, i| t.actfrcrange()[i], |t, i, v| t.actfrcrange_mut()[i] = v;
    "frictionloss" => |t, _| t.frictionloss(), |t, _, v| t.set_frictionloss(v);
    "armature" => |t, _| t.armature(), |t, _, v| t.set_armature(v);
    "width" => |t, _| t.width(), |t, _, v| t.set_width(v);
    "margin" => |t, _| t.margin(), |t, _, v| t.set_margin(v);
    "solreflimit" => |t, i| t.solref_limit()[i], |t, i, v| t.solref_limit_mut()[i] = v;
    "solimplimit" => |t, i| t.solimp_limit()[i], |t, i, v| t.solimp_limit_mut()[i] = v;
}

numbers! {
    MjsEquality:
    "data" => |e, i| e.data()[i], |e, i, v| e.data_mut()[i] = v;
    "solref" => |e, i| e.solref()[i], |e, i, v| e.solref_mut()[i] = v;
    "solimp" => |e, i| e.solimp()[i], |e, i, v| e.solimp_mut()[i] = v;
}

numbers! {
    MjOption:
    "timestep" => |o, _| o.timestep, |o, _, v| o.timestep = v;
    "gravity" => |o, i| o.gravity[i], |o, i, v| o.gravity[i] = v;
    "wind" => |o, i| o.wind[i], |o, i, v| o.wind[i] = v;
    "density" => |o, _| o.density, |o, _, v| o.density = v;
    "viscosity" => |o, _| o.viscosity, |o, _, v| o.viscosity = v;
    "impratio" => |o, _| o.impratio, |o, _, v| o.impratio = v;
    "tolerance" => |o, _| o.tolerance, |o, _, v| o.tolerance = v;
}
