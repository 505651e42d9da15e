//! A mass at rest on its structure: held in its gap by friction, or on a wall.

use super::{Sliding, SlidingState};
use crate::absorber::ride::Ride;
use crate::absorber::siva::Siva;
use crate::absorber::{Absorber, Wall};
use crate::host::DrivenHost;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::contact::{Stretch, first_release};
use crate::segment::flight::{Curve, GapPoint, Jet, Losses, Motion, Quantity, Rows, Seen, Travel};

/// The motion of structure and mass as one, from one state.
#[derive(Debug, Clone)]
pub struct SlidingRide<'a, R: Real = f64> {
    from: SlidingState<R>,
    ride: Ride<'a, Siva<DrivenHost<R>>>,
    friction: R,
    /// Where the mass is, as a value of y.
    place: R,
    /// Of a held mass: the direction in which it would slide off where the curve is 0.
    off: R,
}

impl<'a, R: Real> SlidingRide<'a, R> {
    pub(super) fn new(system: &'a Sliding<R>, from: &SlidingState<R>) -> Self {
        let siva = system.going(from.direction);
        let ride = siva.ride(&from.seen);
        let place = siva.gap(&from.seen).y;
        Self { from: *from, ride, friction: system.friction, place, off: R::ONE }
    }

    fn is_held(&self) -> bool {
        self.from.is_held()
    }

    /// The first instant within a length at which friction no longer holds the mass, and the direction in which it slides
    /// off.
    pub(super) fn first_slip(&self, length: R) -> (Stretch<SlidingState<R>, R>, R) {
        let off = |off: R| Self { off, ..self.clone() };
        let up = first_release(&off(R::ONE), &self.from, length);
        let whole = if up.contact.is_some() { up.end.h } else { length };
        let down = first_release(&off(-R::ONE), &self.from, whole);
        let undecided = up.undecided + down.undecided;
        if down.contact.is_some() {
            // Grazings of the other limit after the event were counted as well.
            let before = if up.undecided == 0 {
                0
            } else {
                first_release(&off(R::ONE), &self.from, down.end.h).undecided
            };
            (Stretch { undecided: before + down.undecided, ..down }, -R::ONE)
        } else {
            (Stretch { undecided, ..up }, R::ONE)
        }
    }

    /// The same ride, whose curve is 0 where the mass slides off in a direction.
    pub(super) fn sliding_off(&self, off: R) -> Self {
        Self { off, ..self.clone() }
    }
}

impl<R: Real> Motion for SlidingRide<'_, R> {
    type Real = R;
    type State = SlidingState<R>;
    const RIDING: bool = true;

    fn origin(&self) -> &SlidingState<R> {
        &self.from
    }

    fn reach(&self) -> R {
        self.ride.reach()
    }

    fn state(&self, h: R) -> SlidingState<R> {
        SlidingState { seen: self.ride.state(h), ..self.from }
    }

    fn arrival(&self, h: R) -> SlidingState<R> {
        SlidingState { seen: self.ride.arrival(h), ..self.from }
    }

    fn primary(&self, h: R) -> Jet<R> {
        self.ride.primary(h)
    }

    fn acceleration(&self, h: R) -> R {
        self.ride.acceleration(h)
    }

    fn gap(&self, _h: R) -> GapPoint<R> {
        GapPoint { y: self.place, w: R::ZERO }
    }

    fn seen(&self, h: R) -> Seen<SlidingState<R>, R> {
        let Seen { state, primary, acceleration, .. } = self.ride.seen(h);
        let state = SlidingState { seen: state, ..self.from };
        Seen { state, primary, gap: self.gap(h), acceleration }
    }

    fn wall(&self) -> Option<Wall> {
        if self.is_held() { None } else { self.ride.wall() }
    }

    fn losses(&self, h: R) -> Losses<R> {
        self.ride.losses(h)
    }

    fn square(&self, h: [R; 2]) -> R {
        self.ride.square(h)
    }

    fn largest(&self, of: Quantity, least: R, length: R, end: &SlidingState<R>) -> Option<R> {
        self.ride.largest(of, least, length, &end.seen)
    }

    fn rows(&self) -> Option<Rows<R>> {
        self.ride.rows()
    }

    fn travel(&self) -> Option<Travel<R>> {
        let Travel { rows, mut gap, .. } = self.ride.travel()?;
        gap[0] = self.place;
        Some(Travel::new(rows, gap, R::ONE))
    }
}

/// On a wall: the force per unit of mass that keeps the mass from leaving, which is the push of the wall and what friction can add
/// to it. Held: what friction can carry beyond A, R ± A.
impl<R: Real> Curve for SlidingRide<'_, R> {
    type Real = R;
    type Sample = SlidingState<R>;

    fn sample(&self, h: R) -> SlidingState<R> {
        self.state(h)
    }

    fn jet(&self, sample: &SlidingState<R>) -> Jet<R> {
        let jet = self.ride.jet(&sample.seen);
        if !self.is_held() {
            return jet;
        }
        // The ride of a free mass tells −A as seen from the wall last touched.
        let factor = -self.off * self.from.seen.side;
        Jet {
            value: self.friction + factor * jet.value,
            rate: factor * jet.rate,
            curvature: factor * jet.curvature,
            jerk: factor * jet.jerk,
        }
    }

    /// Plain evaluation suffices, because the magnitude is that of the terms.
    fn precise(&self, h: R) -> DoubleDouble<R> {
        DoubleDouble::new(self.jet(&self.state(h)).value)
    }

    fn fourth(&self) -> R {
        self.ride.fourth()
    }

    fn magnitude(&self) -> R {
        let magnitude = self.ride.magnitude();
        if self.is_held() { magnitude + self.friction } else { magnitude }
    }

    fn stays_positive(&self) -> bool {
        if self.is_held() {
            self.friction > self.ride.magnitude() * ABOVE
        } else {
            self.ride.stays_positive()
        }
    }
}

/// A margin for rounding.
const ABOVE: f64 = 1.0 + 1e-9;
