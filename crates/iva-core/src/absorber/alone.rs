//! The structure without absorber, as a system for the event loop.

use crate::absorber::impact::Impact;
use crate::absorber::{Absorber, Clock, ImpactLaw, LawAt, OnStructure, Point, Wall};
use crate::error::Invalid;
use crate::force::Force;
use crate::host::oscillator::Primary;
use crate::host::{
    DrivenHost, Flown, Host, HostState, Integrated, Phase, Sinusoidal, Structure, UndrivenHost,
};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;
use crate::segment::flight::{
    Curve, FastFlight, GapPoint, Jet, Losses, Meets, Motion, Quantity, Rows, Travel, Turns,
};
use crate::segment::taylor::ORDER;

/// A structure without absorber, as a system to run. Its flights never end at a wall.
#[derive(Debug, Clone, PartialEq)]
pub struct Alone<H: Host> {
    pub(crate) host: H,
}

impl<R: Real> Alone<UndrivenHost<R>> {
    /// A structure of damping ratio ζ without drive.
    ///
    /// # Errors
    /// [`Invalid`] for a damping ratio out of [`crate::range`].
    pub fn new(damping_ratio: R) -> Result<Self, Invalid> {
        range::damping_ratio("primary.damping_ratio", damping_ratio)?;
        Ok(Self { host: UndrivenHost::new(damping_ratio, R::ZERO) })
    }

    /// The same structure under a force.
    pub fn under(&self, force: Force<R>) -> Alone<DrivenHost<R>> {
        Alone { host: DrivenHost::new(self.host.damping_ratio(), R::ZERO, force, R::ZERO) }
    }
}

impl<R: Real, H: Host<Real = R>> Alone<H> {
    /// The damping ratio ζ.
    pub fn damping_ratio(&self) -> R {
        self.host.damping_ratio()
    }

    /// The force that drives it; `None` for a structure that cannot be driven.
    pub fn force(&self) -> Option<&Force<R>> {
        self.host.force()
    }
}

/// The motion of the structure from one state.
#[derive(Debug, Clone, Copy)]
pub struct AloneFlight<'a, H: Host> {
    structure: &'a H::Structure,
    from: HostState<Phase<H>, H::Real>,
    course: <H::Structure as Structure>::Course,
}

impl<R: Real, H: Host<Real = R>> AloneFlight<'_, H> {
    fn flown(&self, h: R) -> Flown<Phase<H>, R> {
        R::dispatched(
            #[inline(always)]
            || self.structure.flown(&self.from, &self.course, h),
        )
    }
}

impl<R: Real, H: Host<Real = R>> Motion for AloneFlight<'_, H> {
    type Real = R;
    type State = HostState<Phase<H>, R>;
    const RIDING: bool = false;

    fn origin(&self) -> &Self::State {
        &self.from
    }

    fn reach(&self) -> R {
        self.structure.reach(&self.from)
    }

    fn state(&self, h: R) -> Self::State {
        self.flown(h).to
    }

    fn arrival(&self, h: R) -> Self::State {
        let mut state = self.state(h);
        self.structure.refresh(&mut state);
        state
    }

    fn primary(&self, h: R) -> Jet<R> {
        self.structure.jet(&self.from, &self.course, h)
    }

    /// The flight of any finite motion meets no wall.
    fn fast_path(&self, length: R) -> Option<FastFlight<Self::State, R>> {
        let end = self.arrival(length);
        let finite = end.primary.x.value.is_finite() && end.primary.v.value.is_finite();
        finite.then_some(FastFlight { length, later: R::ZERO, end, meets: Meets::Nothing })
    }

    fn turns(&self, length: R, end: &Self::State) -> Turns<R> {
        if !R::FAST_PATHS || self.from.primary.v.value * end.primary.v.value >= 0.0 {
            return Turns::Unknown;
        }
        R::dispatched(
            #[inline(always)]
            || self.structure.turns(&self.from, &self.course, end, length),
        )
    }

    fn gap(&self, _h: R) -> GapPoint<R> {
        GapPoint { y: R::ZERO, w: R::ZERO }
    }

    fn wall(&self) -> Option<Wall> {
        None
    }

    fn losses(&self, h: R) -> Losses<R> {
        let (from, course) = (&self.from, &self.course);
        let motion = Integrated { from, course, mass_ratio: R::ZERO, gap_velocity: None };
        let [viscous, work] = self.structure.losses(&motion, h);
        Losses { viscous, pivot: R::ZERO, work }
    }

    fn square(&self, h: [R; 2]) -> R {
        R::dispatched(
            #[inline(always)]
            || self.structure.square(&self.from, &self.course, h),
        )
    }

    fn largest(&self, of: Quantity, least: R, length: R, end: &Self::State) -> Option<R> {
        R::dispatched(
            #[inline(always)]
            || self.structure.largest(of, least, (&self.from, &self.course), end, length),
        )
    }

    fn rows(&self) -> Option<Rows<R>> {
        self.structure.rows(&self.from, &self.course)
    }

    fn acceleration(&self, h: R) -> R {
        self.flown(h).to.acceleration.value
    }

    fn travel(&self) -> Option<Travel<R>> {
        let rows = self.structure.series(&self.from, &self.course);
        Some(Travel::new(rows, [R::ZERO; ORDER + 1], R::ONE))
    }
}

