//! What smooth motion between two events must say of itself.
//!
//! A flight (the absorber free in its gap) and a ride (the absorber stuck on a wall) are both a
//! [`Motion`]: exact states at any h up to `reach`. What can end them is a [`Curve`]: a scalar
//! function with its derivatives and a bound on the fourth, enough to enclose it without gaps.

use crate::compensated::DoubleDouble;
use crate::real::Real;
use crate::system::{Point, Wall};
use crate::taylor::Row;

/// A scalar function of time and its first three derivatives at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet<R = f64> {
    /// f
    pub value: R,
    /// f′
    pub rate: R,
    /// f″
    pub curvature: R,
    /// f‴
    pub jerk: R,
}

/// A scalar function on [0, reach] with a bound on its fourth derivative.
pub trait Curve {
    /// The numbers that it is evaluated in.
    type Real: Real;
    /// What one evaluation yields; the jet is read from it.
    type Sample: Copy;
    /// Evaluates the motion at h.
    fn sample(&self, h: Self::Real) -> Self::Sample;
    /// The function and its derivatives at a sample.
    fn jet(&self, sample: &Self::Sample) -> Jet<Self::Real>;
    /// f at h with an error far below 2⁻⁵³ of [`Curve::magnitude`]. Dear; asked only where the sign
    /// of f is in doubt.
    fn precise(&self, h: Self::Real) -> DoubleDouble<Self::Real>;
    /// A number that |f⁗| does not exceed on [0, reach].
    fn fourth(&self) -> Self::Real;
    /// The size of f, of which rounding takes some 2⁻⁵³.
    fn magnitude(&self) -> Self::Real;
}

/// Displacement and velocity of the absorber in its gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GapPoint<R = f64> {
    /// Gap displacement y.
    pub y: R,
    /// Gap velocity w = ẏ.
    pub w: R,
}

/// The polynomials that a motion consists of, in powers of h/`step`, beyond their order 0.
#[derive(Debug, Clone, Copy)]
pub struct Rows<R = f64> {
    /// Length that h is measured in.
    pub step: R,
    /// Highest power.
    pub order: usize,
    /// Displacement of the primary.
    pub x: Row<R>,
    /// Its absolute acceleration ẍ + a_g.
    pub acceleration: Row<R>,
    /// Acceleration a_g of the base.
    pub base: Row<R>,
}

/// Which wall a contact is made with, seen from the wall last touched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The wall last touched.
    Near,
    /// The wall across the gap.
    Far,
}

/// A flight that a proof in closed form decides, without a search.
#[derive(Debug, Clone, Copy)]
pub struct FastFlight<State, R = f64> {
    /// Its length, rounded.
    pub length: R,
    /// What the rounded length lacks: to be added to it.
    pub later: R,
    /// The state at its end.
    pub end: State,
    /// What it meets there.
    pub meets: Meets,
}

/// What a flight meets at its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meets {
    /// No wall.
    Nothing,
    /// A wall that the state at its end is in contact with.
    Wall,
    /// A wall that the state at its end has reached within rounding.
    Near(Side),
}

/// What is known of a function between the ends of an interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc<R = f64> {
    /// The function at both ends.
    pub values: [R; 2],
    /// Its derivative there.
    pub rates: [R; 2],
    /// A bound on its second derivative.
    pub second: R,
    /// A bound on its third derivative.
    pub third: R,
}

impl<R: Real> Arc<R> {
    /// True if its size stays below a number on an interval of this length, rounding included.
    pub fn is_below(&self, number: R, length: R) -> bool {
        const ROUNDING: f64 = 32.0 * f64::EPSILON;
        let [a, b] = self.values.map(R::abs);
        a.max(b) + self.second * 0.125 * (length * length) < number * (R::ONE - ROUNDING)
    }

    /// True if it runs one way on an interval of this length: its derivative stays this close to the chord.
    pub fn is_monotone(&self, length: R) -> bool {
        let [a, b] = self.rates;
        a * b > 0.0 && a.abs().min(b.abs()) > self.third * 0.125 * (length * length)
    }
}

/// What is known of a motion between its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arcs<R = f64> {
    /// Of x.
    pub displacement: Arc<R>,
    /// Of ẍ + a_g.
    pub acceleration: Arc<R>,
}

/// What a motion takes and gives, as integrals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Losses<R = f64> {
    /// Energy lost in the structure's damper.
    pub viscous: R,
    /// Energy lost in the pivot of a pendulum.
    pub pivot: R,
    /// Work of force and base.
    pub work: R,
}

/// Whether x turns round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turns<R = f64> {
    /// It does not.
    Never,
    /// Once: when, and x there.
    Once(R, R),
    /// Not decided at a glance.
    Unknown,
}

/// Smooth motion from one state, exact for 0 ≤ h ≤ `reach`.
pub trait Motion {
    /// The numbers that it is evaluated in.
    type Real: Real;
    /// The state it starts from and leads to.
    type State: Copy + std::fmt::Debug;
    /// True while the absorber is stuck on a wall.
    const RIDING: bool;
    /// The state at h = 0.
    fn origin(&self) -> &Self::State;
    /// The longest h this motion is exact for.
    fn reach(&self) -> Self::Real;
    /// The state at h.
    fn state(&self, h: Self::Real) -> Self::State;
    /// The same to more digits, for the end of the motion, which the run goes on from.
    fn arrival(&self, h: Self::Real) -> Self::State {
        self.state(h)
    }
    /// What a flight of this length comes to, if that is plain; `None` says nothing.
    fn fast_path(&self, _length: Self::Real) -> Option<FastFlight<Self::State, Self::Real>> {
        None
    }
    /// Whether x turns round in a motion of this length to this state, if that is plain.
    fn turns(&self, _length: Self::Real, _end: &Self::State) -> Turns<Self::Real> {
        Turns::Unknown
    }
    /// The same of ẍ + a_g.
    fn acceleration_turns(&self, _length: Self::Real, _end: &Self::State) -> Turns<Self::Real> {
        Turns::Unknown
    }
    /// Primary displacement and its derivatives at h.
    fn primary(&self, h: Self::Real) -> Jet<Self::Real>;
    /// Gap displacement and velocity at h.
    fn gap(&self, h: Self::Real) -> GapPoint<Self::Real>;
    /// Structure and absorber at h.
    fn place(&self, h: Self::Real) -> (Point<Self::Real>, GapPoint<Self::Real>) {
        let Jet { value: x, rate: v, .. } = self.primary(h);
        (Point { x, v }, self.gap(h))
    }
    /// The wall ridden on; `None` in flight.
    fn wall(&self) -> Option<Wall>;
    /// What it takes and gives up to h.
    fn losses(&self, h: Self::Real) -> Losses<Self::Real>;
    /// ∫x² from one h to another; asked under force.
    fn square(&self, _h: [Self::Real; 2]) -> Self::Real {
        Self::Real::ZERO
    }
    /// What is known of its way to this state, where that is at hand.
    fn arcs(&self, _end: &Self::State) -> Option<Arcs<Self::Real>> {
        None
    }
    /// The series that it is read from, where it is one.
    fn rows(&self) -> Option<Rows<Self::Real>> {
        None
    }
}
