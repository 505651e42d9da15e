//! A structure under force and base motion, without and with its absorber stuck to it.

use std::any::TypeId;
use std::sync::{Arc, OnceLock};

use super::{Driven, Forces, Moment, Pieces, Place, Source, Weight};
use crate::force::{Drive, Force, Pushes, Smooth};
use crate::host::sinusoid::MOST_DAMPED;
use crate::host::{Excitation, Host, Sinusoidal, Steps};
use crate::number::clock::Clock;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

/// A structure under force and base motion.
#[derive(Debug, Clone)]
pub struct DrivenHost<R: Real = f64> {
    damping_ratio: R,
    mass_ratio: R,
    forces: Forces<R>,
    free: Driven<Forces<R>>,
    /// The structure of mass 1 + μ; made when the absorber first sticks.
    loaded: OnceLock<Box<Driven<Forces<R>>>>,
    /// Its motion from point to point of a record; `None` under any other force, with gravity along the motion, and
    /// in numbers without [`Real::FAST_PATHS`].
    pieces: OnceLock<Option<Arc<Pieces<R>>>>,
    /// Its motion over whole steps between impulses; `None` if another force acts, or gravity along the motion.
    steps: OnceLock<Option<Arc<Steps<R>>>>,
}

impl<R: Real> DrivenHost<R> {
    /// A structure of damping ratio ζ under a force and gravity G along its motion, for an absorber of mass
    /// ratio μ.
    pub(crate) fn new(damping_ratio: R, mass_ratio: R, force: Force<R>, gravity: R) -> Self {
        let forces = Forces::new(force, Weight::new(gravity, mass_ratio));
        let free = Driven::new(R::ONE, damping_ratio, &forces);
        let (loaded, pieces, steps) = (OnceLock::new(), OnceLock::new(), OnceLock::new());
        Self { damping_ratio, mass_ratio, forces, free, loaded, pieces, steps }
    }

    fn shared_steps(&self) -> &Option<Arc<Steps<R>>> {
        let made = || {
            let kicked = self.forces.weight().is_none() && !self.forces.force.lasts();
            let has = kicked && R::FAST_PATHS && self.damping_ratio <= MOST_DAMPED;
            let ramped = self.free.source.ramped().filter(|_| has)?;
            Some(Arc::new(Steps::new(ramped.oscillator())))
        };
        self.steps.get_or_init(made)
    }

    /// The state of the drive at the same instant of the same force, with the gravity of this host.
    pub(crate) fn taken_over(&self, phase: &Moment<R>) -> Moment<R> {
        self.forces.moment(phase.time, phase.kicks, &phase.smooth)
    }

    /// The pieces of the record that is its only force. Structures of one damping ratio under one record share them.
    fn made(&self) -> Option<Arc<Pieces<R>>> {
        let level = R::FAST_PATHS && self.forces.weight().is_none();
        let record = self.forces.force.record_alone().filter(|_| level)?;
        let make = || Pieces::new(self.damping_ratio, record, self.free.reach);
        // Equal numbers may have different derivatives.
        if TypeId::of::<R>() != TypeId::of::<f64>() {
            return Some(Arc::new(make()));
        }
        let fits = |pieces: &Pieces<R>| pieces.fits(self.damping_ratio, record);
        Some(record.history.kept(fits, make))
    }
}

impl<R: Real> Excitation for DrivenHost<R> {
    type Real = R;
    type Phase = Moment<R>;

    fn force(&self) -> Option<&Force<R>> {
        Some(&self.forces.force)
    }

    fn smooth_for(&self, phase: &Moment<R>) -> R {
        phase.smooth_for(R::INFINITY)
    }

    fn due(&self, phase: &Moment<R>) -> Option<R> {
        self.forces.force.due(phase.time, phase.kicks)
    }

    fn after_impulse(&self, phase: &Moment<R>) -> Moment<R> {
        self.forces.moment(phase.time, phase.kicks + 1, &phase.smooth)
    }
}

impl<R: Real> Host for DrivenHost<R> {
    type Structure = Driven<Forces<R>>;

