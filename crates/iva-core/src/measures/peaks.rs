//! Peaks of the primary displacement, one per half cycle.

use crate::absorber::OnStructure;
use crate::engine::observe::Span;
use crate::number::real::Real;
use crate::segment::flight::{Jet, Motion, Rows, Turns};
use crate::segment::polynomial::{jet, turned, turnings};

/// A peak: the largest |x| between consecutive zero crossings of x.
///
/// An impact can make several extrema in one half cycle; they count as one peak. Peak 0 includes
/// the start. Only half cycles ended by a zero crossing count; a run without any crossing has the
/// one peak 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Peak<R = f64> {
    /// Instant, in 1/ωn.
    pub time: R,
    /// Displacement, signed.
    pub displacement: R,
}

/// A stretch of a span on which x is monotonic.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Monotone<R = f64> {
    /// Begin and end, as times after the start of the span.
    pub h: [R; 2],
    /// x at both ends.
    pub x: [R; 2],
}

/// Hands out the stretches of a span on which x is monotonic, in order.
pub(crate) fn monotone<R: Real, S: OnStructure<Real = R>, M: Motion<Real = R, State = S::State>>(
    span: &Span<'_, M>,
    mut take: impl FnMut(&Monotone<R>),
) {
    let (from, to) = (span.from, span.to);
    let mut begin = (R::ZERO, from.x);
    let mut turn = |(h, x): (R, R)| {
        take(&Monotone { h: [begin.0, h], x: [begin.1, x] });
        begin = (h, x);
    };
    match span.motion.turns(span.length, span.end) {
        Turns::Never => {}
        Turns::Once(h, x) => turn((h, x)),
        // Under force x may have more than one extremum.
        Turns::Unknown => match span.motion.rows() {
            Some(Rows { x, step, order, .. }) => {
                let x = &x[..=order];
                for bracket in turnings(x, span.length / step) {
                    let (t, x) = turned(|t| jet(x, t), bracket);
                    turn(((t * step).min(span.length), x));
                }
            }
            None if from.v * to.v < 0.0 => {
                let at = |h: R| {
                    let Jet { value, rate, curvature, jerk } = span.motion.primary(h);
                    [value, rate, curvature, jerk]
                };
                turn(turned(at, [R::ZERO, span.length]));
            }
            None => {}
        },
    }
    take(&Monotone { h: [begin.0, span.length], x: [begin.1, to.x] });
}

/// The half cycles of x.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct HalfCycles<R = f64> {
    /// The largest |x| so far of the current half cycle.
    pub current: Peak<R>,
    /// Sign of x in the current half cycle, 0 until x has left 0.
    pub sign: R,
    /// Number of completed half cycles.
    pub ended: u64,
}

impl<R: Real> HalfCycles<R> {
    pub fn start(time: R, x: R) -> Self {
        let sign = if x == 0.0 { R::ZERO } else { x.signum() };
        Self { current: Peak { time, displacement: x }, sign, ended: 0 }
    }

    /// Takes the end of a monotonic stretch; returns the peak of the half cycle that a zero crossing has
    /// completed.
    pub fn reach(&mut self, time: R, x: R) -> Option<Peak<R>> {
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
