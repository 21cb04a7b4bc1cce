//! What is to be seen of an environment, for films: solids where they are, and cords. Whoever draws needs no engine.

use std::sync::Arc;

/// One moment of an episode as it looks. Solids and cords are the same ones, in the same order, at every moment of it. SI; z is
/// up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sight {
    /// What is solid.
    pub solids: Vec<Solid>,
    /// Ways of tendons.
    pub cords: Vec<Cord>,
    /// What this episode is about, in a few words: the object that is grasped. Empty where there is nothing to say.
    pub about: String,
    /// What is to be known of the moment, such as `12 mm above the floor`; may be empty.
    pub told: String,
    /// What is the case now, such as `contact`: a row of stills shows the first moment of each, in the order of these names.
    pub moments: Vec<&'static str>,
}

/// A body with a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Its shape, in its own frame.
    pub form: Form,
    /// Where its frame is, m.
    pub at: [f64; 3],
    /// The axes of its frame, of length 1.
    pub axes: [[f64; 3]; 3],
    /// Red, green, blue.
    pub colour: [u8; 3],
    /// 1 where nothing is seen through it.
    pub opacity: f32,
    /// Whether it stays where it is whatever happens.
    pub fixed: bool,
}

/// A shape; lengths in m.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// The plane of the x and y axes: half its edges, 0 for one without end.
    Plane([f64; 2]),
    /// Ground that is not flat: points in rows.
    Field(Arc<[Vec<[f64; 3]>]>),
    /// Half the axes; a ball where they are alike.
    Ellipsoid([f64; 3]),
    /// A cylinder along z with half balls at its ends.
    Capsule {
        /// Of cylinder and balls.
        radius: f64,
        /// Half the length of the cylinder.
        half_length: f64,
    },
    /// A cylinder along z.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// Half its length.
        half_length: f64,
    },
    /// Half the edges.
    Box([f64; 3]),
    /// The convex hull of points.
    Hull(Arc<[[f64; 3]]>),
}

/// A cord.
#[derive(Clone, Debug, PartialEq)]
pub struct Cord {
    /// Its parts, each a broken line, m.
    pub parts: Vec<Vec<[f64; 3]>>,
    /// Red, green, blue.
    pub colour: [u8; 3],
}
