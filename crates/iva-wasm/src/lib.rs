//! The simulator for the explorer, compiled to WebAssembly.
//!
//! JavaScript writes a text to a buffer, calls one of the functions of [`exported`], and reads the answer: a text in JSON
//! ([`json`]), or columns of numbers by their places in memory. A text has one instruction a line:
//!
//! | line | meaning |
//! |---|---|
//! | `choose kind piva` | a choice of the absorber, by its name and word |
//! | `set absorber.clearance 0.5` | a field, by its path as in a study file, and its value |
//! | `axis absorber.clearance 0.1 0.2` | values of a field for a map; the last axis varies fastest |
//! | `measure settling_time_5` | the measure of a map |
//!
//! What is computed is the same as in a study ([`iva_sweep`]): the same fields, checks, units and tables.

pub mod exported;
pub mod fused;
pub mod json;
mod map;
mod run;
mod scene;
mod words;
