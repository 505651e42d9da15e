//! The first contact of a flight, with proof that none came earlier.
//!
//! Distances are measured from the wall last touched: the *near* wall is met where D returns to 0,
//! the *far* one where D reaches 2d. Both are searched by [`crate::roots`]; the earlier wins. At
//! the wall that the flight left, D = 0 is no contact: leaving is decided by the sign of the
//! velocity, then acceleration, then jerk, without cool-down time or nudge.

use crate::flight::{Curve, Jet, Side};
use crate::real::Real;
use crate::roots::{DOUBT, Node, Searched, highest_change};

/// Half width of the band around a wall in which an extremum is undecided, in units of 2⁻⁵³ of the
/// curve's magnitude (d for the gap).
pub const UNDECIDED_BAND: f64 = 16.0;

/// What a stretch of flight ends in.
#[derive(Debug, Clone, Copy)]
pub struct Stretch<T, R = f64> {
    /// The end: of the stretch, or the contact.
    pub end: Node<T, R>,
    /// The wall touched; `None`: proof that no wall is met.
    pub contact: Option<Side>,
    /// Grazing extrema within the band, counted as no contact.
    pub undecided: u64,
}

/// Searches a flight from its start up to `length` for its first contact.
pub fn first_contact<R: Real, C: Curve<Real = R>>(
    flight: &C,
    start: &C::Sample,
    clearance: R,
    length: R,
) -> Stretch<C::Sample, R> {
    let jet = flight.jet(start);
    let fourth = flight.fourth();
    let size = flight.magnitude();
    // A flight that starts from a wall is exact to rounding of its own height over it.
    let height = if jet.value == 0.0 { size.min(highest(&jet, fourth, length)) } else { size };
    let near = searched(flight, (R::ZERO, R::ONE), fourth, height);
    let far = searched(flight, (clearance * 2.0, -R::ONE), fourth, size);
    let a = Node { h: R::ZERO, sample: *start, jet };
    let b = near.node(length);
    let (a_far, b_far) = (far.seen(&a.jet), far.seen(&b.jet));
    let mut stretch = Stretch { end: b, contact: None, undecided: 0 };
    if !near.excluded(&a.jet, &b.jet, length) {
        let search = near.first_zero(&a, &b);
        stretch.undecided = search.undecided;
        if let Some(zero) = search.zero {
            stretch.end = zero;
            stretch.contact = Some(Side::Near);
        }
    }
    if !far.excluded(&a_far, &b_far, length) {
        let end = Node { jet: far.seen(&stretch.end.jet), ..stretch.end };
        let search = far.first_zero(&Node { jet: a_far, ..a }, &end);
        if let Some(zero) = search.zero {
            stretch.end = Node { jet: flight.jet(&zero.sample), ..zero };
            stretch.contact = Some(Side::Far);
            if stretch.undecided > 0 {
                // Only what grazes the near wall before the contact counts.
                stretch.undecided = near.first_zero(&a, &stretch.end).undecided;
            }
        }
        stretch.undecided += search.undecided;
    }
    stretch
}

/// A flight of this length that meets no wall, because none can be reached.
pub fn free_stretch<R: Real, C: Curve<Real = R>>(flight: &C, length: R) -> Stretch<C::Sample, R> {
    let sample = flight.sample(length);
    let end = Node { h: length, sample, jet: flight.jet(&sample) };
    Stretch { end, contact: None, undecided: 0 }
}

/// The first instant within `length` at which the pressure of a ride vanishes.
pub fn first_release<R: Real, C: Curve<Real = R>>(
    ride: &C,
    start: &C::Sample,
    length: R,
) -> Stretch<C::Sample, R> {
    let pressure = searched(ride, (R::ZERO, R::ONE), ride.fourth(), ride.magnitude());
    let a = Node { h: R::ZERO, sample: *start, jet: ride.jet(start) };
    let b = pressure.node(length);
    let mut stretch = Stretch { end: b, contact: None, undecided: 0 };
    if !pressure.excluded(&a.jet, &b.jet, length) {
        let search = pressure.first_zero(&a, &b);
        stretch.undecided = search.undecided;
        if let Some(zero) = search.zero {
            stretch.end = zero;
            stretch.contact = Some(Side::Near);
        }
    }
    stretch
}

fn searched<R: Real, C: Curve<Real = R>>(
    curve: &C,
    (level, sign): (R, R),
    fourth: R,
    magnitude: R,
) -> Searched<'_, C> {
    let unit = R::EPSILON * 0.5 * magnitude;
    Searched { curve, level, sign, fourth, band: unit * UNDECIDED_BAND, doubt: unit * DOUBT }
}

/// What a function does not exceed within `length`.
fn highest<R: Real>(jet: &Jet<R>, fourth: R, length: R) -> R {
    jet.value.abs() + highest_change(jet, fourth, length)
}
