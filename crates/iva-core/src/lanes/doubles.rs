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
//! ([`responses`]); one round of a lane evaluates both the end of the trial stretch and the contact in it, so
//! that nearly every round completes a stretch; and a round is divided into stages that a processor can
//! overlap ([`step`]). Free decays ([`decays`]) log their motion; driven runs take their measures stretch by
//! stretch ([`totals`]).

mod decays;
mod lane;
mod motion;
mod responses;
mod step;
mod stops;
mod totals;
mod turning;

use super::{Job, Lockstep, Observers, ScalarRun};
use crate::force::{Acts, Harmonic};
use crate::host::{DrivenHost, Host};
use crate::measures::Wanted;
use crate::oscillator::Equation;
use crate::siva::Siva;
use crate::steady::Steady;

pub(super) use decays::FreeFlights;
use lane::{Lane, Lanes};
use motion::Structure;
pub(super) use motion::{BASE, FORCE};
use responses::{Responses, Tables};
use step::Rounds;
use totals::{Asked, Total, Totals};

/// Number of lanes: enough to hide the latency of operations on a processor with wide vectors.
const WIDTH: usize = 16;

/// Lanes of free masses in plain doubles.
#[derive(Debug)]
pub(super) struct Doubles<const DRIVE: u8> {
    lanes: Lanes<WIDTH>,
    tables: Tables<WIDTH>,
    rounds: Rounds<WIDTH>,
    totals: Totals<WIDTH>,
    asked: Asked,
    /// The polynomials computed last, kept because runs that follow each other often have the same.
    latest: Option<Responses>,
}

type Watched<'a> = ScalarRun<'a, Siva<DrivenHost>, Observers<Siva<DrivenHost>>>;

impl<const DRIVE: u8> Doubles<DRIVE> {
    /// The structure of a run, whose polynomials are loaded into the tables of a lane.
    fn structure(&mut self, i: usize, host: &DrivenHost) -> Structure {
        let equation = Equation::new(1.0, host.damping_ratio());
        let harmonic = host.force().and_then(|force| force.harmonics().first());
        let frequency = harmonic.map_or(0.0, |it| it.frequency);
        let same = |it: &Responses| it.damping == equation.damping && it.frequency == frequency;
        let responses = match self.latest.filter(same) {
            Some(responses) => responses,
            None => {
                let responses = Responses::new(equation.damping, equation.growth, frequency);
                *self.latest.insert(responses)
            }
        };
        self.tables.set(i, &responses);
        let structure = Structure::new(&equation, responses.longest);
        harmonic.map_or(structure, |harmonic| driven(structure, harmonic))
    }

    /// Adds the sums of a lane to the observers of its run, and clears them.
    fn tell(&mut self, i: usize, run: &mut Watched<'_>) {
        let total = self.totals.get(i);
        let (measures, steady) = &mut run.observer;
        measures.add([total.lost, total.lost_rest], [total.worked, total.worked_rest]);
        let Total { displacement, acceleration, counts, .. } = total;
        if let Some(steady) = steady {
            let wall = self.lanes.counts.streak_side[i];
            let square = [total.square, total.square_rest];
            steady.add(square, [displacement, acceleration], (total.impacts as u64, wall));
        }
        let told = Total { displacement, acceleration, counts, ..Total::default() };
        self.totals.set(i, &told);
    }
}

/// A structure with a harmonic force, and the contribution of that to the bounds on its derivatives
/// ([`crate::host::Driven`]).
fn driven(structure: Structure, harmonic: &Harmonic) -> Structure {
    let Structure { growth, longest, .. } = structure;
    let mut drives = [harmonic.amplitude.abs(); 7];
    let mut powers = [1.0; 8];
    for n in 1..7 {
        drives[n] = drives[n - 1] * harmonic.frequency;
    }
    for n in 1..8 {
        powers[n] = powers[n - 1] * growth;
    }
    let excess = |order: usize| {
        let sum: f64 = (0..=order).map(|i| powers[order - i] * drives[i]).sum();
        powers[order + 1] * (longest * drives[0]) + sum + drives[order]
    };
    let (base, sign) = if harmonic.acts == Acts::Base { (1.0, -1.0) } else { (0.0, 1.0) };
    Structure {
        amplitude: sign * harmonic.amplitude,
        frequency: harmonic.frequency,
        phase: harmonic.phase,
        excess_3: excess(3),
        excess_4: excess(4),
        excess_5: excess(5),
        excess_6: excess(6),
        base_3: base * drives[3],
        base_4: base * drives[4],
        ..structure
    }
}

