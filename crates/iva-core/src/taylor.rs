//! The flight of a pendulum absorber as a Taylor series in time.
//!
//! With y = b sinθ the gap displacement, W = b θ̇, c = cosθ and a = ẍ + a_g (a_g the acceleration of the base,
//! see [`crate::force`]) the motion is polynomial:
//!
//! ```text
//! ẏ = c W        ċ = −y W/b²        Ẇ = −(β a c + r² y + ν W)
//! ẋ = u          u̇ = a − a_g        (1 + μ) a + μλ ÿ = f/M − x − 2ζ u
//! ```
//!
//! with β = b/(κL), λ = L/b, r² = g/(κL), ν = 2ζp r (physics: Lagrange's equations of the paper's
//! Eqs. 4 and 5, with their misprints mended, for a compound bob). The last equation is momentum: with
//! ÿ = (c W)˙ it is linear in the newest coefficient of a, so that each order costs three
//! convolutions and no division.
//!
//! Coefficients are those of powers of t/h: the step ends at 1. [`Remainder`] bounds what the
//! truncation leaves out.

use crate::compensated::Sum;
use crate::force::Drive;
use crate::real::{self, ONE, Real, ZERO, dispatched};

pub use remainder::Remainder;

mod remainder;

/// Highest order of the series.
pub const ORDER: usize = 20;

/// Coefficients of one variable.
pub type Row<T> = [T; ORDER + 1];

/// Numbers that a series can be computed in: doubles, or doubles with their rounding rests where a
/// grazing is to be decided.
pub trait Number:
    Copy
    + std::ops::Add<Output = Self>
    + std::ops::Sub<Output = Self>
    + std::ops::Mul<Output = Self>
    + std::ops::Div<Output = Self>
    + std::ops::Neg<Output = Self>
{
    /// The number without rest.
    fn from_real(value: Real) -> Self;
    /// 1/n.
    fn reciprocal(n: usize) -> Self;
    /// self · factor + addend.
    #[inline(always)]
    fn fused(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }
}

impl Number for Real {
    fn from_real(value: Real) -> Self {
        value
    }
    fn reciprocal(n: usize) -> Self {
        real::reciprocal(n)
    }
    #[inline(always)]
    fn fused(self, factor: Self, addend: Self) -> Self {
        self.mul_add(factor, addend)
    }
}

impl Number for Sum {
    fn from_real(value: Real) -> Self {
        Sum::new(value)
    }
    fn reciprocal(n: usize) -> Self {
        Sum::new(ONE).over(n as f64)
    }
}

/// The constants of the equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pendulum {
    /// Mass ratio μ.
    pub mass_ratio: Real,
    /// Damping ratio ζ of the primary.
    pub damping_ratio: Real,
    /// b, from the pivot to the point of contact.
    pub contact_distance: Real,
    /// κ = I/(m L²).
    pub inertia_ratio: Real,
    /// λ = L/b.
    pub lever: Real,
    /// β = b/(κL).
    pub coupling: Real,
    /// r² = g/(κL), in ωn².
    pub frequency_squared: Real,
    /// ν = 2ζp r.
    pub pivot_damping: Real,
    /// sinθ = θ and cosθ = 1: then c stays 1 and the equations are linear.
    pub small_angles: bool,
}

/// A state between events: x, u, y, W and c.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing<T> {
    /// Displacement of the primary.
    pub x: T,
    /// Its velocity.
    pub u: T,
    /// Gap displacement y = b sinθ.
    pub y: T,
    /// W = b θ̇.
    pub w: T,
    /// cosθ.
    pub c: T,
}

/// The series of a step of length h; entry k belongs to (t/h)ᵏ.
#[derive(Debug, Clone, Copy)]
pub struct Series<T, const LENGTH: usize = { ORDER + 1 }> {
    /// Displacement of the primary.
    pub x: [T; LENGTH],
    /// Its velocity.
    pub u: [T; LENGTH],
    /// Its absolute acceleration A = ẍ + a_g, one order less.
    pub a: [T; LENGTH],
    /// Gap displacement.
    pub y: [T; LENGTH],
    /// W = b θ̇.
    pub w: [T; LENGTH],
    /// cosθ.
    pub c: [T; LENGTH],
}

/// The sums of order k over coefficients that are known before it: Σ y_i W_{k−i}, Σ c_{i+1} W_{k−i} and
/// Σ c_{i+1} a_{k−1−i} over 0 ≤ i < k. Together, and even and odd terms apart, so that no addition
/// waits for the one before.
#[inline(always)]
fn convolutions<T: Number>(y: &[T], w: &[T], c: &[T], a: &[T], k: usize) -> [T; 3] {
    let (y, w, c, a) = (&y[..k], &w[1..=k], &c[1..=k], &a[..k]);
    let with = |sums: [T; 3], i: usize| {
        let (w, a) = (w[k - 1 - i], a[k - 1 - i]);
        [y[i].fused(w, sums[0]), c[i].fused(w, sums[1]), c[i].fused(a, sums[2])]
    };
    let mut even = [T::from_real(ZERO); 3];
    let mut odd = even;
    let mut i = 0;
    while i + 1 < k {
        even = with(even, i);
        odd = with(odd, i + 1);
        i += 2;
    }
    if i < k {
        even = with(even, i);
    }
    [even[0] + odd[0], even[1] + odd[1], even[2] + odd[2]]
}

