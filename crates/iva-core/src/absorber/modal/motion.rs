//! The motion of the modes and of all masses between two events.

use std::cell::OnceCell;

use super::drive::Aside;
use super::equations::Regime;
use super::losses::{at_nodes, mean};
use super::oscillation::{Oscillating, Oscillation};
use super::series::{EXACT, ModalSeries, Series, scaled};
use super::state::{Modes, Place};
use super::{Modal, ModalState, wall_of};
use crate::absorber::{Clock, OnStructure, Wall};
use crate::host::{Host, Structure};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::{
    Curve, FastFlight, GapPoint, Jet, Losses, Meets, Motion, Rows, Seen, Side, Travel, Turns,
};
use crate::segment::taylor::{ORDER, Row, horner};

/// A mass this close to the wall that it left, in clearances, is followed by the series of its own distance.
const NEAR: f64 = 1e-6;

/// The motion from one state. Its curve is that of the absorber at hand: the distance to the wall last touched, or the
/// pressure on that wall while it is stuck.
///
/// A sample of the curve holds the place of that absorber only, the rest of it is that of the begin.
#[derive(Debug)]
pub struct ModalMotion<'a, H: Host, const N: usize, const M: usize> {
    pub(super) system: &'a Modal<H, N, M>,
    pub(super) regime: Regime<'a, H::Real, N>,
    pub(super) from: ModalState<H, N, M>,
    /// That of the structure, where it moves as one.
    pub(super) oscillation: Option<Oscillation<'a, H>>,
    /// Unit of time of the series: a power of two.
    pub(super) unit: H::Real,
    reach: H::Real,
    /// The power series, once they were needed.
    expansion: OnceCell<Box<Expansion<H::Real, N>>>,
    /// x at the point that the run sees, once it was needed.
    seen: OnceCell<Series<H::Real>>,
}

/// The power series of a motion.
#[derive(Debug, Clone)]
struct Expansion<R, const N: usize> {
    /// q of all modes.
    rows: ModalSeries<R>,
    /// ∬A at the points of the masses for which it was needed.
    curved: [OnceCell<Series<R>>; N],
    /// a_g in powers of t; empty where the base does not move.
    base: Vec<DoubleDouble<R>>,
    /// Harmonic forces at other points.
    asides: Vec<Aside<R>>,
}

impl<'a, R: Real, H: Host<Real = R>, const N: usize, const M: usize> ModalMotion<'a, H, N, M> {
    pub(super) fn new(system: &'a Modal<H, N, M>, from: &ModalState<H, N, M>) -> Self {
        let regime = system.regime(&from.places);
        let unit = R::power_of_two(system.reach);
        let oscillation = system.oscillating(from).map(Oscillating::motion);
        let reach = match &oscillation {
            Some(it) => it.reach(),
            None => {
                let smooth = system.host.smooth_for(&from.phase);
                if smooth <= system.reach { smooth } else { system.reach }
            }
        };
        let (expansion, seen) = (OnceCell::new(), OnceCell::new());
        Self { system, regime, from: *from, oscillation, unit, reach, expansion, seen }
    }

    fn expansion(&self) -> &Expansion<R, N> {
        self.expansion.get_or_init(|| Box::new(self.expanded()))
    }

    fn expanded(&self) -> Expansion<R, N> {
        let pushes = self.system.pushes(&self.from.phase, self.unit);
        let asides = self.system.asides(&self.from.phase, self.unit, ORDER);
        let rows = self.system.series(
            &self.from.modes,
            &self.regime,
            (&pushes, &asides),
            self.unit,
            (ORDER, EXACT),
        );
        let powers = if self.system.host.moves_base() { ORDER + 1 } else { 0 };
        let base = (0..powers).map(|m| pushes(m)[1]).collect();
        Expansion { rows, curved: [const { OnceCell::new() }; N], base, asides }
    }

    /// a_g in powers of t, in plain numbers.
    fn base(&self) -> Row<R> {
        let base = &self.expansion().base;
        std::array::from_fn(|m| base.get(m).map_or(R::ZERO, |a| a.value))
    }

    /// ∬A at the point of a mass.
    pub(super) fn curved(&self, k: usize) -> &Series<R> {
        let Expansion { rows, curved, base, .. } = self.expansion();
        curved[k].get_or_init(|| {
            let place = &self.from.places[k];
            let followed = self.system.followed(k, place);
            let base = |m: usize| base.get(m).copied().unwrap_or(DoubleDouble::ZERO);
            let mut curved = self.system.curved(rows, followed, base, (self.unit, ORDER));
            // At a release the acceleration is set to 0 without rounding.
            if place.shaken.is_some_and(|shaken| shaken[0] == 0.0) {
                curved.set(2, DoubleDouble::ZERO);
            }
            curved
        })
    }

    /// q of all modes.
    pub(super) fn modal_series(&self) -> &ModalSeries<R> {
        &self.expansion().rows
    }

    /// The harmonic forces at other points.
    pub(super) fn asides(&self) -> &[Aside<R>] {
        &self.expansion().asides
    }

