//! The multipliers of a periodic orbit with their errors, and their product against the exact identity.
//!
//! An error E of the monodromy matrix M moves a simple multiplier λ by at most ‖P‖ ‖E‖ to first order, with the projector
//! P = ∏ (M − λₖ)/(λ − λₖ) on its eigenvector; and any by at most (2‖M‖ + ‖E‖)^¾ ‖E‖^¼ (L. Elsner, Linear Algebra Appl. 71
//! (1985) 77–80). E is the rounding of the product of its factors (`orbit/rounding.rs`) and the change of M from the orbit
//! found to the true one, which residual and rounding of the run tell.

use std::sync::atomic::AtomicBool;

use nalgebra::{Complex, Matrix4, Vector4};

use super::coordinates::Coordinates;
use super::description::Description;
use super::multipliers::multipliers;
use super::periodic::{Missed, Orbit, reached};
use super::rounding::Rounding;
use super::{Cycle, Trajectory, map};
use crate::absorber::{Clock, LawAt};

/// The bound of an error, over its standard error.
const CERTAIN: f64 = 4.0;
/// The error of a computed eigenvalue, as one of the matrix over its norm.
const SOLVER: f64 = 8.0 * f64::EPSILON;
/// The change of a coordinate by which the change of M is found, over the size of the state.
const CHANGE: f64 = 1e-7;

/// The multipliers of a periodic orbit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spectrum {
    /// The multipliers, largest first; those that are 0 by the ride on a wall are exactly 0.
    pub multipliers: [Complex<f64>; 4],
    /// Bounds on their absolute errors.
    pub errors: [f64; 4],
    /// The multipliers of the half map of a symmetric orbit, with their errors.
    pub half: Option<([Complex<f64>; 4], [f64; 4])>,
    /// The largest rank that the monodromy matrix can have: the dimension of the state, 2 less with a ride on a wall, 1 less with a plastic impact.
    pub rank: usize,
    /// The product of the multipliers minus its exact value e^(2N) exp(−∫ contraction): of unlike walls each impact has its
    /// own e, and where e depends on the approach speed u, e d(e u)/du in place of e². `None` with a ride, or where no
    /// identity is known.
    pub determinant_error: Option<f64>,
}

/// A multiplier and its error.
type Known = (Complex<f64>, f64);

/// The multipliers of an orbit with their errors, from one more run of it and four beside it.
///
/// # Errors
/// [`Missed`] if a run does not end.
pub fn spectrum<S: Coordinates + Clone>(
    orbit: &Orbit<S>,
    description: &Description,
    cancel: Option<&AtomicBool>,
) -> Result<Spectrum, Missed> {
    let system = &orbit.trajectory.system;
    let law = |it: &crate::impact::Impact| system.law_at(it.wall, it.approach_speed());
    let plastic = description.impacts.iter().any(|impact| law(impact).restitution == 0.0);
    let lost = match (description.episodes.is_empty(), plastic) {
        (false, _) => 2,
        (true, true) => 1,
        (true, false) => 0,
    };
    let rank = system.dimension() - lost;
    let (matrix, error) = sought(orbit, cancel)?;
    let mut known = with_errors(&matrix, error);
    known[rank..].fill((Complex::new(0.0, 0.0), 0.0));
    let half = orbit.symmetric.then_some(known);
    let squared = |(it, error): Known| (it * it, error * (2.0 * it.norm() + error));
    let all = if orbit.symmetric { sorted(known.map(squared)) } else { known };
    let multipliers = all.map(|(it, _)| it);
    let shrinkage = description.contraction.map(|sum| {
        let shrunk = description.impacts.iter().map(|impact| {
            let LawAt { restitution, rebound, slope, .. } = law(impact);
            let steeper = if slope == rebound { restitution } else { slope };
            restitution * steeper
        });
        shrunk.product::<f64>() * (-sum).exp()
    });
    let product = multipliers.iter().product::<Complex<f64>>().re;
    Ok(Spectrum {
        multipliers,
        errors: all.map(|(_, error)| error),
        half: half.map(|half| (half.map(|(it, _)| it), half.map(|(_, error)| error))),
        rank,
        determinant_error: shrinkage.map(|exact| product - exact),
    })
}

/// The largest first, of a pair that with the positive imaginary part first.
fn sorted(mut known: [Known; 4]) -> [Known; 4] {
    known.sort_by(|(p, _), (q, _)| q.norm().total_cmp(&p.norm()).then(q.im.total_cmp(&p.im)));
    known
}

/// The derivative of the map that was solved, and a bound on the norm of its error.
fn sought<S: Coordinates + Clone>(
    orbit: &Orbit<S>,
    cancel: Option<&AtomicBool>,
) -> Result<(Matrix4<f64>, f64), Missed> {
    let Trajectory { system, state, cycle: Cycle { begin, length }, .. } = &orbit.trajectory;
    let (mirror, length) = if orbit.symmetric { (-1.0, 0.5 * length) } else { (1.0, *length) };
    let mut rounding = Rounding::default();
    let end = reached(&orbit.trajectory, begin + length, cancel, &mut rounding)?;
    let at = system.coordinates(state);
    let matrix = rounding.product * mirror;
    // The distance to the true orbit.
    let back = (Matrix4::identity() - matrix).try_inverse().ok_or(Missed::Singular)?;
    let spread = (back * rounding.state * back.transpose()).diagonal().map(f64::sqrt) * CERTAIN;
    let away = spread + (back * (system.coordinates(&end) * mirror - at)).abs();
    let change = CHANGE * at.amax().max(system.clearance());
    let mut error = rounding.errors() * CERTAIN;
    for coordinate in 0..4 {
        let beside = at + Vector4::ith(coordinate, change);
        let rate = slope(orbit, &beside, length, cancel)?.map(|it| it * mirror - matrix);
        error += rate.map_or(Matrix4::zeros(), |rate| rate.abs() * (away[coordinate] / change));
    }
    Ok((matrix, error.norm() + SOLVER * matrix.norm()))
}

/// The derivative of the map at a point beside the orbit; `None` if that is out of the gap.
fn slope<S: Coordinates + Clone>(
    orbit: &Orbit<S>,
    at: &Vector4<f64>,
    length: f64,
    cancel: Option<&AtomicBool>,
) -> Result<Option<Matrix4<f64>>, Missed> {
    let Trajectory { system, cycle: Cycle { begin, .. }, .. } = &orbit.trajectory;
    let Some(start) = system.start_at(at) else { return Ok(None) };
    let state = system.begin_at(&start, Clock::new(*begin));
    let cycle = Cycle { begin: *begin, length };
    Ok(map(&Trajectory { state, cycle, ..orbit.trajectory.clone() }, true, cancel)?.tangent)
}

/// The eigenvalues of a matrix, largest first, each with a bound on its error from one on that of the matrix.
fn with_errors(matrix: &Matrix4<f64>, error: f64) -> [Known; 4] {
    let all = multipliers(matrix);
    let whole = matrix.map(|element| Complex::new(element, 0.0));
    let any = (2.0 * matrix.norm() + error).powf(0.75) * error.powf(0.25);
    std::array::from_fn(|i| {
        let mut projector: Matrix4<Complex<f64>> = Matrix4::identity();
        let mut distance = 1.0;
        for other in (0..4).filter(|other| *other != i) {
            projector *= whole - Matrix4::from_diagonal_element(all[other]);
            distance *= (all[i] - all[other]).norm();
        }
        let first_order = error * projector.norm() / distance;
        (all[i], if first_order < any { first_order } else { any })
    })
}
