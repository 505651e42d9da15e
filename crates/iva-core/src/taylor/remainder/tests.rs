//! The bounds against coefficients of higher order, which they have not seen.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::compensated::DoubleDouble;
use crate::force::{Acts, Harmonic};
use crate::taylor::Swing;

/// Longer than any series in use.
const LONG: usize = 121;

#[test]
fn no_later_coefficient_exceeds_its_bound() {
    // From calm to violent: small and large angles, slow and fast, heavy and light, up to 120°.
    let mut seen = 0.0f64;
    for index in 0..400u32 {
        let part = |k: u32| f64::from((index * k + k / 2) % 101) / 100.0;
        let kappa = 1.0 + part(13) * part(7);
        let lever = 0.6 + part(29);
        let angle = 2.1 * part(17) - 1.0;
        let pendulum = Pendulum {
            mass_ratio: 0.01 + 2.0 * part(31) * part(5),
            damping_ratio: 0.3 * part(3),
            contact_distance: 2.0,
            inertia_ratio: kappa,
            lever,
            coupling: 1.0 / (kappa * lever),
            frequency_squared: 4.0 * part(11) * part(19),
            pivot_damping: 0.4 * part(23),
            small_angles: index % 7 == 0,
        };
        let cosine = if pendulum.small_angles { 1.0 } else { angle.cos() };
        let start = Swing {
            x: part(37) - 0.5,
            u: part(41) - 0.5,
            y: 2.0 * angle.sin(),
            w: 4.0 * (part(43) - 0.5),
            c: cosine,
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
        for (order, h) in [(10, 0.5), (16, 0.6), (20, 0.4), (20, 1.0)] {
            let (near, far) = (
                force.drive(DoubleDouble::ZERO, DoubleDouble::ZERO, h),
                force.drive(DoubleDouble::ZERO, DoubleDouble::ZERO, h),
            );
            let short = pendulum.series::<f64, { ORDER + 1 }>(&start, Some(&near), h, order);
            let long = pendulum.series::<f64, LONG>(&start, Some(&far), h, LONG - 1);
            let remainder = Remainder::prove(&pendulum, &short, &force, h, order).unwrap();
            let Tail { x, u, y, c, w, .. } = remainder.tail;
            for k in order + 1..LONG {
                let bound = power(remainder.ratio, k) / ((k + 1) * (k + 1)) as f64;
                for (row, constant) in
                    [(&long.x, x), (&long.u, u), (&long.y, y), (&long.c, c), (&long.w, w)]
                {
                    let ratio = row[k].abs() / (constant * bound);
                    assert!(ratio <= 1.0 || row[k] == 0.0, "{index}, order {order}, {k}: {ratio}");
                    seen = seen.max(if row[k] == 0.0 { 0.0 } else { ratio });
                }
            }
        }
    }
    // The bounds are not idle: somewhere a coefficient comes near.
    assert!(seen > 0.05, "{seen}");
}
