//! The log of a run in free decay: the motions of its structure, from which measures are computed.
//!
//! Between two entries the structure moves without drive, alone while the absorber flies and as one mass 1 + μ
//! while it sticks; of several with the mass of those that stick. So an entry holds where a motion begins, and its end is the begin of the next. The whole
//! motion can be made again from that ([`crate::host::sinusoid`]).

use crate::absorber::{Aboard, Clock};
use crate::host::sinusoid::Motion;
use crate::number::compensated::DoubleDouble;

/// The begin of a motion of the structure.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Entry {
    /// The instant, in 1/ωn, in double-double.
    pub time: f64,
    pub time_rest: f64,
    /// x and ẋ.
    pub x: f64,
    pub v: f64,
    /// ẋ at the end of the motion before: just before an impact.
    pub v_before: f64,
    /// Absolute velocity of the absorber in flight, and its distance from wall − ([`Aboard`]).
    pub absorber: f64,
    pub height: f64,
    /// The mass ratio of what is stuck to the structure.
    pub carried: f64,
}

impl Entry {
    /// The begin of a motion with this velocity of the structure just before, and these absorbers.
    #[inline(always)]
    pub fn new(
        clock: Clock,
        [x, v]: Motion,
        v_before: f64,
        Aboard { carried, velocity: absorber, height }: Aboard,
    ) -> Self {
        let (time, time_rest) = (clock.value, clock.rest);
        Self { time, time_rest, x, v, v_before, absorber, height, carried }
    }

    /// The instant at which the motion begins.
    #[inline(always)]
    pub fn clock(&self) -> Clock {
        DoubleDouble { value: self.time, rest: self.time_rest }
    }

    /// x from the middle of its motion, and ẋ.
    #[inline(always)]
    pub fn from(&self, middle: f64) -> Motion {
        [self.x - middle, self.v]
    }

    /// x from the middle of the motion before, and ẋ at the end of that motion.
    #[inline(always)]
    pub fn reached(&self, middle: f64) -> Motion {
        [self.x - middle, self.v_before]
    }
}

/// The motions of a run in order of time, as far as no measure has taken them.
#[derive(Debug, Clone)]
pub(crate) struct Log {
    entries: Vec<Entry>,
    /// Number of entries of a full log.
    full: usize,
}

/// Number of entries after which measures take them, so that a long run needs no more memory: 260 kB.
const FULL: usize = 4096;

impl Default for Log {
    fn default() -> Self {
        Self { entries: Vec::new(), full: FULL }
    }
}

impl Log {
    /// Removes all entries and keeps their memory.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.full = FULL;
    }

    /// Removes all entries but the last, with which the motion begins that measures have not taken.
    pub fn restart(&mut self) {
        let last = self.entries.pop();
        self.clear();
        self.entries.extend(last);
    }

    /// Lets the log grow, where measures cannot take its entries yet.
    pub fn grow(&mut self) {
        self.full = self.entries.len() * 2;
    }

    /// The entries.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// True if measures are to take the entries.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        self.entries.len() >= self.full
    }

    /// Logs the begin of a motion.
    #[inline(always)]
    pub fn push(&mut self, entry: Entry) {
        self.entries.push(entry);
    }
}
