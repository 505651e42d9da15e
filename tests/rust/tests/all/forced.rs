//! Scenes under force and base motion: reference events, exact periodic motions, work.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::{PI, TAU};

use iva_core::{
    absorber::{Absorber, Start},
    force::{Acts, Force, Harmonic, Impulse},
    host::DrivenHost,
    piva::{Parameters, Piva},
    propagation::{Errors, Estimated, TimeError},
    run::{Run, run, states},
    simulate::{Limits, Outcome, simulate},
    siva::Siva,
};
use iva_tests::{
    U, UNITS_ALLOWED,
    case::compound,
    dd::Dd,
    driven::{mass, pendulum},
    oracle::Kind,
    reference::{PivaReference, forced_scenes},
    timeline::{Mark, marks},
    units,
};
use proptest::{prelude::*, test_runner::TestCaseResult};

/// Approach speed at or below which impacts are missing in the reference.
const FLOOR: f64 = 1e-9;

#[test]
fn every_forced_reference_event_is_found_and_none_added() {
    for scene in forced_scenes() {
        let clearance = scene.parameters.clearance;
        let limits = Limits { chatter_floor: FLOOR, ..Limits::new(scene.duration, clearance) };
        let start = Start { displacement: scene.displacement, ..Start::default() };
        let piva = Piva::new(scene.parameters).unwrap().under(scene.force.clone());
        is_the_reference(&run(&piva, &start.into(), &limits).unwrap(), &scene);
        if let Some(siva) = scene.mass() {
            is_the_reference(&run(&siva, &start, &limits).unwrap(), &scene);
        }
    }
}

/// Fails unless a run has the events of a reference, within rounding.
fn is_the_reference<S>(result: &Run<S>, scene: &PivaReference) {
    assert_eq!((result.tally.outcome, result.tally.undecided), (Outcome::Finished, 0));
    let list = marks(result, FLOOR);
    let found: Vec<_> = list.iter().map(|m| (m.kind, m.wall)).collect();
    let expected: Vec<_> = scene.events.iter().map(|e| (e.kind, e.wall)).collect();
    assert_eq!(found, expected, "{}", scene.name);
    let mut all: Vec<f64> = Vec::new();
    for (mark, event) in list.iter().zip(&scene.events) {
        let error = (Dd::from(mark.time) - event.time).value();
        all.push(units(error, event.condition, event.time.value()));
    }
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    all.sort_by(f64::total_cmp);
    let worst = all[all.len() - 1];
    let median = all[all.len() / 2];
    println!("{:22} median {median:.2} mean {mean:.2} worst {worst:.2} units", scene.name);
    assert!(worst <= UNITS_ALLOWED, "{}: {worst} units", scene.name);
}

fn on_primary(amplitude: f64, frequency: f64, phase: f64) -> Harmonic {
    Harmonic { amplitude, frequency, phase, acts: Acts::Primary }
}

/// A symmetric motion with two impacts a cycle (Masri and Caughey 1966), at the impact on wall +.
struct Orbit {
    absorber: Siva<DrivenHost>,
    /// State just before the impact.
    start: Start,
    half_period: f64,
}

/// The orbit with μ, e, d, ζ, F, Ω, then s, x, ẋ before the impact and the phase a of F sin(Ωτ + a), all from
/// the closed form (evaluated with 40 digits).
fn orbit([mu, e, d, zeta, amplitude, frequency]: [f64; 6], [s, x, v, a]: [f64; 4]) -> Orbit {
    let force = on_primary(amplitude, frequency, a - 0.5 * PI);
    // The absorber moves with s between walls: before the impact on wall + its velocity is +s.
    Orbit {
        absorber: mass(mu, e, d, zeta)(Force::harmonic(vec![force]).unwrap()),
        start: Start { displacement: x, velocity: v, gap_displacement: d, gap_velocity: s - v },
        half_period: PI / frequency,
    }
}

