//! Logs a driven run, and takes its measures when the log is full or the run has ended.

use std::cell::OnceCell;

use super::answers::{self, Answers, Asked, Block, asks};
use super::lane::Single;
use super::log::{BLOCK, End, Event, Flight, Flights, Log, Ride};
use super::logged::{Logged, Place};
use crate::compensated::DoubleDouble;
use crate::flight::{GapPoint, Motion};
use crate::force::Force;
use crate::force::Pushes;
use crate::host::{Driven, DrivenHost, Host, HostState, Moment};
use crate::impact::Impact;
use crate::lanes::{Job, Observers, Watching};
use crate::measures::{MeasureValues, Wanted};
use crate::observe::{Contact, Observer, Span};
use crate::oscillator::Primary;
use crate::simulate::{Instant, Tally};
use crate::siva::{Siva, SivaState};
use crate::steady::SteadyValues;
use crate::system::{Point, System, Wall};

type DrivenSiva = Siva<DrivenHost>;

/// An observer that logs a run and hands the log to the observers that measure it.
#[derive(Debug)]
pub(in crate::lanes) struct Recorder<const BASE: bool> {
    pub(super) log: Log,
    observers: Observers<DrivenSiva>,
    asked: Asked,
    memory: Box<Memory>,
}

/// Working memory for the evaluation of a log.
#[derive(Debug)]
struct Memory {
    block: Block,
    answers: Vec<Answers<BLOCK>>,
    places: Vec<Place>,
    /// Flights from any place of the log that are evaluated together.
    gathered: Flights<BLOCK>,
}

impl Memory {
    fn new() -> Self {
        let (answers, places) = (Vec::new(), Vec::new());
        Self { block: Block::new(), answers, places, gathered: Flights::new() }
    }
}

impl<const BASE: bool> Watching<DrivenSiva> for Recorder<BASE> {
    fn new(job: &Job<DrivenSiva>, wanted: Wanted, spare: Option<Self>) -> Self {
        let (log, memory) = match spare {
            Some(Self { log, memory, .. }) => (log, memory),
            None => (Log::default(), Box::new(Memory::new())),
        };
        let observers = Observers::new(job, wanted, None);
        Self { log, observers, asked: Asked::new(job, wanted), memory }
    }

    fn values(&self) -> (MeasureValues, Option<SteadyValues>) {
        self.observers.values()
    }
}

impl<const BASE: bool> Recorder<BASE> {
    /// Hands the log to the observers, and clears it.
    fn replay(&mut self, siva: &DrivenSiva) {
        let Some(free) = structure::<BASE>(siva) else { return };
        self.ask(&free);
        self.strobe(siva, &free);
        let Self { log, observers, memory, .. } = self;
        let Memory { answers, places, .. } = &**memory;
        let mut events = &log.events[..];
        let mut places = &places[..];
        for index in 0..log.length {
            while let Some(((_, event), later)) =
                events.split_first().filter(|((before, _), _)| *before <= index)
            {
                show(observers, siva, event);
                events = later;
            }
            let count = places.iter().take_while(|place| place.index <= index).count();
            let here;
            (here, places) = places.split_at(count);
            let (block, slot) = (index / BLOCK, index % BLOCK);
            show_flight(
                observers,
                &Logged {
                    siva,
                    free: &free,
                    flights: &log.blocks[block],
                    answers: &answers[block],
                    slot,
                    places: here,
                    flight: OnceCell::new(),
                },
            );
        }
        for (_, event) in events {
            show(observers, siva, event);
        }
        log.clear();
    }

    /// Computes the answers about all flights.
    fn ask(&mut self, free: &Driven<Single<BASE>>) {
        let Self { log, asked, memory, .. } = self;
        let Memory { block, answers, gathered, .. } = &mut **memory;
        let blocks = log.length.div_ceil(BLOCK);
        answers.resize_with(answers.len().max(blocks), Answers::new);
        for (flights, answers) in log.blocks[..blocks].iter().zip(answers.iter_mut()) {
            block.ask(free, flights, *asked, answers);
        }
        for of in asked.extremes() {
            let counted = (0..log.length).filter(|i| log.start(*i).value >= asked.from);
            let mut least = counted.fold(0.0, |least: f64, i| {
                least.max(answers[i / BLOCK].largest(of).most[i % BLOCK])
            });
            let mut i = 0;
            while i < log.length {
                // The next flights whose largest size may exceed the largest one known; others need no exact
                // value.
                let mut chosen = [0; BLOCK];
                let mut count = 0;
                while i < log.length && count < BLOCK {
                    let (largest, slot) = (answers[i / BLOCK].largest(of), i % BLOCK);
                    if asks(largest.known[slot]) {
                        if largest.limit[slot] < least {
                            largest.known[slot] = 1.0;
                        } else {
                            (chosen[count], count) = (i, count + 1);
                        }
                    }
                    i += 1;
                }
                if count == 0 {
                    break;
                }
                let chosen = &chosen[..count];
                for (slot, i) in chosen.iter().enumerate() {
                    gathered.set(slot, &log.flight(*i));
                }
                let turned = block.turn(of, free, gathered);
                for (slot, i) in chosen.iter().enumerate() {
                    let turned = turned.get(slot);
                    answers[i / BLOCK].largest(of).set(i % BLOCK, &turned);
                    if turned.known > 0.0 && log.start(*i).value >= asked.from {
                        least = least.max(turned.most);
                    }
                }
            }
        }
    }

