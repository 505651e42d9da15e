//! Free masses on an inclined line of motion: gravity G = g sin α along it.
//!
//! A uniform field of gravity is equivalent to a base with constant acceleration, except for the origin of x:
//! x on such a base is smaller by (1 + μ)G, the load of the spring with the absorber on its lower stop. Such
//! a base is a record of two points, whose motion is tested elsewhere. Runs in doubles are compared with runs
//! in numbers of twice the precision.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;

use iva_core::{
    absorber::{OnStructure, Start},
    force::{Acts, Force, Harmonic, History, Record},
    host::DrivenHost,
    measures::{Measures, Wanted},
    propagation::Errors,
    real::{Real, twofold::Twofold},
    run::{Run, run},
    simulate::{Limits, Outcome, simulate},
    siva::Siva,
};
use iva_tests::{U, UNITS_ALLOWED, rng::Rng, units};

/// Relative change of gravity by which sensitivities are measured: far too small to change the events, far
/// above the rounding of numbers of twice the precision.
const MOVED: f64 = 1e-14;

/// An absorber with gravity G = g sin α along its motion, on a structure released from a displacement, driven
/// or not.
#[derive(Debug, Clone, Copy)]
struct Scene {
    mass_ratio: f64,
    restitution: f64,
    clearance: f64,
    damping_ratio: f64,
    gravity: f64,
    displacement: f64,
    /// Height of the absorber above its lower stop.
    height: f64,
    harmonic: Option<Harmonic>,
    duration: f64,
}

impl Scene {
    fn random(rng: &mut Rng, driven: bool) -> Self {
        let clearance = rng.log_range(0.1, 2.0);
        let mut harmonic = |acts| Harmonic {
            amplitude: rng.range(0.1, 0.6),
            frequency: rng.range(0.6, 1.6),
            phase: rng.range(-3.0, 3.0),
            acts,
        };
        let acts = if clearance > 0.5 { Acts::Base } else { Acts::Primary };
        let harmonic = driven.then(|| harmonic(acts));
        Self {
            mass_ratio: rng.log_range(0.02, 0.3),
            restitution: rng.range(0.2, 0.9),
            clearance,
            damping_ratio: rng.pick(&[0.0, 0.01, 0.05]),
            gravity: rng.log_range(0.03, 10.0),
            displacement: rng.range(-2.0, 2.0),
            height: rng.pick(&[0.0, 0.5, 1.2]) * clearance,
            harmonic,
            duration: 40.0,
        }
    }

    fn force<R: Real>(&self, more: Vec<Record<R>>) -> Force<R> {
        let of = |it: Harmonic| Harmonic {
            amplitude: it.amplitude.into(),
            frequency: it.frequency.into(),
            phase: it.phase.into(),
            acts: it.acts,
        };
        Force::new(self.harmonic.map(of).into_iter().collect(), more, &[]).unwrap()
    }

    fn absorber<R: Real>(&self) -> Siva<iva_core::host::UndrivenHost<R>> {
        let of = R::from;
        Siva::new(
            of(self.mass_ratio),
            of(self.restitution),
            of(self.clearance),
            of(self.damping_ratio),
        )
        .unwrap()
    }

    fn inclined<R: Real>(&self) -> Siva<DrivenHost<R>> {
        self.absorber().inclined(self.gravity.into(), self.force(Vec::new()))
    }

    /// The scene with a relative change of gravity.
    fn heavier(&self, by: f64) -> Siva<DrivenHost<Twofold>> {
        let gravity = (Twofold::ONE + by) * self.gravity;
        self.absorber().inclined(gravity, self.force(Vec::new()))
    }

    fn start<R: Real>(&self) -> Start<R> {
        Start {
            displacement: self.displacement.into(),
            velocity: R::ZERO,
            gap_displacement: R::from(self.height) - self.clearance,
            gap_velocity: R::ZERO,
        }
    }

    fn limits<R: Real>(&self) -> Limits<R> {
        Limits::new(self.duration.into(), self.clearance.into())
    }
}

