//! Eigenvalues of small symmetric matrices by Jacobi rotations: the only linear algebra that a calibration needs.

/// Returns the eigenvalues in descending order, each with its unit eigenvector, of a symmetric matrix with finite
/// entries. Only the upper triangle is read. Cyclic Jacobi method (Golub and Van Loan, "Matrix Computations", 8.5).
pub fn symmetric_eigen<const N: usize>(matrix: [[f64; N]; N]) -> [(f64, [f64; N]); N] {
    let mut a: [[f64; N]; N] =
        std::array::from_fn(|i| std::array::from_fn(|j| matrix[i.min(j)][i.max(j)]));
    let mut v: [[f64; N]; N] =
        std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    let size: f64 = a.as_flattened().iter().map(|x| x * x).sum();
    // Convergence is quadratic; a 4x4 matrix takes about six sweeps.
    for _ in 0..32 {
        let beside = |(i, row): (usize, &[f64; N])| row[i + 1..].iter().map(|x| x * x).sum::<f64>();
        if a.iter().enumerate().map(beside).sum::<f64>() <= 1.0e-32 * size {
            break;
        }
        for p in 0..N {
            for q in p + 1..N {
                rotate(&mut a, &mut v, p, q);
            }
        }
    }
    let mut pairs: [(f64, [f64; N]); N] =
        std::array::from_fn(|i| (a[i][i], std::array::from_fn(|k| v[k][i])));
    pairs.sort_by(|x, y| y.0.total_cmp(&x.0));
    pairs
}

/// Applies a rotation that makes entry (p, q), p below q, zero, to the matrix and to the vectors.
fn rotate<const N: usize>(a: &mut [[f64; N]; N], v: &mut [[f64; N]; N], p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
    let c = 1.0 / t.hypot(1.0);
    let s = t * c;
    for row in a.iter_mut().chain(v) {
        (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
    }
    let (upper, lower) = a.split_at_mut(q);
    for (x, y) in upper[p].iter_mut().zip(&mut lower[0]) {
        (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn solves_the_eigen_equation(entries in prop::collection::vec(-5.0..5.0f64, 16)) {
            let m: [[f64; 4]; 4] = std::array::from_fn(|i| {
                std::array::from_fn(|j| entries[4 * i.min(j) + i.max(j)])
            });
            let pairs = symmetric_eigen(m);
            for (i, (value, vector)) in pairs.iter().enumerate() {
                for r in 0..4 {
                    let product: f64 = (0..4).map(|c| m[r][c] * vector[c]).sum();
                    prop_assert!((product - value * vector[r]).abs() < 1e-9);
                }
                for (j, other) in pairs.iter().enumerate() {
                    let dot: f64 = (0..4).map(|k| vector[k] * other.1[k]).sum();
                    prop_assert!((dot - f64::from(u8::from(i == j))).abs() < 1e-9);
                }
            }
            prop_assert!(pairs.windows(2).all(|w| w[0].0 >= w[1].0));
        }
    }

    #[test]
    fn zero_and_diagonal_matrices() {
        assert!(symmetric_eigen([[0.0; 3]; 3]).iter().all(|(value, _)| *value == 0.0));
        let d = symmetric_eigen([[1.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 2.0]]);
        assert_eq!(d.map(|(value, _)| value), [3.0, 2.0, 1.0]);
    }
}
