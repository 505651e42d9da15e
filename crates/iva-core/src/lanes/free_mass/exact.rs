//! Free masses of the exact tier: states in double-double.

use super::{States, Tier, TierRun};
use crate::arrays::arrays;
use crate::compensated::DoubleDouble;
use crate::force::{Acts, Drive, Force, Harmonic, Push, Pushes};
use crate::host::{self, DrivenHost, Host, HostState, Moment, Source, Structure, UndrivenHost};
use crate::oscillator::{Equation, Oscillator, Primary};
use crate::plain::State;
use crate::simulate::wall::REBOUND_LOOK;
use crate::siva::SivaState;
use crate::siva::coasts::{Coast, Coasts};
use crate::siva::exact::InFlight;
use crate::system::Clock;

arrays! {
    /// The state of one lane.
    Held,
    /// [`Held`] of many runs: every field an array over the lanes.
    Helds:
    /// x, ẋ, A, distance to the wall last touched and its rate, in double-double, and the sign of that wall.
    x, x_rest, v, v_rest, a, a_rest, distance, distance_rest, rate, rate_rest, side,
}

impl Held {
    #[inline(always)]
    fn of<P>(state: &SivaState<P>) -> Self {
        let SivaState { host: HostState { primary, acceleration, .. }, side, distance, rate } =
            state;
        let Primary { x, v } = primary;
        Self {
            x: x.value,
            x_rest: x.rest,
            v: v.value,
            v_rest: v.rest,
            a: acceleration.value,
            a_rest: acceleration.rest,
            distance: distance.value,
            distance_rest: distance.rest,
            rate: rate.value,
            rate_rest: rate.rest,
            side: *side,
        }
    }

    #[inline(always)]
    fn state<P>(&self, phase: P) -> SivaState<P> {
        let sum = |value, rest| DoubleDouble { value, rest };
        SivaState {
            host: HostState {
                primary: Primary { x: sum(self.x, self.x_rest), v: sum(self.v, self.v_rest) },
                acceleration: sum(self.a, self.a_rest),
                phase,
            },
            side: self.side,
            distance: sum(self.distance, self.distance_rest),
            rate: sum(self.rate, self.rate_rest),
        }
    }
}

impl<const W: usize> States<SivaState> for Helds<W> {
    fn new() -> Self {
        Helds::new()
    }

    #[inline(always)]
    fn get(&self, i: usize) -> SivaState {
        Helds::get(self, i).state(())
    }

    #[inline(always)]
    fn put(&mut self, i: usize, which: bool, state: &SivaState) {
        self.set(i, &Held::of(state).if_else(which, &Helds::get(self, i)));
    }
}

/// A state at rest in the middle of the gap.
fn at_rest<P>(phase: P) -> SivaState<P> {
    Held { distance: 1.0, side: 1.0, ..Held::default() }.state(phase)
}

/// Free masses on one structure without drive.
#[derive(Debug)]
pub(in crate::lanes) struct ExactDecays<const W: usize> {
    /// Held by value, so that the compiler knows that no store into a lane changes it.
    free: Oscillator,
    coasts: Coasts,
}

impl<const W: usize> Tier for ExactDecays<W> {
    type Host = UndrivenHost;
    type State = SivaState;
    type States = Helds<W>;
    type Mass<'a> = InFlight<'a, Oscillator>;
    const STAGED: bool = true;

    fn new(host: &UndrivenHost) -> Self {
        Self { free: *host.free(), coasts: Coasts::new(host.free()) }
    }

