//! The pendulum impact absorber: a pendulum on the primary system between two walls (paper, Eqs. 3–6 and
//! 15–17 with their misprints corrected; large angles, point bob or compound pendulum).
//!
//! The gap displacement is y = b sinθ, where b is the distance from the pivot to the point of contact, with
//! walls at ±d. A torsional spring may hold it in its pivot ([`Spring`](crate::segment::taylor::Spring)). A flight is a Taylor series
//! ([`crate::segment::taylor`]). Stuck on a wall the pendulum moves as one mass with the primary
//! ([`crate::absorber::ride`]), until gravity, the spring or the primary pulls it off.

use crate::absorber::impact::{Impact, delay};
use crate::absorber::ride::{Ride, Stuck};
use crate::absorber::{Absorber, Angle, Clock, Wall};
use crate::error::Invalid;
use crate::force::Force;
use crate::host::oscillator::Primary;
use crate::host::{DrivenHost, Host, HostState, Phase, Structure, UndrivenHost};
use crate::number::arrays::laned;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;
use crate::segment::flight::Jet;
use crate::segment::taylor::{Pendulum, Series};

pub(crate) use contact::distance;
pub use motion::PivaFlight;
pub(crate) use motion::{Known, PARTS};
pub use parameters::{Angles, ImpactLaw, Parameters};
pub use start::{Given, PivaStart};
pub use state::PivaState;
pub(crate) use state::PivaStates;

use accuracy::Accuracy;
pub(crate) use accuracy::Sizes;
pub(crate) use impact_law::Law;
pub(crate) use step::STEEP;

pub(crate) mod accuracy;
mod contact;
mod gap;
mod impact_law;
pub(crate) mod integrals;
mod motion;
mod on_structure;
mod parameters;
mod start;
mod state;
pub(crate) mod step;

/// The walls of a pendulum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stops<R = f64> {
    /// cosθ at the walls.
    pub cosine: DoubleDouble<R>,
    /// True if the pendulum is so close to horizontal at the walls that cosθ determines the distance better than y,
    /// which hardly changes with the angle there.
    pub steep: bool,
}

laned!(Stops, ManyStops { cosine: DoubleDouble, steep: bool });

/// A pendulum absorber on its primary system.
#[derive(Debug, Clone, PartialEq)]
pub struct Piva<H: Host = UndrivenHost> {
    pub(crate) parameters: Parameters<H::Real>,
    pub(crate) pendulum: Pendulum<H::Real>,
    pub(crate) stops: Stops<H::Real>,
    /// r² d + σ² b θ at a wall: how strongly gravity and the spring pull the pendulum off it.
    pull: DoubleDouble<H::Real>,
    /// The impact laws at wall + and at wall −.
    laws: [Law<H::Real>; 2],
    pub(crate) accuracy: Accuracy<H::Real>,
    pub(crate) host: H,
}

impl<R: Real> Piva<UndrivenHost<R>> {
    /// A pendulum absorber.
    ///
    /// # Errors
    /// [`Invalid`] naming field, value and allowed range.
    pub fn new(parameters: Parameters<R>) -> Result<Self, Invalid> {
        parameters.check()?;
        let pendulum = parameters.pendulum();
        let Pendulum { mass_ratio, damping_ratio, small_angles, spring, .. } = pendulum;
        let clearance = parameters.clearance;
        let wall = DoubleDouble::new(clearance);
        let wall_cosine = pendulum.precise_cosine(wall);
        let pull = DoubleDouble::new(pendulum.frequency_squared).times(clearance);
        let pull = pull + pendulum.arc(wall, wall_cosine).times(spring.acting());
        let law = Law::new(&parameters, parameters.restitution, &pendulum, wall_cosine);
        Ok(Self {
            parameters,
            pendulum,
            stops: Stops { cosine: wall_cosine, steep: parameters.has_steep_walls() },
            pull,
            laws: [law; 2],
            // At small angles full accuracy costs little, so it does not depend on the tolerance; nor does that of
            // pendulums with a spring, whose lanes have one order.
            accuracy: Accuracy::of(if small_angles || spring.acts {
                R::ZERO
            } else {
                parameters.tolerance
            }),
            host: UndrivenHost::new(damping_ratio, mass_ratio),
        })
    }

