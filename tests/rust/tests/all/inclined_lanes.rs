//! Free masses with gravity along the motion, or under impulses, side by side and alone; and the measures of their decays, which are computed
//! from a log of damped sinusoids. In numbers of twice the precision they are computed from stretches in which x is
//! monotonic, which is another way.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::Start,
    force::{Acts, Force, Harmonic, Impulse},
    host::DrivenHost,
    propagation::Errors,
    real::{Real, twofold::Twofold},
    run::run,
    run::side_by_side::{Job, Tier},
    simulate::{Limits, simulate},
    siva::Siva,
    steady::{SteadyWanted, Window},
};
use iva_tests::{U, rng::Rng};

use crate::side_by_side::{alone, together};

/// A structure that is released, with impulses or without, and its absorber at some height above its lower stop.
#[derive(Debug, Clone)]
struct Scene {
    /// μ, e, d, ζ and G.
    numbers: [f64; 5],
    /// x, ẋ, and the height over d.
    start: [f64; 3],
    impulses: Vec<[f64; 2]>,
    duration: f64,
}

impl Scene {
    fn random(rng: &mut Rng, kicked: bool) -> Self {
        let numbers = [
            rng.log_range(0.02, 0.3),
            rng.range(0.2, 0.9),
            rng.log_range(0.1, 2.0),
            rng.pick(&[0.0, 0.01, 0.05, 0.3]),
            rng.log_range(0.01, 3.0),
        ];
        let start = [rng.range(-2.0, 2.0), rng.range(-1.0, 1.0), rng.pick(&[0.0, 0.5, 1.2])];
        let mut impulse = |time| [time, rng.range(-0.5, 0.5)];
        let impulses = if kicked { [0.0, 2.5, 7.0].map(&mut impulse).to_vec() } else { vec![] };
        Self { numbers, start, impulses, duration: rng.range(15.0, 60.0) }
    }

    fn siva<R: Real>(&self) -> Siva<DrivenHost<R>> {
        let [mu, e, d, zeta, gravity] = self.numbers.map(R::from);
        let of = |[time, velocity]: &[f64; 2]| Impulse {
            time: R::from(*time),
            velocity: R::from(*velocity),
        };
        let impulses: Vec<_> = self.impulses.iter().map(of).collect();
        let force = Force::new(Vec::new(), Vec::new(), &impulses).unwrap();
        Siva::new(mu, e, d, zeta).unwrap().inclined(gravity, force)
    }

    fn start<R: Real>(&self) -> Start<R> {
        let ([x, v, height], d) = (self.start, self.numbers[2]);
        Start {
            displacement: x.into(),
            velocity: v.into(),
            gap_displacement: R::from(height * d) - d,
            gap_velocity: R::ZERO,
        }
    }

    fn limits<R: Real>(&self) -> Limits<R> {
        Limits::new(self.duration.into(), self.numbers[2].into())
    }

    fn job(&self) -> Job<Siva<DrivenHost>> {
        let (system, start, limits) = (self.siva(), self.start(), self.limits());
        Job { system, start, begin: 0.0, limits, steady: None, tier: Tier::Exact }
    }
}

/// Jobs of few damping ratios, so that groups are large; some with limits, some that begin later.
fn jobs(rng: &mut Rng) -> Vec<Job<Siva<DrivenHost>>> {
    let job = |i: usize| {
        let mut scene = Scene::random(rng, i % 7 == 6);
        match i % 5 {
            // The middle of the motion is far away from it.
            1 => scene.numbers[4] = rng.log_range(3.0, 1e6),
            2 => scene.numbers[4] = 0.0,
            _ => {}
        }
        let mut job = scene.job();
        if i.is_multiple_of(11) {
            job.limits.max_impacts = 7;
        }
        if i % 11 == 1 {
            job.limits.max_work = 30;
        }
        if i % 11 == 2 {
            job.begin = 1.25;
        }
        job
    };
    (0..300).map(job).collect()
}

#[test]
fn decays_have_the_same_bits_side_by_side_and_alone() {
    let scenes = jobs(&mut Rng::new(20_261_126));
    let together = together(&scenes);
    for (i, (scene, found)) in scenes.iter().zip(together).enumerate() {
        assert_eq!(found, alone(scene), "scene {i}");
    }
}

