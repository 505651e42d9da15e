//! Every damping measure compared with a second computation: the motion is taken from `states` on a dense
//! grid and from the list of events, continued between them by the power series, and the definitions are
//! applied to it literally.
//!
//! Both computations have the same motion within rounding: |Δx| ≤ 16 · 2⁻⁵³ (1 + t) R, R the size of the
//! motion (six units for each and some for the arithmetic here). The effect on a measure is derived for each
//! measure. Where the motion comes closer than that to a level that decides (for example 5 % of the
//! amplitude), the measure is not compared.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::Start,
    run::{Run, run, states},
    simulate::Limits,
    siva::SivaState,
};
use iva_tests::{
    U,
    case::{Case, any_case},
    cases,
    dd::Dd,
    flight::{Segment, root},
    some,
};
use std::f64::consts::{PI, TAU};

/// Smooth motion of a given length from `time` on.
struct Piece {
    time: f64,
    length: f64,
    segment: Segment,
}

/// An instant, such that x is monotonic from it to the next one.
#[derive(Clone, Copy)]
struct Node {
    time: f64,
    x: f64,
    piece: usize,
}

struct Trace {
    pieces: Vec<Piece>,
    nodes: Vec<Node>,
    /// Size of the motion.
    size: f64,
    duration: f64,
}

impl Trace {
    fn new(case: &Case, limits: &Limits, run: &Run<SivaState>) -> Self {
        // (time, x, v, stuck)
        let mut knots: Vec<(f64, f64, f64, bool)> = Vec::new();
        let mut times: Vec<f64> = Vec::new();
        let count = (case.duration / 0.05).ceil() as usize;
        times.extend((0..count).map(|k| case.duration * (k as f64 / count as f64)));
        for episode in &run.episodes {
            times.push(episode.stick_time);
            times.extend(episode.release_time);
        }
        times.sort_by(f64::total_cmp);
        let ends: Vec<f64> = run.episodes.iter().filter_map(|e| e.release_time).collect();
        let starts: Vec<f64> = run.episodes.iter().map(|e| e.stick_time).collect();
        for state in states(&case.siva(), &case.start, limits, &times).unwrap() {
            let stuck =
                starts.contains(&state.time) || (state.wall != 0 && !ends.contains(&state.time));
            knots.push((state.time, state.displacement, state.velocity, stuck));
        }
        // A sample at the instant of an impact may be the state before it (the instant is rounded). The
        // record of the impact replaces it, also where a plastic impact sticks.
        let hits: Vec<f64> = run.impacts.iter().map(|i| i.time).collect();
        knots.retain(|k| !hits.contains(&k.0));
        for impact in &run.impacts {
            let stuck = starts.contains(&impact.time);
            knots.push((impact.time, impact.displacement, impact.velocity_after, stuck));
        }
        knots.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut trace = Self {
            pieces: Vec::new(),
            nodes: Vec::new(),
            size: f64::hypot(case.start.displacement, case.start.velocity)
                + case.mu * (case.start.velocity + case.start.gap_velocity).abs(),
            duration: case.duration,
        };
        for (index, &(time, x, v, stuck)) in knots.iter().enumerate() {
            let end = knots.get(index + 1).map_or(case.duration, |k| k.0);
            let inertia = if stuck { Dd::sum(1.0, case.mu) } else { Dd::ONE };
            let segment = Segment::new(x.into(), v.into(), case.zeta.into(), inertia);
            let piece = Piece { time, length: end - time, segment };
            assert!(piece.length <= piece.segment.length);
            trace.pieces.push(piece);
            trace.add_nodes();
        }
        trace
    }

    /// Adds start, extremum if there is one, and end of the last piece.
    fn add_nodes(&mut self) {
        let index = self.pieces.len() - 1;
        let piece = &self.pieces[index];
        let mut at = vec![Dd::ZERO];
        let end = Dd::from(piece.length);
        let velocity = |h: Dd| piece.segment.at(h).1;
        if velocity(Dd::ZERO).hi * velocity(end).hi < 0.0 {
            let slope = |h: Dd| (piece.segment.at(h).1, piece.segment.at(h).2);
            at.push(root(slope, Dd::ZERO, end));
        }
        at.push(end);
        for h in at {
            let x = piece.segment.at(h).0.value();
            self.nodes.push(Node { time: piece.time + h.value(), x, piece: index });
        }
    }

