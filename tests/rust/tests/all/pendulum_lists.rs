//! Free masses and pendulums on one structure.
//!
//! Numbers come from other formulas (a list of one pendulum is the pendulum, equal pendulums in one phase are one), from momentum and energy, from the mirror image of a scene, and from
//! runs in numbers of twice the precision.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::{Absorber, ImpactLaw, OnStructure},
    error::Invalid,
    force::{Acts, Force, Impulse},
    host::{Host, UndrivenHost},
    impact::Impact,
    observe::StickEpisode,
    piva::{Parameters, Piva},
    real::{Real, twofold::Twofold},
    run::{Run, run},
    simulate::{Outcome, resume, simulate},
};
use iva_tests::list::{List, driven, list};
use iva_tests::pendulum_list::{
    Any, any, any_list, by_itself, limits, mass, mixed, parameters, piva, push, start,
};
use iva_tests::rng::Rng;

/// An impact: the index of its absorber, and numbers.
type Row = (u8, [f64; 7]);

fn rows<R: Real>(impacts: &[Impact<R>]) -> Vec<Row> {
    let row = |it: &Impact<R>| {
        let numbers = [it.time, it.velocity_before, it.velocity_after, it.energy_loss];
        let [time, before, after, lost] = numbers.map(Real::double);
        let [w, to] = [it.gap_velocity_before, it.gap_velocity_after].map(Real::double);
        (it.absorber, [time, it.wall.sign(), before, after, w, to, lost])
    };
    impacts.iter().map(row).collect()
}

fn furthest(a: &[Row], b: &[Row]) -> f64 {
    assert_eq!(a.len(), b.len(), "as many impacts");
    assert!(a.iter().zip(b).all(|(a, b)| a.0 == b.0), "of the same absorbers");
    let off = |(a, b): (&Row, &Row)| (0..7).map(|k| (a.1[k] - b.1[k]).abs()).fold(0.0, f64::max);
    a.iter().zip(b).map(off).fold(0.0, f64::max)
}

/// Rows of impacts, instants of stick episodes, and energies.
struct Told {
    rows: Vec<Row>,
    instants: Vec<f64>,
    energies: [f64; 4],
}

fn told<S, R: Real>(run: Result<Run<S, R>, Invalid>) -> Told {
    let Run { tally, impacts, episodes, measures, .. } = run.unwrap();
    assert_eq!(tally.outcome, Outcome::Finished);
    // Hops of a stuck mass that are about as short as rounding of the clock are decided by bounds, which differ.
    let lasts = |it: &&StickEpisode<R>| {
        it.release_time.is_none_or(|release| (release - it.stick_time).double() > 1e-26)
    };
    let mut instants: Vec<[f64; 4]> = episodes
        .iter()
        .filter(lasts)
        .map(|episode| {
            let release = episode.release_time.unwrap_or(R::ZERO);
            let [start, stick, release] =
                [episode.start_time, episode.stick_time, release].map(Real::double);
            [f64::from(episode.absorber), start, stick, release]
        })
        .collect();
    // Those that last to the end of the run come in any order.
    instants.sort_by(|a, b| a[..2].partial_cmp(&b[..2]).unwrap());
    let energies = [
        measures.energy_work,
        measures.energy_viscous,
        measures.energy_pivot,
        tally.energy_impacts,
    ];
    Told { rows: rows(&impacts), instants: instants.concat(), energies: energies.map(Real::double) }
}

/// That two runs are one to this accuracy; returns the numbers of impacts and of instants.
fn agree(a: &Told, b: &Told, within: f64, scene: &str) -> [usize; 2] {
    let off = furthest(&a.rows, &b.rows);
    assert!(off < within, "{scene}: impacts {off:e}");
    assert_eq!(a.instants.len(), b.instants.len(), "{scene}: episodes");
    for (one, other) in a.instants.iter().zip(&b.instants) {
        assert!((one - other).abs() < within, "{scene}: {one} and {other}");
    }
    for (one, other) in a.energies.iter().zip(&b.energies) {
        assert!((one - other).abs() < within, "{scene}: energies {one} and {other}");
    }
    [a.rows.len(), a.instants.len()]
}

