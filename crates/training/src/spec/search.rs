//! `[search]`, `[cmaes]` and `[ars]`: methods without a gradient of the whole.

use serde::Serialize;

use super::Method;
use super::names::named;
use super::section::Section;
use super::train::TrainSpec;

named! {
    /// What a candidate is scored by.
    pub enum Score {
        /// The undiscounted return.
        Return = "return",
        /// The discounted return.
        DiscountedReturn = "discounted_return",
    }
}

named! {
    /// A version of augmented random search (Mania et al. 2018).
    pub enum ArsVariant {
        /// All directions count.
        V1 = "v1",
        /// The best directions count.
        V1t = "v1-t",
        /// All directions count, and the controller's input is centred and scaled by what was seen.
        V2 = "v2",
        /// The best directions count, with the same filter.
        V2t = "v2-t",
    }
}

impl ArsVariant {
    /// Whether the controller's input is centred and scaled by what was seen.
    pub fn filters(self) -> bool {
        matches!(self, Self::V2 | Self::V2t)
    }

    fn truncates(self) -> bool {
        matches!(self, Self::V1t | Self::V2t)
    }
}

/// `[search]`: how candidates are scored.
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `episodes` | 4 | episodes of a candidate (`cmaes` and `ars`) | 1 to 100 000 |
/// | `score` | "discounted_return" | their mean `return` or `discounted_return` | |
/// | `noise` | false | whether candidates act with noise, whose standard deviations are then searched too | |
/// | `inner_env_steps` | a fortieth of `train.env_steps` | steps of a candidate's own training (`cmaes-rl` and `ars-rl`) | one iteration to 1e12 |
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SearchSpec {
    /// Episodes of a candidate.
    pub episodes: usize,
    /// What counts of them.
    pub score: Score,
    /// Whether candidates act with noise.
    pub noise: bool,
    /// Steps of a candidate's own training.
    pub inner_env_steps: u64,
}

/// `[cmaes]` (Hansen 2016).
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `popsize` | 0 | candidates of a generation; 0: 4 + 3 ln n for n parameters | 0, or 4 to 100 000 |
/// | `sigma` | cmaes: 0.5, cmaes-rl: 0.25 | first step size: of the parameters, or as a fraction of each design range | 1e-9 to 1e3 |
/// | `active` | true | whether bad candidates shrink the covariance | |
/// | `separable` | false | a diagonal covariance, for very many parameters | |
/// | `restarts` | 0 | restarts with twice the candidates where it stagnates | 0 to 20 |
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CmaesSpec {
    /// Candidates of a generation; 0 for the default.
    pub popsize: usize,
    /// First step size.
    pub sigma: f64,
    /// Whether bad candidates shrink the covariance.
    pub active: bool,
    /// Whether the covariance is diagonal.
    pub separable: bool,
    /// Restarts where it stagnates.
    pub restarts: usize,
}

/// `[ars]` (Mania et al. 2018).
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `variant` | ars: "v2-t", ars-rl: "v1-t" | `v1`, `v1-t`, `v2` or `v2-t` | |
/// | `directions` | ars: 32, ars-rl: 4 | directions of a generation, each tried both ways | 1 to 100 000 |
/// | `top` | with -t half of them, else all | the best of them, which count | 1 to `directions` |
/// | `step_size` | 0.05 | length of a step | 1e-9 to 1e3 |
/// | `noise_std` | 0.1 | how far candidates are from the centre | 1e-9 to 1e3 |
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArsSpec {
    /// The version.
    pub variant: ArsVariant,
    /// Directions of a generation.
    pub directions: usize,
    /// The best of them, which count.
    pub top: usize,
    /// Length of a step.
    pub step_size: f64,
    /// How far candidates are from the centre.
    pub noise_std: f64,
}

const MOST_CANDIDATES: usize = 100_000;

impl SearchSpec {
    /// Reads the table for trainings of these iterations.
    pub(super) fn read(mut s: Section<'_>, train: &TrainSpec) -> Self {
        let rows = train.rows() as u64;
        let spec = Self {
            episodes: s.count("episodes", 4, 1..=100_000),
            score: s.choice("score", Score::ALL).unwrap_or(Score::DiscountedReturn),
            noise: s.flag("noise", false),
            inner_env_steps: s.integer("inner_env_steps", rows.max(train.env_steps / 40), 1..=1_000_000_000_000),
        };
        let sound = s.reader.sound(&["search.inner_env_steps", "train.episodes_per_iteration", "train.episode_steps"]);
        if spec.inner_env_steps < rows && sound {
            let message =
                format!("search.inner_env_steps = {} is less than the {}", spec.inner_env_steps, train.portion());
            s.clash("inner_env_steps", message, "train each candidate for at least one iteration");
        }
        s.finish();
        spec
    }
}

impl CmaesSpec {
    /// Reads the table for a method.
    pub(super) fn read(mut s: Section<'_>, method: Method) -> Self {
        let sigma = if method == Method::CmaesRl { 0.25 } else { 0.5 };
        let spec = Self {
            popsize: s.count("popsize", 0, 0..=MOST_CANDIDATES),
            sigma: s.number("sigma", sigma, 1e-9..=1e3),
            active: s.flag("active", true),
            separable: s.flag("separable", false),
            restarts: s.count("restarts", 0, 0..=20),
        };
        if (1..4).contains(&spec.popsize) {
            let message = format!("cmaes.popsize = {} is too few to learn a covariance from", spec.popsize);
            s.clash("popsize", message, "take at least 4, or 0 for 4 + 3 ln n");
        }
        s.finish();
        spec
    }
}

impl ArsSpec {
    /// Reads the table for a method.
    pub(super) fn read(mut s: Section<'_>, method: Method) -> Self {
        let default = if method == Method::ArsRl { ArsVariant::V1t } else { ArsVariant::V2t };
        let variant = s.choice("variant", ArsVariant::ALL).unwrap_or(default);
        let directions = s.count("directions", if method == Method::ArsRl { 4 } else { 32 }, 1..=MOST_CANDIDATES);
        let all = if variant.truncates() { directions.div_ceil(2) } else { directions };
        let spec = Self {
            variant,
            directions,
            top: s.count("top", all, 1..=MOST_CANDIDATES),
            step_size: s.number("step_size", 0.05, 1e-9..=1e3),
            noise_std: s.number("noise_std", 0.1, 1e-9..=1e3),
        };
        if s.reader.sound(&["ars.variant", "ars.directions", "ars.top"]) {
            if spec.top > directions {
                let message = format!("ars.top = {} is more than ars.directions = {directions}", spec.top);
                s.clash("top", message, "the best of the directions are among them");
            } else if spec.top < directions && !variant.truncates() {
                let message = format!("ars.top = {} leaves directions out, which {variant} does not", spec.top);
                s.clash("top", message, "leave it out, or take v1-t or v2-t");
            }
            if variant.filters() && method == Method::ArsRl {
                let message = format!("ars.variant = \"{variant}\" filters what a controller sees");
                s.clash("variant", message, "around a training there is none to search: take v1 or v1-t");
            }
        }
        s.finish();
        spec
    }
}