    fn damping_ratio(&self) -> R {
        self.damping_ratio
    }

    fn carrying(&self, mass_ratio: R) -> Self {
        Self::new(self.damping_ratio, mass_ratio, (*self.forces.force).clone(), R::ZERO)
    }

    #[inline(always)]
    fn free(&self) -> &Driven<Forces<R>> {
        &self.free
    }

    fn loaded(&self) -> &Driven<Forces<R>> {
        let mass = R::ONE + self.mass_ratio;
        let loaded = || Driven::new(mass, self.damping_ratio, &self.forces.loaded());
        self.loaded.get_or_init(|| Box::new(loaded()))
    }

    fn begin_at(&self, time: Clock<R>) -> Moment<R> {
        let (time, kicks) = self.forces.force.begin(time);
        self.forces.moment(time, kicks, &Smooth::ALL)
    }

    fn balanced(&self, phase: &Moment<R>, v: DoubleDouble<R>) -> DoubleDouble<R> {
        let balanced = phase.pushes.primary.value - v.times(self.free.equation.damping);
        match self.forces.weight() {
            None => balanced,
            Some(Weight { gravity, lift }) => (balanced + lift).plus(gravity),
        }
    }

    fn leaning(&self, phase: &Moment<R>) -> [R; 6] {
        let kicked =
            self.forces.force.impulses().next().map_or(R::ZERO, |impulse| impulse.velocity);
        let Pushes { primary: f, base: g } = phase.pushes;
        let [rate, second] = [f.rate.value, f.second.value];
        [rate, second, kicked, g.value.value, g.rate.value, g.second.value]
    }

    fn share(&self, like: &Self) {
        self.free.source.share(&like.free.source);
        let steps = like.shared_steps().clone();
        self.steps.get_or_init(|| steps);
    }

    fn steps(&self) -> Option<&Steps<R>> {
        self.shared_steps().as_deref()
    }

    fn waited(&self, phase: &Moment<R>, time: Clock<R>) -> Moment<R> {
        let later = phase.waited(time);
        if self.forces.force.lasts() { self.taken_over(&later) } else { later }
    }

    fn time(&self, phase: &Moment<R>) -> Option<Clock<R>> {
        Some(phase.time)
    }

    fn pieces(&self) -> Option<&Pieces<R>> {
        self.pieces.get_or_init(|| self.made()).as_deref()
    }

    fn place(&self, phase: &Moment<R>) -> Option<Place> {
        self.pieces()?.place(phase.time, phase.smooth.passed)
    }

    fn at(&self, phase: &Moment<R>, place: Place) -> Moment<R> {
        let Some(pieces) = self.pieces() else { return *phase };
        let time = pieces.instant(place);
        self.forces.moment(
            time,
            phase.kicks,
            &Smooth { passed: pieces.passed(place), ..phase.smooth },
        )
    }

    #[inline(always)]
    fn drive(&self, phase: &Moment<R>, h: R) -> Option<Drive<R>> {
        self.is_driven().then(|| self.forces.drive(phase, h))
    }

    #[inline(always)]
    fn drive_ahead<const LENGTH: usize>(&self, phase: &Moment<R>) -> Option<Drive<R, LENGTH>> {
        self.is_driven().then(|| self.forces.near(phase).ahead())
    }

    #[inline(always)]
    fn drive_now(&self, phase: &Moment<R>) -> Option<Drive<DoubleDouble<R>, 2>> {
        self.is_driven().then(|| phase.pushes.now())
    }

    fn precise_drive(&self, phase: &Moment<R>, h: R) -> Option<Drive<DoubleDouble<R>>> {
        self.is_driven().then(|| self.forces.precise(phase.time, h))
    }

    fn sinusoidal(&self) -> Option<Sinusoidal> {
        let decays = !self.forces.force.lasts();
        let numbers = [self.damping_ratio, self.mass_ratio, self.gravity()];
        Sinusoidal::of(numbers).filter(|_| decays)
    }

    fn gravity(&self) -> R {
        self.forces.weight().map_or(R::ZERO, |weight| weight.gravity)
    }
}
