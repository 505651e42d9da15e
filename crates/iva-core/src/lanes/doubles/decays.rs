//! Free decays: the lanes compute the motion only and log where the motions of the structure begin
//! ([`crate::log`]), as the event loop does where it goes on. Measures follow when a run has ended
//! ([`crate::measures::Decay`]).
//!
//! All runs of a group have one structure, whose motion is known in closed form for any length
//! ([`crate::host::sinusoid`]). While the structure cannot carry a wall to where the absorber is, no wall is
//! met, so the stretch leaps to where that ends.

use super::lane::{Lane, Lanes};
use super::motion::{FREE, State, Structure};
use super::responses::{Responses, Tables};
use super::step::{self, Rounds};
use super::{Lockstep, WIDTH};
use crate::flight::Motion;
use crate::host::Host;
use crate::host::sinusoid::{MOST_DAMPED, Sinusoid};
use crate::lanes::{Job, ScalarRun, Watching};
use crate::log::{Entry, Log};
use crate::measures::{Decay, MeasureValues, Measures, Wanted};
use crate::observe::{Observer, Span};
use crate::oscillator::Equation;
use crate::real::{Real, pick};
use crate::simulate::{Instant, STOPS, Tally};
use crate::siva::{Siva, SivaState};
use crate::steady::SteadyValues;
use crate::system::Clock;

/// The part of a leap that is taken, so that rounding leaves the absorber out of reach.
const SAFE: f64 = 1.0 - 1e-12;

/// True if the fast tier has decays of this structure.
pub(in crate::lanes) fn has(siva: &Siva) -> bool {
    siva.damping_ratio() <= MOST_DAMPED
}

/// Lanes of free masses in plain doubles, on one structure without drive.
#[derive(Debug)]
pub(in crate::lanes) struct FreeDecays {
    lanes: Lanes<WIDTH>,
    tables: Tables<WIDTH>,
    rounds: Rounds<WIDTH>,
    structure: Structure,
    sinusoid: Sinusoid,
    /// The log of the run of each lane.
    logs: [Log; WIDTH],
    wanted: Wanted,
}

impl Lockstep<Siva> for FreeDecays {
    const WIDTH: usize = WIDTH;
    type Observer = Logged;

    fn new(job: &Job<Siva>, wanted: Wanted) -> Self {
        let damping_ratio = job.system.damping_ratio();
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
            logs: Default::default(),
            wanted,
        }
    }

    fn join(leader: &Siva, siva: &Siva) {
        siva.host.share(&leader.host);
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        let Self { lanes, tables, rounds, sinusoid, logs, wanted, .. } = self;
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
        for (i, log) in logs.iter_mut().enumerate() {
            if rounds.hit[i] > 0.0 && keeps(*wanted, lanes.time[i]) {
                let State { x, v, side, rate, .. } = lanes.state.get(i);
                let v_before = rounds.end.v[i];
                log.push(Entry::new(lanes.clock(i), [x, v], v_before, v - side * rate, false));
                // The event loop hands a full log to the measures.
                if log.is_full() {
                    lanes.full[i] = 1.0;
                }
            }
        }
        let mut requests = 0.0;
        for i in 0..WIDTH {
            requests += lanes.request[i] + lanes.stopped[i] + lanes.full[i];
        }
        requests > 0.0
    }

    fn requests(&self, i: usize) -> bool {
        self.lanes.request[i] + self.lanes.stopped[i] + self.lanes.full[i] > 0.0
    }

    fn serve(&mut self, i: usize, run: &mut ScalarRun<'_, Siva, Logged>) -> bool {
        if self.lanes.stopped[i] > 0.0 {
            while run.stopped < STOPS {
                run.pass_stop();
            }
        }
        self.put_back(i, run);
        false
    }

    fn take(&mut self, i: usize, run: &mut ScalarRun<'_, Siva, Logged>) -> bool {
        if run.stopped == STOPS {
            return false;
        }
        let stop = run.limits.duration;
        let Some(lane) = Lane::of(run, &self.structure, stop) else { return false };
        self.lanes.set(i, &lane);
        if keeps(self.wanted, run.clock.value) {
            run.observer.begins(run.clock, &run.tally.state, false);
        }
        std::mem::swap(&mut self.logs[i], &mut run.observer.log);
        true
    }

    fn put_back(&mut self, i: usize, run: &mut ScalarRun<'_, Siva, Logged>) {
        let lane = self.lanes.get(i);
        lane.put_back(run);
        std::mem::swap(&mut self.logs[i], &mut run.observer.log);
        run.observer.v_before = lane.state.v;
    }

    fn idle(&mut self, i: usize) {
        self.lanes.set(i, &Lane::idle());
    }
}

/// True if the motions that begin at an instant are to be logged: all of them, or those of the first period,
/// which the energy lost in it depends on.
#[inline(always)]
fn keeps(wanted: Wanted, time: f64) -> bool {
    wanted.decay() || wanted.ledger || time <= f64::TURN.value
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

/// An observer that logs a run.
#[derive(Debug)]
pub(in crate::lanes) struct Logged {
    log: Log,
    measures: Measures<Siva>,
    decay: Decay,
    /// ẋ at the end of the motion before.
    v_before: f64,
}

impl Watching<Siva> for Logged {
    fn new(job: &Job<Siva>, wanted: Wanted, spare: Option<Self>) -> Self {
        let [damping_ratio, mass_ratio] = [job.system.damping_ratio(), job.system.mass_ratio()];
        let (log, decay) = match spare {
            Some(Self { log, decay, .. }) => (log, decay.serves(damping_ratio, mass_ratio)),
            None => (Log::default(), Decay::new(damping_ratio, mass_ratio)),
        };
        Self { log, measures: Measures::new(wanted), decay, v_before: 0.0 }
    }

    fn values(&self) -> (MeasureValues, Option<SteadyValues>) {
        (*self.measures.values(), None)
    }
}

impl Logged {
    /// Logs that a motion begins.
    fn begins(&mut self, clock: Clock, state: &SivaState, stuck: bool) {
        let [x, v] = [state.host.primary.x.value, state.host.primary.v.value];
        let absorber = v + state.gap_velocity();
        let entry = Entry::new(clock, [x, v], self.v_before, absorber, stuck);
        self.log.push(entry);
        if self.log.is_full() {
            // Settling levels are not known before the reference amplitude.
            if self.measures.reference.settled {
                self.decay.take(&mut self.measures, self.log.entries());
                self.log.clear();
                self.log.push(entry);
            } else {
                self.log.grow();
            }
        }
    }
}

impl Observer<Siva> for Logged {
    fn start(&mut self, siva: &Siva, from: &Instant<SivaState>, duration: f64) {
        self.measures.start(siva, from, duration);
        self.log.clear();
        self.v_before = from.state.host.primary.v.value;
    }

    fn span<M: Motion<Real = f64, State = SivaState>>(&mut self, _siva: &Siva, span: &Span<'_, M>) {
        if keeps(self.measures.wanted, span.start.value) {
            self.begins(span.start, span.motion.origin(), M::RIDING);
        }
        self.v_before = span.to.v;
    }

    fn end(&mut self, siva: &Siva, tally: &Tally<SivaState>) {
        self.begins(tally.clock, &tally.state, false);
        self.decay.take(&mut self.measures, self.log.entries());
        self.measures.end(siva, tally);
    }
}
