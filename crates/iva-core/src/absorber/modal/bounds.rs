//! Bounds on what accelerates a mass, from the energies of derivatives ([`super`]).

use super::regime::Stuck;
use super::{Followed, Modal, ModalState};
use crate::force::{Force, Harmonic};
use crate::host::Host;
use crate::number::real::Real;

/// Bounds are widened by this factor for their own rounding, and for eigenvalues of the damping that are negative by
/// rounding.
const MARGIN: f64 = 1.0 + 1e-9;

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// A bound on the derivative n − 1 of A, n > 0, in a motion of this length from an instant on at which the modes have these
    /// derivatives n and n + 1.
    pub(super) fn bound(
        &self,
        derivatives: impl Fn(usize) -> [R; 2],
        stuck: &Stuck<R>,
        Followed { shape, factor, with_base, constant }: Followed<'_, R>,
        n: usize,
        length: R,
    ) -> R {
        let [f, a] = self.host.force().map_or([R::ZERO; 2], |force| force.largest(n as i32));
        let pushed = self.whole.shape(self.pushed);
        let none: &[R] = &[];
        let parts = self.whole.participation().unwrap_or(none);
        let elsewhere = self.host.force().map_or(&[][..], Force::elsewhere);
        let separate = stuck.masses.is_empty() && self.whole.is_separate();
        let [mut sum, mut shapes, mut forced, mut moved] = [R::ZERO; 4];
        let [mut lows, mut rates] = [[R::ZERO; M]; 2];
        for j in 0..self.whole.count() {
            let [low, high] = derivatives(j);
            let energy = high * high + self.whole.stiffness[j].value * (low * low);
            let phi = shape[j];
            let part = parts.get(j).copied().unwrap_or(R::ZERO);
            if separate {
                let aside = |(point, harmonic): &(usize, Harmonic<R>)| {
                    self.whole.shape(*point)[j].abs() * harmonic.largest(n as i32)
                };
                let asides = elsewhere.iter().fold(R::ZERO, |sum, it| sum + aside(it));
                let push = pushed[j].abs() * f + part.abs() * a + asides;
                sum += phi.abs() * (energy.sqrt() + length * push);
            } else {
                sum += energy;
                shapes += phi * phi;
                forced += pushed[j] * pushed[j];
                moved += part * part;
                (lows[j], rates[j]) = (low, high);
            }
        }
        if !separate {
            let along = |shape: &[R], of: &[R]| {
                shape.iter().zip(of).fold(R::ZERO, |sum, (phi, part)| phi.mul_add(*part, sum))
            };
            for (spring, shape) in &self.whole.springs {
                let stretched = along(shape, &lows);
                sum += *spring * (stretched * stretched);
            }
            let mut dragged = R::ZERO;
            for k in stuck.masses.iter().filter(|k| self.tied[**k].is_none()) {
                let mass = self.masses[*k].mass_ratio;
                let rate = along(self.shape(*k), &rates);
                sum += mass * (rate * rate);
                dragged += mass.sqrt();
            }
            let asides = elsewhere.iter().fold(R::ZERO, |sum, (point, harmonic)| {
                let shape = self.whole.shape(*point);
                sum + along(shape, shape).sqrt() * harmonic.largest(n as i32)
            });
            let push = forced.sqrt() * f + (moved.sqrt() + dragged) * a + asides;
            sum = shapes.sqrt() * (sum.sqrt() + length * push);
        }
        let base = if with_base && self.host.moves_base() {
            self.host.force().map_or(R::ZERO, |force| force.largest(n as i32 - 1)[1])
        } else {
            R::ZERO
        };
        let constant = if n == 1 { constant.value.abs() } else { R::ZERO };
        ((sum + base) * factor.abs() + constant) * MARGIN
    }

    /// The size of the terms that are summed to A of a stuck mass.
    pub(super) fn terms(&self, state: &ModalState<H, N, M>, k: usize) -> R {
        let place = &state.places[k];
        let Followed { shape, factor, constant, .. } = self.followed(k, place);
        let own = constant.value.abs() + self.gravity[k].abs() + self.static_friction[k];
        let mut sum = R::ZERO;
        for (l, is) in self.swinging(&state.places) {
            sum += self.pulling(l, is, &state.places[l]) * self.mobility(k, l).value.abs();
        }
        for (l, mass) in self.masses().iter().enumerate() {
            let most = self.gravity[l].abs() + self.friction[l];
            sum += mass.mass_ratio * most * self.mobility(k, l).value.abs();
        }
        let growth = self.whole.growth();
        for (j, phi) in shape.iter().enumerate() {
            let spring = self.whole.stiffness[j].value * state.modes.places[j].value.abs();
            sum += phi.abs() * (spring + growth * state.modes.velocities[j].value.abs());
        }
        let [f, a] = self.host.force().map_or([R::ZERO; 2], |force| force.largest(0));
        let along = |point: usize| {
            let both = self.whole.shape(point).iter().zip(shape);
            both.fold(R::ZERO, |sum, (a, b)| sum + (*a * *b).abs())
        };
        for (point, harmonic) in self.host.force().map_or(&[][..], Force::elsewhere) {
            sum += along(*point) * harmonic.largest(0);
        }
        (sum + along(self.pushed) * f + a * 2.0).mul_add(factor.abs(), own)
    }
}
