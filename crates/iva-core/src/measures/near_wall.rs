//! The time that the absorber spends close to a wall, stuck on it or not.

use super::pass::Pass;
use crate::number::real::Real;
use crate::segment::flight::Travel;
use crate::segment::polynomial::{jet, turned, turnings};

/// The distance that is close, over the clearance.
const CLOSE: f64 = 0.01;

/// The time during which the distance to a wall is at most a hundredth of the clearance, in 1/ωn.
#[derive(Debug, Clone, Default)]
pub struct NearWall<R = f64> {
    /// The values of y that are close to wall − below the first, and to wall + above the second.
    levels: [R; 2],
    time: R,
}

impl<R: Real> Pass<R> for NearWall<R> {
    fn begin(&mut self, [low, high]: [R; 2]) {
        let close = (high - low) * (0.5 * CLOSE);
        *self = Self { levels: [low + close, high - close], time: R::ZERO };
    }

    fn stretch(&mut self, travel: &Travel<R>, h: [R; 2]) {
        let Travel { rows, gap, .. } = travel;
        let gap = &gap[..=rows.order];
        let [from, to] = h.map(|h| h / rows.step);
        // Between two extrema y rises or falls.
        let extrema =
            turnings(gap, to).into_iter().map(|bracket| turned(|t| jet(gap, t), bracket).0);
        let mut begin = from;
        for end in extrema.filter(|t| *t > from && *t < to).chain([to]) {
            self.time += self.close_by(gap, [begin, end]) * rows.step;
            begin = end;
        }
    }

    fn value(&self) -> R {
        self.time
    }
}

impl<R: Real> NearWall<R> {
    /// The time close to a wall in a stretch in which y does not turn.
    fn close_by(&self, gap: &[R], [begin, end]: [R; 2]) -> R {
        let [low, high] = self.levels;
        let y = [begin, end].map(|t| jet(gap, t)[0]);
        // The instant at which y passes a level; `None` if both ends lie on the same side of it.
        let passage = |level: R| {
            let beyond = y.map(|y| y > level);
            if beyond[0] == beyond[1] {
                return None;
            }
            let at = |t: R| {
                let [value, rate, second, _] = jet(gap, t);
                [R::ZERO, value - level, rate, second]
            };
            Some(turned(at, [begin, end]).0)
        };
        let above = match passage(high) {
            Some(t) if y[1] > high => end - t,
            Some(t) => t - begin,
            None if y[0] > high => end - begin,
            None => R::ZERO,
        };
        let below = match passage(low) {
            Some(t) if y[1] > low => t - begin,
            Some(t) => end - t,
            None if y[0] > low => R::ZERO,
            None => end - begin,
        };
        above + below
    }
}
