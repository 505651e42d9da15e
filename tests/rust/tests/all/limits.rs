//! Edge cases: limits, starts on and beyond a wall, bad values, no motion.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::{Start, Wall},
    error::Invalid,
    run::{run, states},
    simulate::{Limits, Outcome},
    siva::Siva,
};
use iva_tests::Run;

const CLEARANCE: f64 = 0.5;

fn siva() -> Siva {
    Siva::new(0.1, 0.8, CLEARANCE, 0.01).unwrap()
}

fn start(x: f64, v: f64, y: f64, w: f64) -> Start {
    Start { displacement: x, velocity: v, gap_displacement: y, gap_velocity: w }
}

fn go(start: &Start, duration: f64) -> Result<Run, Invalid> {
    run(&siva(), start, &Limits::new(duration, CLEARANCE))
}

/// `value` moved by `steps` doubles away from zero (towards it if `steps` is negative).
fn ulps(value: f64, steps: i64) -> f64 {
    f64::from_bits(value.to_bits().wrapping_add_signed(steps))
}

fn ledger(run: &Run) -> f64 {
    run.measures.energy_residual.abs() / run.measures.energy_initial
}

#[test]
fn the_limits_have_the_documented_defaults() {
    let limits = Limits::new(7.0, 0.5);
    assert_eq!(limits.duration, 7.0);
    assert_eq!(limits.max_impacts, 10_000_000);
    assert_eq!(limits.max_work, 100_000_000);
    assert_eq!(limits.chatter_floor, 1e-6 * 0.5);
}

#[test]
fn max_impacts_gives_the_beginning_of_the_run() {
    let start = start(1.0, 0.0, 0.0, 0.0);
    let full = go(&start, 60.0).unwrap();
    assert_eq!(full.tally.outcome, Outcome::Finished);
    assert!(full.impacts.len() > 12);
    for most in [1_u64, 2, 7, 12] {
        let limits = Limits { max_impacts: most, ..Limits::new(60.0, CLEARANCE) };
        let part = run(&siva(), &start, &limits).unwrap();
        assert_eq!(part.tally.outcome, Outcome::ImpactLimit);
        assert_eq!((part.tally.impacts, part.impacts.len() as u64), (most, most));
        assert_eq!(part.impacts, full.impacts[..part.impacts.len()]);
        let last = part.impacts.last().unwrap().time;
        let next = full.impacts[part.impacts.len()].time;
        assert!((last..=next).contains(&part.tally.end_time), "{}", part.tally.end_time);
        assert!(ledger(&part) <= 1e-12);
    }
    let enough = Limits { max_impacts: full.tally.impacts + 1, ..Limits::new(60.0, CLEARANCE) };
    let same = run(&siva(), &start, &enough).unwrap();
    assert_eq!(same.tally.outcome, Outcome::Finished);
    assert_eq!(same.impacts, full.impacts);
}

#[test]
fn max_work_gives_the_beginning_of_the_run() {
    let start = start(1.0, 0.0, 0.0, 0.0);
    let full = go(&start, 60.0).unwrap();
    let mut impacts = 0;
    for most in [1_u64, 10, full.tally.work / 2, full.tally.work - 1] {
        let limits = Limits { max_work: most, ..Limits::new(60.0, CLEARANCE) };
        let part = run(&siva(), &start, &limits).unwrap();
        assert_eq!(part.tally.outcome, Outcome::WorkLimit, "max_work {most}");
        assert!(part.tally.work <= most, "{} of {most}", part.tally.work);
        assert!(part.tally.end_time < 60.0);
        assert!(part.impacts.len() >= impacts);
        impacts = part.impacts.len();
        assert_eq!(part.impacts, full.impacts[..impacts]);
        assert!(ledger(&part) <= 1e-12);
    }
    assert!(impacts > 0);
}

#[test]
fn a_chattering_run_is_cut_short_as_well() {
    // e = 0.99 gives chatters of about a thousand rebounds; the limit must also hold within a summed tail.
    let absorber = Siva::new(0.1, 0.99, 1e-3, 0.0).unwrap();
    let start = start(1.0, 0.0, 0.0, 0.0);
    let limits = Limits { max_impacts: 200, chatter_floor: 1e-12, ..Limits::new(100.0, 1e-3) };
    let part = run(&absorber, &start, &limits).unwrap();
    assert_eq!((part.tally.outcome, part.tally.impacts), (Outcome::ImpactLimit, 200));
    assert_eq!(part.impacts.len(), 200);
}

