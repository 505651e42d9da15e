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
//! Eqs. 4 and 5, with their misprints mended, for a compound bob). A [`Spring`] in the pivot adds a term to Ẇ. The last equation is momentum: with
//! ÿ = (c W)˙ it is linear in the newest coefficient of a, so that each order costs three
//! convolutions and no division (`segment/taylor/recurrence.rs`).
//!
//! Coefficients are those of powers of t/h: the step ends at 1. [`Remainder`] bounds what the
//! truncation leaves out.

use crate::force::Drive;
use crate::number::arrays::laned;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
pub(crate) use crate::number::series::unrolled;
pub use crate::number::series::{Number, ORDER, Row};

pub(crate) use pivoted::{Growing, Posture, ROOM};
use recurrence::Recurrence;
pub use remainder::Remainder;
pub(crate) use remainder::several::{InFlight, LAST, RemainderOfSeveral, Shaking};
pub use spring::Spring;

/// Runs code with an order of [`crate::absorber::piva`] as a constant.
macro_rules! with_order {
    ($order:expr, $constant:ident => $body:expr) => {
        match $order {
            10 => {
                const $constant: usize = 10;
                $body
            }
            16 => {
                const $constant: usize = 16;
                $body
            }
            _ => {
                const $constant: usize = $crate::segment::taylor::ORDER;
                $body
            }
        }
    };
}
pub(crate) use with_order;

mod pivoted;
mod recurrence;
mod remainder;
mod spring;

/// The orders in use.
pub(crate) const ORDERS: [usize; 3] = [10, 16, ORDER];

/// The constants of the equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pendulum<R = f64> {
    /// Mass ratio μ.
    pub mass_ratio: R,
    /// Damping ratio ζ of the primary.
    pub damping_ratio: R,
    /// b, from the pivot to the point of contact.
    pub contact_distance: R,
    /// κ = I/(m L²).
    pub inertia_ratio: R,
    /// λ = L/b.
    pub lever: R,
    /// β = b/(κL).
    pub coupling: R,
    /// r² = g/(κL), in ωn².
    pub frequency_squared: R,
    /// ν = 2ζp r.
    pub pivot_damping: R,
    /// The spring in the pivot.
    pub spring: Spring<R>,
    /// sinθ = θ and cosθ = 1: then c stays 1 and the equations are linear.
    pub small_angles: bool,
    /// cos α of the line on which its pivot moves, which rises by α: 1 of a level one.
    pub level: R,
    /// sin α.
    pub rise: R,
}

/// The forms that the equations take. Lanes compute one of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Equations {
    /// With sinθ and cosθ.
    Large,
    /// Linear.
    Small,
    /// With sinθ, cosθ and the θ of a spring.
    Sprung,
}

laned!(
    Pendulum,
    Pendulums {
        mass_ratio: f64,
        damping_ratio: f64,
        contact_distance: f64,
        inertia_ratio: f64,
        lever: f64,
        coupling: f64,
        frequency_squared: f64,
        pivot_damping: f64,
        spring: Spring,
        small_angles: bool,
        level: f64,
        rise: f64,
    }
);

/// A state between events: x, u, y, W and c, and the arc φ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing<T> {
    /// Displacement of the primary.
    pub x: T,
    /// Velocity of the primary.
    pub u: T,
    /// Gap displacement y = b sinθ.
    pub y: T,
    /// W = b θ̇.
    pub w: T,
    /// cosθ.
    pub c: T,
    /// φ = b θ, for the spring in the pivot ([`Pendulum::arc`]).
    pub arc: T,
}

/// The series of a step of length h; entry k belongs to (t/h)ᵏ.
#[derive(Debug, Clone, Copy)]
pub struct Series<T, const LENGTH: usize = { ORDER + 1 }> {
    /// Displacement of the primary.
    pub x: [T; LENGTH],
    /// Velocity of the primary.
    pub u: [T; LENGTH],
    /// Absolute acceleration ẍ + a_g of the primary, to one order less.
    pub a: [T; LENGTH],
    /// Gap displacement.
    pub y: [T; LENGTH],
    /// W = b θ̇.
    pub w: [T; LENGTH],
    /// cosθ.
    pub c: [T; LENGTH],
}

