//! Derivatives of the motion of a pendulum: its Taylor series, evaluated in numbers with derivatives.

use nalgebra::{Matrix4, Vector4};

use super::Differentiable;
use super::structure::stuck;
use crate::absorber::Wall;
use crate::absorber::piva::{Piva, PivaState, STEEP, Sizes};
use crate::force::Drive;
use crate::host::{Host, Phase, Structure};
use crate::number::real::Real;
use crate::number::real::dual::Dual;
use crate::segment::taylor::{ORDER, Pendulum, Series, Swing};

/// The order of the series of a rough derivative: it leaves out some 10⁻⁵ of that of a step, 10⁻⁸ at full accuracy.
const ROUGH: usize = 10;

impl<H: Host<Real = f64>> Piva<H> {
    /// The derivative of a flight of length h, from the series up to the order N.
    #[inline(always)]
    fn swung<const N: usize>(&self, from: &PivaState<Phase<H>>, h: f64) -> Matrix4<f64> {
        let y = from.y().value;
        let mut cosine = Dual::constant(from.cosine.value);
        if !self.pendulum.small_angles && from.cosine.value != 0.0 {
            let b = self.parameters.contact_distance;
            cosine.slopes[2] = -y / (b * b * from.cosine.value);
        }
        let (pendulum, y) = (self.pendulum.map(Dual::constant), Dual::variable(y, 2));
        let start = Swing {
            x: Dual::variable(from.primary.x.value, 0),
            u: Dual::variable(from.primary.v.value, 1),
            y,
            w: Dual::variable(from.w.value, 3),
            c: cosine,
            arc: pendulum.arc(y, cosine),
        };
        let drive = self.host.drive(&from.phase, h).map(|drive| Drive {
            primary: drive.primary.map(Dual::constant),
            base: drive.base.map(Dual::constant),
        });
        let series: Series<Dual<4>> =
            pendulum.series_to::<_, _, N>(&start, drive.as_ref(), h.into());
        // At t = 1 a polynomial is the sum of its coefficients; small ones are added first.
        let mut sums = [[0.0; 4]; 4];
        for k in (0..=N).rev() {
            let coefficients = [&series.x[k], &series.u[k], &series.y[k], &series.w[k]];
            for (sums, coefficient) in sums.iter_mut().zip(coefficients) {
                for (sum, slope) in sums.iter_mut().zip(coefficient.slopes) {
                    *sum += slope;
                }
            }
        }
        Matrix4::from_fn(|row, column| sums[row][column])
    }
}

impl<H: Host<Real = f64>> Differentiable for Piva<H> {
    fn rates(&self, state: &PivaState<Phase<H>>) -> Vector4<f64> {
        let series = self.beginning::<3>(state);
        Vector4::new(series.x[1], series.u[1], series.y[1], series.w[1])
    }

    fn sizes(&self, state: &PivaState<Phase<H>>) -> Option<Vector4<f64>> {
        let Pendulum { mass_ratio, damping_ratio, contact_distance: b, lever, .. } = self.pendulum;
        let Pendulum { coupling, frequency_squared, pivot_damping, .. } = self.pendulum;
        let cosine = state.cosine.value.abs().min(1.0);
        let driven = self.host.drive_ahead::<3>(&state.phase).as_ref().map_or(0.0, Drive::size);
        let (y, w) = (state.y().value.abs(), state.w.value.abs());
        let (x, u) = (state.primary.x.value.abs(), state.primary.v.value.abs());
        let wound = self.pendulum.spring.acting() * self.pendulum.arc(y, cosine);
        let swing = frequency_squared * y + wound + pivot_damping * w;
        let turning = if self.pendulum.small_angles { 0.0 } else { y * w * w / (b * b) };
        let on_primary = driven + x + 2.0 * damping_ratio * u;
        let primary = (on_primary + mass_ratio * lever * (turning + swing))
            / self.pendulum.inertia(state.y().value);
        // Where y is not steep, cosθ is computed from y, and its relative error is larger by this factor.
        let sine = y / b;
        let follows = sine < STEEP && !self.pendulum.small_angles;
        let steep = if follows { 1.0 / (1.0 - sine * sine) } else { 1.0 };
        Some(Vector4::new(u, primary, cosine * w, coupling * primary * steep + swing))
    }

