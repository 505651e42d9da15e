//! The power series of modes and of the pendulums that swing on them.
//!
//! Each order of the pull of a pendulum is linear in that of the acceleration of its point (`segment/taylor/pivoted.rs`). So an order of all modes follows from one small
//! system of equations, as if parts of the pendulums were stuck to their points.

use super::drive::{Aside, Pushed};
use super::equations::{Regime, Stuck};
use super::series::{ModalSeries, Series, Term};
use super::{Modal, ModalState};
use crate::host::Host;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::taylor::{Growing, ORDER};

/// Number of coefficients of the gap of a pendulum that are to twice the precision.
pub(super) const FIRST: usize = 3;

/// The power series of a motion.
#[derive(Debug, Clone)]
pub(super) struct Grown<'a, R> {
    /// q of all modes.
    pub rows: ModalSeries<R>,
    /// Those of the pendulums in flight.
    pub swings: Vec<Swing<'a, R>>,
}

/// The power series of a pendulum in flight.
#[derive(Debug, Clone)]
pub(super) struct Swing<'a, R> {
    /// Which of the members it is.
    pub index: usize,
    pub series: Growing<'a, R, R, { ORDER + 1 }>,
    /// The first coefficients of y.
    first: [DoubleDouble<R>; FIRST],
}

impl<R: Real> Swing<'_, R> {
    /// −y from power 2 on up to `order`.
    #[inline(always)]
    pub(super) fn curved(&self, order: usize) -> Series<R> {
        let mut curved = Series::ZERO;
        for m in 2..=order {
            let y = match self.first.get(m) {
                Some(y) => *y,
                None => DoubleDouble::new(self.series.y[m]),
            };
            curved.set(m, -y);
        }
        curved
    }
}

/// What the orders of all series are made of.
pub(super) struct Feed<'f, 'r, R, const N: usize> {
    pub regime: &'f Regime<'r, R, N>,
    pub fixed: &'f Stuck<R>,
    pub asides: &'f [Aside<R>],
    pub unit: R,
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// The power series from a state, as [`Modal::series`], with those of pendulums that swing.
    #[inline(always)]
    pub(super) fn grown<'a>(
        &'a self,
        state: &ModalState<H, N, M>,
        regime: &Regime<'_, R, N>,
        (pushes, asides): (impl Fn(usize) -> Pushed<R>, &[Aside<R>]),
        unit: R,
        orders: (usize, usize),
    ) -> Grown<'a, R> {
        if !self.swings() {
            let rows = self.series(&state.modes, regime, (pushes, asides), unit, orders);
            return Grown { rows, swings: vec![] };
        }
        self.swung(state, regime, (&pushes, asides), unit, orders)
    }

    #[inline(never)]
    fn swung<'a>(
        &'a self,
        state: &ModalState<H, N, M>,
        regime: &Regime<'_, R, N>,
        (pushes, asides): (&dyn Fn(usize) -> Pushed<R>, &[Aside<R>]),
        unit: R,
        (order, exact): (usize, usize),
    ) -> Grown<'a, R> {
        let fixed = self.fixed_at(&state.places);
        let feed = Feed { regime, fixed: &fixed, asides, unit };
        let precise = if exact < FIRST { 0 } else { 1 };
        let mut rows = self.begun(&state.modes, unit, (order, FIRST * precise));
        let mut begin: Vec<(usize, Growing<'a, R, DoubleDouble<R>, FIRST>)> =
            self.swinging_from(&state.places);
        for m in 0..precise {
            self.rise::<DoubleDouble<R>, FIRST>(&mut rows, &mut begin, m, pushes(m), &feed);
        }
        let over = DoubleDouble::new(unit);
        let firsts = begin.iter().map(|(_, it)| {
            let last = if precise > 0 { it.ahead(1, over) } else { DoubleDouble::ZERO };
            [it.y[0], it.y[1], last]
        });
        let firsts: Vec<_> = firsts.collect();
        let mut growing: Vec<(usize, Growing<'a, R, R, { ORDER + 1 }>)> =
            begin.into_iter().map(|(k, it)| (k, it.map(|number| number.value))).collect();
        for m in precise..=order - 2 {
            self.rise::<R, { ORDER + 1 }>(&mut rows, &mut growing, m, pushes(m), &feed);
        }
        // One more order of y asks for no acceleration; the bound on what is left out knows none.
        for (_, it) in growing.iter_mut().filter(|_| order < ORDER) {
            it.y[order] = it.ahead(order - 1, unit);
        }
        let swings = growing.into_iter().zip(firsts).map(|((index, series), mut first)| {
            if precise == 0 {
                first = [0, 1, 2].map(|m| DoubleDouble::new(series.y[m]));
            }
            Swing { index, series, first }
        });
        Grown { rows, swings: swings.collect() }
    }

    /// All pendulums that swing at the begin of their series.
    pub(super) fn swinging_from<'a, const LENGTH: usize>(
        &'a self,
        places: &[super::Place<R>; N],
    ) -> Vec<(usize, Growing<'a, R, DoubleDouble<R>, LENGTH>)> {
        let flying = (0..self.count()).filter(|k| !places[*k].carried());
        let hanging = flying.filter_map(|k| {
            let is = self.hanging(k)?;
            Some((k, Growing::new(is, self.posture(k, is, &places[k]))))
        });
        hanging.collect()
    }

    /// The coefficients m + 2 of all modes and m + 1 of all pendulums, from those before.
    #[inline(always)]
    pub(super) fn rise<T: Term<R>, const LENGTH: usize>(
        &self,
        rows: &mut ModalSeries<R>,
        growing: &mut [(usize, Growing<'_, R, T, LENGTH>)],
        m: usize,
        pushed: Pushed<R>,
        Feed { regime, fixed, asides, unit }: &Feed<'_, '_, R, N>,
    ) {
        let n = T::from_real;
        let (h, square) = (n(*unit), n(*unit * *unit));
        let over = n(R::ONE / *unit);
        let (mut force, felt) = self.forces::<T>(rows, m, &regime.pulls, (pushed, asides), *unit);
        for (k, it) in growing.iter_mut() {
            let pull = it.prepare(m, (h, over)) * square;
            for (force, phi) in force.iter_mut().zip(self.shape(*k)) {
                *force = *force - pull * n(*phi);
            }
        }
        self.carry(&mut force, fixed, felt);
        let each = T::reciprocal((m + 1) * (m + 2));
        rows.set(m + 2, |j| force[j] * each);
        let over_square = over * over;
        for (k, it) in growing.iter_mut() {
            let felt = self.shape(*k).iter().zip(&force);
            let moved = felt.fold(n(R::ZERO), |sum, (phi, force)| *force * n(*phi) + sum);
            it.raise(m, moved.fused(over_square, T::of(pushed[1])), h);
        }
    }
}
