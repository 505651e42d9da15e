//! The structure without absorber.

use super::{Flown, Host, HostState, Integrated, Phase, Structure};
use crate::compensated::Sum;
use crate::error::Invalid;
use crate::flight::{Arcs, Curve, GapPoint, Jet, Losses, Motion, Rows};
use crate::force::Force;
use crate::impact::Impact;
use crate::oscillator::Primary;
use crate::range;
use crate::real::{ONE, Real, ZERO, dispatched};
use crate::system::{Point, System, Wall};

/// A structure without absorber, as a system to run: its flight never ends at a wall.
#[derive(Debug, Clone, PartialEq)]
pub struct Alone<H> {
    host: H,
}

impl<H: Host> Alone<H> {
    /// This structure.
    pub fn new(host: H) -> Self {
        Self { host }
    }
}

/// The motion of the structure from one state.
#[derive(Debug, Clone, Copy)]
pub struct AloneFlight<'a, H: Host> {
    structure: &'a H::Structure,
    from: HostState<Phase<H>>,
    course: <H::Structure as Structure>::Course,
}

impl<H: Host> AloneFlight<'_, H> {
    fn flown(&self, h: Real) -> Flown<Phase<H>> {
        dispatched(
            #[inline(always)]
            || self.structure.flown(&self.from, &self.course, h),
        )
    }
}

impl<H: Host> Motion for AloneFlight<'_, H> {
    type State = HostState<Phase<H>>;
    const RIDING: bool = false;

    fn origin(&self) -> &Self::State {
        &self.from
    }

    fn reach(&self) -> Real {
        self.structure.reach(&self.course)
    }

    fn state(&self, h: Real) -> Self::State {
        self.flown(h).to
    }

    fn arrival(&self, h: Real) -> Self::State {
        let mut state = self.state(h);
        self.structure.refresh(&mut state);
        state
    }

    fn primary(&self, h: Real) -> Jet {
        self.structure.jet(&self.from, &self.course, h)
    }

    fn gap(&self, _h: Real) -> GapPoint {
        GapPoint { y: ZERO, w: ZERO }
    }

    fn wall(&self) -> Option<Wall> {
        None
    }

    fn losses(&self, h: Real) -> Losses {
        let (from, course) = (&self.from, &self.course);
        let motion = Integrated { from, course, mass_ratio: ZERO, gap_velocity: None };
        let [viscous, work] = self.structure.losses(&motion, h);
        Losses { viscous, pivot: ZERO, work }
    }

    fn square(&self, h: [Real; 2]) -> Real {
        dispatched(
            #[inline(always)]
            || self.structure.square(&self.from, &self.course, h),
        )
    }

    fn arcs(&self, end: &Self::State) -> Option<Arcs> {
        self.structure.arcs(&self.from, end)
    }

    fn rows(&self) -> Option<Rows> {
        self.structure.rows(&self.from, &self.course)
    }
}

/// How far it is from a wall: there is none.
impl<H: Host> Curve for AloneFlight<'_, H> {
    type Sample = HostState<Phase<H>>;

    fn sample(&self, h: Real) -> Self::Sample {
        self.state(h)
    }

    fn jet(&self, sample: &Self::Sample) -> Jet {
        let value = if sample.primary.x.value.is_finite() { ONE } else { Real::NAN };
        Jet { value, rate: ZERO, curvature: ZERO, jerk: ZERO }
    }

    fn precise(&self, _h: Real) -> Sum {
        Sum::new(ONE)
    }

    fn fourth(&self) -> Real {
        ZERO
    }

    fn magnitude(&self) -> Real {
        ONE
    }
}

impl<H: Host> System for Alone<H> {
    type State = HostState<Phase<H>>;
    type Start = Point;
    type Flight<'a>
        = AloneFlight<'a, H>
    where
        H: 'a;
    type Ride<'a>
        = AloneFlight<'a, H>
    where
        H: 'a;

    fn clearance(&self) -> Real {
        ZERO
    }

    fn walls_reachable(&self) -> bool {
        false
    }

    fn rebound_ratio(&self) -> Real {
        ZERO
    }

    fn pressure_gain(&self) -> Real {
        ZERO
    }

    fn check_start(&self, start: &Point) -> Result<(), Invalid> {
        range::size("start.displacement", start.x)?;
        range::size("start.velocity", start.v)
    }

    fn begin(&self, start: &Point) -> (Self::State, bool) {
        let primary = Primary { x: Sum::new(start.x), v: Sum::new(start.v) };
        (self.host.state(self.host.begin(), primary), false)
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

    fn distance(&self, _state: &Self::State) -> Jet {
        Jet { value: ONE, rate: ZERO, curvature: ZERO, jerk: ZERO }
    }

    fn touch(&self, state: &Self::State, _wall: Wall) -> (Self::State, Real) {
        (*state, ZERO)
    }

    fn impact(&self, state: &Self::State, time: Real) -> (Self::State, Impact) {
        let Point { x, v } = self.primary(state);
        let impact = Impact {
            time,
            wall: Wall::Plus,
            displacement: x,
            velocity_before: v,
            velocity_after: v,
            gap_velocity_before: ZERO,
            gap_velocity_after: ZERO,
            lever: ONE,
            energy_loss: ZERO,
        };
        (*state, impact)
    }

    fn stick(&self, state: &Self::State) -> (Self::State, Real) {
        (*state, ZERO)
    }

    fn release(&self, state: &Self::State) -> (Self::State, Real) {
        (*state, ZERO)
    }

    fn primary(&self, state: &Self::State) -> Point {
        Point { x: state.primary.x.value, v: state.primary.v.value }
    }

    fn energy(&self, state: &Self::State) -> Real {
        let Point { x, v } = self.primary(state);
        0.5 * (x * x + v * v)
    }

    fn is_driven(&self) -> bool {
        self.host.force().is_some_and(Force::lasts)
    }

    fn moves_base(&self) -> bool {
        self.host.force().is_some_and(Force::moves_base)
    }

    fn smooth_for(&self, state: &Self::State) -> Real {
        self.host.smooth_for(&state.phase)
    }

    fn due(&self, state: &Self::State) -> Option<Real> {
        self.host.due(&state.phase)
    }

    fn kick(&self, state: &Self::State, velocity: Real, _stuck: bool) -> Self::State {
        let Primary { x, v } = state.primary;
        self.host.state(self.host.kicked(&state.phase), Primary { x, v: v.plus(velocity) })
    }
}
