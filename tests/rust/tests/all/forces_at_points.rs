//! Harmonic forces at several points of a structure, with phases of their own.
//!
//! Numbers come from the closed form of undamped modes, q = Σ φ F/(ω² − Ω²) cos(Ω t + θ) + a free motion; from runs in numbers of twice
//! the precision, which take power series only; and from forces of one frequency and phase, which add up.
#![allow(clippy::unwrap_used, clippy::panic)]

use iva_core::{
    absorber::Absorber,
    absorber::modal::{Modal, ModalStart, ModalStructure, Tie},
    flight::GapPoint,
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    impact::Impact,
    observe::Events,
    real::{Real, twofold::Twofold},
    run::run,
    simulate::{Limits, Outcome, simulate},
    siva::FreeMass,
};
use iva_tests::rng::Rng;

const OMEGA: [f64; 3] = [1.0, 2.3, 4.1];
const SHAPES: [[f64; 3]; 3] = [[1.0, 0.6, -0.3], [0.4, -0.8, 0.5], [-0.2, 0.9, 0.7]];
const NAMES: [&str; 3] = ["a", "b", "c"];

/// Amplitude, frequency and phase of a part, and the index of its point.
type Part = ([f64; 3], usize);

fn harmonic<R: Real>([amplitude, frequency, phase]: [f64; 3]) -> Harmonic<R> {
    let [amplitude, frequency, phase] = [amplitude, frequency, phase].map(R::from);
    Harmonic { amplitude, frequency, phase, acts: Acts::Primary }
}

/// Parts at three points of a structure of three modes: the first wherever it says is the force itself, those at its point go with it.
fn system<R: Real>(
    zeta: f64,
    [mu, e, d]: [f64; 3],
    parts: &[Part],
    friction: f64,
    tie: Tie<R>,
) -> Modal<DrivenHost<R>, 1> {
    let mut structure = ModalStructure::new(&OMEGA.map(R::from), &[R::from(zeta); 3]).unwrap();
    for (name, shape) in NAMES.iter().zip(SHAPES) {
        structure = structure.with_point(name, &shape.map(R::from)).unwrap();
    }
    let mass = FreeMass::new(R::from(mu), R::from(e), R::from(d)).unwrap();
    let system = Modal::new(structure, [(mass, "a")]).unwrap().with_ties(&[tie]).unwrap();
    let system = system.with_friction(&[R::from(friction)]).unwrap();
    let main = parts[0].1;
    let (own, elsewhere): (Vec<Part>, Vec<Part>) = parts.iter().partition(|part| part.1 == main);
    let own = own.into_iter().map(|(numbers, _)| harmonic(numbers)).collect();
    let elsewhere = elsewhere.into_iter().map(|(numbers, at)| (at, harmonic(numbers))).collect();
    let force = Force::harmonic(own).unwrap().with_elsewhere(elsewhere).unwrap();
    system.under(force, NAMES[main]).unwrap()
}

fn begin<R: Real>(q: [f64; 3], v: [f64; 3], [y, w]: [f64; 2]) -> ModalStart<R, 1> {
    let gap = GapPoint { y: R::from(y), w: R::from(w) };
    ModalStart::new(&q.map(R::from), &v.map(R::from), [gap]).unwrap()
}

fn parts(rng: &mut Rng, count: usize) -> Vec<Part> {
    let one = |k: usize| {
        // Between the frequencies of the modes.
        let frequency = rng.pick(&[0.0, 1.4, 2.7, 4.5]) + rng.range(0.2, 0.7);
        ([rng.range(0.05, 0.4), frequency, rng.range(-3.0, 3.0)], k % 3)
    };
    (0..count).map(one).collect()
}

