//! Starts in the user's units, given or drawn at random.

use iva_core::absorber::modal::FewModes;
use iva_core::absorber::{Absorber, Clock, OnStructure, Start};
use iva_core::error::{Invalid, number};
use iva_core::host::DrivenHost;
use iva_core::orbit::{Coordinates, Iterated, Trajectory};
use iva_core::piva::Angles;

use super::family::{Family, Member};
use crate::cube::{Cube, Method};
use crate::design::Spec;
use crate::fields::FieldId;
use crate::units::Scale;

/// Displacement and velocity of the structure, gap displacement and gap velocity.
pub type Numbers = [f64; 4];
/// The range of each of these.
pub type Bounds = [[f64; 2]; 4];

/// The names of the numbers of a start.
pub const NAMES: [&str; 4] = ["displacement", "velocity", "gap_displacement", "gap_velocity"];
/// How far starts around a given one are from it, over the size of the state.
const AROUND: f64 = 1e-6;

/// Starts that are drawn at random.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drawn {
    /// Their number.
    pub count: u64,
    /// The seed that they follow from.
    pub seed: u64,
    /// The box that they are spread evenly in.
    pub within: Within,
}

/// The box of starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Within {
    /// The usual one: displacements and velocities up to those without absorber, the whole gap.
    Usual,
    /// This one.
    Given(Bounds),
    /// A small one around the start of the spec, which is the first start.
    Close,
}

/// An absorber whose states are given and shown by the numbers of a start.
pub(super) trait Startable:
    OnStructure<State: Send + Sync> + Coordinates + Iterated + Clone + Send + Sync
{
    /// The trajectory of the same scene from other numbers, in the user's units.
    fn begun(
        like: &Trajectory<Self>,
        scale: &Scale,
        numbers: Numbers,
    ) -> Result<Trajectory<Self>, Invalid>;

    /// The numbers of coordinates, in the user's units.
    fn user_numbers(&self, scale: &Scale, coordinates: Numbers) -> Numbers;
}

