//! Samples of parameters: [`Cube`] places points in the unit cube, and [`Distribution`] maps each coordinate
//! to a value of its parameter.
//!
//! The numbers depend on method, number of points (Latin hypercubes only), seed and axis only, on every
//! platform. A version must not change them, because studies name a seed.

mod distribution;
mod latin;
mod normal;
mod philox;
mod sobol;

pub use distribution::{Distribution, Unfit};
pub use sobol::MOST_AXES as MOST_SOBOL_AXES;

use latin::LatinHypercube;
use philox::{Stream, Use};
use sobol::Sobol;

/// Largest number of points of a sample.
pub const MOST_POINTS: u64 = 1 << 32;
/// Largest number of points of a Latin hypercube, whose permutations then take 40 MB per axis.
pub const MOST_LATIN_POINTS: u64 = 10_000_000;

/// The method by which the points of a sample are placed in the unit cube.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Sobol' points, in the order of Antonov and Saleev: the first 2ᵐ points are evenly spread for any m,
    /// also in their projections on few axes.
    Sobol,
    /// One point in each of `count` equal slices of every axis.
    LatinHypercube,
    /// Independent uniform points.
    Random,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 3] = [Self::Sobol, Self::LatinHypercube, Self::Random];

    /// Its name in studies.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sobol => "sobol",
            Self::LatinHypercube => "latin_hypercube",
            Self::Random => "random",
        }
    }

    /// The method of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }
}

/// The error for a sample that cannot be made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum CubeError {
    /// No point, or too many.
    #[error("{count} points: the method {} takes 1 to {most}", method.name())]
    Count {
        /// The method.
        method: Method,
        /// Points asked for.
        count: u64,
        /// Largest number of points of the method.
        most: u64,
    },
    /// No axis, or too many.
    #[error("{axes} axes: the method {} takes 1 to {most}", method.name())]
    Axes {
        /// The method.
        method: Method,
        /// Axes asked for.
        axes: usize,
        /// Largest number of axes of the method.
        most: usize,
    },
}

/// A sample of the unit cube. Each point is computed from its number alone.
#[derive(Debug, Clone)]
pub struct Cube {
    layout: Layout,
    count: u64,
    axes: usize,
}

#[derive(Debug, Clone)]
enum Layout {
    Sobol(Sobol),
    LatinHypercube(LatinHypercube),
    Random { seed: u64 },
}

impl Cube {
    /// `count` points on `axes` axes. All random numbers follow from the seed. `scramble` applies to Sobol'
    /// points only; without it they are the same for every seed.
    ///
    /// A Sobol' or random point does not depend on `count`. A Latin hypercube takes 4 bytes of memory per
    /// point and axis; the others store no points.
    ///
    /// # Errors
    /// [`CubeError`] for `count` outside 1 to [`MOST_POINTS`] ([`MOST_LATIN_POINTS`] for a Latin hypercube),
    /// or `axes` of zero or, for Sobol' points, beyond [`MOST_SOBOL_AXES`].
    pub fn new(
        method: Method,
        count: u64,
        seed: u64,
        scramble: bool,
        axes: usize,
    ) -> Result<Self, CubeError> {
        let (most_points, most_axes) = match method {
            Method::Sobol => (MOST_POINTS, MOST_SOBOL_AXES),
            Method::LatinHypercube => (MOST_LATIN_POINTS, usize::MAX),
            Method::Random => (MOST_POINTS, usize::MAX),
        };
        if count == 0 || count > most_points {
            return Err(CubeError::Count { method, count, most: most_points });
        }
        if axes == 0 || axes > most_axes {
            return Err(CubeError::Axes { method, axes, most: most_axes });
        }
        let layout = match method {
            Method::Sobol => Layout::Sobol(Sobol::new(axes, scramble.then_some(seed))),
            Method::LatinHypercube => {
                Layout::LatinHypercube(LatinHypercube::new(count as u32, seed, axes))
            }
            Method::Random => Layout::Random { seed },
        };
        Ok(Self { layout, count, axes })
    }

    /// A coordinate of a point, both counted from 0: in [0, 1) for plain Sobol' points, in (0, 1) for all
    /// others. NaN for a point or an axis outside the sample.
    pub fn coordinate(&self, point: u64, axis: usize) -> f64 {
        if point >= self.count || axis >= self.axes {
            return f64::NAN;
        }
        match &self.layout {
            Layout::Sobol(sobol) => sobol.coordinate(point as u32, axis),
            Layout::LatinHypercube(latin) => latin.coordinate(point as usize, axis),
            Layout::Random { seed } => {
                uniform(Stream::new(*seed, axis, Use::Coordinates).word(point))
            }
        }
    }
}

