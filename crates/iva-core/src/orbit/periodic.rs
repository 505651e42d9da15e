//! Periodic orbits: fixed points of the map over whole cycles, by Newton's method with the exact derivative.
//!
//! The map is not smooth where its section meets an impact. So the section is moved first, to the middle of the longest
//! flight between two impacts. An orbit that is its own mirror image half a cycle later is a fixed
//! point of the half map (the map over half a cycle, and the mirror): at a pitchfork the full map is singular there,
//! the half map is not.
//!
//! A motion without impacts is not isolated where an absorber may stand anywhere in its gap: the map is singular,
//! and no orbit is found. Springs and weights make it one like any other.

use std::sync::atomic::AtomicBool;

use nalgebra::{Complex, DMatrix, DVector};

use super::coordinates::Coordinates;
use super::multipliers::{largest_first, multipliers};
use super::{Cycle, Trajectory};
use crate::absorber::Clock;
use crate::engine::observe::{Events, Observer};
use crate::engine::simulate::{Instant, Limits, Outcome, resume};
use crate::error::Invalid;
use crate::measures::propagation::Derivative as _;

/// Most steps of Newton's method.
const MOST_STEPS: u32 = 40;
/// Most halvings of a step that makes the residual larger or leaves the gap.
const MOST_HALVINGS: u32 = 12;
/// The residual, over the size of the state, of what counts as an orbit.
const CLOSED: f64 = 1e-10;
/// By how much rounding may have grown after two cycles, over the square of the derivative.
const GROWN: f64 = 1e-12;
/// A step of this size over that of the state is rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// A periodic orbit.
#[derive(Debug, Clone)]
pub struct Orbit<S: Coordinates> {
    /// The trajectory along it: its cycle begins in the middle of the longest flight between two impacts.
    pub trajectory: Trajectory<S>,
    /// Number of impacts in a cycle that are listed ([`Limits::chatter_floor`]).
    pub impacts: u64,
    /// True if it was sought as its own mirror image half a cycle later.
    pub symmetric: bool,
    /// The derivative of the map that was solved, in [`Coordinates::point`]: of a symmetric orbit the half map with the mirror.
    pub derivative: DMatrix<f64>,
    /// The derivative of the map over the cycle.
    pub monodromy: DMatrix<f64>,
    /// Its eigenvalues, largest first: the Floquet multipliers.
    pub multipliers: Vec<Complex<f64>>,
    /// Those of the half map of a symmetric orbit; the multipliers are their squares.
    pub half_multipliers: Option<Vec<Complex<f64>>>,
    /// The largest difference between a coordinate and its image, over the size of the state.
    pub residual: f64,
    /// Number of steps of Newton's method.
    pub steps: u32,
}

impl<S: Coordinates> Orbit<S> {
    /// True if all multipliers are smaller than 1.
    pub fn is_stable(&self) -> bool {
        self.multipliers.iter().all(|multiplier| multiplier.norm() < 1.0)
    }
}

/// Why no orbit was found.
#[derive(Debug, Clone, PartialEq)]
pub enum Missed {
    /// The cycle has no length, or begins before time zero.
    Invalid(Invalid),
    /// A cycle did not end, or the search was cancelled.
    Cycle(Outcome),
    /// There are less than two impacts in three cycles, or a cycle without, and an absorber may stand anywhere in its gap.
    NoImpacts,
    /// The map has the multiplier 1, or −1 in the half map.
    Singular,
    /// The residual does not fall; it is this over the size of the state.
    Stalled(f64),
    /// The run from the point found does not come back to it, by this over the size of the state: the cycle is not one of the
    /// drive, or the scene is not symmetric.
    NotPeriodic(f64),
    /// At a point of a branch with stick episodes: a run leaves a wall there before its chatter has ended.
    NoStick,
}

impl From<Invalid> for Missed {
    fn from(invalid: Invalid) -> Self {
        Missed::Invalid(invalid)
    }
}

