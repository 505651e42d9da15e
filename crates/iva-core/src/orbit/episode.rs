//! The stick episodes of a chain: chatter, stick and release, as the event loop runs them.
//!
//! An episode begins with the state after its first impact and ends at its release, which is an output of the run, as are
//! all its other impacts: their number may change from orbit to orbit. The motion after the release depends
//! smoothly on the state at the begin as long as the chatter ends in stick and meets its own wall only, and each of
//! its rebounds goes over into one of the next orbit.
//!
//! Where the chatter would end at the instant at which the wall stops to press, the stick *begins*: beyond, the
//! absorber leaves the wall before it sticks. The time that it sticks goes to 0 as a power < 1 of the distance to that orbit,
//! so that no equation for it is smooth. At that orbit itself the rebounds become similar to each other: where the wall
//! presses with J τ at a time τ before it stops to press, and the absorber leaves it with a speed u, a rebound lasts h τ with
//! u = J τ² (h/2 − h²/6), and returns with J τ² (h/2 − h²/3). The next one is similar if
//!
//! ```text
//! e (1/2 − h/3) = (1/2 − h/6) (1 − h)²,
//! ```
//!
//! and then is shorter by the factor 1 − h. Next to that orbit the ratios of the rebounds go away from this factor, towards
//! e if the absorber sticks, upwards if it does not. So the side on which an orbit is can be seen in a late rebound, long
//! before the chatter ends.

use nalgebra::Matrix4;

use super::chain::Flown;
use super::coordinates::Coordinates;
use crate::absorber::{Clock, Wall};
use crate::engine::observe::{Contact, Observer};
use crate::engine::simulate::{Instant, Limits, Outcome, resume};
use crate::measures::propagation::Tangent;

/// Rebounds that last less than this share of the longest one of a chatter are not compared with those of another.
const SHORT: f64 = 0.02;
/// Whether a chatter ends in stick is seen in its last rebound that lasts longer than this share of the first: what the
/// ratio of two rebounds differs from its limit by is then rounding, as it falls as a power > 2 of the time.
const LATE: f64 = 1e-6;
/// Largest ratio of the times that a rebound takes in two neighbouring orbits.
const ALIKE: f64 = 1.25;

/// A stick episode, run from the state after its first impact.
pub(super) struct Ridden<State> {
    /// The flights between its impacts, without those of a chatter that is summed.
    pub rebounds: Vec<Flown<State>>,
    /// The ride on the wall.
    pub ride: Flown<State>,
    /// The state at the release, and its instant.
    pub released: State,
    pub release: Clock,
    /// The derivative of the state just after the release with respect to that at the begin, at fixed instants.
    pub tangent: Matrix4<f64>,
}

/// Why there is no episode.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Lapse {
    /// The run did not get so far, or there is no state to begin with.
    Undefined,
    /// The absorber leaves the wall and does not stick.
    Leaves(Left),
}

/// A chatter that does not end in stick.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Left {
    /// The index of its first impact.
    pub impact: usize,
    /// How long each rebound lasts.
    pub rebounds: Vec<f64>,
    /// The time from the first impact to the other wall, if it is met, and that wall.
    pub met: Option<(f64, Wall)>,
}

/// The instants of an episode, from its first impact on.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Episode {
    /// The index of that impact, its wall and its instant.
    pub impact: usize,
    pub wall: Wall,
    pub begin: f64,
    /// How long each rebound lasts that was not summed.
    pub rebounds: Vec<f64>,
    /// The time until the absorber sticks, and until it is released.
    pub stick: f64,
    pub release: f64,
}

impl Episode {
    /// How long the absorber sticks.
    pub fn duration(&self) -> f64 {
        self.release - self.stick
    }

    /// True if the rebounds go over into those of the same episode of a neighbouring orbit: none has come or gone between
    /// them, but at the end of the chatter.
    pub fn goes_over_into(&self, other: &Self) -> bool {
        let longest = |of: &Self| of.rebounds.iter().copied().fold(0.0, f64::max);
        let short = SHORT * longest(self).max(longest(other));
        let mut pairs = self.rebounds.iter().zip(&other.rebounds);
        pairs.all(|(&a, &b)| a.max(b) < short || a.max(b) < ALIKE * a.min(b))
    }
}

/// By how much each rebound is shorter than the one before, where the chatter ends as the wall stops to press, with this
/// restitution.
fn similar(restitution: f64) -> f64 {
    let [mut low, mut high] = [0.0, 1.0];
    for _ in 0..60 {
        let h = 0.5 * (low + high);
        let returns = restitution * (0.5 - h / 3.0);
        let leaves = (0.5 - h / 6.0) * (1.0 - h) * (1.0 - h);
        if returns < leaves { low = h } else { high = h }
    }
    1.0 - low
}

