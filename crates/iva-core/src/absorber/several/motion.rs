//! The motion of a structure and of several masses between two events.

use super::sight::{Ends, Met};
use super::{InGap, MOST, Several, SeveralState};
use crate::absorber::siva::exact::InFlight;
use crate::absorber::{Absorber, OnStructure, Wall};
use crate::host::oscillator::Primary;
use crate::host::{Flown, Host, HostState, Integrated, Phase, Structure};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::contact::keeps_pressing;
use crate::segment::flight::{
    Curve, FastFlight, GapPoint, Jet, Losses, Meets, Motion, Quantity, Rows, Seen, Side, Travel,
    Turns,
};
use crate::segment::taylor::ORDER;

/// The motion from one state. Its curve is that of the absorber at hand: the distance to the wall last touched, or the
/// pressure on that wall while it is stuck.
#[derive(Debug, Clone)]
pub struct Together<'a, H: Host, const N: usize = MOST> {
    system: &'a Several<H, N>,
    structure: &'a H::Structure,
    pub(super) from: SeveralState<H, N>,
    course: <H::Structure as Structure>::Course,
}

impl<'a, R: Real, H: Host<Real = R>, const N: usize> Together<'a, H, N> {
    pub(super) fn new(system: &'a Several<H, N>, from: SeveralState<H, N>) -> Self {
        let structure = system.structure(&from.masses);
        Self { system, structure, from, course: structure.fast_course(&from.host) }
    }

    /// The place of the absorber at hand at the begin, if there is one.
    fn at_hand(&self) -> Option<&InGap<R>> {
        self.from.masses.get(usize::from(self.from.at_hand))
    }

    fn is_stuck(&self) -> bool {
        self.at_hand().is_some_and(|mass| mass.stuck)
    }

    /// The state after a motion of length h. A call, for six functions need it.
    #[inline(never)]
    fn moved(&self, h: R) -> SeveralState<H, N> {
        let Flown { to, gained } = self.structure.flown(&self.from.host, &self.course, h);
        let mut masses = self.from.masses;
        for mass in masses[..self.system.count].iter_mut().filter(|mass| !mass.stuck) {
            *mass = mass.flown(&gained, h);
        }
        SeveralState { host: to, masses, at_hand: self.from.at_hand }
    }

    /// The motion to a state, seen from both ends.
    fn ends<'e>(&'e self, end: &'e SeveralState<H, N>, length: R) -> Ends<'e, Phase<H>, R> {
        Ends { begin: &self.from.host, end: &end.host, length }
    }

