//! What the engine would take, and end the process over later.

use std::panic::{AssertUnwindSafe, catch_unwind};

use mujoco_rs::prelude::SpecElement;
use mujoco_rs::wrappers::mj_editing::{MjsOrientation, MjtOrientation};

use super::super::{BuildError, Kind};
use super::fields::{KINDS, fields};
use super::{FieldPath, Spec};

/// Kinds whose elements have names.
const NAMED: [Kind; 10] = [
    Kind::Body,
    Kind::Geom,
    Kind::Joint,
    Kind::Actuator,
    Kind::Tendon,
    Kind::Camera,
    Kind::Site,
    Kind::Sensor,
    Kind::Keyframe,
    Kind::Equality,
];

impl Spec {
    /// Refuses names that are no text, on which the wrapper panics. Texts that are not UTF-8 are refused before they are read,
    /// unless they begin with something else than XML, which the engine passes over.
    pub(super) fn check_names(&self) -> Result<(), BuildError> {
        let read = || {
            let targets = self.inner.actuator_iter().map(|actuator| actuator.target().len()).sum::<usize>();
            NAMED.into_iter().map(|kind| self.names(kind).len()).sum::<usize>() + targets
        };
        catch_unwind(AssertUnwindSafe(read))
            .map(drop)
            .or_else(|_| self.refuse("a name in it or in a file that it includes is not UTF-8".to_owned()))
    }

    /// Refuses sizes of a text that ask for more memory than machines have.
    pub(super) fn check_sizes(&self) -> Result<(), BuildError> {
        const MOST_MEMORY: i64 = 1 << 34;
        const MOST_PIXELS: i64 = 1 << 28;
        let memory = self.inner.memory();
        if memory > MOST_MEMORY {
            return self.refuse(format!("`<size memory>` asks for {memory} bytes; the most is 16G"));
        }
        for texture in self.inner.texture_iter() {
            let [width, height] = [texture.width(), texture.height()].map(i64::from);
            if width < 0 || height < 0 || width.saturating_mul(height) > MOST_PIXELS {
                return self
                    .refuse(format!("a texture of {width} × {height} pixels has more than 2^28 or a negative side"));
            }
        }
        Ok(())
    }

    /// Refuses numbers that the engine takes without a word: places without end, spheres of 1e30 m, time that stands still.
    pub(super) fn check_values(&self) -> Result<(), BuildError> {
        const MOST: f64 = 1e10;
        // Until the compiler computes them, such numbers are NaN.
        const COMPUTED: [&str; 5] = ["size", "fromto", "mass", "ipos", "fullinertia"];
        for kind in KINDS {
            for (place, item) in self.items(kind).into_iter().enumerate() {
                for (field, index) in
                    fields(kind).iter().flat_map(|field| (0..field.len).map(move |index| (field, index)))
                {
                    let value = item.number(field.name, index);
                    let good = value.abs() <= MOST || value.is_nan() && COMPUTED.contains(&field.name);
                    if !good || field.name == "timestep" && !field.limits(0).hold(value) {
                        let path = FieldPath::of(kind, place, field.name, index);
                        return self.refuse(format!("`{path}` = {value} is no value for a model"));
                    }
                }
            }
        }
        Ok(())
    }

    /// Refuses quaternions without a direction. The engine makes matrices of zeros from them, and then cannot say how geoms
    /// touch.
    pub(super) fn check_quaternions(&self) -> Result<(), BuildError> {
        let written = |alt: &MjsOrientation| alt.type_ == MjtOrientation::mjORIENTATION_QUAT;
        let spec = &self.inner;
        for body in spec.body_iter() {
            if written(body.alt()) {
                self.check_quaternion("body", body.name(), body.quat())?;
            }
            if !body.ipos()[0].is_nan() && written(body.ialt()) {
                self.check_quaternion("inertia of the body", body.name(), body.iquat())?;
            }
        }
        for geom in spec.geom_iter().filter(|geom| geom.fromto()[0].is_nan() && written(geom.alt())) {
            self.check_quaternion("geom", geom.name(), geom.quat())?;
        }
        for site in spec.site_iter().filter(|site| site.fromto()[0].is_nan() && written(site.alt())) {
            self.check_quaternion("site", site.name(), site.quat())?;
        }
        for frame in spec.frame_iter().filter(|frame| written(frame.alt())) {
            self.check_quaternion("frame", frame.name(), frame.quat())?;
        }
        Ok(())
    }

    fn check_quaternion(&self, kind: &str, name: &str, quaternion: &[f64; 4]) -> Result<(), BuildError> {
        let length = quaternion.iter().map(|component| component * component).sum::<f64>().sqrt();
        if (1e-6..=1e6).contains(&length) {
            return Ok(());
        }
        self.refuse(format!(
            "the quaternion {quaternion:?} of the {kind} `{name}` has the length {length:e}; it says no direction outside \
             [1e-6, 1e6]"
        ))
    }

    fn refuse(&self, message: String) -> Result<(), BuildError> {
        Err(BuildError::Model { file: self.main.clone(), line: None, message })
    }
}
