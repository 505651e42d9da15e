//! Stops that stand on the ground: walls between which a point of the structure moves.
//!
//! A stop has no mass of its own and takes no part in any motion. Its gap displacement is that of the point itself, y = u = −φ₀ᵀq with φ₀ = −φ of the point, so that
//! its walls are met at u = offset ± d. The formulas of members that are coordinates of the structure (`modal/ties.rs`) hold with this shape of the gap and 0 in place
//! of 1/μ: an impact turns u̇ into −e u̇, and the ground takes what impulse that needs; a point that is stuck to a stop is at rest there, M′ → ∞ along φ.
//! Where the base moves, the stops stand on the base.
//!
//! **Pressure.** A point at rest has no acceleration that would tell what its stop carries. What it would do without the stop, while all others stay,
//! tells it instead: A = φ₀ᵀ q̈ of that motion. With the loads −(Φᵀ g + …) and (μ⁻¹ + ΦᵀΦ)⁻¹ = S of a set of stuck members it is
//!
//! ```text
//! A = Σₗ Sₖₗ loadₗ / Sₖₖ,
//! ```
//!
//! by the rule for the inverse of a matrix without one row. The power series of ∬A is kept beside those of the modes, as if the stop were a coordinate.

use super::regime::Stuck;
use super::series::Term;
use super::state::Place;
use super::ties::{Tie, Tied};
use super::{Followed, Modal};
use crate::error::{Invalid, number};
use crate::force::Force;
use crate::host::Host;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

impl<R: Real> Tied<R> {
    /// A stop on the ground at a point of this shape.
    pub(super) fn on_ground(of_point: &[R]) -> Self {
        let shape = of_point.iter().map(|phi| -*phi).collect();
        let (tie, root) = (Tie::NONE, R::ZERO);
        Self { tie, shape, coordinate: 0, root, grounded: true, row: Some(0) }
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// True if a member is a stop on the ground.
    pub fn on_ground(&self, absorber: usize) -> bool {
        self.masses().get(absorber).is_some_and(|member| member.mass_ratio == 0.0)
    }

    /// A stop on the ground.
    #[inline(always)]
    pub(super) fn grounded(&self, k: usize) -> Option<&Tied<R>> {
        self.tied[k].as_ref().filter(|tied| tied.grounded)
    }

    /// Number of coordinates, and of stops on the ground and bodies behind them, each with the series of its ∬A.
    pub(super) fn rows(&self) -> usize {
        self.whole.count() + self.tied.iter().flatten().filter(|it| it.row.is_some()).count()
    }

    /// The row of a stop that a point is stuck to, or of a body that is carried, and its mass.
    #[inline(always)]
    pub(super) fn pressed_row(&self, k: usize, place: &Place<R>) -> Option<usize> {
        if place.carried() { self.tied[k].as_ref()?.row } else { None }
    }

    /// Gives each stop and body its row.
    pub(super) fn number_stops(&mut self) {
        let first = self.whole.count();
        let rows = self.tied.iter_mut().flatten().filter_map(|tied| tied.row.as_mut());
        rows.enumerate().for_each(|(rank, row)| *row = first + rank);
    }

    /// The row of a carried member and the A there, where its contact pulls at its point so, and would without the others: of a stop what the point would do without it, of a body the pull per mass.
    #[inline(always)]
    pub(super) fn pressed<T: Term<R>>(&self, k: usize, pull: T, own: T) -> Option<(usize, T)> {
        let tied = self.tied[k].as_ref()?;
        let over = if tied.grounded { own } else { T::from_real(self.masses[k].mass_ratio) };
        Some((tied.row?, pull / over))
    }

    /// Checks that stops stand where something moves, and that there is room for their rows.
    pub(super) fn check_stops(&self) -> Result<(), Invalid> {
        let still = |k: &usize| self.on_ground(*k) && self.mobility(*k, *k).value == 0.0;
        if let Some(k) = (0..self.count()).find(still) {
            let rule = "a stop on the ground stands at a point that moves: here all shapes are 0";
            return Err(Invalid::new(format!("absorber.{k}.point"), "a node", rule));
        }
        let rows = self.rows();
        if rows > M {
            let rule = format!(
                "modes, masses with a spring or dashpot and stops on the ground are {M} at most"
            );
            return Err(Invalid::new("absorber", number(rows as f64), rule));
        }
        Ok(())
    }

    /// A bound on the derivative n − 1 of A of a stop that a point is stuck to, n > 1, in a motion of this length from an instant on at which the modes have these
    /// derivatives n − 1 and n: springs and dampers make 3 Λ times the root of the energy of a derivative at most.
    pub(super) fn bound_of_load(
        &self,
        k: usize,
        stuck: &Stuck<R>,
        derivatives: impl Fn(usize) -> [R; 2],
        n: usize,
        length: R,
    ) -> R {
        let [force, base] = self.host.force().map_or([R::ZERO; 2], |it| it.largest(n as i32 - 1));
        let along = |one: &[R], other: &[R]| {
            let both = one.iter().zip(other);
            both.fold(R::ZERO, |sum, (a, b)| a.mul_add(*b, sum)).abs()
        };
        let load = |l: usize| {
            let shape = self.gap_shape(l);
            let constant = DoubleDouble::ZERO;
            let followed = Followed { shape, factor: R::ONE, with_base: false, constant };
            let own = self.bound(&derivatives, stuck, followed, n - 1, length);
            let part = along(shape, self.whole.participation().unwrap_or(&[]));
            let alone = if self.tied[l].is_none() { R::ONE } else { R::ZERO };
            let elsewhere = self.host.force().map_or(&[][..], Force::elsewhere).iter();
            let asides = elsewhere.fold(R::ZERO, |sum, (point, harmonic)| {
                along(shape, self.whole.shape(*point)).mul_add(harmonic.largest(n as i32 - 1), sum)
            });
            let driven = along(shape, self.whole.shape(self.pushed)) * force;
            own * self.whole.growth() * 3.0 + driven + (part + alone) * base + asides
        };
        let loads = stuck.masses.iter().map(|l| load(*l));
        let over = if self.on_ground(k) { None } else { Some(self.masses[k].mass_ratio) };
        stuck
            .shares(k, over)
            .zip(loads)
            .fold(R::ZERO, |sum, (share, load)| share.abs().mul_add(load, sum))
    }
}

impl<R: Real> Stuck<R> {
    /// Sₖₗ over Sₖₖ or a mass, of a member k of the set, for all l.
    fn shares(&self, k: usize, mass: Option<R>) -> impl Iterator<Item = R> {
        let count = self.masses.len();
        let at = self.masses.iter().position(|l| *l == k).unwrap_or(0);
        let row = &self.inverse[at * count..(at + 1) * count];
        let own = mass.unwrap_or(row[at].value);
        row.iter().map(move |element| element.value / own)
    }
}
