//! The errors of the fast tier in random scenes, judged by the exact tier, whose own error is below one unit.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fmt::Debug;

use iva_core::{
    absorber::Start,
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    propagation::{Differentiable, Errors},
    run::side_by_side::{Job, SideBySide, Tier},
    simulate::{Limits, Outcome, Tally, simulate},
    siva::Siva,
};
use iva_tests::{U, rng::Rng};

use crate::fast_tier::{NOTHING, all, driven, harmonic, small, stopped_at};

/// The error of an impact of a random run in rounding units, relative to the exact tier; `None` if no impact
/// can be compared: without impacts, after a stick, or where the motion has forgotten its start.
fn by_the_exact_tier<S: SideBySide + Differentiable + Clone + Debug>(
    job: &Job<S>,
    share: f64,
) -> Option<f64> {
    let Job { system, start, limits, .. } = job;
    let whole = simulate(system, start, limits, None, &mut ()).unwrap();
    let number = (share * whole.impacts as f64).ceil() as u64;
    let stopped = Limits { max_impacts: number, ..*limits };
    let mut errors = Errors::default();
    let exact = simulate(system, start, &stopped, None, &mut errors).unwrap();
    if number == 0 || exact.episodes > 0 || exact.outcome != Outcome::ImpactLimit {
        return None;
    }
    let estimate = errors.impacts.last()?.time?;
    let condition = errors.condition()?;
    // The estimate of the exact tier is at least the effect of one rounding of each number.
    if condition > 1e6 || errors.impacts.iter().any(|impact| impact.grazing) {
        return None;
    }
    let (fast, ..) = all(&stopped_at(job, std::iter::once(number)), NOTHING)[0];
    assert_eq!(fast.outcome, Outcome::ImpactLimit, "{job:?}");
    let off = fast.end_time - exact.end_time;
    Some(off.abs() / (U * (condition.max(1.0) + exact.end_time)).max(estimate))
}

#[test]
fn random_runs_are_those_of_the_exact_tier_to_some_units() {
    let mut rng = Rng::new(20_261_123);
    for (what, acts) in [("force", Acts::Primary), ("base", Acts::Base)] {
        let errors = (0..3000).filter_map(|_| {
            let share = rng.unit();
            by_the_exact_tier(&driven(&mut rng, acts), share)
        });
        let errors: Vec<f64> = errors.collect();
        assert!(errors.len() > 500, "{what}: {}", errors.len());
        small(what, errors);
    }
}

/// Largest error of an impact time over what rounding can do ([`Errors::in_doubles`]).
const BOUND: f64 = 3.0;
/// Number of impacts up to which one is picked.
const MOST: u64 = 60;

/// Free masses of all kinds: also heavy damping, which forgets the start, light absorbers, narrow gaps, sticks.
fn any_decay(rng: &mut Rng) -> Job<Siva> {
    let clearance = rng.log_range(1e-3, 3.0);
    let zeta = rng.pick(&[0.0, 0.3, 1.0, 1.7, -1.0, -1.0, -1.0, -1.0]);
    let zeta = if zeta < 0.0 { rng.log_range(1e-4, 3.0) } else { zeta };
    let e = rng.pick(&[0.0, 1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0]);
    let e = if e < 0.0 { rng.unit() } else { e };
    let system = Siva::new(rng.log_range(1e-4, 3.0), e, clearance, zeta).unwrap();
    let start = Start {
        displacement: rng.range(-1.0, 1.0),
        velocity: rng.range(-1.0, 1.0),
        gap_displacement: rng.range(-0.9, 0.9) * clearance,
        gap_velocity: rng.range(-1.0, 1.0),
    };
    let limits = Limits::new(rng.log_range(3.0, 200.0), clearance);
    Job { system, start, begin: 0.0, limits, steady: None, tier: Tier::Fast }
}

fn any_driven(rng: &mut Rng, acts: Acts) -> Job<Siva<DrivenHost>> {
    let Job { system, start, limits, tier, .. } = any_decay(rng);
    let force = Harmonic { frequency: rng.log_range(0.05, 20.0), ..harmonic(rng, acts) };
    let force = Force::new(vec![force], Vec::new(), &[]).unwrap();
    Job { system: system.under(force), start, begin: 0.0, limits, steady: None, tier }
}

