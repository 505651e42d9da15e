//! The interface of smooth motion between two events.
//!
//! A flight (the absorber free in its gap) and a stick episode or *ride* (the absorber stuck on a wall) are
//! both a [`Motion`]: exact states at any h up to `reach`. The event that ends a motion is a zero of a
//! [`Curve`]: a scalar function with its first three derivatives and a bound on the fourth, enough for
//! rigorous enclosures.

use crate::number::arrays::laned;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::place::{Point, Wall};
use crate::segment::polynomial::largest;
use crate::segment::quintic::{BEND_OFF, OFF, SLOPE_OFF, bernstein};
use crate::segment::taylor::{Row, unrolled};

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
    /// The number type of its values.
    type Real: Real;
    /// The function and its derivatives at h.
    fn jet(&self, h: Self::Real) -> Jet<Self::Real>;
    /// Those at the begin, which may be known better than by evaluation.
    fn first(&self) -> Jet<Self::Real>;
    /// f at h in double-double, with an error far below 2⁻⁵³ of [`Curve::magnitude`]. Expensive: called only
    /// where the sign of f is in doubt.
    fn precise(&self, h: Self::Real) -> DoubleDouble<Self::Real>;
    /// A bound on |f⁗| on [0, reach].
    fn fourth(&self) -> Self::Real;
    /// The size of the terms of f: rounding errors of f are some 2⁻⁵³ of it.
    fn magnitude(&self) -> Self::Real;
    /// Up to which value f is known at the begin to its own last digits, 0 included: its rounding errors are in proportion to how far it goes from there.
    fn near(&self) -> Self::Real {
        Self::Real::ZERO
    }
    /// True if a bound tells at once that f is positive on [0, reach].
    fn stays_positive(&self) -> bool {
        false
    }
}

/// Displacement and velocity of the absorber in its gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GapPoint<R = f64> {
    /// Gap displacement y.
    pub y: R,
    /// Gap velocity w = ẏ.
    pub w: R,
}

/// The polynomials of a motion of the structure, in powers of h/`step`; coefficients above `order` are not
/// used.
#[derive(Debug, Clone, Copy)]
pub struct Rows<R = f64> {
    /// Unit of h in the powers, in 1/ωn.
    pub step: R,
    /// Highest power used.
    pub order: usize,
    /// Displacement x of the primary.
    pub x: Row<R>,
    /// Absolute acceleration ẍ + a_g of the primary.
    pub acceleration: Row<R>,
    /// Acceleration a_g of the base.
    pub base: Row<R>,
}

/// The polynomials of structure, gap and absorber in one motion.
#[derive(Debug, Clone, Copy)]
pub struct Travel<R = f64> {
    /// The polynomials of the structure; their `step` and `order` hold for the others as well.
    pub rows: Rows<R>,
    /// Gap displacement.
    pub gap: Row<R>,
    /// Displacement of the absorber's centre of mass, in the coordinates of x.
    pub absorber: Row<R>,
}

/// Bounds on accelerations in one motion.
#[derive(Debug, Clone, Copy)]
pub struct Accelerations<R = f64> {
    /// |ẍ + a_g|.
    pub structure: R,
    /// |ÿ|.
    pub gap: R,
    /// That of the absorber's centre of mass, in the coordinates of x.
    pub absorber: R,
}

impl<R: Real> Travel<R> {
    /// The polynomials from those of structure and gap; `lever` is the displacement of the centre of mass per
    /// gap displacement.
    pub fn new(rows: Rows<R>, gap: Row<R>, lever: R) -> Self {
        let absorber = std::array::from_fn(|k| rows.x[k] + lever * gap[k]);
        Self { rows, gap, absorber }
    }
}

/// The wall of a contact, relative to the wall last touched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The wall last touched.
    Near,
    /// The wall across the gap.
    Far,
}

/// The result of a flight that is decided by a proof in closed form, without a search.
#[derive(Debug, Clone, Copy)]
pub struct FastFlight<State, R = f64> {
    /// High part of its length in 1/ωn.
    pub length: R,
    /// Low part of its length, to be added to `length`.
    pub later: R,
    /// The state at its end.
    pub end: State,
    /// The wall met at its end, if any.
    pub meets: Meets,
}

