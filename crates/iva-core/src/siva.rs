//! The single-mass impact absorber: a free mass between two walls (paper, Eqs. 1, 2, 7, 9–14).
//!
//! In flight no force acts on the mass but, where the line of motion is not level, gravity along it, which counts as an
//! acceleration of the base ([`crate::host`]): ẍ₁ = −a_g relative to the base, so the gap y = x₁ − x obeys ÿ = −A with A = ẍ + a_g
//! the absolute acceleration of the structure ([`crate::host`]). With s the sign of the wall last touched and
//! D = d − s y the distance to it, D̈ = s A: starting from D = 0 neither y nor d enters a rebound.

use crate::compensated::DoubleDouble;
use crate::error::{Invalid, number};
use crate::flight::{GapPoint, Jet};
use crate::force::Force;
use crate::host::{DrivenHost, Host, HostState, Phase, Structure, UndrivenHost};
use crate::impact::{self, Impact};
use crate::limits::{Limits, STOPS};
use crate::oscillator::Primary;
use crate::range;
use crate::real::Real;
use crate::system::{Clock, Point, Start, System, Wall};

pub use motion::SivaFlight;
pub use parameters::Parameters;
pub use ride::SivaRide;

pub(crate) mod fast_flight;
pub(crate) mod motion;
mod parameters;
mod ride;

/// A start this close to a wall, in units of 2⁻⁵² d, stands on it.
const ON_WALL_ULPS: f64 = 4.0;

/// A SIVA on its primary system: parameters, and what follows from them for every flight.
#[derive(Debug, Clone, PartialEq)]
pub struct Siva<H: Host = UndrivenHost> {
    mass_ratio: H::Real,
    restitution: H::Real,
    clearance: H::Real,
    /// Share of the gap velocity that the primary gains at an impact.
    pub(crate) impact_share: DoubleDouble<H::Real>,
    /// The same for e = 0, for an absorber that sticks.
    pub(crate) stick_share: DoubleDouble<H::Real>,
    pub(crate) host: H,
}

impl<R: Real> From<Parameters<R>> for Siva<UndrivenHost<R>> {
    fn from(parameters: Parameters<R>) -> Self {
        let Parameters { mass_ratio, damping_ratio, .. } = parameters;
        Self::on(UndrivenHost::new(damping_ratio, mass_ratio), &parameters)
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

    /// The same absorber under a force and under gravity G = g sin α along its motion, in ωn² × length, with displacements
    /// measured from where the structure rests with the absorber on its lower stop.
    pub fn inclined(&self, gravity: R, force: Force<R>) -> Siva<DrivenHost<R>> {
        let Self { mass_ratio, restitution, clearance, .. } = *self;
        let damping_ratio = self.host.damping_ratio();
        let parameters = Parameters { mass_ratio, restitution, clearance, damping_ratio };
        Siva::on(DrivenHost::new(damping_ratio, mass_ratio, force, gravity), &parameters)
    }
}

impl<R: Real, H: Host<Real = R>> Siva<H> {
    fn on(host: H, parameters: &Parameters<R>) -> Self {
        let Parameters { mass_ratio, restitution, clearance, .. } = *parameters;
        Self {
            mass_ratio,
            restitution,
            clearance,
            impact_share: impact::primary_share(mass_ratio, restitution),
            stick_share: impact::primary_share(mass_ratio, R::ZERO),
            host,
        }
    }

    /// μ = m/M.
    pub fn mass_ratio(&self) -> R {
        self.mass_ratio
    }

    /// Newton's coefficient e on the gap velocity.
    pub fn restitution(&self) -> R {
        self.restitution
    }

    /// What drives it; `None` where nothing can.
    pub fn force(&self) -> Option<&Force<R>> {
        self.host.force()
    }

    /// ζ of the bare primary.
    pub fn damping_ratio(&self) -> R {
        self.host.damping_ratio()
    }

    /// Gravity G = g sin α along the motion, in ωn² × length; 0 where that is level.
    pub fn gravity(&self) -> R {
        self.host.gravity()
    }