#[test]
fn the_stable_orbit_is_kept_for_ten_thousand_cycles() {
    let orbit = orbit(
        [0.05, 0.8, 2.0, 0.02, 0.1, 1.0],
        [1.452072978709073, 0.2809109011943361, -0.2420121631181788, 4.59047988735129],
    );
    let cycles = 10_000;
    let limits = Limits::new((f64::from(cycles) + 0.25) * TAU, 2.0);
    let result = run(&orbit.absorber, &orbit.start, &limits).unwrap();
    assert_eq!(result.tally.outcome, Outcome::Finished);
    assert_eq!(result.impacts.len(), 2 * cycles as usize + 1);
    let late = |(k, impact): (usize, &iva_core::impact::Impact)| {
        (impact.time - k as f64 * orbit.half_period).abs()
    };
    let worst = result.impacts.iter().enumerate().map(late).fold(0.0, f64::max);
    println!("kept within {worst:e}");
    assert!(worst < 1e-9, "{worst:e}");
    let m = &result.measures;
    assert!(m.energy_residual.abs() < 1e-10 * m.energy_work.abs(), "{:e}", m.energy_residual);
}

#[test]
fn from_rest_it_locks_to_the_stable_orbit() {
    let force = Force::harmonic(vec![on_primary(0.1, 1.0, 0.0)]).unwrap();
    let siva = mass(0.05, 0.8, 2.0, 0.02)(force);
    let result = run(&siva, &Start::default(), &Limits::new(600.0 * TAU, 2.0)).unwrap();
    let [.., last] = result.impacts.as_slice() else { panic!("no impacts") };
    let count = result.impacts.iter().filter(|i| i.time > last.time - 10.25 * TAU).count();
    assert_eq!(count, 21, "two impacts a cycle, both ends of ten cycles");
    let tail = result.peaks.iter().rev().skip(1).take(40);
    let highest = tail.map(|peak| peak.displacement.abs()).fold(0.0, f64::max);
    // The closed form's largest |x| between impacts.
    assert!((highest - 0.353_285_319_188_6).abs() < 1e-9, "{highest}");
}

#[test]
fn an_undamped_resonance_grows_with_time() {
    // x = (F/2) τ sin τ from rest (resonance); the walls are out of reach.
    let siva = mass(0.1, 0.5, 1e6, 0.0)(Force::harmonic(vec![on_primary(0.1, 1.0, 0.0)]).unwrap());
    let times = [1.0, 10.0, 100.0, 1e3, 1e4];
    let found = states(&siva, &Start::default(), &Limits::new(1e4, 1e6), &times).unwrap();
    for state in found {
        let truth = 0.05 * state.time * state.time.sin();
        // An error of one rounding unit in the frequency would give τ² units here.
        let allowed = 64.0 * U * 0.05 * state.time * state.time.sqrt().max(1.0);
        assert!((state.displacement - truth).abs() < allowed, "{state:?} {truth}");
    }
}

#[test]
fn the_unstable_orbit_is_left_at_the_rate_of_its_multiplier() {
    let orbit = orbit(
        [0.1, 0.6, 1.0, 0.01, 0.2, 1.0],
        [1.490992427985109, 1.342045429158013, -0.5591221604944157, 4.572987560392349],
    );
    let result = run(&orbit.absorber, &orbit.start, &Limits::new(15.0 * TAU, 1.0)).unwrap();
    // The deviation comes from the rounding of the start, times −2.56749605 in each half cycle.
    let off: Vec<f64> = result
        .impacts
        .iter()
        .enumerate()
        .map(|(k, impact)| impact.time - k as f64 * orbit.half_period)
        .collect();
    let grown: Vec<f64> = off
        .windows(2)
        .filter(|pair| (1e-10..1e-5).contains(&pair[0].abs()))
        .map(|pair| pair[1] / pair[0])
        .collect();
    assert!(grown.len() > 5, "{off:?}");
    for rate in &grown[grown.len() - 4..] {
        assert!((rate / -2.567_496_05 - 1.0).abs() < 0.01, "{grown:?}");
    }
}

