//! The core once more, in numbers of twice the precision: what a run in doubles is verified by.
//!
//! Every module is the source of `iva_core`; only [`real`] differs.

// What only other parts of `iva_core` use.
#![allow(dead_code, unused_imports)]

pub use iva_core::error;

pub mod chatter;
pub mod compensated;
pub mod contact;
pub mod flight;
pub mod force;
pub mod impact;
mod limits;
pub mod measures;
pub mod observe;
pub mod oscillator;
pub mod peaks;
pub mod piva;
mod polynomial;
mod quintic;
pub mod range;
#[path = "real/twofold.rs"]
pub mod real;
pub mod roots;
pub mod run;
pub mod sample;
mod settling;
pub mod simulate;
pub mod siva;
pub mod steady;
pub mod system;
pub mod taylor;
mod trigonometry;