    /// How far the absorber is from its lower stop.
    fn height(&self, state: &SivaState<Phase<H>, R>) -> R {
        let from_below = state.side < 0.0;
        if from_below { state.distance.value } else { -state.distance.minus(self.clearance * 2.0) }
    }
}

/// Checks that a start is in [`crate::range`] and lies in a gap of one-sided clearance d.
///
/// # Errors
/// [`Invalid`] naming field, value and allowed range.
pub fn check_start<R: Real>(clearance: R, start: &Start<R>) -> Result<(), Invalid> {
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
    if beyond > R::EPSILON * ON_WALL_ULPS * clearance {
        return Err(Invalid::new(
            "start.gap_displacement",
            number(start.gap_displacement),
            format!("it must lie in the gap, from -{0} to {0}", number(clearance)),
        ));
    }
    Ok(())
}

/// Structure and gap of a SIVA between events.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SivaState<P = (), R = f64> {
    pub(crate) host: HostState<P, R>,
    /// +1 at the wall y = +d, −1 at y = −d: the one that distances are measured from.
    pub(crate) side: R,
    pub(crate) distance: DoubleDouble<R>,
    pub(crate) rate: DoubleDouble<R>,
}

impl<R: Real, P> SivaState<P, R> {
    /// Gap displacement and velocity in a gap of one-sided clearance d.
    #[inline(always)]
    pub(crate) fn gap(&self, clearance: R) -> GapPoint<R> {
        let d = clearance;
        // Certified to stay in the gap; seen from the far wall rounding could say otherwise.
        let y = self.side * (d - self.distance.value);
        GapPoint { y: y.clamp(-d, d), w: self.gap_velocity() }
    }

    /// Gap velocity w = −s Ḋ.
    #[inline(always)]
    pub(crate) fn gap_velocity(&self) -> R {
        -self.side * self.rate.value
    }
}

/// The state after an impact.
#[inline(always)]
pub(crate) fn collided<R: Real, S: Structure<Real = R>>(
    free: &S,
    state: &SivaState<S::Phase, R>,
    share: DoubleDouble<R>,
    restitution: R,
) -> SivaState<S::Phase, R> {
    let primary = state.host.primary.jumped(-state.side, state.rate, share);
    let acceleration = free.acceleration(&state.host.phase, &primary);
    SivaState {
        host: HostState { primary, acceleration, ..state.host },
        rate: state.rate.product(DoubleDouble::new(-restitution)),
        ..*state
    }
}

impl<R: Real, H: Host<Real = R>> System for Siva<H> {
    type Real = R;
    type State = SivaState<Phase<H>, R>;
    type Start = Start<R>;
    type Flight<'a>
        = SivaFlight<'a, H>
    where
        H: 'a;
    type Ride<'a>
        = SivaRide<'a, H>
    where
        H: 'a;

    fn clearance(&self) -> R {
        self.clearance
    }

    fn rebound_ratio(&self) -> R {
        self.restitution
    }

    fn pressure_gain(&self) -> R {
        self.host.damping_ratio() * 2.0 * self.impact_share.value
    }

    fn stops(&self, limits: &Limits<R>) -> [R; STOPS] {
        limits.stops()
    }

    fn check_start(&self, start: &Start<R>) -> Result<(), Invalid> {
        check_start(self.clearance, start)
    }

    fn begin_at(&self, start: &Start<R>, time: Clock<R>) -> Self::State {
        let primary = Primary {
            x: DoubleDouble::new(start.displacement),
            v: DoubleDouble::new(start.velocity),
        };
        // Seen from the wall that the absorber is nearest to or heads for, so that a mirrored
        // start runs through mirrored numbers.
        let host = self.host.state(self.host.begin_at(time), primary);
        let seen =
            [start.gap_displacement, start.gap_velocity, -host.acceleration.value, start.velocity];
        let side = seen
            .into_iter()
            .chain(self.host.leaning(&host.phase))
            .find(|value| *value != 0.0)
            .unwrap_or(R::ONE);
        let s = if side > 0.0 { R::ONE } else { -R::ONE };
        let distance = DoubleDouble::new(self.clearance).plus(-s * start.gap_displacement);
        let touching = distance.value <= R::EPSILON * ON_WALL_ULPS * self.clearance;
        SivaState {
            host,
            side: s,
            distance: if touching { DoubleDouble::ZERO } else { distance },
            rate: DoubleDouble::new(-s * start.gap_velocity),
        }
    }

