//! A list of free masses on one structure, each in a gap of its own. The empty list is the structure alone.
//!
//! A list has room for N masses. [`Several`] as it stands in scenes has room for [`MOST`], of which it holds some.
//!
//! The structure moves as one with the masses that are stuck to it; each of the others obeys D̈ = s A, where D is its
//! distance to the wall last touched, s the sign of that wall and A the absolute acceleration of the structure
//! ([`crate::absorber::siva`]). So all masses fly in one motion of the structure, and a state is that of the structure plus
//! one for each mass. Which masses are stuck is part of the state; a structure of 1 + the mass ratios of those is kept for
//! each set of them that was met.
//!
//! * **Impacts at one instant.** All masses that touch their walls and approach them have their impact at once: Newton's
//!   law for each, and the momentum of all ([`impact_law`]). Contacts closer to each other than 2⁻⁴⁹/ωn are one event.
//! * **A stuck mass** is carried where an impact pushes its wall against it, and left behind where it pulls its wall
//!   away.
//! * **Chatter** is summed where no other mass is stuck, and none of the others can meet a wall before its end: its
//!   distance from both walls exceeds what its speed, the largest A and the impacts of the chatter can cover. Elsewhere
//!   the impacts are computed one by one, until the rest of the chatter is shorter than rounding of the clock.

use std::sync::OnceLock;

use crate::absorber::impact;
use crate::absorber::siva::free_mass::check_place;
use crate::absorber::siva::{FreeMass, coasts};
use crate::absorber::{Aboard, Absorber, Clock, Coasted, Point, Wall};
use crate::error::{Invalid, number};
use crate::force::Force;
use crate::host::oscillator::Primary;
use crate::host::{DrivenHost, Host, HostState, Structure, UndrivenHost};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;
use crate::segment::flight::{GapPoint, Jet};

pub use motion::Together;
pub use state::{InGap, SeveralState};

pub mod impact_law;
mod motion;
mod on_structure;
pub(crate) mod sight;
mod state;
pub(crate) mod touching;

/// Largest number of absorbers.
pub const MOST: usize = 8;

/// Contacts closer to each other than this, in units of 2⁻⁵²/ωn, are one event.
pub(crate) const AT_ONCE_ULPS: f64 = 8.0;

/// Free masses on a structure, N at most.
#[derive(Debug, Clone)]
pub struct Several<H: Host, const N: usize = MOST> {
    /// Those in use first; the others are copies of the first.
    masses: [FreeMass<H::Real>; N],
    count: usize,
    pub(crate) host: H,
    /// The structure with a set of masses stuck to it, made when the set first is.
    carrying: Vec<OnceLock<Box<H>>>,
}

/// A structure without absorber.
pub type Alone<H> = Several<H, 0>;

/// A start of the structure and of absorbers, N at most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Starts<R, const N: usize = MOST> {
    /// Displacement and velocity of the structure.
    pub primary: Point<R>,
    /// Gap displacement and gap velocity of each absorber; those after the last absorber mean nothing.
    pub gaps: [GapPoint<R>; N],
}

impl<R: Real> Starts<R> {
    /// A start of some absorbers.
    pub fn of(primary: Point<R>, gaps: &[GapPoint<R>]) -> Self {
        let unused = GapPoint { y: R::ZERO, w: R::ZERO };
        let gaps = std::array::from_fn(|k| gaps.get(k).copied().unwrap_or(unused));
        Self { primary, gaps }
    }
}

impl<R> From<Point<R>> for Starts<R, 0> {
    fn from(primary: Point<R>) -> Self {
        Self { primary, gaps: [] }
    }
}

impl<R: Real> Several<UndrivenHost<R>> {
    /// A list of masses on a structure of damping ratio ζ without drive.
    ///
    /// # Errors
    /// [`Invalid`] for a damping ratio out of [`crate::range`], for no mass, and for more than [`MOST`].
    pub fn of(damping_ratio: R, masses: &[FreeMass<R>]) -> Result<Self, Invalid> {
        let Some(first) = masses.first().filter(|_| masses.len() <= MOST) else {
            let rule = format!("give 1 to {MOST} absorbers");
            return Err(Invalid::new("absorber", format!("a list of {}", masses.len()), rule));
        };
        range::damping_ratio("primary.damping_ratio", damping_ratio)?;
        let all = std::array::from_fn(|k| masses.get(k).copied().unwrap_or(*first));
        Ok(Self::on(UndrivenHost::new(damping_ratio, total(masses)), all, masses.len()))
    }
}

