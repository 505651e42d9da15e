//! Integrals over the pieces of a record: ∫x², ∫ẋ² and the work ∫q ẋ, q = f/M or −a_g.
//!
//! Within a piece x = r · z, where z = (x, ẋ, q, q̇) holds at its begin and r the responses of the structure. So
//! ∫x² = zᵀ W z with a matrix W = ∫ r rᵀ that depends on the length of the piece only; it is integrated by Gaussian
//! quadrature ([`crate::segment::quadrature`]). As z is linear in (1, x₀, v₀) of the first point of a block, the sum
//! over its pieces is a quadratic form of them, which is kept for each point.

use std::array::from_fn;

use super::{ALIKE, At, Pieces};
use crate::force::Acts;
use crate::host::driven::NODES;
use crate::host::oscillator::{Oscillator, Primary};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::quadrature::{node, weight};

/// ∫x², ∫ẋ² and ∫q ẋ over a part of a motion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sums<R = f64> {
    /// ∫x².
    pub place: R,
    /// ∫ẋ².
    pub speed: R,
    /// ∫q ẋ.
    pub work: R,
}

/// The integrals from the first point of a block to one of its points, as forms of x₀ and v₀ there: coefficients of
/// 1, x₀, v₀, x₀², x₀v₀, v₀².
#[derive(Debug, Clone, Copy)]
pub(crate) struct Forms<R = f64> {
    place: [R; 6],
    speed: [R; 6],
    work: [R; 3],
}

/// The pairs of 1, x₀, v₀ whose products the coefficients belong to.
const PAIRS: [[usize; 2]; 6] = [[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]];

/// The matrices of one piece of length h.
#[derive(Debug, Clone, Copy)]
struct Weights<R> {
    h: R,
    /// ∫ r rᵀ and ∫ ṙ ṙᵀ.
    place: [[R; 4]; 4],
    speed: [[R; 4]; 4],
    /// ∫ ṙ and ∫ t ṙ.
    work: [[R; 4]; 2],
}

impl<R: Real> Weights<R> {
    /// The matrices of a piece, from those of one that is nearly as long if there are such.
    fn over(oscillator: &Oscillator<R>, h: R, like: Option<&Self>) -> Self {
        let alike = |like: &&Self| (h - like.h).abs() <= h * ALIKE;
        if let Some(like) = like.filter(alike) {
            let mut longer = *like;
            longer.add(oscillator, like.h, h - like.h);
            return Self { h, ..longer };
        }
        let mut weights =
            Self { h, place: [[R::ZERO; 4]; 4], speed: [[R::ZERO; 4]; 4], work: [[R::ZERO; 4]; 2] };
        for n in 0..NODES {
            weights.add(oscillator, node::<R, NODES>(n, [R::ZERO, h]), weight::<R, NODES>(n) * h);
        }
        weights
    }

    /// Adds the integrands at an instant, times a share of the piece.
    fn add(&mut self, oscillator: &Oscillator<R>, at: R, share: R) {
        let [p, s, _] = oscillator.ahead(R::ZERO, R::ONE, at);
        let [q, ..] = oscillator.ahead(R::ONE, R::ZERO, at);
        let c = R::ONE - p;
        let place = [c, s, p, -q];
        let speed = [-s, c - s * oscillator.equation.damping, s, p];
        for i in 0..4 {
            for k in 0..4 {
                self.place[i][k] = (place[i] * share).mul_add(place[k], self.place[i][k]);
                self.speed[i][k] = (speed[i] * share).mul_add(speed[k], self.speed[i][k]);
            }
            self.work[0][i] = speed[i].mul_add(share, self.work[0][i]);
            self.work[1][i] = speed[i].mul_add(share * at, self.work[1][i]);
        }
    }

    /// The forms at the end of a piece, from those at its begin.
    fn next(&self, mut forms: Forms<R>, at: &At<R>, [value, slope]: [R; 2]) -> Forms<R> {
        // z for each of 1, x₀, v₀.
        let z = [
            [at.forced.x.value, at.forced.v.value, value, slope],
            [at.c.value, -at.s.value, R::ZERO, R::ZERO],
            [at.s.value, at.slope.value, R::ZERO, R::ZERO],
        ];
        for (form, matrix) in [(&mut forms.place, &self.place), (&mut forms.speed, &self.speed)] {
            let image = z.map(|z| matrix.map(|row| dot(&row, &z)));
            for (coefficient, [i, k]) in form.iter_mut().zip(PAIRS) {
                let product = dot(&image[i], &z[k]);
                *coefficient += if i == k { product } else { product * 2.0 };
            }
        }
        let push: [R; 4] = from_fn(|i| value * self.work[0][i] + slope * self.work[1][i]);
        for (coefficient, z) in forms.work.iter_mut().zip(&z) {
            *coefficient += dot(&push, z);
        }
        forms
    }
}

#[inline(always)]
fn dot<R: Real>(a: &[R; 4], b: &[R; 4]) -> R {
    (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])
}

impl<R: Real> Forms<R> {
    const NOTHING: Self = Self { place: [R::ZERO; 6], speed: [R::ZERO; 6], work: [R::ZERO; 3] };

    /// The integrals between two points of a block, from the state at its first point.
    #[inline(always)]
    pub(crate) fn between([from, to]: [&Self; 2], start: &Primary<R>) -> Sums<R> {
        let (x, v) = (start.x.value, start.v.value);
        let products = [R::ONE, x, v, x * x, x * v, v * v];
        let sum = |from: &[R], to: &[R]| {
            let terms = products.iter().zip(to.iter().zip(from));
            terms.fold(R::ZERO, |sum, (product, (to, from))| (*to - *from).mul_add(*product, sum))
        };
        Sums {
            place: sum(&from.place, &to.place),
            speed: sum(&from.speed, &to.speed),
            work: sum(&from.work, &to.work),
        }
    }
}

impl<R: Real> Pieces<R> {
    /// The integrals from the first point of a block to each of its points.
    pub(super) fn integrated(&self, index: usize, points: &[At<R>]) -> Vec<Forms<R>> {
        let first = self.begins[index];
        let sign = match self.record.acts {
            Acts::Primary => R::ONE,
            Acts::Base => -R::ONE,
        };
        let mut all = vec![Forms::NOTHING];
        let mut weights: Option<Weights<R>> = None;
        for (k, ends) in points.windows(2).enumerate() {
            let length: DoubleDouble<R> = ends[1].time - ends[0].time;
            let by = Weights::over(&self.oscillator, length.value, weights.as_ref());
            weights = weights.or(Some(by));
            let [value, next] = [k, k + 1].map(|k| self.record.value(first + k));
            let load = [value.value, ((next - value) / length).value].map(|it| it * sign);
            all.push(by.next(all[k], &ends[0], load));
        }
        all
    }
}
