//! Sobol' points: I. M. Sobol', USSR Comput. Math. Math. Phys. 7 (1967) 86-112, in the order of
//! I. A. Antonov and V. M. Saleev, ibid. 19 (1979) 252-256, with the direction numbers of S. Joe
//! and F. Y. Kuo, Constructing Sobol sequences with better two-dimensional projections, SIAM J.
//! Sci. Comput. 30 (2008) 2635-2654 (their file new-joe-kuo-6.21201); scrambled as by A. B. Owen,
//! Randomly permuted (t,m,s)-nets and (t,s)-sequences, Lecture Notes in Statistics 106 (1995)
//! 299-317.

use super::philox::{Stream, Use};
use super::uniform;

/// Number of binary digits of a coordinate, and of the number of a point.
const DIGITS: usize = 32;
/// Number of digits that one block of random numbers scrambles: the tree of their prefixes has 2⁸ - 1 nodes,
/// and a block 2⁸ bits.
const DIGITS_A_BLOCK: usize = 8;

/// Largest number of axes: one for each primitive polynomial over GF(2) up to degree 7, and the first axis,
/// which needs none.
pub const MOST_AXES: usize = 1 + POLYNOMIALS.len();

/// For each axis from the second: the inner coefficients a₁ … aₛ₋₁ of the polynomial
/// xˢ + a₁xˢ⁻¹ + … + aₛ₋₁x + 1, read as a binary number, and the first direction numbers m₁ … mₛ.
#[rustfmt::skip]
const POLYNOMIALS: [(u32, &[u32]); 36] = [
    (0, &[1]), (1, &[1, 3]), (1, &[1, 3, 1]), (2, &[1, 1, 1]), (1, &[1, 1, 3, 3]),
    (4, &[1, 3, 5, 13]), (2, &[1, 1, 5, 5, 17]), (4, &[1, 1, 5, 5, 5]), (7, &[1, 1, 7, 11, 19]),
    (11, &[1, 1, 5, 1, 1]), (13, &[1, 1, 1, 3, 11]), (14, &[1, 3, 5, 5, 31]),
    (1, &[1, 3, 3, 9, 7, 49]), (13, &[1, 1, 1, 15, 21, 21]), (16, &[1, 3, 1, 13, 27, 49]),
    (19, &[1, 1, 1, 15, 7, 5]), (22, &[1, 3, 1, 15, 13, 25]), (25, &[1, 1, 5, 5, 19, 61]),
    (1, &[1, 3, 7, 11, 23, 15, 103]), (4, &[1, 3, 7, 13, 13, 15, 69]),
    (7, &[1, 1, 3, 13, 7, 35, 63]), (8, &[1, 3, 5, 9, 1, 25, 53]), (14, &[1, 3, 1, 13, 9, 35, 107]),
    (19, &[1, 3, 1, 5, 27, 61, 31]), (21, &[1, 1, 5, 11, 19, 41, 61]),
    (28, &[1, 3, 5, 3, 3, 13, 69]), (31, &[1, 1, 7, 13, 1, 19, 1]), (32, &[1, 3, 7, 5, 13, 19, 59]),
    (37, &[1, 1, 3, 9, 25, 29, 41]), (41, &[1, 3, 5, 13, 23, 1, 55]),
    (42, &[1, 3, 7, 3, 13, 59, 17]), (50, &[1, 3, 1, 3, 5, 53, 69]),
    (55, &[1, 1, 5, 5, 23, 33, 13]), (56, &[1, 1, 7, 7, 1, 61, 123]),
    (59, &[1, 1, 7, 9, 13, 61, 49]), (62, &[1, 3, 3, 5, 3, 55, 33]),
];

/// A binary fraction: the digits after the point, the first one in the highest bit.
type Fraction = u32;

/// Sobol' points, plain or scrambled.
#[derive(Debug, Clone)]
pub(super) struct Sobol {
    axes: Vec<Axis>,
}

#[derive(Debug, Clone)]
struct Axis {
    directions: [Fraction; DIGITS],
    scramble: Option<Scramble>,
}

impl Sobol {
    /// Points on up to [`MOST_AXES`] axes (further axes are ignored), scrambled if a seed is given.
    pub(super) fn new(axes: usize, seed: Option<u64>) -> Self {
        let directions = std::iter::once(van_der_corput())
            .chain(POLYNOMIALS.iter().map(|(inner, first)| directions(*inner, first)));
        let scramble = |axis| seed.map(|seed| Scramble(Stream::new(seed, axis, Use::Scrambling)));
        let axes = directions
            .take(axes)
            .enumerate()
            .map(|(axis, directions)| Axis { directions, scramble: scramble(axis) })
            .collect();
        Self { axes }
    }

