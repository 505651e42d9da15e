//! Points that are run side by side: those of a study that wants the summary, and events, their errors and the
//! envelope at most.
//!
//! Whether a point goes side by side, and in which tier, is decided by the study and by the point alone. The
//! points of a part are grouped after that, one group for each kind of scene, so that no row depends on what
//! else is in its part.

use std::sync::atomic::AtomicBool;

use iva_core::lanes::{self, Job, Listed, Listing, SideBySide};
use iva_core::piva::Piva;

use crate::engine::design::Design;
use crate::engine::ended::Ended;
use crate::engine::point::{Estimates, Request};
use crate::engine::scene::Scene;
use crate::error::Invalid;

/// Runs those of the designs that can go side by side. The results are in the order of the designs; `None`:
/// the design has to be run by itself, or had not begun when the sweep was cancelled.
///
/// # Errors
/// [`Invalid`] for a start or limits that the core refuses.
pub(crate) fn run(
    designs: &[Design],
    request: &Request,
    cancel: &AtomicBool,
) -> Result<Vec<Option<(Ended, Listed)>>, Invalid> {
    let ended = designs.iter().map(|_| None).collect();
    let mut part = Part { designs, request, cancel, ended };
    if request.goes_side_by_side() {
        part.run(|scene| match scene {
            Scene::Siva { system, start } => Some((system.clone(), *start)),
            _ => None,
        })?;
        part.run(|scene| match scene {
            Scene::DrivenSiva { system, start, .. } => Some((system.clone(), *start)),
            _ => None,
        })?;
        part.run(|scene| match scene {
            Scene::Piva { system, start, .. } => Some((Piva::clone(system), *start)),
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
    ended: Vec<Option<(Ended, Listed)>>,
}

impl Part<'_> {
    /// Runs the designs of one kind of scene.
    fn run<S: SideBySide>(
        &mut self,
        scene: impl Fn(&Scene) -> Option<(S, S::Start)>,
    ) -> Result<(), Invalid> {
        let Self { designs, request, cancel, ended } = self;
        let (mut jobs, mut places, listing) = (Vec::new(), Vec::new(), request.listing());
        for (place, design) in designs.iter().enumerate() {
            let Some((system, start)) = scene(&design.scene) else { continue };
            if request.wants_extremes(&system) {
                continue;
            }
            let steady = request.steady_of(&system).map(|wanted| (wanted, design.window));
            let Design { begin, limits, tier, .. } = *design;
            // Events and errors are those of the exact tier, where there are two.
            let tier = if listing == Listing::default() { tier } else { design.tier_alone() };
            jobs.push(Job { system, start, begin, limits, steady, tier });
            places.push(place);
        }
        if jobs.is_empty() {
            return Ok(());
        }
        let mut refused = None;
        let mut take =
            |index: usize, (tally, measures, steady): &lanes::Ended<S>, listed: Listed| {
                let (place, tier) = (places[index], S::tier(&jobs[index]));
                let found = (tally.without_state(), *measures, *steady);
                match Ended::new(&designs[place], found, tier, request.reduction, cancel) {
                    Ok(run) => {
                        let [condition, digits] = Estimates::<S>::of_run(&listed.errors);
                        ended[place] = Some((Ended { condition, digits, ..run }, listed));
                    }
                    Err(error) => refused = Some(error),
                }
            };
        lanes::run_listed(&jobs, (request.wanted, listing), Some(cancel), &mut take)?;
        refused.map_or(Ok(()), Err)
    }
}
