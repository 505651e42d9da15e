//! What happens at the special points of a branch, as conditions on one number that changes its sign there.

use nalgebra::{Complex, Matrix4, Matrix6};

use super::chain::Passed;
use super::coordinates::Coordinates;
use super::episode::{Episode, Lapse, Left};
use super::margins::{Extremum, extrema};
use crate::absorber::Wall;

/// Size of a multiplier's imaginary part from which a pair on the unit circle counts as complex, and how far it may be
/// off the circle.
const COMPLEX: f64 = 1e-6;
const ON_CIRCLE: f64 = 1e-6;

/// The kind of a special point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Multiplier 1: two orbits meet, and the branch turns back.
    Fold,
    /// Multiplier −1 of the half map of a symmetric orbit: two orbits that are mirror images of each other begin.
    Pitchfork,
    /// Multiplier −1: an orbit that takes twice as long begins.
    Flip,
    /// A pair of complex multipliers of size 1 (of the half map of a symmetric orbit): a torus begins.
    NeimarkSacker,
    /// The absorber touches a wall without speed between two impacts.
    Grazing,
    /// The speed of an impact goes to 0.
    ImpactVanishes,
    /// The time that the absorber sticks in an episode goes to 0: beyond, its chatter does not end.
    StickBegins,
    /// Two absorbers strike at one instant: beyond, they do so in the other order.
    ImpactsCoincide,
    /// A slide, or a time in which friction holds an absorber, begins or ends to be.
    SlideChanges,
}

impl Kind {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Fold => "fold",
            Kind::Pitchfork => "pitchfork",
            Kind::Flip => "flip",
            Kind::NeimarkSacker => "neimark_sacker",
            Kind::Grazing => "grazing",
            Kind::ImpactVanishes => "impact_vanishes",
            Kind::StickBegins => "stick_begins",
            Kind::ImpactsCoincide => "impacts_coincide",
            Kind::SlideChanges => "slide_changes",
        }
    }
}

/// The condition of a special point: the kind, and where in the chain it happens.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Condition {
    /// A fold.
    Fold,
    /// A pitchfork.
    Pitchfork,
    /// A flip.
    Flip,
    /// A Neimark–Sacker point.
    NeimarkSacker,
    /// A grazing of a wall in the flight after an impact of this index.
    Grazing {
        /// The flight.
        flight: usize,
        /// The wall.
        wall: Wall,
    },
    /// An impact of this index vanishes; that after the last one is the first of the next cycle.
    ImpactVanishes {
        /// The impact.
        impact: usize,
    },
    /// The stick of the episode that begins with an impact of this index begins or ends to be.
    StickBegins {
        /// The impact.
        impact: usize,
    },
    /// Two absorbers strike at one instant.
    ImpactsCoincide,
    /// A slide begins or ends to be.
    SlideChanges,
}

impl Condition {
    /// The kind of the point.
    pub fn kind(self) -> Kind {
        match self {
            Condition::Fold => Kind::Fold,
            Condition::Pitchfork => Kind::Pitchfork,
            Condition::Flip => Kind::Flip,
            Condition::NeimarkSacker => Kind::NeimarkSacker,
            Condition::Grazing { .. } => Kind::Grazing,
            Condition::ImpactVanishes { .. } => Kind::ImpactVanishes,
            Condition::StickBegins { .. } => Kind::StickBegins,
            Condition::ImpactsCoincide => Kind::ImpactsCoincide,
            Condition::SlideChanges => Kind::SlideChanges,
        }
    }

    /// The number that changes its sign there; `None` if there is no such extremum or impact. The duration of a stick only
    /// goes to 0.
    pub(super) fn value<S: Coordinates>(
        self,
        system: &S,
        passed: &Passed<S::State>,
        cycle: f64,
    ) -> Option<f64> {
        let [fold, other, pairs] = spectral(&passed.map, &passed.speeds);
        match self {
            Condition::Fold => Some(fold),
            Condition::Pitchfork | Condition::Flip => Some(other),
            Condition::NeimarkSacker => Some(pairs),
            Condition::Grazing { flight, wall } => {
                let all = extrema(system, &passed.flights, cycle);
                let here = all.iter().filter(|it| it.flight == flight && it.wall == wall);
                here.map(|it| it.margin).min_by(f64::total_cmp)
            }
            Condition::ImpactVanishes { impact } => {
                impact.checked_sub(1).and_then(|index| passed.speeds.get(index)).copied()
            }
            Condition::StickBegins { impact } => {
                passed.episodes.iter().find(|it| it.impact == impact).map(Episode::duration)
            }
            Condition::ImpactsCoincide | Condition::SlideChanges => None,
        }
    }
}

/// The numbers that vanish with a multiplier 1, with a multiplier −1, and with a product of two multipliers that is 1. At an
/// impact of approach speed w → 0 the derivative of the map grows as 1/w in one direction: the first two grow so, the third as
/// its cube. Multiplied by that, they are smooth there.
fn spectral(map: &Matrix4<f64>, speeds: &[f64]) -> [f64; 3] {
    let shifted = |by: f64| (map + Matrix4::identity() * by).determinant();
    let slow: f64 = speeds.iter().product();
    [shifted(-1.0) * slow, shifted(1.0) * slow, pairs(map) * slow.powi(3)]
}

/// True if a pair of complex multipliers is on the unit circle; two real ones whose product is 1 are no Neimark–Sacker
/// point.
pub(super) fn turns(multipliers: &[Complex<f64>]) -> bool {
    let mut complex = multipliers.iter().filter(|it| it.im > COMPLEX);
    complex.any(|it| (it.norm() - 1.0).abs() < ON_CIRCLE)
}

