//! Free masses of the exact tier: states in double-double.

use super::{Loaded, Tier, of_siva};
use crate::absorber::Clock;
use crate::absorber::siva::exact::InFlight;
use crate::absorber::siva::{Siva, SivaState, coasts};
use crate::force::{Acts, Drive, Force, Harmonic, Push, Pushes, Smooth};
use crate::host::oscillator::{Equation, Oscillator, Primary};
use crate::host::steps::Responses;
use crate::host::{
    self, DrivenHost, Host as _, HostState, Moment, Source, Steps, Structure, Weight,
};
use crate::number::arrays::{Lanes as _, arrays};
use crate::number::compensated::DoubleDouble;

/// A state at rest in the middle of the gap.
pub(super) fn at_rest<P>(phase: P) -> SivaState<P> {
    let zero = DoubleDouble::ZERO;
    SivaState {
        host: HostState { primary: Primary::default(), acceleration: zero, phase },
        side: 1.0,
        distance: DoubleDouble::new(1.0),
        rate: zero,
    }
}

/// Free masses on one structure without drive.
#[derive(Debug)]
pub(crate) struct ExactDecays {
    /// Held by value, so that the compiler knows that no store into a lane changes it.
    free: Oscillator,
    steps: Steps,
}

impl Tier for ExactDecays {
    type System = Siva;
    type State = SivaState;
    type Responses = Responses;
    type Mass<'a> = InFlight<'a, Oscillator>;
    const STAGED: bool = true;

    fn new(system: &Siva) -> Self {
        let free = system.host.free();
        Self { free: *free, steps: Steps::new(free) }
    }

    of_siva!();

    #[inline(always)]
    fn with<T>(
        &self,
        _i: usize,
        from: &SivaState,
        act: impl FnOnce(&Self::Mass<'_>, &SivaState) -> T,
    ) -> T {
        act(&InFlight { free: &self.free, course: &() }, from)
    }

    #[inline(always)]
    fn longest(&self, _i: usize) -> f64 {
        self.free.reach
    }

    #[inline(always)]
    fn steps(&self) -> Option<&Steps> {
        Some(&self.steps)
    }

    #[inline(always)]
    fn responses(steps: &Steps, count: usize) -> Responses {
        steps.responses(count)
    }

    #[inline(always)]
    fn coasted(steps: &Steps, state: &SivaState, count: f64, by: Responses) -> SivaState {
        coasts::after(steps, state, count, by)
    }

    fn load(&mut self, _i: usize, from: &Loaded<'_, Siva>) -> Option<SivaState> {
        Some(from.state)
    }

    fn unload(&self, state: &SivaState, _system: &Siva, _clock: Clock) -> SivaState {
        *state
    }

    fn idle(&mut self, _i: usize) -> SivaState {
        at_rest(())
    }
}

arrays! {
    /// The structure of one driven lane.
    Scene, Scenes:
    /// The force: f/M or a_g = amplitude · cos(frequency · t + angle).
    amplitude, frequency, angle,
    /// Gravity along the motion.
    gravity,
    /// The constants of the structure ([`host::Driven`]).
    damping, growth, reach, step;
    /// The lift of the spring in flight.
    lift: DoubleDouble,
    excess: [f64; 7],
}

/// What acts on a lane: one harmonic force, on the structure or its base, and gravity along the motion if `HEAVY`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Single<const BASE: bool, const HEAVY: bool> {
    harmonic: Harmonic,
    weight: Weight,
}

impl<const BASE: bool, const HEAVY: bool> Single<BASE, HEAVY> {
    /// f/M, and a_g plus gravity along the motion, where the force is `push`.
    #[inline(always)]
    fn pushes_of(&self, push: Push) -> Pushes {
        let mut pushes = if BASE {
            Pushes { base: push, ..Pushes::NONE }
        } else {
            Pushes { primary: push, ..Pushes::NONE }
        };
        if HEAVY {
            pushes.base.value = pushes.base.value.plus(self.weight.gravity);
        }
        pushes
    }

    /// The same pushes, without those that are known to be 0: the compiler leaves out what is computed with them.
    #[inline(always)]
    fn known(&self, pushes: &Pushes) -> Pushes {
        match (BASE, HEAVY) {
            (true, _) => Pushes { base: pushes.base, ..Pushes::NONE },
            (false, false) => Pushes { primary: pushes.primary, ..Pushes::NONE },
            (false, true) => self.pushes_of(pushes.primary),
        }
    }
}

