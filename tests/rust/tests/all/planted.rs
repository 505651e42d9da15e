//! Contacts near tangency with known outcome: the first extremum of the gap displacement is computed in
//! double-double, and the wall is placed at a chosen distance beyond or before it.
//!
//! Outside the band of 32 · 2⁻⁵³ · max(d, |y|) hit or miss must be right, and nothing undecided; inside it
//! the answer may be "undecided" (which counts as no contact) or must be right.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{absorber::Start, run::run, simulate::Limits, siva::Siva};
use iva_tests::{
    U, UNITS_ALLOWED,
    dd::Dd,
    flight::{Segment, free, root},
};
use proptest::prelude::*;

/// A start from which the gap displacement runs into a first extremum.
#[derive(Debug, Clone, Copy)]
struct Approach {
    zeta: f64,
    start: Start,
}

/// The first extremum of y: time, y, and |ÿ| there.
struct Extremum {
    time: Dd,
    y: Dd,
    curvature: f64,
}

impl Approach {
    /// Velocity of the absorber, constant in flight.
    fn drift(&self) -> Dd {
        Dd::sum(self.start.velocity, self.start.gap_velocity)
    }

    /// y and w = ẏ at an instant.
    fn gap(&self, time: Dd) -> (Dd, Dd) {
        let s = &self.start;
        let (x, v) = free(s.displacement.into(), s.velocity.into(), self.zeta.into(), time);
        let from = Dd::sum(s.displacement, s.gap_displacement);
        (from + self.drift() * time - x, self.drift() - v)
    }

    /// The first zero of w after the start within 12 units of time. Steps of at most a tenth and the zeros of
    /// ẍ between them ensure that none is missed.
    fn extremum(&self) -> Option<Extremum> {
        let zeta = Dd::from(self.zeta);
        let (mut x, mut v) = (Dd::from(self.start.displacement), Dd::from(self.start.velocity));
        let mut time = Dd::ZERO;
        while time.hi < 12.0 {
            let segment = Segment::new(x, v, zeta, Dd::ONE);
            let step = Dd::from(segment.length.min(0.1));
            let rate = |h: Dd| self.drift() - segment.at(h).1;
            let acceleration = |h: Dd| segment.at(h).2;
            let mut cuts = vec![Dd::ZERO, step];
            if acceleration(Dd::ZERO).hi * acceleration(step).hi < 0.0 {
                let jerk = |h: Dd| -(segment.at(h).1 + zeta * 2.0 * acceleration(h));
                cuts.insert(1, root(|h| (acceleration(h), jerk(h)), Dd::ZERO, step));
            }
            for piece in cuts.windows(2) {
                if rate(piece[0]).hi * rate(piece[1]).hi < 0.0 {
                    let h = root(|h| (rate(h), -acceleration(h)), piece[0], piece[1]);
                    let time = time + h;
                    let curvature = acceleration(h).abs().hi;
                    return Some(Extremum { time, y: self.gap(time).0, curvature });
                }
            }
            (x, v, _) = segment.at(step);
            time = time + step;
        }
        None
    }

    /// The contact with a wall at `level` (with the sign of the extremum) before the extremum. y must be
    /// inside the wall at the start and monotonic from there to the extremum.
    fn contact(&self, level: Dd, extremum: &Extremum) -> Dd {
        root(
            |time| {
                let (y, w) = self.gap(time);
                (y - level, w)
            },
            Dd::ZERO,
            extremum.time,
        )
    }
}

prop_compose! {
    fn approach()(
        zeta in prop_oneof![2 => Just(0.0), 2 => 1e-4..0.05, 1 => 0.05..0.9],
        x in prop_oneof![1 => Just(1.0), 3 => -1.0..1.0],
        v in prop_oneof![1 => Just(0.0), 3 => -1.0..1.0],
        y in prop_oneof![1 => Just(0.0), 3 => -0.5..0.5],
        drift in prop_oneof![2 => Just(0.0), 3 => -0.4..0.4],
    ) -> Approach {
        let start = Start {
            displacement: x,
            velocity: v,
            gap_displacement: y,
            gap_velocity: drift - v,
        };
        Approach { zeta, start }
    }
}

