//! A third absorber, in one file: a free mass in a gap, with a linear dashpot and a linear spring between it and the
//! structure.
//!
//! ```text
//! ẍ + 2ζẋ + x = μ(γw + κy),    ẇ = −ẍ − γw − κy,    w = ẏ,
//! ```
//!
//! with γ and κ the constants of dashpot and spring over the absorber's mass. It is a pendulum at small angles with a
//! torsional spring at its pivot, if κ = g/L + the stiffness of that spring over mL².

use iva_core::coupled::{Coupled, Coupling};
use iva_core::real::Real;
use iva_core::taylor::Number;

/// μ, e, d, ζ, γ and κ.
#[derive(Debug, Clone, Copy)]
pub struct Dashpot<R = f64>(pub [R; 6]);

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
    fn rates<T: Number<Real = R>>(&self, [x, v, y, w]: [T; 4]) -> [T; 2] {
        let [mu, _, _, zeta, gamma, kappa] = self.0.map(T::from_real);
        let pull = gamma * w + kappa * y;
        let a = mu * pull - (x + (zeta + zeta) * v);
        [a, -(a + pull)]
    }

    fn dampers(&self) -> [R; 2] {
        let [mu, _, _, zeta, gamma, _] = self.0;
        [zeta * 2.0, mu * gamma]
    }

    fn spring(&self) -> R {
        let [mu, _, _, _, _, kappa] = self.0;
        mu * kappa
    }
}
