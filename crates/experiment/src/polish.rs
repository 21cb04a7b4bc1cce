//! `[polish]`: the last part of a training, in which the controller alone learns where the result has to work.

use hwasp_settings::{Fields, Settings, choice};

use crate::task::Task;
use crate::train::TrainSettings;

choice! {
    /// Where a controller is polished.
    pub enum PolishWorld {
        /// On the hardware as built, where results are evaluated.
        Deployment = "deployment",
        /// In the world that stands in for the built robot.
        Native = "native",
    }
}

/// `[polish]`.
#[derive(Clone, Debug, PartialEq)]
pub struct PolishSettings {
    /// What part of the steps of a training it takes; 0 for none.
    pub share: f64,
    /// Where.
    pub world: PolishWorld,
    /// The share of all schedules that is done when it begins, in [0, 1].
    pub progress_start: f64,
    /// What it is checked against; nothing where that is wrong itself.
    limits: Option<Limits>,
}

/// What a polish has to fit.
#[derive(Clone, Debug, PartialEq)]
struct Limits {
    /// Steps of the whole training.
    env_steps: u64,
    /// An iteration, in rows and in words.
    rows: u64,
    portion: String,
    /// The problem, where no world stands in for its robot.
    no_native: Option<String>,
}

impl Default for PolishSettings {
    fn default() -> Self {
        Self { share: 0.0, world: PolishWorld::Deployment, progress_start: 0.5, limits: None }
    }
}

impl PolishSettings {
    /// The defaults for a task and trainings of this length, which are what the file asks for.
    pub(crate) fn new(train: &TrainSettings, task: &Task) -> Self {
        let no_native = task.built().stand_in.is_none().then(|| task.name().to_owned());
        let (env_steps, rows, portion) = (train.env_steps, train.rows() as u64, train.portion());
        Self { limits: Some(Limits { env_steps, rows, portion, no_native }), ..Self::default() }
    }

    /// Steps of a training of `env_steps` that polish.
    pub fn steps(&self, env_steps: u64) -> u64 {
        (self.share * env_steps as f64) as u64
    }

    fn check(&self, limits: &Limits, fields: &mut Fields<'_, '_>) {
        let Limits { env_steps, rows, portion, no_native } = limits;
        let (share, steps) = (self.share, self.steps(*env_steps));
        fields.check("share", steps >= *rows, || {
            (
                format!(
                    "polish.share = {share} of train.env_steps = {env_steps} is {steps} steps, less than the {portion}"
                ),
                "take a larger share, train for longer, or with fewer episodes per iteration; 0 leaves the polish out"
                    .into(),
            )
        });
        fields.check("share", env_steps - steps >= *rows, || {
            (
                format!(
                    "polish.share = {share} of train.env_steps = {env_steps} leaves {} steps to train before, less than the {portion}",
                    env_steps - steps
                ),
                "take a smaller share, or train for longer".into(),
            )
        });
        if let Some(problem) = no_native {
            fields.check("world", self.world != PolishWorld::Native, || {
                (
                    format!("polish.world = \"native\", and {problem} has no world that is nearer to the built robot"),
                    "polish in \"deployment\", on the hardware as built; z-grasp and 3d-grasp have a native world, and model where it has a law"
                        .into(),
                )
            });
        }
    }
}

impl Settings for PolishSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        let about = "part of `train.env_steps` that comes last, and trains the controller alone on the design as built; 0: none";
        fields.number("share", &mut self.share, 0.0..=0.9, about);
        let about = "where: with the hardware as built, which is where results are evaluated, or in the world that stands in for \
                     the built robot";
        fields.choice("world", &mut self.world, about);
        let about = "share of all schedules that is done when it begins; they reach their end once more";
        fields.number("progress_start", &mut self.progress_start, 0.0..=1.0, about);
        let sound = fields.sound(&["share", "world"]);
        if let Some(limits) = self.limits.take().filter(|_| sound && self.share > 0.0) {
            self.check(&limits, fields);
        }
    }
}