impl<R: Real, const N: usize> Several<UndrivenHost<R>, N> {
    /// N masses on a structure of damping ratio ζ without drive.
    ///
    /// # Errors
    /// [`Invalid`] for a damping ratio out of [`crate::range`], and for more than [`MOST`] masses.
    pub fn new(damping_ratio: R, masses: [FreeMass<R>; N]) -> Result<Self, Invalid> {
        range::damping_ratio("primary.damping_ratio", damping_ratio)?;
        if N > MOST {
            let rule = format!("give {MOST} absorbers at most");
            return Err(Invalid::new("absorber", number(N as f64), rule));
        }
        Ok(Self::on(UndrivenHost::new(damping_ratio, total(&masses)), masses, N))
    }

    /// The same masses on the same structure under a force.
    pub fn under(&self, force: Force<R>) -> Several<DrivenHost<R>, N> {
        let damping_ratio = self.host.damping_ratio();
        let host = DrivenHost::new(damping_ratio, total(self.masses()), force, R::ZERO);
        Several::on(host, self.masses, self.count)
    }
}

/// The mass ratio of all masses together.
fn total<R: Real>(masses: &[FreeMass<R>]) -> R {
    masses.iter().fold(R::ZERO, |sum, mass| sum + mass.mass_ratio)
}

impl<R: Real, H: Host<Real = R>, const N: usize> Several<H, N> {
    fn on(host: H, masses: [FreeMass<R>; N], count: usize) -> Self {
        let carrying = (0..1_usize << count).map(|_| OnceLock::new()).collect();
        Self { masses, count, host, carrying }
    }

    /// The damping ratio ζ of the structure.
    pub fn damping_ratio(&self) -> R {
        self.host.damping_ratio()
    }

    /// The force that drives it; `None` for a structure that cannot be driven.
    pub fn force(&self) -> Option<&Force<R>> {
        self.host.force()
    }

    /// The masses.
    pub fn masses(&self) -> &[FreeMass<R>] {
        &self.masses[..self.count]
    }

    /// Each mass, with its place in a state.
    fn each(&self, state: &SeveralState<H, N>) -> impl Iterator<Item = (&FreeMass<R>, InGap<R>)> {
        self.masses().iter().zip(state.masses)
    }

    /// The structure with the masses that are stuck to it in a state.
    fn structure(&self, masses: &[InGap<R>; N]) -> &H::Structure {
        let stuck = || masses.iter().enumerate().filter(|(_, mass)| mass.stuck);
        let set: usize = stuck().map(|(k, _)| 1 << k).sum();
        if set == 0 {
            return self.host.free();
        }
        let mass = || stuck().fold(R::ZERO, |sum, (k, _)| sum + self.masses[k].mass_ratio);
        self.carrying[set].get_or_init(|| Box::new(self.host.carrying(mass()))).loaded()
    }

    /// ẋ, A with the masses that are stuck in a state, and the acceleration of the base.
    pub(crate) fn motion_of(&self, state: &SeveralState<H, N>) -> [R; 3] {
        let HostState { primary, phase, .. } = &state.host;
        let structure = self.structure(&state.masses);
        let [base, ..] = structure.base(phase);
        [primary.v.value, structure.acceleration(phase, primary).value, base]
    }

    /// The structure at a place, with A computed anew for the masses that are stuck to it.
    fn hosted(&self, state: &SeveralState<H, N>, primary: Primary<R>) -> HostState<H::Phase, R> {
        let phase = state.host.phase;
        let acceleration = self.structure(&state.masses).acceleration(&phase, &primary);
        HostState { primary, acceleration, phase }
    }

    /// The state in which the structure has gained a velocity: masses in flight keep theirs.
    fn jumped(&self, state: &SeveralState<H, N>, gained: DoubleDouble<R>) -> SeveralState<H, N> {
        let mut after = *state;
        for mass in after.masses[..self.count].iter_mut().filter(|mass| !mass.stuck) {
            *mass = mass.left_by(gained);
        }
        after.host = self.hosted(&after, state.host.primary.faster_by(gained));
        after
    }

