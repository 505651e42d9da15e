//! Periodic orbits of a given scene, in the user's units, see [`iva_core::orbit`].
//!
//! [`Family::new`] makes of a spec, and of a value of one of its fields, the system under its harmonic drive with the cycle
//! that an orbit repeats; [`orbit`] finds one.

use std::ops::ControlFlow::{Break, Continue};
use std::sync::atomic::{AtomicBool, AtomicU64};

use iva_core::absorber::modal::FewModes;
use iva_core::absorber::{Clock, Point};
use iva_core::error::Invalid;
use iva_core::host::DrivenHost;
use iva_core::observe::{Events, Observer};
use iva_core::orbit::description::{Description, describe};
use iva_core::orbit::periodic::find;
use iva_core::orbit::spectrum::spectrum;
use iva_core::orbit::symmetry::{find_any, find_either};
use iva_core::orbit::{Coordinates, Cycle, Iterated, Request, Trajectory, iterate};
use iva_core::piva::Piva;
use iva_core::sample::Sampler;
use iva_core::simulate::{Instant, Limits, resume};
use iva_core::siva::Siva;

use crate::design::Spec;
use course::Moment;
use family::{OfMember, with_member};

pub mod attractors;
pub mod basins;
pub mod branches;
mod course;
pub mod diagram;
mod family;
pub mod lyapunov;
pub mod starts;
pub mod words;

pub use course::Course;
pub use family::{Family, Member, common_periods};
pub use iva_core::impact::Impact;
pub use iva_core::observe::StickEpisode;
pub use iva_core::orbit::periodic::{Missed, Orbit};
pub use iva_core::orbit::polish::Seen;
pub use iva_core::orbit::spectrum::Spectrum;
pub use iva_core::sample::State;
pub use iva_core::simulate::Outcome;

/// What ends long work, and what is told of it.
#[derive(Debug, Clone, Copy)]
pub struct Tracker<'a> {
    /// A flag that ends the work; it then returns what it has.
    pub cancel: &'a AtomicBool,
    /// Counts the points that are done.
    pub done: &'a AtomicU64,
}