/// Where in a chatter it is seen whether it ends in stick: the index of a late rebound.
#[derive(Debug, Clone, Copy)]
pub(super) struct Late {
    pub index: usize,
    pub restitution: f64,
}

impl Late {
    /// That of a chatter that ends in stick; `None` if it is too short.
    pub fn of(episode: &Episode, restitution: f64) -> Option<Self> {
        let all = &episode.rebounds;
        let least = LATE * all.first()?;
        let index = all.iter().rposition(|length| *length > least)?;
        let late = Self { index, restitution };
        late.sticks(all).then_some(late)
    }

    /// True if a chatter with these rebounds goes on to stick.
    pub fn sticks(&self, rebounds: &[f64]) -> bool {
        let pair = self.index.checked_sub(1).and_then(|before| rebounds.get(before..=self.index));
        pair.is_some_and(|pair| pair[1] < similar(self.restitution) * pair[0])
    }
}

/// An observer of the rebounds on one wall, the stick and the release.
struct Watch<State> {
    wall: Wall,
    rebounds: Vec<Flown<State>>,
    stick: Option<Instant<State>>,
    release: Option<Instant<State>>,
    astray: Option<(f64, Wall)>,
}

impl<S: Coordinates> Observer<S> for Watch<S::State> {
    fn looks_within(&self) -> bool {
        false
    }

    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State>) {
        let Contact { time, states: [before, after], summed } = *contact;
        if summed {
            return;
        }
        let wall = system.wall(before);
        if wall != self.wall {
            self.astray = Some((time, wall));
            return;
        }
        let next = match self.rebounds.last_mut() {
            Some(last) => {
                last.length = time - last.begin;
                Flown { from: *after, begin: time, ..last.clone() }
            }
            None => return,
        };
        self.rebounds.push(next);
    }

    fn stick(&mut self, _system: &S, from: &Instant<S::State>) {
        self.stick.get_or_insert(*from);
    }

    fn release(&mut self, _system: &S, from: &Instant<S::State>) {
        self.release.get_or_insert(*from);
    }

    fn is_done(&self) -> bool {
        self.release.is_some() || self.astray.is_some()
    }
}

impl<State: Copy> Ridden<State> {
    /// The episode from a state on its wall, after the impact of an index, between that instant and the next impact.
    pub fn new<S: Coordinates<State = State>>(
        system: &S,
        from: &State,
        impact: usize,
        [begin, until]: [f64; 2],
    ) -> Result<Self, Lapse> {
        let first = Flown { after: impact, from: *from, begin, length: 0.0 };
        let watch = Watch {
            wall: system.wall(from),
            rebounds: vec![first],
            stick: None,
            release: None,
            astray: None,
        };
        let mut seen = (Tangent::default(), watch);
        let from = Instant { time: Clock::new(begin), state: *from };
        let limits = Limits::new(until, system.clearance());
        let tally = resume(system, &from, &limits, None, &mut seen);
        let outcome = tally.map_err(|_| Lapse::Undefined)?.outcome;
        let (tangent, Watch { mut rebounds, stick, release, astray, .. }) = seen;
        let left = |mut rebounds: Vec<Flown<State>>, met| {
            rebounds.pop();
            let rebounds = rebounds.iter().map(|flown| flown.length).collect();
            Err(Lapse::Leaves(Left { impact, rebounds, met }))
        };
        if let Some((time, wall)) = astray {
            return left(rebounds, Some((time - begin, wall)));
        }
        match (outcome, stick, release) {
            (Outcome::Finished | Outcome::Stopped, Some(stick), Some(release)) => {
                let Instant { time, state } = stick;
                // After the last impact nothing is left of the chatter, or it is summed.
                rebounds.pop();
                let length = (release.time - time).value;
                let ride = Flown { after: impact, from: state, begin: time.value, length };
                let tangent = *tangent.derivative();
                let Instant { time: release, state: released } = release;
                Ok(Self { rebounds, ride, released, release, tangent })
            }
            (Outcome::Finished, None, None) => left(rebounds, None),
            _ => Err(Lapse::Undefined),
        }
    }

    /// Its instants.
    pub fn episode(&self, impact: usize, wall: Wall, begin: f64) -> Episode {
        Episode {
            impact,
            wall,
            begin,
            rebounds: self.rebounds.iter().map(|flown| flown.length).collect(),
            stick: self.ride.begin - begin,
            release: self.release.value - begin,
        }
    }
}
