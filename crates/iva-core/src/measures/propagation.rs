//! How errors grow along a run: an estimate of the error of every impact time.
//!
//! A small error of the state z = (x, ẋ, y, ẏ) (with W = b θ̇ in place of ẏ for a pendulum) is multiplied by
//! the derivative of the motion: of the flow along a segment, and of an impact by the saltation matrix
//!
//! ```text
//! S = J + (f⁺ − J f⁻) nᵀ/(nᵀ f⁻)
//! ```
//!
//! with J the derivative of the velocity jump, f the rates before and after, n the gradient of the gap (P. C.
//! Müller, Chaos, Solitons & Fractals 5 (1995) 1671–1681). The rounding and truncation errors of each segment
//! are treated as independent random errors: their covariance P changes over a segment to Φ P Φᵀ + Q. A
//! summed chatter conserves momentum and centre of mass, a release is smooth. The segments of a pendulum are its
//! steps; those of a free mass, whose motion is linear, are the whole motions between two events.
//!
//! Rounding errors are not independent where a wall is hit again and again: a chatter uses the same rounded
//! constants at every rebound. Such correlated errors are columns that add up, and join the covariance when
//! the other wall is met.
//!
//! The error of an impact time is the error of the distance over the approach speed. Close to a grazing it is
//! the largest change of the instant that the curvature allows. Once the error reaches 1/ωn the run has
//! forgotten its start, and nothing is estimated from there on.
//!
//! Those of several absorbers, on several modes or with friction, are in `propagation/lists.rs`.
//!
//! [`Differentiable`] is what a system tells about its derivatives, [`Errors`] the estimate.

pub use crate::absorber::derivatives::{Differentiable, free_mass_impact, free_mass_stick};
pub use errors::{Errors, TimeError};
pub(crate) use tangent::saltation;
pub use tangent::{Derivative, Tangent};
pub use tangents::Tangents;
pub use ways::{ByLists, ByTangents, Estimated, Way};

mod errors;
mod jumps;
mod lists;
mod tangent;
mod tangents;
mod ways;
