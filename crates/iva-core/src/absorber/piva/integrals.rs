//! Integrals along a motion of a structure with a pendulum: energy lost in its dampers, work of its force,
//! and ∫x².
//!
//! A motion is a share t of a step, and rows are in powers of time over the step. The order of a row is known
//! to the compiler, so that many motions can go side by side.

use crate::force::Drive;
use crate::number::real::Real;
use crate::segment::flight::Losses;
use crate::segment::quadrature::{mean_product, nodes, rates, values};
use crate::segment::taylor::{Pendulum, Row};

/// Number of nodes of the integrals over a step.
const NODES: usize = 8;

/// The power series that losses and work are integrals of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Integrands<'a, R> {
    /// Series of ẋ.
    pub u: &'a Row<R>,
    /// Series of the gap displacement y.
    pub y: &'a Row<R>,
    /// Series of W.
    pub w: &'a Row<R>,
    /// Series of f/M and a_g; `None` in free motion.
    pub drive: Option<&'a Drive<R>>,
    /// True if the pivot is damped.
    pub pivots: bool,
    /// True if the base moves.
    pub base: bool,
}

impl<R: Real> Integrands<'_, R> {
    /// Energy lost and work over a share t of a step: ∫ 2ζ ẋ² dt, the loss in the pivot, and ∫ (f/M) ẋ − a_g
    /// ((1 + μ) ẋ + μλ ẏ) dt, where a_g is multiplied by the momentum of all masses along x.
    #[inline(always)]
    pub fn taken<const N: usize>(&self, pendulum: &Pendulum<R>, t: R, step: R) -> Losses<R> {
        let Pendulum { mass_ratio, damping_ratio, lever, inertia_ratio, pivot_damping, .. } =
            *pendulum;
        let (at, h) = (nodes::<R, NODES>([R::ZERO, t]), t * step);
        let u = values::<N, _, _, _>(self.u, &at);
        let viscous = damping_ratio * 2.0 * mean_product(&u, &u) * h;
        let mut pivot = R::ZERO;
        if self.pivots {
            let w = values::<N, _, _, _>(self.w, &at);
            let factor = mass_ratio * inertia_ratio * (lever * lever) * pivot_damping;
            pivot = factor * mean_product(&w, &w) * h;
        }
        let Some(drive) = self.drive else { return Losses { viscous, pivot, work: R::ZERO } };
        let mut work = mean_product(&values::<N, _, _, _>(&drive.primary, &at), &u);
        if self.base {
            let rate = rates::<N, _, _, _>(self.y, &at);
            let (mass, pull) = (R::ONE + mass_ratio, mass_ratio * lever / step);
            let mut momentum = [R::ZERO; NODES];
            for (n, momentum) in momentum.iter_mut().enumerate() {
                *momentum = mass * u[n] + pull * rate[n];
            }
            work -= mean_product(&values::<N, _, _, _>(&drive.base, &at), &momentum);
        }
        Losses { viscous, pivot, work: work * h }
    }
}

/// ∫ f² dt between two shares of a step.
#[inline(always)]
pub(crate) fn square<R: Real, const N: usize>(row: &Row<R>, [from, to]: [R; 2], step: R) -> R {
    let f = values::<N, _, _, _>(row, &nodes::<R, NODES>([from, to]));
    mean_product(&f, &f) * ((to - from) * step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::segment::taylor::ORDER;

    #[test]
    fn the_integral_of_a_square_is_exact() {
        // cos(t − ½) in powers of t.
        let (sine, cosine) = (-0.5_f64).sin_cos();
        let mut term = 1.0;
        let mut row = [0.0; ORDER + 1];
        for (k, coefficient) in row.iter_mut().enumerate() {
            *coefficient = term * [cosine, -sine, -cosine, sine][k % 4];
            term /= (k + 1) as f64;
        }
        // ∫₀¹ cos²(t − 1/2) dt = 1/2 + (sin 1 + sin 1)/4
        let truth = 0.5 + 0.5 * 1f64.sin();
        let whole = square::<_, ORDER>(&row, [0.0, 1.0], 1.0);
        assert!((whole - truth).abs() < 1e-15, "{whole} {truth}");
        let [a, b] = [[0.0, 0.3], [0.3, 1.0]].map(|ends| square::<_, ORDER>(&row, ends, 1.0));
        assert!((a + b - truth).abs() < 1e-15);
    }
}
