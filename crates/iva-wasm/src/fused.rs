//! The function `fma`, a·b + c rounded once.
//!
//! WebAssembly has no such instruction: the compiler calls a function of this name in its place. The compiler's own works
//! with whole numbers and takes some 28 ns, most of the time of a run. This one takes sums and products of doubles, some 11
//! ns. The exact result is a sum of three numbers without overlap. The lower two are rounded to odd, so that the rounding
//! of the last sum sees on which side of a tie it is: S. Boldo and G. Melquiond, *Emulation of a FMA and correctly rounded
//! sums: proved algorithms using rounding to odd*, IEEE Transactions on Computers 57 (2008).
//!
//! Newer browsers have `f64x2.relaxed_madd`, which may round once or twice, but always alike in one browser. Those that do
//! not have it refuse a module with it, so the page writes it into this function when it loads the module, and tries it
//! against the sums ([`rounds_once`]): with it a free decay takes two thirds of the time, a pendulum less
//! than half.
#![allow(unsafe_code)]

/// a·b + c, rounded once: what [`f64::mul_add`] calls on this machine. It must not call that itself.
#[cfg_attr(target_arch = "wasm32", unsafe(no_mangle))]
pub extern "C" fn fma(a: f64, b: f64, c: f64) -> f64 {
    from_sums(a, b, c)
}

/// True if [`f64::mul_add`] has the bits of the sums, here: in sums that cancel, that tie, and in any others.
pub fn rounds_once() -> bool {
    let mut doubles = Doubles(1);
    (0..1000).all(|_| {
        let [a, b] = [doubles.next(20), doubles.next(20)];
        let sums = [-a * b, a * b * 0.5_f64.powi(53), doubles.next(20)];
        sums.into_iter().all(|c| a.mul_add(b, c).to_bits() == from_sums(a, b, c).to_bits())
    })
}

/// Doubles of many sizes, the same every time.
struct Doubles(u64);

impl Doubles {
    fn bits(&mut self) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) << 32) ^ (self.0 >> 20)
    }

    /// A double whose exponent is at most `spread` from 0; every fourth has few bits, so that sums tie.
    fn next(&mut self, spread: i64) -> f64 {
        let exponent = (1023 + self.bits() as i64 % (spread + 1)).clamp(0, 2047) as u64;
        let mantissa = self.bits() & ((1 << 52) - 1);
        let kept = if self.bits().is_multiple_of(4) { mantissa >> 40 << 40 } else { mantissa };
        f64::from_bits((self.bits() % 2) << 63 | exponent << 52 | kept)
    }
}

/// Above and below these sizes a term could overflow, or underflow.
const MOST: f64 = 1e270;
const LEAST: f64 = 1e-270;

/// a·b + c, rounded once. It is inlined, so that `fma` has a body of its own to be replaced.
#[inline(always)]
fn from_sums(a: f64, b: f64, c: f64) -> f64 {
    let product = a * b;
    let size = product.abs();
    let usual = size > LEAST && size < MOST && a.abs() < MOST && b.abs() < MOST && c.abs() < MOST;
    if !usual {
        return if a == 0.0 || b == 0.0 { product + c } else { libm::fma(a, b, c) };
    }
    let lost = lost_in_product([a, b], product);
    let (small, least) = two_sum(c, lost);
    let (high, low) = two_sum(product, small);
    high + odd_sum(least, low)
}

/// The error of a rounded product: T. J. Dekker, *A floating-point technique for extending the available precision*,
/// Numerische Mathematik 18 (1971), with G. W. Veltkamp's halves of a double.
#[inline(always)]
fn lost_in_product([a, b]: [f64; 2], product: f64) -> f64 {
    let halves = |x: f64| {
        let scaled = x * 134_217_729.0;
        let high = scaled - (scaled - x);
        (high, x - high)
    };
    let ((ah, al), (bh, bl)) = (halves(a), halves(b));
    al * bl - (((product - ah * bh) - al * bh) - ah * bl)
}

/// a + b as the rounded sum and its exact error.
#[inline(always)]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// a + b rounded to odd: a sum that is not a double becomes the neighbour whose last bit is 1.
#[inline(always)]
fn odd_sum(a: f64, b: f64) -> f64 {
    let (sum, rest) = two_sum(a, b);
    let bits = sum.to_bits();
    if rest == 0.0 || bits & 1 == 1 {
        return sum;
    }
    let outwards = (rest > 0.0) == (sum > 0.0);
    f64::from_bits(if outwards { bits + 1 } else { bits - 1 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The instruction of this machine, or its library, is right by IEEE 754.
    fn check(a: f64, b: f64, c: f64) {
        let (ours, exact) = (from_sums(a, b, c), a.mul_add(b, c));
        let same = ours.to_bits() == exact.to_bits() || (ours.is_nan() && exact.is_nan());
        assert!(same, "{a:e} * {b:e} + {c:e}: {ours:e}, {exact:e}");
    }

    #[test]
    fn sums_have_the_bits_of_the_instruction() {
        let mut doubles = Doubles(1);
        for round in 0..1_000_000 {
            let spread = [2, 60, 300, 1100][round % 4];
            let [a, b, far] = std::array::from_fn(|_| doubles.next(spread));
            // Near the negative product, about half a unit of it, anywhere, and about twice its units.
            for near in [-a * b, a * b * 0.5_f64.powi(53), far, a * b * 2_f64.powi(53)] {
                for factor in [1.0, 1.0 + f64::EPSILON, 1.0 - f64::EPSILON, 1.5] {
                    check(a, b, near * factor);
                }
            }
        }
    }

    #[test]
    fn zeros_and_infinities_are_those_of_the_instruction() {
        let positive = [0.0, 1.0, f64::INFINITY, f64::NAN, f64::MIN_POSITIVE, 5e-324, f64::MAX];
        let all: Vec<f64> = positive.into_iter().flat_map(|it| [it, -it]).collect();
        for &a in &all {
            for &b in &all {
                all.iter().for_each(|&c| check(a, b, c));
            }
        }
    }

    #[test]
    fn this_machine_rounds_once() {
        assert!(rounds_once());
        assert_eq!(fma(1.0 + f64::EPSILON, 1.0 - f64::EPSILON, -1.0), -f64::EPSILON * f64::EPSILON);
    }
}