/// The wall that a flight meets at its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meets {
    /// No wall.
    Nothing,
    /// A wall that the state at its end is in contact with.
    Wall,
    /// A wall that the state at its end touches within rounding; the side says which.
    Near(Side),
}

/// A function on an interval of length L, as far as the values at both ends and a bound tell: it is close to
/// the quintic with the same values and first two derivatives at both ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc<R = f64> {
    /// Value, L × first and ½ L² × second derivative at the begin of the interval.
    pub begin: [R; 3],
    /// Value, L × first and ½ L² × second derivative at the end of the interval.
    pub end: [R; 3],
    /// L⁶ × a bound on the sixth derivative.
    pub sixth: R,
}

/// Bound on the rounding errors in the tests of an [`Arc`], relative to its size.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl<R: Real> Arc<R> {
    /// The arc of a function from its value and first two derivatives at both ends of an interval of this
    /// length, and a bound on its sixth derivative.
    #[inline(always)]
    pub fn new(begin: [R; 3], end: [R; 3], sixth: R, length: R) -> Self {
        let half_square = (length * length) * 0.5;
        let cube = length * length * length;
        let scaled = |[f, rate, second]: [R; 3]| [f, length * rate, half_square * second];
        Self { begin: scaled(begin), end: scaled(end), sixth: sixth * (cube * cube) }
    }

    /// The same arc with its bound widened by the rounding errors of numbers of this size.
    #[inline(always)]
    pub fn doubted(self, size: R) -> Self {
        // Sufficient for the value; the bounds on slope and second derivative take larger shares of `sixth`.
        Self { sixth: self.sixth + size * (R::EPSILON * (64.0 / OFF)), ..self }
    }

    /// A bound on the size of the function on the interval.
    #[inline(always)]
    pub fn limit(&self) -> R {
        // Twice as many coefficients, those of both halves, exceed the quintic by a quarter as much.
        let mut b = bernstein(&self.begin, &self.end);
        let mut most = R::larger(b[0].abs(), b[5].abs());
        unrolled!(k < 5 => {
            let mut i = 0;
            while i < 5 - k {
                b[i] = (b[i] + b[i + 1]) * 0.5;
                i += 1;
            }
            most = R::larger(most, R::larger(b[0].abs(), b[4 - k].abs()));
        });
        (most + self.sixth * OFF) * (R::ONE + ROUNDING)
    }

    /// True if the function is proved monotonic on the interval.
    #[inline(always)]
    pub fn is_monotone(&self) -> bool {
        let b = bernstein(&self.begin, &self.end);
        let steps = [b[1] - b[0], b[2] - b[1], b[3] - b[2], b[4] - b[3], b[5] - b[4]];
        let off = self.sixth * (SLOPE_OFF / 5.0) + largest_size(&b) * ROUNDING;
        one_sign(&steps, off)
    }

    /// True if the function is proved to have a single extremum: its first derivative changes sign, its
    /// second does not.
    #[inline(always)]
    pub fn turns_once(&self) -> bool {
        let b = bernstein(&self.begin, &self.end);
        let bend = |i: usize| (b[i + 2] - b[i + 1]) - (b[i + 1] - b[i]);
        let off = self.sixth * (BEND_OFF / 20.0) + largest_size(&b) * ROUNDING;
        (self.begin[1] * self.end[1] < 0.0) & one_sign(&[bend(0), bend(1), bend(2), bend(3)], off)
    }
}

/// True if all values have one sign and sizes above `off`.
#[inline(always)]
fn one_sign<R: Real, const N: usize>(values: &[R; N], off: R) -> bool {
    let above = values.iter().fold(true, |all, value| all & (*value > off));
    let below = values.iter().fold(true, |all, value| all & (*value < -off));
    above | below
}

/// The largest absolute value.
#[inline(always)]
fn largest_size<R: Real, const N: usize>(values: &[R; N]) -> R {
    values.iter().fold(R::ZERO, |most, value| R::larger(value.abs(), most))
}

/// The largest size of a function on an interval, or a bound on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extreme<R = f64> {
    /// Upper bound on the size.
    pub limit: R,
    /// The largest size, valid if `known`.
    pub most: R,
    /// True if `most` is proved to be the largest size.
    pub known: bool,
}