prop_compose! {
    /// Spring and damper force balance at the start, and the first extremum comes so soon that the gap is
    /// small against the displacement: y is a small difference of large terms.
    fn balanced()(
        zeta in 0.05..3.0,
        v in prop_oneof![-1.0..-0.01, 0.01..1.0],
        unbalance in prop_oneof![1 => Just(0.0), 2 => -1e-9..1e-9, 1 => -1e-3..1e-3],
        exponent in -3.0..-0.5,
    ) -> Approach {
        let x = -2.0 * zeta * v + unbalance;
        // ẏ = w − j h²/2 with j = −v, and w such that it vanishes at h
        let h = 10f64.powf(exponent);
        let start = Start {
            displacement: x,
            velocity: v,
            gap_displacement: 0.0,
            gap_velocity: -0.5 * v * h * h,
        };
        Approach { zeta, start }
    }
}

/// Relative distance of the wall beyond (+) or before (−) the extremum.
fn shift() -> impl Strategy<Value = f64> {
    (prop_oneof![Just(1.0), Just(-1.0)], -14.0..-2.0)
        .prop_map(|(s, p): (f64, f64)| s * 10f64.powf(p))
}

/// The result of a run with a planted wall.
struct Planted {
    /// |extremum| − d, exact: positive if the wall is hit.
    over: f64,
    /// The band 32 · 2⁻⁵³ · max(d, |y|).
    band: f64,
    impacts: usize,
    undecided: u64,
    /// Error of the time of the hit, and the error allowed.
    hit: Option<(f64, f64)>,
}

/// Places the wall at |extremum| (1 + shift) and runs past the extremum. `None` where the start is not a
/// plain approach: y must move towards the extremum from well inside the gap.
fn plant(approach: &Approach, shift: f64, mu: f64, e: f64) -> Option<Planted> {
    let extremum = approach.extremum()?;
    let side = extremum.y.hi.signum();
    let size = extremum.y.abs();
    let start = &approach.start;
    let reach = start.displacement.hypot(start.velocity) + start.gap_displacement.abs();
    // Well inside the gap at first, moving towards the wall of the extremum (not away from the other one).
    if start.gap_displacement.abs() > 0.9 * size.hi {
        return None;
    }
    if (extremum.y - start.gap_displacement).hi * side <= 0.0 || extremum.curvature < 1e-5 {
        return None;
    }
    let clearance = (size * (Dd::ONE + shift)).value();
    let over = (size - clearance).value();
    // After the extremum y moves back with |ÿ| ≤ reach: the other wall, 2d away, is not met within
    // √(2·2d/reach), nor the same wall again before another extremum. As |x⃛| ≤ reach, ÿ keeps its sign for
    // curvature/reach.
    let after = (0.5 * extremum.curvature / (2.0 * reach)).min((clearance / reach).sqrt());
    let duration = extremum.time.hi + after.min(0.3);
    let siva = Siva::new(mu, e, clearance, approach.zeta).unwrap();
    let run = run(&siva, start, &Limits::new(duration, clearance)).unwrap();
    let hit = (over > 0.0).then(|| {
        let truth = approach.contact(Dd::from(side * clearance), &extremum);
        let speed = approach.gap(truth).1.abs().hi;
        // A relative change of the inputs (x, ẋ, y, w, d) by one unit changes y at the wall by at most this,
        // and the time of the contact by 1/w of that.
        let time = truth.hi;
        let moved = reach + (1.0 + time) * (reach + approach.drift().abs().hi) + clearance;
        let allowed = UNITS_ALLOWED * U * ((moved / speed).max(1.0) + time);
        let error = run.impacts.first().map_or(f64::INFINITY, |impact| {
            assert_eq!(impact.wall.sign(), side);
            (truth - impact.time).abs().hi
        });
        (error, allowed)
    });
    let band = 32.0 * U * clearance.max(size.hi);
    Some(Planted { over, band, impacts: run.impacts.len(), undecided: run.tally.undecided, hit })
}

