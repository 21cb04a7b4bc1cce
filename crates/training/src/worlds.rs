//! A problem put together: a mechanism in the world where one trains, and in the one where the result has to work.

use std::sync::Arc;

use hwasp_core::{Law, MakeEnvironment};

/// A mechanism in a world.
#[derive(Clone)]
pub struct World {
    /// The mechanism's law.
    pub law: Law,
    /// Makes environments for it.
    pub make: Arc<dyn MakeEnvironment>,
}

/// A problem: where one trains, where the result has to work, and what is known of its best design.
#[derive(Clone)]
pub struct Problems {
    /// Where one trains.
    pub training: World,
    /// Where the result has to work: the mechanism as built, without aids to training.
    pub deployment: World,
    /// The total of each design group that is best as built, where it is known, SI.
    pub optimum: Vec<Option<f64>>,
}

impl Problems {
    /// A mechanism that works as it is trained: one world, whose best design is not known.
    pub fn new(law: Law, make: impl MakeEnvironment + 'static) -> Self {
        let optimum = vec![None; law.design().groups().len()];
        let world = World { law, make: Arc::new(make) };
        Self { training: world.clone(), deployment: world, optimum }
    }
}