impl<const DRIVE: u8> Lockstep<Siva<DrivenHost>> for Doubles<DRIVE> {
    const WIDTH: usize = WIDTH;
    type Observer = Observers<Siva<DrivenHost>>;

    fn new(job: &Job<Siva<DrivenHost>>, wanted: Wanted) -> Self {
        let steady = job.steady.map(|(steady, _)| steady).unwrap_or_default();
        let asked = Asked {
            ledger: wanted.ledger,
            square: steady.rms,
            displacement: steady.amplitude || steady.regime,
            acceleration: steady.acceleration,
            impacts: job.steady.is_some(),
        };
        Self {
            lanes: Lanes::new(),
            tables: Tables::new(),
            rounds: Rounds::new(),
            totals: Totals::new(),
            asked,
            latest: None,
        }
    }

    fn join(leader: &Siva<DrivenHost>, siva: &Siva<DrivenHost>) {
        siva.host.share(&leader.host);
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        let Self { lanes, tables, rounds, totals, asked, .. } = self;
        step::reach::<WIDTH, DRIVE>(lanes, rounds, |Lane { state, structure, length, .. }, i| {
            state.after::<WIDTH, DRIVE>(structure, tables, i, *length)
        });
        step::land::<WIDTH, DRIVE>(lanes, tables, rounds);
        if asked.displacement {
            totals::largest::<WIDTH, DRIVE, false>(lanes, tables, rounds, totals);
        }
        if asked.acceleration {
            totals::largest::<WIDTH, DRIVE, true>(lanes, tables, rounds, totals);
        }
        if asked.ledger {
            totals::lose::<WIDTH, DRIVE>(lanes, tables, rounds, totals);
        }
        if asked.square {
            totals::square::<WIDTH, DRIVE>(lanes, tables, rounds, totals);
        }
        if asked.impacts {
            totals::count(rounds, totals);
        }
        step::commit::<WIDTH, DRIVE>(lanes, rounds, |_, _| 0.0);
        let mut requests = 0.0;
        for i in 0..WIDTH {
            requests += lanes.request[i] + lanes.stopped[i] + lanes.full[i];
        }
        requests > 0.0
    }

    fn requests(&self, i: usize) -> bool {
        self.lanes.request[i] + self.lanes.stopped[i] + self.lanes.full[i] > 0.0
    }

    fn serve(&mut self, i: usize, run: &mut Watched<'_>) -> bool {
        let goes_on = self.lanes.stopped[i] == 0.0 || self.pass_stop(i, run);
        if goes_on && self.lanes.request[i] + self.lanes.full[i] == 0.0 {
            return true;
        }
        self.put_back(i, run);
        false
    }

    fn take(&mut self, i: usize, run: &mut Watched<'_>) -> bool {
        if run.ended {
            return false;
        }
        // A strobe that is due now is left to the event loop.
        let strobe = run.observer.1.as_ref().and_then(Steady::next_strobe);
        if strobe.is_some_and(|instant| stops::is_due(instant.value, run.clock)) {
            return false;
        }
        let structure = self.structure(i, &run.system.host);
        let stop = self.next_stop(run, run.clock);
        let Some(lane) = Lane::of(run, &structure, stop) else { return false };
        self.lanes.set(i, &lane);
        let counts = stops::counts(run, run.clock);
        let [displacement, acceleration] =
            run.observer.1.as_ref().map_or([0.0; 2], |steady| steady.largest());
        let counts = if counts { 1.0 } else { 0.0 };
        self.totals.set(i, &Total { displacement, acceleration, counts, ..Total::default() });
        true
    }

    fn put_back(&mut self, i: usize, run: &mut Watched<'_>) {
        let lane = self.lanes.get(i);
        lane.put_back(run);
        self.tell(i, run);
    }

    fn idle(&mut self, i: usize) {
        self.lanes.set(i, &Lane::idle());
        self.totals.set(i, &Total::default());
    }
}
