//! Conjugate gradients (Hestenes and Stiefel 1952).

/// What [`conjugate_gradient`] found.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// The solution, as far as it goes.
    pub x: Vec<f64>,
    /// What is left, b - H·x, as the recursion has it.
    pub residual: Vec<f64>,
    /// Products H·v that it took.
    pub iterations: usize,
}

/// Solves H·x = b for a symmetric positive definite H, of which it needs to know no more than `product`, which writes H·v
/// into its second argument. It ends after so many iterations, where the squared norm of the residual is below `tolerance`,
/// or where H turns out not to be positive.
pub fn conjugate_gradient(
    b: &[f64],
    iterations: usize,
    tolerance: f64,
    mut product: impl FnMut(&[f64], &mut [f64]),
) -> Solution {
    let mut out = Solution { x: vec![0.0; b.len()], residual: b.to_vec(), iterations: 0 };
    let (mut direction, mut curved) = (b.to_vec(), vec![0.0; b.len()]);
    let mut left = dot(b, b);
    while out.iterations < iterations && left >= tolerance {
        product(&direction, &mut curved);
        out.iterations += 1;
        let curvature = dot(&direction, &curved);
        if curvature <= 0.0 {
            break;
        }
        let along = left / curvature;
        for i in 0..b.len() {
            out.x[i] += along * direction[i];
            out.residual[i] -= along * curved[i];
        }
        let next = dot(&out.residual, &out.residual);
        let keep = next / left;
        for (d, r) in direction.iter_mut().zip(&out.residual) {
            *d = r + keep * *d;
        }
        left = next;
    }
    out
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    fn multiply(h: &DMatrix<f64>) -> impl Fn(&[f64], &mut [f64]) + use<> {
        let h = h.clone();
        move |v, out| out.copy_from_slice((&h * DVector::from_column_slice(v)).as_slice())
    }

    proptest! {
        /// Against a direct solve; and what the recursion takes for the residual is the residual.
        #[test]
        fn solves_as_a_factorisation_does(entries in prop::collection::vec(-1.0..1.0_f64, 36), b in prop::collection::vec(-1.0..1.0_f64, 6)) {
            let a = DMatrix::from_vec(6, 6, entries);
            let h = &a * a.transpose() + DMatrix::identity(6, 6) * 0.1;
            let found = conjugate_gradient(&b, 30, 1e-24, multiply(&h));
            let b = DVector::from_vec(b);
            let wanted = h.clone().cholesky().unwrap().solve(&b);
            let x = DVector::from_vec(found.x);
            prop_assert!((&x - &wanted).norm() < 1e-8 * (1.0 + wanted.norm()));
            prop_assert!((b - h * x - DVector::from_vec(found.residual)).norm() < 1e-9);
        }
    }

    /// As many steps as there are different eigenvalues, and no more than asked for.
    #[test]
    fn counts_its_steps() {
        let h = DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, 4.0, 4.0, 9.0]));
        assert_eq!(conjugate_gradient(&[1.0; 4], 10, 1e-20, multiply(&h)).iterations, 3);
        assert_eq!(conjugate_gradient(&[1.0; 4], 2, 1e-20, multiply(&h)).iterations, 2);
        assert_eq!(conjugate_gradient(&[0.0; 4], 10, 1e-20, multiply(&h)).iterations, 0);
        assert_eq!(conjugate_gradient(&[1e-6; 4], 10, 1e-10, multiply(&h)).iterations, 0);
    }

    /// A direction in which H is not positive is no way to go.
    #[test]
    fn stops_where_nothing_curves() {
        let found = conjugate_gradient(&[1.0, 0.0], 10, 1e-10, |v, out| out.copy_from_slice(&[-v[0], v[1]]));
        assert_eq!((found.x, found.iterations), (vec![0.0; 2], 1));
    }
}
