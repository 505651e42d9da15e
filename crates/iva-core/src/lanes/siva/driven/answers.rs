//! Answers to the measures about flights under a harmonic force, for eight flights at a time.
//!
//! They are computed by the functions that answer for a single flight ([`crate::host`]), so they have the
//! same bits.

use super::lane::Single;
use super::log::{BLOCK, Flights};
use crate::arrays::arrays;
use crate::compensated::DoubleDouble;
use crate::flight::{Extreme, Quantity};
use crate::host::driven::Leading;
use crate::host::{Driven, DrivenHost, Structure};
use crate::lanes::{Job, pick};
use crate::measures::Wanted;
use crate::oscillator::Primary;
use crate::real::Real;
use crate::siva::Siva;
use crate::siva::motion::arrived;
use crate::steady::SteadyWanted;
use crate::taylor::{ORDER, unrolled};

/// The quantities that are asked of all flights of a run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asked {
    /// True if flights are to be logged at all.
    pub flights: bool,
    /// Energy lost and work.
    ledger: bool,
    /// The largest |x|.
    displacement: bool,
    /// The largest |ẍ + a_g|.
    acceleration: bool,
    /// ∫x².
    square: bool,
    /// Mass ratio μ.
    mass_ratio: f64,
    /// The instant from which extremes count.
    pub from: f64,
}

impl Asked {
    pub fn new(job: &Job<Siva<DrivenHost>>, wanted: Wanted) -> Self {
        let steady = job.steady.map_or_else(SteadyWanted::default, |(steady, _)| steady);
        let SteadyWanted { amplitude, rms, acceleration, regime, .. } = steady;
        let (ledger, displacement) = (wanted.ledger, amplitude || regime);
        // Impacts are logged with the flights that they end.
        let flights = ledger || steady != SteadyWanted::default();
        let mass_ratio = job.system.mass_ratio();
        let from = job.steady.map_or(0.0, |(_, window)| window.from);
        Self { flights, ledger, displacement, acceleration, square: rms, mass_ratio, from }
    }

    /// The quantities whose largest size is asked for.
    pub fn extremes(self) -> impl Iterator<Item = Quantity> {
        let displacement = self.displacement.then_some(Quantity::Displacement);
        displacement.into_iter().chain(self.acceleration.then_some(Quantity::Acceleration))
    }
}

arrays! {
    /// The largest size of a quantity in a flight ([`Extreme`]).
    Largest,
    /// [`Largest`] of several flights: every field an array over them.
    Largests:
    /// The fields of [`Extreme`]; `known` is 1 if the largest size is known, −1 if its extremum has to be
    /// found.
    limit, most, known,
}

arrays! {
    /// The answers about one flight.
    Answer,
    /// [`Answer`] of several flights: every field an array over them.
    Answers:
    /// Energy lost, work, and ∫x².
    lost, worked, square;
    displacement: Largest, Largests,
    acceleration: Largest, Largests
}

impl Answers<BLOCK> {
    /// The largest sizes of a quantity in all flights.
    pub fn largest(&mut self, of: Quantity) -> &mut Largests<BLOCK> {
        match of {
            Quantity::Displacement => &mut self.displacement,
            Quantity::Acceleration => &mut self.acceleration,
        }
    }

    /// The largest size of a quantity in a flight.
    pub fn extreme(&self, i: usize, of: Quantity) -> Extreme {
        let Largest { limit, most, known } = match of {
            Quantity::Displacement => self.displacement.get(i),
            Quantity::Acceleration => self.acceleration.get(i),
        };
        Extreme { limit, most, known: known > 0.0 }
    }
}

/// True if the extremum of a quantity in a flight has to be found.
pub(super) fn asks(known: f64) -> bool {
    known < 0.0
}

/// One power series for each flight of a block.
pub(super) type Series = [[f64; BLOCK]; ORDER + 1];

/// Runs a loop over flights with the widest vector instructions of the machine.
macro_rules! dispatched {
    ($work:expr) => {
        f64::dispatched(
            #[inline(always)]
            || $work,
        )
    };
}

/// The series of a block of flights.
#[derive(Debug)]
#[repr(align(64))]
pub(super) struct Block {
    /// Series of f/M, 0 where the base moves.
    pub pushed: Series,
    /// Series of x.
    pub place: Series,
    /// Series of ∬A, where the base moves.
    pub pulled: Series,
    /// Series of ∬a_g, where the base moves.
    pub carried: Series,
}

impl Block {
    pub fn new() -> Self {
        let [pushed, place, pulled, carried] = [[[0.0; BLOCK]; ORDER + 1]; 4];
        Self { pushed, place, pulled, carried }
    }

    /// Answers the questions, except for largest sizes whose extremum has to be found.
    pub fn ask<const BASE: bool>(
        &mut self,
        free: &Driven<Single<BASE>>,
        flights: &Flights<BLOCK>,
        asked: Asked,
        answers: &mut Answers<BLOCK>,
    ) {
        for of in asked.extremes() {
            *answers.largest(of) = match of {
                Quantity::Displacement => {
                    dispatched!(bounded(Quantity::Displacement, free, flights))
                }
                Quantity::Acceleration => {
                    dispatched!(bounded(Quantity::Acceleration, free, flights))
                }
            };
        }
        if asked.ledger || asked.square {
            dispatched!(self.take(free, flights));
        }
        if asked.ledger {
            [answers.lost, answers.worked] =
                dispatched!(self.lose(free, asked.mass_ratio, flights));
        }
        if asked.square {
            answers.square = dispatched!(self.square(free, flights));
        }
    }

