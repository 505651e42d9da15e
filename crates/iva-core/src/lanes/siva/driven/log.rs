//! The log of a driven run: its flights, its stick episodes, and the impacts that the event loop has applied.

use super::lane::Single;
use crate::arrays::arrays;
use crate::compensated::DoubleDouble;
use crate::host::driven::Leading;
use crate::host::{Driven, HostState, Moment, Source};
use crate::impact::Impact;
use crate::oscillator::Primary;
use crate::siva::SivaState;
use crate::system::Clock;

/// Number of flights in a block.
pub(super) const BLOCK: usize = 8;

arrays! {
    /// Displacement and absolute acceleration at one end of a flight, with their derivatives.
    End,
    /// [`End`] of several flights: every field an array over them.
    Ends:
    x, v, x_second, x_third, a, a_rate, a_second, a_third,
}

arrays! {
    /// A flight.
    Flight,
    /// [`Flight`] of several: every field an array over them.
    Flights:
    /// The state at its begin in double-double, and the instant of its drive.
    x, x_rest, v, v_rest, a, a_rest, distance, distance_rest, rate, rate_rest, side,
    instant, instant_rest,
    /// The clock at its begin, and its length; 0: there is no flight.
    time, time_rest, length,
    /// The impact at its end: its time, the sign of the wall, and its approach speed; 0: none.
    impact_time, impact_wall, approach;
    /// Displacement and acceleration at both ends, from which extremes are found; the derivatives only if
    /// they are wanted.
    begin: End, Ends,
    end: End, Ends
}

impl End {
    /// The end of a flight at a state of the structure, with derivatives only if extremes are wanted.
    #[inline(always)]
    pub fn new(
        free: &Driven<impl Source<Real = f64>>,
        at: &HostState<Moment>,
        derivatives: bool,
    ) -> Self {
        if !derivatives {
            let Primary { x, v } = &at.primary;
            return Self { x: x.value, v: v.value, ..Self::default() };
        }
        let Leading { displacement, acceleration } = free.leading_of(at);
        let [x, v, x_second, x_third] = displacement;
        let [a, a_rate, a_second, a_third] = acceleration;
        Self { x, v, x_second, x_third, a, a_rate, a_second, a_third }
    }

    /// Displacement and acceleration with their derivatives.
    #[inline(always)]
    pub fn leading(&self) -> Leading {
        Leading {
            displacement: [self.x, self.v, self.x_second, self.x_third],
            acceleration: [self.a, self.a_rate, self.a_second, self.a_third],
        }
    }
}

/// Number of flights and events in a full log: some hundred cycles of a force, and a megabyte.
const FULL: usize = 4096;

/// An event of the log that is not a flight.
#[derive(Debug, Clone)]
pub(super) enum Event {
    /// A stretch of a stick episode.
    Ride(Box<Ride>),
    /// An impact that no logged flight contains.
    Impact(Impact),
    /// Impacts up to this approach speed turned out to belong to a chatter that ended in stick, and are not
    /// listed.
    Unlist(f64),
}

/// A motion with the absorber stuck on its wall.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ride {
    pub from: SivaState<Moment>,
    pub start: Clock,
    pub length: f64,
    pub end: SivaState<Moment>,
}

/// The flights of a run in blocks, and the events between them.
#[derive(Debug, Default)]
pub(super) struct Log {
    pub blocks: Vec<Flights<BLOCK>>,
    /// Number of flights logged.
    pub length: usize,
    /// The events, each with the number of flights before it.
    pub events: Vec<(usize, Event)>,
}

impl Log {
    /// Logs a flight.
    #[inline(always)]
    pub fn push(&mut self, flight: &Flight) {
        let (block, slot) = (self.length / BLOCK, self.length % BLOCK);
        if block == self.blocks.len() {
            self.blocks.push(Flights::new());
        }
        self.blocks[block].set(slot, flight);
        self.length += 1;
    }

    /// A flight of the log.
    pub fn flight(&self, i: usize) -> Flight {
        self.blocks[i / BLOCK].get(i % BLOCK)
    }

    /// The clock at the begin of a flight.
    pub fn start(&self, i: usize) -> Clock {
        let block = &self.blocks[i / BLOCK];
        sum(block.time[i % BLOCK], block.time_rest[i % BLOCK])
    }

    /// An instant just after the end of a flight, later by its rounding.
    pub fn end(&self, i: usize) -> f64 {
        let block = &self.blocks[i / BLOCK];
        (block.time[i % BLOCK] + block.length[i % BLOCK]) * (1.0 + 2.0 * f64::EPSILON)
    }

    /// The length of a flight.
    pub fn span(&self, i: usize) -> f64 {
        self.blocks[i / BLOCK].length[i % BLOCK]
    }

    /// True if the log is to be measured and cleared, so that long runs need no more memory.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        self.length + self.events.len() >= FULL
    }

    /// Logs an event that is not a flight.
    pub fn event(&mut self, event: Event) {
        self.events.push((self.length, event));
    }

    /// Removes all entries, but keeps the memory.
    pub fn clear(&mut self) {
        self.length = 0;
        self.events.clear();
    }
}

impl Flight {
    /// A flight between two states that ends without an impact, or with one that is logged as an event.
    #[inline(always)]
    pub fn new(
        from: &SivaState<Moment>,
        start: Clock,
        length: f64,
        [begin, end]: [End; 2],
    ) -> Self {
        let HostState { primary: Primary { x, v }, acceleration: a, phase } = &from.host;
        Self {
            x: x.value,
            x_rest: x.rest,
            v: v.value,
            v_rest: v.rest,
            a: a.value,
            a_rest: a.rest,
            distance: from.distance.value,
            distance_rest: from.distance.rest,
            rate: from.rate.value,
            rate_rest: from.rate.rest,
            side: from.side,
            instant: phase.time.value,
            instant_rest: phase.time.rest,
            time: start.value,
            time_rest: start.rest,
            length,
            begin,
            end,
            ..Self::default()
        }
    }

    /// The state of the structure at its begin.
    #[inline(always)]
    pub fn host<const BASE: bool>(&self, free: &Driven<Single<BASE>>) -> HostState<Moment> {
        let time = sum(self.instant, self.instant_rest);
        let primary = Primary { x: sum(self.x, self.x_rest), v: sum(self.v, self.v_rest) };
        let phase = Moment { time, kicks: 0, pushes: free.source.pushes(time, time) };
        HostState { primary, acceleration: sum(self.a, self.a_rest), phase }
    }

    /// The state at its begin.
    #[inline(always)]
    pub fn state<const BASE: bool>(&self, free: &Driven<Single<BASE>>) -> SivaState<Moment> {
        SivaState {
            host: self.host(free),
            side: self.side,
            distance: sum(self.distance, self.distance_rest),
            rate: sum(self.rate, self.rate_rest),
        }
    }
}

#[inline(always)]
fn sum(value: f64, rest: f64) -> DoubleDouble {
    DoubleDouble { value, rest }
}
