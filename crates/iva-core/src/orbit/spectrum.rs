//! The multipliers of a periodic orbit with their errors, and their product against the exact identity.
//!
//! An error E of the monodromy matrix M moves a simple multiplier λ by at most ‖P‖ ‖E‖ to first order, with the projector
//! P = ∏ (M − λₖ)/(λ − λₖ) on its eigenvector; and any of n by at most (2‖M‖ + ‖E‖)^(1−1/n) ‖E‖^(1/n) (L. Elsner, Linear Algebra Appl. 71
//! (1985) 77–80). E is the rounding of the product of its factors (`orbit/rounding.rs`) and the change of M from the orbit
//! found to the true one, which residual and rounding of the run tell.

use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;

use nalgebra::{Complex, DMatrix, DVector};

use super::coordinates::Coordinates;
use super::description::Description;
use super::multipliers::multipliers;
use super::periodic::{Missed, Orbit, flown, reached, state_at};
use super::rounding::Rounding;
use super::{Cycle, Trajectory};
use crate::absorber::LawAt;
use crate::engine::observe::StickEpisode;

/// The bound of an error, over its standard error.
const CERTAIN: f64 = 4.0;
/// The error of a computed eigenvalue, as one of the matrix over its norm.
const SOLVER: f64 = 8.0 * f64::EPSILON;
/// The change of a coordinate by which the change of M is found, over the size of the state.
const CHANGE: f64 = 1e-7;

/// The multipliers of a periodic orbit.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// The multipliers, largest first; those that are 0 by the ride on a wall are exactly 0.
    pub multipliers: Vec<Complex<f64>>,
    /// Bounds on their absolute errors.
    pub errors: Vec<f64>,
    /// The multipliers of the half map of a symmetric orbit, with their errors.
    pub half: Option<(Vec<Complex<f64>>, Vec<f64>)>,
    /// The largest rank that the monodromy matrix can have: the dimension of the state, 2 less for each absorber that rides on a wall at one
    /// instant, 1 less for another with a plastic impact then.
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
    let law = |it: &crate::impact::Impact| {
        system.law_of(it.absorber.into(), it.wall, it.approach_speed())
    };
    let length = orbit.trajectory.cycle.length;
    let plastic = description.impacts.iter().filter(|it| law(it).restitution == 0.0);
    let rank = system.dimension().saturating_sub(lost(description, plastic, length));
    let (matrix, error) = sought(orbit, cancel)?;
    let mut known = with_errors(&matrix, error);
    known[rank..].fill((Complex::new(0.0, 0.0), 0.0));
    let half = orbit.symmetric.then(|| known.iter().copied().unzip());
    let squared = |(it, error): Known| (it * it, error * (2.0 * it.norm() + error));
    let all =
        if orbit.symmetric { sorted(known.into_iter().map(squared).collect()) } else { known };
    let (multipliers, errors): (Vec<_>, Vec<_>) = all.into_iter().unzip();
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
        errors,
        half,
        rank,
        determinant_error: shrinkage.map(|exact| product - exact),
    })
}

/// How many numbers of a state are lost at one instant of a cycle, at the most: two of each absorber that rides, and one of another that has a
/// plastic impact. What is lost at different instants may be the same.
fn lost<'a>(
    description: &Description,
    plastic: impl Iterator<Item = &'a crate::impact::Impact>,
    length: f64,
) -> usize {
    let rides = |it: &StickEpisode, time: f64| {
        let since = (time - it.stick_time).rem_euclid(length);
        it.release_time.is_some_and(|end| since < end - it.stick_time) || time == it.stick_time
    };
    let riders = |time: f64| {
        let riding = description.episodes.iter().filter(|it| rides(it, time));
        riding.map(|it| it.absorber).collect::<BTreeSet<_>>()
    };
    let by_rides = description.episodes.iter().map(|it| 2 * riders(it.stick_time).len());
    let by_impacts = plastic.map(|it| {
        let riders = riders(it.time);
        2 * riders.len() + usize::from(!riders.contains(&it.absorber))
    });
    by_rides.chain(by_impacts).max().unwrap_or(0)
}

/// The largest first, of a pair that with the positive imaginary part first.
fn sorted(mut known: Vec<Known>) -> Vec<Known> {
    known.sort_by(|(p, _), (q, _)| q.norm().total_cmp(&p.norm()).then(q.im.total_cmp(&p.im)));
    known
}

