//! Steady states in closed form, compared with numbers of 40 digits, with simulations and with each other.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::{PI, TAU};

use iva_core::{
    absorber::{OnStructure, Start, Wall},
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    run::{Run, run, states},
    simulate::{Limits, Outcome},
    siva::Siva,
    theory::{Complex, Orbit, SymmetricScene, masri_caughey, slow_manifold},
};
use iva_tests::driven::mass;
use nalgebra::Matrix4;
use proptest::prelude::*;

fn scene([mu, e, d, zeta, amplitude, frequency]: [f64; 6]) -> SymmetricScene {
    SymmetricScene {
        mass_ratio: mu,
        restitution: e,
        clearance: d,
        damping_ratio: zeta,
        force: Harmonic { amplitude, frequency, phase: 0.0, acts: Acts::Primary },
    }
}

fn plus(scene: &SymmetricScene) -> Orbit {
    masri_caughey(scene).unwrap().branches[0].expect("the orbit exists")
}

/// The absorber under the scene's force, with a given phase.
fn absorber(scene: &SymmetricScene, phase: f64) -> Siva<DrivenHost> {
    let SymmetricScene { mass_ratio, restitution, clearance, damping_ratio, force } = *scene;
    let force = Force::harmonic(vec![Harmonic { phase, ..force }]).unwrap();
    mass(mass_ratio, restitution, clearance, damping_ratio)(force)
}

type Result = Run<<Siva<DrivenHost> as OnStructure>::State>;

/// A run of a number of half cycles and a quarter, from just after the impact on wall +.
fn follow(scene: &SymmetricScene, orbit: &Orbit, half_cycles: f64) -> Result {
    let limits = Limits::new((half_cycles + 0.25) * PI / scene.force.frequency, scene.clearance);
    run(&absorber(scene, orbit.phase), &orbit.start, &limits).unwrap()
}

fn close(found: f64, expected: f64, allowed: f64) {
    assert!((found - expected).abs() <= allowed, "{found} instead of {expected}");
}

const STABLE: [f64; 6] = [0.05, 0.8, 2.0, 0.02, 0.1, 1.0];
const UNSTABLE: [f64; 6] = [0.1, 0.6, 1.0, 0.01, 0.2, 1.0];

// The numbers of the next three tests were derived independently, with 40 digits.

#[test]
fn the_stable_orbit_has_its_numbers() {
    let scene = scene(STABLE);
    let answer = masri_caughey(&scene).unwrap();
    assert!(answer.branches[1].is_none(), "x without absorber exceeds d: its speed is negative");
    close(answer.amplitude_without_absorber, 2.5, 1e-15);
    let orbit = answer.branches[0].unwrap();
    close(orbit.speed, 1.452072978709073, 1e-14);
    close(orbit.displacement, 0.2809109011943361, 1e-14);
    close(orbit.velocity_before, -0.2420121631181788, 1e-14);
    close(orbit.velocity_after, -0.09680486524727154, 1e-14);
    // The phase of sin(Ωτ + a).
    close(orbit.phase, 4.59047988735129 - 0.5 * PI, 1e-14);
    close(orbit.amplitude, 0.3532853191886, 1e-13);
    assert!(orbit.admissible && orbit.stable);
    let [a, b, c, d] = orbit.multipliers;
    let expected =
        [Complex::new(0.9217639412, 0.1307669925), Complex::new(0.06222103944, 0.8045647798)];
    for (found, expected) in
        [(a, expected[0]), (b, expected[0].conj()), (c, expected[1]), (d, expected[1].conj())]
    {
        assert!((found - expected).norm() < 1e-10, "{found}");
    }
}

#[test]
fn the_unstable_orbit_has_its_numbers() {
    let orbit = plus(&scene(UNSTABLE));
    close(orbit.speed, 1.490992427985109, 1e-14);
    close(orbit.displacement, 1.342045429158013, 1e-14);
    close(orbit.velocity_before, -0.5591221604944157, 1e-14);
    close(orbit.velocity_after, -0.260923674897394, 1e-14);
    close(orbit.phase, 4.572987560392349 - 0.5 * PI, 1e-14);
    assert!(orbit.admissible && !orbit.stable);
    assert!((orbit.multipliers[0] + 2.56749605).norm() < 1e-8, "{}", orbit.multipliers[0]);
}

