//! Branches of periodic orbits: how an orbit changes with a number of its scene, and the special points on the way.
//!
//! A branch keeps its sequence of impacts (`orbit/chain.rs`). It is followed in both directions by pseudo-arclength
//! continuation (`orbit/continuation.rs`), so that it may turn back, and ends where the number leaves its range, where the
//! absorber would touch a wall between two impacts (grazing), where the speed of an impact goes to 0, or where a
//! stick does not begin any more. Of conditions
//! that change their sign between two points, the point is located by Newton's method on the equations of the orbit and
//! the condition together, whose matrix stays regular there. What ends within a stick episode (`orbit/episode.rs`) is known from one
//! side only: that end is the last orbit before a point beyond which, by steps down to rounding, there is none.
//!
//! Systems of several members or modes, and what rubs, have no such chain: their branches are those of [`shooting`].

use std::sync::atomic::{AtomicBool, AtomicU64};

use nalgebra::{Complex, DVector, Matrix4};

use super::chain::Chain;
use super::conditions::Condition;
use super::coordinates::Coordinates;
use super::family::{Family, Scenes};
use super::multipliers::{largest_first, of_four};
use follower::{Follower, Side};

mod brink;
mod follower;
mod halves;
pub mod shooting;
mod switch;

pub use switch::switch;

/// How a branch is followed.
#[derive(Debug, Clone, Copy)]
pub struct Along<'a> {
    /// The range of the number.
    pub between: [f64; 2],
    /// Most points in each direction.
    pub most_points: usize,
    /// Longest step, as a share of the range and of the sizes of the unknowns.
    pub longest: f64,
    /// A flag that ends it.
    pub cancel: Option<&'a AtomicBool>,
    /// Counts the points that are found.
    pub done: Option<&'a AtomicU64>,
}

impl Along<'_> {
    /// Within a range, with the usual steps.
    pub fn new(between: [f64; 2]) -> Self {
        Self { between, most_points: 2000, longest: 0.02, cancel: None, done: None }
    }
}

/// A point of a branch.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchPoint {
    /// The number that is changed.
    pub value: f64,
    /// Length of the branch up to here, in scales; the first orbit is at 0, points on one side of it below.
    pub length: f64,
    /// The instant of an impact, in 1/ωn, and x, ẋ and ẏ (or W) after it; the instants of the other impacts of the chain. Of a branch without a
    /// chain a section, as a share of the cycle, and the numbers of the state there.
    pub unknowns: Vec<f64>,
    /// The multipliers, largest first.
    pub multipliers: Vec<Complex<f64>>,
    /// Those of the half map of a symmetric orbit.
    pub half_multipliers: Option<Vec<Complex<f64>>>,
    /// Largest |x|.
    pub amplitude: f64,
    /// The smallest distance of an extremum of the gap displacement between two impacts from the wall that the absorber turns
    /// back from; infinite without one.
    pub margin: f64,
    /// The smallest approach speed, those within stick episodes after their first impact apart.
    pub slowest: f64,
}

impl BranchPoint {
    /// True if all multipliers are smaller than 1.
    pub fn is_stable(&self) -> bool {
        self.multipliers.iter().all(|multiplier| multiplier.norm() < 1.0)
    }
}

/// A special point of a branch.
#[derive(Debug, Clone, PartialEq)]
pub struct SpecialPoint {
    /// What happens there.
    pub condition: Condition,
    /// The orbit.
    pub at: BranchPoint,
}

/// Why a branch ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The number is at the end of its range.
    Range,
    /// A grazing.
    Grazing,
    /// The speed of an impact goes to 0.
    ImpactVanishes,
    /// The time that the absorber sticks goes to 0.
    StickBegins,
    /// Two absorbers strike at one instant.
    ImpactsCoincide,
    /// A slide begins or ends to be.
    SlideChanges,
    /// A pitchfork or flip at which the branch begins: beyond it are the mirror images of its orbits, or the same orbits.
    Origin,
    /// Of a curve of Neimark–Sacker points: the pair of multipliers becomes real, 1 twice or −1 twice.
    Resonance,
    /// The branch comes back to its begin.
    Closed,
    /// No next point was found.
    Stalled,
    /// The largest number of points.
    Points,
    /// It was cancelled.
    Cancelled,
}

