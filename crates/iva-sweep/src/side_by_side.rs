//! Points that are run side by side: those of a study that wants the summary only.
//!
//! Whether a point goes side by side, and in which tier, is decided by the study and by the point alone. The
//! points of a part are grouped after that, one group for each kind of scene, so that no row depends on what
//! else is in its part.

use std::sync::atomic::AtomicBool;

use iva_core::lanes::{self, Job, SideBySide, Tier};
use iva_core::measures::MeasureValues;
use iva_core::simulate::Tally;
use iva_core::steady::SteadyValues;

use crate::done::Done;
use crate::engine::design::Design;
use crate::engine::point::Request;
use crate::engine::rows::{Cell, RunRow};
use crate::engine::scene::Scene;
use crate::error::Invalid;
use crate::study::Study;

/// The result of a run, for any kind of scene.
#[derive(Debug, Clone)]
pub(crate) struct Ended {
    /// How it ended, and its counts.
    pub tally: Tally<()>,
    /// Its measures.
    pub measures: MeasureValues,
    /// Those of its steady state; `None` where they were not asked for.
    pub steady: Option<SteadyValues>,
    /// The tier that made it.
    pub tier: Tier,
}

impl Ended {
    /// Hands out the row of `summary`; returns the counts of the run.
    ///
    /// # Errors
    /// As [`Request::settled`].
    pub fn summarise(
        &self,
        study: &Study,
        point: u64,
        design: &Design,
        request: &Request,
        cancel: &AtomicBool,
        take: &mut dyn FnMut(&mut dyn Iterator<Item = Cell>),
    ) -> Result<Done, Invalid> {
        let Self { tally, measures, steady, tier } = self;
        let settled = request.settled(design, steady.as_ref(), cancel)?;
        let row = RunRow { settled, tier: *tier, ..RunRow::new(design, *tally, measures) };
        take(&mut row.cells(&request.columns, &study.swept(point), point));
        Ok(Done::run(tally.outcome.name(), tally.work))
    }
}

/// Runs those of the designs that can go side by side. The results are in the order of the designs; `None`:
/// the design has to be run by itself, or had not begun when the sweep was cancelled.
///
/// # Errors
/// [`Invalid`] for a start or limits that the core refuses.
pub(crate) fn run(
    designs: &[Design],
    request: &Request,
    cancel: &AtomicBool,
) -> Result<Vec<Option<Ended>>, Invalid> {
    let mut part = Part { designs, request, cancel, ended: vec![None; designs.len()] };
    if request.summary_alone() {
        part.run(|scene| match scene {
            Scene::Siva { system, start } => Some((system.clone(), *start)),
            _ => None,
        })?;
        part.run(|scene| match scene {
            Scene::DrivenSiva { system, start, .. } => Some((system.clone(), *start)),
            _ => None,
        })?;
        part.run(|scene| match scene {
            Scene::Piva { system, start, .. } => Some((system.clone(), *start)),
            _ => None,
        })?;
        part.run(|scene| match scene {
            Scene::Alone { system, start } => Some((system.clone(), *start)),
            _ => None,
        })?;
        part.run(|scene| match scene {
            Scene::DrivenAlone { system, start } => Some((system.clone(), *start)),
            _ => None,
        })?;
    }
    Ok(part.ended)
}

/// A part of a sweep in progress.
struct Part<'a> {
    designs: &'a [Design],
    request: &'a Request,
    cancel: &'a AtomicBool,
    ended: Vec<Option<Ended>>,
}

impl Part<'_> {
    /// Runs the designs of one kind of scene.
    fn run<S: SideBySide>(
        &mut self,
        scene: impl Fn(&Scene) -> Option<(S, S::Start)>,
    ) -> Result<(), Invalid> {
        let Self { designs, request, cancel, ended } = self;
        let (mut jobs, mut places) = (Vec::new(), Vec::new());
        for (place, design) in designs.iter().enumerate() {
            let Some((system, start)) = scene(&design.scene) else { continue };
            if request.wants_extremes(&system) {
                continue;
            }
            let steady = request.steady_of(&system).map(|wanted| (wanted, design.window));
            let Design { begin, limits, tier, .. } = *design;
            jobs.push(Job { system, start, begin, limits, steady, tier });
            places.push(place);
        }
        if jobs.is_empty() {
            return Ok(());
        }
        lanes::run(&jobs, request.wanted, Some(cancel), &mut |index, (tally, measures, steady)| {
            let (tally, measures, steady) = (tally.without_state(), *measures, *steady);
            let tier = S::tier(&jobs[index]);
            ended[places[index]] = Some(Ended { tally, measures, steady, tier });
        })
    }
}
