//! One lane: the variables of a free decay that fast flights change, and arrays of such lanes.

use super::flying::{Flying, Flyings};
use crate::lanes::ScalarRun;
use crate::lanes::arrays::arrays;
use crate::lanes::decay::{Decay, Decays};
use crate::siva::Siva;

arrays! {
    /// The variables of one run.
    Lane,
    /// [`Lane`] of many runs: every field an array over the lanes.
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

    /// The lane of a run in flight; `None` if the event loop has to go on with the run.
    pub fn of(run: &ScalarRun<'_, Siva>, reach: f64) -> Option<Self> {
        Some(Lane { flying: Flying::of(run, reach)?, decay: Decay::of(&run.observer.0) })
    }

    /// Writes the variables back into the run.
    pub fn put_back(&self, run: &mut ScalarRun<'_, Siva>) {
        self.flying.put_back(run, ());
        self.decay.put_back(&mut run.observer.0, &run.system.host, &run.tally.state);
    }
}
