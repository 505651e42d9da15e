//! The pendulum impact absorber: a pendulum on the primary system between two walls (paper, Eqs. 3–6 and
//! 15–17 with their misprints corrected; large angles, point bob or compound pendulum).
//!
//! The gap displacement is y = b sinθ, where b is the distance from the pivot to the point of contact, with
//! walls at ±d. A flight is a Taylor series ([`crate::segment::taylor`]). Stuck on a wall the pendulum moves as one
//! mass with the primary, in closed form, until gravity or the primary pulls it off.

use crate::absorber::impact::Impact;
use crate::absorber::system::{Angle, Clock, Point, System, Wall};
use crate::error::Invalid;
use crate::force::{Drive, Force};
use crate::host::oscillator::Primary;
use crate::number::arrays::laned;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;
use crate::segment::flight::Jet;
use crate::segment::taylor::{Pendulum, Series, Swing};

pub(crate) use contact::distance;
pub use motion::PivaFlight;
pub(crate) use motion::{Known, PARTS};
pub use parameters::{Angles, ImpactLaw, Parameters};
pub use ride::PivaRide;
pub use start::{Given, PivaStart};

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
mod parameters;
mod ride;
mod start;
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
pub struct Piva<R = f64> {
    pub(crate) parameters: Parameters<R>,
    pub(crate) pendulum: Pendulum<R>,
    pub(crate) stops: Stops<R>,
    /// The impact laws at wall + and at wall −.
    laws: [Law<R>; 2],
    pub(crate) accuracy: Accuracy<R>,
    /// The force that drives the structure.
    force: Force<R>,
}

impl<R: Real> Piva<R> {
    /// A pendulum absorber.
    ///
    /// # Errors
    /// [`Invalid`] naming field, value and allowed range.
    pub fn new(parameters: Parameters<R>) -> Result<Self, Invalid> {
        parameters.check()?;
        let Parameters {
            mass_ratio,
            clearance,
            damping_ratio,
            frequency_ratio,
            length,
            inertia_ratio,
            contact_distance,
            pivot_damping_ratio,
            angles,
            ..
        } = parameters;
        let lever = length / contact_distance;
        let pendulum = Pendulum {
            mass_ratio,
            damping_ratio,
            contact_distance,
            inertia_ratio,
            lever,
            coupling: R::ONE / (inertia_ratio * lever),
            frequency_squared: frequency_ratio * frequency_ratio,
            pivot_damping: pivot_damping_ratio * 2.0 * frequency_ratio,
            small_angles: angles == Angles::Small,
        };
        let wall_cosine = pendulum.precise_cosine(DoubleDouble::new(clearance));
        let law = Law::new(&parameters, parameters.restitution, &pendulum, wall_cosine);
        Ok(Self {
            parameters,
            pendulum,
            stops: Stops { cosine: wall_cosine, steep: parameters.has_steep_walls() },
            laws: [law; 2],
            // At small angles full accuracy costs little, so it does not depend on the tolerance.
            accuracy: Accuracy::of(if pendulum.small_angles {
                R::ZERO
            } else {
                parameters.tolerance
            }),
            force: Force::default(),
        })
    }

    /// The same absorber under a force.
    #[must_use]
    pub fn under(self, force: Force<R>) -> Self {
        Self { force, ..self }
    }

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

    /// The force that drives the structure.
    pub fn force(&self) -> &Force<R> {
        &self.force
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
        let Parameters { inertia_ratio, length, .. } = self.parameters;
        inertia_ratio * length * self.pendulum.frequency_squared
    }

    /// Taylor coefficients of the force at a state, of the smooth piece that acts from `from` on; `None`
    /// without a lasting force.
    #[inline(always)]
    pub(crate) fn drive<const LENGTH: usize>(
        &self,
        from: Clock<R>,
        state: &PivaState<R>,
        h: R,
    ) -> Option<Drive<R, LENGTH>> {
        self.force.lasts().then(|| self.force.drive(from, state.time, h))
    }

    /// The first Taylor coefficients of the flight from a state, in powers of t, under the piece of the force
    /// that acts from `from` on.
    #[inline(always)]
    pub(crate) fn beginning<const LENGTH: usize>(
        &self,
        from: Clock<R>,
        state: &PivaState<R>,
    ) -> Series<R, LENGTH> {
        let drive = self.drive(from, state, R::ONE);
        let series = self.pendulum.beginning(&state.swing(), drive.as_ref());
        at_rest_on_release(state, series)
    }