/// The error of an impact over what rounding can do, and true after a stick. `None`: there is no impact,
/// rounding may turn one into a grazing, or the motion has forgotten all but some digits of itself.
fn by_what_rounding_does<S: SideBySide + Differentiable + Clone + Debug>(
    job: &Job<S>,
    share: f64,
) -> Option<(f64, bool)> {
    let Job { system, start, limits, .. } = job;
    let whole = simulate(system, start, limits, None, &mut ()).unwrap();
    let number = (share * whole.impacts.min(MOST) as f64).ceil() as u64;
    let stopped = Limits { max_impacts: number, ..*limits };
    let mut errors = Errors::in_doubles();
    let exact = simulate(system, start, &stopped, None, &mut errors).unwrap();
    if number == 0 || exact.outcome != Outcome::ImpactLimit {
        return None;
    }
    let estimate = errors.impacts.last()?.time?;
    if estimate > 1e-9 || errors.impacts.iter().any(|impact| impact.grazing) {
        return None;
    }
    let (fast, ..) = all(&stopped_at(job, std::iter::once(number)), NOTHING)[0];
    let counts = |Tally { outcome, episodes, .. }: Tally<S::State>| (outcome, episodes);
    assert_eq!(counts(fast), counts(exact), "{job:?}");
    Some(((fast.end_time - exact.end_time).abs() / estimate, exact.episodes > 0))
}

/// Compares impacts of so many scenes of each kind.
fn compare(scenes: usize) {
    let mut rng = Rng::new(1);
    for (what, acts) in [("force", Acts::Primary), ("base", Acts::Base)] {
        let mut found = Vec::new();
        for _ in 0..scenes {
            let share = rng.unit();
            found.extend(by_what_rounding_does(&any_driven(&mut rng, acts), share));
        }
        for sticks in [false, true] {
            let of_kind = found.iter().filter(|it| it.1 == sticks).map(|it| it.0);
            let mut errors: Vec<f64> = of_kind.collect();
            errors.sort_by(f64::total_cmp);
            let at = |share: f64| errors[((errors.len() - 1) as f64 * share) as usize];
            let [median, most, worst] = [at(0.5), at(0.999), at(1.0)];
            let kind = if sticks { "after sticks" } else { "without sticks" };
            let count = errors.len();
            println!("{what:7} {kind:15} {count:6}: {median:.3} {most:.2} {worst:.2}");
            assert!(count > scenes / 5 && worst <= BOUND, "{what} {kind}: {worst}");
        }
    }
}

#[test]
fn errors_are_within_what_rounding_does_in_scenes_of_all_kinds() {
    compare(iva_tests::some(2000));
}

/// The second and third impact are 90/ωn apart: some 300 stretches of equal length under a force that turns in
/// each of them by the same angle. The absorber is slow, so a phase that drifts and is set right shows.
#[test]
fn stretches_of_equal_length_gather_no_error_of_the_phase() {
    let (amplitude, frequency, phase) = (0.376_680_164_803_129_8, 6.558_442_044_814_062, 1.258_489);
    let force = Harmonic { amplitude, frequency, phase, acts: Acts::Base };
    let clearance = 2.004_353_591_900_889;
    let siva = Siva::new(0.104_789_121_240_821_22, 0.288_161_354_249_725_33, clearance, 0.3);
    let mut worst = 0.0_f64;
    for gap_velocity in (0..200).map(|k| 0.499 + 1e-4 * f64::from(k)) {
        let start = Start {
            displacement: -0.955_621_789_601_794_7,
            velocity: 0.960_476_540_920_949_5,
            gap_displacement: -0.793_983_252_219_761_6,
            gap_velocity,
        };
        let system = siva.clone().unwrap().under(Force::harmonic(vec![force]).unwrap());
        let limits = Limits { max_impacts: 3, ..Limits::new(300.0, clearance) };
        let job = Job { system, start, begin: 0.0, limits, steady: None, tier: Tier::Fast };
        worst = worst.max(by_what_rounding_does(&job, 1.0).map_or(0.0, |found| found.0));
    }
    println!("worst {worst:.2}");
    assert!(worst > 0.0 && worst <= 1.5, "{worst}");
}

#[test]
#[ignore = "takes a minute"]
fn stress_errors_are_within_what_rounding_does() {
    compare(34_000);
}
