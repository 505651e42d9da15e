//! Integrals along motions of a structure with a pendulum: what its dampers take, what its force gives, and ∫x².
//!
//! By the quadrature of [`crate::host`], for one motion or for several side by side. A motion is a share t of a step, and
//! rows are in powers of time over the step.

use crate::flight::Losses;
use crate::force::Drive;
use crate::host::driven::integral::{COUNT, node, sum_of, weight};
use crate::real::Real;
use crate::taylor::ORDER;

/// A row of each of W motions.
pub(crate) type Rows<R, const W: usize> = [[R; W]; ORDER + 1];

/// What several motions come to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Taken<R, const W: usize> {
    pub viscous: [R; W],
    pub pivot: [R; W],
    pub work: [R; W],
}

impl<R: Real> Taken<R, 1> {
    /// What one motion comes to.
    pub fn one(&self) -> Losses<R> {
        let Self { viscous: [viscous], pivot: [pivot], work: [work] } = *self;
        Losses { viscous, pivot, work }
    }
}

/// What losses depend on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Factors<R, const W: usize> {
    /// 2ζ
    pub damping: [R; W],
    /// m κ L² ν over M b².
    pub pivot: [R; W],
    /// 1 + μ
    pub mass: [R; W],
    /// μλ
    pub pull: [R; W],
}

/// The rows that losses and work are integrals of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Integrands<'a, R, const W: usize> {
    /// Of ẋ, y and W.
    pub u: &'a Rows<R, W>,
    pub y: &'a Rows<R, W>,
    pub w: &'a Rows<R, W>,
    /// Of f/M and a_g; `None` in free motion.
    pub drive: Option<[&'a Rows<R, W>; 2]>,
    /// True if pivots are damped.
    pub pivots: bool,
    /// True if the base moves.
    pub base: bool,
}

impl<R: Real, const W: usize> Integrands<'_, R, W> {
    /// Losses and work over the shares t of steps: ∫ 2ζ ẋ² dt, that of the pivot, and
    /// ∫ (f/M) ẋ − a_g ((1 + μ) ẋ + μλ ẏ) dt, the momentum of all masses along x behind a_g.
    #[inline(always)]
    pub fn taken<const N: usize>(
        &self,
        factors: &Factors<R, W>,
        t: [R; W],
        step: [R; W],
    ) -> Taken<R, W> {
        let nothing = [[R::ZERO; W]; COUNT];
        let (mut squares, mut swings, mut works, mut carried) =
            (nothing, nothing, nothing, nothing);
        for n in 0..COUNT {
            let mut at = [R::ZERO; W];
            for i in 0..W {
                at[i] = node(n, [R::ZERO, t[i]]);
            }
            let u = polynomials::<R, W, N>(self.u, &at);
            for i in 0..W {
                squares[n][i] = weight::<R>(n) * (u[i] * u[i]);
            }
            if self.pivots {
                let w = polynomials::<R, W, N>(self.w, &at);
                for i in 0..W {
                    swings[n][i] = weight::<R>(n) * (w[i] * w[i]);
                }
            }
            let Some([force, base]) = self.drive else { continue };
            let f = polynomials::<R, W, N>(force, &at);
            for i in 0..W {
                works[n][i] = weight::<R>(n) * (f[i] * u[i]);
            }
            if self.base {
                let g = polynomials::<R, W, N>(base, &at);
                let rate = rates::<R, W, N>(self.y, &at);
                for i in 0..W {
                    let momentum = factors.mass[i] * u[i] + factors.pull[i] * (rate[i] / step[i]);
                    carried[n][i] = weight::<R>(n) * (g[i] * momentum);
                }
            }
        }
        let (squares, swings) = (sums(&squares), sums(&swings));
        let (works, carried) = (sums(&works), sums(&carried));
        let mut taken = Taken { viscous: [R::ZERO; W], pivot: [R::ZERO; W], work: [R::ZERO; W] };
        for i in 0..W {
            let h = t[i] * step[i];
            taken.viscous[i] = factors.damping[i] * squares[i] * h;
            taken.pivot[i] = factors.pivot[i] * swings[i] * h;
            taken.work[i] = (works[i] - carried[i]) * h;
        }
        taken
    }
}