/// The map of a search: over the whole cycle, or over half of it with the mirror.
struct Sought<'a, S: Coordinates> {
    trajectory: Trajectory<S>,
    symmetric: bool,
    cancel: Option<&'a AtomicBool>,
}

/// A point, its image less itself, and the derivative of the map.
#[derive(Clone)]
struct Tried {
    at: DVector<f64>,
    off: DVector<f64>,
    derivative: DMatrix<f64>,
    impacts: u64,
}

impl<S: Coordinates + Clone> Sought<'_, S> {
    /// Tries a point; `None` if it is out of the gap.
    fn tried(&self, at: DVector<f64>) -> Result<Option<Tried>, Missed> {
        let Trajectory { system, cycle, .. } = &self.trajectory;
        let Some(state) = state_at(system, &at, cycle.begin) else { return Ok(None) };
        let (length, mirror) =
            if self.symmetric { (0.5 * cycle.length, -1.0) } else { (cycle.length, 1.0) };
        let Flown { end, derivative, impacts } =
            flown(system, (&state, cycle.begin), length, self.cancel)?;
        let off = system.point(&end) * mirror - &at;
        Ok(Some(Tried { at, off, derivative: derivative * mirror, impacts }))
    }

    /// The size of a state.
    fn size(&self, at: &DVector<f64>) -> f64 {
        at.amax().max(self.trajectory.system.clearance())
    }

    /// The orbit through a point that is on it.
    fn orbit(&self, solved: &Tried, steps: u32) -> Orbit<S> {
        let mut trajectory = self.trajectory.clone();
        let system = &trajectory.system;
        if let Some(state) = state_at(system, &solved.at, trajectory.cycle.begin) {
            trajectory.state = state;
        }
        let derivative = solved.derivative.clone();
        let half = self.symmetric.then_some(&derivative);
        let (monodromy, impacts) = match half {
            Some(half) => (half * half, 2 * solved.impacts),
            None => (derivative.clone(), solved.impacts),
        };
        let half_multipliers = half.map(multipliers);
        let squares =
            |half: &Vec<Complex<f64>>| largest_first(half.iter().map(|it| it * it).collect());
        Orbit {
            trajectory,
            impacts,
            symmetric: self.symmetric,
            derivative,
            multipliers: half_multipliers.as_ref().map_or_else(|| multipliers(&monodromy), squares),
            monodromy,
            half_multipliers,
            residual: solved.off.amax() / self.size(&solved.at),
            steps,
        }
    }

    /// Newton's method from a point: the solution and the number of steps.
    fn solved(&self, from: DVector<f64>) -> Result<(Tried, u32), Missed> {
        let mut best = self.tried(from)?.ok_or(Missed::Stalled(f64::INFINITY))?;
        for step in 1..=MOST_STEPS {
            if best.impacts == 0 && !self.trajectory.system.has_place_of_rest() {
                return Err(Missed::NoImpacts);
            }
            let size = self.size(&best.at);
            let size_of = best.at.len();
            let system = DMatrix::identity(size_of, size_of) - &best.derivative;
            let newton = system.lu().solve(&best.off).ok_or(Missed::Singular)?;
            if newton.amax() <= ROUNDING * size {
                return Ok((best, step));
            }
            match self.nearer(&best, &newton)? {
                Some(next) => best = next,
                // The residual is down to rounding, or does not fall.
                None if best.off.amax() <= CLOSED * size => return Ok((best, step)),
                None => break,
            }
        }
        Err(Missed::Stalled(best.off.amax() / self.size(&best.at)))
    }

    /// The point after a step of Newton's method or, where the residual does not fall, after a part of it.
    fn nearer(&self, from: &Tried, newton: &DVector<f64>) -> Result<Option<Tried>, Missed> {
        let mut share = 1.0;
        for _ in 0..MOST_HALVINGS {
            match self.tried(&from.at + newton * share) {
                Ok(Some(tried)) if tried.off.amax() < from.off.amax() => return Ok(Some(tried)),
                Err(Missed::Cycle(Outcome::Cancelled)) => {
                    return Err(Missed::Cycle(Outcome::Cancelled));
                }
                _ => share *= 0.5,
            }
        }
        Ok(None)
    }
}

