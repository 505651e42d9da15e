//! Trajectories of free masses under one harmonic force, side by side in lanes.
//!
//! A lane flies through one cycle. At its end, and at all that is not simple, the event loop goes on with the run of that
//! cycle; the next cycle is a new run, which the lane takes over at once.

use super::{Image, Request, See, Trajectory, Turn, begun, image};
use crate::host::DrivenHost;
use crate::lanes::free_mass::{ExactDriven, FastDriven, FreeMasses, Loaded, Tier};
use crate::lanes::{self, LANES, WIDE};
use crate::measures::Wanted;
use crate::measures::forced::Forced;
use crate::plain::{BASE, FORCE};
use crate::propagation::Tangent;
use crate::real::Real;
use crate::simulate::{Limits, Outcome};
use crate::siva::Siva;
use crate::steady::SteadyWanted;
use crate::system::{Clock, System};

type Mass = Siva<DrivenHost>;

/// Number of evaluations between two checks of the cancel flag.
const CANCEL_EVERY: u32 = 1024;

/// Goes on with trajectories that fit together.
pub(super) fn iterate(
    (trajectories, limits): (&[Trajectory<Mass>], &[Limits]),
    group: &[usize],
    request: Request<'_>,
    see: See<'_, Mass>,
) {
    let Trajectory { system, tier, .. } = &trajectories[group[0]];
    let given = Given { trajectories, group, limits, request };
    match (tier, system.moves_base()) {
        (lanes::Tier::Fast, true) => run::<FastDriven<BASE, WIDE>, WIDE>(given, see),
        (lanes::Tier::Fast, false) => run::<FastDriven<FORCE, WIDE>, WIDE>(given, see),
        (lanes::Tier::Exact, true) => run::<ExactDriven<true, LANES>, LANES>(given, see),
        (lanes::Tier::Exact, false) => run::<ExactDriven<false, LANES>, LANES>(given, see),
    }
}

fn run<T: Tier<System = Mass>, const W: usize>(given: Given<'_>, see: See<'_, Mass>) {
    f64::dispatched(
        #[inline(always)]
        || {
            // With the lanes as local variables of the vectorised function, its stack is aligned to the arrays.
            let mut masses = FreeMasses::<T, W>::new(&given.trajectory(0).system);
            let turns = (0..W).map(|_| None).collect();
            let mut all = Turns { given, see, turns, next: 0 };
            for i in 0..W {
                all.go_on(&mut masses, i);
            }
            while all.is_live() && !lanes::is_set(given.request.cancel) {
                for _ in 0..CANCEL_EVERY {
                    masses.attempt();
                    if masses.advance() {
                        all.serve(&mut masses);
                        if !all.is_live() {
                            break;
                        }
                    }
                }
            }
        },
    );
}

/// The trajectories that fit together, and what is computed of them.
#[derive(Clone, Copy)]
struct Given<'a> {
    trajectories: &'a [Trajectory<Mass>],
    /// Their indices.
    group: &'a [usize],
    /// The limits of a cycle of each trajectory.
    limits: &'a [Limits],
    request: Request<'a>,
}

impl<'a> Given<'a> {
    /// The trajectory at a position of the group.
    fn trajectory(&self, position: usize) -> &'a Trajectory<Mass> {
        &self.trajectories[self.group[position]]
    }

    /// A cycle from a state.
    fn begun(&self, position: usize, state: &<Mass as System>::State) -> Turn<'a, Mass> {
        let Request { tangents, cancel } = self.request;
        let limits = &self.limits[self.group[position]];
        begun(self.trajectory(position), state, limits, (tangents, cancel))
    }
}

/// The cycle of a lane.
struct Lane<'a> {
    /// The position of its trajectory in the group.
    position: usize,
    turn: Turn<'a, Mass>,
    /// The tables of the fast tier.
    forced: Option<Box<Forced>>,
}

/// The cycles that the lanes are in.
struct Turns<'a, 'b> {
    given: Given<'a>,
    see: See<'b, Mass>,
    turns: Vec<Option<Lane<'a>>>,
    /// The position of the first trajectory that has not begun.
    next: usize,
}

impl Turns<'_, '_> {
    /// True if a lane has a trajectory.
    fn is_live(&self) -> bool {
        self.turns.iter().any(Option::is_some)
    }

