//! A periodic orbit as a boundary-value problem in its impact times.
//!
//! The sequence of walls is given. The unknowns are the instant of the first impact, the state after it (x, ẋ, and ẏ or
//! W = b θ̇, on the wall), and the instants of the other impacts; the equations say that the absorber is at its wall at each
//! instant, and that the state after one cycle is that at its begin. Between impacts the motion flies on whether or
//! not it stays in the gap, and an impact takes place whether or not the absorber moves towards the wall. So all
//! equations stay smooth where an impact vanishes or a new one would begin: there only the *admissibility* of the
//! solution is lost, by the sign of a speed or of a margin. No section of the motion is fixed that an impact could
//! meet.
//!
//! An impact may begin a stick episode (`orbit/episode.rs`): chatter, stick and release belong to the flight that follows
//! it, whose derivative is that of the run.
//!
//! Of an orbit that is its own mirror image half a cycle later, only half the cycle is solved for.

use nalgebra::{DMatrix, DVector, Matrix4, Matrix4xX, RowDVector, Vector4};

use super::coordinates::Coordinates;
use super::episode::{Episode, Lapse, Ridden};
use crate::absorber::{Clock, Wall};
use crate::measures::propagation::saltation;
use crate::segment::flight::Motion;

/// Unknowns besides the instants of the impacts after the first: its instant, x, ẋ and ẏ (or W) after it.
const FIRST: usize = 4;
/// The coordinates that these unknowns are.
const FREE: [usize; 3] = [0, 1, 3];
/// The coordinate that a wall fixes.
const GAP: usize = 2;

/// The sequence of impacts of an orbit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Chain {
    /// The walls in order; of a symmetric orbit those of the first half of the cycle.
    pub walls: Vec<Wall>,
    /// Of each impact whether it begins a stick episode: it then stands for all impacts of the chatter.
    pub sticks: Vec<bool>,
    /// True if the second half of the cycle is the mirror image of the first.
    pub symmetric: bool,
    /// Number of cycles of the scene that it takes to repeat.
    pub cycles: u32,
}

/// A flight of a chain between impacts, from an impact or a release on: the state at its begin, the instant of that, and the
/// time to the next impact. A ride is written in the same way.
#[derive(Debug, Clone)]
pub(super) struct Flown<State> {
    /// The index of the impact of the chain that comes before.
    pub after: usize,
    pub from: State,
    pub begin: f64,
    pub length: f64,
}

/// What a chain comes to for some values of its unknowns.
#[derive(Debug, Clone)]
pub(super) struct Passed<State> {
    /// The left-hand sides of the equations: lengths and velocities.
    pub residual: DVector<f64>,
    /// Their derivatives with respect to the unknowns; empty if they were not asked for.
    pub jacobian: DMatrix<f64>,
    /// The derivative of the map over the chain, in [`Coordinates`]: of a symmetric orbit that of the half map with the
    /// mirror.
    pub map: Matrix4<f64>,
    /// The approach speed of each impact; below 0 where the absorber would move away from the wall.
    pub speeds: Vec<f64>,
    /// The flights in order of time, those between the impacts of an episode among them.
    pub flights: Vec<Flown<State>>,
    /// The episodes in order, and the rides in them.
    pub episodes: Vec<Episode>,
    pub rides: Vec<Flown<State>>,
}

/// y of a wall, from the middle of the gap.
fn place<S: Coordinates>(system: &S, wall: Wall) -> f64 {
    system.clearance() * wall.sign()
}

/// The state after a flight that is not ended by walls, and the derivative with respect to the state at its begin.
pub(super) fn flown<S: Coordinates>(
    system: &S,
    from: &S::State,
    length: f64,
) -> Option<(S::State, Matrix4<f64>)> {
    let (mut state, mut left, mut tangent) = (*from, length, Matrix4::identity());
    if S::LINEAR {
        tangent = system.flight_tangent(from, length);
    }
    while left > 0.0 {
        let flight = system.flight(&state);
        let step = flight.reach().min(left);
        if step.is_nan() || step <= 0.0 {
            return None;
        }
        if !S::LINEAR {
            tangent = system.flight_tangent(&state, step) * tangent;
        }
        state = flight.arrival(step);
        left -= step;
    }
    (left == 0.0).then_some((state, tangent))
}

impl Chain {
    /// True if it tells an orbit; one without impacts stands for those of [`shooting`](super::branch::shooting).
    pub fn tells(&self) -> bool {
        !self.walls.is_empty()
    }

