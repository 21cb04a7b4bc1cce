//! From the longest step that the quadratic model allows to one that holds.

use super::TrpoConfig;

/// What [`backtrack`] settled on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    /// Share of the full step; 0 for none.
    pub(super) fraction: f64,
    /// The loss there.
    pub(super) loss: f64,
    /// The divergence there, nats.
    pub(super) kl: f64,
    /// Steps tried.
    pub(super) tried: usize,
}

/// The first of the steps 1, r, r², … that improves on the loss `start` with a divergence of at most `max_kl`; none where
/// none of them does. `evaluate` gives loss and divergence of a share of the full step; what is no number is no improvement.
pub(super) fn backtrack(
    start: f64,
    max_kl: f64,
    config: &TrpoConfig,
    mut evaluate: impl FnMut(f64) -> (f64, f64),
) -> Step {
    let mut fraction = 1.0;
    for tried in 1..=config.backtracks {
        let (loss, kl) = evaluate(fraction);
        if loss < start && kl <= max_kl {
            return Step { fraction, loss, kl, tried };
        }
        fraction *= config.backtrack_ratio;
    }
    Step { fraction: 0.0, loss: start, kl: 0.0, tried: config.backtracks }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn search(loss: impl Fn(f64) -> f64, kl: impl Fn(f64) -> f64) -> Step {
        backtrack(1.0, 0.01, &TrpoConfig::default(), |f| (loss(f), kl(f)))
    }

    #[test]
    fn takes_the_first_step_that_holds() {
        assert_eq!(search(|_| 0.5, |_| 0.01), Step { fraction: 1.0, loss: 0.5, kl: 0.01, tried: 1 });
        // 0.8³ is the first below 0.6.
        let by_loss = search(|f| if f < 0.6 { 0.9 } else { 1.0 }, |_| 0.0);
        assert_eq!((by_loss.tried, by_loss.loss), (4, 0.9));
        assert!((by_loss.fraction - 0.512).abs() < 1e-12);
        assert_eq!(search(|_| 0.0, |f| if f < 0.6 { 0.01 } else { 0.010_001 }).tried, 4);
    }

    #[test]
    fn takes_none_where_none_holds() {
        let none = Step { fraction: 0.0, loss: 1.0, kl: 0.0, tried: 15 };
        assert_eq!(search(|_| 1.0, |_| 0.0), none);
        assert_eq!(search(|_| f64::NAN, |_| 0.0), none);
        assert_eq!(search(|_| 0.0, |_| f64::NAN), none);
        assert_eq!(search(|_| f64::NEG_INFINITY, |_| f64::INFINITY), none);
    }

    proptest! {
        /// Whatever the two functions look like, what is taken is within the limit and better.
        #[test]
        fn never_leaves_the_limit(losses in prop::collection::vec(-2.0..3.0_f64, 15), kls in prop::collection::vec(0.0..0.03_f64, 15)) {
            let mut tried = 0;
            let step = backtrack(1.0, 0.01, &TrpoConfig::default(), |_| {
                tried += 1;
                (losses[tried - 1], kls[tried - 1])
            });
            let holds = |i: usize| losses[i] < 1.0 && kls[i] <= 0.01;
            prop_assert_eq!(step.fraction > 0.0, (0..15).any(holds));
            if step.fraction > 0.0 {
                prop_assert!(step.loss < 1.0 && step.kl <= 0.01);
                prop_assert_eq!(Some(tried - 1), (0..15).position(holds));
            }
        }
    }
}
