//! `[train]`: how long, in which portions, and how the result is judged.

use hwasp_algos::MOST_ROWS;
use hwasp_settings::{Fields, Settings};

/// The most steps of a training.
const LONGEST: u64 = 1_000_000_000_000;

/// `[train]`.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainSettings {
    /// Simulator steps of the whole training.
    pub env_steps: u64,
    /// Episodes between updates; lanes where steps are counted.
    pub episodes_per_iteration: usize,
    /// Steps between updates, shared evenly by lanes that run one episode after the other; 0 where episodes are counted.
    pub steps_per_iteration: usize,
    /// Training episodes are truncated after so many steps.
    pub episode_steps: usize,
    /// Whether learners see rewards divided by the running deviation of discounted returns.
    pub reward_scaling: bool,
    /// The share of all schedules that is done at the start, in [0, 1].
    pub progress_start: f64,
    /// Episodes of an evaluation.
    pub evaluation_episodes: usize,
    /// Root seed of an evaluation's start states.
    pub evaluation_seed: u64,
    /// What the authors' plots count per iteration; 0 for the real steps.
    pub nominal_steps: u64,
    /// Steps that came before, where these are the settings of a later part of a training.
    before: u64,
    /// Steps of an episode of the task.
    horizon: usize,
    /// Whether the horizon is known to be right.
    horizon_sound: bool,
}

impl TrainSettings {
    /// The defaults for a task of this horizon. `horizon_sound`: whether that is what the file asks for.
    pub(crate) fn new(horizon: usize, horizon_sound: bool) -> Self {
        Self {
            env_steps: 4_000_000,
            episodes_per_iteration: 20,
            steps_per_iteration: 0,
            episode_steps: horizon.min(200),
            reward_scaling: false,
            progress_start: 0.0,
            evaluation_episodes: 1000,
            evaluation_seed: 1_000_003,
            nominal_steps: 0,
            before: 0,
            horizon,
            horizon_sound,
        }
    }

    /// Rows, which are steps, of an iteration.
    pub fn rows(&self) -> usize {
        match self.steps_per_iteration {
            0 => self.episodes_per_iteration.saturating_mul(self.episode_steps),
            steps => steps,
        }
    }

    /// The steps of a lane in an iteration, at least, where steps are counted and an episode may be longer: what comes late in
    /// long episodes is never seen then.
    pub fn short_lanes(&self) -> Option<usize> {
        let lane = self.steps_per_iteration / self.episodes_per_iteration;
        (self.steps_per_iteration > 0 && lane < self.episode_steps).then_some(lane)
    }

    /// An iteration in words.
    pub(crate) fn portion(&self) -> String {
        let (episodes, steps) = (self.episodes_per_iteration, self.episode_steps);
        match self.steps_per_iteration {
            0 => format!("{} rows of an iteration ({episodes} episodes of {steps} steps)", self.rows()),
            rows => format!("{rows} rows of an iteration (train.steps_per_iteration)"),
        }
    }

    /// The share of all schedules that is done after so many steps.
    pub fn progress(&self, env_steps: u64) -> f64 {
        let [done, all] = [env_steps, self.env_steps].map(|steps| steps.saturating_sub(self.before) as f64);
        self.progress_start + (1.0 - self.progress_start) * (done / all)
    }

    /// The settings of what follows after so many steps, where the schedules go from `progress_start` to their end once more.
    #[must_use]
    pub fn after(&self, env_steps: u64, progress_start: f64) -> Self {
        Self { before: env_steps, progress_start, ..self.clone() }
    }
}

impl Settings for TrainSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        let mut env_steps = self.env_steps;
        // Its default is at least one iteration, which the next two keys make.
        if !fields.reads() {
            fields.default("4 000 000").limits("one iteration to 1e12");
            fields.integer("env_steps", &mut env_steps, 1..=LONGEST, "simulator steps of the whole training");
        }
        fields.count(
            "episodes_per_iteration",
            &mut self.episodes_per_iteration,
            1..=100_000,
            "episodes between updates",
        );
        fields.limits("0, or `episodes_per_iteration` to 10 000 000");
        let about = "where it is not 0, steps between updates: `episodes_per_iteration` is how many lanes share them evenly, and \
                     each runs one episode after the other";
        fields.count("steps_per_iteration", &mut self.steps_per_iteration, 0..=MOST_ROWS, about);
        fields.default("200").limits("1 to the horizon");
        fields.count("episode_steps", &mut self.episode_steps, 1..=100_000, "training episodes are cut to this");
        if fields.reads() {
            self.env_steps = self.env_steps.max(self.rows() as u64);
            fields.integer("env_steps", &mut self.env_steps, 1..=LONGEST, "");
        }
        let about = "whether learners see rewards divided by the running deviation of discounted returns; what is told stays as it is";
        fields.flag("reward_scaling", &mut self.reward_scaling, about);
        let about = "share of all schedules that is done at the start; 1 trains on with everything as it is at the end";
        fields.number("progress_start", &mut self.progress_start, 0.0..=1.0, about);
        fields.count("evaluation_episodes", &mut self.evaluation_episodes, 1..=1_000_000, "episodes of an evaluation");
        let last = i64::MAX as u64;
        fields.integer("evaluation_seed", &mut self.evaluation_seed, 0..=last, "root of their start states");
        let about = "what the authors' plots count per iteration (`plot --axis nominal`); 0: the real steps";
        fields.integer("nominal_steps", &mut self.nominal_steps, 0..=LONGEST, about);
        self.check(fields);
    }
}

impl TrainSettings {
    fn check(&self, fields: &mut Fields<'_, '_>) {
        let (steps, horizon, rows, portion) = (self.episode_steps, self.horizon, self.rows(), self.portion());
        fields.check("episode_steps", steps <= horizon || !self.horizon_sound, || {
            (
                format!("train.episode_steps = {steps} is more than task.horizon = {horizon}"),
                format!("set train.episode_steps to at most {horizon}"),
            )
        });
        fields.check("episodes_per_iteration", rows <= MOST_ROWS, || {
            (format!("the {portion} are more than {MOST_ROWS}"), "take fewer or shorter episodes per iteration".into())
        });
        let lanes = self.episodes_per_iteration;
        let steps = self.steps_per_iteration;
        fields.check(
            "steps_per_iteration",
            steps == 0 || steps >= lanes || !fields.sound(&["episodes_per_iteration"]),
            || {
                (
                    format!("train.steps_per_iteration = {steps} is less than a step for each of {lanes} lanes"),
                    "take more steps, or fewer lanes by train.episodes_per_iteration".into(),
                )
            },
        );
        let sound = fields.sound(&["env_steps", "episodes_per_iteration", "steps_per_iteration", "episode_steps"]);
        let given = self.env_steps;
        fields.check("env_steps", given >= rows as u64 || !sound, || {
            (
                format!("train.env_steps = {given} is less than the {portion}"),
                "train for longer, or with fewer episodes per iteration".into(),
            )
        });
    }
}
