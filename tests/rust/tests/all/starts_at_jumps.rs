//! Runs that begin at a jump or corner of a record. The begin of a run and the points of a record are
//! converted to natural time by themselves, so the two may differ by a rounding.
//!
//! The truth is the same run begun a little earlier, before the jump: the motion depends continuously on the
//! begin, the jump itself included.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;

use iva_core::{
    absorber::{Absorber, Start},
    force::{Acts, Force, History, Record},
    observe::Events,
    piva::{Parameters, Piva, PivaStart},
    sample::{Sampler, State},
    simulate::{Limits, Outcome, simulate_from},
    siva::Siva,
};
use iva_tests::rng::Rng;

/// Natural times after the begin at which runs are compared.
const LATER: [f64; 3] = [0.1, 0.2, 0.4];
/// How much earlier the other run begins, relative to the instant.
const EARLIER: f64 = 1e-10;
/// Largest difference of a displacement; the wrong branch at a wall differs by some thousandths.
const ALLOWED: f64 = 1e-4;

/// Two records, of which one ends or bends and the other may begin at `jump` (user's time), per ωn².
fn force(rng: &mut Rng, omega: f64, jump: f64) -> Force {
    let acts = if rng.unit() < 0.3 { Acts::Base } else { Acts::Primary };
    let record = |times: Vec<f64>, values: Vec<f64>| {
        let values = values.iter().map(|value| value * omega * omega).collect();
        let history = Arc::new(History::new(times, values).unwrap());
        Record { history, acts, rate: omega, scale: 1.0 / (omega * omega) }
    };
    let mut value = || rng.range(-4.0, 4.0);
    let (a, b, c) = (value(), value(), value());
    let (before, after) = (0.3 * jump, jump + 2.0 / omega);
    let records = match rng.pick(&[0.0, 1.0, 2.0, 3.0]) as u8 {
        // A jump up from nothing, a jump down to nothing, both, a corner.
        0 => vec![record(vec![jump, after], vec![a, b])],
        1 => vec![record(vec![before, jump], vec![a, b])],
        2 => vec![record(vec![before, jump], vec![a, b]), record(vec![jump, after], vec![c, -c])],
        _ => vec![record(vec![before, jump, after], vec![a, b, c])],
    };
    Force::new(Vec::new(), records, &[]).unwrap()
}

/// The states at `times`, and how the run ended.
fn moved<S: Absorber<Real = f64>>(
    system: &S,
    start: &S::Start,
    begin: f64,
    times: &[f64],
) -> Vec<State> {
    let limits = Limits::new(times[times.len() - 1] + 0.1, system.clearance());
    let mut observers = (Sampler::at(times.to_vec()), Events::default());
    let tally = simulate_from(system, start, begin, &limits, None, &mut observers).unwrap();
    assert_eq!(tally.outcome, Outcome::Finished, "{start:?} at {begin}");
    for episode in &observers.1.episodes {
        let release = episode.release_time.unwrap_or(limits.duration);
        assert!(begin <= episode.stick_time && episode.stick_time <= release, "{episode:?}");
    }
    observers.0.states
}

/// The largest difference of x and y; true if the absorber was stuck in one of the states.
fn compared(a: &[State], b: &[State]) -> (f64, bool) {
    assert_eq!((a.len(), b.len()), (LATER.len(), LATER.len()));
    let off = |(a, b): (&State, &State)| {
        let gap = (a.gap_displacement - b.gap_displacement).abs();
        gap.max((a.displacement - b.displacement).abs())
    };
    let stuck = b.iter().any(|state| state.wall != 0);
    (a.iter().zip(b).map(off).fold(0.0, f64::max), stuck)
}

