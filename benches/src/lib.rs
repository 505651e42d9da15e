//! Scenes of the benches. Criterion benches are in `benches/*.rs`; `bin/counted.rs` runs the scenes whose
//! instructions are counted.

use std::f64::consts::TAU;

use iva_core::absorber::{Absorber, Start, Wall};
use iva_core::error::Invalid;
use iva_core::force::{Acts, Force, Harmonic, Impulse};
use iva_core::host::DrivenHost;
use iva_core::measures::{Measures, Wanted};
use iva_core::piva::{Parameters, Piva};
use iva_core::run::side_by_side::{Job, SideBySide, Tier};
use iva_core::simulate::Limits;
use iva_core::siva::Siva;
use iva_core::steady::{Steady, SteadyWanted, Window};

/// The start of all scenes: displaced by 1, at rest.
pub const START: Start =
    Start { displacement: 1.0, velocity: 0.0, gap_displacement: 0.0, gap_velocity: 0.0 };

/// Free decays of 30 periods: `masses` mass ratios, 8 clearances from `narrowest` on, 5 coefficients of
/// restitution; ζ 0.01.
///
/// # Errors
/// [`Invalid`] for a clearance of 0 or less.
pub fn decays(masses: u32, narrowest: f64) -> Result<Vec<Job<Siva>>, Invalid> {
    let mut scenes = Vec::new();
    for mass in 0..masses {
        for step in 0..8 {
            for e in [0.4, 0.5125, 0.625, 0.7375, 0.85] {
                let mu = 0.02 + 0.18 * f64::from(mass) / f64::from(masses);
                let clearance = narrowest + 0.125 * f64::from(step);
                let system = Siva::new(mu, e, clearance, 0.01)?;
                let limits = Limits::new(30.0 * TAU, clearance);
                scenes.push(Job {
                    begin: 0.0,
                    system,
                    start: START,
                    limits,
                    steady: None,
                    tier: Tier::Exact,
                });
            }
        }
    }
    Ok(scenes)
}

/// These jobs in the fast tier.
pub fn fast<S: SideBySide>(jobs: Vec<Job<S>>) -> Vec<Job<S>> {
    jobs.into_iter().map(|job| Job { tier: Tier::Fast, ..job }).collect()
}

/// The decays of [`decays`] with pendulums of r = 0.4 and L = 10, at a tolerance.
///
/// # Errors
/// [`Invalid`] for a clearance of 0 or less.
pub fn swinging_decays(
    masses: u32,
    narrowest: f64,
    tolerance: f64,
) -> Result<Vec<Job<Piva<DrivenHost>>>, Invalid> {
    let pendulum = |Job { system, limits, .. }: Job<Siva>| {
        let (mu, e) = (system.mass_ratio(), system.restitution(Wall::Plus));
        let point_bob = Parameters::point_bob(mu, e, system.clearance(), 0.01, 10.0);
        let system = Piva::new(Parameters { frequency_ratio: 0.4, tolerance, ..point_bob })?;
        let system = system.under(Force::harmonic(vec![])?);
        Ok(Job { begin: 0.0, system, start: START.into(), limits, steady: None, tier: Tier::Exact })
    };
    decays(masses, narrowest)?.into_iter().map(pendulum).collect()
}

/// The decays of [`decays`] with a vertical line of motion, with a tenth of the largest gravity at which the
/// absorber would leave its lower stop; it starts on that stop.
///
/// # Errors
/// [`Invalid`] for a clearance of 0 or less.
pub fn upright_decays(masses: u32, narrowest: f64) -> Result<Vec<Job<Siva<DrivenHost>>>, Invalid> {
    let upright = |Job { system, start, begin, limits, steady, tier }: Job<Siva>| {
        let gravity = 0.1 / (1.0 + system.mass_ratio());
        let start = Start { gap_displacement: -system.clearance(), ..start };
        let system = system.inclined(gravity, Force::default());
        Job { system, start, begin, limits, steady, tier }
    };
    Ok(decays(masses, narrowest)?.into_iter().map(upright).collect())
}

