//! The following of a branch to one side.

use nalgebra::DVector;

use super::super::conditions::{Condition, Kind, Tests, turns};
use super::super::continuation::{Curve, OnCurve, distance, solved};
use super::super::coordinates::Coordinates;
use super::super::family::Family;
use super::super::margins::amplitude;
use super::brink::BRINK;
use super::halves::{difference, origin};
use super::{Along, BranchPoint, End, SpecialPoint, multipliers_of};
use crate::absorber::Wall;
use crate::run::side_by_side::{is_set, one_more};

/// Smallest and first step along a branch, in scales, and by how much a step grows.
const SHORTEST: f64 = 1e-7;
const FIRST: f64 = 1e-3;
const GROWTH: f64 = 1.5;
/// Least cosine of the angle between the tangents at two neighbouring points.
const STRAIGHT: f64 = 0.95;
/// A step may lead so far, in its length.
const FARTHEST: f64 = 2.0;
/// Most halvings of a stretch of a branch in which a special point is sought.
const MOST_HALVINGS: u32 = 40;

/// A point of the curve, with its numbers.
#[derive(Clone)]
pub(super) struct Stop {
    pub on: OnCurve,
    pub tests: Tests,
    pub at: BranchPoint,
}

/// The end of a side: its last point, if it was found, the reason, and what happens there.
struct Ending {
    last: Option<Stop>,
    why: End,
    special: Option<SpecialPoint>,
}

/// One side of a branch, from its first point on.
#[derive(Default)]
pub(super) struct Side {
    pub points: Vec<BranchPoint>,
    pub special: Vec<SpecialPoint>,
}

/// The following of a branch.
pub(super) struct Follower<'a, S> {
    pub family: &'a Family<'a, S>,
    pub along: Along<'a>,
    /// 1 towards larger lengths, −1 towards smaller ones.
    pub towards: f64,
}