impl Pendulum {
    /// cosθ at a gap displacement, of a pendulum that hangs below its pivot.
    pub fn cosine(&self, y: Real) -> Real {
        if self.small_angles {
            return ONE;
        }
        let sine = y / self.contact_distance;
        ((1.0 - sine) * (1.0 + sine)).max(0.0).sqrt()
    }

    /// 1 + μ − (μ/κ) cos²θ, what a force on the primary moves: written as 1 + (μ/κ)(κ − 1 + sin²θ), in
    /// which nothing cancels however heavy the pendulum is.
    pub fn inertia<T: Number>(&self, y: T) -> T {
        let n = T::from_real;
        let sine = if self.small_angles { n(ZERO) } else { y / n(self.contact_distance) };
        let share = n(self.mass_ratio) * n(self.lever) * n(self.coupling);
        n(ONE) + share * (n(self.inertia_ratio - 1.0) + sine * sine)
    }

    /// The series from a state under a drive, for a step of length h, up to `order` of x, u, y, W and c.
    pub fn series<T: Number, const LENGTH: usize>(
        &self,
        start: &Swing<T>,
        drive: Option<&Drive<T, LENGTH>>,
        h: Real,
        order: usize,
    ) -> Series<T, LENGTH> {
        dispatched(
            #[inline(always)]
            || self.coefficients(start, drive, h, order),
        )
    }

    /// The first few coefficients in powers of t: derivatives at an instant. The order is known to the
    /// compiler, which leaves no loop.
    pub fn beginning<const LENGTH: usize>(
        &self,
        start: &Swing<Real>,
        drive: Option<&Drive<Real, LENGTH>>,
    ) -> Series<Real, LENGTH> {
        self.coefficients(start, drive, ONE, LENGTH - 1)
    }

    #[inline(always)]
    fn coefficients<T: Number, const LENGTH: usize>(
        &self,
        start: &Swing<T>,
        drive: Option<&Drive<T, LENGTH>>,
        h: Real,
        order: usize,
    ) -> Series<T, LENGTH> {
        let n = T::from_real;
        let Pendulum { mass_ratio: mu, damping_ratio, lever, coupling, pivot_damping, .. } = *self;
        let (step, r2, nu) = (n(h), n(self.frequency_squared), n(pivot_damping));
        let b2 = n(self.contact_distance) * n(self.contact_distance);
        let (beta, zeta2) = (n(coupling), n(2.0 * damping_ratio));
        let pull = n(mu) * n(lever);
        let row = [n(ZERO); LENGTH];
        let mut s = Series { x: row, u: row, a: row, y: row, w: row, c: row };
        (s.x[0], s.u[0], s.y[0], s.w[0], s.c[0]) = (start.x, start.u, start.y, start.w, start.c);
        let over_inertia = n(ONE) / self.inertia(start.y);
        let (over_b2, over_step) = (n(ONE) / b2, n(ONE) / step);
        // (c W)_k without its term c₀ W_k
        let mut swept = n(ZERO);
        for k in 0..order {
            let next = n((k + 1) as f64 * ONE);
            let over = step * T::reciprocal(k + 1);
            let (mut ca, mut next_swept) = (n(ZERO), n(ZERO));
            // Small angles: c stays 1, and the recurrences are linear.
            if !self.small_angles {
                let [yw, cw, sum] = convolutions(&s.y, &s.w, &s.c, &s.a, k);
                // ċ = −y W/b²
                s.c[k + 1] = -(over * (yw + s.y[k] * s.w[0]) * over_b2);
                next_swept = cw + s.c[k + 1] * s.w[0];
                ca = sum;
            }
            let rest = beta * ca + r2 * s.y[k] + nu * s.w[k];
            let [driven, base] = drive.map_or([n(ZERO); 2], |it| [it.primary[k], it.base[k]]);
            let force = driven - (s.x[k] + zeta2 * s.u[k]);
            s.a[k] =
                (force - pull * (next_swept * next * over_step - start.c * rest)) * over_inertia;
            s.w[k + 1] = -(over * (beta * start.c * s.a[k] + rest));
            s.u[k + 1] = over * (s.a[k] - base);
            s.x[k + 1] = over * s.u[k];
            s.y[k + 1] = over * (start.c * s.w[k] + swept);
            swept = next_swept;
        }
        s
    }
}

/// A polynomial by Horner's rule.
pub fn horner<T: Number>(coefficients: &[T], t: T) -> T {
    let zero = T::from_real(ZERO);
    coefficients.iter().rev().fold(zero, |sum, coefficient| sum * t + *coefficient)
}
