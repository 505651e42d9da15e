//! The runs of points, side by side where their kind of scene can.
//!
//! The tier of a point is decided by the study and by the point alone. The points of a part are grouped after that, one group for each kind of scene, so that no row depends on what
//! else is in its part.

use std::sync::atomic::AtomicBool;

use iva_core::run::side_by_side::{self, Job, Listed, SideBySide};

use crate::engine::design::Design;
use crate::engine::ended::Ended;
use crate::engine::point::{Estimates, Request};
use crate::engine::scene::{Mounted, Scene};
use crate::error::Invalid;

/// Runs the designs. The results are in the order of the designs; `None`: the run had not begun when the sweep was
/// cancelled.
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
    for &extremes in request.with_extremes() {
        part.run(extremes, |scene| match scene {
            Scene::Siva(it) => Some(it),
            _ => None,
        })?;
        part.run(extremes, |scene| match scene {
            Scene::DrivenSiva(it) => Some(it),
            _ => None,
        })?;
        part.run(extremes, |scene| match scene {
            Scene::Piva(it) => Some(&**it),
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
    /// Runs the designs of one kind of scene whose extremes are wanted, or those of which they are not.
    fn run<S: SideBySide + Clone>(
        &mut self,
        extremes: bool,
        scene: impl Fn(&Scene) -> Option<&Mounted<S>>,
    ) -> Result<(), Invalid> {
        let Self { designs, request, cancel, ended } = self;
        let (mut jobs, mut places) = (Vec::new(), Vec::new());
        let listing = request.listing(extremes);
        for (place, design) in designs.iter().enumerate() {
            let Some(Mounted { system, start, .. }) = scene(&design.scene) else { continue };
            if request.wants_extremes(system) != extremes {
                continue;
            }
            let steady = request.steady_of(system).map(|wanted| (wanted, design.window));
            let Design { begin, limits, tier, .. } = *design;
            // What is listed is that of the exact tier, where there are two.
            let tier = if listing.is_empty() { tier } else { design.tier_alone() };
            let (system, start) = (system.clone(), *start);
            jobs.push(Job { system, start, begin, limits, steady, tier });
            places.push(place);
        }
        if jobs.is_empty() {
            return Ok(());
        }
        let mut refused = None;
        let mut take =
            |index: usize, (tally, measures, steady): &side_by_side::Ended<S>, listed: Listed| {
                let (place, tier) = (places[index], S::tier(&jobs[index]));
                let found = (tally.without_state(), *measures, *steady);
                match Ended::new(&designs[place], found, tier, request.reduction, cancel) {
                    Ok(run) => {
                        let [condition, digits] = listed.errors.of_run();
                        let named = request.named(listed.passes.iter().copied());
                        let extremes = listed.extremes.clone();
                        let absorbers = listed.absorbers.clone();
                        let run = Ended { condition, digits, extremes, absorbers, named, ..run };
                        ended[place] = Some((run, listed));
                    }
                    Err(error) => refused = Some(error),
                }
            };
        side_by_side::run_listed(&jobs, (request.measures(), &listing), Some(cancel), &mut take)?;
        refused.map_or(Ok(()), Err)
    }
}
