//! The power series of modes and of the pendulums that swing on them.
//!
//! Each order of the pull of a pendulum is linear in that of the acceleration of its point (`segment/taylor/pivoted.rs`). So an order of all modes follows from one small
//! system of equations, as if parts of the pendulums were stuck to their points.

use super::drive::{Aside, Pushed};
use super::regime::{Regime, Stuck};
use super::series::{ModalSeries, Series, Term};
use super::{Modal, ModalState};
use crate::host::Host;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::taylor::{Growing, ROOM};

/// Number of coefficients of the gap of a pendulum that are to twice the precision.
pub(super) const FIRST: usize = 3;
/// The length of their rows.
const SHORT: usize = 4;

/// The power series of a motion.
#[derive(Debug, Clone)]
pub(super) struct Grown<'a, R> {
    /// q of all modes.
    pub rows: ModalSeries<R>,
    /// Those of the pendulums in flight.
    pub swings: Vec<Swing<'a, R, R, ROOM>>,
    /// Of each y₂ to twice the precision, and the highest coefficient of y, which asks for no acceleration.
    gaps: Vec<(DoubleDouble<R>, R)>,
}

/// The power series of a pendulum in flight.
#[derive(Debug, Clone)]
pub(super) struct Swing<'a, R, T, const LENGTH: usize> {
    /// Which of the members it is.
    pub index: usize,
    /// φ of its point.
    pub shape: &'a [R],
    pub series: Growing<'a, R, T, LENGTH>,
}

impl<R: Real> Grown<'_, R> {
    /// −y of a pendulum in flight from power 2 on up to `order`; `None` of any other member.
    #[inline(always)]
    pub(super) fn swung(&self, k: usize, order: usize) -> Option<Series<R>> {
        let at = self.swings.iter().position(|swing| swing.index == k)?;
        let (mut curved, (second, last)) = (Series::ZERO, self.gaps[at]);
        for m in FIRST..order {
            curved.set(m, DoubleDouble::new(-self.swings[at].series.y[m]));
        }
        // Without it the gap velocity would end an order before W does.
        curved.set(order, DoubleDouble::new(-last));
        curved.set(2, -second);
        Some(curved)
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
            return Grown { rows, swings: vec![], gaps: vec![] };
        }
        self.grown_swinging(state, regime, (&pushes, asides), unit, orders)
    }

    #[inline(never)]
    fn grown_swinging<'a>(
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
        let mut begun: Vec<Swing<'a, R, DoubleDouble<R>, SHORT>> =
            self.swinging_from(&state.places);
        if precise > 0 {
            self.rise(&mut rows, &mut begun, 0, pushes(0), &feed);
        }
        let going_on =
            |Swing { index, shape, series }: &Swing<'a, R, DoubleDouble<R>, SHORT>| Swing {
                index: *index,
                shape,
                series: Growing::from_first(series, precise, |number| number.value),
            };
        let mut swings: Vec<Swing<'a, R, R, ROOM>> = begun.iter().map(going_on).collect();
        for m in precise..=order - 2 {
            self.rise(&mut rows, &mut swings, m, pushes(m), &feed);
        }
        let gap = |(first, swing): (&Swing<'a, R, _, SHORT>, &Swing<'a, R, R, ROOM>)| {
            let series = &swing.series;
            let second = match precise {
                0 => DoubleDouble::new(if order > 2 { series.y[2] } else { R::ZERO }),
                _ => first.series.ahead(1, DoubleDouble::new(unit)),
            };
            let last = series.ahead(order - 1, unit);
            (if order == 2 && precise == 0 { DoubleDouble::new(last) } else { second }, last)
        };
        let gaps = begun.iter().zip(&swings).map(gap).collect();
        Grown { rows, swings, gaps }
    }

    /// All pendulums that swing at the begin of their series.
    pub(super) fn swinging_from<'a, const LENGTH: usize>(
        &'a self,
        places: &[super::Place<R>; N],
    ) -> Vec<Swing<'a, R, DoubleDouble<R>, LENGTH>> {
        let flying = (0..self.count()).filter(|k| !places[*k].carried());
        let hanging = flying.filter_map(|index| {
            let is = self.hanging(index)?;
            let place = &places[index];
            let rubbed = self.rubbing(index, place);
            let series = Growing::new(is, self.posture(index, is, place), rubbed);
            Some(Swing { index, shape: self.shape(index), series })
        });
        hanging.collect()
    }

    /// The coefficients m + 2 of all modes and m + 1 of all pendulums, from those before.
    #[inline(always)]
    pub(super) fn rise<T: Term<R>, const LENGTH: usize>(
        &self,
        rows: &mut ModalSeries<R>,
        swings: &mut [Swing<'_, R, T, LENGTH>],
        m: usize,
        pushed: Pushed<R>,
        Feed { regime, fixed, asides, unit }: &Feed<'_, '_, R, N>,
    ) {
        let n = T::from_real;
        let (h, square) = (n(*unit), n(*unit * *unit));
        let over = n(R::ONE / *unit);
        let (mut force, felt) = self.forces::<T>(rows, m, &regime.pulls, (pushed, asides), *unit);
        for Swing { shape, series, .. } in swings.iter_mut() {
            let pull = series.prepare(m, (h, over)) * square;
            for (force, phi) in force.iter_mut().zip(*shape) {
                *force = *force - pull * n(*phi);
            }
        }
        self.carry(&mut force, fixed, felt);
        let each = T::reciprocal((m + 1) * (m + 2));
        rows.set(m + 2, |j| force[j] * each);
        let over_square = over * over;
        for Swing { shape, series, .. } in swings.iter_mut() {
            let felt = shape.iter().zip(&force);
            let moved = felt.fold(n(R::ZERO), |sum, (phi, force)| *force * n(*phi) + sum);
            series.raise(m, moved.fused(over_square, T::of(pushed[1])), h);
        }
    }
}
