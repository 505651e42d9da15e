//! Steady states under force: amplitudes after a transient, the state once a cycle of the force, and
//! whether it comes back.
//!
//! All is read off the series of the motion as it passes: extrema by enclosure, mean squares as
//! integrals, strobes at their instants. Nothing is sampled.

use std::collections::VecDeque;

use crate::compensated::DoubleDouble;
use crate::flight::{Arc, Arcs, Motion, Turns};
use crate::force::Harmonic;
use crate::impact::Impact;
use crate::observe::{Observer, Span};
use crate::polynomial::largest;
use crate::real::Real;
use crate::sample::{SLACK, span_ends};
use crate::simulate::{Instant, Outcome, Tally};
use crate::system::{System, Wall};

pub use bare::amplitude_without_absorber;
pub use regime::Regime;

use regime::{RETURNS_KEPT, regime};

mod bare;
mod regime;

/// What a steady state is measured by.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Window<R = f64> {
    /// Instant from which on it counts: the end of the transient.
    pub from: R,
    /// The force whose cycles count; `None` if none of the forces has any.
    pub cycle: Option<Harmonic<R>>,
}

impl<R: Real> Window<R> {
    /// The instants Ω t + phase = 2π k, from the first at or after time zero on.
    fn instant(&self, index: u64) -> Option<DoubleDouble<R>> {
        let Harmonic { frequency, phase, .. } = self.cycle?;
        let first = (phase / R::TURN.value).ceil();
        let turns = R::TURN.times(first + index as f64);
        Some(turns.plus(-phase).over(frequency))
    }
}

impl<R: Real> Window<R> {
    /// The first strobe that a regime is told by, or one a little before.
    fn last_kept(&self, duration: R) -> u64 {
        let Some(Harmonic { frequency, phase, .. }) = self.cycle else { return 0 };
        let first = (phase / R::TURN.value).ceil();
        let last = (frequency * duration + phase) / R::TURN.value - first;
        last.max(0.0).whole().saturating_sub(RETURNS_KEPT + 1) as u64
    }
}

/// Which groups of numbers to compute.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SteadyWanted {
    /// Largest displacement.
    pub amplitude: bool,
    /// Its root mean square.
    pub rms: bool,
    /// Largest accelerations, of primary and base.
    pub acceleration: bool,
    /// The kind of motion.
    pub regime: bool,
    /// Impacts a cycle.
    pub impacts: bool,
    /// All strobes, not only the last few.
    pub strobes: bool,
}

impl SteadyWanted {
    /// Everything.
    pub const ALL: Self = Self {
        amplitude: true,
        rms: true,
        acceleration: true,
        regime: true,
        impacts: true,
        strobes: true,
    };

    fn any(self) -> bool {
        self != Self::default()
    }
}

/// The state at one phase of the force, and the cycle that ends there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strobe<R = f64> {
    /// Number of the instant, 0 for the first at or after time zero.
    pub cycle: u64,
    /// Instant, in 1/ωn.
    pub time: R,
    /// Displacement of the primary.
    pub displacement: R,
    /// Its velocity.
    pub velocity: R,
    /// Absorber minus primary displacement.
    pub gap_displacement: R,
    /// Absorber minus primary velocity.
    pub gap_velocity: R,
    /// Largest |x| from the strobe before, or from the begin of the window, up to here.
    pub amplitude: R,
    /// Listed impacts from the begin of the window up to here.
    pub impacts: u64,
}

/// The numbers of a steady state; `None` where the run does not define one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SteadyValues<R = f64> {
    /// Largest |x|.
    pub amplitude_max: Option<R>,
    /// √ of the mean of x².
    pub amplitude_rms: Option<R>,
    /// Largest |ẍ + a_g| between impacts.
    pub acceleration_max: Option<R>,
    /// Largest |a_g|.
    pub base_max: Option<R>,
    /// Listed impacts over cycles of the force.
    pub impacts_per_cycle: Option<R>,
    /// What comes back, and how often.
    pub regime: Option<Regime>,
}

/// Watches a driven run.
#[derive(Debug, Clone, Default)]
pub struct Steady<R = f64> {
    window: Window<R>,
    wanted: SteadyWanted,
    duration: R,
    values: SteadyValues<R>,
    strobes: VecDeque<Strobe<R>>,
    next: u64,
    /// The first strobe to keep.
    first: u64,
    /// Largest |x|: of the cycle under way, where strobes are wanted, and of the window.
    current: R,
    largest: R,
    acceleration: R,
    base: R,
    square: DoubleDouble<R>,
    base_moves: bool,
    impacts: u64,
    streak: Streak<R>,
}

/// The numbers of a steady state under way.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kept<R = f64> {
    /// From when on it counts.
    pub from: R,
    /// Largest |x| and |ẍ + a_g|.
    pub largest: R,
    pub acceleration: R,
    /// ∫x².
    pub square: DoubleDouble<R>,
    /// Listed impacts.
    pub impacts: u64,
    /// The next strobe to keep; infinite if none is.
    pub strobe: DoubleDouble<R>,
}

