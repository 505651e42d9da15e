//! The state as numbers, in which orbits are sought: of one absorber on one mode the four that [`Differentiable`] speaks of, of a system of
//! several members or modes a point of as many as it has.

use nalgebra::{DVector, Vector4};

use crate::absorber::modal::Modal;
use crate::absorber::piva::{Angles, Given, ImpactLaw, Parameters, Piva, PivaStart};
use crate::absorber::siva::Siva;
use crate::absorber::{Absorber, ImpactLaw as _, LawAt, OnStructure, Start, Wall};
use crate::host::Host;
use crate::measures::propagation::{Derivative, Differentiable, Tangent, Tangents};
use crate::number::real::Real;
use crate::range;

/// An absorber whose states in flight follow from four numbers and the phase of the drive: x, ẋ, y from the middle of the gap and
/// ẏ (W = b θ̇ in place of ẏ for a pendulum). Where walls are alike and the motion is level, minus these numbers are those of the
/// mirror image.
pub trait Numbered: Absorber {
    /// These numbers of a state.
    fn numbers(&self, state: &Self::State) -> [Self::Real; 4];
    /// The start with these numbers, which may be of no place in the gap.
    fn numbered(&self, numbers: [Self::Real; 4]) -> Self::Start;
    /// All numbers of a state: these four, or q and q̇ of all modes and y from the middle of the gap and ẏ of each member that is not a
    /// stop on the ground.
    fn all_numbers(&self, state: &Self::State) -> Vec<Self::Real> {
        self.numbers(state).to_vec()
    }
    /// The start with all these numbers, which may be of no place in a gap; `None` if there are more or fewer.
    fn all_numbered(&self, numbers: &[Self::Real]) -> Option<Self::Start> {
        Some(self.numbered(numbers.try_into().ok()?))
    }
}

/// All numbers of a state at a strobe.
pub trait Strobe: Clone + std::fmt::Debug + Send + Sync {
    /// No state: not a number.
    fn none() -> Self;
    /// The numbers.
    fn numbers(&self) -> &[f64];
    /// The same with other numbers.
    fn with(numbers: &[f64]) -> Self;
    /// The largest size of a number.
    fn size(&self) -> f64 {
        self.numbers().iter().fold(0.0, |size: f64, it| size.max(it.abs()))
    }
    /// The largest difference to another.
    fn apart(&self, other: &Self) -> f64 {
        let both = self.numbers().iter().zip(other.numbers());
        // What is not a number is apart from all.
        both.fold(0.0, |most: f64, (a, b)| if (a - b).abs() <= most { most } else { (a - b).abs() })
    }
}

impl Strobe for Vector4<f64> {
    fn none() -> Self {
        Vector4::repeat(f64::NAN)
    }

    fn numbers(&self) -> &[f64] {
        self.as_slice()
    }

    fn with(numbers: &[f64]) -> Self {
        Vector4::from_column_slice(numbers)
    }
}

impl Strobe for Vec<f64> {
    fn none() -> Self {
        vec![f64::NAN]
    }

    fn numbers(&self) -> &[f64] {
        self
    }

    fn with(numbers: &[f64]) -> Self {
        numbers.to_vec()
    }
}

