//! Lanes for the fast flights of free masses under one harmonic force each, on the structure or on its base.
//! Force, damping and absorber may differ from lane to lane.
//!
//! The lanes compute the motion only and log their flights ([`log`]), as the event loop does where it goes
//! on. Measures follow when a log is full or its run has ended ([`recorder`]), for eight flights at a time.

mod answers;
mod integrals;
mod lane;
mod log;
mod logged;
mod recorder;
mod step;

use crate::host::DrivenHost;
use crate::lanes::{Job, LANES, Lockstep, ScalarRun};
use crate::measures::Wanted;
use crate::siva::Siva;

use answers::Asked;
use lane::{Lane, Lanes};
use log::{Flight, Flights, Log};
use recorder::Recorder;

/// Eight lanes for driven free masses.
#[derive(Debug)]
pub(in crate::lanes) struct DrivenFastFlights<const BASE: bool> {
    lanes: Lanes<LANES>,
    /// The flight that each lane has just completed; of length 0 if there is none.
    ended: Flights<LANES>,
    /// The log of the run of each lane.
    logs: [Log; LANES],
    asked: Asked,
}

impl<const BASE: bool> Lockstep<Siva<DrivenHost>> for DrivenFastFlights<BASE> {
    type Observer = Recorder<BASE>;

    fn new(job: &Job<Siva<DrivenHost>>, wanted: Wanted) -> Self {
        Self {
            lanes: Lanes::new(),
            ended: Flights::new(),
            logs: Default::default(),
            asked: Asked::new(job, wanted),
        }
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        let Self { lanes, ended, logs, asked } = self;
        if asked.extremes().next().is_some() {
            step::steps::<LANES, BASE, true>(lanes, ended);
        } else {
            step::steps::<LANES, BASE, false>(lanes, ended);
        }
        if asked.flights {
            for (i, log) in logs.iter_mut().enumerate() {
                if ended.length[i] > 0.0 {
                    log.push(&ended.get(i));
                    // The event loop hands a full log to the measures.
                    if log.is_full() {
                        lanes.flying.request[i] = 1.0;
                    }
                }
            }
        }
        let mut requests = 0.0;
        for i in 0..LANES {
            requests += lanes.flying.request[i] + lanes.flying.stopped[i];
        }
        requests > 0.0
    }

    fn requests(&self, i: usize) -> bool {
        self.lanes.flying.request[i] + self.lanes.flying.stopped[i] > 0.0
    }

    fn serve(
        &mut self,
        i: usize,
        run: &mut ScalarRun<'_, Siva<DrivenHost>, Recorder<BASE>>,
    ) -> bool {
        self.put_back(i, run);
        false
    }

    fn take(
        &mut self,
        i: usize,
        run: &mut ScalarRun<'_, Siva<DrivenHost>, Recorder<BASE>>,
    ) -> bool {
        let lane = Lane::of(run);
        if let Some(lane) = &lane {
            self.lanes.set(i, lane);
            std::mem::swap(&mut self.logs[i], &mut run.observer.log);
        }
        lane.is_some()
    }

    fn put_back(&mut self, i: usize, run: &mut ScalarRun<'_, Siva<DrivenHost>, Recorder<BASE>>) {
        self.lanes.get(i).put_back(run);
        std::mem::swap(&mut self.logs[i], &mut run.observer.log);
    }

    fn idle(&mut self, i: usize) {
        self.lanes.set(i, &Lane::idle());
        self.ended.set(i, &Flight::default());
    }
}
