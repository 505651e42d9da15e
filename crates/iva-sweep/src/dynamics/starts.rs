//! Starts in the user's units, given or drawn at random.

use iva_core::absorber::{Absorber, Clock, OnStructure, Start};
use iva_core::error::{Invalid, number};
use iva_core::orbit::{Coordinates, Iterated, Strobe as _, Trajectory};
use iva_core::piva::Angles;

use super::family::{Family, Member, OfMember};
use crate::cube::{Cube, Method};
use crate::fields::FieldId;
use crate::units::Scale;

/// Displacement and velocity of the structure, then gap displacement and gap velocity of each absorber or unit.
pub type Numbers = Vec<f64>;
/// The range of each of these.
pub type Bounds = Vec<[f64; 2]>;

/// The names of the numbers of a start with one absorber.
pub const NAMES: [&str; 4] = ["displacement", "velocity", "gap_displacement", "gap_velocity"];

/// The name of the number at a place, of so many: of several absorbers with the index of the absorber, as in `gap_velocity.1`.
pub fn name_of(place: usize, count: usize) -> String {
    match place {
        0 | 1 => NAMES[place].to_owned(),
        _ if count <= NAMES.len() => NAMES[place % 2 + 2].to_owned(),
        _ => format!("{}.{}", NAMES[place % 2 + 2], place / 2 - 1),
    }
}

/// The place of the number of this name; without an index that of the first absorber.
pub fn place_of(name: &str) -> Option<usize> {
    let (name, index) = name.split_once('.').unwrap_or((name, "0"));
    let place = NAMES.iter().position(|it| *it == name)?;
    let index: usize = index.parse().ok().filter(|index| place > 1 || *index == 0)?;
    place.checked_add(index.checked_mul(2)?)
}

/// How far starts around a given one are from it, over the size of the state.
const AROUND: f64 = 1e-6;

/// Starts that are drawn at random.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// Their number.
    pub count: u64,
    /// The seed that they follow from.
    pub seed: u64,
    /// The box that they are spread evenly in.
    pub within: Within,
}

/// The box of starts.
#[derive(Debug, Clone, PartialEq)]
pub enum Within {
    /// The usual one: displacements and velocities up to those without absorber, the whole gap.
    Usual,
    /// This one.
    Given(Bounds),
    /// A small one around the start of the spec, which is the first start.
    Close,
}

/// An absorber whose states are given and shown by the four numbers of a start.
pub(super) trait Startable:
    OnStructure<State: Send + Sync> + Coordinates + Iterated + Clone + Send + Sync
{
    /// The trajectory of the same scene from other numbers, in the user's units.
    fn begun(
        like: &Trajectory<Self>,
        scale: &Scale,
        numbers: [f64; 4],
    ) -> Result<Trajectory<Self>, Invalid>;

    /// The numbers of coordinates, in the user's units.
    fn user_numbers(&self, scale: &Scale, coordinates: [f64; 4]) -> [f64; 4];
}

impl<S> Startable for S
where
    S: OnStructure<State: Send + Sync> + Coordinates + Iterated + Clone + Send + Sync,
    S::Start: From<Start>,
{
    fn begun(
        like: &Trajectory<Self>,
        scale: &Scale,
        numbers: [f64; 4],
    ) -> Result<Trajectory<Self>, Invalid> {
        let [displacement, velocity, gap_displacement, gap_velocity] = numbers;
        let natural = 1.0 / scale.velocity(1.0);
        let (velocity, gap_velocity) = (velocity * natural, gap_velocity * natural);
        let start = Start { displacement, velocity, gap_displacement, gap_velocity };
        let begun = Trajectory::new(like.system.clone(), &start.into(), like.cycle)?;
        Ok(Trajectory { tier: like.tier, ..begun })
    }

    fn user_numbers(&self, scale: &Scale, coordinates: [f64; 4]) -> [f64; 4] {
        let [x, v, y, w] = coordinates;
        // Of a pendulum the last coordinate is b θ̇, and the gap velocity b θ̇ cos θ.
        let start = self.start_at(&coordinates.into());
        let gap_velocity = start.map_or(w, |start| {
            let state = self.begin_at(&start, Clock::new(0.0));
            -self.wall(&state).sign() * self.distance(&state).rate
        });
        [x, scale.velocity(v), self.offset_of(0) + y, scale.velocity(gap_velocity)]
    }
}

