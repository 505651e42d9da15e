//! The flight of a pendulum absorber as a Taylor series in time.
//!
//! With y = b sinθ the gap displacement, W = b θ̇, c = cosθ and a = ẍ the motion is polynomial:
//!
//! ```text
//! ẏ = c W        ċ = −y W/b²        Ẇ = −(β a c + r² y + ν W)
//! ẋ = u          u̇ = a              (1 + μ) a + μλ ÿ = −x − 2ζ u
//! ```
//!
//! with β = b/(κL), λ = L/b, r² = g/(κL), ν = 2ζp r (physics: Lagrange's equations of the paper's
//! Eqs. 4 and 5, with their misprints mended, for a compound bob). The last equation is momentum: with
//! ÿ = (c W)˙ it is linear in the newest coefficient of a, so that each order costs three
//! convolutions and no division.
//!
//! Coefficients are those of powers of t/h: the step ends at 1, and their size tells at once what
//! the truncation leaves out.

use crate::compensated::Sum;

/// Order of the series.
pub const ORDER: usize = 20;

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
    fn from_double(value: f64) -> Self;
}

impl Number for f64 {
    fn from_double(value: f64) -> Self {
        value
    }
}

impl Number for Sum {
    fn from_double(value: f64) -> Self {
        Sum::new(value)
    }
}

/// The constants of the equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pendulum {
    /// Mass ratio μ.
    pub mass_ratio: f64,
    /// Damping ratio ζ of the primary.
    pub damping_ratio: f64,
    /// b, from the pivot to the point of contact.
    pub contact_distance: f64,
    /// λ = L/b.
    pub lever: f64,
    /// β = b/(κL).
    pub coupling: f64,
    /// r² = g/(κL), in ωn².
    pub frequency_squared: f64,
    /// ν = 2ζp r.
    pub pivot_damping: f64,
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
pub struct Series<T> {
    /// Displacement of the primary.
    pub x: [T; ORDER + 1],
    /// Its velocity.
    pub u: [T; ORDER + 1],
    /// Its acceleration, one order less.
    pub a: [T; ORDER + 1],
    /// Gap displacement.
    pub y: [T; ORDER + 1],
    /// W = b θ̇.
    pub w: [T; ORDER + 1],
    /// cosθ.
    pub c: [T; ORDER + 1],
}

impl Pendulum {
    /// cosθ at a gap displacement, of a pendulum that hangs below its pivot.
    pub fn cosine(&self, y: f64) -> f64 {
        if self.small_angles {
            return 1.0;
        }
        let sine = y / self.contact_distance;
        ((1.0 - sine) * (1.0 + sine)).max(0.0).sqrt()
    }

    /// The series from a state, for a step of length h, up to `order` of x, u, y, W and c.
    pub fn series<T: Number>(&self, start: &Swing<T>, h: f64, order: usize) -> Series<T> {
        let zero = T::from_double(0.0);
        let n = T::from_double;
        let Pendulum { mass_ratio: mu, damping_ratio, lever, coupling, pivot_damping, .. } = *self;
        let (step, r2, nu) = (n(h), n(self.frequency_squared), n(pivot_damping));
        let b2 = n(self.contact_distance) * n(self.contact_distance);
        let (beta, zeta2) = (n(coupling), n(2.0) * n(damping_ratio));
        let pull = n(mu) * n(lever);
        let mut s = Series {
            x: [zero; ORDER + 1],
            u: [zero; ORDER + 1],
            a: [zero; ORDER + 1],
            y: [zero; ORDER + 1],
            w: [zero; ORDER + 1],
            c: [zero; ORDER + 1],
        };
        (s.x[0], s.u[0], s.y[0], s.w[0], s.c[0]) = (start.x, start.u, start.y, start.w, start.c);
        let inertia = n(1.0) + n(mu) - pull * beta * start.c * start.c;
        for k in 0..order {
            let next = n((k + 1) as f64);
            let over = step / next;
            // ċ = −y W/b²
            let mut yw = zero;
            for i in 0..=k {
                yw = yw + s.y[i] * s.w[k - i];
            }
            s.c[k + 1] = if self.small_angles { zero } else { -(over * yw / b2) };
            // c W and c a without the terms of c₀ and of order k + 1
            let (mut cw, mut ca) = (zero, zero);
            for i in 0..=k {
                cw = cw + s.c[i + 1] * s.w[k - i];
            }
            for i in 1..=k {
                ca = ca + s.c[i] * s.a[k - i];
            }
            let rest = beta * ca + r2 * s.y[k] + nu * s.w[k];
            let force = -(s.x[k] + zeta2 * s.u[k]);
            s.a[k] = (force - pull * (cw / over - start.c * rest)) / inertia;
            s.w[k + 1] = -(over * (beta * start.c * s.a[k] + rest));
            s.u[k + 1] = over * s.a[k];
            s.x[k + 1] = over * s.u[k];
            s.y[k + 1] = over * {
                let mut cw = zero;
                for i in 0..=k {
                    cw = cw + s.c[i] * s.w[k - i];
                }
                cw
            };
        }
        s
    }
}

/// A polynomial by Horner's rule.
pub fn horner<T: Number>(coefficients: &[T], t: T) -> T {
    let zero = T::from_double(0.0);
    coefficients.iter().rev().fold(zero, |sum, coefficient| sum * t + *coefficient)
}
