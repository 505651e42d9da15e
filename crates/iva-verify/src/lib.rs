//! Runs in numbers of twice the precision ([`Twofold`]), a hundred times slower than in doubles.
//!
//! [`verify()`] tells how far the numbers of a run are from those of an exact one, [`gradients()`] their derivatives, by
//! differences of two exact runs, and [`exact_orbit`] makes a periodic orbit exact.
//!
//! All code for these numbers is compiled in this crate, so that it takes none of the time of what is compiled for
//! speed, and beside it.
//!
//! [`Twofold`]: iva_core::real::twofold::Twofold

mod gradients;
mod orbits;
mod verify;

pub use gradients::gradients;
pub use orbits::exact_orbit;
pub use verify::{Finding, Verification, verify};