/// The instants of impacts, sticks and releases, with their walls.
fn instants<S, R: Real>(run: &Run<S, R>) -> Vec<(char, f64, R)> {
    let impacts = run.impacts.iter().map(|it| ('i', it.wall.sign(), it.time));
    let sticks = run.episodes.iter().map(|it| ('s', it.wall.sign(), it.stick_time));
    let releases =
        run.episodes.iter().filter_map(|it| Some(('r', it.wall.sign(), it.release_time?)));
    let mut all: Vec<_> = impacts.chain(sticks).chain(releases).collect();
    all.sort_by(|a, b| a.2.total_cmp(&b.2));
    all
}

fn assert_same_events<R: Real, Q: Real>(
    one: &[(char, f64, R)],
    other: &[(char, f64, Q)],
    scene: &Scene,
) {
    let kinds = |events: &[(char, f64)]| events.to_vec();
    let one: Vec<_> = one.iter().map(|it| (it.0, it.1)).collect();
    let other: Vec<_> = other.iter().map(|it| (it.0, it.1)).collect();
    assert_eq!(kinds(&one), kinds(&other), "{scene:?}");
}

/// True if the events could depend on rounding, so that two runs need not agree.
fn is_too_sensitive(errors: &Errors) -> bool {
    errors.condition().is_none_or(|condition| condition > 1e6)
        || errors.impacts.iter().any(|impact| impact.grazing || impact.time.is_none())
}

#[test]
fn gravity_is_an_acceleration_of_the_base() {
    let mut rng = Rng::new(20_261_124);
    let mut compared = 0;
    for number in 0..120 {
        let scene = Scene::random(&mut rng, number % 2 == 1);
        let inclined = scene.inclined::<Twofold>();
        let found = run(&inclined, &scene.start(), &scene.limits()).unwrap();

        let constant = vec![scene.gravity; 2];
        let record = Record {
            history: Arc::new(History::new(vec![0.0, 100.0], constant).unwrap()),
            acts: Acts::Base,
            rate: Twofold::ONE,
            scale: Twofold::ONE,
        };
        let level = scene.absorber().under(scene.force(vec![record]));
        let carried = (Twofold::ONE + scene.mass_ratio) * scene.gravity;
        let start = scene.start::<Twofold>();
        let start = Start { displacement: start.displacement - carried, ..start };
        let expected = run(&level, &start, &scene.limits()).unwrap();
        let [found, expected] = [instants(&found), instants(&expected)];

        let mut errors = Errors::default();
        simulate(&scene.inclined(), &scene.start(), &scene.limits(), None, &mut errors).unwrap();
        if is_too_sensitive(&errors) {
            continue;
        }
        compared += found.len();
        assert_same_events(&found, &expected, &scene);
        for (one, other) in found.iter().zip(&expected) {
            let off = (one.2 - other.2).abs();
            assert!(off < 1e-18, "{off:?} at {:?} of {scene:?}", one.2);
        }
    }
    assert!(compared > 1500, "{compared}");
}

