//! The drive of a structure, as its motion uses it.

use std::sync::{Arc, OnceLock};

use super::{Moment, Ramped, Weight};
use crate::force::{Acts, Drive, Force, Harmonic, Pushes, Smooth};
use crate::number::clock::Clock;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

/// The drive of a structure: f/M and a_g as functions of time.
pub trait Source: Clone + std::fmt::Debug {
    /// The number type of its values.
    type Real: Real;
    /// f/M, and a_g plus gravity along the motion, at a later instant of the same smooth piece.
    fn pushes(&self, from: &Moment<Self::Real>, time: Clock<Self::Real>) -> Pushes<Self::Real>;
    /// [`Source::pushes`] with the accuracy of plain numbers at least.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn plain_pushes(
        &self,
        from: &Moment<Self::Real>,
        time: Clock<Self::Real>,
    ) -> Pushes<Self::Real> {
        self.pushes(from, time)
    }
    /// The same instant, with the piece that acts from there on.
    #[inline(always)]
    fn renewed(&self, moment: &Moment<Self::Real>) -> Moment<Self::Real> {
        *moment
    }
    /// The Taylor coefficients of f/M and a_g about a moment, in powers of t/h, without gravity.
    fn drive(&self, moment: &Moment<Self::Real>, h: Self::Real) -> Drive<Self::Real>;
    /// The Taylor coefficients of f/M, and of a_g plus gravity along the motion, in double-double.
    fn precise(&self, time: Clock<Self::Real>, h: Self::Real) -> Drive<DoubleDouble<Self::Real>>;
    /// True if the base moves or gravity acts along the motion.
    fn moves_base(&self) -> bool;
    /// True if it is piecewise: it has recorded parts.
    fn bends(&self) -> bool;
    /// Gravity along the motion; `None` where the motion is level.
    #[inline(always)]
    fn weight(&self) -> Option<Weight<Self::Real>> {
        None
    }
    /// The motion of the structure in closed form, where the drive is linear between bends.
    #[inline(always)]
    fn ramped(&self) -> Option<&Ramped<Self::Real>> {
        None
    }
}

/// A sum of forces, shared by a structure with and without its absorber.
#[derive(Debug, Clone, PartialEq)]
pub struct Forces<R = f64> {
    pub(super) force: Arc<Force<R>>,
    moves_base: bool,
    weight: Option<Weight<R>>,
    ramped: Option<Closed<R>>,
}

/// The motion in closed form of a mass on a structure of damping ratio ζ; made by the first flight.
#[derive(Debug, Clone)]
struct Closed<R> {
    mass: R,
    damping_ratio: R,
    made: OnceLock<Arc<Ramped<R>>>,
}

impl<R: Real> Forces<R> {
    /// A force on a structure by itself, with gravity along its motion.
    pub(super) fn new(force: Force<R>, weight: Option<Weight<R>>) -> Self {
        let moves_base = force.moves_base() || weight.is_some();
        Self { force: Arc::new(force), moves_base, weight, ramped: None }
    }

    /// The same forces on a structure of this mass.
    pub(super) fn on_mass(&self, mass: R, damping_ratio: R) -> Self {
        let linear = self.force.harmonics().is_empty();
        let closed = Closed { mass, damping_ratio, made: OnceLock::new() };
        Self { ramped: linear.then_some(closed), ..self.clone() }
    }

    /// Takes the motion in closed form over from the same mass on a structure of the same ζ.
    pub(super) fn share(&self, like: &Self) {
        if let (Some(own), Some(like)) = (&self.ramped, &like.ramped) {
            // Looked up before the cell is initialised: forces may share with themselves.
            let made = Arc::clone(like.get());
            own.made.get_or_init(|| made);
        }
    }

    /// The only force, if it is harmonic.
    #[inline(always)]
    fn single(&self) -> Option<&Harmonic<R>> {
        match self.force.harmonics() {
            [harmonic] if self.force.is_single() => Some(harmonic),
            _ => None,
        }
    }

    /// f/M and a_g of the only force at an instant with the accuracy of plain numbers.
    #[inline(always)]
    fn plainly(harmonic: &Harmonic<R>, time: Clock<R>) -> Pushes<R> {
        let mut pushes = Pushes::NONE;
        *pushes.on(harmonic.acts) = harmonic.plain_push(time);
        pushes
    }

