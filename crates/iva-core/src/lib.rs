//! Physics and numerics of impact vibration absorbers.
//!
//! A free mass in a gap rides on a damped linear oscillator and takes energy from it by impacts.
//! The core runs such systems event by event, without an ODE solver:
//!
//! ```text
//!            ┌──────────────────────────────────────────────────────────┐
//!            ▼                                                          │
//!   flight ──► contact ──► impact ──► leaves the wall ──────────────────┤
//!  (closed    (certified)  (momentum,    │                              │
//!   form)                  restitution)  └► chatter ──► stick ──► release
//!                                          (tail summed)  (closed form)
//! ```
//!
//! | symbol | name | here |
//! |---|---|---|
//! | M, ωn, ζ, f | primary system, natural frequency, damping ratio, force | [`host`] |
//! | m, μ = m/M | absorber, mass ratio | [`siva`] |
//! | e | restitution | [`impact`] |
//! | d | clearance, half of the total play | [`system::System::clearance`] |
//! | y, w = ẏ | gap displacement, gap velocity (y = x₁ − x) | [`flight::GapPoint`] |
//! | τ | time in 1/ωn | [`system::Clock`] |
//!
//! Natural units throughout: ωn = 1, M = 1, lengths as the user gives them. Where things are:
//!
//! * [`system`] says what an absorber must tell of itself; [`siva`] is a free mass, [`piva`] a
//!   pendulum.
//! * [`real`] is the number that a motion is carried in: a double, one of twice the precision, one with
//!   derivatives.
//! * [`host`] is the structure: an [`oscillator`] and the [`force`] that drives it. It knows no absorber.
//! * [`taylor`] is the flight of a pendulum, [`flight`] what any smooth motion must say of itself,
//!   [`roots`] and [`contact`] the certified search for what ends it, [`impact`] and [`chatter`] what
//!   happens then.
//! * [`simulate`] is the event loop. It knows no absorber by name, and no absorber knows the loop.
//! * [`lanes`] is the same loop for many runs side by side. Its lanes carry copies of what a run changes in simple flights,
//!   and go back to the run for everything else. Lanes of free decays carry copies of what their measures change as well
//!   (`lanes/watch.rs`); lanes of driven runs log their flights, and measures read the log (`lanes/siva/driven/recorder.rs`).
//!   Free masses in plain doubles, the fast tier, have lanes of their own (`lanes/doubles.rs`).
//! * [`range`] holds the numbers that a run accepts.
//! * [`observe`] is how results leave it: [`measures`], [`peaks`], [`sample`] and, under force,
//!   [`steady`] watch a run, and so does [`extremes`]: how far the absorber goes.
//! * [`propagation`] watches as well: it estimates what errors have grown to.
//! * [`run`] does all of it in one call.
//! * [`theory`] holds steady states known in closed form; no run uses it.
//!
//! How to add a measure, a field or an absorber is told in `CONTRIBUTING.md` and `docs/adding-an-absorber.md`.
//!
//! **What is guaranteed.** No contact is stepped over and none invented: every stretch of flight
//! ends with a contact and proof that none came earlier, or with proof that there is none (see
//! [`roots`]). What double precision cannot decide is an *extremum* of y within 16 · 2⁻⁵³ d of a
//! wall: it counts as no contact and raises the run's `undecided` counter; every other one is
//! decided, to twice the precision where that is needed. The guarantee is about the motion as
//! carried: a grazing decided by the rounding of earlier impacts is decided as exactly as the
//! conditioning of the run allows, no better.
//!
//! Only + − × ÷ √ and the fused multiply-add take part in the motion, each rounded as IEEE 754 demands,
//! and the sines of the `libm` crate, made of the same (for the phase of a force and the angle of a
//! start), so that a run has the same bits on every machine of one architecture. Logarithms and π appear in measures and in
//! [`theory`] only.
//!
//! ```
//! use iva_core::{run::run, simulate::{Limits, Outcome}, siva::Siva, system::Start};
//!
//! let siva = Siva::new(0.15, 0.5, 0.6, 0.0)?; // μ, e, d, ζ
//! let start = Start { displacement: 1.0, ..Start::default() };
//! let run = run(&siva, &start, &Limits::new(20.0, 0.6))?;
//! assert_eq!(run.tally.outcome, Outcome::Finished);
//! // The first flight ends where x has fallen by d: τ = arccos(1 − d/x₀).
//! assert!((run.impacts[0].time - 0.4f64.acos()).abs() < 4e-16);
//! # Ok::<(), iva_core::error::Invalid>(())
//! ```

pub mod chatter;
pub mod compensated;
pub mod contact;
pub mod error;
pub mod extremes;
pub mod flight;
pub mod force;
pub mod host;
pub mod impact;
pub mod lanes;
mod limits;
pub mod measures;
pub mod observe;
pub mod oscillator;
pub mod peaks;
pub mod piva;
pub mod polynomial;
pub mod propagation;
mod quintic;
pub mod range;
pub mod real;
pub mod roots;
pub mod run;
pub mod sample;
mod settling;
pub mod simulate;
pub mod siva;
pub mod steady;
pub mod system;
pub mod taylor;
pub mod theory;
mod trigonometry;
