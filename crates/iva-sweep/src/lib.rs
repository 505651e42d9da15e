//! Many runs of an impact vibration absorber.
//!
//! From what a user gives to Arrow tables:
//! [`fields`] (every number a user can give) → [`design`] (one point, alternatives settled, in
//! natural units; [`scene`] is what runs) → [`study`] (points, by [`sampling`], and outputs) → [`sweep`] (rayon over the points) → [`tables`]
//! (Arrow). No files, no Python.
//!
//! **One source, three kinds of number.** What stands in the folder `engine` (from the fields of one run
//! to the cells of its rows) is compiled three times, as the core is: in doubles ([`doubles`], what users
//! get; [`design`] and [`scene`] are its), in numbers of twice the precision ([`twofold`], for
//! [`verify`]) and in numbers with a derivative ([`dual`], for [`gradients`]). In it `super::core` is the
//! core of that number and `Real` the number.

pub mod axis;
pub mod choices;
pub mod columns;
pub mod cube;
pub mod done;
#[allow(clippy::duplicate_mod)] // see `engine`
pub mod doubles;
#[allow(clippy::duplicate_mod)]
pub mod dual;
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
#[allow(clippy::duplicate_mod)]
pub mod twofold;
pub mod units;
pub mod variable;
pub mod verify;

pub use doubles::{design, scene};
pub(crate) use iva_core::error;
pub use iva_core::error::{Invalid, number};