    /// The drive at an instant, when the first `kicks` impulses have acted, with the piece that acts from there on; that
    /// is looked up near the piece of an earlier instant.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub(super) fn moment(&self, time: Clock<R>, kicks: u32, near: &Smooth<R>) -> Moment<R> {
        let (smooth, pushes) = self.force.smooth(time, kicks, near);
        Moment { time, kicks, smooth, pushes: self.heavy(pushes) }
    }

    /// With gravity along the motion.
    #[inline(always)]
    fn heavy(&self, mut pushes: Pushes<R>) -> Pushes<R> {
        if let Some(Weight { gravity, .. }) = self.weight {
            pushes.base.value = pushes.base.value.plus(gravity);
        }
        pushes
    }

    /// Without gravity along the motion.
    #[inline(always)]
    fn light(&self, mut pushes: Pushes<R>) -> Pushes<R> {
        if let Some(Weight { gravity, .. }) = self.weight {
            pushes.base.value = pushes.base.value.plus(-gravity);
        }
        pushes
    }

    /// f/M and a_g at a moment with the accuracy of plain numbers, without gravity.
    #[inline(always)]
    pub(super) fn near(&self, moment: &Moment<R>) -> Pushes<R> {
        match self.single() {
            Some(harmonic) => Self::plainly(harmonic, moment.time),
            None => self.light(moment.pushes),
        }
    }

    /// The force on a structure with the absorber stuck to it.
    pub(super) fn loaded(&self) -> Self {
        Self { weight: self.weight.map(Weight::loaded), ..self.clone() }
    }
}

impl<R: PartialEq> PartialEq for Closed<R> {
    fn eq(&self, other: &Self) -> bool {
        self.mass == other.mass && self.damping_ratio == other.damping_ratio
    }
}

impl<R: Real> Closed<R> {
    #[inline(always)]
    fn get(&self) -> &Arc<Ramped<R>> {
        self.made.get_or_init(|| Arc::new(Ramped::new(self.mass, self.damping_ratio)))
    }
}

impl<R: Real> Source for Forces<R> {
    type Real = R;
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn pushes(&self, from: &Moment<R>, time: Clock<R>) -> Pushes<R> {
        self.heavy(self.force.later(from.time, &self.light(from.pushes), time))
    }

    #[inline(always)]
    fn renewed(&self, moment: &Moment<R>) -> Moment<R> {
        self.moment(moment.time, moment.kicks, &moment.smooth)
    }

    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn plain_pushes(&self, from: &Moment<R>, time: Clock<R>) -> Pushes<R> {
        match self.single() {
            Some(harmonic) => self.heavy(Self::plainly(harmonic, time)),
            None => self.pushes(from, time),
        }
    }

    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn drive(&self, moment: &Moment<R>, h: R) -> Drive<R> {
        let (time, pushes) = (&moment.time, self.light(moment.pushes));
        if self.force.harmonics().is_empty() {
            return Drive::linear(&pushes, h);
        }
        let Some(harmonic) = self.single() else { return self.force.drive(*time, h) };
        match harmonic.acts {
            Acts::Primary => Drive { primary: harmonic.onwards(&pushes.primary, h), ..Drive::NONE },
            Acts::Base => Drive { base: harmonic.onwards(&pushes.base, h), ..Drive::NONE },
        }
    }

    fn precise(&self, time: Clock<R>, h: R) -> Drive<DoubleDouble<R>> {
        let mut drive: Drive<DoubleDouble<R>> = self.force.precise(time, h);
        if let Some(Weight { gravity, .. }) = self.weight {
            drive.base[0] = drive.base[0].plus(gravity);
        }
        drive
    }

    #[inline(always)]
    fn moves_base(&self) -> bool {
        self.moves_base
    }

    fn bends(&self) -> bool {
        !self.force.records().is_empty()
    }

    #[inline(always)]
    fn weight(&self) -> Option<Weight<R>> {
        self.weight
    }

    #[inline(always)]
    fn ramped(&self) -> Option<&Ramped<R>> {
        self.ramped.as_ref().map(|closed| &**closed.get())
    }
}
