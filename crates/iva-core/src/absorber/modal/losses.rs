//! What a motion loses and gains: integrals of the products of polynomials, by quadrature: a motion is so short that what 9 nodes leave out is
//! below 10⁻²⁰ of the whole.

use super::ModalMotion;
use super::forms::NODES;
use super::propagator::Flown;
use super::state::Place;
use super::structure::Damping;
use crate::force::Force;
use crate::host::Host;
use crate::number::real::Real;
use crate::segment::flight::Losses;
use crate::segment::quadrature::{node, weight};
use crate::segment::taylor::{ORDER, Pendulum, Row};

/// Lengths that differ by so many units of 2⁻⁵² are the same but for rounding.
const SAME_ULPS: f64 = 16.0;

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> ModalMotion<'_, H, N, M> {
    /// The losses of the first part of the motion, of length h.
    pub(super) fn lost(&self, h: R) -> Losses<R> {
        if let Some(it) = self.oscillation() {
            return self.lost_by(it, h);
        }
        if let Some([all, gaps]) = self.lost_in_leap(h) {
            return Losses { viscous: all - gaps, pivot: gaps, work: R::ZERO };
        }
        let nodes = self.nodes([R::ZERO, h]);
        let rates: Vec<AtNodes<R>> = (0..self.system.whole.count())
            .map(|j| {
                let row = self.modal_series().row(j);
                let over = R::ONE / self.unit;
                let rate: Row<R> = std::array::from_fn(|m| {
                    if m < ORDER { row[m + 1] * ((m + 1) as f64) * over } else { R::ZERO }
                });
                at_nodes(&rate, &nodes)
            })
            .collect();
        let gaps = self.lost_in_gaps(&rates) * h;
        let viscous = self.viscous(&rates) * h - gaps;
        let pivot = gaps + self.lost_in_pivots(&nodes) * h;
        Losses { viscous, pivot, work: self.work(&rates, &nodes) * h }
    }

    /// The nodes of the quadrature between two instants, in the unit of time of the series.
    pub(super) fn nodes(&self, ends: [R; 2]) -> AtNodes<R> {
        let part = ends.map(|h| self.share(h));
        std::array::from_fn(|g| node::<R, NODES>(g, part))
    }

    /// The losses in all dampers and in the gaps, where the motion is a shortest leap that nothing drives or pulls.
    fn lost_in_leap(&self, h: R) -> Option<[R; 2]> {
        let Self { system, from, .. } = self;
        let driven = system.host.force().is_some_and(Force::lasts);
        if !R::FAST_PATHS || driven || from.places[..system.count()].iter().any(Place::carried) {
            return None;
        }
        let leaps = system.leaps()?;
        let near = (h - leaps.shortest).abs() <= leaps.shortest * (R::EPSILON * SAME_ULPS);
        if !near || self.regime.pulls.iter().any(|pull| pull.value != 0.0) {
            return None;
        }
        let forms = leaps.forms.get_or_init(|| system.forms(leaps.shortest));
        let n = system.whole.count();
        Some(forms.lost(n, &Flown::of(&from.modes, n)))
    }

    /// The mean of q̇ᵀ D q̇.
    fn viscous(&self, rates: &[AtNodes<R>]) -> R {
        let n = rates.len();
        match &self.system.whole.damping {
            Damping::Separate(dampers) => {
                let each = dampers.iter().zip(rates).filter(|(c, _)| c.value != 0.0);
                each.fold(R::ZERO, |sum, (c, rate)| c.value.mul_add(mean(rate, rate), sum))
            }
            Damping::Full(matrix) => (0..n).fold(R::ZERO, |sum, j| {
                sum + mean(&rates[j], &along(&matrix[j * n..(j + 1) * n], rates))
            }),
        }
    }

    /// The mean of Σ c ẏ² of the dashpots in the gaps.
    fn lost_in_gaps(&self, rates: &[AtNodes<R>]) -> R {
        let flying = (0..self.system.count()).filter(|k| !self.from.places[*k].carried());
        let tied = flying.filter_map(|k| self.system.tied[k].as_ref());
        tied.fold(R::ZERO, |sum, tied| {
            let speed = along(&tied.shape, rates);
            sum + tied.tie.taken(mean(&speed, &speed))
        })
    }

    /// The mean of Σ μκλ² ν W² of the pivots.
    fn lost_in_pivots(&self, nodes: &AtNodes<R>) -> R {
        let damped = |(k, is): &(usize, &Pendulum<R>)| {
            let swing = self.swing(*k).filter(|_| is.pivot_damping != 0.0)?;
            let w: Row<R> = std::array::from_fn(|m| swing.series.w[m]);
            let turning = at_nodes(&w, nodes);
            Some(is.swung_inertia() * is.pivot_damping * mean(&turning, &turning))
        };
        let each = self.system.swinging(&self.from.places);
        each.filter_map(|it| damped(&it)).fold(R::ZERO, |sum, lost| sum + lost)
    }

    /// The mean of Σ f φ·q̇ − a_g (Γ·q̇ + Σ μ ẋ₁): ẋ₁ is that of the structure for a stuck mass; in flight it loses ∫a_g.
    fn work(&self, rates: &[AtNodes<R>], nodes: &AtNodes<R>) -> R {
        let system = self.system;
        let Some(drive) = system.host.drive(&self.from.phase, self.unit) else { return R::ZERO };
        let pushed = along(system.whole.shape(system.pushed), rates);
        let mut work = mean(&pushed, &at_nodes(&drive.primary, nodes));
        for (point, row) in self.asides() {
            let force = at_nodes(&row.map(|it| it.value), nodes);
            work += mean(&along(system.whole.shape(*point), rates), &force);
        }
        if !system.host.moves_base() {
            return work;
        }
        let mut momentum = along(system.whole.participation().unwrap_or(&[]), rates);
        for (k, (mass, place)) in system.masses().iter().zip(&self.from.places).enumerate() {
            // A tied mass takes part as a coordinate of the structure.
            if system.tied[k].is_some() {
                continue;
            }
            let moving = if place.carried() {
                along(system.shape(k), rates)
            } else if let Some(swing) = self.swing(k) {
                let mut moving = along(system.shape(k), rates);
                let over = swing.series.pendulum.lever / self.unit;
                let rate: Row<R> = std::array::from_fn(|m| {
                    let next = || swing.series.beside(m + 1) * ((m + 1) as f64) * over;
                    if m < ORDER { next() } else { R::ZERO }
                });
                for (sum, part) in moving.iter_mut().zip(at_nodes(&rate, nodes)) {
                    *sum += part;
                }
                moving
            } else {
                let [_, v] = self.from.modes.of_point(system.shape(k));
                let mut moving = [R::ZERO; ORDER + 1];
                moving[0] = v.value + place.gap(mass).w;
                for m in 0..ORDER {
                    let gravity = if m == 0 { system.falling(k, place).value } else { R::ZERO };
                    moving[m + 1] = -((drive.base[m] + gravity) * R::reciprocal(m + 1) * self.unit);
                }
                at_nodes(&moving, nodes)
            };
            for (sum, part) in momentum.iter_mut().zip(moving) {
                *sum = part.mul_add(mass.mass_ratio, *sum);
            }
        }
        work - mean(&momentum, &at_nodes(&drive.base, nodes))
    }
}

/// What a number is at all nodes.
pub(super) type AtNodes<R> = [R; NODES];

/// A polynomial at all nodes, side by side.
pub(super) fn at_nodes<R: Real>(row: &Row<R>, nodes: &AtNodes<R>) -> AtNodes<R> {
    let mut values = [R::ZERO; NODES];
    for coefficient in row.iter().rev() {
        for (value, t) in values.iter_mut().zip(nodes) {
            *value = value.mul_add(*t, *coefficient);
        }
    }
    values
}

/// The mean of a product.
pub(super) fn mean<R: Real>(a: &AtNodes<R>, b: &AtNodes<R>) -> R {
    let both = a.iter().zip(b).enumerate();
    both.fold(R::ZERO, |sum, (g, (a, b))| (weight::<R, NODES>(g) * *a).mul_add(*b, sum))
}

/// A sum of modes with these factors at all nodes.
fn along<R: Real>(shape: &[R], modes: &[AtNodes<R>]) -> AtNodes<R> {
    let mut sum = [R::ZERO; NODES];
    for (phi, mode) in shape.iter().zip(modes) {
        for (sum, part) in sum.iter_mut().zip(mode) {
            *sum = phi.mul_add(*part, *sum);
        }
    }
    sum
}
