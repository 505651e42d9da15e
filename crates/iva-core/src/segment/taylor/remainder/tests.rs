//! The bounds against series of a much higher order.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::force::{Acts, Force, Harmonic};
use crate::number::compensated::DoubleDouble;
use crate::segment::taylor::{Spring, Swing};

/// Longer than any series in use.
const LONG: usize = 121;

#[test]
fn no_series_leaves_out_more_than_its_bound() {
    // From calm to violent: small and large angles, slow and fast, heavy and light, up to 120°.
    let mut ratios = Vec::new();
    for index in 0..400u32 {
        let part = |k: u32| f64::from((index * k + k / 2) % 101) / 100.0;
        let kappa = 1.0 + part(13) * part(7);
        let lever = 0.6 + part(29);
        let angle = 2.1 * part(17) - 1.0;
        let small_angles = index % 7 == 0;
        let pendulum = Pendulum {
            mass_ratio: 0.01 + 2.0 * part(31) * part(5),
            damping_ratio: 0.3 * part(3),
            contact_distance: 2.0,
            inertia_ratio: kappa,
            lever,
            coupling: 1.0 / (kappa * lever),
            frequency_squared: 4.0 * part(11) * part(19),
            pivot_damping: 0.4 * part(23),
            spring: Spring::new(if index % 3 == 0 { 3.0 * part(61) } else { 0.0 }, small_angles),
            small_angles,
            level: 1.0,
            rise: 0.0,
        };
        let (y, cosine) = (2.0 * angle.sin(), if small_angles { 1.0 } else { angle.cos() });
        let start = Swing {
            x: part(37) - 0.5,
            u: part(41) - 0.5,
            y,
            w: 4.0 * (part(43) - 0.5),
            c: cosine,
            arc: pendulum.arc(y, cosine),
        };
        // Every other scene is driven, now and then hard and fast, by force or base.
        let acts = if index % 4 == 1 { Acts::Primary } else { Acts::Base };
        let harmonic = Harmonic {
            amplitude: 3.0 * part(47),
            frequency: 0.2 + 3.0 * part(53),
            phase: part(59),
            acts,
        };
        let driven = index % 2 == 1;
        let force = Force::harmonic(Vec::from_iter(driven.then_some(harmonic))).unwrap();
        let fastest = pendulum.fastest().max(force.fastest());
        for (order, h) in [(10, 0.5), (16, 0.6), (20, 0.4), (20, 1.0)] {
            let (near, far) =
                (force.drive(DoubleDouble::ZERO, h), force.drive(DoubleDouble::ZERO, h));
            let short = pendulum.series::<f64, { ORDER + 1 }>(&start, Some(&near), h, order);
            let long = pendulum.series::<f64, LONG>(&start, Some(&far), h, LONG - 1);
            for most in [0.6, 1.0] {
                let driven = with_order!(order, N => force.left_out::<N>(h * most));
                let remainder = with_order!(
                    order, N => Remainder::new::<N>(&pendulum, fastest, &short, driven, (h, most))
                );
                // Steps of this length are in use.
                if h * most * fastest.max(pendulum.swing(start.w)) <= 0.75 {
                    assert!(remainder.proves(), "{index}, order {order}, {h}");
                }
                if !remainder.proves() {
                    continue;
                }
                for share in [most, 0.7 * most] {
                    if remainder.within(share) > 1.0 {
                        continue;
                    }
                    let beyond = |row: &[f64; LONG]| {
                        let from_there = row[order + 1..].iter().rev();
                        let sum =
                            from_there.fold(0.0, |sum, coefficient| sum * share + coefficient);
                        (sum * share.powi(order as i32 + 1)).abs()
                    };
                    let left_out = remainder.left_out(share);
                    let errors = [
                        beyond(&long.x).max(beyond(&long.u)),
                        beyond(&long.y)
                            .max(beyond(&long.w) / fastest)
                            .max(pendulum.contact_distance * beyond(&long.c)),
                    ];
                    for (error, bound) in errors.into_iter().zip(left_out) {
                        assert!(error <= bound, "{index}, order {order}, {h}: {error} > {bound}");
                        if bound > 0.0 {
                            ratios.push(error / bound);
                        }
                    }
                }
            }
        }
    }
    // The bounds are not idle: half of the errors are above a twentieth of them.
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    assert!(ratios.len() > 5000 && median > 0.05, "{} bounds, median {median}", ratios.len());
}
