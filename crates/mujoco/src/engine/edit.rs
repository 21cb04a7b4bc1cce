//! Changes of the model in place, for domain randomisation.

use mujoco_rs::prelude::MjModel;

use super::{BodyId, GeomId, Shape, Simulation};

/// The smallest mass and inertia that the engine takes for one (`mjMINVAL`); below it ends the process.
const MIN_VALUE: f64 = 1e-15;

/// A value that the model cannot take. What was edited before it stays.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// A length of a shape.
    #[error("a length of {value} m of {shape:?} is not positive and finite")]
    Length {
        /// The shape.
        shape: Shape,
        /// Its first such length, m.
        value: f64,
    },
    /// A mass.
    #[error("a mass of {0} kg is not finite and at least 1e-15 kg")]
    Mass(f64),
    /// Moments of inertia.
    #[error(
        "no rigid body has the moments of inertia {0:?} kg·m²: each is to be at least 1e-15 and at most the sum of the others"
    )]
    Inertia([f64; 3]),
    /// Coefficients of friction.
    #[error("the friction {0:?} (slide, spin in m, roll in m) is not finite and at least 0")]
    Friction([f64; 3]),
    /// A geom that is none of the shapes.
    #[error(
        "only a sphere, capsule, box, cylinder or ellipsoid can be given another shape; this geom is a plane, mesh or field"
    )]
    NoShape,
}

impl Simulation {
    /// Starts changes of the model. When they end, the engine's derived constants are computed anew and the simulation is
    /// reset; the result is to the bit that of a model compiled with the changes.
    pub fn edit(&mut self) -> ModelEdit<'_> {
        ModelEdit { simulation: self, constants: false }
    }
}

/// Changes of a model, which take effect when this is dropped.
#[derive(Debug)]
#[must_use = "changes that are dropped at once reset the simulation and change nothing"]
pub struct ModelEdit<'a> {
    simulation: &'a mut Simulation,
    /// Whether derived constants depend on what was changed.
    constants: bool,
}

impl ModelEdit<'_> {
    /// Gives a geom a shape. Mass and inertia of its body are another change ([`Self::inertial`]).
    pub fn shape(&mut self, geom: GeomId, shape: Shape) -> Result<&mut Self, EditError> {
        if let Some(value) = shape.lengths().find(|length| !(length.is_finite() && *length > 0.0)) {
            return Err(EditError::Length { shape, value });
        }
        if !is_primitive(self.simulation.model(), geom) {
            return Err(EditError::NoShape);
        }
        self.constants = true;
        let model = self.model_mut();
        model.geom_size_mut()[geom.0] = shape.geom_size();
        #[expect(unsafe_code, reason = "the wrapper offers types in no other way")]
        // SAFETY: unsafe because types with data of their own (meshes, height fields) are indices into it; neither the
        // geom's old type nor the new one has any.
        let types = unsafe { model.geom_type_mut() };
        types[geom.0] = shape.geom_type();
        Ok(self)
    }

    /// Gives a body a mass, kg, and moments of inertia about the axes of its inertial frame, kg·m². Centre of mass and
    /// frame stay where they are.
    pub fn inertial(&mut self, body: BodyId, mass: f64, inertia: [f64; 3]) -> Result<&mut Self, EditError> {
        if !(mass.is_finite() && mass >= MIN_VALUE) {
            return Err(EditError::Mass(mass));
        }
        let [x, y, z] = inertia;
        // Rounding may take a flat body's largest moment above the sum of the others.
        let balanced = |a: f64, b: f64, c: f64| a <= (b + c) * (1.0 + 1e-9);
        let possible = inertia.iter().all(|moment| moment.is_finite() && *moment >= MIN_VALUE);
        if !(possible && balanced(x, y, z) && balanced(y, x, z) && balanced(z, x, y)) {
            return Err(EditError::Inertia(inertia));
        }
        self.constants = true;
        let model = self.model_mut();
        model.body_mass_mut()[body.0] = mass;
        model.body_inertia_mut()[body.0] = inertia;
        Ok(self)
    }

    /// Gives a geom coefficients of friction: sliding (without unit), spinning and rolling (m).
    pub fn friction(&mut self, geom: GeomId, friction: [f64; 3]) -> Result<&mut Self, EditError> {
        if !friction.iter().all(|coefficient| coefficient.is_finite() && *coefficient >= 0.0) {
            return Err(EditError::Friction(friction));
        }
        self.model_mut().geom_friction_mut()[geom.0] = friction;
        Ok(self)
    }

    #[expect(unsafe_code, reason = "the wrapper offers the arrays of a model in use in no other way")]
    fn model_mut(&mut self) -> &mut MjModel {
        // SAFETY: unsafe because the whole model could be exchanged for one of other sizes, or its addresses changed. The
        // reference stays within this type, which only writes values into arrays.
        unsafe { self.simulation.data_mut().model_mut() }
    }
}

impl Drop for ModelEdit<'_> {
    fn drop(&mut self) {
        if self.constants {
            self.simulation.data_mut().set_const();
        }
        self.simulation.reset();
    }
}

fn is_primitive(model: &MjModel, geom: GeomId) -> bool {
    use mujoco_rs::prelude::MjtGeomBase as Type;
    matches!(
        model.geom_type()[geom.0],
        Type::mjGEOM_SPHERE | Type::mjGEOM_CAPSULE | Type::mjGEOM_ELLIPSOID | Type::mjGEOM_CYLINDER | Type::mjGEOM_BOX
    )
}
