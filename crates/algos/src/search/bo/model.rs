//! What the scores of a search say, and where it looks next.

use hwasp_core::Stream;
use rand::RngExt;
use rand_distr::StandardNormal;

use super::fit::fitted;
use super::improvement::improvement;
use super::kernel::Kernel;
use super::minimise::minimise;
use super::posterior::Posterior;

/// Points of the whole space at which a search for the most improvement looks first.
const ANYWHERE: usize = 256;
/// The best points tried, beside which it looks too; so many times, and so far, in fractions of the space.
const BESIDE: usize = 4;
const EACH: usize = 16;
const FAR: [f64; 4] = [0.3, 0.1, 0.03, 0.01];
/// The best of these points, from which it climbs, and the most steps.
const CLIMBS: usize = 5;
const STEPS: usize = 50;
/// Scores below the lower quartile by so many interquartile ranges are raised to there (Tukey 1977): how bad the worst are says nothing of
/// the best.
const FENCE: f64 = 1.5;

/// A kernel, and the scores that it was fitted to.
pub(super) struct Model {
    kernel: Kernel,
    /// Standardised, of all points; those that failed have the worst.
    scores: Vec<f64>,
    /// The point tried whose mean is best.
    pub(super) best: usize,
    /// Points tried, the best means first.
    ranked: Vec<usize>,
    /// The best mean.
    incumbent: f64,
}

impl Model {
    /// None where no score is there. Scores that are `failed` have no say in the fit.
    pub(super) fn new(points: &[Vec<f64>], scores: &[f64], failed: f64) -> Option<Self> {
        let sound: Vec<usize> = (0..scores.len()).filter(|&i| scores[i] != failed).collect();
        if sound.is_empty() {
            return None;
        }
        let standard = standardised(&sound.iter().map(|&i| scores[i]).collect::<Vec<_>>());
        let tried: Vec<&[f64]> = sound.iter().map(|&i| &points[i][..]).collect();
        let kernel = fitted(&tried, &standard);
        let worst = standard.iter().copied().fold(f64::INFINITY, f64::min);
        let mut all = vec![worst; scores.len()];
        sound.iter().zip(&standard).for_each(|(&i, &score)| all[i] = score);

        let posterior = Posterior::new(&kernel, points.iter().map(Vec::as_slice).collect(), &all, points.len());
        let means: Vec<f64> = points.iter().map(|point| posterior.mean(point)).collect();
        let mut ranked = sound;
        // Stable: of equal means the first.
        ranked.sort_by(|&a, &b| means[b].total_cmp(&means[a]));
        let best = ranked[0];
        ranked.truncate(BESIDE);
        Some(Self { kernel, scores: all, best, ranked, incumbent: means[best] })
    }

    /// So many candidates for the next generation; each has a stream.
    pub(super) fn candidates(
        &self,
        points: &[Vec<f64>],
        count: usize,
        stream: impl Fn(usize) -> Stream,
    ) -> Vec<Vec<f64>> {
        let (mut points, mut scores, told) = (points.to_vec(), self.scores.clone(), points.len());
        for k in 0..count {
            let posterior = Posterior::new(&self.kernel, points.iter().map(Vec::as_slice).collect(), &scores, told);
            let next = self.most_improvement(&points, &posterior, &mut stream(k));
            scores.push(posterior.mean(&next));
            points.push(next);
        }
        points.split_off(told)
    }

    /// The candidate with the most expected improvement that a search from many points finds.
    fn most_improvement(&self, points: &[Vec<f64>], posterior: &Posterior<'_>, stream: &mut Stream) -> Vec<f64> {
        let n = points[0].len();
        let mut seeds: Vec<Vec<f64>> = (0..ANYWHERE).map(|_| (0..n).map(|_| stream.random()).collect()).collect();
        for &i in &self.ranked {
            for k in 0..EACH {
                let far = FAR[k % FAR.len()];
                let beside =
                    points[i].iter().map(|x| (x + far * stream.sample::<f64, _>(StandardNormal)).clamp(0.0, 1.0));
                seeds.push(beside.collect());
            }
        }
        let mut valued: Vec<(f64, Vec<f64>)> = seeds
            .into_iter()
            .map(|x| {
                let (mean, std) = posterior.at(&x);
                (improvement(mean, std, self.incumbent).log, x)
            })
            .collect();
        valued.sort_by(|a, b| b.0.total_cmp(&a.0));
        let climbed = valued.iter().take(CLIMBS).filter_map(|(_, seed)| {
            minimise(seed, &vec![(0.0, 1.0); n], STEPS, |x| {
                let slope = posterior.slope(x);
                let gain = improvement(slope.mean, slope.std, self.incumbent);
                let by = |(mean, std): (&f64, &f64)| -(gain.by_mean * mean + gain.by_std * std);
                gain.log.is_finite().then(|| (-gain.log, slope.mean_by.iter().zip(&slope.std_by).map(by).collect()))
            })
        });
        let best = climbed.reduce(|best, other| if other.1 < best.1 { other } else { best });
        best.map_or_else(|| valued[0].1.clone(), |(x, _)| x)
    }
}

/// Scores with mean 0 and variance 1, the worst of them raised to Tukey's lower fence; all 0 where they do not differ.
pub(super) fn standardised(scores: &[f64]) -> Vec<f64> {
    let mut sorted = scores.to_vec();
    sorted.sort_by(f64::total_cmp);
    let quartile = |quarters: usize| sorted[(sorted.len() - 1) * quarters / 4];
    let (lower, upper) = (quartile(1), quartile(3));
    let fence = if upper > lower { lower - FENCE * (upper - lower) } else { f64::MIN };
    let fenced: Vec<f64> = scores.iter().map(|s| s.max(fence)).collect();
    let count = fenced.len() as f64;
    let mean = fenced.iter().map(|s| s / count).sum::<f64>();
    let std = (fenced.iter().map(|s| (s - mean).powi(2) / count).sum::<f64>()).sqrt();
    fenced.iter().map(|s| if std > 0.0 { (s - mean) / std } else { 0.0 }).collect()
}