impl<R: Real> Pendulum<R> {
    /// μκλ² = I/b²: the inertia that W = b θ̇ belongs to.
    pub(crate) fn swung_inertia(&self) -> R {
        self.mass_ratio * self.inertia_ratio * (self.lever * self.lever)
    }

    /// The form of the equations.
    pub(crate) fn equations(&self) -> Equations {
        match (self.small_angles, self.spring.acts) {
            (true, _) => Equations::Small,
            (false, true) => Equations::Sprung,
            (false, false) => Equations::Large,
        }
    }

    /// The same equations in other numbers.
    pub fn map<Q>(&self, number: impl Fn(R) -> Q) -> Pendulum<Q> {
        Pendulum {
            mass_ratio: number(self.mass_ratio),
            damping_ratio: number(self.damping_ratio),
            contact_distance: number(self.contact_distance),
            inertia_ratio: number(self.inertia_ratio),
            lever: number(self.lever),
            coupling: number(self.coupling),
            frequency_squared: number(self.frequency_squared),
            pivot_damping: number(self.pivot_damping),
            spring: self.spring.map(&number),
            small_angles: self.small_angles,
            level: number(self.level),
            rise: number(self.rise),
        }
    }

    /// γ = cos(θ − α) = c cos α + sinθ sin α, what the pivot and the arc of the pendulum have of one direction: c where the pivot moves level.
    #[inline(always)]
    pub(crate) fn lean<T: Number<Real = R>>(&self, y: T, c: T) -> T {
        if self.rise == 0.0 {
            return c;
        }
        let n = T::from_real;
        n(self.level) * c + n(self.rise) * (y / n(self.contact_distance))
    }

    /// sin(θ − α): sinθ where the pivot moves level, 0 at small angles.
    #[inline(always)]
    fn aside<T: Number<Real = R>>(&self, y: T, c: T) -> T {
        let n = T::from_real;
        let sine = if self.small_angles { n(R::ZERO) } else { y / n(self.contact_distance) };
        if self.rise == 0.0 { sine } else { n(self.level) * sine - n(self.rise) * c }
    }

    /// p = b sin(θ − α) + b sin α, how far a pendulum of the length b has swung along the line of its pivot, from 1 − c: y where that is level.
    #[inline(always)]
    pub(crate) fn beside<T: Number<Real = R>>(&self, y: T, raised: T) -> T {
        if self.rise == 0.0 {
            return y;
        }
        let n = T::from_real;
        n(self.level) * y + n(self.rise * self.contact_distance) * raised
    }

    /// [`Self::beside`] with its velocity and acceleration, from those of the gap.
    pub(crate) fn swung_beside(&self, [y, w, bend]: [R; 3]) -> [R; 3] {
        if self.rise == 0.0 {
            return [y, w, bend];
        }
        let (c, over_b) = (self.cosine(y), R::ONE / self.contact_distance);
        let (sine, turned) = (y * over_b, w / c);
        let lean = self.level + self.rise * sine / c;
        let raised = sine * sine / (R::ONE + c);
        let whirled = self.rise * over_b * turned * turned / c;
        [self.beside(y, raised), lean * w, lean * bend + whirled]
    }

    /// The fastest rate in the equations but for the swing: of the primary, of the pendulum.
    pub fn fastest(&self) -> R {
        let zeta = self.damping_ratio;
        let primary = zeta + (R::ONE + zeta * zeta).sqrt();
        let stiffness = self.frequency_squared + self.spring.acting();
        let hanging = (stiffness * (R::ONE + self.mass_ratio)).sqrt();
        primary.max(hanging).max(self.pivot_damping)
    }

    /// |θ̇| = |W|/b, the rate at which sinθ and cosθ change; 0 at small angles, where the equations are linear.
    #[inline(always)]
    pub fn swing(&self, w: R) -> R {
        if self.small_angles { R::ZERO } else { w.abs() / self.contact_distance }
    }

    /// The arc φ = b θ at a gap displacement and cosθ, for the spring; 0 where that has no term of its own.
    #[inline(always)]
    pub fn arc<T: Number<Real = R>>(&self, y: T, cosine: T) -> T {
        let b = self.contact_distance;
        self.spring.arc(b, y / T::from_real(b), cosine)
    }

