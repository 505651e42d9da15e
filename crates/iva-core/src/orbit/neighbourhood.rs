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
//! the map has the impacts of the orbit and takes at least half of |z − p|² from V. That is a sample, no proof; half of the radius
//! that passes is used.

use std::sync::atomic::AtomicBool;

use nalgebra::{Matrix4, Vector4};

use super::attractors::Attractor;
use super::coordinates::{Coordinates, Strobe as _};
use super::{Trajectory, map};
use crate::absorber::Clock;
use crate::engine::simulate::Outcome;

/// Most halvings of the radius.
const MOST_HALVINGS: u32 = 30;
/// Most doublings of the number of terms of V: an orbit that needs more is hardly stable.
const MOST_DOUBLINGS: u32 = 40;
/// Number of directions that are tried, and the parts of the radius.
const DIRECTIONS: u32 = 48;
const PARTS: [f64; 3] = [1.0, 0.7, 0.35];

/// An ellipsoid around a strobe of a stable orbit, in which trajectories stay with the orbit.
#[derive(Debug, Clone)]
pub struct Neighbourhood {
    /// Index of the attractor.
    pub attractor: usize,
    /// The strobe.
    pub centre: Vector4<f64>,
    /// A matrix A: the points z with |A (z − p)| < 1 are within.
    shape: Matrix4<f64>,
    /// The smallest half axis of the ellipsoid.
    pub radius: f64,
}

impl Neighbourhood {
    /// True if a state is within.
    #[inline]
    pub fn holds(&self, at: &Vector4<f64>) -> bool {
        (self.shape * (at - self.centre)).norm_squared() < 1.0
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
            // Of one absorber on one mode.
            let Ok(centre) = <[f64; 4]>::try_from(strobe.numbers()) else { continue };
            let around = Around { trajectory, centre: centre.into(), periods, cancel };
            all.extend(around.neighbourhood(index));
        }
    }
    all
}

/// The end of some cycles.
struct End {
    at: Vector4<f64>,
    impacts: u64,
    derivative: Matrix4<f64>,
}

/// What is known of a strobe.
struct Around<'a, S: Coordinates> {
    trajectory: &'a Trajectory<S>,
    centre: Vector4<f64>,
    periods: usize,
    cancel: Option<&'a AtomicBool>,
}

impl<S: Coordinates + Clone> Around<'_, S> {
    /// The image of a point after the periods of the orbit: `None` if it is not in the gap; the end is `None` if a cycle does not
    /// end.
    fn end(&self, at: &Vector4<f64>, tangents: bool) -> Option<Option<End>> {
        let system = &self.trajectory.system;
        let state = system.begin_at(&system.start_at(at)?, Clock::new(self.trajectory.cycle.begin));
        let mut trajectory = self.trajectory.from(&state);
        let (mut impacts, mut derivative) = (0, Matrix4::identity());
        for _ in 0..self.periods {
            let Ok(image) = map(&trajectory, tangents, self.cancel) else { return Some(None) };
            if image.outcome != Outcome::Finished {
                return Some(None);
            }
            derivative = image.tangent.unwrap_or_default() * derivative;
            impacts += image.impacts;
            trajectory.state = image.state;
        }
        Some(Some(End { at: system.coordinates(&trajectory.state), impacts, derivative }))
    }

    fn neighbourhood(&self, attractor: usize) -> Option<Neighbourhood> {
        let orbit = self.end(&self.centre, true)??;
        let factor = norm(&orbit.derivative)?;
        let inverse = factor.try_inverse()?;
        let size = self.trajectory.system.clearance().max(self.centre.amax());
        // V is at least |z − p|²: no point of the ellipsoid is further away than its radius.
        let mut radius = size;
        for _ in 0..MOST_HALVINGS {
            if self.is_kept(radius, (&factor, &inverse), orbit.impacts) {
                let shape = factor / (0.5 * radius);
                let radius = 1.0 / shape.norm();
                return Some(Neighbourhood { attractor, centre: self.centre, shape, radius });
            }
            radius *= 0.5;
        }
        None
    }

    /// True if all points tried come nearer.
    fn is_kept(
        &self,
        radius: f64,
        (factor, inverse): (&Matrix4<f64>, &Matrix4<f64>),
        impacts: u64,
    ) -> bool {
        (0..DIRECTIONS).all(|k| {
            let direction = inverse * direction(k);
            PARTS.iter().all(|part| {
                let off = direction * (radius * part);
                match self.end(&(self.centre + off), false) {
                    // No state is there.
                    None => true,
                    Some(None) => false,
                    Some(Some(end)) => {
                        let [before, after] =
                            [off, end.at - self.centre].map(|z| (factor * z).norm_squared());
                        end.impacts == impacts && after <= before - 0.5 * off.norm_squared()
                    }
                }
            })
        })
    }
}

/// A matrix A with |A z|² = Σ |Mᵏ z|²; `None` if the sum does not end.
fn norm(monodromy: &Matrix4<f64>) -> Option<Matrix4<f64>> {
    let (mut sum, mut power) = (Matrix4::identity(), *monodromy);
    for _ in 0..MOST_DOUBLINGS {
        if power.norm() < f64::EPSILON {
            break;
        }
        sum += power.transpose() * sum * power;
        power *= power;
    }
    let ends = power.norm() < 1.0 && sum.iter().all(|it| it.is_finite());
    ends.then(|| sum.cholesky()).flatten().map(|factors| factors.l().transpose())
}

/// A unit vector: both senses of the axes first, then directions that fill the sphere evenly, by the multiples of powers of a
/// number (M. Roberts, R₄).
fn direction(k: u32) -> Vector4<f64> {
    let mut unit = Vector4::zeros();
    if k < 8 {
        unit[(k / 2) as usize] = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        return unit;
    }
    // The root of g⁵ = g + 1.
    const ROOT: f64 = 1.1673039782614187;
    let mut share = 1.0;
    for place in 0..4 {
        share /= ROOT;
        unit[place] = 2.0 * (f64::from(k) * share).fract() - 1.0;
    }
    unit.normalize()
}