proptest! {
    #![proptest_config(iva_tests::rejecting(4000))]

    #[test]
    fn beyond_the_band_every_contact_is_found_and_none_invented(
        approach in prop_oneof![approach(), balanced()],
        shift in shift(),
        mu in 0.01..3.0,
        e in 0.0..1.0,
    ) {
        let planted = plant(&approach, shift, mu, e);
        prop_assume!(planted.is_some());
        let Planted { over, band, impacts, undecided, hit } = planted.unwrap();
        prop_assume!(over.abs() > band);
        prop_assert_eq!(undecided, 0, "over by {:e}", over);
        match hit {
            None => prop_assert_eq!(impacts, 0, "over by {:e}", over),
            Some((error, allowed)) => {
                prop_assert!(impacts >= 1, "missed, over by {over:e}");
                // A hit with an allowed error above the time since the tangent could not be checked.
                prop_assert!(error <= allowed, "off by {error:e} of {allowed:e}, over {over:e}");
            }
        }
    }

    #[test]
    fn inside_the_band_the_answer_is_undecided_or_right(
        approach in prop_oneof![approach(), balanced()],
        steps in -120i32..120,
        mu in 0.01..3.0,
    ) {
        // Walls a few roundings from the extremum, 2⁻⁵³ relative apart.
        let planted = plant(&approach, f64::from(steps) * U, mu, 0.5);
        prop_assume!(planted.is_some());
        let Planted { over, band, impacts, undecided, .. } = planted.unwrap();
        if over.abs() > band {
            prop_assert_eq!(undecided, 0);
        }
        if undecided == 0 {
            prop_assert_eq!(impacts > 0, over > 0.0, "over by {:e}", over);
        } else {
            // Undecided once, which counts as no contact.
            prop_assert_eq!((undecided, impacts), (1, 0));
        }
    }
}

/// Without damping, from displacement 1 at rest, y = 1 − cos τ: the extremum 2 is exact.
#[test]
fn every_wall_around_an_exact_tangent() {
    for steps in 1..=4000_i64 {
        // Doubles below and above 2 are 2⁻⁵² and 2⁻⁵¹ apart.
        let inside = f64::from_bits(2.0f64.to_bits() - steps as u64);
        let outside = f64::from_bits(2.0f64.to_bits() + steps as u64);
        for clearance in [inside, outside] {
            let siva = Siva::new(0.1, 0.5, clearance, 0.0).unwrap();
            let start = Start { displacement: 1.0, ..Start::default() };
            let run = run(&siva, &start, &Limits::new(4.0, clearance)).unwrap();
            let in_band = (clearance - 2.0).abs() <= 32.0 * U * clearance.max(2.0);
            let place = format!("{steps} steps: {clearance:?}");
            if run.tally.undecided == 0 {
                assert_eq!(run.impacts.len(), usize::from(clearance < 2.0), "{place}");
            } else {
                assert!(in_band, "{place}");
                assert_eq!((run.tally.undecided, run.impacts.len()), (1, 0), "{place}");
            }
        }
    }
}

/// A transversal return is never in the band, however low: rebounds of a chatter.
#[test]
fn low_rebounds_are_never_undecided() {
    for exponent in 2..=11 {
        let w = 10f64.powi(-exponent);
        // On wall +, pressed (x = 1: ÿ = +1 towards the wall), leaving at speed w: it returns after 2w/A,
        // A = 1 to order w.
        let siva = Siva::new(0.1, 0.9, 0.5, 0.0).unwrap();
        let start =
            Start { displacement: 1.0, velocity: 0.0, gap_displacement: 0.5, gap_velocity: -w };
        let limits = Limits { chatter_floor: 1e-14, ..Limits::new(1.0, 0.5) };
        let run = run(&siva, &start, &limits).unwrap();
        assert_eq!(run.tally.undecided, 0);
        // D = w h − (1 − cos h): h = 2w (1 + O(w²)); approach w (1 + O(w²))
        let first = &run.impacts[0];
        let rounding = 16.0 * U;
        assert!((first.time / (2.0 * w) - 1.0).abs() <= w * w + rounding, "{w}: {}", first.time);
        assert!((first.gap_velocity_before / w - 1.0).abs() <= w * w + rounding, "{w}");
        assert_eq!(run.episodes.len(), 1);
    }
}
