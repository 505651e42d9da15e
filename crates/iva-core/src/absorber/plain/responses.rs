//! The responses of the oscillator from rest that every flight is a sum of, as short polynomials.
//!
//! P is the response to a constant force of 1 and Q = −∫P ([`crate::host::oscillator`]); C and B are those to
//! (cos Ωs − 1)/Ω² and to sin Ωs/Ω, which stay finite for slow forces; K = ∫C is needed on a moving base. With
//! S = h − 2ζP + Q
//!
//! ```text
//! Ṗ = S,    Ċ = −B,    Ḃ = P + Ω²C.
//! ```
//!
//! P/h², Q/h³, C/h⁴, B/h³ and K/h⁵ are power series of [`TAYLOR`] terms, shortened to [`TERMS`] terms: each higher
//! power of t = h/longest is replaced by its expansion in Chebyshev polynomials on [0, 1] up to that degree
//! (C. Lanczos, *Applied Analysis*, 1956, "economization"). The error is below 10⁻¹⁷ of the leading term.

use crate::segment::taylor::unrolled;

/// Number of polynomials.
const RESPONSES: usize = 5;
/// Terms of each polynomial.
pub(crate) const TERMS: usize = 14;
/// Terms of the power series before it is shortened.
const TAYLOR: usize = 26;
/// Longest flight in units of 1/(fastest rate of oscillator and force).
const LONGEST: f64 = 2.0;

/// Row m: the polynomial of [`TERMS`] terms that replaces the power t^(m + TERMS).
const SHORTER: [[f64; TERMS]; TAYLOR - TERMS] = shorter();

const fn shorter() -> [[f64; TERMS]; TAYLOR - TERMS] {
    // Coefficients of the Chebyshev polynomials on [0, 1]: T₀ = 1, T₁ = 2x − 1, Tₙ₊₁ = (4x − 2) Tₙ − Tₙ₋₁.
    let mut chebyshev = [[0.0; TERMS]; TERMS];
    chebyshev[0][0] = 1.0;
    chebyshev[1][0] = -1.0;
    chebyshev[1][1] = 2.0;
    let mut n = 2;
    while n < TERMS {
        let mut k = 0;
        while k <= n {
            let raised = if k > 0 { chebyshev[n - 1][k - 1] } else { 0.0 };
            chebyshev[n][k] = 4.0 * raised - 2.0 * chebyshev[n - 1][k] - chebyshev[n - 2][k];
            k += 1;
        }
        n += 1;
    }
    let mut shorter = [[0.0; TERMS]; TAYLOR - TERMS];
    let mut row = 0;
    while row < TAYLOR - TERMS {
        // x^m = Σ w_n T_n with w_n = C(2m, m − n)/2^(2m−1), half of it for n = 0.
        let m = row + TERMS;
        let mut weight = 1.0;
        let mut k = 0;
        while k < m {
            // C(2m, m)/4^m = Π (2k + 1)/(2k + 2).
            weight *= (2 * k + 1) as f64 / (2 * k + 2) as f64;
            k += 1;
        }
        let mut n = 0;
        while n < TERMS {
            let mut k = 0;
            while k <= n {
                shorter[row][k] += weight * chebyshev[n][k];
                k += 1;
            }
            weight *= (m - n) as f64 / (m + n + 1) as f64 * if n == 0 { 2.0 } else { 1.0 };
            n += 1;
        }
        row += 1;
    }
    shorter
}

/// The reciprocals 1/n.
const OVER: [f64; TAYLOR + 6] = {
    let mut over = [0.0; TAYLOR + 6];
    let mut n = 1;
    while n < over.len() {
        over[n] = 1.0 / n as f64;
        n += 1;
    }
    over
};

/// The polynomials for one oscillator and one frequency of the force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Responses {
    /// 2ζ of the oscillator.
    pub damping: f64,
    /// Ω of the force; 0 without force.
    pub frequency: f64,
    /// The longest flight that they hold for.
    pub longest: f64,
    /// Coefficients of P/h², Q/h³, C/h⁴, B/h³ and K/h⁵ in powers of t.
    pub terms: [[f64; TERMS]; RESPONSES],
}

