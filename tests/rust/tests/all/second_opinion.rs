//! A thousand moderate scenes compared with a deliberately simple program (`iva_tests::naive`: fixed
//! Runge–Kutta steps, bisection, the impact law), impact by impact.
//!
//! The error of the simple program is estimated. Halving its step changes every number by fifteen times the
//! error of the finer run, impacts and their amplification included. So the simulator must agree within the
//! largest change by halving so far, plus the roundings of the simple program times the condition, measured
//! by a changed start. The comparison of a scene stops where the simple program is unreliable: before the
//! first low rebound (and so before any stick), before a near miss of a wall, and where halving or the
//! changed start give other impacts or change them by more than 10⁻⁶.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iva_core::{
    absorber::{self, Start},
    force::{Acts, Force, Harmonic},
    impact::Impact,
    piva::{Angles, Parameters, Piva},
    run::{Run, run, states},
    sample::State,
    simulate::Limits,
    siva::Siva,
};
use iva_tests::{
    naive::{self, Absorber, Drive, Scene},
    rng::Rng,
};

/// Step of the coarse run; a power of two, so that instants add up without rounding.
const STEP: f64 = 1.0 / 256.0;
/// Approach speed, as a share of the motion, below which a comparison ends.
const LOW: f64 = 0.01;
/// Distance of an extremum from a wall, as a share of the clearance, below which a comparison ends.
const MARGIN: f64 = 1e-4;
/// Change of each number of the start, by which conditions are measured.
const MOVED: f64 = 1e-8;
/// Rounding error of the simple program per unit of condition: some thousand steps of a unit each.
const ROUNDING: f64 = 2e-13;
/// Change by halving the step above which the simple program counts as unreliable.
const TOO_FAR: f64 = 1e-6;

fn scene(rng: &mut Rng, number: usize) -> Scene {
    let clearance = rng.log_range(0.15, 1.6);
    let absorber = match number % 3 {
        0 => Absorber::Mass,
        kind => {
            let length = clearance * rng.log_range(1.1, 20.0);
            let compound = rng.unit() < 0.4;
            Absorber::Pendulum {
                length,
                contact: if compound { length * rng.range(0.95, 1.4) } else { length },
                inertia: if compound { rng.range(1.0, 1.5) } else { 1.0 },
                frequency_ratio: rng.pick(&[0.0, 0.1, 0.5, 1.0, 1.3]),
                large_angles: kind == 1,
            }
        }
    };
    let drive = (number / 3 % 2 == 1).then(|| Drive {
        amplitude: rng.range(0.05, 0.6),
        frequency: rng.range(0.4, 2.0),
        phase: rng.range(0.0, TAU),
        base: rng.unit() < 0.5,
    });
    let start = [
        rng.range(0.5, 1.0) * rng.sign(),
        rng.range(-0.5, 0.5),
        clearance * rng.range(-0.9, 0.9),
        rng.range(-0.5, 0.5),
    ];
    Scene {
        mass_ratio: rng.log_range(0.02, 1.0),
        restitution: rng.range(0.3, 0.9),
        clearance,
        damping_ratio: rng.pick(&[0.0, 0.01, 0.1]),
        absorber,
        drive,
        start,
        duration: rng.range(10.0, 25.0),
    }
}

/// The results of the simulator under test.
struct Answer {
    impacts: Vec<Impact>,
    sticks: usize,
    last: State,
}

fn simulated(scene: &Scene, end: f64) -> Answer {
    let Scene { mass_ratio, restitution, clearance, damping_ratio, .. } = *scene;
    let [displacement, velocity, gap_displacement, gap_velocity] = scene.start;
    let start = Start { displacement, velocity, gap_displacement, gap_velocity };
    let harmonic = scene.drive.map(|drive| Harmonic {
        amplitude: drive.amplitude,
        frequency: drive.frequency,
        phase: drive.phase,
        acts: if drive.base { Acts::Base } else { Acts::Primary },
    });
    let force = Force::harmonic(harmonic.into_iter().collect()).unwrap();
    match scene.absorber {
        Absorber::Mass => {
            let siva = Siva::new(mass_ratio, restitution, clearance, damping_ratio).unwrap();
            if force.is_none() {
                answer(&siva, &start, clearance, end)
            } else {
                answer(&siva.under(force), &start, clearance, end)
            }
        }
        Absorber::Pendulum { length, contact, inertia, frequency_ratio, large_angles } => {
            let parameters = Parameters {
                frequency_ratio,
                inertia_ratio: inertia,
                contact_distance: contact,
                angles: if large_angles { Angles::Large } else { Angles::Small },
                ..Parameters::point_bob(mass_ratio, restitution, clearance, damping_ratio, length)
            };
            let piva = Piva::new(parameters).unwrap().under(force);
            answer(&piva, &start.into(), clearance, end)
        }
    }
}

