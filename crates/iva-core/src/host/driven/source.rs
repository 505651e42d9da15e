//! What drives a structure, seen from its motion.

use std::sync::Arc;

use super::{Moment, Weight};
use crate::compensated::DoubleDouble;
use crate::force::{Drive, Force, Pushes};
use crate::real::Real;
use crate::system::Clock;

/// What drives a structure.
pub trait Source: Clone + std::fmt::Debug {
    /// The numbers that it is evaluated in.
    type Real: Real;
    /// f/M, and a_g with gravity along the motion, at an instant, of the smooth piece that acts from an earlier one on.
    fn pushes(&self, from: Clock<Self::Real>, time: Clock<Self::Real>) -> Pushes<Self::Real>;
    /// The coefficients of f/M and a_g from an instant on, in powers of t/h.
    fn drive(&self, time: Clock<Self::Real>, h: Self::Real) -> Drive<Self::Real>;
    /// The same to twice the precision, gravity along the motion included.
    fn precise(&self, time: Clock<Self::Real>, h: Self::Real) -> Drive<DoubleDouble<Self::Real>>;
    /// How far a motion goes that reaches so far: not beyond the next instant at which the drive bends, jumps or
    /// kicks, and then that instant.
    fn until_bend(
        &self,
        moment: &Moment<Self::Real>,
        reach: Self::Real,
    ) -> (Self::Real, Option<Clock<Self::Real>>);
    /// True if the base moves.
    fn moves_base(&self) -> bool;
    /// True if it consists of pieces.
    fn bends(&self) -> bool;
    /// Gravity along the motion; `None` where that is level.
    #[inline(always)]
    fn weight(&self) -> Option<Weight<Self::Real>> {
        None
    }
}

/// A sum of forces, shared by a structure with and without its absorber.
#[derive(Debug, Clone, PartialEq)]
pub struct Forces<R = f64> {
    pub(super) force: Arc<Force<R>>,
    moves_base: bool,
    weight: Option<Weight<R>>,
}

impl<R: Real> Forces<R> {
    /// A force on a structure by itself, with gravity along its motion.
    pub(super) fn new(force: Force<R>, weight: Option<Weight<R>>) -> Self {
        let moves_base = force.moves_base() || weight.is_some();
        Self { force: Arc::new(force), moves_base, weight }
    }

    /// The same on a structure with the absorber stuck to it.
    pub(super) fn loaded(&self) -> Self {
        Self { weight: self.weight.map(Weight::loaded), ..self.clone() }
    }
}

impl<R: Real> Source for Forces<R> {
    type Real = R;
    #[inline(always)]
    fn pushes(&self, from: Clock<R>, time: Clock<R>) -> Pushes<R> {
        let mut pushes = self.force.pushes(from, time);
        if let Some(Weight { gravity, .. }) = self.weight {
            pushes.base.value = pushes.base.value.plus(gravity);
        }
        pushes
    }

    #[inline(always)]
    fn drive(&self, time: Clock<R>, h: R) -> Drive<R> {
        self.force.drive(time, time, h)
    }

    fn precise(&self, time: Clock<R>, h: R) -> Drive<DoubleDouble<R>> {
        let mut drive: Drive<DoubleDouble<R>> = self.force.precise(time, h);
        if let Some(Weight { gravity, .. }) = self.weight {
            drive.base[0] = drive.base[0].plus(gravity);
        }
        drive
    }

    #[inline(always)]
    fn until_bend(&self, moment: &Moment<R>, reach: R) -> (R, Option<Clock<R>>) {
        self.force.until_bend(moment.time, moment.kicks, reach)
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
}