    /// Bound on the difference of two computations of x at a time.
    fn rounding(&self, time: f64) -> f64 {
        16.0 * U * (1.0 + time) * self.size
    }

    /// Peaks: the largest |x| between consecutive zero crossings of x.
    fn peaks(&self) -> Vec<Node> {
        let mut peaks = Vec::new();
        let mut best = self.nodes[0];
        let mut sign = 0.0;
        for &node in &self.nodes {
            // Without damping a release is at x = 0 exactly: values below the rounding of the motion have no
            // sign there.
            let piece = &self.pieces[node.piece];
            let speed = piece.segment.at(Dd::sum(node.time, -piece.time)).1.hi.abs();
            let clear = node.x.abs() > 16.0 * U * speed;
            if clear && node.x * sign < 0.0 {
                peaks.push(best);
                best = node;
            }
            if clear {
                sign = node.x.signum();
            }
            if node.x.abs() > best.x.abs() {
                best = node;
            }
        }
        if peaks.is_empty() {
            peaks.push(best);
        }
        peaks
    }

    /// The last instant at which |x| = level, with |ẋ| there.
    fn last_at(&self, level: f64) -> Option<(f64, f64)> {
        let pair = self.nodes.windows(2).rev().find(|pair| {
            (pair[0].x.abs() - level) * (pair[1].x.abs() - level) <= 0.0
                && pair[0].piece == pair[1].piece
        })?;
        let piece = &self.pieces[pair[0].piece];
        let signed = if pair[0].x.abs().max(pair[1].x.abs()) == pair[0].x.abs() {
            level * pair[0].x.signum()
        } else {
            level * pair[1].x.signum()
        };
        let off = |h: Dd| (piece.segment.at(h).0 - signed, piece.segment.at(h).1);
        let (low, high) = (pair[0].time - piece.time, pair[1].time - piece.time);
        let h = root(off, low.into(), high.into());
        Some((piece.time + h.value(), piece.segment.at(h).1.abs().hi))
    }

    /// True if an extremum or an end of the run is too close to a level to decide on which side it is.
    fn touches(&self, level: f64) -> bool {
        let extremes = self.nodes.windows(3).filter(|w| {
            let (a, b) = (w[1].x - w[0].x, w[2].x - w[1].x);
            a * b <= 0.0
        });
        let near = |node: &Node| (node.x.abs() - level).abs() <= 4.0 * self.rounding(node.time);
        extremes.map(|w| w[1]).any(|n| near(&n)) || near(&self.nodes[self.nodes.len() - 1])
    }

    /// The largest |x| from a time to the end.
    fn largest_since(&self, from: f64) -> f64 {
        let later = self.nodes.iter().filter(|n| n.time >= from).map(|n| n.x.abs());
        let piece = self.pieces.iter().rev().find(|p| p.time <= from).unwrap();
        let there = piece.segment.at(Dd::sum(from, -piece.time)).0.abs().hi;
        later.fold(there, f64::max)
    }

