//! The settings of learners, baselines and searches as experiment files have them: described once, in the structs that the
//! algorithms take.

use hwasp_settings::{Fields, Settings, choice};

use crate::baseline::{BaselineConfig, MlpBaselineConfig};
use crate::ppo::PpoConfig;
use crate::search::{ArsConfig, BoConfig, CmaesConfig, RandomConfig};
use crate::trpo::{FisherRows, TrpoConfig};

/// The most rows of an iteration: they are all held in memory.
pub const MOST_ROWS: usize = 10_000_000;
/// The most hidden layers of a network.
pub const MOST_LAYERS: usize = 16;
/// The widest hidden layer.
pub const WIDEST_LAYER: usize = 4096;
/// The most candidates or directions of a generation.
const MOST_CANDIDATES: usize = 100_000;
/// The most candidates that a Bayesian search chooses together, each by a model of its own.
const MOST_BATCH: usize = 100;
/// Limits of Adam's learning rate.
pub const RATES: std::ops::RangeInclusive<f64> = 1e-9..=1.0;

impl Settings for PpoConfig {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        fields.number("discount", &mut self.discount, 0.0..=1.0, "gamma");
        fields.number("gae_lambda", &mut self.gae_lambda, 0.0..=1.0, "lambda of generalised advantages");
        fields.number(
            "clip_ratio",
            &mut self.clip_ratio,
            1e-3..=1.0,
            "epsilon: how far the probability ratio may leave 1",
        );
        fields.count("epochs", &mut self.epochs, 1..=1000, "passes over a batch");
        fields.limits("0 to the rows of an iteration");
        fields.count(
            "minibatch_rows",
            &mut self.minibatch_rows,
            0..=MOST_ROWS,
            "rows of a minibatch; 0: the whole batch",
        );
        fields.number("learning_rate", &mut self.learning_rate, RATES, "Adam's");
        let about = "fraction of it at the end of a linear decay";
        fields.number("learning_rate_final", &mut self.learning_rate_final, 0.0..=1.0, about);
        fields.number("adam_epsilon", &mut self.adam_epsilon, 1e-16..=0.1, "Adam's");
        fields.number("entropy_coef", &mut self.entropy_coef, 0.0..=10.0, "weight of the entropy");
        fields.positive("max_grad_norm", &mut self.max_grad_norm, 1e6, "longest gradient; 0: any");
        fields.positive("target_kl", &mut self.target_kl, 100.0, "ends the epochs beyond; 0: never");
        fields.flag("normalize_advantages", &mut self.normalize_advantages, "centred and scaled per batch");
        fields.flag("bootstrap_truncated", &mut self.bootstrap_truncated, "whether a cut episode has a future");
        let about =
            "whether each epoch but the first has the advantages of the values as the epoch before has fitted them";
        fields.flag("recompute_advantages", &mut self.recompute_advantages, about);
    }
}

impl Settings for TrpoConfig {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        let of_ppo = "that of `[ppo]`";
        fields.default(of_ppo).number("discount", &mut self.advantages.discount, 0.0..=1.0, "gamma");
        let about = "lambda of generalised advantages";
        fields.default(of_ppo).number("gae_lambda", &mut self.advantages.gae_lambda, 0.0..=1.0, about);
        fields.number("max_kl", &mut self.max_kl, 1e-9..=10.0, "the most mean KL divergence of an update, nats");
        let about = "fraction of it at the end of a linear decay";
        fields.number("max_kl_final", &mut self.max_kl_final, 1e-6..=1.0, about);
        self.fisher_rows_field(fields);
        fields.count("cg_iterations", &mut self.cg_iterations, 1..=1000, "most steps of conjugate gradients");
        let about = "they end where the squared norm of the residual is below";
        fields.number("cg_tolerance", &mut self.cg_tolerance, 0.0..=1.0, about);
        let about = "added to the diagonal of the curvature, in units of the parameters";
        fields.number("damping", &mut self.damping, 0.0..=1e3, about);
        let about = "unit of the design's parameters in the equations of a step: the larger, the further the design goes for the \
                     same KL";
        fields.number("design_scale", &mut self.design_scale, 1e-3..=1e3, about);
        let about = "what a step that does not hold is shortened by";
        fields.number("backtrack_ratio", &mut self.backtrack_ratio, 0.01..=0.99, about);
        fields.count("backtracks", &mut self.backtracks, 1..=100, "steps tried, the full one among them");
        let normalize = &mut self.advantages.normalize;
        fields.default(of_ppo).flag("normalize_advantages", normalize, "centred and scaled per batch");
        let bootstrap = &mut self.advantages.bootstrap_truncated;
        fields.default(of_ppo).flag("bootstrap_truncated", bootstrap, "whether a cut episode has a future");
    }
}