#[test]
fn doubles_are_off_by_some_rounding_units() {
    let mut rng = Rng::new(20_261_125);
    let mut found = Vec::new();
    let scenes = iva_tests::some(400);
    for number in 0..scenes {
        let scene = Scene::random(&mut rng, number % 2 == 1);
        let mut errors = Errors::default();
        simulate(&scene.inclined(), &scene.start(), &scene.limits(), None, &mut errors).unwrap();
        if is_too_sensitive(&errors) {
            continue;
        }
        let exact = run(&scene.inclined::<Twofold>(), &scene.start(), &scene.limits()).unwrap();
        let plain = run(&scene.inclined::<f64>(), &scene.start(), &scene.limits()).unwrap();
        assert_eq!(plain.tally.undecided, 0, "{scene:?}");
        assert_eq!(plain.tally.outcome, Outcome::Finished);
        let [exact, plain] = [
            instants(&exact),
            instants(&plain).into_iter().map(|it| (it.0, it.1, it.2.into())).collect(),
        ];
        assert_same_events(&plain, &exact, &scene);
        let condition = errors.condition().unwrap_or(1.0);
        let moved = run(&scene.heavier(MOVED), &scene.start(), &scene.limits()).unwrap();
        let moved = instants(&moved);
        assert_same_events(&moved, &exact, &scene);
        for ((one, truth), moved) in plain.iter().zip(&exact).zip(&moved) {
            let off = f64::from(one.2 - truth.2);
            let by_gravity = f64::from(moved.2 - truth.2).abs() / MOVED;
            found.push((units(off, condition.max(by_gravity), f64::from(truth.2)), number));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let median = found[found.len() / 2];
    println!("{} events, median {median:?}, worst {:?}", found.len(), found.last());
    assert!(found.len() > 7 * scenes && median.0 < 1.0, "{median:?}");
    assert!(found.last().unwrap().0 <= UNITS_ALLOWED, "{:?}", found.last());
}

/// Without damping and with e = 1 no energy is lost: gravity, structure and absorber exchange it.
#[test]
fn elastic_impacts_on_an_undamped_structure_keep_the_energy() {
    let scene = Scene {
        mass_ratio: 0.1,
        restitution: 1.0,
        clearance: 0.8,
        damping_ratio: 0.0,
        gravity: 0.7,
        displacement: 1.0,
        height: 0.3,
        harmonic: None,
        duration: 3000.0,
    };
    let system = scene.inclined::<f64>();
    let mut measures = Measures::new(Wanted::ALL);
    let tally = simulate(&system, &scene.start(), &scene.limits(), None, &mut measures).unwrap();
    let values = measures.values();
    let initial = 0.5 + 0.1 * 0.7 * 0.3;
    assert!(tally.impacts > 1000, "{}", tally.impacts);
    assert!((values.energy_initial - initial).abs() < 1e-15, "{}", values.energy_initial);
    // A random walk with one rounding per impact and stretch.
    let stretches = tally.work as f64;
    assert!((values.energy_final - initial).abs() < 4.0 * U * stretches.sqrt(), "{values:?}");
    assert_eq!(values.energy_work, 0.0);
}

/// Stuck on its lower stop the absorber moves as one mass with the structure, x = x₀ cos(t/√(1 + μ)) without
/// damping. It lifts off where the structure decelerates by more than gravity, if it does: at
/// cos(t/√(1 + μ)) = (1 + μ)G/x₀.
#[test]
fn a_resting_absorber_lifts_off_where_gravity_no_longer_holds_it() {
    let mass = 1.25_f64;
    for (gravity, lifts) in [(0.7, true), (0.799, true), (0.8, false), (0.9, false), (30.0, false)]
    {
        let scene = Scene {
            mass_ratio: 0.25,
            restitution: 0.5,
            clearance: 0.4,
            damping_ratio: 0.0,
            gravity,
            // The structure starts below its position of rest, and decelerates on its way up.
            displacement: -1.0,
            height: 0.0,
            harmonic: None,
            duration: 4.0,
        };
        let run = run(&scene.inclined::<f64>(), &scene.start(), &scene.limits()).unwrap();
        let first = run.episodes.first().expect("it begins at rest on its stop");
        assert_eq!((first.wall.sign(), first.stick_time), (-1.0, 0.0));
        let Some(release) = first.release_time else {
            assert!(!lifts, "G = {gravity}");
            continue;
        };
        let turned = mass.sqrt() * (-mass * gravity).acos();
        // The slope of the arc cosine there.
        let condition = mass.sqrt() * gravity / (1.0 - (mass * gravity).powi(2)).sqrt();
        assert!(lifts && units(release - turned, condition, turned) <= 2.0, "{release} {turned}");
    }
}

/// A stuck absorber adds its weight only: gravity does not appear in the motion, which is x₀ cos(t/√(1 + μ))
/// without damping, for any size of gravity.
#[test]
fn a_dead_weight_keeps_its_digits_under_any_gravity() {
    for gravity in [2.0, 1e4, 1e8, 1e12] {
        let scene = Scene {
            mass_ratio: 0.21,
            restitution: 0.5,
            clearance: 0.4,
            damping_ratio: 0.0,
            gravity,
            displacement: 1.0,
            height: 0.0,
            harmonic: None,
            duration: 60.0,
        };
        let system = scene.inclined::<f64>();
        let mut measures = Measures::new(Wanted::ALL);
        let tally =
            simulate(&system, &scene.start(), &scene.limits(), None, &mut measures).unwrap();
        assert_eq!((tally.impacts, tally.time_stuck), (0, scene.duration));
        let truth = (scene.duration / 1.21_f64.sqrt()).cos();
        let off = system.primary(&tally.state).x - truth;
        assert!(off.abs() < 100.0 * U, "G = {gravity:e}: {off:e}");
        let values = measures.values();
        assert!(values.energy_residual.abs() < 100.0 * U, "G = {gravity:e}: {values:?}");
    }
}
