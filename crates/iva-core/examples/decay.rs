//! A free mass on a structure given in kilograms, newtons per metre and millimetres: one decay, its
//! impacts, the motion at some instants, and what other gaps would do.
//!
//! ```sh
//! cargo run --release -p iva-core --example decay
//! ```

use iva_core::absorber::Start;
use iva_core::error::Invalid;
use iva_core::run::{Run, run, states};
use iva_core::simulate::{Limits, Outcome};
use iva_core::siva::Siva;

/// A structure in SI units. The core computes in natural ones: ωn = 1, M = 1, lengths as given.
struct Structure {
    mass: f64,
    stiffness: f64,
    damping: f64,
}

impl Structure {
    fn natural_frequency(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    fn damping_ratio(&self) -> f64 {
        self.damping / (2.0 * self.mass * self.natural_frequency())
    }
}

fn main() -> Result<(), Invalid> {
    let structure = Structure { mass: 3.0, stiffness: 12_000.0, damping: 2.0 };
    let omega = structure.natural_frequency();
    let (mass, restitution, gap) = (0.25, 0.6, 5e-3);
    let start = Start { displacement: 4e-3, ..Start::default() };
    let seconds = 12.0;

    // Mass ratio, restitution, one-sided clearance, damping ratio; each is checked here.
    let absorber = |gap: f64| {
        Siva::new(mass / structure.mass, restitution, gap / 2.0, structure.damping_ratio())
    };
    let siva = absorber(gap)?;
    let limits = Limits::new(seconds * omega, gap / 2.0);
    let decay = run(&siva, &start, &limits)?;
    assert_eq!(decay.tally.outcome, Outcome::Finished);
    println!("{} impacts, settled after {:.3} s", decay.impacts.len(), settled(&decay, omega));
    if let Some(first) = decay.impacts.first() {
        println!(
            "the first at {:.4} s with {:.3} m/s",
            first.time / omega,
            first.gap_velocity_before * omega
        );
    }

    // The motion at any instants; nothing is interpolated.
    for state in states(&siva, &start, &limits, &[0.1 * omega, 0.5 * omega])? {
        println!("x({:.1} s) = {:+.3} mm", state.time / omega, 1e3 * state.displacement);
    }

    for millimetres in 3..=8 {
        let gap = f64::from(millimetres) * 1e-3;
        let decay = run(&absorber(gap)?, &start, &Limits::new(seconds * omega, gap / 2.0))?;
        println!("gap {millimetres} mm: {:.3} s", settled(&decay, omega));
    }
    Ok(())
}

/// The 5 % settling time in seconds; infinite if it did not settle.
fn settled<State>(decay: &Run<State>, omega: f64) -> f64 {
    decay.measures.settling_time_5.map_or(f64::INFINITY, |tau| tau / omega)
}
