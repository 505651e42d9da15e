//! Flights of free decays. All runs of a group have one structure, whose motion is known in closed form for any length
//! ([`crate::host::sinusoid`]). While the structure cannot carry a wall to where the absorber is, no wall is
//! met, so the stretch leaps to where that ends.

use super::WIDTH;
use super::lane::{Lane, Lanes};
use super::step::{self, Rounds};
use crate::arrays::any;
use crate::host::sinusoid::Sinusoid;
use crate::lanes::decays::{Decaying, Flights};
use crate::log::Entry;
use crate::oscillator::Equation;
use crate::plain::responses::{Responses, Tables};
use crate::plain::{FREE, State, Structure};
use crate::real::pick;
use crate::siva::Siva;

/// The part of a leap that is taken, so that rounding leaves the absorber out of reach.
const SAFE: f64 = 1.0 - 1e-12;

/// Lanes of free masses in plain doubles, on one structure without drive.
#[derive(Debug)]
pub(in crate::lanes) struct FreeFlights {
    lanes: Lanes<WIDTH>,
    tables: Tables<WIDTH>,
    rounds: Rounds<WIDTH>,
    structure: Structure,
    sinusoid: Sinusoid,
}

impl Flights for FreeFlights {
    const WIDTH: usize = WIDTH;

    fn new(siva: &Siva) -> Self {
        let damping_ratio = siva.damping_ratio();
        let equation = Equation::new(1.0, damping_ratio);
        let responses = Responses::new(equation.damping, equation.growth, 0.0);
        let mut tables = Tables::new();
        (0..WIDTH).for_each(|i| tables.set(i, &responses));
        Self {
            lanes: Lanes::new(),
            tables,
            rounds: Rounds::new(),
            structure: Structure::new(&equation, responses.longest),
            sinusoid: Sinusoid::new(1.0, damping_ratio),
        }
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        let Self { lanes, tables, rounds, sinusoid, .. } = self;
        // By value, so that the compiler knows that no store into a lane changes it.
        let sinusoid = *sinusoid;
        step::reach::<WIDTH, FREE>(
            lanes,
            rounds,
            #[inline(always)]
            |lane, _| reached(&sinusoid, lane),
        );
        step::land::<WIDTH, FREE>(lanes, tables, rounds);
        step::commit::<WIDTH, FREE>(
            lanes,
            rounds,
            #[inline(always)]
            |state, clearance| leap(&sinusoid, state, clearance),
        );
        any(&lanes.request) | any(&lanes.stopped) | any(&lanes.full)
    }

    #[inline(always)]
    fn times(&self) -> &[f64] {
        &self.lanes.time
    }

    #[inline(always)]
    fn hits(&self) -> bool {
        any(&self.rounds.hit)
    }

    #[inline(always)]
    fn motion(&self, i: usize) -> Option<Entry> {
        (self.rounds.hit[i] > 0.0).then(|| {
            let State { x, v, side, rate, .. } = self.lanes.state.get(i);
            let v_before = self.rounds.end.v[i];
            Entry::new(self.lanes.clock(i), [x, v], v_before, v - side * rate, false)
        })
    }

    fn requests(&self, i: usize) -> bool {
        self.lanes.request[i] + self.lanes.stopped[i] + self.lanes.full[i] > 0.0
    }

    fn take(&mut self, i: usize, run: &Decaying<'_>) -> bool {
        let lane = Lane::of(run, &self.structure, run.limits.duration);
        if let Some(lane) = &lane {
            self.lanes.set(i, lane);
        }
        lane.is_some()
    }

    fn put_back(&self, i: usize, run: &mut Decaying<'_>) -> f64 {
        if self.lanes.stopped[i] > 0.0 {
            run.reach_end();
        }
        let lane = self.lanes.get(i);
        lane.put_back(run);
        lane.state.v
    }

    fn idle(&mut self, i: usize) {
        self.lanes.set(i, &Lane::idle());
    }
}

/// The state at the end of a trial.
#[inline(always)]
fn reached(sinusoid: &Sinusoid, lane: &Lane) -> State {
    let Lane { state, structure, length: h, .. } = *lane;
    let State { x, v, distance, rate, side, .. } = state;
    let by = sinusoid.responses(h);
    let ([x_far, v_far], [further, faster]) =
        (sinusoid.moved([x, v], &by), sinusoid.gained([x, v], &by));
    let leaps = h > structure.longest;
    let absorber = side.mul_add(-rate, v);
    let moved = side * absorber.mul_add(-h, x_far - x);
    let near = rate.mul_add(h, side * further);
    State {
        x: pick(leaps, x_far, x + v.mul_add(h, further)),
        v: pick(leaps, v_far, v + faster),
        distance: distance + pick(leaps, moved, near),
        rate: pick(leaps, side * (v_far - absorber), side.mul_add(faster, rate)),
        ..state
    }
}

/// The time for which the structure cannot carry a wall to the absorber from a state on; 0 if it can.
///
/// |x| stays below |Z|, so an absorber in uniform motion meets no wall while its displacement is within
/// d − |Z|.
#[inline(always)]
fn leap(sinusoid: &Sinusoid, state: &State, clearance: f64) -> f64 {
    let State { x, v, distance, rate, side, .. } = *state;
    let place = side.mul_add(clearance - distance, x);
    let speed = side.mul_add(-rate, v);
    let window = clearance - sinusoid.radius([x, v]);
    let way = window - pick(speed < 0.0, -place, place);
    let time = SAFE * way / (speed.abs() + f64::MIN_POSITIVE);
    pick(place.abs() < window, time, 0.0)
}
