//! The summation of a chatter by itself: a ball on a table at rest, whose bounces have a closed form. Dropped
//! from h it comes to rest after √(2h/g)(1+e)/(1−e).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::chatter::Rebound;
use iva_tests::dd::Dd;

/// h, e, g (taken as the doubles nearest to these decimals), time of the first touch √(2h/g),
/// duration of the rebounds after it 2e√(2gh)/(g(1−e)), their sum; 40-digit arithmetic.
const BALL: [[&str; 6]; 5] = [
    [
        "10",
        "0.8",
        "9.81",
        "1.4278431229270644308",
        "11.422744983416518617",
        "12.850588106343583047",
    ],
    ["1", "0.5", "9.81", "0.451523640985730893", "0.90304728197146178601", "1.354570922957192679"],
    ["1", "0.9", "1", "1.4142135623730950488", "25.455844122715717159", "26.870057685088812208"],
    [
        "1e-6",
        "0.99",
        "1",
        "0.0014142135623730950168",
        "0.28001428534987256211",
        "0.28142849891224565713",
    ],
    ["1", "0.1", "2", "1", "0.22222222222222223593", "1.2222222222222222359"],
];

/// A rebound of a ball: the pressure is constant and not changed by impacts.
fn rebound(speed: f64, gravity: f64, restitution: f64) -> Rebound {
    let (ratio, spread) = (restitution, 0.0);
    Rebound { speed, pressure: gravity, ratio, spread, ..Rebound::default() }
}

#[test]
fn the_sum_of_all_bounces_is_right_to_four_ulps() {
    for row in BALL {
        let [h, e, g, first, rest, all] = row.map(Dd::parse);
        let (h, e, g) = (h.value(), e.value(), g.value());
        let speed = (Dd::from(2.0) * g * h).sqrt();
        let tail = rebound((speed * e).value(), g, e).tail();
        let ulps = |found: Dd, truth: Dd| {
            ((found - truth) / (f64::EPSILON * 2f64.powi(truth.hi.log2().floor() as i32))).abs().hi
        };
        assert!(ulps(tail.into(), rest) <= 4.0, "{row:?}: {tail}");
        assert!(ulps(first + tail, all) <= 4.0, "{row:?}");
        // The result does not depend on the bounce after which the sum begins.
        let (mut time, mut speed) = (first, speed * e);
        for bounces in 1..=40 {
            time = time + speed * 2.0 / g;
            speed = speed * e;
            let sum = time + rebound(speed.value(), g, e).tail();
            assert!(ulps(sum, all) <= 4.0, "{row:?}, {bounces} bounces");
        }
    }
}

#[test]
fn the_tenth_impact_comes_before_the_end_by_the_tail_after_it() {
    // h = 1, e = ½, g = 9.81: tenth impact 1.352807158734592, end 1.354570922957193 (both to
    // sixteen digits): the tail after the tenth impact is their difference.
    let speed = (2.0f64 * 9.81).sqrt() * 0.5f64.powi(10);
    let tail = rebound(speed, 9.81, 0.5).tail();
    assert!((1.352_807_158_734_592 + tail - 1.354_570_922_957_193).abs() <= 1e-15);
}
