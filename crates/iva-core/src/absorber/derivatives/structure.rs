//! Derivatives of the motion of a structure, alone or with an absorber stuck to it, which is linear.

use nalgebra::Matrix4;

use crate::host::oscillator::Equation;

/// x and ẋ after a time h from (x, ẋ) = (1, 0) and from (0, 1): the columns of the flow.
///
/// From (0, 1) by the power series over h/2ⁿ, from (1, 0) by x = p′ + c p and ẋ = −k p with p that motion; the
/// flow over twice the time is its square.
#[inline(always)]
pub(crate) fn columns(equation: &Equation, h: f64) -> [[f64; 2]; 2] {
    let Equation { stiffness, damping, growth, .. } = *equation;
    let mut doublings = 0;
    let mut step = h;
    while step * growth > STEP {
        step *= 0.5;
        doublings += 1;
    }
    let (mut lower, mut upper, mut factor) = (0.0, 1.0, 1.0);
    let [mut x, mut v] = [0.0; 2];
    for over in OVER {
        (x, v) = (x + factor * lower, v + factor * upper);
        factor *= step * over;
        (lower, upper) = (upper, equation.next_derivative(lower, upper));
    }
    for _ in 0..doublings {
        let displaced = v + damping * x;
        (x, v) = (x * (displaced + v), v * v - stiffness * (x * x));
    }
    [[v + damping * x, -stiffness * x], [x, v]]
}

/// The derivative of the motion of a structure with an absorber stuck to it, over a time h.
pub(super) fn stuck(equation: &Equation, h: f64) -> Matrix4<f64> {
    let [[xx, vx], [xv, vv]] = columns(equation, h);
    Matrix4::new(
        xx, xv, 0.0, 0.0, //
        vx, vv, 0.0, 0.0, //
        0.0, 0.0, 0.0, 0.0, //
        0.0, 0.0, 0.0, 0.0,
    )
}

/// The longest step of the power series, times the growth.
const STEP: f64 = 0.5;
/// 1/k for its terms: what follows them is below 10⁻¹⁷.
const OVER: [f64; 14] = {
    let mut over = [0.0; 14];
    let mut k = 0;
    while k < 14 {
        over[k] = 1.0 / (k + 1) as f64;
        k += 1;
    }
    over
};
