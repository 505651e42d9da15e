//! The motion of a structure that moves as one and that nothing ties to its masses: that of one oscillator.
//!
//! A mass in flight feels nothing of the structure but its absolute acceleration A. The structure feels of the mass its weight and its
//! friction, a constant force, which moves the middle of its motion by μ (G + s R). So its motions are those of [`crate::host`]: in
//! closed form where no force lasts, else one power series. Impacts, sticks, slides and the search for them are those of any
//! other structure.

use super::state::{Felt, Modes, Place};
use super::{Modal, ModalMotion, ModalState};
use crate::absorber::siva::coasts;
use crate::absorber::{Aboard, Clock, Coasted, Coasts, OnStructure as _};
use crate::host::oscillator::{Arrival, Primary};
use crate::host::{Flown, Host, HostState, Integrated, Phase, Structure};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::{Jet, Losses, Quantity, Rows, Travel, Turns};
use crate::segment::polynomial::product_integral;
use crate::segment::taylor::{ORDER, Row};

/// The structure with what it carries, and its state at one instant.
#[derive(Debug)]
pub(super) struct Oscillating<'a, H: Host> {
    pub structure: &'a H::Structure,
    /// Its displacement is that from the middle of the motion.
    pub state: HostState<Phase<H>, H::Real>,
    middle: DoubleDouble<H::Real>,
}

/// A motion of it.
#[derive(Debug)]
pub(super) struct Oscillation<'a, H: Host> {
    pub begin: Oscillating<'a, H>,
    course: <H::Structure as Structure>::Course,
}

impl<'a, R: Real, H: Host<Real = R>> Oscillating<'a, H> {
    /// A and its first three derivatives.
    fn derivatives(structure: &H::Structure, state: &HostState<Phase<H>, R>) -> [R; 4] {
        let HostState { primary, acceleration, phase } = state;
        let a = acceleration.value;
        let [jerk, snap, crackle] = structure.derivatives(phase, primary.v.value, a);
        [a, jerk, snap, crackle]
    }

    /// A of a mass that is pulled so, and its derivatives.
    #[inline(always)]
    pub(super) fn felt(&self, pull: DoubleDouble<R>) -> [R; 4] {
        let [_, jerk, snap, crackle] = Self::derivatives(self.structure, &self.state);
        [(self.state.acceleration + pull).value, jerk, snap, crackle]
    }

    /// The structure at the end of a motion from here.
    fn at<const N: usize, const M: usize>(
        &self,
        end: &ModalState<H, N, M>,
    ) -> HostState<Phase<H>, R> {
        let ([x, v], phase) = ([end.modes.places[0], end.modes.velocities[0]], end.phase);
        let primary = Primary { x: x - self.middle, v };
        HostState { primary, acceleration: self.structure.acceleration(&phase, &primary), phase }
    }

    /// The motion from here.
    pub(super) fn motion(self) -> Oscillation<'a, H> {
        Oscillation { course: self.structure.fast_course(&self.state), begin: self }
    }
}

