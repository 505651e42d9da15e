//! The numbers of a motion: doubles, double-doubles, numbers with derivatives, and arrays of them over lanes.

pub(crate) mod arrays;
pub mod clock;
pub mod compensated;
pub mod real;
pub(crate) mod root;
pub mod series;
pub(crate) mod trigonometry;
