//! How near a trajectory has to be to a stable orbit to stay with it.
//!
//! Close to a strobe p the map over the periods of the orbit is p + M (z − p). In the norm
//!
//! ```text
//! V(z) = Σ |Mᵏ (z − p)|²,  k = 0, 1, 2, …
//! ```
//!
//! it comes nearer with each application, by V(Mz) = V(z) − |z − p|². Further off the map is not linear, and where an impact
//! is missed it jumps. So the neighbourhood is an ellipsoid V < r² whose radius is tried: from points on it and within it
//! the map has as many impacts as the orbit, where that has no ride, and takes at least half of |z − p|² from V. That is a sample, no proof; half of the radius
//! that passes is used.

use std::sync::atomic::AtomicBool;

use nalgebra::{DMatrix, DVector};

use super::attractors::Attractor;
use super::coordinates::{Coordinates, Strobe as _};
use super::periodic::state_at;
use super::{Trajectory, map};
use crate::engine::simulate::Outcome;

/// Most halvings of the radius.
const MOST_HALVINGS: u32 = 30;
/// Most doublings of the number of terms of V: an orbit that needs more is hardly stable.
const MOST_DOUBLINGS: u32 = 40;
/// Number of directions that are tried for each number of a state, and the parts of the radius.
const DIRECTIONS: usize = 12;
const PARTS: [f64; 3] = [1.0, 0.7, 0.35];

/// An ellipsoid around a strobe of a stable orbit, in which trajectories stay with the orbit.
#[derive(Debug, Clone)]
pub struct Neighbourhood {
    /// Index of the attractor.
    pub attractor: usize,
    /// The strobe.
    pub centre: DVector<f64>,
    /// A matrix A: the points z with |A (z − p)| < 1 are within.
    shape: DMatrix<f64>,
    /// The smallest half axis of the ellipsoid.
    pub radius: f64,
}

impl Neighbourhood {
    /// True if a state is within.
    #[inline]
    pub fn holds(&self, at: &[f64]) -> bool {
        let off = |j: usize| at[j] - self.centre[j];
        let part = |row: usize| (0..at.len()).map(|j| self.shape[(row, j)] * off(j)).sum::<f64>();
        (0..at.len()).map(|row| part(row).powi(2)).sum::<f64>() < 1.0
    }
}

/// The neighbourhoods of all strobes of attractors of a scene, given with a trajectory of it. A strobe that none is found for has none:
/// trajectories are caught at the others.
pub fn neighbourhoods<S: Coordinates + Clone>(
    trajectory: &Trajectory<S>,
    attractors: &[Attractor<S>],
    cancel: Option<&AtomicBool>,
) -> Vec<Neighbourhood> {
    let mut all = vec![];
    for (index, attractor) in attractors.iter().enumerate() {
        let periods = attractor.periods();
        for strobe in attractor.strobes.iter().chain(attractor.mirrored.iter().flatten()) {
            let centre = DVector::from_column_slice(strobe.numbers());
            let around = Around { trajectory, centre, periods, cancel };
            all.extend(around.neighbourhood(index));
        }
    }
    all
}

/// The end of some cycles.
struct End {
    at: DVector<f64>,
    impacts: u64,
    rides: u64,
    derivative: DMatrix<f64>,
}

/// What is known of a strobe.
struct Around<'a, S: Coordinates> {
    trajectory: &'a Trajectory<S>,
    centre: DVector<f64>,
    periods: usize,
    cancel: Option<&'a AtomicBool>,
}