/// One that runs in doubles, with the derivatives of its motion.
pub trait Coordinates: Differentiable + Numbered + Sized {
    /// The observer of the derivative of a run, in all numbers of a state.
    type Derivative: Derivative<Self>;
    /// The numbers of a strobe, of which there are many: without a heap where they are four.
    type Strobe: Strobe;
    /// The strobe of a state.
    fn strobe(&self, state: &Self::State) -> Self::Strobe {
        Strobe::with(&self.all_numbers(state))
    }
    /// The start at a strobe; `None` if it is of no place in a gap.
    fn start_at_strobe(&self, strobe: &Self::Strobe) -> Option<Self::Start> {
        self.start_of(&DVector::from_column_slice(strobe.numbers()))
    }
    /// The point of a state: all its numbers.
    fn point(&self, state: &Self::State) -> DVector<f64> {
        self.all_numbers(state).into()
    }
    /// The start at a point, at which numbers that no run accepts as they are so small are 0; `None` if it is of no place in a gap.
    fn start_of(&self, point: &DVector<f64>) -> Option<Self::Start> {
        let start = self.all_numbered(point.map(range::or_zero).as_slice())?;
        self.check_start(&start).is_ok().then_some(start)
    }
    /// Which of the numbers of a state are y from the middle of a gap, each with the index of its absorber.
    fn gaps(&self) -> Vec<(usize, usize)> {
        vec![(2, 0)]
    }
    /// The four numbers of a state.
    fn coordinates(&self, state: &Self::State) -> Vector4<f64> {
        self.numbers(state).into()
    }
    /// The start with these four numbers; `None` if they are of no place in the gap.
    fn start_at(&self, numbers: &Vector4<f64>) -> Option<Self::Start> {
        let start = self.numbered(numbers.map(range::or_zero).into());
        self.check_start(&start).is_ok().then_some(start)
    }
    /// The rate at which a small volume of states shrinks in flight at a gap displacement, in ωn: −div ż, in the coordinates
    /// that momenta and places make. `None` if an impact does not shrink it by e².
    fn contraction(&self, gap_displacement: f64) -> Option<f64>;
    /// True if every absorber has a place of rest in its gap, by a spring or its weight: then a motion without impacts is isolated.
    fn has_place_of_rest(&self) -> bool {
        false
    }
    /// How many of the numbers a state can have independently of each other.
    fn dimension(&self) -> usize {
        4
    }
    /// ln |det| of the derivative of the motion over a time with this number of impacts and no ride, where it depends on
    /// nothing else.
    fn known_log_volume(&self, _time: f64, _impacts: u64) -> Option<f64> {
        None
    }
}

/// y from the middle of the gap, by the distance to a wall.
fn from_middle<S: Absorber>(system: &S, state: &S::State) -> S::Real {
    let side = system.wall(state).sign();
    (system.clearance() - system.distance(state).value) * side
}

impl<R: Real, H: Host<Real = R>> Numbered for Siva<H>
where
    Self: Absorber<Real = R, Start = Start<R>>,
{
    fn numbers(&self, state: &Self::State) -> [R; 4] {
        let (primary, side) = (self.primary(state), self.wall(state).sign());
        let rate = self.distance(state).rate;
        [primary.x, primary.v, from_middle(self, state), rate * -side]
    }

    fn numbered(&self, numbers: [R; 4]) -> Start<R> {
        let [displacement, velocity, from_middle, gap_velocity] = numbers;
        let gap_displacement = self.offset() + from_middle;
        Start { displacement, velocity, gap_displacement, gap_velocity }
    }
}

impl<H: Host<Real = f64>> Coordinates for Siva<H>
where
    Self: Differentiable + Absorber<Start = Start>,
{
    type Derivative = Tangent;
    type Strobe = Vector4<f64>;

    fn strobe(&self, state: &Self::State) -> Vector4<f64> {
        self.coordinates(state)
    }

    /// 2ζ.
    fn contraction(&self, _gap_displacement: f64) -> Option<f64> {
        Some(2.0 * self.damping_ratio())
    }

    fn known_log_volume(&self, time: f64, impacts: u64) -> Option<f64> {
        log_volume(self, time, impacts)
    }
}

/// Of equal walls with a constant restitution: 2 N ln e − τ times the contraction, which is the same in any state. The damper takes ẋ, an
/// impact turns two velocities by −e: w⁺ = −e w⁻ and the instant of the impact, which moves by δy/w.
fn log_volume<S: Coordinates>(system: &S, time: f64, impacts: u64) -> Option<f64> {
    let [plus, minus] = [Wall::Plus, Wall::Minus].map(|wall| system.law_at(wall, 1.0));
    let constant = plus == minus && plus.slope == plus.rebound;
    let damped = system.contraction(0.0)? * time;
    constant.then(|| 2.0 * impacts as f64 * plus.restitution.ln() - damped)
}