#[test]
fn rebounds_that_become_no_rows_do_not_count() {
    // Nine impacts are above the floor of 0.01; the low rebounds before the stick must not count towards a
    // limit of ten.
    let absorber = Siva::new(0.15, 0.5, 0.1, 0.0).unwrap();
    let start = start(1.0, 0.0, 0.0, 0.0);
    let limits = Limits { chatter_floor: 1e-2, ..Limits::new(6.0, 0.1) };
    let whole = run(&absorber, &start, &limits).unwrap();
    assert_eq!((whole.tally.outcome, whole.impacts.len()), (Outcome::Finished, 9));
    let ten = run(&absorber, &start, &Limits { max_impacts: 10, ..limits }).unwrap();
    assert_eq!(ten, whole);
    for most in 1..=9 {
        let part = run(&absorber, &start, &Limits { max_impacts: most, ..limits }).unwrap();
        assert_eq!(part.tally.outcome, Outcome::ImpactLimit);
        assert_eq!(part.impacts, whole.impacts[..most as usize]);
    }
}

#[test]
fn the_lowest_floor_lists_rebounds_like_any_other() {
    // A chatter in an overdamped decay, listed over seventy orders of magnitude.
    let absorber = Siva::new(0.1, 0.5, 0.01, 1.2).unwrap();
    let start = start(1.0, 0.0, 0.0, 0.0);
    let at = |floor: f64| {
        let limits = Limits { chatter_floor: floor, ..Limits::new(4.0, 0.01) };
        run(&absorber, &start, &limits).unwrap()
    };
    let (coarse, fine) = (at(1e-6), at(1e-75));
    assert!(!fine.episodes.is_empty());
    assert_eq!(coarse.tally.outcome, fine.tally.outcome);
    assert_eq!(coarse.episodes.len(), fine.episodes.len());
    for episode in &fine.episodes {
        let rows: Vec<_> = fine
            .impacts
            .iter()
            .filter(|i| (episode.start_time..=episode.stick_time).contains(&i.time))
            .collect();
        assert!(rows.len() > 200, "{}", rows.len());
        for pair in rows.windows(2) {
            assert!(pair[0].time <= pair[1].time);
            // low rebounds shrink by e
            if pair[0].approach_speed() < 1e-9 {
                let ratio = pair[1].approach_speed() / pair[0].approach_speed();
                assert!((ratio - 0.5).abs() < 1e-8, "{ratio}");
            }
        }
    }
}

#[test]
fn the_ends_of_the_range_are_exact_as_well() {
    // Scaling lengths by a power of two changes no bit; heavy, light and strongly damped scenes close their
    // ledgers.
    let scene = |power: i32| {
        let scale = 2f64.powi(power);
        let absorber = Siva::new(0.15, 0.5, 0.1 * scale, 0.02).unwrap();
        run(&absorber, &start(scale, 0.0, 0.0, 0.0), &Limits::new(60.0, 0.1 * scale)).unwrap()
    };
    let plain = scene(0);
    for power in [-225, -100, 100, 249] {
        let scaled = scene(power);
        assert_eq!(scaled.tally.outcome, Outcome::Finished);
        assert_eq!(scaled.measures.settling_time_5, plain.measures.settling_time_5);
        assert_eq!(scaled.measures.damping_ratio_fit, plain.measures.damping_ratio_fit);
        let times = |run: &Run| run.impacts.iter().map(|i| i.time).collect::<Vec<_>>();
        assert_eq!(times(&scaled), times(&plain), "2^{power}");
    }
    for (mu, e, clearance, zeta, duration) in [
        (1e9, 0.5, 0.5, 0.01, 600.0),
        (1e9, 1.0, 0.05, 0.0, 600.0),
        (5e-324, 0.9, 0.5, 0.0, 600.0),
        (0.1, 0.95, 1e-60, 0.01, 300.0),
        (0.1, 0.5, 0.5, 1e9, 1e-6),
    ] {
        let absorber = Siva::new(mu, e, clearance, zeta).unwrap();
        let limits = Limits::new(duration, clearance);
        let run = run(&absorber, &start(1.0, 0.0, 0.0, 0.0), &limits).unwrap();
        assert_eq!(run.tally.outcome, Outcome::Finished, "μ {mu:e}, d {clearance:e}, ζ {zeta:e}");
        assert!(ledger(&run) <= 1e-12, "μ {mu:e}, d {clearance:e}: {:e}", ledger(&run));
    }
}

