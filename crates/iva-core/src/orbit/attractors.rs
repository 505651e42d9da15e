//! Attractors: what many starts end in, and how often.
//!
//! A trajectory is followed from strobe to strobe. Where strobes repeat after n cycles, Newton's method finds the orbit
//! that they settle on ([`periodic::find`](super::periodic::find)); trajectories on the same orbit are counted together,
//! whichever of its n strobes they have come to. A motion without impacts is a class of its own: the absorber may stand
//! anywhere in its gap. What does not repeat is aperiodic (a torus, chaos, a modulated response; exponents tell which,
//! [`lyapunov`](super::lyapunov)), or has a transient that is longer than the trajectory.

use std::ops::ControlFlow::{self, Break, Continue};
use std::sync::atomic::AtomicBool;

use super::coordinates::{Coordinates, Strobe};
use super::periodic::{Orbit, find, reached};
use super::{Cycle, Image, Iterated, Request, Trajectory, iterate, map};
use crate::absorber::Clock;
use crate::engine::simulate::Outcome;
use crate::error::Invalid;

/// Strobes whose distance over the size of the state is at most this repeat.
const REPEATS: f64 = 1e-7;
/// A trajectory whose strobes repeat is on an orbit that is at most this far, over the size of the state: the distance left
/// is that of two strobes over 1 − |λ|.
const NEAR: f64 = 1e-4;
/// Number of cycles until Newton's method is tried again, after it has found no stable orbit nearby.
const AGAIN: u64 = 64;
/// Most cycles of an orbit that is sought.
const MOST_PERIODS: u32 = 1000;

/// What is sought.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Search {
    /// Most cycles of an orbit.
    pub most_periods: u32,
    /// Most cycles of a trajectory. Transients can be very long.
    pub most_cycles: u64,
    /// True if orbits that are mirror images of each other, half a cycle later, count as one. The drive must change its sign after half
    /// a cycle, the walls be alike and the motion level.
    pub join_mirrored: bool,
}

/// What a trajectory has ended in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// The periodic attractor with this index.
    Periodic(usize),
    /// A motion without impacts.
    NoImpacts,
    /// Its strobes did not repeat.
    Aperiodic,
    /// A cycle did not end.
    Unfinished(Outcome),
}

/// A stable periodic orbit that starts have ended in.
#[derive(Debug, Clone)]
pub struct Attractor<S: Coordinates> {
    /// The orbit.
    pub orbit: Orbit<S>,
    /// Its strobes at the begin of the cycle of the starts, in order of time: as many as it has cycles.
    pub strobes: Vec<S::Strobe>,
    /// Those of its mirror image, if mirror images count as one.
    pub mirrored: Option<Vec<S::Strobe>>,
}

impl<S: Coordinates> Attractor<S> {
    /// Number of cycles after which it repeats.
    pub fn periods(&self) -> usize {
        self.strobes.len()
    }

    /// True if its mirror image is another orbit, which is counted with it.
    pub fn is_pair(&self, clearance: f64) -> bool {
        let first = self.mirrored.as_ref().and_then(|them| them.first());
        first.is_some_and(|strobe| {
            let near = NEAR * clearance.max(strobe.size());
            self.strobes.iter().all(|own| own.apart(strobe) > near)
        })
    }

    /// True if a strobe is as near to one of its own, or of its mirror image, as trajectories are that have come to it.
    pub fn is_near(&self, strobe: &S::Strobe, clearance: f64) -> bool {
        self.is_at(strobe, NEAR * clearance.max(strobe.size()))
    }

    /// True if a strobe is within a distance of one of its own, or of its mirror image.
    fn is_at(&self, strobe: &S::Strobe, within: f64) -> bool {
        let all = self.strobes.iter().chain(self.mirrored.iter().flatten());
        all.into_iter().any(|known| known.apart(strobe) <= within)
    }
}

/// What starts have ended in.
#[derive(Debug, Clone)]
pub struct Found<S: Coordinates> {
    /// The periodic attractors, in the order of the starts that found them.
    pub attractors: Vec<Attractor<S>>,
    /// The class of each start.
    pub classes: Vec<Class>,
}

/// How many starts have ended in a class.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Their number.
    pub count: usize,
    /// Their number over that of all starts.
    pub share: f64,
    /// Its binomial standard error.
    pub standard_error: f64,
}

impl<S: Coordinates> Found<S> {
    /// The share of starts whose class is of a kind.
    pub fn share(&self, of: impl Fn(&Class) -> bool) -> Share {
        let count = self.classes.iter().filter(|class| of(class)).count();
        let all = self.classes.len() as f64;
        let share = count as f64 / all;
        Share { count, share, standard_error: (share * (1.0 - share) / all).sqrt() }
    }

    /// Adds what more starts of the same scene have ended in. Attractors that both have found count as one.
    pub fn join(&mut self, more: Self, clearance: f64) {
        let places: Vec<usize> =
            more.attractors.into_iter().map(|it| self.place(it, clearance)).collect();
        self.classes.extend(more.classes.into_iter().map(|class| match class {
            Class::Periodic(index) => Class::Periodic(places[index]),
            other => other,
        }));
    }

