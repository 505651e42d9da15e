//! Curves of special points over two numbers of a scene.
//!
//! A curve consists of the points where the equations of an orbit and one condition (`orbit/conditions.rs`) hold together. It
//! is followed in both directions by the continuation that follows branches, and ends where a number leaves its range or
//! where another impact would begin or vanish.

use std::sync::atomic::{AtomicBool, AtomicU64};

use nalgebra::{Complex, DVector};

use super::branch::{End, SpecialPoint, multipliers_of, scales};
use super::chain::Chain;
use super::conditions::{Condition, Kind, Tests, turns};
use super::continuation::{Curve, Equations, OnCurve, distance, kernel};
use super::coordinates::Coordinates;
use super::family::{Conditioned, Family, Scenes};
use super::multipliers::of_four;
use crate::run::side_by_side::{is_set, one_more};

/// First and smallest step along a curve, in scales, and by how much a step grows.
const FIRST: f64 = 1e-3;
const SHORTEST: f64 = 1e-6;
const GROWTH: f64 = 1.5;
/// Least cosine of the angle between the tangents at two neighbouring points, and how far a step may lead, in its length.
const STRAIGHT: f64 = 0.95;
const FARTHEST: f64 = 2.0;

/// How a curve is followed.
#[derive(Debug, Clone, Copy)]
pub struct AlongCurve<'a> {
    /// The ranges of the two numbers.
    pub between: [[f64; 2]; 2],
    /// Values of the first number at which a point is wanted wherever the curve comes by.
    pub at: &'a [f64],
    /// Most points in each direction.
    pub most_points: usize,
    /// Longest step, as a share of the ranges and of the sizes of the unknowns.
    pub longest: f64,
    /// A flag that ends it.
    pub cancel: Option<&'a AtomicBool>,
    /// Counts the points that are found.
    pub done: Option<&'a AtomicU64>,
}

/// A point of a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvePoint {
    /// The two numbers.
    pub values: [f64; 2],
    /// The unknowns of the orbit, as [`BranchPoint`](super::branch::BranchPoint) has them.
    pub unknowns: Vec<f64>,
    /// The multipliers of the orbit, largest first.
    pub multipliers: Vec<Complex<f64>>,
}

/// A curve of special points.
#[derive(Debug, Clone, PartialEq)]
pub struct SpecialCurve {
    /// The condition that holds on it.
    pub condition: Condition,
    /// Its points in order.
    pub points: Vec<CurvePoint>,
    /// Why it ends on either side.
    pub ends: [End; 2],
    /// The wanted values that it does not come by, or where Newton's method finds no point of it.
    pub missed: Vec<f64>,
}

/// The points to one side of a point.
struct Side {
    points: Vec<CurvePoint>,
    end: End,
    /// The wanted values at which no point was found though the curve comes by.
    unsolved: Vec<f64>,
}

/// The equations of an orbit and a condition; a point has the unknowns of the orbit, then the two numbers.
pub(super) trait Special: Equations {
    /// The sizes by which the unknowns and the numbers change.
    fn scales(&self) -> &DVector<f64>;
    /// The multipliers of the orbit at a point.
    fn multipliers(&self, at: &DVector<f64>) -> Option<Vec<Complex<f64>>>;
    /// The unknowns of a point as they are told.
    fn unknowns(&self, at: &DVector<f64>) -> Vec<f64> {
        at.as_slice()[..at.len() - 2].to_vec()
    }
    /// Why the curve ends before a point: the pair of multipliers is real there, or the orbit is not one that a run makes, but for
    /// the condition of the curve.
    fn broken(&self, at: &DVector<f64>) -> Option<End>;
}

impl<S: Coordinates> Special for Conditioned<'_, S> {
    fn scales(&self) -> &DVector<f64> {
        &self.family.scales
    }

    fn multipliers(&self, at: &DVector<f64>) -> Option<Vec<Complex<f64>>> {
        let (_, passed, _) = self.family.passed(at, false)?;
        Some(multipliers_of(&passed.map, self.family.chain.symmetric).0)
    }

    fn broken(&self, at: &DVector<f64>) -> Option<End> {
        let (system, passed, cycle) = self.family.passed(at, false)?;
        if self.condition == Condition::NeimarkSacker && !turns(&of_four(&passed.map)) {
            return Some(End::Resonance);
        }
        let broken = Tests::new(&system, &passed, cycle).broken();
        let broken = broken.into_iter().find(|broken| *broken != self.condition)?;
        Some(End::at(broken))
    }
}

/// The following of a curve to one side.
struct Follower<'a, 'b, C> {
    special: &'a C,
    along: AlongCurve<'b>,
}

