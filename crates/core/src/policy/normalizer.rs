//! What a controller sees of an observation.

/// Centre and scale of every observation, and how far from zero what is left may be.
#[derive(Clone, Debug, PartialEq)]
pub struct Normalizer {
    /// Subtracted, SI.
    center: Vec<f64>,
    /// Divides what is left, SI.
    scale: Vec<f64>,
    /// The controller sees nothing beyond ± this; infinite where there is no limit.
    clip: f64,
}

impl Normalizer {
    pub(super) fn new(center: Vec<f64>, scale: Vec<f64>, clip: Option<f64>) -> Self {
        Self { center, scale, clip: clip.unwrap_or(f64::INFINITY) }
    }

    /// Writes what the controller sees of an observation in SI: (observation - centre)/scale within ± the clip.
    #[inline]
    pub fn apply(&self, observation: &[f64], out: &mut [f32]) {
        let scaling = self.center.iter().zip(&self.scale);
        for ((out, x), (center, scale)) in out.iter_mut().zip(observation).zip(scaling) {
            *out = ((x - center) / scale).clamp(-self.clip, self.clip) as f32;
        }
    }

    /// What is subtracted from each observation, SI.
    pub fn center(&self) -> &[f64] {
        &self.center
    }

    /// What divides what is left, SI.
    pub fn scale(&self) -> &[f64] {
        &self.scale
    }

    /// How far from zero what the controller sees may be; none where there is no limit.
    pub fn clip(&self) -> Option<f64> {
        self.clip.is_finite().then_some(self.clip)
    }
}
