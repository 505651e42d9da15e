//! Runs one of the fixed scenes of `.ci/instructions.py`, which counts the instructions of the run.
//!
//! `counted NAME`; without a name it lists the scenes.

use std::f64::consts::TAU;
use std::hint::black_box;
use std::process::ExitCode;

use iva_benches::{
    START, decays, driven, driven_jobs, driven_measures, driven_pendulums, fast, swinging_decays,
    upright_decays,
};
use iva_core::absorber::Absorber;
use iva_core::error::Invalid;
use iva_core::force::{Acts, Force, Harmonic};
use iva_core::measures::{Measures, Wanted};
use iva_core::piva::{Parameters, Piva};
use iva_core::run::side_by_side::{self, Job, SideBySide};
use iva_core::simulate::{Limits, simulate};
use iva_core::siva::Siva;

type Run = fn() -> Result<(), Invalid>;

/// Name and code of each scene; `nothing` gives the instructions of a program that runs nothing.
const SCENES: [(&str, Run); 17] = [
    ("nothing", || Ok(())),
    ("siva", || decay(&Siva::new(0.15, 0.5, 0.6, 0.01)?, &START)),
    ("siva_chatter", || decay(&Siva::new(0.15, 0.5, 0.1, 0.01)?, &START)),
    ("siva_forced", || {
        let (siva, limits, window) = driven()?;
        let mut measures = driven_measures(window);
        black_box(simulate(black_box(&siva), &START, &limits, None, &mut measures)?);
        Ok(())
    }),
    ("siva_side_by_side", || count(&decays(2, 0.1)?, Wanted::ALL)),
    ("siva_forced_side_by_side", || count(&driven_jobs(Acts::Primary)?, Wanted::ALL)),
    ("siva_on_base_side_by_side", || count(&driven_jobs(Acts::Base)?, Wanted::ALL)),
    ("siva_impacts_side_by_side", || count(&decays(2, 0.1)?, IMPACTS)),
    ("siva_fast", || count(&fast(decays(2, 0.1)?), Wanted::ALL)),
    ("siva_impacts_fast", || count(&fast(decays(2, 0.1)?), IMPACTS)),
    ("siva_forced_fast", || count(&fast(driven_jobs(Acts::Primary)?), Wanted::ALL)),
    ("siva_upright", || count(&upright_decays(1, 0.1)?, Wanted::ALL)),
    ("piva_forced_side_by_side", || count(&driven_pendulums(Acts::Primary, 0.0)?, Wanted::ALL)),
    ("piva_side_by_side", || count(&swinging_decays(1, 0.6, 0.0)?, Wanted::ALL)),
    ("piva", || decay(&Piva::new(pendulum(0.5, 1.4))?, &START.into())),
    ("piva_chatter", || decay(&Piva::new(pendulum(0.4, 0.2))?, &START.into())),
    ("piva_forced", || {
        let force = Harmonic { amplitude: 0.03, frequency: 0.95, phase: 0.0, acts: Acts::Primary };
        let piva = Piva::new(pendulum(0.6, 0.8))?.under(Force::harmonic(vec![force])?);
        decay(&piva, &START.into())
    }),
];

/// Counts of impacts only, without measures.
const IMPACTS: Wanted = Wanted::NONE;

/// Runs jobs side by side.
fn count<S: SideBySide>(jobs: &[Job<S>], wanted: Wanted) -> Result<(), Invalid> {
    side_by_side::run(jobs, wanted, None, &mut |_, ended| {
        black_box(ended);
    })
}

fn pendulum(restitution: f64, clearance: f64) -> Parameters {
    Parameters {
        frequency_ratio: 0.4,
        ..Parameters::point_bob(0.12, restitution, clearance, 0.01, 10.0)
    }
}

fn decay<S: Absorber<Real = f64>>(system: &S, start: &S::Start) -> Result<(), Invalid> {
    let limits = Limits::new(30.0 * TAU, system.clearance());
    let mut measures = Measures::<S>::new(Wanted::ALL);
    black_box(simulate(black_box(system), start, &limits, None, &mut measures)?);
    black_box(measures.values());
    Ok(())
}

fn main() -> ExitCode {
    let Some(asked) = std::env::args().nth(1) else {
        SCENES.iter().for_each(|(name, _)| println!("{name}"));
        return ExitCode::SUCCESS;
    };
    match SCENES.iter().find(|(name, _)| *name == asked).map(|(_, run)| run()) {
        Some(Ok(())) => ExitCode::SUCCESS,
        Some(Err(error)) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
        None => {
            eprintln!("no scene {asked:?}");
            ExitCode::FAILURE
        }
    }
}
