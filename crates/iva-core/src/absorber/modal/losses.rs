//! What a motion loses and gains: integrals of the products of polynomials.

use super::ModalMotion;
use super::propagator::Flown;
use super::state::Place;
use super::structure::Damping;
use crate::force::Force;
use crate::host::Host;
use crate::number::real::Real;
use crate::segment::flight::Losses;
use crate::segment::polynomial::product_integral;
use crate::segment::taylor::{ORDER, Row};

/// Lengths that differ by so many units of 2⁻⁵² are the same but for rounding.
const SAME_ULPS: f64 = 16.0;

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> ModalMotion<'_, H, N, M> {
    /// The losses of the first part of the motion, of length h.
    pub(super) fn lost(&self, h: R) -> Losses<R> {
        if let Some([all, gaps]) = self.lost_in_leap(h) {
            return Losses { viscous: all - gaps, pivot: gaps, work: R::ZERO };
        }
        let rates = self.velocities();
        let gaps = self.lost_in_gaps(&rates, h);
        Losses { viscous: self.viscous(&rates, h) - gaps, pivot: gaps, work: self.work(&rates, h) }
    }

    /// The losses in all dampers and in the gaps, where the motion is a shortest leap that nothing drives or pulls.
    fn lost_in_leap(&self, h: R) -> Option<[R; 2]> {
        let Self { system, from, .. } = self;
        let driven = system.host.force().is_some_and(Force::lasts);
        if !R::FAST_PATHS || driven || from.places[..system.count].iter().any(Place::carried) {
            return None;
        }
        let leaps = system.leaps()?;
        let near = (h - leaps.shortest).abs() <= leaps.shortest * (R::EPSILON * SAME_ULPS);
        if !near || system.regime(&from.places).pulls.iter().any(|pull| pull.value != 0.0) {
            return None;
        }
        let forms = leaps.forms.get_or_init(|| system.forms(leaps.shortest));
        let n = system.whole.count();
        Some(forms.lost(n, &Flown::of(&from.modes, n)))
    }

    /// q̇ of all modes as polynomials in t.
    fn velocities(&self) -> Vec<Row<R>> {
        let rate = |j: usize| {
            let row = self.modal_series().row(j);
            let over = R::ONE / self.unit;
            std::array::from_fn(|m| {
                if m < ORDER { row[m + 1] * ((m + 1) as f64) * over } else { R::ZERO }
            })
        };
        (0..self.system.whole.count()).map(rate).collect()
    }

    /// ∫ a b dh of two polynomials from 0 to h.
    pub(super) fn integral(&self, a: &Row<R>, b: &Row<R>, h: R) -> R {
        product_integral(a, b, self.share(h)) * self.unit
    }

    /// ∫ q̇ᵀ D q̇ dh.
    fn viscous(&self, rates: &[Row<R>], h: R) -> R {
        let n = rates.len();
        match &self.system.whole.damping {
            Damping::Separate(dampers) => {
                dampers.iter().zip(rates).fold(R::ZERO, |sum, (c, rate)| {
                    if c.value == 0.0 { sum } else { sum + c.value * self.integral(rate, rate, h) }
                })
            }
            Damping::Full(matrix) => (0..n).fold(R::ZERO, |sum, j| {
                let elements = &matrix[j * n..(j + 1) * n];
                let force: Row<R> = std::array::from_fn(|m| {
                    let both = elements.iter().zip(rates);
                    both.fold(R::ZERO, |sum, (c, rate)| c.mul_add(rate[m], sum))
                });
                sum + self.integral(&rates[j], &force, h)
            }),
        }
    }

    /// Σ c ∫ ẏ² dh of the dashpots in the gaps.
    fn lost_in_gaps(&self, rates: &[Row<R>], h: R) -> R {
        let flying = (0..self.system.count).filter(|k| !self.from.places[*k].carried());
        let tied = flying.filter_map(|k| self.system.tied[k].as_ref());
        tied.fold(R::ZERO, |sum, tied| {
            let speed: Row<R> = std::array::from_fn(|m| {
                let both = tied.shape.iter().zip(rates);
                both.fold(R::ZERO, |sum, (phi, rate)| phi.mul_add(rate[m], sum))
            });
            sum + tied.tie.taken(self.integral(&speed, &speed, h))
        })
    }

    /// ∫ f φ_f·q̇ − a_g (Γ·q̇ + Σ μ ẋ₁) dh: ẋ₁ is that of the structure for a stuck mass; in flight it loses ∫a_g.
    fn work(&self, rates: &[Row<R>], h: R) -> R {
        let system = self.system;
        let Some(drive) = system.host.drive(&self.from.phase, self.unit) else { return R::ZERO };
        let seen = |shape: &[R]| -> Row<R> {
            std::array::from_fn(|m| {
                let both = shape.iter().zip(rates);
                both.fold(R::ZERO, |sum, (phi, rate)| phi.mul_add(rate[m], sum))
            })
        };
        let pushed = seen(system.whole.shape(system.pushed));
        let mut work = self.integral(&pushed, &drive.primary, h);
        for (point, row) in self.asides() {
            work += self.integral(&seen(system.whole.shape(*point)), &row.map(|it| it.value), h);
        }
        if !system.host.moves_base() {
            return work;
        }
        let mut momentum = seen(system.whole.participation().unwrap_or(&[]));
        for (k, (mass, place)) in system.masses().iter().zip(&self.from.places).enumerate() {
            // A tied mass takes part as a coordinate of the structure.
            if system.tied[k].is_some() {
                continue;
            }
            let moving = if place.carried() {
                seen(system.shape(k))
            } else {
                let [_, v] = self.from.modes.of_point(system.shape(k));
                let mut moving = [R::ZERO; ORDER + 1];
                moving[0] = v.value + place.gap(mass).w;
                for m in 0..ORDER {
                    let gravity = if m == 0 { system.falling(k, place).value } else { R::ZERO };
                    moving[m + 1] = -((drive.base[m] + gravity) * R::reciprocal(m + 1) * self.unit);
                }
                moving
            };
            for (sum, part) in momentum.iter_mut().zip(moving) {
                *sum = part.mul_add(mass.mass_ratio, *sum);
            }
        }
        work -= self.integral(&momentum, &drive.base, h);
        work
    }
}