impl<R: Real> Extreme<R> {
    /// The extreme of an arc. If `once`, the arc is known to have a single extremum, with the value `turned`.
    #[inline(always)]
    pub fn new(arc: &Arc<R>, once: bool, turned: R) -> Self {
        let ends = R::larger(arc.begin[0].abs(), arc.end[0].abs());
        let monotone = arc.is_monotone();
        let turned = R::larger(turned.abs(), ends);
        let most = if monotone { ends } else { turned };
        Self { limit: arc.limit(), most, known: monotone | once }
    }

    /// The larger of the largest size and `least`; `None` if the largest size is not known.
    #[inline(always)]
    pub fn largest(&self, least: R) -> Option<R> {
        if self.limit < least {
            return Some(least);
        }
        self.known.then(|| R::larger(self.most, least))
    }
}

/// A quantity whose largest size can be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// x.
    Displacement,
    /// ẍ + a_g.
    Acceleration,
}

/// The energies that a motion exchanges with the outside, as integrals, per primary mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Losses<R = f64> {
    /// Energy lost in the structure's damper.
    pub viscous: R,
    /// Energy lost in the absorber's own damper: the pivot of a pendulum, or a dashpot in the gap.
    pub pivot: R,
    /// Work done by the force and by the base.
    pub work: R,
}

laned!(Losses, ManyLosses { viscous: f64, pivot: f64, work: f64 });

/// The extrema of x within a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turns<R = f64> {
    /// None: x is monotonic.
    Never,
    /// One: its time h after the begin of the motion, and x there.
    Once(R, R),
    /// Not decided without a search.
    Unknown,
}

/// A motion at one instant.
#[derive(Debug, Clone, Copy)]
pub struct Seen<State, R = f64> {
    /// The state.
    pub state: State,
    /// Displacement and velocity of the structure.
    pub primary: Point<R>,
    /// Gap displacement and velocity.
    pub gap: GapPoint<R>,
    /// Absolute acceleration ẍ + a_g of the structure.
    pub acceleration: R,
}

