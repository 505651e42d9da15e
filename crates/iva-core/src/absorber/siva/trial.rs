//! A trial: a stretch of flight of a free mass that is decided in closed form.
//!
//! 1. [`search`]: distance, rate and curvature at both ends of the stretch make a quintic, which proves that no
//!    wall is met, or one wall once, and then gives an estimate of the time ([`super::proof`]).
//! 2. [`land`]: the state at the end of the stretch, or at the estimate, from which the Taylor series leads to
//!    the contact.
//!
//! Both are written for one run and without branches: the event loop makes one trial after another, lanes make
//! those of many runs side by side. A trial that is not decided is followed by one from which the wall is looked
//! for again, or by one of half the length ([`Trial::next`]).
//!
//! The numbers of the state are those of the accuracy tier: double-doubles ([`super::exact`]) or plain doubles
//! ([`crate::absorber::plain::mass`]).

use super::Law;
use super::proof::Quintic;
use crate::absorber::chatter::first_search;
use crate::absorber::plain::State;
use crate::number::arrays::laned;
use crate::number::real::{Real, pick};
use crate::segment::flight::{FastFlight, Meets};
use crate::segment::quintic::root_by;

/// Largest number of times that a trial is halved or a wall looked for again.
pub(crate) const TRIES: usize = 4;

/// A free mass on its structure, in the numbers of one accuracy tier.
pub(crate) trait FreeMass {
    /// The number type.
    type Real: Real;
    /// The state of structure and absorber.
    type State: Copy;
    /// Largest relative change of the rate on the way from the estimate to the contact.
    const STRAIGHT: f64;
    /// Largest error of the series on that way, in units of 2⁻⁵² of rate × time.
    const CLOSE: f64;

    /// Distance to the wall last touched, its rate and its second derivative.
    fn curve(&self, at: &Self::State) -> [Self::Real; 3];
    /// [`FreeMass::curve`] a time h later, with the accuracy of plain numbers.
    fn ahead(&self, from: &Self::State, h: Self::Real) -> [Self::Real; 3];
    /// The state in plain doubles.
    fn in_doubles(at: &Self::State) -> State;
    /// The longest first trial after a rebound with this rate from a wall with this pressure; `over` is 1/clearance.
    #[inline(always)]
    fn rebound(rate: Self::Real, pressure: Self::Real, _over: Self::Real) -> Self::Real {
        first_search(rate, pressure)
    }
    /// Bounds on the fifth and sixth derivative of the distance from a state on.
    fn bounds(&self, from: &Self::State) -> [Self::Real; 2];
    /// The state a time h later, but that what drives it, and A, may have the accuracy of plain numbers:
    /// [`FreeMass::touching`] computes them anew.
    fn nearly(&self, from: &Self::State, h: Self::Real) -> Self::State;
    /// Distance to the wall at `beyond` from the wall last touched, and its first four derivatives.
    fn near(&self, at: &Self::State, beyond: Self::Real) -> [Self::Real; 5];
    /// The state a short time t later, in contact with the near or the far wall. If not `hit`, t is 0 and only its
    /// drive and A may be computed anew.
    fn touching(&self, at: &Self::State, hit: bool, far: bool, t: Self::Real) -> Self::State;
    /// The state a time h later, no wall being met.
    fn arrived(&self, from: &Self::State, h: Self::Real) -> Self::State {
        self.touching(&self.nearly(from, h), false, false, Self::Real::ZERO)
    }
    /// The state after an impact with this approach speed; the same state if not `hit`.
    fn struck(&self, touching: &Self::State, hit: bool, law: &Law<Self::Real>) -> Self::State;
}

/// What is tried: a stretch of this length.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Trial<R = f64> {
    pub length: R,
    /// The time at which a wall is looked for again, known to be met once; 0: both walls are searched for.
    pub again: R,
    /// True if that is the far wall.
    pub far: bool,
}

laned!(Trial, Trials { length: f64, again: f64, far: bool });

/// What is proved about a trial.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sight<R = f64> {
    /// True if no wall is met.
    pub free: bool,
    /// True if one wall is met once.
    pub meets: bool,
    /// True if that is the far wall.
    pub far: bool,
    /// The end of the trial, or the estimated time of the contact.
    pub h: R,
}

laned!(Sight, Sights { free: bool, meets: bool, far: bool, h: f64 });

/// The end of a trial.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Landing<State, R = f64> {
    /// True if the stretch ends in contact with a wall.
    pub hit: bool,
    /// The time from its begin, high and low part.
    pub h: R,
    pub later: R,
    /// The state at its end, before an impact.
    pub end: State,
    /// The time at which the wall is to be looked for again; 0: it is not.
    pub again: R,
}

impl<R: Real> Trial<R> {
    /// A stretch in which both walls are searched for.
    pub fn new(length: R) -> Self {
        Self { length, again: R::ZERO, far: false }
    }

    /// The trial after one that is not decided, if the wall is to be looked for at the time `again`.
    #[inline(always)]
    pub fn next(&self, again: R, far: bool) -> Self {
        let length = pick(again > 0.0, self.length, self.length * 0.5);
        Self { length, again, far }
    }
}

