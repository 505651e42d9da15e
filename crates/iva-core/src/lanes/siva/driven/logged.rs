//! A flight of a log as a motion: answers computed side by side are stored, all others are computed on
//! demand.

use std::cell::OnceCell;

use super::answers::Answers;
use super::lane::Single;
use super::log::{BLOCK, Flights};
use crate::flight::{GapPoint, Jet, Losses, Motion, Quantity, Rows};
use crate::host::{Driven, DrivenHost, Moment};
use crate::siva::{Siva, SivaFlight, SivaState};
use crate::system::{Point, System, Wall};

/// Structure and absorber at one instant of a flight.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// The index of the flight in the log.
    pub index: usize,
    /// The time after the begin of the flight.
    pub h: f64,
    pub primary: Point,
    pub gap: GapPoint,
}

/// A flight of a log with its answers.
#[derive(Debug)]
pub(super) struct Logged<'a, const BASE: bool> {
    pub siva: &'a Siva<DrivenHost>,
    pub free: &'a Driven<Single<BASE>>,
    pub flights: &'a Flights<BLOCK>,
    pub answers: &'a Answers<BLOCK>,
    /// The position of the flight in its block.
    pub slot: usize,
    /// The states at some instants of the flight.
    pub places: &'a [Place],
    pub flight: OnceCell<SivaFlight<'a, DrivenHost>>,
}

impl<'a, const BASE: bool> Logged<'a, BASE> {
    fn flight(&self) -> &SivaFlight<'a, DrivenHost> {
        self.flight.get_or_init(|| self.siva.flight(&self.flights.get(self.slot).state(self.free)))
    }
}

impl<const BASE: bool> Motion for Logged<'_, BASE> {
    type Real = f64;
    type State = SivaState<Moment>;
    const RIDING: bool = false;

    fn origin(&self) -> &Self::State {
        self.flight().origin()
    }

    fn reach(&self) -> f64 {
        self.flight().reach()
    }

    fn state(&self, h: f64) -> Self::State {
        self.flight().state(h)
    }

    fn primary(&self, h: f64) -> Jet {
        self.flight().primary(h)
    }

    fn gap(&self, h: f64) -> GapPoint {
        self.flight().gap(h)
    }

    fn place(&self, h: f64) -> (Point, GapPoint) {
        match self.places.iter().find(|place| place.h == h) {
            Some(Place { primary, gap, .. }) => (*primary, *gap),
            None => self.flight().place(h),
        }
    }

    fn wall(&self) -> Option<Wall> {
        None
    }

    fn losses(&self, _h: f64) -> Losses {
        let (viscous, work) = (self.answers.lost[self.slot], self.answers.worked[self.slot]);
        Losses { viscous, pivot: 0.0, work }
    }

    fn square(&self, h: [f64; 2]) -> f64 {
        if h == [0.0, self.flights.length[self.slot]] {
            self.answers.square[self.slot]
        } else {
            self.flight().square(h)
        }
    }

    fn largest(&self, of: Quantity, least: f64, _length: f64, _end: &Self::State) -> Option<f64> {
        self.answers.extreme(self.slot, of).largest(least)
    }

    fn rows(&self) -> Option<Rows> {
        self.flight().rows()
    }
}
