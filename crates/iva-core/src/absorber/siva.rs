//! The single-mass impact absorber: a free mass between two walls (paper, Eqs. 1, 2, 7, 9–14).
//!
//! In flight no force acts on the mass, except gravity where the line of motion is inclined; gravity counts
//! as an acceleration of the base ([`crate::host`]). So ẍ₁ = −a_g relative to the base, and the gap
//! y = x₁ − x obeys ÿ = −A with A = ẍ + a_g the absolute acceleration of the structure. With s the sign of
//! the wall last touched and D = d − s y the distance to it, D̈ = s A: neither y nor d enters a rebound,
//! which starts from D = 0.

use std::any::TypeId;

use crate::absorber::impact;
use crate::absorber::plain::Scene;
use crate::absorber::restitution::RestitutionLaw;
use crate::absorber::ride::{Ride, Stuck};
use crate::absorber::{Absorber, Clock, Coasted, Coasts, Start, Wall};
use crate::error::Invalid;
use crate::force::Force;
use crate::host::oscillator::Primary;
use crate::host::{DrivenHost, Host, HostState, Phase, Structure, UndrivenHost};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;
use crate::segment::flight::{GapPoint, Jet};

pub use free_mass::FreeMass;
pub(crate) use impact_law::Law;
pub use motion::SivaFlight;
pub use parameters::Parameters;
pub use state::SivaState;
pub(crate) use state::collided;

pub(crate) mod coasts;
pub(crate) mod exact;
pub(crate) mod free_mass;
mod impact_law;
pub(crate) mod motion;
mod on_structure;
mod parameters;
mod passage;
mod pieces;
pub(crate) mod proof;
mod state;
pub(crate) mod trial;

/// A free mass (SIVA) on its primary system: its parameters and constants derived from them.
#[derive(Debug, Clone, PartialEq)]
pub struct Siva<H: Host = UndrivenHost> {
    pub(crate) mass: FreeMass<H::Real>,
    /// Share of the gap velocity that the primary gains when the absorber sticks: that for e = 0.
    pub(crate) stick_share: DoubleDouble<H::Real>,
    pub(crate) host: H,
}

impl<R: Real> From<Parameters<R>> for Siva<UndrivenHost<R>> {
    fn from(parameters: Parameters<R>) -> Self {
        let Parameters { mass_ratio, restitution, clearance, damping_ratio } = parameters;
        Self {
            mass: FreeMass::checked(mass_ratio, restitution, clearance),
            stick_share: impact::primary_share(mass_ratio, R::ZERO),
            host: UndrivenHost::new(damping_ratio, mass_ratio),
        }
    }
}

impl<R: Real> Siva<UndrivenHost<R>> {
    /// A SIVA from mass ratio μ, restitution e, one-sided clearance d and the damping ratio ζ of
    /// its primary.
    ///
    /// # Errors
    /// As [`Parameters::new`].
    pub fn new(
        mass_ratio: R,
        restitution: R,
        clearance: R,
        damping_ratio: R,
    ) -> Result<Self, Invalid> {
        Parameters::new(mass_ratio, restitution, clearance, damping_ratio).map(Self::from)
    }

    /// The same absorber on the same structure under a force.
    pub fn under(&self, force: Force<R>) -> Siva<DrivenHost<R>> {
        self.inclined(R::ZERO, force)
    }

    /// The same absorber under a force and under gravity G = g sin α along its motion, in ωn² × length.
    /// Displacements are measured from the position of rest with the absorber on its lower stop.
    pub fn inclined(&self, gravity: R, force: Force<R>) -> Siva<DrivenHost<R>> {
        let Self { mass, stick_share, .. } = *self;
        let host = DrivenHost::new(self.host.damping_ratio(), mass.mass_ratio, force, gravity);
        Siva { mass, stick_share, host }
    }
}

impl<R: Real, H: Host<Real = R>> Siva<H> {
    /// The same absorber with another restitution at the wall −.
    ///
    /// # Errors
    /// [`Invalid`] for one outside [0, 1].
    pub fn with_restitution_minus(self, restitution: R) -> Result<Self, Invalid> {
        Ok(Self { mass: self.mass.with_restitution_minus(restitution)?, ..self })
    }

    /// The same absorber with a restitution that depends on the approach speed, by one law at both walls.
    pub fn with_restitution_law(self, law: RestitutionLaw<R>) -> Self {
        self.with_restitution_laws([law; 2])
    }

    /// The same absorber with a restitution that depends on the approach speed, at wall + and at wall −.
    pub fn with_restitution_laws(self, laws: [RestitutionLaw<R>; 2]) -> Self {
        Self { mass: self.mass.with_restitution_laws(laws), ..self }
    }