/// The state of a system at a point and an instant; `None` if that is of no place in a gap.
pub(super) fn state_at<S: Coordinates>(
    system: &S,
    point: &DVector<f64>,
    instant: f64,
) -> Option<S::State> {
    Some(system.begin_at(&system.start_of(point)?, Clock::new(instant)))
}

/// A run over a stretch of time: its end, its derivative in all numbers of a state, and its impacts that are listed.
pub(super) struct Flown<State> {
    pub end: State,
    pub derivative: DMatrix<f64>,
    pub impacts: u64,
}

/// A run of this length from a state at an instant.
pub(super) fn flown<S: Coordinates>(
    system: &S,
    (state, begin): (&S::State, f64),
    length: f64,
    cancel: Option<&AtomicBool>,
) -> Result<Flown<S::State>, Missed> {
    let from = Instant { time: Clock::new(begin), state: *state };
    let limits = Limits::new(begin + length, system.clearance());
    let mut seen = S::Derivative::default();
    let tally = resume(system, &from, &limits, cancel, &mut seen)?;
    match tally.outcome {
        Outcome::Finished => {
            Ok(Flown { end: tally.state, derivative: seen.factor(system), impacts: tally.impacts })
        }
        outcome => Err(Missed::Cycle(outcome)),
    }
}

/// The instants at which members come to rest in their gaps and slip.
#[derive(Debug, Default)]
pub(super) struct Rubbing {
    pub stops: Vec<f64>,
    pub slips: Vec<f64>,
    /// The smallest acceleration in the gap with which one turns back at once, over that before; where it vanishes friction holds the member.
    pub weakest: Option<f64>,
}

impl<S: Coordinates> Observer<S> for Rubbing {
    fn looks_within(&self) -> bool {
        false
    }

    fn stop(&mut self, system: &S, time: f64, states: [&S::State; 2]) {
        self.stops.push(time);
        if !system.is_held(states[1]) {
            let [before, after] = states.map(|state| system.distance(state).curvature.abs());
            let least = self.weakest.unwrap_or(f64::INFINITY);
            self.weakest = Some(least.min(after / before));
        }
    }

    fn slip(&mut self, _system: &S, from: &Instant<S::State>) {
        self.slips.push(from.time.value);
    }
}

impl Rubbing {
    /// The instants in order, each with whether a slide follows: after a stop, unless it is a slip that is next. The first is next to the
    /// last.
    pub fn marks(&self) -> Vec<(f64, bool)> {
        let stops = self.stops.iter().map(|time| (*time, false));
        let mut all: Vec<_> = stops.chain(self.slips.iter().map(|time| (*time, true))).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let next = all.iter().cycle().skip(1);
        all.iter().zip(next).map(|(own, next)| (own.0, own.1 || !next.1)).collect()
    }
}

/// The middle of the longest flight between two events; `None` without two impacts.
fn longest_flight(events: &Events) -> Option<f64> {
    // Where something happens, and whether a flight follows.
    let impacts = events.impacts.iter().map(|impact| (impact.time, true));
    let sticks = events.episodes.iter().map(|episode| (episode.stick_time, false));
    let releases = events.episodes.iter().filter_map(|it| it.release_time).map(|time| (time, true));
    let mut marks: Vec<_> = impacts.chain(sticks).chain(releases).collect();
    marks.sort_by(|a, b| a.0.total_cmp(&b.0));
    longest(&marks)
}

/// The middle of the longest time between two marks of which the first has a flight or a slide after it.
fn longest(marks: &[(f64, bool)]) -> Option<f64> {
    let flights = marks.windows(2).filter(|pair| pair[0].1);
    let longest = flights.max_by(|a, b| (a[1].0 - a[0].0).total_cmp(&(b[1].0 - b[0].0)))?;
    Some(0.5 * (longest[0].0 + longest[1].0))
}

