//! Derivatives of the motion of a free mass, which is linear between impacts.

use nalgebra::{Matrix4, Vector4};

use super::structure::{columns, stuck};
use super::{Differentiable, free_mass_impact, free_mass_stick};
use crate::absorber::siva::Siva;
use crate::absorber::{Absorber, ImpactLaw, OnStructure, Point};
use crate::host::oscillator::Primary;
use crate::host::{Host, HostState, Structure};
use crate::number::compensated::DoubleDouble;

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
        stuck(self.host.loaded().equation(), h)
    }

    #[inline(always)]
    fn impact_matrix(&self, [before, _]: [&Self::State; 2]) -> Matrix4<f64> {
        free_mass_impact(&self.law_at(self.wall(before), before.gap_velocity().abs()))
    }

    /// x + y moves uniformly, whatever x does.
    #[inline(always)]
    fn flight_volume(&self, tangent: &Matrix4<f64>) -> f64 {
        tangent[(0, 0)] * tangent[(1, 1)] - tangent[(0, 1)] * tangent[(1, 0)]
    }

    #[inline(always)]
    fn impact_volume(&self, jump: &Matrix4<f64>) -> f64 {
        jump[(3, 3)]
    }

    /// With Y the gap displacement from the wall and σ = μ/(1 + μ), X = x + σY obeys
    /// (1 + μ) Ẍ + 2ζ Ẋ + X = f + σY + 2ζσẎ: as if stuck, but for the integrals of Y and Ẏ over the chatter. That of Ẏ is
    /// −Y at its begin, that of Y of higher order.
    fn stick_matrix(&self, _stuck: &Self::State) -> Matrix4<f64> {
        let share = self.stick_share.value;
        let mut matrix = free_mass_stick(share);
        matrix[(1, 2)] = -share * self.host.loaded().equation().damping;
        matrix
    }
}
