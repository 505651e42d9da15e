//! Bounds on the motion of a driven structure.
//!
//! With q = k f/M − a_g the pair z = (√k x, ẋ) obeys ż = M z + q e₂, |M| ≤ Λ, and |e^{Mt}| ≤ 1. Hence, in a
//! motion of length L,
//!
//! ```text
//! |A⁽ⁿ⁾| ≤ Λⁿ⁺¹ (ρ + L q₀) + Σ_{i ≤ n} Λⁿ⁻ⁱ q_i + g_n
//! ```
//!
//! where q_i and g_n bound the derivatives of q and a_g. Gravity G along the motion adds |G| to A, and the lift
//! μG of the spring |μG| to f/M.

use std::array::from_fn;

use super::{Forces, Source, Weight};
use crate::host::oscillator::Equation;
use crate::number::real::Real;

/// Bounds on a_g and its first four derivatives, and the contribution of the drive to the bounds on A and its
/// first six.
pub(super) fn bounds<R: Real>(
    equation: &Equation<R>,
    source: &Forces<R>,
    reach: R,
) -> ([R; 5], [R; 7]) {
    let Equation { stiffness, growth, .. } = *equation;
    let largest: [[R; 2]; 7] = from_fn(|order| largest(source, order as i32));
    let drive = largest.map(|[f, g]| stiffness * f + g);
    let mut powers = [R::ONE; 8];
    for n in 1..powers.len() {
        powers[n] = powers[n - 1] * growth;
    }
    let excess = from_fn(|n| {
        let sum = (0..=n).fold(R::ZERO, |sum, i| sum + powers[n - i] * drive[i]);
        let gravity = source.weight().filter(|_| n == 0).map_or(R::ZERO, |it| it.gravity.abs());
        powers[n + 1] * (reach * drive[0]) + sum + (largest[n][1] + gravity)
    });
    (from_fn(|order| largest[order][1]), excess)
}

/// Bounds on the derivative of this order of f/M (with the lift of the spring) and of a_g, within smooth
/// pieces.
fn largest<R: Real>(source: &Forces<R>, order: i32) -> [R; 2] {
    let [f, g] = source.force.largest(order);
    match source.weight().filter(|_| order == 0) {
        None => [f, g],
        Some(Weight { lift, .. }) => [f + lift.value.abs(), g],
    }
}