    #[inline(always)]
    fn with<T>(&self, _i: usize, _from: &SivaState, act: impl FnOnce(&Self::Mass<'_>) -> T) -> T {
        act(&InFlight { free: &self.free, course: &() })
    }

    #[inline(always)]
    fn longest(&self, _i: usize) -> f64 {
        self.free.reach
    }

    #[inline(always)]
    fn rebound(rate: f64, pressure: f64, _over: f64) -> f64 {
        rate * REBOUND_LOOK / pressure
    }

    #[inline(always)]
    fn coasts(&self) -> Option<&Coasts> {
        Some(&self.coasts)
    }

    #[inline(always)]
    fn coasted(coasts: &Coasts, state: &SivaState, by: &Coast) -> SivaState {
        coasts.coasted(state, by)
    }

    fn load(&mut self, _i: usize, run: &TierRun<'_, Self>) -> Option<SivaState> {
        Some(run.tally.state)
    }

    #[inline(always)]
    fn in_doubles(state: &SivaState) -> State {
        state.in_doubles()
    }

    fn unload(&self, state: &SivaState, _host: &UndrivenHost, _clock: Clock) -> SivaState {
        *state
    }

    fn idle(&mut self, _i: usize) -> SivaState {
        at_rest(())
    }
}

arrays! {
    /// The state of one driven lane.
    Moved,
    /// [`Moved`] of many runs: every field an array over the lanes.
    Moveds:
    /// The instant of the drive, and f/M or a_g there with its first three derivatives.
    instant, instant_rest, push, push_rest, slope, slope_rest, second, second_rest, third;
    /// Structure and absorber.
    held: Held, Helds
}

/// The states of all lanes under a force on the structure, or on its base.
#[derive(Debug)]
pub(in crate::lanes) struct Driven<const BASE: bool, const W: usize>(Moveds<W>);

impl<const BASE: bool, const W: usize> States<SivaState<Moment>> for Driven<BASE, W> {
    fn new() -> Self {
        Self(Moveds::new())
    }

    #[inline(always)]
    fn get(&self, i: usize) -> SivaState<Moment> {
        let Moved { instant, instant_rest, held, third, .. } = self.0.get(i);
        let Moved { push, push_rest, slope, slope_rest, second, second_rest, .. } = self.0.get(i);
        let sum = |value, rest| DoubleDouble { value, rest };
        let push = Push {
            value: sum(push, push_rest),
            rate: sum(slope, slope_rest),
            second: sum(second, second_rest),
            third,
        };
        let pushes = Single::<BASE>::pushes_of(push);
        held.state(Moment { time: sum(instant, instant_rest), kicks: 0, pushes })
    }

    #[inline(always)]
    fn put(&mut self, i: usize, which: bool, state: &SivaState<Moment>) {
        let Moment { time, pushes: Pushes { primary, base }, .. } = state.host.phase;
        let Push { value, rate, second, third } = if BASE { base } else { primary };
        let moved = Moved {
            instant: time.value,
            instant_rest: time.rest,
            push: value.value,
            push_rest: value.rest,
            slope: rate.value,
            slope_rest: rate.rest,
            second: second.value,
            second_rest: second.rest,
            third,
            held: Held::of(state),
        };
        self.0.set(i, &moved.if_else(which, &self.0.get(i)));
    }
}

arrays! {
    /// The structure of one driven lane.
    Scene,
    /// [`Scene`] of many runs: every field an array over the lanes.
    Scenes:
    /// The force: f/M or a_g = amplitude · cos(frequency · t + angle).
    amplitude, frequency, angle,
    /// The constants of the structure ([`host::Driven`]).
    damping, growth, reach, step, excess_0, excess_1, excess_2, excess_3, excess_4, excess_5, excess_6,
}

/// The force of a lane: one harmonic force, on the structure or its base.
#[derive(Debug, Clone, Copy)]
pub(in crate::lanes) struct Single<const BASE: bool>(Harmonic);

impl<const BASE: bool> Single<BASE> {
    /// f/M and a_g, one of which is `push`.
    #[inline(always)]
    fn pushes_of(push: Push) -> Pushes {
        if BASE {
            Pushes { base: push, ..Pushes::NONE }
        } else {
            Pushes { primary: push, ..Pushes::NONE }
        }
    }
}

impl<const BASE: bool> Source for Single<BASE> {
    type Real = f64;
    #[inline(always)]
    fn pushes(&self, _from: Clock, time: Clock) -> Pushes {
        Self::pushes_of(self.0.push(time))
    }

