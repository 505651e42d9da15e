//! Runs that begin later: from a state, or at another instant of the force; runs ended by an observer; and
//! the derivative of a period.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iva_core::{
    absorber::{Absorber, OnStructure, Start},
    compensated::DoubleDouble,
    force::{Acts, Force, Harmonic, Impulse},
    host::DrivenHost,
    impact::Impact,
    measures::{Measures, Wanted},
    observe::{Events, Observer, StickEpisode},
    piva::{Parameters, Piva},
    propagation::{Differentiable, Errors, Estimated},
    sample::Sampler,
    simulate::{Instant, Limits, Outcome, resume, simulate},
    siva::Siva,
    steady::{Steady, SteadyWanted, Window},
};
use iva_tests::rng::Rng;
use nalgebra::Matrix4;

const U: f64 = f64::EPSILON / 2.0;

fn harmonic(amplitude: f64, frequency: f64, phase: f64) -> Harmonic {
    Harmonic { amplitude, frequency, phase, acts: Acts::Primary }
}

/// Impacts and stick episodes of a run from an instant, with the estimated errors of the impacts.
struct Seen {
    instant: Option<(Outcome, f64)>,
    impacts: Vec<Impact>,
    episodes: Vec<StickEpisode>,
    errors: Vec<f64>,
}

fn seen<S: Differentiable + Estimated>(
    system: &S,
    from: &Instant<S::State>,
    until: f64,
) -> (Seen, Instant<S::State>) {
    let limits = Limits::new(until, system.clearance());
    let mut observers = (Events::default(), Errors::default());
    let tally = resume(system, from, &limits, None, &mut observers).unwrap();
    let (Events { impacts, episodes }, errors) = observers;
    let errors = errors.impacts.iter().map(|it| it.time.unwrap_or(f64::INFINITY)).collect();
    let instant = Some((tally.outcome, tally.end_time));
    (Seen { instant, impacts, episodes, errors }, tally.instant())
}

/// Compares a run in one piece and in two; returns the number of impacts compared and of pieces that begin
/// stuck.
fn cut<S: Differentiable + Estimated>(
    system: &S,
    start: &S::Start,
    at: f64,
    until: f64,
) -> [usize; 2] {
    let from = Instant::start(system, start);
    let (whole, end) = seen(system, &from, until);
    let (first, middle) = seen(system, &from, at);
    let (second, end_again) = seen(system, &middle, until);
    assert_eq!(second.instant, Some((Outcome::Finished, until)));
    assert_eq!((middle.time.value, end.time, end_again.time), (at, end.time, end.time));
    let impacts: Vec<&Impact> = first.impacts.iter().chain(&second.impacts).collect();
    let mut compared = 0;
    for ((one, two), error) in whole.impacts.iter().zip(&impacts).zip(&whole.errors) {
        if *error > 1e-6 {
            break;
        }
        assert_eq!(one.wall, two.wall, "impact {compared} at {}", one.time);
        let off = (one.time - two.time).abs();
        assert!(off <= 4.0 * error + 8.0 * U * one.time, "impact {compared}: {off:e}, {error:e}");
        compared += 1;
    }
    if whole.errors.iter().all(|error| *error <= 1e-6) {
        let of_whole: u64 = whole.episodes.iter().map(|episode| episode.impacts).sum();
        assert!(impacts.len() == whole.impacts.len() || of_whole > 0, "{} impacts", impacts.len());
    }
    let begins_stuck = second.episodes.first().is_some_and(|it| it.start_time == at);
    [compared, usize::from(begins_stuck)]
}

