//! Derivatives of the motion of a free mass, which is linear between impacts.

use nalgebra::{Matrix4, Vector4};

use super::structure::{columns, lag};
use super::{Differentiable, free_mass_impact, free_mass_stick};
use crate::compensated::DoubleDouble;
use crate::host::{Host, HostState, Structure};
use crate::oscillator::{Equation, Primary};
use crate::siva::Siva;
use crate::system::{Point, System, Wall};

impl<H: Host<Real = f64>> Differentiable for Siva<H> {
    const LINEAR: bool = true;

    #[inline(always)]
    fn rates(&self, state: &Self::State) -> Vector4<f64> {
        // Computed from x and ẋ in doubles: that is all that is known of a state before an impact from its row.
        let HostState { primary: Primary { x, v }, phase, .. } = &state.host;
        let [x, v] = [x.value, v.value].map(DoubleDouble::new);
        let a = self.host.free().acceleration(phase, &Primary { x, v }).value;
        let [base, ..] = self.host.free().base(phase);
        Vector4::new(v.value, a - base, state.gap_velocity(), -a)
    }

    fn bend(&self, before: &Self::State) -> f64 {
        self.rates(before)[3].abs()
    }

    fn plain_state(&self, state: &Self::State) -> Vector4<f64> {
        let Point { x, v } = self.primary(state);
        let most = self.clearance() * 2.0;
        Vector4::new(x.abs(), v.abs(), most, state.gap_velocity().abs())
    }

    fn plain_rates(&self, state: &Self::State) -> Vector4<f64> {
        let Point { v, .. } = self.primary(state);
        let pull = self.host.free().bound::<0>(&state.host.primary);
        Vector4::new(v.abs(), pull, state.gap_velocity().abs(), pull)
    }

    #[inline(always)]
    fn flight_tangent(&self, _from: &Self::State, h: f64) -> Matrix4<f64> {
        let equation = self.host.free().equation();
        let flow @ [[xx, vx], [xv, vv]] = columns(equation, h);
        let [stayed, late] = lag(equation, h, flow);
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
            stayed,
            late,
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

    #[inline(always)]
    fn impact_matrix(&self, wall: Wall) -> Matrix4<f64> {
        free_mass_impact(self.impact_gain(wall), self.restitution(wall))
    }

    fn velocity_gained(&self, wall: Wall, before: &Vector4<f64>) -> Option<f64> {
        Some(self.impact_gain(wall) * before[2])
    }

    fn stick_matrix(&self, _wall: Wall) -> Matrix4<f64> {
        free_mass_stick(self.stick_share.value)
    }

    /// With Y the gap displacement from the wall and σ = μ/(1 + μ), X = x + σY obeys
    /// (1 + μ) Ẍ + 2ζ Ẋ + X = f + σY + 2ζσẎ: it moves as if stuck but for ∫Ẏ = −Y at the begin and I = ∫Y. Rebounds of
    /// speeds u eᵏ under the pressure A make |I| = ⅔ u³/A² Σ e³ᵏ; what is left out is of the order of (u/A)² Y.
    fn chatter_matrix(&self, wall: Wall, after: &Vector4<f64>) -> Matrix4<f64> {
        let (sigma, e) = (self.stick_share.value, self.restitution(wall));
        let Equation { stiffness, damping, .. } = *self.host.loaded().equation();
        let ratio = after[2] / after[3];
        let by_speed = 2.0 * ratio * ratio / (1.0 - e * e * e);
        let mut matrix = self.stick_matrix(wall);
        matrix[(1, 2)] -= sigma * damping;
        matrix[(0, 3)] += sigma * damping * by_speed;
        matrix[(1, 3)] += sigma * (stiffness - damping * damping) * by_speed;
        matrix
    }
}