#[test]
fn within_four_ulps_a_start_is_on_the_wall_and_beyond_it_is_an_error() {
    for side in [1.0, -1.0] {
        let wall = if side > 0.0 { Wall::Plus } else { Wall::Minus };
        for steps in [-4, -1, 0, 1, 4] {
            let y = side * ulps(CLEARANCE, steps);
            // moving into the wall: an impact at time zero
            let result = go(&start(0.0, 0.0, y, side * 0.5), 1.0).unwrap();
            let first = &result.impacts[0];
            assert_eq!((first.time, first.wall), (0.0, wall), "{steps} ulps");
            assert_eq!(first.gap_velocity_before, side * 0.5);
            assert_eq!(first.velocity_before, 0.0);
        }
        for steps in [5, 64, 1 << 40] {
            let y = side * ulps(CLEARANCE, steps);
            for w in [0.0, side * 0.5, -side * 0.5] {
                let error = go(&start(1.0, 0.0, y, w), 1.0).unwrap_err();
                assert!(error.field.ends_with("gap_displacement"), "{error}");
                assert!(!error.value.is_empty() && !error.allowed.is_empty());
            }
        }
        // Well inside the gap the first impact comes after the remaining distance is covered.
        let y = side * (CLEARANCE - 1e-9);
        let result = go(&start(0.0, 0.0, y, side * 0.5), 1.0).unwrap();
        let time = result.impacts[0].time;
        // x stays 0: 1e-9 at speed 0.5; the subtraction above rounds by 2⁻⁵⁴ of 2⁻¹
        let left = CLEARANCE - y.abs();
        assert!((time - left / 0.5).abs() <= 2.0 * f64::EPSILON * CLEARANCE, "{time:e}");
    }
}

#[test]
fn a_start_moving_off_the_wall_is_no_impact() {
    // x at rest in the middle: y moves from wall to wall at constant speed, 2d/|w| = 2
    let result = go(&start(0.0, 0.0, CLEARANCE, -0.5), 2.5).unwrap();
    assert_eq!((result.impacts.len(), result.episodes.len()), (1, 0));
    let first = &result.impacts[0];
    assert_eq!(first.wall, Wall::Minus);
    assert!((first.time - 2.0).abs() <= 6.0 * f64::EPSILON * 2.0, "{}", first.time);
}

#[test]
fn resting_on_a_wall_that_presses_is_an_episode_without_impacts() {
    // ẍ = −x − 2ζẋ. Wall +: presses while ẍ < 0; wall −: while ẍ > 0.
    let pressed = [(1.0, 0.0, 1.0), (-1.0, 0.0, -1.0), (1.0, -0.3, 1.0), (0.0, 1.0, 1.0)];
    for (x, v, side) in pressed {
        let result = go(&start(x, v, side * CLEARANCE, 0.0), 1.0).unwrap();
        assert!(!result.episodes.is_empty(), "({x}, {v}) at {side}");
        let episode = &result.episodes[0];
        assert_eq!((episode.start_time, episode.stick_time), (0.0, 0.0));
        assert_eq!((episode.impacts, episode.energy_loss), (0, 0.0));
        assert_eq!(episode.wall.sign(), side);
        let state = states(
            &siva(),
            &start(x, v, side * CLEARANCE, 0.0),
            &Limits::new(1.0, CLEARANCE),
            &[0.1],
        )
        .unwrap()[0];
        assert_eq!(f64::from(state.wall), side);
        assert_eq!(state.gap_displacement, side * CLEARANCE);
        assert_eq!(state.gap_velocity, 0.0);
    }
    for (x, v, side) in [(1.0, 0.0, -1.0), (-1.0, 0.0, 1.0), (1.0, 0.2, -1.0)] {
        let result = go(&start(x, v, side * CLEARANCE, 0.0), 0.1).unwrap();
        assert!(result.episodes.is_empty() && result.impacts.is_empty(), "({x}, {v}) at {side}");
    }
}

