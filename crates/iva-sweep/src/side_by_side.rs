//! Points that are run side by side: those of which only the summary is asked.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use iva_core::lanes::{self, Ended, Job, SideBySide};
use iva_core::measures::MeasureValues;
use iva_core::steady::{SteadyValues, SteadyWanted};
use iva_core::system::System;

use crate::done::Done;
use crate::engine::design::Design;
use crate::engine::point::Request;
use crate::engine::rows::{self, Cell};
use crate::engine::scene::Scene;
use crate::error::Invalid;
use crate::study::Study;

/// What the summaries of some points are asked for with.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    pub study: &'a Study,
    pub request: &'a Request,
    pub cancel: &'a AtomicBool,
}

type Take<'a> = &'a mut dyn FnMut(&mut dyn Iterator<Item = Cell>);

/// Runs points and hands out their rows of `summary`, in order; returns what they came to. `None`: these points
/// are to be run one by one.
///
/// # Errors
/// [`Invalid`] for a point that makes no valid scene.
pub(crate) fn summaries(
    asked: &Asked<'_>,
    points: Range<u64>,
    take: Take<'_>,
) -> Result<Option<Done>, Invalid> {
    let Request { summary, impacts, episodes, envelope, steady, .. } = *asked.request;
    let more = impacts || episodes || envelope || steady.strobes || asked.study.errors;
    if more || !summary || points.is_empty() {
        return Ok(None);
    }
    match asked.study.design(points.start)?.scene {
        Scene::Siva { .. } => together(asked, points, take, |design| match &design.scene {
            Scene::Siva { system, start } => Some(job(design, system, start, ())),
            _ => None,
        }),
        Scene::DrivenSiva { .. } => together(asked, points, take, |design| match &design.scene {
            Scene::DrivenSiva { system, start } => {
                // Impulses alone leave a decay.
                let steady = if system.is_driven() { steady } else { SteadyWanted::default() };
                Some(job(design, system, start, (steady, design.window)))
            }
            _ => None,
        }),
        Scene::Piva { .. } => together(asked, points, take, |design| match &design.scene {
            Scene::Piva { system, start, .. } if system.force().is_none() => {
                Some(job(design, system, start, ()))
            }
            _ => None,
        }),
    }
}

fn job<S: SideBySide + Clone>(
    design: &Design,
    system: &S,
    start: &S::Start,
    also: S::Also,
) -> Job<S> {
    Job { system: system.clone(), start: *start, limits: design.limits, also }
}

/// What was measured of a run.
trait Measured {
    fn decay(&self) -> &MeasureValues;
    fn steady(&self) -> Option<&SteadyValues>;
}

impl Measured for MeasureValues {
    fn decay(&self) -> &MeasureValues {
        self
    }
    fn steady(&self) -> Option<&SteadyValues> {
        None
    }
}

impl Measured for (MeasureValues, SteadyValues) {
    fn decay(&self) -> &MeasureValues {
        &self.0
    }
    fn steady(&self) -> Option<&SteadyValues> {
        Some(&self.1)
    }
}

fn together<S: SideBySide<Values: Measured>>(
    asked: &Asked<'_>,
    points: Range<u64>,
    take: Take<'_>,
    job: impl Fn(&Design) -> Option<Job<S>>,
) -> Result<Option<Done>, Invalid> {
    let Asked { study, request, cancel } = *asked;
    let (mut designs, mut jobs) = (Vec::new(), Vec::new());
    for point in points.clone() {
        let design = study.design(point)?;
        let Some(job) = job(&design) else { return Ok(None) };
        jobs.push(job);
        designs.push(design);
    }
    let mut results: Vec<Option<Ended<S>>> = vec![None; jobs.len()];
    let keep = &mut |index: usize, ended: &Ended<S>| results[index] = Some(ended.clone());
    lanes::run(&jobs, request.wanted, Some(cancel), keep)?;
    let mut done = Done::default();
    // After a cancellation the points before the first that was not begun.
    for (point, (design, result)) in points.zip(designs.iter().zip(&results)) {
        let Some((tally, values)) = result else { break };
        let settled = request.settled(design, values.steady(), cancel)?;
        let row = rows::RunRow { settled, ..rows::RunRow::new(design, tally, values.decay()) };
        take(&mut row.cells(study, point));
        done += Done::run(tally.outcome.name(), tally.work);
    }
    Ok(Some(done))
}
