//! Damping measures of a decay, each under its own name.
//!
//! None is *the* damping ratio. All are taken from the exact motion during the run: no samples, no envelope
//! fits to sampled data. Reference amplitude A₀ = |x(0)|, or the first peak when x(0) = 0.

use crate::absorber::{Absorber, Point};
use crate::engine::observe::{Contact, Each, Observer, Span};
use crate::engine::simulate::{Instant, Outcome, Tally};
use crate::host::Excitation;
use crate::measures::peaks::{HalfCycles, Peak, monotone};
use crate::measures::settling::{LEVELS, LastCrossing};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::Motion;

pub(crate) use decay::{Sinusoids, Stretch, Stretches, height, in_motion, keeps, looks};
pub use fit::FIT_FLOOR;
pub(crate) use fit::Fit;
pub(crate) use ledger::Ledger;

pub mod bends;
mod decay;
pub mod extremes;
mod fit;
pub(crate) mod forced;
mod ledger;
pub(crate) mod log;
pub mod near_wall;
pub mod pass;
pub mod peaks;
pub mod propagation;
pub mod sample;
mod settling;
pub mod steady;
pub mod summary;

/// Relative distance at or below which two instants count as the same, in parts of their size.
const CLOSE: f64 = 8.0 * f64::EPSILON;
/// Numbers of cycles of the logarithmic decrements.
const CYCLES: [u64; 3] = [1, 3, 10];

/// Which groups of measures to compute.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wanted {
    /// Logarithmic decrements and the least-squares fit.
    pub peaks: bool,
    /// Settling times.
    pub settling: bool,
    /// Residual amplitude.
    pub residual: bool,
    /// Losses in the dampers of structure and pivot, and work of the force: integrals along all motions.
    pub ledger: bool,
    /// The energy lost in the first period.
    pub first_period: bool,
    /// The list of all peaks.
    pub envelope: bool,
}

impl Wanted {
    /// All groups of measures; not the list of peaks.
    pub const ALL: Wanted = Wanted {
        peaks: true,
        settling: true,
        residual: true,
        ledger: true,
        first_period: true,
        envelope: false,
    };

    /// No group.
    pub const NONE: Wanted = Wanted {
        peaks: false,
        settling: false,
        residual: false,
        ledger: false,
        first_period: false,
        envelope: false,
    };

    /// True if the peaks of a decay, or a measure of its displacement, are wanted.
    pub(crate) fn decay(self) -> bool {
        self.peaks || self.settling || self.residual || self.envelope
    }
}

/// The measures of a run, times in 1/ωn and energies per primary mass in ωn² × length²; `None` where
/// the run does not define one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MeasureValues<R = f64> {
    /// δ/√(4π² + δ²), δ = ln(a₀/a₂).
    pub damping_ratio_1: Option<R>,
    /// δ/√(4π² + δ²), δ = ln(a₀/a₆)/3.
    pub damping_ratio_3: Option<R>,
    /// δ/√(4π² + δ²), δ = ln(a₀/a₂₀)/10.
    pub damping_ratio_10: Option<R>,
    /// −slope of the least-squares line of ln a_k over ωn t_k, down to 5 % of A₀; at least 3 peaks.
    pub damping_ratio_fit: Option<R>,
    /// (E(0) − E(2π))/(4π E(0)), E(0) after the impulses of time zero; null if one follows within
    /// the period.
    pub damping_ratio_energy: Option<R>,
    /// Last instant at which |x| = 0.10 A₀; null while |x| exceeds it in the last half period.
    pub settling_time_10: Option<R>,
    /// Last instant at which |x| = 0.05 A₀.
    pub settling_time_5: Option<R>,
    /// Last instant at which |x| = 0.02 A₀.
    pub settling_time_2: Option<R>,
    /// Largest |x| over the last period over A₀. Like all measures above, null under a lasting force.
    pub residual_amplitude: Option<R>,
    /// E(0), before any impulse.
    pub energy_initial: R,
    /// Σ ∫ 2ζ ẋ² dt.
    pub energy_viscous: R,
    /// Energy lost by the damping of a pendulum's pivot or by dashpots in gaps, an integral; else 0.
    pub energy_pivot: R,
    /// Energy lost in friction in the gap, μ R times the way slid and that of summed chatters; 0 without friction.
    pub energy_friction: R,
    /// E at the end.
    pub energy_final: R,
    /// Work done by force, base motion and impulses; 0 in free decay.
    pub energy_work: R,
    /// Initial + work − impacts − viscous − pivot − friction − final.
    pub energy_residual: R,
}

