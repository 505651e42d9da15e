//! Masses tied to their points by a spring or a dashpot, and those on which others ride: coordinates of the structure.
//!
//! A spring and a dashpot pull at a mass and at its point with k y + c ẏ; the spring is slack at y = 0, wherever the walls are. A mass that has one is a coordinate p = √μ x₁ of the
//! structure, of frequency 0, so that the gap displacement y = x₁ − u is a motion of the structure alone:
//!
//! ```text
//! y = −φᵀq,    φ = (φ of the point, …, −1/√μ, …),    K gains k φφᵀ,    D gains c φφᵀ.
//! ```
//!
//! Its inertia is in the coordinate p already. So the formulas of masses without ties hold with this shape of the gap in place of φ, and with 0 in place of
//! 1/μ in the impact law and while it is stuck, or else it would be counted twice; gravity and the motion of the base reach it by the coordinate p. Stuck to a wall it
//! presses on that as any other mass does, less what the spring pulls: the dashpot is at rest.
//!
//! A **body** is a mass that is a point of the structure as well ([`Modal::with_bodies`]), at which forces act, other members ride or a stop stands. What its wall or friction
//! carries is then not told by the acceleration of its point, but is the load of that contact over its mass, which is kept beside the series of the modes as that of a stop on the ground is.

use std::sync::Arc;

use super::structure::{Damping, ModalStructure};
use super::{Modal, ModalState};
use crate::absorber::siva::FreeMass;
use crate::error::{Invalid, number};
use crate::host::{Host, UndrivenHost};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;

/// What ties a mass to its point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tie<R> {
    /// k of a linear spring, over the unit of mass and the square of that of frequency.
    pub spring: R,
    /// c of a linear dashpot, over the unit of mass and that of frequency.
    pub damping: R,
}

/// What a mass that is tied to its point is to the structure.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tied<R> {
    pub tie: Tie<R>,
    /// φ of the gap.
    pub shape: Vec<R>,
    /// The index of p; 0 of a stop on the ground.
    pub coordinate: usize,
    /// √μ: how the base takes part in p.
    pub root: R,
    /// True of a stop on the ground (`modal/ground.rs`), which has neither mass nor coordinate.
    pub grounded: bool,
    /// The row of what the contact of a stop on the ground or of a body carries, behind those of all coordinates; `None` of other members.
    pub row: Option<usize>,
}

impl<R: Real> Tie<R> {
    /// A mass that nothing ties to its point.
    pub const NONE: Self = Self { spring: R::ZERO, damping: R::ZERO };

    /// What it stores at a gap displacement: ½ k y².
    pub(super) fn stored(&self, y: R) -> R {
        self.spring * 0.5 * (y * y)
    }

    /// What it takes per time, of the product of two gap velocities.
    pub(super) fn taken(&self, product: R) -> R {
        self.damping * product
    }

    /// Checks the numbers of the mass of an index.
    fn check(&self, k: usize) -> Result<(), Invalid> {
        for (name, value) in [("spring", self.spring), ("gap_damping", self.damping)] {
            let field = format!("absorber.{k}.{name}");
            range::size(&field, value)?;
            if value < 0.0 {
                return Err(Invalid::new(field, number(value.double()), "give 0 or more"));
            }
        }
        Ok(())
    }
}

