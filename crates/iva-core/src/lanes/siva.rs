//! Lanes for the fast flights of free masses in the exact tier: free decays, on primary structures of one
//! damping ratio, and runs under one harmonic force ([`driven`]).

mod driven;
mod flying;
mod look;

use super::LANES;
use super::decays::{Decaying, Flights};
use crate::arrays::{any, arrays};
use crate::compensated::DoubleDouble;
use crate::host::Host;
use crate::log::Entry;
use crate::oscillator::Oscillator;
use crate::siva::Siva;
pub(super) use driven::DrivenFastFlights;

use flying::{Flying, Flyings};
use look::look;

arrays! {
    /// The impact that an evaluation has found.
    Struck,
    /// [`Struck`] of many runs: every field an array over the lanes.
    Strikes:
    /// 1 if there is one; ẋ just before.
    hit, v_before,
}

/// Eight lanes of free decays on one primary structure.
#[derive(Debug)]
pub(super) struct FastFlights {
    lanes: Flyings<LANES>,
    struck: Strikes<LANES>,
    /// The structure without absorber. Held by value, so that the compiler knows that it does not overlap the
    /// arrays.
    free: Oscillator,
}

impl Flights for FastFlights {
    const WIDTH: usize = LANES;

    fn new(siva: &Siva) -> Self {
        Self { lanes: Flyings::new(), struck: Strikes::new(), free: *siva.host.free() }
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        let Self { lanes, struck, free } = self;
        evaluate(lanes, struck, free)
    }

    #[inline(always)]
    fn times(&self) -> &[f64] {
        &self.lanes.time
    }

    #[inline(always)]
    fn hits(&self) -> bool {
        any(&self.struck.hit)
    }

    #[inline(always)]
    fn motion(&self, i: usize) -> Option<Entry> {
        let Struck { hit, v_before } = self.struck.get(i);
        (hit > 0.0).then(|| {
            let Flyings { x, v, side, rate, time, time_rest, .. } = &self.lanes;
            let clock = DoubleDouble { value: time[i], rest: time_rest[i] };
            Entry::new(clock, [x[i], v[i]], v_before, v[i] - side[i] * rate[i], false)
        })
    }

    fn requests(&self, i: usize) -> bool {
        self.lanes.request[i] + self.lanes.stopped[i] > 0.0
    }

    fn take(&mut self, i: usize, run: &Decaying<'_>) -> bool {
        let flying = Flying::of(run, self.free.reach);
        if let Some(flying) = &flying {
            self.lanes.set(i, flying);
        }
        flying.is_some()
    }

    fn put_back(&self, i: usize, run: &mut Decaying<'_>) -> f64 {
        let flying = self.lanes.get(i);
        flying.put_back(run, ());
        flying.v
    }

    fn idle(&mut self, i: usize) {
        self.lanes.set(i, &Flying::idle());
        self.struck.set(i, &Struck::default());
    }
}

/// One evaluation of each lane; true if a lane needs its run.
#[inline(always)]
fn evaluate<const W: usize>(
    lanes: &mut Flyings<W>,
    struck: &mut Strikes<W>,
    free: &Oscillator,
) -> bool {
    for i in 0..W {
        let flying = lanes.get(i);
        let look = look(free, &(), &flying, flying.state(()));
        lanes.set(i, &look.next(&flying, free.reach));
        struck.set(i, &look.struck());
    }
    any(&lanes.request) | any(&lanes.stopped)
}