/// In numbers of twice the precision, which leave nothing of conditioning: a list of one pendulum is the pendulum itself,
/// with chatter and sticks, with and without force.
#[test]
fn a_list_of_one_pendulum_is_the_pendulum() {
    let mut rng = Rng::new(5);
    let mut counted = [0; 2];
    for k in 0..40 {
        let one = any(&mut rng, true);
        let at = [rng.range(-2.0, 2.0), rng.range(-1.0, 1.0)];
        let zeta = rng.range(0.0, 0.1);
        let system: List<UndrivenHost<Twofold>> = mixed(&[one], zeta);
        let alone: Piva<UndrivenHost<Twofold>> = piva(&one, zeta);
        let begun = start::<Twofold>(at, &[one]);
        let by_itself = by_itself::<Twofold>(at, &one);
        let limits = limits::<Twofold>(15.0);
        let acts = if k % 4 == 0 { Acts::Base } else { Acts::Primary };
        let force = || push::<Twofold>(0.4, 0.9, acts);
        let [a, b] = if k % 2 == 0 {
            [
                told(run(&driven(&system, force()), &begun, &limits)),
                told(run(&alone.under(force()), &by_itself, &limits)),
            ]
        } else {
            [told(run(&system, &begun, &limits)), told(run(&alone, &by_itself, &limits))]
        };
        let more = agree(&a, &b, 1e-12, &format!("scene {k}"));
        counted = [counted[0] + more[0], counted[1] + more[1]];
    }
    assert!(counted[0] > 100 && counted[1] > 20, "{counted:?}");
}

/// Impacts, energies and gaps of a run.
fn held<H: Host<Real = f64>>(
    system: &List<H>,
    at: [f64; 2],
    all: &[Any],
    counted: &mut [usize],
) -> usize {
    let run = run(system, &start(at, all), &limits(30.0)).unwrap();
    assert_eq!(run.tally.outcome, Outcome::Finished);
    assert!(run.measures.energy_residual.abs() < 1e-12, "{:e}", run.measures.energy_residual);
    for impact in &run.impacts {
        let k = usize::from(impact.absorber);
        let e = all[k].common[if impact.wall.sign() > 0.0 { 1 } else { 2 }];
        let (w, after) = (impact.gap_velocity_before, impact.gap_velocity_after);
        assert!(w * impact.wall.sign() > 0.0 && (after + e * w).abs() <= 1e-15 * w.abs());
        counted[k] += 1;
    }
    assert!(run.impacts.windows(2).all(|two| two[0].time <= two[1].time), "in order of time");
    for k in 0..all.len() {
        let seen = system.turned_to(&run.tally.state, k);
        let d = system.clearance_of(k);
        let distance = system.distance(&seen).value;
        assert!((0.0..=2.0 * d).contains(&distance), "{distance} of {d}");
    }
    run.episodes.len()
}

/// The energy of structure and absorbers, the work of what drives them, and the losses of every event, in random lists of 2
/// to 5; no absorber leaves its gap.
#[test]
fn energy_holds() {
    let mut rng = Rng::new(11);
    let mut episodes = 0;
    let mut counted = [0; 5];
    for k in 0..40 {
        let all = any_list(&mut rng, 2 + k % 4);
        let at = [rng.range(0.5, 2.0), rng.range(-1.0, 1.0)];
        let zeta = if k % 3 == 0 { 0.0 } else { rng.range(0.0, 0.05) };
        let system = mixed(&all, zeta);
        episodes += match k % 5 {
            0 => {
                let kicks = [1.0, 4.0, 9.0, 16.0]
                    .map(|time| Impulse { velocity: rng.range(-1.0, 1.0), time });
                let harmonics = push::<f64>(0.3, 1.2, Acts::Primary).harmonics().to_vec();
                let force = Force::new(harmonics, vec![], &kicks).unwrap();
                held(&driven(&system, force), at, &all, &mut counted)
            }
            1 => held(&driven(&system, push(0.5, 1.05, Acts::Base)), at, &all, &mut counted),
            _ => held(&system, at, &all, &mut counted),
        };
    }
    assert!(episodes > 40 && counted.iter().all(|count| *count > 60), "{episodes} {counted:?}");
}

