//! One run of a study, for any [number type](iva_core::real): from the fields that a user gave to the cells
//! of its rows.
//!
//! [`given`] (fields as numbers) → [`design`] (alternatives resolved, natural units; the system to run is a
//! [`scene`]) → `point` (the run; `ended` is its result) → `rows` (its rows, in the user's units by [`scale`]). Results are computed
//! in doubles; the crate `iva-verify` computes them in numbers of twice the precision.

pub mod contact;
pub mod design;
pub(crate) mod ended;
pub(crate) mod forces;
pub(crate) mod free_mass;
pub mod given;
mod modal;
pub(crate) mod pendulum;
pub(crate) mod point;
mod restitution;
pub(crate) mod rows;
pub mod scale;
pub mod scene;
mod several;
pub(crate) mod ties;
