//! Random observations and what the program does at them, to hold another runtime against.

use std::sync::Arc;

use hwasp_core::{Purpose, Sampler, Serial, Stream, stream};
use hwasp_runs::encode;
use hwasp_runs::tensors::{Piece, serialized};
use hwasp_training::held_out;
use rand::RngExt;

use crate::deployed::Deployed;
use crate::error::ExportError;
use crate::file::ExportFile;
use crate::model::{COMMAND, EFFORT, OBSERVATION, STATE};

const SAMPLES: &str = "samples.safetensors";
/// Observations are within so many scales of the centre.
const SCALES: f64 = 3.0;
/// Held-out episodes whose states are used.
const EPISODES: u64 = 8;

/// `count` observations, each component uniform within three scales of its centre; beside each a state from held-out
/// episodes, so that it is one that the hardware can be in; and the program's commands and efforts at both.
pub(super) fn samples(deployed: &Deployed, count: usize) -> Result<ExportFile, ExportError> {
    let seed = deployed.spec.train.evaluation_seed;
    let mut random = stream(seed, Purpose::Samples, 0, 0);
    let normalizer = deployed.normalizer();
    let scaling: Vec<_> = normalizer.center().iter().zip(normalizer.scale()).collect();
    let draw = |random: &mut Stream| {
        let uniform = |(&center, &scale): (&f64, &f64), x: f64| (center + SCALES * scale * (2.0 * x - 1.0)) as f32;
        scaling.iter().map(|&scaling| uniform(scaling, random.random())).collect::<Vec<f32>>()
    };
    let observations: Vec<f32> = (0..count).flat_map(|_| draw(&mut random)).collect();
    let sampler = Sampler::new(Arc::clone(&deployed.policy), Arc::clone(&deployed.world.make), None);
    let visited = sampler.collect(&Serial, &deployed.params, &held_out(seed, 0..EPISODES))?.state;
    let width = deployed.env.state.len();
    let rows = visited.len() / width;
    let states: Vec<f64> = (0..count)
        .flat_map(|_| {
            let row = random.random_range(0..rows);
            visited[row * width..][..width].iter().map(|&x| f64::from(x))
        })
        .collect();
    let (commands, efforts) = deployed.act(&observations, &states);
    let shape = |width: usize| vec![count, width];
    let pieces = [
        Piece::f32(OBSERVATION.to_owned(), shape(scaling.len()), &observations),
        Piece::f64(STATE.to_owned(), shape(width), &states),
        Piece::f64(COMMAND.to_owned(), shape(deployed.env.command.len()), &commands),
        Piece::f64(EFFORT.to_owned(), shape(deployed.env.effort.len()), &efforts),
    ];
    let about = [("format", "hwasp-samples-1".to_owned())];
    let contents = serialized(&pieces, about).map_err(|e| encode(SAMPLES, &e))?;
    Ok(ExportFile { name: SAMPLES.to_owned(), contents })
}
