//! The event loop ([`simulate`]) and the interface of those who watch it ([`observe`]). It knows no absorber by name and no
//! measure.

mod limits;
pub mod observe;
pub mod simulate;
mod tally;
