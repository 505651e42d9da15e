//! The measures of a free mass under one harmonic force in plain doubles, computed from its log.
//!
//! A run logs its flights, each with the states of structure and absorber at both ends and the impact that ends
//! it, and the events between them that are no flights. When the log is full or the run has ended, measures
//! take many flights at a time: losses, work and ∫x² by Gauss's quadrature ([`integrals`]), largest sizes by
//! bounds first ([`extremes`]), strobes and impacts in order of time. A motion with the absorber stuck to its
//! wall is measured by itself, after the flights before it.
//!
//! A flight that crosses the begin of the window of the steady state is logged as two.

use crate::absorber::impact::Impact;
use crate::absorber::plain::responses::Responses;
use crate::absorber::plain::{BASE, FORCE, Scene, State, Structure};
use crate::absorber::{Clock, Point, Wall};
use crate::host::oscillator::Equation;
use crate::measures::Wanted;
use crate::measures::steady::{Steady, SteadyWanted, Strobed};
use crate::number::arrays::Lanes as _;
use crate::number::clock::SLACK;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::number::vectors::in_vectors;
use crate::segment::flight::{GapPoint, Quantity};

mod courses;
mod extremes;
mod flights;
mod integrals;

use flights::{BLOCK, Block, Event, Flight, Flights, Part};
use integrals::Integrals;

/// Number of flights in a full log: 160 kB.
const FULL: usize = 1024;

/// The log of a run and its measures; the memory serves one run after the other.
#[derive(Debug)]
pub(crate) struct Forced {
    blocks: Vec<Block>,
    /// Number of flights logged.
    count: usize,
    /// Number of flights before the window of the steady state.
    before: usize,
    /// The events, each with the number of flights before it.
    events: Vec<(usize, Event)>,
    scene: Scene,
    pub structure: Structure,
    pub responses: Responses,
    wanted: Wanted,
    steady: SteadyWanted,
    /// The begin of the window.
    from: f64,
}

impl Forced {
    /// A log for a run of a scene, in the memory of another one; `None` where the force is too fast for the
    /// polynomials of a flight.
    pub fn new(
        scene: &Scene,
        spare: Option<Box<Self>>,
        (wanted, steady): (Wanted, SteadyWanted),
        from: f64,
    ) -> Option<Box<Self>> {
        let equation = Equation::new(1.0, scene.damping_ratio);
        let frequency = scene.harmonic.frequency;
        let same = |it: &Responses| it.damping == equation.damping && it.frequency == frequency;
        let responses = spare.as_ref().map(|spare| spare.responses).filter(same);
        let responses = responses
            .unwrap_or_else(|| Responses::new(equation.damping, equation.growth, frequency));
        let structure = Structure::driven(&equation, &responses, &scene.harmonic);
        let finite = responses.terms.iter().flatten().all(|term| term.is_finite());
        if !(finite && structure.excess_6.is_finite()) {
            return None;
        }
        let (blocks, mut events) =
            spare.map_or_else(Default::default, |spare| (spare.blocks, spare.events));
        events.clear();
        let (count, before, scene) = (0, 0, *scene);
        Some(Box::new(Self {
            blocks,
            count,
            before,
            events,
            scene,
            structure,
            responses,
            wanted,
            steady,
            from,
        }))
    }

    /// True if a measure needs the flights.
    #[inline(always)]
    pub fn is_wanted(&self) -> bool {
        self.wanted.ledger || self.steady.any()
    }