fn answer<S: absorber::Absorber<Real = f64>>(
    system: &S,
    start: &S::Start,
    clearance: f64,
    end: f64,
) -> Answer {
    let limits = Limits { chatter_floor: 1e-9, ..Limits::new(end, clearance) };
    let Run { impacts, episodes, .. } = run(system, start, &limits).unwrap();
    let last = states(system, start, &limits, &[end]).unwrap()[0];
    Answer { impacts, sticks: episodes.len(), last }
}

/// The comparisons made, and the differences found.
#[derive(Debug, Default)]
struct Compared {
    impacts: usize,
    expected: usize,
    last_states: usize,
    /// Differences of instants, and the largest over the allowed one.
    off: Vec<f64>,
    share: f64,
}

/// The runs of the simple program up to where it is reliable: fine, coarse, and with a changed start.
fn opinions(scene: &Scene) -> [naive::Run; 3] {
    let (low, margin) = (LOW, MARGIN * scene.clearance);
    let first = scene.run(STEP / 2.0, low, margin);
    let mut end = first.end;
    // The end must not be near an impact, which one of the runs could have beyond the end.
    for impact in first.impacts.iter().rev() {
        if (impact.time - end).abs() < 2.0 * STEP {
            end = impact.time - 2.0 * STEP;
        }
    }
    let scene = Scene { duration: end.max(4.0 * STEP), ..*scene };
    let [x, v, y, w] = scene.start;
    let moved = Scene { start: [x + MOVED, v - MOVED, y - MOVED, w + MOVED], ..scene };
    [(&scene, STEP / 2.0), (&scene, STEP), (&moved, STEP / 2.0)]
        .map(|(scene, step)| scene.run(step, 0.0, 0.0))
}

/// The estimated error of the simple program up to the current instant.
struct Doubt {
    halving: f64,
    condition: f64,
}

impl Doubt {
    /// Compares numbers that belong together, each from the fine, the coarse and the changed run and from the
    /// simulator. `None` if the estimated error is too large; otherwise the difference of the first number,
    /// and the largest difference over the allowed one.
    fn judge(&mut self, what: &str, numbers: &[[f64; 4]]) -> Result<Option<(f64, f64)>, String> {
        for [fine, coarse, moved, _] in numbers {
            self.halving = self.halving.max((fine - coarse).abs());
            self.condition = self.condition.max((fine - moved).abs() / MOVED);
        }
        let allowed = self.halving + ROUNDING * self.condition;
        if allowed > TOO_FAR {
            return Ok(None);
        }
        let off = |[fine, _, _, found]: &[f64; 4]| (found - fine).abs();
        let most = numbers.iter().map(off).fold(0.0, f64::max);
        if most <= allowed {
            return Ok(Some((off(&numbers[0]), most / allowed)));
        }
        Err(format!("{what}: {numbers:?}, off by {most:e}, allowed {allowed:e}"))
    }
}

