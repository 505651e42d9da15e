//! Lists of free masses in lanes.
//!
//! One round of a lane is a stretch in which all masses fly ([`round`]), decided at once from the values at both ends
//! ([`crate::absorber::several::sight`]), as the event loop decides it: each mass meets no wall, or one wall once. The
//! stretch ends at the first contact. If no other mass touches a wall there, the lane has the impact by itself.
//!
//! A lane computes only motions. What its run counts, and tells its observers, it learns from the [`log`] of the impacts: it
//! strikes once more from each state in contact, as if it had come there by itself. What is not simple (impacts of several
//! masses at one instant, low rebounds, stick, a grazing, the end) is left to the run from the begin of the stretch.
//!
//! The loops are those over lanes, which become vector instructions: no loop over masses is left in them. A loop whose body is too
//! large does not become vectors, so under a force the first contacts are found in a loop of their own.

use super::side_by_side::{Job, Listing, Lockstep, ScalarRun, SideBySide};
use super::structures::Structures;
use crate::absorber::several::{InGap, Several, SeveralState};
use crate::absorber::siva::{Law, coasts};
use crate::engine::progress::Progress;
use crate::host::oscillator::Primary;
use crate::host::{Host as _, HostState, Steps};
use crate::measures::summary::Summary;
use crate::measures::{Wanted, keeps};
use crate::number::arrays::{Laned, Lanes as Over, any, arrays};
use crate::number::compensated::DoubleDouble;
use crate::number::real::pick;
use log::{Impact, Log, Stretch};
use round::{Contact, Contacts, Mass, Round, Rounds, State, States, ended, first_contact};

mod log;
mod round;

arrays! {
    /// The variables of the run of one lane.
    Lane, Lanes:;
    /// Clock, counts and limits.
    progress: Progress,
    /// True if its run is needed.
    request: bool,
}

/// Lists of K free masses in lanes.
#[derive(Debug)]
pub(super) struct Lists<S: Structures, const K: usize, const W: usize> {
    structures: S,
    lanes: Lanes<W>,
    contacts: Contacts<W>,
    rounds: Rounds<W>,
    masses: <[Mass; K] as Laned>::Lanes<W>,
    /// The states at the begin of a stretch.
    states: States<S::Phase, K, W>,
    /// The states at its end, in contact, and after the impact.
    ends: [States<S::Phase, K, W>; 3],
    /// The numbers of steps that lanes coast.
    counts: [f64; W],
    logs: Vec<Log<S::Phase, K>>,
}

/// The run of a lane.
type RunOf<'a, S> = ScalarRun<'a, Several<<S as Structures>::Host>>;

impl<S: Structures, const K: usize, const W: usize> Lists<S, K, W>
where
    Several<S::Host>: SideBySide<State = SeveralState<S::Host>>,
{
    /// One stretch of each lane, in one loop over lanes or in two ([`Structures::ONE_LOOP`]).
    #[inline(always)]
    fn attempt(&mut self) {
        for i in 0..if S::ONE_LOOP { 0 } else { W } {
            let (lane, masses, from) = (self.lanes.get(i), self.masses.get(i), self.states.get(i));
            let length = self.structures.longest(i).min(lane.progress.ahead());
            let mut contact = Contact::default();
            self.structures.with(
                i,
                &from.host,
                #[inline(always)]
                |flight, host| {
                    let from = State { host: *host, ..from };
                    contact = first_contact(flight, &masses, &from, length);
                },
            );
            self.contacts.set(i, &contact);
        }
        for i in 0..W {
            let (lane, masses, from) = (self.lanes.get(i), self.masses.get(i), self.states.get(i));
            let length = self.structures.longest(i).min(lane.progress.ahead());
            let mut contact = self.contacts.get(i);
            let (mut found, mut states) = (Round::default(), [from; 3]);
            self.structures.with(
                i,
                &from.host,
                #[inline(always)]
                |flight, host| {
                    let from = State { host: *host, ..from };
                    if S::ONE_LOOP {
                        contact = first_contact(flight, &masses, &from, length);
                    }
                    (found, states) = ended(flight, &lane, &masses, &from, (length, &contact));
                },
            );
            self.rounds.set(i, &found);
            self.ends[0].set(i, &states[0]);
            self.ends[1].set(i, &states[1]);
            self.ends[2].set(i, &states[2]);
        }
    }

    /// Goes to the end of the stretch in the lanes that need nothing of their runs.
    #[inline(always)]
    fn advance(&mut self) {
        for i in 0..W {
            let (lane, round) = (self.lanes.get(i), self.rounds.get(i));
            let Round { h, later, first, passed, hit, .. } = round;
            let clock = lane.progress.clock.plus_parts(h, 0.0);
            let mut progress = lane.progress.moved(passed, clock, first);
            let touched = progress.clock.plus_parts(later, 0.0);
            progress.clock = Laned::pick(hit, &touched, &progress.clock);
            progress.counts.impacts += pick(hit, 1.0, 0.0);
            let request = !passed | progress.is_full();
            self.lanes.set(i, &Lane { progress, request });
            self.states.set(i, &Laned::pick(passed, &self.ends[2].get(i), &self.states.get(i)));
        }
    }

    /// Logs what the lanes have done; true if a log is full.
    #[inline(never)]
    fn log(&mut self) -> bool {
        let mut full = false;
        for (i, log) in self.logs.iter_mut().enumerate() {
            let Round { h, hit, passed, which, .. } = self.rounds.get(i);
            if hit | (log.looks & passed) {
                let [end, touching, _] = &self.ends;
                let clock = self.lanes.progress.clock.get(i);
                let impact =
                    hit.then(|| Impact { which: which as usize, clock, touching: touching.get(i) });
                log.push(&Stretch { h, end: end.get(i), impact });
                full |= log.is_full();
            }
        }
        full
    }

    /// Lets the lanes coast whose masses are all far from their walls.
    #[inline(always)]
    fn coast(&mut self) {
        let Self { structures, lanes, rounds, masses, states, counts, .. } = self;
        let Some(steps) = structures.steps() else { return };
        for (i, count) in counts.iter_mut().enumerate() {
            let (lane, round, state) = (lanes.get(i), rounds.get(i), states.get(i));
            let masses: [Mass; K] = masses.get(i);
            let mut least = f64::INFINITY;
            for (place, mass) in state.places.iter().zip(&masses) {
                let at = place.in_doubles(&state.host.primary);
                let within = [1.0 / mass.clearance, lane.progress.remaining()];
                least = least.min(coasts::count(steps, &at, within));
            }
            *count = pick(round.passed & !round.hit, least, 0.0);
        }
        if !any(counts) {
            return;
        }
        for (i, &count) in counts.iter().enumerate() {
            let (mut lane, state) = (lanes.get(i), states.get(i));
            let time = steps.time(count);
            let to = coasted(steps, &state, count);
            let later = lane.progress.later(time).clock;
            lane.progress.clock = Laned::pick(count > 0.0, &later, &lane.progress.clock);
            lanes.set(i, &lane);
            states.set(i, &Laned::pick(count > 0.0, &to, &state));
        }
    }
}

