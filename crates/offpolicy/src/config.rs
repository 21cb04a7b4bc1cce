//! Settings of off-policy learners.

use hwasp_algos::{MOST_LAYERS, MOST_ROWS, RATES, WIDEST_LAYER};
use hwasp_settings::{Fields, Settings};

/// Settings that all off-policy learners share.
///
/// | name | default | purpose |
/// |---|---|---|
/// | `discount` | 0.99 | γ |
/// | `n_step` | 1 | steps whose rewards are taken before a value takes over |
/// | `batch_rows` | 256 | rows of a gradient step |
/// | `replay_frames` | 1,000,000 | moments that are held |
/// | `warmup_steps` | 1000 | steps before the first update |
/// | `updates_per_step` | 1 | gradient steps per step of the simulator |
/// | `policy_delay` | 2 for TD3, 1 for SAC | gradient steps of the critics for one of the policy |
/// | `design_start` | 0 | share of the schedules that is done before the design moves |
/// | `design_search` | 0 | steps of the simulator from one search of the design by the critics to the next; 0: the design follows their slope |
/// | `design_returns` | 0 | episodes whose returns move the means of designs that are drawn once an episode; 0: critics do |
/// | `forget_beyond` | 0 | share of its range by which a design parameter moves until the replay is emptied; 0: it is kept |
/// | `learning_rate` | 3e-4 | of the policy, by Adam |
/// | `critic_learning_rate` | 3e-4 | of the critics |
/// | `learning_rate_final` | 1 | fraction of both left at the end of a linear decay |
/// | `polyak` | 0.005 | share that targets follow by |
/// | `critic_hidden` | `[256, 256]` | widths of the critics' hidden layers, of ReLU |
/// | `critic_layer_norm` | false | whether sums of those layers are normalised in each row |
/// | `initial_value` | mean of the first returns | what critics say of everything at first |
/// | `value_scale` | spread of the first returns | what critics say is in units of this |
/// | `privileged` | false | critics see the law's state |
/// | `context` | false | critics see what the episode is about |
#[derive(Clone, Debug, PartialEq)]
pub struct ReplayConfig {
    /// γ.
    pub discount: f64,
    /// Steps whose rewards are taken as they were before a value takes over (Sutton 1988). What the policy did in between may not
    /// be what it would do now: more than a few are a bias.
    pub n_step: usize,
    /// Rows of a gradient step.
    pub batch_rows: usize,
    /// Moments that the replay holds; the oldest give way.
    pub replay_frames: usize,
    /// Steps before the first update.
    pub warmup_steps: usize,
    /// Gradient steps of the critics per step of the simulator.
    pub updates_per_step: f64,
    /// Gradient steps of the critics for one of the policy (Fujimoto et al. 2018, section 5.2).
    pub policy_delay: usize,
    /// The share of the schedules that is done before the design moves: a controller that knows nothing yet makes other designs
    /// look good than one that can use them.
    pub design_start: f64,
    /// Steps of the simulator from one search of the design to the next: it goes where critics see the most value at the starts of
    /// episodes (Luck et al. 2019). With 0 there is no search, and the design follows the critics' slope.
    pub design_search: usize,
    /// Episodes, the latest ones, whose returns move what is drawn once an episode, in the place of the critics: in as many episodes
    /// its means move by their covariance with the returns, times the design's own rate. With 0 critics move them.
    pub design_returns: usize,
    /// The share of its range by which a design parameter moves until the replay is emptied, as one would where the design is in
    /// the environment. With 0 all is kept: in the graph, old experience stays true.
    pub forget_beyond: f64,
    /// Step size of Adam for the policy, at the start.
    pub learning_rate: f64,
    /// The same for the critics.
    pub critic_learning_rate: f64,
    /// What fraction of both is left at the end.
    pub learning_rate_final: f64,
    /// τ, by which targets follow.
    pub polyak: f64,
    /// Widths of the critics' hidden layers.
    pub critic_hidden: Vec<usize>,
    /// Whether the sums of those layers are brought to mean 0 and variance 1 in each row: critics that many gradient steps on few
    /// steps of the simulator do not lead astray (Hiraoka et al. 2022).
    pub critic_layer_norm: bool,
    /// What critics say of everything at first, in the unit of the return; the mean of the returns before the first update where
    /// it is none. A value above all that can be earned is optimism (Sutton and Barto 2018, section 2.6): a design that nobody has
    /// tried then is not taken for a bad one, nor one that happens to come first for a good one.
    pub initial_value: Option<f64>,
    /// The unit of what critics say, and of the temperature, in units of the return; the spread of the returns before the first update
    /// where it is none. Their step size is the same whatever the unit: in a small one they take longer to say much.
    pub value_scale: Option<f64>,
    /// Whether critics see the law's state, which the controller does not (Pinto et al. 2018).
    pub privileged: bool,
    /// Whether they see the episode's context.
    pub context: bool,
}

