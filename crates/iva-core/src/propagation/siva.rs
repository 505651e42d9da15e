//! Derivatives of the motion of a SIVA: it is linear between impacts.

use nalgebra::{Matrix4, Vector4};

use super::Differentiable;
use crate::host::{Host, HostState, Structure};
use crate::oscillator::Equation;
use crate::siva::Siva;

/// x and ẋ after a time h, from (x, ẋ) = (1, 0) and (0, 1): columns.
fn columns(equation: &Equation, h: f64) -> [[f64; 2]; 2] {
    [(1.0, 0.0), (0.0, 1.0)].map(|(x, v)| {
        let (mut lower, mut upper, mut factor) = (x, v, 1.0);
        let mut sums = [0.0; 2];
        for k in 1..=TERMS {
            sums = [sums[0] + factor * lower, sums[1] + factor * upper];
            factor *= h / k as f64;
            (lower, upper) = (upper, equation.next_derivative(lower, upper));
        }
        sums
    })
}

/// Terms of the power series: what is left out after a step of 1.4 over the growth is below 10⁻²⁰.
const TERMS: usize = 26;

impl<H: Host<Real = f64>> Differentiable for Siva<H> {
    fn rates(&self, state: &Self::State) -> Vector4<f64> {
        let HostState { primary, acceleration, phase } = &state.host;
        let [base, ..] = self.host.free().base(phase);
        let a = acceleration.value;
        Vector4::new(primary.v.value, a - base, state.gap_velocity(), -a)
    }

    fn flight_tangent(&self, _from: &Self::State, h: f64) -> Matrix4<f64> {
        let [[xx, vx], [xv, vv]] = columns(self.host.free().equation(), h);
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

    fn ride_tangent(&self, _from: &Self::State, h: f64) -> Matrix4<f64> {
        let [[xx, vx], [xv, vv]] = columns(self.host.loaded().equation(), h);
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
