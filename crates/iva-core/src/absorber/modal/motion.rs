//! The motion of the modes and of all masses between two events.

use std::cell::OnceCell;

use super::drive::Aside;
use super::oscillation::{Oscillating, Oscillation};
use super::regime::Regime;
use super::series::{EXACT, ModalSeries, Series, scaled};
use super::state::{Felt, Modes, Place};
use super::swings::{Grown, Swing};
use super::{Modal, ModalState};
use crate::absorber::Clock;
use crate::host::{Host, Structure};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::Jet;
use crate::segment::taylor::{ORDER, ROOM, Row, horner};

/// A mass this close to the wall that it left, in clearances, is followed by the series of its own distance.
pub(super) const NEAR: f64 = 1e-6;

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
    oscillation: Option<Oscillation<'a, H>>,
    /// Unit of time of the series: a power of two.
    pub(super) unit: H::Real,
    pub(super) reach: H::Real,
    /// True if a pendulum swings.
    pub(super) swings: bool,
    /// True if what the power series leave out is bounded.
    pub(super) sure: bool,
    /// The power series, once they were needed.
    expansion: OnceCell<Box<Expansion<'a, H::Real>>>,
    /// x at the point that the run sees, once it was needed.
    seen: OnceCell<Series<H::Real>>,
}

/// The power series of a motion.
#[derive(Debug, Clone)]
struct Expansion<'a, R> {
    /// Of modes and pendulums.
    grown: Grown<'a, R>,
    /// ∬A at the points of the masses for which it was needed.
    curved: Vec<OnceCell<Series<R>>>,
    /// a_g in powers of t; empty where the base does not move.
    base: Vec<DoubleDouble<R>>,
    /// Harmonic forces at other points.
    asides: Vec<Aside<R>>,
}

impl<'a, R: Real, H: Host<Real = R>, const N: usize, const M: usize> ModalMotion<'a, H, N, M> {
    pub(super) fn new(system: &'a Modal<H, N, M>, from: &ModalState<H, N, M>) -> Self {
        Self::within(system, from, None)
    }

    /// The motion within a time that is proved already, if one is given.
    pub(super) fn within(
        system: &'a Modal<H, N, M>,
        from: &ModalState<H, N, M>,
        proved: Option<R>,
    ) -> Self {
        let regime = system.regime(&from.places);
        let swings = system.swings() && system.swinging(&from.places).next().is_some();
        let longest = if swings { system.longest_swing(from) } else { system.reach };
        let unit = R::power_of_two(longest);
        let oscillation = system.oscillating(from).map(Oscillating::motion);
        let reach = match (&oscillation, proved) {
            (_, Some(proved)) => proved,
            (Some(it), _) => it.reach(),
            (None, None) => {
                let smooth = system.host.smooth_for(&from.phase);
                if smooth <= longest { smooth } else { longest }
            }
        };
        let (expansion, seen) = (OnceCell::new(), OnceCell::new());
        let sure = true;
        let mut motion = Self {
            system,
            regime,
            from: *from,
            oscillation,
            unit,
            reach,
            swings,
            sure,
            expansion,
            seen,
        };
        if swings && proved.is_none() {
            motion.prove();
        }
        motion
    }

    /// Where pendulums swing, the motion ends where the series leave out more than full accuracy allows.
    fn prove(&mut self) {
        let most = (self.reach / self.unit).min(R::ONE * 2.0);
        let grown = &self.expansion().grown;
        let share = self.system.share_proved(grown, &self.from, (self.unit, most));
        self.sure = share.is_some();
        self.reach = share.map_or(self.reach, |share| share * self.unit);
    }

