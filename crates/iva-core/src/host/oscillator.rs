//! The primary system between events: m ẍ + 2ζ ẋ + x = 0 in closed form (paper, Eq. 1 with f = 0).
//!
//! Natural units: time in 1/ωn, M = 1. The primary without absorber has m = 1; with the absorber stuck on a
//! wall m = 1 + μ. With a = −(k x + c v) the acceleration at the start, k = 1/m, c = 2ζ/m,
//!
//! ```text
//! x(h) = x + v h + a P(h) + v Q(h),
//! v(h) = v + a S(h) − k v P(h),        S = Ṗ = h − c P + Q,
//! a(h) = a − k a P(h) + j S(h),        j = −(k v + c a),
//! ```
//!
//! where P is the step response from rest (P̈ + c Ṗ + k P = 1, P ≈ h²/2), S the impulse response and
//! Q = −k ∫P ≈ −k h³/6. P and Q are summed from their power series: they keep *relative* accuracy
//! down to the smallest h, so that a rebound of 10⁻⁹ is as accurate as a flight of half a period.
//! Written with a instead of x, nothing large cancels in a flight that starts with k x + c v ≈ 0.
//! The series needs no case for under-, critical and overdamping, and no library function.
//!
//! **Bounds.** ρ = √k |x| + |v| bounds √(k x² + v²), which never grows (ζ ≥ 0). The pair
//! (√k x, v) obeys a linear system of norm Λ = c/2 + √(c²/4 + k), and so do its derivatives. Hence
//! |x⁽ⁿ⁾| ≤ Λⁿ⁻¹ ρ for n ≥ 1 at every later time, for any ζ: no singularity at ζ = 1.

use crate::number::arrays::laned;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::Jet;

/// Terms of the series of P and Q, beginning with h².
const TERMS: usize = 24;
/// Number of leading terms whose coefficients are computed in double-double.
const EXACT_TERMS: usize = 8;
/// Number of terms from h⁴ on for which the low parts of the coefficients are used: the next is below 10⁻¹⁹.
const RESTS: usize = 4;
/// Terms of the series of the viscous loss, beginning with h.
const LOSS_TERMS: usize = 30;

/// The constants of the equation m ẍ + 2ζ ẋ + x = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equation<R = f64> {
    /// k = 1/m.
    pub stiffness: R,
    /// √k.
    pub frequency: R,
    /// c = 2ζ/m.
    pub damping: R,
    /// Λ, the factor by which each further derivative can grow.
    pub growth: R,
    /// 1/3.
    pub(crate) third: DoubleDouble<R>,
}

impl<R: Real> Equation<R> {
    /// The equation of mass `mass` (1 or 1 + μ) on the primary's spring and damper.
    pub fn new(mass: R, damping_ratio: R) -> Self {
        Self::of(R::ONE / mass, damping_ratio * 2.0 / mass)
    }

    /// ẍ = −k x − c ẋ.
    pub(crate) fn of(stiffness: R, damping: R) -> Self {
        let growth = damping * 0.5 + (damping * 0.25 * damping + stiffness).sqrt();
        let third = DoubleDouble::new(R::ONE).over(3.0);
        Self { stiffness, frequency: stiffness.sqrt(), damping, growth, third }
    }

    /// k p − c r, in double-double.
    #[inline(always)]
    pub(crate) fn pull(&self, p: DoubleDouble<R>, r: DoubleDouble<R>) -> DoubleDouble<R> {
        let spring =
            if self.stiffness == 1.0 { p } else { p.product(DoubleDouble::new(self.stiffness)) };
        spring - r.product(DoubleDouble::new(self.damping))
    }

    /// x⁽ⁿ⁺²⁾ = −(k x⁽ⁿ⁾ + c x⁽ⁿ⁺¹⁾), from the two derivatives before it.
    #[inline]
    pub fn next_derivative(&self, lower: R, upper: R) -> R {
        -(self.stiffness * lower + self.damping * upper)
    }

    /// ρ of a state: bounds |v| and, times Λⁿ⁻¹, the n-th derivative of x at every later time.
    #[inline]
    pub fn radius(&self, x: R, v: R) -> R {
        self.frequency * x.abs() + v.abs()
    }

