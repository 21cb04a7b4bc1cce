//! What episodes came to.

/// The episodes of an iteration that came to their end.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ended {
    /// How many; NaN where nobody counted.
    pub(crate) episodes: f64,
    /// Their mean length, steps; NaN where there is none.
    pub(crate) steps: f64,
    /// What they came to; none where there is none.
    pub(crate) returns: Option<Returns>,
}

/// What episodes came to, on average.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Returns {
    pub(crate) discounted: f64,
    pub(crate) undiscounted: f64,
    /// What each named term of the reward came to; empty where nobody counted.
    pub(crate) terms: Vec<f64>,
}

impl Returns {
    /// Of the means of several.
    pub(crate) fn mean(of: &[&Self]) -> Self {
        let mean = |pick: fn(&Self) -> f64| of.iter().map(|returns| pick(returns)).sum::<f64>() / of.len() as f64;
        Self {
            discounted: mean(|r| r.discounted),
            undiscounted: mean(|r| r.undiscounted),
            terms: mean_terms(&of.iter().map(|returns| &*returns.terms).collect::<Vec<_>>()),
        }
    }
}

/// The mean of each term.
pub(crate) fn mean_terms(of: &[&[f64]]) -> Vec<f64> {
    let terms = of.iter().map(|terms| terms.len()).min().unwrap_or(0);
    (0..terms).map(|k| of.iter().map(|terms| terms[k]).sum::<f64>() / of.len() as f64).collect()
}
