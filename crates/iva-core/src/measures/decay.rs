//! The measures of a free decay, computed from its log.
//!
//! Peaks are looked for from the begin on, as long as they change a measure; passages of the settling levels
//! from the end back, to the first one that is found. Turning points and losses of many motions are computed
//! side by side in the lanes of vector instructions: one motion does not depend on another.

use std::cell::OnceCell;

use super::{CLOSE, Measures, late};
use crate::host::sinusoid::Sinusoid;
use crate::log::Entry;
use crate::real::Real;
use crate::system::System;

/// Number of motions side by side.
const BLOCK: usize = 16;

/// Computes the measures of runs of one kind of structure and absorber; its memory serves one after the other.
#[derive(Debug)]
pub(crate) struct Decay {
    damping_ratio: f64,
    mass_ratio: f64,
    /// The structure alone, and with the absorber stuck to it; that is made when it is needed.
    free: Sinusoid,
    stuck: OnceCell<Sinusoid>,
    /// Time and displacement of the first turning point of x in each motion.
    turns: Vec<(f64, f64)>,
    /// The ends of the monotonic stretches of one motion: time and displacement.
    ends: Vec<(f64, f64)>,
}

impl Decay {
    /// For a structure of damping ratio ζ and an absorber of mass ratio μ.
    pub fn new(damping_ratio: f64, mass_ratio: f64) -> Self {
        let (turns, ends) = (Vec::new(), Vec::new());
        let free = Sinusoid::new(1.0, damping_ratio);
        Self { damping_ratio, mass_ratio, free, stuck: OnceCell::new(), turns, ends }
    }

    /// The same for another absorber, on a structure that is likely to be the same.
    pub fn serves(self, damping_ratio: f64, mass_ratio: f64) -> Self {
        if damping_ratio != self.damping_ratio {
            return Self::new(damping_ratio, mass_ratio);
        }
        Self { mass_ratio, stuck: OnceCell::new(), ..self }
    }

    /// Takes the motions between these entries, of which the last one is the begin of a motion that is not
    /// taken yet.
    pub fn take<S: System<Real = f64>>(&mut self, measures: &mut Measures<S>, log: &[Entry]) {
        f64::dispatched(
            #[inline(always)]
            || self.measure(measures, log),
        );
    }

    #[inline(always)]
    fn measure<S: System<Real = f64>>(&mut self, measures: &mut Measures<S>, log: &[Entry]) {
        let Some(last) = log.last() else { return };
        measures.moving |= log.len() > 1;
        if measures.wanted.decay() {
            self.turn(log);
            self.find_peaks(measures, log);
            if measures.wanted.settling {
                self.settle(measures, log);
            }
            if measures.wanted.settling || measures.wanted.residual {
                self.look_back(measures, log);
            }
        }
        if measures.wanted.ledger {
            self.lose(measures, log);
        }
        let period = f64::TURN.value;
        if measures.begin == 0.0 && log[0].time <= period && last.time >= period * (1.0 - CLOSE) {
            let k = log.partition_point(|entry| entry.time <= period);
            // If the run ends after one period within rounding, its end counts.
            let at = if k < log.len() { &log[k - 1] } else { last };
            let h = -at.clock().minus(period);
            measures.one_period(self.energy(at, h.max(0.0)));
        }
    }

    /// The structure in a motion.
    #[inline(always)]
    fn structure(&self, entry: &Entry) -> &Sinusoid {
        let stuck = || Sinusoid::new(1.0 + self.mass_ratio, self.damping_ratio);
        if entry.stuck > 0.0 { self.stuck.get_or_init(stuck) } else { &self.free }
    }

    /// Energy of structure and absorber a time h after the begin of a motion.
    #[inline(always)]
    fn energy(&self, entry: &Entry, h: f64) -> f64 {
        let [x, v] = self.structure(entry).after(entry.from(), h);
        let absorber = if entry.stuck > 0.0 { v } else { entry.absorber };
        (x * x + v * v) * 0.5 + self.mass_ratio * 0.5 * (absorber * absorber)
    }

    /// Computes the first turning point of x in each motion.
    #[inline(always)]
    fn turn(&mut self, log: &[Entry]) {
        self.turns.clear();
        let free = self.free;
        for block in motions(log).chunks(BLOCK) {
            let [mut x, mut v, mut time, mut turned] = [[0.0; BLOCK]; 4];
            for (i, entry) in block.iter().enumerate() {
                (x[i], v[i]) = (entry.x, entry.v);
            }
            for i in 0..BLOCK {
                (time[i], turned[i]) = free.first_turn([x[i], v[i]]);
            }
            let turns = time.iter().copied().zip(turned).zip(block);
            for (turn, entry) in turns {
                let stuck = entry.stuck > 0.0;
                let turn =
                    if stuck { self.structure(entry).first_turn(entry.from()) } else { turn };
                self.turns.push(turn);
            }
        }
    }

