//! Evaluations of many episodes.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_core::Serial;
use hwasp_training::{Assembly, evaluate};

/// An evaluation kept the rows of all its episodes: `eval --episodes 32000` took 1.5 GB, and one of 100,000 episodes after a
/// training ran out of memory. What is held of an episode is less than 200 bytes now, its returns in the figures included;
/// its 30 rows are more than 1,000.
#[test]
fn many_episodes_take_little_memory() {
    let assembly = Assembly::new(&hwasp_testing::resolve(hwasp_testing::layers("reach"), None).unwrap()).unwrap();
    let params = assembly.init();
    let peak = |episodes| {
        let run = || assert_eq!(evaluate(&assembly, &params, (episodes, 4), &Serial).unwrap().episodes, episodes);
        allocation_counter::measure(run).bytes_max
    };
    let (few, many) = (peak(200), peak(20_000));
    assert!(many - few < 200 * 19_800, "{few} bytes for 200 episodes, {many} for 20,000");
}