    /// The distance to the wall and its derivatives in free motion, under the piece of the force that acts
    /// from `from` on.
    fn jet(&self, from: Clock<R>, state: &PivaState<R>) -> Jet<R> {
        R::dispatched(
            #[inline(always)]
            || contact::distance(state, &self.beginning(from, state)),
        )
    }
}

/// Sets Ẇ and ÿ to 0 right after a release: their rounding errors could send the pendulum back into the wall.
fn at_rest_on_release<R: Real, const LENGTH: usize>(
    state: &PivaState<R>,
    mut series: Series<R, LENGTH>,
) -> Series<R, LENGTH> {
    if state.released {
        (series.w[1], series.y[2]) = (R::ZERO, R::ZERO);
    }
    series
}

/// The state of primary and pendulum between events.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PivaState<R = f64> {
    /// The instant of the drive.
    pub(crate) time: Clock<R>,
    /// Number of impulses that have acted.
    pub(crate) kicks: u32,
    pub(crate) primary: Primary<R>,
    pub(crate) wall: Wall,
    /// The distance d − s y ≥ 0 to the wall last touched.
    pub(crate) distance: DoubleDouble<R>,
    pub(crate) clearance: R,
    /// W = b θ̇.
    pub(crate) w: DoubleDouble<R>,
    /// cosθ.
    pub(crate) cosine: DoubleDouble<R>,
    /// True just after a release, where W and Ẇ are exactly 0.
    pub(crate) released: bool,
}

laned!(PivaState, PivaStates {
    time: Clock,
    primary: Primary,
    wall: Wall,
    distance: DoubleDouble,
    clearance: f64,
    w: DoubleDouble,
    cosine: DoubleDouble,
    released: bool,
} kicks = 0);

impl<R: Real> PivaState<R> {
    /// Gap displacement y.
    #[inline(always)]
    pub(crate) fn y(&self) -> DoubleDouble<R> {
        let s = self.wall.sign();
        DoubleDouble::new(self.clearance * s)
            .plus_parts(self.distance.value * -s, self.distance.rest * -s)
    }

    /// The variables of the Taylor series.
    #[inline(always)]
    pub(crate) fn swing(&self) -> Swing<R> {
        Swing {
            x: self.primary.x.value,
            u: self.primary.v.value,
            y: self.y().value,
            w: self.w.value,
            c: self.cosine.value,
        }
    }

    /// Distance to a wall.
    #[inline(always)]
    fn distance_to(&self, wall: Wall) -> R {
        if wall == self.wall {
            self.distance.value
        } else {
            -self.distance.minus(self.clearance * 2.0)
        }
    }

    /// Gap velocity ẏ = c W.
    #[inline(always)]
    fn gap_velocity(&self) -> R {
        self.cosine.value * self.w.value
    }
}

impl<R: Real> System for Piva<R> {
    type Real = R;
    type State = PivaState<R>;
    type Start = PivaStart<R>;
    type Flight<'a> = PivaFlight<'a, R>;
    type Ride<'a> = PivaRide<'a, R>;

    fn clearance(&self) -> R {
        self.parameters.clearance
    }

    fn rebound_ratio(&self, wall: Wall) -> R {
        self.law(wall).ratio
    }

    /// The gain of the law is per W; divided by cosθ it is per gap velocity W cosθ.
    fn impact_gain(&self, wall: Wall) -> R {
        self.law(wall).impact_gain() / self.stops.cosine.value
    }

    fn lever(&self) -> R {
        self.pendulum.lever
    }

    fn pressure_gain(&self, wall: Wall) -> R {
        self.law(wall).pressure_gain
    }

    fn check_start(&self, start: &PivaStart<R>) -> Result<(), Invalid> {
        self.check(start)
    }

    fn begin_at(&self, start: &PivaStart<R>, time: Clock<R>) -> PivaState<R> {
        self.first_state(start, time)
    }

    fn with_drive_of(&self, state: &PivaState<R>, like: &PivaState<R>) -> PivaState<R> {
        PivaState { time: like.time, kicks: like.kicks, ..*state }
    }

