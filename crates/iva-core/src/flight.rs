//! What smooth motion between two events must say of itself.
//!
//! A flight (the absorber free in its gap) and a ride (the absorber stuck on a wall) are both a
//! [`Motion`]: exact states at any h up to `reach`. What can end them is a [`Curve`]: a scalar
//! function with its derivatives and a bound on the fourth, enough to enclose it without gaps.

use crate::compensated::DoubleDouble;
use crate::quintic::{BEND_OFF, OFF, SLOPE_OFF, bernstein};
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

/// The polynomials of a motion with that of the gap displacement.
#[derive(Debug, Clone, Copy)]
pub struct Travel<R = f64> {
    /// Those of the structure.
    pub rows: Rows<R>,
    /// Gap displacement.
    pub gap: Row<R>,
    /// Displacement of the absorber's centre of mass, measured as that of the structure.
    pub absorber: Row<R>,
}

impl<R: Real> Travel<R> {
    /// From the series of structure and gap; `lever` is how far the centre of mass goes per gap displacement.
    pub fn new(rows: Rows<R>, gap: Row<R>, lever: R) -> Self {
        let absorber = std::array::from_fn(|k| rows.x[k] + lever * gap[k]);
        Self { rows, gap, absorber }
    }
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

/// What is known of a function between the ends of an interval: close to the quintic that has its values and first two
/// derivatives there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc<R = f64> {
    /// Value, L × first and ½ L² × second derivative at the begin, L being the length of the interval.
    pub begin: [R; 3],
    /// The same at the end.
    pub end: [R; 3],
    /// L⁶ × a bound on the sixth derivative.
    pub sixth: R,
}

/// What rounding takes of the bounds of an [`Arc`], over its size.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl<R: Real> Arc<R> {
    /// From value and first two derivatives at both ends of an interval of this length, and a bound on the sixth.
    #[inline(always)]
    pub fn new(begin: [R; 3], end: [R; 3], sixth: R, length: R) -> Self {
        let half_square = (length * length) * 0.5;
        let cube = length * length * length;
        let scaled = |[f, rate, second]: [R; 3]| [f, length * rate, half_square * second];
        Self { begin: scaled(begin), end: scaled(end), sixth: sixth * (cube * cube) }
    }

    /// The same where rounding takes as much as of numbers of this size.
    #[inline(always)]
    pub fn doubted(self, size: R) -> Self {
        // Enough for the value; slope and second derivative have larger shares of the bound.
        Self { sixth: self.sixth + size * (R::EPSILON * (64.0 / OFF)), ..self }
    }

    /// A number that its size stays below.
    #[inline(always)]
    pub fn limit(&self) -> R {
        (largest(&bernstein(&self.begin, &self.end)) + self.sixth * OFF) * (R::ONE + ROUNDING)
    }

    /// True if it runs one way.
    #[inline(always)]
    pub fn is_monotone(&self) -> bool {
        let b = bernstein(&self.begin, &self.end);
        let steps = [b[1] - b[0], b[2] - b[1], b[3] - b[2], b[4] - b[3], b[5] - b[4]];
        let off = self.sixth * (SLOPE_OFF / 5.0) + largest(&b) * ROUNDING;
        one_sign(&steps, off)
    }

    /// True if it turns round once: its first derivative changes its sign and the second keeps its own.
    #[inline(always)]
    pub fn turns_once(&self) -> bool {
        let b = bernstein(&self.begin, &self.end);
        let bend = |i: usize| (b[i + 2] - b[i + 1]) - (b[i + 1] - b[i]);
        let off = self.sixth * (BEND_OFF / 20.0) + largest(&b) * ROUNDING;
        (self.begin[1] * self.end[1] < 0.0) & one_sign(&[bend(0), bend(1), bend(2), bend(3)], off)
    }
}

/// True if all have one sign, and are larger than this.
#[inline(always)]
fn one_sign<R: Real, const N: usize>(values: &[R; N], off: R) -> bool {
    let above = values.iter().fold(true, |all, value| all & (*value > off));
    let below = values.iter().fold(true, |all, value| all & (*value < -off));
    above | below
}

/// The largest size.
#[inline(always)]
fn largest<R: Real, const N: usize>(values: &[R; N]) -> R {
    values.iter().fold(R::ZERO, |most, value| R::larger(value.abs(), most))
}

/// What the largest size of a function on an interval is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extreme<R = f64> {
    /// It stays below this.
    pub limit: R,
    /// It is this, if `known`.
    pub most: R,
    /// True if that is plain.
    pub known: bool,
}

impl<R: Real> Extreme<R> {
    /// Of a function that turns round once, `turned` being its value there, or runs one way.
    #[inline(always)]
    pub fn new(arc: &Arc<R>, once: bool, turned: R) -> Self {
        let ends = R::larger(arc.begin[0].abs(), arc.end[0].abs());
        let monotone = arc.is_monotone();
        let turned = R::larger(turned.abs(), ends);
        let most = if monotone { ends } else { turned };
        Self { limit: arc.limit(), most, known: monotone | once }
    }

    /// The largest size, or `least` if that is larger; `None` if it is not plain.
    #[inline(always)]
    pub fn largest(&self, least: R) -> Option<R> {
        if self.limit < least {
            return Some(least);
        }
        self.known.then(|| R::larger(self.most, least))
    }
}

/// A function of time whose largest size may be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// x.
    Displacement,
    /// ẍ + a_g.
    Acceleration,
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
    /// Primary displacement and its derivatives at h.
    fn primary(&self, h: Self::Real) -> Jet<Self::Real>;
    /// Absolute acceleration ẍ + a_g of the structure at h; as it stands here, of one whose base is at rest.
    fn acceleration(&self, h: Self::Real) -> Self::Real {
        self.primary(h).curvature
    }
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
    /// The largest size of a quantity in a motion of this length to this state, or `least` if that is larger, if it is
    /// plain.
    fn largest(
        &self,
        _of: Quantity,
        _least: Self::Real,
        _length: Self::Real,
        _end: &Self::State,
    ) -> Option<Self::Real> {
        None
    }
    /// The series that it is read from, where it is one.
    fn rows(&self) -> Option<Rows<Self::Real>> {
        None
    }
    /// Series of structure and gap, whatever it is read from; `None` where the absorber has none to offer.
    fn travel(&self) -> Option<Travel<Self::Real>> {
        None
    }
}