/// All modes at the end, and the energy that the forces have brought, for parts that leaps take and for more.
#[test]
fn modes_and_work_are_those_of_the_closed_form() {
    let mut rng = Rng::new(101);
    for scene in 0..60 {
        let count = 2 + scene % 5;
        let parts = parts(&mut rng, count);
        let [q, v]: [[f64; 3]; 2] = [0, 1].map(|_| [0, 1, 2].map(|_| rng.range(-1.0, 1.0)));
        let system = system::<f64>(0.0, [1e-28, 0.5, 500.0], &parts, 0.0, Tie::NONE);
        let start = begin(q, v, [0.0, 0.0]);
        let duration = rng.range(5.0, 60.0);
        let coast = system.coasts(&system.begin(&start), duration);
        let steps = coast.map_or(0, |(steps, _)| steps);
        assert_eq!(steps > 1, count <= 4, "{count} parts: {steps}");
        let found = run(&system, &start, &Limits::new(duration, 1e-9)).unwrap();
        assert_eq!((found.tally.outcome, found.tally.impacts), (Outcome::Finished, 0));
        let mut energy = 0.0;
        for j in 0..3 {
            let steady = |t: f64| {
                let of = |([amplitude, frequency, phase], at): &Part| {
                    let size = SHAPES[*at][j] * amplitude / (OMEGA[j].powi(2) - frequency.powi(2));
                    let (s, c) = (frequency * t + phase).sin_cos();
                    [size * c, -size * frequency * s]
                };
                parts.iter().map(of).fold([0.0; 2], |sum, it| [sum[0] + it[0], sum[1] + it[1]])
            };
            let ([from, from_rate], [to, to_rate]) = (steady(0.0), steady(duration));
            let (s, c) = (OMEGA[j] * duration).sin_cos();
            let [place, rate] = [q[j] - from, (v[j] - from_rate) / OMEGA[j]];
            let truth = [to + place * c + rate * s, to_rate + OMEGA[j] * (rate * c - place * s)];
            let modes = found.tally.state.modes();
            let off = [modes.places[j].value - truth[0], modes.velocities[j].value - truth[1]];
            assert!(off.iter().all(|it| it.abs() < 2e-13), "scene {scene}, mode {j}: {off:?}");
            let [a, b] = [[q[j], v[j]], truth].map(|[q, v]| (OMEGA[j] * q).powi(2) + v * v);
            energy += 0.5 * (b - a);
        }
        let off = found.measures.energy_work - energy;
        assert!(off.abs() < 1e-12, "scene {scene}: {off:e}");
    }
}

/// Impacts with friction, springs and dashpots in the gap are those of twice the precision; the ledger closes.
#[test]
fn impacts_are_those_of_twice_the_precision() {
    let mut rng = Rng::new(102);
    let mut compared = 0;
    for scene in 0..40 {
        let parts = parts(&mut rng, 2 + scene % 4);
        let mass = [rng.log_range(0.02, 0.3), rng.range(0.3, 0.9), rng.range(0.2, 0.8)];
        let friction = if scene % 3 == 0 { rng.log_range(0.01, 0.1) } else { 0.0 };
        let tie = if scene % 2 == 0 { [0.02, 0.005] } else { [0.0; 2] };
        fn ran<R: Real>(
            parts: &[Part],
            mass: [f64; 3],
            friction: f64,
            [spring, damping]: [f64; 2],
        ) -> (Vec<Impact<R>>, f64) {
            let tie = Tie { spring: R::from(spring), damping: R::from(damping) };
            let system = system::<R>(0.01, mass, parts, friction, tie);
            let start = begin([1.0, 0.3, -0.2], [0.0, 0.5, 0.0], [0.1, 0.0]);
            let limits = Limits::new(R::from(12.0), R::from(1e-9));
            let mut events = Events::default();
            simulate(&system, &start, &limits, None, &mut events).unwrap();
            let measures = run(&system, &start, &limits).unwrap().measures;
            (events.impacts, measures.energy_residual.double() / measures.energy_initial.double())
        }
        let (plain, residual) = ran::<f64>(&parts, mass, friction, tie);
        let (exact, _) = ran::<Twofold>(&parts, mass, friction, tie);
        assert!(residual.abs() < 1e-13, "scene {scene}: {residual:e}");
        // Chaos takes a digit or so each few impacts.
        for (a, b) in plain.iter().zip(&exact).take(8) {
            let off = (a.time - b.time.double()).abs();
            assert!(off < 1e-11, "scene {scene}: {off:e} at {}", a.time);
            compared += 1;
        }
    }
    assert!(compared > 200, "{compared}");
}

