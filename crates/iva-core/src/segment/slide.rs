//! The first event of a slide: a flight in which the gap velocity keeps its sign until the absorber stops.
//!
//! 1. The first zero of the speed is searched ([`crate::segment::roots`]): the stop, or proof that there is none.
//! 2. Until then the speed is positive, so that the distance to the wall ahead only falls: that wall is met if and only if it is
//!    reached at the end of the slide, and is met once. The wall behind is not met.
//!
//! A speed that touches 0 within rounding counts as no stop, and a stop within rounding of the wall ahead counts as no
//! contact; both raise `undecided`. The bands are those of
//! [`UNDECIDED_BAND`](crate::segment::contact::UNDECIDED_BAND), in units of the terms of which the speed, or the
//! distance, is the sum.

use crate::number::real::Real;
use crate::segment::contact::{highest, searched};
use crate::segment::flight::{Curve, Side};
use crate::segment::roots::Node;

/// What a slide ends with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    /// Its length: nothing has happened.
    Length,
    /// Contact with a wall.
    Wall(Side),
    /// The absorber stops in its gap.
    Stop,
}

/// The result of the search over a slide.
#[derive(Debug, Clone, Copy)]
pub struct Slide<R = f64> {
    /// Its end.
    pub h: R,
    /// What it ends with.
    pub ends: Ends,
    /// Number of grazing extrema within the bands, counted as no event.
    pub undecided: u64,
}

/// The result of the search for the end of a ride in which friction holds the absorber.
#[derive(Debug, Clone, Copy)]
pub struct Slip<R = f64> {
    /// Its end.
    pub h: R,
    /// The sign of the gap velocity from there on; `None` if friction holds the absorber all the way.
    pub direction: Option<R>,
    /// Number of grazing extrema within the bands, counted as no event.
    pub undecided: u64,
}

/// Searches a slide from its start up to `length` for its first event. `distance` is that to the wall last touched, `ahead` says
/// whether the absorber moves towards that wall or the far one, and `speed` is |w|, ≥ 0 at the start but for rounding.
pub fn first_end<R: Real, D, V>(
    (distance, speed): (&D, &V),
    ahead: Side,
    clearance: R,
    length: R,
) -> Slide<R>
where
    D: Curve<Real = R>,
    V: Curve<Real = R>,
{
    let jet = speed.first();
    let fourth = speed.fourth();
    let stops = searched(speed, (R::ZERO, R::ONE), fourth, highest(&jet, fourth, length));
    let a = Node { h: R::ZERO, jet };
    let b = stops.node(length);
    let (mut slide, mut last) = (Slide { h: length, ends: Ends::Length, undecided: 0 }, b);
    if !stops.excluded(&a.jet, &b.jet, length) {
        let search = stops.first_zero(&a, &b);
        slide.undecided = search.undecided;
        if let Some(zero) = search.zero {
            (last, slide.h, slide.ends) = (zero, zero.h, Ends::Stop);
        }
    }
    let jet = distance.first();
    let (whole, fourth) = (distance.magnitude(), distance.fourth());
    let (level, sign, size) = match ahead {
        Side::Near => (R::ZERO, R::ONE, whole.min(highest(&jet, fourth, slide.h))),
        Side::Far => (clearance * 2.0, -R::ONE, whole),
    };
    let left = searched(distance, (level, sign), fourth, size);
    let end = Node { jet: left.seen(&distance.jet(last.h)), ..last };
    let value = left.value(&end);
    let stopped = slide.ends == Ends::Stop;
    if value > if stopped { left.band } else { R::ZERO } {
        return slide;
    }
    if stopped && value >= -left.band {
        slide.undecided += 1;
        return slide;
    }
    let begin = Node { h: R::ZERO, jet: left.seen(&jet) };
    let met = left.refine(&begin, &end, None);
    if slide.undecided > 0 {
        // The search over the whole slide also counted speeds after the contact.
        slide.undecided = stops.first_zero(&a, &stops.node(met.h)).undecided;
    }
    Slide { h: met.h, ends: Ends::Wall(ahead), ..slide }
}
