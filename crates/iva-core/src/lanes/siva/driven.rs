//! Fast flights of free masses under one harmonic force on the structure each, side by side: force, damping and absorber
//! may differ from lane to lane.

mod integrals;
mod lane;
mod step;

use crate::host::DrivenHost;
use crate::lanes::{Job, LANES, Lockstep, ScalarRun};
use crate::measures::Wanted;
use crate::siva::Siva;
use crate::steady::SteadyWanted;

use integrals::Integrals;
use lane::{Lane, Lanes};

/// Eight lanes.
#[derive(Debug)]
pub(in crate::lanes) struct DrivenFastFlights {
    lanes: Lanes<LANES>,
    integrals: Integrals<LANES>,
    asked: Asked,
}

/// What is asked of all lanes.
#[derive(Debug, Clone, Copy)]
struct Asked {
    steady: AskedSteady,
    /// Losses and work.
    ledger: bool,
}

/// What is asked of the steady states of all lanes.
#[derive(Debug, Clone, Copy)]
pub(in crate::lanes) struct AskedSteady {
    /// Largest displacements and accelerations.
    pub extremes: bool,
    /// The mean square.
    pub square: bool,
}

impl AskedSteady {
    pub fn of(job: &Job<Siva<DrivenHost>>) -> Self {
        let SteadyWanted { amplitude, rms, acceleration, regime, .. } =
            job.steady.map_or_else(SteadyWanted::default, |(wanted, _)| wanted);
        Self { extremes: amplitude || acceleration || regime, square: rms }
    }
}

impl Lockstep<Siva<DrivenHost>> for DrivenFastFlights {
    fn new(job: &Job<Siva<DrivenHost>>, wanted: Wanted) -> Self {
        let asked = Asked { steady: AskedSteady::of(job), ledger: wanted.ledger };
        Self { lanes: Lanes::new(), integrals: Integrals::new(), asked }
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        let Self { lanes, integrals, asked } = self;
        if asked.steady.extremes {
            step::steps::<LANES, true>(lanes, integrals);
        } else {
            step::steps::<LANES, false>(lanes, integrals);
        }
        if asked.ledger {
            integrals.lose(lanes);
        }
        if asked.steady.square {
            integrals.square(lanes);
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

    fn serve(&mut self, i: usize, run: &mut ScalarRun<'_, Siva<DrivenHost>>) -> bool {
        self.put_back(i, run);
        false
    }

    fn take(&mut self, i: usize, run: &ScalarRun<'_, Siva<DrivenHost>>) -> bool {
        let lane = Lane::of(run);
        if let Some(lane) = &lane {
            self.lanes.set(i, lane);
        }
        lane.is_some()
    }

    fn put_back(&self, i: usize, run: &mut ScalarRun<'_, Siva<DrivenHost>>) {
        let lane = self.lanes.get(i);
        lane.put_back(run);
        if lane.flying.stopped == super::STOP {
            run.pass_stop();
        }
    }

    fn idle(&mut self, i: usize) {
        self.lanes.set(i, &Lane::idle());
    }
}