impl<R: Real, H: Host<Real = R>> Oscillation<'_, H> {
    /// A bound on the derivative n − 1 of A, n from 1 to 5, but for its constant part.
    #[inline(always)]
    pub(super) fn bound(&self, n: usize) -> R {
        let Oscillating { structure, state: HostState { primary, .. }, .. } = &self.begin;
        match n {
            1 => structure.bound::<0>(primary),
            2 => structure.bound::<1>(primary),
            3 => structure.bound::<2>(primary),
            4 => structure.bound::<3>(primary),
            _ => structure.bound::<4>(primary),
        }
    }

    pub(super) fn reach(&self) -> R {
        self.begin.structure.reach(&self.begin.state)
    }

    fn flown(&self, h: R) -> HostState<Phase<H>, R> {
        self.begin.structure.flown(&self.begin.state, &self.course, h).to
    }

    /// x and its derivatives.
    pub(super) fn primary(&self, h: R) -> Jet<R> {
        let jet = self.begin.structure.jet(&self.begin.state, &self.course, h);
        Jet { value: jet.value + self.begin.middle.value, ..jet }
    }

    /// The absolute acceleration of the structure.
    pub(super) fn acceleration(&self, h: R) -> R {
        self.flown(h).acceleration.value
    }

    /// ∬A, ∫A and A, in plain numbers.
    #[inline(always)]
    pub(super) fn ahead(&self, h: R) -> [R; 3] {
        self.begin.structure.ahead(&self.begin.state, &self.course, h)
    }

    /// A of a mass that is pulled so, and its derivatives.
    pub(super) fn felt(&self, h: R, pull: DoubleDouble<R>) -> [R; 4] {
        let flown = self.flown(h);
        let [_, rest @ ..] = Oscillating::<H>::derivatives(self.begin.structure, &flown);
        let [jerk, snap, crackle] = rest;
        [(flown.acceleration + pull).value, jerk, snap, crackle]
    }

    /// The rate of A.
    pub(super) fn jerk(&self, h: R) -> R {
        Oscillating::<H>::derivatives(self.begin.structure, &self.flown(h))[1]
    }

    /// ∬A to twice the precision, where a grazing is to be decided.
    pub(super) fn precise(&self, h: R) -> DoubleDouble<R> {
        self.begin.structure.precise(&self.begin.state, h)
    }

    /// The power series of the structure's motion.
    fn series(&self) -> Rows<R> {
        self.displaced(self.begin.structure.series(&self.begin.state, &self.course))
    }

    fn displaced(&self, rows: Rows<R>) -> Rows<R> {
        let mut x = rows.x;
        x[0] += self.begin.middle.value;
        Rows { x, ..rows }
    }

    /// The same, if a force acts.
    pub(super) fn rows(&self) -> Option<Rows<R>> {
        let rows = self.begin.structure.rows(&self.begin.state, &self.course)?;
        Some(self.displaced(rows))
    }

    /// ∫x² between two instants.
    pub(super) fn square(&self, ends: [R; 2]) -> R {
        if self.begin.middle.value == 0.0 {
            return self.begin.structure.square(&self.begin.state, &self.course, ends);
        }
        let Rows { step, order, x, .. } = self.series();
        let x = &x[..=order];
        let until = |h: R| product_integral(x, x, h / step);
        (until(ends[1]) - until(ends[0])) * step
    }

    /// As [`Motion::largest`](crate::segment::flight::Motion::largest), in a motion to a state of the same structure.
    pub(super) fn largest<const N: usize, const M: usize>(
        &self,
        (of, least): (Quantity, R),
        length: R,
        end: &ModalState<H, N, M>,
    ) -> Option<R> {
        let Oscillating { structure, state, middle } = &self.begin;
        if middle.value != 0.0 {
            return None;
        }
        structure.largest(of, least, (state, &self.course), &self.begin.at(end), length)
    }

    /// Where x turns in a motion of this length to a state of the same structure.
    pub(super) fn turns<const N: usize, const M: usize>(
        &self,
        end: &ModalState<H, N, M>,
        length: R,
    ) -> Turns<R> {
        let Oscillating { structure, state, middle } = &self.begin;
        let end = self.begin.at(end);
        if !R::FAST_PATHS || state.primary.v.value * end.primary.v.value >= 0.0 {
            return Turns::Unknown;
        }
        match structure.turns(state, &self.course, &end, length) {
            Turns::Once(h, x) => Turns::Once(h, x + middle.value),
            other => other,
        }
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// The structure with the masses that it carries in a state.
    fn with_carried(&self, places: &[Place<R>; N]) -> &H::Structure {
        let set = self.carried_set(places);
        if set == 0 {
            return self.host.free();
        }
        let mass = || {
            let carried = (0..self.count()).filter(|k| set >> k & 1 == 1);
            carried.fold(R::ZERO, |sum, k| sum + self.masses[k].mass_ratio)
        };
        self.carrying[set].get_or_init(|| Box::new(self.host.carrying(mass()))).loaded()
    }

    /// The structure as an oscillator; `None` if it is none.
    #[inline(always)]
    pub(super) fn oscillating(&self, state: &ModalState<H, N, M>) -> Option<Oscillating<'_, H>> {
        if !self.oscillates() {
            return None;
        }
        let structure = self.with_carried(&state.places);
        let mut middle = DoubleDouble::ZERO;
        let mut released = None;
        for (k, place) in state.places[..self.count()].iter().enumerate() {
            let pull = self.pull(k, place);
            // At a release the acceleration is set to 0 without rounding.
            if place.leaves {
                released = Some(-pull);
            }
            if pull.value != 0.0 && !place.carried() {
                middle = middle + pull.times(self.masses[k].mass_ratio);
            }
        }
        let [x, v] = [state.modes.places[0] - middle, state.modes.velocities[0]];
        let (primary, phase) = (Primary { x, v }, state.phase);
        let acceleration = released.unwrap_or_else(|| structure.acceleration(&phase, &primary));
        Some(Oscillating { structure, state: HostState { primary, acceleration, phase }, middle })
    }

    /// A short time later: the oscillator and its drive.
    #[inline(always)]
    pub(super) fn soon(
        Oscillating { structure, state, .. }: &Oscillating<'_, H>,
        moved: &mut ModalState<H, N, M>,
        time: R,
    ) {
        let HostState { primary: Primary { v, .. }, acceleration, phase } = state;
        let [base, ..] = structure.base(phase);
        moved.modes.places[0] = moved.modes.places[0].plus(v.value * time);
        moved.modes.velocities[0] = v.plus((acceleration.value - base) * time);
        moved.phase = structure.later(phase, time);
    }

    /// True if nothing pulls at masses but their walls.
    pub(super) fn is_level(&self) -> bool {
        let pulls = self.gravity[..self.count()].iter().chain(&self.friction[..self.count()]);
        pulls.into_iter().all(|pull| *pull == 0.0)
    }

    /// As many steps in which no mass can meet a wall as all masses have, each alone; `None` of none.
    pub(super) fn steps_ahead(
        &self,
        state: &ModalState<H, N, M>,
        remaining: R,
    ) -> Coasts<ModalState<H, N, M>, R> {
        let flies = !state.places[..self.count()].iter().any(Place::carried);
        let steps = self.host.steps().filter(|_| flies && self.count() > 0);
        let steps = steps?;
        let primary = Primary { x: state.modes.places[0], v: state.modes.velocities[0] };
        let time = remaining.min(self.host.smooth_for(&state.phase)).double();
        let places = self.masses().iter().zip(&state.places);
        let count = places.fold(f64::INFINITY, |least, (mass, place)| {
            let within = [1.0 / mass.clearance.double(), time];
            least.min(coasts::count(steps, &place.in_doubles(&primary), within))
        });
        (count >= 1.0).then(|| (count as usize, self.stepped(state, count as usize)))
    }

    /// The state after so many steps.
    pub(super) fn stepped(
        &self,
        state: &ModalState<H, N, M>,
        count: usize,
    ) -> Coasted<ModalState<H, N, M>, R> {
        let Some(steps) = self.host.steps() else { return (*state, Clock::ZERO) };
        let primary = Primary { x: state.modes.places[0], v: state.modes.velocities[0] };
        let (by, time) = (steps.responses(count), steps.time(count as f64));
        let (to, _) = steps.after(&primary, by);
        let mut coasted = (*state, time);
        let after = &mut coasted.0;
        after.renew();
        after.phase = self.host.waited(&state.phase, time);
        (after.modes.places[0], after.modes.velocities[0]) = (to.x, to.v);
        for place in &mut after.places[..self.count()] {
            [place.distance, place.rate] =
                coasts::drifted([&primary, &to], place.side, [place.distance, place.rate], time);
        }
        coasted
    }

    /// The masses in a motion of a decay that is logged.
    pub(super) fn on_board(&self, state: &ModalState<H, N, M>) -> Aboard {
        let v = self.primary(state).v;
        let (mut carried, mut twice) = (0.0, 0.0);
        for (mass, place) in self.masses().iter().zip(&state.places) {
            let mu = mass.mass_ratio.double();
            if place.carried() {
                carried += mu;
            } else {
                let own = (v + place.gap(mass).w).double();
                twice += mu * (own * own);
            }
        }
        Aboard { carried, velocity: (twice / self.total().double()).sqrt(), height: 0.0 }
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> ModalMotion<'_, H, N, M> {
    /// The state after a motion of length h; at its end with the drive that acts from there on.
    #[inline(never)]
    pub(super) fn oscillated(
        &self,
        of: &Oscillation<'_, H>,
        h: R,
        ends: bool,
    ) -> ModalState<H, N, M> {
        let Oscillating { structure, state, middle } = &of.begin;
        let Flown { mut to, gained } = structure.flown(state, &of.course, h);
        if ends {
            structure.refresh(&mut to);
        }
        let (system, at_hand) = (self.system, self.from.at_hand);
        let mut modes = Modes::REST;
        modes.places[0] = to.primary.x + *middle;
        modes.velocities[0] = to.primary.v;
        let (places, phase) = (self.from.places, to.phase);
        let mut after: ModalState<H, N, M> =
            ModalState { modes, places, phase, at_hand, felt: None };
        let [a, jerk, snap, crackle] = Oscillating::<H>::derivatives(structure, &to);
        for (k, place) in after.places[..system.count()].iter_mut().enumerate() {
            let pull = self.regime.pulls[k];
            let felt = if pull.value == 0.0 { a } else { (to.acceleration + pull).value };
            if k == usize::from(at_hand) {
                after.felt = Some(Felt { of: k, shaken: [felt, jerk, snap, crackle] });
            }
            *place = self.oscillated_place(k, &gained, h);
        }
        after
    }

    /// The place of a mass at h, after which the structure has come to this.
    fn oscillated_place(&self, k: usize, gained: &Arrival<R>, h: R) -> Place<R> {
        let (place, pull) = (&self.from.places[k], self.regime.pulls[k]);
        if place.carried() {
            return *place;
        }
        let [mut curved, mut faster] = [gained.curved, gained.velocity];
        if pull.value != 0.0 {
            let fallen = pull.times(h);
            (curved, faster) = (curved + fallen.times(h).half(), faster + fallen);
        }
        let [curved, faster] = [curved, faster]
            .map(|sum| DoubleDouble { value: place.side * sum.value, rest: place.side * sum.rest });
        let distance = place.distance.plus_both(place.rate.times(h), curved);
        Place { distance, rate: place.rate + faster, leaves: false, ..*place }
    }

    /// The place of a mass alone at h.
    pub(super) fn oscillated_alone(&self, of: &Oscillation<'_, H>, k: usize, h: R) -> Place<R> {
        let Oscillating { structure, state, .. } = &of.begin;
        self.oscillated_place(k, &structure.flown(state, &of.course, h).gained, h)
    }

    /// The same, where distances and rates of masses in flight, and all of the structure, are those of plain numbers.
    pub(super) fn nearly_oscillated(&self, of: &Oscillation<'_, H>, h: R) -> ModalState<H, N, M> {
        let (system, mut after) = (self.system, self.from);
        let flies = |place: &Place<R>| !place.carried();
        if of.begin.structure.moves_base() || !after.places[..system.count()].iter().all(flies) {
            return self.oscillated(of, h, true);
        }
        let Primary { x, v } = of.begin.state.primary;
        let [curved, faster, _] = of.ahead(h);
        let x = v.value.mul_add(h, x.value + of.begin.middle.value) + curved;
        after.modes.places[0] = DoubleDouble::new(x);
        after.modes.velocities[0] = DoubleDouble::new(v.value + faster);
        after.felt = None;
        for k in 0..system.count() {
            let [distance, rate, _] = self.approached(k, h, [curved, faster, R::ZERO]);
            let [distance, rate] = [distance, rate].map(DoubleDouble::new);
            after.places[k] = Place { distance, rate, ..after.places[k] };
        }
        after
    }

    /// The distance of a mass in flight from its wall with two derivatives, after a motion with these ∬A, ∫A and A.
    #[inline(always)]
    pub(super) fn approached(&self, k: usize, h: R, [curved, faster, a]: [R; 3]) -> [R; 3] {
        let (Place { side, distance, rate, .. }, pull) =
            (&self.from.places[k], self.regime.pulls[k].value);
        let bent = (pull * h).mul_add(h * 0.5, curved);
        let travelled = side.mul_add(bent, rate.value * h);
        let faster = pull.mul_add(h, faster);
        [distance.value + travelled, side.mul_add(faster, rate.value), *side * (a + pull)]
    }

    /// The energy lost and the work done in a motion of length h. That on a moving base is done on the structure, and on each mass.
    pub(super) fn lost_by(&self, of: &Oscillation<'_, H>, h: R) -> Losses<R> {
        let Oscillating { structure, state: from, .. } = &of.begin;
        let on = |mass_ratio: R, gap_velocity: Option<R>| {
            structure.losses(&Integrated { from, course: &of.course, mass_ratio, gap_velocity }, h)
        };
        let [viscous, alone] = on(R::ZERO, None);
        let mut work = alone;
        if structure.moves_base() {
            for (mass, place) in self.system.masses().iter().zip(&self.from.places) {
                let w = (!place.carried()).then(|| place.gap(mass).w);
                work += on(mass.mass_ratio, w)[1] - alone;
            }
        }
        Losses { viscous, pivot: R::ZERO, work }
    }

    /// The power series of the structure and of a mass, whose gap obeys ÿ = −A in flight.
    pub(super) fn travel_by(&self, of: &Oscillation<'_, H>, absorber: usize) -> Travel<R> {
        let (rows, system) = (of.series(), self.system);
        let mut gap: Row<R> = [R::ZERO; ORDER + 1];
        let Some((mass, place)) = system.masses().iter().zip(&self.from.places).nth(absorber)
        else {
            return Travel::new(rows, gap, R::ONE);
        };
        let now = place.gap(mass);
        (gap[0], gap[1]) = (now.y, now.w * rows.step);
        if !place.carried() {
            for m in 0..=ORDER - 2 {
                let pull = if m == 0 { system.pull(absorber, place).value } else { R::ZERO };
                let over = R::reciprocal(m + 1) * R::reciprocal(m + 2);
                gap[m + 2] = -(rows.acceleration[m] + pull) * over * (rows.step * rows.step);
            }
        }
        Travel::new(rows, gap, R::ONE)
    }
}
