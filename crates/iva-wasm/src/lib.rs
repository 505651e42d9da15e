//! The simulator for the explorer, compiled to WebAssembly.
//!
//! JavaScript writes a text to a buffer, calls one of the functions of [`exported`], and reads the answer: a text in JSON
//! ([`json`]), or columns of numbers by their places in memory. A text has one instruction a line:
//!
//! | line | meaning |
//! |---|---|
//! | `choose kind piva` | an absorber of this kind, or none; after it other choices of it, by their names and words |
//! | `entry points named top 0.1 0.2` | an entry of a structure with several modes, or a row or point of one: its name, its form (`mode`, `name`, `names`, `numbers`, `row`, `named`), and what it holds; %20 is a space in a name |
//! | `force`, `record base_acceleration 0 1 0.5 2` | a force; a recorded one has its times and values in turns |
//! | `table 0 0.1 0.9 1 0.6` | the table of the restitution of an absorber: approach speeds and values in turns |
//! | `starts gap_velocity 0 0.1` | a field of the start, with a number for each absorber or unit |
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