impl<R: Real, const N: usize, const M: usize> Modal<UndrivenHost<R>, N, M> {
    /// The same masses, each tied to its point.
    ///
    /// # Errors
    /// [`Invalid`] for a negative number or one out of [`crate::range`], for ties that are not as many as masses, and if modes
    /// and tied masses are more than M.
    pub fn with_ties(self, ties: &[Tie<R>]) -> Result<Self, Invalid> {
        super::structure::same("absorber.spring", ties.len(), self.count())?;
        for (k, tie) in ties.iter().enumerate() {
            tie.check(k)?;
        }
        let own = self.whole.count();
        let coupled: Vec<usize> = (0..self.count()).filter(|k| ties[*k] != Tie::NONE).collect();
        if let Some(k) = coupled.iter().find(|k| self.on_ground(**k)) {
            let rule = "a stop on the ground has no spring or dashpot: give them to the structure";
            let tie = number(ties[*k].spring.double());
            return Err(Invalid::new(format!("absorber.{k}.spring"), tie, rule));
        }
        let new: Vec<usize> = coupled.iter().copied().filter(|k| self.tied[*k].is_none()).collect();
        let count = own + new.len();
        if count > M {
            let rule = format!("modes and masses with a spring or dashpot are {M} at most");
            return Err(Invalid::new("absorber.spring", number(count as f64), rule));
        }
        if coupled.is_empty() {
            return Ok(self);
        }
        let mut all = self.tied.clone();
        for (k, known) in all.iter_mut().enumerate() {
            let Some(known) = known else { continue };
            known.shape.resize(count, R::ZERO);
            known.tie = ties[k];
        }
        for (index, &k) in new.iter().enumerate() {
            let root = self.masses[k].mass_ratio.sqrt();
            let coordinate = own + index;
            let mut shape = self.whole.shape(self.at[k]).to_vec();
            shape.resize(count, R::ZERO);
            shape[coordinate] = -(R::ONE / root);
            let (grounded, row) = (false, None);
            all[k] = Some(Tied { tie: ties[k], shape, coordinate, root, grounded, row });
        }
        let of_all: Vec<&Tied<R>> = coupled.iter().filter_map(|k| all[*k].as_ref()).collect();
        let roots: Vec<R> = new.iter().filter_map(|k| Some(all[*k].as_ref()?.root)).collect();
        let whole = self.whole.with_masses(&of_all, &roots);
        let tied = Self { tied: all, whole: Arc::new(whole), ..self }.completed();
        tied.check_stops().map(|()| tied)
    }
}

