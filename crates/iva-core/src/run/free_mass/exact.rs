//! Free masses of the exact tier: states in double-double.

use super::{Loaded, Tier, of_siva};
use crate::absorber::Clock;
use crate::absorber::siva::exact::InFlight;
use crate::absorber::siva::{Siva, SivaState, coasts};
use crate::host::oscillator::Primary;
use crate::host::steps::Responses;
use crate::host::{HostState, Steps};
use crate::number::compensated::DoubleDouble;
use crate::run::side_by_side::SideBySide;
use crate::run::structures::{SingleForce, Structures, Undriven};

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
pub(crate) type ExactDecays = Exact<Undriven>;

/// Free masses under one harmonic force each, on the structure or on its base, with gravity along the motion if
/// `HEAVY`.
pub(crate) type ExactDriven<const BASE: bool, const HEAVY: bool, const W: usize> =
    Exact<SingleForce<BASE, HEAVY, W>>;

/// Free masses on structures of one kind.
#[derive(Debug)]
pub(crate) struct Exact<S: Structures>(S);

impl<S: Structures> Tier for Exact<S>
where
    Siva<S::Host>: SideBySide<State = SivaState<S::Phase>>,
{
    type System = Siva<S::Host>;
    type State = SivaState<S::Phase>;
    type Responses = Responses;
    type Mass<'a>
        = InFlight<'a, S::One>
    where
        Self: 'a;
    const STAGED: bool = S::STAGED;

    fn new(system: &Self::System) -> Self {
        Self(S::new(&system.host))
    }

    of_siva!();

    #[inline(always)]
    fn with<T>(
        &self,
        i: usize,
        from: &Self::State,
        act: impl FnOnce(&Self::Mass<'_>, &Self::State) -> T,
    ) -> T {
        self.0.with(
            i,
            &from.host,
            #[inline(always)]
            |mass, host| act(mass, &SivaState { host: *host, ..*from }),
        )
    }

    #[inline(always)]
    fn longest(&self, i: usize) -> f64 {
        self.0.longest(i)
    }

    #[inline(always)]
    fn steps(&self) -> Option<&Steps> {
        self.0.steps()
    }

    #[inline(always)]
    fn responses(steps: &Steps, count: usize) -> Responses {
        steps.responses(count)
    }

    #[inline(always)]
    fn coasted(steps: &Steps, state: &Self::State, count: f64, by: Responses) -> Self::State {
        coasts::after(steps, state, count, by)
    }

    fn load(&mut self, i: usize, from: &Loaded<'_, Self::System>) -> Option<Self::State> {
        let loaded = self.0.load(i, &from.system.host, &from.state.host);
        loaded.then_some(from.state)
    }

    fn unload(&self, state: &Self::State, _system: &Self::System, _clock: Clock) -> Self::State {
        *state
    }

    fn idle(&mut self, i: usize) -> Self::State {
        at_rest(self.0.idle(i))
    }
}
