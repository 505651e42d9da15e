//! Runs as plain lists of events, for the comparison of two runs.

use crate::{
    Run, UNITS_ALLOWED,
    dd::Dd,
    oracle::{self, Event, Kind, Scene},
    units,
};
use iva_core::{run::run, simulate::Limits};

/// One event of a run of the simulator under test.
#[derive(Debug, Clone, Copy)]
pub struct Mark {
    /// Kind of the event.
    pub kind: Kind,
    /// Instant, in 1/ωn.
    pub time: f64,
    /// Wall, ±1.
    pub wall: f64,
    /// For an impact: velocities of the primary and of the absorber, and gap velocity, just before it.
    pub velocities: Option<[f64; 3]>,
}

/// Impacts with an approach speed above `threshold`, sticks and releases in order of time. At one instant an
/// impact comes before the stick that it ends in.
pub fn marks<S>(run: &iva_core::run::Run<S>, threshold: f64) -> Vec<Mark> {
    let mut list: Vec<Mark> = Vec::new();
    for impact in &run.impacts {
        if impact.gap_velocity_before.abs() > threshold {
            list.push(Mark {
                kind: Kind::Impact,
                time: impact.time,
                wall: impact.wall.sign(),
                velocities: Some([
                    impact.velocity_before,
                    impact.absorber_velocity_before(),
                    impact.gap_velocity_before,
                ]),
            });
        }
    }
    for episode in &run.episodes {
        let wall = episode.wall.sign();
        let mut mark = |kind, time| list.push(Mark { kind, time, wall, velocities: None });
        mark(Kind::Stick, episode.stick_time);
        if let Some(time) = episode.release_time {
            mark(Kind::Release, time);
        }
    }
    // The sort is stable: impacts, pushed first, stay before sticks of the same instant.
    list.sort_by(|a, b| a.time.total_cmp(&b.time));
    list
}

/// True if an event of the oracle belongs to the list with impacts above `threshold`.
pub fn listed(event: &Event, threshold: f64) -> bool {
    event.kind != Kind::Impact || event.gap_velocity[0].abs().hi > threshold
}

/// An approach speed around 1e-8 that differs by at least 5 % from that of every impact.
pub fn clear_threshold(events: &[Event]) -> f64 {
    let mut threshold = 1e-8;
    let near = |threshold: f64| {
        events.iter().any(|e| {
            e.kind == Kind::Impact && (e.gap_velocity[0].abs().hi / threshold - 1.0).abs() < 0.05
        })
    };
    while near(threshold) {
        threshold *= 1.13;
    }
    threshold
}

/// Largest condition up to which two runs are compared event by event: their states then differ by 1e-6 at
/// most.
pub const WORST_CONDITION: f64 = 1e9;

/// Compares events with the true ones, one by one, while the condition is at most [`WORST_CONDITION`]. The
/// comparison ends at the first event above it. It also ends at an event that differs, if changes of the
/// inputs by sixteen roundings already give other events up to there. `shift` is added to the times of the
/// true events; `share` multiplies the six units allowed. Returns the number of events compared.
///
/// # Errors
/// The first difference.
pub fn compare(
    scene: &Scene,
    truth: &[Event],
    marks: &[Mark],
    threshold: f64,
    shift: f64,
    share: f64,
) -> Result<usize, String> {
    let conditions = oracle::conditions(scene, truth, |e| e.time);
    let kept = truth.iter().enumerate().filter(|(_, e)| listed(e, threshold));
    let mut compared = 0;
    let mut marks = marks.iter();
    for (index, event) in kept {
        if conditions[index] > WORST_CONDITION {
            return Ok(compared);
        }
        let mark = marks.next();
        let time = (event.time + shift).value();
        let same = mark.is_some_and(|m| {
            (m.kind, m.wall) == (event.kind, event.wall)
                && units((Dd::from(m.time) - event.time - shift).value(), conditions[index], time)
                    <= share * UNITS_ALLOWED
        });
        if !same {
            if oracle::fragile_from(scene, truth) <= index {
                return Ok(compared);
            }
            let off = mark.map(|m| (Dd::from(m.time) - event.time - shift).value());
            let allowed = conditions[index].max(1.0) + time;
            return Err(format!(
                "event {index}: {:?} at wall {} at {time} expected, found {mark:?}, off by {:?} units (condition {:e})",
                event.kind,
                event.wall,
                off.map(|o| o.abs() / (crate::U * allowed)),
                conditions[index],
            ));
        }
        compared += 1;
    }
    // An additional event would be left over, unless it lies at the very end of the run.
    let end = scene.duration + shift;
    match marks.find(|m| m.time < end - 1e-6) {
        Some(extra) if oracle::fragile_from(scene, truth) >= truth.len() => {
            Err(format!("an event that does not exist: {extra:?}"))
        }
        _ => Ok(compared),
    }
}

/// Runs a scene of the oracle in the simulator under test, with all impacts above 1e-9 listed.
pub fn simulated(scene: &Scene) -> Run {
    let limits = Limits { chatter_floor: 1e-9, ..Limits::new(scene.duration, scene.clearance.hi) };
    run(&scene.absorber(), &scene.begin(), &limits).expect("a valid scene")
}
