//! The attractors of a scene, in the user's units, see [`iva_core::orbit::attractors`].

use std::sync::atomic::{AtomicBool, Ordering};

use iva_core::orbit::attractors::{self as core, Attractor, Class, Search};
use iva_core::orbit::symmetry::find_any;
use iva_core::orbit::{Cycle, Trajectory};

use super::basins::{LeftOut, untold};
use super::family::{Family, with_member};
use super::starts::{Bounds, Drawn, Numbers, Startable, Starts};
use super::{Found, Missed, Outcome, Tracker, told};
use crate::design::Spec;
use crate::sweep::SweepError;
use crate::workers::Workers;

/// Number of starts that a worker takes at once.
const TOGETHER: usize = 64;

/// A periodic attractor.
#[derive(Debug, Clone)]
pub struct Attracting {
    /// The orbit.
    pub found: Found,
    /// Number of periods of the drive after which it repeats.
    pub periods: u32,
    /// True if its mirror image is another orbit, which is counted with it.
    pub pair: bool,
    /// Number of starts that end in it.
    pub count: usize,
}

/// What starts end in.
#[derive(Debug, Clone)]
pub struct Inventory {
    /// The periodic attractors, in the order of the starts that found them.
    pub attractors: Vec<Attracting>,
    /// Number of starts that end in a motion without impacts.
    pub no_impacts: usize,
    /// Number of starts whose strobes do not repeat, or whose orbit is left out.
    pub aperiodic: usize,
    /// The first of these.
    pub aperiodic_start: Option<Numbers>,
    /// How cycles ended that did not finish, one for each such start.
    pub unfinished: Vec<Outcome>,
    /// The box of the starts: displacement and velocity, gap displacement and gap velocity of each absorber.
    pub bounds: Bounds,
    /// The orbits that cannot be described, with the reasons.
    pub left_out: Vec<LeftOut>,
}

/// What starts that are drawn end in. An orbit and its mirror image count as one. Cancelled, the starts that are not finished are
/// among [`Inventory::unfinished`].
///
/// # Errors
/// [`SweepError::Invalid`] as [`Family::new`], for orbits of no period or of too many, or if a box has starts outside the gap.
pub fn attractors(
    spec: &Spec,
    drawn: &Drawn,
    (most_periods, most_cycles): (u32, u64),
    tracker: Tracker<'_>,
) -> Result<Inventory, SweepError> {
    let family = Family::new(spec, None, 1)?;
    let search = Search { most_periods, most_cycles, join_mirrored: family.mirrors };
    with_member!(&family.member, |it| {
        let starts = family.drawn(it, drawn)?;
        inventory(&family, it, starts, search, tracker)
    })
}

fn inventory<S: Startable>(
    family: &Family,
    like: &Trajectory<S>,
    starts: Starts<S>,
    search: Search,
    tracker: Tracker<'_>,
) -> Result<Inventory, SweepError> {
    let found = searched(&starts.trajectories, search, tracker)?;
    // What was found before a call was cancelled is told all the same.
    let cancel = &AtomicBool::new(false);
    let clearance = like.system.clearance();
    let (mut attractors, mut left_out, mut unlike) = (vec![], vec![], vec![Class::Aperiodic]);
    for (index, attractor) in found.attractors.iter().enumerate() {
        let class = Class::Periodic(index);
        let told = match told_of(family, like, attractor, cancel) {
            Ok(told) => told,
            Err(why) => {
                left_out.push(untold(family, like, attractor, why));
                unlike.push(class);
                continue;
            }
        };
        let (pair, periods) = (attractor.is_pair(clearance), attractor.periods() as u32);
        let count = found.share(|it| *it == class).count;
        attractors.push(Attracting { found: told, periods, pair, count });
    }
    let first = found.classes.iter().position(|class| unlike.contains(class));
    let unfinished = found.classes.iter().filter_map(|class| match class {
        Class::Unfinished(outcome) => Some(*outcome),
        _ => None,
    });
    Ok(Inventory {
        attractors,
        no_impacts: found.share(|class| *class == Class::NoImpacts).count,
        aperiodic: found.share(|class| unlike.contains(class)).count,
        aperiodic_start: first.map(|index| starts.numbers[index].clone()),
        unfinished: unfinished.collect(),
        bounds: starts.bounds,
        left_out,
    })
}

/// What trajectories end in, found by all workers.
pub(super) fn searched<S: Startable>(
    trajectories: &[Trajectory<S>],
    search: Search,
    tracker: Tracker<'_>,
) -> Result<core::Found<S>, SweepError> {
    let groups: Vec<_> = trajectories.chunks(TOGETHER).collect();
    let one = |group: u64| {
        let group = groups[group as usize];
        let found = core::attractors(group, search, Some(tracker.cancel));
        tracker.done.fetch_add(group.len() as u64, Ordering::Relaxed);
        found
    };
    let parts = Workers::new(None)?.map(groups.len() as u64, one);
    let clearance = trajectories.first().map_or(f64::NAN, |first| first.system.clearance());
    let mut all = core::Found { attractors: vec![], classes: vec![] };
    for part in parts {
        all.join(part?, clearance);
    }
    Ok(all)
}

/// All that is told of an attractor, at the phase of the starts.
pub(super) fn told_of<S: Startable>(
    family: &Family,
    like: &Trajectory<S>,
    attractor: &Attractor<S>,
    cancel: &AtomicBool,
) -> Result<Found, Missed> {
    let periods = attractor.periods() as u32;
    let cancel = Some(cancel);
    let maybe_symmetric = family.mirrors && !periods.is_multiple_of(2);
    let start = attractor.strobes.first().and_then(|strobe| like.system.start_at_strobe(strobe));
    let orbit = match start.filter(|_| maybe_symmetric) {
        Some(start) => {
            // Sought anew from the phase of the starts, so that its section is no further than a cycle from there.
            let cycle = Cycle { length: like.cycle.length * f64::from(periods), ..like.cycle };
            let at_phase = Trajectory::new(like.system.clone(), &start, cycle)?;
            find_any(&at_phase, cancel).unwrap_or_else(|_| attractor.orbit.clone())
        }
        None => attractor.orbit.clone(),
    };
    told(family, like.cycle.begin, (&orbit, periods), cancel)
}
