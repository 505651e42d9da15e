//! Modes from the matrices of mass, stiffness and damping.
//!
//! With M = L Lᵀ (Cholesky) the symmetric matrix L⁻¹ K L⁻ᵀ has the eigenvalues ω² and eigenvectors v, and φ = L⁻ᵀ v are
//! the mass-normalised shapes. Eigenvalues are found by Jacobi's rotations (C. G. J. Jacobi, 1846; G. H. Golub and C. F. Van
//! Loan, *Matrix Computations*, §8.5), which take only + − × ÷ √ in any number type, and are accurate for small
//! eigenvalues too.

use super::ModalStructure;
use super::structure::{Damping, checked_damping, counted, same, symmetrical};
use crate::error::{Invalid, number};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

/// Largest number of sweeps over all pairs; ten are enough for any matrix of some forty rows.
const SWEEPS: usize = 40;
/// Elements of this size, in units of 2⁻⁵² of the diagonal times the number of modes, are none.
const NOTHING_ULPS: f64 = 16.0;

impl<R: Real> ModalStructure<R> {
    /// The modes of M ẍ + C ẋ + K x = 0, each matrix of n rows given row by row, in consistent units. The names are those
    /// of the n displacements, which become points of the structure.
    ///
    /// M is positive definite; K and C feed no energy: they have no negative eigenvalue. Where C does not couple the
    /// modes, each has a damping of its own; otherwise they have a full damping matrix.
    ///
    /// # Errors
    /// [`Invalid`] naming the matrix that is not of this kind, with what is wrong.
    pub fn from_matrices(
        names: &[&str],
        mass: &[R],
        stiffness: &[R],
        damping: &[R],
    ) -> Result<Self, Invalid> {
        let n = names.len();
        counted("structure.points", n)?;
        for (field, matrix) in [("mass", mass), ("stiffness", stiffness), ("damping", damping)] {
            same(&format!("structure.{field}"), matrix.len(), n * n)?;
        }
        let m = symmetrical("structure.mass", mass, n)?;
        let k = symmetrical("structure.stiffness", stiffness, n)?;
        let c = checked_damping("structure.damping", damping, n)?;
        let lower = cholesky(&m, n).ok_or_else(|| {
            let least = number(least_eigenvalue(&m, n));
            let rule = "the mass matrix is to be positive definite; this is its least eigenvalue";
            Invalid::new("structure.mass", least, rule)
        })?;
        let mut reduced = congruent(&lower, &k, n);
        let mut vectors = eigen(&mut reduced, n);
        // φ = L⁻ᵀ v, column by column.
        for j in 0..n {
            for i in (0..n).rev() {
                let above = (i + 1..n)
                    .fold(vectors[i * n + j], |sum, l| sum - lower[l * n + i] * vectors[l * n + j]);
                vectors[i * n + j] = above / lower[i * n + i];
            }
        }
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|a, b| reduced[a * n + a].total_cmp(&reduced[b * n + b]));
        let most = order.last().map_or(R::ZERO, |last| reduced[last * n + last].abs());
        // The matrices may have been rounded to doubles.
        let small = most * (f64::EPSILON * (NOTHING_ULPS * n as f64));
        let mut squares = Vec::with_capacity(n);
        for j in &order {
            let square = reduced[j * n + j];
            if square < -small {
                let rule = "springs feed no energy: give a stiffness matrix without negative \
                            eigenvalue; this is one of M⁻¹K";
                return Err(Invalid::new("structure.stiffness", number(square), rule));
            }
            squares.push(DoubleDouble::new(square.max(R::ZERO)));
        }
        let shape = |i: usize, j: usize| vectors[i * n + order[j]];
        let modal = |i: usize, j: usize| {
            let mut sum = DoubleDouble::ZERO;
            for a in 0..n {
                for b in 0..n {
                    let both = DoubleDouble::new(shape(a, i)).times(shape(b, j));
                    sum = sum + both.times(c[a * n + b]);
                }
            }
            sum
        };
        let rates: Vec<_> = (0..n).map(|j| modal(j, j)).collect();
        let largest = rates.iter().fold(R::ZERO, |most, rate| most.max(rate.value.abs()));
        let nothing = largest * (R::EPSILON * (NOTHING_ULPS * n as f64));
        let full: Vec<R> = (0..n * n)
            .map(|e| if e % n <= e / n { modal(e / n, e % n) } else { modal(e % n, e / n) }.value)
            .collect();
        let couples = (0..n * n).any(|e| e / n != e % n && full[e].abs() > nothing);
        // A damping below 0 is rounding: C has no negative eigenvalue.
        let separate =
            || rates.iter().map(|rate| if rate.value < 0.0 { DoubleDouble::ZERO } else { *rate });
        let damping =
            if couples { Damping::Full(full) } else { Damping::Separate(separate().collect()) };
        let mut structure = Self::of(squares, damping);
        for (i, name) in names.iter().enumerate() {
            let shapes: Vec<R> = (0..n).map(|j| shape(i, j)).collect();
            structure = structure.with_point(name, &shapes)?;
        }
        Ok(structure)
    }

    /// q of displacements, or q̇ of velocities, of a structure from matrices: φᵀ M x.
    ///
    /// # Errors
    /// [`Invalid`] if there are not as many as points, or not as many points as modes.
    pub fn modal(&self, mass: &[R], displacements: &[R]) -> Result<Vec<R>, Invalid> {
        let n = self.count();
        same("start.displacements", displacements.len(), n)?;
        same("structure.mass", mass.len(), n * n)?;
        same("structure.points", self.points().count(), n)?;
        let momentum = |i: usize| {
            (0..n).fold(DoubleDouble::ZERO, |sum, l| {
                sum + DoubleDouble::new(mass[i * n + l]).times(displacements[l])
            })
        };
        let momenta: Vec<_> = (0..n).map(momentum).collect();
        let coordinate = |j: usize| {
            (0..n).fold(DoubleDouble::ZERO, |sum, i| sum + momenta[i].times(self.shape(i)[j]))
        };
        Ok((0..n).map(|j| coordinate(j).value).collect())
    }
}

