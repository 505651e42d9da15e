//! Where branches begin on others: orbits that are their own mirror images, or the same run twice.

use nalgebra::DVector;

use super::super::super::Trajectory;
use super::super::super::conditions::Condition;
use super::super::super::continuation::{Equations, OnCurve, kernel};
use super::super::super::coordinates::Coordinates;
use super::super::super::periodic::flown;
use super::super::BranchPoint;
use super::{Shooting, Stop};

/// The halves of an orbit are alike where they differ by less, over the size of the state.
const ALIKE: f64 = 1e-5;
/// First steps away from a point that are tried, in scales.
const TRIED: [f64; 5] = [1e-2, 3e-3, 3e-2, 1e-3, 1e-4];

impl<S: Coordinates + Clone> Shooting<'_, S> {
    /// The condition of the orbit that a branch begins on, where its own turns back and is that orbit: its own mirror image
    /// half a cycle later or, where it takes an even number of cycles of the drive, the same half its time later.
    pub fn origin(&self, at: &BranchPoint) -> Option<Condition> {
        let even = self.cycles.is_multiple_of(2);
        let (sign, condition) =
            if even { (1.0, Condition::Flip) } else { (-1.0, Condition::Pitchfork) };
        let point = DVector::from_column_slice(&at.unknowns[1..]);
        let Trajectory { system, state, cycle, .. } =
            self.trajectory(&point.clone().push(at.value))?;
        let half =
            flown(&system, (&state, cycle.begin), 0.5 * cycle.length, self.along.cancel).ok()?;
        let size = point.amax().max(system.clearance());
        let alike = (system.point(&half.end) * sign - point).amax() < ALIKE * size;
        (alike && !self.symmetric).then_some(condition)
    }

    /// The family of the branch that begins at a special point, in a direction in which the number that is changed does not
    /// change.
    pub fn parted(&self, condition: Condition) -> Option<Self> {
        match condition {
            Condition::Pitchfork if self.symmetric => {
                Some(Self { symmetric: false, ..self.clone() })
            }
            Condition::Flip if !self.symmetric => {
                Some(Self { cycles: 2 * self.cycles, share: 0.5 * self.share, ..self.clone() })
            }
            _ => None,
        }
    }

    /// The family of the branch that one begins on whose orbit at a point has two halves that are alike.
    pub fn begun(&self, at: &BranchPoint) -> Option<Self> {
        match self.origin(at)? {
            Condition::Pitchfork => Some(Self { symmetric: true, ..self.clone() }),
            _ => Some(Self {
                cycles: self.cycles / 2,
                share: (2.0 * self.share).fract(),
                ..self.clone()
            }),
        }
    }

    /// The first point of the branch that begins at a point.
    pub fn ahead(&self, point: &DVector<f64>) -> Option<Stop> {
        let number = self.size;
        let (_, derivatives) = self.at(point)?;
        let (columns, scales) =
            (derivatives.columns(0, number).into_owned(), self.scales.rows(0, number));
        let tangent = kernel(&columns, &scales.into_owned())?.push(0.0);
        for step in TRIED {
            for tangent in [tangent.clone(), -&tangent] {
                let begin = OnCurve { point: point.clone(), tangent };
                let Some(next) = self.curve().next(&begin, step) else { continue };
                let moved = (&next.point - point).component_div(&self.scales);
                let forwards = moved.dot(&begin.tangent) > 0.5 * step && moved.norm() < 4.0 * step;
                if let Some(stop) = self.stop(next, step).filter(|_| forwards) {
                    return Some(stop);
                }
            }
        }
        None
    }
}