    /// The same absorber on the same structure under a force.
    pub fn under(&self, force: Force<R>) -> Piva<DrivenHost<R>> {
        let Self { parameters, pendulum, stops, pull, laws, accuracy, .. } = *self;
        let Parameters { damping_ratio, mass_ratio, .. } = parameters;
        let host = DrivenHost::new(damping_ratio, mass_ratio, force, R::ZERO);
        Piva { parameters, pendulum, stops, pull, laws, accuracy, host }
    }
}

impl<R: Real, H: Host<Real = R>> Piva<H> {
    /// The same absorber with another restitution at the wall −.
    ///
    /// # Errors
    /// [`Invalid`] for one outside [0, 1].
    pub fn with_restitution_minus(mut self, restitution: R) -> Result<Self, Invalid> {
        range::restitution("absorber.restitution_minus", restitution)?;
        let Self { parameters, pendulum, stops, .. } = &self;
        self.laws[1] = Law::new(parameters, restitution, pendulum, stops.cosine);
        Ok(self)
    }

    /// The impact law at a wall.
    pub(crate) fn law(&self, wall: Wall) -> &Law<R> {
        &self.laws[wall.index()]
    }

    /// Newton's coefficient e on the gap velocity, at a wall.
    pub fn restitution(&self, wall: Wall) -> R {
        self.law(wall).restitution
    }

    /// The parameters it was made from; their restitution is that of wall +.
    pub fn parameters(&self) -> &Parameters<R> {
        &self.parameters
    }

    /// The force that drives the structure; `None` for one that cannot be driven.
    pub fn force(&self) -> Option<&Force<R>> {
        self.host.force()
    }

    /// True if the pendulum can reach its walls: d < b, or small angles, where y is not limited.
    pub fn stop_reachable(&self) -> bool {
        self.pendulum.small_angles || self.parameters.clearance < self.parameters.contact_distance
    }

    /// θ at wall +; π/2 where the pendulum cannot reach it.
    pub fn wall_angle(&self) -> R {
        let Parameters { clearance, contact_distance, .. } = self.parameters;
        let sine = clearance / contact_distance;
        let small = self.pendulum.small_angles;
        if small { sine } else { R::atan2(sine, self.stops.cosine.value) }
    }

    /// Acceleration of gravity g = κ L r², in ωn² × length.
    pub fn gravity(&self) -> R {
        let Parameters { inertia_ratio, length, frequency_ratio, .. } = self.parameters;
        inertia_ratio * length * (frequency_ratio * frequency_ratio)
    }

    /// θ in a state.
    pub(crate) fn angle_of<P>(&self, state: &PivaState<P, R>) -> R {
        let sine = state.y().value / self.pendulum.contact_distance;
        if self.pendulum.small_angles { sine } else { R::atan2(sine, state.cosine.value) }
    }

    /// The first Taylor coefficients of the flight from a state, in powers of t.
    #[inline(always)]
    pub(crate) fn beginning<const LENGTH: usize>(
        &self,
        state: &PivaState<Phase<H>, R>,
    ) -> Series<R, LENGTH> {
        let drive = self.host.drive_ahead(&state.phase);
        let series = self.pendulum.beginning(&state.swing(&self.pendulum), drive.as_ref());
        at_rest_on_release(state, series)
    }

    /// A at the release from a wall: Ẇ = 0 there, so β c A + r² y + σ² φ = 0.
    fn release_acceleration(&self, wall: Wall) -> DoubleDouble<R> {
        let pull = self.pull.times(-wall.sign());
        pull.over_sum(self.stops.cosine.times(self.pendulum.coupling))
    }
}

/// Sets Ẇ and ÿ to 0 right after a release: their rounding errors could send the pendulum back into the wall.
fn at_rest_on_release<R: Real, P, const LENGTH: usize>(
    state: &PivaState<P, R>,
    mut series: Series<R, LENGTH>,
) -> Series<R, LENGTH> {
    if state.released {
        (series.w[1], series.y[2]) = (R::ZERO, R::ZERO);
    }
    series
}

