//! What a run over one cycle shows of an orbit: its sequence of events, and which of them is next to change.

use super::super::super::Cycle;
use super::super::super::conditions::Condition;
use super::super::super::description::Description;
use super::super::super::periodic::Rubbing;
use crate::absorber::Wall;
use crate::absorber::impact::Impact;
use crate::engine::observe::StickEpisode;

/// The section is moved where its flight is shorter than this share of the longest one, or it is nearer than this share to
/// an end of it.
const SHORT: f64 = 0.5;
const NEAR: f64 = 0.2;

/// The events of a cycle: impacts in their order, those and the rides of each member in its own, and how often members come to
/// rest in their gaps and slip. Rides of two members that begin at one instant are no change.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sequence {
    impacts: String,
    each: Vec<String>,
    rubs: [usize; 2],
}

impl Sequence {
    /// That of a cycle of this length.
    pub fn of(cycle: &Description, rubbing: &Rubbing, length: f64) -> Self {
        let own = |absorber: u8| {
            let mut own = cycle.clone();
            own.impacts.retain(|it| it.absorber == absorber);
            own.episodes.retain(|it| it.absorber == absorber);
            own.walls(length)
        };
        let all = cycle.impacts.iter().map(|it| it.absorber);
        let last = all.chain(cycle.episodes.iter().map(|it| it.absorber)).max();
        let single = Description { episodes: vec![], ..cycle.clone() };
        Self {
            impacts: single.walls(length),
            each: last.map_or(vec![], |last| (0..=last).map(own).collect()),
            rubs: [rubbing.stops.len(), rubbing.slips.len()],
        }
    }

    /// True if another differs by what rubs.
    pub fn rubs_otherwise(&self, other: &Self) -> bool {
        self.rubs != other.rubs
    }
}

/// The smallest time between two events of which one follows the other, over the cycle.
fn soonest(mut marks: Vec<(f64, bool)>, length: f64) -> f64 {
    marks.sort_by(|a, b| a.0.total_cmp(&b.0));
    let first = marks.first().copied();
    marks.extend(first.map(|(time, kind)| (time + length, kind)));
    let unlike = marks.windows(2).filter(|pair| pair[0].1 != pair[1].1);
    unlike.map(|pair| (pair[1].0 - pair[0].0) / length).fold(f64::INFINITY, f64::min)
}

/// A cycle in which a ride stands for all that follow at the same wall, and for their chatters, and a chatter for its first
/// impact: a mass that another one shakes may come off its wall and back very often, and how often is no event of a branch.
pub(super) fn collapsed(mut cycle: Description) -> Description {
    let mut kept: Vec<(StickEpisode, f64)> = Vec::new();
    for ride in &cycle.episodes {
        let last = kept.iter_mut().rev().find(|(it, _)| it.absorber == ride.absorber);
        match last.filter(|(it, _)| it.wall == ride.wall) {
            Some((first, stick)) if !apart(&cycle, (first, *stick), ride) => {
                first.release_time = ride.release_time;
                *stick = ride.stick_time;
            }
            _ => kept.push((*ride, ride.stick_time)),
        }
    }
    let within = |it: &Impact| {
        let own = kept.iter().filter(|(ride, _)| ride.absorber == it.absorber);
        own.into_iter().any(|(ride, stick)| it.time > ride.start_time && it.time <= *stick)
    };
    cycle.impacts.retain(|it| !within(it));
    cycle.episodes = kept.into_iter().map(|(ride, _)| ride).collect();
    cycle
}

/// True if between the last stick of a ride and another at the same wall the absorber is at the other wall.
fn apart(cycle: &Description, (first, stick): (&StickEpisode, f64), next: &StickEpisode) -> bool {
    let own = cycle.impacts.iter().filter(|it| it.absorber == first.absorber);
    own.into_iter().any(|it| it.wall != first.wall && it.time > stick && it.time < next.stick_time)
}

/// The smallest approach speed.
pub(super) fn slowest(cycle: &Description) -> f64 {
    cycle.impacts.iter().map(Impact::approach_speed).fold(f64::INFINITY, f64::min)
}

/// The smallest of the numbers that vanish where the sequence of events changes, and what happens there. Speeds and durations of
/// rides vanish as roots of the way to that point, or faster: so their squares are compared with margins and times between
/// events.
pub(super) fn nearest(
    description: &Description,
    rubbing: &Rubbing,
    (slowest, margin): (f64, f64),
    length: f64,
) -> (f64, Condition) {
    let rides = description.episodes.iter();
    let ride = rides.filter_map(|it| Some((it.release_time? - it.stick_time) / length));
    let ride = ride.fold(f64::INFINITY, f64::min);
    let single = |absorber: u8| {
        let all = description.impacts.iter();
        soonest(all.map(|it| (it.time, it.absorber == absorber)).collect(), length)
    };
    let absorbers = description.impacts.iter().map(|it| it.absorber).max().unwrap_or(0);
    let meeting = (0..absorbers).map(single).fold(f64::INFINITY, f64::min);
    let stops = rubbing.stops.iter().map(|it| (*it, true));
    let rubbed =
        soonest(stops.chain(rubbing.slips.iter().map(|it| (*it, false))).collect(), length);
    // A stop that comes at the instant of an impact of another one, too.
    let struck = description.impacts.iter().map(|it| (it.time, false));
    let stops = rubbing.stops.iter().map(|it| (*it, true));
    let rubbed = (rubbed * rubbed).min(soonest(stops.chain(struck).collect(), length));
    let rubbed = rubbing.weakest.map_or(rubbed, |weakest| rubbed.min(weakest));
    let all = [
        (slowest * slowest, Condition::ImpactVanishes { impact: 0 }),
        (margin, Condition::Grazing { flight: 0, wall: Wall::Plus }),
        (ride * ride, Condition::StickBegins { impact: 0 }),
        (meeting, Condition::ImpactsCoincide),
        (rubbed, Condition::SlideChanges),
    ];
    let none = (f64::INFINITY, Condition::SlideChanges);
    all.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or(none)
}

/// How much of a cycle later a better section is: the middle of the longest flight between two events or, without impacts, of the
/// longest slide; `None` where it is well placed.
pub(super) fn section(
    description: &Description,
    rubbing: &Rubbing,
    Cycle { begin, length }: Cycle,
) -> Option<f64> {
    let impacts = description.impacts.iter().map(|impact| (impact.time, true));
    let rides = description.episodes.iter();
    let rides = rides.flat_map(|it| [(Some(it.stick_time), false), (it.release_time, true)]);
    let rides = rides.filter_map(|(time, flies)| Some((time?, flies)));
    let share = |time: f64| ((time - begin) / length).rem_euclid(1.0);
    let mut marks: Vec<_> = impacts.chain(rides).collect();
    if marks.is_empty() {
        marks = rubbing.marks();
    }
    marks.iter_mut().for_each(|(time, _)| *time = share(*time));
    marks.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (first, last) = (*marks.first()?, *marks.last()?);
    marks.push((first.0 + 1.0, first.1));
    let flights = marks.windows(2).filter(|pair| pair[0].1);
    let longest = flights.max_by(|a, b| (a[1].0 - a[0].0).total_cmp(&(b[1].0 - b[0].0)))?;
    let [from, to] = [longest[0].0, longest[1].0];
    let [before, after] = [1.0 - last.0, first.0];
    let own = before + after;
    let placed = last.1 && own > SHORT * (to - from) && before.min(after) > NEAR * own;
    (!placed).then(|| (0.5 * (from + to)).fract())
}