    /// A coordinate: a multiple of 2⁻³² in [0, 1) for plain points, a number in (0, 1) for scrambled ones;
    /// NaN for an axis outside the sample.
    pub(super) fn coordinate(&self, point: u32, axis: usize) -> f64 {
        let Some(Axis { directions, scramble }) = self.axes.get(axis) else { return f64::NAN };
        let digits = combination(directions, gray(point));
        match scramble {
            None => f64::from(digits) / (1u64 << DIGITS) as f64,
            Some(scramble) => uniform(scramble.word(digits)),
        }
    }
}

/// The Gray code of a number: successive codes differ in one digit.
fn gray(number: u32) -> u32 {
    number ^ (number >> 1)
}

/// The sum modulo 2, digit by digit, of the directions that a code selects.
fn combination(directions: &[Fraction; DIGITS], code: u32) -> Fraction {
    let chosen = |(k, direction): (usize, &Fraction)| direction & 0u32.wrapping_sub(code >> k & 1);
    directions.iter().enumerate().map(chosen).fold(0, |sum, direction| sum ^ direction)
}

/// The directions of the first axis: all mₖ are 1.
fn van_der_corput() -> [Fraction; DIGITS] {
    std::array::from_fn(|k| fraction(k, 1))
}

/// The directions mₖ 2⁻ᵏ of a polynomial, by the recurrence
/// mₖ = 2a₁mₖ₋₁ ⊕ … ⊕ 2ˢ⁻¹aₛ₋₁mₖ₋ₛ₊₁ ⊕ 2ˢmₖ₋ₛ ⊕ mₖ₋ₛ.
fn directions(inner: u32, first: &[u32]) -> [Fraction; DIGITS] {
    let degree = first.len();
    let mut v = [0; DIGITS];
    for k in 0..DIGITS {
        v[k] = first.get(k).map_or_else(
            || {
                (1..degree)
                    .filter(|i| inner >> (degree - 1 - i) & 1 == 1)
                    .fold(v[k - degree] ^ (v[k - degree] >> degree), |sum, i| sum ^ v[k - i])
            },
            |m| fraction(k, *m),
        );
    }
    v
}

/// m 2⁻ᵏ⁻¹ for the k-th direction, counted from 0.
fn fraction(k: usize, m: u32) -> Fraction {
    m << (DIGITS - 1 - k)
}

/// A nested uniform scrambling: every digit is flipped or kept at random, in the same way for all fractions
/// with the same digits before it.
#[derive(Debug, Clone, Copy)]
struct Scramble(Stream);

impl Scramble {
    /// A scrambled fraction, with random digits after its last.
    fn word(self, digits: Fraction) -> u64 {
        let scrambled = (0..DIGITS / DIGITS_A_BLOCK)
            .fold(0, |done, block| done << DIGITS_A_BLOCK | self.next_digits(digits, block));
        // No two points have all digits in common, so the digits after the last are independent.
        let [behind, ..] = self.nodes(digits, DIGITS);
        scrambled << DIGITS | behind >> DIGITS
    }

    /// The digits of one block, scrambled.
    fn next_digits(self, digits: Fraction, block: usize) -> u64 {
        let known = block * DIGITS_A_BLOCK;
        let next = (digits << known) >> (DIGITS - DIGITS_A_BLOCK);
        let nodes = self.nodes(digits, known);
        let changes = (0..DIGITS_A_BLOCK).fold(0, |changes, depth| {
            // The digits before the block, after a leading 1: a different number for each node.
            let node = 1 << depth | next >> (DIGITS_A_BLOCK - depth);
            changes << 1 | (nodes[node as usize / 64] >> (node % 64) & 1)
        });
        u64::from(next) ^ changes
    }