    /// The index of an attractor, which is added if it is new.
    fn place(&mut self, attractor: Attractor<S>, clearance: f64) -> usize {
        let near = |strobe: &S::Strobe| NEAR * clearance.max(strobe.size());
        let first = attractor.strobes.first();
        let at = |it: &Attractor<S>| first.is_some_and(|strobe| it.is_at(strobe, near(strobe)));
        let known = self.attractors.iter().position(at);
        known.unwrap_or_else(|| {
            self.attractors.push(attractor);
            self.attractors.len() - 1
        })
    }
}

/// The last strobes of a trajectory.
struct Strobes<T> {
    /// The strobe after k cycles is at k modulo the length.
    ring: Vec<(T, u64)>,
    count: u64,
    /// The cycle from which on Newton's method may be tried.
    next_try: u64,
}

impl<T: Strobe> Strobes<T> {
    fn back(&self, cycles: u64) -> &(T, u64) {
        &self.ring[((self.count - 1 - cycles) % self.ring.len() as u64) as usize]
    }

    /// Adds a strobe, with the impacts of the cycle before it; the number of cycles after which the strobes repeat, if they do,
    /// and the number of impacts in them.
    fn repeat(&mut self, strobe: (T, u64), clearance: f64) -> Option<(u64, u64)> {
        let place = (self.count % self.ring.len() as u64) as usize;
        self.ring[place] = strobe;
        self.count += 1;
        let now = &self.back(0).0;
        let size = clearance.max(now.size());
        let most = (self.ring.len() as u64 - 1).min(self.count - 1);
        let repeats = |n: &u64| self.back(*n).0.apart(now) <= REPEATS * size;
        let periods = (1..=most).find(repeats)?;
        Some((periods, (0..periods).map(|back| self.back(back).1).sum()))
    }
}

/// The search, and what it has found so far.
struct Searching<'a, S: Coordinates> {
    search: Search,
    cancel: Option<&'a AtomicBool>,
    attractors: Vec<Attractor<S>>,
}

impl<S: Coordinates + Clone> Searching<'_, S> {
    /// The index of the attractor that a trajectory has come to, which is new if need be; `None` if there is no stable orbit
    /// nearby.
    fn attractor(&mut self, trajectory: &Trajectory<S>, periods: u64) -> Option<usize> {
        let system = &trajectory.system;
        let strobe = system.strobe(&trajectory.state);
        let near = NEAR * system.clearance().max(strobe.size());
        let known = self.attractors.iter().position(|attractor| attractor.is_at(&strobe, near));
        if known.is_some() {
            return known;
        }
        let (orbit, strobes) = self.orbit(trajectory, periods)?;
        let join = self.search.join_mirrored;
        let mirrored = match join {
            true => Some(mirrored(trajectory, &strobes, self.cancel)?),
            false => None,
        };
        let attractor = Attractor { orbit, strobes, mirrored };
        if !attractor.orbit.is_stable() || !attractor.is_at(&strobe, near) {
            return None;
        }
        self.attractors.push(attractor);
        Some(self.attractors.len() - 1)
    }

    /// The orbit near a trajectory that repeats after some periods, and its strobes. With a multiplier close to −1 strobes
    /// seem to repeat after two periods before they do after one.
    fn orbit(
        &self,
        trajectory: &Trajectory<S>,
        periods: u64,
    ) -> Option<(Orbit<S>, Vec<S::Strobe>)> {
        let one = trajectory.cycle;
        let cycle = Cycle { length: one.length * periods as f64, ..one };
        let orbit = find(&Trajectory { cycle, ..trajectory.clone() }, false, self.cancel).ok()?;
        let strobes = strobes(&orbit, one, periods, self.cancel)?;
        let size = trajectory.system.clearance().max(strobes[0].size());
        let repeats = |n: &usize| strobes[*n].apart(&strobes[0]) <= REPEATS * size;
        let fewer = (1..strobes.len()).filter(|n| strobes.len().is_multiple_of(*n)).find(repeats);
        match fewer {
            Some(fewer) => self.orbit(trajectory, fewer as u64),
            None => Some((orbit, strobes)),
        }
    }
}

/// What one more strobe says of a trajectory.
enum Told<State> {
    /// What it ends in.
    Class(Class),
    /// At this state its strobes repeat after some cycles.
    Repeats(State, u64),
}

impl Search {
    /// What one more image says of a trajectory, if anything.
    fn told<S: Coordinates>(
        &self,
        system: &S,
        image: &Image<S::State>,
        strobes: &mut Strobes<S::Strobe>,
    ) -> Option<Told<S::State>> {
        if image.outcome != Outcome::Finished {
            return Some(Told::Class(Class::Unfinished(image.outcome)));
        }
        let strobe = (system.strobe(&image.state), image.impacts);
        match strobes.repeat(strobe, system.clearance()) {
            Some((_, 0)) => return Some(Told::Class(Class::NoImpacts)),
            Some((periods, _)) if strobes.count >= strobes.next_try => {
                strobes.next_try = strobes.count + AGAIN;
                return Some(Told::Repeats(image.state, periods));
            }
            _ => {}
        }
        (strobes.count >= self.most_cycles).then_some(Told::Class(Class::Aperiodic))
    }
}

