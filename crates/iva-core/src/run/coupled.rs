//! Coupled masses in lanes.

use super::free_mass::{self, Loaded};
use super::side_by_side::{Group, Job, LANES, Logged, SideBySide};
use crate::absorber::Clock;
use crate::absorber::coupled::{Coupled, CoupledState, Coupling};
use crate::absorber::plain::State;
use crate::absorber::siva::Law;
use crate::absorber::siva::trial::FreeMass;

/// The coupled masses of all lanes.
#[derive(Debug)]
pub(crate) struct Masses<C: Coupling, const W: usize>([Coupled<C>; W]);

impl<C: Coupling<Real = f64>, const W: usize> free_mass::Tier for Masses<C, W> {
    type System = Coupled<C>;
    type State = CoupledState;
    type Responses = ();
    type Mass<'a>
        = Coupled<C>
    where
        Self: 'a;
    const STAGED: bool = true;

    fn new(system: &Coupled<C>) -> Self {
        Self([*system; W])
    }

    fn laws(system: &Coupled<C>) -> [Law; 2] {
        let [mu, restitution, _] = system.coupling.constants();
        [Law::new(mu, restitution); 2]
    }

    fn in_doubles(state: &CoupledState) -> State {
        <Coupled<C> as FreeMass>::in_doubles(state)
    }

    #[inline(always)]
    fn with<T>(
        &self,
        i: usize,
        from: &CoupledState,
        act: impl FnOnce(&Coupled<C>, &CoupledState) -> T,
    ) -> T {
        act(&self.0[i], from)
    }

    #[inline(always)]
    fn longest(&self, i: usize) -> f64 {
        self.0[i].reach()
    }

    fn load(&mut self, i: usize, from: &Loaded<'_, Coupled<C>>) -> Option<CoupledState> {
        self.0[i] = *from.system;
        Some(from.state)
    }

    fn unload(&self, state: &CoupledState, _system: &Coupled<C>, _clock: Clock) -> CoupledState {
        *state
    }

    fn idle(&mut self, i: usize) -> CoupledState {
        self.0[i].at_rest()
    }
}

impl<C: Coupling<Real = f64>> SideBySide for Coupled<C> {
    fn common(_job: &Job<Self>) -> Option<[f64; 2]> {
        Some([0.0; 2])
    }

    fn run(group: Group<'_, Self>) {
        group.run::<Logged<Masses<C, LANES>, LANES>>();
    }
}
