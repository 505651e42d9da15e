//! Steady states under force: amplitudes after a transient, strobes (the state once per cycle of the force),
//! and whether the motion is periodic.
//!
//! All are taken from the power series of the motion during the run: extrema by enclosure, mean squares as
//! integrals, strobes at their instants. Nothing is sampled.

use std::collections::VecDeque;

use crate::absorber::impact::Impact;
use crate::absorber::{Absorber, Wall};
use crate::engine::observe::{Contact, Observer, Span};
use crate::engine::simulate::{Instant, Outcome, Tally};
use crate::host::Excitation;
use crate::number::clock::SLACK;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::{Motion, Quantity};
use crate::segment::polynomial::largest;

pub(crate) use quiet::Quiet;
pub use regime::Regime;
pub use strobes::Strobe;
pub(crate) use strobes::Strobed;
pub use window::Window;

use regime::regime;
use strobes::Spanned;

mod quiet;
mod regime;
mod strobes;
mod window;

/// The groups of measures to compute.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SteadyWanted {
    /// Largest displacement.
    pub amplitude: bool,
    /// Root mean square of the displacement.
    pub rms: bool,
    /// Largest accelerations of primary and base.
    pub acceleration: bool,
    /// The kind of motion.
    pub regime: bool,
    /// Impacts per cycle of the force.
    pub impacts: bool,
    /// All strobes, not only the last few.
    pub strobes: bool,
}

impl SteadyWanted {
    /// All groups.
    pub const ALL: Self = Self {
        amplitude: true,
        rms: true,
        acceleration: true,
        regime: true,
        impacts: true,
        strobes: true,
    };

    /// A number that is different for each combination of groups.
    pub(crate) fn bits(self) -> u8 {
        let Self { amplitude, rms, acceleration, regime, impacts, strobes } = self;
        let each = [amplitude, rms, acceleration, regime, impacts, strobes];
        each.iter().fold(0, |bits, wanted| bits * 2 + u8::from(*wanted))
    }

    pub(crate) fn any(self) -> bool {
        self != Self::default()
    }
}

/// The measures of a steady state; `None` where the run does not define one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SteadyValues<R = f64> {
    /// Largest |x|.
    pub amplitude_max: Option<R>,
    /// Root mean square of x.
    pub amplitude_rms: Option<R>,
    /// Largest |ẍ + a_g| between impacts.
    pub acceleration_max: Option<R>,
    /// Largest |a_g|.
    pub base_max: Option<R>,
    /// Listed impacts per cycle of the force.
    pub impacts_per_cycle: Option<R>,
    /// The kind of motion.
    pub regime: Option<Regime>,
}

/// An observer that measures the steady state of a driven run.
#[derive(Debug, Clone, Default)]
pub struct Steady<R = f64> {
    window: Window<R>,
    wanted: SteadyWanted,
    duration: R,
    values: SteadyValues<R>,
    strobes: VecDeque<Strobe<R>>,
    /// Number of strobes at each instant, one for each absorber.
    absorbers: usize,
    /// Index of the next strobe to keep.
    next: u64,
    /// Instant of the next strobe to keep.
    instant: Option<DoubleDouble<R>>,
    /// Largest |x| of the current cycle, if strobes are wanted.
    current: R,
    /// Largest |x| of the window.
    largest: R,
    acceleration: R,
    base: R,
    square: DoubleDouble<R>,
    base_moves: bool,
    driven: bool,
    /// True if the largest |a_g| is known in closed form.
    base_known: bool,
    /// True if the window has begun.
    begun: bool,
    impacts: u64,
    /// The current streak of each absorber that has had an impact.
    streaks: Vec<Streak<R>>,
}

/// Consecutive impacts on one wall, some of which may turn out not to be listed: their numbers in the window,
/// from 1, and their approach speeds.
#[derive(Debug, Clone, Default)]
struct Streak<R = f64> {
    wall: Option<Wall>,
    impacts: Vec<(u64, R)>,
}

impl<R: Real> Steady<R> {
    /// An observer of the wanted measures in a window.
    pub fn new(window: Window<R>, wanted: SteadyWanted) -> Self {
        Self { window, wanted, ..Self::default() }
    }

    /// The measures; complete once the run has ended.
    pub fn values(&self) -> &SteadyValues<R> {
        &self.values
    }

    /// The begin of the window.
    pub(crate) fn begin(&self) -> R {
        self.window.from
    }

    /// The largest |x| and |ẍ + a_g| so far.
    pub(crate) fn largest(&self) -> [R; 2] {
        [self.largest, self.acceleration]
    }

    /// Sets the largest |x| and |ẍ + a_g| so far.
    pub(crate) fn set_largest(&mut self, [displacement, acceleration]: [R; 2]) {
        (self.largest, self.acceleration) = (displacement, acceleration);
    }

    /// Adds ∫x² of many flights.
    pub(crate) fn add_square(&mut self, square: DoubleDouble) {
        self.square = self.square.plus_parts(square.value.into(), square.rest.into());
    }

