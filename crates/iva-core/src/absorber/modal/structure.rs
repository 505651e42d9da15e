//! A structure by its modes: frequencies, damping, and mass-normalised shapes at named points.

use super::matrices::least_eigenvalue;
use super::{MOST_MODES, PRIMARY};
use crate::error::{Invalid, number};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;

/// What rounding may do to a matrix that was given in doubles, relative to its largest element.
const ROUNDED: f64 = 256.0 * f64::EPSILON;

/// A structure by its modes, in natural units.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalStructure<R = f64> {
    /// ωⱼ².
    pub(super) stiffness: Vec<DoubleDouble<R>>,
    pub(super) damping: Damping<R>,
    /// Springs between coordinates: k φφᵀ for each k and φ.
    pub(super) springs: Vec<(R, Vec<R>)>,
    /// Names and shapes.
    points: Vec<(String, Vec<R>)>,
    /// Γⱼ; `None` if the base does not move.
    participation: Option<Vec<R>>,
}

/// The damping matrix of the modes.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Damping<R> {
    /// 2ζⱼωⱼ.
    Separate(Vec<DoubleDouble<R>>),
    /// All elements, row by row.
    Full(Vec<R>),
}

impl<R: Real> ModalStructure<R> {
    /// A structure that moves as one, of damping ratio ζ, in its own units, with the single point [`PRIMARY`].
    ///
    /// # Errors
    /// [`Invalid`] for a damping ratio out of [`crate::range`].
    pub fn moving_as_one(damping_ratio: R) -> Result<Self, Invalid> {
        let one = [R::ONE];
        Self::new(&one, &[damping_ratio])?.with_point(PRIMARY, &one)?.with_base(&one)
    }

    /// Modes of frequencies ωⱼ ≥ 0 and damping ratios ζⱼ ≥ 0. One of frequency 0 is a motion that nothing holds or damps.
    ///
    /// # Errors
    /// [`Invalid`] naming the number that is out of [`crate::range`], and for no mode, more than [`MOST_MODES`], or not as
    /// many damping ratios as frequencies.
    pub fn new(frequencies: &[R], damping_ratios: &[R]) -> Result<Self, Invalid> {
        counted("structure.frequencies", frequencies.len())?;
        same("structure.damping_ratios", damping_ratios.len(), frequencies.len())?;
        for (j, (w, zeta)) in frequencies.iter().zip(damping_ratios).enumerate() {
            if *w != 0.0 {
                range::positive(&format!("structure.frequencies[{j}]"), *w)?;
            }
            range::damping_ratio(&format!("structure.damping_ratios[{j}]"), *zeta)?;
        }
        let stiffness = frequencies.iter().map(|w| DoubleDouble::new(*w).times(*w)).collect();
        let both = damping_ratios.iter().zip(frequencies);
        let rates = both.map(|(zeta, w)| DoubleDouble::new(*zeta * 2.0).times(*w)).collect();
        Ok(Self::of(stiffness, Damping::Separate(rates)))
    }

    pub(super) fn of(stiffness: Vec<DoubleDouble<R>>, damping: Damping<R>) -> Self {
        Self { stiffness, damping, springs: vec![], points: vec![], participation: None }
    }

    /// The same structure with a full damping matrix of its modes, row by row, in place of damping ratios.
    ///
    /// # Errors
    /// [`Invalid`] if it has not n² elements, is not symmetric, or feeds energy: if it has a negative eigenvalue.
    pub fn with_damping(mut self, matrix: &[R]) -> Result<Self, Invalid> {
        let n = self.count();
        same("structure.damping", matrix.len(), n * n)?;
        self.damping = Damping::Full(checked_damping("structure.damping", matrix, n)?);
        Ok(self)
    }

    /// The same structure with one more named point, where the modes have these shapes (mass-normalised).
    ///
    /// # Errors
    /// [`Invalid`] if there are not as many shapes as modes, one is out of [`crate::range`], or the name is taken.
    pub fn with_point(mut self, name: &str, shapes: &[R]) -> Result<Self, Invalid> {
        let field = format!("structure.points.{name}");
        same(&field, shapes.len(), self.count())?;
        for shape in shapes {
            range::size(&field, *shape)?;
        }
        if self.points.iter().any(|(other, _)| other == name) {
            return Err(Invalid::new(
                "structure.points",
                name,
                "give each point a name of its own",
            ));
        }
        self.points.push((name.to_owned(), shapes.to_vec()));
        Ok(self)
    }

