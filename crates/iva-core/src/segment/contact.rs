//! The first contact of a flight, with proof that none came earlier.
//!
//! Distances D are measured from the wall last touched. The *near* wall, the one last touched, is met where D
//! returns to 0; the *far* wall, across the gap, where D reaches 2d. Both zeros are searched by
//! [`crate::segment::roots`]; the earlier one is the contact. At the wall that the flight left, D = 0 is no contact:
//! whether the absorber leaves is decided by the sign of the velocity, then acceleration, then jerk, without
//! waiting time or displacement.

use crate::number::real::Real;
use crate::segment::enclosure::Enclosure;
use crate::segment::flight::{Curve, Jet, Side};
use crate::segment::quintic::{monomials, root};
use crate::segment::roots::{DOUBT, Node, Searched, highest_change};

/// Half width of the band around a wall in which an extremum is undecided, in units of 2⁻⁵³ of the
/// curve's magnitude (d for the gap).
pub const UNDECIDED_BAND: f64 = 16.0;

/// The result of the search over one stretch of motion.
#[derive(Debug, Clone, Copy)]
pub struct Stretch<R = f64> {
    /// The end of the stretch, or the contact if there is one.
    pub end: R,
    /// The wall touched; `None` if it is proved that no wall is met.
    pub contact: Option<Side>,
    /// Number of grazing extrema within [`UNDECIDED_BAND`], counted as no contact.
    pub undecided: u64,
}

/// Searches a flight from its start up to `length` for its first contact. The walls are 2 `half_play` apart; of one wall only it is ∞.
pub fn first_contact<R: Real, C: Curve<Real = R>>(
    flight: &C,
    half_play: R,
    length: R,
) -> Stretch<R> {
    let jet = flight.first();
    let fourth = flight.fourth();
    let size = flight.magnitude();
    // A flight that starts at a wall, or close to it, has rounding errors in proportion to its own height over that wall.
    let close = jet.value.abs() <= flight.near();
    let height = if close { size.min(highest(&jet, fourth, length)) } else { size };
    let near = searched(flight, (R::ZERO, R::ONE), fourth, height);
    let far = searched(flight, (half_play * 2.0, -R::ONE), fourth, size);
    let a = Node { h: R::ZERO, jet };
    let b = near.node(length);
    let [a_far, b_far] = [&a, &b].map(|node| Node { jet: far.seen(&node.jet), ..*node });
    let mut stretch = Stretch { end: length, contact: None, undecided: 0 };
    let mut last = b_far;
    if !near.excluded(&a.jet, &b.jet, length) {
        let search = near.first_zero(&a, &b);
        stretch.undecided = search.undecided;
        if let Some(zero) = search.zero {
            (stretch.end, stretch.contact) = (zero.h, Some(Side::Near));
            last = Node { jet: far.seen(&zero.jet), ..zero };
        }
    }
    if half_play.is_finite() && !far.excluded(&a_far.jet, &b_far.jet, length) {
        let search = far.first_zero(&a_far, &last);
        if let Some(zero) = search.zero {
            (stretch.end, stretch.contact) = (zero.h, Some(Side::Far));
            if stretch.undecided > 0 {
                // The search over the whole stretch also counted grazings after the contact.
                stretch.undecided = near.first_zero(&a, &near.node(zero.h)).undecided;
            }
        }
        stretch.undecided += search.undecided;
    }
    stretch
}

/// True if it is proved at once, from distance and rate at both ends of a flight of this length and from the bound on the fourth
/// derivative, that no wall is met: by the Bernstein coefficients of the cubic between them, which the distance leaves by
/// no more than t² (L − t)²/24 times the bound. At the wall that the flight left these coefficients count over t (L − t).
#[inline(always)]
pub fn stays_clear<R: Real>(ends: [[R; 2]; 2], clearance: R, fourth: R, length: R) -> bool {
    stays_clear_by(ends, clearance, clearance, fourth, length)
}

/// [`stays_clear`] for distances that are differences of numbers of this size.
#[inline(always)]
pub(crate) fn stays_clear_by<R: Real>(
    ends: [[R; 2]; 2],
    clearance: R,
    size: R,
    fourth: R,
    length: R,
) -> bool {
    let doubt = R::EPSILON * 0.5 * DOUBT * size;
    let square = length * length;
    let bent = (square * square) * fourth * (1.0 / 384.0);
    let third = length * (1.0 / 3.0);
    let inner = |[[a, a_rate], [b, b_rate]]: [[R; 2]; 2]| [a + third * a_rate, b - third * b_rate];
    let [[begin, _], [end, _]] = ends;
    let [b1, b2] = inner(ends);
    let least = begin.min(b1).min(b2).min(end);
    // t² (L − t)²/24 over t (L − t) is a quarter of L²/24 at most; the coefficients are three times b1 and b2.
    let left =
        (begin == 0.0) & (b1.min(b2).min(end) > doubt) & (b1.min(b2) * 3.0 > bent * 4.0 + doubt);
    let near = left | (least > bent + doubt);
    let wide = clearance * 2.0;
    let across = ends.map(|[value, rate]| [wide - value, -rate]);
    let [c1, c2] = inner(across);
    let least = across[0][0].min(c1).min(c2).min(across[1][0]);
    near & (least > bent + doubt)
}

