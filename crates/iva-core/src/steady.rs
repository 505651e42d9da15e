//! Steady states under force: amplitudes after a transient, the state once a cycle of the force, and
//! whether it comes back.
//!
//! All is read off the series of the motion as it passes: extrema by enclosure, mean squares as
//! integrals, strobes at their instants. Nothing is sampled.

use std::collections::VecDeque;

use crate::compensated::Sum;
use crate::flight::{Motion, Rows};
use crate::force::{Harmonic, WHOLE_TURN};
use crate::impact::Impact;
use crate::observe::{Observer, Span};
use crate::polynomial::{largest, square_integral};
use crate::real::{Real, ZERO};
use crate::sample::{SLACK, span_ends};
use crate::simulate::{Outcome, Tally};
use crate::system::{System, Wall};
use crate::taylor::with_order;

pub use bare::amplitude_without_absorber;
pub use regime::Regime;

use regime::{RETURNS_KEPT, regime};

mod bare;
mod regime;

/// What a steady state is measured by.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Window {
    /// Instant from which on it counts: the end of the transient.
    pub from: Real,
    /// The force whose cycles count; `None` if none of the forces has any.
    pub cycle: Option<Harmonic>,
}

impl Window {
    /// The instants Ω t + phase = 2π k, from the first at or after time zero on.
    fn instant(&self, index: u64) -> Option<Sum> {
        let Harmonic { frequency, phase, .. } = self.cycle?;
        let first = (phase / WHOLE_TURN.value).ceil();
        let turns = WHOLE_TURN.times(first + index as f64);
        Some(turns.plus(-phase).over(frequency))
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
pub struct Strobe {
    /// Number of the instant, 0 for the first at or after time zero.
    pub cycle: u64,
    /// Instant, in 1/ωn.
    pub time: Real,
    /// Displacement of the primary.
    pub displacement: Real,
    /// Its velocity.
    pub velocity: Real,
    /// Absorber minus primary displacement.
    pub gap_displacement: Real,
    /// Absorber minus primary velocity.
    pub gap_velocity: Real,
    /// Largest |x| from the strobe before, or from the begin of the window, up to here.
    pub amplitude: Real,
    /// Listed impacts from the begin of the window up to here.
    pub impacts: u64,
}

/// The numbers of a steady state; `None` where the run does not define one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SteadyValues {
    /// Largest |x|.
    pub amplitude_max: Option<Real>,
    /// √ of the mean of x².
    pub amplitude_rms: Option<Real>,
    /// Largest |ẍ + a_g| between impacts.
    pub acceleration_max: Option<Real>,
    /// Largest |a_g|.
    pub base_max: Option<Real>,
    /// Listed impacts over cycles of the force.
    pub impacts_per_cycle: Option<Real>,
    /// What comes back, and how often.
    pub regime: Option<Regime>,
}

/// Watches a driven run.
#[derive(Debug, Clone, Default)]
pub struct Steady {
    window: Window,
    wanted: SteadyWanted,
    duration: Real,
    values: SteadyValues,
    strobes: VecDeque<Strobe>,
    next: u64,
    /// Largest |x|: of the cycle under way, and of those before.
    current: Real,
    largest: Real,
    acceleration: Real,
    base: Real,
    square: Sum,
    impacts: u64,
    streak: Streak,
}

/// Impacts on one wall in a row, some of which may turn out not to be listed: numbers in the window,
/// from 1, and approach speeds.
#[derive(Debug, Clone, Default)]
struct Streak {
    wall: Option<Wall>,
    impacts: Vec<(u64, Real)>,
}

impl Steady {
    /// Measures what is wanted in a window.
    pub fn new(window: Window, wanted: SteadyWanted) -> Self {
        Self { window, wanted, ..Self::default() }
    }

    /// What was measured; complete once the run has ended.
    pub fn values(&self) -> &SteadyValues {
        &self.values
    }

    /// The strobes of the window: all if wanted, else the last few.
    pub fn strobes(&self) -> impl Iterator<Item = &Strobe> {
        self.strobes.iter()
    }

