//! The following of a branch to one side: special points on the way, and its end.

use super::super::super::conditions::{Condition, turns};
use super::super::super::continuation::distance;
use super::super::super::coordinates::Coordinates;
use super::super::follower::Side;
use super::super::{End, SpecialPoint};
use super::{FARTHEST, FINEST, Shooting, Stop};
use crate::run::side_by_side::{is_set, one_more};

/// First step along a branch, in scales, and by how much a step grows.
const FIRST: f64 = 1e-3;
const GROWTH: f64 = 1.5;
/// A step of this length that fails leads beyond the end of the branch.
const BRINK: f64 = 1e-5;
/// Most parts of a stretch in which a special point is sought.
const MOST_PARTS: u32 = 60;
/// What a number is smaller than, over its scale, at the end of a branch that it is the reason of.
const SMALL: f64 = 1e-6;

/// So many steps in a row that do not fail lead away from no end.
const IN_A_ROW: u32 = 8;

/// The last point of a side, the special points on the way to it, and why it is the last.
type Last = (Option<Stop>, Vec<SpecialPoint>, Option<End>);

impl<S: Coordinates + Clone> Shooting<'_, S> {
    /// The point at which a test function changes its sign within a step.
    fn located(
        &self,
        now: &Stop,
        (step, towards): (f64, f64),
        [mut at_low, mut at_high]: [f64; 2],
        of: &dyn Fn(&Stop) -> f64,
    ) -> Option<Stop> {
        let [mut low, mut high] = [0.0, step];
        let mut found = None;
        for part in 0..MOST_PARTS {
            // Every third time the middle: no end stays where it is.
            let share = if part % 3 == 2 { 0.5 } else { at_low / (at_low - at_high) };
            let middle = low + (high - low) * share;
            if !(middle > low && middle < high) || high - low < FINEST {
                break;
            }
            let stop = self.next(now, middle, towards)?;
            let value = of(&stop);
            if (value < 0.0) == (at_low < 0.0) {
                (low, at_low) = (middle, value);
            } else {
                (high, at_high) = (middle, value);
            }
            found = Some(stop);
            if value == 0.0 {
                break;
            }
        }
        found
    }

    /// The special points within a step, in order; `None` if one was not located.
    fn between(&self, now: &Stop, next: &Stop, step: (f64, f64)) -> Option<Vec<SpecialPoint>> {
        let other = if self.symmetric { Condition::Pitchfork } else { Condition::Flip };
        let number = self.size;
        type Test<'t> = (Condition, Box<dyn Fn(&Stop) -> f64 + 't>);
        let all: [Test<'_>; 3] = [
            (Condition::Fold, Box::new(move |it: &Stop| it.on.tangent[number])),
            (other, Box::new(|it: &Stop| it.tests[0])),
            (Condition::NeimarkSacker, Box::new(|it: &Stop| it.tests[1])),
        ];
        let mut found = Vec::new();
        for (condition, of) in all {
            let values = [of(now), of(next)];
            if values[0] * values[1] >= 0.0 {
                continue;
            }
            let at = self.located(now, step, values, &*of)?.at;
            let own = at.half_multipliers.as_ref().unwrap_or(&at.multipliers);
            if condition != Condition::NeimarkSacker || turns(own) {
                found.push(SpecialPoint { condition, at });
            }
        }
        found.sort_by(|a, b| (step.1 * a.at.length).total_cmp(&(step.1 * b.at.length)));
        Some(found)
    }

    /// Follows the branch from a point on: its points and special points to one side, and why it ends.
    pub fn side(mut self, first: &Stop, towards: f64) -> (Side, End) {
        let (mut now, mut home) = (first.clone(), first.on.point.clone());
        let mut side = Side::default();
        let mut step = FIRST.min(self.along.longest);
        while side.points.len() < self.along.most_points {
            if is_set(self.along.cancel) {
                return (side, End::Cancelled);
            }
            if let Some((last, found)) = self.at_bound(&now, step, towards) {
                side.special.extend(found);
                side.points.push(last.at);
                return (side, End::Range);
            }
            let Some((next, found)) = self.whole(&now, step, towards) else {
                step *= 0.5;
                if step > BRINK {
                    continue;
                }
                let (last, found, why) = self.last(&now, step, towards);
                side.special.extend(found);
                side.points.extend(last.iter().map(|it| it.at.clone()));
                match (why, last) {
                    (Some(why), _) => return (side, why),
                    (None, Some(last)) => now = last,
                    (None, None) => {}
                }
                step = BRINK;
                continue;
            };
            for SpecialPoint { condition, at } in found {
                let origin = self.origin(&at).filter(|_| condition == Condition::Fold);
                side.special
                    .push(SpecialPoint { condition: origin.unwrap_or(condition), at: at.clone() });
                if origin.is_some() {
                    side.points.push(at);
                    return (side, End::Origin);
                }
            }
            let before = std::mem::replace(&mut now, next);
            side.points.push(now.at.clone());
            one_more(self.along.done);
            let apart = distance(&now.on.point, &home, &self.scales);
            if side.points.len() > 4 && apart < step {
                return (side, End::Closed);
            }
            let points = [&now.on.point, &before.on.point, &home];
            if let Some(share) = now.section
                && let Some(moved) = self.moved(points, share, now.at.length)
            {
                (self, now, home) = moved;
            }
            step = (step * GROWTH).min(self.along.longest);
        }
        (side, End::Points)
    }

    /// The next point after a step, and the special points on the way to it; `None` if one of these is not found.
    fn whole(&self, now: &Stop, step: f64, towards: f64) -> Option<(Stop, Vec<SpecialPoint>)> {
        let next = self.next(now, step, towards)?;
        let found = self.between(now, &next, (step, towards))?;
        Some((next, found))
    }

    /// The last point before what a step leads beyond, by halving, and why it is the last; no reason where there was nothing but a
    /// step that failed.
    fn last(&self, now: &Stop, step: f64, towards: f64) -> Last {
        let (mut last, mut found, mut step, mut steps) = (None, vec![], step, 0);
        while step > FINEST {
            match self.whole(last.as_ref().unwrap_or(now), step, towards) {
                Some((next, mut more)) => {
                    found.append(&mut more);
                    (last, steps) = (Some(next), steps + 1);
                }
                None => (step, steps) = (0.5 * step, 0),
            }
            if steps > IN_A_ROW {
                return (last, found, None);
            }
        }
        if is_set(self.along.cancel) {
            return (last, found, Some(End::Cancelled));
        }
        let end = last.as_ref().unwrap_or(now);
        let (small, mut condition) = end.next;
        if small > SMALL {
            let beyond = self.curve().next(&now.on, BRINK).and_then(|on| self.stop(on, 0.0));
            let rubs = beyond.is_some_and(|it| it.sequence.rubs_otherwise(&now.sequence));
            if !rubs {
                return (last, found, Some(End::Stalled));
            }
            condition = Condition::SlideChanges;
        }
        found.push(SpecialPoint { condition, at: end.at.clone() });
        (last, found, Some(End::at(condition)))
    }

    /// The point at the end of the range and the special points on the way, if a step leads beyond.
    fn at_bound(&self, now: &Stop, step: f64, towards: f64) -> Option<(Stop, Vec<SpecialPoint>)> {
        let ([low, high], number) = (self.along.between, self.size);
        let value = |step: f64| now.at.value + step * now.on.tangent[number] * self.scales[number];
        let bound = value(step).clamp(low, high);
        if bound == value(step) {
            return None;
        }
        let on = self.curve().where_unknown_is(&now.on, number, bound)?;
        let apart = distance(&now.on.point, &on.point, &self.scales);
        let last = self.stop(on, now.at.length + towards * apart)?;
        let near = apart < FARTHEST * step && last.sequence == now.sequence;
        let found = self.between(now, &last, (apart, towards)).filter(|_| near)?;
        Some((last, found))
    }
}