/// Smooth motion from one state, exact for 0 ≤ h ≤ `reach`.
pub trait Motion {
    /// The number type of its values.
    type Real: Real;
    /// The state at one instant of the motion.
    type State: Copy + std::fmt::Debug;
    /// True for a stick episode, in which the absorber rides on a wall.
    const RIDING: bool;
    /// The state at h = 0.
    fn origin(&self) -> &Self::State;
    /// The largest h for which this motion is exact.
    fn reach(&self) -> Self::Real;
    /// The state at h.
    fn state(&self, h: Self::Real) -> Self::State;
    /// The state at h with more digits: the end of the motion, from which the run goes on.
    fn arrival(&self, h: Self::Real) -> Self::State {
        self.state(h)
    }
    /// The state at h, as far as [`Motion::clears`] and [`Motion::meets`] look at it.
    fn ahead(&self, h: Self::Real) -> Self::State {
        self.arrival(h)
    }
    /// The state at h, of which that ahead is known.
    fn completed(&self, _h: Self::Real, ahead: &Self::State) -> Self::State {
        *ahead
    }
    /// The result of a flight of this length, or of a first part of it, if a proof in closed form decides it; `None`:
    /// nothing is proved.
    fn fast_path(&self, _length: Self::Real) -> Option<FastFlight<Self::State, Self::Real>> {
        None
    }
    /// True if it is proved at once that the absorber at hand, one of several, meets no wall on the way to the state after
    /// this length, or stays on the one that it is stuck to.
    fn clears(&self, _length: Self::Real, _end: &Self::State) -> bool {
        false
    }
    /// Instant and wall of the contact of the absorber at hand on the way to that state, if it is proved at once that there is
    /// exactly one. The instant leaves a distance of rounding size.
    fn meets(&self, _length: Self::Real, _end: &Self::State) -> Option<(Self::Real, Side)> {
        None
    }
    /// The extrema of x in a motion of this length to this state, if they are found without a search.
    fn turns(&self, _length: Self::Real, _end: &Self::State) -> Turns<Self::Real> {
        Turns::Unknown
    }
    /// Primary displacement and its derivatives at h.
    fn primary(&self, h: Self::Real) -> Jet<Self::Real>;
    /// Absolute acceleration ẍ + a_g of the structure at h. By default that of a structure whose base is at
    /// rest.
    fn acceleration(&self, h: Self::Real) -> Self::Real {
        self.primary(h).curvature
    }
    /// Absolute acceleration of the structure at h where an absorber rides; `None` where the structure moves as one.
    fn acceleration_at(&self, _absorber: usize, _h: Self::Real) -> Option<Self::Real> {
        None
    }
    /// Gap displacement and velocity at h.
    fn gap(&self, h: Self::Real) -> GapPoint<Self::Real>;
    /// Displacement and velocity of structure and gap at h.
    fn place(&self, h: Self::Real) -> (Point<Self::Real>, GapPoint<Self::Real>) {
        let Jet { value: x, rate: v, .. } = self.primary(h);
        (Point { x, v }, self.gap(h))
    }
    /// All of one instant, from one evaluation of the motion where that is possible.
    fn seen(&self, h: Self::Real) -> Seen<Self::State, Self::Real> {
        let (primary, gap) = self.place(h);
        Seen { state: self.state(h), primary, gap, acceleration: self.acceleration(h) }
    }
    /// The wall that the absorber is stuck on; `None` in flight.
    fn wall(&self) -> Option<Wall>;
    /// How many absorbers move. What is said of the absorber above and below is that of the one at hand.
    #[inline(always)]
    fn absorbers(&self) -> usize {
        1
    }
    /// [`Motion::gap`] of the absorber of this index.
    #[inline(always)]
    fn gap_of(&self, _absorber: usize, h: Self::Real) -> GapPoint<Self::Real> {
        self.gap(h)
    }
    /// [`Motion::wall`] of the absorber of this index.
    #[inline(always)]
    fn wall_of(&self, _absorber: usize) -> Option<Wall> {
        self.wall()
    }
    /// Energy lost and work done from 0 to h.
    fn losses(&self, h: Self::Real) -> Losses<Self::Real>;
    /// ∫x² dh between two values of h; 0 where the absorber offers no power series.
    fn square(&self, _h: [Self::Real; 2]) -> Self::Real {
        Self::Real::ZERO
    }
    /// The larger of `least` and the largest size of a quantity in a motion of this length to this state;
    /// `None` if it is not known.
    fn largest(
        &self,
        _of: Quantity,
        _least: Self::Real,
        _length: Self::Real,
        _end: &Self::State,
    ) -> Option<Self::Real> {
        None
    }
    /// The larger of `least` and the largest size of a quantity between two values of h, from the power series of the
    /// motion.
    fn largest_between(&self, of: Quantity, h: [Self::Real; 2], least: Self::Real) -> Self::Real {
        let rows = self.rows().or_else(|| self.travel().map(|travel| travel.rows));
        let Some(rows) = rows else { return least };
        let row = match of {
            Quantity::Displacement => &rows.x,
            Quantity::Acceleration => &rows.acceleration,
        };
        largest(&row[..=rows.order], h.map(|h| h / rows.step), least)
    }
    /// [`Motion::largest`], or else [`Motion::largest_between`].
    fn largest_of(
        &self,
        of: Quantity,
        least: Self::Real,
        length: Self::Real,
        end: &Self::State,
    ) -> Self::Real {
        let most = self.largest(of, least, length, end);
        most.unwrap_or_else(|| self.largest_between(of, [Self::Real::ZERO, length], least))
    }
    /// The power series of the structure's motion; `None` if the motion is evaluated in another way.
    fn rows(&self) -> Option<Rows<Self::Real>> {
        None
    }
    /// The power series of structure, gap and absorber, for any motion; `None` where the absorber offers
    /// none.
    fn travel(&self) -> Option<Travel<Self::Real>> {
        None
    }
    /// [`Motion::travel`] of the absorber of this index.
    #[inline(always)]
    fn travel_of(&self, _absorber: usize) -> Option<Travel<Self::Real>> {
        self.travel()
    }
    /// Bounds on the accelerations of structure, gap and absorber in a motion of this length; `None` where none is known
    /// at once.
    fn accelerations(&self, _length: Self::Real) -> Option<Accelerations<Self::Real>> {
        None
    }
}
