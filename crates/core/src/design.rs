//! Design spaces: what about the hardware may change, in which unit and between which limits.

use hwasp_diff::Scalar;
use rand::RngExt;
use thiserror::Error;

use crate::streams::Stream;
use crate::units::Dimension;

/// Where a design begins, per parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Initial {
    /// The unbounded parameter `u` (before the squash) uniform in ±`half_width`; the paper's code uses 5.
    Logit {
        /// Half the width of the interval of `u`.
        half_width: f64,
    },
    /// A given value, in SI.
    Value(f64),
}

/// A group of like parameters: ten spring stiffnesses, say.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignGroup {
    /// What it is called in files, plots and tables.
    pub name: String,
    /// What it measures; values are in the SI unit of it.
    pub dimension: Dimension,
    /// Lower limit of each parameter, SI.
    pub lo: f64,
    /// Upper limit of each parameter, SI.
    pub hi: f64,
    /// How many there are.
    pub count: usize,
    /// Where they begin.
    pub initial: Initial,
}

/// Why a design space cannot be.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DesignError {
    /// Limits that leave no room.
    #[error("{name}: the limits [{lo}, {hi}] are not an interval of finite numbers")]
    Limits {
        /// The group.
        name: String,
        /// Its lower limit.
        lo: f64,
        /// Its upper limit.
        hi: f64,
    },
    /// No parameter.
    #[error("{name}: a group needs at least one parameter")]
    Empty {
        /// The group.
        name: String,
    },
    /// Two groups of one name.
    #[error("{name}: two groups have this name")]
    Twice {
        /// The name.
        name: String,
    },
    /// A start outside of the limits, or on one of them, where the squash has no inverse.
    #[error("{name}: the initial value {value} is not inside ({lo}, {hi})")]
    Start {
        /// The group.
        name: String,
        /// The start asked for.
        value: f64,
        /// Its lower limit.
        lo: f64,
        /// Its upper limit.
        hi: f64,
    },
    /// Not one start per group.
    #[error("{given} starts for {needed} groups of design parameters")]
    Starts {
        /// Starts given.
        given: usize,
        /// Groups there are.
        needed: usize,
    },
}

/// The parameters `p` of a mechanism, each confined to its limits by `p = lo + (hi - lo)·sigmoid(u)` with `u` free.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignSpace {
    groups: Vec<DesignGroup>,
    /// Limits of every single parameter, in order.
    bounds: Vec<(f64, f64)>,
}

impl DesignSpace {
    /// Checks the groups and lays their parameters out one after the other.
    pub fn new(groups: Vec<DesignGroup>) -> Result<Self, DesignError> {
        for (i, g) in groups.iter().enumerate() {
            let name = g.name.clone();
            if !(g.lo.is_finite() && g.hi.is_finite() && g.lo < g.hi) {
                return Err(DesignError::Limits { name, lo: g.lo, hi: g.hi });
            }
            if g.count == 0 {
                return Err(DesignError::Empty { name });
            }
            if groups[..i].iter().any(|other| other.name == g.name) {
                return Err(DesignError::Twice { name });
            }
            if let Initial::Value(value) = g.initial
                && !(value > g.lo && value < g.hi)
            {
                return Err(DesignError::Start { name, value, lo: g.lo, hi: g.hi });
            }
        }
        let bounds = groups.iter().flat_map(|g| std::iter::repeat_n((g.lo, g.hi), g.count)).collect();
        Ok(Self { groups, bounds })
    }

    /// The groups, in order.
    pub fn groups(&self) -> &[DesignGroup] {
        &self.groups
    }

    /// The number of parameters over all groups.
    pub fn len(&self) -> usize {
        self.bounds.len()
    }

    /// Whether nothing can change.
    pub fn is_empty(&self) -> bool {
        self.bounds.is_empty()
    }

