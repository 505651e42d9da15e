//! The variables of [`Measures`](crate::measures::Measures) that change in every stretch of motion, without
//! branches.

use crate::arrays::arrays;
use crate::compensated::DoubleDouble;
use crate::measures::{Measures, late};
use crate::peaks::{HalfCycles, Peak};
use crate::real::{Real, pick};
use crate::system::System;

arrays! {
    /// The measures of one run, as far as every stretch of motion changes them.
    Watch, Watches:
    /// The energy lost in the primary's damper, in double-double.
    viscous, viscous_rest,
    /// The current half cycle: time and displacement of its largest |x|, and the sign of x; the number of
    /// completed ones.
    peak_time, peak_x, peak_sign, half_cycles,
    /// A₀; the instants at which the last period and the last half period begin; the largest |x| since each.
    amplitude, late_from, later_from, late, later,
    /// 1 if a peak has just been completed; its time and displacement; 1 if later peaks change a measure.
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

    /// The measures of a lane without a run.
    pub fn idle() -> Self {
        Self { late_from: f64::INFINITY, later_from: f64::INFINITY, ..Self::default() }
    }

    /// The peak that a zero crossing has just completed, and its index.
    pub fn ended_peak(&self) -> (Peak, u64) {
        let peak = Peak { time: self.ended_time, displacement: self.ended_x };
        (peak, self.half_cycles as u64 - 1)
    }

    /// Adds the energy lost in the primary's damper in a stretch, if it has ended (`done`).
    #[inline(always)]
    pub fn losing(&self, loss: f64, done: bool) -> Self {
        let viscous = DoubleDouble { value: self.viscous, rest: self.viscous_rest }.plus(loss);
        let mut next = *self;
        next.viscous = pick(done, viscous.value, self.viscous);
        next.viscous_rest = pick(done, viscous.rest, self.viscous_rest);
        next
    }

    /// The measures after a stretch that begins at an instant, if it has ended (`done`).
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

    /// Updates the current half cycle, and the peak of one that a zero crossing completes.
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
    /// After the measures have taken the peak of a lane: clears it, and asks whether later peaks change a
    /// measure.
    pub fn listen<S: System<Real = f64>>(&mut self, i: usize, measures: &Measures<S>) {
        let ended = self.half_cycles[i] as u64;
        (self.peaked[i], self.listens[i]) = (0.0, pick(measures.listens(ended), 1.0, 0.0));
    }
}

/// A stretch of motion, divided at the extremum of x.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stretch {
    /// x at its begin, at the extremum, and at its end.
    pub x: [f64; 3],
    /// The times of these three after the begin of the stretch.
    pub h: [f64; 3],
    /// True if x has an extremum in it; if not, `x[1]` is `x[0]` and `h[1]` is `h[0]`.
    pub turns: bool,
    /// Energy lost in the primary's damper.
    pub loss: f64,
}

/// Whether half cycles end at the extremum and at the end of a stretch.
pub(super) struct Ends {
    pub at_turn: bool,
    pub at_end: bool,
}

impl Ends {
    /// True if at most one half cycle ends; a stretch with two is left to the event loop.
    #[inline(always)]
    pub fn simple(&self) -> bool {
        !(self.at_turn & self.at_end)
    }
}

impl Stretch {
    /// A stretch for runs whose measures do not use it.
    pub const NONE: Self = Self { x: [0.0; 3], h: [0.0; 3], turns: false, loss: 0.0 };

    /// The ends of half cycles in the stretch, where x has this sign in the current half cycle.
    #[inline(always)]
    pub fn ends(&self, sign: f64) -> Ends {
        let at_turn = self.turns & (self.x[1] * sign < 0.0);
        let sign = pick(at_turn, -sign, sign);
        Ends { at_turn, at_end: self.x[2] * sign < 0.0 }
    }

    /// Whether |x| falls below a level, between which times, and the level with the sign of x.
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

/// A passage of |x| below a level, if there is one.
pub(super) struct Passage {
    pub passes: bool,
    pub h: [f64; 2],
    pub level: f64,
}