impl Family {
    /// The numbers of a state, in the user's units.
    pub(super) fn numbers<S: Startable>(&self, system: &S, state: &S::State) -> Numbers {
        if !self.is_several() {
            return system.user_numbers(&self.scale, system.coordinates(state).into()).to_vec();
        }
        let primary = system.primary(state);
        let gap = |k: usize| {
            let seen = system.turned_to(state, k);
            let (side, distance) = (system.wall(&seen).sign(), system.distance(&seen));
            let y = system.offset_of(k) + (system.clearance_of(k) - distance.value) * side;
            [y, self.scale.velocity(-side * distance.rate)]
        };
        let own = [primary.x, self.scale.velocity(primary.v)];
        own.into_iter().chain((0..self.middles.len()).flat_map(gap)).collect()
    }

    /// Those at a strobe.
    pub(super) fn numbers_at<S: Startable>(&self, system: &S, strobe: &S::Strobe) -> Numbers {
        match <[f64; 4]>::try_from(strobe.numbers()) {
            Ok(four) if !self.is_several() => system.user_numbers(&self.scale, four).to_vec(),
            _ => system.start_at_strobe(strobe).map_or_else(Vec::new, |start| {
                self.numbers(system, &system.begin_at(&start, Clock::new(0.0)))
            }),
        }
    }

    /// The trajectory of the same scene from a start with other values of some of its numbers.
    ///
    /// # Errors
    /// [`Invalid`] for a value outside its gap.
    pub(super) fn begun<S: Startable + OfMember>(
        &self,
        like: &Trajectory<S>,
        changed: &[(usize, f64)],
    ) -> Result<Trajectory<S>, Invalid> {
        let mut numbers = self.numbers(&like.system, &like.state);
        for (place, value) in changed {
            let count = numbers.len();
            let rule = || format!("there are {count} numbers of a start");
            let number = numbers.get_mut(*place);
            *number.ok_or_else(|| Invalid::new("start", name_of(*place, usize::MAX), rule()))? =
                *value;
        }
        match <[f64; 4]>::try_from(&numbers[..]) {
            Ok(four) if !self.is_several() => return S::begun(like, &self.scale, four),
            _ => {}
        }
        let mut from = self.spec.clone();
        for (place, field) in [(0, FieldId::Displacement), (1, FieldId::Velocity)] {
            if changed.iter().any(|(other, _)| *other == place) {
                from.replace(field, numbers[place])?;
            }
        }
        for (first, field) in [(2, FieldId::GapDisplacement), (3, FieldId::GapVelocity)] {
            if changed.iter().any(|(place, _)| *place >= 2 && place % 2 == first % 2) {
                let each: Numbers = numbers[first..].iter().step_by(2).copied().collect();
                from.clear(field.into());
                from.set_starts(field, &each)?;
            }
        }
        let other = || Invalid::missing("absorber", "give one of the same kind");
        let begun = S::of(Self::new(&from, None, 1)?.member).ok_or_else(other)?;
        Ok(Trajectory { cycle: like.cycle, tier: like.tier, ..begun })
    }

    /// The usual box of starts, in the user's units: displacement and velocity of the structure up to those of its steady state
    /// without absorber, each whole gap as far as a pendulum reaches, and gap velocities up to the same velocity.
    fn bounds<S: Absorber<Real = f64>>(&self, system: &S) -> Bounds {
        let frequency = std::f64::consts::TAU / self.period;
        let x = if self.amplitude.is_finite() { self.amplitude } else { system.clearance() };
        let v = self.scale.velocity(x * frequency);
        let [low, high] = self.within;
        let gap = |k: usize| {
            let (middle, half) = (self.middles[k], system.clearance_of(k).min(self.reach(k)));
            let [minus, plus] = system.walls_of(k);
            [[(middle - half).max(minus), (middle + half).min(plus)], [-v, v]]
        };
        let own = [[-x, x].map(|x| x.max(low).min(high)), [-v, v]];
        own.into_iter().chain((0..self.middles.len()).flat_map(gap)).collect()
    }

    /// How far an absorber reaches to either side, where there were no walls.
    fn reach(&self, absorber: usize) -> f64 {
        match &self.member {
            Member::Piva(it) if it.system.parameters().angles == Angles::Large => {
                it.system.parameters().contact_distance
            }
            Member::System(it) => match it.system.pendulum(absorber) {
                Some(pendulum) if pendulum.angles == Angles::Large => pendulum.contact_distance,
                _ => f64::INFINITY,
            },
            _ => f64::INFINITY,
        }
    }

