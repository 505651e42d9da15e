//! Derivatives of the motion of a pendulum: its Taylor series, evaluated in numbers with derivatives.

use nalgebra::{Matrix4, Vector4};

use super::Differentiable;
use super::structure::stuck;
use crate::absorber::Absorber as _;
use crate::absorber::piva::{Piva, PivaState, STEEP, Sizes};
use crate::force::Drive;
use crate::host::{Host, Phase, Structure};
use crate::number::real::dual::Dual;
use crate::segment::taylor::{ORDER, Pendulum, Series, Swing};

/// The order of the series of a rough derivative: it leaves out some 10⁻⁵ of that of a step, 10⁻⁸ at full accuracy.
pub(crate) const ROUGH: usize = 10;

/// Sizes of the terms of the equations of a pendulum before they cancel.
pub(crate) struct Terms {
    /// r² |y| + ν |W|, with that of a spring.
    pub swing: f64,
    /// |y| W²/b², with which the turning arm pulls at the structure.
    pub turning: f64,
    /// How much larger the relative error of cosθ is than that of y, from which it is computed.
    pub steep: f64,
}

impl Terms {
    pub fn of<P: Copy>(pendulum: &Pendulum, state: &PivaState<P>) -> Self {
        let Pendulum { contact_distance: b, frequency_squared, pivot_damping, .. } = *pendulum;
        let cosine = state.cosine.value.abs().min(1.0);
        let (y, w) = (state.y().value.abs(), state.w.value.abs());
        let wound = pendulum.spring.acting() * pendulum.arc(y, cosine);
        let swing = frequency_squared * y + wound + pivot_damping * w;
        let turning = if pendulum.small_angles { 0.0 } else { y * w * w / (b * b) };
        let sine = y / b;
        let follows = sine < STEEP && !pendulum.small_angles;
        let steep = if follows { 1.0 / (1.0 - sine * sine) } else { 1.0 };
        Self { swing, turning, steep }
    }
}

/// As [`Differentiable::sharpness`].
pub(crate) fn sharpness<P: Copy>(pendulum: &Pendulum, state: &PivaState<P>) -> f64 {
    let steep = state.y().value.abs() >= STEEP * pendulum.contact_distance;
    let cosine = state.cosine.value.abs().min(1.0);
    if steep && !pendulum.small_angles { cosine } else { 1.0 }
}

/// The begin of a flight in numbers with derivatives with respect to four variables, of which the first has the index `first`;
/// x and ẋ have the indices 0 and 1, and y and W those from `own` on.
#[inline(always)]
pub(crate) fn begun<P: Copy>(
    pendulum: &Pendulum<Dual<4>>,
    from: &PivaState<P>,
    own: usize,
    first: usize,
) -> Swing<Dual<4>> {
    let values = [from.primary.x.value, from.primary.v.value, from.y().value, from.w.value];
    let [mut x, mut u, mut y, mut w] = values.map(Dual::constant);
    for (number, index) in [(&mut x, 0), (&mut u, 1), (&mut y, own), (&mut w, own + 1)] {
        if (first..first + 4).contains(&index) {
            number.slopes[index - first] = 1.0;
        }
    }
    let mut c = Dual::constant(from.cosine.value);
    if !pendulum.small_angles && from.cosine.value != 0.0 {
        let b = pendulum.contact_distance.value;
        let slope = -y.value / (b * b * from.cosine.value);
        c.slopes = y.slopes.map(|it| it * slope);
    }
    Swing { x, u, y, w, c, arc: pendulum.arc(y, c) }
}

impl<H: Host<Real = f64>> Piva<H> {
    /// The derivative of a flight of length h, from the series up to the order N.
    #[inline(always)]
    fn swung<const N: usize>(&self, from: &PivaState<Phase<H>>, h: f64) -> Matrix4<f64> {
        let pendulum = self.pendulum.map(Dual::constant);
        let start = begun(&pendulum, from, 2, 0);
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
        let Pendulum { mass_ratio, damping_ratio, lever, coupling, .. } = self.pendulum;
        let cosine = state.cosine.value.abs().min(1.0);
        let driven = self.host.drive_ahead::<3>(&state.phase).as_ref().map_or(0.0, Drive::size);
        let (x, u) = (state.primary.x.value.abs(), state.primary.v.value.abs());
        let Terms { swing, turning, steep } = Terms::of(&self.pendulum, state);
        let on_primary = driven + x + 2.0 * damping_ratio * u;
        let primary = (on_primary + mass_ratio * lever * (turning + swing))
            / self.pendulum.inertia(state.y().value);
        let w = state.w.value.abs();
        Some(Vector4::new(u, primary, cosine * w, coupling * primary * steep + swing))
    }

    fn sharpness(&self, state: &PivaState<Phase<H>>) -> f64 {
        sharpness(&self.pendulum, state)
    }

    fn turning(&self, state: &PivaState<Phase<H>>) -> f64 {
        state.w.value.abs()
    }

    fn flight_tangent(&self, from: &PivaState<Phase<H>>, h: f64) -> Matrix4<f64> {
        self.swung::<ORDER>(from, h)
    }

    fn rough_tangent(&self, from: &PivaState<Phase<H>>, h: f64) -> Matrix4<f64> {
        self.swung::<ROUGH>(from, h)
    }

    fn ride_tangent(&self, _from: &PivaState<Phase<H>>, h: f64) -> Matrix4<f64> {
        stuck(self.host.loaded().equation(), h)
    }

    fn impact_matrix(&self, [before, _]: [&Self::State; 2]) -> Matrix4<f64> {
        let mut jump = Matrix4::identity();
        let law = self.law(self.wall(before));
        (jump[(1, 3)], jump[(3, 3)]) = (law.impact_gain(), -law.ratio);
        jump
    }

    fn stick_matrix(&self, stuck: &Self::State) -> Matrix4<f64> {
        let mut matrix = Matrix4::from_diagonal(&Vector4::new(1.0, 1.0, 0.0, 0.0));
        let Pendulum { mass_ratio, lever, .. } = self.pendulum;
        // The centre of mass, (1 + μ) x + μλ y, is conserved.
        matrix[(0, 2)] = mass_ratio * lever / (1.0 + mass_ratio);
        matrix[(1, 3)] = self.law(self.wall(stuck)).stick_gain();
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
