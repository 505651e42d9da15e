//! One run with the usual observers, in one call.

use crate::absorber::Absorber;
use crate::absorber::impact::Impact;
use crate::engine::observe::{Events, StickEpisode};
use crate::engine::simulate::{Limits, Tally, simulate};
use crate::error::{Invalid, number};
use crate::measures::peaks::Peak;
use crate::measures::sample::{Sampler, State};
use crate::measures::{MeasureValues, Measures, Wanted};

/// The results of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Run<S, R = f64> {
    /// Outcome, counts and sums.
    pub tally: Tally<S, R>,
    /// Listed impacts.
    pub impacts: Vec<Impact<R>>,
    /// Stick episodes.
    pub episodes: Vec<StickEpisode<R>>,
    /// Peaks of the primary displacement.
    pub peaks: Vec<Peak<R>>,
    /// Damping measures and the energy ledger.
    pub measures: MeasureValues<R>,
}

/// Runs a system and records impacts, episodes, peaks and measures.
///
/// # Errors
/// [`Invalid`] if the start or a limit is not usable.
pub fn run<S: Absorber>(
    system: &S,
    start: &S::Start,
    limits: &Limits<S::Real>,
) -> Result<Run<S::State, S::Real>, Invalid> {
    let wanted = Wanted { envelope: true, ..Wanted::ALL };
    let mut observers = (Events::default(), Measures::<S>::new(wanted));
    let tally = simulate(system, start, limits, None, &mut observers)?;
    let (events, measures) = observers;
    Ok(Run {
        tally,
        impacts: events.impacts,
        episodes: events.episodes,
        peaks: measures.envelope().to_vec(),
        measures: *measures.values(),
    })
}

/// The states of a run at increasing instants within its duration; those after an early end are
/// missing.
///
/// # Errors
/// [`Invalid`] if the start, a limit or an instant is not usable.
pub fn states<S: Absorber<Real = f64>>(
    system: &S,
    start: &S::Start,
    limits: &Limits,
    times: &[f64],
) -> Result<Vec<State>, Invalid> {
    for (index, time) in times.iter().enumerate() {
        let earlier = index > 0 && times[index - 1] > *time;
        if !(*time >= 0.0 && *time <= limits.duration) || earlier {
            return Err(Invalid::new(
                format!("times[{index}]"),
                number(*time),
                format!("give increasing instants from 0 to {}", number(limits.duration)),
            ));
        }
    }
    let mut sampler = Sampler::at(times.to_vec());
    simulate(system, start, limits, None, &mut sampler)?;
    Ok(sampler.states)
}