impl<R: Real> Kept<R> {
    /// Where no steady state is measured.
    pub const NOTHING: Self = Self {
        from: R::INFINITY,
        largest: R::ZERO,
        acceleration: R::ZERO,
        square: DoubleDouble::ZERO,
        impacts: 0,
        strobe: DoubleDouble::new(R::INFINITY),
    };
}

/// Impacts on one wall in a row, some of which may turn out not to be listed: numbers in the window,
/// from 1, and approach speeds.
#[derive(Debug, Clone, Default)]
struct Streak<R = f64> {
    wall: Option<Wall>,
    impacts: Vec<(u64, R)>,
}

impl<R: Real> Steady<R> {
    /// Measures what is wanted in a window.
    pub fn new(window: Window<R>, wanted: SteadyWanted) -> Self {
        Self { window, wanted, ..Self::default() }
    }

    /// What was measured; complete once the run has ended.
    pub fn values(&self) -> &SteadyValues<R> {
        &self.values
    }

    /// The strobes of the window: all if wanted, else the last few.
    pub fn strobes(&self) -> impl Iterator<Item = &Strobe<R>> {
        self.strobes.iter()
    }

    /// The numbers that every span changes.
    pub(crate) fn kept(&self) -> Kept<R> {
        let strobes = self.wanted.regime || self.wanted.strobes;
        let next = self.window.instant(self.next.max(self.first)).filter(|_| strobes);
        Kept {
            from: self.window.from,
            largest: self.largest,
            acceleration: self.acceleration,
            square: self.square,
            impacts: self.impacts,
            strobe: next.unwrap_or(DoubleDouble::new(R::INFINITY)),
        }
    }

    /// Takes them back; of the impacts on the wall that is being hit none is low.
    pub(crate) fn put_back(&mut self, kept: Kept<R>, wall: Option<Wall>) {
        let Kept { largest, acceleration, square, impacts, .. } = kept;
        self.streak = Streak { wall, impacts: Vec::new() };
        *self = Self { largest, acceleration, square, impacts, ..std::mem::take(self) };
    }

    /// What counts in a part of a span.
    fn part<M: Motion<Real = R>>(&mut self, span: &Span<'_, M>, h: [R; 2]) {
        let wanted = self.wanted;
        let whole = h == [R::ZERO, span.length];
        let arcs = span.motion.arcs(span.end).filter(|_| whole);
        if wanted.amplitude || wanted.regime {
            self.largest = largest_displacement(span, arcs.as_ref(), h, self.largest);
        }
        if wanted.acceleration {
            self.accelerations(span, arcs.as_ref(), h);
        }
        if wanted.rms {
            self.square = self.square.plus(span.motion.square(h));
        }
    }

    /// The largest accelerations: those that cannot exceed what was seen are not looked at.
    fn accelerations<M: Motion<Real = R>>(
        &mut self,
        span: &Span<'_, M>,
        arcs: Option<&Arcs<R>>,
        h: [R; 2],
    ) {
        let turns = || span.motion.acceleration_turns(span.length, span.end);
        let known = arcs.and_then(|arcs| {
            largest_known(&arcs.acceleration, self.acceleration, span.length, turns)
        });
        if let (Some(most), false) = (known, self.base_moves) {
            self.acceleration = most;
            return;
        }
        let Some(rows) = span.motion.rows() else { return };
        let t = h.map(|h| h / rows.step);
        self.acceleration = largest(&rows.acceleration[..=rows.order], t, self.acceleration);
        if self.base_moves {
            self.base = largest(&rows.base[..=rows.order], t, self.base);
        }
    }

    /// The amplitude of the cycle under way.
    fn until<M: Motion<Real = R>>(&mut self, span: &Span<'_, M>, h: [R; 2]) {
        if self.wanted.strobes && h[0] < h[1] {
            self.current = largest_displacement(span, None, h, self.current);
        }
    }

    fn strobe<M: Motion<Real = R>>(&mut self, motion: &M, h: R, time: R) {
        let (primary, gap) = motion.place(h);
        self.strobes.push_back(Strobe {
            cycle: self.next,
            time,
            displacement: primary.x,
            velocity: primary.v,
            gap_displacement: gap.y,
            gap_velocity: gap.w,
            amplitude: self.current.max(primary.x.abs()),
            impacts: self.impacts,
        });
        if !self.wanted.strobes && self.strobes.len() > RETURNS_KEPT {
            self.strobes.pop_front();
        }
        self.current = R::ZERO;
    }
}