impl<S: Coordinates + Clone> Around<'_, S> {
    /// The image of a point after the periods of the orbit: `None` if it is not in the gap; the end is `None` if a cycle does not
    /// end.
    fn end(&self, at: &DVector<f64>, tangents: bool) -> Option<Option<End>> {
        let system = &self.trajectory.system;
        let state = state_at(system, at, self.trajectory.cycle.begin)?;
        let mut trajectory = self.trajectory.from(&state);
        let (mut impacts, mut rides, mut derivative) =
            (0, 0, DMatrix::identity(at.len(), at.len()));
        for _ in 0..self.periods {
            let Ok(image) = map(&trajectory, tangents, self.cancel) else { return Some(None) };
            if image.outcome != Outcome::Finished {
                return Some(None);
            }
            if let Some(tangent) = image.tangent {
                derivative = tangent.matrix * derivative;
            }
            impacts += image.impacts;
            rides += image.rides;
            trajectory.state = image.state;
        }
        Some(Some(End { at: system.point(&trajectory.state), impacts, rides, derivative }))
    }

    fn neighbourhood(&self, attractor: usize) -> Option<Neighbourhood> {
        let orbit = self.end(&self.centre, true)??;
        let factor = norm(&orbit.derivative)?;
        let inverse = factor.clone().try_inverse()?;
        let size = self.trajectory.system.clearance().max(self.centre.amax());
        // V is at least |z − p|²: no point of the ellipsoid is further away than its radius.
        let mut radius = size;
        for _ in 0..MOST_HALVINGS {
            if self.is_kept(radius, (&factor, &inverse), &orbit) {
                let shape = factor / (0.5 * radius);
                let radius = 1.0 / shape.norm();
                return Some(Neighbourhood {
                    attractor,
                    centre: self.centre.clone(),
                    shape,
                    radius,
                });
            }
            radius *= 0.5;
        }
        None
    }

    /// True if all points tried come nearer.
    fn is_kept(
        &self,
        radius: f64,
        (factor, inverse): (&DMatrix<f64>, &DMatrix<f64>),
        orbit: &End,
    ) -> bool {
        let count = self.centre.len();
        (0..DIRECTIONS * count).all(|k| {
            let direction = inverse * direction(k, count);
            PARTS.iter().all(|part| {
                let off = &direction * (radius * part);
                match self.end(&(&self.centre + &off), false) {
                    // No state is there.
                    None => true,
                    Some(None) => false,
                    Some(Some(end)) => {
                        let [before, after] =
                            [&off, &(end.at - &self.centre)].map(|z| (factor * z).norm_squared());
                        // Of a chatter that ends in a ride the number of impacts is no number of the orbit.
                        let alike = orbit.rides > 0 || end.impacts == orbit.impacts;
                        alike && after <= before - 0.5 * off.norm_squared()
                    }
                }
            })
        })
    }
}

/// A matrix A with |A z|² = Σ |Mᵏ z|²; `None` if the sum does not end.
fn norm(monodromy: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let count = monodromy.ncols();
    let (mut sum, mut power) = (DMatrix::identity(count, count), monodromy.clone());
    for _ in 0..MOST_DOUBLINGS {
        if power.norm() < f64::EPSILON {
            break;
        }
        sum += power.transpose() * &sum * &power;
        power = &power * &power;
    }
    let ends = power.norm() < 1.0 && sum.iter().all(|it| it.is_finite());
    ends.then(|| sum.cholesky()).flatten().map(|factors| factors.l().transpose())
}

/// A unit vector of so many numbers: both senses of the axes first, then directions that fill the sphere evenly, by the multiples of
/// powers of a number (M. Roberts, Rₙ).
fn direction(k: usize, count: usize) -> DVector<f64> {
    let mut unit = DVector::zeros(count);
    if k < 2 * count {
        unit[k / 2] = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        return unit;
    }
    // The root of gⁿ⁺¹ = g + 1.
    let root = (0..MOST_DOUBLINGS).fold(1.0, |g: f64, _| (1.0 + g).powf(1.0 / (count + 1) as f64));
    let mut share = 1.0;
    for part in unit.iter_mut() {
        share /= root;
        *part = 2.0 * (k as f64 * share).fract() - 1.0;
    }
    unit.normalize()
}
