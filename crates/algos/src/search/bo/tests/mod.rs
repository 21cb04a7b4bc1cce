//! `process`: the Gaussian process, by numbers from elsewhere. `seam`: what `Search` and the state promise. `solve`: functions
//! solved.

mod process;
mod seam;
mod solve;

use super::{Bo, BoConfig, Search, SearchError};

fn search(start: &[f64], seed: u64) -> Bo {
    Bo::new(BoConfig::default(), start.to_vec(), seed).unwrap()
}
