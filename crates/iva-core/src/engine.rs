//! The event loop ([`simulate`]) and the interface of those who watch it ([`observe`]). It knows no absorber by name and no
//! measure. Clock, counts and limits of a run are its `Progress`, which the loop and the lanes carry alike.

pub(crate) mod counts;
mod limits;
pub mod observe;
pub(crate) mod progress;
pub mod simulate;
mod tally;
