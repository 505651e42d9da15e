//! The numbers of a motion: doubles, double-doubles, numbers with derivatives, arrays of them over
//! lanes, and the vector instructions that lanes run in.

pub(crate) mod arrays;
pub mod clock;
pub mod compensated;
pub mod real;
pub(crate) mod root;
pub mod series;
pub(crate) mod trigonometry;
pub(crate) mod vectors;
