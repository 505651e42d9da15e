//! The modules of `iva-core-dual`, at the root of that crate by its `src/lib.rs`.

pub use iva_core::error;

pub mod chatter;
pub mod compensated;
pub mod contact;
pub mod flight;
pub mod force;
pub mod host;
pub mod impact;
pub(crate) mod limits;
pub mod measures;
pub mod observe;
pub mod oscillator;
pub mod peaks;
pub mod piva;
pub(crate) mod polynomial;
pub(crate) mod quintic;
pub mod range;
#[path = "real/dual.rs"]
pub mod real;
pub mod roots;
pub mod run;
pub mod sample;
pub(crate) mod settling;
pub mod simulate;
pub mod siva;
pub mod steady;
pub mod system;
pub mod taylor;
pub(crate) mod trigonometry;
