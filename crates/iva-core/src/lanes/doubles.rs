//! The fast tier: free masses in plain doubles.
//!
//! The exact tier carries states in double-double, so that the error of a run is below one rounding of its
//! numbers. Here states are plain doubles and only the clock is compensated: every stretch of flight adds
//! rounding errors, and the error of a run is some rounding units times its condition number. The guarantee
//! on events is the same: every stretch is proved to meet no wall, or one wall once, for the motion as
//! computed. What is not simple (a low rebound, the sum of a chatter, a stick episode, a grazing) is left to
//! the event loop, from the same state.
//!
//! Three things make it fast: flights are sums of four short polynomials whatever the force is
//! ([`crate::plain`]); one round of a lane evaluates both the end of the trial stretch and the contact in it,
//! so that nearly every round completes a stretch; and a round is divided into stages that a processor can
//! overlap ([`step`]). Lanes only move, and log what measures need: free decays ([`decays`]) the begins of
//! their motions, runs under a harmonic force (here) their flights ([`crate::measures::forced`]).

mod decays;
mod lane;
mod step;

use super::{Job, Lockstep, ScalarRun};
use crate::arrays::any;
use crate::host::{DrivenHost, Host};
use crate::measures::Wanted;
use crate::measures::forced::Forced;
use crate::plain::responses::Tables;
use crate::siva::Siva;

pub(super) use decays::FreeFlights;
use lane::{Lane, Lanes};
use step::Rounds;

/// Number of lanes: enough to hide the latency of operations on a processor with wide vectors.
const WIDTH: usize = 16;

/// Lanes of free masses in plain doubles under one harmonic force each, on the structure or on its base.
#[derive(Debug)]
pub(super) struct Doubles<const DRIVE: u8> {
    lanes: Lanes<WIDTH>,
    tables: Tables<WIDTH>,
    rounds: Rounds<WIDTH>,
    /// The log of the run of each lane.
    logs: [Option<Box<Forced>>; WIDTH],
    /// True if measures need the flights.
    logged: bool,
}

type Watched<'a> = ScalarRun<'a, Siva<DrivenHost>>;

impl<const DRIVE: u8> Lockstep<Siva<DrivenHost>> for Doubles<DRIVE> {
    const WIDTH: usize = WIDTH;

    fn new(job: &Job<Siva<DrivenHost>>, wanted: Wanted) -> Self {
        let steady = job.steady.map(|(steady, _)| steady).unwrap_or_default();
        Self {
            lanes: Lanes::new(),
            tables: Tables::new(),
            rounds: Rounds::new(),
            logs: [const { None }; WIDTH],
            logged: wanted.ledger || steady.any(),
        }
    }

    fn join(leader: &Siva<DrivenHost>, siva: &Siva<DrivenHost>) {
        siva.host.share(&leader.host);
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        let Self { lanes, tables, rounds, logs, logged } = self;
        step::reach::<WIDTH, DRIVE>(
            lanes,
            rounds,
            #[inline(always)]
            |Lane { state, structure, length, .. }, i| {
                state.after::<DRIVE>(structure, &tables.of(i), *length)
            },
        );
        step::land::<WIDTH, DRIVE>(lanes, tables, rounds);
        let mut full = false;
        if *logged {
            for (i, log) in logs.iter_mut().enumerate() {
                if rounds.passed[i] > 0.0
                    && let Some(log) = log
                {
                    let length = rounds.length[i] + rounds.later[i];
                    let ends = [&lanes.state.get(i), &rounds.end.get(i)];
                    let clock = lanes.clock(i);
                    let at = clock.plus_parts(rounds.length[i], rounds.later[i]).value;
                    log.push(clock, length, [at, rounds.approach[i]], ends);
                    full |= log.is_full();
                }
            }
        }
        step::commit::<WIDTH, DRIVE>(
            lanes,
            rounds,
            #[inline(always)]
            |_, _| 0.0,
        );
        full | any(&lanes.request) | any(&lanes.stopped) | any(&lanes.full)
    }

    fn requests(&self, i: usize) -> bool {
        let full = self.logs[i].as_ref().is_some_and(|log| log.is_full());
        full || self.lanes.request[i] + self.lanes.stopped[i] + self.lanes.full[i] > 0.0
    }

    fn serve(&mut self, i: usize, run: &mut Watched<'_>) -> bool {
        let lanes = &self.lanes;
        if lanes.request[i] + lanes.stopped[i] + lanes.full[i] > 0.0 {
            self.put_back(i, run);
            return false;
        }
        run.observer.forced = self.logs[i].take();
        run.observer.take_log();
        self.logs[i] = run.observer.forced.take();
        true
    }

    fn take(&mut self, i: usize, run: &mut Watched<'_>) -> bool {
        let Some(log) = run.observer.forced.as_ref().filter(|_| !run.ended) else { return false };
        let Some(lane) = Lane::of(run, &log.structure, run.limits.duration) else { return false };
        self.tables.set(i, &log.responses);
        self.lanes.set(i, &lane);
        self.logs[i] = run.observer.forced.take();
        true
    }

    fn put_back(&mut self, i: usize, run: &mut Watched<'_>) {
        if self.lanes.stopped[i] > 0.0 {
            run.reach_end();
        }
        self.lanes.get(i).put_back(run);
        run.observer.forced = self.logs[i].take();
    }

    fn idle(&mut self, i: usize) {
        self.lanes.set(i, &Lane::idle());
        self.logs[i] = None;
    }
}