impl<const BASE: bool, const HEAVY: bool> Source for Single<BASE, HEAVY> {
    type Real = f64;
    #[inline(always)]
    fn pushes(&self, _from: &Moment, time: Clock) -> Pushes {
        self.pushes_of(self.harmonic.push(time))
    }

    #[inline(always)]
    fn plain_pushes(&self, _from: &Moment, time: Clock) -> Pushes {
        self.pushes_of(self.harmonic.plain_push(time))
    }

    #[inline(always)]
    fn drive(&self, moment: &Moment, h: f64) -> Drive<f64> {
        let Pushes { primary, mut base } = moment.pushes;
        if BASE {
            if HEAVY {
                base.value = base.value.plus(-self.weight.gravity);
            }
            Drive { base: self.harmonic.onwards(&base, h), ..Drive::NONE }
        } else {
            Drive { primary: self.harmonic.onwards(&primary, h), ..Drive::NONE }
        }
    }

    fn precise(&self, time: Clock, h: f64) -> Drive<DoubleDouble> {
        let mut drive = Drive::NOTHING;
        let row = if BASE { &mut drive.base } else { &mut drive.primary };
        self.harmonic.add_precise(row, time, h);
        if HEAVY {
            drive.base[0] = drive.base[0].plus(self.weight.gravity);
        }
        drive
    }

    #[inline(always)]
    fn moves_base(&self) -> bool {
        BASE || HEAVY
    }

    fn bends(&self) -> bool {
        false
    }

    #[inline(always)]
    fn weight(&self) -> Option<Weight> {
        HEAVY.then_some(self.weight)
    }
}

/// Free masses under one harmonic force each, on the structure or on its base, with gravity along the motion if
/// `HEAVY`.
#[derive(Debug)]
pub(crate) struct ExactDriven<const BASE: bool, const HEAVY: bool, const W: usize>(Scenes<W>);

impl<const BASE: bool, const HEAVY: bool, const W: usize> Tier for ExactDriven<BASE, HEAVY, W> {
    type System = Siva<DrivenHost>;
    type State = SivaState<Moment>;
    type Responses = ();
    type Mass<'a> = InFlight<'a, host::Driven<Single<BASE, HEAVY>>>;
    const STAGED: bool = false;

    fn new(_system: &Siva<DrivenHost>) -> Self {
        Self(Scenes::new())
    }

    of_siva!();

    #[inline(always)]
    fn with<T>(
        &self,
        i: usize,
        from: &Self::State,
        act: impl FnOnce(&Self::Mass<'_>, &Self::State) -> T,
    ) -> T {
        let Scene { amplitude, frequency, angle: phase, gravity, lift, .. } = self.0.get(i);
        let Scene { damping, growth, reach, step, excess, .. } = self.0.get(i);
        let third = DoubleDouble::new(1.0).over(3.0);
        let source = Single {
            harmonic: Harmonic { amplitude, frequency, phase, acts: Acts::Primary },
            weight: Weight { gravity, lift },
        };
        let equation = Equation { stiffness: 1.0, frequency: 1.0, damping, growth, third };
        let free = host::Driven { equation, source, base: [0.0; 5], reach, step, excess };
        let mut from = *from;
        from.host.phase.pushes = source.known(&from.host.phase.pushes);
        let course = free.course(&from.host);
        act(&InFlight { free: &free, course: &course }, &from)
    }

    #[inline(always)]
    fn longest(&self, i: usize) -> f64 {
        self.0.reach[i]
    }

    fn load(&mut self, i: usize, from: &Loaded<'_, Self::System>) -> Option<Self::State> {
        let host::Driven { equation, source, reach, step, excess, .. } = from.system.host.free();
        let Weight { gravity, lift } = source.weight().unwrap_or(Weight::NONE);
        let harmonic = from.system.force().map(Force::harmonics)?.first()?;
        let scene = Scene {
            amplitude: harmonic.amplitude,
            frequency: harmonic.frequency,
            angle: harmonic.phase,
            gravity,
            lift,
            damping: equation.damping,
            growth: equation.growth,
            reach: *reach,
            step: *step,
            excess: *excess,
        };
        self.0.set(i, &scene);
        Some(from.state)
    }

    fn unload(
        &self,
        state: &Self::State,
        _system: &Siva<DrivenHost>,
        _clock: Clock,
    ) -> Self::State {
        *state
    }

    fn idle(&mut self, i: usize) -> Self::State {
        self.0.set(i, &Scene { step: 1.0, ..Scene::default() });
        let (time, pushes) = (Clock::ZERO, Pushes::NONE);
        at_rest(Moment { time, kicks: 0, smooth: Smooth::ALL, pushes })
    }
}
