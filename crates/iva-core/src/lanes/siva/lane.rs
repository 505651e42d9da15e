//! One lane: a free decay reduced to the numbers that fast flights change, and arrays of such lanes.

use super::flying::{Flying, Flyings};
use crate::lanes::ScalarRun;
use crate::lanes::arrays::arrays;
use crate::lanes::decay::{Decay, Decays};
use crate::siva::Siva;

arrays! {
    /// The numbers of one run.
    Lane,
    /// Lanes side by side: of every number an array.
    Lanes:
    ;
    /// The flight.
    flying: Flying, Flyings,
    /// Measures.
    decay: Decay, Decays
}

impl Lane {
    /// A lane without a run.
    pub fn idle() -> Self {
        Lane { flying: Flying::idle(), decay: Decay::idle() }
    }

    /// A run that has come to where fast flights can go on; `None` if it has not.
    pub fn of(run: &ScalarRun<'_, Siva>, reach: f64) -> Option<Self> {
        Some(Lane { flying: Flying::of(run, reach)?, decay: Decay::of(&run.observer.0) })
    }

    /// Puts the numbers back into the run.
    pub fn put_back(&self, run: &mut ScalarRun<'_, Siva>) {
        self.flying.put_back(run, ());
        self.decay.put_back(&mut run.observer.0, &run.system.host, &run.tally.state);
    }
}
