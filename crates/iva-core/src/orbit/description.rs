//! What a run over one cycle of a periodic orbit shows: its events, its largest displacement, and how close it comes to a
//! grazing.

use std::sync::atomic::AtomicBool;

use super::Cycle;
use super::coordinates::Coordinates;
use super::margins::margin_of;
use super::periodic::{Missed, Orbit, reached};
use crate::absorber::Wall;
use crate::absorber::impact::Impact;
use crate::engine::observe::{Contact, Events, Observer, Span, StickEpisode};
use crate::engine::simulate::Instant;
use crate::segment::flight::{Motion, Travel};
use crate::segment::polynomial::{jet, largest, turned, turnings};
use crate::segment::quadrature::{node, weight};

/// Number of nodes of the quadrature in a span.
const NODES: usize = 9;
/// At most so far from a wall, over the clearance, the absorber is on it: the band of rounding of a contact.
const ON_WALL: f64 = 16.0 * f64::EPSILON;

/// One cycle of a periodic orbit, in natural units.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Description {
    /// Its listed impacts in order of time.
    pub impacts: Vec<Impact>,
    /// Its stick episodes in order of the instant of their stick.
    pub episodes: Vec<StickEpisode>,
    /// Largest |x|; `None` if the motion has no power series.
    pub amplitude: Option<f64>,
    /// The smallest distance of an extremum of y between impacts to a wall, those within the chatters of stick episodes
    /// apart: it is 0 at a grazing. Where the absorber leaves a wall from rest, there is none. `None` if there is no such extremum.
    pub grazing_margin: Option<f64>,
    /// The smallest and the largest approach speed of its impacts; with a stick episode there is no smallest one.
    pub approach_speeds: [Option<f64>; 2],
    /// ∫ of [`Coordinates::contraction`] over the cycle; `None` with a stick episode, too.
    pub contraction: Option<f64>,
}

/// The description of a periodic orbit, from one more run over its cycle.
///
/// # Errors
/// [`Missed`] if that run does not end.
pub fn describe<S: Coordinates>(
    orbit: &Orbit<S>,
    cancel: Option<&AtomicBool>,
) -> Result<Description, Missed> {
    let Cycle { begin, length } = orbit.trajectory.cycle;
    let mut seen = (Events::default(), Extrema::default());
    reached(&orbit.trajectory, begin + length, cancel, &mut seen)?;
    let (Events { impacts, episodes }, extrema) = seen;
    let speeds = || impacts.iter().map(Impact::approach_speed);
    let smallest = speeds().reduce(f64::min).filter(|_| episodes.is_empty());
    let approach_speeds = [smallest, speeds().reduce(f64::max)];
    let contraction = extrema.contraction.filter(|_| episodes.is_empty());
    let amplitude = (!extrema.unknown).then_some(extrema.amplitude);
    let chatters =
        |time: f64| episodes.iter().any(|it| (it.start_time..=it.stick_time).contains(&time));
    let between = extrema.turns.iter().filter(|(time, _)| !chatters(*time));
    let grazing_margin = between.map(|(_, distance)| *distance).reduce(f64::min);
    Ok(Description { impacts, episodes, amplitude, grazing_margin, approach_speeds, contraction })
}

impl Description {
    /// The same cycle from another instant on: every event is moved by whole cycles into the cycle that begins there, an
    /// episode with its stick.
    #[must_use]
    pub fn seen_from(mut self, instant: f64, length: f64) -> Self {
        let later = |time: f64| -((time - instant) / length).floor() * length;
        for impact in &mut self.impacts {
            impact.time += later(impact.time);
        }
        for episode in &mut self.episodes {
            let shift = later(episode.stick_time);
            episode.start_time += shift;
            episode.stick_time += shift;
            episode.release_time = episode.release_time.map(|time| time + shift);
        }
        self.impacts.sort_by(|a, b| a.time.total_cmp(&b.time));
        self.episodes.sort_by(|a, b| a.stick_time.total_cmp(&b.stick_time));
        self
    }

    /// The mirror image of the cycle: every event comes earlier by a time, at the other wall, with the other sign.
    #[must_use]
    pub fn mirrored(mut self, earlier: f64) -> Self {
        for impact in &mut self.impacts {
            *impact = Impact {
                time: impact.time - earlier,
                wall: impact.wall.opposite(),
                displacement: -impact.displacement,
                velocity_before: -impact.velocity_before,
                velocity_after: -impact.velocity_after,
                gap_velocity_before: -impact.gap_velocity_before,
                gap_velocity_after: -impact.gap_velocity_after,
                ..*impact
            };
        }
        for episode in &mut self.episodes {
            episode.wall = episode.wall.opposite();
            episode.start_time -= earlier;
            episode.stick_time -= earlier;
            episode.release_time = episode.release_time.map(|time| time - earlier);
        }
        self
    }

