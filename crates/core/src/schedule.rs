//! Schedules: what changes while training goes on.

/// How much is done, in [0, 1], of a change that goes evenly from `from` to `to`, both fractions of training, when `progress`
/// of it is over. Where `to` is not after `from` the change is sudden: nothing up to `from`, and all behind it.
pub fn share_done(progress: f64, from: f64, to: f64) -> f64 {
    ((progress - from) / (to - from).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
}

/// What is left, at `progress` in [0, 1], of what goes evenly from all to the fraction `last`.
pub fn share_left(last: f64, progress: f64) -> f64 {
    1.0 + (last - 1.0) * progress
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Noise and objects each had this formula for themselves.
    #[test]
    fn a_change_is_even_between_its_ends() {
        let done = [0.0, 0.2, 0.3, 0.4, 0.6, 1.0].map(|progress| share_done(progress, 0.2, 0.6));
        for (done, wanted) in done.into_iter().zip([0.0, 0.0, 0.25, 0.5, 1.0, 1.0]) {
            assert!((done - wanted).abs() < 1e-12, "{done} is not {wanted}");
        }
    }

    /// Learners each had this formula for their rates.
    #[test]
    fn what_is_left_falls_evenly() {
        assert_eq!([0.0, 0.5, 1.0].map(|progress| share_left(0.5, progress)), [1.0, 0.75, 0.5]);
    }

    #[test]
    fn a_change_without_length_is_sudden() {
        assert_eq!([0.0, 0.5, 0.500_001, 1.0].map(|progress| share_done(progress, 0.5, 0.5)), [0.0, 0.0, 1.0, 1.0]);
    }
}
