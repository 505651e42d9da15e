//! Results on disk: the folder of a result, its manifest, and its tables as Parquet, Arrow or CSV.
//!
//! In the order of a sweep: [`taken`] checks a folder and locks it for a sweep → [`part_files`] are the files
//! of a part while they are written, each a [`table_file`] → [`sweep_folder`] enters complete parts in the
//! [`manifest`]. [`output`] is the folder of a single run. [`inputs`] are points and records that are kept
//! beside the tables, [`points_file`] reads and writes files of points. Below them: `directory` is an open
//! folder in which no link is followed, [`folder`] knows the layout of a result and which files belong to it,
//! `claim` locks it against other processes, `exchange` replaces one result by another, `claims` checks the
//! sizes that a file states before it is decoded, and `csv` reads and writes text with commas.
//!
//! The text of a study is kept and handed back; its TOML is not read here. A failure is an [`Error`] that
//! carries data; the names of options in the advice to the user come from the front, see [`remedy`].

mod caught;
mod claim;
mod claims;
mod created;
mod csv;
mod directory;
pub mod error;
mod exchange;
pub mod fault;
pub mod folder;
mod hidden;
pub mod inputs;
pub mod manifest;
pub mod output;
pub mod part_files;
pub mod points_file;
pub mod regular_file;
pub mod remedy;
pub mod sweep_folder;
pub mod table_file;
pub mod taken;
mod visible;

#[doc(hidden)]
pub use directory::faults;
pub use error::Error;
pub use visible::visible;