impl<C: Special> Follower<'_, '_, C> {
    fn curve(&self) -> Curve<'_> {
        Curve { equations: self.special, scales: self.special.scales().clone() }
    }

    /// The index of the first number.
    fn number(&self) -> usize {
        self.special.scales().len() - 2
    }

    fn point(&self, at: &DVector<f64>) -> Option<CurvePoint> {
        let values = [at[self.number()], at[self.number() + 1]];
        let multipliers = self.special.multipliers(at)?;
        Some(CurvePoint { values, unknowns: self.special.unknowns(at), multipliers })
    }

    /// True if both numbers are in their ranges.
    fn is_within(&self, point: &CurvePoint) -> bool {
        let mut pairs = self.along.between.iter().zip(point.values);
        pairs.all(|([low, high], value)| (*low..=*high).contains(&value))
    }

    /// The points to one side of a point.
    fn side(&self, first: &OnCurve) -> Side {
        let (mut points, mut unsolved) = (vec![], vec![]);
        let end = self.follow(first, &mut points, &mut unsolved);
        Side { points, end, unsolved }
    }

    /// Adds the points to one side of a point, and the wanted values at which none was found; why the curve ends.
    fn follow(
        &self,
        first: &OnCurve,
        points: &mut Vec<CurvePoint>,
        unsolved: &mut Vec<f64>,
    ) -> End {
        let (curve, scales, count) = (self.curve(), self.special.scales(), self.number());
        let mut now = first.clone();
        let mut step = FIRST.min(self.along.longest);
        while points.len() < self.along.most_points {
            if is_set(self.along.cancel) {
                return End::Cancelled;
            }
            let next = curve.next(&now, step).filter(|next| {
                next.tangent.dot(&now.tangent) > STRAIGHT
                    && distance(&next.point, &now.point, scales) < FARTHEST * step
            });
            let Some(next) = next else {
                step *= 0.5;
                if step < SHORTEST {
                    return End::Stalled;
                }
                continue;
            };
            if let Some(end) = self.special.broken(&next.point) {
                if step > SHORTEST {
                    step *= 0.5;
                    continue;
                }
                return end;
            }
            let (from, to) = (now.point[count], next.point[count]);
            let mut wanted: Vec<f64> = self
                .along
                .at
                .iter()
                .copied()
                .filter(|at| (from - at) * (at - to) >= 0.0 && *at != from)
                .collect();
            wanted.sort_by(|a, b| ((a - from).abs()).total_cmp(&(b - from).abs()));
            wanted.dedup();
            for at in wanted {
                let there = curve.where_unknown_is(&now, count, at);
                match there.and_then(|there| self.point(&there.point)) {
                    Some(point) if self.is_within(&point) => points.push(point),
                    Some(_) => {}
                    None => unsolved.push(at),
                }
            }
            let outside = (0..2).find(|k| {
                let [low, high] = self.along.between[*k];
                !(low..=high).contains(&next.point[count + k])
            });
            if let Some(k) = outside {
                let [low, high] = self.along.between[k];
                let bound = next.point[count + k].clamp(low, high);
                let last = curve.where_unknown_is(&now, count + k, bound);
                points.extend(last.and_then(|last| self.point(&last.point)));
                return End::Range;
            }
            points.extend(self.point(&next.point));
            if points.len() > 4 && distance(&next.point, &first.point, scales) < step {
                return End::Closed;
            }
            one_more(self.along.done);
            now = next;
            step = (step * GROWTH).min(self.along.longest);
        }
        End::Points
    }
}

/// Follows the curve of a special point over two numbers, of which it has these values; its chain is that of the branch that
/// it is on. `None` if the special point is not one of these scenes, or one at which a stick begins: there no equation is
/// smooth.
pub fn curve<S: Coordinates>(
    scenes: Scenes<'_, S>,
    chain: &Chain,
    special: &SpecialPoint,
    values: [f64; 2],
    along: AlongCurve<'_>,
) -> Option<SpecialCurve> {
    let condition = special.condition;
    if !chain.tells() || condition.kind() == Kind::StickBegins {
        return None;
    }
    let ranges = along.between.map(|[low, high]| high - low);
    let scales = scales(chain, &special.at.unknowns, &ranges);
    let family = Family { scenes, chain: chain.clone(), scales };
    let point = special.at.unknowns.iter().copied().chain(values);
    let point = DVector::from_iterator(chain.unknowns() + 2, point);
    through(&Conditioned { family: &family, condition }, condition, &point, along)
}

/// The curve through a point, in both directions.
pub(super) fn through<C: Special>(
    special: &C,
    condition: Condition,
    point: &DVector<f64>,
    along: AlongCurve<'_>,
) -> Option<SpecialCurve> {
    let follower = Follower { special, along };
    let (_, derivatives) = special.at(point)?;
    let mut tangent = kernel(&derivatives, special.scales())?;
    if tangent[follower.number()] < 0.0 {
        tangent.neg_mut();
    }
    let first = follower.curve().nearby(point, &tangent)?;
    let back = OnCurve { tangent: -&first.tangent, ..first.clone() };
    let (before, after) = (follower.side(&back), follower.side(&first));
    let mut points = before.points;
    points.reverse();
    points.extend(follower.point(&first.point));
    points.extend(after.points);
    let unsolved = [before.unsolved, after.unsolved].concat();
    let missed = |at: &&f64| unsolved.contains(at) || points.iter().all(|it| it.values[0] != **at);
    let missed = along.at.iter().filter(missed).copied().collect();
    Some(SpecialCurve { condition, points, ends: [before.end, after.end], missed })
}
