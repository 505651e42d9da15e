//! The single-mass impact absorber: a free mass between two walls (paper, Eqs. 1, 2, 7, 9–14).
//!
//! In flight ẍ + 2ζẋ + x = 0 and ẍ₁ = 0, so the gap y = x₁ − x obeys ÿ = −ẍ. With s the sign of
//! the wall last touched and D = d − s y the distance to it, D̈ = s ẍ: starting from D = 0 neither
//! y nor d enters a rebound.

use std::sync::{Arc, OnceLock};

use crate::compensated::Sum;
use crate::error::{Invalid, number};
use crate::flight::Jet;
use crate::impact::{self, Impact};
use crate::limits::{Limits, STOPS};
use crate::oscillator::{Oscillator, Primary};
use crate::range;
use crate::real::{ONE, Real, STRIDES, ZERO, dispatched};
use crate::system::{Point, Start, Stride, System, Wall};

pub use motion::SivaFlight;
pub use ride::SivaRide;

pub(crate) mod motion;
mod ride;
pub(crate) mod stride;

/// A start this close to a wall, in units of 2⁻⁵² d, stands on it.
const ON_WALL_ULPS: f64 = 4.0;

/// Checked parameters of a SIVA on its primary system, in natural units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    mass_ratio: Real,
    restitution: Real,
    clearance: Real,
    damping_ratio: Real,
}

impl Parameters {
    /// Mass ratio μ > 0, restitution e in [0, 1], one-sided clearance d > 0, and the damping ratio
    /// ζ ≥ 0 of the primary, within the bounds of [`crate::range`].
    ///
    /// # Errors
    /// [`Invalid`] naming field, value and allowed range.
    pub fn new(
        mass_ratio: Real,
        restitution: Real,
        clearance: Real,
        damping_ratio: Real,
    ) -> Result<Self, Invalid> {
        range::mass_ratio("absorber.mass_ratio", mass_ratio)?;
        range::positive("absorber.clearance", clearance)?;
        range::restitution("absorber.restitution", restitution)?;
        range::damping_ratio("primary.damping_ratio", damping_ratio)?;
        Ok(Self { mass_ratio, restitution, clearance, damping_ratio })
    }

    /// μ = m/M.
    pub fn mass_ratio(&self) -> Real {
        self.mass_ratio
    }

    /// Newton's coefficient e on the gap velocity.
    pub fn restitution(&self) -> Real {
        self.restitution
    }

    /// One-sided clearance d.
    pub fn clearance(&self) -> Real {
        self.clearance
    }

    /// ζ of the bare primary.
    pub fn damping_ratio(&self) -> Real {
        self.damping_ratio
    }
}

/// A SIVA on its primary system: parameters, and what follows from them for every flight.
#[derive(Debug, Clone, PartialEq)]
pub struct Siva {
    mass_ratio: Real,
    restitution: Real,
    clearance: Real,
    damping_ratio: Real,
    /// Share of the gap velocity that the primary gains at an impact.
    pub(crate) impact_share: Sum,
    /// The same where the absorber sticks.
    pub(crate) stick_share: Sum,
    /// The primary by itself; made by the first flight, and shared with scenes that run beside this.
    pub(crate) free: OnceLock<Arc<Oscillator>>,
    /// Of the mass 1 + μ; made where the absorber sticks.
    loaded: OnceLock<Box<Oscillator>>,
}

impl From<Parameters> for Siva {
    fn from(parameters: Parameters) -> Self {
        let Parameters { mass_ratio, restitution, clearance, damping_ratio } = parameters;
        Self {
            mass_ratio,
            restitution,
            clearance,
            damping_ratio,
            impact_share: impact::primary_share(mass_ratio, restitution),
            stick_share: impact::primary_share(mass_ratio, ZERO),
            free: OnceLock::new(),
            loaded: OnceLock::new(),
        }
    }
}

impl Siva {
    /// A SIVA from mass ratio μ, restitution e, one-sided clearance d and the damping ratio ζ of
    /// its primary.
    ///
    /// # Errors
    /// As [`Parameters::new`].
    pub fn new(
        mass_ratio: Real,
        restitution: Real,
        clearance: Real,
        damping_ratio: Real,
    ) -> Result<Self, Invalid> {
        Parameters::new(mass_ratio, restitution, clearance, damping_ratio).map(Self::from)
    }

