//! Learning bars.

mod common;

use common::Case;
use hwasp_core::Placement;

#[test]
fn measure() {
    let iterations: u64 = std::env::var("ITER").map_or(40, |s| s.parse().unwrap());
    for place in [Placement::Graph, Placement::Action] {
        for seed in 0..6 {
            let start = std::time::Instant::now();
            let case = if std::env::var("MS").is_ok() { Case::mass_spring(place) } else { Case::reach(place) };
            println!("{place:?} {seed} {:?} {:?}", case.learn(seed, iterations), start.elapsed());
        }
    }
}