    fn sharpness(&self, state: &PivaState<Phase<H>>) -> f64 {
        let steep = state.y().value.abs() >= STEEP * self.parameters.contact_distance;
        let cosine = state.cosine.value.abs().min(1.0);
        if steep && !self.pendulum.small_angles { cosine } else { 1.0 }
    }

    fn turning(&self, state: &PivaState<Phase<H>>) -> f64 {
        state.w.value.abs()
    }

    fn flight_tangent(&self, from: &PivaState<Phase<H>>, h: f64) -> Matrix4<f64> {
        f64::dispatched(
            #[inline(always)]
            || self.swung::<ORDER>(from, h),
        )
    }

    fn rough_tangent(&self, from: &PivaState<Phase<H>>, h: f64) -> Matrix4<f64> {
        f64::dispatched(
            #[inline(always)]
            || self.swung::<ROUGH>(from, h),
        )
    }

    fn ride_tangent(&self, _from: &PivaState<Phase<H>>, h: f64) -> Matrix4<f64> {
        stuck(self.host.loaded().equation(), h)
    }

    fn impact_matrix(&self, wall: Wall, _approach: f64) -> Matrix4<f64> {
        let mut jump = Matrix4::identity();
        let law = self.law(wall);
        (jump[(1, 3)], jump[(3, 3)]) = (law.impact_gain(), -law.ratio);
        jump
    }

    fn stick_matrix(&self, wall: Wall) -> Matrix4<f64> {
        let mut matrix = Matrix4::from_diagonal(&Vector4::new(1.0, 1.0, 0.0, 0.0));
        let Pendulum { mass_ratio, lever, .. } = self.pendulum;
        // The centre of mass, (1 + μ) x + μλ y, is conserved.
        matrix[(0, 2)] = mass_ratio * lever / (1.0 + mass_ratio);
        matrix[(1, 3)] = self.law(wall).stick_gain();
        matrix
    }

    fn truncation(&self, from: &PivaState<Phase<H>>) -> [f64; 2] {
        let driven = self.host.drive(&from.phase, 1.0);
        let sizes = Sizes::of(self, from, driven.as_ref().map_or(0.0, Drive::size));
        // At full accuracy the proven bound is far above the truncation error.
        let share = if self.parameters.tolerance > 0.0 { self.accuracy.tolerance } else { 0.0 };
        [share * sizes.primary, share * sizes.gap]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::absorber::piva::{Parameters, PivaStart};
    use crate::absorber::{Absorber, Start};
    use crate::force::{Acts, Force, Harmonic};
    use crate::segment::flight::Motion;

    /// The fractional parts of multiples of an irrational number.
    fn spread(i: u32, k: u32) -> f64 {
        (f64::from(i) * f64::from(2 * k + 3).sqrt()).fract()
    }

    /// The reference is the series of the highest order.
    #[test]
    fn a_rough_tangent_has_some_five_digits_in_every_step() {
        let mut worst = [0.0f64; 3];
        for i in 1..1500 {
            let u = |k| spread(i, k);
            let which = (3.0 * u(0)) as usize;
            let parameters = Parameters {
                tolerance: [0.0, 1e-9, 1e-6][which],
                frequency_ratio: 0.1 + u(1),
                pivot_damping_ratio: 0.1 * u(2),
                ..Parameters::point_bob(0.3 * u(14), 0.6, 0.9, 0.1 * u(4), 1.0 + u(5))
            };
            let harmonic = Harmonic {
                amplitude: u(6),
                frequency: 0.2 + 3.0 * u(7),
                phase: u(8),
                acts: if u(9) < 0.5 { Acts::Primary } else { Acts::Base },
            };
            let piva = Piva::new(parameters).unwrap();
            let piva = piva.under(Force::harmonic(vec![harmonic]).unwrap());
            let start = Start {
                displacement: 2.0 * u(10) - 1.0,
                velocity: 2.0 * u(15) - 1.0,
                gap_displacement: 1.6 * u(12) - 0.8,
                gap_velocity: 2.0 * u(13) - 1.0,
            };
            let state = piva.begin(&PivaStart::from(start));
            let h = piva.flight(&state).reach();
            let (full, rough) = (piva.flight_tangent(&state, h), piva.rough_tangent(&state, h));
            worst[which] = worst[which].max((full - rough).amax() / full.amax());
        }
        let small = [1e-7, 1e-4, 1e-4];
        let within = worst.iter().zip(small).all(|(worst, small)| (1e-12..small).contains(worst));
        assert!(within, "{worst:?}");
    }
}
