//! A stretch of smooth motion: what a motion is ([`flight`]), its power series, and the first event in it, found and
//! proved to be the first ([`contact`], [`roots`]).

pub mod contact;
pub(crate) mod enclosure;
pub mod flight;
pub mod place;
pub mod polynomial;
pub(crate) mod quadrature;
pub(crate) mod quintic;
pub mod roots;
pub mod slide;
pub mod taylor;
