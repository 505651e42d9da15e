//! Shared code of the tests: double-double numbers, an independent simulator, the reference event lists, and
//! the unit in which rounding errors are judged.
//!
//! The crate holds nothing but tests, so it may panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

pub mod case;
pub mod composed;
pub mod covered;
pub mod dd;
pub mod driven;
pub mod flight;
pub mod laws;
pub mod list;
pub mod modal;
pub mod naive;
pub mod oracle;
pub mod pendulum;
pub mod pendulum_list;
pub mod reference;
pub mod rng;
pub mod speed_law;
pub mod stress;
pub mod timeline;
pub mod two_modes;

use proptest::test_runner::{Config, RngSeed};

/// A recorded run of the SIVA.
pub type Run = iva_core::run::Run<iva_core::siva::SivaState>;

/// Unit roundoff of double precision, 2⁻⁵³.
pub const U: f64 = f64::EPSILON / 2.0;

/// An error in rounding units: |error| / (2⁻⁵³ (max(condition, 1) + τ)).
pub fn units(error: f64, condition: f64, time: f64) -> f64 {
    error.abs() / (U * (condition.max(1.0) + time))
}

/// Largest error of an event time, in rounding units.
pub const UNITS_ALLOWED: f64 = 6.0;

/// Every how many cases of a test are tried: all of them in `make stress`, which sets `EVERY_CASE`.
pub fn stride() -> usize {
    if std::env::var_os("EVERY_CASE").is_some() { 1 } else { 3 }
}

/// How many of the cases of a test are tried.
pub fn some(all: usize) -> usize {
    all.div_ceil(stride())
}

/// Settings of the property tests with a fixed seed, so that failures are reproducible (`PROPTEST_RNG_SEED`
/// and `PROPTEST_CASES` override them).
pub fn cases(cases: u32) -> Config {
    let mut config = Config { failure_persistence: None, ..Config::default() };
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = cases.div_ceil(stride() as u32);
    }
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(20_240_611);
    }
    config
}

/// As [`cases`], for properties that reject most of the random inputs.
pub fn rejecting(count: u32) -> Config {
    let config = cases(count);
    Config { max_global_rejects: config.cases.saturating_mul(100), ..config }
}