/// Compares `scene`, run by the simple program, with `tested`, run by the simulator.
fn compare(scene: &Scene, tested: &Scene, so_far: &mut Compared) -> Result<(), String> {
    let [fine, coarse, moved] = opinions(scene);
    let Answer { impacts, sticks, last } = simulated(tested, fine.end);
    so_far.expected += fine.impacts.len();
    let mut doubt = Doubt { halving: 0.0, condition: 1.0 };
    for (k, impact) in fine.impacts.iter().enumerate() {
        let (Some(rough), Some(moved)) = (coarse.impacts.get(k), moved.impacts.get(k)) else {
            return Ok(());
        };
        if rough.wall != impact.wall || moved.wall != impact.wall {
            return Ok(());
        }
        let Some(found) = impacts.get(k) else {
            return Err(format!("impact {k} is missing: {impact:?}"));
        };
        if found.wall.sign() != impact.wall {
            return Err(format!("impact {k}: {found:?} for {impact:?}"));
        }
        let found = [
            found.time,
            found.velocity_before,
            found.velocity_after,
            found.gap_velocity_before,
            found.gap_velocity_after,
        ];
        let [fine, coarse, moved] = [impact, rough, moved].map(|i| {
            let [a, b, c, d] = i.velocities;
            [i.time, a, b, c, d]
        });
        let numbers = [0, 1, 2, 3, 4].map(|i| [fine[i], coarse[i], moved[i], found[i]]);
        let Some((off, share)) = doubt.judge(&format!("impact {k}"), &numbers)? else {
            return Ok(());
        };
        so_far.off.push(off);
        so_far.share = so_far.share.max(share);
        so_far.impacts += 1;
    }
    let count = fine.impacts.len();
    if coarse.impacts.len() != count || moved.impacts.len() != count {
        return Ok(());
    }
    if impacts.len() > count || sticks > 0 {
        return Err(format!("{sticks} sticks or an impact too many: {:?}", impacts.get(count)));
    }
    let found = [last.displacement, last.velocity, last.gap_displacement, last.gap_velocity];
    let numbers = [0, 1, 2, 3].map(|i| [fine.last[i], coarse.last[i], moved.last[i], found[i]]);
    if let Some((_, share)) = doubt.judge(&format!("last state, at {}", fine.end), &numbers)? {
        so_far.share = so_far.share.max(share);
        so_far.last_states += 1;
    }
    Ok(())
}

#[test]
fn a_thousand_scenes_agree_with_a_naive_program() {
    let mut rng = Rng::new(41);
    let mut total = Compared::default();
    let mut failures = Vec::new();
    for number in 0..1000 {
        let scene = scene(&mut rng, number);
        if let Err(what) = compare(&scene, &scene, &mut total) {
            failures.push(format!("scene {number} {scene:?}: {what}"));
        }
    }
    total.off.sort_by(f64::total_cmp);
    println!(
        "{} of {} impacts and {} last states compared; instants off by {:.1e} (median), {:.1e} (most), at most {:.2} of what is allowed",
        total.impacts,
        total.expected,
        total.last_states,
        total.off[total.off.len() / 2],
        total.off[total.off.len() - 1],
        total.share,
    );
    assert!(failures.is_empty(), "{} scenes: {failures:#?}", failures.len());
    // The rules that end a comparison must not leave too little to compare, and the comparison must be sharp.
    assert!(total.impacts * 10 >= total.expected * 9 && total.impacts > 3000);
    assert!(total.last_states > 700);
    assert!(total.off[total.off.len() / 2] < 1e-10);
}

/// The comparison is effective: small changes of one of the two programs are detected in nearly every scene.
#[test]
fn a_small_difference_is_seen() {
    let seen = |change: &dyn Fn(&mut Scene) -> bool| {
        let mut rng = Rng::new(43);
        let (mut tried, mut seen) = (0, 0);
        for number in 0..60 {
            let scene = scene(&mut rng, number);
            let mut other = scene;
            if change(&mut other) {
                tried += 1;
                let compared = compare(&scene, &other, &mut Compared::default());
                seen += usize::from(compared.is_err());
            }
        }
        assert!(tried >= 15 && seen * 10 >= tried * 7, "{seen} of {tried}");
    };
    seen(&|scene| {
        scene.restitution += 1e-7;
        true
    });
    seen(&|scene| {
        scene.clearance *= 1.0 + 1e-8;
        true
    });
    // Base motion replaced by a force on the primary alone.
    seen(&|scene| {
        let Some(drive) = scene.drive.as_mut().filter(|drive| drive.base) else { return false };
        (drive.base, drive.amplitude) = (false, -drive.amplitude);
        true
    });
    // Large angles replaced by small ones.
    seen(&|scene| match &mut scene.absorber {
        Absorber::Pendulum { large_angles, .. } if *large_angles => {
            *large_angles = false;
            true
        }
        _ => false,
    });
}