#[test]
fn a_run_in_two_pieces_is_the_run_in_one() {
    let mut rng = Rng::new(2021);
    let [mut compared, mut stuck] = [0; 2];
    for number in 0..400 {
        let (mu, e) = (rng.log_range(0.02, 0.4), rng.pick(&[0.0, 0.3, 0.6, 0.8, 1.0]));
        let (d, zeta) = (rng.log_range(0.2, 2.0), rng.pick(&[0.0, 0.02, 0.1]));
        let start = Start {
            displacement: rng.range(-1.0, 1.0),
            velocity: rng.range(-1.0, 1.0),
            gap_displacement: d * rng.range(-1.0, 1.0),
            ..Start::default()
        };
        let force = harmonic(rng.range(0.2, 1.0), rng.range(0.6, 1.4), rng.range(0.0, 6.0));
        let impulse = Impulse { velocity: 0.4, time: 3.0 };
        let impulses = if number % 5 == 0 { &[impulse][..] } else { &[] };
        let force = Force::new(vec![force], Vec::new(), impulses).unwrap();
        let at = rng.range(0.5, 9.0);
        let siva = Siva::new(mu, e, d, zeta).unwrap();
        let piva = Piva::new(Parameters::point_bob(mu, e, d, zeta, 3.0 * d)).unwrap();
        let found = match number % 4 {
            0 => cut(&siva, &start, at, 12.0),
            1 | 2 => cut(&siva.under(force), &start, at, 12.0),
            _ => cut(&piva.under(force), &start.into(), at, 12.0),
        };
        compared += found[0];
        stuck += found[1];
    }
    println!("{compared} impacts, {stuck} pieces begin stuck");
    assert!(compared > 1500 && stuck > 20, "{compared} {stuck}");
}

/// A start at a later instant equals a start at time zero under the force with its phase advanced
/// accordingly.
#[test]
fn a_start_at_an_instant_has_the_force_of_that_instant() {
    let mut rng = Rng::new(7);
    let mut compared = 0;
    for _ in 0..100 {
        let (amplitude, omega) = (rng.range(0.3, 1.0), rng.range(0.6, 1.4));
        let time = rng.range(0.0, 5.0);
        let siva = Siva::new(0.15, 0.6, 0.7, 0.03).unwrap();
        let under =
            |phase| siva.under(Force::harmonic(vec![harmonic(amplitude, omega, phase)]).unwrap());
        let start = Start { displacement: rng.range(-1.0, 1.0), ..Start::default() };
        let (system, shifted) = (under(0.3), under(0.3 + omega * time));
        let clock = DoubleDouble::new(time);
        let from = Instant { time: clock, state: system.begin_at(&start, clock) };
        let (late, _) = seen(&system, &from, time + 10.0);
        let (early, _) = seen(&shifted, &Instant::start(&shifted, &start), 10.0);
        assert_eq!(late.impacts.len(), early.impacts.len());
        for ((a, b), error) in late.impacts.iter().zip(&early.impacts).zip(&early.errors) {
            // The phase is rounded to a double.
            let allowed = 8.0 * error + 64.0 * U * (time + a.time);
            let off = (a.time - time - b.time).abs();
            assert!(*error > 1e-9 || off <= allowed, "{off:e} {allowed:e}");
            compared += 1;
        }
    }
    assert!(compared > 300, "{compared}");
}

/// A run that begins at or after an impulse does not include it, one that begins before does; a run from time
/// zero includes those of time zero.
#[test]
fn impulses_up_to_the_begin_are_over() {
    let impulses = [2.0, 6.0].map(|time| Impulse { velocity: 0.5, time });
    let force = Force::new(Vec::new(), Vec::new(), &impulses).unwrap();
    let siva = Siva::new(0.1, 0.6, 50.0, 0.0).unwrap().under(force.clone());
    let piva = Piva::new(Parameters::point_bob(0.1, 0.6, 50.0, 0.0, 100.0)).unwrap().under(force);
    for (begin, left) in
        [(1.0, [2.0, 6.0].as_slice()), (2.0, &[6.0]), (3.0, &[6.0]), (6.0, &[]), (7.0, &[])]
    {
        let clock = DoubleDouble::new(begin);
        let limits = Limits::new(10.0, 50.0);
        // x = ½ sin(τ − τ₁) + ½ sin(τ − τ₂), and nothing before.
        let truth: f64 = left.iter().map(|time| 0.5 * (10.0_f64 - time).sin()).sum();
        let from = Instant { time: clock, state: siva.begin_at(&Start::default(), clock) };
        let end = resume(&siva, &from, &limits, None, &mut ()).unwrap();
        let x = siva.primary(&end.state).x;
        assert!((x - truth).abs() < 1e-14, "from {begin}: {x} {truth}");
        let from = Instant { time: clock, state: piva.begin_at(&Start::default().into(), clock) };
        let end = resume(&piva, &from, &limits, None, &mut ()).unwrap();
        let hit = piva.primary(&end.state).x != 0.0;
        assert_eq!(hit, !left.is_empty(), "from {begin}");
    }
}

