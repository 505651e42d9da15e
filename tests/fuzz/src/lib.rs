//! What the fuzz targets share: inputs made of any bits, and what must hold of the answer.
//!
//! A target fails by a panic, which is a failed assertion or a fault of what it calls, or by taking too
//! long. What is refused must be refused in one sentence, see [`refusal`].

pub mod judge;
pub mod refusal;
pub mod scene;
pub mod study;
pub mod tables;
pub mod walls;
