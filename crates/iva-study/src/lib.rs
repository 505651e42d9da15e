//! Studies: TOML text → what to run, and running it into a folder.
//!
//! In the order of a sweep: [`study_file`] reads the text, with the place of every error in [`error`]
//! (`value`, `axes`, [`sampling`], `forces` and [`record_file`] read what stands in it, [`source`] keeps the
//! places, [`report`] says what is to be shown) → [`resolved`] writes the study with every default filled
//! in, `named` gives names to points and records that no file holds → [`run_sweep`] runs it part by part
//! into a folder of [`iva_store`], and compares it by `changes` with the study that a folder holds.
//!
//! Nothing is printed here, and no signal is listened to: who runs a sweep hands in a
//! [`run_sweep::Watch`] that is told how far it is, and a flag that ends it.

mod axes;
mod changes;
pub mod error;
mod forces;
mod named;
pub mod record_file;
pub mod report;
pub mod resolved;
pub mod run_sweep;
pub mod sampling;
pub mod source;
pub mod study_file;
pub mod threads;
mod value;

pub use error::Error;
pub use study_file::{STUDY_VERSION, StudyFile, parse_study, read_study};