/// An observer that ends a run after a number of impacts.
struct After(u64);

impl<S: Absorber> Observer<S> for After {
    fn impact(&mut self, _system: &S, _impact: &Impact<S::Real>) {
        self.0 = self.0.saturating_sub(1);
    }

    fn is_done(&self) -> bool {
        self.0 == 0
    }
}

#[test]
fn an_observer_ends_a_run() {
    let siva = Siva::new(0.1, 0.8, 0.5, 0.0).unwrap();
    let start = Start { displacement: 1.0, ..Start::default() };
    let limits = Limits::new(10.0 * TAU, 0.5);
    let mut observers = (Events::default(), After(5));
    let tally = simulate(&siva, &start, &limits, None, &mut observers).unwrap();
    assert_eq!((tally.outcome, tally.impacts), (Outcome::Stopped, 5));
    assert_eq!(tally.outcome.name(), "stopped");
    assert_eq!(observers.0.impacts.last().unwrap().time, tally.end_time);
    // The continued run has the bits of the whole: the end did not cut a stretch of motion.
    let mut whole = Events::default();
    simulate(&siva, &start, &limits, None, &mut whole).unwrap();
    let mut rest = Events::default();
    resume(&siva, &tally.instant(), &limits, None, &mut rest).unwrap();
    assert_eq!([observers.0.impacts, rest.impacts].concat(), whole.impacts);
}

/// Samples, peaks and strobes of a continued run equal those of the whole run from there on.
#[test]
fn observers_see_a_run_from_its_begin_on() {
    let push = harmonic(0.5, 1.1, 0.2);
    let siva = Siva::new(0.1, 0.6, 0.7, 0.03).unwrap();
    let siva = siva.under(Force::harmonic(vec![push]).unwrap());
    let start = Start { displacement: 1.0, ..Start::default() };
    let times: Vec<f64> = (0..=300).map(|k| 0.1 * f64::from(k)).collect();
    let window = Window { from: 0.0, cycle: Some(push) };
    let wanted = SteadyWanted { strobes: true, ..SteadyWanted::ALL };
    let listed = Wanted { envelope: true, ..Wanted::NONE };
    let observers =
        || (Sampler::at(times.clone()), (Measures::new(listed), Steady::new(window, wanted)));
    let (mut whole, mut rest) = (observers(), observers());
    let limits = Limits::new(30.0, 0.7);
    simulate(&siva, &start, &limits, None, &mut whole).unwrap();
    let first = simulate(&siva, &start, &Limits::new(12.34, 0.7), None, &mut ()).unwrap();
    resume(&siva, &first.instant(), &limits, None, &mut rest).unwrap();
    let (states, peaks) = (&rest.0.states, rest.1.0.envelope());
    assert_eq!(states.len(), times.iter().filter(|time| **time >= 12.34).count());
    for (a, b) in states.iter().rev().zip(whole.0.states.iter().rev()) {
        assert_eq!(a.time, b.time);
        assert!((a.displacement - b.displacement).abs() < 1e-10, "{}", a.time);
    }
    assert!(peaks[0].time >= 12.34, "{:?}", peaks[0]);
    let strobes: Vec<f64> = rest.1.1.strobes().map(|strobe| strobe.time).collect();
    let later: Vec<f64> =
        whole.1.1.strobes().map(|strobe| strobe.time).filter(|time| *time >= 12.34).collect();
    assert_eq!(strobes, later);
}