/// An observer that computes the measures of a run.
#[derive(Debug, Clone)]
pub struct Measures<S: Absorber> {
    pub(crate) wanted: Wanted,
    pub(crate) values: MeasureValues<S::Real>,
    pub(crate) duration: S::Real,
    /// The instant at which the run has begun.
    begin: S::Real,
    pub(crate) reference: Reference<S::Real>,
    /// Energy at time zero, after the impulses of that instant.
    pub(crate) energy_begin: S::Real,
    pub(crate) moving: bool,
    pub(crate) half_cycles: HalfCycles<S::Real>,
    /// The peaks so far, if they are to be listed.
    envelope: Vec<Peak<S::Real>>,
    pub(crate) first_peak: S::Real,
    pub(crate) decrements: [Option<S::Real>; 3],
    pub(crate) fit: Fit<S::Real>,
    pub(crate) settling: [LastCrossing<S>; 3],
    pub(crate) last_period: S::Real,
    pub(crate) last_half_period: S::Real,
    pub(crate) ledger: Ledger<S::Real>,
    /// True if a lasting force drives the system.
    driven: bool,
    /// The end of the last span.
    reached: S::Real,
    /// The log of a decay from which its measures are computed: where the structure moves in closed form, and
    /// where it does not.
    pub(crate) decay: Option<Box<Sinusoids>>,
    pub(crate) stretches: Option<Stretches<S>>,
}

/// A₀, which grows during the first half cycle if x(0) = 0; `settled` once it is final.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reference<R = f64> {
    pub amplitude: R,
    pub settled: bool,
}

impl<R: Real, S: Absorber<Real = R>> Measures<S> {
    /// Computes the wanted groups of measures.
    pub fn new(wanted: Wanted) -> Self {
        Self {
            wanted,
            values: MeasureValues::default(),
            duration: R::ZERO,
            begin: R::ZERO,
            reference: Reference { amplitude: R::ZERO, settled: false },
            energy_begin: R::ZERO,
            moving: false,
            half_cycles: HalfCycles::default(),
            envelope: Vec::new(),
            first_peak: R::ZERO,
            decrements: [None; 3],
            fit: Fit::default(),
            settling: LEVELS.map(|share| LastCrossing::new(R::from(share))),
            last_period: R::ZERO,
            last_half_period: R::ZERO,
            ledger: Ledger::default(),
            driven: false,
            reached: R::ZERO,
            decay: None,
            stretches: None,
        }
    }

    /// The measures; complete once the run has ended.
    pub fn values(&self) -> &MeasureValues<R> {
        &self.values
    }

    /// All peaks of x, if they were wanted; complete once the run has ended.
    pub fn envelope(&self) -> &[Peak<R>] {
        &self.envelope
    }

    /// Takes the list of peaks.
    pub(crate) fn take_envelope(&mut self) -> Option<Vec<Peak<R>>> {
        self.wanted.envelope.then(|| std::mem::take(&mut self.envelope))
    }

    /// Adds energy lost and work of many flights, each in double-double.
    pub(crate) fn add(&mut self, lost: DoubleDouble, work: DoubleDouble) {
        self.moving = true;
        let Ledger { viscous, work: worked, .. } = &mut self.ledger;
        *viscous = viscous.plus_parts(lost.value.into(), lost.rest.into());
        *worked = worked.plus_parts(work.value.into(), work.rest.into());
    }

