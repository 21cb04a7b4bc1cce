//! What the returns of episodes say of what was drawn for them.

/// What each episode earned beyond a straight line over time, in units of the spread about it: a controller that learns earns more
/// from episode to episode, whatever is drawn. None where all lie on the line.
pub(crate) fn beyond_trend(returns: &[f64]) -> Option<Vec<f64>> {
    let n = returns.len() as f64;
    let mean = |of: &dyn Fn(usize) -> f64| (0..returns.len()).map(of).sum::<f64>() / n;
    let time = |i: usize| i as f64 - 0.5 * (n - 1.0);
    let level = mean(&|i| returns[i]);
    let slope = mean(&|i| time(i) * returns[i]) / mean(&|i| time(i) * time(i)).max(f64::MIN_POSITIVE);
    let beyond: Vec<f64> = (0..returns.len()).map(|i| returns[i] - level - slope * time(i)).collect();
    let spread = mean(&|i| beyond[i] * beyond[i]).sqrt();
    (spread > 1e-12 * (1.0 + level.abs())).then(|| beyond.iter().map(|gain| gain / spread).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1, 2, 6, 7: mean 4, slope 2.2; beyond the line 0.3, -0.9, 0.9, -0.3, whose spread is √0.45.
    #[test]
    fn progress_is_no_merit() {
        let beyond = beyond_trend(&[1.0, 2.0, 6.0, 7.0]).unwrap();
        let wanted = [0.3, -0.9, 0.9, -0.3].map(|gain: f64| gain / 0.45_f64.sqrt());
        assert!(beyond.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{beyond:?}");
        assert_eq!(beyond_trend(&[1.0, 2.0, 3.0, 4.0]), None);
        assert_eq!(beyond_trend(&[5.0]), None);
    }
}
