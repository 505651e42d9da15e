//! Settling time: the last instant at which |x| falls below a level.
//!
//! During the run only the stretch of the last crossing is kept; its root is solved once, at the end.

use crate::flight::{Jet, Motion};
use crate::observe::Span;
use crate::peaks::Monotone;
use crate::real::Real;
use crate::roots::polish;
use crate::system::{Clock, System};

/// The levels, in parts of A₀.
pub(crate) const LEVELS: [f64; 3] = [0.10, 0.05, 0.02];

/// The last crossing of one level.
#[derive(Debug, Clone)]
pub(crate) struct LastCrossing<S: System> {
    share: S::Real,
    crossing: Option<Crossing<S::State, S::Real>>,
    /// Its instant, if that is already known.
    instant: Option<S::Real>,
}

/// A stretch on which |x| falls below the level once.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Crossing<State, R = f64> {
    /// The state at the begin of the motion that contains the stretch.
    pub origin: State,
    /// True if that motion is a stick episode.
    pub riding: bool,
    /// The instant of its begin.
    pub start: Clock<R>,
    /// Begin and end of the stretch, as times after that instant.
    pub h: [R; 2],
    /// The level, with the sign of x.
    pub level: R,
}

impl<R: Real, S: System<Real = R>> LastCrossing<S> {
    /// Watches |x| = share · A₀.
    pub fn new(share: R) -> Self {
        Self { share, crossing: None, instant: None }
    }

    /// Keeps a crossing.
    pub fn passed(&mut self, crossing: Crossing<S::State, R>) {
        self.crossing = Some(crossing);
    }

    /// Keeps a crossing at this instant.
    pub fn passed_at(&mut self, instant: S::Real) {
        self.instant = Some(instant);
    }

    /// The level for a reference amplitude.
    pub fn level(&self, amplitude: S::Real) -> S::Real {
        self.share * amplitude
    }

    pub fn forget(&mut self) {
        (self.crossing, self.instant) = (None, None);
    }

    /// Keeps the stretch if |x| falls below the level on it.
    pub fn watch<M: Motion<Real = R, State = S::State>>(
        &mut self,
        span: &Span<'_, M>,
        stretch: &Monotone<R>,
        amplitude: R,
    ) {
        let level = self.level(amplitude);
        let [from, to] = stretch.x;
        // After the last passage |x| is below the level, so only stretches that end below it count.
        if from.abs() <= level || to.abs() > level {
            return;
        }
        self.passed(Crossing {
            origin: *span.motion.origin(),
            riding: M::RIDING,
            start: span.start,
            h: stretch.h,
            level: if from > 0.0 { level } else { -level },
        });
    }

    /// The settling time; `None` if `late`, the largest |x| of the last half period, still exceeds
    /// the level or if |x| never passed it.
    pub fn time(&self, system: &S, late: R, amplitude: R) -> Option<R> {
        if late > self.level(amplitude) {
            return None;
        }
        let solved = self.crossing.as_ref().map(|crossing| {
            let h = if crossing.riding {
                crossing.solve(&system.ride(&crossing.origin))
            } else {
                crossing.solve(&system.flight(&crossing.origin))
            };
            crossing.start.plus(h).value
        });
        solved.or(self.instant)
    }
}

impl<R: Real, State> Crossing<State, R> {
    fn solve<M: Motion<Real = R>>(&self, motion: &M) -> R {
        let [low, high] = self.h;
        let [from, to] = self.h.map(|h| motion.primary(h).value);
        let rise = if self.level < 0.0 { 1.0 } else { -1.0 };
        let guess = low + (high - low) * ((self.level - from) / (to - from));
        let (h, ()) = polish(
            |h| {
                let Jet { value, rate, curvature, .. } = motion.primary(h);
                ((), [(value - self.level) * rise, rate * rise, curvature * rise])
            },
            low,
            high,
            guess,
        );
        h
    }
}