    /// True as long as peaks after the first `ended` ones change a measure.
    pub(crate) fn listens(&self, ended: u64) -> bool {
        self.wanted.envelope || (self.wanted.peaks && (!self.fit.closed || ended <= 2 * CYCLES[2]))
    }

    pub(crate) fn peak(&mut self, peak: &Peak<R>, index: u64) {
        let amplitude = peak.displacement.abs();
        if index == 0 {
            self.first_peak = amplitude;
            self.reference.settled = true;
        }
        if !self.wanted.peaks {
            return;
        }
        for (decrement, cycles) in self.decrements.iter_mut().zip(CYCLES) {
            if index == 2 * cycles {
                let delta = (self.first_peak / amplitude).ln() / cycles as f64;
                *decrement = Some(delta / (R::TURN.value * R::TURN.value + delta * delta).sqrt());
            }
        }
        self.fit.take(peak.time, amplitude / self.reference.amplitude);
    }

    /// Takes the energy after one period.
    pub(crate) fn one_period(&mut self, energy: R) {
        let initial = self.energy_begin;
        if initial > 0.0 {
            self.values.damping_ratio_energy =
                Some((initial - energy) / (R::TURN.value * 2.0 * initial));
        }
    }

    /// Takes the end of a monotonic stretch of x.
    fn reach(&mut self, time: R, x: R) {
        // Before the amplitude is used: the end of half cycle 0 makes A₀ final.
        if let Some(peak) = self.half_cycles.reach(time, x) {
            self.peak(&peak, self.half_cycles.ended - 1);
            if self.wanted.envelope {
                self.envelope.push(peak);
            }
        }
        if !self.reference.settled && x.abs() > self.reference.amplitude {
            self.reference.amplitude = x.abs();
        }
    }

    /// Adds energies lost and work done in a span.
    fn lose<M: Motion<Real = R, State = S::State>>(&mut self, span: &Span<'_, M>) {
        if self.wanted.ledger {
            self.ledger = self.ledger.plus(&span.motion.losses(span.length));
        }
    }

    /// Lists the peaks in a span of a run under a lasting force, where no measure needs them.
    pub(crate) fn list_peaks<M>(&mut self, system: &S, span: &Span<'_, M>)
    where
        M: Motion<Real = R, State = S::State>,
    {
        if self.wanted.envelope && system.excitation().is_driven() {
            monotone::<_, S, M>(span, |stretch| {
                let time = span.start.plus(stretch.h[1]).value;
                self.envelope.extend(self.half_cycles.reach(time, stretch.x[1]));
            });
        }
    }
}

impl<R: Real, S: Absorber<Real = R>> Observer<S> for Measures<S> {
    fn start(&mut self, system: &S, from: &Instant<S::State, R>, duration: R) {
        let Instant { time, state } = from;
        let (sinusoids, stretches) = (self.decay.take(), self.stretches.take());
        *self = Self::new(self.wanted);
        let Point { x, v } = system.primary(state);
        self.log_decay(system, sinusoids, [x, v].map(Real::double));
        let looks =
            self.decay.is_none() && !system.excitation().is_driven() && looks(self.wanted, 0.0);
        self.stretches = looks.then(|| Stretches::new(stretches));
        (self.begin, self.duration, self.driven) =
            (time.value, duration, system.excitation().is_driven());
        self.reference = Reference { amplitude: x.abs(), settled: x != 0.0 };
        self.half_cycles = HalfCycles::start(time.value, x);
        self.values.energy_initial = system.energy(state);
        self.energy_begin = self.values.energy_initial;
    }