/// A random word as a number in (0, 1): an odd multiple of 2⁻⁵³, midway between two multiples of 2⁻⁵².
fn uniform(word: u64) -> f64 {
    ((word >> 11) | 1) as f64 * f64::EPSILON / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [(Method, bool); 4] = [
        (Method::Sobol, false),
        (Method::Sobol, true),
        (Method::LatinHypercube, false),
        (Method::Random, false),
    ];

    fn cube(method: Method, count: u64, seed: u64, scramble: bool, axes: usize) -> Cube {
        Cube::new(method, count, seed, scramble, axes).expect("a cube")
    }

    /// Means and products of three axes are within 5 standard deviations of those of independent uniform
    /// points: 0.0046 for a mean, 0.0013 for a covariance.
    #[test]
    fn moments_are_those_of_uniform_points() {
        const COUNT: u64 = 100_000;
        for (method, scramble) in KINDS {
            let cube = cube(method, COUNT, 3, scramble, 20);
            let mean =
                |value: &dyn Fn(u64) -> f64| (0..COUNT).map(value).sum::<f64>() / COUNT as f64;
            for axis in [0, 1, 19] {
                let at = |point, axis| cube.coordinate(point, axis) - 0.5;
                let first = mean(&|point| at(point, axis));
                assert!(first.abs() < 0.0046, "{method:?} axis {axis}: mean off by {first}");
                for other in [0, 7, 19] {
                    let expected = if axis == other { 1.0 / 12.0 } else { 0.0 };
                    let error = mean(&|point| at(point, axis) * at(point, other)) - expected;
                    assert!(error.abs() < 0.0013, "{method:?} {axis} {other}: {error}");
                }
            }
        }
    }

    #[test]
    fn coordinates_are_inside_and_those_of_their_number_alone() {
        for (method, scramble) in KINDS {
            let [a, b] = [0, 1].map(|_| cube(method, 1000, 11, scramble, 6));
            let forward: Vec<f64> =
                (0..6000).map(|n| a.coordinate(n / 6, (n % 6) as usize)).collect();
            let mut backward: Vec<f64> =
                (0..6000).rev().map(|n| b.coordinate(n / 6, (n % 6) as usize)).collect();
            backward.reverse();
            assert_eq!(forward, backward);
            let lowest = if (method, scramble) == (Method::Sobol, false) { -1.0 } else { 0.0 };
            assert!(forward.iter().all(|x| *x > lowest && *x < 1.0));
        }
    }

    #[test]
    fn more_points_leave_the_first_as_they_are() {
        for (method, scramble) in KINDS {
            if method == Method::LatinHypercube {
                continue;
            }
            let [few, many] = [10, MOST_POINTS].map(|count| cube(method, count, 5, scramble, 3));
            for point in 0..10 {
                assert_eq!(few.coordinate(point, 2), many.coordinate(point, 2));
            }
            assert!(many.coordinate(MOST_POINTS - 1, 2) < 1.0);
        }
    }

    /// The numbers of a seed must never change.
    #[test]
    fn a_seed_is_a_sample_for_ever() {
        let known = [
            [0.0, 0.5, 0.1572265625, 0.0380859375],
            [0.3192584473160264, 0.6874575970765157, 0.4373414259610854, 0.5523167510445589],
            [0.9967539532404112, 0.8296536530412809, 0.6177813225394388, 0.23089173139247168],
            [0.7539532404108792, 0.6536530412806928, 0.7813225394384243, 0.8917313924712328],
        ];
        for ((method, scramble), row) in KINDS.into_iter().zip(known) {
            let cube = cube(method, 1000, 2024, scramble, 20);
            let found = [(0, 0), (1, 0), (999, 0), (999, 19)].map(|(p, a)| cube.coordinate(p, a));
            assert_eq!(found, row, "{method:?}");
        }
    }

    #[test]
    fn seeds_and_axes_differ() {
        for (method, scramble) in &KINDS[1..] {
            let [a, b] = [1, 2].map(|seed| cube(*method, 100, seed, *scramble, 2));
            assert!((0..100).any(|point| a.coordinate(point, 0) != b.coordinate(point, 0)));
            assert!((0..100).any(|point| a.coordinate(point, 0) != a.coordinate(point, 1)));
        }
    }

    #[test]
    fn what_is_not_there_is_nan() {
        for (method, scramble) in KINDS {
            let cube = cube(method, 10, 0, scramble, 2);
            assert!(cube.coordinate(10, 0).is_nan() && cube.coordinate(0, 2).is_nan());
        }
    }

    #[test]
    fn impossible_cubes_are_refused() {
        let refused = |method, count, axes| {
            Cube::new(method, count, 0, true, axes).map(|_| ()).unwrap_err().to_string()
        };
        assert_eq!(
            refused(Method::Sobol, 0, 1),
            "0 points: the method sobol takes 1 to 4294967296"
        );
        assert_eq!(refused(Method::Sobol, 1, 38), "38 axes: the method sobol takes 1 to 37");
        assert_eq!(
            refused(Method::LatinHypercube, 10_000_001, 1),
            "10000001 points: the method latin_hypercube takes 1 to 10000000"
        );
        assert!(refused(Method::Random, 1, 0).starts_with("0 axes"));
        assert!(refused(Method::Random, MOST_POINTS + 1, 1).starts_with("4294967297 points"));
    }

    #[test]
    fn methods_have_names() {
        for method in Method::ALL {
            assert_eq!(Method::from_name(method.name()), Some(method));
        }
        assert_eq!(Method::from_name("halton"), None);
    }
}
