//! Settling time: the last instant at which |x| falls below a level.
//!
//! Of a motion without closed form only the stretch of the last crossing is kept; its root is solved once, at the end.

use crate::absorber::Absorber;
use crate::measures::peaks::Monotone;
use crate::measures::{Stretch, in_motion};
use crate::number::real::Real;
use crate::segment::flight::{Jet, Motion};
use crate::segment::roots::polish;

/// The levels, in parts of A₀.
pub(crate) const LEVELS: [f64; 3] = [0.10, 0.05, 0.02];

/// The last crossing of one level.
#[derive(Debug, Clone)]
pub(crate) struct LastCrossing<S: Absorber> {
    share: S::Real,
    crossing: Option<Crossing<S>>,
    /// Its instant, if that is already known.
    instant: Option<S::Real>,
}

/// A stretch on which |x| falls below the level once.
#[derive(Debug, Clone)]
struct Crossing<S: Absorber> {
    stretch: Stretch<S::State, S::Real>,
    /// The level, with the sign of x.
    level: S::Real,
}

impl<R: Real, S: Absorber<Real = R>> LastCrossing<S> {
    /// Watches |x| = share · A₀.
    pub fn new(share: R) -> Self {
        Self { share, crossing: None, instant: None }
    }

    /// Keeps the stretch of a crossing.
    pub fn passed(&mut self, stretch: Stretch<S::State, R>, level: R) {
        self.crossing = Some(Crossing { stretch, level });
    }

    /// Keeps a crossing at this instant.
    pub fn passed_at(&mut self, instant: S::Real) {
        self.instant = Some(instant);
    }

    /// The level for a reference amplitude.
    pub fn level(&self, amplitude: S::Real) -> S::Real {
        self.share * amplitude
    }

    /// The settling time; `None` if `late`, the largest |x| of the last half period, still exceeds
    /// the level or if |x| never passed it.
    pub fn time(&self, system: &S, late: R, amplitude: R) -> Option<R> {
        if late > self.level(amplitude) {
            return None;
        }
        let solved = self.crossing.as_ref().map(|Crossing { stretch, level }| {
            let h = in_motion!(system, stretch, motion => solve(&motion, &stretch.part, *level));
            stretch.start.plus(h).value
        });
        solved.or(self.instant)
    }
}

/// The instant at which x passes a level in a stretch, as a time after the begin of its motion.
fn solve<R: Real, M: Motion<Real = R>>(motion: &M, stretch: &Monotone<R>, level: R) -> R {
    let [low, high] = stretch.h;
    let [from, to] = stretch.h.map(|h| motion.primary(h).value);
    let rise = if level < 0.0 { 1.0 } else { -1.0 };
    let guess = low + (high - low) * ((level - from) / (to - from));
    let (h, ()) = polish(
        |h| {
            let Jet { value, rate, curvature, .. } = motion.primary(h);
            ((), [(value - level) * rise, rate * rise, curvature * rise])
        },
        low,
        high,
        guess,
    );
    h
}
