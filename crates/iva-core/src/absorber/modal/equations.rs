//! The equations of the modes between events, and their power series.
//!
//! The forces on the modes are g = −ω²q − Σ k φφᵀq − D q̇ + φ_f f − Γ a_g + Σ μ G φ, with the springs k and the weights μ G in all gaps.
//! A stuck mass pulls at its point with R = −μ (ü + a_g + G), so that with the shapes Φ of all stuck masses
//!
//! ```text
//! q̈ = g + Φ R,    (μ⁻¹ + ΦᵀΦ) R = −(Φᵀ g + a_g + G).
//! ```
//!
//! With M′ = I + Φ μ Φᵀ the energy ½ (q̇ᵀM′q̇ + qᵀω²q) falls without drive, and so does that of each derivative. Under drive
//! the root of twice the energy grows by |φ_f| |f| + (|Γ| + Σ √μ) |a_g| per time at most, for M′ ≥ I and
//! M′ ≥ μ φφᵀ.

use super::drive::{Aside, Pushed};
use super::regime::{Regime, Stuck};
use super::series::{EXACT, ModalSeries, Series, Term, scaled};
use super::state::{Modes, Place};
use super::structure::Damping;
use super::swings::Grown;
use super::{Followed, Modal, ModalState};
use crate::host::{Host, Structure as _};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::taylor::{Number, ORDER};

