//! Derivatives of the motion of a SIVA: it is linear between impacts.

use nalgebra::{Matrix4, Vector4};

use super::Differentiable;
use crate::compensated::Sum;
use crate::oscillator::{Oscillator, Primary};
use crate::siva::{Siva, SivaState};

/// x and ẋ after a time h, from (x, ẋ) = (1, 0) and (0, 1): columns.
fn columns(oscillator: &Oscillator, h: f64) -> [[f64; 2]; 2] {
    [(1.0, 0.0), (0.0, 1.0)].map(|(x, v)| {
        let primary = Primary { x: Sum::new(x), v: Sum::new(v) };
        let jet = oscillator.jet(x, v, oscillator.acceleration(&primary).value, h);
        [jet.value, jet.rate]
    })
}

impl Differentiable for Siva {
    fn rates(&self, state: &SivaState) -> Vector4<f64> {
        let (v, a) = (state.primary.v.value, state.acceleration.value);
        Vector4::new(v, a, state.gap_velocity(), -a)
    }

    fn flight_tangent(&self, _from: &SivaState, h: f64) -> Matrix4<f64> {
        let [[xx, vx], [xv, vv]] = columns(self.free(), h);
        // x + y moves uniformly.
        Matrix4::new(
            xx,
            xv,
            0.0,
            0.0, //
            vx,
            vv,
            0.0,
            0.0, //
            1.0 - xx,
            h - xv,
            1.0,
            h, //
            -vx,
            1.0 - vv,
            0.0,
            1.0,
        )
    }

    fn ride_tangent(&self, _from: &SivaState, h: f64) -> Matrix4<f64> {
        let [[xx, vx], [xv, vv]] = columns(self.loaded(), h);
        Matrix4::new(
            xx, xv, 0.0, 0.0, //
            vx, vv, 0.0, 0.0, //
            0.0, 0.0, 0.0, 0.0, //
            0.0, 0.0, 0.0, 0.0,
        )
    }

    fn impact_matrix(&self) -> Matrix4<f64> {
        let mut jump = Matrix4::identity();
        (jump[(1, 3)], jump[(3, 3)]) = (self.impact_share.value, -self.restitution());
        jump
    }

    fn stick_matrix(&self) -> Matrix4<f64> {
        let mut matrix = Matrix4::from_diagonal(&Vector4::new(1.0, 1.0, 0.0, 0.0));
        (matrix[(0, 2)], matrix[(1, 3)]) = (self.stick_share.value, self.stick_share.value);
        matrix
    }
}
