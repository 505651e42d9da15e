//! Branches of orbits of any system: several members, several modes, and what rubs.
//!
//! The chain of impacts (`orbit/chain.rs`) is one of a single member. Here an orbit is a fixed point of the map over its
//! cycle: the unknowns are the numbers of its state at a section, which lies in a flight and moves on with it, and the
//! derivatives are those of a run. So whatever a run takes has branches. A branch keeps its sequence of impacts, rides, stops
//! and slips. It ends where another sequence begins (`shooting/events.rs`), which is known from this side only: that end is
//! approached by halved steps along the branch, down to rounding, and what happens there is told by the number that has
//! become small (`shooting/sides.rs`). Folds, flips and the like are where a test function changes its sign along the branch.

use nalgebra::{Complex, DMatrix, DVector};

use super::super::chain::Chain;
use super::super::conditions::Condition;
use super::super::continuation::{Curve, Equations, OnCurve, Sides, distance};
use super::super::coordinates::Coordinates;
use super::super::description::describe;
use super::super::family::Scenes;
use super::super::periodic::{Missed, Orbit, Rubbing, flown, reached, state_at, through};
use super::super::{Cycle, Trajectory};
use super::follower::Side;
use super::{Along, Branch, BranchPoint, End, SpecialPoint};
use crate::run::side_by_side::Tier;
pub use curves::curve;
use events::{Sequence, collapsed, nearest, section, slowest};

mod curves;
mod events;
mod origins;
mod sides;

/// The smallest step along a branch, in scales.
const FINEST: f64 = 1e-14;
/// Least cosine of the angle between the tangents at two neighbouring points, and how far a step may lead, in its length.
const STRAIGHT: f64 = 0.95;
const FARTHEST: f64 = 2.0;
/// By how much an orbit may miss itself, over the size of its state and of the derivative.
const CLOSED: f64 = 1e-13;
/// Step of a difference, in scales: the equations need no exact derivative for an exact solution.
const DIFFERENCE: f64 = 1e-6;

/// The orbits of a family of scenes as fixed points of the map. A point has the numbers of the state at the section, then the
/// number that is changed, or the two.
#[derive(Clone)]
struct Shooting<'a, S> {
    scenes: Scenes<'a, S>,
    symmetric: bool,
    cycles: u32,
    /// Where in the cycle the section is, as a share of it.
    share: f64,
    /// How many numbers a state has.
    size: usize,
    scales: DVector<f64>,
    along: Along<'a>,
}

/// A point of a branch, with what a run over its cycle shows.
#[derive(Clone)]
struct Stop {
    on: OnCurve,
    at: BranchPoint,
    sequence: Sequence,
    /// Its walls, as [`Description::walls`](super::super::description::Description::walls) has them.
    walls: String,
    /// By how much the orbit misses itself after its cycle, over the size of its state and of the derivative.
    open: f64,
    /// The smallest of the numbers that vanish where the sequence changes, over its scale, and what happens there.
    next: (f64, Condition),
    /// What vanishes with a multiplier −1, and with a product of two multipliers that is 1.
    tests: [f64; 2],
    /// The next section, as a share of the cycle, if it is to be moved.
    section: Option<f64>,
}

/// The product of λᵢ λⱼ − 1 over all pairs of multipliers.
fn pairs(multipliers: &[Complex<f64>]) -> f64 {
    let all = multipliers.iter().enumerate();
    let product =
        all.flat_map(|(i, one)| multipliers[..i].iter().map(move |other| one * other - 1.0));
    product.product::<Complex<f64>>().re
}

