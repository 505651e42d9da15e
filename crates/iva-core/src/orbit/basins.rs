//! Basins of attraction: which attractor each of many starts ends in.
//!
//! A start is decided as soon as its trajectory is in the neighbourhood of an orbit, which has been tried
//! ([`neighbourhoods`](super::neighbourhood::neighbourhoods)). On the way the rounding errors of each cycle are carried
//! by the exact derivatives, P → Φ P Φᵀ + Q: where they grow so much that another path may have been taken, the start is
//! not sure.

use std::ops::ControlFlow::{self, Break, Continue};
use std::sync::atomic::AtomicBool;

use nalgebra::DMatrix;

use super::coordinates::Strobe;
use super::neighbourhood::Neighbourhood;
use super::{Image, Iterated, Request, Trajectory, iterate};
use crate::absorber::derivatives::maps::{by_matrix, carry_covariance};
use crate::engine::simulate::Outcome;
use crate::error::Invalid;

/// The largest rounding error on the way, over the size of the state, with which a start is sure.
const SURE: f64 = 1e-7;
/// The rounding error of a cycle, over the size of the state.
const ROUNDING: f64 = f64::EPSILON;
/// Strobes whose distance over the size of the state is at most this repeat.
const REPEATS: f64 = 1e-9;

/// Where a start ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// In the attractor with this index.
    Attractor(usize),
    /// In a motion without impacts.
    NoImpacts,
    /// In none of these so far: the cycles are used up ([`Outcome::Finished`]), or one of them did not end.
    Open(Outcome),
}

/// A start, decided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Where it ends.
    pub ending: Ending,
    /// Number of cycles until that was known.
    pub cycles: u64,
    /// The largest rounding error on the way, estimated, over the size of the state.
    pub error: f64,
}

impl Cell {
    /// The attractor; `None` if there is none, or if rounding errors may have decided.
    pub fn label(&self) -> Option<usize> {
        match self.ending {
            Ending::Attractor(index) if self.is_sure() => Some(index),
            _ => None,
        }
    }

    /// False if rounding errors have grown so much that they may have decided.
    pub fn is_sure(&self) -> bool {
        self.error <= SURE
    }
}

/// A start on its way.
struct Way<T> {
    last: T,
    /// The covariance of the rounding errors, over the square of the size of the state.
    covariance: DMatrix<f64>,
    cell: Cell,
}

impl<T: Strobe> Way<T> {
    /// Of a state of so many numbers.
    fn new(count: usize) -> Self {
        let cell = Cell { ending: Ending::Open(Outcome::Cancelled), cycles: 0, error: 0.0 };
        let round = DMatrix::from_diagonal_element(count, count, ROUNDING * ROUNDING);
        Self { last: T::none(), covariance: round, cell }
    }

    /// Goes on to the next strobe; true if it decides.
    fn ends<S: Iterated<Strobe = T>>(
        &mut self,
        system: &S,
        image: &Image<S::State>,
        (neighbourhoods, most_cycles): (&[Neighbourhood], u64),
    ) -> bool {
        let cell = &mut self.cell;
        cell.cycles += 1;
        cell.ending = Ending::Open(image.outcome);
        let (Outcome::Finished, Some(tangent)) = (image.outcome, &image.tangent) else {
            return true;
        };
        carry_covariance(&mut self.covariance, &mut by_matrix(&tangent.matrix));
        for i in 0..self.covariance.ncols() {
            self.covariance[(i, i)] += ROUNDING * ROUNDING;
        }
        cell.error = cell.error.max(self.covariance.trace().sqrt());
        let at = system.strobe(&image.state);
        if let Some(near) = neighbourhoods.iter().find(|it| it.holds(at.numbers())) {
            cell.ending = Ending::Attractor(near.attractor);
            return true;
        }
        if image.impacts == 0 {
            let size = system.clearance().max(at.size());
            if self.last.apart(&at) <= REPEATS * size {
                cell.ending = Ending::NoImpacts;
                return true;
            }
        }
        self.last = at;
        cell.cycles >= most_cycles
    }
}

/// Where trajectories of one scene end, which go side by side; `neighbourhoods` are those of its attractors. Trajectories may be divided
/// among several calls in any way.
///
/// # Errors
/// [`Invalid`] if a cycle has no length or begins before time zero.
pub fn basins<S: Iterated>(
    trajectories: &[Trajectory<S>],
    neighbourhoods: &[Neighbourhood],
    most_cycles: u64,
    cancel: Option<&AtomicBool>,
) -> Result<Vec<Cell>, Invalid> {
    let count = trajectories.first().map_or(0, |it| it.system.point(&it.state).len());
    let mut ways: Vec<Way<S::Strobe>> = trajectories.iter().map(|_| Way::new(count)).collect();
    let request = Request { tangents: true, cancel };
    let mut see = |index: usize, image: &Image<S::State>| -> ControlFlow<()> {
        let system = &trajectories[index].system;
        let ends = ways[index].ends(system, image, (neighbourhoods, most_cycles));
        if ends { Break(()) } else { Continue(()) }
    };
    iterate(trajectories, request, &mut see)?;
    Ok(ways.into_iter().map(|way| way.cell).collect())
}