    /// The limits of parameter `i`, SI.
    pub fn bounds(&self, i: usize) -> (f64, f64) {
        self.bounds[i]
    }

    /// The middle of the limits of every parameter, SI.
    pub fn middle(&self) -> Vec<f64> {
        self.bounds.iter().map(|(lo, hi)| 0.5 * (lo + hi)).collect()
    }

    /// The name of every parameter: `stiffness[3]`, or just the group's where it has one member.
    pub fn names(&self) -> Vec<String> {
        self.groups
            .iter()
            .flat_map(|g| (0..g.count).map(|i| if g.count == 1 { g.name.clone() } else { format!("{}[{i}]", g.name) }))
            .collect()
    }

    /// The group that parameter `i` belongs to.
    pub fn group_of(&self, i: usize) -> &DesignGroup {
        let mut end = 0;
        let holds = |group: &&DesignGroup| {
            end += group.count;
            i < end
        };
        self.groups.iter().find(holds).expect("every parameter belongs to a group")
    }

    /// Parameter `i` in SI from its unbounded stand-in `u`.
    pub fn squash<T: Scalar>(&self, i: usize, u: T) -> T {
        let (lo, hi) = self.bounds[i];
        u.sigmoid() * (hi - lo) + lo
    }

    /// The unbounded stand-in of `value`, which is moved inside the limits by a millionth of the range where it is not.
    pub fn unsquash(&self, i: usize, value: f64) -> f64 {
        let (lo, hi) = self.bounds[i];
        let x = ((value - lo) / (hi - lo)).clamp(1e-6, 1.0 - 1e-6);
        (x / (1.0 - x)).ln()
    }

    /// The design in SI from unbounded stand-ins.
    pub fn values(&self, u: &[f64]) -> Vec<f64> {
        u.iter().enumerate().map(|(i, &u)| self.squash(i, u)).collect()
    }

    /// Unbounded stand-ins of a fresh design.
    pub fn sample_initial(&self, rng: &mut Stream) -> Vec<f64> {
        let mut u = Vec::with_capacity(self.len());
        for g in &self.groups {
            for _ in 0..g.count {
                let i = u.len();
                u.push(match g.initial {
                    Initial::Logit { half_width } => (rng.random::<f64>() * 2.0 - 1.0) * half_width,
                    Initial::Value(value) => self.unsquash(i, value),
                });
            }
        }
        u
    }

    /// The sum over each group: the total stiffness of parallel springs, the length of a bar of segments. A group of one
    /// gives its value.
    pub fn totals(&self, design: &[f64]) -> Vec<f64> {
        let mut at = 0;
        self.groups
            .iter()
            .map(|g| {
                at += g.count;
                design[at - g.count..at].iter().sum()
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::streams::{Purpose, stream};

    fn springs(initial: Initial) -> Result<DesignSpace, DesignError> {
        DesignSpace::new(vec![DesignGroup {
            name: "stiffness".into(),
            dimension: Dimension::Stiffness,
            lo: 0.0,
            hi: 10.0,
            count: 3,
            initial,
        }])
    }

    #[test]
    fn squash_and_unsquash_are_inverse() {
        let space = springs(Initial::Logit { half_width: 5.0 }).unwrap();
        for value in [0.01, 1.0, 5.0, 9.9] {
            assert!((space.squash(1, space.unsquash(1, value)) - value).abs() < 1e-12);
        }
        let u = space.sample_initial(&mut stream(0, Purpose::Design, 0, 0));
        assert!(u.iter().all(|u| u.abs() < 5.0));
        assert_eq!(space.totals(&[1.0, 2.0, 3.0]), [6.0]);
        assert_eq!(space.names()[2], "stiffness[2]");
    }

    #[test]
    fn a_start_on_the_limit_is_refused() {
        let error = springs(Initial::Value(10.0)).unwrap_err();
        assert_eq!(error.to_string(), "stiffness: the initial value 10 is not inside (0, 10)");
    }
}