    #[inline]
    fn flight(&self, state: &Self::State) -> SivaFlight<'_, H> {
        SivaFlight::new(self, *state)
    }

    fn ride(&self, state: &Self::State) -> SivaRide<'_, H> {
        SivaRide::new(self, *state)
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
            (-state.distance.minus(self.clearance * 2.0), state.rate.negated())
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

    fn impact(&self, state: &Self::State, time: R) -> (Self::State, Impact<R>) {
        let s = state.side;
        let approach = -state.rate.value;
        let after = collided(self.host.free(), state, self.impact_share, self.restitution);
        let impact = Impact {
            time,
            wall: self.wall(state),
            displacement: state.host.primary.x.value,
            velocity_before: state.host.primary.v.value,
            velocity_after: after.host.primary.v.value,
            gap_velocity_before: s * approach,
            gap_velocity_after: after.gap_velocity(),
            lever: R::ONE,
            energy_loss: impact::energy_loss(self.mass_ratio, self.restitution, approach),
        };
        (after, impact)
    }

    fn stick(&self, state: &Self::State) -> (Self::State, R) {
        let loss = impact::energy_loss(self.mass_ratio, R::ZERO, state.rate.value);
        let primary = state.host.primary.jumped(-state.side, state.rate, self.stick_share);
        let host = self.host.state(state.host.phase, primary);
        let stuck =
            SivaState { host, distance: DoubleDouble::ZERO, rate: DoubleDouble::ZERO, ..*state };
        (stuck, loss)
    }

    fn release(&self, state: &Self::State) -> (Self::State, R) {
        // Release is where A = 0: written into x, the pressure is exactly 0.
        let HostState { primary: Primary { x, v }, phase, .. } = state.host;
        let left = (x - self.host.balanced(&phase, v)).value;
        let [jerk, ..] = self.host.free().derivatives(&phase, v.value, R::ZERO);
        let later = impact::delay(left, -jerk, R::ZERO);
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

    fn primary(&self, state: &Self::State) -> Point<R> {
        let Primary { x, v } = state.host.primary;
        Point { x: x.value, v: v.value }
    }

    fn is_driven(&self) -> bool {
        self.host.force().is_some_and(Force::lasts)
    }

    fn moves_base(&self) -> bool {
        self.host.force().is_some_and(Force::moves_base)
    }

    fn largest_base(&self, between: [R; 2]) -> Option<R> {
        self.host.force()?.largest_base(between)
    }

    fn smooth_for(&self, state: &Self::State) -> R {
        self.host.smooth_for(&state.host.phase)
    }

    fn due(&self, state: &Self::State) -> Option<R> {
        self.host.due(&state.host.phase)
    }

    fn apply_impulse(&self, state: &Self::State, velocity: R, stuck: bool) -> Self::State {
        let phase = self.host.after_impulse(&state.host.phase);
        let Primary { x, v } = state.host.primary;
        let mass = DoubleDouble::new(R::ONE).plus(self.mass_ratio);
        let gained = if stuck {
            DoubleDouble::new(velocity).over_sum(mass)
        } else {
            DoubleDouble::new(velocity)
        };
        let host = self.host.state(phase, Primary { x, v: v + gained });
        let rate = if stuck { state.rate } else { state.rate.plus(state.side * velocity) };
        SivaState { host, rate, ..*state }
    }

    fn energy(&self, state: &Self::State) -> R {
        let Point { x, v } = self.primary(state);
        let absorber = v + state.gap_velocity();
        let moving = (x * x + v * v) * 0.5 + self.mass_ratio * 0.5 * (absorber * absorber);
        let gravity = self.host.gravity();
        if gravity == 0.0 {
            return moving;
        }
        moving + self.mass_ratio * gravity * self.height(state)
    }
}

#[cfg(test)]
mod tests;
