//! Lyapunov exponents of a scene, in the user's units, see [`iva_core::orbit::lyapunov`].

use std::sync::atomic::Ordering;

use iva_core::error::Invalid;
use iva_core::orbit::Trajectory;
use iva_core::orbit::lyapunov::{Spectrum, carried, spectrum};

use super::Tracker;
use super::diagram::Window;
use super::family::{Family, OfMember, with_member};
use super::starts::{Bounds, Drawn, Startable};
use crate::design::Spec;
use crate::sweep::SweepError;
use crate::workers::Workers;

/// Number of trajectories that go side by side on one thread.
const TOGETHER: usize = 4;

/// The exponents, per unit of the user's time.
#[derive(Debug, Clone, PartialEq)]
pub struct Exponents {
    /// The exponents and all that is told of them; rates are per unit of the user's time.
    pub spectrum: Spectrum,
    /// The dimension of the attractor in the section of the strobe.
    pub dimension: f64,
    /// The box of the starts, in the user's units.
    pub bounds: Bounds,
}

/// The exponents along trajectories from starts that are drawn. Cancelled, they are those of the cycles that are finished.
///
/// # Errors
/// [`SweepError::Invalid`] as [`Family::new`], or if a box has starts outside the gap.
pub fn lyapunov(
    spec: &Spec,
    drawn: &Drawn,
    window: Window,
    tracker: Tracker<'_>,
) -> Result<Exponents, SweepError> {
    let family = Family::new(spec, None, 1)?;
    with_member!(&family.member, |it| exponents(&family, it, drawn, window, tracker))
}

fn exponents<S: Startable + OfMember>(
    family: &Family,
    like: &Trajectory<S>,
    drawn: &Drawn,
    window: Window,
    tracker: Tracker<'_>,
) -> Result<Exponents, SweepError> {
    let starts = family.drawn(like, drawn)?;
    let groups: Vec<_> = starts.trajectories.chunks(TOGETHER).collect();
    let one = |group: u64| {
        let group = groups[group as usize];
        let all = carried(group, window, Some(tracker.cancel));
        tracker.done.fetch_add(group.len() as u64, Ordering::Relaxed);
        all
    };
    let all = Workers::new(None)?.map(groups.len() as u64, one);
    let all: Result<Vec<_>, Invalid> = all.into_iter().collect();
    let natural = spectrum(&starts.trajectories, &all?.concat());
    // A rate per 1/ωn → one per unit of the user's time.
    let rate = |it: f64| family.scale.velocity(it);
    let dimension = natural.dimension();
    let spectrum = Spectrum {
        exponents: natural.exponents.iter().map(|it| rate(*it)).collect(),
        standard_errors: natural.standard_errors.iter().map(|it| rate(*it)).collect(),
        sum_error: natural.sum_error.map(rate),
        ..natural
    };
    Ok(Exponents { spectrum, dimension, bounds: starts.bounds })
}