    /// That of the structure, where it moves as one.
    #[inline(always)]
    pub(super) fn oscillation(&self) -> Option<&Oscillation<'a, H>> {
        self.oscillation.as_ref()
    }

    fn expansion(&self) -> &Expansion<'a, R> {
        self.expansion.get_or_init(|| Box::new(self.expanded()))
    }

    fn expanded(&self) -> Expansion<'a, R> {
        let pushes = self.system.pushes(&self.from.phase, self.unit);
        let asides = self.system.asides(&self.from.phase, self.unit, ORDER);
        let feed = (&pushes, asides.as_slice());
        let grown = self.system.grown(&self.from, &self.regime, feed, self.unit, (ORDER, EXACT));
        let powers = if self.system.host.moves_base() { ORDER + 1 } else { 0 };
        let base = (0..powers).map(|m| pushes(m)[1]).collect();
        let curved = vec![OnceCell::new(); self.system.count().max(1)];
        Expansion { grown, curved, base, asides }
    }

    /// a_g in powers of t, in plain numbers.
    pub(super) fn base(&self) -> Row<R> {
        let base = &self.expansion().base;
        std::array::from_fn(|m| base.get(m).map_or(R::ZERO, |a| a.value))
    }

    /// ∬A at the point of a mass.
    pub(super) fn curved(&self, k: usize) -> &Series<R> {
        let Expansion { grown, curved, base, .. } = self.expansion();
        curved[k].get_or_init(|| {
            let place = &self.from.places[k];
            let base = |m: usize| base.get(m).copied().unwrap_or(DoubleDouble::ZERO);
            let mut curved = self.system.curved(grown, (k, place), base, (self.unit, ORDER));
            // At a release the acceleration is set to 0 without rounding.
            if place.leaves {
                curved.set(2, DoubleDouble::ZERO);
            }
            curved
        })
    }

    /// q and q̇ of all modes at h.
    #[inline(always)]
    pub(super) fn modes(&self, h: R) -> Modes<R, M> {
        self.modal_series().modes(self.system.whole.count(), self.share(h), self.unit)
    }

    /// q of all modes.
    pub(super) fn modal_series(&self) -> &ModalSeries<R> {
        &self.expansion().grown.rows
    }

    /// The power series of a pendulum in flight; `None` of any other member.
    pub(super) fn swing(&self, k: usize) -> Option<&Swing<'a, R, R, ROOM>> {
        if !self.swings {
            return None;
        }
        self.expansion().grown.swings.iter().find(|swing| swing.index == k)
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
        if self.swings {
            return self.largest_of_series(self.curved(k), 2);
        }
        let followed = self.system.followed(k, &self.from.places[k]);
        if let Some(it) = self.oscillation() {
            return it.bound(1) + followed.constant.value.abs();
        }
        self.system.bound(self.derivatives(1), &self.regime.stuck, followed, 1, self.reach)
    }

    /// A bound on the rate of A of a mass.
    pub(super) fn most_jerked(&self, k: usize) -> R {
        if self.swings {
            return self.largest_of_series(self.curved(k), 3);
        }
        if let Some(it) = self.oscillation() {
            return it.bound(2);
        }
        if self.system.pressed_row(k, &self.from.places[k]).is_some() {
            let stuck = &self.regime.stuck;
            return self.system.bound_of_load(k, stuck, self.derivatives(1), 2, self.reach);
        }
        let followed = self.system.followed(k, &self.from.places[k]);
        self.system.bound(self.derivatives(2), &self.regime.stuck, followed, 2, self.reach)
    }

    /// A bound on the derivative n − 1 of A of the absorber at hand, n > 1.
    #[inline(always)]
    pub(super) fn fourth_of(&self, n: usize) -> R {
        if let Some(it) = self.oscillation() {
            return it.bound(n);
        }
        let (k, begin) = self.begun();
        if self.swings {
            return self.largest_of_series(self.curved(k), n + 1);
        }
        if self.system.pressed_row(k, begin).is_some() {
            let stuck = &self.regime.stuck;
            return self.system.bound_of_load(k, stuck, self.derivatives(n - 1), n, self.reach);
        }
        let followed = self.system.followed(k, begin);
        self.system.bound(self.derivatives(n), &self.regime.stuck, followed, n, self.reach)
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

    pub(super) fn x(&self) -> &Series<R> {
        self.seen.get_or_init(|| self.displacement(self.system.whole.shape(self.system.seen)))
    }

    /// The displacement of a point of this shape.
    pub(super) fn displacement(&self, shape: &[R]) -> Series<R> {
        let mut sum = Series::ZERO;
        for m in 0..=ORDER {
            sum.set(m, self.modal_series().summed(shape, m));
        }
        sum
    }

    /// The place of a mass at h.
    #[inline(always)]
    pub(super) fn place(&self, k: usize, h: R) -> Place<R> {
        if let Some(it) = self.oscillation() {
            return self.oscillated_alone(it, k, h);
        }
        let (place, curved, t) = (&self.from.places[k], self.curved(k), self.share(h));
        if place.carried() {
            return *place;
        }
        let sided = |sum: DoubleDouble<R>| DoubleDouble {
            value: place.side * sum.value,
            rest: place.side * sum.rest,
        };
        let straight = place.rate.times(h);
        let [bent, gained] = curved.at(t);
        let distance = place.distance.plus_both(straight, sided(bent));
        let rate = place.rate + sided(scaled(gained, R::ONE / self.unit));
        Place { distance, rate, leaves: false, ..*place }
    }

    /// A of a mass and its derivatives at h, as many as its curve needs.
    #[inline(always)]
    pub(super) fn felt(&self, k: usize, h: R) -> [R; 4] {
        if let Some(it) = self.oscillation() {
            return it.felt(h, self.regime.pulls[k]);
        }
        let (curved, t, over) = (self.curved(k), self.share(h), R::ONE / self.unit);
        let square = over * over;
        let (cube, fourth) = (over * square, square * square);
        if self.from.places[k].carried() {
            let [a, jerk] = [curved.derivative::<2>(t).value, curved.derivative::<3>(t).value];
            let [snap, crackle] =
                [curved.derivative::<4>(t).value, curved.derivative::<5>(t).value];
            return [a * square, jerk * cube, snap * fourth, crackle * over * fourth];
        }
        let [a, jerk] = curved.bends(t);
        let snap = match self.system.friction[k] {
            friction if friction == 0.0 => R::ZERO,
            _ => curved.derivative::<4>(t).value * fourth,
        };
        [a * square, jerk * cube, snap, R::ZERO]
    }

    /// What is left of friction at rest before the absorber at hand, which is accelerated so, would go in a direction: of one that is stuck, off its
    /// wall.
    pub(super) fn carried_by(&self, sign: R, shaken: [R; 4]) -> Jet<R> {
        let [value, rate, curvature, jerk] = shaken.map(|it| sign * it);
        let (k, begin) = self.begun();
        let held = self.system.held_up_to(k, begin);
        Jet { value: value + held, rate, curvature, jerk }
    }

    /// A and its derivatives of the absorber at hand, at the begin. Where it has just been let go A is 0 exactly.
    pub(super) fn felt_first(&self) -> [R; 4] {
        let (k, begin) = self.begun();
        self.from.felt_by(k).unwrap_or_else(|| {
            let [a, jerk, snap, crackle] = self.felt(k, R::ZERO);
            [if begin.leaves { R::ZERO } else { a }, jerk, snap, crackle]
        })
    }

    /// The state at h, at which the modes are these.
    pub(super) fn state_with(&self, modes: Modes<R, M>, h: R) -> ModalState<H, N, M> {
        let (system, from) = (self.system, &self.from);
        let mut places = from.places;
        for (k, place) in places[..system.count()].iter_mut().enumerate() {
            let near = place.distance.value <= system.masses[k].clearance * NEAR
                || system.friction[k] != 0.0;
            *place = if place.carried() {
                *place
            } else if near || system.host.moves_base() || system.hanging(k).is_some() {
                // The series keeps the relative accuracy of a rebound or of a slide, however small it is.
                let place = self.place(k, h);
                let level = self.swing(k).is_some_and(|Swing { series, .. }| {
                    system.is_turned_level(k, series.pendulum, horner(&series.c, self.share(h)))
                });
                if level { Place { distance: DoubleDouble::new(R::NAN), ..place } } else { place }
            } else {
                system.place_after(from, k, (&modes, [DoubleDouble::ZERO; 2]), Clock::new(h))
            };
        }
        let free = system.host.free();
        let phase = free.renewed(&free.within(&from.phase, h));
        let k = self.at_hand();
        let rides = places[k].carried() && system.count() > 0;
        let felt = rides.then(|| Felt { of: k, shaken: self.felt(k, h) });
        ModalState { modes, places, phase, at_hand: from.at_hand, felt }
    }
}
