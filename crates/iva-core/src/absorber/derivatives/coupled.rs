//! Derivatives of the motion of a coupled mass, which is linear between impacts.

use nalgebra::{Matrix4, Vector4};

use super::{Differentiable, free_mass_impact, free_mass_stick};
use crate::absorber::coupled::{Coupled, Coupling};
use crate::absorber::impact::primary_share;
use crate::absorber::{ImpactLaw, Wall};

impl<C: Coupling<Real = f64>> Differentiable for Coupled<C> {
    fn rates(&self, state: &Self::State) -> Vector4<f64> {
        let z = self.variables(state);
        let [a, b] = self.coupling.rates(z);
        Vector4::new(z[1], a, z[3], b)
    }

    fn flight_tangent(&self, _from: &Self::State, h: f64) -> Matrix4<f64> {
        let rates = unit_states().map(|z: [f64; 4]| {
            let [a, b] = self.coupling.rates(z);
            Vector4::new(z[1], a, z[3], b)
        });
        (Matrix4::from_columns(&rates) * h).exp()
    }

    fn ride_tangent(&self, _from: &Self::State, h: f64) -> Matrix4<f64> {
        let [mu, ..] = self.coupling.constants();
        let rates = unit_states().map(|[x, v, ..]: [f64; 4]| {
            let [a, b] = self.coupling.rates([x, v, 0.0, 0.0]);
            Vector4::new(v, a + mu / (1.0 + mu) * b, 0.0, 0.0)
        });
        let mut tangent = (Matrix4::from_columns(&rates) * h).exp();
        (tangent[(2, 2)], tangent[(3, 3)]) = (0.0, 0.0);
        tangent
    }

    fn impact_matrix(&self, wall: Wall, approach: f64) -> Matrix4<f64> {
        free_mass_impact(&self.law_at(wall, approach))
    }

    fn stick_matrix(&self, _wall: Wall) -> Matrix4<f64> {
        let [mu, ..] = self.coupling.constants();
        free_mass_stick(primary_share(mu, 0.0).value)
    }
}

/// The states of which one of x, ẋ, y and w is 1 and the others are 0.
fn unit_states() -> [[f64; 4]; 4] {
    Matrix4::identity().into()
}