impl<S: Coordinates> Follower<'_, S> {
    fn curve(&self) -> Curve<'_> {
        Curve { equations: self.family, scales: self.family.scales.clone() }
    }

    /// The index of the number that is changed.
    fn number(&self) -> usize {
        self.family.chain.unknowns()
    }

    fn apart(&self, a: &Stop, b: &DVector<f64>) -> f64 {
        distance(&a.on.point, b, &self.family.scales)
    }

    /// A point of the curve with its numbers.
    pub fn stop(&self, on: OnCurve, length: f64) -> Option<Stop> {
        let (system, passed, cycle) = self.family.passed(&on.point, false)?;
        let tests = Tests::new(&system, &passed, cycle);
        let (all, half) = multipliers_of(&passed.map, self.family.chain.symmetric);
        let at = BranchPoint {
            value: on.point[self.number()],
            length,
            unknowns: on.point.as_slice()[..self.number()].to_vec(),
            multipliers: all,
            half_multipliers: half,
            amplitude: amplitude(&system, &passed, cycle),
            margin: tests.margin(),
            slowest: tests.slowest(),
        };
        Some(Stop { on, tests, at })
    }

    /// A point further along the curve than another one.
    fn beyond(&self, from: &Stop, on: OnCurve) -> Option<Stop> {
        let length = from.at.length + self.towards * self.apart(from, &on.point);
        self.stop(on, length)
    }

    /// The orbit at a value of the number near these unknowns, with the tangent in the direction that is followed.
    pub fn first(&self, unknowns: &[f64], value: f64) -> Option<Stop> {
        let mut point = DVector::from_element(self.number() + 1, value);
        point.rows_mut(0, unknowns.len()).copy_from_slice(unknowns);
        let mut normal = DVector::zeros(point.len());
        normal[self.number()] = self.towards;
        self.stop(self.curve().nearby(&point, &normal)?, 0.0)
    }

    /// The point where a condition is met on the stretch of the curve between two points.
    fn located(&self, condition: Condition, [from, to]: [&Stop; 2]) -> Option<Stop> {
        let value = |stop: &Stop| self.family.condition(&stop.on.point, condition);
        let equations = |at: &DVector<f64>| self.family.with_condition(at, condition);
        let (mut from, mut to) = (from.clone(), to.clone());
        for _ in 0..MOST_HALVINGS {
            let (a, b) = (value(&from)?, value(&to).unwrap_or(f64::NAN));
            let share = if a * b < 0.0 { a / (a - b) } else { 0.5 };
            let guess = &from.on.point + (&to.on.point - &from.on.point) * share;
            let length = self.apart(&from, &to.on.point);
            if let Some(point) = solved(&guess, &self.family.scales, &equations) {
                // Within the stretch, or off by rounding.
                if distance(&point, &guess, &self.family.scales) <= length.max(SHORTEST) {
                    return self.beyond(&from, OnCurve { point, ..from.on.clone() });
                }
            }
            // Closer to the sign change.
            let middle = self.beyond(&from, self.curve().next(&from.on, 0.5 * length)?)?;
            if (value(&middle)? < 0.0) == (a < 0.0) { from = middle } else { to = middle }
        }
        None
    }

    /// The special point at a condition; `None` if it is none.
    fn special(&self, condition: Condition, at: BranchPoint) -> Option<SpecialPoint> {
        let kind = condition.kind();
        // Two real multipliers whose product is 1 are no special point.
        let own = at.half_multipliers.as_ref().unwrap_or(&at.multipliers);
        let is_one = kind != Kind::NeimarkSacker || turns(own);
        let [low, high] = self.along.between;
        (is_one && (low..=high).contains(&at.value)).then_some(SpecialPoint { condition, at })
    }

    /// The point of the tangent after a step.
    pub fn ahead(&self, now: &Stop, step: f64) -> DVector<f64> {
        &now.on.point + (&now.on.tangent * step).component_mul(&self.family.scales)
    }

    /// The point at the end of the range of the number, if the step leads beyond: there may be no scene.
    fn at_bound(&self, now: &Stop, step: f64) -> Option<OnCurve> {
        let ([low, high], number) = (self.along.between, self.number());
        let value = self.ahead(now, step)[number];
        let bound = value.clamp(low, high);
        (bound != value).then(|| self.curve().where_unknown_is(&now.on, number, bound))?
    }

    /// The next point after a step.
    ///
    /// # Errors
    /// The condition by which a stick episode is another one there, or none, if it is that.
    pub fn next(&self, now: &Stop, step: f64) -> Result<Stop, Option<Condition>> {
        let lost =
            || self.family.lapse(&self.ahead(now, step)).and_then(|lapse| now.tests.lost(&lapse));
        let on = self.curve().next(&now.on, step).or_else(|| self.at_bound(now, step));
        let on = on.ok_or_else(lost)?;
        let next = self.beyond(now, on).ok_or(None)?;
        let straight = next.on.tangent.dot(&now.on.tangent) > STRAIGHT;
        if let Some(changed) = now.tests.changed(&next.tests) {
            return Err(Some(changed));
        }
        let near = straight && self.apart(now, &next.on.point) < FARTHEST * step;
        if near { Ok(next) } else { Err(None) }
    }

    /// The end of the branch at a condition, where it was located.
    fn ends(&self, why: End, condition: Condition, last: Option<Stop>) -> Ending {
        let special = last.as_ref().and_then(|last| self.special(condition, last.at.clone()));
        Ending { last, why, special }
    }

    /// The conditions by which a point is not admissible that comes after an admissible one. Beyond an impact that vanishes the
    /// flights before and after it pass the wall: these extrema are its own.
    fn broken(&self, [now, next]: [&Stop; 2]) -> Vec<Condition> {
        let (chain, all) = (&self.family.chain, next.tests.broken());
        let count = chain.walls.len();
        let own = |flight: usize, wall: Wall| {
            all.iter().any(|other| match *other {
                Condition::ImpactVanishes { impact } => {
                    let before = (impact - 1, chain.wall(impact));
                    let after = (impact % count, chain.wall(impact % count));
                    [before, after].contains(&(flight, wall))
                }
                _ => false,
            })
        };
        let counts = |condition: &Condition| match *condition {
            Condition::Grazing { flight, wall } => {
                now.tests.turns_back(flight, wall) || !own(flight, wall)
            }
            _ => true,
        };
        all.iter().copied().filter(counts).collect()
    }

    /// The end of the branch between two points, if it ends there.
    fn ending(&self, [now, next]: [&Stop; 2]) -> Option<Ending> {
        let halves = [now, next].map(|stop| difference(self.family, &stop.on.point));
        if let [Some(a), Some(b)] = halves
            && a * b < 0.0
            && let Some((condition, point)) =
                origin(self.family, [&now.on.point, &next.on.point], a / (a - b))
        {
            let last = self.beyond(now, OnCurve { point, ..now.on.clone() });
            return Some(self.ends(End::Origin, condition, last));
        }
        let broken = self.broken([now, next]);
        if let Some(first) = broken.first().copied() {
            let located = |condition| Some((condition, self.located(condition, [now, next])?));
            // One that is not located might be the first.
            let found: Option<Vec<_>> = broken.into_iter().map(located).collect();
            let along = |stop: &Stop| self.towards * stop.at.length;
            let nearest = found.and_then(|all| {
                all.into_iter().min_by(|(_, a), (_, b)| along(a).total_cmp(&along(b)))
            });
            let (condition, last) = nearest.map_or((first, None), |(it, last)| (it, Some(last)));
            return Some(self.ends(End::at(condition), condition, last));
        }
        let [low, high] = self.along.between;
        let bound = next.at.value.clamp(low, high);
        (bound == low || bound == high).then(|| {
            let on = self.curve().where_unknown_is(&next.on, self.number(), bound);
            let last = on.and_then(|on| self.beyond(now, on));
            Ending { last, why: End::Range, special: None }
        })
    }

    /// The special points between two points and up to a length, in order; `None` if one is there and was not located.
    fn between(&self, [now, next]: [&Stop; 2], limit: f64) -> Option<Vec<SpecialPoint>> {
        let mut found = Vec::new();
        for condition in now.tests.met(&next.tests, self.family.chain.symmetric) {
            let at = self.located(condition, [now, next])?.at;
            let before = (limit - at.length) * self.towards >= 0.0;
            found.extend(self.special(condition, at).filter(|_| before));
        }
        let along = |point: &SpecialPoint| self.towards * point.at.length;
        found.sort_by(|a, b| along(a).total_cmp(&along(b)));
        Some(found)
    }

    /// Follows the branch from a point on.
    pub fn side(&self, first: &Stop) -> (Side, End) {
        let (mut now, mut side) = (first.clone(), Side::default());
        let mut step = FIRST.min(self.along.longest);
        while side.points.len() < self.along.most_points {
            if is_set(self.along.cancel) {
                return (side, End::Cancelled);
            }
            let (next, brink) = match self.next(&now, step) {
                Ok(next) => (Some(next), None),
                Err(Some(_)) if step < BRINK => self.brink(&now, step).unzip(),
                Err(_) => (None, None),
            };
            let ending = next.as_ref().and_then(|next| {
                let at_brink = brink.map(|special| Ending {
                    last: Some(next.clone()),
                    why: End::at(special.condition),
                    special: self.special(special.condition, special.at),
                });
                self.ending([&now, next]).or(at_brink)
            });
            let last = ending.as_ref().and_then(|ending| ending.last.as_ref());
            let lost = ending.is_some() && last.is_none();
            let special = next
                .as_ref()
                .filter(|_| !lost)
                .and_then(|next| self.between([&now, next], last.unwrap_or(next).at.length));
            // What is not located on a stretch may be on a shorter one; it is never passed over.
            let (Some(next), Some(mut special)) = (next, special) else {
                step *= 0.5;
                if step < SHORTEST {
                    return (side, End::Stalled);
                }
                continue;
            };
            side.special.append(&mut special);
            if let Some(Ending { last: Some(last), why, special }) = ending {
                side.special.extend(special);
                side.points.push(last.at);
                return (side, why);
            }
            side.points.push(next.at.clone());
            let turned = next.on.tangent.dot(&first.on.tangent);
            if side.points.len() > 4
                && self.apart(&next, &first.on.point) < step
                && turned > STRAIGHT
            {
                return (side, End::Closed);
            }
            one_more(self.along.done);
            now = next;
            step = (step * GROWTH).min(self.along.longest);
        }
        (side, End::Points)
    }
}
