//! Integrals along the spans of all lanes: the quadrature of [`crate::host`], lane by lane in every operation.

use super::lane::{Lanes, Single};
use crate::compensated::DoubleDouble;
use crate::host::driven::integral::{COUNT, node, sum_of, weight};
use crate::host::{Course, Driven, HostState, Moment};
use crate::lanes::pick;
use crate::taylor::{ORDER, unrolled};

/// A series of each lane.
type Series<const W: usize> = [[f64; W]; ORDER + 1];

/// The series of the spans that are behind.
#[derive(Debug)]
#[repr(align(64))]
pub(super) struct Integrals<const W: usize> {
    place: Series<W>,
    velocity: Series<W>,
    force: Series<W>,
    /// Lengths, and what powers of time are taken in.
    length: [f64; W],
    step: [f64; W],
    /// 1 if the span is behind, and if it counts.
    pub done: [f64; W],
    pub counts: [f64; W],
}

impl<const W: usize> Integrals<W> {
    pub fn new() -> Self {
        let series = [[0.0; W]; ORDER + 1];
        let [length, step, done, counts] = [[0.0; W]; 4];
        Self { place: series, velocity: series, force: series, length, step, done, counts }
    }

    /// Takes in the motion of a lane.
    #[inline(always)]
    pub fn take(
        &mut self,
        i: usize,
        free: &Driven<Single>,
        from: &HostState<Moment>,
        course: &Course,
        [length, step]: [f64; 2],
    ) {
        let place = free.place(from, course);
        let velocity = free.derivative(&place);
        unrolled!(k < ORDER + 1 => {
            self.place[k][i] = place[k];
            self.velocity[k][i] = velocity[k];
            self.force[k][i] = course.pushed[k];
        });
        (self.length[i], self.step[i]) = (length, step);
    }

    /// Losses and work.
    #[inline(always)]
    pub fn lose(&mut self, lanes: &mut Lanes<W>) {
        let mut squares = [[0.0; W]; COUNT];
        let mut works = [[0.0; W]; COUNT];
        for n in 0..COUNT {
            let velocity = self.at(&self.velocity, n);
            let force = self.at(&self.force, n);
            for i in 0..W {
                squares[n][i] = weight::<f64>(n) * (velocity[i] * velocity[i]);
                works[n][i] = weight::<f64>(n) * (force[i] * velocity[i]);
            }
        }
        let [square, work] = [sums_of(&squares), sums_of(&works)];
        for i in 0..W {
            let done = self.done[i] > 0.0;
            let lost = lanes.damping[i] * square[i] * self.length[i];
            let viscous =
                DoubleDouble { value: lanes.viscous[i], rest: lanes.viscous_rest[i] }.plus(lost);
            let worked = DoubleDouble { value: lanes.worked[i], rest: lanes.worked_rest[i] }
                .plus(work[i] * self.length[i]);
            lanes.viscous[i] = pick(done, viscous.value, lanes.viscous[i]);
            lanes.viscous_rest[i] = pick(done, viscous.rest, lanes.viscous_rest[i]);
            lanes.worked[i] = pick(done, worked.value, lanes.worked[i]);
            lanes.worked_rest[i] = pick(done, worked.rest, lanes.worked_rest[i]);
        }
    }

    /// ∫x².
    #[inline(always)]
    pub fn square(&mut self, lanes: &mut Lanes<W>) {
        let mut squares = [[0.0; W]; COUNT];
        for (n, squares) in squares.iter_mut().enumerate() {
            let place = self.at(&self.place, n);
            for i in 0..W {
                squares[i] = weight::<f64>(n) * (place[i] * place[i]);
            }
        }
        let square = sums_of(&squares);
        for i in 0..W {
            let counts = self.counts[i] > 0.0;
            let square = square[i] * self.length[i];
            let sum =
                DoubleDouble { value: lanes.square[i], rest: lanes.square_rest[i] }.plus(square);
            lanes.square[i] = pick(counts, sum.value, lanes.square[i]);
            lanes.square_rest[i] = pick(counts, sum.rest, lanes.square_rest[i]);
        }
    }

    /// A series at a node.
    #[inline(always)]
    fn at(&self, series: &Series<W>, n: usize) -> [f64; W] {
        let t: [f64; W] = std::array::from_fn(|i| node(n, [0.0, self.length[i] / self.step[i]]));
        let mut values: [f64; W] = [0.0; W];
        for k in (0..=ORDER).rev() {
            for i in 0..W {
                values[i] = values[i].mul_add(t[i], series[k][i]);
            }
        }
        values
    }
}

/// The sums over all nodes.
#[inline(always)]
fn sums_of<const W: usize>(terms: &[[f64; W]; COUNT]) -> [f64; W] {
    std::array::from_fn(|i| sum_of(&std::array::from_fn(|n| terms[n][i])))
}