impl Responses {
    /// The polynomials from 2ζ, the growth rate Λ of the oscillator, and Ω of the force (0: none).
    pub fn new(damping: f64, growth: f64, frequency: f64) -> Self {
        let longest = LONGEST / growth.max(frequency);
        let square = frequency * frequency;
        // Taylor coefficients of the forces 1, (cos Ωs − 1)/Ω² and sin Ωs/Ω.
        let mut drives = [[0.0; TAYLOR + 4]; 3];
        drives[0][0] = 1.0;
        let (mut cosine, mut sine) = (-0.5, 1.0);
        for k in 1..TAYLOR / 2 + 2 {
            let n = 2 * k;
            (drives[1][n], drives[2][n - 1]) = (cosine, sine);
            cosine *= -square * (OVER[n + 1] * OVER[n + 2]);
            sine *= -square * (OVER[n] * OVER[n + 1]);
        }
        // The Taylor series of y from y″ + 2ζ y′ + y = force.
        let answer = |drive: &[f64; TAYLOR + 4]| {
            let mut y = [0.0; TAYLOR + 6];
            for n in 0..TAYLOR + 4 {
                let [over, after] = [OVER[n + 1] * OVER[n + 2], damping * OVER[n + 2]];
                y[n + 2] = (drive[n] - y[n]) * over - after * y[n + 1];
            }
            y
        };
        let integral = |series: &[f64; TAYLOR + 6], sign: f64| {
            let mut integral = [0.0; TAYLOR + 6];
            for n in 3..TAYLOR + 6 {
                integral[n] = sign * series[n - 1] * OVER[n];
            }
            integral
        };
        let (step, cosine) = (answer(&drives[0]), answer(&drives[1]));
        let shortened = |series: &[f64; TAYLOR + 6], first: usize| {
            let mut terms = [0.0; TERMS];
            let mut scale = 1.0;
            for k in 0..TAYLOR {
                let term = series[first + k] * scale;
                scale *= longest;
                if k < TERMS {
                    terms[k] = term;
                } else {
                    for (sum, share) in terms.iter_mut().zip(&SHORTER[k - TERMS]) {
                        *sum += term * share;
                    }
                }
            }
            terms
        };
        let terms = [
            shortened(&step, 2),
            shortened(&integral(&step, -1.0), 3),
            shortened(&cosine, 4),
            shortened(&answer(&drives[2]), 3),
            shortened(&integral(&cosine, 1.0), 5),
        ];
        Self { damping, frequency, longest, terms }
    }
}

/// The values of the polynomials of one structure.
pub(crate) trait Values {
    /// A polynomial at t.
    fn at<const WHICH: usize>(&self, t: f64) -> f64;
}

/// The value of a polynomial, whose coefficients `row` gives, at t.
#[inline(always)]
fn value(row: impl Fn(usize) -> f64, t: f64) -> f64 {
    let z = t * t;
    let (mut even, mut odd) = (row(TERMS - 2), row(TERMS - 1));
    unrolled!(k < 6 => {
        even = even.mul_add(z, row(TERMS - 4 - 2 * k));
        odd = odd.mul_add(z, row(TERMS - 3 - 2 * k));
    });
    odd.mul_add(t, even)
}

impl Values for Responses {
    #[inline(always)]
    fn at<const WHICH: usize>(&self, t: f64) -> f64 {
        let row = &self.terms[WHICH];
        value(
            #[inline(always)]
            |k| row[k],
            t,
        )
    }
}

impl<V: Values> Values for &V {
    #[inline(always)]
    fn at<const WHICH: usize>(&self, t: f64) -> f64 {
        (**self).at::<WHICH>(t)
    }
}

/// The polynomials of all lanes.
#[derive(Debug)]
#[repr(align(64))]
pub(crate) struct Tables<const W: usize> {
    pub terms: [[[f64; W]; TERMS]; RESPONSES],
}

impl<const W: usize> Tables<W> {
    pub fn new() -> Self {
        Self { terms: [[[0.0; W]; TERMS]; RESPONSES] }
    }

    /// Loads polynomials into a lane.
    pub fn set(&mut self, i: usize, responses: &Responses) {
        for (rows, terms) in self.terms.iter_mut().zip(&responses.terms) {
            for (row, term) in rows.iter_mut().zip(terms) {
                row[i] = *term;
            }
        }
    }

    /// The polynomials of a lane.
    #[inline(always)]
    pub fn of(&self, i: usize) -> OfLane<'_, W> {
        OfLane(self, i)
    }
}

/// The polynomials of one lane.
pub(crate) struct OfLane<'a, const W: usize>(&'a Tables<W>, usize);

impl<const W: usize> Values for OfLane<'_, W> {
    #[inline(always)]
    fn at<const WHICH: usize>(&self, t: f64) -> f64 {
        let Self(tables, i) = *self;
        let row = &tables.terms[WHICH];
        value(
            #[inline(always)]
            |k| row[k][i],
            t,
        )
    }
}
