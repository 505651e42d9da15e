//! What drives a structure, seen from its motion.

use std::sync::Arc;

use super::Moment;
use crate::compensated::DoubleDouble;
use crate::force::{Drive, Force, Pushes};
use crate::real::Real;
use crate::system::Clock;

/// What drives a structure.
pub trait Source: Clone + std::fmt::Debug {
    /// The numbers that it is evaluated in.
    type Real: Real;
    /// f/M and a_g at an instant, of the smooth piece that acts from an earlier one on.
    fn pushes(&self, from: Clock<Self::Real>, time: Clock<Self::Real>) -> Pushes<Self::Real>;
    /// Their coefficients from an instant on, in powers of t/h.
    fn drive(&self, time: Clock<Self::Real>, h: Self::Real) -> Drive<Self::Real>;
    /// The same to twice the precision.
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
}

/// A sum of forces, shared by a structure with and without its absorber.
#[derive(Debug, Clone, PartialEq)]
pub struct Forces<R = f64> {
    pub(super) force: Arc<Force<R>>,
    moves_base: bool,
}

impl<R: Real> Forces<R> {
    pub(super) fn new(force: Force<R>) -> Self {
        let moves_base = force.moves_base();
        Self { force: Arc::new(force), moves_base }
    }
}

impl<R: Real> Source for Forces<R> {
    type Real = R;
    #[inline(always)]
    fn pushes(&self, from: Clock<R>, time: Clock<R>) -> Pushes<R> {
        self.force.pushes(from, time)
    }

    #[inline(always)]
    fn drive(&self, time: Clock<R>, h: R) -> Drive<R> {
        self.force.drive(time, time, h)
    }

    fn precise(&self, time: Clock<R>, h: R) -> Drive<DoubleDouble<R>> {
        self.force.precise(time, h)
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
}
