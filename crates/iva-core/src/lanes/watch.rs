//! What [`Measures`](crate::measures::Measures) watch in every stretch of motion, without branches.

use super::arrays::arrays;
use super::pick;
use crate::compensated::DoubleDouble;
use crate::measures::{Measures, late};
use crate::peaks::{HalfCycles, Peak};
use crate::real::Real;
use crate::system::System;

arrays! {
    /// The measures of one run, as far as every stretch of motion changes them.
    Watch,
    /// Those of many.
    Watches:
    /// The energy that the primary's damper has taken.
    viscous, viscous_rest,
    /// The half cycle under way; how many have ended.
    peak_time, peak_x, peak_sign, half_cycles,
    /// Largest |x| in the last period and in the last half period, and where each begins.
    amplitude, late_from, later_from, late, later,
    /// The peak that has just been ended, if `peaked`; 1 if peaks are still looked at.
    peaked, ended_time, ended_x, listens,
}

impl Watch {
    pub fn of<S: System<Real = f64>>(measures: &Measures<S>) -> Self {
        let HalfCycles { current, sign, ended } = measures.half_cycles;
        Self {
            viscous: measures.viscous.value,
            viscous_rest: measures.viscous.rest,
            peak_time: current.time,
            peak_x: current.displacement,
            peak_sign: sign,
            half_cycles: ended as f64,
            amplitude: measures.reference.amplitude,
            late_from: late(measures.duration, f64::TURN.value),
            later_from: late(measures.duration, 0.5 * f64::TURN.value),
            listens: pick(measures.listens(measures.half_cycles.ended), 1.0, 0.0),
            late: measures.last_period,
            later: measures.last_half_period,
            ..Self::default()
        }
    }

    pub fn put_back<S: System<Real = f64>>(&self, measures: &mut Measures<S>) {
        measures.viscous = DoubleDouble { value: self.viscous, rest: self.viscous_rest };
        measures.half_cycles = HalfCycles {
            current: Peak { time: self.peak_time, displacement: self.peak_x },
            sign: self.peak_sign,
            ended: self.half_cycles as u64,
        };
        (measures.last_period, measures.last_half_period) = (self.late, self.later);
    }

    /// Of a lane without a run.
    pub fn idle() -> Self {
        Self { late_from: f64::INFINITY, later_from: f64::INFINITY, ..Self::default() }
    }

    /// The peak that a zero crossing has ended, and its index.
    pub fn ended_peak(&self) -> (Peak, u64) {
        let peak = Peak { time: self.ended_time, displacement: self.ended_x };
        (peak, self.half_cycles as u64 - 1)
    }

    /// Takes in what the primary's damper takes in a stretch, if it is `done`.
    #[inline(always)]
    pub fn losing(&self, loss: f64, done: bool) -> Self {
        let viscous = DoubleDouble { value: self.viscous, rest: self.viscous_rest }.plus(loss);
        let mut next = *self;
        next.viscous = pick(done, viscous.value, self.viscous);
        next.viscous_rest = pick(done, viscous.rest, self.viscous_rest);
        next
    }

    /// Takes in a stretch that begins at an instant, if it is `done`.
    #[inline(always)]
    pub fn after(&self, stretch: &Stretch, clock: DoubleDouble, done: bool) -> Self {
        let mut next = self.losing(stretch.loss, done);
        self.half_cycle(&mut next, stretch, clock, done);
        let [x, x_turn, x_end] = stretch.x;
        let largest = x.abs().max(x_turn.abs()).max(x_end.abs());
        let late = done & (clock.minus(self.late_from) >= 0.0);
        let later = done & (clock.minus(self.later_from) >= 0.0);
        next.late = pick(late, self.late.max(largest), self.late);
        next.later = pick(later, self.later.max(largest), self.later);
        next
    }

    /// The half cycle under way, and the peak of one that has ended.
    #[inline(always)]
    fn half_cycle(&self, next: &mut Self, stretch: &Stretch, clock: DoubleDouble, done: bool) {
        let mut time = self.peak_time;
        let mut x = self.peak_x;
        let Ends { at_turn, at_end } = stretch.ends(self.peak_sign);
        let (mut ended_time, mut ended_x) = (time, x);
        let mut reach = |ends: bool, counts: bool, h: f64, there: f64| {
            let instant = clock.plus(h).value;
            ended_time = pick(ends, time, ended_time);
            ended_x = pick(ends, x, ended_x);
            let takes = ends | ((there.abs() > x.abs()) & counts);
            time = pick(takes, instant, time);
            x = pick(takes, there, x);
        };
        let [_, h_turn, h_end] = stretch.h;
        let [_, x_turn, x_end] = stretch.x;
        reach(at_turn, stretch.turns, h_turn, x_turn);
        reach(at_end & !at_turn, true, h_end, x_end);
        let ends = (at_turn | at_end) & done;
        next.peak_time = pick(done, time, self.peak_time);
        next.peak_x = pick(done, x, self.peak_x);
        next.peak_sign = pick(ends, -self.peak_sign, self.peak_sign);
        next.half_cycles = self.half_cycles + pick(ends, 1.0, 0.0);
        next.ended_time = ended_time;
        next.ended_x = ended_x;
        next.peaked = pick(ends, self.listens, 0.0);
    }
}

impl<const W: usize> Watches<W> {
    /// After the measures have taken in the peak of a lane: whether they look at the next.
    pub fn listen<S: System<Real = f64>>(&mut self, i: usize, measures: &Measures<S>) {
        let ended = self.half_cycles[i] as u64;
        (self.peaked[i], self.listens[i]) = (0.0, pick(measures.listens(ended), 1.0, 0.0));
    }
}

/// A stretch of motion, cut where x turns round.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stretch {
    /// x at its begin, where it turns, at its end,
    pub x: [f64; 3],
    /// and when.
    pub h: [f64; 3],
    /// Whether it turns; if not, `x[1]` is `x[0]` and `h[1]` is `h[0]`.
    pub turns: bool,
    /// What the primary's damper takes.
    pub loss: f64,
}

/// Where half cycles end.
pub(super) struct Ends {
    pub at_turn: bool,
    pub at_end: bool,
}

impl Ends {
    /// Two in one stretch are for the event loop.
    #[inline(always)]
    pub fn simple(&self) -> bool {
        !(self.at_turn & self.at_end)
    }
}

impl Stretch {
    /// Of a run whose measures look at none.
    pub const NONE: Self = Self { x: [0.0; 3], h: [0.0; 3], turns: false, loss: 0.0 };

    /// Whether a half cycle with this sign of x ends.
    #[inline(always)]
    pub fn ends(&self, sign: f64) -> Ends {
        let at_turn = self.turns & (self.x[1] * sign < 0.0);
        let sign = pick(at_turn, -sign, sign);
        Ends { at_turn, at_end: self.x[2] * sign < 0.0 }
    }

    /// Whether |x| falls below the level, between which instants, and the level with the sign of x.
    #[inline(always)]
    pub fn passage(&self, level: f64) -> Passage {
        let [x, x_turn, x_end] = self.x;
        let first = self.turns & (x.abs() > level) & (x_turn.abs() <= level);
        let second = (x_turn.abs() > level) & (x_end.abs() <= level);
        let h = [pick(second, self.h[1], 0.0), pick(second, self.h[2], self.h[1])];
        let sign = pick(second, x_turn, x);
        Passage { passes: first | second, h, level: pick(sign > 0.0, level, -level) }
    }
}

/// |x| falls below a level.
pub(super) struct Passage {
    pub passes: bool,
    pub h: [f64; 2],
    pub level: f64,
}