    /// The derivatives n and n + 1 of each mode at the begin.
    fn derivatives(&self, n: usize) -> impl Fn(usize) -> [R; 2] {
        let powers = (1..=n).fold(R::ONE, |power, i| power / self.unit * i as f64);
        let next = powers / self.unit * (n + 1) as f64;
        let rows = self.modal_series();
        move |j| [rows.plain(j, n) * powers, rows.plain(j, n + 1) * next]
    }

    pub(super) fn share(&self, h: R) -> R {
        h / self.unit
    }

    /// A bound on |A| of a mass.
    pub(super) fn most_shaken(&self, k: usize) -> R {
        let followed = self.system.followed(k, &self.from.places[k]);
        if let Some(it) = &self.oscillation {
            return it.bound(1) + followed.constant.value.abs();
        }
        self.system.bound(self.derivatives(1), self.regime.stuck, followed, 1, self.reach)
    }

    /// A bound on the derivative n − 1 of A of the absorber at hand, n > 1.
    pub(super) fn fourth_of(&self, n: usize) -> R {
        if let Some(it) = &self.oscillation {
            return it.bound(n);
        }
        let (k, begin) = self.begun();
        let followed = self.system.followed(k, begin);
        self.system.bound(self.derivatives(n), self.regime.stuck, followed, n, self.reach)
    }

    /// The index of the absorber at hand.
    pub(super) fn at_hand(&self) -> usize {
        self.system.index(self.from.at_hand.into())
    }

    /// The index of the absorber at hand, and its place at the begin.
    pub(super) fn begun(&self) -> (usize, &Place<R>) {
        let k = self.at_hand();
        (k, &self.from.places[k])
    }

    fn x(&self) -> &Series<R> {
        self.seen.get_or_init(|| self.displacement(self.system.whole.shape(self.system.seen)))
    }

    /// The displacement of a point of this shape.
    fn displacement(&self, shape: &[R]) -> Series<R> {
        let mut sum = Series::ZERO;
        for m in 0..=ORDER {
            sum.set(m, self.modal_series().summed(shape, m));
        }
        sum
    }

    /// The place of a mass at h. Its accelerations are those that its curve needs.
    #[inline(always)]
    pub(super) fn place(&self, k: usize, h: R) -> Place<R> {
        if let Some(it) = &self.oscillation {
            return self.oscillated(it, h, false).places[k];
        }
        let (place, curved, t) = (&self.from.places[k], self.curved(k), self.share(h));
        let over = R::ONE / self.unit;
        let square = over * over;
        if place.carried() {
            let jerks = [curved.derivative::<3>(t), curved.derivative::<4>(t)];
            let a = curved.derivative::<2>(t).value * square;
            let [jerk, snap] = [jerks[0].value * over * square, jerks[1].value * square * square];
            let crackle = curved.derivative::<5>(t).value * over * square * square;
            return Place { shaken: Some([a, jerk, snap, crackle]), ..*place };
        }
        let sided = |sum: DoubleDouble<R>| DoubleDouble {
            value: place.side * sum.value,
            rest: place.side * sum.rest,
        };
        let straight = place.rate.times(h);
        let [bent, gained] = curved.at(t);
        let distance = place.distance.plus_both(straight, sided(bent));
        let rate = place.rate + sided(scaled(gained, over));
        let [a, jerk] = curved.bends(t);
        let snap = match self.system.friction[k] {
            friction if friction == 0.0 => R::ZERO,
            _ => curved.derivative::<4>(t).value * square * square,
        };
        let shaken = Some([a * square, jerk * over * square, snap, R::ZERO]);
        Place { distance, rate, shaken, ..*place }
    }

    /// What is left of friction at rest before the absorber at hand, which is accelerated so, would go in a direction: of one that is stuck, off its
    /// wall.
    pub(super) fn carried_by(&self, sign: R, shaken: [R; 4]) -> Jet<R> {
        let [value, rate, curvature, jerk] = shaken.map(|it| sign * it);
        let held = self.system.static_friction[self.at_hand()];
        Jet { value: value + held, rate, curvature, jerk }
    }

    /// A and its derivatives that come with a place of the absorber at hand; those at the begin where none do.
    pub(super) fn shaken(&self, place: &Place<R>) -> [R; 4] {
        let begin = || self.place(self.at_hand(), R::ZERO).shaken;
        place.shaken.or_else(begin).unwrap_or([R::NAN; 4])
    }