/// The decays of [`decays`] after a blow on a structure at rest.
///
/// # Errors
/// [`Invalid`] for a clearance of 0 or less.
pub fn decays_after_a_blow(
    masses: u32,
    narrowest: f64,
) -> Result<Vec<Job<Siva<DrivenHost>>>, Invalid> {
    let struck = |Job { system, begin, limits, steady, tier, .. }: Job<Siva>| {
        let blow = Impulse { velocity: 1.0, time: 0.0 };
        let system = system.under(Force::new(Vec::new(), Vec::new(), &[blow])?);
        Ok(Job { system, start: Start::default(), begin, limits, steady, tier })
    };
    decays(masses, narrowest)?.into_iter().map(struck).collect()
}

/// A free mass under a harmonic force for 60 cycles, with the window of its steady state.
///
/// # Errors
/// [`Invalid`] for numbers out of range, which these are not.
pub fn driven() -> Result<(Siva<DrivenHost>, Limits, Window), Invalid> {
    let force = Harmonic { amplitude: 0.1, frequency: 0.95, phase: 0.0, acts: Acts::Primary };
    let siva = Siva::new(0.1, 0.7, 1.0, 0.02)?.under(Force::harmonic(vec![force])?);
    let limits = Limits::new(60.0 * TAU / force.frequency, 1.0);
    Ok((siva, limits, Window { from: 0.0, cycle: Some(force) }))
}

/// All measures of a summary of a driven run.
pub fn driven_measures(window: Window) -> (Measures<Siva<DrivenHost>>, Steady) {
    let wanted = SteadyWanted { strobes: false, ..SteadyWanted::ALL };
    (Measures::new(Wanted::ALL), Steady::new(window, wanted))
}

/// Forty driven free masses with one damping ratio, under forces of many frequencies on the structure or its
/// base.
///
/// # Errors
/// [`Invalid`] for numbers out of range, which these are not.
pub fn driven_jobs(acts: Acts) -> Result<Vec<Job<Siva<DrivenHost>>>, Invalid> {
    let wanted = SteadyWanted { strobes: false, ..SteadyWanted::ALL };
    let job = |i: u32| {
        let (amplitude, frequency) = (0.1, 0.8 + 0.01 * f64::from(i));
        let force = Harmonic { amplitude, frequency, phase: 0.0, acts };
        let siva = Siva::new(0.1, 0.7, 1.0, 0.02)?.under(Force::harmonic(vec![force])?);
        let limits = Limits::new(60.0 * TAU / frequency, 1.0);
        let window = Window { from: 0.0, cycle: Some(force) };
        Ok(Job {
            begin: 0.0,
            system: siva,
            start: START,
            limits,
            steady: Some((wanted, window)),
            tier: Tier::Exact,
        })
    };
    (0..40).map(job).collect()
}

/// The runs of [`driven_jobs`] with pendulums of r = 0.3 and L = 10, at a tolerance.
///
/// # Errors
/// [`Invalid`] for numbers out of range, which these are not.
pub fn driven_pendulums(acts: Acts, tolerance: f64) -> Result<Vec<Job<Piva<DrivenHost>>>, Invalid> {
    let pendulum = |Job { system, limits, steady, tier, .. }: Job<Siva<DrivenHost>>| {
        let force = system.force().cloned().unwrap_or_default();
        let (mu, e) = (system.mass_ratio(), system.restitution(Wall::Plus));
        let point_bob = Parameters::point_bob(mu, e, system.clearance(), 0.02, 10.0);
        let swinging = Parameters { frequency_ratio: 0.3, tolerance, ..point_bob };
        let system = Piva::new(swinging)?.under(force);
        Ok(Job { begin: 0.0, system, start: START.into(), limits, steady, tier })
    };
    driven_jobs(acts)?.into_iter().map(pendulum).collect()
}
