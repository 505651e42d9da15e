//! Bounds on the motion of a driven structure.
//!
//! With q = k f/M − a_g the pair z = (√k x, ẋ) obeys ż = M z + q e₂, |M| ≤ Λ, and |e^{Mt}| ≤ 1. Hence, in a
//! motion of length L,
//!
//! ```text
//! |A⁽ⁿ⁾| ≤ Λⁿ⁺¹ (ρ + L q₀) + Σ_{i ≤ n} Λⁿ⁻ⁱ q_i + g_n
//! ```
//!
//! where q_i and g_n bound the derivatives of q and a_g. Gravity G along the motion adds to A, and the lift
//! μG of the spring to f/M.

use super::{Forces, Source, Weight};
use crate::oscillator::Equation;
use crate::real::Real;

/// Bounds on the derivative of this order of f/M (with the lift of the spring) and of a_g, within smooth
/// pieces.
pub(super) fn largest<R: Real>(source: &Forces<R>, order: i32) -> [R; 2] {
    let [f, g] = source.force.largest(order);
    match source.weight().filter(|_| order == 0) {
        None => [f, g],
        Some(Weight { lift, .. }) => [f + lift.value, g],
    }
}

/// The contribution of the drive to the bound on the derivative of A of this order.
pub(super) fn exceeding<R: Real>(
    equation: &Equation<R>,
    source: &Forces<R>,
    reach: R,
    order: i32,
) -> R {
    let Equation { stiffness, growth, .. } = *equation;
    let drive = |order: i32| {
        let [f, g] = largest(source, order);
        stiffness * f + g
    };
    let power = |n: i32| (0..n).fold(R::ONE, |power, _| power * growth);
    let sum = (0..=order).fold(R::ZERO, |sum, i| sum + power(order - i) * drive(i));
    let gravity = source.weight().filter(|_| order == 0).map_or(R::ZERO, |weight| weight.gravity);
    power(order + 1) * (reach * drive(0)) + sum + (largest(source, order)[1] + gravity)
}
