//! The log of a decay whose structure moves in closed form.
//!
//! A run only logs where the motions of its structure begin ([`crate::measures::log`]): after the start, an impact, a
//! stick and a release. What lies between follows from the closed form, so the measures do not depend on the
//! stretches in which the run was computed. Turning points and losses of many motions are computed side by side
//! in the lanes of vector instructions: one motion does not depend on another.

use std::cell::OnceCell;

use super::{Course, Measures, Passage, looks};
use crate::absorber::{Absorber, Clock};
use crate::engine::observe::Span;
use crate::host::Sinusoidal;
use crate::host::sinusoid::{self, Sinusoid};
use crate::measures::Wanted;
use crate::measures::log::{Entry, Log};
use crate::number::compensated::DoubleDouble;
use crate::number::real::{Real, pick};
use crate::number::vectors::in_vectors;
use crate::segment::flight::Motion;

/// Number of motions side by side.
const BLOCK: usize = 16;
/// The middle of the motion may be this many times as far from 0 as the motion is large at its begin: x, as a
/// difference from the middle, would lose digits farther away.
const FARTHEST: f64 = 8.0;
/// More turning points than any motion has.
const MOST_TURNS: f64 = 1e15;

/// The log of a decay; the memory serves one run after the other.
#[derive(Debug, Clone)]
pub(crate) struct Sinusoids {
    of: Sinusoidal,
    /// The motions so far.
    pub log: Log,
    /// True if the motion that begins next is to be logged.
    pub fresh: bool,
    /// ẋ at the end of the last stretch.
    pub v_before: f64,
    /// The structure alone, and with the absorber stuck to it; that is made when it is needed.
    free: Sinusoid,
    stuck: OnceCell<Sinusoid>,
    /// The first turning point of x in each motion: its time, and x there from the middle of the motion.
    turns: Vec<(f64, f64)>,
}

/// True if the motions that begin at an instant are to be logged.
#[inline(always)]
pub(crate) fn keeps(wanted: Wanted, time: f64) -> bool {
    wanted.ledger || looks(wanted, time)
}

impl<S: Absorber> Measures<S> {
    /// Prepares the log of a run whose decay has a closed form, if a measure needs one.
    pub(in crate::measures) fn log_decay(
        &mut self,
        system: &S,
        spare: Option<Box<Sinusoids>>,
        [x, v]: [f64; 2],
    ) {
        if !S::SINUSOIDAL {
            return;
        }
        let needs = keeps(self.wanted, 0.0);
        let near = |of: &Sinusoidal| of.middle(false).abs() <= FARTHEST * (x.abs() + v.abs());
        self.decay = system.sinusoidal().filter(near).filter(|_| needs).map(|of| {
            let mut decay = spare.unwrap_or_else(|| Box::new(Sinusoids::new(of)));
            decay.serve(of);
            decay.v_before = v;
            decay
        });
    }

    /// The motion that begins next is a new one.
    pub(in crate::measures) fn log_next(&mut self) {
        if let Some(decay) = &mut self.decay {
            decay.fresh = true;
        }
    }

    /// Logs the motion that begins at a state, if it is new. Lanes log the motions after it themselves.
    pub(crate) fn begins(
        &mut self,
        system: &S,
        clock: Clock<S::Real>,
        state: &S::State,
        stuck: bool,
    ) {
        if let Some(decay) = &mut self.decay
            && std::mem::take(&mut decay.fresh)
            && keeps(self.wanted, clock.value.double())
        {
            self.log_motion(system, clock, state, stuck);
        }
    }

    fn log_motion(&mut self, system: &S, clock: Clock<S::Real>, state: &S::State, stuck: bool) {
        let Some(decay) = &mut self.decay else { return };
        let at = system.primary(state);
        let clock = Clock { value: clock.value.double(), rest: clock.rest.double() };
        let motion = [at.x, at.v].map(Real::double);
        let entry = Entry::new(clock, motion, decay.v_before, system.aboard(state, stuck));
        decay.log.push(entry);
        if decay.log.is_full() {
            self.make_log_room();
        }
    }

    /// Takes the motions of a full log, so that a long run needs no more memory.
    pub(crate) fn make_log_room(&mut self) {
        let Some(decay) = &self.decay else { return };
        let settled = self.settles(decay.log.entries().iter().map(|entry| entry.x.into()));
        if settled {
            self.take_log();
        }
        if let Some(decay) = &mut self.decay {
            if settled { decay.log.restart() } else { decay.log.grow() }
        }
    }