    /// ∫ 2ζẋ² dt, five-point Gauss–Legendre on each piece (at most 0.05 long: error below 1e-19).
    fn viscous(&self, zeta: f64) -> f64 {
        const RULE: [(f64, f64); 5] = [
            (0.0, 0.568_888_888_888_888_9),
            (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
            (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
            (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
            (0.906_179_845_938_664, 0.236_926_885_056_189_08),
        ];
        let mut sum = Dd::ZERO;
        for piece in &self.pieces {
            for (place, weight) in RULE {
                let v = piece.segment.at(Dd::from(piece.length * (1.0 + place) / 2.0)).1.hi;
                sum = sum + zeta * v * v * weight * piece.length;
            }
        }
        sum.value()
    }
}

/// Asserts that both values are missing, or that they agree within `allowed`.
fn same(name: &str, found: Option<f64>, truth: Option<f64>, allowed: f64) {
    match (found, truth) {
        (None, None) => {}
        (Some(found), Some(truth)) => assert!(
            (found - truth).abs() <= allowed,
            "{name}: {found} for {truth}, off {:e} of {allowed:e}",
            found - truth
        ),
        _ => panic!("{name}: {found:?} for {truth:?}"),
    }
}

/// Slope of the least-squares line, and its largest change by errors of at most `errors` in y.
fn slope(points: &[(f64, f64)], errors: &[f64]) -> (f64, f64) {
    let n = points.len() as f64;
    let mean_t = points.iter().map(|p| p.0).sum::<f64>() / n;
    let mean_y = points.iter().map(|p| p.1).sum::<f64>() / n;
    let square: f64 = points.iter().map(|p| (p.0 - mean_t).powi(2)).sum();
    let product: f64 = points.iter().map(|p| (p.0 - mean_t) * (p.1 - mean_y)).sum();
    let moved: f64 = points.iter().zip(errors).map(|(p, e)| (p.0 - mean_t).abs() * e).sum();
    (product / square, moved / square)
}

/// Number of comparisons made, of those that can be skipped.
#[derive(Default)]
struct Made {
    fits: usize,
    settlings: usize,
}

fn check(case: &Case, made: &mut Made) {
    // With all impacts above 1e-15 listed, the unlisted rest of a tail is below rounding.
    let limits = Limits { chatter_floor: 1e-15, ..case.limits() };
    let run = run(&case.siva(), &case.start, &limits).unwrap();
    assert_eq!(run.tally.undecided, 0);
    let trace = Trace::new(case, &limits, &run);
    let m = &run.measures;
    let peaks = trace.peaks();
    let still = trace.size == 0.0 || peaks[0].x == 0.0;
    if still {
        return; // ratios to zero, which `limits.rs` tests
    }

    assert_eq!(run.peaks.len(), peaks.len(), "peaks");
    for (found, truth) in run.peaks.iter().zip(&peaks) {
        let allowed = trace.rounding(truth.time);
        assert!((found.displacement - truth.x).abs() <= allowed, "{found:?} for {}", truth.x);
        // At a smooth extremum a time error h changes x by h²/2. Two extrema closer in height than rounding
        // may be exchanged, so the height at the reported time is compared.
        let piece = trace.pieces.iter().rev().find(|p| p.time <= found.time).unwrap();
        let there = piece.segment.at(Dd::sum(found.time, -piece.time)).0;
        let late = U * found.time * trace.size;
        assert!((there - truth.x).abs().hi <= allowed + late, "{found:?} at {}", truth.time);
    }

    let start = case.start.displacement.abs();
    let reference = if start == 0.0 { peaks[0].x.abs() } else { start };
    let decrement = |cycles: usize| {
        let (first, last) = (peaks.first()?, peaks.get(2 * cycles)?);
        let error =
            trace.rounding(first.time) / first.x.abs() + trace.rounding(last.time) / last.x.abs();
        let delta = (first.x / last.x).abs().ln() / cycles as f64;
        Some((delta / f64::hypot(TAU, delta), error / cycles as f64 / TAU + 8.0 * U))
    };
    for (name, cycles, found) in [
        ("damping_ratio_1", 1, m.damping_ratio_1),
        ("damping_ratio_3", 3, m.damping_ratio_3),
        ("damping_ratio_10", 10, m.damping_ratio_10),
    ] {
        let truth = decrement(cycles);
        same(name, found, truth.map(|t| t.0), truth.map_or(0.0, |t| t.1));
    }

    let level = 0.05 * reference;
    let kept = peaks.iter().position(|p| p.x.abs() < level).unwrap_or(peaks.len());
    if !peaks.iter().any(|p| (p.x.abs() - level).abs() <= 4.0 * trace.rounding(p.time)) {
        let points: Vec<_> = peaks[..kept].iter().map(|p| (p.time, p.x.abs().ln())).collect();
        // The curvature at an extremum is −x: an error of x moves its time by the error over |x|.
        let errors: Vec<_> = peaks[..kept]
            .iter()
            .map(|p| trace.rounding(p.time) / p.x.abs() * 2.0 + 8.0 * U)
            .collect();
        if kept < 3 {
            assert_eq!(m.damping_ratio_fit, None);
        } else {
            made.fits += 1;
            let (slope, moved) = slope(&points, &errors);
            let sums = 16.0 * U * (1.0 + slope.abs()) * kept as f64;
            same(
                "damping_ratio_fit",
                m.damping_ratio_fit,
                Some(-slope),
                moved * (1.0 + slope.abs()) + sums,
            );
        }
    }

    for (name, share, found) in [
        ("settling_time_10", 0.10, m.settling_time_10),
        ("settling_time_5", 0.05, m.settling_time_5),
        ("settling_time_2", 0.02, m.settling_time_2),
    ] {
        let level = share * reference;
        if trace.touches(level) {
            continue;
        }
        let from = (case.duration - PI).max(0.0);
        if trace.largest_since(from) > level {
            assert_eq!(found, None, "{name}: |x| exceeds the level in the last half period");
            continue;
        }
        made.settlings += 1;
        let (truth, speed) = trace.last_at(level).unwrap();
        let allowed = 2.0 * trace.rounding(truth) / speed + 2.0 * U * truth;
        same(name, found, Some(truth), allowed);
    }

    let energy = |x: f64, v: f64, w: f64| 0.5 * (x * x + v * v + case.mu * (v + w) * (v + w));
    let s = &case.start;
    let initial = energy(s.displacement, s.velocity, s.gap_velocity);
    if case.duration < TAU {
        assert_eq!((m.damping_ratio_energy, m.residual_amplitude), (None, None));
    } else {
        let after = states(&case.siva(), s, &limits, &[TAU]).unwrap()[0];
        let later = energy(after.displacement, after.velocity, after.gap_velocity);
        // The error of each energy is 2 |Δ(x, ẋ)| |(x, ẋ)|, below this bound over a time of 2π.
        let allowed = 8.0 * trace.rounding(TAU) * (1.0 + case.mu) * trace.size.max(1.0) / initial;
        let truth = (initial - later) / (2.0 * TAU * initial);
        same("damping_ratio_energy", m.damping_ratio_energy, Some(truth), allowed);
        let residual = trace.largest_since(case.duration - TAU) / reference;
        let allowed = 2.0 * trace.rounding(trace.duration) / reference;
        same("residual_amplitude", m.residual_amplitude, Some(residual), allowed);
    }
    let allowed = 4.0 * trace.rounding(case.duration) * case.duration * case.zeta * trace.size;
    same("energy_viscous", Some(m.energy_viscous), Some(trace.viscous(case.zeta)), allowed);
}

#[test]
fn measures_of_random_decays() {
    use proptest::test_runner::{TestCaseError, TestError, TestRunner};
    let made = std::cell::RefCell::new(Made::default());
    let mut runner = TestRunner::new(cases(600));
    let result = runner.run(&any_case(0.5, 90.0), |case| {
        let attempt = std::panic::AssertUnwindSafe(|| check(&case, &mut made.borrow_mut()));
        std::panic::catch_unwind(attempt).map_err(|panic| {
            let text = panic.downcast_ref::<String>().cloned().unwrap_or_default();
            TestCaseError::fail(text)
        })
    });
    if let Err(TestError::Fail(why, case)) = result {
        panic!("{why}\n{case:#?}");
    }
    // The rules that skip a comparison must not skip too many.
    let made = made.into_inner();
    assert!(
        made.fits > some(200) && made.settlings > some(300),
        "{} fits, {} settlings",
        made.fits,
        made.settlings
    );
}

fn case(x: f64, v: f64, zeta: f64, duration: f64) -> Case {
    // The absorber starts at rest, and so stays at rest without impacts.
    let start = Start { displacement: x, velocity: v, gap_velocity: -v, ..Start::default() };
    Case { mu: 0.1, e: 0.5, clearance: 0.6, zeta, start, duration }
}

#[test]
fn a_start_at_zero_takes_its_first_peak_as_reference() {
    for duration in [3.0, 6.0, 7.0, 60.0, 200.0] {
        for zeta in [0.0, 0.02, 0.3] {
            check(&case(0.0, 1.0, zeta, duration), &mut Made::default());
            check(&case(0.0, -0.7, zeta, duration), &mut Made::default());
        }
    }
    // ζ = 0.3, no impact (γ 10): first peak exp(−ζ acos ζ/√(1−ζ²)), residual relative to it
    let wide = Case { clearance: 10.0, ..case(0.0, 1.0, 0.3, 40.0) };
    let run = wide.run();
    let damped = (1.0f64 - 0.09).sqrt();
    let peak = (-0.3 * 0.3f64.acos() / damped).exp();
    assert!((run.peaks[0].displacement - peak).abs() <= 8.0 * U);
    // |x| is below 5 % of the peak at most half a period before the envelope is.
    let latest = (1.0 / (0.05 * peak * damped)).ln() / 0.3;
    let time = run.measures.settling_time_5.unwrap();
    assert!(time <= latest && time >= latest - PI / damped - 0.3, "{time} of {latest}");
}

#[test]
fn a_run_without_zero_crossing_has_one_peak() {
    // overdamped from rest: x falls monotonically
    for (x, v) in [(1.0, 0.0), (-0.4, 0.0), (0.5, 0.5), (0.0, 1.0)] {
        for zeta in [1.0, 1.5, 4.0] {
            let overdamped = Case { clearance: 5.0, ..case(x, v, zeta, 40.0) };
            let run = overdamped.run();
            assert_eq!(run.peaks.len(), 1, "({x}, {v}), ζ = {zeta}");
            assert_eq!(run.measures.damping_ratio_1, None);
            assert_eq!(run.measures.damping_ratio_fit, None);
            if zeta < 2.0 {
                check(&overdamped, &mut Made::default());
            }
        }
    }
    // The same for a run that ends before the first crossing, at π/2.
    let run = case(1.0, 0.0, 0.0, 1.0).run();
    assert_eq!(run.peaks.len(), 1);
    assert_eq!((run.peaks[0].time, run.peaks[0].displacement), (0.0, 1.0));
}

#[test]
fn a_half_cycle_cut_by_the_end_of_the_run_is_no_peak() {
    // γ 10, ζ = 0: crossings at π/2 + kπ. Until 4π there are four, so peaks at 0, π, 2π, 3π.
    let free = Case { clearance: 10.0, ..case(1.0, 0.0, 0.0, 4.0 * PI) };
    let run = free.run();
    assert_eq!(run.peaks.len(), 4);
    for (k, peak) in run.peaks.iter().enumerate() {
        let time = PI * k as f64;
        assert!((peak.time - time).abs() <= 6.0 * U * (1.0 + time), "{peak:?}");
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        assert!((peak.displacement - sign).abs() <= 6.0 * U * (1.0 + time));
    }
    let m = &run.measures;
    let flat = m.damping_ratio_1.unwrap();
    assert!(flat.abs() <= 2.0 * 6.0 * U * 8.0 / TAU, "{flat}");
    assert_eq!(m.damping_ratio_3, None);
    assert_eq!(m.settling_time_10, None);
    let residual = m.residual_amplitude.unwrap();
    assert!((residual - 1.0).abs() <= 6.0 * U * (1.0 + 4.0 * PI));
}

#[test]
fn runs_shorter_than_a_period_have_no_energy_ratio_and_no_residual() {
    for (duration, defined) in [(1.0, false), (TAU - 1e-9, false), (TAU, true), (6.3, true)] {
        let m = case(1.0, 0.0, 0.05, duration).run().measures;
        assert_eq!(m.damping_ratio_energy.is_some(), defined, "{duration}");
        assert_eq!(m.residual_amplitude.is_some(), defined, "{duration}");
    }
}