#[test]
fn orbits_end_at_the_largest_clearance_in_a_fold() {
    let numbers = [0.1, 0.6, 3.0, 0.005, 0.02, 1.0];
    let answer = masri_caughey(&scene(numbers)).unwrap();
    close(answer.largest_clearance, 2.015122467300952, 1e-13);
    assert_eq!(answer.branches, [None, None]);
    let near = |factor: f64| {
        let clearance = factor * answer.largest_clearance;
        masri_caughey(&SymmetricScene { clearance, ..scene(numbers) }).unwrap()
    };
    assert_eq!(near(1.0 + 1e-12).branches, [None, None]);
    // Both branches meet there; a multiplier of each tends to 1 like the square root of the distance.
    let away = |factor: f64| {
        near(factor).branches.map(|orbit| {
            let sizes = orbit.unwrap().multipliers.map(|multiplier| (multiplier - 1.0).norm());
            sizes.into_iter().fold(f64::INFINITY, f64::min)
        })
    };
    let (far, close_by) = (away(1.0 - 1e-6), away(1.0 - 1e-8));
    for (far, close_by) in far.into_iter().zip(close_by) {
        assert!(far < 0.02, "{far}");
        close(far / close_by, 10.0, 0.2);
    }
}

#[test]
fn an_orbit_through_the_wall_is_not_admissible() {
    // The orbit is stable, but after a weak rebound the primary catches up with the absorber at once.
    let scene = scene([0.05, 0.02, 1.0, 0.02, 0.1, 1.0]);
    let orbit = plus(&scene);
    assert!(orbit.stable && !orbit.admissible);
    let first = follow(&scene, &orbit, 1.0).impacts[0];
    assert_eq!(first.wall, Wall::Plus);
    assert!(first.time < 0.5 * PI, "{}", first.time);
    // With a stronger rebound the absorber crosses the gap.
    let pushed = plus(&SymmetricScene { restitution: 0.3, ..scene });
    assert!(pushed.admissible);
}

#[test]
fn numbers_without_an_orbit_are_refused_with_their_name() {
    for (numbers, sentence) in [
        ([0.1, 0.6, 1.0, 0.0, 0.1, 1.0], "force.frequency = 1: without damping"),
        ([0.1, 0.6, 1.0, 0.0, 0.1, 1.0 / 3.0], "force.frequency = 0.3333333333333333: without"),
        ([0.1, 0.6, 1.0, 0.1, 0.0, 1.0], "force.amplitude = 0: give a number"),
        ([0.1, 0.6, 1.0, 0.1, 0.1, 1e4], "force.frequency = 10000: give 1e-3 to 1e3"),
        ([0.1, 0.6, 1.0, 0.1, 0.1, f64::NAN], "force.frequency = NaN: give 1e-3 to 1e3"),
        ([0.1, 1.6, 1.0, 0.1, 0.1, 1.0], "absorber.restitution = 1.6: give a number from 0 to 1"),
        ([0.1, 0.6, -1.0, 0.1, 0.1, 1.0], "absorber.clearance = -1"),
        ([0.1, 0.6, 1.0, -0.1, 0.1, 1.0], "primary.damping_ratio = -0.1"),
        ([0.1, 0.6, 1.0, 101.0, 0.1, 1.0], "primary.damping_ratio = 101: give at most 100"),
        ([0.0, 0.6, 1.0, 0.1, 0.1, 1.0], "absorber.mass_ratio = 0"),
    ] {
        let error = masri_caughey(&scene(numbers)).unwrap_err().to_string();
        assert!(error.starts_with(sentence), "{error}");
    }
    assert!(slow_manifold(0.1, 2.0, 1.0).unwrap_err().to_string().starts_with("absorber.rest"));
}

#[test]
fn a_negative_amplitude_is_half_a_turn() {
    let other = scene([0.05, 0.8, 2.0, 0.02, -0.1, 1.0]);
    let (one, other) = (plus(&scene(STABLE)), plus(&other));
    close((one.phase - other.phase).abs(), PI, 1e-15);
    assert_eq!(one.start, other.start);
}

