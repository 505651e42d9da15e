//! Smooth motion in double-double: the power series of a damped oscillator on one short segment.

use crate::dd::Dd;

const TERMS: usize = 28;

/// The motion κ ẍ + 2ζ ẋ + x = 0 from a state, as a power series in the time since then (κ = 1 in flight,
/// κ = 1 + μ while stuck).
#[derive(Debug, Clone)]
pub struct Segment {
    /// Taylor coefficients of x.
    pub x: [Dd; TERMS],
    /// Length on which the error of the series is below 1e-32 of |x| + |ẋ|.
    pub length: f64,
}

impl Segment {
    /// The series from displacement `x` and velocity `v`.
    pub fn new(x: Dd, v: Dd, zeta: Dd, inertia: Dd) -> Self {
        let mut c = [Dd::ZERO; TERMS];
        c[0] = x;
        c[1] = v;
        for k in 0..TERMS - 2 {
            let n = (k + 1) as f64;
            let pull = zeta * 2.0 * n * c[k + 1] + c[k];
            c[k + 2] = -(pull / (inertia * (n * (n + 1.0))));
        }
        // |x_k| ≤ (|x| + |v|) λ^k/k! with λ the larger root (or 1); (λh)^28/28! < 1e-34 at λh = ½
        let damping = zeta.hi.max(1.0);
        let fastest = damping + (damping * damping - 1.0).sqrt();
        Self { x: c, length: 0.5 / fastest }
    }

    /// Displacement, velocity and acceleration after `h`.
    pub fn at(&self, h: Dd) -> (Dd, Dd, Dd) {
        let (mut x, mut v, mut a) = (Dd::ZERO, Dd::ZERO, Dd::ZERO);
        for k in (0..TERMS).rev() {
            x = x * h + self.x[k];
            if k >= 1 {
                v = v * h + self.x[k] * k as f64;
            }
            if k >= 2 {
                a = a * h + self.x[k] * (k * (k - 1)) as f64;
            }
        }
        (x, v, a)
    }
}

/// Displacement and velocity of the free primary system (any ζ ≥ 0) a time `t` after (x, v).
pub fn free(x: Dd, v: Dd, zeta: Dd, t: Dd) -> (Dd, Dd) {
    let (mut x, mut v, mut left) = (x, v, t);
    loop {
        let segment = Segment::new(x, v, zeta, Dd::ONE);
        let last = left.hi <= segment.length;
        let h = if last { left } else { Dd::from(segment.length) };
        (x, v, _) = segment.at(h);
        if last {
            return (x, v);
        }
        left = left - h;
    }
}

/// The root of `f` in (`low`, `high`), where its signs differ; `f` returns value and derivative. Newton's
/// method, safeguarded by bisection.
pub fn root(f: impl Fn(Dd) -> (Dd, Dd), mut low: Dd, mut high: Dd) -> Dd {
    let rising = f(high).0 > Dd::ZERO;
    let mut at = (low + high) * 0.5;
    for _ in 0..200 {
        let (value, slope) = f(at);
        if (value > Dd::ZERO) == rising {
            high = at;
        } else {
            low = at;
        }
        let newton = at - value / slope;
        let next = if newton > low && newton < high { newton } else { (low + high) * 0.5 };
        let step = (next - at).abs().hi;
        at = next;
        if step <= 1e-31 * at.hi.abs() || (high - low).hi <= 1e-31 * high.hi.abs() {
            break;
        }
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn undamped_flight_is_the_cosine() {
        // cos 10 and sin 10 to 32 digits
        let (x, v) = free(Dd::ONE, Dd::ZERO, Dd::ZERO, Dd::from(10.0));
        assert!((x - Dd::parse("-0.83907152907645245225886394782406")).abs().hi < 1e-29);
        assert!((v - Dd::parse("0.54402111088936981340474766185138")).abs().hi < 1e-29);
    }
}
