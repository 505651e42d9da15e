//! Points that are run side by side: free decays of which only the summary is asked.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use iva_core::lanes::{Decay, Decayed, SideBySide, decays};

use crate::done::Done;
use crate::doubles::design::Design;
use crate::doubles::point::Request;
use crate::doubles::rows::{self, Cell};
use crate::doubles::scene::Scene;
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
            Scene::Siva { system, start } => {
                Some(Decay { system: system.clone(), start: *start, limits: design.limits })
            }
            Scene::Piva { .. } => None,
        }),
        Scene::Piva { .. } => together(asked, points, take, |design| match &design.scene {
            Scene::Piva { system, start, .. } if system.force().is_none() => {
                Some(Decay { system: system.clone(), start: *start, limits: design.limits })
            }
            _ => None,
        }),
    }
}

fn together<S: SideBySide>(
    asked: &Asked<'_>,
    points: Range<u64>,
    take: Take<'_>,
    decay: impl Fn(&Design) -> Option<Decay<S>>,
) -> Result<Option<Done>, Invalid> {
    let Asked { study, request, cancel } = *asked;
    let (mut designs, mut scenes) = (Vec::new(), Vec::new());
    for point in points.clone() {
        let design = study.design(point)?;
        let Some(decay) = decay(&design) else { return Ok(None) };
        scenes.push(decay);
        designs.push(design);
    }
    let mut results: Vec<Option<Decayed<S>>> = vec![None; scenes.len()];
    let keep = &mut |index: usize, decayed: &Decayed<S>| results[index] = Some(*decayed);
    decays(&scenes, request.wanted, Some(cancel), keep)?;
    let mut done = Done::default();
    // After a cancellation the points before the first that was not begun.
    for (point, (design, result)) in points.zip(designs.iter().zip(&results)) {
        let Some((tally, values)) = result else { break };
        take(&mut rows::RunRow::new(design, tally, values).cells(study, point));
        done += Done::run(tally.outcome.name(), tally.work);
    }
    Ok(Some(done))
}
