//! Restitution that depends on the approach speed, by the laws of the core: single impacts, energies, derivatives, sweeps.
//!
//! Numbers come from closed forms (single impacts, a table that is constant at all speeds that occur), energies and volumes,
//! and from differences of runs in numbers of twice the precision.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use Law::{Constant, Plastic, Power as PowerLaw, Table};
use iva_core::{
    absorber::{Absorber, ImpactLaw, OnStructure, Point, Start, Wall, restitution::RestitutionLaw},
    flight::GapPoint,
    force::Acts,
    host::Host,
    measures::Wanted,
    observe::Events,
    propagation::Tangent,
    real::{Real, twofold::Twofold},
    run::run,
    run::side_by_side::{self, Job, Listing, SideBySide, Tier},
    simulate::{Limits, Outcome, simulate},
    siva::{FreeMass, Siva},
};
use iva_tests::list::{begun, driven, list};
use iva_tests::{
    U,
    laws::{Free, LAWS, Law, mass, push, start},
    rng::Rng,
};

/// Laws that are constant at all speeds of a run, but in two cases not at all speeds: those go through all that reads a law.
fn constant_here(e: f64) -> [RestitutionLaw; 2] {
    let beyond = RestitutionLaw::table(&[[1e9, e], [2e9, 0.5 * e + 0.3]]).unwrap();
    assert!(!beyond.is_constant());
    [RestitutionLaw::constant(e).unwrap(), beyond]
}

#[test]
fn a_law_that_is_constant_gives_the_same_bits() {
    let mut sticks = 0;
    for (k, e) in [0.05, 0.5, 0.8, 0.95, 1.0].into_iter().enumerate() {
        for d in [0.05, 0.2, 0.7] {
            let old = Siva::new(0.15, e, d, 0.02).unwrap();
            let force =
                push(0.3, 0.9 + 0.02 * k as f64, if k < 3 { Acts::Primary } else { Acts::Base });
            let limits = Limits::new(if e == 1.0 { 20.0 } else { 15.0 * TAU }, d);
            let (free, driven) = (run(&old, &start(), &limits), old.under(force.clone()));
            let (free, forced) = (free.unwrap(), run(&driven, &start(), &limits).unwrap());
            for law in constant_here(e) {
                let new = old.clone().with_restitution_law(law);
                assert_eq!(new.varies(), !law.is_constant());
                assert_eq!(run(&new, &start(), &limits).unwrap(), free, "{e} {d}");
                let new = new.under(force.clone());
                assert_eq!(run(&new, &start(), &limits).unwrap(), forced, "{e} {d}");
            }
            sticks += free.episodes.len() + forced.episodes.len();
        }
    }
    assert!(sticks > 20, "{sticks}");
}

#[test]
fn a_law_that_is_constant_gives_the_same_bits_to_several() {
    let (mut rng, mut sticks) = (Rng::new(46), 0);
    for k in 0..12 {
        let given: [[f64; 3]; 3] = std::array::from_fn(|_| {
            [rng.log_range(0.02, 0.5), rng.range(0.1, 0.9), rng.range(0.1, 0.8)]
        });
        let old = given.map(|[mu, e, d]| FreeMass::new(mu, e, d).unwrap());
        let laws = |which: usize| {
            std::array::from_fn(|n| {
                old[n].with_restitution_laws([constant_here(given[n][1])[which]; 2])
            })
        };
        let gaps = [0.3, -0.4, 0.7].map(|w| GapPoint { y: 0.01, w });
        let starts = begun(Point { x: 1.0, v: 0.2 }, &gaps);
        let limits = Limits::new(30.0, 0.1);
        let system = |masses: [FreeMass; 3]| list(0.02, &masses);
        let force = push(0.4, 0.9, Acts::Primary);
        for masses in [laws(0), laws(1)] {
            if k % 2 == 0 {
                let old = run(&system(old), &starts, &limits).unwrap();
                let new = run(&system(masses), &starts, &limits).unwrap();
                assert_eq!((&old.impacts, &old.episodes), (&new.impacts, &new.episodes), "{k}");
                sticks += old.episodes.len();
            } else {
                let old = run(&driven(&system(old), force.clone()), &starts, &limits).unwrap();
                let new = run(&driven(&system(masses), force.clone()), &starts, &limits).unwrap();
                assert_eq!((&old.impacts, &old.episodes), (&new.impacts, &new.episodes), "{k}");
                sticks += old.episodes.len();
            }
        }
    }
    assert!(sticks > 10, "{sticks}");
}