    /// The same structure on a base that may move: Γⱼ = φⱼᵀ M r, where r is the displacement of the structure as the base
    /// moves by 1.
    ///
    /// The gaps of all masses lie along the motion of the base: each mass feels all of a_g.
    ///
    /// # Errors
    /// [`Invalid`] if there are not as many numbers as modes, or one is out of [`crate::range`].
    pub fn with_base(mut self, participation: &[R]) -> Result<Self, Invalid> {
        let field = "structure.participation";
        same(field, participation.len(), self.count())?;
        for part in participation {
            range::size(field, *part)?;
        }
        self.participation = Some(participation.to_vec());
        Ok(self)
    }

    /// The same structure with a body of this mass beside it that nothing holds, as a coordinate √m x of frequency 0 and as a point of this name. It may be one of the members
    /// ([`super::Modal::with_bodies`]), and others may ride on it.
    ///
    /// # Errors
    /// [`Invalid`] for a mass out of [`crate::range`], for more than [`MOST_MODES`] coordinates, and if the name is taken.
    pub fn with_body(&self, name: &str, mass: R) -> Result<Self, Invalid> {
        range::mass_ratio(&format!("structure.points.{name}"), mass)?;
        let count = self.count() + 1;
        counted("structure.frequencies", count)?;
        let damping = match &self.damping {
            Damping::Separate(rates) => {
                Damping::Separate([rates.as_slice(), &[DoubleDouble::ZERO]].concat())
            }
            Damping::Full(_) => Damping::Full(self.extended_damping(count)),
        };
        let root = mass.sqrt();
        let mut shape = vec![R::ZERO; count];
        shape[count - 1] = R::ONE / root;
        self.extended(damping, &[root]).with_point(name, &shape)
    }

    /// Number of modes.
    pub fn count(&self) -> usize {
        self.stiffness.len()
    }

    /// ωⱼ of a mode.
    pub fn frequency(&self, mode: usize) -> Option<R> {
        self.stiffness.get(mode).map(|square| square.value.sqrt())
    }

    /// ζⱼ of a mode: its own damping, without what it exchanges with others, over 2ωⱼ; 0 of one without any, also if its frequency is 0.
    pub fn damping_ratio(&self, mode: usize) -> Option<R> {
        let rate = match &self.damping {
            Damping::Separate(rates) => rates.get(mode)?.value,
            Damping::Full(matrix) => *matrix.get(mode * (self.count() + 1))?,
        };
        let critical = self.frequency(mode)? * 2.0;
        Some(if rate == 0.0 { rate } else { rate / critical })
    }

    /// True if it has one mode, of frequency 1 and shape 1 at all points, that takes all of the motion of its base: it moves as
    /// one, in its own units.
    pub fn moves_as_one(&self) -> bool {
        let whole = |shape: &[R]| shape.iter().all(|phi| *phi == 1.0);
        self.count() == 1
            && self.frequency(0).is_some_and(|frequency| frequency == 1.0)
            && self.points.iter().all(|(_, shape)| whole(shape))
            && self.participation().is_none_or(whole)
    }

    /// True if each mode has its own damping, and none exchanges energy with another in flight.
    pub fn is_separate(&self) -> bool {
        matches!(self.damping, Damping::Separate(_))
    }

    /// Names of the points.
    pub fn points(&self) -> impl Iterator<Item = &str> {
        self.points.iter().map(|(name, _)| name.as_str())
    }

    /// Γⱼ; `None` if the base does not move.
    pub fn participation(&self) -> Option<&[R]> {
        self.participation.as_deref()
    }

    /// The shapes at a named point.
    pub fn shapes(&self, point: &str) -> Option<&[R]> {
        self.points.iter().find(|(name, _)| name == point).map(|(_, shape)| shape.as_slice())
    }

    /// The index of a point.
    pub(super) fn point(&self, field: &str, name: &str) -> Result<usize, Invalid> {
        let found = self.points.iter().position(|(other, _)| other == name);
        found.ok_or_else(|| {
            let names: Vec<_> = self.points().collect();
            Invalid::new(field, name, format!("give one of the points {}", names.join(", ")))
        })
    }

    /// The shapes at the point of an index.
    pub(super) fn shape(&self, point: usize) -> &[R] {
        self.points.get(point).map_or(&[], |(_, shape)| shape.as_slice())
    }

    /// The damping matrix of so many coordinates, of which those after the modes have none.
    pub(super) fn extended_damping(&self, count: usize) -> Vec<R> {
        let n = self.count();
        let mut matrix = vec![R::ZERO; count * count];
        for j in 0..n {
            match &self.damping {
                Damping::Separate(rates) => matrix[j * (count + 1)] = rates[j].value,
                Damping::Full(full) => {
                    matrix[j * count..j * count + n].copy_from_slice(&full[j * n..(j + 1) * n]);
                }
            }
        }
        matrix
    }