/// The state after some steps.
#[inline(always)]
fn coasted<P: Copy, const K: usize>(steps: &Steps, from: &State<P, K>, count: f64) -> State<P, K> {
    let HostState { primary, phase, .. } = from.host;
    let (to, acceleration) = steps.after(&primary, steps.responses(count as usize));
    let mut places = from.places;
    for place in &mut places {
        let InGap { side, distance, rate, .. } = *place;
        let drifted = coasts::drifted([&primary, &to], side, [distance, rate], steps.time(count));
        [place.distance, place.rate] = drifted;
    }
    State { host: HostState { primary: to, acceleration, phase }, places }
}

impl<S: Structures, const K: usize, const W: usize> Lockstep<Several<S::Host>> for Lists<S, K, W>
where
    Several<S::Host>: SideBySide<State = SeveralState<S::Host>>,
{
    const WIDTH: usize = W;

    fn new(job: &Job<Several<S::Host>>, _wanted: Wanted, _listing: &Listing) -> Self {
        Self {
            structures: S::new(&job.system.host),
            lanes: Lanes::new(),
            contacts: Over::new(),
            rounds: Over::new(),
            masses: Over::new(),
            states: Over::new(),
            ends: [Over::new(), Over::new(), Over::new()],
            counts: [0.0; W],
            logs: (0..W).map(|_| Log::default()).collect(),
        }
    }

    fn join(leader: &Several<S::Host>, list: &Several<S::Host>) {
        list.host.share(&leader.host);
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        self.attempt();
        self.advance();
        let full = self.log();
        self.coast();
        full | any(&self.lanes.request)
    }

    fn requests(&self, i: usize) -> bool {
        self.lanes.request[i] > 0.0 || self.logs[i].is_full()
    }

    fn serve(&mut self, i: usize, run: &mut RunOf<'_, S>) -> bool {
        self.put_back(i, run);
        self.lanes.request[i] == 0.0
    }

    fn take(&mut self, i: usize, run: &mut RunOf<'_, S>) -> bool {
        let (system, state) = (run.system, run.tally.state);
        let Summary { measures, steady, beside: (_, (extremes, passes)), .. } = &mut *run.observer;
        let logged = measures.decay.is_some() || !keeps(measures.wanted, 0.0);
        let looks = !logged || steady.is_some() || extremes.is_some() || !passes.is_empty();
        // Steps that a lane coasts are not shown to observers.
        let fits = !looks || self.structures.steps().is_none();
        if !(fits && run.all_fly() && self.structures.load(i, &system.host, &state.host)) {
            return false;
        }
        self.logs[i].looks = looks;
        run.observer.measures.begins(system, run.progress.clock, &state, false);
        let mut masses = [Mass::default(); K];
        for (mass, of) in masses.iter_mut().zip(system.masses()) {
            *mass = Mass { clearance: of.clearance, laws: of.laws };
        }
        let mut places = [InGap::UNUSED; K];
        places.copy_from_slice(&state.masses[..K]);
        self.lanes.set(i, &Lane { progress: run.progress, request: false });
        self.masses.set(i, &masses);
        self.states.set(i, &State { host: state.host, places });
        true
    }

    fn put_back(&mut self, i: usize, run: &mut RunOf<'_, S>) {
        self.logs[i].tell::<S>(run);
        let (Progress { clock, first, counts, .. }, state) =
            (self.lanes.progress.get(i), self.states.get(i));
        (run.progress.clock, run.progress.first) = (clock, first);
        run.progress.counts.work = counts.work;
        state.put_into(&mut run.tally.state);
        if let Some(decay) = run.observer.measures.decay.as_mut().filter(|_| !self.logs[i].looks) {
            // The last stretches of the lane were not shown.
            decay.v_before = state.host.primary.v.value;
        }
    }

    fn idle(&mut self, i: usize) {
        let (phase, acceleration) = (self.structures.idle(i), DoubleDouble::ZERO);
        let host = HostState { primary: Primary::default(), acceleration, phase };
        self.lanes.set(i, &Lane { progress: Progress::idle(), request: false });
        self.masses.set(i, &[Mass { clearance: 1.0, laws: [Law::default(); 2] }; K]);
        self.states.set(i, &State { host, places: [InGap::UNUSED; K] });
        self.logs[i].looks = false;
    }
}