/// The longest motion in units of 1/Λ.
pub(super) const LONGEST: f64 = 1.0;

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// The power series of all modes from a state, up to `order`, in powers of t = h/`unit` (a power of two);
    /// so many of them to twice the precision, [`EXACT`](super::series::EXACT) at most. No pendulum swings.
    #[inline(always)]
    pub(super) fn series(
        &self,
        modes: &Modes<R, M>,
        regime: &Regime<'_, R, N>,
        (pushes, asides): (impl Fn(usize) -> Pushed<R>, &[Aside<R>]),
        unit: R,
        (order, exact): (usize, usize),
    ) -> ModalSeries<R> {
        let mut rows = self.begun(modes, unit, (order, exact));
        for m in 0..=order - 2 {
            let pushed = pushes(m);
            if m + 2 < exact {
                self.raise::<DoubleDouble<R>>(&mut rows, m, regime, (pushed, asides), unit);
            } else {
                self.raise::<R>(&mut rows, m, regime, (pushed, asides), unit);
            }
        }
        rows
    }

    /// The first two powers of the series.
    #[inline(always)]
    pub(super) fn begun(
        &self,
        modes: &Modes<R, M>,
        unit: R,
        (order, exact): (usize, usize),
    ) -> ModalSeries<R> {
        let mut rows = ModalSeries::new(self.rows(), order, exact);
        rows.set(0, |j| modes.places[j]);
        rows.set(1, |j| scaled(modes.velocities[j], unit));
        rows
    }

    /// The whole series under what feeds the modes in powers of t, not inlined: where it is computed beforehand.
    #[inline(never)]
    pub(super) fn series_fed(
        &self,
        modes: &Modes<R, M>,
        regime: &Regime<'_, R, N>,
        (fed, asides): (&[Pushed<R>], &[Aside<R>]),
        unit: R,
    ) -> ModalSeries<R> {
        self.series(modes, regime, (|m| fed[m], asides), unit, (ORDER, EXACT))
    }

    /// Computes the coefficients m + 2 from those before, with the coefficients m of f, a_g and gravity.
    #[inline(always)]
    fn raise<T: Term<R>>(
        &self,
        rows: &mut ModalSeries<R>,
        m: usize,
        Regime { stuck, pulls }: &Regime<'_, R, N>,
        pushed: (Pushed<R>, &[Aside<R>]),
        unit: R,
    ) {
        let (mut force, felt) = self.forces::<T>(rows, m, pulls, pushed, unit);
        self.carry(&mut force, stuck, felt);
        let over = T::reciprocal((m + 1) * (m + 2));
        rows.set(m + 2, |j| force[j] * over);
    }

    /// The coefficients m of all forces on the modes but those of members that are carried along, times the square of the unit of time; and those of a_g and
    /// gravity.
    #[inline(always)]
    pub(super) fn forces<T: Term<R>>(
        &self,
        rows: &ModalSeries<R>,
        m: usize,
        pulls: &[DoubleDouble<R>; N],
        (pushed, asides): (Pushed<R>, &[Aside<R>]),
        unit: R,
    ) -> ([T; M], [T; 2]) {
        let n = self.whole.count();
        let zero = T::from_real(R::ZERO);
        let square = unit * unit;
        let damped = T::from_real(unit * (m + 1) as f64);
        let (q, v) = (rows.power(m), rows.power(m + 1));
        let mut force = [zero; M];
        let stiffness = &self.whole.stiffness[..n];
        let sprung = |j: usize| T::of(scaled(stiffness[j], square)) * T::at(q, j);
        match &self.whole.damping {
            Damping::Separate(rates) => {
                let rates = &rates[..n];
                for (j, force) in force[..n].iter_mut().enumerate() {
                    *force = -(T::of(rates[j]) * T::at(v, j) * damped) - sprung(j);
                }
            }
            Damping::Full(matrix) => {
                for (j, force) in force[..n].iter_mut().enumerate() {
                    let elements = matrix[j * n..(j + 1) * n].iter().enumerate();
                    let damper = elements.fold(zero, |sum, (i, element)| {
                        T::at(v, i).fused(T::from_real(*element), sum)
                    });
                    *force = -(damper * damped) - sprung(j);
                }
            }
        }
        for (spring, shape) in &self.whole.springs {
            let both = shape.iter().enumerate();
            let stretched =
                both.fold(zero, |sum, (j, phi)| T::at(q, j).fused(T::from_real(*phi), sum));
            let pull = stretched * T::from_real(*spring * square);
            for (force, phi) in force.iter_mut().zip(shape) {
                *force = *force - pull * T::from_real(*phi);
            }
        }
        let [f, a, gravity] = pushed.map(|push| T::of(push) * T::from_real(square));
        let pulled = if m == 0 { &pulls[..] } else { &[] };
        for (k, pull) in pulled.iter().enumerate().filter(|(_, it)| it.value != 0.0) {
            let weight = gravity * T::of(pull.times(self.masses[k].mass_ratio));
            for (force, phi) in force.iter_mut().zip(self.gap_shape(k)) {
                *force = *force + weight * T::from_real(*phi);
            }
        }
        if self.host.is_driven() {
            for (force, phi) in force.iter_mut().zip(self.whole.shape(self.pushed)) {
                *force = *force + f * T::from_real(*phi);
            }
            for (force, part) in force.iter_mut().zip(self.whole.participation().unwrap_or(&[])) {
                *force = *force - a * T::from_real(*part);
            }
        }
        for (point, row) in asides {
            let aside = T::of(scaled(row[m], square));
            for (force, phi) in force.iter_mut().zip(self.whole.shape(*point)) {
                *force = *force + aside * T::from_real(*phi);
            }
        }
        (force, [a, gravity])
    }

    /// Adds to forces on the modes those of the members that are carried along, under such accelerations of the base and by gravity.
    #[inline(always)]
    pub(super) fn carry<T: Term<R>>(
        &self,
        force: &mut [T; M],
        stuck: &Stuck<R>,
        [a, gravity]: [T; 2],
    ) {
        let count = stuck.masses.len();
        if count == 0 {
            return;
        }
        let zero = T::from_real(R::ZERO);
        if let [k] = *stuck.masses {
            let shape = self.gap_shape(k);
            let begin = if self.tied[k].is_some() {
                zero
            } else if self.gravity[k] == 0.0 {
                a
            } else {
                a + gravity * T::from_real(self.gravity[k])
            };
            let felt = shape.iter().zip(&*force);
            let load = felt.fold(begin, |sum, (phi, force)| *force * T::from_real(*phi) + sum);
            let pull = T::of(stuck.inverse[0]) * load;
            for (force, phi) in force.iter_mut().zip(shape) {
                *force = *force - pull * T::from_real(*phi);
            }
            if let Some((row, a)) = self.pressed(k, pull, T::of(stuck.inverse[0])) {
                force[row] = a;
            }
            return;
        }
        let mut load = [zero; N];
        for (load, k) in load.iter_mut().zip(&stuck.masses) {
            let felt = self.gap_shape(*k).iter().zip(&*force);
            let fallen = || a + gravity * T::from_real(self.gravity[*k]);
            let moved = if self.tied[*k].is_none() { fallen() } else { zero };
            *load = felt.fold(moved, |sum, (phi, force)| *force * T::from_real(*phi) + sum);
        }
        for (i, k) in stuck.masses.iter().enumerate() {
            let row = stuck.inverse[i * count..(i + 1) * count].iter().zip(&load);
            let pull = row.fold(zero, |sum, (element, load)| T::of(*element) * *load + sum);
            for (force, phi) in force.iter_mut().zip(self.gap_shape(*k)) {
                *force = *force - pull * T::from_real(*phi);
            }
            if let Some((row, a)) = self.pressed(*k, pull, T::of(stuck.inverse[i * (count + 1)])) {
                force[row] = a;
            }
        }
    }

    /// What the curve of a member is made of, beyond a uniform motion, from the series of all modes and pendulums:
    /// ∬A from power 2 on up to `order`.
    #[inline(always)]
    pub(super) fn curved(
        &self,
        grown: &Grown<'_, R>,
        (k, place): (usize, &Place<R>),
        base: impl Fn(usize) -> DoubleDouble<R>,
        (unit, order): (R, usize),
    ) -> Series<R> {
        if let Some(curved) = grown.swung(k, order) {
            return curved;
        }
        if let Some(row) = self.pressed_row(k, place) {
            let mut sum = Series::ZERO;
            (2..=order).for_each(|m| sum.set(m, grown.rows.coefficient(row, m)));
            return sum;
        }
        let Followed { shape, factor, with_base, constant } = self.followed(k, place);
        let mut sum = Series::ZERO;
        let based = with_base && self.host.moves_base();
        for m in 2..=order {
            let mut moved = grown.rows.summed(shape, m);
            if based {
                let over = <DoubleDouble<R> as Number>::reciprocal((m - 1) * m);
                moved = moved + scaled(base(m - 2), unit * unit) * over;
            }
            if factor != 1.0 {
                moved = moved.times(factor);
            }
            if m == 2 && constant.value != 0.0 {
                moved = moved + scaled(constant, unit * unit).half();
            }
            sum.set(m, moved);
        }
        sum
    }

    /// A, as the curve of a mass is made of it, and its first three derivatives: the absolute acceleration of the structure at its
    /// point, with gravity and the spring.
    #[inline]
    pub(super) fn shaken(&self, state: &ModalState<H, N, M>, k: usize) -> [R; 4] {
        state.felt_by(k).unwrap_or_else(|| self.shaken_now(state, k))
    }

    /// The same, computed. In many places, so that one copy of it is enough.
    #[inline(never)]
    fn shaken_now(&self, state: &ModalState<H, N, M>, k: usize) -> [R; 4] {
        let place = &state.places[k];
        let exact = |[a, jerk, snap, crackle]: [R; 4]| {
            [if place.leaves { R::ZERO } else { a }, jerk, snap, crackle]
        };
        if let Some(it) = self.oscillating(state) {
            return exact(it.felt(self.pull(k, place)));
        }
        let pushes = self.pushes(&state.phase, R::ONE);
        // Of a mass in flight that does not rub A and its rate are enough.
        let order = if place.stuck || self.friction[k] != 0.0 { 5 } else { 3 };
        let regime = self.regime(&state.places);
        let asides = self.asides(&state.phase, R::ONE, order);
        let feed = (&pushes, asides.as_slice());
        let grown = self.grown(state, &regime, feed, R::ONE, (order, 3));
        let curved = self.curved(&grown, (k, place), |m| pushes(m)[1], (R::ONE, order));
        exact([(2, 2.0), (3, 6.0), (4, 24.0), (5, 120.0)].map(|(m, f)| curved.plain(m) * f))
    }

    /// −s A: the pressure on its wall per unit mass, if a mass is stuck.
    pub(super) fn pressure(&self, state: &ModalState<H, N, M>, k: usize) -> R {
        -state.places[k].side * self.shaken(state, k)[0]
    }

    /// A short time later: the modes and the drive, and all places but those that `chosen` changes.
    #[inline(never)]
    pub(super) fn move_on(
        &self,
        state: &mut ModalState<H, N, M>,
        time: R,
        chosen: &dyn Fn(usize) -> bool,
    ) {
        if time == 0.0 {
            return;
        }
        if let Some(it) = self.oscillating(state) {
            state.renew();
            Self::soon(&it, state, time);
            for (k, place) in state.places[..self.count()].iter_mut().enumerate() {
                if !chosen(k) {
                    let felt = it.state.acceleration + self.pull(k, place);
                    *place = place.moved(time, felt.value);
                }
            }
            return;
        }
        let (pushes, asides) =
            (self.pushes(&state.phase, R::ONE), self.asides(&state.phase, R::ONE, 1));
        let regime = self.regime(&state.places);
        let begin = state.places;
        let grown = self.grown(state, &regime, (&pushes, asides.as_slice()), R::ONE, (2, 0));
        let curves: [R; N] = std::array::from_fn(|k| {
            let asked = k < self.count() && !chosen(k) && !begin[k].carried();
            let curved = || self.curved(&grown, (k, &begin[k]), |m| pushes(m)[1], (R::ONE, 2));
            if asked { curved().plain(2) * 2.0 } else { R::ZERO }
        });
        let rows = grown.rows;
        state.renew();
        let Modes { places, velocities } = &mut state.modes;
        for j in 0..self.whole.count() {
            let acceleration = rows.plain(j, 2) * 2.0;
            places[j] = places[j].plus(velocities[j].value * time);
            velocities[j] = velocities[j].plus(acceleration * time);
        }
        state.phase = self.host.free().later(&state.phase, time);
        for k in (0..self.count()).filter(|k| !chosen(*k)) {
            let place = &mut state.places[k];
            *place = place.moved(time, curves[k]);
        }
    }
}