/// The state of a trajectory at a later instant.
pub(super) fn reached<S: Coordinates>(
    trajectory: &Trajectory<S>,
    instant: f64,
    cancel: Option<&AtomicBool>,
    observer: &mut impl Observer<S>,
) -> Result<S::State, Missed> {
    let Trajectory { system, state, cycle, .. } = trajectory;
    let from = Instant { time: Clock::new(cycle.begin), state: *state };
    let limits = Limits::new(instant, system.clearance());
    let tally = resume(system, &from, &limits, cancel, observer)?;
    match tally.outcome {
        Outcome::Finished => Ok(tally.state),
        outcome => Err(Missed::Cycle(outcome)),
    }
}

/// A trajectory that begins in the middle of the longest flight between two impacts of another: in its first two cycles or,
/// where the second impact comes just after them, in its first three. Without impacts it begins in the middle of the longest slide, or
/// a cycle later.
fn moved<S: Coordinates + Clone>(
    trajectory: &Trajectory<S>,
    cancel: Option<&AtomicBool>,
) -> Result<Trajectory<S>, Missed> {
    let Trajectory { system, cycle: Cycle { begin, length }, .. } = trajectory;
    let flight = |cycles: f64| {
        let mut seen = (Events::default(), Rubbing::default());
        reached(trajectory, begin + cycles * length, cancel, &mut seen)?;
        let (events, rubbing) = seen;
        let rests = events.impacts.is_empty() && system.has_place_of_rest();
        let slide = || rests.then(|| longest(&rubbing.marks()).unwrap_or(begin + length));
        longest_flight(&events).or_else(slide).ok_or(Missed::NoImpacts)
    };
    let middle = flight(2.0).or_else(|_| flight(3.0))?;
    let state = reached(trajectory, middle, cancel, &mut ())?;
    // The phase of the drive is the same in every cycle.
    let begin = begin + (middle - begin).rem_euclid(*length);
    let state = state_at(system, &system.point(&state), begin).ok_or(Missed::NoImpacts)?;
    Ok(Trajectory { state, cycle: Cycle { begin, length: *length }, ..trajectory.clone() })
}

/// The periodic orbit near a trajectory, of the period of its cycle. If it is `symmetric`, the drive must change its sign
/// after half a cycle, the walls be alike and the motion level.
///
/// # Errors
/// [`Missed`] says why there is none, or why none was found.
pub fn find<S: Coordinates + Clone>(
    trajectory: &Trajectory<S>,
    symmetric: bool,
    cancel: Option<&AtomicBool>,
) -> Result<Orbit<S>, Missed> {
    trajectory.limits()?;
    let trajectory = moved(trajectory, cancel)?;
    let from = trajectory.system.point(&trajectory.state);
    let sought = Sought { trajectory, symmetric, cancel };
    let (solved, steps) = sought.solved(from)?;
    let orbit = sought.orbit(&solved, steps);
    // The map sets the drive back; a run does not.
    let Cycle { begin, length } = orbit.trajectory.cycle;
    let later = reached(&orbit.trajectory, begin + 2.0 * length, cancel, &mut ())?;
    let system = &orbit.trajectory.system;
    let off = (system.point(&later) - &solved.at).amax();
    let off = off / system.clearance().max(solved.at.amax());
    if off.is_nan() || off > CLOSED + GROWN * orbit.monodromy.amax().powi(2) {
        return Err(Missed::NotPeriodic(off));
    }
    Ok(orbit)
}

/// The orbit of a trajectory that is already on one, as exactly as the residual tells.
///
/// # Errors
/// [`Missed`] if the cycle does not end.
pub(super) fn through<S: Coordinates + Clone>(
    trajectory: Trajectory<S>,
    symmetric: bool,
    cancel: Option<&AtomicBool>,
) -> Result<Orbit<S>, Missed> {
    let at = trajectory.system.point(&trajectory.state);
    let sought = Sought { trajectory, symmetric, cancel };
    let tried = sought.tried(at)?.ok_or(Missed::Stalled(f64::INFINITY))?;
    Ok(sought.orbit(&tried, 0))
}