impl<R: Real, const N: usize, const M: usize> Modal<UndrivenHost<R>, N, M> {
    /// The same members, of which some are the bodies of these names ([`ModalStructure::with_body`]). A body comes before what rides on it.
    ///
    /// # Errors
    /// [`Invalid`] for a name that no point has, for a point that is not a body of this mass or that the member rides on itself, and for names that are not as many as members.
    pub fn with_bodies(mut self, names: &[Option<&str>]) -> Result<Self, Invalid> {
        super::structure::same("absorber.point", names.len(), self.count())?;
        for (k, name) in names.iter().enumerate() {
            let Some(name) = name else { continue };
            let field = format!("absorber.{k}.point");
            let point = self.whole.point(&field, name)?;
            let own = self.whole.shape(point);
            let root = self.masses[k].mass_ratio.sqrt();
            let coordinate = own.iter().position(|phi| *phi != 0.0).unwrap_or(0);
            let alone = own.iter().filter(|phi| **phi != 0.0).count() == 1;
            if self.on_ground(k) || !alone || own[coordinate] != R::ONE / root {
                return Err(Invalid::new(
                    field,
                    *name,
                    "give a body that has the mass of this member",
                ));
            }
            if self.at[..=k].contains(&point) {
                let rule = "a body comes before what rides on it, and rides on another point";
                return Err(Invalid::new(field, *name, rule));
            }
            let both = self.shape(k).iter().zip(own);
            let shape = both.map(|(at, own)| *at - *own).collect();
            let (tie, grounded, row) = (Tie::NONE, false, Some(0));
            self.tied[k] = Some(Tied { tie, shape, coordinate, root, grounded, row });
        }
        let system = self.completed();
        system.check_stops().map(|()| system)
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// Number of modes that are the structure's own.
    pub(super) fn own_modes(&self) -> usize {
        self.structure.count()
    }

    /// G of each member with the weight of what rides on it, per mass.
    pub(super) fn weighed(&self) -> [R; N] {
        let mut weights = self.gravity;
        // What rides on a body comes after it.
        for k in (0..self.count()).rev() {
            let Some(body) = self.tied[k].as_ref().filter(|it| it.row.is_some()) else { continue };
            let on = |l: &usize| self.rides_on(*l, body);
            let riders = (k + 1..self.count()).filter(on);
            let of = |sum: R, l: usize| self.masses[l].mass_ratio.mul_add(weights[l], sum);
            let carried = riders.fold(R::ZERO, of);
            weights[k] +=
                if carried == 0.0 { carried } else { carried / self.masses[k].mass_ratio };
        }
        weights
    }

    /// True if a member rides on a body.
    pub(super) fn rides_on(&self, l: usize, body: &Tied<R>) -> bool {
        !body.grounded && self.shape(l)[body.coordinate] != 0.0
    }

    /// 1/μ, or 0 for a mass that is a coordinate of the structure.
    pub(super) fn lightness(&self, k: usize) -> DoubleDouble<R> {
        match &self.tied[k] {
            Some(_) => DoubleDouble::ZERO,
            None => DoubleDouble::new(R::ONE).over(self.masses[k].mass_ratio),
        }
    }

    /// √μ (u + y) and √μ (u̇ + w) of each tied mass, at their coordinates.
    pub(super) fn positions(
        &self,
        places: &mut [DoubleDouble<R>],
        of_gaps: impl Fn(usize) -> DoubleDouble<R>,
    ) {
        for (k, tied) in self.tied.iter().enumerate() {
            let Some(tied) = tied.as_ref().filter(|tied| !tied.grounded) else { continue };
            let both = places.iter().zip(self.shape(k));
            let u = both.fold(DoubleDouble::ZERO, |sum, (q, phi)| sum + q.times(*phi));
            places[tied.coordinate] = (u + of_gaps(k)).times(tied.root);
        }
    }

    /// Sets the coordinates of tied masses, if they rub, by their places in the gaps. Both are carried, each with its own rounding, and friction turns
    /// by the one what pulls by the other: what they differ by would grow from slide to slide.
    pub(super) fn align(&self, state: &mut ModalState<H, N, M>) {
        let rubs = |k: usize| self.friction[k] != 0.0 && self.tied[k].is_some();
        if !(0..self.count()).any(rubs) {
            return;
        }
        let ModalState { modes, places, .. } = state;
        let sided = |k: usize, it: DoubleDouble<R>| it.times(places[k].side);
        self.positions(&mut modes.places, |k| {
            let FreeMass { clearance, offset, .. } = self.masses[k];
            let within = places[k].distance.negated().plus(clearance);
            sided(k, within).plus(offset)
        });
        self.positions(&mut modes.velocities, |k| sided(k, places[k].rate).negated());
    }

    /// k y/μ: the acceleration by which its spring pulls a mass back, which has this place.
    pub(super) fn pulled(&self, k: usize, y: R) -> DoubleDouble<R> {
        let spring = self.tied[k].as_ref().map_or(R::ZERO, |tied| tied.tie.spring);
        DoubleDouble::new(spring).times(y).over(self.masses[k].mass_ratio)
    }
}

impl<R: Real> ModalStructure<R> {
    /// The structure of which these masses are coordinates, some of them new.
    fn with_masses(&self, tied: &[&Tied<R>], new: &[R]) -> Self {
        let count = self.count() + new.len();
        let mut damping = self.extended_damping(count);
        for Tied { tie, shape, .. } in tied {
            for (i, a) in shape.iter().enumerate() {
                for (j, b) in shape.iter().enumerate() {
                    damping[i * count + j] += tie.damping * (*a * *b);
                }
            }
        }
        let mut wider = self.extended(Damping::Full(damping), new);
        let springs = tied.iter().filter(|it| it.tie.spring != 0.0);
        wider.springs = springs.map(|it| (it.tie.spring, it.shape.clone())).collect();
        wider
    }
}