impl<R: Real, H: Host<Real = R>> Absorber for Piva<H> {
    type Start = PivaStart<R>;
    type Flight<'a>
        = PivaFlight<'a, H>
    where
        H: 'a;
    type Ride<'a>
        = Ride<'a, Self>
    where
        H: 'a;

    fn clearance(&self) -> R {
        self.parameters.clearance
    }

    fn lever(&self) -> R {
        self.pendulum.lever
    }

    fn check_start(&self, start: &PivaStart<R>) -> Result<(), Invalid> {
        self.check(start)
    }

    fn begin_at(&self, start: &PivaStart<R>, time: Clock<R>) -> Self::State {
        self.first_state(start, time)
    }

    fn flight(&self, state: &Self::State) -> PivaFlight<'_, H> {
        PivaFlight::new(self, *state)
    }

    fn ride(&self, state: &Self::State) -> Ride<'_, Self> {
        Ride::new(self, *state)
    }

    fn wall(&self, state: &Self::State) -> Wall {
        state.wall
    }

    fn distance(&self, state: &Self::State) -> Jet<R> {
        contact::distance(state, &self.beginning(state))
    }

    fn touch(&self, state: &Self::State, wall: Wall) -> (Self::State, R) {
        let (touching, later) = self.stops.touching(state, wall, &self.beginning(state));
        let phase = self.host.free().later(&state.phase, later);
        (PivaState { phase, ..touching }, later)
    }

    fn release(&self, state: &Self::State) -> (Self::State, R) {
        // The wall stops pressing where x is at the balance for the A of a release.
        let Primary { x, v } = state.primary;
        let Parameters { damping_ratio, mass_ratio, .. } = self.parameters;
        let acceleration = self.release_acceleration(state.wall);
        let pull = acceleration * DoubleDouble::new(R::ONE).plus(mass_ratio);
        let balanced = |v| self.host.balanced(&state.phase, v) - pull;
        // A force changes the pressure as well, and much faster than x does, so the correction of x says
        // nothing about the instant then.
        let left = if self.host.is_driven() { R::ZERO } else { (x - balanced(v)).value };
        let rate = v.value + damping_ratio * 2.0 * acceleration.value;
        let later = delay(left, rate, acceleration.value);
        let v = v.plus(acceleration.value * later);
        let primary = Primary { x: balanced(v), v };
        let (distance, w) = (DoubleDouble::ZERO, DoubleDouble::ZERO);
        let phase = self.host.free().later(&state.phase, later);
        (PivaState { phase, primary, distance, w, released: true, ..*state }, later)
    }

    fn walls_reachable(&self) -> bool {
        self.stop_reachable()
    }

    fn angle(&self, state: &Self::State) -> Option<Angle<R>> {
        let rate = state.w.value / self.pendulum.contact_distance;
        Some(Angle { value: self.angle_of(state), rate })
    }

    fn impact_angles(&self, impact: &Impact<R>) -> Option<[Angle<R>; 2]> {
        let value = self.wall_angle() * impact.wall.sign();
        let lever = self.stops.cosine.value * self.pendulum.contact_distance;
        let angle = |w: R| Angle { value, rate: w / lever };
        Some([impact.gap_velocity_before, impact.gap_velocity_after].map(angle))
    }
}

impl<R: Real, H: Host<Real = R>> Stuck for Piva<H> {
    type Host = H;

    fn structure_of(state: &Self::State) -> Primary<R> {
        state.primary
    }

    fn with_structure(state: &Self::State, structure: HostState<Phase<H>, R>) -> Self::State {
        let HostState { phase, primary, .. } = structure;
        PivaState { phase, primary, ..*state }
    }

    /// −s β cosθ A − r² d − σ² b |θ|: gravity and the spring pull the pendulum off the wall.
    fn pressure(&self, wall: Wall) -> [R; 2] {
        let factor = self.pendulum.coupling * self.stops.cosine.value * -wall.sign();
        [factor, -self.pull.value]
    }
}
