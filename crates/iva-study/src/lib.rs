//! Studies: reading them from TOML text, and running their sweeps into a folder.
//!
//! In the order of a sweep: [`study_file`] reads the text, with the place of every error in [`error`]
//! (`value`, `axes`, [`sampling`], `forces`, `structure` and [`record_file`] read its sections, [`source`] keeps the
//! places of keys, [`report`] holds the settings of the table of best points) → `named` gives file names to points
//! and records made in a program, [`resolved`] writes the study with every default filled in → [`run_sweep`]
//! runs it part by part into a folder of [`iva_store`]; `changes` lists differences from the study in a folder. [`examples`] are the studies that come with the program.
//!
//! Nothing is printed and no signal is handled here: the caller of a sweep passes a [`run_sweep::Watch`], which
//! receives the progress, and a flag that cancels it.

mod absorbers;
mod axes;
mod changes;
pub mod error;
pub mod examples;
mod forces;
mod named;
pub mod record_file;
pub mod report;
pub mod resolved;
pub mod run_sweep;
pub mod sampling;
mod selection;
pub mod source;
mod structure;
pub mod study_file;
pub mod threads;
mod value;

pub use error::Error;
pub use study_file::{STUDY_VERSION, StudyFile, parse_study, read_study};
