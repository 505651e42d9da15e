//! The fast tier: free masses in plain doubles.
//!
//! The instant of an impact is obtained as the end of a run that stops at a number of impacts. These instants
//! are compared with the references (50 digits, `tests/reference`), and for random runs with the exact tier,
//! whose own error is below one unit.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::{f64::consts::TAU, fmt::Debug};

use iva_core::{
    absorber::Start,
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    measures::{MeasureValues, Wanted},
    propagation::{Differentiable, Errors},
    run::side_by_side::{self, Ended, Job, SideBySide, Tier},
    simulate::{Limits, Outcome, simulate},
    siva::Siva,
    steady::{SteadyValues, SteadyWanted, Window},
};
use iva_tests::{
    U, UNITS_ALLOWED,
    dd::Dd,
    oracle::Kind,
    reference::{Expected, forced_scenes},
    rng::Rng,
    units,
};

/// Approach speed at or below which impacts are missing in the reference.
const FLOOR: f64 = 1e-9;
/// Largest median of the errors of instants, in rounding units.
const MEDIAN_ALLOWED: f64 = 1.0;

/// The results of runs in a tier, in the order of the jobs.
pub(crate) fn all<S: SideBySide>(jobs: &[Job<S>], wanted: Wanted) -> Vec<Ended<S>> {
    let mut found: Vec<Option<Ended<S>>> = vec![None; jobs.len()];
    side_by_side::run(jobs, wanted, None, &mut |i, ended: &Ended<S>| found[i] = Some(*ended))
        .unwrap();
    found.into_iter().map(Option::unwrap).collect()
}

/// Copies of a job that stop at the given numbers of impacts.
pub(crate) fn stopped_at<S: SideBySide + Clone>(
    job: &Job<S>,
    impacts: impl Iterator<Item = u64>,
) -> Vec<Job<S>> {
    let stopped = |max_impacts| {
        let limits = Limits { max_impacts, ..job.limits };
        Job { limits, ..Job::clone(job) }
    };
    impacts.map(stopped).collect()
}

pub(crate) const NOTHING: Wanted = Wanted::NONE;

/// The errors of all impacts of a reference, in rounding units. A chatter is left to the exact tier, so
/// scenes with stick episodes are compared by their counts.
fn judged<S: SideBySide + Clone>(job: &Job<S>, events: &[Expected]) -> Vec<f64> {
    let sticks = events.iter().filter(|event| event.kind == Kind::Stick).count();
    let impacts: Vec<_> = events.iter().filter(|event| event.kind == Kind::Impact).collect();
    let (whole, ..) = all(std::slice::from_ref(job), NOTHING)[0];
    assert_eq!(whole.outcome, Outcome::Finished);
    assert_eq!((whole.impacts, whole.episodes), (impacts.len() as u64, sticks as u64));
    if sticks > 0 {
        return Vec::new();
    }
    let ends = all(&stopped_at(job, 1..impacts.len() as u64 + 1), NOTHING);
    let error = |((tally, ..), event): (&Ended<S>, &&Expected)| {
        let off = (Dd::from(tally.end_time) - event.time).value();
        units(off, event.condition, event.time.value())
    };
    ends.iter().zip(&impacts).map(error).collect()
}

/// Fails unless the errors are within their bounds.
pub(crate) fn small(what: &str, mut errors: Vec<f64>) {
    if errors.is_empty() {
        return;
    }
    errors.sort_by(f64::total_cmp);
    let (median, worst) = (errors[errors.len() / 2], errors[errors.len() - 1]);
    println!("{what:30} {:5} impacts, median {median:.2}, worst {worst:.2}", errors.len());
    assert!(median <= MEDIAN_ALLOWED && worst <= UNITS_ALLOWED, "{what}: {median} {worst}");
}

