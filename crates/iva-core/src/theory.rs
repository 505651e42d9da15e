//! Steady states known in closed form, for comparison with simulations and as starts of runs.
//!
//! | function | regime | exact |
//! |---|---|---|
//! | [`masri_caughey`] | harmonic force or base motion, two symmetric impacts a cycle | for any μ |
//! | [`slow_manifold`] | slowly varying vibration at ωn, two symmetric impacts a cycle | as μ → 0 |
//!
//! Both are for a free mass in its gap (no gravity), and both are pure functions: nothing here runs a
//! simulation, and no simulation uses them. Natural units: ωn = 1, primary mass 1, time in 1/ωn, lengths as
//! the user gives them.
//!
//! ```
//! use iva_core::force::{Acts, Force, Harmonic};
//! use iva_core::{run::run, simulate::Limits, siva::Siva};
//! use iva_core::theory::{SymmetricScene, masri_caughey};
//!
//! let force = Harmonic { amplitude: 0.1, frequency: 1.0, phase: 0.0, acts: Acts::Primary };
//! let scene = SymmetricScene {
//!     mass_ratio: 0.05, restitution: 0.8, clearance: 2.0, damping_ratio: 0.02, force,
//! };
//! let [Some(orbit), _] = masri_caughey(&scene)?.branches else { unreachable!() };
//! assert!(orbit.admissible && orbit.stable);
//!
//! // A run that starts on the orbit stays on it: one impact every half cycle.
//! let siva = Siva::new(0.05, 0.8, 2.0, 0.02)?.under(Force::harmonic(vec![force])?);
//! let run = run(&siva, &orbit.at_phase(force.phase), &Limits::new(100.0, 2.0))?;
//! let [.., one, other] = run.impacts.as_slice() else { unreachable!() };
//! assert!((other.time - one.time - std::f64::consts::PI).abs() < 1e-10);
//! # Ok::<(), iva_core::error::Invalid>(())
//! ```

pub use nalgebra::Complex;

pub use masri_caughey::{MasriCaughey, Orbit, SymmetricScene, masri_caughey};
pub use slow_manifold::{SlowManifold, slow_manifold};

mod half_cycle;
mod masri_caughey;
mod slow_manifold;