    /// The walls in order of time: `+` or `-` for an impact, and `(+)` or `(-)` for a stick episode with all its impacts,
    /// where its stick begins; of several absorbers each with the number of its absorber before it.
    pub fn walls(&self, length: f64) -> String {
        let within = |impact: &Impact, episode: &StickEpisode| {
            // The chatter may have begun in the cycle before.
            let since = (impact.time - episode.start_time).rem_euclid(length);
            let same = impact.absorber == episode.absorber;
            same && since <= episode.stick_time - episode.start_time
        };
        let single = |impact: &&Impact| !self.episodes.iter().any(|it| within(impact, it));
        let of = self.impacts.iter().map(|it| it.absorber);
        let several = of.chain(self.episodes.iter().map(|it| it.absorber)).any(|it| it > 0);
        let sign = |wall: Wall, absorber: u8| {
            let sign = if wall == Wall::Plus { "+" } else { "-" };
            if several { format!("{absorber}{sign}") } else { sign.to_owned() }
        };
        let impacts = self.impacts.iter().filter(single);
        let mut marks: Vec<(f64, String)> =
            impacts.map(|impact| (impact.time, sign(impact.wall, impact.absorber))).collect();
        let sticks = self.episodes.iter();
        marks.extend(sticks.map(|it| (it.stick_time, format!("({})", sign(it.wall, it.absorber)))));
        marks.sort_by(|a, b| a.0.total_cmp(&b.0));
        marks.into_iter().map(|(_, mark)| mark).collect()
    }
}

/// An observer of the extrema between impacts, and of the contraction.
#[derive(Debug, Default)]
struct Extrema {
    amplitude: f64,
    /// The instant of each extremum of y, and its distance to the closer wall.
    turns: Vec<(f64, f64)>,
    contraction: Option<f64>,
    /// ẏ of each absorber at the end of the last span, if it was one of the flight that goes on.
    rates: Vec<Option<f64>>,
    /// True if a motion had no power series.
    unknown: bool,
}

impl Extrema {
    /// An extremum; after a contact or a ride that on the wall is none, as the absorber begins there.
    fn turn<S: Coordinates>(&mut self, system: &S, absorber: usize, time: f64, y: f64) {
        let y = y - system.offset_of(absorber);
        let distance = [Wall::Minus, Wall::Plus].map(|wall| margin_of(system, absorber, wall, y));
        let distance = distance[0].min(distance[1]);
        let off = distance.abs() > ON_WALL * system.clearance_of(absorber);
        if self.rates[absorber].is_some() || off {
            self.turns.push((time, distance));
        }
    }

    /// A span of flight of an absorber from an instant on, of length t in units of the power series.
    fn flight<S: Coordinates>(
        &mut self,
        system: &S,
        absorber: usize,
        travel: &Travel,
        [from, t]: [f64; 2],
    ) {
        let gap = &travel.gap[..=travel.rows.order];
        let [y, begin, ..] = jet(gap, 0.0);
        // An extremum where two spans meet.
        if self.rates[absorber].is_some_and(|rate| (rate > 0.0) != (begin > 0.0)) {
            self.turn(system, absorber, from, y);
        }
        for bracket in turnings(gap, t) {
            let (at, y) = turned(|t| jet(gap, t), bracket);
            self.turn(system, absorber, from + at * travel.rows.step, y);
        }
        self.rates[absorber] = Some(jet(gap, t)[1]);
    }

    /// ∫ of the contraction over a span, by the gap displacement of the first absorber.
    fn contract<S: Coordinates>(&mut self, system: &S, travel: &Travel, t: f64) {
        let gap = &travel.gap[..=travel.rows.order];
        let node = |n: usize| {
            let y = jet(gap, node::<f64, NODES>(n, [0.0, t]))[0];
            Some(system.contraction(y)? * weight::<f64, NODES>(n))
        };
        let mean = (0..NODES).map(node).sum::<Option<f64>>();
        let before = self.contraction;
        self.contraction = before.zip(mean).map(|(sum, mean)| sum + mean * t * travel.rows.step);
    }
}

impl<S: Coordinates> Observer<S> for Extrema {
    fn start(&mut self, system: &S, _from: &Instant<S::State>, _duration: f64) {
        let rates = vec![None; system.absorbers().max(1)];
        *self = Self { contraction: Some(0.0), rates, ..Self::default() };
    }

    fn span<M: Motion<Real = f64, State = S::State>>(&mut self, system: &S, span: &Span<'_, M>) {
        let Some(travel) = span.motion.travel() else {
            (self.unknown, self.contraction) = (true, None);
            return;
        };
        let t = span.length / travel.rows.step;
        self.amplitude = largest(&travel.rows.x[..=travel.rows.order], [0.0, t], self.amplitude);
        if M::RIDING {
            self.rates.fill(None);
            return;
        }
        self.contract(system, &travel, t);
        if self.rates.len() == 1 {
            return self.flight(system, 0, &travel, [span.start.value, t]);
        }
        for absorber in 0..self.rates.len() {
            let flies = span.motion.wall_of(absorber).is_none();
            match span.motion.travel_of(absorber).filter(|_| flies) {
                Some(travel) => self.flight(system, absorber, &travel, [span.start.value, t]),
                None => self.rates[absorber] = None,
            }
        }
    }

    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State>) {
        self.rates[system.at_hand(contact.states[0])] = None;
    }
}