    /// A small box around a state.
    fn around<S: Startable>(&self, system: &S, given: &Numbers) -> Bounds {
        let size = AROUND * given[0].abs().max(system.clearance());
        let sizes = [size, self.scale.velocity(size)];
        let around = |(place, it): (usize, &f64)| {
            let [low, high] = match place {
                0 => self.within,
                _ if place % 2 == 0 => system.walls_of(place / 2 - 1),
                _ => [f64::NEG_INFINITY, f64::INFINITY],
            };
            [it - sizes[place % 2], it + sizes[place % 2]].map(|it| it.clamp(low, high))
        };
        given.iter().enumerate().map(around).collect()
    }

    /// Trajectories from starts that are drawn, and their numbers, with the box in which they are.
    ///
    /// # Errors
    /// [`Invalid`] for a box that is none, or with starts outside a gap.
    pub(super) fn drawn<S: Startable + OfMember>(
        &self,
        like: &Trajectory<S>,
        drawn: &Drawn,
    ) -> Result<Starts<S>, Invalid> {
        let system = &like.system;
        let given = self.numbers(system, &like.state);
        let close = drawn.within == Within::Close;
        let bounds = match &drawn.within {
            Within::Usual => self.bounds(system),
            Within::Given(bounds) => checked(bounds, given.len())?,
            Within::Close => self.around(system, &given),
        };
        let beside = close && self.is_several();
        let axes = if beside { system.point(&like.state).len() } else { bounds.len() };
        let cube = Cube::new(Method::Random, drawn.count, drawn.seed, false, axes)
            .map_err(|error| Invalid::new("starts", drawn.count.to_string(), error.to_string()))?;
        let (mut trajectories, mut numbers) = (vec![], vec![]);
        for point in 0..drawn.count {
            let share = |axis: usize| cube.coordinate(point, axis);
            if close && point == 0 {
                trajectories.push(like.clone());
                numbers.push(given.clone());
            } else if beside {
                trajectories.push(beside_state(like, share));
                numbers.push(given.clone());
            } else {
                let at = |(axis, [low, high]): (usize, &[f64; 2])| low + (high - low) * share(axis);
                let one: Numbers = bounds.iter().enumerate().map(at).collect();
                let all: Vec<_> = one.iter().copied().enumerate().collect();
                trajectories.push(self.begun(like, &all)?);
                numbers.push(one);
            }
        }
        Ok(Starts { trajectories, numbers, bounds })
    }

    /// True if four numbers do not tell a state.
    pub fn is_several(&self) -> bool {
        matches!(&self.member, Member::System(it) if it.system.check_single().is_err())
    }
}

/// A trajectory next to another, off by these shares of a small range in each number of its state.
fn beside_state<S: Startable>(like: &Trajectory<S>, share: impl Fn(usize) -> f64) -> Trajectory<S> {
    let Trajectory { system, state, cycle, .. } = like;
    let mut at = system.point(state);
    let size = AROUND * at.amax().max(system.clearance());
    for (axis, number) in at.iter_mut().enumerate() {
        *number += size * (2.0 * share(axis) - 1.0);
    }
    for (place, k) in system.gaps() {
        at[place] = at[place].clamp(-system.clearance_of(k), system.clearance_of(k));
    }
    let start = system.start_of(&at);
    start.map_or_else(
        || like.clone(),
        |it| like.from(&system.begin_at(&it, Clock::new(cycle.begin))),
    )
}

/// Trajectories from starts.
pub(super) struct Starts<S: Absorber> {
    pub trajectories: Vec<Trajectory<S>>,
    /// Their starts, in the user's units.
    pub numbers: Vec<Numbers>,
    /// The box in which they are.
    pub bounds: Bounds,
}

/// Checks a box of so many numbers.
fn checked(bounds: &Bounds, count: usize) -> Result<Bounds, Invalid> {
    if bounds.len() != count {
        let rule = format!("give ranges of the {count} numbers of a start");
        return Err(Invalid::new("box", format!("{} ranges", bounds.len()), rule));
    }
    for (place, [low, high]) in bounds.iter().enumerate() {
        if !(low.is_finite() && high.is_finite() && low <= high) {
            let shown = format!("({}, {})", number(*low), number(*high));
            let rule = "give two numbers, the smaller one first";
            return Err(Invalid::new(format!("box.{}", name_of(place, count)), shown, rule));
        }
    }
    Ok(bounds.clone())
}