/// ∫ f² between two shares of steps.
#[inline(always)]
pub(crate) fn square<R: Real, const W: usize, const N: usize>(
    row: &Rows<R, W>,
    from: [R; W],
    to: [R; W],
    step: [R; W],
) -> [R; W] {
    let mut squares = [[R::ZERO; W]; COUNT];
    for (n, squares) in squares.iter_mut().enumerate() {
        let mut at = [R::ZERO; W];
        for i in 0..W {
            at[i] = node(n, [from[i], to[i]]);
        }
        let f = polynomials::<R, W, N>(row, &at);
        for i in 0..W {
            squares[i] = weight::<R>(n) * (f[i] * f[i]);
        }
    }
    let mut square = sums(&squares);
    for i in 0..W {
        square[i] *= (to[i] - from[i]) * step[i];
    }
    square
}

/// One row as those of one motion.
#[inline(always)]
pub(crate) fn alone<R: Real>(row: &[R; ORDER + 1]) -> Rows<R, 1> {
    row.map(|coefficient| [coefficient])
}

/// The drive of one motion.
#[inline(always)]
pub(crate) fn drive_alone<R: Real>(drive: &Drive<R>) -> [Rows<R, 1>; 2] {
    [alone(&drive.primary), alone(&drive.base)]
}

/// Polynomials up to the order N.
#[inline(always)]
fn polynomials<R: Real, const W: usize, const N: usize>(row: &Rows<R, W>, t: &[R; W]) -> [R; W] {
    let mut values = [R::ZERO; W];
    for k in 0..=N {
        for i in 0..W {
            values[i] = values[i].mul_add(t[i], row[N - k][i]);
        }
    }
    values
}

/// Their derivatives by t.
#[inline(always)]
fn rates<R: Real, const W: usize, const N: usize>(row: &Rows<R, W>, t: &[R; W]) -> [R; W] {
    let mut values = [R::ZERO; W];
    for k in 0..N {
        for i in 0..W {
            values[i] = values[i].mul_add(t[i], row[N - k][i] * ((N - k) as f64));
        }
    }
    values
}

/// The sums over all nodes.
#[inline(always)]
fn sums<R: Real, const W: usize>(terms: &[[R; W]; COUNT]) -> [R; W] {
    let mut sums = [R::ZERO; W];
    for i in 0..W {
        let mut of_one = [R::ZERO; COUNT];
        for n in 0..COUNT {
            of_one[n] = terms[n][i];
        }
        sums[i] = sum_of(&of_one);
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    /// cos(t − ½) in powers of t.
    fn cosine() -> Rows<f64, 1> {
        let mut term = 1.0;
        let mut row = [[0.0]; ORDER + 1];
        for (k, coefficient) in row.iter_mut().enumerate() {
            let (sine, cosine) = (-0.5_f64).sin_cos();
            *coefficient = [term * [cosine, -sine, -cosine, sine][k % 4]];
            term /= (k + 1) as f64;
        }
        row
    }

    #[test]
    fn the_integral_of_a_square_is_exact() {
        // ∫₀¹ cos²(t − 1/2) dt = 1/2 + (sin 1 + sin 1)/4
        let truth = 0.5 + 0.5 * 1f64.sin();
        let [found] = square::<f64, 1, ORDER>(&cosine(), [0.0], [1.0], [1.0]);
        assert!((found - truth).abs() < 1e-15, "{found} {truth}");
        let parts = [[0.0, 0.3], [0.3, 1.0]];
        let [a, b] =
            parts.map(|[from, to]| square::<f64, 1, ORDER>(&cosine(), [from], [to], [1.0])[0]);
        assert!((a + b - truth).abs() < 1e-15);
    }
}
