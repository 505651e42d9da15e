//! The pendulum absorber between walls in double-double: an independent Taylor series.
//!
//! The variables are the angle θ, its rate, sinθ and cosθ. The two accelerations follow from Lagrange's 2 × 2
//! equations of motion, solved for the newest coefficients; the simulator under test works with y = b sinθ,
//! W = b θ̇ and momentum instead.

use crate::dd::Dd;
use iva_core::piva::Parameters;

const TERMS: usize = 30;
/// Length of a segment in 1/ωn, short against every time scale of the tests.
const STEP: f64 = 0.1;

/// The state x, ẋ, θ, θ̇.
pub type Swing = [Dd; 4];

/// One segment: Taylor coefficients of x, ẋ, θ, θ̇ and sinθ.
#[derive(Debug, Clone)]
pub struct Segment {
    x: [Dd; TERMS],
    u: [Dd; TERMS],
    angle: [Dd; TERMS],
    rate: [Dd; TERMS],
    sine: [Dd; TERMS],
    contact: Dd,
}

fn product(a: &[Dd; TERMS], b: &[Dd; TERMS], k: usize) -> Dd {
    (0..=k).fold(Dd::ZERO, |sum, i| sum + a[i] * b[k - i])
}

/// Sine and cosine by their series at a 1024th of the angle, and ten doublings.
pub fn sine_cosine(angle: Dd) -> (Dd, Dd) {
    let small = angle / 1024.0;
    let square = small * small;
    // 1 − cos and sin of the small angle.
    let (mut versine, mut sine) = (Dd::ZERO, Dd::ZERO);
    for k in (1..=12).rev() {
        let n = (2 * k) as f64;
        versine = (Dd::ONE - versine) * square / (n * (n - 1.0));
        sine = (Dd::ONE - sine) * square / (n * (n + 1.0));
    }
    sine = small * (Dd::ONE - sine);
    for _ in 0..10 {
        // 1 − cos 2α = 2 sin²α; sin 2α = 2 sinα (1 − (1 − cosα))
        let twice = sine * 2.0 * (Dd::ONE - versine);
        versine = sine * sine * 2.0;
        sine = twice;
    }
    (sine, Dd::ONE - versine)
}

impl Segment {
    /// The segment from a state.
    pub fn new(p: &Parameters, [x, u, angle, rate]: Swing) -> Self {
        let z = [Dd::ZERO; TERMS];
        let (mu, zeta) = (Dd::from(p.mass_ratio), Dd::from(p.damping_ratio));
        let (length, kappa) = (Dd::from(p.length), Dd::from(p.inertia_ratio));
        let gravity = kappa * length * p.frequency_ratio * p.frequency_ratio;
        let stiffness = Dd::from(p.spring_ratio) * p.spring_ratio;
        let pivot = Dd::from(2.0) * p.pivot_damping_ratio * p.frequency_ratio;
        let (mut s, mut c, mut ss) = (z, z, z);
        let mut m =
            Self { x: z, u: z, angle: z, rate: z, sine: z, contact: p.contact_distance.into() };
        (m.x[0], m.u[0], m.angle[0], m.rate[0]) = (x, u, angle, rate);
        (s[0], c[0]) = sine_cosine(angle);
        // accelerations: a = ẍ and α = θ̈
        let (mut a, mut alpha) = (z, z);
        for k in 0..TERMS - 1 {
            let n = (k + 1) as f64;
            ss[k] = product(&m.rate, &m.rate, k);
            // (1+μ) a + μL (α c − θ̇² s) = −x − 2ζu,   κL (α + σ² θ + ν θ̇) + a c + g s = 0
            let rest = |f: &[Dd; TERMS], g: &[Dd; TERMS]| {
                (1..=k).fold(Dd::ZERO, |sum, i| sum + f[i] * g[k - i])
            };
            let first = -(m.x[k] + zeta * 2.0 * m.u[k])
                - mu * length * (rest(&c, &alpha) - product(&ss, &s, k));
            let turning = stiffness * m.angle[k] + pivot * m.rate[k];
            let second = -(rest(&c, &a) + gravity * s[k] + kappa * length * turning);
            // [1+μ, μL c₀; c₀, κL] [a; α] = [first; second]
            let determinant = (Dd::ONE + mu) * kappa * length - mu * length * c[0] * c[0];
            a[k] = (first * kappa * length - mu * length * c[0] * second) / determinant;
            alpha[k] = ((Dd::ONE + mu) * second - c[0] * first) / determinant;
            m.x[k + 1] = m.u[k] / n;
            m.u[k + 1] = a[k] / n;
            m.angle[k + 1] = m.rate[k] / n;
            m.rate[k + 1] = alpha[k] / n;
            s[k + 1] = product(&c, &m.rate, k) / n;
            c[k + 1] = -(product(&s, &m.rate, k) / n);
        }
        m.sine = s;
        m
    }

    fn sum(series: &[Dd; TERMS], h: Dd) -> Dd {
        series.iter().rev().fold(Dd::ZERO, |sum, coefficient| sum * h + *coefficient)
    }

    /// The state after h ≤ 0.1.
    pub fn at(&self, h: Dd) -> Swing {
        [&self.x, &self.u, &self.angle, &self.rate].map(|series| Self::sum(series, h))
    }

    /// Gap displacement and its first three derivatives after h ≤ 0.1.
    pub fn gap(&self, h: Dd) -> [Dd; 4] {
        let mut series = self.sine;
        let mut derivatives = [Dd::ZERO; 4];
        for derivative in &mut derivatives {
            *derivative = Self::sum(&series, h) * self.contact;
            for k in 1..TERMS {
                series[k - 1] = series[k] * k as f64;
            }
            series[TERMS - 1] = Dd::ZERO;
        }
        derivatives
    }
}

/// The state after a time of free swing.
pub fn swing(p: &Parameters, start: Swing, time: f64) -> Swing {
    let mut state = start;
    let mut left = Dd::from(time);
    while left.hi > STEP {
        state = Segment::new(p, state).at(STEP.into());
        left = left - STEP;
    }
    Segment::new(p, state).at(left)
}

/// The first extremum of the gap displacement: time, y and |ÿ|; `None` within 12 units of time.
pub fn extremum(p: &Parameters, start: Swing) -> Option<(Dd, Dd, f64)> {
    let mut state = start;
    let mut time = Dd::ZERO;
    while time.hi < 12.0 {
        let segment = Segment::new(p, state);
        let (from, to) = (segment.gap(Dd::ZERO), segment.gap(STEP.into()));
        if from[1].hi * to[1].hi < 0.0 && from[2].hi * to[2].hi > 0.0 {
            let rate = |h| {
                let [_, rate, curvature, _] = segment.gap(h);
                (rate, curvature)
            };
            let h = crate::flight::root(rate, Dd::ZERO, STEP.into());
            let [y, _, curvature, _] = segment.gap(h);
            return Some((time + h, y, curvature.abs().hi));
        }
        if from[1].hi * to[1].hi <= 0.0 && time.hi > 0.0 {
            return None; // a degenerate extremum
        }
        state = segment.at(STEP.into());
        time = time + STEP;
    }
    None
}
