//! Free masses of the exact tier on which no lasting force acts: but gravity along an inclined line of motion, or impulses,
//! of which a lane begins after the last one.

use super::exact::at_rest;
use super::{Loaded, Tier, of_siva};
use crate::absorber::Clock;
use crate::absorber::siva::exact::InFlight;
use crate::absorber::siva::{Siva, SivaState, coasts};
use crate::force::{Drive, Force, Push, Pushes, Smooth};
use crate::host::oscillator::Equation;
use crate::host::steps::Responses;
use crate::host::{
    self, DrivenHost, Host as _, Moment, Ramped, Source, Steps, Structure as _, Weight,
};
use crate::number::arrays::{Lanes as _, arrays};
use crate::number::compensated::DoubleDouble;

arrays! {
    /// The structure of one lane.
    Scene, Scenes:
    /// Gravity along the motion, in ωn² × length.
    gravity,
    /// The constants of the structure ([`host::Driven`]).
    reach, step;
    /// The lift of the spring in flight.
    lift: DoubleDouble,
    excess: [f64; 7],
}

/// What acts on a lane: gravity along the motion, if `HEAVY`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Unforced<'a, const HEAVY: bool> {
    ramped: &'a Ramped,
    weight: Weight,
}

impl<const HEAVY: bool> Unforced<'_, HEAVY> {
    #[inline(always)]
    fn pushes_ever(&self) -> Pushes {
        if !HEAVY {
            return Pushes::NONE;
        }
        let value = DoubleDouble::new(self.weight.gravity);
        Pushes { base: Push { value, ..Push::NONE }, ..Pushes::NONE }
    }
}

impl<const HEAVY: bool> Source for Unforced<'_, HEAVY> {
    type Real = f64;

    #[inline(always)]
    fn pushes(&self, _from: &Moment, _time: Clock) -> Pushes {
        self.pushes_ever()
    }

    #[inline(always)]
    fn drive(&self, _moment: &Moment, _h: f64) -> Drive<f64> {
        Drive::NONE
    }

    fn precise(&self, _time: Clock, _h: f64) -> Drive<DoubleDouble> {
        let mut drive = Drive::NOTHING;
        drive.base[0] = self.pushes_ever().base.value;
        drive
    }

    #[inline(always)]
    fn moves_base(&self) -> bool {
        HEAVY
    }

    fn bends(&self) -> bool {
        false
    }

    #[inline(always)]
    fn weight(&self) -> Option<Weight> {
        HEAVY.then_some(self.weight)
    }

    #[inline(always)]
    fn ramped(&self) -> Option<&Ramped> {
        Some(self.ramped)
    }
}

/// Free masses on structures of one damping ratio, each with its own gravity along the motion if `HEAVY`.
#[derive(Debug)]
pub(crate) struct ExactUnforced<const HEAVY: bool, const W: usize> {
    /// Held by value, so that the compiler knows that no store into a lane changes it.
    ramped: Ramped,
    equation: Equation,
    steps: Steps,
    scenes: Scenes<W>,
}

impl<const HEAVY: bool, const W: usize> Tier for ExactUnforced<HEAVY, W> {
    type System = Siva<DrivenHost>;
    type State = SivaState<Moment>;
    type Responses = Responses;
    type Mass<'a> = InFlight<'a, host::Driven<Unforced<'a, HEAVY>>>;
    const STAGED: bool = true;

    fn new(system: &Siva<DrivenHost>) -> Self {
        let equation = *system.host.free().equation();
        let ramped = Ramped::new(1.0, system.host.damping_ratio());
        let steps = Steps::new(ramped.oscillator());
        Self { ramped, equation, steps, scenes: Scenes::new() }
    }

    of_siva!();

    #[inline(always)]
    fn with<T>(
        &self,
        i: usize,
        from: &Self::State,
        act: impl FnOnce(&Self::Mass<'_>, &Self::State) -> T,
    ) -> T {
        let Scene { gravity, lift, reach, step, excess } = self.scenes.get(i);
        let source = Unforced { ramped: &self.ramped, weight: Weight { gravity, lift } };
        // The compiler leaves out what is computed with forces that are 0.
        let mut from = *from;
        from.host.phase.pushes = source.pushes_ever();
        let Self { equation, .. } = *self;
        let free = host::Driven { equation, source, base: [0.0; 5], reach, step, excess };
        let course = free.course(&from.host);
        act(&InFlight { free: &free, course: &course }, &from)
    }

    #[inline(always)]
    fn longest(&self, i: usize) -> f64 {
        self.scenes.reach[i]
    }

    #[inline(always)]
    fn steps(&self) -> Option<&Steps> {
        if HEAVY { None } else { Some(&self.steps) }
    }

    #[inline(always)]
    fn responses(steps: &Steps, count: usize) -> Responses {
        steps.responses(count)
    }

    #[inline(always)]
    fn coasted(steps: &Steps, state: &Self::State, count: f64, by: Responses) -> Self::State {
        let mut after = coasts::after(steps, state, count, by);
        after.host.phase = state.host.phase.waited(steps.time(count));
        after
    }

    fn load(&mut self, i: usize, from: &Loaded<'_, Self::System>) -> Option<Self::State> {
        if from.state.host.phase.smooth.end.is_some() {
            return None;
        }
        let host::Driven { source, reach, step, excess, .. } = from.system.host.free();
        let Weight { gravity, lift } = source.weight().unwrap_or(Weight::NONE);
        let scene = Scene { gravity, lift, reach: *reach, step: *step, excess: *excess };
        self.scenes.set(i, &scene);
        Some(from.state)
    }

    fn unload(&self, state: &Self::State, system: &Siva<DrivenHost>, _clock: Clock) -> Self::State {
        let mut state = *state;
        state.host.phase.kicks = system.force().map_or(0, Force::kicks);
        state
    }

    fn idle(&mut self, i: usize) -> Self::State {
        self.scenes.set(i, &Scene { step: 1.0, ..Scene::default() });
        let time = Clock::ZERO;
        at_rest(Moment { time, kicks: 0, smooth: Smooth::ALL, pushes: Pushes::NONE })
    }
}
