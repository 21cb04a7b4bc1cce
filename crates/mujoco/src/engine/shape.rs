//! Shapes a geom can be edited to.

use std::f64::consts::PI;

use mujoco_rs::prelude::MjtGeomBase;

/// A convex shape, centred on its geom, in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A ball.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// A box.
    Box {
        /// Half the edges along x, y and z.
        half: [f64; 3],
    },
    /// A cylinder along z.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Half the length.
        half_length: f64,
    },
    /// An ellipsoid.
    Ellipsoid {
        /// Half the axes along x, y and z.
        radii: [f64; 3],
    },
}

impl Shape {
    /// Volume, m³.
    pub fn volume(&self) -> f64 {
        match *self {
            Self::Sphere { radius } => 4.0 / 3.0 * PI * radius.powi(3),
            Self::Box { half: [x, y, z] } => 8.0 * x * y * z,
            Self::Cylinder { radius, half_length } => 2.0 * PI * radius * radius * half_length,
            Self::Ellipsoid { radii: [x, y, z] } => 4.0 / 3.0 * PI * x * y * z,
        }
    }

    /// Moments of inertia about x, y and z through the centre when `mass` (kg) fills the shape evenly, kg·m².
    pub fn inertia(&self, mass: f64) -> [f64; 3] {
        let solid = |factor: f64, [x, y, z]: [f64; 3]| {
            [factor * mass * (y * y + z * z), factor * mass * (x * x + z * z), factor * mass * (x * x + y * y)]
        };
        match *self {
            Self::Sphere { radius } => [0.4 * mass * radius * radius; 3],
            Self::Box { half } => solid(1.0 / 3.0, half),
            Self::Cylinder { radius, half_length } => {
                let across = mass * (3.0 * radius * radius + 4.0 * half_length * half_length) / 12.0;
                [across, across, 0.5 * mass * radius * radius]
            }
            Self::Ellipsoid { radii } => solid(0.2, radii),
        }
    }

    /// The engine's type.
    pub(super) fn geom_type(&self) -> MjtGeomBase {
        match self {
            Self::Sphere { .. } => MjtGeomBase::mjGEOM_SPHERE,
            Self::Box { .. } => MjtGeomBase::mjGEOM_BOX,
            Self::Cylinder { .. } => MjtGeomBase::mjGEOM_CYLINDER,
            Self::Ellipsoid { .. } => MjtGeomBase::mjGEOM_ELLIPSOID,
        }
    }

    /// The engine's size, m; what a type does not use is zero, as its compiler leaves it.
    pub(super) fn geom_size(&self) -> [f64; 3] {
        match *self {
            Self::Sphere { radius } => [radius, 0.0, 0.0],
            Self::Box { half: size } | Self::Ellipsoid { radii: size } => size,
            Self::Cylinder { radius, half_length } => [radius, half_length, 0.0],
        }
    }

    /// The lengths of the shape, each of which has to be positive.
    pub(super) fn lengths(&self) -> impl Iterator<Item = f64> {
        let used = match self {
            Self::Sphere { .. } => 1,
            Self::Cylinder { .. } => 2,
            Self::Box { .. } | Self::Ellipsoid { .. } => 3,
        };
        self.geom_size().into_iter().take(used)
    }
}
