//! Trajectories side by side in lanes.
//!
//! A lane flies through one cycle; at its end it begins the next one by itself, from the image. What is not simple is
//! left to the event loop, in the run of that cycle, until the lane can take over again.

use super::{Image, Iterated, Request, See, Trajectory, Turn, begun, derivative, image};
use crate::absorber::Clock;
use crate::engine::simulate::{Limits, Outcome};
use crate::measures::Wanted;
use crate::measures::forced::Forced;
use crate::measures::propagation::Tangent;
use crate::measures::steady::SteadyWanted;
use crate::number::vectors::in_vectors;
use crate::run::side_by_side::{Cycling, Loaded, Tier};

/// Number of evaluations between two checks of the cancel flag.
const CANCEL_EVERY: u32 = 1024;

/// Goes on with trajectories that fit together.
pub(super) fn iterate<S: Iterated<Derivative = Tangent>, L: Cycling<S>>(
    (trajectories, limits): (&[Trajectory<S>], &[Limits]),
    group: &[usize],
    request: Request<'_>,
    see: See<'_, S>,
) {
    let given = Given { trajectories, group, limits, request };
    in_vectors(
        #[inline(always)]
        || {
            // With the lanes as local variables of the vectorised function, its stack is aligned to the arrays.
            let mut lanes = L::cycling(&given.trajectory(0).system);
            let turns = (0..L::WIDTH).map(|_| None).collect();
            let mut all = Turns { given, see, turns, next: 0 };
            for i in 0..L::WIDTH {
                all.go_on(&mut lanes, i);
            }
            while all.is_live() && !crate::run::side_by_side::is_set(given.request.cancel) {
                for _ in 0..CANCEL_EVERY {
                    if lanes.evaluate() {
                        all.serve(&mut lanes);
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
struct Given<'a, S: Iterated> {
    trajectories: &'a [Trajectory<S>],
    /// Their indices.
    group: &'a [usize],
    /// The limits of a cycle of each trajectory.
    limits: &'a [Limits],
    request: Request<'a>,
}

impl<S: Iterated> Clone for Given<'_, S> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S: Iterated> Copy for Given<'_, S> {}

impl<'a, S: Iterated> Given<'a, S> {
    /// The trajectory at a position of the group.
    fn trajectory(&self, position: usize) -> &'a Trajectory<S> {
        &self.trajectories[self.group[position]]
    }

    /// A cycle from a state.
    fn begun(&self, position: usize, state: &S::State) -> Turn<'a, S> {
        let Request { tangents, cancel } = self.request;
        let limits = &self.limits[self.group[position]];
        begun(self.trajectory(position), state, limits, (tangents, cancel))
    }
}

/// The cycle of a lane.
struct Lane<'a, S: Iterated> {
    /// The position of its trajectory in the group.
    position: usize,
    turn: Turn<'a, S>,
    /// The tables of the fast tier.
    forced: Option<Box<Forced>>,
}

/// The cycles that the lanes are in.
struct Turns<'a, 'b, S: Iterated> {
    given: Given<'a, S>,
    see: See<'b, S>,
    turns: Vec<Option<Lane<'a, S>>>,
    /// The position of the first trajectory that has not begun.
    next: usize,
}

impl<S: Iterated<Derivative = Tangent>> Turns<'_, '_, S> {
    /// True if a lane has a trajectory.
    fn is_live(&self) -> bool {
        self.turns.iter().any(Option::is_some)
    }

    /// Serves the requests of the lanes.
    #[inline(never)]
    fn serve<L: Cycling<S>>(&mut self, lanes: &mut L) {
        for i in 0..L::WIDTH {
            if !lanes.requests(i) {
                continue;
            }
            let Some(Lane { turn, .. }) = &mut self.turns[i] else { continue };
            let system = turn.system;
            if let Some(tangent) = &mut turn.observer {
                lanes.follow(i, system, tangent);
            }
            if lanes.is_at_end(i) {
                self.repeat(lanes, i);
            } else {
                lanes.put_back_cycle(i, turn);
                // What the lane could not do is done here, before it is asked again.
                turn.step();
                self.go_on(lanes, i);
            }
        }
    }

    /// Lets a lane that is at the end of its cycle go on with the next one.
    fn repeat<L: Cycling<S>>(&mut self, lanes: &mut L, i: usize) {
        let Some(Lane { position, turn, forced }) = &mut self.turns[i] else { return };
        let (system, position) = (turn.system, *position);
        let Trajectory { state, cycle, .. } = self.given.trajectory(position);
        let state = system.with_drive_of(&lanes.shown(i, system), state);
        if let Some(tangent) = &mut turn.observer {
            tangent.turn(system, &state, Clock::new(turn.limits.duration), false);
        }
        let (impacts, outcome) = (lanes.impacts(i), Outcome::Finished);
        // The rides of this cycle; the run goes on with the next.
        let rides = std::mem::take(&mut turn.tally.episodes);
        let tangent = derivative(turn, rides);
        let image = Image { state, impacts, rides, outcome, tangent };
        let clock = Clock::new(cycle.begin);
        let from = Loaded { system, clock, state, forced: forced.as_deref() };
        if (self.see)(self.given.group[position], &image).is_break() {
            self.turns[i] = None;
        } else if lanes.repeat(i, &from) {
            if let Some(tangent) = &mut turn.observer {
                *tangent = Tangent::at(clock);
            }
            return;
        } else {
            *turn = self.given.begun(position, &state);
        }
        self.go_on(lanes, i);
    }

    /// Lets the event loop go on with the cycle of a lane, and with all that follow it, until the lane can take over; a
    /// lane without a trajectory is given the next one.
    fn go_on<L: Cycling<S>>(&mut self, lanes: &mut L, i: usize) {
        loop {
            let Some(Lane { position, turn, forced }) = &mut self.turns[i] else {
                if self.refill(lanes, i) {
                    continue;
                }
                return;
            };
            loop {
                if taken(lanes, i, turn, forced.as_deref()) {
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
    fn refill<L: Cycling<S>>(&mut self, lanes: &mut L, i: usize) -> bool {
        lanes.rest(i);
        let position = self.next;
        if position == self.given.group.len() {
            return false;
        }
        self.next += 1;
        let Trajectory { system, state, tier, cycle } = self.given.trajectory(position);
        let scene = system.forced().filter(|_| *tier == Tier::Fast);
        let wanted = (Wanted::NONE, SteadyWanted::default());
        let forced = scene.and_then(|scene| Forced::new(&scene, None, wanted, cycle.begin));
        let turn = self.given.begun(position, state);
        if self.given.request.tangents {
            lanes.listen(i);
        }
        self.turns[i] = Some(Lane { position, turn, forced });
        true
    }
}

/// Lets a lane take a run over, if the run is at a state from which it can.
fn taken<S: Iterated<Derivative = Tangent>, L: Cycling<S>>(
    lanes: &mut L,
    i: usize,
    turn: &Turn<'_, S>,
    forced: Option<&Forced>,
) -> bool {
    !turn.ended && lanes.take_cycle(i, turn, forced)
}
