//! The last instant at which |x| passes a level: a settling time.
//!
//! While the run passes, only the stretch of the last crossing is kept; its root is solved once,
//! at the end.

use crate::flight::{Jet, Motion};
use crate::observe::Span;
use crate::peaks::Monotone;
use crate::real::Real;
use crate::roots::polish;
use crate::system::{Clock, System};

/// Follows one level.
#[derive(Debug, Clone)]
pub(crate) struct LastCrossing<S: System> {
    share: Real,
    crossing: Option<Crossing<S::State>>,
}

/// A stretch on which x passes the level once.
#[derive(Debug, Clone, Copy)]
struct Crossing<State> {
    origin: State,
    riding: bool,
    start: Clock,
    stretch: Monotone,
    level: Real,
}

impl<S: System> LastCrossing<S> {
    /// Watches |x| = share · A₀.
    pub fn new(share: Real) -> Self {
        Self { share, crossing: None }
    }

    pub fn forget(&mut self) {
        self.crossing = None;
    }

    /// Keeps the stretch if |x| falls below the level on it.
    pub fn watch<M: Motion<State = S::State>>(
        &mut self,
        span: &Span<'_, M>,
        stretch: &Monotone,
        amplitude: Real,
    ) {
        let level = self.share * amplitude;
        let [from, to] = stretch.x;
        // After the last passage |x| is below, so only those that lead there count.
        if from.abs() <= level || to.abs() > level {
            return;
        }
        self.crossing = Some(Crossing {
            origin: *span.motion.origin(),
            riding: M::RIDING,
            start: span.start,
            stretch: *stretch,
            level: if from > 0.0 { level } else { -level },
        });
    }

    /// The settling time; `None` if `late`, the largest |x| of the last half period, still exceeds
    /// the level or if |x| never passed it.
    pub fn time(&self, system: &S, late: Real, amplitude: Real) -> Option<Real> {
        if late > self.share * amplitude {
            return None;
        }
        self.crossing.as_ref().map(|crossing| {
            let h = if crossing.riding {
                crossing.solve(&system.ride(&crossing.origin))
            } else {
                crossing.solve(&system.flight(&crossing.origin))
            };
            crossing.start.plus(h).value
        })
    }
}

impl<State> Crossing<State> {
    fn solve<M: Motion>(&self, motion: &M) -> Real {
        let [low, high] = self.stretch.h;
        let [from, to] = self.stretch.x;
        let rise = if to > from { 1.0 } else { -1.0 };
        let guess = low + (high - low) * ((self.level - from) / (to - from));
        let (h, ()) = polish(
            |h| {
                let Jet { value, rate, curvature, .. } = motion.primary(h);
                ((), [rise * (value - self.level), rise * rate, rise * curvature])
            },
            low,
            high,
            guess,
        );
        h
    }
}