/// The strobes of an orbit at the begin of a cycle.
pub(super) fn strobes<S: Coordinates + Clone>(
    orbit: &Orbit<S>,
    cycle: Cycle,
    periods: u64,
    cancel: Option<&AtomicBool>,
) -> Option<Vec<S::Strobe>> {
    let Trajectory { system, cycle: section, .. } = &orbit.trajectory;
    // The orbit begins in the middle of a flight: the first strobe after it.
    let later = (cycle.begin - section.begin).rem_euclid(cycle.length);
    let state = match later > 0.0 {
        true => reached(&orbit.trajectory, section.begin + later, cancel, &mut ()).ok()?,
        false => orbit.trajectory.state,
    };
    let start = system.start_of(&system.point(&state))?;
    let mut trajectory = Trajectory::new(system.clone(), &start, cycle).ok()?;
    let mut strobes = vec![];
    for _ in 0..periods {
        strobes.push(system.strobe(&trajectory.state));
        trajectory.state = map(&trajectory, false, cancel).ok()?.state;
    }
    Some(strobes)
}

/// The strobes of the mirror image of a motion, half a cycle later.
fn mirrored<S: Coordinates + Clone>(
    trajectory: &Trajectory<S>,
    strobes: &[S::Strobe],
    cancel: Option<&AtomicBool>,
) -> Option<Vec<S::Strobe>> {
    let Trajectory { system, cycle: Cycle { begin, length }, .. } = trajectory;
    let half = Cycle { begin: *begin, length: 0.5 * length };
    let one = |strobe: &S::Strobe| {
        let state = system.begin_at(&system.start_at_strobe(strobe)?, Clock::new(*begin));
        let half = Trajectory { cycle: half, ..trajectory.from(&state) };
        let image = -system.point(&map(&half, false, cancel).ok()?.state);
        Some(S::Strobe::with(image.as_slice()))
    };
    strobes.iter().map(one).collect()
}

/// What trajectories of one scene end in, which go side by side. Their cycle is that of the drive.
///
/// # Errors
/// [`Invalid`] if orbits of no cycle are sought, or a cycle has no length or begins before time zero.
pub fn attractors<S: Iterated + Coordinates + Clone>(
    trajectories: &[Trajectory<S>],
    search: Search,
    cancel: Option<&AtomicBool>,
) -> Result<Found<S>, Invalid> {
    if search.most_periods == 0 || search.most_periods > MOST_PERIODS {
        let (value, rule) =
            (search.most_periods, format!("give a number from 1 to {MOST_PERIODS}"));
        return Err(Invalid::new("most_periods", value.to_string(), rule));
    }
    let ring = vec![(S::Strobe::none(), 0); search.most_periods as usize + 1];
    let fresh = || Strobes { ring: ring.clone(), count: 0, next_try: 0 };
    let mut all: Vec<Strobes<S::Strobe>> = trajectories.iter().map(|_| fresh()).collect();
    let mut classes = vec![Class::Unfinished(Outcome::Cancelled); trajectories.len()];
    let mut searching = Searching { search, cancel, attractors: vec![] };
    let request = Request { tangents: false, cancel };
    let mut open: Vec<usize> = (0..trajectories.len()).collect();
    let mut going: Vec<Trajectory<S>> = trajectories.to_vec();
    // Orbits are sought in the order of the starts, so that the result does not depend on which trajectory is ahead.
    while !open.is_empty() {
        let mut told: Vec<Option<Told<S::State>>> = open.iter().map(|_| None).collect();
        let mut see = |k: usize, image: &Image<S::State>| -> ControlFlow<()> {
            told[k] = search.told(&going[k].system, image, &mut all[open[k]]);
            if told[k].is_none() { Continue(()) } else { Break(()) }
        };
        iterate(&going, request, &mut see)?;
        let mut left = (vec![], vec![]);
        for ((index, trajectory), told) in open.iter().zip(&going).zip(told) {
            classes[*index] = match told {
                None => Class::Unfinished(Outcome::Cancelled),
                Some(Told::Class(class)) => class,
                Some(Told::Repeats(state, periods)) => {
                    let trajectory = trajectory.from(&state);
                    match searching.attractor(&trajectory, periods) {
                        Some(attractor) => Class::Periodic(attractor),
                        None if all[*index].count >= search.most_cycles => Class::Aperiodic,
                        None => {
                            left.0.push(*index);
                            left.1.push(trajectory);
                            continue;
                        }
                    }
                }
            };
        }
        (open, going) = left;
    }
    Ok(Found { attractors: searching.attractors, classes })
}
