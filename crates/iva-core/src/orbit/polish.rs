//! A periodic orbit in numbers of twice the precision.
//!
//! Newton's method once more, on the map in these numbers. The derivative that doubles gave is enough: each step makes the error
//! smaller by some ten digits. The scene is given in the same numbers, so that conversion of units is exact too.

use std::sync::atomic::AtomicBool;

use nalgebra::{Matrix4, Vector4};

use super::coordinates::Numbered;
use super::periodic::Missed;
use crate::absorber::Angle;
use crate::absorber::impact::Impact;
use crate::engine::observe::{Events, StickEpisode};
use crate::engine::simulate::{Instant, Limits, Outcome, resume};
use crate::measures::sample::{Sampler, State};
use crate::number::real::Real;

/// Most steps.
const MOST_STEPS: u32 = 12;
/// The residual, over the size of the state, that is below what any result in doubles can show.
const SOLVED: f64 = 1e-26;
/// The largest residual of what counts as an orbit in these numbers: stick episodes and steps of pendulums leave some 1e-21.
const CLOSED: f64 = 1e-18;

/// What is solved: the map over a stretch of time from an instant on, followed by the mirror or not.
#[derive(Debug, Clone, Copy)]
pub struct Stretch<R> {
    /// The instant, in 1/ωn.
    pub begin: R,
    /// The length of the cycle or, of a symmetric orbit, of half of it.
    pub length: R,
    /// True if the image is mirrored.
    pub mirrored: bool,
}

/// A point of a periodic orbit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polished<R> {
    /// x, ẋ, y and ẏ (or W).
    pub at: [R; 4],
    /// The largest difference between one of these and its image, over the size of the state.
    pub residual: f64,
}

/// What a run from a point shows, rounded to doubles: its events over one cycle, and its states at increasing instants.
#[derive(Debug, Clone, PartialEq)]
pub struct Seen {
    /// Its impacts and stick episodes.
    pub events: Events,
    /// Its states.
    pub states: Vec<State>,
}

/// The run from a point at an instant to another.
fn run<S: Numbered>(
    system: &S,
    (begin, at): (S::Real, [S::Real; 4]),
    end: S::Real,
    seen: &mut (Events<S::Real>, Sampler<S::Real>),
    cancel: Option<&AtomicBool>,
) -> Result<S::State, Missed> {
    let start = system.numbered(at);
    system.check_start(&start)?;
    let from = Instant::at(system, &start, begin);
    let limits = Limits::new(end, system.clearance());
    let tally = resume(system, &from, &limits, cancel, seen)?;
    match tally.outcome {
        Outcome::Finished => Ok(tally.state),
        outcome => Err(Missed::Cycle(outcome)),
    }
}

/// The point of an orbit near one that was found in doubles, where the map has a derivative.
///
/// # Errors
/// [`Missed`] if a run does not end, or the residual does not fall.
pub fn polish<S: Numbered>(
    system: &S,
    stretch: Stretch<S::Real>,
    (from, derivative): (&Vector4<f64>, &Matrix4<f64>),
    cancel: Option<&AtomicBool>,
) -> Result<Polished<S::Real>, Missed> {
    let Stretch { begin, length, mirrored } = stretch;
    let mirror = if mirrored { -1.0 } else { 1.0 };
    let back = (Matrix4::identity() - derivative).try_inverse().ok_or(Missed::Singular)?;
    let size = from.amax().max(system.clearance().into());
    let mut at: [S::Real; 4] = [0, 1, 2, 3].map(|k| from[k].into());
    let mut best: Option<Polished<S::Real>> = None;
    for _ in 0..MOST_STEPS {
        let mut unseen = (Events::default(), Sampler::at(vec![]));
        let end = run(system, (begin, at), begin + length, &mut unseen, cancel)?;
        let image = system.numbers(&end);
        let off: [S::Real; 4] = [0, 1, 2, 3].map(|k| image[k] * mirror - at[k]);
        let off: Vector4<f64> = off.map(Into::into).into();
        let residual = off.amax() / size;
        if residual.is_nan() || best.is_some_and(|best| residual >= best.residual) {
            break;
        }
        best = Some(Polished { at, residual });
        if residual <= SOLVED {
            break;
        }
        let step = back * off;
        at = [0, 1, 2, 3].map(|k| at[k] + step[k]);
    }
    match best {
        Some(best) if best.residual <= CLOSED => Ok(best),
        other => Err(Missed::Stalled(other.map_or(f64::INFINITY, |best| best.residual))),
    }
}

/// The events of a run from a point at an instant over one cycle, and its states at increasing instants.
///
/// # Errors
/// [`Missed`] if a run does not end.
pub fn shown<S: Numbered>(
    system: &S,
    (begin, at): (S::Real, [S::Real; 4]),
    length: S::Real,
    instants: &[S::Real],
    cancel: Option<&AtomicBool>,
) -> Result<Seen, Missed> {
    let mut cycle = (Events::default(), Sampler::at(vec![]));
    run(system, (begin, at), begin + length, &mut cycle, cancel)?;
    let mut sampled = (Events::default(), Sampler::at(instants.to_vec()));
    let last = instants.last().copied().unwrap_or(begin + length);
    run(system, (begin, at), last, &mut sampled, cancel)?;
    let Events { impacts, episodes } = cycle.0;
    let impacts = impacts.iter().map(impact).collect();
    let events = Events { impacts, episodes: episodes.iter().map(episode).collect() };
    Ok(Seen { events, states: sampled.1.states.iter().map(state).collect() })
}

/// An impact in doubles.
fn impact<R: Real>(given: &Impact<R>) -> Impact {
    Impact {
        time: given.time.into(),
        absorber: given.absorber,
        wall: given.wall,
        displacement: given.displacement.into(),
        velocity_before: given.velocity_before.into(),
        velocity_after: given.velocity_after.into(),
        gap_velocity_before: given.gap_velocity_before.into(),
        gap_velocity_after: given.gap_velocity_after.into(),
        lever: given.lever.into(),
        energy_loss: given.energy_loss.into(),
    }
}

/// A stick episode in doubles.
fn episode<R: Real>(given: &StickEpisode<R>) -> StickEpisode {
    StickEpisode {
        absorber: given.absorber,
        wall: given.wall,
        start_time: given.start_time.into(),
        stick_time: given.stick_time.into(),
        release_time: given.release_time.map(Into::into),
        impacts: given.impacts,
        energy_loss: given.energy_loss.into(),
    }
}

/// A state in doubles.
fn state<R: Real>(given: &State<R>) -> State {
    State {
        absorber: 0,
        time: given.time.into(),
        displacement: given.displacement.into(),
        velocity: given.velocity.into(),
        gap_displacement: given.gap_displacement.into(),
        gap_velocity: given.gap_velocity.into(),
        wall: given.wall,
        acceleration: given.acceleration.into(),
        absorber_acceleration: given.absorber_acceleration.into(),
        energy: given.energy.into(),
        angle: given.angle.map(|it| Angle { value: it.value.into(), rate: it.rate.into() }),
    }
}