    /// The largest sizes of a quantity, with its extremum found.
    pub fn turn<const BASE: bool>(
        &mut self,
        of: Quantity,
        free: &Driven<Single<BASE>>,
        flights: &Flights<BLOCK>,
    ) -> Largests<BLOCK> {
        dispatched!(self.take(free, flights));
        match of {
            Quantity::Displacement => {
                dispatched!(self.turned(Quantity::Displacement, free, flights))
            }
            Quantity::Acceleration => {
                dispatched!(self.turned(Quantity::Acceleration, free, flights))
            }
        }
    }

    /// Computes the series of the flights.
    #[inline(always)]
    fn take<const BASE: bool>(&mut self, free: &Driven<Single<BASE>>, flights: &Flights<BLOCK>) {
        // Passed by value, here and below, so that the compiler knows that the arrays do not overlap.
        let free = free.clone();
        let [mut pushed, mut place, mut pulled, mut carried] = [[[0.0; BLOCK]; ORDER + 1]; 4];
        for i in 0..BLOCK {
            let from = flights.get(i).host(&free);
            let course = free.course(&from);
            let x = free.place(&from, &course);
            unrolled!(k < ORDER + 1 => {
                place[k][i] = x[k];
                if BASE {
                    pulled[k][i] = course.pulled[k];
                    carried[k][i] = course.carried[k];
                } else {
                    pushed[k][i] = course.pushed[k];
                }
            });
        }
        self.place = place;
        if BASE {
            (self.pulled, self.carried) = (pulled, carried);
        } else {
            self.pushed = pushed;
        }
    }

    /// The largest sizes of a quantity from the series.
    #[inline(always)]
    fn turned<const BASE: bool>(
        &self,
        of: Quantity,
        free: &Driven<Single<BASE>>,
        flights: &Flights<BLOCK>,
    ) -> Largests<BLOCK> {
        let free = free.clone();
        let mut largest = Largests::new();
        for i in 0..BLOCK {
            let (begin, ends) = known_of(flights, i);
            let mut row = [0.0; ORDER + 1];
            unrolled!(k < ORDER + 1 => {
                row[k] = match of {
                    Quantity::Acceleration if BASE => self.pulled[k][i],
                    _ => self.place[k][i],
                };
            });
            if of == Quantity::Acceleration {
                row = free.derivative(&free.derivative(&row));
            }
            let extreme = free.extreme(of, [&ends[0], &ends[1]], &begin, &row, flights.length[i]);
            let Extreme { limit, most, known } = extreme;
            largest.set(i, &Largest { limit, most, known: if known { 1.0 } else { 0.0 } });
        }
        largest
    }
}

/// The structure at the begin of a flight, and displacement and acceleration with their derivatives at both
/// ends.
#[inline(always)]
fn known_of(flights: &Flights<BLOCK>, i: usize) -> (Primary, [Leading; 2]) {
    let (x, v) = (DoubleDouble::new(flights.x[i]), DoubleDouble::new(flights.v[i]));
    (Primary { x, v }, [flights.begin.get(i).leading(), flights.end.get(i).leading()])
}

/// The largest sizes of a quantity as far as the ends of the flights determine them.
#[inline(always)]
fn bounded<const BASE: bool>(
    of: Quantity,
    free: &Driven<Single<BASE>>,
    flights: &Flights<BLOCK>,
) -> Largests<BLOCK> {
    let free = free.clone();
    let mut largest = Largests::new();
    for i in 0..BLOCK {
        let (begin, ends) = known_of(flights, i);
        let arc = free.arc(of, [&ends[0], &ends[1]], &begin, flights.length[i]);
        let Extreme { limit, most, known } = Extreme::new(&arc, false, 0.0);
        let turns = pick(arc.turns_once(), -1.0, 0.0);
        largest.set(i, &Largest { limit, most, known: pick(known, 1.0, turns) });
    }
    largest
}

/// x, ẋ, y and w of flights a time h after their begin, from the clearance and the middle of the gap.
#[inline(always)]
fn placed<const BASE: bool>(
    free: &Driven<Single<BASE>>,
    [clearance, offset]: [f64; 2],
    flights: &Flights<BLOCK>,
    h: &[f64; BLOCK],
) -> [[f64; BLOCK]; 4] {
    let free = free.clone();
    let [mut x, mut v, mut y, mut w] = [[0.0; BLOCK]; 4];
    for i in 0..BLOCK {
        let from = flights.get(i).state(&free);
        let state = arrived(&free, &free.course(&from.host), &from, h[i]);
        let gap = state.gap(clearance);
        (x[i], v[i]) = (state.host.primary.x.value, state.host.primary.v.value);
        (y[i], w[i]) = (offset + gap.y, gap.w);
    }
    [x, v, y, w]
}

/// [`placed`] with the widest vector instructions of the machine.
pub(super) fn places<const BASE: bool>(
    free: &Driven<Single<BASE>>,
    gap: [f64; 2],
    flights: &Flights<BLOCK>,
    h: &[f64; BLOCK],
) -> [[f64; BLOCK]; 4] {
    dispatched!(placed(free, gap, flights, h))
}