    /// The same structure with further coordinates of frequency 0, which take part in the motion of its base as told, and this
    /// damping matrix of all.
    pub(super) fn extended(&self, damping: Damping<R>, participation: &[R]) -> Self {
        let mut wider = self.clone();
        let count = self.count() + participation.len();
        wider.stiffness.resize(count, DoubleDouble::ZERO);
        wider.damping = damping;
        wider.points.iter_mut().for_each(|(_, shape)| shape.resize(count, R::ZERO));
        if let Some(all) = &mut wider.participation {
            all.extend_from_slice(participation);
        }
        wider
    }

    /// φᵀ D φ of a shape.
    pub(super) fn damped(&self, shape: &[R]) -> R {
        let n = self.count();
        let of_row = |j: usize| match &self.damping {
            Damping::Separate(rates) => rates[j].value * shape[j],
            Damping::Full(matrix) => {
                let both = matrix[j * n..(j + 1) * n].iter().zip(shape);
                both.fold(R::ZERO, |sum, (element, phi)| sum + *element * *phi)
            }
        };
        (0..n).fold(R::ZERO, |sum, j| sum + of_row(j) * shape[j])
    }

    /// Λ: a bound on the factor by which each further derivative of a motion grows.
    pub(super) fn growth(&self) -> R {
        let own = self.stiffness.iter().fold(R::ZERO, |most, k| most.max(k.value));
        let stiffest = self.springs.iter().fold(own, |sum, (spring, shape)| {
            sum + *spring * shape.iter().fold(R::ZERO, |sum, phi| phi.mul_add(*phi, sum))
        });
        let n = self.count();
        let damped = match &self.damping {
            Damping::Separate(rates) => {
                rates.iter().fold(R::ZERO, |most, rate| most.max(rate.value))
            }
            // The largest sum of sizes in a row bounds all eigenvalues.
            Damping::Full(matrix) => matrix.chunks(n).fold(R::ZERO, |most, row| {
                most.max(row.iter().fold(R::ZERO, |sum, element| sum + element.abs()))
            }),
        };
        // A structure that is free to move, without damping, has no time scale of its own.
        let growth = damped * 0.5 + (damped * damped * 0.25 + stiffest).sqrt();
        if growth > 0.0 { growth } else { R::ONE }
    }
}

/// A damping matrix, made exactly symmetric.
pub(super) fn checked_damping<R: Real>(
    field: &str,
    matrix: &[R],
    n: usize,
) -> Result<Vec<R>, Invalid> {
    let symmetric = symmetrical(field, matrix, n)?;
    let most = symmetric.iter().fold(R::ZERO, |most, element| most.max(element.abs()));
    let least = least_eigenvalue(&symmetric, n);
    if least < -(most * ROUNDED) {
        let rule = "dampers feed no energy: give a matrix without negative eigenvalue; this is one";
        return Err(Invalid::new(field, number(least), rule));
    }
    Ok(symmetric)
}

/// A matrix that is symmetric to rounding, made exactly so.
pub(super) fn symmetrical<R: Real>(field: &str, matrix: &[R], n: usize) -> Result<Vec<R>, Invalid> {
    let most = matrix.iter().fold(R::ZERO, |most, element| most.max(element.abs()));
    if !most.is_finite() || matrix.iter().any(|element| element.is_nan()) {
        return Err(Invalid::new(field, "not finite", "give finite numbers"));
    }
    let mut even = matrix.to_vec();
    for i in 0..n {
        for j in 0..i {
            let [a, b] = [matrix[i * n + j], matrix[j * n + i]];
            if (a - b).abs() > most * ROUNDED {
                let rule = format!("give a symmetric matrix: [{j}][{i}] is {}", number(b));
                return Err(Invalid::new(format!("{field}[{i}][{j}]"), number(a), rule));
            }
            let mean = a.midpoint(b);
            (even[i * n + j], even[j * n + i]) = (mean, mean);
        }
    }
    Ok(even)
}

/// Checks a number of modes.
pub(super) fn counted(field: &str, count: usize) -> Result<(), Invalid> {
    if (1..=MOST_MODES).contains(&count) {
        return Ok(());
    }
    let rule = format!("give from 1 to {MOST_MODES} modes");
    Err(Invalid::new(field, number(count as f64), rule))
}

/// Checks that there are as many numbers as needed.
pub(super) fn same(field: &str, count: usize, needed: usize) -> Result<(), Invalid> {
    if count == needed {
        return Ok(());
    }
    let given = format!("{count} numbers");
    Err(Invalid::new(field, given, format!("give {needed}")))
}