    /// The primary in flight.
    #[inline(always)]
    pub(crate) fn free(&self) -> &Oscillator {
        self.shared()
    }

    /// The primary in flight, to share.
    #[inline(always)]
    pub(crate) fn shared(&self) -> &Arc<Oscillator> {
        self.free.get_or_init(|| Arc::new(Oscillator::new(ONE, self.damping_ratio)))
    }

    /// The primary with the absorber stuck to it.
    pub(crate) fn loaded(&self) -> &Oscillator {
        self.loaded
            .get_or_init(|| Box::new(Oscillator::new(1.0 + self.mass_ratio, self.damping_ratio)))
    }

    /// μ = m/M.
    pub fn mass_ratio(&self) -> Real {
        self.mass_ratio
    }

    /// Newton's coefficient e on the gap velocity.
    pub fn restitution(&self) -> Real {
        self.restitution
    }

    /// ζ of the bare primary.
    pub fn damping_ratio(&self) -> Real {
        self.damping_ratio
    }
}

/// Checks that a start is in [`crate::range`] and lies in a gap of one-sided clearance d.
///
/// # Errors
/// [`Invalid`] naming field, value and allowed range.
pub fn check_start(clearance: Real, start: &Start) -> Result<(), Invalid> {
    let fields = [
        ("start.displacement", start.displacement),
        ("start.velocity", start.velocity),
        ("start.gap_displacement", start.gap_displacement),
        ("start.gap_velocity", start.gap_velocity),
    ];
    for (field, value) in fields {
        range::size(field, value)?;
    }
    let beyond = start.gap_displacement.abs() - clearance;
    if beyond > ON_WALL_ULPS * Real::EPSILON * clearance {
        return Err(Invalid::new(
            "start.gap_displacement",
            number(start.gap_displacement),
            format!("it must lie in the gap, from -{0} to {0}", number(clearance)),
        ));
    }
    Ok(())
}

/// Primary and gap of a SIVA between events.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SivaState {
    pub(crate) primary: Primary,
    /// ẍ in free motion, small against x and ẋ where the two balance.
    pub(crate) acceleration: Sum,
    /// +1 at the wall y = +d, −1 at y = −d: the one that distances are measured from.
    pub(crate) side: Real,
    pub(crate) distance: Sum,
    pub(crate) rate: Sum,
}

impl SivaState {
    /// Gap velocity w = −s Ḋ.
    pub(crate) fn gap_velocity(&self) -> Real {
        -self.side * self.rate.value
    }
}

/// The state after an impact.
#[inline(always)]
pub(crate) fn collided(
    free: &Oscillator,
    state: &SivaState,
    share: Sum,
    restitution: Real,
) -> SivaState {
    let primary = state.primary.kicked(-state.side, state.rate, share);
    SivaState {
        primary,
        acceleration: free.acceleration(&primary),
        rate: state.rate.product(Sum::new(-restitution)),
        ..*state
    }
}

impl System for Siva {
    type State = SivaState;
    type Start = Start;
    type Flight<'a> = SivaFlight<'a>;
    type Ride<'a> = SivaRide<'a>;

    fn clearance(&self) -> Real {
        self.clearance
    }

    fn rebound_ratio(&self) -> Real {
        self.restitution
    }

    fn pressure_gain(&self) -> Real {
        self.free().damping * self.impact_share.value
    }

    fn stops(&self, limits: &Limits) -> [Real; STOPS] {
        limits.stops()
    }

    fn check_start(&self, start: &Start) -> Result<(), Invalid> {
        check_start(self.clearance, start)
    }

    fn begin(&self, start: &Start) -> (SivaState, bool) {
        let primary = Primary { x: Sum::new(start.displacement), v: Sum::new(start.velocity) };
        // Seen from the wall that the absorber is nearest to or heads for, so that a mirrored
        // start runs through mirrored numbers.
        let acceleration = self.free().acceleration(&primary);
        let side =
            [start.gap_displacement, start.gap_velocity, -acceleration.value, start.velocity]
                .into_iter()
                .find(|value| *value != 0.0)
                .unwrap_or(ONE);
        let s = if side > 0.0 { ONE } else { -ONE };
        let distance = Sum::new(self.clearance).plus(-s * start.gap_displacement);
        let touching = distance.value <= ON_WALL_ULPS * Real::EPSILON * self.clearance;
        let state = SivaState {
            primary,
            acceleration,
            side: s,
            distance: if touching { Sum::ZERO } else { distance },
            rate: Sum::new(-s * start.gap_velocity),
        };
        (state, touching)
    }

