//! How learner, policy and hardware are composed.

use hwasp_settings::choice;

choice! {
    /// A composition of learner, policy and hardware; it decides where the design sits unless `[design]` does.
    pub enum Method {
        /// The design is in the policy's graph.
        Hwasp = "hwasp",
        /// The design is in the action.
        Minimal = "minimal",
        /// The design is drawn once an episode and held.
        Episode = "episode",
        /// The design stays as it begins.
        Fixed = "fixed",
        /// CMA-ES over controller and design.
        Cmaes = "cmaes",
        /// Augmented random search over controller and design.
        Ars = "ars",
        /// CMA-ES over the design; every candidate trains a controller of its own.
        CmaesRl = "cmaes-rl",
        /// Augmented random search over the design; every candidate trains a controller of its own.
        ArsRl = "ars-rl",
        /// Bayesian optimisation of the design; every candidate trains a controller of its own.
        BoRl = "bo-rl",
        /// Random designs; every candidate trains a controller of its own.
        RandomRl = "random-rl",
    }
}

impl Method {
    /// Whether it searches without a gradient of the whole.
    pub fn searches(self) -> bool {
        matches!(self, Self::Cmaes | Self::Ars) || self.trains_inside()
    }

    /// Whether every candidate of its search trains a controller of its own.
    pub fn trains_inside(self) -> bool {
        matches!(self, Self::CmaesRl | Self::ArsRl | Self::BoRl | Self::RandomRl)
    }

    /// Whether the last generation of its search may be smaller, as the rest of a budget has it.
    pub fn divides_generations(self) -> bool {
        matches!(self, Self::BoRl | Self::RandomRl)
    }
}