/// Orbits of random scenes: ζ small, around 1 and large, force and base motion.
fn orbits() -> impl Strategy<Value = (SymmetricScene, Orbit)> {
    let damping = prop_oneof![Just(0.0), 0.0..0.1f64, 0.9..1.1f64, Just(1.0), 1.0..4.0f64];
    let restitution = prop_oneof![Just(0.0), 0.05..1.0f64, 0.5..0.95f64];
    let driven = (0.05..1.0f64, 0.25..3.0f64, any::<bool>());
    (0.001..0.5f64, restitution, 0.02..1.0f64, damping, driven, any::<bool>()).prop_filter_map(
        "no orbit",
        |(mu, e, part, zeta, (amplitude, frequency, base), lower)| {
            let mut scene = scene([mu, e, 1.0, zeta, amplitude, frequency]);
            scene.force.acts = if base { Acts::Base } else { Acts::Primary };
            let bare = masri_caughey(&scene).ok()?;
            scene.clearance =
                part * bare.largest_clearance.min(4.0 * bare.amplitude_without_absorber);
            let [one, other] = masri_caughey(&scene).ok()?.branches;
            if lower { other.or(one) } else { one }.map(|orbit| (scene, orbit))
        },
    )
}

proptest! {
    #![proptest_config(iva_tests::rejecting(300))]

    #[test]
    fn the_product_of_the_multipliers_knows_no_mass((scene, orbit) in orbits()) {
        let size = orbit.multipliers.iter().map(|m| m.norm().max(1.0)).product::<f64>();
        let product: Complex<f64> = orbit.multipliers.iter().product();
        let decay = (-2.0 * scene.damping_ratio * PI / scene.force.frequency).exp();
        let off = (product - scene.restitution * scene.restitution * decay).norm();
        prop_assert!(off < 1e-12 * size * size, "{off:e}");
    }

    /// One impact after half a cycle on the other wall and none before: true if the orbit is admissible, and
    /// false otherwise.
    #[test]
    fn admissible_orbits_are_motions_and_others_are_not((scene, orbit) in orbits()) {
        let half = PI / scene.force.frequency;
        let result = follow(&scene, &orbit, 1.0);
        let motion = result.tally.episodes == 0 && result.impacts.first().is_some_and(|impact| {
            impact.wall == Wall::Minus && (impact.time - half).abs() < 1e-9 * half
        });
        prop_assert_eq!(motion, orbit.admissible);
        if motion {
            let impact = result.impacts[0];
            let size = orbit.speed + orbit.amplitude;
            for (found, expected) in [
                (impact.displacement, orbit.displacement),
                (impact.velocity_before, orbit.velocity_before),
                (impact.velocity_after, orbit.velocity_after),
                (impact.gap_velocity_before, orbit.approach_speed),
            ] {
                let off = (found + expected).abs();
                prop_assert!(off < 1e-9 * size, "{found} {expected}");
            }
        }
    }

    /// A stable orbit, started at any phase, is kept for a hundred cycles, and its largest |x| is reached.
    #[test]
    fn stable_orbits_are_kept((scene, orbit) in orbits(), phase in -7.0..7.0f64) {
        prop_assume!(orbit.admissible && orbit.multipliers[0].norm() < 0.99);
        let half = PI / scene.force.frequency;
        let start = orbit.at_phase(phase);
        let limits = Limits::new(200.25 * half, scene.clearance);
        let result = run(&absorber(&scene, phase), &start, &limits).unwrap();
        prop_assert_eq!(result.tally.outcome, Outcome::Finished);
        for impact in &result.impacts {
            let side = if impact.wall == Wall::Plus { 0.0 } else { PI };
            let turned = scene.force.frequency * impact.time + phase - orbit.phase - side;
            let off = turned - TAU * (turned / TAU).round();
            prop_assert!(off.abs() < 1e-9, "{off:e} at {}", impact.time);
        }
        prop_assert!((200..=201).contains(&result.impacts.len()), "{}", result.impacts.len());
        let times: Vec<f64> = (0..=2000).map(|k| f64::from(k) * half / 2000.0).collect();
        let sampled = states(&absorber(&scene, phase), &start, &limits, &times).unwrap();
        let sampled = sampled.iter().map(|state| state.displacement);
        let met = result.impacts.iter().map(|impact| impact.displacement);
        let largest = sampled.chain(met).map(f64::abs).fold(0.0, f64::max);
        prop_assert!(largest < orbit.amplitude * (1.0 + 1e-9), "{largest}");
        prop_assert!(largest > orbit.amplitude * (1.0 - 1e-4), "{largest}");
    }

    /// The map of the half cycle by central differences of the simulation, from the middle between two
    /// impacts to the mirrored middle: another section with the same multipliers. The traces of its powers
    /// are compared, which are well conditioned also for double multipliers.
    #[test]
    fn multipliers_are_those_of_the_simulated_map((scene, orbit) in orbits()) {
        prop_assume!(orbit.admissible);
        let phase = orbit.phase + 0.5 * PI;
        let middle = orbit.at_phase(phase);
        let half = PI / scene.force.frequency;
        let limits = Limits::new(half, scene.clearance);
        let absorber = absorber(&scene, phase);
        let rates = [1.0, scene.force.frequency, 1.0, scene.force.frequency];
        let step = 1e-5 * scene.clearance;
        let mut map = Matrix4::zeros();
        for column in 0..4 {
            for sign in [1.0, -1.0] {
                let mut moved = [
                    middle.displacement,
                    middle.velocity,
                    middle.gap_displacement,
                    middle.gap_velocity,
                ];
                moved[column] += sign * step * rates[column];
                let [displacement, velocity, gap_displacement, gap_velocity] = moved;
                let start = Start { displacement, velocity, gap_displacement, gap_velocity };
                prop_assume!(gap_displacement.abs() < scene.clearance);
                let result = run(&absorber, &start, &limits).unwrap();
                prop_assume!(result.impacts.len() == 1 && result.tally.episodes == 0);
                let end = states(&absorber, &start, &limits, &[half]).unwrap()[0];
                let end =
                    [end.displacement, end.velocity, end.gap_displacement, end.gap_velocity];
                for row in 0..4 {
                    map[(row, column)] -= sign * end[row] / rates[row] / (2.0 * step);
                }
            }
        }
        // Third derivatives grow as the approach speed decreases.
        let gentle = scene.force.frequency * scene.clearance / orbit.approach_speed;
        prop_assume!(gentle < 3.0);
        let size = 1.0 + map.norm();
        let mut power = Matrix4::identity();
        for k in 1..=4 {
            power *= map;
            let sum: Complex<f64> = orbit.multipliers.iter().map(|m| m.powu(k)).sum();
            let trace: f64 = power.trace();
            let off = (sum - trace).norm();
            prop_assert!(off < 1e-7 * size.powi(k as i32 + 1), "{k}: {off:e} of {size}");
        }
    }

    /// For μ → 0 the forced orbit at Ω = 1 lies on the manifold.
    #[test]
    fn light_absorbers_lie_on_the_manifold(
        e in 0.1..0.95f64,
        theta in 0.2..2.2f64,
        d in 0.1..3.0f64,
    ) {
        let manifold = slow_manifold(1e-9, e, d).unwrap();
        let amplitude = manifold.amplitude(theta) * d;
        // At resonance F = 2ζ times the amplitude.
        let answer = masri_caughey(&scene([1e-9, e, d, 0.05, 0.1 * amplitude, 1.0])).unwrap();
        let upper = theta > manifold.stable_theta[0];
        prop_assume!((theta - manifold.stable_theta[0]).abs() > 0.01);
        let orbit = answer.branches[usize::from(!upper)].unwrap();
        prop_assert!((0.5 * PI * orbit.speed / d - theta).abs() < 1e-5);
        prop_assert!((orbit.amplitude - amplitude).abs() < 1e-6 * amplitude);
        prop_assert_eq!(orbit.admissible, manifold.admissible(theta));
        let [from, to] = manifold.stable_theta;
        prop_assume!((theta - to).abs() > 1e-4);
        prop_assert_eq!(orbit.stable && orbit.admissible, from < theta && theta < to);
        if let Some(stable) = manifold.stable_theta_at(amplitude / d) {
            let on_it = (stable - theta).abs() < 1e-9;
            prop_assert_eq!(on_it, from < theta && theta < to);
        }
    }
}

