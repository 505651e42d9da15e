//! Integrals along the flights of a log: the quadrature of [`crate::host`], for all flights of a block at
//! once.

use super::answers::{Block, Series};
use super::lane::Single;
use super::log::{BLOCK, Flights};
use crate::host::Driven;
use crate::host::driven::integral::{COUNT, node, sum_of, weight};
use crate::taylor::{ORDER, unrolled};

impl Block {
    /// Energy lost in the damper, and work.
    #[inline(always)]
    pub fn lose<const BASE: bool>(
        &self,
        free: &Driven<Single<BASE>>,
        mass_ratio: f64,
        flights: &Flights<BLOCK>,
    ) -> [[f64; BLOCK]; 2] {
        let free = free.clone();
        let t = parts(&free, flights);
        let velocity = derivatives::<BASE, 1>(&free, &self.place);
        let (gained, base) = match BASE {
            true => (
                derivatives::<BASE, 1>(&free, &self.pulled),
                derivatives::<BASE, 2>(&free, &self.carried),
            ),
            false => ([[0.0; BLOCK]; ORDER + 1], [[0.0; BLOCK]; ORDER + 1]),
        };
        let [mut squares, mut works, mut carried] = [[[0.0; BLOCK]; COUNT]; 3];
        for n in 0..COUNT {
            let velocity = at(&velocity, n, &t);
            for i in 0..BLOCK {
                squares[n][i] = weight::<f64>(n) * (velocity[i] * velocity[i]);
            }
            if BASE {
                let (gained, base) = (at(&gained, n, &t), at(&base, n, &t));
                for i in 0..BLOCK {
                    let absorber = -flights.side[i] * flights.rate[i] - gained[i];
                    let momentum = velocity[i] + mass_ratio * (velocity[i] + absorber);
                    carried[n][i] = weight::<f64>(n) * (base[i] * momentum);
                }
            } else {
                let force = at(&self.pushed, n, &t);
                for i in 0..BLOCK {
                    works[n][i] = weight::<f64>(n) * (force[i] * velocity[i]);
                }
            }
        }
        let [mut square, mut work, carried] = [&squares, &works, &carried].map(sums_of);
        for i in 0..BLOCK {
            square[i] = free.equation.damping * square[i] * flights.length[i];
            work[i] = if BASE { work[i] - carried[i] } else { work[i] };
            work[i] *= flights.length[i];
        }
        [square, work]
    }

    /// ∫x².
    #[inline(always)]
    pub fn square<const BASE: bool>(
        &self,
        free: &Driven<Single<BASE>>,
        flights: &Flights<BLOCK>,
    ) -> [f64; BLOCK] {
        let t = parts(free, flights);
        let mut squares = [[0.0; BLOCK]; COUNT];
        for (n, squares) in squares.iter_mut().enumerate() {
            let place = at(&self.place, n, &t);
            for i in 0..BLOCK {
                squares[i] = weight::<f64>(n) * (place[i] * place[i]);
            }
        }
        let square = sums_of(&squares);
        std::array::from_fn(|i| square[i] * flights.length[i])
    }
}

/// The Nth derivatives of series, N = 1 or 2.
#[inline(always)]
fn derivatives<const BASE: bool, const N: usize>(
    free: &Driven<Single<BASE>>,
    series: &Series,
) -> Series {
    let mut derivatives = [[0.0; BLOCK]; ORDER + 1];
    for i in 0..BLOCK {
        let mut row = [0.0; ORDER + 1];
        unrolled!(k < ORDER + 1 => {
            row[k] = series[k][i];
        });
        row = free.derivative(&row);
        if N == 2 {
            row = free.derivative(&row);
        }
        unrolled!(k < ORDER + 1 => {
            derivatives[k][i] = row[k];
        });
    }
    derivatives
}

/// The lengths of the flights in units of the step of the series.
#[inline(always)]
fn parts<const BASE: bool>(free: &Driven<Single<BASE>>, flights: &Flights<BLOCK>) -> [f64; BLOCK] {
    std::array::from_fn(|i| flights.length[i] / free.step)
}

/// The values of a series at node n of each flight.
#[inline(always)]
fn at(series: &Series, n: usize, t: &[f64; BLOCK]) -> [f64; BLOCK] {
    let t: [f64; BLOCK] = std::array::from_fn(|i| node(n, [0.0, t[i]]));
    let mut values = [0.0; BLOCK];
    for k in (0..=ORDER).rev() {
        for i in 0..BLOCK {
            values[i] = f64::mul_add(values[i], t[i], series[k][i]);
        }
    }
    values
}

/// The sum over all nodes for each flight.
#[inline(always)]
fn sums_of(terms: &[[f64; BLOCK]; COUNT]) -> [f64; BLOCK] {
    std::array::from_fn(|i| sum_of(&std::array::from_fn(|n| terms[n][i])))
}