/// The distance to a wall, here a constant 1 because there is no wall.
impl<R: Real, H: Host<Real = R>> Curve for AloneFlight<'_, H> {
    type Real = R;
    type Sample = HostState<Phase<H>, R>;

    fn sample(&self, h: R) -> Self::Sample {
        self.state(h)
    }

    fn jet(&self, sample: &Self::Sample) -> Jet<R> {
        let value = if sample.primary.x.value.is_finite() { R::ONE } else { R::NAN };
        Jet { value, rate: R::ZERO, curvature: R::ZERO, jerk: R::ZERO }
    }

    fn precise(&self, _h: R) -> DoubleDouble<R> {
        DoubleDouble::new(R::ONE)
    }

    fn fourth(&self) -> R {
        R::ZERO
    }

    fn magnitude(&self) -> R {
        R::ONE
    }
}

impl<R: Real, H: Host<Real = R>> OnStructure for Alone<H> {
    type Real = R;
    type Excitation = H;
    type State = HostState<Phase<H>, R>;

    fn excitation(&self) -> &H {
        &self.host
    }

    fn phase(state: &Self::State) -> &Phase<H> {
        &state.phase
    }

    fn mass_ratio(&self) -> R {
        R::ZERO
    }

    fn with_drive_of(&self, state: &Self::State, like: &Self::State) -> Self::State {
        self.host.state(like.phase, state.primary)
    }

    fn primary(&self, state: &Self::State) -> Point<R> {
        Point { x: state.primary.x.value, v: state.primary.v.value }
    }

    fn energy(&self, state: &Self::State) -> R {
        let Point { x, v } = self.primary(state);
        (x * x + v * v) * 0.5
    }

    fn sinusoidal(&self) -> Option<Sinusoidal> {
        self.host.sinusoidal()
    }

    fn apply_impulse(&self, state: &Self::State, velocity: R, _stuck: bool) -> Self::State {
        let Primary { x, v } = state.primary;
        self.host.state(self.host.after_impulse(&state.phase), Primary { x, v: v.plus(velocity) })
    }
}

impl<R: Real, H: Host<Real = R>> ImpactLaw for Alone<H> {
    fn law_of(&self, _absorber: usize, _wall: Wall, _approach: R) -> LawAt<R> {
        let none = R::ZERO;
        LawAt::constant(none, none, none, none)
    }

    fn impact(&self, state: &Self::State, time: R) -> (Self::State, Impact<R>) {
        let (none, primary) = ([R::ZERO; 2], self.primary(state));
        let impact = Impact::of_free_mass(none, time, Wall::Plus, primary, R::ZERO);
        (*state, impact)
    }

    fn stick(&self, state: &Self::State) -> (Self::State, R) {
        (*state, R::ZERO)
    }
}

impl<R: Real, H: Host<Real = R>> Absorber for Alone<H> {
    type Start = Point<R>;
    type Flight<'a>
        = AloneFlight<'a, H>
    where
        H: 'a;
    type Ride<'a>
        = AloneFlight<'a, H>
    where
        H: 'a;

    /// 1: there are no walls, and defaults that are a share of the clearance stay usable.
    fn clearance(&self) -> R {
        R::ONE
    }

    fn walls_reachable(&self) -> bool {
        false
    }

    fn check_start(&self, start: &Point<R>) -> Result<(), Invalid> {
        range::size("start.displacement", start.x)?;
        range::size("start.velocity", start.v)
    }

    fn begin_at(&self, start: &Point<R>, time: Clock<R>) -> Self::State {
        let primary = Primary { x: DoubleDouble::new(start.x), v: DoubleDouble::new(start.v) };
        self.host.state(self.host.begin_at(time), primary)
    }

    fn flight(&self, state: &Self::State) -> AloneFlight<'_, H> {
        let structure = self.host.free();
        AloneFlight { structure, from: *state, course: structure.fast_course(state) }
    }

    fn ride(&self, state: &Self::State) -> AloneFlight<'_, H> {
        self.flight(state)
    }

    fn wall(&self, _state: &Self::State) -> Wall {
        Wall::Plus
    }

    fn distance(&self, _state: &Self::State) -> Jet<R> {
        Jet { value: R::ONE, rate: R::ZERO, curvature: R::ZERO, jerk: R::ZERO }
    }

    fn touch(&self, state: &Self::State, _wall: Wall) -> (Self::State, R) {
        (*state, R::ZERO)
    }

    fn release(&self, state: &Self::State) -> (Self::State, R) {
        (*state, R::ZERO)
    }
}