/// The wall of the contact in a flight of this length, and its distance, if it is proved at once that there is exactly one: the
/// distance falls all the way to below the near wall, or rises all the way to beyond the far one. Values and rates at both
/// ends, of distances that are differences of numbers of this size, and a bound on the fourth derivative.
#[inline(always)]
pub fn only_contact<R: Real>(
    ends: [[R; 2]; 2],
    clearance: R,
    size: R,
    fourth: R,
    length: R,
) -> Option<(Side, R)> {
    let [near, far] = only_contacts(ends, clearance, size, fourth, length);
    if near {
        return Some((Side::Near, R::ZERO));
    }
    far.then_some((Side::Far, clearance * 2.0))
}

/// [`only_contact`] without branches: whether it is with the near wall, and with the far one.
#[inline(always)]
pub(crate) fn only_contacts<R: Real>(
    [values, rates]: [[R; 2]; 2],
    clearance: R,
    size: R,
    fourth: R,
    length: R,
) -> [bool; 2] {
    let doubt = R::EPSILON * 0.5 * DOUBT * size;
    let ([begin, end], wide) = (values, clearance * 2.0);
    let way = Enclosure::new(values, rates, length, fourth);
    // Doubts of a rate are those of a distance over a share of the length.
    let unsure = doubt * 64.0 / length;
    let near = (begin > doubt) & (end < -doubt) & way.falls(unsure);
    let within = ((begin == 0.0) | (begin > doubt)) & (begin < wide - doubt);
    [near, within & (end > wide + doubt) & way.rises(unsure)]
}

/// The last step of Newton's method to a contact, over the length of the flight: the next would be its square.
const CLOSE: f64 = 1e-7;

/// The instant at which the distance of a flight comes to a level, of which values, rates and second derivatives at both
/// ends tell that it does once: the root of the quintic between them, corrected by Newton's method. `off`: distance from the
/// level, and rate, at an instant.
#[inline(always)]
pub fn meeting<R: Real>(
    ends: [[R; 2]; 2],
    bends: [R; 2],
    level: R,
    length: R,
    off: impl Fn(R) -> [R; 2],
) -> Option<R> {
    let (h, close) = nearest(ends, bends, level, length, off);
    close.then_some(h)
}

/// [`meeting`] without branches: the instant, and whether it is close enough.
#[inline(always)]
pub(crate) fn nearest<R: Real>(
    [[begin, end], [rate, end_rate]]: [[R; 2]; 2],
    bends: [R; 2],
    level: R,
    length: R,
    off: impl Fn(R) -> [R; 2],
) -> (R, bool) {
    let half_square = length * length * 0.5;
    let quintic = monomials(
        &[begin - level, length * rate, half_square * bends[0]],
        &[end - level, length * end_rate, half_square * bends[1]],
    );
    let mut h = length * root(&quintic);
    let mut step = R::INFINITY;
    for _ in 0..2 {
        let [left, rate] = off(h);
        step = left / rate;
        h -= step;
    }
    (h, (step.abs() <= length * CLOSE) & (h > 0.0) & (h < length))
}

/// True if a stick episode of this length surely does not end: the same for the pressure, whose terms have this size.
#[inline(always)]
pub fn keeps_pressing<R: Real>(ends: [[R; 2]; 2], size: R, fourth: R, length: R) -> bool {
    let [[begin, rate], [end, end_rate]] = ends;
    let square = length * length;
    let bent = (square * square) * fourth * (1.0 / 384.0);
    let third = length * (1.0 / 3.0);
    let least = begin.min(begin + third * rate).min(end - third * end_rate).min(end);
    least > bent + R::EPSILON * 0.5 * DOUBT * size
}

/// Searches a stick episode up to `length` for its release, the first instant at which the pressure on the wall
/// vanishes; it is returned as the contact, with [`Side::Near`].
pub fn first_release<R: Real, C: Curve<Real = R>>(ride: &C, length: R) -> Stretch<R> {
    let pressure = searched(ride, (R::ZERO, R::ONE), ride.fourth(), ride.magnitude());
    let a = Node { h: R::ZERO, jet: ride.first() };
    let b = pressure.node(length);
    let mut stretch = Stretch { end: length, contact: None, undecided: 0 };
    if !pressure.excluded(&a.jet, &b.jet, length) {
        let search = pressure.first_zero(&a, &b);
        stretch.undecided = search.undecided;
        if let Some(zero) = search.zero {
            (stretch.end, stretch.contact) = (zero.h, Some(Side::Near));
        }
    }
    stretch
}

pub(super) fn searched<R: Real, C: Curve<Real = R>>(
    curve: &C,
    (level, sign): (R, R),
    fourth: R,
    magnitude: R,
) -> Searched<'_, C> {
    let unit = R::EPSILON * 0.5 * magnitude;
    Searched { curve, level, sign, fourth, band: unit * UNDECIDED_BAND, doubt: unit * DOUBT }
}

/// A bound on the size of a function within `length`.
pub(super) fn highest<R: Real>(jet: &Jet<R>, fourth: R, length: R) -> R {
    jet.value.abs() + highest_change(jet, fourth, length)
}