/// The derivative of the map that was solved, and a bound on the norm of its error.
fn sought<S: Coordinates + Clone>(
    orbit: &Orbit<S>,
    cancel: Option<&AtomicBool>,
) -> Result<(DMatrix<f64>, f64), Missed> {
    let Trajectory { system, state, cycle: Cycle { begin, length }, .. } = &orbit.trajectory;
    let (mirror, length) = if orbit.symmetric { (-1.0, 0.5 * length) } else { (1.0, *length) };
    let mut rounding = Rounding::<S::Derivative>::default();
    let end = reached(&orbit.trajectory, begin + length, cancel, &mut rounding)?;
    let at = system.point(state);
    let count = at.len();
    let matrix = &rounding.product * mirror;
    // The distance to the true orbit.
    let back = (DMatrix::identity(count, count) - &matrix).try_inverse().ok_or(Missed::Singular)?;
    let spread = (&back * &rounding.state * back.transpose()).diagonal().map(f64::sqrt) * CERTAIN;
    let away = spread + (back * (system.point(&end) * mirror - &at)).abs();
    let change = CHANGE * at.amax().max(system.clearance());
    let mut error = rounding.errors() * CERTAIN;
    for coordinate in 0..count {
        let mut beside = at.clone();
        beside[coordinate] += change;
        if let Some(slope) = slope(orbit, &beside, length, cancel)? {
            error += (slope * mirror - &matrix).abs() * (away[coordinate] / change);
        }
    }
    let bound = error.norm() + SOLVER * matrix.norm();
    Ok((matrix, bound))
}

/// The derivative of the map at a point beside the orbit; `None` if that is out of the gap.
fn slope<S: Coordinates + Clone>(
    orbit: &Orbit<S>,
    at: &DVector<f64>,
    length: f64,
    cancel: Option<&AtomicBool>,
) -> Result<Option<DMatrix<f64>>, Missed> {
    let Trajectory { system, cycle: Cycle { begin, .. }, .. } = &orbit.trajectory;
    let Some(state) = state_at(system, at, *begin) else { return Ok(None) };
    Ok(Some(flown(system, (&state, *begin), length, cancel)?.derivative))
}

/// The eigenvalues of a matrix, largest first, each with a bound on its error from one on that of the matrix.
fn with_errors(matrix: &DMatrix<f64>, error: f64) -> Vec<Known> {
    let (all, n) = (multipliers(matrix), matrix.nrows());
    let whole = matrix.map(|element| Complex::new(element, 0.0));
    let elsner = 1.0 / n as f64;
    let any = (2.0 * matrix.norm() + error).powf(1.0 - elsner) * error.powf(elsner);
    let known = |i: usize| {
        let mut projector: DMatrix<Complex<f64>> = DMatrix::identity(n, n);
        let mut distance = 1.0;
        for other in (0..n).filter(|other| *other != i) {
            projector *= &whole - DMatrix::from_diagonal_element(n, n, all[other]);
            distance *= (all[i] - all[other]).norm();
        }
        let first_order = error * projector.norm() / distance;
        (all[i], if first_order < any { first_order } else { any })
    };
    (0..n).map(known).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::absorber::Wall;

    fn ride(absorber: u8, [stick_time, release_time]: [f64; 2]) -> StickEpisode {
        let release_time = Some(release_time);
        let (wall, start_time) = (Wall::Plus, stick_time);
        StickEpisode {
            absorber,
            wall,
            start_time,
            stick_time,
            release_time,
            impacts: 0,
            energy_loss: 0.0,
        }
    }

    /// Four numbers are lost only where two absorbers ride at once, also over the end of a cycle of 10.
    #[test]
    fn rides_at_different_times_lose_no_more_than_one() {
        for (rides, known) in [
            (vec![], 0),
            (vec![ride(0, [1.0, 2.0]), ride(0, [5.0, 6.0])], 2),
            (vec![ride(0, [1.0, 2.0]), ride(1, [3.0, 4.0])], 2),
            (vec![ride(0, [1.0, 3.5]), ride(1, [3.0, 4.0])], 4),
            (vec![ride(0, [8.0, 12.0]), ride(1, [1.0, 1.5])], 4),
        ] {
            let description = Description { episodes: rides, ..Description::default() };
            assert_eq!(lost(&description, std::iter::empty(), 10.0), known, "{description:?}");
        }
    }
}