/// The horizontal momentum of all masses in one impact: the structure and each centre of mass, from the states before and
/// after; those that have no impact keep the momentum that belongs to W.
#[test]
fn an_impact_keeps_the_momentum() {
    let mut rng = Rng::new(17);
    for _ in 0..200 {
        let all = any_list(&mut rng, 3);
        let system: List<UndrivenHost<f64>> = mixed(&all, 0.02);
        // The first at its wall + and moving towards it.
        let mut all = all;
        all[0].start = [1.0, rng.range(0.1, 1.0)];
        let before = system.begin(&start([rng.range(-1.0, 1.0), rng.range(-1.0, 1.0)], &all));
        let (after, impact) = system.impact(&before, 0.0);
        let v = [before, after].map(|state| system.primary(&state).v);
        let mut momentum = v;
        for (k, any) in all.iter().enumerate() {
            let mu = any.common[0];
            for (sum, state) in momentum.iter_mut().zip([&before, &after]) {
                let v = system.primary(state).v;
                let seen = system.turned_to(state, k);
                let jet = system.distance(&seen);
                let w = -jet.rate * system.wall(&seen).sign();
                let lever = any.swing.map_or(1.0, |([.., b, _, _], _)| 1.0 / b);
                *sum += mu * (v + lever * w);
            }
        }
        assert!((momentum[0] - momentum[1]).abs() < 1e-14 * (1.0 + momentum[0].abs()));
        let lost = system.energy(&before) - system.energy(&after);
        assert!((lost - impact.energy_loss).abs() < 1e-14 * (1.0 + lost), "{lost}");
    }
}

/// n equal pendulums in one phase are one of n times the mass; in numbers of twice the precision.
#[test]
fn equal_pendulums_in_one_phase_are_one() {
    let mut rng = Rng::new(23);
    let mut impacts = 0;
    for _ in 0..8 {
        let one = any(&mut rng, true);
        let third = Any {
            common: [one.common[0] / 4.0, one.common[1], one.common[2], one.common[3]],
            ..one
        };
        let at = [rng.range(0.5, 2.0), rng.range(-1.0, 1.0)];
        let single: List<UndrivenHost<Twofold>> = mixed(&[one], 0.03);
        let all = [third; 4];
        let list: List<UndrivenHost<Twofold>> = mixed(&all, 0.03);
        let a = run(&single, &start(at, &[one]), &limits(15.0)).unwrap();
        let b = run(&list, &start(at, &all), &limits(15.0)).unwrap();
        assert_eq!(4 * a.impacts.len(), b.impacts.len());
        for (k, impact) in a.impacts.iter().enumerate() {
            for n in 0..4 {
                let other = &b.impacts[4 * k + n];
                let off = f64::from(impact.time - other.time).abs();
                assert!(off < 1e-13 && usize::from(other.absorber) == n, "{k}: {off:e}");
            }
        }
        assert_eq!(4 * a.episodes.len(), b.episodes.len());
        impacts += a.impacts.len();
    }
    assert!(impacts > 40, "{impacts}");
}

/// The mirror image of a scene gives the mirrored run to the bit.
#[test]
fn a_mirrored_scene_stays_mirrored_to_the_bit() {
    let mut rng = Rng::new(29);
    for _ in 0..12 {
        let mut all = any_list(&mut rng, 3);
        for any in &mut all {
            any.common[2] = any.common[1];
        }
        let mirrored =
            |any: &Any| Any { offset: -any.offset, start: any.start.map(|it| -it), ..*any };
        let mirror: Vec<Any> = all.iter().map(mirrored).collect();
        let at = [rng.range(0.5, 2.0), rng.range(-1.0, 1.0)];
        let one = run(&mixed::<f64>(&all, 0.02), &start(at, &all), &limits(25.0)).unwrap();
        let begun = start(at.map(|it| -it), &mirror);
        let other = run(&mixed::<f64>(&mirror, 0.02), &begun, &limits(25.0)).unwrap();
        assert!(one.impacts.len() > 5 && one.impacts.len() == other.impacts.len());
        for (a, b) in one.impacts.iter().zip(&other.impacts) {
            assert_eq!(a.time.to_bits(), b.time.to_bits());
            assert_eq!(a.velocity_after.to_bits(), (-b.velocity_after).to_bits());
            assert_eq!(a.gap_velocity_before.to_bits(), (-b.gap_velocity_before).to_bits());
        }
    }
}

/// The order of the list changes no more than rounding; impacts in numbers of twice the precision.
#[test]
fn the_order_of_the_list_does_not_matter() {
    let mut rng = Rng::new(31);
    for _ in 0..8 {
        let all = any_list(&mut rng, 3);
        let turned = [all[2], all[0], all[1]];
        let at = [rng.range(0.5, 2.0), rng.range(-1.0, 1.0)];
        let one = run(&mixed::<Twofold>(&all, 0.02), &start(at, &all), &limits(12.0)).unwrap();
        let other =
            run(&mixed::<Twofold>(&turned, 0.02), &start(at, &turned), &limits(12.0)).unwrap();
        let mut rows = [rows(&one.impacts), rows(&other.impacts)];
        for row in &mut rows[1] {
            row.0 = (row.0 + 2) % 3;
        }
        let off = furthest(&rows[0], &rows[1]);
        assert!(off < 1e-13, "{off:e}");
    }
}