    /// Logs a stretch of motion.
    pub(in crate::measures) fn log_span<M>(&mut self, system: &S, span: &Span<'_, M>)
    where
        M: Motion<Real = S::Real, State = S::State>,
    {
        self.begins(system, span.start, span.motion.origin(), M::RIDING);
        if let Some(decay) = &mut self.decay {
            decay.v_before = span.to.v.double();
        }
    }

    /// Takes the log of a run that has ended at a state.
    pub(in crate::measures) fn end_log(
        &mut self,
        system: &S,
        clock: Clock<S::Real>,
        state: &S::State,
    ) {
        self.log_motion(system, clock, state, false);
        self.take_log();
    }

    /// Computes the measures of the motions in the log.
    fn take_log(&mut self) {
        if !S::SINUSOIDAL {
            return;
        }
        if let Some(mut decay) = self.decay.take() {
            let log = std::mem::take(&mut decay.log);
            in_vectors(
                #[inline(always)]
                || decay.measure(self, log.entries()),
            );
            decay.log = log;
            self.decay = Some(decay);
        }
    }
}

impl Sinusoids {
    fn new(of: Sinusoidal) -> Self {
        Self {
            of,
            log: Log::default(),
            fresh: true,
            v_before: 0.0,
            free: Sinusoid::new(1.0, of.damping_ratio),
            stuck: OnceCell::new(),
            turns: Vec::new(),
        }
    }

    /// Prepares for a run of a structure, likely with the damping ratio of the run before.
    fn serve(&mut self, of: Sinusoidal) {
        if of.damping_ratio != self.of.damping_ratio {
            self.free = Sinusoid::new(1.0, of.damping_ratio);
        }
        (self.of, self.stuck, self.fresh) = (of, OnceCell::new(), true);
        self.log.clear();
    }

    /// Takes the motions between these entries, of which the last one is the begin of a motion that is not
    /// taken yet.
    #[inline(always)]
    fn measure<S: Absorber>(&mut self, measures: &mut Measures<S>, log: &[Entry]) {
        measures.moving |= log.len() > 1;
        if measures.wanted.decay() {
            self.turn(log);
        }
        measures.take_course(&Logged { sinusoids: self, log });
        if measures.wanted.ledger {
            self.lose(&mut measures.ledger.viscous, log);
        }
    }

    /// The structure in a motion.
    #[inline(always)]
    fn structure(&self, entry: &Entry) -> Sinusoid {
        let Sinusoidal { damping_ratio, mass_ratio, .. } = self.of;
        let carrying = || Sinusoid::new(1.0 + entry.carried, damping_ratio);
        if entry.carried == 0.0 {
            self.free
        } else if entry.carried == mass_ratio {
            *self.stuck.get_or_init(carrying)
        } else {
            carrying()
        }
    }

    /// Energy of structure and absorber a time h after the begin of a motion.
    #[inline(always)]
    fn energy(&self, entry: &Entry, h: f64) -> f64 {
        let [x, v] = self.after(entry, h);
        let Sinusoidal { mass_ratio, gravity, .. } = self.of;
        let fallen = gravity * h;
        let mut moving = (x * x + v * v) * 0.5;
        let (absorber, height) = if entry.carried > 0.0 {
            moving += entry.carried * 0.5 * (v * v);
            (entry.absorber, entry.height)
        } else {
            let passed = h * (entry.absorber - 0.5 * fallen) - (x - entry.x);
            (entry.absorber - fallen, entry.height + passed)
        };
        moving += mass_ratio * 0.5 * (absorber * absorber);
        moving + mass_ratio * gravity * height
    }

    /// The middle of a motion.
    #[inline(always)]
    fn middle(&self, entry: &Entry) -> f64 {
        self.of.middle(entry.carried > 0.0)
    }

    /// x and ẋ a time h after the begin of a motion.
    #[inline(always)]
    fn after(&self, entry: &Entry, h: f64) -> [f64; 2] {
        let middle = self.middle(entry);
        let [x, v] = self.structure(entry).after(entry.from(middle), h);
        [middle + x, v]
    }

    /// Computes the first turning point of x in each motion.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn turn(&mut self, log: &[Entry]) {
        self.turns.clear();
        let (free, middle) = (self.free, self.of.middle(false));
        for block in motions(log).chunks(BLOCK) {
            let [mut x, mut v, mut time, mut turned] = [[0.0; BLOCK]; 4];
            for (i, entry) in block.iter().enumerate() {
                [x[i], v[i]] = entry.from(middle);
            }
            for i in 0..BLOCK {
                (time[i], turned[i]) = free.first_turn([x[i], v[i]]);
            }
            let turns = time.iter().copied().zip(turned).zip(block);
            for (turn, entry) in turns {
                let stuck = entry.carried > 0.0;
                let turn =
                    if stuck { self.structure(entry).first_turn(entry.from(0.0)) } else { turn };
                self.turns.push(turn);
            }
        }
    }

    /// The turning points of x in a motion before a time, each with its time.
    #[inline(always)]
    fn turns_of(
        &self,
        k: usize,
        entry: &Entry,
        until: f64,
    ) -> impl DoubleEndedIterator<Item = (f64, f64)> + use<> {
        let (structure, middle) = (self.structure(entry), self.middle(entry));
        let (first, x) = self.turns[k];
        let at = move |n: u64| (n as f64).mul_add(structure.half, first);
        let count = ((until - first) / structure.half).ceil();
        // A run that has overflowed has no turning points.
        let mut count = if count < MOST_TURNS { count as u64 } else { 0 };
        if count > 0 && at(count - 1) >= until {
            count -= 1;
        }
        (0..count).map(move |n| (at(n), middle + structure.later_turn(x, n)))
    }