    /// Number of impacts until the motion repeats; a stick episode counts as one.
    pub fn impacts(&self) -> usize {
        self.walls.len() * if self.symmetric { 2 } else { 1 }
    }

    /// The time that the chain takes where a cycle of the scene takes this time: of a symmetric orbit half the time until
    /// the motion repeats.
    pub(super) fn length(&self, cycle: f64) -> f64 {
        cycle * f64::from(self.cycles) * if self.symmetric { 0.5 } else { 1.0 }
    }

    /// Number of unknowns and of equations.
    pub fn unknowns(&self) -> usize {
        FIRST - 1 + self.walls.len()
    }

    /// The wall of impact i, where the last one is the first of the next cycle, or the mirror image of the first.
    pub(super) fn wall(&self, i: usize) -> Wall {
        match self.walls.get(i) {
            Some(wall) => *wall,
            None if self.symmetric => self.walls[0].opposite(),
            None => self.walls[0],
        }
    }

    /// The instant of impact i of a chain of a length.
    pub(super) fn instant(&self, unknowns: &[f64], length: f64, i: usize) -> f64 {
        match i {
            0 => unknowns[0],
            _ if i == self.walls.len() => unknowns[0] + length,
            _ => unknowns[FIRST - 1 + i],
        }
    }

    /// −1 where the state at the end is to be the mirror image of that at the begin, else 1.
    fn sign(&self) -> f64 {
        if self.symmetric { -1.0 } else { 1.0 }
    }