    /// A stretch of a span between two strobes.
    fn stretch(&mut self, rows: &Rows<'_>, h: [Real; 2]) {
        let t = h.map(|h| h / rows.step);
        if self.wanted.amplitude || self.wanted.regime || self.wanted.strobes {
            self.current = largest(rows.x, t, self.current);
        }
        if self.wanted.acceleration {
            self.acceleration = largest(rows.acceleration, t, self.acceleration);
            self.base = largest(rows.base, t, self.base);
        }
        if self.wanted.rms {
            let integral =
                |t: Real| with_order!(rows.x.len() - 1, N => square_integral::<N>(rows.x, t));
            let before = if t[0] == 0.0 { ZERO } else { integral(t[0]) };
            self.square = self.square.plus((integral(t[1]) - before) * rows.step);
        }
    }

    fn strobe<M: Motion>(&mut self, motion: &M, h: Real, time: Real) {
        if self.wanted.regime || self.wanted.strobes {
            let (primary, gap) = (motion.primary(h), motion.gap(h));
            self.strobes.push_back(Strobe {
                cycle: self.next,
                time,
                displacement: primary.value,
                velocity: primary.rate,
                gap_displacement: gap.y,
                gap_velocity: gap.w,
                amplitude: self.current.max(primary.value.abs()),
                impacts: self.impacts,
            });
            if !self.wanted.strobes && self.strobes.len() > RETURNS_KEPT {
                self.strobes.pop_front();
            }
        }
        self.largest = self.largest.max(self.current);
        self.current = ZERO;
    }
}

/// A number of cycles that is whole but for rounding.
fn whole(cycles: Real) -> Real {
    let near = cycles.round();
    if (cycles - near).abs() <= 16.0 * f64::EPSILON * near { near } else { cycles }
}

impl<S: System> Observer<S> for Steady {
    fn start(&mut self, _system: &S, _state: &S::State, duration: Real) {
        *self = Self { duration, ..Self::new(self.window, self.wanted) };
    }

    fn span<M: Motion<State = S::State>>(&mut self, _system: &S, span: &Span<'_, M>) {
        let Some(rows) = span.motion.rows().filter(|_| self.wanted.any()) else { return };
        let begin = (-span.start.minus(self.window.from)).max(0.0);
        let mut h = begin;
        // Also where no strobe is wanted: what is wanted besides changes no bit of a number.
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
            if instant.value >= self.window.from * (1.0 - SLACK) {
                if at > h {
                    self.stretch(&rows, [h, at]);
                    h = at;
                }
                self.strobe(span.motion, at, instant.value.max(0.0));
            }
            self.next += 1;
        }
        if span.length > h {
            self.stretch(&rows, [h, span.length]);
        }
    }

    fn impact(&mut self, _system: &S, impact: &Impact) {
        if impact.time < self.window.from {
            return;
        }
        self.impacts += 1;
        if self.streak.wall != Some(impact.wall) {
            self.streak = Streak { wall: Some(impact.wall), impacts: Vec::new() };
        }
        self.streak.impacts.push((self.impacts, impact.approach_speed()));
    }

    fn unlist(&mut self, _first: u64, floor: Real) {
        // The last first: the numbers of those before stay as they are.
        for (number, speed) in std::mem::take(&mut self.streak.impacts).into_iter().rev() {
            if speed <= floor {
                self.impacts -= 1;
                let counts_it = |strobe: &&mut Strobe| strobe.impacts >= number;
                self.strobes.iter_mut().rev().take_while(counts_it).for_each(|it| it.impacts -= 1);
            }
        }
    }

    fn end(&mut self, _system: &S, tally: &Tally<S::State>) {
        let length = self.duration - self.window.from;
        if tally.outcome != Outcome::Finished || length <= 0.0 || !self.wanted.any() {
            return;
        }
        let Self { wanted, window, .. } = *self;
        self.largest = self.largest.max(self.current);
        let cycle = window.cycle;
        self.values = SteadyValues {
            amplitude_max: wanted.amplitude.then_some(self.largest),
            amplitude_rms: wanted.rms.then(|| (self.square.value / length).sqrt()),
            acceleration_max: wanted.acceleration.then_some(self.acceleration),
            base_max: wanted.acceleration.then_some(self.base),
            impacts_per_cycle: cycle.filter(|_| wanted.impacts).map(|harmonic| {
                let cycles = whole(harmonic.frequency * length / std::f64::consts::TAU);
                self.impacts as f64 / cycles
            }),
            regime: cycle.filter(|_| wanted.regime).and_then(|harmonic| {
                regime(&self.strobes, self.impacts, self.largest, harmonic.frequency)
            }),
        };
    }
}