    /// True if the restitution depends on the approach speed at a wall. Such absorbers run one by one: lanes read a
    /// constant e.
    pub fn varies(&self) -> bool {
        self.mass.varies()
    }

    /// The same absorber in a gap whose middle is at y = `offset`.
    ///
    /// # Errors
    /// [`Invalid`] for an offset out of [`crate::range`].
    pub fn with_offset(self, offset: R) -> Result<Self, Invalid> {
        Ok(Self { mass: self.mass.with_offset(offset)?, ..self })
    }

    /// The impact law at the wall with this sign.
    #[inline(always)]
    pub(crate) fn law(&self, side: R) -> &Law<R> {
        self.mass.law(side)
    }

    /// The impact laws at wall + and at wall −.
    pub(crate) fn laws(&self) -> &[Law<R>; 2] {
        &self.mass.laws
    }

    /// μ = m/M.
    pub fn mass_ratio(&self) -> R {
        self.mass.mass_ratio
    }

    /// Newton's coefficient e on the gap velocity, at a wall: that of approach speed 0 where it depends on the speed.
    pub fn restitution(&self, wall: Wall) -> R {
        self.law(R::from(wall.sign())).restitution
    }

    /// The middle of the gap, as a value of y.
    pub fn offset(&self) -> R {
        self.mass.offset
    }

    /// The force that drives the structure; `None` for one that cannot be driven.
    pub fn force(&self) -> Option<&Force<R>> {
        self.host.force()
    }

    /// Damping ratio ζ of the primary without absorber.
    pub fn damping_ratio(&self) -> R {
        self.host.damping_ratio()
    }

    /// Gravity G = g sin α along the motion, in ωn² × length; 0 where the motion is level.
    pub fn gravity(&self) -> R {
        self.host.gravity()
    }

    /// Gap displacement and velocity.
    pub(crate) fn gap(&self, state: &SivaState<Phase<H>, R>) -> GapPoint<R> {
        let GapPoint { y, w } = state.gap(self.mass.clearance);
        GapPoint { y: self.mass.offset + y, w }
    }

    /// Distance of the absorber from its lower stop.
    fn height(&self, state: &SivaState<Phase<H>, R>) -> R {
        let from_below = state.side < 0.0;
        if from_below {
            state.distance.value
        } else {
            -state.distance.minus(self.mass.clearance * 2.0)
        }
    }
}

/// Checks that a start is in [`crate::range`] and in a gap of one-sided clearance d with middle at `offset`.
///
/// # Errors
/// [`Invalid`] naming field, value and allowed range.
pub fn check_start<R: Real>(clearance: R, offset: R, start: &Start<R>) -> Result<(), Invalid> {
    let fields = [
        ("start.displacement", start.displacement),
        ("start.velocity", start.velocity),
        ("start.gap_displacement", start.gap_displacement),
        ("start.gap_velocity", start.gap_velocity),
    ];
    for (field, value) in fields {
        range::size(field, value)?;
    }
    free_mass::check_place(
        "start.gap_displacement",
        start.gap_displacement,
        [offset - clearance, offset + clearance],
        clearance + offset.abs(),
    )
}

impl<R: Real, H: Host<Real = R>> Absorber for Siva<H> {
    type Start = Start<R>;
    type Flight<'a>
        = SivaFlight<'a, H>
    where
        H: 'a;
    type Ride<'a>
        = Ride<'a, Self>
    where
        H: 'a;

    fn clearance(&self) -> R {
        self.mass.clearance
    }

    fn offset(&self) -> R {
        self.mass.offset
    }

    fn check_start(&self, start: &Start<R>) -> Result<(), Invalid> {
        check_start(self.mass.clearance, self.mass.offset, start)
    }

    fn begin_at(&self, start: &Start<R>, time: Clock<R>) -> Self::State {
        let primary = Primary {
            x: DoubleDouble::new(start.displacement),
            v: DoubleDouble::new(start.velocity),
        };
        let host = self.host.state(self.host.begin_at(time), primary);
        let (y, w) = (start.gap_displacement, start.gap_velocity);
        let leaning = [-host.acceleration.value, start.velocity];
        let leaning = leaning.into_iter().chain(self.host.leaning(&host.phase));
        let (side, distance) = self.mass.begun((DoubleDouble::new(y), w), leaning);
        SivaState { host, side, distance, rate: DoubleDouble::new(-side * w) }
    }