/// The product of λᵢ λⱼ − 1 over all pairs of eigenvalues: the determinant of the second compound matrix less 1.
fn pairs(matrix: &Matrix4<f64>) -> f64 {
    const PAIRS: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
    let compound = Matrix6::from_fn(|row, column| {
        let ([i, j], [k, l]) = (PAIRS[row], PAIRS[column]);
        matrix[(i, k)] * matrix[(j, l)] - matrix[(i, l)] * matrix[(j, k)]
    });
    (compound - Matrix6::identity()).determinant()
}

/// The numbers of all conditions at a point of a branch.
#[derive(Debug, Clone)]
pub(super) struct Tests {
    /// Of a fold; of a flip or, where the orbit is symmetric, of a pitchfork; of a Neimark–Sacker point.
    spectral: [f64; 3],
    /// The extrema between impacts, the one nearest to its wall first.
    extrema: Vec<Extremum>,
    /// The approach speeds of the impacts.
    speeds: Vec<f64>,
    /// The stick episodes.
    episodes: Vec<Episode>,
}

impl Tests {
    /// Those of a chain.
    pub fn new<S: Coordinates>(system: &S, passed: &Passed<S::State>, cycle: f64) -> Self {
        let mut extrema = extrema(system, &passed.flights, cycle);
        extrema.sort_by(|a, b| a.margin.total_cmp(&b.margin));
        let spectral = spectral(&passed.map, &passed.speeds);
        let (speeds, episodes) = (passed.speeds.clone(), passed.episodes.clone());
        Self { spectral, extrema, speeds, episodes }
    }

    /// The smallest margin of an extremum between impacts; infinite without one.
    pub fn margin(&self) -> f64 {
        self.extrema.first().map_or(f64::INFINITY, |nearest| nearest.margin)
    }

    /// The smallest approach speed.
    pub fn slowest(&self) -> f64 {
        self.speeds.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// True if the motion is one that a run would make: no impact without speed, and none left out.
    pub fn admissible(&self) -> bool {
        self.slowest() > 0.0 && self.margin() > 0.0
    }

    /// The condition by which an episode changes between this point and a neighbour, within its chatter: an impact begins or
    /// vanishes there at a grazing.
    pub fn changed(&self, other: &Self) -> Option<Condition> {
        let mut pairs = self.episodes.iter().zip(&other.episodes);
        let (here, _) = pairs.find(|(here, there)| !here.goes_over_into(there))?;
        Some(Condition::Grazing { flight: here.impact, wall: here.wall })
    }

    /// The condition beyond which an episode does not end in stick any more, where it has this lapse: a grazing of the other wall
    /// within the chatter, or the begin of the stick.
    pub fn lost(&self, lapse: &Lapse) -> Option<Condition> {
        let Lapse::Leaves(Left { impact, met, .. }) = *lapse else { return None };
        let here = self.episode(impact)?;
        let within = met.filter(|(time, _)| *time < here.stick);
        let begins = Condition::StickBegins { impact };
        Some(within.map_or(begins, |(_, wall)| Condition::Grazing { flight: impact, wall }))
    }

    /// The episode that begins with an impact.
    pub fn episode(&self, impact: usize) -> Option<&Episode> {
        self.episodes.iter().find(|it| it.impact == impact)
    }

    /// True if there is an extremum in the flight after an impact that turns back from a wall.
    pub fn turns_back(&self, flight: usize, wall: Wall) -> bool {
        self.extrema.iter().any(|it| it.flight == flight && it.wall == wall)
    }

    /// The conditions that are met between this point and a later one of the same branch.
    pub fn met(&self, later: &Self, symmetric: bool) -> Vec<Condition> {
        let other = if symmetric { Condition::Pitchfork } else { Condition::Flip };
        let all = [Condition::Fold, other, Condition::NeimarkSacker];
        let pairs = self.spectral.into_iter().zip(later.spectral);
        all.into_iter().zip(pairs).filter(|(_, (a, b))| a * b < 0.0).map(|(it, _)| it).collect()
    }

    /// The conditions by which this point is not admissible.
    pub fn broken(&self) -> Vec<Condition> {
        let speeds = self.speeds.iter().zip(1..);
        let stopped = speeds.filter(|(speed, _)| **speed <= 0.0);
        let vanishing = stopped.map(|(_, impact)| Condition::ImpactVanishes { impact });
        let beyond = self.extrema.iter().filter(|it| it.margin <= 0.0);
        let grazing =
            beyond.map(|&Extremum { flight, wall, .. }| Condition::Grazing { flight, wall });
        vanishing.chain(grazing).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a diagonal matrix the product is known: here (λᵢ λⱼ − 1) over the pairs of 2, .5, 3 and −1.
    #[test]
    fn the_compound_matrix_has_the_products_of_pairs() {
        let numbers: [f64; 4] = [2.0, 0.25, 3.0, -1.0];
        let turn = Matrix4::new(
            1.0, 0.4, 0.2, 0.1, 0.0, 1.0, 0.3, -0.6, 0.5, 0.0, 1.0, 0.2, 0.1, -0.3, 0.0, 1.0,
        );
        let inverse = turn.try_inverse().map_or(Matrix4::zeros(), |inverse| inverse);
        let matrix = turn * Matrix4::from_diagonal(&numbers.into()) * inverse;
        let mut truth = 1.0;
        for i in 0..4 {
            for j in 0..i {
                truth *= numbers[i] * numbers[j] - 1.0;
            }
        }
        assert!((pairs(&matrix) - truth).abs() < 1e-11 * truth.abs());
    }
}