    /// The turning points of x in a motion before a time, each with its time.
    #[inline(always)]
    fn turns_of(&self, k: usize, entry: &Entry, until: f64) -> impl Iterator<Item = (f64, f64)> {
        let &Sinusoid { half, shrink, .. } = self.structure(entry);
        let (first, mut x) = self.turns[k];
        let mut count = 0.0;
        std::iter::from_fn(move || {
            let turn = (first + count * half, x);
            count += 1.0;
            x *= -shrink;
            (turn.0 < until).then_some(turn)
        })
    }

    /// Hands out peaks as long as they change a measure.
    #[inline(always)]
    fn find_peaks<S: System<Real = f64>>(&self, measures: &mut Measures<S>, log: &[Entry]) {
        for (k, entry) in motions(log).iter().enumerate() {
            if measures.reference.settled && !measures.listens(measures.half_cycles.ended) {
                return;
            }
            let (start, end) = (entry.clock(), &log[k + 1]);
            for (h, x) in self.turns_of(k, entry, length(entry, end)) {
                measures.reach(start.plus(h).value, x);
            }
            measures.reach(end.time, end.x);
        }
    }

    /// Finds the last passage of each settling level.
    #[inline(always)]
    fn settle<S: System<Real = f64>>(&mut self, measures: &mut Measures<S>, log: &[Entry]) {
        let amplitude = measures.reference.amplitude;
        let mut levels = measures.settling.each_ref().map(|it| Some(it.level(amplitude)));
        for (k, entry) in motions(log).iter().enumerate().rev() {
            let Some(least) = levels.iter().flatten().copied().reduce(f64::min) else { return };
            let structure = *self.structure(entry);
            if structure.radius(entry.from()) <= least {
                continue;
            }
            let end = &log[k + 1];
            let mut ends = std::mem::take(&mut self.ends);
            ends.clear();
            ends.push((0.0, entry.x));
            ends.extend(self.turns_of(k, entry, length(entry, end)));
            let mut right = (length(entry, end), end.x);
            for left in ends.drain(..).rev() {
                for (level, last) in levels.iter_mut().zip(&mut measures.settling) {
                    let passes = |level: &f64| left.1.abs() > *level && right.1.abs() <= *level;
                    if let Some(size) = level.take_if(|level| passes(level)) {
                        let there = size.copysign(left.1);
                        let h = structure.passage(entry.from(), there, [left.0, right.0]);
                        last.passed_at(entry.clock().plus(h).value);
                    }
                }
                right = left;
            }
            self.ends = ends;
        }
    }

    /// Finds the largest |x| of the last period and half period of the run.
    #[inline(always)]
    fn look_back<S: System<Real = f64>>(&self, measures: &mut Measures<S>, log: &[Entry]) {
        let duration = measures.duration;
        let windows = [
            (f64::TURN.value, &mut measures.last_period),
            (0.5 * f64::TURN.value, &mut measures.last_half_period),
        ];
        for (before_end, largest) in windows {
            let from = late(duration, before_end);
            for (k, entry) in motions(log).iter().enumerate().rev() {
                let end = &log[k + 1];
                let (begin, length) = (-entry.clock().minus(from), length(entry, end));
                if begin + duration * (2.0 * CLOSE) >= length {
                    break;
                }
                let first = match begin > 0.0 {
                    true => self.structure(entry).after(entry.from(), begin)[0],
                    false => entry.x,
                };
                let turns = self.turns_of(k, entry, length).filter(|(h, _)| *h > begin);
                *largest = turns.fold(largest.max(first.abs()), |most, (_, x)| most.max(x.abs()));
                *largest = largest.max(end.x.abs());
            }
        }
    }

    /// Adds the energy lost in the structure's damper.
    #[inline(always)]
    fn lose<S: System<Real = f64>>(&self, measures: &mut Measures<S>, log: &[Entry]) {
        let free = self.free;
        for (number, block) in motions(log).chunks(BLOCK).enumerate() {
            let [mut from_x, mut from_v, mut to_x, mut to_v, mut span, mut lost] =
                [[0.0; BLOCK]; 6];
            let ends = &log[number * BLOCK + 1..];
            for (i, (entry, end)) in block.iter().zip(ends).enumerate() {
                [from_x[i], from_v[i]] = entry.from();
                [to_x[i], to_v[i]] = end.reached();
                span[i] = length(entry, end);
            }
            for i in 0..BLOCK {
                lost[i] = free.lost([from_x[i], from_v[i]], [to_x[i], to_v[i]], span[i]);
            }
            for (i, (entry, end)) in block.iter().zip(ends).enumerate() {
                let lost = match entry.stuck > 0.0 {
                    true => self.structure(entry).lost(entry.from(), end.reached(), span[i]),
                    false => lost[i],
                };
                measures.viscous = measures.viscous.plus(lost);
            }
        }
    }
}

/// The motions that end within a log: all entries but the last.
fn motions(log: &[Entry]) -> &[Entry] {
    &log[..log.len().saturating_sub(1)]
}

/// The length of a motion that ends where another begins.
#[inline(always)]
fn length(entry: &Entry, end: &Entry) -> f64 {
    (end.clock() - entry.clock()).value
}
