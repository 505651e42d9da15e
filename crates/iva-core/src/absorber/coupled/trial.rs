//! A coupled mass in flight: its trials in closed form.

use super::{Coupled, CoupledState, Coupling};
use crate::absorber::plain::State;
use crate::absorber::siva::Law;
use crate::absorber::siva::trial::FreeMass;
use crate::number::real::{Real, pick};
use crate::segment::taylor::unrolled;

impl<R: Real, C: Coupling<Real = R>> Coupled<C> {
    /// The longest motion that a series is used for.
    #[inline(always)]
    pub(crate) fn reach(&self) -> R {
        R::ONE / self.growth
    }

    /// The derivatives of x and w of orders 1 to 4.
    #[inline(always)]
    fn derivatives(&self, at: &CoupledState<R>) -> [[R; 2]; 4] {
        let mut z = self.variables(at);
        let mut all = [[R::ZERO; 2]; 4];
        for derivative in &mut all {
            let [a, b] = self.coupling.rates(z);
            z = [z[1], a, z[3], b];
            *derivative = [z[0], b];
        }
        all
    }
}

impl<R: Real, C: Coupling<Real = R>> FreeMass for Coupled<C> {
    type Real = R;
    type State = CoupledState<R>;
    const STRAIGHT: f64 = 1e-3;
    const CLOSE: f64 = 1.0 / 16.0;

    #[inline(always)]
    fn curve(&self, at: &CoupledState<R>) -> [R; 3] {
        let [_, b] = self.coupling.rates(self.variables(at));
        [at.distance, at.rate, -at.side * b]
    }

    #[inline(always)]
    fn ahead(&self, from: &CoupledState<R>, h: R) -> [R; 3] {
        self.curve(&self.nearly(from, h))
    }

    #[inline(always)]
    fn in_doubles(at: &CoupledState<R>) -> State {
        let CoupledState { x, v, side, distance, rate } = *at;
        let [x, v, side, distance, rate] = [x, v, side, distance, rate].map(R::double);
        State { x, v, side, distance, rate, ..State::default() }
    }

    #[inline(always)]
    fn bounds(&self, from: &CoupledState<R>) -> [R; 2] {
        let square = self.growth * self.growth;
        let fifth = self.most(from) * (square * square);
        [fifth, fifth * self.growth]
    }

    #[inline(always)]
    fn nearly(&self, from: &CoupledState<R>, h: R) -> CoupledState<R> {
        // The terms of the power series: small ones are summed among themselves before they are added.
        let mut term = self.variables(from);
        let mut gained = [R::ZERO; 4];
        unrolled!(k < 20 => {
            let [a, b] = self.coupling.rates(term);
            let factor = h * R::reciprocal(k + 1);
            term = [term[1] * factor, a * factor, term[3] * factor, b * factor];
            gained = std::array::from_fn(#[inline(always)] |i| gained[i] + term[i]);
        });
        let [x, v, y, w] = gained;
        CoupledState {
            x: from.x + x,
            v: from.v + v,
            distance: from.distance - from.side * y,
            rate: from.rate - from.side * w,
            ..*from
        }
    }

    #[inline(always)]
    fn near(&self, at: &CoupledState<R>, beyond: R) -> [R; 5] {
        let [[_, b], [_, b1], [_, b2], _] = self.derivatives(at);
        let s = -at.side;
        [at.distance - beyond, at.rate, s * b, s * b1, s * b2]
    }

    #[inline(always)]
    fn touching(&self, at: &CoupledState<R>, hit: bool, far: bool, t: R) -> CoupledState<R> {
        let [[v, b], [a, b1], [a1, b2], [a2, _]] = self.derivatives(at);
        let raised = |[first, second, third, fourth]: [R; 4]| {
            t * (first
                + t * (second * 0.5 + t * (third * (1.0 / 6.0) + t * (fourth * (1.0 / 24.0)))))
        };
        let turn = pick(hit & far, -R::ONE, R::ONE);
        let s = -at.side;
        let distance = at.distance + raised([at.rate, s * b, s * b1, s * b2]);
        CoupledState {
            x: at.x + raised([v, a, a1, a2]),
            v: at.v + raised([a, a1, a2, R::ZERO]),
            side: turn * at.side,
            distance: pick(hit, R::ZERO, distance),
            rate: turn * (at.rate + raised([s * b, s * b1, s * b2, R::ZERO])),
        }
    }

    #[inline(always)]
    fn struck(&self, touching: &CoupledState<R>, hit: bool, law: &Law<R>) -> CoupledState<R> {
        let CoupledState { v, side, rate, .. } = *touching;
        let approach = pick(hit, rate, R::ZERO);
        let gained = law.share.value * (-side * approach);
        CoupledState {
            v: v + gained,
            rate: pick(hit, -law.restitution * approach, rate),
            ..*touching
        }
    }
}
