//! The measures of a free decay, computed from its log.
//!
//! A run only logs its motions. The measures are functions of the log, written once ([`Course`]) for two kinds of
//! log: of motions that are damped sinusoids in closed form ([`sinusoids`]), and, for all other motions, of
//! stretches in which x is monotonic ([`stretches`]).
//!
//! Peaks are looked for from the begin on, as long as they change a measure; passages of the settling levels
//! and the largest |x| of the last period from the end back, to the first motion that does not matter.

use super::{CLOSE, Measures, Wanted, late};
use crate::absorber::{Absorber, Clock};
use crate::measures::peaks::Monotone;
use crate::number::real::Real;

pub(crate) use sinusoids::{Sinusoids, height, keeps};
pub(crate) use stretches::{Stretch, Stretches, in_motion};

mod sinusoids;
mod stretches;

/// The motions in a log, in order of time. Times within a motion count from its start.
pub(super) trait Course<S: Absorber> {
    /// Number of motions.
    fn count(&self) -> usize;
    /// The instant from which the times within a motion count.
    fn start(&self, k: usize) -> Clock<S::Real>;
    /// Time and displacement at begin and end of a motion.
    fn ends(&self, k: usize) -> [(S::Real, S::Real); 2];
    /// Time and displacement at the turning points of x between them.
    fn turns(&self, k: usize) -> impl DoubleEndedIterator<Item = (S::Real, S::Real)>;
    /// A bound on |x| in a motion.
    fn largest(&self, k: usize) -> S::Real;
    /// x in a motion.
    fn displacement(&self, k: usize, h: S::Real) -> S::Real;
    /// The energy of structure and absorber in a motion.
    fn energy(&self, k: usize, h: S::Real) -> S::Real;
    /// Hands the passages of the settling levels to the measures.
    fn pass(&self, found: &[Option<Passage<S::Real>>; 3], measures: &mut Measures<S>);
}

/// A passage of |x| from above a level to below it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Passage<R> {
    /// The motion.
    pub motion: usize,
    /// The stretch of it in which x is monotonic.
    pub stretch: Monotone<R>,
    /// The level, with the sign of x.
    pub level: R,
}

/// True if the measures of x or the energy after a period depend on the motions that begin at an instant.
#[inline(always)]
pub(crate) fn looks(wanted: Wanted, time: f64) -> bool {
    wanted.decay() || (wanted.first_period && time <= f64::TURN.value)
}

impl<S: Absorber> Measures<S> {
    /// Takes the motions in a log.
    #[inline(always)]
    pub(super) fn take_course(&mut self, course: &impl Course<S>) {
        if course.count() == 0 {
            return;
        }
        if self.wanted.decay() {
            self.find_peaks(course);
            if self.wanted.settling {
                self.settle(course);
            }
            if self.wanted.settling || self.wanted.residual {
                self.look_back(course);
            }
        }
        if self.wanted.first_period && self.begin == 0.0 {
            self.pass_period(course);
        }
    }

    /// True if A₀, and with it the settling levels, is final once motions that end at these x are taken.
    fn settles(&self, mut ends: impl Iterator<Item = S::Real>) -> bool {
        let mut half_cycles = self.half_cycles;
        let crosses = |x| half_cycles.reach(S::Real::ZERO, x).is_some();
        self.reference.settled || ends.any(crosses)
    }

    /// Hands out peaks as long as they change a measure.
    #[inline(always)]
    fn find_peaks(&mut self, course: &impl Course<S>) {
        for k in 0..course.count() {
            let (start, [_, end]) = (course.start(k), course.ends(k));
            for (h, x) in course.turns(k) {
                if self.needs_no_peak() {
                    return;
                }
                self.reach(start.plus(h).value, x);
            }
            if self.needs_no_peak() {
                return;
            }
            self.reach(start.plus(end.0).value, end.1);
        }
    }

    /// True if later peaks change nothing.
    #[inline(always)]
    fn needs_no_peak(&self) -> bool {
        self.reference.settled && !self.listens(self.half_cycles.ended)
    }

    /// Finds the last passage of each settling level.
    #[inline(always)]
    fn settle(&mut self, course: &impl Course<S>) {
        let amplitude = self.reference.amplitude;
        let mut levels = self.settling.each_ref().map(|it| Some(it.level(amplitude)));
        let mut found = [None; 3];
        for motion in (0..course.count()).rev() {
            let Some(least) = levels.iter().flatten().copied().reduce(S::Real::min) else { break };
            if course.largest(motion) <= least {
                continue;
            }
            let [begin, mut right] = course.ends(motion);
            for left in std::iter::once(begin).chain(course.turns(motion)).rev() {
                for (level, found) in levels.iter_mut().zip(&mut found) {
                    let passes = |level: &S::Real| left.1.abs() > *level && right.1.abs() <= *level;
                    let Some(size) = level.take_if(|level| passes(level)) else { continue };
                    let level = if left.1 > 0.0 { size } else { -size };
                    let stretch = Monotone { h: [left.0, right.0], x: [left.1, right.1] };
                    *found = Some(Passage { motion, stretch, level });
                }
                right = left;
            }
        }
        course.pass(&found, self);
    }

    /// Finds the largest |x| of the last period and half period of the run.
    #[inline(always)]
    fn look_back(&mut self, course: &impl Course<S>) {
        let duration = self.duration;
        let windows = [
            (S::Real::TURN.value, &mut self.last_period),
            (S::Real::TURN.value * 0.5, &mut self.last_half_period),
        ];
        for (before_end, largest) in windows {
            let from = late(duration, before_end);
            for k in (0..course.count()).rev() {
                let (late, [begin, end]) = (-course.start(k).minus(from), course.ends(k));
                if late + duration * (2.0 * CLOSE) >= end.0 {
                    break;
                }
                let first = if late > begin.0 { course.displacement(k, late) } else { begin.1 };
                let turns = course.turns(k).rev().take_while(|(h, _)| *h > late);
                let most = first.abs().max(end.1.abs());
                *largest = largest.max(turns.fold(most, |most, (_, x)| most.max(x.abs())));
            }
        }
    }

    /// Takes the energy after one period, if the log reaches from before that instant to it.
    #[inline(always)]
    fn pass_period(&mut self, course: &impl Course<S>) {
        let period = S::Real::TURN.value;
        let until = |k: usize| -course.start(k).minus(period);
        let last = course.count() - 1;
        let begins = until(0) >= course.ends(0)[0].0;
        let ends = until(last) - course.ends(last)[1].0 <= period * CLOSE;
        if !begins || !ends || self.values.damping_ratio_energy.is_some() {
            return;
        }
        let later = (0..=last).find(|k| until(*k) < course.ends(*k)[0].0);
        let k = later.unwrap_or(course.count()) - 1;
        // If the run ends after one period within rounding, its end counts.
        let h = until(k).min(course.ends(k)[1].0);
        self.one_period(course.energy(k, h));
    }
}