#[test]
fn a_run_does_not_go_on_from_its_end() {
    let siva = Siva::new(0.1, 0.8, 0.5, 0.0).unwrap();
    let limits = Limits::new(5.0, 0.5);
    let tally = simulate(&siva, &Start::default(), &limits, None, &mut ()).unwrap();
    let error = resume(&siva, &tally.instant(), &limits, None, &mut ()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "run.duration = 5: give more than 5, the instant that it goes on from"
    );
}

/// A periodic orbit of a free mass under cos τ: clearance, state at time 0 and Floquet multipliers, from a
/// boundary-value problem in impact times with 50 digits, given to 17.
struct Orbit {
    clearance: f64,
    state: [f64; 4],
    multipliers: [[f64; 2]; 4],
}

#[allow(clippy::excessive_precision)] // the digits as printed
const ORBITS: [Orbit; 2] = [
    Orbit {
        clearance: 4.5,
        state: [
            -1.103_156_743_247_770_2,
            0.327_501_609_173_651_1,
            -4.037_732_857_123_851_6,
            3.255_630_719_455_687_6,
        ],
        multipliers: [
            [0.550_577_507_158_645_0, 0.467_293_191_256_058_44],
            [0.550_577_507_158_645_0, -0.467_293_191_256_058_44],
            [0.313_709_639_088_309_94, 0.383_674_744_641_538_65],
            [0.313_709_639_088_309_94, -0.383_674_744_641_538_65],
        ],
    },
    // An unstable orbit.
    Orbit {
        clearance: 3.0,
        state: [
            -2.333_805_057_368_052_5,
            0.957_159_603_387_611_1,
            -2.187_699_745_573_819_5,
            2.525_821_941_031_89,
        ],
        multipliers: [
            [5.469_080_376_201_061, 0.0],
            [0.604_630_645_356_308_9, 0.396_184_837_184_487_54],
            [0.604_630_645_356_308_9, -0.396_184_837_184_487_54],
            [0.044_821_099_745_351_76, 0.0],
        ],
    },
];

/// Σ λᵏ, real because complex multipliers come in conjugate pairs.
fn power_sum(multipliers: &[[f64; 2]; 4], k: i32) -> f64 {
    let part = |[re, im]: &[f64; 2]| re.hypot(*im).powi(k) * (f64::from(k) * im.atan2(*re)).cos();
    multipliers.iter().map(part).sum()
}

#[test]
fn the_derivative_over_a_period_has_the_floquet_multipliers() {
    for Orbit { clearance, state, multipliers } in &ORBITS {
        let siva: Siva<DrivenHost> = Siva::new(0.2, 0.7, *clearance, 0.05)
            .unwrap()
            .under(Force::harmonic(vec![harmonic(1.0, 1.0, 0.0)]).unwrap());
        let [displacement, velocity, gap_displacement, gap_velocity] = *state;
        let start = Start { displacement, velocity, gap_displacement, gap_velocity };
        let mut errors = Errors::default();
        let limits = Limits::new(TAU, *clearance);
        let tally = simulate(&siva, &start, &limits, None, &mut errors).unwrap();
        assert_eq!(tally.impacts, 2);
        let back = siva.primary(&tally.state);
        assert!((back.x - displacement).abs() < 1e-13 && (back.v - velocity).abs() < 1e-13);
        let monodromy: Matrix4<f64> = *errors.derivative().unwrap();
        for k in 1..=4 {
            let (trace, truth) = (monodromy.pow(k).trace(), power_sum(multipliers, k as i32));
            assert!((trace - truth).abs() < 1e-12 * truth.abs().max(1.0), "{k}: {trace} {truth}");
        }
        // e^(2N) exp(−2ζT): Liouville's formula.
        let truth = 0.7f64.powi(4) * (-0.1 * TAU).exp();
        assert!((monodromy.determinant() - truth).abs() < 1e-13, "{}", monodromy.determinant());
    }
}
