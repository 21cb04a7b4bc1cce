//! Running means and variances, exact for any order of their parts.

use serde::{Deserialize, Serialize};

use crate::bits;

/// Count, mean and spread of rows of numbers, as sums that grow by rows and by parts.
///
/// Parts that are merged in one order give the same bits, whoever gathered them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Moments {
    /// Rows so far.
    #[serde(with = "bits")]
    pub count: f64,
    /// Mean of each component.
    #[serde(with = "bits")]
    pub mean: Vec<f64>,
    /// Sum of the squared deviations from the mean, of each component.
    #[serde(with = "bits")]
    pub squares: Vec<f64>,
}

impl Moments {
    /// Of rows of `dim` numbers, before the first.
    pub fn new(dim: usize) -> Self {
        Self { count: 0.0, mean: vec![0.0; dim], squares: vec![0.0; dim] }
    }

    /// Takes in a row (Welford 1962).
    #[inline]
    pub fn push(&mut self, row: &[f64]) {
        self.count += 1.0;
        let share = 1.0 / self.count;
        for ((x, mean), squares) in row.iter().zip(&mut self.mean).zip(&mut self.squares) {
            let apart = x - *mean;
            *mean += apart * share;
            *squares += apart * (x - *mean);
        }
    }

    /// Takes in all rows of another one (Chan et al. 1983, eq. 1.5: the sums of both parts joined).
    pub fn merge(&mut self, other: &Self) {
        let total = self.count + other.count;
        if other.count == 0.0 {
            return;
        }
        let own = self.mean.iter_mut().zip(&mut self.squares);
        for ((mean, squares), (of_mean, of_squares)) in own.zip(other.mean.iter().zip(&other.squares)) {
            let apart = of_mean - *mean;
            *mean += apart * other.count / total;
            *squares += of_squares + apart * apart * self.count * other.count / total;
        }
        self.count = total;
    }

    /// The variance of each component over all rows; 0 before the first.
    pub fn variances(&self) -> impl Iterator<Item = f64> + '_ {
        let count = self.count.max(1.0);
        self.squares.iter().map(move |squares| squares / count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1, 2, 4, 9 have mean 4 and squared deviations 9 + 4 + 0 + 25 = 38; 5 five times has no spread.
    #[test]
    fn four_rows_by_hand() {
        let mut moments = Moments::new(2);
        for x in [1.0, 2.0, 4.0, 9.0] {
            moments.push(&[x, 5.0]);
        }
        assert_eq!((moments.count, &moments.mean[..]), (4.0, &[4.0, 5.0][..]));
        assert!((moments.squares[0] - 38.0).abs() < 1e-12 && moments.squares[1] == 0.0, "{moments:?}");
        assert_eq!(moments.variances().collect::<Vec<_>>(), [moments.squares[0] / 4.0, 0.0]);
    }

    /// 1, 2 and 4, 9: means 1.5 and 6.5, squares 0.5 and 12.5, so that together they are
    /// 0.5 + 12.5 + (6.5 - 1.5)²·2·2/4 = 38 around 1.5 + 5·2/4 = 4.
    #[test]
    fn two_parts_by_hand() {
        let part = |rows: [f64; 2]| {
            let mut part = Moments::new(1);
            for x in rows {
                part.push(&[x]);
            }
            part
        };
        let mut whole = part([1.0, 2.0]);
        whole.merge(&part([4.0, 9.0]));
        assert_eq!(whole, Moments { count: 4.0, mean: vec![4.0], squares: vec![38.0] });
        let before = whole.clone();
        whole.merge(&Moments::new(1));
        assert_eq!(whole, before);
        let mut none = Moments::new(1);
        none.merge(&before);
        assert_eq!(none, before);
    }
}