/// The largest |x| in a part of a span, or `least` if that is larger; `arcs` are of the whole span.
fn largest_displacement<R: Real, M: Motion<Real = R>>(
    span: &Span<'_, M>,
    arcs: Option<&Arcs<R>>,
    h: [R; 2],
    least: R,
) -> R {
    let turns = || span.motion.turns(span.length, span.end);
    let known = |arcs: &Arcs<R>| largest_known(&arcs.displacement, least, span.length, turns);
    if let Some(most) = arcs.and_then(known) {
        return most;
    }
    let Some(rows) = span.motion.rows() else { return least };
    largest(&rows.x[..=rows.order], h.map(|h| h / rows.step), least)
}

/// The largest size of a function, or `least` if that is larger, where its ends tell, or where it turns round once.
fn largest_known<R: Real>(
    arc: &Arc<R>,
    least: R,
    length: R,
    turns: impl Fn() -> Turns<R>,
) -> Option<R> {
    if arc.is_below(least, length) {
        return Some(least);
    }
    let [a, b] = arc.values.map(R::abs);
    let ends = least.max(a).max(b);
    if arc.is_monotone(length) {
        return Some(ends);
    }
    match turns() {
        Turns::Once(_, value) => Some(ends.max(value.abs())),
        _ => None,
    }
}

/// A number of cycles that is whole but for rounding.
fn whole<R: Real>(cycles: R) -> R {
    let near = cycles.round();
    if (cycles - near).abs() <= near * (16.0 * f64::EPSILON) { near } else { cycles }
}

impl<R: Real, S: System<Real = R>> Observer<S> for Steady<R> {
    fn start(&mut self, system: &S, from: &Instant<S::State, R>, duration: R) {
        let base_moves = system.moves_base();
        let window = Window { from: self.window.from.max(from.time.value), ..self.window };
        *self = Self { duration, base_moves, ..Self::new(window, self.wanted) };
        self.first = if self.wanted.strobes { 0 } else { self.window.last_kept(duration) };
    }

    fn span<M: Motion<Real = R, State = S::State>>(&mut self, _system: &S, span: &Span<'_, M>) {
        if !self.wanted.any() {
            return;
        }
        let begin = (-span.start.minus(self.window.from)).max(0.0);
        if begin < span.length {
            self.part(span, [begin, span.length]);
        }
        if !(self.wanted.regime || self.wanted.strobes) {
            return;
        }
        let mut h = begin;
        while let Some(instant) = self.window.instant(self.next) {
            let at = (instant - span.start).value;
            let beyond = (instant.value - self.duration) / self.duration;
            let last = beyond.abs() <= SLACK && span_ends(&span.start, span.length, self.duration);
            // At an impact the state after it counts.
            if at >= span.length && !last {
                break;
            }
            let at = at.clamp(0.0, span.length);
            // The window may begin at a strobe, but for rounding.
            if instant.value >= self.window.from * (R::ONE - SLACK) {
                self.until(span, [h, at]);
                h = h.max(at);
                if self.next >= self.first {
                    self.strobe(span.motion, at, instant.value.max(0.0));
                }
            }
            self.next += 1;
        }
        self.until(span, [h, span.length]);
    }

    fn impact(&mut self, _system: &S, impact: &Impact<R>) {
        if impact.time < self.window.from {
            return;
        }
        self.impacts += 1;
        if self.streak.wall != Some(impact.wall) {
            self.streak = Streak { wall: Some(impact.wall), impacts: Vec::new() };
        }
        self.streak.impacts.push((self.impacts, impact.approach_speed()));
    }

    fn unlist(&mut self, _first: u64, floor: R) {
        // The last first: the numbers of those before stay as they are.
        for (number, speed) in std::mem::take(&mut self.streak.impacts).into_iter().rev() {
            if speed <= floor {
                self.impacts -= 1;
                let counts_it = |strobe: &&mut Strobe<R>| strobe.impacts >= number;
                self.strobes.iter_mut().rev().take_while(counts_it).for_each(|it| it.impacts -= 1);
            }
        }
    }

    fn end(&mut self, _system: &S, tally: &Tally<S::State, R>) {
        let length = self.duration - self.window.from;
        if tally.outcome != Outcome::Finished || length <= 0.0 || !self.wanted.any() {
            return;
        }
        let Self { wanted, window, .. } = *self;
        let cycle = window.cycle;
        self.values = SteadyValues {
            amplitude_max: wanted.amplitude.then_some(self.largest),
            amplitude_rms: wanted.rms.then(|| (self.square.value / length).sqrt()),
            acceleration_max: wanted.acceleration.then_some(self.acceleration),
            base_max: wanted.acceleration.then_some(self.base),
            impacts_per_cycle: cycle.filter(|_| wanted.impacts).map(|harmonic| {
                let cycles = whole(harmonic.frequency * length / std::f64::consts::TAU);
                R::from(self.impacts as f64) / cycles
            }),
            regime: cycle.filter(|_| wanted.regime).and_then(|harmonic| {
                regime(&self.strobes, self.impacts, self.largest, harmonic.frequency)
            }),
        };
    }
}
