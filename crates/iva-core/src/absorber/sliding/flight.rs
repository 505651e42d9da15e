//! The slide of a mass in one direction: the flight of a free mass under another gravity.

use super::{Sliding, SlidingState};
use crate::absorber::siva::SivaFlight;
use crate::absorber::{Absorber, Point, Wall};
use crate::host::{DrivenHost, Host, Structure};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::{
    Accelerations, Curve, FastFlight, GapPoint, Jet, Losses, Motion, Quantity, Rows, Seen, Side,
    Travel, Turns,
};

/// The slide from one state, until the mass stops.
#[derive(Debug, Clone)]
pub struct SlidingFlight<'a, R: Real = f64> {
    system: &'a Sliding<R>,
    from: SlidingState<R>,
    flight: SivaFlight<'a, DrivenHost<R>>,
}

impl<'a, R: Real> SlidingFlight<'a, R> {
    pub(super) fn new(system: &'a Sliding<R>, from: &SlidingState<R>) -> Self {
        let flight = system.going(from.direction).flight(&from.seen);
        Self { system, from: *from, flight }
    }

    pub(super) fn begin(&self) -> &SlidingState<R> {
        &self.from
    }

    /// The wall that the mass moves towards.
    pub(super) fn ahead(&self) -> Side {
        if self.from.direction == self.from.seen.side { Side::Near } else { Side::Far }
    }

    pub(super) fn speed(&self) -> Speed<'_, 'a, R> {
        Speed { slide: self }
    }
}

impl<R: Real> Motion for SlidingFlight<'_, R> {
    type Real = R;
    type State = SlidingState<R>;
    const RIDING: bool = false;

    fn origin(&self) -> &SlidingState<R> {
        &self.from
    }

    fn reach(&self) -> R {
        self.flight.reach()
    }

    fn state(&self, h: R) -> SlidingState<R> {
        SlidingState { seen: self.flight.state(h), ..self.from }
    }

    fn arrival(&self, h: R) -> SlidingState<R> {
        SlidingState { seen: self.flight.arrival(h), ..self.from }
    }

    fn primary(&self, h: R) -> Jet<R> {
        self.flight.primary(h)
    }

    fn fast_path(&self, length: R) -> Option<FastFlight<SlidingState<R>, R>> {
        let FastFlight { length, later, end, meets } = self.flight.fast_path(length)?;
        let end = SlidingState { seen: end, ..self.from };
        Some(FastFlight { length, later, end, meets })
    }

    fn acceleration(&self, h: R) -> R {
        self.flight.acceleration(h)
    }

    fn gap(&self, h: R) -> GapPoint<R> {
        self.flight.gap(h)
    }

    fn place(&self, h: R) -> (Point<R>, GapPoint<R>) {
        self.flight.place(h)
    }

    fn seen(&self, h: R) -> Seen<SlidingState<R>, R> {
        let Seen { state, primary, gap, acceleration } = self.flight.seen(h);
        let state = SlidingState { seen: state, ..self.from };
        Seen { state, primary, gap, acceleration }
    }

    fn wall(&self) -> Option<Wall> {
        None
    }

    fn losses(&self, h: R) -> Losses<R> {
        self.flight.losses(h)
    }

    fn square(&self, h: [R; 2]) -> R {
        self.flight.square(h)
    }

    fn largest(&self, of: Quantity, least: R, length: R, end: &SlidingState<R>) -> Option<R> {
        self.flight.largest(of, least, length, &end.seen)
    }

    fn rows(&self) -> Option<Rows<R>> {
        self.flight.rows()
    }

    fn travel(&self) -> Option<Travel<R>> {
        self.flight.travel()
    }

    fn accelerations(&self, length: R) -> Option<Accelerations<R>> {
        self.flight.accelerations(length)
    }

    fn turns(&self, length: R, end: &SlidingState<R>) -> Turns<R> {
        self.flight.turns(length, &end.seen)
    }
}

/// The distance to the wall last touched.
impl<R: Real> Curve for SlidingFlight<'_, R> {
    type Real = R;
    type Sample = SlidingState<R>;

    fn sample(&self, h: R) -> SlidingState<R> {
        self.state(h)
    }

    fn jet(&self, sample: &SlidingState<R>) -> Jet<R> {
        self.flight.jet(&sample.seen)
    }

    fn precise(&self, h: R) -> DoubleDouble<R> {
        self.flight.precise(h)
    }

    fn fourth(&self) -> R {
        self.flight.fourth()
    }

    fn magnitude(&self) -> R {
        self.flight.magnitude()
    }
}

/// The speed |w| of a slide, with ẇ = −A.
#[derive(Debug)]
pub(super) struct Speed<'b, 'a, R: Real> {
    slide: &'b SlidingFlight<'a, R>,
}

impl<R: Real> Curve for Speed<'_, '_, R> {
    type Real = R;
    type Sample = SlidingState<R>;

    fn sample(&self, h: R) -> SlidingState<R> {
        self.slide.state(h)
    }

    fn jet(&self, sample: &SlidingState<R>) -> Jet<R> {
        let SlidingState { seen, direction: s } = sample;
        let [jerk, snap, _] = self.slide.system.rates_of_a(*s, seen);
        Jet {
            value: *s * seen.gap_velocity(),
            rate: -*s * seen.host.acceleration.value,
            curvature: -*s * jerk,
            jerk: -*s * snap,
        }
    }

    /// The sum of the terms up to h³ in double-double. Those from h⁴ on are rounded to plain numbers: an error of a tenth of
    /// 2⁻⁵³ of the magnitude at most, as h is 1.2 at most.
    fn precise(&self, h: R) -> DoubleDouble<R> {
        let SlidingState { seen, direction } = self.slide.state(h);
        let factor = -direction * seen.side;
        DoubleDouble { value: factor * seen.rate.value, rest: factor * seen.rate.rest }
    }

    fn fourth(&self) -> R {
        let SlidingState { seen, direction } = &self.slide.from;
        let free = self.slide.system.going(*direction).host.free();
        free.bound::<3>(&seen.host.primary)
    }

    /// The terms are bounded by the search ([`crate::segment::slide`]), as a slide from rest is as accurate as it is slow.
    fn magnitude(&self) -> R {
        self.slide.from.seen.rate.value.abs()
    }
}