    #[inline(always)]
    fn drive(&self, moment: &Moment, h: f64) -> Drive<f64> {
        let Pushes { primary, base } = &moment.pushes;
        if BASE {
            Drive { base: self.0.onwards(base, h), ..Drive::NONE }
        } else {
            Drive { primary: self.0.onwards(primary, h), ..Drive::NONE }
        }
    }

    fn precise(&self, time: Clock, h: f64) -> Drive<DoubleDouble> {
        let mut drive = Drive::NOTHING;
        let row = if BASE { &mut drive.base } else { &mut drive.primary };
        self.0.add_precise(row, time, h);
        drive
    }

    #[inline(always)]
    fn until_bend(&self, _moment: &Moment, reach: f64) -> (f64, Option<Clock>) {
        (reach, None)
    }

    #[inline(always)]
    fn moves_base(&self) -> bool {
        BASE
    }

    fn bends(&self) -> bool {
        false
    }
}

/// Free masses under one harmonic force each, on the structure or on its base.
#[derive(Debug)]
pub(in crate::lanes) struct ExactDriven<const BASE: bool, const W: usize>(Scenes<W>);

impl<const BASE: bool, const W: usize> Tier for ExactDriven<BASE, W> {
    type Host = DrivenHost;
    type State = SivaState<Moment>;
    type States = Driven<BASE, W>;
    type Mass<'a> = InFlight<'a, host::Driven<Single<BASE>>>;
    const STAGED: bool = false;

    fn new(_host: &DrivenHost) -> Self {
        Self(Scenes::new())
    }

    #[inline(always)]
    fn with<T>(&self, i: usize, from: &Self::State, act: impl FnOnce(&Self::Mass<'_>) -> T) -> T {
        let Scene { amplitude, frequency, angle: phase, damping, growth, .. } = self.0.get(i);
        let Scene { reach, step, .. } = self.0.get(i);
        let Scene { excess_0, excess_1, excess_2, excess_3, .. } = self.0.get(i);
        let Scene { excess_4, excess_5, excess_6, .. } = self.0.get(i);
        let third = DoubleDouble::new(1.0).over(3.0);
        let free = host::Driven {
            equation: Equation { stiffness: 1.0, frequency: 1.0, damping, growth, third },
            source: Single(Harmonic { amplitude, frequency, phase, acts: Acts::Primary }),
            base: [0.0; 5],
            reach,
            step,
            excess: [excess_0, excess_1, excess_2, excess_3, excess_4, excess_5, excess_6],
        };
        let course = free.course(&from.host);
        act(&InFlight { free: &free, course: &course })
    }

    #[inline(always)]
    fn longest(&self, i: usize) -> f64 {
        self.0.reach[i]
    }

    #[inline(always)]
    fn rebound(rate: f64, pressure: f64, _over: f64) -> f64 {
        rate * REBOUND_LOOK / pressure
    }

    fn load(&mut self, i: usize, run: &TierRun<'_, Self>) -> Option<Self::State> {
        let host::Driven { equation, reach, step, excess, .. } = run.system.host.free();
        let harmonic = run.system.force().map(Force::harmonics)?.first()?;
        let scene = Scene {
            amplitude: harmonic.amplitude,
            frequency: harmonic.frequency,
            angle: harmonic.phase,
            damping: equation.damping,
            growth: equation.growth,
            reach: *reach,
            step: *step,
            excess_0: excess[0],
            excess_1: excess[1],
            excess_2: excess[2],
            excess_3: excess[3],
            excess_4: excess[4],
            excess_5: excess[5],
            excess_6: excess[6],
        };
        self.0.set(i, &scene);
        Some(run.tally.state)
    }

    #[inline(always)]
    fn in_doubles(state: &Self::State) -> State {
        state.in_doubles()
    }

    fn unload(&self, state: &Self::State, _host: &DrivenHost, _clock: Clock) -> Self::State {
        *state
    }

    fn idle(&mut self, i: usize) -> Self::State {
        self.0.set(i, &Scene { step: 1.0, ..Scene::default() });
        let pushes = Single::<BASE>::pushes_of(Push::NONE);
        at_rest(Moment { time: Clock::ZERO, kicks: 0, pushes })
    }
}