/// A base with a_g = a cos(Ωτ + φ). In the inertial frame it is a force x_g + 2ζ ẋ_g on the primary, with
/// x_g = −(a/Ω²) cos(Ωτ + φ), and no force acts on the absorber.
struct MovingBase {
    acceleration: Harmonic,
    damping_ratio: f64,
}

impl MovingBase {
    /// Amplitude −a/Ω² of the base displacement.
    fn moved(&self) -> f64 {
        let Harmonic { amplitude, frequency, .. } = self.acceleration;
        -amplitude / (frequency * frequency)
    }

    /// Runs from rest relative to the base at a displacement: in the frame of the base, and in the inertial
    /// frame.
    fn both<S>(&self, under: impl Fn(Force) -> S, x: f64, duration: f64) -> [Run<S::State>; 2]
    where
        S: Absorber<Real = f64, Start: From<Start>>,
    {
        let (Harmonic { frequency, phase, .. }, moved) = (self.acceleration, self.moved());
        let seen = vec![
            on_primary(moved, frequency, phase),
            on_primary(-2.0 * self.damping_ratio * moved * frequency, frequency, phase - 0.5 * PI),
        ];
        let relative = Start { displacement: x, ..Start::default() };
        let outside = Start {
            displacement: x + moved * phase.cos(),
            velocity: -moved * frequency * phase.sin(),
            ..relative
        };
        [(vec![self.acceleration], relative), (seen, outside)].map(|(harmonics, start)| {
            let system = under(Force::harmonic(harmonics).unwrap());
            run(&system, &start.into(), &Limits::new(duration, system.clearance())).unwrap()
        })
    }

    /// Both runs have the same impacts at the same times, and ledgers that close.
    fn is_a_force<S>(&self, under: impl Fn(Force) -> S, x: f64) -> TestCaseResult
    where
        S: Absorber<Real = f64, Start: From<Start>>,
    {
        let [one, other] = self.both(under, x, 12.0);
        // Rounding of the inputs, some ulp of 1 + a/Ω², grows by a factor of a few at each impact.
        let mut allowed = 64.0 * U * (1.0 + self.moved().abs());
        for (a, b) in one.impacts.iter().zip(&other.impacts) {
            allowed *= 4.0 / (a.approach_speed() / (0.3 + a.approach_speed()));
            if allowed > 1e-7 {
                break;
            }
            prop_assert_eq!(a.wall, b.wall);
            prop_assert!((a.time - b.time).abs() <= allowed, "{} {}", a.time, b.time);
        }
        let m = &one.measures;
        let size =
            m.energy_initial + m.energy_work.abs() + one.tally.energy_impacts + m.energy_viscous;
        prop_assert!(m.energy_residual.abs() <= 1e-11 * size, "{:e}", m.energy_residual / size);
        Ok(())
    }
}

/// A mirrored scene gives the same bits; a phase advanced by a full turn gives the same run within rounding.
fn mirror_and_turn<S>(under: impl Fn(Force) -> S, force: Harmonic, x: f64) -> TestCaseResult
where
    S: Absorber<Real = f64, Start: From<Start>>,
{
    let scene = |amplitude: f64, phase: f64, displacement: f64| {
        let harmonic = Harmonic { amplitude, phase, ..force };
        let system = under(Force::harmonic(vec![harmonic]).unwrap());
        let start = Start { displacement, ..Start::default() };
        run(&system, &start.into(), &Limits::new(20.0, system.clearance())).unwrap()
    };
    let Harmonic { amplitude, phase, .. } = force;
    let (one, mirrored) = (scene(amplitude, phase, x), scene(-amplitude, phase, -x));
    prop_assert_eq!(one.impacts.len(), mirrored.impacts.len());
    for (a, b) in one.impacts.iter().zip(&mirrored.impacts) {
        prop_assert_eq!(a.time.to_bits(), b.time.to_bits());
        prop_assert_eq!(a.wall.sign(), -b.wall.sign());
    }
    let turned = scene(amplitude, phase + TAU, x);
    if let (Some(a), Some(b)) = (one.impacts.first(), turned.impacts.first()) {
        let allowed = 64.0 * U * (1.0 + 1.0 / a.approach_speed());
        prop_assert!((a.time - b.time).abs() <= allowed, "{} {}", a.time, b.time);
    }
    Ok(())
}

