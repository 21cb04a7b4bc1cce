//! Generalised advantage estimation (Schulman et al. 2016, eq. 16).

use hwasp_core::{Batch, End};
use serde::{Deserialize, Serialize};

/// How rewards and values become advantages.
///
/// | name | default | purpose |
/// |---|---|---|
/// | `discount` | 0.99 | γ |
/// | `gae_lambda` | 0.95 | λ |
/// | `normalize` | true | mean 0, variance 1 over the batch |
/// | `bootstrap_truncated` | true | value the state after a truncated episode; the paper's toolkit does not |
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AdvantageConfig {
    /// γ, of returns and advantages.
    pub discount: f64,
    /// λ of the advantages.
    pub gae_lambda: f64,
    /// Whether advantages are centred and scaled over the batch.
    pub normalize: bool,
    /// Whether the state after a truncated episode is valued.
    pub bootstrap_truncated: bool,
}

impl Default for AdvantageConfig {
    fn default() -> Self {
        Self { discount: 0.99, gae_lambda: 0.95, normalize: true, bootstrap_truncated: true }
    }
}

/// What [`advantages`] gives, one value per row, and two per episode.
#[derive(Clone, Debug, PartialEq)]
pub struct Advantages {
    /// `Â_t = Σ_l (γλ)^l δ_{t+l}` with `δ_t = r_t + γ·V(s_{t+1}) - V(s_t)`.
    pub advantage: Vec<f32>,
    /// `Â_t + V(s_t)`, the λ-return that a value function may learn.
    pub lambda_return: Vec<f32>,
    /// `Σ_l γ^l r_{t+l}` to the end of the episode, and nothing beyond; of one that was cut, the value of the state after it is
    /// what is beyond.
    pub discounted_return: Vec<f32>,
    /// `Σ_t γ^t r_t` of each episode, and beyond it the value of the state after it where that counts.
    pub episode_return: Vec<f64>,
    /// The same less V of the episode's first state.
    pub episode_advantage: Vec<f64>,
    /// How well the values foretold what they learn.
    pub foresight: Foresight,
}

/// How well values foretold the targets that a value function learns next. The rewards are those that the learner sees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Foresight {
    /// Mean square of the error, reward².
    pub value_loss: f64,
    /// The share of the targets' variance that the values account for: 1 for perfect ones, 0 for ones that know no more than the
    /// mean, and less for worse ones; NaN where the targets are all alike.
    pub explained_variance: f64,
}

impl Foresight {
    /// Of values before they learn these targets, one for one.
    pub fn of(values: &[f32], targets: &[f32]) -> Self {
        let n = targets.len().max(1) as f64;
        let (mut errors, mut squares, mut sum, mut sum_squares) = (0.0, 0.0, 0.0, 0.0);
        // Of differences from one of them: squares of large numbers that are nearly alike lose what tells them apart.
        let first = targets.first().map_or(0.0, |&target| f64::from(target));
        for (&value, &target) in values.iter().zip(targets) {
            let (error, target) = (f64::from(target) - f64::from(value), f64::from(target) - first);
            errors += error;
            squares += error * error;
            sum += target;
            sum_squares += target * target;
        }
        let variance = |sum: f64, squares: f64| (squares / n - (sum / n).powi(2)).max(0.0);
        let (unexplained, all) = (variance(errors, squares), variance(sum, sum_squares));
        Self { value_loss: squares / n, explained_variance: if all > 0.0 { 1.0 - unexplained / all } else { f64::NAN } }
    }
}

/// The advantages of a batch of whole episodes.
///
/// `values` are V(s) of every row, `last_values` V of the state after each episode's last row. That state counts where an
/// episode was truncated and `bootstrap_truncated` is set, and always where it was [cut](hwasp_core::Episode::cut): that is no
/// end of the task's. A terminated episode has no future.
pub fn advantages(
    batch: &Batch,
    values: &[f32],
    last_values: &[f32],
    (discount, gae_lambda): (f64, f64),
    bootstrap_truncated: bool,
) -> Advantages {
    let rows = batch.rows();
    let mut out = Advantages {
        advantage: vec![0.0; rows],
        lambda_return: vec![0.0; rows],
        discounted_return: vec![0.0; rows],
        episode_return: Vec::with_capacity(batch.episodes.len()),
        episode_advantage: Vec::with_capacity(batch.episodes.len()),
        foresight: Foresight::default(),
    };
    for (episode, &last_value) in batch.episodes.iter().zip(last_values) {
        let bootstrap = episode.cut || (bootstrap_truncated && episode.end == End::Truncated);
        let mut next_value = if bootstrap { f64::from(last_value) } else { 0.0 };
        let (mut advantage, mut total, mut whole) = (0.0, if episode.cut { next_value } else { 0.0 }, next_value);
        for t in episode.rows.clone().rev() {
            let (reward, value) = (batch.reward[t], f64::from(values[t]));
            let delta = reward + discount * next_value - value;
            advantage = delta + discount * gae_lambda * advantage;
            total = reward + discount * total;
            whole = reward + discount * whole;
            out.advantage[t] = advantage as f32;
            out.lambda_return[t] = (advantage + value) as f32;
            out.discounted_return[t] = total as f32;
            next_value = value;
        }
        out.episode_return.push(whole);
        out.episode_advantage.push(whole - next_value);
    }
    out
}