impl<S> Startable for S
where
    S: OnStructure<State: Send + Sync> + Coordinates + Iterated + Clone + Send + Sync,
    S::Start: From<Start>,
{
    fn begun(
        like: &Trajectory<Self>,
        scale: &Scale,
        numbers: Numbers,
    ) -> Result<Trajectory<Self>, Invalid> {
        let [displacement, velocity, gap_displacement, gap_velocity] = numbers;
        let natural = 1.0 / scale.velocity(1.0);
        let (velocity, gap_velocity) = (velocity * natural, gap_velocity * natural);
        let start = Start { displacement, velocity, gap_displacement, gap_velocity };
        let begun = Trajectory::new(like.system.clone(), &start.into(), like.cycle)?;
        Ok(Trajectory { tier: like.tier, ..begun })
    }

    fn user_numbers(&self, scale: &Scale, coordinates: Numbers) -> Numbers {
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
    /// The usual box of starts, in the user's units: displacement and velocity of the structure up to those of its steady state
    /// without absorber, the whole gap as far as a pendulum reaches, and gap velocities up to the same velocity.
    pub(super) fn bounds<S: Absorber<Real = f64>>(&self, system: &S) -> Bounds {
        let frequency = std::f64::consts::TAU / self.period;
        let (middle, clearance) = (system.offset_of(0), system.clearance());
        let half = clearance.min(self.reach());
        let x = if self.amplitude.is_finite() { self.amplitude } else { clearance };
        let v = self.scale.velocity(x * frequency);
        let [low, high] = self.within;
        [[-x, x].map(|x| x.max(low).min(high)), [-v, v], [middle - half, middle + half], [-v, v]]
    }

    /// How far the absorber reaches to either side, where there were no walls.
    fn reach(&self) -> f64 {
        match &self.member {
            Member::Piva(it) if it.system.parameters().angles == Angles::Large => {
                it.system.parameters().contact_distance
            }
            Member::System(it) => match it.system.pendulum(0) {
                Some(pendulum) if pendulum.angles == Angles::Large => pendulum.contact_distance,
                _ => f64::INFINITY,
            },
            _ => f64::INFINITY,
        }
    }

    /// Trajectories from starts that are drawn, and their numbers, with the box in which they are.
    pub(super) fn drawn<S: Startable>(
        &self,
        like: &Trajectory<S>,
        drawn: Drawn,
    ) -> Result<Starts<S>, Invalid> {
        let system = &like.system;
        let gap = system.walls_of(0);
        let given: Numbers = system.coordinates(&like.state).into();
        let given = system.user_numbers(&self.scale, given);
        let bounds = match drawn.within {
            Within::Usual => self.bounds(system),
            Within::Given(bounds) => checked(bounds)?,
            Within::Close => {
                let size = AROUND * given[0].abs().max(system.clearance());
                let sizes = [size, self.scale.velocity(size)];
                let around = |k: usize| [given[k] - sizes[k % 2], given[k] + sizes[k % 2]];
                let [x, v, y, w] = [0, 1, 2, 3].map(around);
                let x = x.map(|x| x.clamp(self.within[0], self.within[1]));
                [x, v, y.map(|y| y.clamp(gap[0], gap[1])), w]
            }
        };
        let cube = Cube::new(Method::Random, drawn.count, drawn.seed, false, 4)
            .map_err(|error| Invalid::new("starts", drawn.count.to_string(), error.to_string()))?;
        let (mut trajectories, mut numbers) = (vec![], vec![]);
        for point in 0..drawn.count {
            let one = [0, 1, 2, 3].map(|axis| {
                let [low, high] = bounds[axis];
                low + (high - low) * cube.coordinate(point, axis)
            });
            if point == 0 && drawn.within == Within::Close {
                trajectories.push(like.clone());
                numbers.push(given);
            } else {
                trajectories.push(S::begun(like, &self.scale, one)?);
                numbers.push(one);
            }
        }
        Ok(Starts { trajectories, numbers, bounds })
    }
}

/// Trajectories from starts.
pub(super) struct Starts<S: Absorber> {
    pub trajectories: Vec<Trajectory<S>>,
    /// Their starts, in the user's units.
    pub numbers: Vec<Numbers>,
    /// The box in which they are.
    pub bounds: Bounds,
}

impl<S: Absorber> Starts<S> {
    /// The same without a limit to how many numbers a start has.
    pub fn of_all(self) -> AllStarts<S> {
        let Self { trajectories, numbers, bounds } = self;
        let numbers = numbers.into_iter().map(Vec::from).collect();
        AllStarts { trajectories, numbers, bounds: bounds.to_vec() }
    }
}

/// Trajectories from starts of any number of absorbers.
pub(super) struct AllStarts<S: Absorber> {
    pub trajectories: Vec<Trajectory<S>>,
    /// Displacement and velocity, gap displacement and gap velocity of each absorber, in the user's units.
    pub numbers: Vec<Vec<f64>>,
    /// The box in which they are.
    pub bounds: Vec<[f64; 2]>,
}

impl Family {
    /// True if four numbers do not tell a state.
    pub fn is_several(&self) -> bool {
        matches!(&self.member, Member::System(it) if it.system.check_single().is_err())
    }

    /// The usual box of starts of all absorbers.
    fn bounds_of_all(&self, system: &FewModes<DrivenHost>) -> Vec<[f64; 2]> {
        let frequency = std::f64::consts::TAU / self.period;
        let x = if self.amplitude.is_finite() { self.amplitude } else { system.clearance() };
        let v = self.scale.velocity(x * frequency);
        let [low, high] = self.within;
        let gap = |k: usize| {
            let reach = system.pendulum(k).filter(|it| it.angles == Angles::Large);
            let reach = reach.map_or(f64::INFINITY, |it| it.contact_distance);
            let (middle, half) = (self.middles[k], system.clearance_of(k).min(reach));
            let [minus, plus] = system.walls_of(k);
            [[(middle - half).max(minus), (middle + half).min(plus)], [-v, v]]
        };
        let own = [[-x, x].map(|x| x.clamp(low, high)), [-v, v]];
        own.into_iter().chain((0..self.middles.len()).flat_map(gap)).collect()
    }

    /// Trajectories of all absorbers from starts that are drawn from the usual box.
    ///
    /// # Errors
    /// [`Invalid`] for another box, and as of the scene.
    pub(super) fn drawn_of_all(
        &self,
        spec: &Spec,
        drawn: Drawn,
    ) -> Result<AllStarts<FewModes<DrivenHost>>, Invalid> {
        let Member::System(like) = &self.member else {
            return Ok(AllStarts { trajectories: vec![], numbers: vec![], bounds: vec![] });
        };
        if drawn.within != Within::Usual {
            let rule = "starts of several absorbers are drawn from the usual box; leave it out";
            return Err(Invalid::new("box", "given", rule));
        }
        let bounds = self.bounds_of_all(&like.system);
        let cube = Cube::new(Method::Random, drawn.count, drawn.seed, false, bounds.len())
            .map_err(|error| Invalid::new("starts", drawn.count.to_string(), error.to_string()))?;
        let (mut trajectories, mut numbers) = (vec![], vec![]);
        for point in 0..drawn.count {
            let at = |(axis, [low, high]): (usize, &[f64; 2])| {
                low + (high - low) * cube.coordinate(point, axis)
            };
            let one: Vec<f64> = bounds.iter().enumerate().map(at).collect();
            let mut from = spec.clone();
            from.replace(FieldId::Displacement, one[0])?;
            from.replace(FieldId::Velocity, one[1])?;
            for (field, first) in [(FieldId::GapDisplacement, 2), (FieldId::GapVelocity, 3)] {
                let each: Vec<f64> = one[first..].iter().step_by(2).copied().collect();
                from.clear(field.into());
                from.set_starts(field, &each)?;
            }
            if let Member::System(trajectory) = Self::of_all(from, 1)?.member {
                trajectories.push(*trajectory);
                numbers.push(one);
            }
        }
        Ok(AllStarts { trajectories, numbers, bounds })
    }
}

/// Checks a box.
fn checked(bounds: Bounds) -> Result<Bounds, Invalid> {
    for (name, [low, high]) in NAMES.into_iter().zip(bounds) {
        if !(low.is_finite() && high.is_finite() && low <= high) {
            let shown = format!("({}, {})", number(low), number(high));
            let rule = "give two numbers, the smaller one first";
            return Err(Invalid::new(format!("box.{name}"), shown, rule));
        }
    }
    Ok(bounds)
}
