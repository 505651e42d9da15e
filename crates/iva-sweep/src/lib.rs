//! Many runs of an impact vibration absorber.
//!
//! The way from the user's input to Arrow tables: [`fields`] (every number that a user can give) → [`design`]
//! (one point, alternatives resolved, in natural units; the system to run is a [`scene`]) → [`study`]
//! (points, by [`sampling`], and outputs) → [`sweep`] (points in parallel, by rayon) → [`tables`] (Arrow; the
//! columns are defined in [`columns`]). No files, no Python. `CONTRIBUTING.md` tells how to add a measure or
//! a field.
//!
//! The feature `sweeps`, on by default, has the tables, many points, and all that is built on them. Without it there are
//! single runs alone, whose rows are plain columns of numbers ([`watched`]); they need no Arrow and no threads.
//!
//! [`engine`] processes one point, from its fields to the cells of its rows. It is generic over the [number
//! type](iva_core::real).

// Some of what serves many points stands beside what serves one.
#![cfg_attr(not(feature = "sweeps"), allow(dead_code))]

pub mod axis;
mod cells;
pub mod choices;
pub mod columns;
pub mod cube;
pub mod done;
#[cfg(feature = "sweeps")]
pub mod doubts;
#[cfg(feature = "sweeps")]
pub mod dynamics;
pub mod engine;
pub mod fields;
pub mod forces;
#[cfg(feature = "sweeps")]
pub mod identity;
#[cfg(feature = "sweeps")]
pub mod listed;
pub mod motion;
#[cfg(feature = "sweeps")]
pub mod plan;
pub mod restitution_table;
pub mod sampling;
#[cfg(feature = "sweeps")]
mod side_by_side;
pub mod slot;
mod spec;
pub mod structure;
pub mod study;
#[cfg(feature = "sweeps")]
pub mod sweep;
#[cfg(feature = "sweeps")]
pub mod tables;
#[cfg(feature = "sweeps")]
pub mod theory;
pub mod units;
pub mod variable;
pub mod watched;
#[cfg(feature = "sweeps")]
mod workers;

pub use engine::{design, scene};
pub(crate) use iva_core::error;
pub use iva_core::error::{Invalid, number};