/// Doubles against numbers of twice the precision, over the first impacts, which conditioning has not yet spread.
#[test]
fn doubles_agree_with_twice_the_precision() {
    let mut rng = Rng::new(37);
    let (mut worst, mut impacts) = (0.0_f64, 0);
    for k in 0..24 {
        let all = any_list(&mut rng, 2 + k % 3);
        let at = [rng.range(0.5, 2.0), rng.range(-1.0, 1.0)];
        let acts = if k % 4 == 1 { Acts::Base } else { Acts::Primary };
        let [plain, precise] = if k % 2 == 0 {
            let plain = run(&mixed::<f64>(&all, 0.02), &start(at, &all), &limits(12.0)).unwrap();
            let precise = run(&mixed::<Twofold>(&all, 0.02), &start(at, &all), &limits(12.0));
            [rows(&plain.impacts), rows(&precise.unwrap().impacts)]
        } else {
            let plain = driven(&mixed::<f64>(&all, 0.02), push(0.4, 0.9, acts));
            let precise = driven(&mixed::<Twofold>(&all, 0.02), push(0.4, 0.9, acts));
            let plain = run(&plain, &start(at, &all), &limits(12.0)).unwrap();
            let precise = run(&precise, &start(at, &all), &limits(12.0)).unwrap();
            [rows(&plain.impacts), rows(&precise.impacts)]
        };
        let first = |rows: &[Row]| rows[..rows.len().min(6)].to_vec();
        worst = worst.max(furthest(&first(&plain), &first(&precise)));
        impacts += plain.len().min(6);
    }
    assert!(worst < 2e-13 && impacts > 80, "{worst:e} {impacts}");
}

/// A run that is divided at any instant, also while absorbers are stuck, ends as the whole one.
#[test]
fn a_divided_run_goes_on() {
    let mut rng = Rng::new(83);
    let mut stuck = 0;
    for _ in 0..16 {
        let all = any_list(&mut rng, 3);
        let system = driven(&mixed::<Twofold>(&all, 0.02), push(1.0, 0.4, Acts::Primary));
        let start = start([1.5, 0.0], &all);
        let whole = simulate(&system, &start, &limits(12.0), None, &mut ()).unwrap();
        let middle: f64 = rng.range(2.0, 10.0);
        let first = simulate(&system, &start, &limits(middle), None, &mut ()).unwrap();
        stuck += usize::from((0..3).any(|k| system.is_stuck(&system.turned_to(&first.state, k))));
        let second = resume(&system, &first.instant(), &limits(12.0), None, &mut ()).unwrap();
        assert_eq!(whole.impacts, first.impacts + second.impacts);
        let [a, b] = [&whole, &second].map(|run| system.primary(&run.state));
        let off = [a.x - b.x, a.v - b.v].map(|it| f64::from(it).abs());
        assert!(off[0].max(off[1]) < 1e-13, "{middle}: {off:?}");
    }
    assert!(stuck > 0, "{stuck} divided while an absorber was stuck");
}

/// What a list does not take is refused with the field.
#[test]
fn what_a_list_does_not_take_is_refused() {
    let mut rng = Rng::new(1);
    let mut one = any(&mut rng, true);
    let refused = |parameters: Parameters| {
        let list: List<UndrivenHost<f64>> = list(0.0, &[mass(&one)]);
        list.with_pendulums(&[Some(parameters)]).unwrap_err().field
    };
    let far = Parameters { contact_distance: one.common[3], ..parameters(&one, 0.0) };
    assert_eq!(refused(far), "absorber.0.clearance");
    let printed = iva_core::piva::ImpactLaw::Printed;
    let printed = Parameters { impact_law: printed, ..parameters(&one, 0.0) };
    assert_eq!(refused(printed), "absorber.0.impact_law");
    let heavy = Parameters { inertia_ratio: 0.5, ..parameters(&one, 0.0) };
    assert_eq!(refused(heavy), "absorber.0.inertia_ratio");
    let system: List<UndrivenHost<f64>> = mixed(&[one, one], 0.0);
    one.start = [1.5, 0.0];
    let error = system.check_start(&start([1.0, 0.0], &[one, one])).unwrap_err();
    assert_eq!(error.field, "start.0.gap_displacement");
}
