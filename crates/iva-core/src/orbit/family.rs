//! The orbits of a family of scenes, as solutions of equations: those of the chain and, at special points, a condition.

use nalgebra::{DMatrix, DVector};

use super::chain::{Chain, Passed};
use super::conditions::Condition;
use super::continuation::{Equations, Sides};
use super::coordinates::Coordinates;
use super::episode::Lapse;
use crate::absorber::OnStructure;
use crate::error::Invalid;

/// The scene for values of the numbers that are changed: the absorber on its structure, and the length of a cycle of the
/// drive in 1/ωn.
pub type Scenes<'a, S> = &'a dyn Fn(&[f64]) -> Result<(S, f64), Invalid>;

/// Step of a difference, in scales: the equations need no exact derivative for an exact solution.
const DIFFERENCE: f64 = 1e-6;

/// A system, what its chain comes to or why it does not, and the length of a cycle.
type Tried<S> = (S, Result<Passed<<S as OnStructure>::State>, Lapse>, f64);

/// A family of scenes with one sequence of impacts. A point holds the unknowns of the chain, then the numbers that are
/// changed.
pub(super) struct Family<'a, S> {
    pub scenes: Scenes<'a, S>,
    pub chain: Chain,
    /// The scales of a point: sizes by which the unknowns and numbers change.
    pub scales: DVector<f64>,
}

impl<S: Coordinates> Family<'_, S> {
    /// The system at a point, what its chain comes to or why it does not, and the length of a cycle; `None` if the scene does
    /// not allow the numbers.
    fn tried(&self, point: &DVector<f64>, derivatives: bool) -> Option<Tried<S>> {
        let (unknowns, numbers) = point.as_slice().split_at(self.chain.unknowns());
        let (system, cycle) = (self.scenes)(numbers).ok()?;
        let length = self.chain.length(cycle);
        let passed = self.chain.passed(&system, length, unknowns, derivatives);
        Some((system, passed, cycle))
    }

    /// The system at a point, what its chain comes to, and the length of a cycle.
    pub fn passed(
        &self,
        point: &DVector<f64>,
        derivatives: bool,
    ) -> Option<(S, Passed<S::State>, f64)> {
        let (system, passed, cycle) = self.tried(point, derivatives)?;
        Some((system, passed.ok()?, cycle))
    }

    /// Why the chain has no motion at a point; `None` if it has one, or if the scene does not allow the numbers.
    pub fn lapse(&self, point: &DVector<f64>) -> Option<Lapse> {
        self.tried(point, false)?.1.err()
    }

    /// How long the rebounds of the episode last that begins with an impact, whether or not it ends in stick, and the
    /// restitution of low impacts at its wall; `None` where that is 1, so that the rebounds shrink by no fixed ratio.
    pub fn rebounds(&self, point: &DVector<f64>, impact: usize) -> Option<(Vec<f64>, f64)> {
        let (system, passed, _) = self.tried(point, false)?;
        let restitution = system.law_at(self.chain.wall(impact), 0.0).rebound;
        if restitution >= 1.0 {
            return None;
        }
        let rebounds = match passed {
            Ok(passed) => passed.episodes.into_iter().find(|it| it.impact == impact)?.rebounds,
            Err(Lapse::Leaves(left)) if left.impact == impact => left.rebounds,
            Err(_) => return None,
        };
        Some((rebounds, restitution))
    }

    /// The derivative of a function of the point with respect to one of its numbers, by a difference.
    fn difference(
        &self,
        point: &DVector<f64>,
        index: usize,
        of: &dyn Fn(&DVector<f64>) -> Option<DVector<f64>>,
    ) -> Option<DVector<f64>> {
        let by = DIFFERENCE * self.scales[index];
        let moved = |by: f64| {
            let mut moved = point.clone();
            moved[index] += by;
            Some((of(&moved)?, moved[index]))
        };
        match (moved(by), moved(-by)) {
            (Some((high, at_high)), Some((low, at_low))) => Some((high - low) / (at_high - at_low)),
            // At the end of what the scene allows.
            (Some((high, at)), None) => Some((high - of(point)?) / (at - point[index])),
            (None, Some((low, at))) => Some((low - of(point)?) / (at - point[index])),
            (None, None) => None,
        }
    }

    /// The number of a condition.
    pub fn condition(&self, point: &DVector<f64>, condition: Condition) -> Option<f64> {
        let (system, passed, cycle) = self.passed(point, false)?;
        condition.value(&system, &passed, cycle)
    }

    /// The equations of the chain, and a condition.
    pub fn with_condition(&self, point: &DVector<f64>, condition: Condition) -> Option<Sides> {
        let (sides, derivatives) = self.at(point)?;
        let rows = sides.len();
        let number = |at: &DVector<f64>| {
            self.condition(at, condition).map(|value| DVector::from_element(1, value))
        };
        let sides = sides.push(number(point)?[0]);
        let mut matrix = derivatives.insert_row(rows, 0.0);
        for column in 0..point.len() {
            matrix[(rows, column)] = self.difference(point, column, &number)?[0];
        }
        Some((sides, matrix))
    }
}

impl<S: Coordinates> Equations for Family<'_, S> {
    fn at(&self, point: &DVector<f64>) -> Option<Sides> {
        let (_, passed, _) = self.passed(point, true)?;
        let (size, count) = (self.chain.unknowns(), point.len());
        let mut derivatives = DMatrix::zeros(size, count);
        derivatives.columns_mut(0, size).copy_from(&passed.jacobian);
        let sides = |at: &DVector<f64>| Some(self.passed(at, false)?.1.residual);
        for index in size..count {
            let column = self.difference(point, index, &sides)?;
            derivatives.column_mut(index).copy_from(&column);
        }
        Some((passed.residual, derivatives))
    }
}

/// A family with a condition: the equations of a curve of special points in two numbers.
pub(super) struct Conditioned<'a, S> {
    pub family: &'a Family<'a, S>,
    pub condition: Condition,
}

impl<S: Coordinates> Equations for Conditioned<'_, S> {
    fn at(&self, point: &DVector<f64>) -> Option<Sides> {
        self.family.with_condition(point, self.condition)
    }
}
