//! A periodic orbit in numbers of twice the precision.
//!
//! Newton's method once more, on the map in these numbers. The derivative that doubles gave is enough: each step makes the error
//! smaller by some ten digits. The scene is given in the same numbers, so that conversion of units is exact too.

use std::sync::atomic::AtomicBool;

use nalgebra::{DMatrix, DVector};

use super::coordinates::Numbered;
use super::periodic::Missed;
use crate::absorber::impact::Impact;
use crate::absorber::{Angle, Point};
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
#[derive(Debug, Clone, PartialEq)]
pub struct Polished<R> {
    /// All numbers of its state.
    pub at: Vec<R>,
    /// The largest difference between one of these and its image, over the size of the state.
    pub residual: f64,
}

/// What a run from a point shows, rounded to doubles: its events over one cycle, and its states at increasing instants.
#[derive(Debug, Clone, PartialEq)]
pub struct Seen {
    /// Its impacts and stick episodes.
    pub events: Events,
    /// Its states, at each instant one of each absorber.
    pub states: Vec<State>,
    /// q and q̇ of the modes of a structure with points at each instant.
    pub modes: Vec<Vec<Point>>,
}

/// The run from a point at an instant to another.
fn run<S: Numbered>(
    system: &S,
    (begin, at): (S::Real, &[S::Real]),
    end: S::Real,
    seen: &mut (Events<S::Real>, Sampler<S::Real>),
    cancel: Option<&AtomicBool>,
) -> Result<S::State, Missed> {
    let start = system.all_numbered(at).ok_or(Missed::Stalled(f64::INFINITY))?;
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
    (from, derivative): (&DVector<f64>, &DMatrix<f64>),
    cancel: Option<&AtomicBool>,
) -> Result<Polished<S::Real>, Missed> {
    let Stretch { begin, length, mirrored } = stretch;
    let mirror = if mirrored { -1.0 } else { 1.0 };
    let count = from.len();
    let back =
        (DMatrix::identity(count, count) - derivative).try_inverse().ok_or(Missed::Singular)?;
    let size = from.amax().max(system.clearance().into());
    let mut at: Vec<S::Real> = from.iter().map(|it| (*it).into()).collect();
    let mut best: Option<Polished<S::Real>> = None;
    for _ in 0..MOST_STEPS {
        let mut unseen = (Events::default(), Sampler::at(vec![]));
        let end = run(system, (begin, &at), begin + length, &mut unseen, cancel)?;
        let image = system.all_numbers(&end);
        let off = image.iter().zip(&at).map(|(image, at)| (*image * mirror - *at).into());
        let off = DVector::from_iterator(count, off);
        let residual = off.amax() / size;
        if residual.is_nan() || best.as_ref().is_some_and(|best| residual >= best.residual) {
            break;
        }
        best = Some(Polished { at: at.clone(), residual });
        if residual <= SOLVED {
            break;
        }
        for (at, step) in at.iter_mut().zip(&(&back * off)) {
            *at += *step;
        }
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
    (begin, at): (S::Real, &[S::Real]),
    length: S::Real,
    instants: &[S::Real],
    cancel: Option<&AtomicBool>,
) -> Result<Seen, Missed> {
    let mut cycle = (Events::default(), Sampler::at(vec![]));
    run(system, (begin, at), begin + length, &mut cycle, cancel)?;
    let mut sampled = (Events::default(), Sampler::with_modes(instants.to_vec()));
    let last = instants.last().copied().unwrap_or(begin + length);
    run(system, (begin, at), last, &mut sampled, cancel)?;
    let Events { impacts, episodes } = cycle.0;
    let impacts = impacts.iter().map(impact).collect();
    let events = Events { impacts, episodes: episodes.iter().map(episode).collect() };
    let Sampler { states, modes, .. } = sampled.1;
    let point = |it: &Point<S::Real>| Point { x: it.x.into(), v: it.v.into() };
    let modes = modes.unwrap_or_default();
    let modes = modes.iter().map(|all| all.iter().map(point).collect()).collect();
    Ok(Seen { events, states: states.iter().map(state).collect(), modes })
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
        absorber: given.absorber,
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
