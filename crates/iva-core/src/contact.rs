//! The first contact of a flight, with proof that none came earlier.
//!
//! Distances are measured from the wall last touched: the *near* wall is met where D returns to 0,
//! the *far* one where D reaches 2d. Both are searched by [`crate::roots`]; the earlier wins. At
//! the wall that the flight left, D = 0 is no contact: leaving is decided by the sign of the
//! velocity, then acceleration, then jerk, without cool-down time or nudge.

use crate::flight::{Curve, Jet};
use crate::roots::{Node, Searched};

/// Half width of the band around a wall, in units of 2⁻⁵³ of the curve's magnitude (d for the gap),
/// in which an extremum is undecided. Evaluation errs by less (but for the exception in
/// docs/guarantee.md), so that nothing beyond twice this band is ever undecided,
/// and nothing decided is wrong.
pub const UNDECIDED_BAND: f64 = 16.0;

/// Which wall a contact is made with, seen from the wall last touched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The wall last touched.
    Near,
    /// The wall across the gap.
    Far,
}

/// What a stretch of flight ends in.
#[derive(Debug, Clone, Copy)]
pub struct Stretch<T> {
    /// The end: of the stretch, or the contact.
    pub end: Node<T>,
    /// The wall touched; `None`: proof that no wall is met.
    pub contact: Option<Side>,
    /// Grazing extrema within the band, counted as no contact.
    pub undecided: u64,
}

/// Searches a flight from its start up to `length` for its first contact.
pub fn first_contact<C: Curve>(
    flight: &C,
    start: &C::Sample,
    clearance: f64,
    length: f64,
) -> Stretch<C::Sample> {
    let play = 2.0 * clearance;
    let across = |jet: Jet| Jet {
        value: play - jet.value,
        rate: -jet.rate,
        curvature: -jet.curvature,
        jerk: -jet.jerk,
    };
    let fourth = flight.fourth();
    let band = UNDECIDED_BAND * 0.5 * f64::EPSILON * flight.magnitude();
    let near = Searched { curve: flight, view: |jet| jet, fourth, band };
    let far = Searched { curve: flight, view: across, fourth, band };
    let a = Node { h: 0.0, sample: *start, jet: flight.jet(start) };
    let b = near.node(length);
    let (a_far, b_far) = (across(a.jet), across(b.jet));
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
        let end = Node { jet: across(stretch.end.jet), ..stretch.end };
        let search = far.first_zero(&Node { jet: a_far, ..a }, &end);
        if let Some(zero) = search.zero {
            stretch.end = Node { jet: across(zero.jet), ..zero };
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

/// The first instant within `length` at which the pressure of a ride vanishes.
pub fn first_release<C: Curve>(ride: &C, start: &C::Sample, length: f64) -> Stretch<C::Sample> {
    let fourth = ride.fourth();
    let band = UNDECIDED_BAND * 0.5 * f64::EPSILON * ride.magnitude();
    let pressure = Searched { curve: ride, view: |jet| jet, fourth, band };
    let a = Node { h: 0.0, sample: *start, jet: ride.jet(start) };
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