impl<'a, S: Coordinates + Clone> Shooting<'a, S> {
    fn curve(&self) -> Curve<'_> {
        Curve { equations: self, scales: self.scales.clone() }
    }

    /// A family of orbits of a shape (symmetric or not, cycles of the drive) with a section, near a point there.
    fn new(
        scenes: Scenes<'a, S>,
        (symmetric, cycles): (bool, u32),
        (share, near): (f64, &DVector<f64>),
        along: Along<'a>,
    ) -> Option<Self> {
        let [low, high] = along.between;
        let (system, _) = scenes(&[low]).or_else(|_| scenes(&[high])).ok()?;
        let size = near.amax().max(system.clearance());
        let scales = DVector::from_element(near.len(), size).push(high - low);
        Some(Self { scenes, symmetric, cycles, share, size: near.len(), scales, along })
    }

    /// A branch of this family without points.
    fn branch(&self, first: &Stop) -> Branch {
        let Self { symmetric, cycles, .. } = *self;
        let chain = Chain { walls: vec![], sticks: vec![], symmetric, cycles };
        let sequence = Some(first.walls.clone());
        Branch { chain, sequence, points: vec![], special: vec![], ends: [End::Stalled; 2] }
    }

    /// The branch of the orbit near a point at a value of the number, in both directions.
    fn both(self, at: &DVector<f64>, value: f64) -> Option<Branch> {
        let [down, up] = [-1.0, 1.0].map(|towards| self.first(at, value, towards));
        let (down, up) = (down?, up?);
        let branch = self.branch(&up);
        let (Side { mut points, mut special }, before) = self.clone().side(&down, -1.0);
        points.reverse();
        special.reverse();
        points.push(up.at.clone());
        let (after, end) = self.side(&up, 1.0);
        points.extend(after.points);
        special.extend(after.special);
        Some(Branch { points, special, ends: [before, end], ..branch })
    }

    /// The trajectory at a point.
    fn trajectory(&self, point: &DVector<f64>) -> Option<Trajectory<S>> {
        let at = point.rows(0, self.size).into_owned();
        let (system, cycle) = (self.scenes)(&point.as_slice()[self.size..]).ok()?;
        let length = cycle * f64::from(self.cycles);
        let begin = self.share * length;
        let state = state_at(&system, &at, begin)?;
        Some(Trajectory { system, state, cycle: Cycle { begin, length }, tier: Tier::Exact })
    }

    /// The image of a point less itself, the derivative of that by the numbers of the state, and the number of impacts.
    fn sides(&self, point: &DVector<f64>) -> Option<(Sides, u64)> {
        let Trajectory { system, state, cycle, .. } = self.trajectory(point)?;
        let (part, mirror) = if self.symmetric { (0.5, -1.0) } else { (1.0, 1.0) };
        let from = (&state, cycle.begin);
        let ran = flown(&system, from, part * cycle.length, self.along.cancel).ok()?;
        let size = self.size;
        let off = system.point(&ran.end) * mirror - point.rows(0, size);
        let derivative = ran.derivative * mirror - DMatrix::identity(size, size);
        Some(((off, derivative), ran.impacts))
    }

    /// A point of the branch, with what a run over its cycle shows.
    fn stop(&self, on: OnCurve, length: f64) -> Option<Stop> {
        let cancel = self.along.cancel;
        let orbit = through(self.trajectory(&on.point)?, self.symmetric, cancel).ok()?;
        let description = collapsed(describe(&orbit, cancel).ok()?);
        let Trajectory { system, cycle, .. } = &orbit.trajectory;
        let mut rubbing = Rubbing::default();
        reached(&orbit.trajectory, cycle.begin + cycle.length, cancel, &mut rubbing).ok()?;
        let size = on.point.rows(0, self.size).amax().max(system.clearance());
        let slowest = slowest(&description);
        let margin = description.grazing_margin.unwrap_or(f64::INFINITY);
        let own = orbit.half_multipliers.as_ref().unwrap_or(&orbit.multipliers);
        let identity = DMatrix::identity(self.size, self.size);
        let tests = [(&orbit.derivative + identity).determinant(), pairs(own)];
        Some(Stop {
            sequence: Sequence::of(&description, &rubbing, cycle.length),
            walls: description.walls(cycle.length),
            next: nearest(&description, &rubbing, (slowest / size, margin / size), cycle.length),
            open: orbit.residual / (1.0 + orbit.derivative.amax()),
            section: section(&description, &rubbing, *cycle).map(|it| (self.share + it).fract()),
            tests,
            at: BranchPoint {
                value: on.point[self.size],
                length,
                unknowns: self.unknowns(&on.point),
                amplitude: description.amplitude.unwrap_or(f64::NAN),
                margin,
                slowest,
                multipliers: orbit.multipliers,
                half_multipliers: orbit.half_multipliers,
            },
            on,
        })
    }

    /// The section and the numbers of the state there.
    fn unknowns(&self, point: &DVector<f64>) -> Vec<f64> {
        [self.share].into_iter().chain(point.iter().copied().take(self.size)).collect()
    }

    /// The orbit at a value of the number near a state, with the tangent in a direction.
    fn first(&self, at: &DVector<f64>, value: f64, towards: f64) -> Option<Stop> {
        let point = at.push(value);
        let mut normal = DVector::zeros(point.len());
        normal[self.size] = towards;
        self.stop(self.curve().nearby(&point, &normal)?, 0.0)
    }

    /// The next point after a step with the same sequence, within the range.
    fn next(&self, now: &Stop, step: f64, towards: f64) -> Option<Stop> {
        let ([low, high], on) = (self.along.between, self.curve().next(&now.on, step)?);
        if !(low..=high).contains(&on.point[self.size]) {
            return None;
        }
        let apart = distance(&now.on.point, &on.point, &self.scales);
        let near = apart < FARTHEST * step && on.tangent.dot(&now.on.tangent) > STRAIGHT;
        let next = self.stop(on, now.at.length + towards * apart).filter(|_| near)?;
        // Beyond an end Newton's method may stop where its steps are small as the derivative is large.
        (next.sequence == now.sequence && next.open < CLOSED).then_some(next)
    }

    /// A point at another section.
    fn at_section(&self, share: f64, point: &DVector<f64>) -> Option<DVector<f64>> {
        let trajectory = self.trajectory(point)?;
        let Cycle { begin, length } = trajectory.cycle;
        let instant = begin + (share - self.share).rem_euclid(1.0) * length;
        let state = reached(&trajectory, instant, self.along.cancel, &mut ()).ok()?;
        Some(trajectory.system.point(&state).push(point[self.size]))
    }

    /// The same family with another section, and points of a branch there: one, one before it, and that where it began.
    fn moved(
        &self,
        [now, before, home]: [&DVector<f64>; 3],
        share: f64,
        length: f64,
    ) -> Option<(Self, Stop, DVector<f64>)> {
        let later = |point| self.at_section(share, point);
        let (point, before, home) = (later(now)?, later(before)?, later(home)?);
        let towards = (&point - before).component_div(&self.scales);
        let moved = Self { share, ..self.clone() };
        let stop = moved.stop(moved.curve().nearby(&point, &towards)?, length)?;
        Some((moved, stop, home))
    }
}

