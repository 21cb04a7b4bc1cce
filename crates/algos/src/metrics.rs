//! What an update did, as named numbers.

/// What one update of a learner did: numbers in the order of the learner's names
/// ([`Learner::metric_names`](crate::Learner::metric_names)). Every learner has names of its own, and none that it knows no
/// number for; `kl` and `entropy` (nats) mean the same wherever they are told.
#[derive(Clone, Debug, PartialEq)]
pub struct Metrics {
    names: &'static [&'static str],
    values: Vec<f64>,
}

impl Metrics {
    /// The values of these names, in their order.
    ///
    /// # Panics
    /// If there is not one value per name.
    pub fn new(names: &'static [&'static str], values: Vec<f64>) -> Self {
        assert_eq!(values.len(), names.len(), "one value for each of {names:?}");
        Self { names, values }
    }

    /// The value of this name; none where the learner does not tell it.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.iter().find(|(known, _)| *known == name).map(|(_, value)| value)
    }

    /// Names and values, in order.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, f64)> {
        self.names.iter().copied().zip(self.values.iter().copied())
    }

    /// The values, in the order of the names.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}