    /// The chain of a cycle of this length (of a symmetric orbit half of it) for values of its unknowns.
    ///
    /// # Errors
    /// [`Lapse`] where the instants are not in order, a state is beyond what the system can have, or an episode does not end
    /// in stick and release.
    pub(super) fn passed<S: Coordinates>(
        &self,
        system: &S,
        length: f64,
        unknowns: &[f64],
        derivatives: bool,
    ) -> Result<Passed<S::State>, Lapse> {
        let (count, size) = (self.walls.len(), self.unknowns());
        let instants: Vec<f64> = (0..=count).map(|i| self.instant(unknowns, length, i)).collect();
        let in_order = instants.windows(2).all(|pair| pair[0] < pair[1]);
        if !(in_order && unknowns.iter().all(|it| it.is_finite())) {
            return Err(Lapse::Undefined);
        }
        let columns = if derivatives { size } else { 0 };
        let mut residual = DVector::zeros(size);
        let mut jacobian = DMatrix::zeros(if derivatives { size } else { 0 }, columns);
        let mut map = Matrix4::identity();
        let (mut speeds, mut flights) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let (mut episodes, mut rides) = (Vec::new(), Vec::new());

        let [x, v, w] = [unknowns[1], unknowns[2], unknowns[3]];
        let first = Vector4::new(x, v, place(system, self.wall(0)), w);
        let at = |numbers: &Vector4<f64>, time: f64| {
            let start = system.start_at(numbers).ok_or(Lapse::Undefined)?;
            Ok(system.begin_at(&start, Clock::new(time)))
        };
        let mut state = at(&first, instants[0])?;
        // How the state after the current impact depends on the unknowns.
        let mut carried = Matrix4xX::zeros(columns);
        if derivatives {
            for (k, coordinate) in FREE.into_iter().enumerate() {
                carried[(coordinate, 1 + k)] = 1.0;
            }
        }
        for i in 1..=count {
            let wall = self.wall(i);
            let (begin, end) = (instants[i - 1], instants[i]);
            let leaving = system.rates(&state);
            let mut flight = Flown { after: i - 1, from: state, begin, length: end - begin };
            let mut released = Matrix4::identity();
            if self.sticks[i - 1] {
                let ridden = Ridden::new(system, &state, i - 1, [begin, end])?;
                episodes.push(ridden.episode(i - 1, self.wall(i - 1), begin));
                (flight.from, flight.begin) = (ridden.released, ridden.release.value);
                flight.length = (Clock::new(end) - ridden.release).value;
                released = ridden.tangent;
                rides.push(ridden.ride);
                flights.extend(ridden.rebounds);
            }
            let (arrived, tangent) =
                flown(system, &flight.from, flight.length).ok_or(Lapse::Undefined)?;
            let tangent = tangent * released;
            flights.push(flight);
            let mut contact = system.coordinates(&arrived);
            let row = if i < count { i - 1 } else { size - FIRST };
            residual[row] = contact[GAP] - place(system, wall);
            contact[GAP] = place(system, wall);
            let touching = at(&contact, end)?;
            let before = system.rates(&touching);
            speeds.push(before[GAP] * wall.sign());
            let (after, _) = system.impact(&touching, end);
            let jump = system.impact_matrix([&touching, &after]);
            let rates = system.rates(&after);
            if derivatives {
                carried = tangent * carried;
                let mut add = |column: usize, by: Vector4<f64>| {
                    carried.column_mut(column).iter_mut().zip(by.iter()).for_each(|(a, b)| *a += b);
                };
                let column = |i: usize| if i.is_multiple_of(count) { 0 } else { FIRST - 1 + i };
                add(column(i - 1), -(tangent * leaving));
                add(column(i), before);
                jacobian.row_mut(row).copy_from(&RowDVector::from(carried.row(GAP)));
                carried.row_mut(GAP).fill(0.0);
                carried = jump * carried;
            }
            map = saltation(system, [&touching, &after], [&before, &rates]) * tangent * map;
            state = after;
        }
        let last = system.coordinates(&state);
        for (k, coordinate) in FREE.into_iter().enumerate() {
            let row = size - FREE.len() + k;
            residual[row] = last[coordinate] - self.sign() * first[coordinate];
            if derivatives {
                jacobian.row_mut(row).copy_from(&RowDVector::from(carried.row(coordinate)));
                jacobian[(row, 1 + k)] -= self.sign();
            }
        }
        let map = map * self.sign();
        Ok(Passed { residual, jacobian, map, speeds, flights, episodes, rides })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::absorber::Start;
    use crate::error::Invalid;
    use crate::force::{Acts, Force, Harmonic};
    use crate::orbit::Trajectory;
    use crate::orbit::periodic::{Missed, find};
    use crate::siva::Siva;

    /// Central differences, at and beside the orbit S1 of the references: chatter, stick and release on each wall.
    #[test]
    fn the_derivatives_through_an_episode_are_those_of_differences() -> Result<(), Missed> {
        let system = |restitution: f64| -> Result<_, Invalid> {
            let acts = Acts::Primary;
            let harmonic = Harmonic { amplitude: 1.0, frequency: 0.7, phase: 0.0, acts };
            let force = Force::harmonic(vec![harmonic])?;
            Ok(Siva::new(0.1, restitution, 0.25, 0.02)?.under(force))
        };
        let start = Start {
            displacement: 2.176_589_021_818_41,
            velocity: 0.111_600_297_722_162,
            gap_displacement: 0.168_039_634_175_835,
            gap_velocity: 0.183_456_265_851_444,
        };
        let length = TAU / 0.7;
        for (restitution, symmetric) in [(0.5, true), (0.5, false), (0.0, false)] {
            let system = system(restitution)?;
            let cycle = crate::orbit::Cycle { begin: 0.0, length };
            let orbit = find(&Trajectory::new(system.clone(), &start, cycle)?, symmetric, None)?;
            let both = Chain::of(&orbit, 1);
            assert!(both.is_ok(), "{both:?}");
            let Ok((chain, mut unknowns)) = both else { continue };
            assert!(chain.sticks.iter().all(|sticks| *sticks));
            unknowns[1] += 1e-3;
            unknowns[0] -= 2e-3;
            let length = chain.length(length);
            let at = |unknowns: &[f64]| chain.passed(&system, length, unknowns, true);
            let here = at(&unknowns);
            assert!(here.is_ok(), "{:?}", here.err());
            let Ok(here) = here else { continue };
            for column in 0..unknowns.len() {
                let moved = |by: f64| {
                    let mut moved = unknowns.clone();
                    moved[column] += by;
                    at(&moved).map(|passed| passed.residual)
                };
                // After a plastic impact the absorber can only leave the wall.
                if restitution == 0.0 && column == 3 {
                    continue;
                }
                let both = moved(1e-5).and_then(|high| Ok((high, moved(-1e-5)?)));
                assert!(both.is_ok(), "{column} {both:?}");
                let Ok((high, low)) = both else { continue };
                let off = (high - low) / 2e-5 - here.jacobian.column(column);
                assert!(off.amax() < 1e-8, "{restitution} {column}: {:e}", off.amax());
            }
        }
        Ok(())
    }
}
