//! Leaving out what is only seen.

use mujoco_rs::prelude::{MjModel, MjSpec};

use super::super::{BuildError, log};
use super::find::parent;
use super::message;
use super::{Spec, plain};

impl Spec {
    /// Takes out textures, materials, geoms that touch nothing and the meshes of those, as far as no other element names
    /// them. Most of the time that the compiler needs goes into textures. Pictures want the whole model: keep another
    /// `Spec` for them.
    ///
    /// Masses and inertias stay to the bit, and so does the motion. They also stay what they were to a design: a geom that
    /// gives its body mass stays too, because the body could not follow a change of its other geoms any more if its
    /// inertia were written down.
    ///
    /// Returns whether it was done. If a mass, an inertia or the number of coordinates would not stay, nothing is changed.
    ///
    /// # Errors
    ///
    /// The model does not compile.
    pub fn discard_visual(&mut self) -> Result<bool, BuildError> {
        let mut copy = self.copy()?;
        let before = self.compiled(&mut copy)?;
        drop(copy);
        let mut lean = self.copy()?;
        let kept: Vec<usize> = lean
            .geom_iter()
            .enumerate()
            .filter(|(_, geom)| geom.contype() == 0 && geom.conaffinity() == 0)
            .filter(|(_, geom)| {
                let body = parent(&lean, *geom).filter(|&(place, _)| place > 0);
                body.is_some_and(|(_, body)| self.inferred(body)) && geom.mass() != 0.0
            })
            .map(|(place, _)| place)
            .collect();
        // What could touch something is not discarded.
        let mark = format!("{}/kept", self.mount.path(""));
        let mut infos = Vec::new();
        for (place, geom) in lean.geom_iter_mut().enumerate() {
            if kept.binary_search(&place).is_ok() {
                geom.set_conaffinity(1);
                infos.push(geom.info().to_owned());
                geom.set_info(&mark);
            }
        }
        let (discarded, warnings) = log::warnings_of(|| lean.discard_visual_with_vfs(self.mount.vfs()));
        self.note(warnings);
        if discarded.is_err() {
            return Ok(false);
        }
        // The kept geoms are still in their order.
        let mut infos = infos.into_iter();
        for geom in lean.geom_iter_mut() {
            if geom.info() == mark {
                geom.set_conaffinity(0);
                geom.set_info(&infos.next().unwrap_or_default());
            }
        }
        let same = same_bodies(&before, &self.compiled(&mut lean)?);
        if same {
            self.inner = lean;
        }
        Ok(same)
    }

    fn compiled(&self, spec: &mut MjSpec) -> Result<MjModel, BuildError> {
        let (compiled, _) = log::warnings_of(|| spec.compile_with_vfs(self.mount.vfs()));
        compiled.map_err(|error| message::error(&self.mount, &self.main, &plain(error)))
    }
}

/// Whether two models move alike, as far as bodies say it: to the bit.
fn same_bodies(a: &MjModel, b: &MjModel) -> bool {
    fn same<const N: usize>(a: &[[f64; N]], b: &[[f64; N]]) -> bool {
        let bits = |values: &[[f64; N]]| values.iter().flatten().map(|value| value.to_bits()).collect::<Vec<_>>();
        bits(a) == bits(b)
    }
    (a.nq(), a.nv(), a.nu(), a.na(), a.nbody()) == (b.nq(), b.nv(), b.nu(), b.na(), b.nbody())
        && a.body_mass().iter().map(|mass| mass.to_bits()).eq(b.body_mass().iter().map(|mass| mass.to_bits()))
        && same(a.body_inertia(), b.body_inertia())
        && same(a.body_ipos(), b.body_ipos())
        && same(a.body_iquat(), b.body_iquat())
}