/// A run as a list of events, and the estimated errors of its impacts.
struct Judged<S> {
    run: Run<S>,
    marks: Vec<Mark>,
    errors: Vec<TimeError>,
}

impl<S> Judged<S> {
    fn new<T: Estimated<State = S>>(system: &T, start: &T::Start, duration: f64) -> Self {
        let limits = Limits::new(duration, system.clearance());
        let mut errors = Errors::default();
        simulate(system, start, &limits, None, &mut errors).unwrap();
        let run = run(system, start, &limits).unwrap();
        assert_eq!(run.tally.outcome, Outcome::Finished);
        assert_eq!(run.impacts.len(), errors.impacts.len());
        Self { marks: marks(&run, f64::NEG_INFINITY), run, errors: errors.impacts }
    }

    /// The estimated error of an impact; infinite once the estimate is unreliable.
    fn error(&self, impact: usize) -> f64 {
        self.errors.get(impact).map_or(0.0, |error| match error.time {
            Some(time) if !error.grazing && time <= 1e-6 => time,
            _ => f64::INFINITY,
        })
    }
}

/// The same events in order, impacts at the same times as long as both runs estimate their errors, and the
/// same energies if that holds to the end.
fn agree<S, T>(one: &Judged<S>, other: &Judged<T>) -> TestCaseResult {
    let (mut impacts, mut largest) = (0, 0.0f64);
    for k in 0..one.marks.len().max(other.marks.len()) {
        let (a, b) = (one.marks.get(k), other.marks.get(k));
        if [a, b].iter().flatten().any(|mark| mark.kind == Kind::Impact) {
            // The error of a run is usually at most a quarter of its estimate.
            let allowed = 4.0 * (one.error(impacts) + other.error(impacts));
            if allowed.is_infinite() {
                return Ok(());
            }
            largest = largest.max(allowed);
            let times = a.zip(b).map(|(a, b)| (a.time, b.time));
            let off = times.map_or(0.0, |(a, b)| (a - b).abs());
            prop_assert!(off <= allowed, "{off:e}, allowed {allowed:e}: {a:?} {b:?}");
            impacts += 1;
        }
        let [a, b] = [a, b].map(|mark| mark.map(|mark| (mark.kind, mark.wall)));
        prop_assert_eq!(a, b, "event {}", k);
    }
    let (a, b) = (&one.run.measures, &other.run.measures);
    let size = a.energy_initial.max(a.energy_work.abs());
    // An error of the state of this size changes the energies by some hundred times as much.
    let allowed = size * (128.0 * largest).max(1e-9);
    for (a, b) in [(a.energy_viscous, b.energy_viscous), (a.energy_work, b.energy_work)] {
        prop_assert!((a - b).abs() <= allowed, "{a:e} {b:e}, allowed {allowed:e}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(iva_tests::cases(300))]

    #[test]
    fn a_moving_base_is_a_force_in_the_inertial_frame(
        p in compound(),
        free_mass in any::<bool>(),
        clearance in 0.2..1.5f64,
        amplitude in 0.05..0.5f64,
        frequency in 0.3..2.0f64,
        phase in -3.0..3.0f64,
        x in -1.0..1.0f64,
    ) {
        let Parameters { mass_ratio, restitution, damping_ratio, .. } = p;
        let acceleration = Harmonic { amplitude, frequency, phase, acts: Acts::Base };
        let base = MovingBase { acceleration, damping_ratio };
        if free_mass {
            base.is_a_force(mass(mass_ratio, restitution, clearance, damping_ratio), x)?;
        } else {
            base.is_a_force(pendulum(Parameters { clearance, ..p }), x)?;
        }
    }

    #[test]
    fn mirror_and_phase_change_nothing(
        p in compound(),
        clearance in 0.2..1.5f64,
        amplitude in 0.05..0.5f64,
        frequency in 0.3..2.0f64,
        phase in -3.0..0.0f64,
        x in 0.1..1.0f64,
    ) {
        let Parameters { mass_ratio, restitution, damping_ratio, .. } = p;
        let force = on_primary(amplitude, frequency, phase);
        mirror_and_turn(pendulum(Parameters { clearance, ..p }), force, x)?;
        mirror_and_turn(mass(mass_ratio, restitution, clearance, damping_ratio), force, x)?;
    }

    /// Both flights are power series, but of different equations in different variables.
    #[test]
    fn a_driven_free_mass_is_a_pendulum_at_small_angles_without_gravity(
        mu in 0.01..1.0f64,
        e in prop_oneof![1 => Just(0.0), 6 => 0.0..1.0f64, 1 => Just(1.0)],
        d in 0.1..1.5f64,
        zeta in prop_oneof![Just(0.0), 0.0..0.3f64],
        drives in prop::collection::vec(
            (any::<bool>(), 0.05..1.0f64, 0.3..3.0f64, -3.0..3.0f64), 1..=2,
        ),
        kick in prop::option::of((0.0..20.0f64, -0.5..0.5f64)),
        x in prop_oneof![0.2..1.0f64, -1.0..-0.2f64],
    ) {
        let harmonic = |(base, amplitude, frequency, phase)| {
            let acts = if base { Acts::Base } else { Acts::Primary };
            Harmonic { amplitude, frequency, phase, acts }
        };
        let harmonics = drives.into_iter().map(harmonic).collect();
        let kick: Vec<_> =
            kick.into_iter().map(|(time, velocity)| Impulse { velocity, time }).collect();
        let force = Force::new(harmonics, Vec::new(), &kick).unwrap();
        let start = Start { displacement: x, ..Start::default() };
        let siva = Judged::new(&mass(mu, e, d, zeta)(force.clone()), &start, 25.0);
        let piva = pendulum(Parameters::free_mass(mu, e, d, zeta))(force);
        agree(&siva, &Judged::new(&piva, &start.into(), 25.0))?;
    }
}

/// Runs with many stick episodes a cycle close the ledger and agree in both frames.
fn many_sticks<S>(under: impl Fn(Force) -> S, damping_ratio: f64)
where
    S: Absorber<Real = f64, Start: From<Start>>,
{
    let acceleration = Harmonic { amplitude: 0.3, frequency: 0.8, phase: 0.4, acts: Acts::Base };
    let [one, other] = MovingBase { acceleration, damping_ratio }.both(under, 0.5, 40.0 * TAU);
    assert!(one.tally.episodes > 40, "{}", one.tally.episodes);
    for result in [&one, &other] {
        let m = &result.measures;
        let size = m.energy_initial + m.energy_work.abs() + m.energy_viscous;
        assert!(m.energy_residual.abs() < 1e-11 * size, "{:e}", m.energy_residual / size);
    }
    // An error does not grow through twenty stick episodes, because a stick forgets the state before it.
    for (a, b) in one.episodes.iter().zip(&other.episodes).take(20) {
        assert_eq!(a.wall, b.wall);
        assert!((a.stick_time - b.stick_time).abs() < 1e-12 * (1.0 + a.stick_time));
        let (Some(a), Some(b)) = (a.release_time, b.release_time) else { continue };
        assert!((a - b).abs() < 1e-12 * (1.0 + a), "{a} {b}");
    }
}

#[test]
fn many_sticks_a_cycle_keep_the_ledger_and_look_the_same_from_outside() {
    for (clearance, e) in [(0.05, 0.1), (0.1, 0.3)] {
        many_sticks(mass(0.1, e, clearance, 0.02), 0.02);
    }
    let p = Parameters::free_mass(0.1, 0.2, 0.05, 0.02);
    many_sticks(pendulum(Parameters { frequency_ratio: 0.3, ..p }), 0.02);
}