/// Centres to mean 0 and scales to variance 1: (A - mean)/sqrt(var + 1e-8), over the whole batch.
pub fn normalize(advantage: &mut [f32]) {
    let n = advantage.len().max(1) as f64;
    let mean = advantage.iter().map(|&a| f64::from(a)).sum::<f64>() / n;
    let var = advantage.iter().map(|&a| (f64::from(a) - mean).powi(2)).sum::<f64>() / n;
    let scale = 1.0 / (var + 1e-8).sqrt();
    for a in advantage {
        *a = ((f64::from(*a) - mean) * scale) as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hwasp_core::Episode;

    /// Two episodes: three steps truncated, two steps terminated. γ = 0.5, λ = 0.5.
    fn batch() -> Batch {
        Batch {
            reward: vec![1.0, 2.0, 3.0, 4.0, 5.0],
            episodes: vec![
                Episode {
                    rows: 0..3,
                    end: End::Truncated,
                    cut: false,
                    last_obs: vec![],
                    last_state: vec![],
                    context: vec![],
                    log_prob: 0.0,
                    outcome: None,
                    terms: vec![],
                },
                Episode {
                    rows: 3..5,
                    end: End::Terminated,
                    cut: false,
                    last_obs: vec![],
                    last_state: vec![],
                    context: vec![],
                    log_prob: 0.0,
                    outcome: None,
                    terms: vec![],
                },
            ],
            ..Batch::default()
        }
    }

    #[test]
    fn by_hand() {
        let values = [10.0, 20.0, 30.0, 40.0, 50.0];
        let got = advantages(&batch(), &values, &[8.0, 99.0], (0.5, 0.5), true);
        // First episode, backwards:
        //   δ2 = 3 + 0.5·8 - 30 = -23;            A2 = -23
        //   δ1 = 2 + 0.5·30 - 20 = -3;            A1 = -3 + 0.25·(-23) = -8.75
        //   δ0 = 1 + 0.5·20 - 10 = 1;             A0 = 1 + 0.25·(-8.75) = -1.1875
        // Second, terminated, so that 99 does not count:
        //   δ4 = 5 - 50 = -45;                    A4 = -45
        //   δ3 = 4 + 0.5·50 - 40 = -11;           A3 = -11 + 0.25·(-45) = -22.25
        assert_eq!(got.advantage, [-1.1875, -8.75, -23.0, -22.25, -45.0]);
        assert_eq!(got.lambda_return, [8.8125, 11.25, 7.0, 17.75, 5.0]);
        assert_eq!(got.discounted_return, [2.75, 3.5, 3.0, 6.5, 5.0]);
        // The first was truncated: 2.75 and 0.5³·8 of what follows, less V of 10; the second less V of 40.
        assert_eq!(got.episode_return, [3.75, 6.5]);
        assert_eq!(got.episode_advantage, [-6.25, -33.5]);
    }

    #[test]
    fn the_authors_convention_ends_at_truncation() {
        let got = advantages(&batch(), &[0.0; 5], &[8.0, 99.0], (0.5, 1.0), false);
        assert_eq!(got.advantage, got.discounted_return);
    }

    /// The first episode of the test by hand, cut: its value counts under the authors' convention too, and the discounted return
    /// goes on with it. Backwards with λ = 1: A2 = 3 + 0.5·8 = 7, A1 = 2 + 0.5·7 = 5.5, A0 = 1 + 0.5·5.5 = 3.75.
    #[test]
    fn a_cut_is_no_end() {
        let mut batch = batch();
        batch.episodes[0].cut = true;
        let got = advantages(&batch, &[0.0; 5], &[8.0, 99.0], (0.5, 1.0), false);
        assert_eq!(got.advantage, [3.75, 5.5, 7.0, 6.5, 5.0]);
        assert_eq!(got.advantage, got.discounted_return);
    }

    /// Targets 1, 2, 3 (variance 2/3). Values that are one too low all over explain all of it, the mean nothing of it, and values that
    /// run the other way (errors -2, 0, 2) less than nothing.
    #[test]
    fn foresight_by_hand() {
        let of = |values: [f32; 3]| Foresight::of(&values, &[1.0, 2.0, 3.0]);
        assert_eq!(of([0.0, 1.0, 2.0]), Foresight { value_loss: 1.0, explained_variance: 1.0 });
        let mean = of([2.0; 3]);
        assert!((mean.value_loss - 2.0 / 3.0).abs() < 1e-12 && mean.explained_variance.abs() < 1e-12);
        let contrary = of([3.0, 2.0, 1.0]);
        assert!((contrary.value_loss - 8.0 / 3.0).abs() < 1e-12 && (contrary.explained_variance + 3.0).abs() < 1e-12);
        let alike = Foresight::of(&[0.0; 2], &[5.0; 2]);
        assert!(alike.value_loss == 25.0 && alike.explained_variance.is_nan());
        // In single precision one part in 10⁷ is left of such targets.
        let far = Foresight::of(&[1e6 + 1.0, 1e6 + 2.0], &[1e6 + 1.0, 1e6 + 2.0]);
        assert_eq!((far.value_loss, far.explained_variance), (0.0, 1.0));
    }

    #[test]
    fn normalised_advantages_have_mean_zero_and_variance_one() {
        let mut a = [1.0, 2.0, 3.0, 6.0];
        normalize(&mut a);
        assert!(a.iter().sum::<f32>().abs() < 1e-6);
        assert!((a.iter().map(|a| a * a).sum::<f32>() / 4.0 - 1.0).abs() < 1e-6);
    }
}
