//! The core once more, in numbers of twice the precision: what a run in doubles is verified by.
//!
//! Every module is the source of `iva_core`; only [`real`] differs.

// What only other parts of `iva_core` use.
#![allow(dead_code, unused_imports)]

// A source distribution keeps this file, which lies in the package, and the folder of `iva_core` beside
// the package; it drops a `path` of `[lib]` that leads out of the package.
#[path = "../../iva-core/src/twofold_core.rs"]
mod source;

pub use source::*;