impl<R: Real, H: Host<Real = R>> Numbered for Piva<H>
where
    Self: Absorber<Real = R, Start = PivaStart<R>>,
{
    fn numbers(&self, state: &Self::State) -> [R; 4] {
        let primary = self.primary(state);
        let rate = self.angle(state).map_or(R::NAN, |angle| angle.rate);
        let w = rate * self.parameters().contact_distance;
        [primary.x, primary.v, from_middle(self, state), w]
    }

    fn numbered(&self, numbers: [R; 4]) -> PivaStart<R> {
        let [displacement, velocity, y, w] = numbers;
        let rate = Given::Angle(w / self.parameters().contact_distance);
        PivaStart { displacement, velocity, place: Given::Gap(y), rate }
    }
}

impl<H: Host<Real = f64>> Coordinates for Piva<H> {
    type Derivative = Tangent;
    type Strobe = Vector4<f64>;

    fn has_place_of_rest(&self) -> bool {
        self.parameters().frequency_ratio > 0.0
    }

    fn strobe(&self, state: &Self::State) -> Vector4<f64> {
        self.coordinates(state)
    }

    /// The trace of the damping matrix over the mass matrix, (2ζ κ + 2ζp r κ (1 + μ))/(κ (1 + μ) − μ cos²θ).
    fn contraction(&self, gap_displacement: f64) -> Option<f64> {
        let Parameters { mass_ratio, damping_ratio, inertia_ratio, contact_distance, .. } =
            *self.parameters();
        let Parameters { frequency_ratio, pivot_damping_ratio, angles, impact_law, .. } =
            *self.parameters();
        let sine = gap_displacement / contact_distance;
        let cosine_squared = if angles == Angles::Small { 1.0 } else { 1.0 - sine * sine };
        let total = 1.0 + mass_ratio;
        let pivot = 2.0 * pivot_damping_ratio * frequency_ratio;
        let damped = inertia_ratio * (2.0 * damping_ratio + pivot * total);
        let rate = damped / (inertia_ratio * total - mass_ratio * cosine_squared);
        (impact_law == ImpactLaw::Consistent).then_some(rate)
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Numbered for Modal<H, N, M> {
    fn numbers(&self, state: &Self::State) -> [R; 4] {
        let primary = self.primary(state);
        let rate = self.distance(state).rate;
        [primary.x, primary.v, from_middle(self, state), rate * -self.wall(state).sign()]
    }

    /// At a stop on the ground the structure is where the gap tells.
    fn numbered(&self, [x, v, from_middle, w]: [R; 4]) -> Self::Start {
        let y = self.offset_of(0) + from_middle;
        let [displacement, velocity] = if self.on_ground(0) { [y, w] } else { [x, v] };
        Start { displacement, velocity, gap_displacement: y, gap_velocity: w }.into()
    }

    fn all_numbers(&self, state: &Self::State) -> Vec<R> {
        if self.is_single() { self.numbers(state).to_vec() } else { self.point_of(state) }
    }

    fn all_numbered(&self, numbers: &[R]) -> Option<Self::Start> {
        if self.is_single() {
            return Some(self.numbered(numbers.try_into().ok()?));
        }
        self.start_of_point(numbers)
    }
}

impl<H: Host<Real = f64>, const N: usize, const M: usize> Coordinates for Modal<H, N, M> {
    type Derivative = Tangents;
    type Strobe = Vec<f64>;

    fn has_place_of_rest(&self) -> bool {
        (0..self.count()).all(|k| self.rests_in_gap(k))
    }

    fn contraction(&self, _gap_displacement: f64) -> Option<f64> {
        self.shrinking().filter(|_| !(self.is_single() && self.on_ground(0)))
    }

    fn known_log_volume(&self, time: f64, impacts: u64) -> Option<f64> {
        let law = |k: usize, wall: Wall| {
            let LawAt { restitution, rebound, slope, .. } = self.law_of(k, wall, 1.0);
            (restitution, slope == rebound)
        };
        let first = law(0, Wall::Plus);
        let like = |k: usize| [Wall::Plus, Wall::Minus].map(|wall| law(k, wall)) == [first; 2];
        (1..self.count()).all(like).then(|| log_volume(self, time, impacts))?
    }

    fn gaps(&self) -> Vec<(usize, usize)> {
        if self.is_single() { vec![(2, 0)] } else { self.gaps_of_point() }
    }

    fn dimension(&self) -> usize {
        match self.is_single() {
            true if self.on_ground(0) => 2,
            true => 4,
            false => self.independent().len(),
        }
    }
}
