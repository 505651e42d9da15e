//! The multipliers of a monodromy matrix.

use nalgebra::{DMatrix, Matrix4, Schur};

pub use nalgebra::Complex;

/// Most iterations of a Schur decomposition: it converges in some ten, or hardly ever.
const MOST_ITERATIONS: usize = 200;
/// Most iterations of the fallback.
const MOST_SWEEPS: usize = 200;

/// The eigenvalues of a matrix, largest first; of a pair that with the positive imaginary part first.
pub fn multipliers(matrix: &DMatrix<f64>) -> Vec<Complex<f64>> {
    // The iteration has no exceptional shifts and can stall where eigenvalues lie on the unit circle; for the transpose it
    // takes another path to the same ones.
    let attempt = |matrix| Schur::try_new(matrix, f64::EPSILON, MOST_ITERATIONS);
    let all = match attempt(matrix.clone()).or_else(|| attempt(matrix.transpose())) {
        Some(schur) => schur.complex_eigenvalues().iter().copied().collect(),
        None => roots(&characteristic(matrix)),
    };
    largest_first(all)
}

/// Those of the map of one absorber.
pub(crate) fn of_four(map: &Matrix4<f64>) -> [Complex<f64>; 4] {
    let all = multipliers(&DMatrix::from_column_slice(4, 4, map.as_slice()));
    std::array::from_fn(|i| all[i])
}

/// The same numbers, the largest first; of a pair that with the positive imaginary part first.
pub(super) fn largest_first<A: AsMut<[Complex<f64>]>>(mut all: A) -> A {
    all.as_mut().sort_by(|p, q| q.norm().total_cmp(&p.norm()).then(q.im.total_cmp(&p.im)));
    all
}

/// The coefficients of λⁿ + … + c₁ λ + c₀, from c₀ on (U. Le Verrier, D. K. Faddeev).
fn characteristic(matrix: &DMatrix<f64>) -> Vec<f64> {
    let n = matrix.nrows();
    let mut coefficients = vec![0.0; n];
    let mut product = matrix.clone();
    for k in 1..=n {
        let c = -product.trace() / k as f64;
        coefficients[n - k] = c;
        product = matrix * (product + DMatrix::from_diagonal_element(n, n, c));
    }
    coefficients
}

/// The roots of that polynomial, all at once (K. Weierstrass, E. Durand, I. O. Kerner).
fn roots(coefficients: &[f64]) -> Vec<Complex<f64>> {
    let n = coefficients.len();
    let size = coefficients.iter().fold(1.0, |size: f64, c| size.max(c.abs()));
    let begin = |k| Complex::new(0.4, 0.9).powi(k as i32) * size.powf(1.0 / n as f64);
    let mut all: Vec<Complex<f64>> = (0..n).map(begin).collect();
    for _ in 0..MOST_SWEEPS {
        let mut moved: f64 = 0.0;
        for k in 0..n {
            let z = all[k];
            let value =
                coefficients.iter().rev().fold(Complex::new(1.0, 0.0), |sum, c| sum * z + c);
            let others = (0..n).filter(|j| *j != k).map(|j| z - all[j]);
            let step = value / others.product::<Complex<f64>>();
            if step.re.is_finite() && step.im.is_finite() {
                all[k] -= step;
                moved = moved.max(step.norm());
            }
        }
        if moved <= f64::EPSILON * size {
            break;
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    /// The eigenvalues that a matrix was made from: .8 ± .3 i, −.5 and 1e-3.
    #[test]
    fn both_ways_find_planted_eigenvalues() {
        let planted = Matrix4::new(
            0.8, 0.3, 0.7, -0.2, -0.3, 0.8, 0.1, 0.4, 0.0, 0.0, -0.5, 0.6, 0.0, 0.0, 0.0, 1e-3,
        );
        let turn = Matrix4::new(
            1.0, 0.4, 0.2, 0.1, 0.0, 1.0, 0.3, -0.6, 0.5, 0.0, 1.0, 0.2, 0.1, -0.3, 0.0, 1.0,
        );
        let inverse = turn.try_inverse().map_or(Matrix4::zeros(), |inverse| inverse);
        let matrix = turn * planted * inverse;
        let matrix = DMatrix::from_column_slice(4, 4, matrix.as_slice());
        let truth = [(0.8, 0.3), (0.8, -0.3), (-0.5, 0.0), (1e-3, 0.0)];
        let slow = largest_first(roots(&characteristic(&matrix)));
        for found in [multipliers(&matrix), slow] {
            for (found, (re, im)) in found.iter().zip(truth) {
                assert!((found - Complex::new(re, im)).norm() < 1e-14, "{found} {re} {im}");
            }
        }
    }
}