/// The mass meets a structure at rest: e is that of its speed, momentum and energy follow from it.
#[test]
fn one_impact_is_that_of_the_law() {
    let (mu, d) = (0.25, 0.5);
    // u^(1/5) is 1/2 at 2⁻⁵ and 2 at 2⁵, where e = 0 for a = 0.5.
    let exact = [
        (Constant(0.75), 0.3, 0.75),
        (PowerLaw(0.5, [1, 5]), 0.03125, 0.75),
        (PowerLaw(0.25, [1, 5]), 32.0, 0.5),
        (PowerLaw(0.5, [1, 5]), 32.0, 0.0),
        (PowerLaw(0.5, [1, 5]), 100.0, 0.0),
        (PowerLaw(0.5, [3, 4]), 0.0625, 0.9375),
        (PowerLaw(0.25, [2, 1]), 0.5, 0.9375),
        (Plastic(0.5), 0.25, 1.0),
        (Plastic(0.5), 0.5, 1.0),
        // (6√3/5)^½ (23/24)^½ (½/(½ + 2 √1.15))^¼ with 30 digits.
        (Plastic(0.25), 0.5, 0.930_625_877_273_653_3),
        // 1.185 q^¼.
        (Plastic(1e-12), 1.0, 1.184_992_992_212_236_3e-3),
        (Table(&[[0.25, 0.75], [0.5, 0.5]]), 0.375, 0.625),
        (Table(&[[0.25, 0.75], [0.5, 0.5]]), 0.125, 0.75),
        (Table(&[[0.25, 0.75], [0.5, 0.5]]), 4.0, 0.5),
    ];
    for (law, speed, e) in exact {
        let system = mass([mu, d, 0.1], law);
        let start = Start { gap_velocity: speed, ..Start::default() };
        // A chatter at a yield speed of 10⁻¹² would go on and on.
        let limits = Limits { max_work: 20, ..Limits::new(1.5 * d / speed, d) };
        let found = run(&system, &start, &limits).unwrap();
        let impact = &found.impacts[0];
        assert_eq!((impact.time, impact.approach_speed()), (d / speed, speed), "{law:?}");
        let near = |found: f64, expected: f64| {
            assert!(
                (found - expected).abs() <= 8.0 * U * expected.abs(),
                "{law:?}: {found} {expected}"
            );
        };
        near(law.made::<f64>().restitution(speed), e);
        near(-impact.gap_velocity_after, e * speed);
        near(impact.velocity_after, mu / (1.0 + mu) * (1.0 + e) * speed);
        near(impact.energy_loss, 0.5 * mu / (1.0 + mu) * (1.0 - e * e) * speed * speed);
        assert_eq!(found.tally.episodes, u64::from(e == 0.0));
    }
}

#[test]
fn each_law_is_its_formula_in_all_numbers() {
    let mut rng = Rng::new(3);
    for law in LAWS {
        let [double, slow] = [law.made::<f64>(), law.made::<f64>()];
        let exact = law.made::<Twofold>();
        for _ in 0..400 {
            let u = rng.log_range(1e-12, 10.0);
            let e = double.restitution(u);
            assert!((0.0..=1.0).contains(&e) && slow.restitution(u) == e);
            assert!((e - law.expected(u)).abs() <= 8.0 * U, "{law:?} {u}: {e}");
            let twice = exact.restitution(Twofold::from(u));
            assert!(f64::from(twice - e).abs() <= 4.0 * U, "{law:?} {u}: {e}");
            // The slope that the derivatives of impacts use is that of a difference.
            let step = u * 2f64.powi(-50);
            let [low, high] = [-step, step].map(|by| exact.restitution(Twofold::from(u) + by));
            let slope = f64::from((high - low) / (2.0 * step));
            let system = mass::<f64>([0.1, 1.0, 0.02], law);
            let at = system.law_at(Wall::Minus, u);
            assert!((at.slope - e - u * slope).abs() <= 1e-14, "{law:?} {u}: {} {slope}", at.slope);
            assert_eq!((at.restitution, at.rebound), (e, e));
            // `spread` bounds what any lower speed has.
            let lower = double.restitution(u * rng.unit());
            assert!((lower - e).abs() <= at.spread * (1.0 + 4.0 * U) + 2.0 * U, "{law:?} {u}");
        }
        let [low, high] = [1e-30, 1e30].map(|u| double.restitution(u));
        assert!((0.0..=1.0).contains(&high) && (low == 1.0 || low == law.expected(1e-30)));
    }
}