    /// True if measures are to take the log, so that a long run needs no more memory.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        self.count + self.events.len() >= FULL
    }

    /// Logs a flight between two states, with the instant and approach speed of the impact at its end; 0: there
    /// is none. The forces of the states are computed when the log is taken.
    #[inline(always)]
    pub fn push(
        &mut self,
        clock: Clock,
        length: f64,
        [impact_time, approach]: [f64; 2],
        [begin, end]: [&State; 2],
    ) {
        let State { x, v, distance, rate, side, .. } = *begin;
        let flight = Flight {
            time: clock.value,
            time_rest: clock.rest,
            length,
            x,
            v,
            distance,
            rate,
            side,
            end_x: end.x,
            end_v: end.v,
            impact_time,
            approach,
            wall: end.side,
        };
        let until = -clock.minus(self.from);
        if until > 0.0 {
            if until < length {
                return self.divide(&flight, until);
            }
            self.store(&flight);
            self.before = self.count;
            if approach > 0.0 && impact_time >= self.from {
                // At the very begin of the window, which no flight before it is in.
                self.event(Event::Impact(impact_time, wall_of(end.side), approach));
            }
            return;
        }
        self.store(&flight);
    }

    #[inline(always)]
    fn store(&mut self, flight: &Flight) {
        let (block, slot) = (self.count / BLOCK, self.count % BLOCK);
        if block == self.blocks.len() {
            self.blocks.push(Block::new());
        }
        self.blocks[block].flights.set(slot, flight);
        self.count += 1;
    }

    /// Logs a flight as two, of which the first has this length.
    #[inline(never)]
    fn divide(&mut self, flight: &Flight, first: f64) {
        let there = {
            let force = self.structure.force_at(flight.clock());
            self.later(&flight.begin(force), first)
        };
        let State { x, v, distance, rate, side, .. } = there;
        self.store(&Flight { length: first, end_x: x, end_v: v, approach: 0.0, ..*flight });
        self.before = self.count;
        let clock = flight.clock().plus(first);
        let (time, time_rest, length) = (clock.value, clock.rest, flight.length - first);
        self.store(&Flight { time, time_rest, length, x, v, distance, rate, side, ..*flight });
    }

    /// The state a time h after another.
    #[inline(always)]
    fn later(&self, state: &State, h: f64) -> State {
        if self.scene.moves_base {
            state.after::<BASE>(&self.structure, &self.responses, h)
        } else {
            state.after::<FORCE>(&self.structure, &self.responses, h)
        }
    }

    /// Logs an impact that no flight contains.
    pub fn impact<R: Real>(&mut self, impact: &Impact<R>) {
        let [time, approach] = [impact.time, impact.approach_speed()].map(R::double);
        let event = Event::Impact(time, impact.wall, approach);
        self.event(event);
    }

    /// Logs that impacts up to this approach speed are not listed.
    pub fn unlist(&mut self, floor: f64) {
        self.event(Event::Unlist(floor));
    }

    /// Logs an event, if a measure counts impacts.
    fn event(&mut self, event: Event) {
        if self.steady.any() {
            self.events.push((self.count, event));
        }
    }

    /// Takes the log for the measures, and clears it; returns the energy lost and the work.
    pub fn take<R: Real>(&mut self, steady: Option<&mut Steady<R>>) -> [DoubleDouble; 2] {
        let taken = if self.scene.moves_base {
            in_vectors(
                #[inline(always)]
                || self.measure::<R, BASE>(steady),
            )
        } else {
            in_vectors(
                #[inline(always)]
                || self.measure::<R, FORCE>(steady),
            )
        };
        (self.count, self.before) = (0, 0);
        self.events.clear();
        taken
    }

    #[inline(always)]
    fn measure<R: Real, const DRIVE: u8>(
        &mut self,
        steady: Option<&mut Steady<R>>,
    ) -> [DoubleDouble; 2] {
        let structure = self.structure;
        for block in &mut self.blocks[..self.count.div_ceil(BLOCK)] {
            block.put_forces(&structure);
        }
        let Integrals { lost, worked, square } = self.integrate::<DRIVE>();
        if let Some(steady) = steady {
            steady.add_square(square);
            let [mut displacement, mut acceleration] = steady.largest().map(R::double);
            if self.steady.amplitude || self.steady.regime {
                displacement = self.largest::<DRIVE>(Quantity::Displacement, displacement);
            }
            if self.steady.acceleration {
                acceleration = self.largest::<DRIVE>(Quantity::Acceleration, acceleration);
            }
            steady.set_largest([displacement, acceleration].map(R::from));
            self.show::<R, DRIVE>(steady);
        }
        [lost, worked]
    }

    /// Hands out strobes and impacts in order of time.
    #[inline(always)]
    fn show<R: Real, const DRIVE: u8>(&self, steady: &mut Steady<R>) {
        let mut events = self.events.iter().peekable();
        let mut strobe = steady.next_strobe().map(|it| it.value.double());
        for i in self.before..self.count {
            while let Some((_, event)) = events.next_if(|(before, _)| *before <= i) {
                event.show(steady);
            }
            let (block, slot) = (&self.blocks[i / BLOCK], i % BLOCK);
            let Flights { time, length, impact_time, approach, wall, .. } = &block.flights;
            let end = time[slot] + length[slot];
            let due = |strobe: f64| strobe <= end * (1.0 + 4.0 * SLACK);
            if self.steady.strobes || strobe.is_some_and(due) {
                let clock = block.flights.get(slot).clock();
                let clock = Clock { value: clock.value.into(), rest: clock.rest.into() };
                let mut motion = Strobing::<'_, DRIVE> { log: self, from: block.begin(slot) };
                steady.take_strobes(clock, [0.0, length[slot]].map(R::from), &mut motion);
                strobe = steady.next_strobe().map(|it| it.value.double());
            }
            let approach = approach[slot];
            if approach > 0.0 {
                let wall = (0, wall_of(wall[slot]));
                steady.count(impact_time[slot].into(), wall, approach.into());
            }
        }
        events.for_each(|(_, event)| event.show(steady));
    }
}

/// A flight from a state, at which strobes are taken.
struct Strobing<'a, const DRIVE: u8> {
    log: &'a Forced,
    from: State,
}

impl<const DRIVE: u8> Strobing<'_, DRIVE> {
    /// The state a time h after the begin of the flight.
    #[inline(always)]
    fn at(&self, h: f64) -> State {
        let Self { log: Forced { structure, responses, .. }, from } = self;
        if h == 0.0 { *from } else { from.after::<DRIVE>(structure, responses, h) }
    }
}

impl<R: Real, const DRIVE: u8> Strobed<R> for Strobing<'_, DRIVE> {
    #[inline(always)]
    fn place(&mut self, h: R) -> (Point<R>, GapPoint<R>) {
        let there = self.at(h.double());
        let State { x, v, distance, rate, side, .. } = there;
        let Scene { offset, clearance, .. } = self.log.scene;
        let y = offset + side * (clearance - distance);
        let primary = Point { x: R::from(x), v: R::from(v) };
        (primary, GapPoint { y: R::from(y), w: R::from(-side * rate) })
    }

    #[inline(always)]
    fn largest(&mut self, [from, to]: [R; 2], least: R) -> R {
        let [from, to, least] = [from, to, least].map(R::double);
        let largest = {
            let part = Part { begin: self.at(from), end: self.at(to), length: to - from };
            self.log.largest_in::<DRIVE>(Quantity::Displacement, &part, least)
        };
        largest.into()
    }
}

/// The wall of this sign.
fn wall_of(side: f64) -> Wall {
    if side > 0.0 { Wall::Plus } else { Wall::Minus }
}
