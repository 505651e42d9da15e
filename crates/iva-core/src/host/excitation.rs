//! What drives a structure, and the instants at which something happens to it.

use std::fmt::Debug;
use std::marker::PhantomData;

use crate::force::Force;
use crate::number::real::Real;

/// What drives a structure: nothing by default.
pub trait Excitation: Debug {
    /// The number type of the motion.
    type Real: Real;
    /// The state of the drive at one instant.
    type Phase: Copy + Debug + PartialEq;

    /// The force; `None` for a structure that cannot be driven.
    fn force(&self) -> Option<&Force<Self::Real>> {
        None
    }
    /// True if a lasting force or base motion drives the structure, not impulses only.
    fn is_driven(&self) -> bool {
        self.force().is_some_and(Force::lasts)
    }
    /// True if the base moves.
    fn moves_base(&self) -> bool {
        self.force().is_some_and(Force::moves_base)
    }
    /// The time for which the drive stays smooth, until a kink, a jump or an impulse.
    fn smooth_for(&self, _phase: &Self::Phase) -> Self::Real {
        Self::Real::INFINITY
    }
    /// P/M of the impulse that is due, 0 at a jump of the force; `None` if no impulse is due.
    fn due(&self, _phase: &Self::Phase) -> Option<Self::Real> {
        None
    }
    /// The state of the drive after the impulse that was due.
    fn after_impulse(&self, phase: &Self::Phase) -> Self::Phase {
        *phase
    }
}

/// No excitation.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Still<R = f64>(PhantomData<R>);

impl<R: Real> Still<R> {
    /// No excitation, of any structure.
    pub const NONE: &'static Self = &Self(PhantomData);
}

impl<R: Real> Excitation for Still<R> {
    type Real = R;
    type Phase = ();
}