/// An orbit that was found in doubles, of an absorber of any kind.
#[derive(Debug, Clone, Copy)]
pub enum InDoubles<'a> {
    /// Of a free mass.
    Siva(&'a Orbit<Siva<DrivenHost>>),
    /// Of a pendulum.
    Piva(&'a Orbit<Piva<DrivenHost>>),
    /// Of one member of any kind.
    System(&'a Orbit<FewModes<DrivenHost>>),
}

/// An orbit to twice the precision.
#[derive(Debug, Clone)]
pub struct Exact {
    /// Its events and states, rounded.
    pub seen: Seen,
    /// The largest difference between a coordinate and its image before they are rounded, over the size of the state.
    pub residual: f64,
    /// The largest error of a coordinate that doubles gave, over the size of the state.
    pub error: f64,
}

/// Computes an orbit of so many periods to twice the precision, with its states after two numbers of cycles.
pub type ToTwice =
    fn(&Spec, (InDoubles<'_>, u32), cycles: [f64; 2], Option<&AtomicBool>) -> Result<Exact, Missed>;

/// What is asked of an orbit.
#[derive(Debug, Clone, Copy)]
pub struct Asked {
    /// Number of periods of the drive after which it repeats.
    pub periods: u32,
    /// True: one that is its own mirror image half a cycle later is sought, by the half map. False: any, by the map. `None`:
    /// see [`find_either`].
    pub symmetric: Option<bool>,
    /// Number of periods of the drive that are run first.
    pub settle: u64,
    /// What computes the orbit to twice the precision, to be rounded then, if that is asked for.
    pub verify: Option<ToTwice>,
}

/// A periodic orbit, in the user's units.
#[derive(Debug, Clone)]
pub struct Found {
    /// The orbit.
    pub course: Course,
    /// Its mirror image: minus the motion half a period of the drive later or, of an odd number of periods, half a cycle
    /// later. `None` if that is no motion, as the walls are unlike or the motion is not level.
    pub mirrored: Option<Course>,
    /// The length of a cycle.
    pub length: f64,
    /// The walls that the run from the start meets in a cycle: the sequence that the search began with.
    pub walls_of_start: String,
    /// Number of periods of the drive after which the motion repeats: a divisor of the one asked for.
    pub least_periods: u32,
    /// True if it is its own mirror image half a cycle later.
    pub symmetric: bool,
    /// Its multipliers with their errors, its rank and the error of the determinant.
    pub spectrum: Spectrum,
    /// True if all multipliers are smaller than 1.
    pub stable: bool,
    /// The largest difference between a coordinate and its image, over the size of the state, in natural units.
    pub residual: f64,
    /// The largest error of a coordinate of the orbit that doubles gave, over the size of the state; `None` unless verified.
    pub error: Option<f64>,
    /// Largest |x|.
    pub amplitude: Option<f64>,
    /// See [`Description::grazing_margin`].
    pub grazing_margin: Option<f64>,
    /// Smallest and largest approach speed.
    pub approach_speeds: [Option<f64>; 2],
}

/// The periodic orbit near the start of a spec, or near what its run settles on; or why none was found.
///
/// # Errors
/// [`Invalid`] as [`Family::new`], or if a symmetric orbit is asked for where there is none.
pub fn orbit(
    spec: &Spec,
    asked: Asked,
    cancel: &AtomicBool,
) -> Result<Result<Found, Missed>, Invalid> {
    let family = Family::new(spec, None, asked.periods)?;
    let odd = asked.periods % 2 == 1;
    if asked.symmetric == Some(true) && !(family.mirrors && odd) {
        let rule = if odd {
            "the mirror image of a motion is one only with like walls and a level line of motion"
        } else {
            "an orbit of an even number of periods is never its own mirror image half a cycle later"
        };
        return Err(Invalid::new("symmetric", "True", rule));
    }
    let found = with_member!(&family.member, |it| found(&family, it, (spec, asked), cancel));
    match found {
        Err(Missed::Invalid(invalid)) => Err(invalid),
        other => Ok(other),
    }
}

/// The orbit near a trajectory, with all that is told of it.
fn found<S: OfMember + Iterated + Clone>(
    family: &Family,
    trajectory: &Trajectory<S>,
    (spec, asked): (&Spec, Asked),
    cancel: &AtomicBool,
) -> Result<Found, Missed> {
    let cancel = Some(cancel);
    let trajectory = settled(trajectory, family.period, asked.settle, cancel)?;
    let odd = asked.periods % 2 == 1;
    let orbit = match asked.symmetric {
        Some(true) => find(&trajectory, true, cancel)?,
        _ if !(family.mirrors && odd) => find(&trajectory, false, cancel)?,
        Some(false) => find_any(&trajectory, cancel)?,
        None => find_either(&trajectory, cancel)?,
    };
    let walls_of_start = walls(&trajectory, cancel)?;
    let begin = trajectory.cycle.begin;
    let found = told(family, begin, (&orbit, asked.periods), cancel)?;
    let found = Found { walls_of_start, ..found };
    let Some(to_twice) = asked.verify else { return Ok(found) };
    let seen_at = SeenAt::new(begin, (&orbit, asked.periods));
    let cycles = [0.0, seen_at.shift].map(|shift| seen_at.cycles + shift);
    let exact = to_twice(spec, (S::in_doubles(&orbit), asked.periods), cycles, cancel)?;
    let Events { impacts, episodes } = exact.seen.events;
    let description = Description { impacts, episodes, ..Description::default() };
    let sampled = (&exact.seen.states[..], &exact.seen.modes[..]);
    let (course, mirrored) = seen_at.courses(family, sampled, &description)?;
    let (residual, error) = (exact.residual, Some(exact.error));
    Ok(Found { course, mirrored, residual, error, ..found })
}

/// How an orbit is seen: from an instant that sets the phase of the drive on.
struct SeenAt {
    /// The instant.
    begin: f64,
    /// The length of a cycle.
    length: f64,
    /// Number of cycles after which the orbit is seen at that phase: its section may be some cycles later, as each search moves it on.
    cycles: f64,
    /// The mirror image is minus the motion this part of a cycle later.
    shift: f64,
}

impl SeenAt {
    /// Of an orbit of so many periods.
    fn new<S: Coordinates>(begin: f64, (orbit, periods): (&Orbit<S>, u32)) -> Self {
        let Cycle { begin: section, length } = orbit.trajectory.cycle;
        let cycles = ((section - begin) / length).ceil().max(1.0);
        let odd = !periods.is_multiple_of(2);
        let shift = if odd { 0.5 } else { 0.5 / f64::from(periods) };
        Self { begin, length, cycles, shift }
    }

    /// The instants at which the state and that of the mirror image are taken.
    fn instants(&self) -> [f64; 2] {
        let later = self.begin + self.cycles * self.length;
        [later, later + self.shift * self.length]
    }

    /// The orbit and its mirror image, from the states at these instants and the events of a cycle.
    fn courses(
        &self,
        family: &Family,
        (states, modes): (&[State], &[Vec<Point>]),
        description: &Description,
    ) -> Result<(Course, Option<Course>), Missed> {
        let each = family.middles.len();
        let ([at, later], [modes, later_modes]) =
            (&states.chunks(each).collect::<Vec<_>>()[..], modes)
        else {
            return Err(Missed::Cycle(Outcome::NotFinite));
        };
        let Self { begin, length, .. } = *self;
        let course = |moment: (Moment<'_>, bool), description: Description| {
            let description = description.seen_from(begin, length);
            family.course(begin, moment, &description, length)
        };
        let image = || {
            let moment = Moment { states: later, modes: later_modes };
            course((moment, true), description.clone().mirrored(self.shift * length))
        };
        let moment = Moment { states: at, modes };
        let own = course((moment, false), description.clone())?;
        Ok((own, family.mirrors.then(image).transpose()?))
    }
}

/// All that is told of an orbit of so many periods, seen from an instant that sets the phase of the drive.
fn told<S: Coordinates + Clone>(
    family: &Family,
    begin: f64,
    (orbit, periods): (&Orbit<S>, u32),
    cancel: Option<&AtomicBool>,
) -> Result<Found, Missed> {
    let description = describe(orbit, cancel)?;
    let spectrum = spectrum(orbit, &description, cancel)?;
    let length = orbit.trajectory.cycle.length;
    let seen_at = SeenAt::new(begin, (orbit, periods));
    let Sampler { states, modes, .. } = sampled(&orbit.trajectory, &seen_at.instants(), cancel)?;
    let sampled = (&states[..], &modes.unwrap_or_default()[..]);
    let (course, mirrored) = seen_at.courses(family, sampled, &description)?;
    let scale = &family.scale;
    Ok(Found {
        course,
        mirrored,
        length: scale.time(length),
        walls_of_start: description.walls(length),
        least_periods: least_periods(orbit, periods, cancel)?,
        symmetric: orbit.symmetric,
        spectrum,
        stable: orbit.is_stable(),
        residual: orbit.residual,
        error: None,
        amplitude: description.amplitude,
        grazing_margin: description.grazing_margin,
        approach_speeds: description
            .approach_speeds
            .map(|it| it.map(|speed| scale.velocity(speed))),
    })
}

/// The trajectory after some periods of the drive.
fn settled<S: Coordinates + Iterated + Clone>(
    trajectory: &Trajectory<S>,
    period: f64,
    settle: u64,
    cancel: Option<&AtomicBool>,
) -> Result<Trajectory<S>, Missed> {
    if settle == 0 {
        return Ok(trajectory.clone());
    }
    let cycle = Cycle { length: period, ..trajectory.cycle };
    let single = [Trajectory { cycle, ..trajectory.clone() }];
    let (mut count, mut last, mut outcome) = (0, trajectory.state, Outcome::Cancelled);
    iterate(&single, Request { tangents: false, cancel }, &mut |_, image| {
        (count, last, outcome) = (count + 1, image.state, image.outcome);
        if count < settle { Continue(()) } else { Break(()) }
    })?;
    match outcome {
        Outcome::Finished if count == settle => Ok(trajectory.from(&last)),
        Outcome::Finished => Err(Missed::Cycle(Outcome::Cancelled)),
        outcome => Err(Missed::Cycle(outcome)),
    }
}

/// Shows the run of a trajectory up to an instant to an observer.
fn shown<S: Coordinates>(
    trajectory: &Trajectory<S>,
    instant: f64,
    cancel: Option<&AtomicBool>,
    observer: &mut impl Observer<S>,
) -> Result<(), Missed> {
    let Trajectory { system, state, cycle, .. } = trajectory;
    let from = Instant { time: Clock::new(cycle.begin), state: *state };
    let limits = Limits::new(instant, system.clearance());
    match resume(system, &from, &limits, cancel, observer)?.outcome {
        Outcome::Finished => Ok(()),
        outcome => Err(Missed::Cycle(outcome)),
    }
}

/// The states of a trajectory at increasing instants.
fn sampled<S: Coordinates>(
    trajectory: &Trajectory<S>,
    instants: &[f64],
    cancel: Option<&AtomicBool>,
) -> Result<Sampler, Missed> {
    let mut sampler = Sampler::with_modes(instants.to_vec());
    let last = instants.last().copied().unwrap_or(trajectory.cycle.begin);
    shown(trajectory, last, cancel, &mut sampler)?;
    Ok(sampler)
}

/// The walls that a run over one cycle meets.
fn walls<S: Coordinates>(
    trajectory: &Trajectory<S>,
    cancel: Option<&AtomicBool>,
) -> Result<String, Missed> {
    let Cycle { begin, length } = trajectory.cycle;
    let mut events = Events::default();
    shown(trajectory, begin + length, cancel, &mut events)?;
    let Events { impacts, episodes } = events;
    let description = Description { impacts, episodes, ..Description::default() };
    Ok(description.walls(length))
}

/// By how much a state may differ from an equal one, over its size.
const SAME: f64 = 1e-8;

/// The least number of periods after which an orbit of so many periods repeats.
fn least_periods<S: Coordinates>(
    orbit: &Orbit<S>,
    periods: u32,
    cancel: Option<&AtomicBool>,
) -> Result<u32, Missed> {
    let Trajectory { system, state, cycle: Cycle { begin, length }, .. } = &orbit.trajectory;
    let at = system.point(state);
    for divisor in (1..periods).filter(|divisor| periods.is_multiple_of(*divisor)) {
        let share = f64::from(divisor) / f64::from(periods);
        let later = Limits::new(begin + length * share, system.clearance());
        let from = Instant { time: Clock::new(*begin), state: *state };
        let end = resume(system, &from, &later, cancel, &mut ())?.state;
        if (system.point(&end) - &at).amax() <= SAME * at.amax().max(system.clearance()) {
            return Ok(divisor);
        }
    }
    Ok(periods)
}
