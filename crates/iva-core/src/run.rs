//! Making runs: one alone ([`run`]), or many side by side in the lanes of vector instructions ([`side_by_side`]).
//!
//! A run that is alone goes through the event loop ([`crate::engine::simulate`]) with the usual observers, or with all
//! that a study can ask for ([`observed`]). Many runs go
//! through the same event loop, and lanes take over their simple flights: those of free masses (`run/free_mass.rs`) and of
//! pendulums (`run/piva.rs`). Which runs go in which lanes is said in `run/kinds.rs`.
//! The structure alone, to compare with, is in [`bare`].

pub mod bare;
mod cycling;
mod decays;
mod estimated;
mod forced;
pub(crate) mod free_mass;
mod group;
mod kinds;
mod logged;
pub mod observed;
pub(crate) mod piva;
mod running;
pub mod side_by_side;
mod single;
pub(crate) mod structures;

pub use single::{Run, run, states};