#[test]
fn the_manifold_has_its_closed_forms() {
    // For e = 1/2: (1−e)/(1+e) = 1/3.
    let manifold = slow_manifold(0.02, 0.5, 3.0).unwrap();
    let rho = 2.0 / (3.0 * PI);
    close(manifold.rho, rho, 1e-16);
    close(manifold.activation, rho / (1.0 + rho * rho).sqrt(), 1e-16);
    close(manifold.activation_amplitude, 3.0 * manifold.activation, 1e-15);
    close(manifold.stable_theta[0], 1.0 / (1.0 + rho * rho), 1e-15);
    close(manifold.stable_theta[1], PI * PI / (PI * PI - 4.0), 1e-15);
    close(manifold.amplitude(manifold.stable_theta[0]), manifold.activation, 1e-15);
    close(manifold.largest_added_damping, 0.04 / PI * 3.0, 1e-16);
    // The damping is largest where the impacts are at x = 0.
    close(manifold.best_amplitude, manifold.amplitude(1.0) * 3.0, 1e-15);
    close(manifold.added_damping(1.0), manifold.largest_added_damping, 1e-16);
    for theta in [0.96, 0.99, 1.01, 1.3] {
        assert!(manifold.added_damping(theta) < manifold.largest_added_damping);
    }
}

