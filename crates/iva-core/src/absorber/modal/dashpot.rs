//! Masses with a dashpot in their gap: coordinates of the structure.
//!
//! A dashpot pulls at a mass and at its point with c ẏ. A mass that has one is a coordinate p = √μ x₁ of the structure, of
//! frequency 0, so that the gap displacement y = x₁ − u is a motion of the structure alone:
//!
//! ```text
//! y = −φᵀq,    φ = (φ of the point, …, −1/√μ, …),    D gains c φφᵀ.
//! ```
//!
//! With this shape of the gap the mass is one among others, in the limit of an infinite mass that rests: its 1/μ is 0 in the
//! impact law and while it is stuck, and the motion of the base reaches it by the coordinate p. Stuck to a wall it presses
//! on that as any other mass does, for the dashpot is at rest.

use super::structure::ModalStructure;
use super::{MOST_MODES, Modal};
use crate::error::{Invalid, number};
use crate::host::{Host, UndrivenHost};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;

/// What a mass with a dashpot is to the structure.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Dashpot<R> {
    /// c, in units of the unit of mass times that of frequency.
    pub damping: R,
    /// φ of the gap.
    pub shape: Vec<R>,
    /// The index of p.
    pub coordinate: usize,
    /// √μ: how the base takes part in p.
    root: R,
}

impl<R: Real, const N: usize> Modal<UndrivenHost<R>, N> {
    /// The same masses, with a dashpot in the gap of each: c, over the unit of mass and that of frequency; 0 for none.
    ///
    /// # Errors
    /// [`Invalid`] for a negative number or one out of [`crate::range`], for dashpots that are not as many as masses, and if modes
    /// and masses with dashpots are more than [`MOST_MODES`].
    pub fn with_dashpots(self, dashpots: &[R]) -> Result<Self, Invalid> {
        super::structure::same("absorber.gap_damping", dashpots.len(), self.count)?;
        for (k, damping) in dashpots.iter().enumerate() {
            let field = format!("absorber.{k}.gap_damping");
            range::size(&field, *damping)?;
            if *damping < 0.0 {
                return Err(Invalid::new(field, number(damping.double()), "give 0 or more"));
            }
        }
        let own = self.whole.count();
        let coupled: Vec<usize> = (0..self.count).filter(|k| dashpots[*k] != 0.0).collect();
        let count = own + coupled.len();
        if count > MOST_MODES {
            let rule = format!("modes and masses with a dashpot are {MOST_MODES} at most");
            return Err(Invalid::new("absorber.gap_damping", number(count as f64), rule));
        }
        if coupled.is_empty() {
            return Ok(self);
        }
        let mut all = std::array::from_fn(|_| None);
        for (index, &k) in coupled.iter().enumerate() {
            let root = self.masses[k].mass_ratio.sqrt();
            let coordinate = own + index;
            let mut shape = self.whole.shape(self.at[k]).to_vec();
            shape.resize(count, R::ZERO);
            shape[coordinate] = -(R::ONE / root);
            all[k] = Some(Dashpot { damping: dashpots[k], shape, coordinate, root });
        }
        let of_all: Vec<&Dashpot<R>> = all.iter().flatten().collect();
        let whole = self.whole.with_masses(&of_all);
        let of = (self.masses, self.at, self.count);
        let (structure, points) = (self.structure, [self.seen, self.pushed]);
        Ok(Self { structure, ..Self::on(self.host, whole, of, all, points) })
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize> Modal<H, N> {
    /// Number of modes that are the structure's own.
    pub(super) fn own_modes(&self) -> usize {
        self.structure.count()
    }

    /// 1/μ, or 0 for a mass that is a coordinate of the structure.
    pub(super) fn lightness(&self, k: usize) -> DoubleDouble<R> {
        match &self.dashpots[k] {
            Some(_) => DoubleDouble::ZERO,
            None => DoubleDouble::new(R::ONE).over(self.masses[k].mass_ratio),
        }
    }

    /// √μ (u + y) and √μ (u̇ + w) of each mass with a dashpot, at their coordinates.
    pub(super) fn positions(&self, places: &mut [DoubleDouble<R>], of_gaps: impl Fn(usize) -> R) {
        for (k, dashpot) in self.dashpots.iter().enumerate() {
            let Some(dashpot) = dashpot else { continue };
            let both = places.iter().zip(self.shape(k));
            let u = both.fold(DoubleDouble::ZERO, |sum, (q, phi)| sum + q.times(*phi));
            places[dashpot.coordinate] = u.plus(of_gaps(k)).times(dashpot.root);
        }
    }
}

impl<R: Real> ModalStructure<R> {
    /// The structure of which these masses are coordinates.
    fn with_masses(&self, dashpots: &[&Dashpot<R>]) -> Self {
        let count = self.count() + dashpots.len();
        let mut damping = self.extended_damping(count);
        for dashpot in dashpots {
            for (i, a) in dashpot.shape.iter().enumerate() {
                for (j, b) in dashpot.shape.iter().enumerate() {
                    damping[i * count + j] += dashpot.damping * (*a * *b);
                }
            }
        }
        let masses: Vec<R> = dashpots.iter().map(|it| it.root).collect();
        self.extended(damping, &masses)
    }
}
