//! Latin hypercubes: M. D. McKay, R. J. Beckman and W. J. Conover, A comparison of three methods
//! for selecting values of input variables in the analysis of output from a computer code,
//! Technometrics 21 (1979) 239-245.

use super::philox::{Stream, Use};

/// A Latin hypercube: a random permutation of the cells of each axis, with a random position in each cell.
#[derive(Debug, Clone)]
pub(super) struct LatinHypercube {
    axes: Vec<Axis>,
    count: u32,
}

#[derive(Debug, Clone)]
struct Axis {
    /// The cell of each point.
    cells: Vec<u32>,
    places: Stream,
}

impl LatinHypercube {
    /// `count` points, from 1 to 2²⁴.
    pub(super) fn new(count: u32, seed: u64, axes: usize) -> Self {
        let axes = (0..axes)
            .map(|axis| Axis {
                cells: shuffled(count, Stream::new(seed, axis, Use::Shuffle)),
                places: Stream::new(seed, axis, Use::Coordinates),
            })
            .collect();
        Self { axes, count }
    }

    /// A coordinate, in (0, 1); NaN for a point or an axis outside the sample.
    pub(super) fn coordinate(&self, point: usize, axis: usize) -> f64 {
        let Some(Axis { cells, places }) = self.axes.get(axis) else { return f64::NAN };
        cells.get(point).map_or(f64::NAN, |cell| self.within(*cell, places.word(point as u64)))
    }

    /// A random position in a cell: an odd multiple of 2⁻ᵇ of its width, with the largest b for which it
    /// differs from both edges of the cell in double precision.
    fn within(&self, cell: u32, word: u64) -> f64 {
        let bits = 19 + self.count.leading_zeros();
        let place = (word >> (64 - bits)) | 1;
        let steps = (u64::from(cell) << bits) | place;
        steps as f64 / (u64::from(self.count) << bits) as f64
    }
}

/// A random permutation of 0..count: R. Durstenfeld, Algorithm 235: Random permutation, Comm. ACM 7
/// (1964) 420.
fn shuffled(count: u32, random: Stream) -> Vec<u32> {
    let mut cells: Vec<u32> = (0..count).collect();
    for (last, word) in (1..cells.len()).rev().zip(random.words()) {
        cells.swap(last, below(last as u64 + 1, word));
    }
    cells
}

/// A random index below a bound. The numbers of words, out of 2⁶⁴, for two indices differ by at most one, so
/// that for 2²⁴ indices the relative error of a probability is at most 2⁻⁴⁰.
fn below(bound: u64, word: u64) -> usize {
    ((u128::from(word) * u128::from(bound)) >> 64) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_of_every_axis_has_one_point() {
        for count in [1, 2, 3, 10, 1000, 65_536, 1_000_003] {
            let latin = LatinHypercube::new(count, 42, 3);
            for axis in 0..3 {
                let mut taken = vec![false; count as usize];
                for point in 0..count as usize {
                    let x = latin.coordinate(point, axis);
                    assert!(x > 0.0 && x < 1.0, "{x}");
                    let cell = &mut taken[(x * f64::from(count)) as usize];
                    assert!(
                        !std::mem::replace(cell, true),
                        "{count} points: {x} twice in its cell"
                    );
                }
            }
        }
    }

    #[test]
    fn the_outermost_places_stay_in_their_cells() {
        for count in [1, 7, 4096, 9_999_991, 10_000_000, (1 << 24) - 1, 1 << 24] {
            let latin = LatinHypercube { axes: Vec::new(), count };
            for cell in [0, count / 3, count / 2, count - 1] {
                for word in [0, u64::MAX] {
                    let x = latin.within(cell, word);
                    assert_eq!((x * f64::from(count)) as u32, cell, "{x} of {count}");
                    assert!(x > 0.0 && x < 1.0, "{x} of {count}");
                }
            }
        }
    }

    /// χ² over the 24 permutations of four cells, for 24 000 seeds: with 23 degrees of freedom it exceeds 60
    /// once in 30 000 sequences of random numbers.
    #[test]
    fn all_permutations_are_equally_likely() {
        let mut found = std::collections::HashMap::new();
        for seed in 0..24_000 {
            *found.entry(shuffled(4, Stream::new(seed, 0, Use::Shuffle))).or_insert(0.0) += 1.0;
        }
        assert_eq!(found.len(), 24);
        let square: f64 = found.values().map(|n: &f64| (n - 1000.0).powi(2) / 1000.0).sum();
        assert!(square < 60.0, "χ² = {square}");
    }

    #[test]
    fn axes_and_seeds_differ() {
        let [a, b] = [1, 2].map(|seed| LatinHypercube::new(100, seed, 2));
        let row = |latin: &LatinHypercube, axis| -> Vec<f64> {
            (0..100).map(|point| latin.coordinate(point, axis)).collect()
        };
        assert_ne!(row(&a, 0), row(&a, 1));
        assert_ne!(row(&a, 0), row(&b, 0));
    }
}
