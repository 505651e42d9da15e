//! What the event loop, searches and observers ask of a motion.

use super::losses::{at_nodes, mean};
use super::motion::NEAR;
use super::{ModalMotion, ModalState, Place, wall_of};
use crate::absorber::{Absorber as _, OnStructure, Wall};
use crate::host::Host;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::{
    Curve, FastFlight, GapPoint, Jet, Losses, Meets, Motion, Quantity, Rows, Seen, Side, Travel,
    Turns,
};
use crate::segment::taylor::{ORDER, Row, horner};

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Motion
    for ModalMotion<'_, H, N, M>
{
    type Real = R;
    type State = ModalState<H, N, M>;
    const RIDING: bool = false;

    fn origin(&self) -> &Self::State {
        &self.from
    }

    fn reach(&self) -> R {
        self.reach
    }

    fn state(&self, h: R) -> Self::State {
        if let Some(it) = self.oscillation() {
            return self.oscillated(it, h, false);
        }
        self.state_with(self.modes(h), h)
    }

    fn arrival(&self, h: R) -> Self::State {
        match self.oscillation() {
            Some(it) => self.oscillated(it, h, true),
            None => self.state(h),
        }
    }

    /// Of one mass; several are asked one by one. A structure alone meets no wall in any finite motion.
    fn fast_path(&self, length: R) -> Option<FastFlight<Self::State, R>> {
        if self.system.count() == 0 {
            let (end, later, meets) = (self.arrival(length), R::ZERO, Meets::Nothing);
            let finite = self.system.energy(&end).is_finite();
            return finite.then_some(FastFlight { length, later, end, meets });
        }
        if !R::FAST_PATHS || self.begun().1.carried() {
            return None;
        }
        let ahead = self.ahead(length);
        if self.clears(length, &ahead) {
            let end = self.completed(length, &ahead);
            return Some(FastFlight { length, later: R::ZERO, end, meets: Meets::Nothing });
        }
        let (length, side) = self.meets(length, &ahead)?;
        let end = self.arrival(length);
        Some(FastFlight { length, later: R::ZERO, end, meets: Meets::Near(side) })
    }

    /// Distances and rates of masses in flight are those of plain numbers.
    fn ahead(&self, h: R) -> Self::State {
        if let Some(it) = self.oscillation() {
            return self.nearly_oscillated(it, h);
        }
        let (system, from) = (self.system, &self.from);
        let modes = self.modes(h);
        let mut ahead = ModalState { modes, ..*from };
        for k in 0..system.count() {
            let place = &from.places[k];
            let rubs = system.friction[k] != 0.0;
            ahead.places[k] = if place.carried() || rubs || system.host.moves_base() {
                self.place(k, h)
            } else if system.hanging(k).is_some() {
                let [distance, rate, _] = self.approach(k, h);
                let [distance, rate] = [distance, rate].map(DoubleDouble::new);
                Place { distance, rate, leaves: false, ..*place }
            } else {
                let [mut u, mut v] = [R::ZERO; 2];
                for (j, phi) in system.gap_shape(k).iter().enumerate() {
                    let (q, rate) = (from.modes.places[j].value, from.modes.velocities[j].value);
                    let moved = modes.places[j].value - rate.mul_add(h, q);
                    u = phi.mul_add(moved, u);
                    v = phi.mul_add(modes.velocities[j].value - rate, v);
                }
                let gained = system.falling(k, place).value * h;
                (u, v) = (u + gained * h * 0.5, v + gained);
                let distance =
                    place.side.mul_add(u, place.rate.value.mul_add(h, place.distance.value));
                let rate = place.side.mul_add(v, place.rate.value);
                let [distance, rate] = [distance, rate].map(DoubleDouble::new);
                Place { distance, rate, ..*place }
            };
        }
        ahead
    }

    fn completed(&self, h: R, ahead: &Self::State) -> Self::State {
        match self.oscillation() {
            Some(it) => self.oscillated(it, h, true),
            None => self.state_with(ahead.modes, h),
        }
    }

    fn clears(&self, length: R, end: &Self::State) -> bool {
        self.surely_clears(length, end)
    }

    fn meets(&self, length: R, end: &Self::State) -> Option<(R, Side)> {
        self.sure_contact(length, end)
    }

    fn turns(&self, length: R, end: &Self::State) -> Turns<R> {
        if let Some(it) = self.oscillation() {
            return it.turns(end, length);
        }
        let never = if self.swings {
            self.surely_never_turns(length)
        } else {
            self.system.never_turns(&self.regime, [&self.from, end], length)
        };
        if never { Turns::Never } else { Turns::Unknown }
    }

    fn primary(&self, h: R) -> Jet<R> {
        if let Some(it) = self.oscillation() {
            return it.primary(h);
        }
        let (x, t, over) = (self.x(), self.share(h), R::ONE / self.unit);
        Jet {
            value: x.derivative::<0>(t).value,
            rate: x.derivative::<1>(t).value * over,
            curvature: x.derivative::<2>(t).value * over * over,
            jerk: x.derivative::<3>(t).value * over * over * over,
        }
    }

    fn acceleration(&self, h: R) -> R {
        if let Some(it) = self.oscillation() {
            return it.acceleration(h);
        }
        self.primary(h).curvature + horner(&self.base(), self.share(h))
    }

    fn acceleration_at(&self, absorber: usize, h: R) -> Option<R> {
        if absorber >= self.system.count() {
            return None;
        }
        if let Some(it) = self.oscillation() {
            return Some(it.acceleration(h));
        }
        let constant = [self.system.gravity[absorber], self.system.friction[absorber]];
        let hangs = self.system.hanging(absorber).is_some();
        if self.system.tied[absorber].is_none() && constant == [R::ZERO; 2] && !hangs {
            return Some(self.system.shaken(&self.state(h), absorber)[0]);
        }
        let (t, over) = (self.share(h), R::ONE / self.unit);
        let bent = self.displacement(self.system.shape(absorber)).derivative::<2>(t).value;
        Some(bent * over * over + horner(&self.base(), t))
    }

    fn gap(&self, h: R) -> GapPoint<R> {
        self.gap_of(self.at_hand(), h)
    }

    fn absorbers(&self) -> usize {
        self.system.count()
    }

    fn gap_of(&self, absorber: usize, h: R) -> GapPoint<R> {
        let k = self.system.index(absorber);
        self.place(k, h).gap(&self.system.masses[k])
    }

    fn wall_of(&self, absorber: usize) -> Option<Wall> {
        let place = self.from.places.get(absorber).filter(|place| place.stuck)?;
        Some(wall_of(place.side))
    }

    fn seen(&self, h: R) -> Seen<Self::State, R> {
        let state = self.state(h);
        let primary = self.system.primary(&state);
        Seen { state, primary, gap: self.gap(h), acceleration: self.acceleration(h) }
    }

    fn wall(&self) -> Option<Wall> {
        self.wall_of(self.at_hand())
    }

    fn losses(&self, h: R) -> Losses<R> {
        self.lost(h)
    }

    fn square(&self, ends: [R; 2]) -> R {
        if let Some(it) = self.oscillation() {
            return it.square(ends);
        }
        let x = at_nodes(&self.x().row(), &self.nodes(ends));
        mean(&x, &x) * (ends[1] - ends[0])
    }

    fn largest(&self, of: Quantity, least: R, length: R, end: &Self::State) -> Option<R> {
        self.oscillation()?.largest((of, least), length, end)
    }

    fn rows(&self) -> Option<Rows<R>> {
        if let Some(it) = self.oscillation() {
            return it.rows();
        }
        let (x, base) = (self.x().row(), self.base());
        let square = R::ONE / (self.unit * self.unit);
        let acceleration = std::array::from_fn(|m| {
            let of = ((m + 1) * (m + 2)) as f64;
            let bent = if m + 2 <= ORDER { x[m + 2] * of * square } else { R::ZERO };
            if m + 2 <= ORDER { bent + base[m] } else { R::ZERO }
        });
        Some(Rows { step: self.unit, order: ORDER, x, acceleration, base })
    }

    fn travel(&self) -> Option<Travel<R>> {
        self.travel_of(self.at_hand())
    }

    /// The structure is that at the point that the run sees, the absorber at its own point.
    fn travel_of(&self, absorber: usize) -> Option<Travel<R>> {
        if let Some(it) = self.oscillation() {
            return Some(self.travel_by(it, absorber));
        }
        let (k, rows) = (self.system.index(absorber), self.rows()?);
        let (mass, place) = (&self.system.masses[k], &self.from.places[k]);
        let GapPoint { y, w } = place.gap(mass);
        let curved = self.curved(k).row();
        let mut gap: Row<R> =
            std::array::from_fn(|m| if place.carried() { R::ZERO } else { -curved[m] });
        (gap[0], gap[1]) = (y, w * self.unit);
        let own = self.displacement(self.system.shape(k)).row();
        let [_, lever, _] = self.system.beside(k, [R::ZERO, R::ONE, R::ZERO]);
        let mut absorber: Row<R> = match self.swing(k) {
            Some(swing) if swing.series.pendulum.rise != 0.0 => {
                let lever = swing.series.pendulum.lever;
                std::array::from_fn(|m| lever.mul_add(swing.series.beside(m), own[m]))
            }
            _ => std::array::from_fn(|m| lever.mul_add(gap[m], own[m])),
        };
        absorber[0] = own[0] + self.system.beside(k, [y, w, R::ZERO])[0];
        Some(Travel { rows, gap, absorber })
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> ModalMotion<'_, H, N, M> {
    /// The jet of the curve where the absorber at hand has a place, and A these values.
    fn jet_of(&self, place: &Place<R>, felt: [R; 4]) -> Jet<R> {
        let begin = self.begun().1;
        if begin.carried() {
            return self.carried_by(-begin.side, felt);
        }
        let [curvature, jerk] = [felt[0], felt[1]].map(|it| place.side * it);
        Jet { value: place.distance.value, rate: place.rate.value, curvature, jerk }
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Curve
    for ModalMotion<'_, H, N, M>
{
    type Real = R;

    /// D; or what the wall and friction carry beyond the pressure −s A, or friction beyond A.
    fn jet(&self, h: R) -> Jet<R> {
        let k = self.at_hand();
        self.jet_of(&self.place(k, h), self.felt(k, h))
    }

    fn first(&self) -> Jet<R> {
        self.jet_of(self.begun().1, self.felt_first())
    }

    fn precise(&self, h: R) -> DoubleDouble<R> {
        let (k, begin) = self.begun();
        if begin.carried() {
            return DoubleDouble::new(self.jet(h).value);
        }
        if let Some(it) = self.oscillation() {
            let (pull, side) = (self.regime.pulls[k], begin.side);
            let bent = it.precise(h) + pull.times(h).times(h).half();
            let bent = DoubleDouble { value: side * bent.value, rest: side * bent.rest };
            return begin.distance + begin.rate.times(h) + bent;
        }
        if self.swings {
            return self.precise_distance(k, h);
        }
        self.place(k, h).distance
    }

    fn fourth(&self) -> R {
        let (_, begin) = self.begun();
        self.fourth_of(if begin.carried() { 5 } else { 3 })
    }

    fn near(&self) -> R {
        let by_series = self.system.count() > 0 && self.oscillation().is_none();
        if by_series { self.system.masses[self.at_hand()].clearance * NEAR } else { R::ZERO }
    }

    fn magnitude(&self) -> R {
        let (k, begin) = self.begun();
        if begin.carried() {
            self.system.terms(&self.from, k)
        } else {
            self.system.masses[k].size_at(begin.distance.value)
        }
    }
}
