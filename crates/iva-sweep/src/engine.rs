//! One run of a study, in any [number](iva_core::real): from the fields that a user gave to the cells of its rows.
//!
//! [`given`] (fields as numbers) → [`design`] (alternatives settled, in natural units; [`scene`] is what runs)
//! → `point` (the run) → `rows` (its rows, in the user's units by [`scale`]). Users get doubles;
//! [`crate::verify`] runs in numbers of twice the precision, [`crate::gradients`] in numbers with derivatives.

pub mod design;
pub(crate) mod forces;
pub(crate) mod free_mass;
pub mod given;
pub(crate) mod pendulum;
pub(crate) mod point;
pub(crate) mod rows;
pub mod scale;
pub mod scene;
