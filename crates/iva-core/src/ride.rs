//! The absorber stuck on a wall: one mass 1 + μ on the primary's spring and damper, in closed form,
//! until the pressure on the wall changes sign.

use std::fmt::Debug;

use crate::compensated::Sum;
use crate::flight::{Curve, GapPoint, Jet, Motion};
use crate::oscillator::{Increment, Oscillator, Primary};
use crate::system::Wall;

/// A state that can ride: its primary moves on, the rest stays.
pub trait Rider: Copy + Debug {
    /// The primary.
    fn primary(&self) -> &Primary;
    /// The same state with the primary elsewhere.
    fn with_primary(self, primary: Primary) -> Self;
    /// The wall it rides on.
    fn wall(&self) -> Wall;
}

/// What an absorber presses with while it rides: −s · `leverage` · ẍ − `weight`, s the sign of the
/// wall, as the acceleration with which the gap would close if it were free.
#[derive(Debug, Clone, Copy)]
pub struct Pressure {
    /// How much of the primary's acceleration presses: 1 for a free mass.
    pub leverage: f64,
    /// What pulls the absorber off the wall: gravity on a pendulum, 0 for a free mass.
    pub weight: f64,
}

/// The ride from one state.
#[derive(Debug, Clone, Copy)]
pub struct Ride<'a, S> {
    loaded: &'a Oscillator,
    from: S,
    acceleration: Sum,
    clearance: f64,
    pressure: Pressure,
}

impl<'a, S: Rider> Ride<'a, S> {
    /// The ride of an absorber on the oscillator of mass 1 + μ.
    pub fn new(loaded: &'a Oscillator, from: S, clearance: f64, pressure: Pressure) -> Self {
        let acceleration = loaded.acceleration(from.primary());
        Self { loaded, from, acceleration, clearance, pressure }
    }

    fn after(&self, h: f64) -> (Primary, Increment) {
        self.from.primary().after(self.loaded, self.acceleration, h)
    }
}

impl<S: Rider> Motion for Ride<'_, S> {
    type State = S;
    const RIDING: bool = true;

    fn origin(&self) -> &S {
        &self.from
    }

    fn reach(&self) -> f64 {
        self.loaded.reach
    }

    fn state(&self, h: f64) -> S {
        let (primary, _) = self.after(h);
        self.from.with_primary(primary)
    }

    fn primary(&self, h: f64) -> Jet {
        let (primary, increment) = self.after(h);
        primary.jet(self.loaded, self.acceleration.value + increment.acceleration)
    }

    fn gap(&self, _h: f64) -> GapPoint {
        GapPoint { y: self.from.wall().sign() * self.clearance, w: 0.0 }
    }

    fn wall(&self) -> Option<Wall> {
        Some(self.from.wall())
    }

    fn viscous_loss(&self, h: f64) -> f64 {
        let Primary { x, v } = self.from.primary();
        self.loaded.viscous_loss(x.value, v.value, h)
    }
}

impl<S: Rider> Curve for Ride<'_, S> {
    type Sample = S;

    fn sample(&self, h: f64) -> S {
        self.state(h)
    }

    /// The pressure on the wall; the ride ends where it changes sign.
    fn jet(&self, sample: &S) -> Jet {
        let factor = -sample.wall().sign() * self.pressure.leverage;
        let Primary { x, v } = sample.primary();
        let second = self.loaded.next_derivative(x.value, v.value);
        let third = self.loaded.next_derivative(v.value, second);
        let fourth = self.loaded.next_derivative(second, third);
        let fifth = self.loaded.next_derivative(third, fourth);
        Jet {
            value: factor * second - self.pressure.weight,
            rate: factor * third,
            curvature: factor * fourth,
            jerk: factor * fifth,
        }
    }

    /// The magnitude is that of the terms: plain evaluation is precise enough.
    fn precise(&self, h: f64) -> Sum {
        Sum::new(self.jet(&self.state(h)).value)
    }

    /// The fourth derivative of ẍ is x⁽⁶⁾, bounded by Λ⁵ρ.
    fn fourth(&self) -> f64 {
        let Primary { x, v } = self.from.primary();
        let radius = self.loaded.radius(x.value, v.value);
        self.pressure.leverage * self.loaded.growth.powi(5) * radius
    }

    /// ẍ is bounded by Λρ.
    fn magnitude(&self) -> f64 {
        let Primary { x, v } = self.from.primary();
        let radius = self.loaded.radius(x.value, v.value);
        self.pressure.leverage * self.loaded.growth * radius + self.pressure.weight
    }
}
