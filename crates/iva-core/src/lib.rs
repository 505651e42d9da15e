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
//! | e | restitution | [`impact`], [`absorber::LawAt`] |
//! | d | clearance, half of the total play | [`absorber::Absorber::clearance`] |
//! | y, w = ẏ | gap displacement, gap velocity (y = x₁ − x) | [`flight::GapPoint`] |
//! | τ | time in 1/ωn | [`absorber::Clock`] |
//!
//! Natural units throughout: ωn = 1, M = 1, lengths as the user gives them. The rooms, each of which knows only those
//! above it:
//!
//! | room | what is in it |
//! |---|---|
//! | [`number`] | doubles, double-doubles, numbers of twice the precision ([`real`]), arrays over lanes and the vectors of the machine |
//! | [`force`] | what drives the structure: harmonics, records, impulses |
//! | [`segment`] | a stretch of smooth motion ([`flight`]), its power series ([`taylor`]), and the search for the first event in it with proof ([`roots`], [`contact`], [`segment::slide`]) |
//! | [`host`] | the primary structure: an [`oscillator`] and what drives it; it knows no absorber |
//! | [`absorber`] | the interface of an absorber, which is three traits: what a run sees of the structure ([`OnStructure`](absorber::OnStructure)), the impact law ([`ImpactLaw`](absorber::ImpactLaw)), and the rest ([`Absorber`](absorber::Absorber)); a free mass ([`siva`]), a pendulum ([`piva`]); free masses and pendulums, up to 64 of them, with friction, springs, dashpots and weight at points of a structure with any number of modes ([`absorber::modal`]); the formulas of an impact, with a list of the places that apply them ([`impact`]), the laws of its restitution ([`absorber::restitution`]), and the formulas of infinitely many ([`chatter`]); the motion with the absorber stuck to its wall ([`absorber::ride`]) |
//! | [`engine`] | the event loop ([`simulate`]) and the interface of its observers ([`observe`]); it knows no absorber by name and no measure |
//! | [`measures`] | observers: decay and energies, peaks, [`steady`] states, [`extremes`], [`sample`]s, how errors grow in a run and its derivative ([`propagation`]); [`measures::pass`], the interface of measures that need one file only, such as [`measures::near_wall`]; [`summary`] joins them |
//! | [`run`] | making runs: one alone with the usual observers, in one call ([`run::run`]), or with all that a study can ask for ([`run::observed`]); many side by side in the lanes of vector instructions, with the same observers ([`run::side_by_side`]) |
//! | [`orbit`] | maps over whole cycles of a drive, one or many side by side, with derivatives ([`orbit::map`], [`orbit::iterate`]); periodic orbits ([`orbit::periodic`]) and their [`orbit::multipliers`]; how they change with a number of the scene ([`orbit::branch`], on the equations of [`orbit::chain`]), and curves of their special points over two numbers ([`orbit::curve`]); Lyapunov exponents ([`orbit::lyapunov`]), bifurcation diagrams ([`orbit::diagram`]), attractors ([`orbit::attractors`]) and their [`orbit::basins`] |
//! | [`theory`] | steady states known in closed form; no run uses it |
//!
//! [`range`] holds the ranges of numbers that a run accepts.
//!
//! Where to look (paths without `crates` or `tests` are those of this crate's `src`):
//!
//! | what | where |
//! |---|---|
//! | the impact law | the trait [`absorber::ImpactLaw`] is what the event loop asks; `absorber/siva/impact_law.rs` and `absorber/piva/impact_law.rs` implement it for a free mass and a pendulum; the formulas, and a list of the places that apply them, are in [`impact`]; laws by which e depends on the approach speed are in [`absorber::restitution`]; an example of another law is `tests/rust/src/speed_law.rs` |
//! | a new measure | one that is computed where it is asked for by name: one file with a [`measures::pass::Pass`] beside [`measures::near_wall`], and an entry in `crates/iva-sweep/src/columns/tables.rs`; one of every run: a field of [`measures::MeasureValues`]; `CONTRIBUTING.md` has all steps of both |
//! | a new field of a scene, for studies, sweeps and Python | a row in `crates/iva-sweep/src/fields.rs`, and its meaning in `crates/iva-sweep/src/engine/design.rs`; `CONTRIBUTING.md` has all steps |
//! | another kind of absorber | a file or folder in `absorber/` that implements [`absorber::OnStructure`], [`absorber::ImpactLaw`] and [`absorber::Absorber`], with the motions of flight and ride ([`flight::Motion`], [`flight::Curve`]); `docs/adding-an-absorber.md` has all steps |
//! | another structure | the same three traits, with the absorber that is on it: `tests/rust/src/two_modes.rs` has two modes; of the core's own, [`absorber::modal`] has many |
//! | a linear force between a free mass and its point, such as that of a spring | `absorber/modal/ties.rs`: the numbers of a [`Tie`](absorber::modal::Tie), what it stores, takes and pulls, and how it enters stiffness and damping of the structure, of which the mass is a coordinate |
//! | an event of a free mass beside impacts, such as a stop | a variant of [`segment::slide::Ends`] and of the endings in `engine/simulate/together.rs`; then every proof that nothing happens has to know it: `fast_path`, `clears` and `meets` of the motion, `coasts`, `others_wait` |
//! | friction in the gap | the equations and the law at walls: `absorber/modal/friction.rs`, the ends of slides: `absorber/modal/slides.rs`; the event loop: `engine/simulate/slide.rs`; what friction has done in a run: [`simulate::Rubbed`], `energy_friction` of [`measures::MeasureValues`] |
//! | a second absorber on one structure | [`absorber::modal`] has the list; one absorber is at hand in a state ([`Absorber::at_hand`](absorber::Absorber::at_hand)), and the event loop takes each in turn (`engine/simulate/together.rs`). Impacts and stick episodes tell the index of their absorber. Lanes and branches know one absorber |
//!
//! **Lanes.** A lane holds copies of the variables that change in simple flights, and hands everything else back to its
//! run. The flights of free masses are written once, for lanes and loop, generic in the numbers of the accuracy tier
//! (`absorber/siva/trial.rs`, `run/free_mass.rs`). Of pendulums under force, measures see only the steps
//! that may change a peak or an extreme; lanes add up the sums (`run/piva.rs`). Observers that look within flights see
//! every step of a pendulum (`run/piva/shown.rs`); lanes of free masses keep the flights until their runs show them
//! (`run/free_mass/shown.rs`).
//!
//! **Measures.** Those of a decay are functions of its log (`measures/decay.rs`), whether it ran alone or in a lane. The
//! log of a free mass holds the begins of its motions, which are damped sinusoids, also where gravity acts along the motion; that
//! of any other absorber the stretches in which x is monotonic. The measures of a free mass under one harmonic force are computed from a log of its flights
//! (`measures/forced.rs`).
//!
//! **What is guaranteed.** No contact is stepped over and none invented: every stretch of flight ends with a
//! contact and proof that none came earlier, or with proof that there is none (see [`roots`]). The one case
//! that double precision cannot decide is an *extremum* of y within 16 · 2⁻⁵³ d of a wall: it counts as no
//! contact and raises the run's `undecided` counter. Every other extremum is decided, in double-double where
//! that is needed. The guarantee is about the motion as computed: a grazing that depends on the rounding of
//! earlier impacts is decided as exactly as the conditioning of the run allows, no better.
//!
//! The motion is computed with + − × ÷ √ and the fused multiply-add only, each rounded as IEEE 754 demands,
//! and with the sines of the `libm` crate, built from the same operations (for the phase of a force and the
//! angle of a start). So a run has the same bits on every machine of one architecture. Logarithms and π
//! appear in measures, in exponents and entropies of [`orbit`], and in [`theory`] only.
//!
//! ```
//! use iva_core::{absorber::Start, run::run, simulate::{Limits, Outcome}, siva::Siva};
//!
//! let siva = Siva::new(0.15, 0.5, 0.6, 0.0)?; // μ, e, d, ζ
//! let start = Start { displacement: 1.0, ..Start::default() };
//! let run = run(&siva, &start, &Limits::new(20.0, 0.6))?;
//! assert_eq!(run.tally.outcome, Outcome::Finished);
//! // The first flight ends where x has fallen by d: τ = arccos(1 − d/x₀).
//! assert!((run.impacts[0].time - 0.4f64.acos()).abs() < 4e-16);
//! # Ok::<(), iva_core::error::Invalid>(())
//! ```

// Elsewhere a fused multiply-add would be a call of the C library. Rustdoc, which is not told the baseline, compiles
// no code.
#[cfg(all(target_arch = "x86_64", not(target_feature = "fma"), not(doc)))]
compile_error!("compile with RUSTFLAGS=-Ctarget-cpu=x86-64-v3, as .cargo/config.toml says");

pub mod absorber;
pub mod engine;
pub mod error;
pub mod force;
pub mod host;
pub mod measures;
pub mod number;
pub mod orbit;
pub mod range;
pub mod run;
pub mod segment;
pub mod theory;

// What users name, without its room.
pub use absorber::{chatter, impact, piva, siva};
pub use engine::{observe, simulate};
pub use host::oscillator;
pub use measures::{extremes, peaks, propagation, sample, steady, summary};
pub use number::{compensated, real};
pub use segment::{contact, flight, polynomial, roots, taylor};