/// Compares runs that begin at a jump, exactly or a rounding off, with one that begins a little earlier.
fn at_a_jump<S: Absorber<Real = f64>>(system: &S, start: &S::Start, jump: f64) -> (f64, bool) {
    let times = LATER.map(|later| jump + later);
    let earlier = moved(system, start, jump * (1.0 - EARLIER), &times);
    let mut worst = (0.0, false);
    for begin in [jump.next_down(), jump, jump.next_up()] {
        let (off, stuck) = compared(&moved(system, start, begin, &times), &earlier);
        worst = (off.max(worst.0), stuck);
    }
    worst
}

#[test]
fn a_run_that_begins_at_a_jump_is_the_run_begun_a_little_earlier() {
    let mut rng = Rng::new(20_261_124);
    let [mut stuck, mut at_wall, mut worst] = [0.0, 0.0, 0.0_f64];
    for number in 0..2000 {
        let omega = rng.log_range(1e-2, 1e3);
        let jump = rng.log_range(0.1, 30.0) / omega;
        let (d, e) = (rng.range(0.2, 1.0), rng.pick(&[0.0, 0.5, 0.8]));
        let zeta = rng.pick(&[0.0, 0.01, 0.2]);
        let touches = rng.unit() < 0.7;
        let place = if touches { rng.sign() } else { rng.range(-0.95, 0.95) };
        let start = Start {
            displacement: rng.range(-2.0, 2.0),
            velocity: rng.range(-2.0, 2.0),
            gap_displacement: d * place,
            gap_velocity: if touches { 0.0 } else { rng.range(-1.0, 1.0) },
        };
        let force = force(&mut rng, omega, jump);
        let begin = jump * omega;
        let (off, rides) = if number % 4 == 0 {
            let bob = Parameters::point_bob(0.1, e, d, zeta, 3.0 * d);
            at_a_jump(&Piva::new(bob).unwrap().under(force), &PivaStart::from(start), begin)
        } else {
            let gravity = rng.pick(&[0.0, 1.0, -1.0]);
            let siva = Siva::new(0.1, e, d, zeta).unwrap().inclined(gravity, force);
            at_a_jump(&siva, &start, begin)
        };
        assert!(off <= ALLOWED, "scene {number}: {off:e}, begins at {begin}, {start:?}");
        worst = worst.max(off);
        stuck += if rides { 1.0 } else { 0.0 };
        at_wall += if touches { 1.0 } else { 0.0 };
    }
    println!("{at_wall} begin at a wall, {stuck} have a stick, worst {worst:e}");
    assert!(stuck > 400.0 && at_wall > 1300.0);
}

/// A run that is cut at a jump goes on from the state there, written as a start in doubles.
#[test]
fn a_run_goes_on_from_its_state_at_a_jump() {
    let mut rng = Rng::new(5);
    let [mut stuck, mut worst] = [0.0, 0.0_f64];
    for number in 0..500 {
        let omega = rng.log_range(1e-2, 1e3);
        let jump = rng.log_range(0.3, 10.0) / omega;
        let (d, zeta) = (rng.range(0.2, 1.0), rng.pick(&[0.0, 0.01, 0.2]));
        let force = force(&mut rng, omega, jump);
        let system = Siva::new(0.1, 0.5, d, zeta).unwrap().inclined(1.0, force);
        let start = Start { gap_displacement: -d, ..Start::default() };
        let at = jump * omega;
        let times: Vec<f64> = std::iter::once(at).chain(LATER.map(|later| at + later)).collect();
        let whole = moved(&system, &start, 0.0, &times);
        let State { displacement, velocity, gap_displacement, gap_velocity, .. } = whole[0];
        let start = Start { displacement, velocity, gap_displacement, gap_velocity };
        let (off, rides) = compared(&moved(&system, &start, at, &times[1..]), &whole[1..]);
        assert!(off <= ALLOWED, "scene {number}: {off:e} after {at}");
        worst = worst.max(off);
        stuck += if whole[0].wall != 0 || rides { 1.0 } else { 0.0 };
    }
    println!("{stuck} have a stick, worst {worst:e}");
    assert!(stuck > 200.0);
}
