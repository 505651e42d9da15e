//! Points that are run side by side: those of a study that wants the summary only.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use iva_core::lanes::{self, Ended, Job, SideBySide};

use crate::done::Done;
use crate::engine::design::Design;
use crate::engine::point::Request;
use crate::engine::rows::{self, Cell};
use crate::engine::scene::{Scene, with_system};
use crate::error::Invalid;
use crate::study::Study;

/// The arguments common to all calls of [`summaries`] in a sweep.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    pub study: &'a Study,
    pub request: &'a Request,
    pub cancel: &'a AtomicBool,
}

type Take<'a> = &'a mut dyn FnMut(&mut dyn Iterator<Item = Cell>);

/// Runs points and hands out their rows of `summary`, in order; returns their counts. `None`: these points
/// have to be run one by one.
///
/// # Errors
/// [`Invalid`] for a point that makes no valid scene.
pub(crate) fn summaries(
    asked: &Asked<'_>,
    points: Range<u64>,
    take: Take<'_>,
) -> Result<Option<Done>, Invalid> {
    let Request { summary, impacts, episodes, envelope, ref steady, .. } = *asked.request;
    let more = impacts || episodes || envelope || steady.strobes || asked.study.errors;
    if more || !summary || points.is_empty() {
        return Ok(None);
    }
    let design = asked.study.design(points.start)?;
    if with_system!(&design.scene, |system, _start| asked.request.wants_extremes(system)) {
        return Ok(None);
    }
    match design.scene {
        Scene::Siva { .. } => together(asked, points, take, |design| match &design.scene {
            Scene::Siva { system, start } => Some((system.clone(), *start)),
            _ => None,
        }),
        Scene::DrivenSiva { .. } => together(asked, points, take, |design| match &design.scene {
            Scene::DrivenSiva { system, start, .. } => Some((system.clone(), *start)),
            _ => None,
        }),
        Scene::Piva { .. } => together(asked, points, take, |design| match &design.scene {
            Scene::Piva { system, start, .. } => Some((system.clone(), *start)),
            _ => None,
        }),
        Scene::Alone { .. } => together(asked, points, take, |design| match &design.scene {
            Scene::Alone { system, start } => Some((system.clone(), *start)),
            _ => None,
        }),
        Scene::DrivenAlone { .. } => together(asked, points, take, |design| match &design.scene {
            Scene::DrivenAlone { system, start } => Some((system.clone(), *start)),
            _ => None,
        }),
    }
}

fn together<S: SideBySide>(
    asked: &Asked<'_>,
    points: Range<u64>,
    take: Take<'_>,
    scene: impl Fn(&Design) -> Option<(S, S::Start)>,
) -> Result<Option<Done>, Invalid> {
    let Asked { study, request, cancel } = *asked;
    let (mut designs, mut jobs) = (Vec::new(), Vec::new());
    let mut designer = study.designer();
    for point in points.clone() {
        let design = designer.design(point)?;
        let Some((system, start)) = scene(&design) else { return Ok(None) };
        let steady = request.steady_of(&system).map(|wanted| (wanted, design.window));
        let Design { begin, limits, tier, .. } = design;
        jobs.push(Job { system, start, begin, limits, steady, tier });
        designs.push(design);
    }
    let mut results: Vec<Option<Ended<S>>> = vec![None; jobs.len()];
    let keep = &mut |index: usize, ended: &Ended<S>| results[index] = Some(*ended);
    lanes::run(&jobs, request.wanted, Some(cancel), keep)?;
    let mut done = Done::default();
    // After a cancellation only the points before the first one that had not begun.
    for (index, (point, (design, result))) in points.zip(designs.iter().zip(&results)).enumerate() {
        let Some((tally, measures, steady)) = result else { break };
        let settled = request.settled(design, steady.as_ref(), cancel)?;
        let tier = S::tier(&jobs[index]);
        let row = rows::RunRow { settled, tier, ..rows::RunRow::new(design, tally, measures) };
        take(&mut row.cells(&request.columns, &study.swept(point), point));
        done += Done::run(tally.outcome.name(), tally.work);
    }
    Ok(Some(done))
}
