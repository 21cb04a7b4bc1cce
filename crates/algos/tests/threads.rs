//! The number of threads changes no bit of a training.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use common::Case;
use hwasp_core::{Executor, Placement, Serial, Threads};

#[test]
fn training_gives_the_same_parameters_on_any_number_of_threads() {
    for place in [Placement::Graph, Placement::Action, Placement::Episode] {
        let case = Case::mass_spring(place);
        let train = |executor: &dyn Executor, seed| -> Vec<u32> {
            case.train(executor, seed, 3).iter().map(|p| p.to_bits()).collect()
        };
        let serial = train(&Serial, 4);
        assert_ne!(serial, train(&Serial, 5), "the seed should matter");
        for count in [1, 2, 3] {
            assert_eq!(serial, train(&Threads::new(count).unwrap(), 4), "{place:?}, {count} threads");
        }
    }
}