impl Default for ReplayConfig {
    fn default() -> Self {
        Self {
            discount: 0.99,
            n_step: 1,
            batch_rows: 256,
            replay_frames: 1_000_000,
            warmup_steps: 1000,
            updates_per_step: 1.0,
            policy_delay: 1,
            design_start: 0.0,
            design_search: 0,
            design_returns: 0,
            forget_beyond: 0.0,
            learning_rate: 3e-4,
            critic_learning_rate: 3e-4,
            learning_rate_final: 1.0,
            polyak: 0.005,
            critic_hidden: vec![256, 256],
            critic_layer_norm: false,
            initial_value: None,
            value_scale: None,
            privileged: false,
            context: false,
        }
    }
}

/// The most moments that a replay may hold: a few hundred bytes each.
const MOST_FRAMES: usize = 100_000_000;

impl Settings for ReplayConfig {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        fields.number("discount", &mut self.discount, 0.0..=1.0, "gamma");
        let about = "steps whose rewards are taken as they were before a value takes over";
        fields.count("n_step", &mut self.n_step, 1..=100, about);
        fields.count("batch_rows", &mut self.batch_rows, 1..=65_536, "rows of a gradient step");
        let about = "moments that the replay holds, one per step and one per episode; the oldest give way";
        fields.default("1 000 000, or twice the rows of an iteration");
        fields.count("replay_frames", &mut self.replay_frames, 100..=MOST_FRAMES, about);
        fields.count("warmup_steps", &mut self.warmup_steps, 1..=MOST_ROWS, "steps before the first update");
        let about = "gradient steps of the critics per step of the simulator";
        fields.number("updates_per_step", &mut self.updates_per_step, 1e-3..=100.0, about);
        let about = "gradient steps of the critics for one of the policy";
        fields.count("policy_delay", &mut self.policy_delay, 1..=100, about);
        let about = "share of the schedules that is done before the design moves";
        fields.number("design_start", &mut self.design_start, 0.0..=1.0, about);
        let about = "steps of the simulator from one search of the design by the critics to the next; 0: it follows their slope";
        fields.count("design_search", &mut self.design_search, 0..=MOST_ROWS, about);
        let about = "episodes whose returns move designs that are drawn once an episode; 0: critics do";
        fields.count("design_returns", &mut self.design_returns, 0..=MOST_ROWS, about);
        let about = "share of its range by which a design parameter moves until the replay is emptied; 0: it is kept";
        fields.number("forget_beyond", &mut self.forget_beyond, 0.0..=1.0, about);
        fields.number("learning_rate", &mut self.learning_rate, RATES, "Adam's, for the policy");
        fields.number("critic_learning_rate", &mut self.critic_learning_rate, RATES, "Adam's, for the critics");
        let about = "fraction of both at the end of a linear decay";
        fields.number("learning_rate_final", &mut self.learning_rate_final, 0.0..=1.0, about);
        fields.number("polyak", &mut self.polyak, 1e-6..=1.0, "share that the targets follow by in a gradient step");
        let about = "widths of the critics' hidden layers";
        fields.counts("critic_hidden", &mut self.critic_hidden, MOST_LAYERS, 1..=WIDEST_LAYER, about);
        let about = "whether sums of the critics' hidden layers are normalised in each row";
        fields.flag("critic_layer_norm", &mut self.critic_layer_norm, about);
        let about = "discounted return that critics expect everywhere at first; \"none\": the mean of those before the first update";
        fields.optional_number("initial_value", &mut self.initial_value, -1e9..=1e9, about);
        let about =
            "unit of what critics say, in units of the return; \"none\": the spread of those before the first update";
        fields.optional_number("value_scale", &mut self.value_scale, 1e-9..=1e9, about);
        let about = "whether critics see the law's state, which the controller does not";
        fields.flag("privileged", &mut self.privileged, about);
        let about = "whether critics see what an episode is about and no sensor tells";
        fields.flag("context", &mut self.context, about);
    }
}
