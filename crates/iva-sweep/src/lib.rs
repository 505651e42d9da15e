//! Many runs of an impact vibration absorber.
//!
//! The way from the user's input to Arrow tables: [`fields`] (every number that a user can give) → [`design`]
//! (one point, alternatives resolved, in natural units; the system to run is a [`scene`]) → [`study`]
//! (points, by [`sampling`], and outputs) → [`sweep`] (points in parallel, by rayon) → [`tables`] (Arrow; the
//! columns are defined in [`columns`]). No files, no Python. `CONTRIBUTING.md` tells how to add a measure or
//! a field.
//!
//! [`engine`] processes one point, from its fields to the cells of its rows. It is generic over the [number
//! type](iva_core::real).

pub mod axis;
pub mod choices;
pub mod columns;
pub mod cube;
pub mod done;
pub mod dynamics;
pub mod engine;
pub mod fields;
pub mod forces;
pub mod gradients;
pub mod identity;
pub mod motion;
pub mod plan;
pub mod sampling;
mod side_by_side;
pub mod slot;
mod spec;
pub mod study;
pub mod sweep;
pub mod tables;
pub mod theory;
pub mod units;
pub mod variable;
pub mod verify;
mod workers;

pub use engine::{design, scene};
pub(crate) use iva_core::error;
pub use iva_core::error::{Invalid, number};
