//! Strobes: the states at one phase of the force.

use super::regime::RETURNS_KEPT;
use super::{Steady, largest_in};
use crate::absorber::{Clock, Point};
use crate::engine::observe::Span;
use crate::measures::sample::span_ends;
use crate::number::clock::SLACK;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::{GapPoint, Motion, Quantity};

/// The state at one phase of the force, with data on the cycle that ends there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strobe<R = f64> {
    /// Index of the strobe, 0 for the first at or after time zero.
    pub cycle: u64,
    /// The index of the absorber: of several there is a strobe of each at every instant.
    pub absorber: u8,
    /// Instant, in 1/ωn.
    pub time: R,
    /// Displacement of the primary.
    pub displacement: R,
    /// Velocity of the primary.
    pub velocity: R,
    /// Absorber minus primary displacement.
    pub gap_displacement: R,
    /// Absorber minus primary velocity.
    pub gap_velocity: R,
    /// Largest |x| from the previous strobe, or from the begin of the window, up to this one.
    pub amplitude: R,
    /// Number of listed impacts from the begin of the window up to this strobe.
    pub impacts: u64,
}

/// A motion at which strobes are taken, in order of time.
pub(crate) trait Strobed<R> {
    /// Structure and absorber a time h after its begin.
    fn place(&mut self, h: R) -> (Point<R>, GapPoint<R>);
    /// How many absorbers move.
    fn absorbers(&self) -> usize {
        1
    }
    /// The gap of the absorber of this index.
    fn gap_of(&mut self, _absorber: usize, h: R) -> GapPoint<R> {
        self.place(h).1
    }
    /// The larger of `least` and the largest |x| in a part, which ends at the last strobe or at its end.
    fn largest(&mut self, h: [R; 2], least: R) -> R;
}

/// A span at which they are taken.
pub(super) struct Spanned<'a, 'b, M: Motion>(pub &'a Span<'b, M>);

impl<R: Real, M: Motion<Real = R>> Strobed<R> for Spanned<'_, '_, M> {
    fn place(&mut self, h: R) -> (Point<R>, GapPoint<R>) {
        self.0.motion.place(h)
    }

    fn absorbers(&self) -> usize {
        self.0.motion.absorbers()
    }

    fn gap_of(&mut self, absorber: usize, h: R) -> GapPoint<R> {
        self.0.motion.gap_of(absorber, h)
    }

    fn largest(&mut self, h: [R; 2], least: R) -> R {
        largest_in(self.0, Quantity::Displacement, h, least)
    }
}

impl<R: Real> Steady<R> {
    /// The strobes of the window: all if wanted, else the last few.
    pub fn strobes(&self) -> impl Iterator<Item = &Strobe<R>> {
        self.strobes.iter()
    }

    /// The strobes of the window, if all are wanted.
    pub fn all_strobes(&self) -> Option<Vec<Strobe<R>>> {
        self.wanted.strobes.then(|| self.strobes.iter().copied().collect())
    }

    /// Keeps the strobes in a motion of this length from an instant on, and the largest |x| of each cycle if all strobes
    /// are wanted; what lies before `from` is left out.
    pub(crate) fn take_strobes(
        &mut self,
        start: Clock<R>,
        [from, length]: [R; 2],
        motion: &mut impl Strobed<R>,
    ) {
        let mut from = from;
        while let Some(instant) = self.next_strobe() {
            let at = (instant - start).value;
            let beyond = (instant.value - self.duration) / self.duration;
            let last = beyond.abs() <= SLACK && span_ends(&start, length, self.duration);
            // At the instant of an impact the state after it counts.
            if at >= length && !last {
                break;
            }
            let at = at.clamp(0.0, length);
            let (primary, gap) = motion.place(at);
            self.until(motion, [from, at]);
            from = from.max(at);
            let instant = instant.value.max(0.0);
            self.absorbers = motion.absorbers().max(1);
            if self.absorbers == 1 {
                self.keep(primary, (0, gap), instant);
            } else {
                for absorber in 0..self.absorbers {
                    let gap = motion.gap_of(absorber, at);
                    self.keep(primary, (absorber as u8, gap), instant);
                }
            }
            self.current = R::ZERO;
            self.pass_strobe();
        }
        self.until(motion, [from, length]);
    }

    /// Updates the amplitude of the current cycle.
    fn until(&mut self, motion: &mut impl Strobed<R>, h: [R; 2]) {
        if self.wanted.strobes && h[0] < h[1] {
            self.current = motion.largest(h, self.current);
        }
    }

    /// The instant of the next strobe to keep; `None` if none is wanted or it is after the end of the run.
    pub(crate) fn next_strobe(&self) -> Option<DoubleDouble<R>> {
        let strobes = self.wanted.regime || self.wanted.strobes;
        let within = |instant: &DoubleDouble<R>| instant.value <= self.duration * (R::ONE + SLACK);
        self.instant.filter(|_| strobes).filter(within)
    }

    pub(super) fn pass_strobe(&mut self) {
        self.next += 1;
        self.instant = self.window.instant(self.next);
    }

    fn keep(&mut self, primary: Point<R>, (absorber, gap): (u8, GapPoint<R>), time: R) {
        self.strobes.push_back(Strobe {
            cycle: self.next,
            absorber,
            time,
            displacement: primary.x,
            velocity: primary.v,
            gap_displacement: gap.y,
            gap_velocity: gap.w,
            amplitude: self.current.max(primary.x.abs()),
            impacts: self.impacts,
        });
        if !self.wanted.strobes && self.strobes.len() > RETURNS_KEPT * self.absorbers {
            self.strobes.pop_front();
        }
    }
}
