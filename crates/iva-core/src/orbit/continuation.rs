//! Solutions of m equations in m + 1 unknowns along a curve: pseudo-arclength continuation (H. B. Keller).
//!
//! A step goes along the tangent, and Newton's method leads back to the curve in the plane normal to the tangent. So
//! the curve may turn back in any unknown. Lengths along the curve and normals are those of the unknowns divided by their
//! scales, so that they do not depend on units.

use nalgebra::{DMatrix, DVector};

/// Most iterations of a singular value decomposition.
const MOST_ITERATIONS: usize = 1000;
/// Most steps of Newton's method.
const MOST_STEPS: u32 = 10;
/// A step of Newton's method of this size, in scales, is rounding.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// A step of this size, in scales, that is not followed by a smaller one is rounding where the equations are sensitive to it.
const SOLVED: f64 = 1e-9;

/// The left-hand sides of equations, and their derivatives with respect to the unknowns.
pub(super) type Sides = (DVector<f64>, DMatrix<f64>);

/// Equations for some unknowns.
pub(super) trait Equations {
    /// Their values at a point; `None` where they are not defined.
    fn at(&self, point: &DVector<f64>) -> Option<Sides>;
}

/// The solution of as many equations as unknowns near a point, by Newton's method.
pub(super) fn solved(
    from: &DVector<f64>,
    scales: &DVector<f64>,
    equations: &dyn Fn(&DVector<f64>) -> Option<Sides>,
) -> Option<DVector<f64>> {
    let mut point = from.clone();
    let mut before = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        let (sides, mut derivatives) = equations(&point)?;
        for (mut column, scale) in derivatives.column_iter_mut().zip(scales.iter()) {
            column *= *scale;
        }
        let step = derivatives.lu().solve(&-sides)?;
        let size = step.norm();
        if !size.is_finite() {
            return None;
        }
        if size >= before && before <= SOLVED {
            return Some(point);
        }
        point += step.component_mul(scales);
        if size <= ROUNDING {
            return Some(point);
        }
        before = size;
    }
    (before <= SOLVED).then_some(point)
}

/// The distance between two points, in scales.
pub(super) fn distance(a: &DVector<f64>, b: &DVector<f64>, scales: &DVector<f64>) -> f64 {
    (a - b).component_div(scales).norm()
}

/// The unit vector, in scales, in the direction in which a function with these derivatives changes least.
pub(super) fn kernel(derivatives: &DMatrix<f64>, scales: &DVector<f64>) -> Option<DVector<f64>> {
    let (rows, count) = derivatives.shape();
    let mut matrix = DMatrix::zeros(count, count);
    matrix.rows_mut(0, rows).copy_from(derivatives);
    for (mut column, scale) in matrix.column_iter_mut().zip(scales.iter()) {
        column *= *scale;
    }
    let parts = matrix.try_svd(false, true, f64::EPSILON, MOST_ITERATIONS)?;
    let least = parts.singular_values.imin();
    Some(parts.v_t?.row(least).transpose())
}

/// A point of a curve, and its tangent there, of unit length in scales.
#[derive(Debug, Clone)]
pub(super) struct OnCurve {
    pub point: DVector<f64>,
    pub tangent: DVector<f64>,
}

/// A curve, by its equations and the scales of the unknowns.
pub(super) struct Curve<'a> {
    pub equations: &'a dyn Equations,
    pub scales: DVector<f64>,
}

impl Curve<'_> {
    /// The equations, and one more: that the unknowns are in the plane through a point with this normal.
    fn bordered(
        &self,
        at: &DVector<f64>,
        origin: &DVector<f64>,
        normal: &DVector<f64>,
    ) -> Option<Sides> {
        let (sides, derivatives) = self.equations.at(at)?;
        let (rows, row) = (sides.len(), normal.component_div(&self.scales));
        let beyond = row.dot(&(at - origin));
        let sides = sides.push(beyond);
        let mut matrix = derivatives.insert_row(rows, 0.0);
        matrix.row_mut(rows).copy_from(&row.transpose());
        Some((sides, matrix))
    }

    /// The tangent at a point of the curve, on the side of another vector.
    fn tangent(&self, point: &DVector<f64>, towards: &DVector<f64>) -> Option<DVector<f64>> {
        let (mut right, mut matrix) = self.bordered(point, point, towards)?;
        for (mut column, scale) in matrix.column_iter_mut().zip(self.scales.iter()) {
            column *= *scale;
        }
        right.fill(0.0);
        right[towards.len() - 1] = 1.0;
        let tangent = matrix.lu().solve(&right)?;
        let size = tangent.norm();
        (size.is_finite() && size > 0.0).then(|| tangent / size)
    }

    /// The point of the curve near a point, in the plane normal to a vector, with its tangent on the side of that vector.
    pub fn nearby(&self, from: &DVector<f64>, normal: &DVector<f64>) -> Option<OnCurve> {
        let point = solved(from, &self.scales, &|at| self.bordered(at, from, normal))?;
        let tangent = self.tangent(&point, normal)?;
        Some(OnCurve { point, tangent })
    }

    /// The point a step further along the curve.
    pub fn next(&self, from: &OnCurve, step: f64) -> Option<OnCurve> {
        let guess = &from.point + (&from.tangent * step).component_mul(&self.scales);
        self.nearby(&guess, &from.tangent)
    }

    /// The point near another one at which an unknown has a value.
    pub fn where_unknown_is(&self, from: &OnCurve, index: usize, value: f64) -> Option<OnCurve> {
        let mut guess = from.point.clone();
        guess[index] = value;
        let mut normal = DVector::zeros(guess.len());
        normal[index] = if from.tangent[index] < 0.0 { -1.0 } else { 1.0 };
        self.nearby(&guess, &normal)
    }
}
