//! Lanes for the fast flights of free masses under one harmonic force each, on the structure or on its base.
//! Force, damping and absorber may differ from lane to lane.
//!
//! The lanes compute the motion only and log their flights, as the event loop does where it goes on. Measures
//! follow when a log is full or its run has ended ([`crate::measures::forced`]).

mod lane;
mod step;

use crate::arrays::any;
use crate::compensated::DoubleDouble;
use crate::host::DrivenHost;
use crate::lanes::{Job, LANES, Lockstep, ScalarRun};
use crate::measures::Wanted;
use crate::measures::forced::Forced;
use crate::siva::Siva;

use lane::{Lane, Lanes};
use step::{Ended, Ends};

/// Eight lanes for driven free masses.
#[derive(Debug)]
pub(in crate::lanes) struct DrivenFastFlights<const BASE: bool> {
    lanes: Lanes<LANES>,
    /// The flight that each lane has just completed.
    ended: Ends<LANES>,
    /// The log of the run of each lane.
    logs: [Option<Box<Forced>>; LANES],
    /// True if measures need the flights.
    logged: bool,
}

type Watched<'a> = ScalarRun<'a, Siva<DrivenHost>>;

impl<const BASE: bool> Lockstep<Siva<DrivenHost>> for DrivenFastFlights<BASE> {
    fn new(job: &Job<Siva<DrivenHost>>, wanted: Wanted) -> Self {
        let steady = job.steady.map(|(steady, _)| steady).unwrap_or_default();
        Self {
            lanes: Lanes::new(),
            ended: Ends::new(),
            logs: [const { None }; LANES],
            logged: wanted.ledger || steady.any(),
        }
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        let Self { lanes, ended, logs, logged } = self;
        step::steps::<LANES, BASE>(lanes, ended);
        if *logged {
            for (i, log) in logs.iter_mut().enumerate() {
                if ended.length[i] > 0.0
                    && let Some(log) = log
                {
                    let Ended { time, time_rest, length, approach, begin, end } = ended.get(i);
                    let clock = DoubleDouble { value: time, rest: time_rest };
                    log.push(clock, length, [lanes.flying.time[i], approach], [&begin, &end]);
                    // The event loop hands a full log to the measures.
                    if log.is_full() {
                        lanes.flying.request[i] = 1.0;
                    }
                }
            }
        }
        any(&lanes.flying.request) | any(&lanes.flying.stopped)
    }

    fn requests(&self, i: usize) -> bool {
        self.lanes.flying.request[i] + self.lanes.flying.stopped[i] > 0.0
    }

    fn serve(&mut self, i: usize, run: &mut Watched<'_>) -> bool {
        self.put_back(i, run);
        false
    }

    fn take(&mut self, i: usize, run: &mut Watched<'_>) -> bool {
        // A force too fast for the log is left to the event loop.
        let fits = !self.logged || run.observer.forced.is_some();
        let lane = Lane::of::<BASE>(run).filter(|_| fits);
        if let Some(lane) = &lane {
            self.lanes.set(i, lane);
            self.logs[i] = run.observer.forced.take();
        }
        lane.is_some()
    }

    fn put_back(&mut self, i: usize, run: &mut Watched<'_>) {
        self.lanes.get(i).put_back::<BASE>(run);
        run.observer.forced = self.logs[i].take();
    }

    fn idle(&mut self, i: usize) {
        self.lanes.set(i, &Lane::idle());
        self.ended.set(i, &Ended::default());
        self.logs[i] = None;
    }
}