#[test]
fn with_no_acceleration_the_jerk_decides() {
    // x = 0, ζ = 0: ẍ = 0 and x⃛ = −ẋ. Wall + presses next if ẋ > 0, retreats if ẋ < 0.
    let absorber = Siva::new(0.1, 0.8, CLEARANCE, 0.0).unwrap();
    for (v, side, sticks) in
        [(1.0, 1.0, true), (-1.0, 1.0, false), (1.0, -1.0, false), (-1.0, -1.0, true)]
    {
        let start = start(0.0, v, side * CLEARANCE, 0.0);
        let result = run(&absorber, &start, &Limits::new(0.5, CLEARANCE)).unwrap();
        assert_eq!(!result.episodes.is_empty(), sticks, "ẋ = {v} at {side}");
        assert!(result.impacts.is_empty());
    }
}

#[test]
fn a_stick_from_the_start_is_released_where_the_wall_stops_pressing() {
    // ζ = 0, both masses together from x = 1: x = cos ωτ, ω = 1/√(1+μ); released at ẍ = 0,
    // τ = (π/2)√(1+μ)
    let absorber = Siva::new(0.21, 0.5, CLEARANCE, 0.0).unwrap();
    let start = start(1.0, 0.0, CLEARANCE, 0.0);
    let result = run(&absorber, &start, &Limits::new(2.0, CLEARANCE)).unwrap();
    let truth = std::f64::consts::FRAC_PI_2 * 1.21f64.sqrt();
    let time = result.episodes[0].release_time.unwrap();
    // condition: dτ/dμ = π/(4√(1+μ)) < 1; six units
    assert!((time - truth).abs() <= 6.0 * f64::EPSILON / 2.0 * (1.0 + truth), "{time} for {truth}");
    assert_eq!(result.tally.time_stuck, time);
    let stuck = run(&absorber, &start, &Limits::new(1.0, CLEARANCE)).unwrap();
    assert_eq!(stuck.episodes[0].release_time, None);
    assert_eq!(stuck.tally.time_stuck, 1.0);
}

#[test]
fn without_motion_nothing_happens() {
    let result = go(&start(0.0, 0.0, 0.2, 0.0), 50.0).unwrap();
    assert_eq!((result.tally.outcome, result.tally.end_time), (Outcome::Finished, 50.0));
    assert_eq!((result.impacts.len(), result.episodes.len()), (0, 0));
    assert_eq!(result.tally.undecided, 0);
    let measures = &result.measures;
    for energy in [
        measures.energy_initial,
        measures.energy_viscous,
        measures.energy_final,
        measures.energy_residual,
    ] {
        assert_eq!(energy, 0.0);
    }
    // Ratios to an amplitude or energy of zero are null, not NaN.
    for value in [
        measures.damping_ratio_1,
        measures.damping_ratio_fit,
        measures.damping_ratio_energy,
        measures.residual_amplitude,
    ] {
        assert_eq!(value, None);
    }
    for value in [measures.settling_time_10, measures.settling_time_5, measures.settling_time_2] {
        assert!(value.is_none_or(f64::is_finite));
    }
    let limits = Limits::new(50.0, CLEARANCE);
    for state in states(&siva(), &start(0.0, 0.0, 0.2, 0.0), &limits, &[0.0, 3.0, 50.0]).unwrap() {
        assert_eq!((state.displacement, state.velocity), (0.0, 0.0));
        assert_eq!((state.gap_displacement, state.gap_velocity, state.wall), (0.2, 0.0, 0));
    }
    // At rest and touching a wall, without motion: no impacts and no endless loop.
    let touching = go(&start(0.0, 0.0, CLEARANCE, 0.0), 50.0).unwrap();
    assert_eq!((touching.tally.outcome, touching.impacts.len()), (Outcome::Finished, 0));
}