    fn span<M: Motion<Real = R, State = S::State>>(&mut self, system: &S, span: &Span<'_, M>) {
        self.moving = true;
        self.reached = span.start.plus(span.length).value;
        if self.decay.is_some() {
            return self.log_span(system, span);
        }
        self.list_peaks(system, span);
        self.log_stretches(system, span);
        self.lose(span);
    }

    /// Under a force only energies are measured, which do not depend on whether peaks are listed.
    fn coast<M>(&mut self, system: &S, whole: &Span<'_, M>, each: Each<'_, M>)
    where
        M: Motion<Real = R, State = S::State>,
    {
        if self.decay.is_some() {
            self.span(system, whole);
        } else if self.driven && !S::LEAPS {
            self.moving = true;
            if self.wanted.envelope {
                each(&mut |span| self.list_peaks(system, span));
            }
            self.lose(whole);
        } else if self.stretches.is_none() && !self.wanted.ledger {
            // Nothing within is looked at.
            self.span(system, whole);
        } else {
            each(&mut |span| self.span(system, span));
        }
    }

    fn contact(&mut self, _system: &S, _contact: &Contact<'_, S::State, R>) {
        self.log_next();
    }

    fn stick(&mut self, _system: &S, _from: &Instant<S::State, R>) {
        self.log_next();
    }

    fn release(&mut self, _system: &S, _from: &Instant<S::State, R>) {
        self.log_next();
    }

    fn impulse(&mut self, system: &S, state: &S::State, work: R) {
        self.log_next();
        self.ledger.work = self.ledger.work.plus(work);
        if !self.moving {
            self.energy_begin = system.energy(state);
        } else if self.reached < R::TURN.value * (R::ONE - CLOSE) {
            // After an impulse within the period the energy lost in it is not defined.
            self.energy_begin = R::ZERO;
        }
    }

    fn end(&mut self, system: &S, tally: &Tally<S::State, R>) {
        let driven = system.excitation().is_driven();
        self.end_log(system, tally.clock, &tally.state);
        self.take_stretches(system);
        if self.half_cycles.ended == 0 {
            let only = self.half_cycles.current;
            self.peak(&only, 0);
            if self.wanted.envelope {
                self.envelope.push(only);
            }
        }
        let amplitude = self.reference.amplitude;
        let whole = tally.outcome == Outcome::Finished && amplitude > 0.0;
        let values = &mut self.values;
        if driven {
            // Under a force nothing decays by itself: these numbers would measure the force.
            values.damping_ratio_energy = None;
        } else {
            [values.damping_ratio_1, values.damping_ratio_3, values.damping_ratio_10] =
                self.decrements;
            values.damping_ratio_fit = self.fit.slope().map(|slope| -slope);
        }
        if whole && self.wanted.settling && !driven {
            let late = self.last_half_period;
            [values.settling_time_10, values.settling_time_5, values.settling_time_2] =
                std::array::from_fn(|i| self.settling[i].time(system, late, amplitude));
        }
        if whole
            && self.wanted.residual
            && self.duration - self.begin >= R::TURN.value * (R::ONE - CLOSE)
            && !driven
        {
            values.residual_amplitude = Some(self.last_period / amplitude);
        }
        values.energy_viscous = self.ledger.viscous.value;
        values.energy_pivot = self.ledger.pivot.value;
        values.energy_work = self.ledger.work.value;
        values.energy_friction = tally.friction.energy.value;
        values.energy_final = system.energy(&tally.state);
        values.energy_residual = DoubleDouble::new(values.energy_initial)
            .plus(-tally.energy_impacts)
            .plus(-values.energy_viscous)
            .plus(-values.energy_pivot)
            .plus(-values.energy_friction)
            .plus(values.energy_work)
            .plus(-values.energy_final)
            .value;
    }
}

/// The instant `before_end` before the end of a run, a little earlier because of rounding.
pub(crate) fn late<R: Real>(duration: R, before_end: R) -> R {
    (duration - before_end) - duration * CLOSE
}
