//! What smooth motion between two events must say of itself.
//!
//! A flight (the absorber free in its gap) and a ride (the absorber stuck on a wall) are both a
//! [`Motion`]: exact states at any h up to `reach`. What can end them is a [`Curve`]: a scalar
//! function with its derivatives and a bound on the fourth, enough to enclose it without gaps.

use crate::compensated::Sum;
use crate::real::{Real, ZERO};
use crate::system::Wall;

/// A scalar function of time and its first three derivatives at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet {
    /// f
    pub value: Real,
    /// f′
    pub rate: Real,
    /// f″
    pub curvature: Real,
    /// f‴
    pub jerk: Real,
}

/// A scalar function on [0, reach] with a bound on its fourth derivative.
pub trait Curve {
    /// What one evaluation yields; the jet is read from it.
    type Sample: Copy;
    /// Evaluates the motion at h.
    fn sample(&self, h: Real) -> Self::Sample;
    /// The function and its derivatives at a sample.
    fn jet(&self, sample: &Self::Sample) -> Jet;
    /// f at h with an error far below 2⁻⁵³ of [`Curve::magnitude`]. Dear; asked only where the sign
    /// of f is in doubt.
    fn precise(&self, h: Real) -> Sum;
    /// A number that |f⁗| does not exceed on [0, reach].
    fn fourth(&self) -> Real;
    /// The size of f, of which rounding takes some 2⁻⁵³.
    fn magnitude(&self) -> Real;
}

/// Displacement and velocity of the absorber in its gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GapPoint {
    /// Gap displacement y.
    pub y: Real,
    /// Gap velocity w = ẏ.
    pub w: Real,
}

/// The polynomials that a motion consists of, in powers of h/`step`.
#[derive(Debug, Clone, Copy)]
pub struct Rows<'a> {
    /// Length that h is measured in.
    pub step: Real,
    /// Displacement of the primary.
    pub x: &'a [Real],
    /// Its absolute acceleration ẍ + a_g.
    pub acceleration: &'a [Real],
    /// Acceleration a_g of the base.
    pub base: &'a [Real],
}

/// Which wall a contact is made with, seen from the wall last touched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The wall last touched.
    Near,
    /// The wall across the gap.
    Far,
}

/// A flight that was decided at a glance.
#[derive(Debug, Clone, Copy)]
pub struct Glide<State> {
    /// Its length …
    pub length: Real,
    /// … and the state at its end.
    pub end: State,
    /// The wall that it meets there; `None`: it meets none.
    pub contact: Option<Side>,
}

/// Whether x turns round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turns {
    /// It does not.
    Never,
    /// Once: when, and x there.
    Once(Real, Real),
    /// Not decided at a glance.
    Unknown,
}

/// Smooth motion from one state, exact for 0 ≤ h ≤ `reach`.
pub trait Motion {
    /// The state it starts from and leads to.
    type State: Copy + std::fmt::Debug;
    /// True while the absorber is stuck on a wall.
    const RIDING: bool;
    /// The state at h = 0.
    fn origin(&self) -> &Self::State;
    /// The longest h this motion is exact for.
    fn reach(&self) -> Real;
    /// The state at h.
    fn state(&self, h: Real) -> Self::State;
    /// The same to more digits, for the end of the motion, which the run goes on from.
    fn arrival(&self, h: Real) -> Self::State {
        self.state(h)
    }
    /// What a flight of this length comes to, if that is plain; `None` says nothing.
    fn glide(&self, _length: Real) -> Option<Glide<Self::State>> {
        None
    }
    /// Whether x turns round in a motion of this length to this state, if that is plain.
    fn turns(&self, _length: Real, _end: &Self::State) -> Turns {
        Turns::Unknown
    }
    /// Primary displacement and its derivatives at h.
    fn primary(&self, h: Real) -> Jet;
    /// Gap displacement and velocity at h.
    fn gap(&self, h: Real) -> GapPoint;
    /// The wall ridden on; `None` in flight.
    fn wall(&self) -> Option<Wall>;
    /// Energy lost in the damper up to h, an integral.
    fn viscous_loss(&self, h: Real) -> Real;
    /// The series that it is read from, where it is one.
    fn rows(&self) -> Option<Rows<'_>> {
        None
    }
    /// Work of force and base up to h, an integral.
    fn work(&self, _h: Real) -> Real {
        ZERO
    }
    /// Energy lost in the pivot of a pendulum up to h, an integral.
    fn pivot_loss(&self, _h: Real) -> Real {
        ZERO
    }
}
