//! The law of one impact, and its limit for infinitely many: what an absorber says of them.
//!
//! The formulas that the laws are made of are in [`crate::absorber::impact`], the sum of infinitely many impacts is in
//! [`crate::absorber::chatter`].

use crate::absorber::OnStructure;
use crate::absorber::chatter::Power;
use crate::absorber::impact::{Impact, primary_share};
use crate::number::real::Real;
use crate::segment::place::Wall;

/// The impact law of an absorber at its walls.
pub trait ImpactLaw: OnStructure {
    /// The impact law of the absorber of this index at a wall, for impacts of an approach speed.
    fn law_of(&self, absorber: usize, wall: Wall, approach: Self::Real) -> LawAt<Self::Real>;
    /// [`ImpactLaw::law_of`] a single absorber, or the first of several.
    fn law_at(&self, wall: Wall, approach: Self::Real) -> LawAt<Self::Real> {
        self.law_of(0, wall, approach)
    }
    /// The impulse of an impact of the only absorber over the unit of mass, per approach speed: on a structure that moves as
    /// one the velocity that it gains.
    fn impulse_at(&self, wall: Wall, approach: Self::Real) -> Self::Real {
        self.law_at(wall, approach).gain
    }
    /// The impulse of an impact of one of several absorbers over the unit of mass.
    fn impulse_of(&self, impact: &Impact<Self::Real>) -> Self::Real {
        let gained = impact.absorber_velocity_after() - impact.absorber_velocity_before();
        gained.abs() * self.mass_ratio_of(impact.absorber.into())
    }
    /// Applies the impact law to a state in contact: the state after the impact, and its record.
    fn impact(&self, state: &Self::State, time: Self::Real) -> (Self::State, Impact<Self::Real>);
    /// The state after an infinite tail of rebounds, stuck with the common velocity, and the energy lost in
    /// the tail.
    fn stick(&self, state: &Self::State) -> (Self::State, Self::Real);
}

/// The impact law at one wall, for impacts of one approach speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LawAt<R = f64> {
    /// Newton's coefficient e on the gap velocity.
    pub restitution: R,
    /// The speed of the rebound over the approach speed: the ratio of consecutive rebounds of a chatter.
    pub rebound: R,
    /// Velocity that the structure gains at the wall, per gap velocity.
    pub gain: R,
    /// Rise of the pressure on the wall at an impact, over the approach speed: the damper responds to the jump of the
    /// structure's velocity.
    pub pressure: R,
    /// The derivative of the speed of the rebound with respect to the approach speed.
    pub slope: R,
    /// A bound on how far `rebound` is from this value at any lower approach speed.
    pub spread: R,
    /// b < 1 of a restitution 1 − a uᵇ of a free mass on an oscillator, which holds at all lower speeds u.
    pub power: Option<R>,
}

impl<R: Real> LawAt<R> {
    /// A law that is the same at every approach speed.
    pub fn constant(restitution: R, rebound: R, gain: R, pressure: R) -> Self {
        let spread = R::ZERO;
        Self { restitution, rebound, gain, pressure, slope: rebound, spread, power: None }
    }

    /// The law of a free mass of mass ratio μ whose e depends on the approach speed w: e, de/dw, a bound on how far e
    /// is from this value at any lower approach speed, and the damping ratio ζ of the structure.
    pub fn of_free_mass(
        mass_ratio: R,
        [restitution, rate, spread]: [R; 3],
        approach: R,
        damping_ratio: R,
    ) -> Self {
        let gain = primary_share(mass_ratio, restitution).value;
        let pressure = damping_ratio * 2.0 * gain;
        let slope = restitution + rate * approach;
        Self { slope, spread, ..Self::constant(restitution, restitution, gain, pressure) }
    }

    /// The derivatives of the velocity that the structure gains, and of the speed of the rebound, with respect to the
    /// approach speed. The impulse grows with 1 + e.
    pub fn slopes(&self) -> [R; 2] {
        let Self { rebound, gain, slope, .. } = *self;
        let steeper = if slope == rebound { R::ONE } else { (R::ONE + slope) / (R::ONE + rebound) };
        [gain * steeper, slope]
    }

    /// How the rebounds of a chatter go on by a power law: an impact changes the rate of the pressure by its gain on a spring
    /// of stiffness 1, and by its rise on the damper 2ζ, which is that rise over the gain.
    pub(crate) fn falling(&self) -> Option<Power<R>> {
        let Self { gain, pressure, .. } = *self;
        self.power.map(|exponent| Power { exponent, kick: gain + pressure * pressure / gain })
    }

    /// True if rebounds from this speed on become ever lower.
    pub fn dies_out(&self) -> bool {
        self.power.is_some() || self.rebound + self.spread < 1.0
    }
}