    /// The bound Λⁿ⁺¹ρ on |x⁽ⁿ⁺²⁾|.
    #[inline(always)]
    pub(crate) fn bound<const N: usize>(&self, primary: &Primary<R>) -> R {
        let radius = self.radius(primary.x.value, primary.v.value);
        let growth = self.growth;
        match N {
            0 => growth * radius,
            1 => growth * growth * radius,
            2 => growth * growth * growth * radius,
            3 => growth * growth * (growth * growth) * radius,
            4 => growth * growth * (growth * growth) * (growth * radius),
            5 => growth * growth * (growth * growth) * (growth * growth) * radius,
            _ => growth * growth * (growth * growth) * (growth * growth) * (growth * radius),
        }
    }
}

/// The power series of one oscillator; they depend on ζ and m only.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillator<R = f64> {
    /// The constants of its equation.
    pub equation: Equation<R>,
    /// Longest h of a flight: 1.4/Λ, where the first dropped term is below 2 · 1.4²⁴/26! ≈ 2e-23 of the sum.
    /// (With a larger h, rounding errors of the terms from h⁴ on would matter.)
    pub reach: R,
    /// Coefficients of P and Q from h² on.
    responses: [[R; 2]; TERMS],
    /// Coefficients of P and Q without the terms up to h³, which [`Oscillator::arrive`] takes separately.
    bent: [[R; 2]; TERMS],
    /// Low parts of the coefficients of h⁴ to h⁷. Their errors are the same in every flight: without the low
    /// parts the energy of an undamped run would drift.
    coefficient_rests: [[R; 2]; RESTS],
    /// Rounding errors of P and Q without the terms up to h³ at h = `reach`, the length of most flights.
    full_step_rest: [R; 2],
    /// Coefficients of P and Q in double-double, for [`Oscillator::precise`].
    exact: [[DoubleDouble<R>; 2]; TERMS],
    loss: [[R; 3]; LOSS_TERMS],
    /// The viscous loss at h = `reach`, per x², x v and v² of the starting state.
    full_loss: [R; 3],
}

impl<R: Real> Oscillator<R> {
    /// The oscillator of mass `mass` (1 or 1 + μ) on the primary's spring and damper.
    pub fn new(mass: R, damping_ratio: R) -> Self {
        let equation = Equation::new(mass, damping_ratio);
        let Equation { stiffness, damping, growth, .. } = equation;
        let reach = R::from(1.4) / growth;
        let exact = responses(stiffness, damping);
        let responses = exact.map(|pair| pair.map(|coefficient| coefficient.value));
        let coefficient_rests =
            std::array::from_fn(|n| exact[n + 2].map(|coefficient| coefficient.rest));
        let mut bent = responses;
        (bent[0], bent[1]) = ([R::ZERO; 2], [R::ZERO; 2]);
        let square = DoubleDouble::new(reach).times(reach);
        let leading: [DoubleDouble<R>; 2] =
            std::array::from_fn(|i| (exact[0][i] + exact[1][i].times(reach)).times_sum(square));
        let rounded = even_and_odd(&bent, reach).map(|sum| reach * reach * sum);
        let full_step_rest =
            std::array::from_fn(|i| (horner(&exact, i, reach) - leading[i]).minus(rounded[i]));
        let loss = loss_series(stiffness, damping, damping_ratio * 2.0);
        Self {
            equation,
            reach,
            responses,
            bent,
            coefficient_rests,
            full_step_rest,
            exact,
            loss,
            full_loss: even_and_odd(&loss, reach),
        }
    }

    /// ẍ of a state in double-double: it may be a small difference of spring and damper force.
    #[inline]
    pub fn acceleration(&self, primary: &Primary<R>) -> DoubleDouble<R> {
        self.next(primary.x, primary.v)
    }

    /// The next derivative of x from the two before it, in double-double.
    #[inline(always)]
    fn next(&self, lower: DoubleDouble<R>, upper: DoubleDouble<R>) -> DoubleDouble<R> {
        let Equation { stiffness, damping, .. } = self.equation;
        let spring =
            if stiffness == 1.0 { lower } else { lower.product(DoubleDouble::new(stiffness)) };
        -(spring + upper.product(DoubleDouble::new(damping)))
    }