#[test]
fn references_are_met_to_some_units() {
    let mut errors = Vec::new();
    for reference in forced_scenes() {
        let Some(system) = reference.mass() else { continue };
        let limits = Limits::new(reference.duration, reference.parameters.clearance);
        let limits = Limits { chatter_floor: FLOOR, ..limits };
        let start = Start { displacement: reference.displacement, ..Start::default() };
        let job = Job { system, start, begin: 0.0, limits, steady: None, tier: Tier::Fast };
        errors.extend(judged(&job, &reference.events));
    }
    small("references", errors);
}

pub(crate) fn decay(rng: &mut Rng) -> Job<Siva> {
    let clearance = rng.log_range(0.1, 2.0);
    let zeta = rng.pick(&[0.0, 0.001, 0.01, 0.05, 0.3, 1.0, 1.7]);
    let system = Siva::new(rng.log_range(0.01, 0.5), rng.range(0.1, 1.0), clearance, zeta).unwrap();
    let place = rng.range(-0.9, 0.9);
    let start = Start {
        displacement: rng.range(-1.0, 1.0),
        velocity: rng.range(-1.0, 1.0),
        gap_displacement: place * clearance,
        gap_velocity: rng.range(-1.0, 1.0),
    };
    let limits = Limits::new(rng.range(5.0, 100.0), clearance);
    Job { system, start, begin: 0.0, limits, steady: None, tier: Tier::Fast }
}

/// A random harmonic force.
pub(crate) fn harmonic(rng: &mut Rng, acts: Acts) -> Harmonic {
    let frequency = rng.log_range(0.2, 4.0);
    Harmonic { amplitude: rng.range(-0.5, 0.5), frequency, phase: rng.range(-3.0, 3.0), acts }
}

pub(crate) fn driven(rng: &mut Rng, acts: Acts) -> Job<Siva<DrivenHost>> {
    let Job { system, start, limits, tier, .. } = decay(rng);
    let force = Force::new(vec![harmonic(rng, acts)], Vec::new(), &[]).unwrap();
    Job { system: system.under(force), start, begin: 0.0, limits, steady: None, tier }
}

/// The results of a run as a text with all digits.
fn told<S: SideBySide>(ended: &Ended<S>) -> String {
    let (tally, measures, steady) = ended;
    format!("{tally:?} {measures:?} {steady:?}")
}

const STEADY: SteadyWanted = SteadyWanted { strobes: false, ..SteadyWanted::ALL };

/// Random driven runs with windows that begin anywhere.
fn steady(rng: &mut Rng, acts: Acts) -> Job<Siva<DrivenHost>> {
    let job = driven(rng, acts);
    let cycle = job.system.force().and_then(|force| force.harmonics().first().copied());
    let from = rng.pick(&[0.0, 0.3, 0.9]) * job.limits.duration;
    Job { steady: Some((STEADY, Window { from, cycle })), ..job }
}

#[test]
fn a_run_has_the_same_bits_whatever_runs_beside_it() {
    let mut rng = Rng::new(7);
    for acts in [Acts::Primary, Acts::Base] {
        let runs: Vec<_> = (0..60).map(|_| steady(&mut rng, acts)).collect();
        let together = all(&runs, Wanted::ALL);
        for (job, ended) in runs.iter().zip(&together) {
            let by_itself = all(std::slice::from_ref(job), Wanted::ALL);
            assert_eq!(told::<Siva<DrivenHost>>(&by_itself[0]), told::<Siva<DrivenHost>>(ended));
        }
    }
}