impl TrpoConfig {
    /// Up to 1 a share of the batch, above it how many rows.
    fn fisher_rows_field(&mut self, fields: &mut Fields<'_, '_>) {
        let mut rows = match self.fisher_rows {
            FisherRows::Fraction(share) => share,
            FisherRows::Count(count) => count as f64,
        };
        let about = "rows that the curvature is taken of: a share of the batch, or above 1 how many";
        fields.number("fisher_rows", &mut rows, 1e-6..=MOST_ROWS as f64, about);
        let sound = !fields.sound(&["fisher_rows"]) || rows <= 1.0 || rows.fract() == 0.0;
        fields.check("fisher_rows", sound, || {
            (
                format!("trpo.fisher_rows = {rows} is neither a share nor a number of rows"),
                "up to 1 it is a share of the batch, above it a whole number of rows".into(),
            )
        });
        self.fisher_rows = if rows > 1.0 { FisherRows::Count(rows as usize) } else { FisherRows::Fraction(rows) };
    }
}

choice! {
    /// What estimates values.
    pub enum BaselineKind {
        /// A network.
        Mlp = "mlp",
        /// Ridge regression on features of state and time.
        Linear = "linear",
    }
}

/// A value baseline as experiment files have it: the settings of both kinds.
#[derive(Clone, Debug, PartialEq)]
pub struct BaselineSettings {
    /// What estimates values.
    pub kind: BaselineKind,
    /// Of the network.
    pub mlp: MlpBaselineConfig,
    /// Regularisation of the linear one.
    pub ridge: f64,
}

impl Default for BaselineSettings {
    fn default() -> Self {
        Self { kind: BaselineKind::Mlp, mlp: MlpBaselineConfig::default(), ridge: 1e-5 }
    }
}

impl Settings for BaselineSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        let mlp = &mut self.mlp;
        fields.choice("kind", &mut self.kind, "what estimates values");
        fields.counts(
            "hidden",
            &mut mlp.hidden,
            MOST_LAYERS,
            1..=WIDEST_LAYER,
            "widths of the network's hidden layers",
        );
        fields.number("learning_rate", &mut mlp.learning_rate, RATES, "Adam's");
        let about = "fraction of it at the end of a linear decay";
        fields.default("that of `[ppo]` under PPO, else 1");
        fields.number("learning_rate_final", &mut mlp.learning_rate_final, 0.0..=1.0, about);
        fields.count("epochs", &mut mlp.epochs, 1..=1000, "passes over a batch");
        let about = "rows of a minibatch of the network; 0: the whole batch";
        fields.default("that of `[ppo]` under PPO, else 1000").limits("0 to the rows of an iteration");
        fields.count("minibatch_rows", &mut mlp.minibatch_rows, 0..=MOST_ROWS, about);
        fields.default("that of `[ppo]` under PPO, else 0.5");
        fields.positive("max_grad_norm", &mut mlp.max_grad_norm, 1e6, "longest gradient; 0: any");
        let about = "whether it also sees the law's state, which the controller does not";
        fields.flag("privileged", &mut mlp.privileged, about);
        let about = "whether it also sees what an episode is about and no sensor tells: of a grasp the object's shape, mass, friction \
                     and inertia";
        fields.flag("context", &mut mlp.context, about);
        fields.number("ridge", &mut self.ridge, 0.0..=1e6, "regularisation of the linear one");
    }
}

impl BaselineSettings {
    /// As learners take it.
    pub fn config(&self) -> BaselineConfig {
        match self.kind {
            BaselineKind::Mlp => BaselineConfig::Mlp(self.mlp.clone()),
            BaselineKind::Linear => {
                BaselineConfig::Linear { ridge: self.ridge, privileged: self.mlp.privileged, context: self.mlp.context }
            }
        }
    }
}