/// L of a matrix L Lᵀ; `None` if it is not positive definite.
fn cholesky<R: Real>(matrix: &[R], n: usize) -> Option<Vec<R>> {
    let mut lower = vec![R::ZERO; n * n];
    for i in 0..n {
        for j in 0..=i {
            let less =
                (0..j).fold(matrix[i * n + j], |sum, l| sum - lower[i * n + l] * lower[j * n + l]);
            if i != j {
                lower[i * n + j] = less / lower[j * n + j];
            } else if less > matrix[i * n + i] * (R::EPSILON * NOTHING_ULPS) {
                lower[i * n + i] = less.sqrt();
            } else {
                return None;
            }
        }
    }
    Some(lower)
}

/// L⁻¹ K L⁻ᵀ.
fn congruent<R: Real>(lower: &[R], matrix: &[R], n: usize) -> Vec<R> {
    let mut reduced = matrix.to_vec();
    for _ in 0..2 {
        // The columns solved, then the rows, by the same code on the transposed matrix.
        for j in 0..n {
            for i in 0..n {
                let less = (0..i)
                    .fold(reduced[i * n + j], |sum, l| sum - lower[i * n + l] * reduced[l * n + j]);
                reduced[i * n + j] = less / lower[i * n + i];
            }
        }
        for i in 0..n {
            for j in 0..i {
                reduced.swap(i * n + j, j * n + i);
            }
        }
    }
    for i in 0..n {
        for j in 0..i {
            let mean = reduced[i * n + j].midpoint(reduced[j * n + i]);
            (reduced[i * n + j], reduced[j * n + i]) = (mean, mean);
        }
    }
    reduced
}

/// Makes a symmetric matrix diagonal by rotations, and returns their product: the eigenvectors, as columns.
fn eigen<R: Real>(matrix: &mut [R], n: usize) -> Vec<R> {
    let mut vectors = vec![R::ZERO; n * n];
    for i in 0..n {
        vectors[i * n + i] = R::ONE;
    }
    for _ in 0..SWEEPS {
        let mut turned = false;
        for p in 0..n {
            for q in p + 1..n {
                let (off, low, high) = (matrix[p * n + q], matrix[p * n + p], matrix[q * n + q]);
                let nothing = (low.abs() * high.abs()).sqrt() * (R::EPSILON * 0.125);
                if off.abs() <= nothing || off == 0.0 {
                    continue;
                }
                turned = true;
                // The smaller root of t² + 2θt − 1 = 0.
                let theta = (high - low) / (off * 2.0);
                let t = R::ONE.copysign(theta) / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = R::ONE / (t * t + 1.0).sqrt();
                let s = t * c;
                for l in 0..n {
                    let (a, b) = (matrix[l * n + p], matrix[l * n + q]);
                    (matrix[l * n + p], matrix[l * n + q]) = (c * a - s * b, s * a + c * b);
                }
                for l in 0..n {
                    let (a, b) = (matrix[p * n + l], matrix[q * n + l]);
                    (matrix[p * n + l], matrix[q * n + l]) = (c * a - s * b, s * a + c * b);
                    let (a, b) = (vectors[l * n + p], vectors[l * n + q]);
                    (vectors[l * n + p], vectors[l * n + q]) = (c * a - s * b, s * a + c * b);
                }
                (matrix[p * n + q], matrix[q * n + p]) = (R::ZERO, R::ZERO);
            }
        }
        if !turned {
            break;
        }
    }
    vectors
}

/// The least eigenvalue of a symmetric matrix.
pub(super) fn least_eigenvalue<R: Real>(matrix: &[R], n: usize) -> R {
    let mut diagonal = matrix.to_vec();
    eigen(&mut diagonal, n);
    (0..n).fold(R::INFINITY, |least, i| least.min(diagonal[i * n + i]))
}
