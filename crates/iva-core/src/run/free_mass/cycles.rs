//! Trajectories of free masses from cycle to cycle.

use super::{FreeMasses, Loaded, Tier};
use crate::absorber::Clock;
use crate::absorber::plain::State;
use crate::absorber::siva::{Siva, SivaState};
use crate::engine::simulate::Run;
use crate::host::{Host, Phase};
use crate::measures::forced::Forced;
use crate::measures::propagation::Tangent;
use crate::number::arrays::Lanes as _;
use crate::run::side_by_side::{Cycling, SideBySide};

impl<H: Host<Real = f64>, T: Tier<System = Siva<H>>, const W: usize> Cycling<Siva<H>>
    for FreeMasses<T, W>
where
    Siva<H>: SideBySide<State = SivaState<Phase<H>>>,
{
    const WIDTH: usize = W;

    fn cycling(leader: &Siva<H>) -> Self {
        Self::new(leader)
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        self.attempt();
        self.advance()
    }

    fn requests(&self, i: usize) -> bool {
        Self::requests(self, i)
    }

    fn is_at_end(&self, i: usize) -> bool {
        self.lanes.stopped[i] > 0.0 && self.lanes.request[i] + self.lanes.full[i] == 0.0
    }

    fn shown(&self, i: usize, system: &Siva<H>) -> SivaState<Phase<H>> {
        self.tier.shown(&self.states.get(i), system, self.lanes.progress.clock.get(i))
    }

    fn impacts(&self, i: usize) -> u64 {
        self.lanes.progress.counts.impacts[i] as u64
    }

    fn listen(&mut self, i: usize) {
        self.list_impacts(i, true);
    }

    fn follow(&mut self, i: usize, system: &Siva<H>, tangent: &mut Tangent) {
        self.take_struck(
            i,
            system,
            #[inline(always)]
            |impact, states| tangent.struck(system, Clock::new(impact.time), states),
        );
    }

    fn take_cycle<O>(
        &mut self,
        i: usize,
        run: &Run<'_, Siva<H>, O>,
        forced: Option<&Forced>,
    ) -> bool {
        self.take(i, run, forced)
    }

    fn put_back_cycle<O>(&mut self, i: usize, run: &mut Run<'_, Siva<H>, O>) {
        self.put_back(i, run);
    }

    fn repeat(&mut self, i: usize, from: &Loaded<'_, Siva<H>>) -> bool {
        let State { x, v, distance, .. } = T::in_doubles(&from.state);
        let Some(state) = self.tier.load(i, from) else { return false };
        let goes_on = distance > 0.0 && (x + v).is_finite();
        if goes_on {
            self.states.set(i, &state);
            self.lanes.set(i, &self.lanes.get(i).repeated(from.clock, self.tier.longest(i)));
        }
        goes_on
    }

    fn rest(&mut self, i: usize) {
        self.idle(i);
    }
}