    /// Computes the states at the strobes that are kept.
    fn strobe(&mut self, siva: &DrivenSiva, free: &Driven<Single<BASE>>) {
        let Self { log, observers, memory, .. } = self;
        let Memory { places, gathered, .. } = &mut **memory;
        places.clear();
        let Some(steady) = &observers.1 else { return };
        let mut index = 0;
        let at_rest = (Point { x: 0.0, v: 0.0 }, GapPoint { y: 0.0, w: 0.0 });
        for instant in steady.kept_strobes() {
            let within = |i: usize| (instant - log.start(i)).value;
            // Clearly before the strobe by rounded numbers, or else by exact ones.
            let before = |i: usize| {
                log.end(i) < instant.value * (1.0 - f64::EPSILON) || within(i) >= log.span(i)
            };
            while index < log.length && before(index) {
                index += 1;
            }
            if index == log.length {
                break;
            }
            let (h, (primary, gap)) = (within(index).clamp(0.0, log.span(index)), at_rest);
            places.push(Place { index, h, primary, gap });
        }
        for chunk in places.chunks_mut(BLOCK) {
            let mut h = [0.0; BLOCK];
            for (slot, place) in chunk.iter().enumerate() {
                gathered.set(slot, &log.flight(place.index));
                h[slot] = place.h;
            }
            let gap = [siva.clearance(), siva.offset()];
            let [x, v, y, w] = answers::places(free, gap, gathered, &h);
            for (slot, place) in chunk.iter_mut().enumerate() {
                place.primary = Point { x: x[slot], v: v[slot] };
                place.gap = GapPoint { y: y[slot], w: w[slot] };
            }
        }
    }
}

/// The structure under its one harmonic force.
fn structure<const BASE: bool>(siva: &DrivenSiva) -> Option<Driven<Single<BASE>>> {
    let harmonic = siva.force().map(Force::harmonics)?.first()?;
    let Driven { equation, base, reach, step, excess, .. } = siva.host.free();
    let (equation, source) = (*equation, Single(*harmonic));
    Some(Driven { equation, source, base: *base, reach: *reach, step: *step, excess: *excess })
}

/// Hands a flight to the observers, with the impact at its end.
fn show_flight<const BASE: bool>(observers: &mut Observers<DrivenSiva>, motion: &Logged<'_, BASE>) {
    let Logged { siva, flights, slot, .. } = motion;
    let i = *slot;
    let (from, to) = (
        Point { x: flights.x[i], v: flights.v[i] },
        Point { x: flights.end.x[i], v: flights.end.v[i] },
    );
    // Of the state at the end of a flight, measures use the structure only.
    let zero = DoubleDouble::ZERO;
    let primary = Primary { x: DoubleDouble::new(to.x), v: DoubleDouble::new(to.v) };
    let phase = Moment { time: zero, kicks: 0, pushes: Pushes::NONE };
    let host = HostState { primary, acceleration: zero, phase };
    let end = SivaState { host, side: flights.side[i], distance: zero, rate: zero };
    let start = DoubleDouble { value: flights.time[i], rest: flights.time_rest[i] };
    observers.span(siva, &Span { motion, start, length: flights.length[i], from, to, end: &end });
    if let (Some(steady), true) = (&mut observers.1, flights.approach[i] > 0.0) {
        let wall = if flights.impact_wall[i] > 0.0 { Wall::Plus } else { Wall::Minus };
        steady.count(flights.impact_time[i], wall, flights.approach[i]);
    }
}

/// Hands an event to the observers.
fn show(observers: &mut Observers<DrivenSiva>, siva: &DrivenSiva, event: &Event) {
    match event {
        Event::Ride(ride) => {
            let Ride { from, start, length, end } = **ride;
            let motion = siva.ride(&from);
            let [from, to] = [&from, &end].map(|state| siva.primary(state));
            observers.span(siva, &Span { motion: &motion, start, length, from, to, end: &end });
        }
        Event::Impact(impact) => observers.impact(siva, impact),
        // The observers know from the impacts before which of them are meant.
        Event::Unlist(floor) => Observer::<DrivenSiva>::unlist(observers, 0, *floor),
    }
}

impl<const BASE: bool> Observer<DrivenSiva> for Recorder<BASE> {
    fn start(&mut self, siva: &DrivenSiva, from: &Instant<SivaState<Moment>>, duration: f64) {
        self.log.clear();
        self.observers.start(siva, from, duration);
    }

    fn span<M: Motion<Real = f64, State = SivaState<Moment>>>(
        &mut self,
        siva: &DrivenSiva,
        span: &Span<'_, M>,
    ) {
        if !self.asked.flights {
            return;
        }
        if self.log.is_full() {
            self.replay(siva);
        }
        let (from, Span { start, length, end, .. }) = (span.motion.origin(), span);
        if M::RIDING {
            let ride = Ride { from: *from, start: *start, length: *length, end: **end };
            self.log.event(Event::Ride(Box::new(ride)));
        } else {
            let (free, extremes) = (siva.host.free(), self.asked.extremes().next().is_some());
            let ends = [from, *end].map(|state| End::new(free, &state.host, extremes));
            self.log.push(&Flight::new(from, *start, *length, ends));
        }
    }

    fn contact(&mut self, siva: &DrivenSiva, contact: &Contact<'_, SivaState<Moment>>) {
        self.observers.contact(siva, contact);
    }

    fn impact(&mut self, _siva: &DrivenSiva, impact: &Impact) {
        if self.asked.flights {
            self.log.event(Event::Impact(*impact));
        }
    }

    fn impulse(&mut self, siva: &DrivenSiva, state: &SivaState<Moment>, work: f64) {
        self.observers.impulse(siva, state, work);
    }

    fn unlist(&mut self, _first: u64, floor: f64) {
        if self.asked.flights {
            self.log.event(Event::Unlist(floor));
        }
    }

    fn end(&mut self, siva: &DrivenSiva, tally: &Tally<SivaState<Moment>>) {
        self.replay(siva);
        self.observers.end(siva, tally);
    }
}
