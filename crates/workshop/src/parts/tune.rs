//! Training the controller further, on the parts.

use std::path::Path;

use hwasp_core::Policy;
use hwasp_experiment::{EXPERIMENT, Experiment, InitialDesign, Method, Place};
use hwasp_runs::{Keeping, Provenance, Resumed, RunError, RunFolder, SUMMARY, SavedRun, saved_experiment};
use hwasp_tasks::hand::DESIGN_LEN;
use hwasp_training::{Assembly, Checkpoint, beginning};

use super::PartsError;

/// A training that goes on with a run's controller on hardware that is fixed now.
pub struct Tuning {
    /// Its experiment: the run's, with the design fixed and every schedule at its end.
    pub assembly: Assembly,
    start: Checkpoint,
}

/// What there is in the folder of such a training.
pub enum TuningFolder {
    /// All of it: what it came to.
    Finished(Vec<f32>),
    /// Nothing or a part of it, and what to go on from.
    Open(Box<RunFolder>, Box<Checkpoint>),
}

impl Tuning {
    /// Of a run's `params` on the hardware of `built`, SI, for so many steps; its result is judged on `asked` episodes from
    /// this seed.
    pub fn new(
        run: &Assembly,
        params: &[f32],
        built: &[f64; DESIGN_LEN],
        env_steps: u64,
        asked: (u64, u64),
    ) -> Result<Self, PartsError> {
        let rows = run.experiment().train.rows() as u64;
        if env_steps < rows {
            return Err(PartsError::ShortTuning { env_steps, rows });
        }
        let assembly = Assembly::new(&experiment(run, params, built, env_steps, asked))?;
        // The controller comes first in both; the noise of the commands is in the experiment.
        let mut start = assembly.init();
        let controller = run.policy.controller_params(params);
        start[..controller.len()].copy_from_slice(controller);
        let start = beginning(&assembly, start, run.experiment().train.env_steps).map_err(Box::new)?;
        Ok(Self { assembly, start })
    }

    /// Its folder: taken up where the same training is there already.
    pub fn folder(&self, path: &Path, provenance: Provenance) -> Result<TuningFolder, RunError> {
        let spec = self.assembly.experiment();
        let (mut folder, from) = if path.join(EXPERIMENT).is_file() {
            if saved_experiment(path, &[], spec.catalogue())? != *spec {
                return Err(RunError::Exists { path: path.to_owned() });
            }
            if path.join(SUMMARY).is_file() {
                return Ok(TuningFolder::Finished(SavedRun::open(path, spec.catalogue())?.params()?));
            }
            let Resumed { folder, found } = RunFolder::resume(path, spec, provenance, Keeping::default())?;
            found.warn();
            (folder, found.checkpoint)
        } else {
            (RunFolder::create(path, spec, &provenance, Keeping::default())?, None)
        };
        let from = from.unwrap_or_else(|| self.start.clone());
        // It begins with what no experiment file says: from the first moment on, that is in its folder.
        folder.keep(&from)?;
        Ok(TuningFolder::Open(Box::new(folder), Box::new(from)))
    }
}

fn experiment(
    run: &Assembly,
    params: &[f32],
    built: &[f64; DESIGN_LEN],
    env_steps: u64,
    (episodes, seed): (u64, u64),
) -> Experiment {
    let mut spec = run.experiment().clone();
    spec.description = format!(
        "The controller of {} ({}, seed {}) trained further on parts.",
        spec.name,
        spec.method.name(),
        spec.seed
    );
    spec.method = Method::Fixed;
    spec.design.initial = InitialDesign::at(&spec.task.groups(), built);
    spec.design.placement = Place::Fixed;
    spec.design.placements.clear();
    spec.noise.command = last_noise(run, params);
    (spec.noise.command_final, spec.noise.effort) = (None, None);
    spec.noise.effort_final.fill(None);
    // Schedules of task, noise and learning rate do not begin again.
    spec.train.progress_start = 1.0;
    spec.train.env_steps = env_steps;
    spec.polish.share = 0.0;
    (spec.train.evaluation_episodes, spec.train.evaluation_seed) = (episodes as usize, seed);
    spec
}

/// Standard deviations of the commands at the end of a run, as fractions of their ranges.
fn last_noise(run: &Assembly, params: &[f32]) -> Vec<f64> {
    let mut log_std = vec![0.0; run.policy.action_dim()];
    run.policy.log_std(params, 1.0, &mut log_std);
    let noise = &run.experiment().noise;
    let last =
        run.worlds.training.env.command.iter().enumerate().map(|(c, port)| match run.policy.action_of_command(c) {
            Some(j) => f64::from(log_std[j]).exp() / (port.hi - port.lo),
            // It was not sampled.
            None => noise.command_final.as_ref().unwrap_or(&noise.command)[c],
        });
    last.map(|std| std.clamp(1e-6, 10.0)).collect()
}