    /// The gain of displacement and velocity in a flight of length h ≤ `reach`. The terms up to h³ are in
    /// double-double, so only the terms from h⁴ on have rounding errors.
    #[inline(always)]
    pub fn arrive(
        &self,
        velocity: DoubleDouble<R>,
        acceleration: DoubleDouble<R>,
        h: R,
    ) -> Arrival<R> {
        let (v, a) = (velocity.value, acceleration.value);
        let Equation { stiffness: k, damping: c, third, .. } = self.equation;
        let length = DoubleDouble::new(h);
        let half_square = length.product(length).half();
        let sixth_cube = half_square.product(length).product(third);
        let z = h * h;
        let [p, q] = even_and_odd(&self.bent, h).map(|sum| z * sum);
        let square = z * z;
        let [p_rest, q_rest] = even_and_odd(&self.coefficient_rests, h).map(|sum| square * sum);
        let full = h == self.reach;
        let p_rest = if full { self.full_step_rest[0] } else { p_rest };
        let q_rest = if full { self.full_step_rest[1] } else { q_rest };
        let jerk = self.next(velocity, acceleration);
        let snap = self.next(acceleration, jerk);
        let curved = acceleration.product(half_square).plus_both(
            jerk.product(sixth_cube),
            DoubleDouble { value: a * p + v * q, rest: a * p_rest + v * q_rest },
        );
        let bent = DoubleDouble {
            value: a * (q - c * p) - k * (v * p),
            rest: a * (q_rest - c * p_rest) - k * (v * p_rest),
        };
        Arrival {
            curved,
            velocity: acceleration
                .product(length)
                .plus_both(jerk.product(half_square), snap.product(sixth_cube))
                .plus_parts(bent.value, bent.rest),
        }
    }

    /// x(h) − x − v h in double-double, for h ≤ `reach`. Expensive: called only where a grazing is to be
    /// decided.
    pub fn precise(
        &self,
        velocity: DoubleDouble<R>,
        acceleration: DoubleDouble<R>,
        h: R,
    ) -> DoubleDouble<R> {
        let forced = acceleration.times_sum(horner(&self.exact, 0, h));
        let carried = velocity.times_sum(horner(&self.exact, 1, h));
        forced.plus_parts(carried.value, carried.rest)
    }

    /// x and its derivatives after a flight of length h ≤ `reach`, with errors of some units in the last
    /// place.
    #[inline(always)]
    pub(crate) fn jet(&self, x: R, v: R, a: R, h: R) -> Jet<R> {
        let [curved, gained, curvature] = self.ahead(v, a, h);
        let (value, rate) = (x + (v * h + curved), v + gained);
        Jet { value, rate, curvature, jerk: self.equation.next_derivative(rate, curvature) }
    }

    /// x(h) − x − v h, v(h) − v and a(h), with errors of some units in the last place.
    #[inline(always)]
    pub(crate) fn ahead(&self, v: R, a: R, h: R) -> [R; 3] {
        let z = h * h;
        let [p, q] = even_and_odd(&self.responses, h).map(|sum| z * sum);
        let Equation { stiffness: k, damping, .. } = self.equation;
        let s = h + (q - damping * p);
        let curvature = a + (self.equation.next_derivative(v, a) * s - k * (a * p));
        [a * p + v * q, a * s - k * (v * p), curvature]
    }

    /// Energy lost in the damper over a flight of length h ≤ `reach`: ∫ 2ζ v² dt, summed from the
    /// power series of the integral (not a difference of energies).
    #[inline(always)]
    pub fn viscous_loss(&self, x: R, v: R, h: R) -> R {
        if h == self.reach {
            loss(&self.full_loss, x, v, h)
        } else {
            self.viscous_loss_series(x, v, h)
        }
    }

    /// [`Oscillator::viscous_loss`] by the power series for every h.
    #[inline(always)]
    pub(crate) fn viscous_loss_series(&self, x: R, v: R, h: R) -> R {
        loss(&even_and_odd(&self.loss, h), x, v, h)
    }
}

/// The gain of displacement and velocity in a flight.
#[derive(Debug, Clone, Copy)]
pub struct Arrival<R = f64> {
    /// x(h) − x − v h.
    pub curved: DoubleDouble<R>,
    /// v(h) − v.
    pub velocity: DoubleDouble<R>,
}

/// A state of the primary, in double-double.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Primary<R = f64> {
    /// Displacement.
    pub x: DoubleDouble<R>,
    /// Velocity.
    pub v: DoubleDouble<R>,
}

laned!(Primary, Primaries { x: DoubleDouble, v: DoubleDouble });

impl<R: Real> Primary<R> {
    /// The state after its velocity has increased.
    pub fn faster_by(&self, gained: DoubleDouble<R>) -> Primary<R> {
        Primary { v: self.v + gained, ..*self }
    }

    /// The state after a flight of length h, and the gain of displacement and velocity in it.
    #[inline(always)]
    pub fn arrived(
        &self,
        oscillator: &Oscillator<R>,
        a: DoubleDouble<R>,
        h: R,
    ) -> (Primary<R>, Arrival<R>) {
        let arrival = oscillator.arrive(self.v, a, h);
        let later = Primary {
            x: self.x.plus_both(self.v.product(DoubleDouble::new(h)), arrival.curved),
            v: self.v + arrival.velocity,
        };
        (later, arrival)
    }

