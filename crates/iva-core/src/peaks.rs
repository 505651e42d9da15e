//! Peaks of the primary displacement, one per half cycle.

use crate::flight::{Jet, Motion};
use crate::observe::{Observer, Span};
use crate::roots::polish;
use crate::simulate::Tally;
use crate::system::System;

/// The largest |x| between consecutive zero crossings of x.
///
/// An impact can make several extrema in one half cycle; they count as one peak. Peak 0 includes
/// the start. Only half cycles ended by a zero crossing count; a run without any crossing has the
/// one peak 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Peak {
    /// Instant, in 1/ωn.
    pub time: f64,
    /// Displacement, signed.
    pub displacement: f64,
}

/// A stretch of a span on which x runs one way.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Monotone {
    /// Begin and end, measured from the start of the span.
    pub h: [f64; 2],
    /// x at both ends.
    pub x: [f64; 2],
}

/// The monotone stretches of a span: one, or two on both sides of a turning point.
pub(crate) fn monotone<S: System, M: Motion<State = S::State>>(
    span: &Span<'_, M>,
) -> (Monotone, Option<Monotone>) {
    let (from, to) = (span.from, span.to);
    if from.v * to.v >= 0.0 {
        return (Monotone { h: [0.0, span.length], x: [from.x, to.x] }, None);
    }
    let rise = if from.v < 0.0 { 1.0 } else { -1.0 };
    let guess = span.length * (from.v / (from.v - to.v));
    let (h, x) = polish(
        |h| {
            let Jet { value, rate, curvature, jerk } = span.motion.primary(h);
            (value, [rise * rate, rise * curvature, rise * jerk])
        },
        0.0,
        span.length,
        guess,
    );
    (Monotone { h: [0.0, h], x: [from.x, x] }, Some(Monotone { h: [h, span.length], x: [x, to.x] }))
}

/// Follows x through its half cycles.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct HalfCycles {
    /// Largest |x| of the half cycle under way.
    pub current: Peak,
    /// Sign of x in it, 0 as long as x has not left 0.
    sign: f64,
    /// Half cycles ended so far.
    pub ended: u64,
}

impl HalfCycles {
    pub fn start(x: f64) -> Self {
        let sign = if x == 0.0 { 0.0 } else { x.signum() };
        Self { current: Peak { time: 0.0, displacement: x }, sign, ended: 0 }
    }

    /// Takes the end of a monotone stretch; returns the peak that a zero crossing has ended.
    pub fn reach(&mut self, time: f64, x: f64) -> Option<Peak> {
        if x * self.sign < 0.0 {
            let peak = self.current;
            self.current = Peak { time, displacement: x };
            self.sign = -self.sign;
            self.ended += 1;
            return Some(peak);
        }
        if x.abs() > self.current.displacement.abs() {
            self.current = Peak { time, displacement: x };
            if self.sign == 0.0 {
                self.sign = x.signum();
            }
        }
        None
    }
}

/// Keeps the peaks of a run.
#[derive(Debug, Clone, Default)]
pub struct Envelope {
    /// Peaks in the order of time.
    pub peaks: Vec<Peak>,
    half_cycles: HalfCycles,
}

impl<S: System> Observer<S> for Envelope {
    fn start(&mut self, system: &S, state: &S::State, _duration: f64) {
        self.peaks.clear();
        self.half_cycles = HalfCycles::start(system.primary(state).x);
    }

    fn span<M: Motion<State = S::State>>(&mut self, _system: &S, span: &Span<'_, M>) {
        let (first, second) = monotone::<S, M>(span);
        for stretch in [Some(first), second].into_iter().flatten() {
            let time = span.start.plus(stretch.h[1]).value;
            self.peaks.extend(self.half_cycles.reach(time, stretch.x[1]));
        }
    }

    fn end(&mut self, _system: &S, _tally: &Tally<S::State>) {
        if self.peaks.is_empty() {
            self.peaks.push(self.half_cycles.current);
        }
    }
}