/// Runs under a harmonic force, on the structure or its base, some level and some with much gravity.
fn driven_jobs(rng: &mut Rng, steady: Option<SteadyWanted>) -> Vec<Job<Siva<DrivenHost>>> {
    let job = |i: usize| {
        let scene = Scene::random(rng, false);
        let acts = if i.is_multiple_of(3) { Acts::Base } else { Acts::Primary };
        let amplitude = rng.range(0.05, 0.5);
        let (frequency, phase) = (rng.range(0.6, 1.6), rng.range(-3.0, 3.0));
        let harmonic = Harmonic { amplitude, frequency, phase, acts };
        let [mu, e, d, zeta, mut gravity] = scene.numbers;
        if i % 5 == 1 {
            gravity *= 1e3;
        } else if i % 5 == 2 {
            gravity = 0.0;
        }
        let siva = Siva::new(mu, e, d, zeta).unwrap();
        let system = siva.inclined(gravity, Force::harmonic(vec![harmonic]).unwrap());
        let window = Window { from: 0.5 * scene.duration, cycle: Some(harmonic) };
        let steady = steady.map(|steady| (steady, window));
        Job { system, steady, begin: if i.is_multiple_of(7) { 1.25 } else { 0.0 }, ..scene.job() }
    };
    (0..120).map(job).collect()
}

#[test]
fn driven_runs_have_the_same_bits_side_by_side_and_alone() {
    for steady in [None, Some(SteadyWanted::ALL)] {
        let scenes = driven_jobs(&mut Rng::new(20_261_128), steady);
        let together = together(&scenes);
        for (i, (scene, found)) in scenes.iter().zip(together).enumerate() {
            assert_eq!(found, alone(scene), "scene {i}");
        }
    }
}

/// All peaks and some measures of runs in doubles are those of runs in numbers of twice the precision, within four rounding
/// units of the size of the motion times its condition.
#[test]
fn the_log_tells_what_the_stretches_tell() {
    let mut rng = Rng::new(20_261_127);
    let (mut compared, mut levels, mut worst) = (0, 0, 0.0_f64);
    for number in 0..400 {
        let mut scene = Scene::random(&mut rng, number % 4 == 3);
        if number % 8 == 7 {
            scene.numbers[4] = 0.0;
        }
        let mut errors = Errors::default();
        simulate(&scene.siva(), &scene.start(), &scene.limits(), None, &mut errors).unwrap();
        let sensitive = errors.condition().is_some_and(|condition| condition > 1e3);
        if sensitive || errors.impacts.iter().any(|it| it.grazing || it.time.is_none()) {
            continue;
        }
        let plain = run(&scene.siva::<f64>(), &scene.start(), &scene.limits()).unwrap();
        let exact = run(&scene.siva::<Twofold>(), &scene.start(), &scene.limits()).unwrap();
        assert_eq!(plain.peaks.len(), exact.peaks.len(), "{scene:?}");
        let condition = errors.condition().unwrap_or(1.0).max(scene.duration);
        let mut close = |found: f64, truth: Twofold, size: f64, what: &str| {
            let off = (found - f64::from(truth)).abs() / (size * condition);
            worst = worst.max(off);
            assert!(off <= 4.0 * U, "{what} {found:e} {truth:?}: {:e} {scene:?}", off / U);
            compared += 1;
        };
        let [x, v, _] = scene.start;
        let [_, _, _, _, gravity] = scene.numbers;
        let size = 1.0 + x.abs() + v.abs() + gravity;
        for (one, other) in plain.peaks.iter().zip(&exact.peaks) {
            close(one.displacement, other.displacement, size, "peak");
        }
        let (found, truth) = (plain.measures, exact.measures);
        close(found.energy_viscous, truth.energy_viscous, size * size, "losses");
        close(found.energy_work, truth.energy_work, size * size, "work");
        let shares = [
            (found.damping_ratio_energy, truth.damping_ratio_energy, "energy after a period"),
            (found.residual_amplitude, truth.residual_amplitude, "residual amplitude"),
        ];
        for (found, truth, what) in shares {
            assert_eq!(found.is_some(), truth.is_some(), "{what} {scene:?}");
            if let (Some(found), Some(truth)) = (found, truth) {
                // Both are ratios to the motion at the begin.
                let share = (size / plain.peaks[0].displacement.abs()).max(1.0).powi(2);
                close(found, truth, share, what);
            }
        }
        let times = [
            (found.settling_time_10, truth.settling_time_10),
            (found.settling_time_5, truth.settling_time_5),
            (found.settling_time_2, truth.settling_time_2),
        ];
        for (found, truth) in times {
            assert_eq!(found.is_some(), truth.is_some(), "{scene:?}");
            let Some((found, truth)) = found.zip(truth) else { continue };
            levels += 1;
            // A passage close to a turning point depends on x by the root.
            let off = (found - f64::from(truth)).abs();
            assert!(off <= 1e-9, "{found} {truth:?} {scene:?}");
        }
    }
    println!("{compared} values, {levels} passages, worst {:.2} units", worst / U);
    assert!(compared > 3000 && levels > 100, "{compared} {levels}");
}