    #[inline]
    fn flight(&self, state: &Self::State) -> SivaFlight<'_, H> {
        SivaFlight::new(self, *state)
    }

    fn ride(&self, state: &Self::State) -> Ride<'_, Self> {
        Ride::new(self, *state)
    }

    fn coasts(&self, state: &Self::State, remaining: R) -> Coasts<Self::State, R> {
        if let Some(pieces) = self.host.pieces() {
            return Some(self.drifts(pieces, state, remaining)).filter(|(count, _)| *count > 0);
        }
        let steps = self.host.steps()?;
        let smooth = self.host.smooth_for(&state.host.phase);
        let within = [1.0 / self.mass.clearance.double(), remaining.min(smooth).double()];
        let count = coasts::count(steps, &state.in_doubles(), within) as usize;
        (count > 0).then(|| (count, self.coasted(state, count)))
    }

    fn coasted(&self, state: &Self::State, count: usize) -> Coasted<Self::State, R> {
        if let Some(pieces) = self.host.pieces() {
            return self.drifted(pieces, state, count);
        }
        let Some(steps) = self.host.steps() else { return (*state, Clock::ZERO) };
        let (by, time) = (steps.responses(count), steps.time(count as f64));
        let mut after = coasts::after(steps, state, count as f64, by);
        after.host.phase = self.host.waited(&state.host.phase, time);
        (after, time)
    }

    fn wall(&self, state: &Self::State) -> Wall {
        if state.side > 0.0 { Wall::Plus } else { Wall::Minus }
    }

    #[inline]
    fn distance(&self, state: &Self::State) -> Jet<R> {
        let (s, HostState { primary, acceleration, phase }) = (state.side, &state.host);
        let [jerk, ..] = self.host.free().derivatives(phase, primary.v.value, acceleration.value);
        Jet {
            value: state.distance.value,
            rate: state.rate.value,
            curvature: s * acceleration.value,
            jerk: s * jerk,
        }
    }

    fn touch(&self, state: &Self::State, wall: Wall) -> (Self::State, R) {
        let (left, rate) = if wall == self.wall(state) {
            (state.distance.value, state.rate)
        } else {
            (-state.distance.minus(self.mass.clearance * 2.0), state.rate.negated())
        };
        let HostState { primary: Primary { x, v }, acceleration, phase } = state.host;
        let a = acceleration.value;
        let later = impact::delay(left, rate.value, a);
        let gained = a * later;
        let [base, ..] = self.host.free().base(&phase);
        let primary = Primary { x: x.plus(v.value * later), v: v.plus(gained - base * later) };
        let side = R::from(wall.sign());
        let rate = rate.plus(side * gained);
        let phase = self.host.free().later(&phase, later);
        let host = HostState { primary, acceleration, phase };
        (SivaState { host, side, distance: DoubleDouble::ZERO, rate }, later)
    }

    fn release(&self, state: &Self::State) -> (Self::State, R) {
        // The release is where A = 0. With x set to the balance, the pressure is exactly 0.
        let HostState { primary: Primary { x, v }, phase, .. } = state.host;
        let left = (x - self.host.balanced(&phase, v)).value;
        let [jerk, snap, _] = self.host.free().derivatives(&phase, v.value, R::ZERO);
        let later = impact::delay(left, -jerk, snap);
        let phase = self.host.free().later(&phase, later);
        let [base, ..] = self.host.free().base(&phase);
        let v = v.plus(-base * later);
        let primary = Primary { x: self.host.balanced(&phase, v), v };
        let host = HostState { primary, acceleration: DoubleDouble::ZERO, phase };
        (
            SivaState { host, distance: DoubleDouble::ZERO, rate: DoubleDouble::ZERO, ..*state },
            later,
        )
    }

    fn forced(&self) -> Option<Scene> {
        let force = self.host.force().filter(|force| force.is_single())?;
        let harmonic = force.harmonics().first()?.in_doubles();
        let in_doubles = TypeId::of::<R>() == TypeId::of::<f64>();
        (in_doubles && self.host.gravity() == 0.0).then(|| Scene {
            damping_ratio: self.damping_ratio().double(),
            mass_ratio: self.mass.mass_ratio.double(),
            clearance: self.mass.clearance.double(),
            offset: self.mass.offset.double(),
            harmonic,
            moves_base: force.moves_base(),
        })
    }
}

impl<R: Real, H: Host<Real = R>> Stuck for Siva<H> {
    type Host = H;

    fn structure_of(state: &Self::State) -> Primary<R> {
        state.host.primary
    }

    fn with_structure(state: &Self::State, host: HostState<Phase<H>, R>) -> Self::State {
        SivaState { host, ..*state }
    }

    /// −s A.
    fn pressure(&self, wall: Wall) -> [R; 2] {
        [R::from(-wall.sign()), R::ZERO]
    }
}

#[cfg(test)]
mod tests;
