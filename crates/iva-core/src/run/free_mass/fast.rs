//! Free masses of the fast tier: states in plain doubles.

use super::{Loaded, Tier, of_siva};
use crate::absorber::Clock;
use crate::absorber::plain::mass::Mass;
use crate::absorber::plain::responses::{OfLane, Tables};
use crate::absorber::plain::{BASE, State, Structure, Structures};
use crate::absorber::siva::{Siva, SivaState};
use crate::force::{Pushes, Smooth};
use crate::host::oscillator::Primary;
use crate::host::{DrivenHost, Host, Moment, Phase};
use crate::number::arrays::Lanes as _;
use crate::number::compensated::DoubleDouble;

/// A state at rest in the middle of the gap.
const AT_REST: State =
    State { x: 0.0, v: 0.0, force: 0.0, quadrature: 0.0, distance: 1.0, rate: 0.0, side: 1.0 };

/// Free masses under one harmonic force each, on the structure or on its base.
#[derive(Debug)]
pub(crate) struct FastDriven<const DRIVE: u8, const W: usize> {
    structures: Structures<W>,
    tables: Tables<W>,
}

impl<const DRIVE: u8, const W: usize> Tier for FastDriven<DRIVE, W> {
    type System = Siva<DrivenHost>;
    type State = State;
    type Responses = ();
    type Mass<'a> = Mass<OfLane<'a, W>, DRIVE>;
    const STAGED: bool = true;

    of_siva!();

    fn new(_system: &Siva<DrivenHost>) -> Self {
        Self { structures: Structures::new(), tables: Tables::new() }
    }

    #[inline(always)]
    fn with<T>(&self, i: usize, from: &State, act: impl FnOnce(&Self::Mass<'_>, &State) -> T) -> T {
        act(&Mass { structure: self.structures.get(i), responses: self.tables.of(i) }, from)
    }

    #[inline(always)]
    fn longest(&self, i: usize) -> f64 {
        self.structures.longest[i]
    }

    #[inline(always)]
    fn refreshed(&self, i: usize, state: &State, clock: Clock) -> State {
        let [force, quadrature] = self.structures.get(i).force_at(clock);
        State { force, quadrature, ..*state }
    }

    fn load(&mut self, i: usize, from: &Loaded<'_, Self::System>) -> Option<State> {
        let log = from.forced?;
        self.tables.set(i, &log.responses);
        self.structures.set(i, &log.structure);
        let state = from.state.in_doubles();
        let [force, quadrature] = log.structure.force_at(from.clock);
        Some(State { force, quadrature, ..state })
    }

    fn unload(
        &self,
        state: &State,
        system: &Siva<DrivenHost>,
        clock: Clock,
    ) -> SivaState<Phase<DrivenHost>> {
        unload(state, &system.host, clock)
    }

    #[inline(always)]
    fn shown(
        &self,
        state: &State,
        system: &Siva<DrivenHost>,
        time: Clock,
    ) -> SivaState<Phase<DrivenHost>> {
        let mut pushes = Pushes::NONE;
        if DRIVE == BASE {
            pushes.base.value = DoubleDouble::new(-state.force);
        } else {
            pushes.primary.value = DoubleDouble::new(state.force);
        }
        let phase = Moment { time, kicks: 0, smooth: Smooth::ALL, pushes };
        in_double_double(state, &system.host, phase)
    }

    fn idle(&mut self, i: usize) -> State {
        let structure = Structure { longest: 1.0, over_longest: 1.0, ..Structure::default() };
        self.structures.set(i, &structure);
        AT_REST
    }
}

/// A state in the form of the event loop.
fn unload<H: Host<Real = f64>>(state: &State, host: &H, clock: Clock) -> SivaState<Phase<H>> {
    in_double_double(state, host, host.begin_at(clock))
}

#[inline(always)]
fn in_double_double<H: Host<Real = f64>>(
    state: &State,
    host: &H,
    phase: Phase<H>,
) -> SivaState<Phase<H>> {
    let State { x, v, distance, rate, side, .. } = *state;
    let primary = Primary { x: DoubleDouble::new(x), v: DoubleDouble::new(v) };
    SivaState {
        host: host.state(phase, primary),
        side,
        distance: DoubleDouble::new(distance),
        rate: DoubleDouble::new(rate),
    }
}