    fn flight(&self, state: &PivaState<R>) -> PivaFlight<'_, R> {
        PivaFlight::new(self, *state)
    }

    fn ride(&self, state: &PivaState<R>) -> PivaRide<'_, R> {
        PivaRide::new(self, *state)
    }

    fn wall(&self, state: &PivaState<R>) -> Wall {
        state.wall
    }

    fn distance(&self, state: &PivaState<R>) -> Jet<R> {
        self.jet(state.time, state)
    }

    fn touch(&self, state: &PivaState<R>, wall: Wall) -> (PivaState<R>, R) {
        R::dispatched(
            #[inline(always)]
            || self.stops.touching(state, wall, &self.beginning(state.time, state)),
        )
    }

    fn impact(&self, state: &PivaState<R>, time: R) -> (PivaState<R>, Impact<R>) {
        R::dispatched(
            #[inline(always)]
            || self.law(state.wall).struck(state, time, self.pendulum.lever),
        )
    }

    fn stick(&self, state: &PivaState<R>) -> (PivaState<R>, R) {
        let (v, law) = (state.primary.v, self.law(state.wall));
        let gained = law.stick(state.w);
        let Parameters { mass_ratio, damping_ratio, .. } = self.parameters;
        let damping = damping_ratio * 2.0 / (R::ONE + mass_ratio);
        let [farther, faster] = law.surplus_of_tail(state.w, &self.distance(state), damping);
        let stuck = PivaState {
            primary: Primary { x: state.primary.x.plus(farther), v: (v + gained).plus(faster) },
            distance: DoubleDouble::ZERO,
            w: DoubleDouble::ZERO,
            ..*state
        };
        (stuck, law.stick_loss(v.value, state.w.value))
    }

    fn release(&self, state: &PivaState<R>) -> (PivaState<R>, R) {
        let (primary, later) = self.without_pressure(state);
        let (distance, w) = (DoubleDouble::ZERO, DoubleDouble::ZERO);
        let time = state.time.plus(later);
        (PivaState { time, primary, distance, w, released: true, ..*state }, later)
    }

    fn primary(&self, state: &PivaState<R>) -> Point<R> {
        Point { x: state.primary.x.value, v: state.primary.v.value }
    }

    fn energy(&self, state: &PivaState<R>) -> R {
        let Point { x, v } = self.primary(state);
        let Parameters { mass_ratio, inertia_ratio, length, .. } = self.parameters;
        let Pendulum { lever, contact_distance, .. } = self.pendulum;
        let (y, w, c) = (state.y().value, state.w.value, state.cosine.value);
        let sine = y / contact_distance;
        // 1 − cosθ without cancellation (θ²/2 at small angles).
        let rise = if c > 0.0 { sine * sine / (R::ONE + c) } else { R::ONE - c };
        let kinetic = v * v + v * 2.0 * lever * (c * w) + inertia_ratio * (lever * w) * (lever * w);
        (x * x + v * v) * 0.5 + mass_ratio * (kinetic * 0.5 + self.gravity() * length * rise)
    }

    fn walls_reachable(&self) -> bool {
        self.stop_reachable()
    }

    fn is_driven(&self) -> bool {
        self.force.lasts()
    }

    fn largest_base(&self, between: [R; 2]) -> Option<R> {
        self.force().largest_base(between)
    }

    fn moves_base(&self) -> bool {
        self.force.moves_base()
    }

    fn smooth_for(&self, state: &PivaState<R>) -> R {
        let end = self.force.smooth_until(state.time, state.kicks);
        end.map_or(R::INFINITY, |end| (end - state.time).value)
    }

    fn due(&self, state: &PivaState<R>) -> Option<R> {
        self.force.due(state.time, state.kicks)
    }

    fn apply_impulse(&self, state: &PivaState<R>, velocity: R, stuck: bool) -> PivaState<R> {
        let Pendulum { mass_ratio, coupling, .. } = self.pendulum;
        let mass = DoubleDouble::new(R::ONE).plus(mass_ratio);
        let kicks = state.kicks + 1;
        if stuck {
            let gained = DoubleDouble::new(velocity).over_sum(mass);
            let primary = state.primary.faster_by(gained);
            return PivaState { kicks, primary, released: false, ..*state };
        }
        let gained = DoubleDouble::new(velocity).over_sum(self.pendulum.inertia(state.y()));
        let swing = gained.times(-coupling).times_sum(state.cosine);
        PivaState {
            kicks,
            primary: state.primary.faster_by(gained),
            w: state.w + swing,
            released: false,
            ..*state
        }
    }

    fn angle(&self, state: &PivaState<R>) -> Option<Angle<R>> {
        let sine = state.y().value / self.pendulum.contact_distance;
        let small = self.pendulum.small_angles;
        let value = if small { sine } else { R::atan2(sine, state.cosine.value) };
        Some(Angle { value, rate: state.w.value / self.pendulum.contact_distance })
    }

    fn impact_angles(&self, impact: &Impact<R>) -> Option<[Angle<R>; 2]> {
        let value = self.wall_angle() * impact.wall.sign();
        let lever = self.stops.cosine.value * self.pendulum.contact_distance;
        let angle = |w: R| Angle { value, rate: w / lever };
        Some([impact.gap_velocity_before, impact.gap_velocity_after].map(angle))
    }
}