    /// A random bit for each node of the tree below the first digits of a fraction.
    fn nodes(self, digits: Fraction, known: usize) -> [u64; 4] {
        let prefix = u64::from(digits) >> (DIGITS - known);
        self.0.block([prefix, known as u64])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// scipy 1.17.1: `scipy.stats.qmc.Sobol(37, scramble=False).random(1024)` at points 1, 2, 3,
    /// 100 and 1023 of axes 0, 1, 2, 7, 19 and 36, in 2⁻¹⁰.
    #[test]
    fn plain_points_are_those_of_scipy() {
        let sobol = Sobol::new(MOST_AXES, None);
        let known: [(u32, [u32; 6]); 5] = [
            (1, [512, 512, 512, 512, 512, 512]),
            (2, [768, 256, 256, 768, 256, 256]),
            (3, [256, 768, 768, 256, 768, 768]),
            (100, [424, 264, 792, 488, 344, 1000]),
            (1023, [1, 771, 627, 633, 327, 965]),
        ];
        for (point, row) in known {
            for (axis, thousandths) in [0, 1, 2, 7, 19, 36].into_iter().zip(row) {
                let expected = f64::from(thousandths) / 1024.0;
                assert_eq!(sobol.coordinate(point, axis), expected, "point {point} axis {axis}");
            }
        }
    }

    /// scipy 1.17.1: `Sobol(37, scramble=False, bits=32).fast_forward(2**32 - 1).random(1)`, the
    /// same axes, in 2⁻³².
    #[test]
    fn the_last_point_is_that_of_scipy() {
        let sobol = Sobol::new(MOST_AXES, None);
        let known = [1u64, 4_294_967_295, 3_305_133_397, 2_271_450_689, 4_043_309_067, 300_800_949];
        for (axis, units) in [0, 1, 2, 7, 19, 36].into_iter().zip(known) {
            let expected = units as f64 / 2f64.powi(32);
            assert_eq!(sobol.coordinate(u32::MAX, axis), expected, "axis {axis}");
        }
    }

    /// Every axis is a (0, 1)-sequence in base 2, the first two are a (0, 2)-sequence.
    #[test]
    fn every_elementary_interval_has_one_point() {
        const M: u32 = 10;
        for seed in [None, Some(0), Some(1), Some(u64::MAX)] {
            let sobol = Sobol::new(MOST_AXES, seed);
            let one = |x: f64, digits: u32| (x * f64::from(1 << digits)) as usize;
            let mut boxes: Vec<(usize, usize, u32)> =
                (0..MOST_AXES).map(|axis| (axis, axis, M)).collect();
            boxes.extend((0..=M).map(|digits| (0, 1, digits)));
            for (a, b, digits) in boxes {
                // The first points, and points from a multiple of their number on.
                for first in [0, 5 << M, u32::MAX - (1 << M) + 1] {
                    let mut taken = [false; 1 << M];
                    for point in (0..1 << M).map(|i| first + i) {
                        let [x, y] = [a, b].map(|axis| sobol.coordinate(point, axis));
                        let index = one(x, digits) << (M - digits) | one(y, M - digits);
                        assert!(!std::mem::replace(&mut taken[index], true), "{a} {b} {digits}");
                    }
                }
            }
        }
    }

    /// The scrambling is nested: fractions have as many first digits in common after it as before.
    #[test]
    fn scrambling_keeps_the_number_of_common_digits() {
        let scramble = Scramble(Stream::new(9, 4, Use::Scrambling));
        let common = |a: u64, b: u64| (a ^ b).leading_zeros();
        for n in 0..100_000u32 {
            let fraction = n.wrapping_mul(0x9E37_79B9);
            let other = fraction ^ (n.wrapping_mul(0x85EB_CA6B) | 1) >> (n % 32);
            let [plain, scrambled] = [
                [fraction, other].map(|x| u64::from(x) << DIGITS),
                [fraction, other].map(|x| scramble.word(x)),
            ];
            if fraction != other {
                assert_eq!(common(plain[0], plain[1]), common(scrambled[0], scrambled[1]));
            }
        }
    }

    /// The scrambling is uniform, and more than a shift: over the seeds, the digits of two fractions change
    /// independently from the first digit in which they differ. Counts of 20 000 fair coins are within 5
    /// standard deviations, 354.
    #[test]
    fn digits_change_independently() {
        let seeds = 20_000;
        let changes = |seed, fraction: Fraction| {
            let word = Scramble(Stream::new(seed, 0, Use::Scrambling)).word(fraction);
            (word >> DIGITS) as u32 ^ fraction
        };
        for shared in [0, 1, 7, 8, 15, 20, 30] {
            let fraction = 0x5A5A_A5A5;
            let other = fraction ^ 0x8000_0000 >> shared;
            let mut equal = [0; DIGITS];
            let mut changed = [0; DIGITS];
            for seed in 0..seeds {
                let [a, b] = [fraction, other].map(|x| changes(seed, x));
                for digit in 0..DIGITS {
                    let at = |x: u32| x >> (DIGITS - 1 - digit) & 1;
                    equal[digit] += i32::from(at(a) == at(b));
                    changed[digit] += at(a) as i32;
                }
            }
            let fair = |count: i32| (count - seeds as i32 / 2).abs() < 354;
            for digit in 0..DIGITS {
                assert!(fair(changed[digit]), "digit {digit} changes {} times", changed[digit]);
                let together =
                    if digit <= shared { equal[digit] == seeds as i32 } else { fair(equal[digit]) };
                assert!(together, "digit {digit} of {shared} shared: {} alike", equal[digit]);
            }
        }
    }
}