impl End {
    /// That at a condition at which the orbit is no longer one that a run makes.
    pub(super) fn at(condition: Condition) -> Self {
        match condition {
            Condition::Grazing { .. } => End::Grazing,
            Condition::StickBegins { .. } => End::StickBegins,
            Condition::ImpactsCoincide => End::ImpactsCoincide,
            Condition::SlideChanges => End::SlideChanges,
            _ => End::ImpactVanishes,
        }
    }

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            End::Range => "range",
            End::Grazing => "grazing",
            End::ImpactVanishes => "impact_vanishes",
            End::StickBegins => "stick_begins",
            End::ImpactsCoincide => "impacts_coincide",
            End::SlideChanges => "slide_changes",
            End::Origin => "origin",
            End::Resonance => "resonance",
            End::Closed => "closed",
            End::Stalled => "stalled",
            End::Points => "points",
            End::Cancelled => "cancelled",
        }
    }
}

/// A branch of periodic orbits with one sequence of impacts.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// The sequence of impacts; without impacts where that of a single member does not tell the orbit ([`shooting`]).
    pub chain: Chain,
    /// The walls of such a branch, as [`Description::walls`](super::description::Description::walls) has them.
    pub sequence: Option<String>,
    /// Its points in order.
    pub points: Vec<BranchPoint>,
    /// The special points, in the same order.
    pub special: Vec<SpecialPoint>,
    /// Why it ends on either side.
    pub ends: [End; 2],
}

/// The multipliers of a chain from the derivative of its map, and those of the half map of a symmetric orbit.
pub(super) fn multipliers_of(
    map: &Matrix4<f64>,
    symmetric: bool,
) -> (Vec<Complex<f64>>, Option<Vec<Complex<f64>>>) {
    let own = of_four(map);
    if symmetric {
        (largest_first(own.map(|it| it * it)).to_vec(), Some(own.to_vec()))
    } else {
        (own.to_vec(), None)
    }
}

/// The sizes by which the unknowns of a chain and a number change.
pub(super) fn scales(chain: &Chain, unknowns: &[f64], ranges: &[f64]) -> DVector<f64> {
    let size = unknowns[1..4].iter().fold(0.0, |size: f64, it| size.max(it.abs()));
    let mut scales = DVector::from_element(chain.unknowns() + ranges.len(), 1.0);
    scales.rows_mut(1, 3).fill(size);
    for (k, range) in ranges.iter().enumerate() {
        scales[chain.unknowns() + k] = *range;
    }
    scales
}

/// Follows the branch of an orbit, which is given by its chain and the unknowns of that, over the numbers of a range, in
/// both directions. `None` if there is no such orbit.
pub fn follow<S: Coordinates>(
    scenes: Scenes<'_, S>,
    (chain, unknowns): (&Chain, &[f64]),
    value: f64,
    along: Along<'_>,
) -> Option<Branch> {
    let [low, high] = along.between;
    let scales = scales(chain, unknowns, &[high - low]);
    let family = Family { scenes, chain: chain.clone(), scales };
    let [down, up] = [-1.0, 1.0].map(|towards| Follower { family: &family, along, towards });
    let first = up.first(unknowns, value)?;
    if !first.tests.admissible() {
        return None;
    }
    let (Side { mut points, mut special }, before) = down.side(&down.first(unknowns, value)?);
    let (after, end) = up.side(&first);
    points.reverse();
    special.reverse();
    points.push(first.at);
    points.extend(after.points);
    special.extend(after.special);
    Some(Branch { chain: chain.clone(), sequence: None, points, special, ends: [before, end] })
}