/// Over one flight the distance is δ + g (−t²/60 + t³/40 − t⁵/120): level at both ends, and lower by .0013 g between them. Its bend comes from
/// a force at another point, which has no second derivative at the begin: only the bound on what that force will do knows of the contact.
#[test]
fn a_contact_that_only_a_force_elsewhere_makes_is_not_missed() {
    let mut rng = Rng::new(141);
    let [mut met, mut missed] = [0, 0];
    for round in 0..100 {
        let (g, slow) = (rng.log_range(1e-3, 0.1), 0.05);
        let structure = ModalStructure::new(&[1e-4], &[0.0]).unwrap();
        let structure = structure.with_point("a", &[1.0]).unwrap().with_point("b", &[1.0]).unwrap();
        let system = Modal::new(structure, [(FreeMass::new(1e-28, 0.5, 1.0).unwrap(), "a")]);
        // ü = −g/30 + .15 g t − g t³/6: a slow force for the first two terms less g t, and g sin t elsewhere.
        let [cosine, sine] = [-g / 30.0, 0.85 * g / slow];
        let own = harmonic::<f64>([f64::hypot(cosine, sine), slow, sine.atan2(cosine)]);
        let other = harmonic::<f64>([g, 1.0, -std::f64::consts::FRAC_PI_2]);
        let force = Force::harmonic(vec![own]).unwrap().with_elsewhere(vec![(1, other)]).unwrap();
        let system = system.unwrap().under(force, "a").unwrap();
        let touches = rng.unit() < 0.5;
        let delta = g * if touches { rng.range(2e-4, 1.1e-3) } else { rng.range(1.5e-3, 3e-3) };
        let gap = GapPoint { y: 1.0 - delta, w: 0.0 };
        let start = ModalStart::new(&[0.0], &[0.0], [gap]).unwrap();
        let found = run(&system, &start, &Limits::new(0.999_999, 1e-9)).unwrap();
        assert_eq!(found.impacts.is_empty(), !touches, "{round}: {:e} g", delta / g);
        if let Some(impact) = found.impacts.first() {
            let way = |t: f64| delta + g * t * t * (-1.0 / 60.0 + t / 40.0 - t.powi(3) / 120.0);
            let (mut from, mut to) = (0.0, 0.5);
            for _ in 0..60 {
                let middle = 0.5 * (from + to);
                if way(middle) > 0.0 { from = middle } else { to = middle }
            }
            // The series of the sines go on: t⁷/5040 and slow² are left out of the polynomial.
            assert!((impact.time - to).abs() < 0.02, "{round}: {} {to}", impact.time);
        }
        met += u32::from(touches);
        missed += u32::from(!touches);
    }
    assert!(met > 30 && missed > 30, "{met} {missed}");
}

/// A force in two halves at points of one shape is the whole.
#[test]
fn two_halves_are_the_whole() {
    let structure = ModalStructure::new(&[1.0, 2.5], &[0.02; 2]).unwrap();
    let structure = structure.with_point("a", &[1.0, -0.4]).unwrap();
    let structure = structure.with_point("b", &[1.0, -0.4]).unwrap();
    let mass = FreeMass::new(0.1, 0.6, 0.4).unwrap();
    let free = Modal::new(structure, [(mass, "a")]).unwrap();
    let with = |own: f64, other: Option<f64>| {
        let part = |size: f64| harmonic::<f64>([size, 0.9, 0.4]);
        let elsewhere = other.map(|size| (1, part(size)));
        let force = Force::harmonic(vec![part(own)]).unwrap();
        let force = force.with_elsewhere(elsewhere.into_iter().collect()).unwrap();
        let system = free.under(force, "a").unwrap();
        let gap = GapPoint { y: 0.0, w: 0.0 };
        let start = ModalStart::new(&[1.0, 0.2], &[], [gap]).unwrap();
        run(&system, &start, &Limits::new(30.0, 1e-9)).unwrap()
    };
    let (whole, halves) = (with(0.25, None), with(0.125, Some(0.125)));
    assert!(whole.impacts.len() > 10 && whole.impacts.len() == halves.impacts.len());
    for (a, b) in whole.impacts.iter().zip(&halves.impacts).take(10) {
        assert!((a.time - b.time).abs() < 1e-12, "{} {}", a.time, b.time);
    }
    let work = [whole, halves].map(|it| it.measures.energy_work);
    assert!((work[0] - work[1]).abs() < 1e-9 && work[0].abs() > 1e-2, "{work:?}");
}

/// A part at a point that there is not, or on a base, is refused in one sentence.
#[test]
fn a_part_at_no_point_is_refused() {
    let structure = ModalStructure::new(&[1.0], &[0.0]).unwrap().with_point("a", &[1.0]).unwrap();
    let mass = FreeMass::new(0.1, 0.6, 0.4).unwrap();
    let free = Modal::new(structure, [(mass, "a")]).unwrap();
    let base = Harmonic { acts: Acts::Base, ..harmonic::<f64>([0.1, 0.9, 0.0]) };
    for part in [(1, harmonic([0.1, 0.9, 0.0])), (0, base)] {
        let force = Force::default().with_elsewhere(vec![part]).unwrap();
        let error = free.under(force, "a").unwrap_err().to_string();
        assert!(error.starts_with("force.elsewhere = "), "{error}");
    }
}
