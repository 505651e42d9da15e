//! What a study is about, in two or three lines: mistaken units show here before anything is run.

use std::fmt::Write;

use iva_sweep::design::Design;
use iva_sweep::study::Study;
use iva_sweep::units::UnitSystem;

use crate::cell::short;
use crate::layout::wrap;

/// Points looked at for the ranges, the corners of most grids among them.
const LOOKED_AT: u64 = 512;

/// Structure, absorber and start of the points of a valid study, as ranges where they are swept.
pub(crate) fn describe(study: &Study, points: u64, units: UnitSystem) -> String {
    let last = points.saturating_sub(1);
    let step = points.div_ceil(LOOKED_AT).max(1);
    let looked_at = (0..points).step_by(usize::try_from(step).unwrap_or(1)).chain([last]);
    let designs: Vec<Design> = looked_at.filter_map(|point| study.design(point).ok()).collect();
    let range = |value: &dyn Fn(&Design) -> f64| {
        let values = designs.iter().map(value);
        let (low, high) = values
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        if low == high {
            short(low, 4)
        } else {
            format!("{} … {}", short(low, 4), short(high, 4))
        }
    };
    let damping = range(&|design| design.parameters.damping_ratio());
    let mut out = String::new();
    let structure = match units {
        UnitSystem::Natural => format!("Structure: damping ratio {damping}"),
        _ => {
            let hertz = range(&|design| design.scale.natural_frequency / std::f64::consts::TAU);
            format!("Structure: {hertz} Hz, damping ratio {damping}")
        }
    };
    let mass = range(&|design| design.parameters.mass_ratio());
    let restitution = range(&|design| design.parameters.restitution());
    // Writing to a String cannot fail.
    let _ = writeln!(out, "{}", wrap(&structure));
    let absorber = format!("Absorber: mass ratio {mass}, restitution {restitution}");
    let _ = writeln!(out, "{}", wrap(&absorber));
    let start = range(&|design| design.start.displacement);
    let clearance = range(&|design| design.parameters.clearance());
    let relative = range(&|design| design.parameters.clearance() / design.start.displacement.abs());
    let unit = if units == UnitSystem::Si { " m" } else { "" };
    let gap = if designs.iter().all(|design| design.start.displacement != 0.0) {
        format!(
            "Start: displacement {start}{unit}; clearance (half of the play) {clearance}{unit}, \
             {relative} of it"
        )
    } else {
        format!("Start: displacement {start}{unit}; clearance {clearance}{unit}")
    };
    let _ = writeln!(out, "{}", wrap(&gap));
    if designs.iter().all(at_rest) {
        let _ = writeln!(out, "{}", wrap(NOTHING_MOVES));
    }
    out
}

/// Said where no point of a study has any motion.
pub(crate) const NOTHING_MOVES: &str =
    "Nothing moves: the start has neither displacement nor velocity. Give start.displacement.";

/// True if a start holds no energy.
pub(crate) fn at_rest(design: &Design) -> bool {
    let start = &design.start;
    start.displacement == 0.0 && start.velocity == 0.0 && start.gap_velocity == 0.0
}
