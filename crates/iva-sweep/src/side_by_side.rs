//! Points that are run side by side: free decays of single masses of which only the summary is asked.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use iva_core::lanes::{Decay, Decayed, decays};

use crate::doubles::design::Design;
use crate::doubles::point::Request;
use crate::doubles::rows::{self, Cell};
use crate::doubles::scene::Scene;
use crate::error::Invalid;
use crate::study::Study;

/// Runs points and hands out their rows of `summary`, in order; returns how many. `None`: these points
/// are to be run one by one.
///
/// # Errors
/// [`Invalid`] for a point that makes no valid scene.
pub(crate) fn summaries(
    study: &Study,
    points: Range<u64>,
    request: &Request,
    cancel: &AtomicBool,
    take: &mut dyn FnMut(&mut dyn Iterator<Item = Cell>),
) -> Result<Option<u64>, Invalid> {
    let Request { summary, impacts, episodes, envelope, wanted, steady, .. } = *request;
    let more = impacts || episodes || envelope || steady.strobes || study.errors;
    if more || !summary {
        return Ok(None);
    }
    let (mut designs, mut scenes) = (Vec::new(), Vec::new());
    for point in points.clone() {
        let design = study.design(point)?;
        let Some(decay) = decay(&design) else { return Ok(None) };
        scenes.push(decay);
        designs.push(design);
    }
    let mut results: Vec<Option<Decayed>> = vec![None; scenes.len()];
    let keep = &mut |index: usize, decayed: &Decayed| results[index] = Some(*decayed);
    decays(&scenes, wanted, Some(cancel), keep)?;
    let mut done = 0;
    let mut row = Vec::new();
    // After a cancellation the points before the first that was not begun.
    for (point, (design, result)) in points.zip(designs.iter().zip(&results)) {
        let Some((tally, values)) = result else { break };
        let swept = study.swept(point).map(Cell::Number);
        let estimated = [Cell::Null, Cell::Null];
        let cells = rows::summary(tally, values, None, estimated, study.measures, design);
        // Points are counted below 2^32 by `Study::points`.
        row.push(Cell::Point(point as u32));
        row.extend(swept);
        row.extend(cells);
        take(&mut row.drain(..));
        done += 1;
    }
    Ok(Some(done))
}

fn decay(design: &Design) -> Option<Decay> {
    match &design.scene {
        Scene::Siva { system, start } => {
            Some(Decay { siva: system.clone(), start: *start, limits: design.limits })
        }
        Scene::Piva { .. } => None,
    }
}