    /// The absorber at hand, and its place in its gap; `None` for a structure alone.
    fn seen<'a>(
        &'a self,
        state: &'a SeveralState<H, N>,
    ) -> Option<(&'a FreeMass<R>, &'a InGap<R>)> {
        let k = usize::from(state.at_hand);
        self.masses().get(k).zip(state.masses.get(k))
    }

    /// Gap displacement and velocity of each absorber.
    pub fn gaps(&self, state: &SeveralState<H, N>) -> impl Iterator<Item = GapPoint<R>> {
        self.each(state).map(|(mass, place)| place.gap(mass))
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize> Absorber for Several<H, N> {
    type Start = Starts<R, N>;
    type Flight<'a>
        = Together<'a, H, N>
    where
        H: 'a;
    type Ride<'a>
        = Together<'a, H, N>
    where
        H: 'a;

    /// For a structure alone the compiler knows it.
    #[inline(always)]
    fn absorbers(&self) -> usize {
        if N == 0 { 0 } else { self.count }
    }

    fn at_hand(&self, state: &Self::State) -> usize {
        usize::from(state.at_hand)
    }

    fn take_at_hand(&self, state: &mut Self::State, absorber: usize) {
        state.at_hand = absorber as u8;
    }

    fn turn<'a>(&'a self, flight: &mut Together<'a, H, N>, absorber: usize) {
        flight.from.at_hand = absorber as u8;
    }

    fn is_stuck(&self, state: &Self::State) -> bool {
        self.seen(state).is_some_and(|(_, mass)| mass.stuck)
    }

    fn freed(&self, state: &Self::State) -> Self::State {
        let mut freed = *state;
        if let Some(mass) = freed.masses.get_mut(usize::from(state.at_hand)) {
            mass.stuck = false;
        }
        freed.host = self.hosted(&freed, state.host.primary);
        freed
    }

    /// A mass travels |Ḋ| t + ½ |A| t² at most, and the impacts of the chatter change Ḋ by less than twice the speed of
    /// the mass that chatters.
    fn others_wait(&self, state: &Self::State, time: R) -> bool {
        let shaken = self.host.free().bound::<0>(&state.host.primary);
        let kicked = self.distance(state).rate.abs() * 2.0;
        let all = self.each(state).enumerate();
        let mut others = all.filter(|(k, _)| *k != usize::from(state.at_hand));
        others.all(|(_, (mass, place))| {
            let speed = place.rate.value.abs() + kicked;
            let travel = time * (speed + shaken * time);
            let near = place.distance.value;
            !place.stuck && near > travel && mass.clearance * 2.0 - near > travel
        })
    }

    /// As many steps as all masses have, each alone.
    fn coasts(&self, state: &Self::State, remaining: R) -> (usize, Coasted<Self::State, R>) {
        if N == 0 {
            return (0, (*state, Clock::ZERO));
        }
        let flies = !state.masses.iter().any(|mass| mass.stuck);
        let Some(steps) = self.host.steps().filter(|_| flies) else {
            return (0, (*state, Clock::ZERO));
        };
        let time = remaining.min(self.host.smooth_for(&state.host.phase)).double();
        let count = {
            self.each(state).fold(f64::INFINITY, |least, (mass, place)| {
                let within = [1.0 / mass.clearance.double(), time];
                least.min(coasts::count(steps, &place.in_doubles(&state.host.primary), within))
            })
        };
        let count = count as usize;
        (count, self.coasted(state, count))
    }

    fn coasted(&self, state: &Self::State, count: usize) -> Coasted<Self::State, R> {
        let Some(steps) = self.host.steps().filter(|_| N > 0) else { return (*state, Clock::ZERO) };
        let HostState { primary, phase, .. } = state.host;
        let (by, time) = (steps.responses(count), steps.time(count as f64));
        let (to, acceleration) = steps.after(&primary, by);
        let phase = self.host.waited(&phase, time);
        let mut after = *state;
        after.host = HostState { primary: to, acceleration, phase };
        for mass in &mut after.masses[..self.count] {
            [mass.distance, mass.rate] =
                coasts::drifted([&primary, &to], mass.side, [mass.distance, mass.rate], time);
        }
        (after, time)
    }

    fn aboard(&self, state: &Self::State, _stuck: bool) -> Aboard {
        let v = state.host.primary.v.value;
        let (mut carried, mut twice) = (0.0, 0.0);
        for (mass, place) in self.each(state) {
            let mu = mass.mass_ratio.double();
            if place.stuck {
                carried += mu;
            } else {
                let own = (v + place.gap(mass).w).double();
                twice += mu * (own * own);
            }
        }
        let velocity = (twice / total(self.masses()).double()).sqrt();
        Aboard { carried, velocity, height: 0.0 }
    }

    /// 1 for a structure alone, so that defaults that are a share of the clearance stay usable.
    fn clearance(&self) -> R {
        let smallest = self.masses().iter().map(|mass| mass.clearance).reduce(R::min);
        smallest.unwrap_or(R::ONE)
    }

    fn clearance_of(&self, absorber: usize) -> R {
        self.masses().get(absorber).map_or(R::ONE, |mass| mass.clearance)
    }

    fn offset_of(&self, absorber: usize) -> R {
        self.masses().get(absorber).map_or(R::ZERO, |mass| mass.offset)
    }

    fn walls_reachable(&self) -> bool {
        self.count > 0
    }

    fn check_start(&self, start: &Starts<R, N>) -> Result<(), Invalid> {
        range::size("start.displacement", start.primary.x)?;
        range::size("start.velocity", start.primary.v)?;
        for (k, (mass, GapPoint { y, w })) in self.masses().iter().zip(start.gaps).enumerate() {
            let field = |name: &str| format!("start.{k}.{name}");
            range::size(&field("gap_displacement"), y)?;
            range::size(&field("gap_velocity"), w)?;
            check_place(&field("gap_displacement"), y, [mass.clearance, mass.offset])?;
        }
        Ok(())
    }

    fn begin_at(&self, start: &Starts<R, N>, time: Clock<R>) -> Self::State {
        let Point { x, v } = start.primary;
        let primary = Primary { x: DoubleDouble::new(x), v: DoubleDouble::new(v) };
        let host = self.host.state(self.host.begin_at(time), primary);
        let leaning = [-host.acceleration.value, v];
        let masses = std::array::from_fn(|k| {
            if k >= self.count {
                return InGap::UNUSED;
            }
            let GapPoint { y, w } = start.gaps[k];
            let leaning = leaning.into_iter().chain(self.host.leaning(&host.phase));
            let (side, distance) = self.masses[k].begun([y, w], leaning);
            InGap { side, distance, rate: DoubleDouble::new(-side * w), stuck: false }
        });
        SeveralState { host, masses, at_hand: 0 }
    }

    fn flight(&self, state: &Self::State) -> Together<'_, H, N> {
        Together::new(self, *state)
    }

    fn ride(&self, state: &Self::State) -> Together<'_, H, N> {
        Together::new(self, *state)
    }

    fn wall(&self, state: &Self::State) -> Wall {
        let minus = self.seen(state).is_some_and(|(_, mass)| mass.side < 0.0);
        if minus { Wall::Minus } else { Wall::Plus }
    }

    /// As if the absorber at hand were in flight, also while it is stuck. A structure alone has no wall: 1.
    fn distance(&self, state: &Self::State) -> Jet<R> {
        let Some((_, mass)) = self.seen(state) else {
            let zero = R::ZERO;
            let value = if state.host.primary.x.value.is_finite() { R::ONE } else { R::NAN };
            return Jet { value, rate: zero, curvature: zero, jerk: zero };
        };
        let HostState { primary, acceleration, phase } = &state.host;
        let [jerk, ..] =
            self.structure(&state.masses).derivatives(phase, primary.v.value, acceleration.value);
        Jet {
            value: mass.distance.value,
            rate: mass.rate.value,
            curvature: mass.side * acceleration.value,
            jerk: mass.side * jerk,
        }
    }

    fn approach_of(&self, state: &Self::State, absorber: usize) -> [R; 2] {
        let place = state.masses.get(absorber);
        place.map_or([R::ONE, R::ZERO], |place| [place.distance.value, place.rate.value])
    }

    fn touch(&self, state: &Self::State, wall: Wall) -> (Self::State, R) {
        if N == 0 {
            return (*state, R::ZERO);
        }
        self.touching(state, wall)
    }

    /// The release is where A = 0, for all stuck masses at once. With x set to the balance, the pressure is exactly 0.
    fn release(&self, state: &Self::State) -> (Self::State, R) {
        let HostState { primary: Primary { x, v }, phase, .. } = state.host;
        let structure = self.structure(&state.masses);
        let left = (x - self.host.balanced(&phase, v)).value;
        let [jerk, snap, _] = structure.derivatives(&phase, v.value, R::ZERO);
        // x leaves the balance by −j h/k in a time h, where k is the stiffness over the mass.
        let stiffness = structure.equation().stiffness;
        let later = impact::delay(left * stiffness, -jerk, snap);
        let phase = structure.later(&phase, later);
        let [base, ..] = structure.base(&phase);
        let v = v.plus(-base * later);
        let primary = Primary { x: self.host.balanced(&phase, v), v };
        let mut after = *state;
        after.host = HostState { primary, acceleration: DoubleDouble::ZERO, phase };
        for mass in &mut after.masses[..self.count] {
            // Masses in flight keep their velocity while the structure loses that of its base.
            let freed = InGap { stuck: false, ..*mass };
            *mass = if mass.stuck { freed } else { mass.moved(later, R::ZERO) };
        }
        (after, later)
    }
}
