//! What smooth motion between two events must say of itself.
//!
//! A flight (the absorber free in its gap) and a ride (the absorber stuck on a wall) are both a
//! [`Motion`]: exact states at any h up to `reach`. What can end them is a [`Curve`]: a scalar
//! function with its derivatives and a bound on the fourth, enough to enclose it without gaps.

use crate::compensated::Sum;
use crate::real::Real;
use crate::system::{Point, Wall};
use crate::taylor::Row;

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

/// The polynomials that a motion consists of, in powers of h/`step`, beyond their order 0.
#[derive(Debug, Clone, Copy)]
pub struct Rows {
    /// Length that h is measured in.
    pub step: Real,
    /// Highest power.
    pub order: usize,
    /// Displacement of the primary.
    pub x: Row<Real>,
    /// Its absolute acceleration ẍ + a_g.
    pub acceleration: Row<Real>,
    /// Acceleration a_g of the base.
    pub base: Row<Real>,
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
pub struct Glide<State> {
    /// Its length, rounded.
    pub length: Real,
    /// What the length lacks.
    pub later: Real,
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
    /// A wall that the state at its end has reached but for rounding.
    Near(Side),
}

/// What is known of a function between the ends of an interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc {
    /// The function at both ends.
    pub values: [Real; 2],
    /// Its derivative there.
    pub rates: [Real; 2],
    /// A bound on its second derivative.
    pub second: Real,
    /// A bound on its third derivative.
    pub third: Real,
}

impl Arc {
    /// True if its size stays below a number on an interval of this length, rounding included.
    pub fn is_below(&self, number: Real, length: Real) -> bool {
        const ROUNDING: f64 = 32.0 * f64::EPSILON;
        let [a, b] = self.values.map(Real::abs);
        a.max(b) + 0.125 * self.second * (length * length) < number * (1.0 - ROUNDING)
    }

    /// True if it runs one way on an interval of this length: its derivative stays this close to the chord.
    pub fn is_monotone(&self, length: Real) -> bool {
        let [a, b] = self.rates;
        a * b > 0.0 && a.abs().min(b.abs()) > 0.125 * self.third * (length * length)
    }
}

/// What is known of a motion between its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arcs {
    /// Of x.
    pub displacement: Arc,
    /// Of ẍ + a_g.
    pub acceleration: Arc,
}

/// What a motion takes and gives, as integrals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Losses {
    /// Energy lost in the structure's damper.
    pub viscous: Real,
    /// Energy lost in the pivot of a pendulum.
    pub pivot: Real,
    /// Work of force and base.
    pub work: Real,
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
    /// The same of ẍ + a_g.
    fn acceleration_turns(&self, _length: Real, _end: &Self::State) -> Turns {
        Turns::Unknown
    }
    /// Primary displacement and its derivatives at h.
    fn primary(&self, h: Real) -> Jet;
    /// Gap displacement and velocity at h.
    fn gap(&self, h: Real) -> GapPoint;
    /// Structure and absorber at h.
    fn place(&self, h: Real) -> (Point, GapPoint) {
        let Jet { value: x, rate: v, .. } = self.primary(h);
        (Point { x, v }, self.gap(h))
    }
    /// The wall ridden on; `None` in flight.
    fn wall(&self) -> Option<Wall>;
    /// What it takes and gives up to h.
    fn losses(&self, h: Real) -> Losses;
    /// ∫x² from one h to another, of a motion under force.
    fn square(&self, h: [Real; 2]) -> Real;
    /// What is known of its way to this state, where that is at hand.
    fn arcs(&self, _end: &Self::State) -> Option<Arcs> {
        None
    }
    /// The series that it is read from, where it is one.
    fn rows(&self) -> Option<Rows> {
        None
    }
}