#[test]
fn elastic_and_plastic_impacts_are_the_limits_of_the_manifold() {
    let elastic = slow_manifold(0.02, 1.0, 3.0).unwrap();
    assert_eq!((elastic.rho, elastic.activation, elastic.best_amplitude), (0.0, 0.0, 0.0));
    assert_eq!(elastic.largest_added_damping, f64::INFINITY);
    assert_eq!(elastic.added_damping(1.5), 0.0);
    assert_eq!(elastic.added_damping(1.0), f64::INFINITY);
    close(elastic.amplitude(1.5), 0.5, 1e-16);
    // For e = 0 the absorber leaves its wall only where the primary decelerates: θ < 1.
    let plastic = slow_manifold(0.02, 0.0, 3.0).unwrap();
    close(plastic.stable_theta[1], 1.0, 1e-12);
    assert_eq!(plastic.stable_theta_at(1.0), None);
}

/// The time in which a free decay falls from θ = 1.4 to 1.05: from dξ/dτ = −ζ_added ξ integrated along the
/// manifold, and from a simulation.
fn decay_times(mass_ratio: f64) -> [f64; 2] {
    let (e, d) = (0.6, 1.0);
    let manifold = slow_manifold(mass_ratio, e, d).unwrap();
    let rho = manifold.rho;
    let time = |from: f64, to: f64| {
        let fall = (1.0 + rho * rho) * (from / to).ln() + 1.0 / from - 1.0 / to;
        PI * PI / (4.0 * mass_ratio * rho) * fall
    };
    let start = Start {
        displacement: (1.5 - 1.0) * d,
        velocity: -rho * 1.5 * d,
        gap_displacement: d,
        gap_velocity: -e * 2.0 / (1.0 + e) * (2.0 / PI * 1.5 * d),
    };
    let siva = Siva::new(mass_ratio, e, d, 0.0).unwrap();
    let limits = Limits::new(1.5 * time(1.5, 1.0), d);
    let peaks = run(&siva, &start, &limits).unwrap().peaks;
    let falls_below = |amplitude: f64| {
        let sizes = peaks.windows(2).map(|pair| (pair, pair.iter().map(|p| p.displacement.abs())));
        for (pair, mut sizes) in sizes {
            let (a, b) = (sizes.next().unwrap(), sizes.next().unwrap());
            if b < amplitude {
                return pair[0].time + (pair[1].time - pair[0].time) * (a - amplitude) / (a - b);
            }
        }
        panic!("it does not fall");
    };
    let [high, low] = [1.4, 1.05].map(|theta| falls_below(manifold.amplitude(theta) * d));
    [time(1.4, 1.05), low - high]
}

#[test]
fn a_light_absorber_damps_free_decay_as_the_manifold_says() {
    let errors = [4e-3, 2e-3, 1e-3, 5e-4].map(|mass_ratio| {
        let [theory, simulated] = decay_times(mass_ratio);
        (simulated / theory - 1.0) / mass_ratio
    });
    println!("relative error over μ: {errors:?}");
    // The neglected terms are of first order in μ: the error over μ tends to a constant.
    for error in errors {
        close(error, errors[3], 0.01 * errors[3].abs());
        close(error, 0.0, 6.0);
    }
}