    /// The energy lost and the work done in a motion of length h, of structure and one mass with this gap velocity.
    fn integrals(&self, mass_ratio: R, gap_velocity: Option<R>, h: R) -> [R; 2] {
        let (from, course) = (&self.from.host, &self.course);
        let motion = Integrated { from, course, mass_ratio, gap_velocity };
        self.structure.losses(&motion, h)
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize> Motion for Together<'_, H, N> {
    type Real = R;
    type State = SeveralState<H, N>;
    const RIDING: bool = false;

    fn origin(&self) -> &Self::State {
        &self.from
    }

    fn reach(&self) -> R {
        self.structure.reach(&self.from.host)
    }

    fn state(&self, h: R) -> Self::State {
        self.moved(h)
    }
    /// A structure alone meets no wall in any finite motion. Several masses are looked at one by one, a single one as they are.
    fn fast_path(&self, length: R) -> Option<FastFlight<Self::State, R>> {
        if N > 0 && (!R::FAST_PATHS || self.system.count > 1) {
            return None;
        }
        let (end, later) = (self.arrival(length), R::ZERO);
        if N > 0 {
            if let Some((length, side)) = self.meets(length, &end) {
                let end = self.arrival(length);
                return Some(FastFlight { length, later, end, meets: Meets::Near(side) });
            }
            let clear = self.clears(length, &end);
            return clear.then_some(FastFlight { length, later, end, meets: Meets::Nothing });
        }
        let Primary { x, v } = end.host.primary;
        let finite = x.value.is_finite() && v.value.is_finite();
        finite.then_some(FastFlight { length, later, end, meets: Meets::Nothing })
    }

    fn arrival(&self, h: R) -> Self::State {
        let mut state = self.moved(h);
        self.structure.refresh(&mut state.host);
        state
    }

    fn primary(&self, h: R) -> Jet<R> {
        self.structure.jet(&self.from.host, &self.course, h)
    }

    fn acceleration(&self, h: R) -> R {
        self.system.host.absolute(self.state(h).host.acceleration)
    }

    fn gap(&self, h: R) -> GapPoint<R> {
        let (state, none) = (self.state(h), GapPoint { y: R::ZERO, w: R::ZERO });
        self.system.seen(&state).map_or(none, |(mass, place)| place.gap(mass))
    }

    fn seen(&self, h: R) -> Seen<Self::State, R> {
        let state = self.state(h);
        let none = GapPoint { y: R::ZERO, w: R::ZERO };
        let gap = self.system.seen(&state).map_or(none, |(mass, place)| place.gap(mass));
        let acceleration = self.system.host.absolute(state.host.acceleration);
        Seen { state, primary: self.system.primary(&state), gap, acceleration }
    }

    fn wall(&self) -> Option<Wall> {
        self.wall_of(usize::from(self.from.at_hand))
    }

    fn absorbers(&self) -> usize {
        self.system.absorbers()
    }

    fn gap_of(&self, absorber: usize, h: R) -> GapPoint<R> {
        let gap = self.system.gaps(&self.state(h)).nth(absorber);
        gap.unwrap_or(GapPoint { y: R::ZERO, w: R::ZERO })
    }

    fn wall_of(&self, absorber: usize) -> Option<Wall> {
        let place = self.from.masses.get(absorber).filter(|place| place.stuck)?;
        Some(if place.side < 0.0 { Wall::Minus } else { Wall::Plus })
    }

    /// The work on a moving base is that on the structure, and that on each mass.
    fn losses(&self, h: R) -> Losses<R> {
        let [viscous, alone] = self.integrals(R::ZERO, None, h);
        let mut work = alone;
        if self.structure.moves_base() {
            for (mass, place) in self.system.each(&self.from) {
                let w = (!place.stuck).then(|| place.gap(mass).w);
                work += self.integrals(mass.mass_ratio, w, h)[1] - alone;
            }
        }
        Losses { viscous, pivot: R::ZERO, work }
    }

    fn square(&self, h: [R; 2]) -> R {
        self.structure.square(&self.from.host, &self.course, h)
    }

    fn largest(&self, of: Quantity, least: R, length: R, end: &Self::State) -> Option<R> {
        let motion = (&self.from.host, &self.course);
        self.structure.largest(of, least, motion, &end.host, length)
    }

    fn rows(&self) -> Option<Rows<R>> {
        self.structure.rows(&self.from.host, &self.course)
    }

    fn travel(&self) -> Option<Travel<R>> {
        self.travel_of(usize::from(self.from.at_hand))
    }

    /// The gap of a mass obeys ÿ = −A in flight.
    fn travel_of(&self, absorber: usize) -> Option<Travel<R>> {
        let rows = self.structure.series(&self.from.host, &self.course);
        let mut gap = [R::ZERO; ORDER + 1];
        let Some((mass, place)) = self.system.each(&self.from).nth(absorber) else {
            return Some(Travel::new(rows, gap, R::ONE));
        };
        let GapPoint { y, w } = place.gap(mass);
        (gap[0], gap[1]) = (y, w * rows.step);
        if !place.stuck {
            for k in 0..=ORDER - 2 {
                let over = R::reciprocal(k + 1) * R::reciprocal(k + 2);
                gap[k + 2] = -rows.acceleration[k] * over * (rows.step * rows.step);
            }
        }
        Some(Travel::new(rows, gap, R::ONE))
    }

    fn clears(&self, length: R, end: &Self::State) -> bool {
        let k = usize::from(self.from.at_hand);
        let (Some(from), Some(to)) = (self.from.masses.get(k), end.masses.get(k)) else {
            return false;
        };
        let begin = &self.from.host;
        if from.stuck {
            let pressed = |HostState { primary, acceleration, phase }: &HostState<Phase<H>, R>| {
                let a = acceleration.value;
                let [jerk, ..] = self.structure.derivatives(phase, primary.v.value, a);
                [-from.side * a, -from.side * jerk]
            };
            let (size, fourth) = (
                self.structure.bound::<0>(&begin.primary),
                self.structure.bound::<4>(&begin.primary),
            );
            return keeps_pressing([pressed(begin), pressed(&end.host)], size, fourth, length);
        }
        let (ends, clearance) = (self.ends(end, length), self.system.masses[k].clearance);
        from.clears(to, self.structure, &ends, clearance)
    }

    fn meets(&self, length: R, end: &Self::State) -> Option<(R, Side)> {
        let k = usize::from(self.from.at_hand);
        let (from, to) = (self.from.masses.get(k)?, end.masses.get(k)?);
        let (ends, clearance) = (self.ends(end, length), self.system.masses[k].clearance);
        if from.stuck {
            return None;
        }
        let flight = InFlight { free: self.structure, course: &self.course };
        let Met { sure, far, h } = from.meets(to, &flight, &ends, clearance);
        sure.then_some((h, if far { Side::Far } else { Side::Near }))
    }

    fn turns(&self, length: R, end: &Self::State) -> Turns<R> {
        let [v, v_end] = [&self.from, end].map(|state| state.host.primary.v.value);
        if !R::FAST_PATHS || v * v_end >= 0.0 {
            return Turns::Unknown;
        }
        self.structure.turns(&self.from.host, &self.course, &end.host, length)
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize> Curve for Together<'_, H, N> {
    type Real = R;
    type Sample = SeveralState<H, N>;

    fn sample(&self, h: R) -> Self::Sample {
        self.state(h)
    }

    /// D, or the pressure −s A.
    fn jet(&self, sample: &Self::Sample) -> Jet<R> {
        let stuck = self.at_hand().filter(|mass| mass.stuck);
        let Some(InGap { side, .. }) = stuck.copied() else {
            let seen = SeveralState { at_hand: self.from.at_hand, ..*sample };
            return self.system.distance(&seen);
        };
        let HostState { primary, phase, .. } = &sample.host;
        let a = self.structure.acceleration(phase, primary).value;
        let [jerk, snap, crackle] = self.structure.derivatives(phase, primary.v.value, a);
        let [value, rate, curvature, jerk] = [a, jerk, snap, crackle].map(|it| -side * it);
        Jet { value, rate, curvature, jerk }
    }

    fn precise(&self, h: R) -> DoubleDouble<R> {
        let flying = self.at_hand().filter(|mass| !mass.stuck);
        let Some(InGap { side, distance, rate, .. }) = flying.copied() else {
            return DoubleDouble::new(self.jet(&self.state(h)).value);
        };
        let travelled = rate.times(h);
        let curved = self.structure.precise(&self.from.host, h);
        distance
            .plus_parts(travelled.value, travelled.rest)
            .plus_parts(side * curved.value, side * curved.rest)
    }

    fn fourth(&self) -> R {
        let begin = &self.from.host.primary;
        if self.is_stuck() {
            self.structure.bound::<4>(begin)
        } else {
            self.structure.bound::<2>(begin)
        }
    }

    fn magnitude(&self) -> R {
        if self.is_stuck() {
            self.structure.bound::<0>(&self.from.host.primary)
        } else {
            self.system.clearance_at_hand(&self.from)
        }
    }
}
