//! The extrema of x in a motion, by Newton's method on its Taylor series.

use crate::number::real::Real;
use crate::segment::flight::{Arc, Turns};
use crate::segment::quintic::{monomials, root};

/// x and its first five derivatives at one instant.
pub(crate) type Jets<R> = [R; 6];

/// A quintic on [0, 1] whose root is close to the extremum of x in a motion of this length; both ends are
/// given by ẋ, ẍ and x⃛.
#[inline(always)]
pub(crate) fn turn<R: Real>(from: [R; 3], to: [R; 3], length: R) -> [R; 6] {
    let half_square = (length * length) * 0.5;
    let end = |[v, a, j]: [R; 3]| [v, length * a, half_square * j];
    monomials(&end(from), &end(to))
}

/// The extremum of x near the instant `guess` of a motion of this length: when, x there, and whether both are
/// exact to rounding. `sixth` bounds the sixth derivative.
#[inline(always)]
pub(crate) fn turning<R: Real>(
    [value, rate, curvature, jerk, snap, fifth]: Jets<R>,
    sixth: R,
    guess: R,
    length: R,
) -> (R, R, bool) {
    let (jerk, snap, fifth) = (jerk * 0.5, snap * (1.0 / 6.0), fifth * (1.0 / 24.0));
    let mut t = -rate / curvature;
    for _ in 0..2 {
        let speed = rate + t * (curvature + t * (jerk + t * (snap + t * fifth)));
        let slope = curvature + t * (jerk * 2.0 + t * (snap * 3.0 + t * (fifth * 4.0)));
        t -= speed / slope;
    }
    let turn = guess + t;
    let rise = jerk * (1.0 / 3.0) + t * (snap * 0.25 + t * (fifth * 0.2));
    let x = value + t * (rate + t * (curvature * 0.5 + t * rise));
    // Compares the next term of the series with rounding.
    let square = t * t;
    let left_out = sixth * (square * square) * (t.abs() * (1.0 / 120.0));
    let close = left_out <= R::EPSILON * (curvature.abs() * turn);
    (turn, x, close & (turn > 0.0) & (turn < length))
}

/// The extremum of a function in a motion of this length, if it is proved to be the only one. Given are the
/// arc between both ends, a guess with the function there, and a bound on its sixth derivative.
#[inline(always)]
pub(crate) fn turned_once<R: Real>(
    arc: &Arc<R>,
    (guess, jets): (R, Jets<R>),
    sixth: R,
    length: R,
) -> Turned<R> {
    let (h, value, exact) = turning(jets, sixth, guess, length);
    Turned { once: arc.turns_once() & exact, h, value }
}

/// The only extremum of a function in a motion, if `once`: when, and the value there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Turned<R = f64> {
    pub once: bool,
    pub h: R,
    pub value: R,
}

impl<R: Real> Turned<R> {
    #[inline(always)]
    pub fn turns(self) -> Turns<R> {
        if self.once { Turns::Once(self.h, self.value) } else { Turns::Unknown }
    }
}

/// An estimate of the instant of the extremum of x in a motion of this length.
#[inline(always)]
pub(crate) fn guess<R: Real>(from: [R; 3], to: [R; 3], length: R) -> R {
    length * root(&turn(from, to, length))
}