/// The measures of a decay and of a steady state, by name.
fn measures(values: &MeasureValues, steady: Option<&SteadyValues>) -> Vec<(&'static str, f64)> {
    let some = |name, value: Option<f64>| value.map(|value| (name, value));
    let settled = steady.copied().unwrap_or_default();
    [
        some("damping_ratio_1", values.damping_ratio_1),
        some("damping_ratio_3", values.damping_ratio_3),
        some("damping_ratio_10", values.damping_ratio_10),
        some("damping_ratio_fit", values.damping_ratio_fit),
        some("damping_ratio_energy", values.damping_ratio_energy),
        some("settling_time_10", values.settling_time_10),
        some("settling_time_5", values.settling_time_5),
        some("settling_time_2", values.settling_time_2),
        some("residual_amplitude", values.residual_amplitude),
        some("energy_viscous", Some(values.energy_viscous)),
        some("energy_final", Some(values.energy_final)),
        some("energy_work", Some(values.energy_work)),
        some("energy_residual", Some(values.energy_residual)),
        some("amplitude_max", settled.amplitude_max),
        some("amplitude_rms", settled.amplitude_rms),
        some("acceleration_max", settled.acceleration_max),
        some("base_max", settled.base_max),
        some("impacts_per_cycle", settled.impacts_per_cycle),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The largest difference between the measures of both tiers, over the condition; `None` if not comparable.
fn difference<S: SideBySide + Differentiable + Clone + Debug>(
    job: &Job<S>,
) -> Option<(f64, &'static str)> {
    let exact = Job { tier: Tier::Exact, ..Job::clone(job) };
    let mut errors = Errors::default();
    simulate(&job.system, &job.start, &job.limits, None, &mut errors).unwrap();
    let condition = errors.condition().unwrap_or(1.0);
    let grazes = errors.impacts.iter().any(|impact| impact.grazing || impact.time.is_none());
    if condition > 1e4 || grazes {
        return None;
    }
    let [(a, first, steady), (b, second, other)] =
        [&exact, job].map(|job| all(std::slice::from_ref(job), Wanted::ALL)[0]);
    assert_eq!(
        (a.impacts, a.episodes, a.effective_impacts, a.undecided),
        (b.impacts, b.episodes, b.effective_impacts, b.undecided)
    );
    assert_eq!(steady.and_then(|it| it.regime), other.and_then(|it| it.regime), "{job:?}");
    let pairs = [measures(&first, steady.as_ref()), measures(&second, other.as_ref())];
    let names = pairs.each_ref().map(|values| values.iter().map(|it| it.0).collect::<Vec<_>>());
    assert_eq!(names[0], names[1], "{job:?}");
    let scale = U * (condition.max(1.0) + job.limits.duration);
    let off = |((name, a), (_, b)): (&(&'static str, f64), &(&'static str, f64))| {
        ((a - b).abs() / (scale * a.abs().max(1.0)), *name)
    };
    pairs[0].iter().zip(&pairs[1]).map(off).max_by(|a, b| a.0.total_cmp(&b.0))
}

#[test]
fn measures_differ_by_no_more_than_their_condition_explains() {
    let mut rng = Rng::new(11);
    let mut found = Vec::new();
    for _ in 0..400 {
        found.extend(difference(&steady(&mut rng, Acts::Primary)));
        found.extend(difference(&steady(&mut rng, Acts::Base)));
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let share = |share: f64| found[(share * found.len() as f64) as usize];
    println!("{} runs, {:?}, {:?}, {:?}", found.len(), share(0.5), share(0.99), found.last());
    assert!(share(0.5).0 <= MEDIAN_ALLOWED && share(0.99).0 <= UNITS_ALLOWED, "{:?}", share(0.99));
    assert!(found.len() > 300);
}

/// Runs for which there is no fast tier equal those of the exact tier, and are reported as such.
#[test]
fn a_tier_that_is_not_there_is_not_named() {
    let period = TAU;
    let force = |frequencies: &[f64]| {
        let one = |frequency: &f64| Harmonic {
            amplitude: 0.1,
            frequency: *frequency,
            phase: 0.0,
            acts: Acts::Primary,
        };
        Force::new(frequencies.iter().map(one).collect(), Vec::new(), &[]).unwrap()
    };
    let siva = Siva::new(0.1, 0.6, 0.7, 0.01).unwrap();
    let job = |frequencies: &[f64]| Job {
        begin: 0.0,
        system: siva.under(force(frequencies)),
        start: Start { displacement: 0.5, ..Start::default() },
        limits: Limits::new(20.0 * period, 0.7),
        steady: None,
        tier: Tier::Fast,
    };
    assert_eq!(SideBySide::tier(&job(&[1.0])), Tier::Fast);
    assert_eq!(SideBySide::tier(&decay(&mut Rng::new(3))), Tier::Exact);
    let two = job(&[1.0, 1.3]);
    assert_eq!(SideBySide::tier(&two), Tier::Exact);
    let exact = Job { tier: Tier::Exact, ..two.clone() };
    let [two, exact] =
        [two, exact].map(|job| told::<Siva<DrivenHost>>(&all(&[job], Wanted::ALL)[0]));
    assert_eq!(two, exact);
}

/// The runs in both tiers, with all measures.
fn both<S: SideBySide + Clone>(jobs: &[Job<S>]) -> [Vec<Ended<S>>; 2] {
    let exact: Vec<_> =
        jobs.iter().map(|job| Job { tier: Tier::Exact, ..Job::clone(job) }).collect();
    [all(&exact, Wanted::ALL), all(jobs, Wanted::ALL)]
}

/// Strobes at time zero, at the begin of the window, at the end of the run, and at stops of the event loop.
#[test]
fn strobes_at_stops_are_taken_once() {
    let mut jobs = Vec::new();
    for (i, cycles) in [25.0_f64, 28.0, 29.0, 40.0, 41.0].iter().enumerate() {
        for (frequency, from) in [(1.0, 0.0), (1.0, 6.0), (2.0, 0.0), (0.9, 3.0)] {
            let acts = [Acts::Primary, Acts::Base][i % 2];
            let force = Harmonic { amplitude: 0.1, frequency, phase: 0.0, acts };
            let siva = Siva::new(0.1, 0.6, 0.4, 0.1).unwrap();
            let cycle = TAU / frequency;
            jobs.push(Job {
                begin: 0.0,
                system: siva.under(Force::new(vec![force], Vec::new(), &[]).unwrap()),
                start: Start { displacement: 0.5, ..Start::default() },
                limits: Limits::new(cycles * cycle, 0.4),
                steady: Some((STEADY, Window { from: from * cycle, cycle: Some(force) })),
                tier: Tier::Fast,
            });
        }
    }
    let [exact, fast] = both(&jobs);
    for ((job, exact), fast) in jobs.iter().zip(&exact).zip(&fast) {
        let regime = |ended: &Ended<Siva<DrivenHost>>| ended.2.unwrap().regime;
        assert_eq!(regime(exact), regime(fast), "{:?} {:?}", job.limits, job.steady);
        assert_eq!(exact.0.impacts, fast.0.impacts);
    }
    assert!(fast.iter().any(|it| it.2.unwrap().regime.is_some()));
}

/// Some strobes are taken in lanes, others in the event loop: after low rebounds and stick episodes. They tell
/// one regime where all of them have the middle of the gap in y.
#[test]
fn strobes_in_a_gap_off_centre_tell_the_regime_of_the_exact_tier() {
    let mut rng = Rng::new(31);
    let mut jobs = Vec::new();
    for _ in 0..300 {
        let force =
            Harmonic { frequency: rng.range(0.6, 1.5), ..harmonic(&mut rng, Acts::Primary) };
        let clearance = rng.log_range(0.1, 0.8);
        let siva = Siva::new(0.1, rng.range(0.1, 0.5), clearance, 0.1).unwrap();
        let siva = siva.with_offset(0.7 * clearance).unwrap();
        let cycle = TAU / force.frequency;
        let force = Force::new(vec![force], Vec::new(), &[]).unwrap();
        let cycle_of = force.harmonics()[0];
        jobs.push(Job {
            begin: 0.0,
            system: siva.under(force),
            start: Start { displacement: 0.5, ..Start::default() },
            limits: Limits::new(150.0 * cycle, clearance),
            steady: Some((STEADY, Window { from: 60.0 * cycle, cycle: Some(cycle_of) })),
            tier: Tier::Fast,
        });
    }
    let [exact, fast] = both(&jobs);
    let regime = |ended: &Ended<Siva<DrivenHost>>| ended.2.unwrap().regime.map(|it| it.to_string());
    let mut stuck = 0;
    for ((job, exact), fast) in jobs.iter().zip(&exact).zip(&fast) {
        let [a, b] = [exact, fast].map(regime);
        let periodic = a.as_ref().is_some_and(|a| a.contains(':'));
        if periodic {
            assert_eq!(a, b, "{:?}", job.system);
            stuck += u64::from(exact.0.episodes > 50);
        }
    }
    assert!(stuck > 20, "{stuck} periodic motions with sticks");
}

/// The motion does not depend on what is measured, not even where a run has so many motions that its log is taken
/// on the way.
#[test]
fn measures_do_not_move_a_run() {
    let mut rng = Rng::new(20_261_125);
    let mut full = 0;
    for scene in 0..40 {
        let clearance = rng.range(0.05, 0.4);
        let siva = Siva::new(rng.range(0.01, 0.05), rng.range(0.97, 1.0), clearance, 1e-4).unwrap();
        let start = Start { displacement: 1.0, gap_velocity: 0.3, ..Start::default() };
        let limits = Limits::new(3000.0, clearance);
        let tier = Tier::Fast;
        let harmonic = harmonic(&mut rng, Acts::Primary);
        let force = Force::new(vec![harmonic], vec![], &[]).unwrap();
        let job = Job { system: siva.under(force), start, begin: 0.0, limits, steady: None, tier };
        let [plain] = all(std::slice::from_ref(&job), Wanted::NONE).try_into().unwrap();
        full += u32::from(plain.0.impacts > 1024);
        for wanted in [Wanted::NONE, Wanted::ALL] {
            let window = Window { from: 100.0, cycle: Some(harmonic) };
            let job = Job { steady: Some((STEADY, window)), ..job.clone() };
            let [found] = all(std::slice::from_ref(&job), wanted).try_into().unwrap();
            assert_eq!(format!("{:?}", found.0), format!("{:?}", plain.0), "{scene} {wanted:?}");
        }
    }
    assert!(full > 20, "{full} full logs");
}

/// Where the polynomials of a force overflow the event loop does everything, and no measure is lost.
#[test]
fn forces_too_fast_for_the_lanes_leave_no_trace() {
    let mut jobs = Vec::new();
    for frequency in [1e3, 1e13, 1e15] {
        let force = Harmonic { amplitude: 1e-3, frequency, phase: 0.3, acts: Acts::Primary };
        let limits = Limits { max_work: 2000, ..Limits::new(1e3 / frequency, 0.7) };
        jobs.push(Job {
            begin: 0.0,
            system: Siva::new(0.1, 0.6, 0.7, 0.01)
                .unwrap()
                .under(Force::new(vec![force], Vec::new(), &[]).unwrap()),
            start: Start { displacement: 0.5, ..Start::default() },
            limits,
            steady: Some((STEADY, Window { from: 0.0, cycle: Some(force) })),
            tier: Tier::Fast,
        });
    }
    let [exact, fast] = both(&jobs);
    for (exact, fast) in exact.iter().zip(&fast) {
        assert_eq!(exact.0.outcome, fast.0.outcome);
        let off = exact.1.energy_work - fast.1.energy_work;
        assert!(off.abs() < 1e-14, "{exact:?} {fast:?}");
        assert!(fast.1.energy_viscous.is_finite() && fast.1.energy_residual.abs() < 1e-14);
    }
}