    /// Adds the energy lost in the structure's damper.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn lose<R: Real>(&self, viscous: &mut DoubleDouble<R>, log: &[Entry]) {
        let (free, middle) = (self.free, self.of.middle(false));
        for (number, block) in motions(log).chunks(BLOCK).enumerate() {
            let [mut from_x, mut from_v, mut to_x, mut to_v, mut span, mut lost] =
                [[0.0; BLOCK]; 6];
            let ends = &log[number * BLOCK + 1..];
            for (i, (entry, end)) in block.iter().zip(ends).enumerate() {
                [from_x[i], from_v[i]] = entry.from(middle);
                [to_x[i], to_v[i]] = end.reached(middle);
                span[i] = length(entry, end);
            }
            for i in 0..BLOCK {
                lost[i] = free.lost([from_x[i], from_v[i]], [to_x[i], to_v[i]], span[i]);
            }
            for (i, (entry, end)) in block.iter().zip(ends).enumerate() {
                let lost = match entry.carried > 0.0 {
                    true => {
                        let ends = [entry.from(0.0), end.reached(0.0)];
                        self.structure(entry).lost(ends[0], ends[1], span[i])
                    }
                    false => lost[i],
                };
                *viscous = viscous.plus(R::from(lost));
            }
        }
    }
}

/// The distance from wall − of an absorber at this distance from the wall of this sign.
#[inline(always)]
pub(crate) fn height(clearance: f64, side: f64, distance: f64) -> f64 {
    pick(side > 0.0, 2.0 * clearance - distance, distance)
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

/// The motions between entries.
struct Logged<'a> {
    sinusoids: &'a Sinusoids,
    log: &'a [Entry],
}

impl<R: Real, S: Absorber<Real = R>> Course<S> for Logged<'_> {
    #[inline(always)]
    fn count(&self) -> usize {
        motions(self.log).len()
    }

    #[inline(always)]
    fn start(&self, k: usize) -> Clock<R> {
        let Clock { value, rest } = self.log[k].clock();
        Clock { value: value.into(), rest: rest.into() }
    }

    #[inline(always)]
    fn ends(&self, k: usize) -> [(R, R); 2] {
        let [entry, end] = [&self.log[k], &self.log[k + 1]];
        [(R::ZERO, entry.x.into()), (length(entry, end).into(), end.x.into())]
    }

    #[inline(always)]
    fn turns(&self, k: usize) -> impl DoubleEndedIterator<Item = (R, R)> {
        let entry = &self.log[k];
        let turns = self.sinusoids.turns_of(k, entry, length(entry, &self.log[k + 1]));
        turns.map(|(h, x)| (h.into(), x.into()))
    }

    #[inline(always)]
    fn largest(&self, k: usize) -> R {
        let entry = &self.log[k];
        let middle = self.sinusoids.middle(entry);
        (middle.abs() + self.sinusoids.structure(entry).radius(entry.from(middle))).into()
    }

    #[inline(always)]
    fn displacement(&self, k: usize, h: R) -> R {
        let entry = &self.log[k];
        self.sinusoids.after(entry, h.double())[0].into()
    }

    #[inline(always)]
    fn energy(&self, k: usize, h: R) -> R {
        self.sinusoids.energy(&self.log[k], h.double().max(0.0)).into()
    }

    /// Those of the structure alone are found side by side.
    #[inline(always)]
    fn pass(&self, found: &[Option<Passage<R>>; 3], measures: &mut Measures<S>) {
        let of = |passage: &Passage<R>| {
            let Passage { motion, stretch, level } = passage;
            let entry = &self.log[*motion];
            let (middle, sign) = (self.sinusoids.middle(entry), level.double());
            sinusoid::Passage {
                from: entry.from(middle),
                level: sign - middle,
                sign,
                between: stretch.h.map(Real::double),
                turn: self.sinusoids.turns[*motion],
            }
        };
        let Some(any) = found.iter().flatten().next() else { return };
        // One more than there are levels, for vectors of four.
        let passages: [_; 4] =
            std::array::from_fn(|i| of(found.get(i).and_then(Option::as_ref).unwrap_or(any)));
        let times = self.sinusoids.free.passages(&passages);
        for (i, h) in times.iter().enumerate().take(found.len()) {
            let Some(passage) = &found[i] else { continue };
            let entry = &self.log[passage.motion];
            let h = match entry.carried > 0.0 {
                true => self.sinusoids.structure(entry).passages(&[passages[i]])[0],
                false => *h,
            };
            measures.settling[i].passed_at(entry.clock().plus(h).value.into());
        }
    }
}