impl Settings for CmaesConfig {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        let mut popsize = self.popsize.unwrap_or(0);
        let about = "candidates of a generation; 0: 4 + 3 ln n for n parameters";
        fields.limits("0, or 4 to 100 000");
        fields.count("popsize", &mut popsize, 0..=MOST_CANDIDATES, about);
        fields.check("popsize", !(1..4).contains(&popsize), || {
            (
                format!("cmaes.popsize = {popsize} is too few to learn a covariance from"),
                "take at least 4, or 0 for 4 + 3 ln n".into(),
            )
        });
        self.popsize = (popsize > 0).then_some(popsize);
        let about = "first step size: of the parameters, or as a fraction of each design range";
        fields.default("cmaes: 0.5, cmaes-rl: 0.25");
        fields.number("sigma", &mut self.sigma, 1e-9..=1e3, about);
        fields.flag("active", &mut self.active, "whether bad candidates shrink the covariance");
        fields.default("false; of `cmaes` with more than 5000 parameters true");
        fields.flag("separable", &mut self.separable, "a diagonal covariance, for very many parameters");
        let mut restarts = self.restarts as usize;
        fields.count("restarts", &mut restarts, 0..=20, "restarts with twice the candidates where it stagnates");
        self.restarts = restarts as u32;
    }
}

impl Settings for BoConfig {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        let about = "candidates that are chosen together, and train side by side";
        fields.count("popsize", &mut self.popsize, 1..=MOST_BATCH, about);
        let about =
            "candidates all over the space before the model chooses, in whole generations; 0: 2n + 2 for n parameters";
        fields.count("initial_points", &mut self.initial_points, 0..=1000, about);
    }
}

impl Settings for RandomConfig {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        fields.count("popsize", &mut self.popsize, 1..=MOST_CANDIDATES, "candidates that train side by side");
    }
}

choice! {
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

    /// Whether the best directions alone count.
    pub fn truncates(self) -> bool {
        matches!(self, Self::V1t | Self::V2t)
    }
}

/// Augmented random search as experiment files have it.
#[derive(Clone, Debug, PartialEq)]
pub struct ArsSettings {
    /// The version.
    pub variant: ArsVariant,
    /// Whether the search is around a training, where there is no input of a controller to filter; not any more once that is judged.
    around_training: bool,
    /// Of the search itself.
    pub config: ArsConfig,
}

impl ArsSettings {
    /// The defaults, for a search over controller and design or over the design around a training.
    pub fn new(around_training: bool) -> Self {
        let (variant, directions) = if around_training { (ArsVariant::V1t, 4) } else { (ArsVariant::V2t, 32) };
        let config = ArsConfig { directions, top: directions / 2, ..ArsConfig::default() };
        Self { variant, around_training, config }
    }
}

impl Settings for ArsSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        fields.default("ars: \"v2-t\", ars-rl: \"v1-t\"");
        fields.choice(
            "variant",
            &mut self.variant,
            "with -t the best directions count, with 2 what was seen scales the input",
        );
        fields.default("ars: 32, ars-rl: 4");
        let about = "directions of a generation, each tried both ways";
        fields.count("directions", &mut self.config.directions, 1..=MOST_CANDIDATES, about);
        let directions = self.config.directions;
        if fields.reads() {
            self.config.top = if self.variant.truncates() { directions.div_ceil(2) } else { directions };
        }
        fields.default("with -t half of them, else all").limits("1 to `directions`");
        fields.count("top", &mut self.config.top, 1..=MOST_CANDIDATES, "the best of them, which count");
        fields.number("step_size", &mut self.config.step_size, 1e-9..=1e3, "length of a step");
        fields.number("noise_std", &mut self.config.noise_std, 1e-9..=1e3, "how far candidates are from the centre");
        if fields.sound(&["variant", "directions", "top"]) {
            self.check(fields);
        }
        // Once it is judged, settings that say the same are the same.
        self.around_training = false;
    }
}

impl ArsSettings {
    fn check(&self, fields: &mut Fields<'_, '_>) {
        let (variant, top, directions) = (self.variant, self.config.top, self.config.directions);
        fields.check("top", top <= directions, || {
            (
                format!("ars.top = {top} is more than ars.directions = {directions}"),
                "the best of the directions are among them".into(),
            )
        });
        fields.check("top", top >= directions || variant.truncates(), || {
            (
                format!("ars.top = {top} leaves directions out, which {variant} does not"),
                "leave it out, or take v1-t or v2-t".into(),
            )
        });
        fields.check("variant", !(variant.filters() && self.around_training), || {
            (
                format!("ars.variant = \"{variant}\" filters what a controller sees"),
                "around a training there is none to search: take v1 or v1-t".into(),
            )
        });
    }
}