    /// Of the impacts of an absorber's current streak, those with an approach speed of at most `floor` are not listed.
    pub(crate) fn unlist_up_to(&mut self, absorber: u8, floor: R) {
        let Some(streak) = self.streaks.get_mut(usize::from(absorber)) else { return };
        // From the last impact back, so that the numbers of earlier impacts stay valid.
        for (number, speed) in std::mem::take(&mut streak.impacts).into_iter().rev() {
            if speed <= floor {
                self.impacts -= 1;
                let others = self.streaks.iter_mut().flat_map(|streak| &mut streak.impacts);
                others.filter(|other| other.0 > number).for_each(|other| other.0 -= 1);
                let counts_it = |strobe: &&mut Strobe<R>| strobe.impacts >= number;
                self.strobes.iter_mut().rev().take_while(counts_it).for_each(|it| it.impacts -= 1);
            }
        }
    }

    /// Counts an impact if it lies in the window.
    pub(crate) fn count(&mut self, time: R, (absorber, wall): (u8, Wall), approach_speed: R) {
        if time < self.window.from {
            return;
        }
        self.impacts += 1;
        let absorber = usize::from(absorber);
        if self.streaks.len() <= absorber {
            self.streaks.resize_with(absorber + 1, Streak::default);
        }
        let streak = &mut self.streaks[absorber];
        if streak.wall != Some(wall) {
            streak.wall = Some(wall);
            streak.impacts.clear();
        }
        streak.impacts.push((self.impacts, approach_speed));
    }

    /// Takes the measures of a part of a span.
    fn part<M: Motion<Real = R>>(&mut self, span: &Span<'_, M>, h: [R; 2]) {
        let wanted = self.wanted;
        if wanted.amplitude || wanted.regime {
            self.largest = largest_in(span, Quantity::Displacement, h, self.largest);
        }
        if wanted.acceleration {
            self.acceleration = largest_in(span, Quantity::Acceleration, h, self.acceleration);
        }
        let looks = wanted.acceleration && self.base_moves && !self.base_known;
        if let Some(rows) = looks.then(|| span.motion.rows()).flatten() {
            let t = h.map(|h| h / rows.step);
            self.base = largest(&rows.base[..=rows.order], t, self.base);
        }
        if wanted.rms {
            self.square = self.square.plus(span.motion.square(h));
        }
    }
}

/// The larger of `least` and the largest size of a quantity in a part of a span.
fn largest_in<R: Real, M: Motion<Real = R>>(
    span: &Span<'_, M>,
    of: Quantity,
    h: [R; 2],
    least: R,
) -> R {
    if h == [R::ZERO, span.length] {
        return span.motion.largest_of(of, least, span.length, span.end);
    }
    span.motion.largest_between(of, h, least)
}

/// A number of cycles, made an integer if it is one within rounding.
fn whole<R: Real>(cycles: R) -> R {
    let near = cycles.round();
    if (cycles - near).abs() <= near * (16.0 * f64::EPSILON) { near } else { cycles }
}

impl<R: Real, S: Absorber<Real = R>> Observer<S> for Steady<R> {
    fn start(&mut self, system: &S, from: &Instant<S::State, R>, duration: R) {
        let (base_moves, driven) =
            (system.excitation().moves_base(), system.excitation().is_driven());
        let window = Window { from: self.window.from.max(from.time.value), ..self.window };
        let force = system.excitation().force();
        let base = force.and_then(|force| force.largest_base([window.from, duration]));
        let (base, base_known) = (base.unwrap_or(R::ZERO), base.is_some());
        let begun = from.time.minus(window.from) >= 0.0;
        *self = Self {
            duration,
            base_moves,
            driven,
            base,
            base_known,
            begun,
            ..Self::new(window, self.wanted)
        };
        self.next = if self.wanted.strobes { 0 } else { self.window.last_kept(duration) };
        self.next = self.next.max(self.window.first());
        self.instant = self.window.instant(self.next);
        // The window may begin at a strobe, within rounding.
        let from = self.window.from * (R::ONE - SLACK);
        while self.instant.is_some_and(|instant| instant.value < from) {
            self.pass_strobe();
        }
    }

    fn looks_within(&self) -> bool {
        // Without a lasting force, and in leaps, the power series of a motion does not reach over several steps.
        let whole = !S::LEAPS && self.driven && self.begun && (self.base_known || !self.base_moves);
        self.wanted.any() && !(whole && self.next_strobe().is_none())
    }

    fn span<M: Motion<Real = R, State = S::State>>(&mut self, _system: &S, span: &Span<'_, M>) {
        if !self.wanted.any() {
            return;
        }
        self.begun = span.start.plus(span.length).minus(self.window.from) >= 0.0;
        let begin = (-span.start.minus(self.window.from)).max(0.0);
        if begin < span.length {
            self.part(span, [begin, span.length]);
        }
        self.take_strobes(span.start, [begin, span.length], &mut Spanned(span));
    }

    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State, R>) {
        if self.wanted.acceleration && contact.time >= self.window.from {
            self.acceleration = contact.hardest_shaking(system, self.acceleration);
        }
    }

    fn impact(&mut self, _system: &S, impact: &Impact<R>) {
        self.count(impact.time, (impact.absorber, impact.wall), impact.approach_speed());
    }

    fn unlist(&mut self, absorber: u8, _first: u64, floor: R) {
        self.unlist_up_to(absorber, floor);
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
                let (impacts, absorbers) = (self.impacts, self.absorbers);
                regime(&self.strobes, absorbers, impacts, self.largest, harmonic.frequency)
            }),
        };
    }
}
