//! Many runs of an impact vibration absorber.
//!
//! From what a user gives to Arrow tables:
//! [`fields`] (every number a user can give) → [`design`] (one point, alternatives settled, in
//! natural units; [`scene`] is what runs) → [`study`] (grid and outputs) → [`sweep`] (rayon over the points) → [`tables`]
//! (Arrow). No files, no Python.

pub mod choices;
pub mod columns;
pub mod design;
pub mod fields;
pub mod forces;
pub mod motion;
mod pendulum;
mod rows;
pub mod scene;
pub mod slot;
mod spec;
pub mod study;
pub mod sweep;
pub mod tables;
pub mod theory;
pub mod units;

pub use iva_core::error::{Invalid, number};
