//! Many runs of an impact vibration absorber.
//!
//! From what a user gives to Arrow tables:
//! [`fields`] (every number a user can give) → [`design`] (one point, alternatives settled, in
//! natural units; [`scene`] is what runs) → [`study`] (points, by [`sampling`], and outputs) → [`sweep`] (rayon over the points) → [`tables`]
//! (Arrow; what stands in each column is told by [`columns`]). No files, no Python. How to add a measure or a field is told
//! in `CONTRIBUTING.md`.
//!
//! What happens to one point, from its fields to the cells of its rows, is [`engine`]: written once, for any
//! [number](iva_core::real).

pub mod axis;
pub mod choices;
pub mod columns;
pub mod cube;
pub mod done;
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

pub use engine::{design, scene};
pub(crate) use iva_core::error;
pub use iva_core::error::{Invalid, number};
