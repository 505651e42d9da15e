//! Lanes for the fast flights of free masses under one harmonic force each, on the structure or on its base.
//! Force, damping and absorber may differ from lane to lane.

mod lane;
mod step;

use crate::arrays::any;
use crate::compensated::DoubleDouble;
use crate::lanes::LANES;
use crate::lanes::forced::{Driven, Flights};
use crate::plain::State;
use crate::system::Clock;

use lane::{Lane, Lanes};
use step::{Ended, Ends};

/// Eight lanes for driven free masses.
#[derive(Debug)]
pub(in crate::lanes) struct DrivenFastFlights<const BASE: bool> {
    lanes: Lanes<LANES>,
    /// The flight that each lane has just completed.
    ended: Ends<LANES>,
}

impl<const BASE: bool> Flights for DrivenFastFlights<BASE> {
    const WIDTH: usize = LANES;

    fn new() -> Self {
        Self { lanes: Lanes::new(), ended: Ends::new() }
    }

    #[inline(always)]
    fn evaluate(
        &mut self,
        wanted: bool,
        mut take: impl FnMut(usize, Clock, f64, [f64; 2], [&State; 2]),
    ) -> bool {
        let Self { lanes, ended } = self;
        step::steps::<LANES, BASE>(lanes, ended);
        if wanted {
            for i in 0..LANES {
                if ended.length[i] > 0.0 {
                    let Ended { time, time_rest, length, approach, begin, end } = ended.get(i);
                    let clock = DoubleDouble { value: time, rest: time_rest };
                    take(i, clock, length, [lanes.flying.time[i], approach], [&begin, &end]);
                }
            }
        }
        any(&lanes.flying.request) | any(&lanes.flying.stopped)
    }

    fn requests(&self, i: usize) -> bool {
        self.lanes.flying.request[i] + self.lanes.flying.stopped[i] > 0.0
    }

    fn take(&mut self, i: usize, run: &Driven<'_>) -> bool {
        let lane = Lane::of::<BASE>(run);
        if let Some(lane) = &lane {
            self.lanes.set(i, lane);
        }
        lane.is_some()
    }

    fn put_back(&self, i: usize, run: &mut Driven<'_>) {
        self.lanes.get(i).put_back::<BASE>(run);
    }

    fn idle(&mut self, i: usize) {
        self.lanes.set(i, &Lane::idle());
        self.ended.set(i, &Ended::default());
    }
}
