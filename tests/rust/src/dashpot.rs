//! A third absorber, in one file: a free mass in a gap, with a linear dashpot between it and the structure.
//!
//! ```text
//! ẍ + 2ζẋ + x = μγw,    ẇ = −ẍ − γw,    w = ẏ,
//! ```
//!
//! with γ the constant of the dashpot over the absorber's mass.

use iva_core::coupled::{Coupled, Coupling};
use iva_core::real::Real;
use iva_core::taylor::Number;

/// μ, e, d, ζ and γ.
#[derive(Debug, Clone, Copy)]
pub struct Dashpot<R = f64>(pub [R; 5]);

impl<R: Real> Dashpot<R> {
    /// The absorber on its structure.
    pub fn mounted(self) -> Coupled<Self> {
        Coupled::new(self)
    }
}

impl<R: Real> Coupling for Dashpot<R> {
    type Real = R;

    fn constants(&self) -> [R; 3] {
        let [mu, e, d, ..] = self.0;
        [mu, e, d]
    }

    #[inline(always)]
    fn rates<T: Number<Real = R>>(&self, [x, v, _y, w]: [T; 4]) -> [T; 2] {
        let [mu, _, _, zeta, gamma] = self.0.map(T::from_real);
        let drag = gamma * w;
        let a = mu * drag - (x + (zeta + zeta) * v);
        [a, -(a + drag)]
    }

    fn dampers(&self) -> [R; 2] {
        let [mu, _, _, zeta, gamma] = self.0;
        [zeta * 2.0, mu * gamma]
    }
}