#[test]
fn bad_parameters_name_their_field() {
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0];
    let check = |result: Result<Siva, Invalid>, field: &str, value: f64| {
        let error = result.expect_err(&format!("{field} = {value} must be refused"));
        assert!(error.field.ends_with(field), "{error}");
        assert!(!error.value.is_empty() && !error.allowed.is_empty(), "{error}");
    };
    for value in bad.into_iter().chain([0.0, -0.0]) {
        check(Siva::new(value, 0.5, 0.5, 0.01), "mass_ratio", value);
        check(Siva::new(0.1, 0.5, value, 0.01), "clearance", value);
    }
    // beyond the range of `iva_core::range`
    check(Siva::new(1.1e9, 0.5, 0.5, 0.01), "mass_ratio", 1.1e9);
    check(Siva::new(0.1, 0.5, 1e-76, 0.01), "clearance", 1e-76);
    check(Siva::new(0.1, 0.5, 0.5, 1.1e9), "damping_ratio", 1.1e9);
    for value in bad.into_iter().chain([-f64::MIN_POSITIVE, 1.0 + f64::EPSILON, 2.0]) {
        check(Siva::new(0.1, value, 0.5, 0.01), "restitution", value);
    }
    for value in bad {
        check(Siva::new(0.1, 0.5, 0.5, value), "damping_ratio", value);
    }
    for e in [0.0, 1.0] {
        assert!(Siva::new(0.1, e, 0.5, 0.0).is_ok());
    }
}

#[test]
fn bad_starts_and_limits_name_their_field() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e76, -1e-76] {
        let starts = [
            (start(bad, 0.0, 0.0, 0.0), "displacement"),
            (start(0.0, bad, 0.0, 0.0), "velocity"),
            (start(0.0, 0.0, bad, 0.0), "gap_displacement"),
            (start(0.0, 0.0, 0.0, bad), "gap_velocity"),
        ];
        for (start, field) in starts {
            let error = go(&start, 1.0).unwrap_err();
            assert!(error.field.ends_with(field), "{field}: {error}");
            if !field.starts_with("gap") {
                assert!(!error.field.contains("gap"), "{field}: {error}");
            }
        }
    }
    let fine = start(1.0, 0.0, 0.0, 0.0);
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        let limits = Limits { duration: bad, ..Limits::new(1.0, CLEARANCE) };
        let error = run(&siva(), &fine, &limits).unwrap_err();
        assert!(error.field.ends_with("duration"), "{error}");
    }
    for bad in [f64::NAN, 0.0, -1e-6] {
        let limits = Limits { chatter_floor: bad, ..Limits::new(1.0, CLEARANCE) };
        let error = run(&siva(), &fine, &limits).unwrap_err();
        assert!(error.field.ends_with("chatter_floor"), "{error}");
    }
}

#[test]
fn the_motion_does_not_depend_on_the_floor() {
    // chattering decay of the paper's Fig. 4
    let absorber = Siva::new(0.15, 0.5, 0.1, 0.0).unwrap();
    let start = start(1.0, 0.0, 0.0, 0.0);
    let at = |floor: f64| {
        let limits = Limits { chatter_floor: floor, ..Limits::new(60.0, 0.1) };
        let times: Vec<f64> = (0..=600).map(|k| f64::from(k) * 0.1).collect();
        (
            run(&absorber, &start, &limits).unwrap(),
            states(&absorber, &start, &limits, &times).unwrap(),
        )
    };
    let (fine, fine_states) = at(1e-9);
    for floor in [1e-7, 1e-4, 1e-2, 1.0] {
        let (coarse, coarse_states) = at(floor);
        assert_eq!(coarse_states, fine_states, "floor {floor}");
        assert_eq!(coarse.measures.energy_final, fine.measures.energy_final);
        assert_eq!(coarse.tally.energy_impacts, fine.tally.energy_impacts);
        assert_eq!(coarse.peaks, fine.peaks);
        assert_eq!(coarse.episodes.len(), fine.episodes.len());
        for (coarse, fine) in coarse.episodes.iter().zip(&fine.episodes) {
            assert_eq!(
                (coarse.stick_time, coarse.release_time),
                (fine.stick_time, fine.release_time)
            );
            assert_eq!(coarse.energy_loss, fine.energy_loss);
            assert!(coarse.impacts <= fine.impacts);
        }
        // Common impacts are equal; only rebounds of a chatter below the floor are missing.
        let listed: Vec<_> = fine
            .impacts
            .iter()
            .filter(|i| {
                i.gap_velocity_before.abs() > floor
                    || !fine
                        .episodes
                        .iter()
                        .any(|e| (e.start_time..=e.stick_time).contains(&i.time))
            })
            .copied()
            .collect();
        assert_eq!(coarse.impacts, listed, "floor {floor}");
        assert_eq!(coarse.tally.impacts, coarse.impacts.len() as u64);
    }
}
