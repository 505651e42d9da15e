//! The integration tests of the Rust crates, in one program because linking takes longer than compiling.
//!
//! One file alone: `cargo test --release -p iva-tests planted::`.

mod absorber_fields;
mod alone;
mod arcs;
mod bouncing_ball;
mod broken_law;
mod closed_forms;
mod continued;
mod decisions;
mod driven_pendulums;
mod errors;
mod every_field;
mod extremes;
mod fast_errors;
mod fast_tier;
mod flight;
mod forced;
mod gradients;
mod impulses;
mod inclined;
mod invariants;
mod lanes;
mod limits;
mod measures;
mod near_wall;
mod neighbours;
mod orbit;
mod piva;
mod piva_flight;
mod planted;
mod record_extremes;
mod records;
mod reference_events;
mod regressions;
mod samples;
mod second_opinion;
mod starts_at_jumps;
mod steady;
mod stress;
mod stress_inputs;
mod sweep_tables;
mod theory;
mod third_absorber;
mod unlike_walls;
mod verified;