    /// The state at h, at which the modes are these.
    fn state_with(&self, modes: Modes<R, M>, h: R) -> ModalState<H, N, M> {
        let (system, from) = (self.system, &self.from);
        let mut places = from.places;
        for (k, place) in places[..system.count].iter_mut().enumerate() {
            let near = place.distance.value <= system.masses[k].clearance * NEAR
                || system.friction[k] != 0.0;
            *place = if place.carried() {
                self.place(k, h)
            } else if near || system.host.moves_base() {
                // The series keeps the relative accuracy of a rebound or of a slide, however small it is.
                Place { shaken: None, ..self.place(k, h) }
            } else {
                system.place_after(from, k, (&modes, [DoubleDouble::ZERO; 2]), Clock::new(h))
            };
        }
        let free = system.host.free();
        let phase = free.renewed(&free.within(&from.phase, h));
        ModalState { modes, places, phase, at_hand: from.at_hand }
    }
}

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
        if let Some(it) = &self.oscillation {
            return self.oscillated(it, h, false);
        }
        self.state_with(self.modal_series().modes(self.share(h), self.unit), h)
    }

    fn arrival(&self, h: R) -> Self::State {
        match &self.oscillation {
            Some(it) => self.oscillated(it, h, true),
            None => self.state(h),
        }
    }

    /// Of one mass; several are asked one by one. A structure alone meets no wall in any finite motion.
    fn fast_path(&self, length: R) -> Option<FastFlight<Self::State, R>> {
        if self.system.count == 0 {
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
        if let Some(it) = &self.oscillation {
            return self.oscillated(it, h, true);
        }
        let (system, from) = (self.system, &self.from);
        let modes = self.modal_series().modes(self.share(h), self.unit);
        let mut ahead = ModalState { modes, ..*from };
        for k in 0..system.count {
            let place = &from.places[k];
            let rubs = system.friction[k] != 0.0;
            ahead.places[k] = if place.carried() || rubs || system.host.moves_base() {
                self.place(k, h)
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
        if self.oscillation.is_some() { *ahead } else { self.state_with(ahead.modes, h) }
    }

    fn clears(&self, length: R, end: &Self::State) -> bool {
        self.surely_clears(length, end)
    }

    fn meets(&self, length: R, end: &Self::State) -> Option<(R, Side)> {
        self.sure_contact(length, end)
    }

    fn turns(&self, length: R, end: &Self::State) -> Turns<R> {
        if let Some(it) = &self.oscillation {
            return it.turns(end, length);
        }
        let never = self.system.never_turns([&self.from, end], length);
        if never { Turns::Never } else { Turns::Unknown }
    }

    fn primary(&self, h: R) -> Jet<R> {
        if let Some(it) = &self.oscillation {
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
        if let Some(it) = &self.oscillation {
            return it.acceleration(h);
        }
        self.primary(h).curvature + horner(&self.base(), self.share(h))
    }

    fn acceleration_at(&self, absorber: usize, h: R) -> Option<R> {
        if absorber >= self.system.count {
            return None;
        }
        if let Some(it) = &self.oscillation {
            return Some(it.acceleration(h));
        }
        let constant = [self.system.gravity[absorber], self.system.friction[absorber]];
        if self.system.tied[absorber].is_none() && constant == [R::ZERO; 2] {
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
        self.system.count
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
        if let Some(it) = &self.oscillation {
            return it.square(ends);
        }
        let x = at_nodes(&self.x().row(), &self.nodes(ends));
        mean(&x, &x) * (ends[1] - ends[0])
    }

    fn rows(&self) -> Option<Rows<R>> {
        if let Some(it) = &self.oscillation {
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
        if let Some(it) = &self.oscillation {
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
        let absorber = std::array::from_fn(|m| own[m] + gap[m]);
        Some(Travel { rows, gap, absorber })
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Curve
    for ModalMotion<'_, H, N, M>
{
    type Real = R;
    type Sample = ModalState<H, N, M>;

    fn sample(&self, h: R) -> Self::Sample {
        if let Some(it) = &self.oscillation {
            return self.oscillated(it, h, false);
        }
        let k = self.at_hand();
        let mut sample = self.from;
        sample.places[k] = self.place(k, h);
        sample
    }

    /// D; or what the wall and friction carry beyond the pressure −s A, or friction beyond A.
    fn jet(&self, sample: &Self::Sample) -> Jet<R> {
        let (k, begin) = self.begun();
        let place = &sample.places[k];
        let shaken = self.shaken(place);
        if begin.carried() {
            return self.carried_by(-begin.side, shaken);
        }
        let [curvature, jerk] = [shaken[0], shaken[1]].map(|it| place.side * it);
        Jet { value: place.distance.value, rate: place.rate.value, curvature, jerk }
    }

    fn precise(&self, h: R) -> DoubleDouble<R> {
        let (k, begin) = self.begun();
        if begin.carried() {
            return DoubleDouble::new(self.jet(&self.sample(h)).value);
        }
        if let Some(it) = &self.oscillation {
            let (pull, side) = (self.regime.pulls[k], begin.side);
            let bent = it.precise(h) + pull.times(h).times(h).half();
            let bent = DoubleDouble { value: side * bent.value, rest: side * bent.rest };
            return begin.distance + begin.rate.times(h) + bent;
        }
        self.place(k, h).distance
    }

    fn fourth(&self) -> R {
        let (_, begin) = self.begun();
        self.fourth_of(if begin.carried() { 5 } else { 3 })
    }

    fn magnitude(&self) -> R {
        let (k, begin) = self.begun();
        if begin.carried() {
            self.system.terms(&self.from, k)
        } else {
            self.system.masses[k].clearance
        }
    }
}