    /// cosθ at a gap displacement, of a pendulum that hangs below its pivot.
    #[inline]
    pub fn cosine(&self, y: R) -> R {
        let b = self.contact_distance;
        // b − y is exact close to the horizontal, where 1 − sinθ would be lost in the rounding of sinθ.
        let cosine = ((b - y) * (b + y)).max(0.0).sqrt() / b;
        if self.small_angles { R::ONE } else { cosine }
    }

    /// cosθ at a gap displacement to twice the precision.
    pub fn precise_cosine(&self, y: DoubleDouble<R>) -> DoubleDouble<R> {
        let cosine = self.cosine(y.value);
        if self.small_angles {
            DoubleDouble::new(R::ONE)
        } else {
            refined_cosine(y.over(self.contact_distance), cosine)
        }
    }

    /// 1 + μ − (μ/κ) cos²θ, what a force on the primary moves: written as 1 + (μ/κ)(κ − 1 + sin²θ), in
    /// which nothing cancels however heavy the pendulum is.
    #[inline(always)]
    pub fn inertia<T: Number<Real = R>>(&self, y: T) -> T {
        T::from_real(R::ONE) + self.own_inertia(y, T::from_real(R::ONE))
    }

    /// The part of [`Self::inertia`] that is the pendulum's: μ (1 − γ²/κ). c counts only where the pivot does not move level.
    #[inline(always)]
    pub(crate) fn own_inertia<T: Number<Real = R>>(&self, y: T, c: T) -> T {
        let n = T::from_real;
        let aside = self.aside(y, c);
        let share = n(self.mass_ratio) * n(self.lever) * n(self.coupling);
        share * (n(self.inertia_ratio - 1.0) + aside * aside)
    }

    /// The series from a state under a drive, for a step of length h, up to `order` of x, u, y, W and c.
    #[cfg_attr(target_arch = "wasm32", inline(never))]
    pub fn series<T: Number<Real = R>, const LENGTH: usize>(
        &self,
        start: &Swing<T>,
        drive: Option<&Drive<T, LENGTH>>,
        h: R,
        order: usize,
    ) -> Series<T, LENGTH> {
        if T::UNROLLED && ORDERS.contains(&order) {
            return with_order!(order, N => self.series_to::<T, LENGTH, N>(start, drive, h));
        }
        let mut recurrence = Recurrence::new(self, start, drive, h);
        for k in 0..order {
            recurrence.raise(k);
        }
        recurrence.series
    }

    /// The series from a state under a drive, of an order N that the compiler knows.
    #[inline(always)]
    pub(crate) fn series_to<T: Number<Real = R>, const LENGTH: usize, const N: usize>(
        &self,
        start: &Swing<T>,
        drive: Option<&Drive<T, LENGTH>>,
        h: R,
    ) -> Series<T, LENGTH> {
        let mut recurrence = Recurrence::new(self, start, drive, h);
        unrolled!(k < N => recurrence.raise(k));
        recurrence.series
    }

    /// The first few coefficients in powers of t: derivatives at an instant. The order is known to the
    /// compiler, which leaves no loop.
    #[inline(always)]
    pub fn beginning<T: Number<Real = R>, const LENGTH: usize>(
        &self,
        start: &Swing<T>,
        drive: Option<&Drive<T, LENGTH>>,
    ) -> Series<T, LENGTH> {
        let mut recurrence = Recurrence::new(self, start, drive, R::ONE);
        for k in 0..LENGTH - 1 {
            recurrence.raise(k);
        }
        recurrence.series
    }
}

/// cosθ to twice the precision from sinθ and from cosθ in plain numbers, by one step of Newton's method.
#[inline(always)]
pub(crate) fn refined_cosine<R: Real>(sine: DoubleDouble<R>, cosine: R) -> DoubleDouble<R> {
    let c = DoubleDouble::new(cosine);
    let square = DoubleDouble::new(R::ONE) - sine * sine;
    let precise = c + (square - c * c) / c.times(2.0);
    if cosine == 0.0 { DoubleDouble::ZERO } else { precise }
}

/// A polynomial by Horner's rule.
pub fn horner<R: Real, T: Number<Real = R>>(coefficients: &[T], t: T) -> T {
    let zero = T::from_real(R::ZERO);
    coefficients.iter().rev().fold(zero, |sum, coefficient| sum * t + *coefficient)
}
