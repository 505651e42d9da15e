//! Results on disk: the folder of a result, its manifest, and its tables as Parquet, Arrow or CSV.
//!
//! In the order of a sweep: [`taken`] looks at a folder and takes it, ready for the first missing part →
//! [`part_files`] are the files of a part while they are written, each a [`table_file`] → [`sweep_folder`]
//! enters complete parts in the [`manifest`]. [`output`] is the folder of a single run. [`inputs`] are
//! files that a study refers to and that are kept beside its tables, [`points_file`] those of points.
//! Below them: `directory` holds a folder by a handle that follows no link, `folder` says what in it is
//! ours, `claim` keeps other processes out of it, `exchange` replaces one result by another, and `claims`
//! checks what a file of others claims to hold before it is decoded.
//!
//! What a study says in TOML is not known here: its text is kept and handed back. What cannot be done is
//! an [`Error`] that carries data; the words for what the user can do about it come from the front that
//! shows it, see [`remedy`].

mod caught;
mod claim;
mod claims;
mod created;
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

#[cfg(any(test, feature = "faults"))]
pub use directory::faults;
pub use error::Error;
pub use visible::visible;