/// Decides whether a trial meets a wall. `over` is 1/clearance, in units of which the quotients stay in the range
/// of single precision.
#[inline(always)]
pub(crate) fn search<M: FreeMass>(
    mass: &M,
    from: &M::State,
    trial: &Trial<M::Real>,
    over: M::Real,
) -> Sight<M::Real> {
    let Trial { length, again, far } = *trial;
    let square = length * length;
    let (first, second) = (length * over, (over * 0.5) * square);
    let scaled =
        |[distance, rate, bend]: [M::Real; 3]| [distance * over, first * rate, second * bend];
    let ends = [scaled(mass.curve(from)), scaled(mass.ahead(from, length))];
    let [_, sixth] = mass.bounds(from);
    let whole = Quintic::of(ends, (sixth * over) * (square * (square * square)));
    let proof = whole.proof();
    let meets_far = proof.meets[1];
    let part = root_by(&whole.meeting(meets_far), M::Real::about);
    let looks = again > 0.0;
    let free = proof.free & !looks;
    let meets = !proof.free & (proof.meets[0] | meets_far) & (part > 0.0) & (part <= 1.0);
    let guess = pick(looks, again, pick(meets, length * part, length * 0.5));
    Sight {
        free,
        meets: meets | looks,
        far: pick(looks, far, meets_far),
        h: pick(free, length, guess),
    }
}

/// Finds the state at the end of a trial, in contact with the wall if it meets one.
#[inline(always)]
pub(crate) fn land<M: FreeMass>(
    mass: &M,
    from: &M::State,
    sight: &Sight<M::Real>,
    length: M::Real,
    [clearance, over]: [M::Real; 2],
) -> Landing<M::State, M::Real> {
    let Sight { meets, far, h, .. } = *sight;
    let at = mass.nearly(from, h);
    let beyond = pick(far, clearance + clearance, M::Real::ZERO);
    let [left, rate, bend, jerk, snap] = mass.near(&at, beyond);
    // Solves left + rate t + ½ bend t² + … = 0 by reversion of the series and one step of Newton's method, for
    // which quotients of a few correct digits suffice.
    let slowness = over * M::Real::about(M::Real::ONE, over * rate);
    let first = -left * slowness;
    let curved = (slowness * 0.5) * (bend * first);
    let cubed = (slowness * (1.0 / 6.0)) * (jerk * (first * first));
    let [minus_two, one] = [M::Real::from(-2.0), M::Real::ONE];
    let t = first * (one - curved.mul_add(curved.mul_add(minus_two, one), cubed));
    let half = bend * 0.5;
    let value = (snap * (1.0 / 24.0)).mul_add(t, jerk * (1.0 / 6.0)).mul_add(t, half);
    let value = value.mul_add(t, rate).mul_add(t, left);
    let slope = (snap * (1.0 / 6.0)).mul_add(t, jerk * 0.5).mul_add(t, bend).mul_add(t, rate);
    let t = t - M::Real::about(over * value, over * slope);
    // Compares the next term of the series with the rounding of rate and distance.
    let [fifth, _] = mass.bounds(from);
    let square = t * t;
    let left_out = fifth * (square * square) * (t.abs() * (1.0 / 120.0));
    let close = (left_out <= (M::Real::EPSILON * M::CLOSE) * (rate.abs() * h))
        & ((slowness * (bend * t)).abs() <= M::STRAIGHT)
        & (t.abs() < h * 0.5)
        & (pick(far, rate, -rate) > 0.0);
    let hit = meets & close;
    let looks_again = meets & !close & (h + t > 0.0) & (h + t <= length);
    let later = pick(hit, t, M::Real::ZERO);
    let end = mass.touching(&at, hit, far, later);
    Landing { hit, h, later, end, again: pick(looks_again, h + t, M::Real::ZERO) }
}

/// The end of a flight of this length, or of a part of it, if that is decided in closed form.
#[inline(always)]
pub(crate) fn fast_flight<M: FreeMass>(
    mass: &M,
    from: &M::State,
    length: M::Real,
    clearance: M::Real,
) -> Option<FastFlight<M::State, M::Real>> {
    let over = M::Real::ONE / clearance;
    let mut trial = Trial::new(length);
    for _ in 0..=TRIES {
        let sight = search(mass, from, &trial, over);
        if sight.free {
            let end = mass.arrived(from, sight.h);
            let (length, later, meets) = (sight.h, M::Real::ZERO, Meets::Nothing);
            return Some(FastFlight { length, later, end, meets });
        }
        if !sight.meets {
            trial = trial.next(M::Real::ZERO, false);
            continue;
        }
        let landing = land(mass, from, &sight, trial.length, [clearance, over]);
        let Landing { hit, h, later, end, again } = landing;
        if hit {
            return Some(FastFlight { length: h, later, end, meets: Meets::Wall });
        }
        if again == 0.0 {
            return None;
        }
        trial = trial.next(again, sight.far);
    }
    None
}