/// No impact gains energy, each loses what its velocities say, and all that is lost adds up.
#[test]
fn energy_never_grows_and_adds_up() {
    let (mut rng, mut impacts) = (Rng::new(8), 0);
    for k in 0..80 {
        let (plus, minus) = (LAWS[k % 8], LAWS[(k / 8) % 8]);
        let numbers = [rng.log_range(0.02, 1.0), rng.range(0.1, 1.2), rng.range(0.0, 0.1)];
        let system = mass(numbers, plus).with_restitution_laws([plus.made(), minus.made()]);
        let limits = Limits::new(25.0, numbers[1]);
        if k % 2 == 0 {
            impacts += lost(&system, &limits, k);
        } else {
            let acts = if k % 4 == 1 { Acts::Primary } else { Acts::Base };
            impacts += lost(&system.under(push(0.3, rng.range(0.5, 1.5), acts)), &limits, k);
        }
    }
    assert!(impacts > 1000, "{impacts}");
}

fn lost<H: Host<Real = f64>>(system: &Siva<H>, limits: &Limits, k: usize) -> usize {
    let found = run(system, &start(), limits).unwrap();
    assert_eq!((found.tally.outcome, found.tally.undecided), (Outcome::Finished, 0), "{k}");
    let mu = system.mass_ratio();
    for impact in &found.impacts {
        let kinetic = |v: f64, w: f64| 0.5 * v * v + 0.5 * mu * (v + w) * (v + w);
        let before = kinetic(impact.velocity_before, impact.gap_velocity_before);
        let after = kinetic(impact.velocity_after, impact.gap_velocity_after);
        assert!(impact.energy_loss >= 0.0, "{k}");
        assert!((before - after - impact.energy_loss).abs() <= 1e-14 * before.max(0.1), "{k}");
        let momentum = |v: f64, w: f64| v + mu * (v + w);
        let kept = momentum(impact.velocity_before, impact.gap_velocity_before)
            - momentum(impact.velocity_after, impact.gap_velocity_after);
        assert!(kept.abs() <= 1e-14, "{k}: {kept:e}");
    }
    let residual = found.measures.energy_residual;
    assert!(residual.abs() < 1e-13, "{k}: {residual:e}");
    found.impacts.len()
}

/// x, ẋ, y and ẏ at the end of a run.
fn end<R: Real>(system: &Free<R>, start: &Start<R>, duration: f64) -> [R; 4] {
    let limits = Limits::new(R::from(duration), system.clearance());
    let state = simulate(system, start, &limits, None, &mut ()).unwrap().state;
    let (primary, gap) = (system.primary(&state), system.distance(&state));
    let sign = if system.wall(&state) == Wall::Plus { R::ONE } else { -R::ONE };
    [primary.x, primary.v, sign * (system.clearance() - gap.value), -(sign * gap.rate)]
}

#[test]
fn the_derivative_of_a_run_is_that_of_differences() {
    let mut checked = 0;
    for law in LAWS {
        let (numbers, duration) = ([0.15, 0.4, 0.02], 1.2 * TAU);
        let system = mass::<f64>(numbers, law);
        let mut seen = (Tangent::default(), Events::default());
        let limits = Limits::new(duration, numbers[1]);
        let tally = simulate(&system, &start(), &limits, None, &mut seen).unwrap();
        let (tangent, events) = seen;
        if tally.episodes > 0 {
            // The approach speed is one at which e = 0.
            continue;
        }
        checked += 1;
        assert!(tally.impacts >= 3, "{law:?}");
        let exact = mass::<Twofold>(numbers, law);
        for varied in 0..4 {
            let moved = |by: f64| {
                let mut start = start::<Twofold>();
                let fields = [
                    &mut start.displacement,
                    &mut start.velocity,
                    &mut start.gap_displacement,
                    &mut start.gap_velocity,
                ];
                *fields.into_iter().nth(varied).unwrap() += by;
                end(&exact, &start, duration)
            };
            let (low, high) = (moved(-1e-9), moved(1e-9));
            for row in 0..4 {
                let truth = f64::from((high[row] - low[row]) / 2e-9);
                let off = (tangent.derivative()[(row, varied)] - truth).abs();
                assert!(
                    off < 1e-9 * truth.abs().max(1.0),
                    "{law:?} {row} {varied}: {truth} {off:e}"
                );
            }
        }
        // Each impact shrinks a small volume by e d(e u)/du, the damper by 2ζ.
        let shrunk = events.impacts.iter().map(|impact| {
            let at = system.law_at(impact.wall, impact.approach_speed());
            at.restitution * at.slope
        });
        let volume = shrunk.product::<f64>() * (-2.0 * numbers[2] * duration).exp();
        let off = (tangent.volume() - volume).abs();
        assert!(off < 1e-12 * volume.abs(), "{law:?}: {volume} {off:e}");
    }
    assert!(checked >= 6, "{checked}");
}

