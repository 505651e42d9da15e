//! Curves of special points over two numbers, of orbits without a chain.

use nalgebra::{Complex, DMatrix, DVector};

use super::super::super::conditions::{Condition, turns};
use super::super::super::continuation::{Equations, OnCurve, Sides};
use super::super::super::coordinates::Coordinates;
use super::super::super::curve::{AlongCurve, Special, SpecialCurve, through};
use super::super::super::family::Scenes;
use super::super::super::multipliers::multipliers;
use super::super::{Along, End, SpecialPoint};
use super::events::Sequence;
use super::{DIFFERENCE, Shooting, pairs};

/// What a number is smaller than, over its scale, just beyond the end of a curve that it is the reason of.
const SMALL: f64 = 1e-4;

/// The orbits of a family of one sequence of events at a special point.
struct Conditioned<'a, S> {
    family: Shooting<'a, S>,
    condition: Condition,
    sequence: Sequence,
}

impl<S: Coordinates + Clone> Conditioned<'_, S> {
    /// The derivative of the map at a point.
    fn derivative(&self, at: &DVector<f64>) -> Option<DMatrix<f64>> {
        let size = self.family.size;
        Some(self.family.sides(at)?.0.1 + DMatrix::identity(size, size))
    }

    /// What vanishes at the condition.
    fn test(&self, at: &DVector<f64>) -> Option<f64> {
        let map = self.derivative(at)?;
        let one = DMatrix::identity(self.family.size, self.family.size);
        match self.condition {
            Condition::Fold => Some((map - one).determinant()),
            Condition::Pitchfork | Condition::Flip => Some((map + one).determinant()),
            Condition::NeimarkSacker => Some(pairs(&multipliers(&map))),
            _ => None,
        }
    }
}

impl<S: Coordinates + Clone> Equations for Conditioned<'_, S> {
    fn at(&self, point: &DVector<f64>) -> Option<Sides> {
        let (sides, derivatives) = self.family.at(point)?;
        let rows = sides.len();
        let sides = sides.push(self.test(point)?);
        let mut all = derivatives.insert_row(rows, 0.0);
        for column in 0..point.len() {
            let by = DIFFERENCE * self.family.scales[column];
            let [mut above, mut below] = [point.clone(), point.clone()];
            above[column] += by;
            below[column] -= by;
            let difference = self.test(&above)? - self.test(&below)?;
            all[(rows, column)] = difference / (above[column] - below[column]);
        }
        Some((sides, all))
    }
}

impl<S: Coordinates + Clone> Special for Conditioned<'_, S> {
    fn scales(&self) -> &DVector<f64> {
        &self.family.scales
    }

    fn multipliers(&self, at: &DVector<f64>) -> Option<Vec<Complex<f64>>> {
        let map = self.derivative(at)?;
        Some(multipliers(&if self.family.symmetric { &map * &map } else { map }))
    }

    fn unknowns(&self, at: &DVector<f64>) -> Vec<f64> {
        self.family.unknowns(at)
    }

    fn broken(&self, at: &DVector<f64>) -> Option<End> {
        let on = OnCurve { point: at.clone(), tangent: DVector::zeros(at.len()) };
        let stop = self.family.stop(on, 0.0)?;
        let own = stop.at.half_multipliers.as_ref().unwrap_or(&stop.at.multipliers);
        if self.condition == Condition::NeimarkSacker && !turns(own) {
            return Some(End::Resonance);
        }
        let (small, why) = stop.next;
        let other = stop.sequence != self.sequence;
        other.then(|| if small < SMALL { End::at(why) } else { End::Stalled })
    }
}

/// Follows the curve of a special point over two numbers, of which it has these values; its branch has this shape (symmetric or
/// not, cycles of the drive). `None` for points at which the sequence of events changes, and if the special point is not one
/// of these scenes.
pub fn curve<S: Coordinates + Clone>(
    scenes: Scenes<'_, S>,
    shape: (bool, u32),
    SpecialPoint { condition, at }: &SpecialPoint,
    values: [f64; 2],
    along: AlongCurve<'_>,
) -> Option<SpecialCurve> {
    let (share, numbers) = at.unknowns.split_first()?;
    let numbers = DVector::from_column_slice(numbers);
    let [first, second] = along.between;
    let one = Along { cancel: along.cancel, ..Along::new(first) };
    let fixed = |value: &[f64]| scenes(&[value[0], values[1]]);
    let scales = Shooting::new(&fixed, shape, (*share, &numbers), one)?.scales;
    let family = Shooting {
        scenes,
        symmetric: shape.0,
        cycles: shape.1,
        share: *share,
        size: numbers.len(),
        scales: scales.push(second[1] - second[0]),
        along: one,
    };
    let point = numbers.push(values[0]).push(values[1]);
    let on = OnCurve { point: point.clone(), tangent: DVector::zeros(point.len()) };
    let sequence = family.stop(on, 0.0)?.sequence;
    let special = Conditioned { family, condition: *condition, sequence };
    through(&special, *condition, &point, along)
}
