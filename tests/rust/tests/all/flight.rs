//! Flight alone, in a gap too wide to be closed, for every damping ratio: compared with the power series in
//! double-double and with nalgebra's matrix exponential.
//!
//! The bound is the contract on event times, applied to the motion: six units of 2⁻⁵³ (1 + t) times
//! the initial size.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{absorber::Start, run::states, simulate::Limits, siva::Siva};
use iva_tests::{U, UNITS_ALLOWED, dd::Dd};

/// Clearance that no flight here reaches: |y| ≤ |x0| + |ẋ0| t + |x| < 94.
const WIDE: f64 = 128.0;

/// Free flight as the simulator computes it, in a gap too wide to be closed: x, ẋ, y.
fn flights(zeta: f64, x: f64, v: f64, times: &[f64]) -> Vec<(f64, f64, f64)> {
    let absorber = Siva::new(0.1, 0.5, WIDE, zeta).unwrap();
    let start = Start { displacement: x, velocity: v, ..Start::default() };
    let limits = Limits::new(times[times.len() - 1], WIDE);
    states(&absorber, &start, &limits, times)
        .unwrap()
        .iter()
        .map(|s| (s.displacement, s.velocity, s.gap_displacement))
        .collect()
}

#[test]
fn flight_is_right_for_every_damping_ratio() {
    // Truth: the power series in double-double. Bound: six units of the initial size.
    let times: Vec<f64> = [1e-9, 1e-6, 1e-3]
        .into_iter()
        .chain((1..=240).step_by(iva_tests::stride()).map(|k| f64::from(k) * 0.125))
        .collect();
    for zeta in [0.0, 0.01, 0.5, 0.99, 0.999_999, 1.0, 1.000_001, 1.01, 1.5, 5.0, 30.0] {
        for (x, v) in [(1.0, 0.0), (0.0, 1.0), (1.0, -3.0), (-0.3, 0.7)] {
            for (&t, (found_x, found_v, found_y)) in times.iter().zip(flights(zeta, x, v, &times)) {
                let (true_x, true_v) =
                    iva_tests::flight::free(x.into(), v.into(), zeta.into(), t.into());
                let size = f64::hypot(x, v);
                let allowed = UNITS_ALLOWED * U * (1.0 + t) * size;
                let place = format!("ζ = {zeta}, ({x}, {v}), t = {t}");
                assert!((true_x - found_x).abs().hi <= allowed, "x, {place}: {found_x}");
                // The velocity changes with ẍ: up to 2ζ|ẋ| + |x| per unit time or, where that is fast, per
                // unit of x.
                let steep = 1.0f64.max(2.0 * zeta);
                assert!((true_v - found_v).abs().hi <= allowed * steep, "ẋ, {place}: {found_v}");
                // y = x0 + ẋ0 t − x (the absorber starts with the primary system's velocity)
                let y = Dd::from(x) + Dd::from(v) * t - true_x;
                // The gap may be computed as a distance to a wall: roundings of d are added.
                let allowed = allowed + 2.0 * U * WIDE;
                assert!((y - found_y).abs().hi <= allowed, "y, {place}: {found_y}");
            }
        }
    }
}

#[test]
fn flight_is_the_matrix_exponential() {
    use nalgebra::{Matrix2, Vector2};
    // The exponential by scaling and squaring is backward stable: error ≤ c u ‖A‖t of the result
    // for these near-normal matrices, c some ten (Higham 2005, Table 2.1 and Theorem 2.1).
    for zeta in [0.0, 0.05, 0.7, 1.0, 1.3] {
        let times: Vec<f64> = (1..=60).map(|k| f64::from(k) * 0.21).collect();
        let matrix = Matrix2::new(0.0, 1.0, -1.0, -2.0 * zeta);
        let norm = 1.0 + 2.0 * zeta;
        for (&t, (x, v, _)) in times.iter().zip(flights(zeta, 0.8, -0.4, &times)) {
            let truth = (matrix * t).exp() * Vector2::new(0.8, -0.4);
            let allowed = U * (UNITS_ALLOWED * (1.0 + t) + 16.0 * (1.0 + norm * t)) * norm;
            assert!((x - truth[0]).abs() <= allowed, "ζ = {zeta}, t = {t}: {x} for {}", truth[0]);
            assert!((v - truth[1]).abs() <= allowed, "ζ = {zeta}, t = {t}: {v} for {}", truth[1]);
        }
    }
}
