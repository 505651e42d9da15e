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
//! their motions, runs under a harmonic force ([`super::forced`]) their flights.

mod decays;
mod lane;
mod step;

use crate::arrays::any;
use crate::lanes::forced::{Driven, Flights};
use crate::plain::State;
use crate::plain::responses::Tables;
use crate::system::Clock;

pub(super) use decays::FreeFlights;
use lane::{Lane, Lanes};
use step::Rounds;

/// Number of lanes: enough to hide the latency of operations on a processor with wide vectors.
const WIDTH: usize = 16;

/// Lanes of free masses in plain doubles under one harmonic force each, on the structure or on its base.
#[derive(Debug)]
pub(super) struct DrivenFlights<const DRIVE: u8> {
    lanes: Lanes<WIDTH>,
    tables: Tables<WIDTH>,
    rounds: Rounds<WIDTH>,
}

impl<const DRIVE: u8> Flights for DrivenFlights<DRIVE> {
    const WIDTH: usize = WIDTH;

    fn new() -> Self {
        Self { lanes: Lanes::new(), tables: Tables::new(), rounds: Rounds::new() }
    }

    #[inline(always)]
    fn evaluate(
        &mut self,
        wanted: bool,
        mut take: impl FnMut(usize, Clock, f64, [f64; 2], [&State; 2]),
    ) -> bool {
        let Self { lanes, tables, rounds } = self;
        step::reach::<WIDTH, DRIVE>(
            lanes,
            rounds,
            #[inline(always)]
            |Lane { state, structure, length, .. }, i| {
                state.after::<DRIVE>(structure, &tables.of(i), *length)
            },
        );
        step::land::<WIDTH, DRIVE>(lanes, tables, rounds);
        if wanted {
            for i in 0..WIDTH {
                if rounds.passed[i] > 0.0 {
                    let (length, later) = (rounds.length[i], rounds.later[i]);
                    let ends = [&lanes.state.get(i), &rounds.end.get(i)];
                    let clock = lanes.clock(i);
                    let at = clock.plus_parts(length, later).value;
                    take(i, clock, length + later, [at, rounds.approach[i]], ends);
                }
            }
        }
        step::commit::<WIDTH, DRIVE>(
            lanes,
            rounds,
            #[inline(always)]
            |_, _| 0.0,
        );
        any(&lanes.request) | any(&lanes.stopped) | any(&lanes.full)
    }

    fn requests(&self, i: usize) -> bool {
        self.lanes.request[i] + self.lanes.stopped[i] + self.lanes.full[i] > 0.0
    }

    fn take(&mut self, i: usize, run: &Driven<'_>) -> bool {
        let Some(log) = &run.observer.forced else { return false };
        let lane = Lane::of(run, &log.structure, run.limits.duration);
        if let Some(lane) = &lane {
            self.tables.set(i, &log.responses);
            self.lanes.set(i, lane);
        }
        lane.is_some()
    }

    fn put_back(&self, i: usize, run: &mut Driven<'_>) {
        if self.lanes.stopped[i] > 0.0 {
            run.reach_end();
        }
        self.lanes.get(i).put_back(run);
    }

    fn idle(&mut self, i: usize) {
        self.lanes.set(i, &Lane::idle());
    }
}
