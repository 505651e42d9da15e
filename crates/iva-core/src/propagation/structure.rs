//! Derivatives of the motion of a structure, alone or with an absorber stuck to it, which is linear.

use nalgebra::{Matrix4, Vector4};

use super::Differentiable;
use crate::host::{Alone, Host, HostState, Structure};
use crate::oscillator::Equation;
use crate::system::Wall;

/// x and ẋ after a time h from (x, ẋ) = (1, 0) and from (0, 1): the columns of the flow.
pub(super) fn columns(equation: &Equation, h: f64) -> [[f64; 2]; 2] {
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

/// Terms of the power series: the truncation error after a step of 1.4 over the growth is below 10⁻²⁰.
const TERMS: usize = 26;

impl<H: Host<Real = f64>> Differentiable for Alone<H> {
    fn rates(&self, state: &Self::State) -> Vector4<f64> {
        let HostState { primary, acceleration, phase } = state;
        let [base, ..] = self.host.free().base(phase);
        Vector4::new(primary.v.value, acceleration.value - base, 0.0, 0.0)
    }

    fn flight_tangent(&self, _from: &Self::State, h: f64) -> Matrix4<f64> {
        let [[xx, vx], [xv, vv]] = columns(self.host.free().equation(), h);
        Matrix4::new(
            xx, xv, 0.0, 0.0, //
            vx, vv, 0.0, 0.0, //
            0.0, 0.0, 1.0, 0.0, //
            0.0, 0.0, 0.0, 1.0,
        )
    }

    fn ride_tangent(&self, from: &Self::State, h: f64) -> Matrix4<f64> {
        self.flight_tangent(from, h)
    }

    fn impact_matrix(&self, _wall: Wall) -> Matrix4<f64> {
        Matrix4::identity()
    }

    fn stick_matrix(&self, _wall: Wall) -> Matrix4<f64> {
        Matrix4::identity()
    }
}
