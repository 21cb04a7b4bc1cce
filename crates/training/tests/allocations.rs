//! What trainings and searches hold in memory.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

use std::sync::atomic::AtomicBool;

use allocation_counter::measure;
use hwasp_core::Serial;
use hwasp_testing::{layers, resolve};
use hwasp_training::{Assembly, train};

/// One generation of two directions on the reach problem, bytes at most.
fn peak(variant: &str, episodes: u64) -> u64 {
    // Four candidates, and the choice at the end on 32 episodes, of 30 steps each.
    let (asked, steps) = (episodes.to_string(), (30 * (4 * episodes + 32)).to_string());
    let settings = [
        ("ars.variant", variant),
        ("ars.directions", "2"),
        ("ars.top", "1"),
        ("search.episodes", &asked),
        ("train.env_steps", &steps),
        ("train.evaluation_episodes", "4"),
    ];
    let layers = settings.iter().fold(layers("reach"), |layers, (k, v)| layers.with_override(k, v));
    let assembly = Assembly::new(&resolve(layers, Some("ars")).unwrap()).unwrap();
    let mut generations = 0;
    let counted = measure(|| {
        generations = train(&assembly, &Serial, &mut (), &AtomicBool::new(false)).unwrap().iterations;
    });
    assert_eq!(generations, 1, "{variant}, {episodes} episodes");
    counted.bytes_max
}

/// The variants of ARS with a state filter held all rows of a candidate's episodes, and what the controller had seen in all
/// candidates of a generation: memory grew with `search.episodes`.
#[test]
fn more_episodes_of_a_candidate_are_no_more_rows() {
    for variant in ["v1-t", "v2-t"] {
        let (few, many) = (peak(variant, 20), peak(variant, 2000));
        // What is held of an episode: returns, steps, how it ended; and of 32 episodes at once, where those are looked through,
        // rows of 30 steps.
        assert!(many < few + 100 * 1980 + 100_000, "{variant}: {few} bytes for 20 episodes, {many} for 2000");
    }
}