impl<S: Coordinates + Clone> Equations for Shooting<'_, S> {
    fn at(&self, point: &DVector<f64>) -> Option<Sides> {
        let ((off, derivatives), impacts) = self.sides(point)?;
        let mut all = derivatives.resize_horizontally(point.len(), 0.0);
        for number in self.size..point.len() {
            let by = DIFFERENCE * self.scales[number];
            let moved = |by: f64| {
                let mut moved = point.clone();
                moved[number] += by;
                let ((side, _), others) = self.sides(&moved)?;
                Some((side, moved[number], others == impacts))
            };
            let column = match (moved(by), moved(-by)) {
                // Next to an end of the branch there is another sequence on one side.
                (Some((above, high, alike)), Some((below, low, like))) if alike == like => {
                    (above - below) / (high - low)
                }
                (Some((side, at, true)), _)
                | (_, Some((side, at, _)))
                | (Some((side, at, _)), None) => (side - &off) / (at - point[number]),
                (None, None) => return None,
            };
            all.set_column(number, &column);
        }
        Some((off, all))
    }
}

/// The orbit at a point of a branch, which has the section and the numbers of the state there, where a cycle of the scene has a
/// length.
///
/// # Errors
/// [`Missed`] if there is no such orbit.
pub fn orbit<S: Coordinates + Clone>(
    system: &S,
    (cycle, cycles): (f64, u32),
    (unknowns, symmetric): (&[f64], bool),
    not_before: f64,
) -> Result<Orbit<S>, Missed> {
    let lost = Missed::Stalled(f64::INFINITY);
    let (share, at) = unknowns.split_first().ok_or(lost.clone())?;
    let length = cycle * f64::from(cycles);
    let begin = not_before + (share * length - not_before).rem_euclid(length);
    let state = state_at(system, &DVector::from_column_slice(at), begin).ok_or(lost)?;
    let cycle = Cycle { begin, length };
    through(Trajectory { system: system.clone(), state, cycle, tier: Tier::Exact }, symmetric, None)
}

/// Follows the branch of an orbit that takes some cycles of the drive, over the numbers of a range, in both directions. `None`
/// if the orbit is none of these scenes.
pub fn follow<S: Coordinates + Clone>(
    scenes: Scenes<'_, S>,
    (orbit, cycles): (&Orbit<S>, u32),
    value: f64,
    along: Along<'_>,
) -> Option<Branch> {
    let Trajectory { system, state, cycle, .. } = &orbit.trajectory;
    let at = system.point(state);
    let share = (cycle.begin / cycle.length).fract();
    let shape = (orbit.symmetric, cycles);
    Shooting::new(scenes, shape, (share, &at), along)?.both(&at, value)
}

/// The branch that begins at a special point of another, which has the shape (symmetric or not, cycles of the drive) of its
/// orbits: at a pitchfork that of the asymmetric orbits, at a flip that of the orbits that take twice as long. Where the branch
/// itself begins at the point, it is the branch that it begins on. `None` for other points, and if it was not found.
pub fn switch<S: Coordinates + Clone>(
    scenes: Scenes<'_, S>,
    shape: (bool, u32),
    SpecialPoint { condition, at }: &SpecialPoint,
    along: Along<'_>,
) -> Option<Branch> {
    let (share, numbers) = at.unknowns.split_first()?;
    let numbers = DVector::from_column_slice(numbers);
    let family = Shooting::new(scenes, shape, (*share, &numbers), along)?;
    if let Some(before) = family.begun(at) {
        return before.both(&numbers, at.value);
    }
    let family = family.parted(*condition)?;
    let point = numbers.push(at.value);
    let first = family.ahead(&point)?;
    let none = DVector::zeros(point.len());
    let begin = family.stop(OnCurve { point, tangent: none }, 0.0)?;
    let mut branch = family.branch(&first);
    let (Side { points, special }, end) = family.side(&first, 1.0);
    branch.points = [vec![begin.at, first.at], points].concat();
    Some(Branch { special, ends: [End::Origin, end], ..branch })
}