    /// Serves the requests of the lanes.
    #[inline(never)]
    fn serve<T: Tier<System = Mass>, const W: usize>(&mut self, masses: &mut FreeMasses<T, W>) {
        for i in 0..W {
            if !masses.requests(i) {
                continue;
            }
            let Some(Lane { turn, .. }) = &mut self.turns[i] else { continue };
            let system = turn.system;
            if let Some(tangent) = &mut turn.observer {
                masses.take_struck(
                    i,
                    system,
                    #[inline(always)]
                    |impact, states| {
                        tangent.struck(system, Clock::new(impact.time), states);
                    },
                );
            }
            if masses.is_at_end(i) {
                self.repeat(masses, i);
            } else {
                masses.put_back(i, turn);
                // What the lane could not do is done here, before it is asked again.
                turn.step();
                self.go_on(masses, i);
            }
        }
    }

    /// Lets a lane that is at the end of its cycle go on with the next one.
    fn repeat<T: Tier<System = Mass>, const W: usize>(
        &mut self,
        masses: &mut FreeMasses<T, W>,
        i: usize,
    ) {
        let Some(Lane { position, turn, forced }) = &mut self.turns[i] else { return };
        let (system, position) = (turn.system, *position);
        let Trajectory { state, cycle, .. } = self.given.trajectory(position);
        let state = system.with_drive_of(&masses.shown(i, system), state);
        let tangent = turn.observer.as_mut().map(|tangent| {
            tangent.turn(system, &state, Clock::new(turn.limits.duration), false);
            *tangent.derivative()
        });
        let (impacts, outcome) = (masses.impacts(i), Outcome::Finished);
        let image = Image { state, impacts, outcome, tangent };
        let clock = Clock::new(cycle.begin);
        let from = Loaded { system, clock, state, forced: forced.as_deref() };
        if (self.see)(self.given.group[position], &image).is_break() {
            self.turns[i] = None;
        } else if masses.repeat(i, &from) {
            if let Some(tangent) = &mut turn.observer {
                *tangent = Tangent::at(system, &state, clock);
            }
            return;
        } else {
            *turn = self.given.begun(position, &state);
        }
        self.go_on(masses, i);
    }

    /// Lets the event loop go on with the cycle of a lane, and with all that follow it, until the lane can take over; a
    /// lane without a trajectory is given the next one.
    fn go_on<T: Tier<System = Mass>, const W: usize>(
        &mut self,
        masses: &mut FreeMasses<T, W>,
        i: usize,
    ) {
        loop {
            let Some(Lane { position, turn, forced }) = &mut self.turns[i] else {
                if self.refill(masses, i) {
                    continue;
                }
                return;
            };
            loop {
                if taken(masses, i, turn, forced.as_deref()) {
                    return;
                }
                if !turn.step() {
                    break;
                }
            }
            let image = image(turn, &self.given.trajectory(*position).state);
            let ends = image.outcome == Outcome::Cancelled
                || (self.see)(self.given.group[*position], &image).is_break()
                || image.outcome != Outcome::Finished;
            if ends {
                self.turns[i] = None;
            } else {
                *turn = self.given.begun(*position, &image.state);
            }
        }
    }

    /// Gives a lane the next trajectory, if there is one.
    fn refill<T: Tier<System = Mass>, const W: usize>(
        &mut self,
        masses: &mut FreeMasses<T, W>,
        i: usize,
    ) -> bool {
        masses.idle(i);
        let position = self.next;
        if position == self.given.group.len() {
            return false;
        }
        self.next += 1;
        let Trajectory { system, state, tier, cycle } = self.given.trajectory(position);
        let scene = system.forced().filter(|_| *tier == lanes::Tier::Fast);
        let wanted = (Wanted::NONE, SteadyWanted::default());
        let forced = scene.and_then(|scene| Forced::new(&scene, None, wanted, cycle.begin));
        let turn = self.given.begun(position, state);
        if self.given.request.tangents {
            masses.list_impacts(i, true);
        }
        self.turns[i] = Some(Lane { position, turn, forced });
        true
    }
}

/// Lets a lane take a run over, if the run is at a state from which it can.
fn taken<T: Tier<System = Mass>, const W: usize>(
    masses: &mut FreeMasses<T, W>,
    i: usize,
    turn: &Turn<'_, Mass>,
    forced: Option<&Forced>,
) -> bool {
    !turn.ended && masses.take(i, turn, forced)
}