    /// The state after its velocity has jumped by `sign` · `share` · `velocity`.
    #[inline]
    pub fn jumped(
        &self,
        sign: impl Into<R>,
        velocity: DoubleDouble<R>,
        share: DoubleDouble<R>,
    ) -> Primary<R> {
        let sign = sign.into();
        let kick = share.value * (sign * velocity.value);
        let rest = sign * (share.value * velocity.rest + share.rest * velocity.value);
        Primary { x: self.x, v: self.v.plus_parts(kick, rest) }
    }
}

/// The viscous loss in a flight of length h from the sums of its three series.
#[inline(always)]
fn loss<R: Real>(sums: &[R; 3], x: R, v: R, h: R) -> R {
    h * (x * x * sums[0] + x * v * sums[1] + v * v * sums[2])
}

/// P (i = 0) or Q (i = 1) at h, in double-double.
fn horner<R: Real>(responses: &[[DoubleDouble<R>; 2]; TERMS], i: usize, h: R) -> DoubleDouble<R> {
    let mut sum = DoubleDouble::<R>::ZERO;
    for coefficients in responses.iter().rev() {
        sum = sum.times(h).plus_parts(coefficients[i].value, coefficients[i].rest);
    }
    sum.times(h).times(h)
}

/// K polynomials at one argument, N even, as sums over even and odd powers; each product and sum is rounded
/// once.
#[inline(always)]
fn even_and_odd<R: Real, const K: usize, const N: usize>(series: &[[R; K]; N], h: R) -> [R; K] {
    const { assert!(N.is_multiple_of(2)) }
    let z = h * h;
    let [mut even, mut odd] = [series[N - 2], series[N - 1]];
    for pair in (0..N / 2 - 1).rev() {
        for k in 0..K {
            even[k] = even[k].mul_add(z, series[2 * pair][k]);
            odd[k] = odd[k].mul_add(z, series[2 * pair + 1][k]);
        }
    }
    std::array::from_fn(|k| odd[k].mul_add(h, even[k]))
}

/// Coefficients of h², h³, … of P and Q, from P⁽ⁿ⁺²⁾ = −k P⁽ⁿ⁾ − c P⁽ⁿ⁺¹⁾ (n ≥ 1) and Q̇ = −k P. The first
/// [`EXACT_TERMS`] are in double-double.
fn responses<R: Real>(stiffness: R, damping: R) -> [[DoubleDouble<R>; 2]; TERMS] {
    let mut series = [[DoubleDouble::ZERO; 2]; TERMS];
    let [mut lower, mut upper] = [DoubleDouble::ZERO, DoubleDouble::new(R::ONE * 0.5)];
    series[0] = [upper, DoubleDouble::ZERO];
    for (n, coefficients) in series.iter_mut().enumerate().skip(1) {
        let (p, q) = ((n + 1) as f64, (n + 2) as f64);
        let (step, carried) = if n < EXACT_TERMS {
            let spring = lower.times(-stiffness).over(p * q);
            let damper = upper.times(-damping).over(q);
            (spring.plus_parts(damper.value, damper.rest), upper.times(-stiffness).over(q))
        } else {
            let step = -(stiffness * lower.value / p + damping * upper.value) / q;
            (DoubleDouble::new(step), DoubleDouble::new(-stiffness * upper.value / q))
        };
        *coefficients = [step, carried];
        (lower, upper) = (upper, step);
    }
    series
}

/// Coefficients of h, h², … of ∫ 2ζ v² for the three products x², x v, v² of the starting state,
/// from (x²)˙ = 2 x v, (x v)˙ = v² − k x² − c x v, (v²)˙ = −2k x v − 2c v².
fn loss_series<R: Real>(stiffness: R, damping: R, viscous: R) -> [[R; 3]; LOSS_TERMS] {
    let mut series = [[R::ZERO; 3]; LOSS_TERMS];
    for product in 0..3 {
        let mut y = [R::ZERO; 3];
        y[product] = R::ONE;
        for (n, coefficients) in series.iter_mut().enumerate() {
            let order = (n + 1) as f64;
            let [xx, xv, vv] = y;
            coefficients[product] = viscous * vv / order;
            y = [
                xv * 2.0 / order,
                (vv - stiffness * xx - damping * xv) / order,
                -(stiffness * xv + damping * vv) * 2.0 / order,
            ];
        }
    }
    series
}
