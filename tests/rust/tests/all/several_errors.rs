//! The estimated errors of runs of several free masses: against true errors, which are those against runs in numbers of
//! twice the precision, against the estimates for a single free mass, and against differences of runs.
#![allow(clippy::unwrap_used, clippy::panic)]

use iva_core::{
    absorber::{Point, Start},
    flight::GapPoint,
    force::{Acts, Force, Harmonic},
    impact::Impact,
    observe::Events,
    propagation::Errors,
    real::{Real, twofold::Twofold},
    simulate::{Limits, simulate},
    siva::{FreeMass, Siva},
};
use iva_tests::covered::Covered;
use iva_tests::list::{List, begun, driven, list};
use iva_tests::rng::Rng;

/// Numbers of a scene: ζ, x and ẋ, and of each mass μ, e, d, y and w.
struct Scene {
    zeta: f64,
    at: [f64; 2],
    masses: Vec<[f64; 5]>,
    driven: bool,
}

impl Scene {
    fn random(rng: &mut Rng, count: usize, driven: bool) -> Self {
        let mass = |rng: &mut Rng| {
            let d = rng.range(0.2, 1.5);
            let y = d * rng.range(-0.9, 0.9);
            [rng.log_range(0.02, 0.5), rng.range(0.2, 0.9), d, y, rng.range(-0.5, 0.5)]
        };
        Self {
            zeta: rng.range(0.0, 0.05),
            at: [rng.range(0.5, 2.0), rng.range(-1.0, 1.0)],
            masses: (0..count).map(|_| mass(rng)).collect(),
            driven,
        }
    }

    /// Runs it, from x displaced by a small number.
    fn run<R: Real, O>(&self, displaced: R, observer: O) -> O
    where
        O: iva_core::observe::Observer<List<iva_core::host::UndrivenHost<R>>>
            + iva_core::observe::Observer<List<iva_core::host::DrivenHost<R>>>,
    {
        let n = R::from;
        let mass = |it: &[f64; 5]| FreeMass::new(n(it[0]), n(it[1]), n(it[2])).unwrap();
        let masses: Vec<FreeMass<R>> = self.masses.iter().map(mass).collect();
        let gap = |it: &[f64; 5]| GapPoint { y: n(it[3]), w: n(it[4]) };
        let gaps: Vec<GapPoint<R>> = self.masses.iter().map(gap).collect();
        let start = begun(Point { x: n(self.at[0]) + displaced, v: n(self.at[1]) }, &gaps);
        let system = list(n(self.zeta), &masses);
        let limits = Limits::new(n(25.0), n(0.2));
        let mut observer = observer;
        if self.driven {
            let [amplitude, frequency, phase] = [0.3, 0.9, 0.2].map(n);
            let harmonic = Harmonic { amplitude, frequency, phase, acts: Acts::Primary };
            let system = driven(&system, Force::harmonic(vec![harmonic]).unwrap());
            simulate(&system, &start, &limits, None, &mut observer).unwrap();
        } else {
            simulate(&system, &start, &limits, None, &mut observer).unwrap();
        }
        observer
    }
}

/// True errors exceed their estimates as rarely as those of a single free mass do, and estimates are of their size.
#[test]
fn estimates_cover_the_errors() {
    let mut rng = Rng::new(71);
    let (mut covered, mut episodes) = (Covered::default(), 0);
    for k in 0..60 {
        let scene = Scene::random(&mut rng, 2 + k % 4, k % 3 == 0);
        let (errors, events) = scene.run(0.0, (Errors::default(), Events::default()));
        let exact = scene.run(Twofold::ZERO, Events::<Twofold>::default());
        episodes += events.episodes.len();
        covered.count(&events.impacts, &exact.impacts, &errors);
    }
    assert!(episodes > 10, "{episodes} episodes");
    covered.holds(1500);
}

/// One mass in a list has the estimates of the free mass, whose formulas are the same.
#[test]
fn one_in_a_list_has_those_of_a_free_mass() {
    let mut rng = Rng::new(73);
    for _ in 0..20 {
        let scene = Scene::random(&mut rng, 1, false);
        let [mu, e, d, y, w] = scene.masses[0];
        let listed = scene.run(0.0, Errors::default());
        let siva = Siva::new(mu, e, d, scene.zeta).unwrap();
        let [displacement, velocity] = scene.at;
        let start = Start { displacement, velocity, gap_displacement: y, gap_velocity: w };
        let mut alone = Errors::default();
        simulate(&siva, &start, &Limits::new(25.0, 0.2), None, &mut alone).unwrap();
        for (one, other) in listed.impacts.iter().zip(&alone.impacts).take(12) {
            let [one, other] = [one.time.unwrap(), other.time.unwrap()];
            assert!((one - other).abs() < 0.1 * other, "{one} {other}");
        }
        let [one, other] = [&listed, &alone].map(|errors| errors.condition());
        if let (Some(one), Some(other)) = (one, other) {
            assert!((one - other).abs() < 0.1 * other, "{one} {other}");
        }
    }
}

/// The condition is no less than a change of any impact time per change of x(0), by differences in twice the precision.
#[test]
fn the_condition_is_that_of_differences() {
    let mut rng = Rng::new(79);
    let mut compared = 0;
    for k in 0..20 {
        let scene = Scene::random(&mut rng, 2 + k % 3, false);
        let errors = scene.run(0.0, Errors::default());
        let Some(condition) = errors.condition() else { continue };
        let small = Twofold::from(1e-14);
        let [below, above] =
            [-small, small].map(|by| scene.run(by, Events::<Twofold>::default()).impacts);
        let change = |(a, b): (&Impact<Twofold>, &Impact<Twofold>)| {
            f64::from((b.time - a.time) / (small + small)).abs()
        };
        let largest = below.iter().zip(&above).map(change).fold(0.0, f64::max);
        assert!(largest * scene.at[0] <= condition * 1.001, "{largest} {condition}");
        compared += 1;
    }
    assert!(compared > 10, "{compared}");
}