/// Lanes read a constant e: masses with another law go through the event loop, among others that do not.
#[test]
fn sweeps_are_their_runs() {
    fn compare<S: SideBySide + Absorber<Real = f64, Start = Start>>(jobs: &[Job<S>]) {
        let (mut seen, all) = (0, Listing { events: true, errors: true, ..Listing::default() });
        side_by_side::run_listed(jobs, (Wanted::ALL, &all), None, &mut |i, (tally, ..), listed| {
            let Job { system, start, limits, .. } = &jobs[i];
            let mut events = Events::default();
            let alone = simulate(system, start, limits, None, &mut events).unwrap();
            assert_eq!(tally.impacts, alone.impacts, "{i}");
            assert_eq!(tally.energy_impacts, alone.energy_impacts, "{i}");
            let listed = listed.events.unwrap();
            assert_eq!((listed.impacts, listed.episodes), (events.impacts, events.episodes), "{i}");
            seen += 1;
        })
        .unwrap();
        assert_eq!(seen, jobs.len());
    }
    let systems =
        (0..32).map(|k| mass([0.15, 0.1 + 0.03 * f64::from(k), 0.02], LAWS[k as usize % 8]));
    let job = |system: Free, fast: bool| {
        let limits = Limits::new(10.0 * TAU, system.clearance());
        // A constant law has another tier.
        let tier = if fast && system.varies() { Tier::Fast } else { Tier::Exact };
        Job { begin: 0.0, system, start: start(), limits, steady: None, tier }
    };
    let free: Vec<_> = systems.enumerate().map(|(k, system)| job(system, k % 3 == 0)).collect();
    compare(&free);
    let driven = |Job { begin, system, start, limits, steady, tier }| {
        let system: Free = system;
        let system = system.under(push(0.3, 0.95, Acts::Primary));
        Job { begin, system, start, limits, steady, tier }
    };
    compare(&free.into_iter().map(driven).collect::<Vec<_>>());
}

#[test]
fn bad_laws_are_refused_in_one_sentence() {
    let refused =
        |law: Result<RestitutionLaw, iva_core::error::Invalid>| law.unwrap_err().to_string();
    let table = |points: &[[f64; 2]]| refused(RestitutionLaw::table(points));
    for (found, sentence) in [
        (
            refused(RestitutionLaw::constant(1.5)),
            "absorber.restitution = 1.5: give a number from 0 to 1",
        ),
        (
            refused(RestitutionLaw::power(0.0, [1, 5])),
            "absorber.restitution.coefficient = 0: give a number from 1e-75 to 1e75",
        ),
        (
            refused(RestitutionLaw::power(0.3, [0, 5])),
            "absorber.restitution.exponent = 0/5: give a quotient of whole numbers from 1 to 8",
        ),
        (
            refused(RestitutionLaw::power(0.3, [1, 9])),
            "absorber.restitution.exponent = 1/9: give a quotient of whole numbers from 1 to 8",
        ),
        (
            refused(RestitutionLaw::plastic(f64::NAN)),
            "absorber.restitution.yield_speed = NaN: give a number from 1e-75 to 1e75",
        ),
        (
            table(&[]),
            "absorber.restitution.points = 0 points: give 1 to 16 points (speed, restitution)",
        ),
        (
            table(&[[0.1, 0.5], [0.1, 0.4]]),
            "absorber.restitution.points[1].speed = 0.1: give a speed above 0.1, that of the point before",
        ),
        (
            table(&[[-0.1, 0.5]]),
            "absorber.restitution.points[0].speed = -0.1: give a speed of 0 or more",
        ),
        (
            table(&[[0.1, 0.5], [0.2, 1.01]]),
            "absorber.restitution.points[1].restitution = 1.01: give a number from 0 to 1",
        ),
    ] {
        assert_eq!(found, sentence);
    }
    let many: Vec<[f64; 2]> = (0..17).map(|k| [f64::from(k), 0.5]).collect();
    assert!(table(&many).contains("17 points"));
    assert!(RestitutionLaw::table(&many[..16]).unwrap().is_constant());
}