    #[inline]
    fn flight(&self, state: &SivaState) -> SivaFlight<'_> {
        SivaFlight::new(self, *state)
    }

    #[inline]
    fn stride(&self, state: &SivaState, length: Real) -> Option<Stride<SivaState>> {
        if STRIDES {
            dispatched(
                #[inline(always)]
                || self.strides(state, length),
            )
        } else {
            None
        }
    }

    fn ride(&self, state: &SivaState) -> SivaRide<'_> {
        SivaRide::new(self, *state)
    }

    fn wall(&self, state: &SivaState) -> Wall {
        if state.side > 0.0 { Wall::Plus } else { Wall::Minus }
    }

    #[inline]
    fn distance(&self, state: &SivaState) -> Jet {
        let s = state.side;
        Jet {
            value: state.distance.value,
            rate: state.rate.value,
            curvature: s * state.acceleration.value,
            jerk: s * self.free().next_derivative(state.primary.v.value, state.acceleration.value),
        }
    }

    fn touch(&self, state: &SivaState, wall: Wall) -> (SivaState, Real) {
        let (left, rate) = if wall == self.wall(state) {
            (state.distance.value, state.rate)
        } else {
            (-state.distance.minus(2.0 * self.clearance), state.rate.negated())
        };
        let a = state.acceleration.value;
        let later = impact::delay(left, rate.value, a);
        let gained = a * later;
        let Primary { x, v } = state.primary;
        let primary = Primary { x: x.plus(v.value * later), v: v.plus(gained) };
        let side = wall.sign() * ONE;
        let rate = rate.plus(side * gained);
        (SivaState { primary, side, distance: Sum::ZERO, rate, ..*state }, later)
    }

    fn impact(&self, state: &SivaState, time: Real) -> (SivaState, Impact) {
        let s = state.side;
        let approach = -state.rate.value;
        let after = collided(self.free(), state, self.impact_share, self.restitution);
        let impact = Impact {
            time,
            wall: self.wall(state),
            displacement: state.primary.x.value,
            velocity_before: state.primary.v.value,
            velocity_after: after.primary.v.value,
            gap_velocity_before: s * approach,
            gap_velocity_after: after.gap_velocity(),
            lever: ONE,
            energy_loss: impact::energy_loss(self.mass_ratio, self.restitution, approach),
        };
        (after, impact)
    }

    fn stick(&self, state: &SivaState) -> (SivaState, Real) {
        let loss = impact::energy_loss(self.mass_ratio, ZERO, state.rate.value);
        let primary = state.primary.kicked(-state.side, state.rate, self.stick_share);
        let stuck = SivaState {
            primary,
            acceleration: self.free().acceleration(&primary),
            distance: Sum::ZERO,
            rate: Sum::ZERO,
            ..*state
        };
        (stuck, loss)
    }

    fn release(&self, state: &SivaState) -> (SivaState, Real) {
        // Release is where x + 2ζẋ = 0: written into x, the pressure is exactly 0.
        let Primary { x, v } = state.primary;
        let primary = Primary { x: v.times(-self.free().damping), v };
        let released = SivaState {
            primary,
            acceleration: Sum::ZERO,
            distance: Sum::ZERO,
            rate: Sum::ZERO,
            ..*state
        };
        (released, impact::delay((x - primary.x).value, v.value, ZERO))
    }

    fn primary(&self, state: &SivaState) -> Point {
        Point { x: state.primary.x.value, v: state.primary.v.value }
    }

    fn energy(&self, state: &SivaState) -> Real {
        let Point { x, v } = self.primary(state);
        let absorber = v + state.gap_velocity();
        0.5 * (x * x + v * v) + 0.5 * self.mass_ratio * (absorber * absorber)
    }
}

#[cfg(test)]
mod tests;
