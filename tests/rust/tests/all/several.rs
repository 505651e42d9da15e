//! Several free masses on one structure.
//!
//! Numbers come from closed forms (one mass is the free mass of old, equal masses in one phase are one mass, two that
//! mirror each other leave the structure at rest), from momentum and energy, from the mirror image of a scene, and from
//! runs in numbers of twice the precision.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;

use iva_core::{
    absorber::modal::{self, FewModes, Modal, ModalStart, ModalStructure, PRIMARY},
    absorber::{Absorber, ImpactLaw, OnStructure, Point, Start},
    extremes::Extremes,
    flight::GapPoint,
    force::{Acts, Force, Harmonic, History, Impulse, Record},
    host::Host,
    impact::Impact,
    measures::Wanted,
    observe::Events,
    real::{Real, twofold::Twofold},
    run::{Run, run},
    sample::Sampler,
    simulate::{Limits, Outcome, resume, simulate},
    siva::{FreeMass, Siva},
    steady::{Steady, SteadyWanted, Window},
    summary::Summary,
};
use iva_tests::list::{List, Starts, begun, driven, list};
use iva_tests::rng::Rng;

/// Parameters of a mass and its start: μ, e, d, offset, y and w.
type Mass = [f64; 6];

/// A random mass in a gap.
fn any_mass(rng: &mut Rng) -> Mass {
    let d = rng.range(0.2, 1.5);
    let offset = rng.range(-0.2, 0.2);
    let y = offset + d * rng.range(-0.9, 0.9);
    [rng.log_range(0.02, 1.0), rng.range(0.2, 0.95), d, offset, y, rng.range(-0.5, 0.5)]
}

fn built<R: Real>([mu, e, d, offset, ..]: Mass) -> FreeMass<R> {
    let mass = FreeMass::new(mu.into(), e.into(), d.into()).unwrap();
    mass.with_offset(offset.into()).unwrap()
}

fn start<R: Real, const N: usize>([x, v]: [f64; 2], masses: &[Mass; N]) -> Starts<R> {
    let gaps = masses.map(|[.., y, w]| GapPoint { y: y.into(), w: w.into() });
    begun(Point { x: x.into(), v: v.into() }, &gaps)
}

fn push<R: Real>(amplitude: f64, frequency: f64, acts: Acts) -> Force<R> {
    let [amplitude, frequency, phase] = [amplitude, frequency, 0.3].map(R::from);
    Force::harmonic(vec![Harmonic { amplitude, frequency, phase, acts }]).unwrap()
}

fn limits<R: Real>(duration: f64) -> Limits<R> {
    Limits::new(duration.into(), R::from(0.3))
}

/// An impact: the index of its absorber, and numbers.
type Row = (u8, [f64; 6]);

/// The impacts of all absorbers in doubles: index, time, wall, velocities before and after.
fn rows<R: Real>(impacts: &[Impact<R>]) -> Vec<Row> {
    let row = |it: &Impact<R>| {
        let numbers = [it.time, it.velocity_before, it.velocity_after];
        let [time, before, after] = numbers.map(Real::double);
        let [w, to] = [it.gap_velocity_before, it.gap_velocity_after].map(Real::double);
        (it.absorber, [time, it.wall.sign(), before, after, w, to])
    };
    impacts.iter().map(row).collect()
}

fn furthest(a: &[Row], b: &[Row]) -> f64 {
    assert_eq!(a.len(), b.len(), "as many impacts");
    let off = |(a, b): (&Row, &Row)| (0..6).map(|k| (a.1[k] - b.1[k]).abs()).fold(0.0, f64::max);
    a.iter().zip(b).map(off).fold(0.0, f64::max)
}

/// In numbers of twice the precision, which leave nothing of conditioning: one mass in a list is the free mass itself, with
/// chatter and sticks, with and without force.
#[test]
fn one_of_several_is_the_free_mass() {
    let mut rng = Rng::new(5);
    let [mut impacts, mut episodes] = [0, 0];
    for k in 0..24 {
        let masses = [any_mass(&mut rng)];
        let at = [rng.range(-2.0, 2.0), rng.range(-1.0, 1.0)];
        let zeta = rng.range(0.0, 0.1);
        let listed = list(Twofold::from(zeta), &masses.map(built));
        let [mu, e, d, offset, y, w] = masses[0];
        let n = Twofold::from;
        let siva = Siva::new(n(mu), n(e), n(d), n(zeta)).unwrap().with_offset(n(offset)).unwrap();
        let [displacement, velocity, gap_displacement, gap_velocity] = [at[0], at[1], y, w].map(n);
        let alone = Start { displacement, velocity, gap_displacement, gap_velocity };
        let (starts, limits) = (start(at, &masses), limits::<Twofold>(15.0));
        let acts = if k % 4 == 0 { Acts::Base } else { Acts::Primary };
        let force = || push::<Twofold>(0.4, 0.9, acts);
        let [a, b] = if k % 2 == 0 {
            [told(run(&listed, &starts, &limits)), told(run(&siva, &alone, &limits))]
        } else {
            let listed = driven(&listed, force());
            let siva = siva.under(force());
            [told(run(&listed, &starts, &limits)), told(run(&siva, &alone, &limits))]
        };
        let off = furthest(&a.0, &b.0);
        assert!(off < 1e-13, "scene {k}: impacts {off:e}");
        assert_eq!(a.1.len(), b.1.len(), "scene {k}: episodes");
        for (one, other) in a.1.iter().zip(&b.1) {
            let off = (one - other).abs();
            assert!(off < 1e-13, "scene {k}: {one} is {other} alone");
        }
        assert!((a.2 - b.2).abs() < 1e-12, "scene {k}: work {} and {}", a.2, b.2);
        (impacts, episodes) = (impacts + a.0.len(), episodes + a.1.len());
    }
    assert!(impacts > 100 && episodes > 8, "{impacts} impacts, {episodes} episodes");
}

/// Rows of impacts, instants of stick episodes, and the work of the drive.
type Told = (Vec<Row>, Vec<f64>, f64);

fn told<S, R: Real>(run: Result<Run<S, R>, iva_core::error::Invalid>) -> Told {
    let Run { tally, impacts, episodes, measures, .. } = run.unwrap();
    assert_eq!(tally.outcome, Outcome::Finished);
    let instants = episodes.iter().flat_map(|episode| {
        let release = episode.release_time.unwrap_or(R::ZERO);
        [episode.start_time, episode.stick_time, release].map(Real::double)
    });
    (rows(&impacts), instants.collect(), measures.energy_work.double())
}

/// Momentum and energy of every event, in random scenes of 2 to 5 masses; no mass leaves its gap.
#[test]
fn momentum_and_energy_hold() {
    let mut rng = Rng::new(11);
    let mut episodes = 0;
    let mut counted = [0; 5];
    for k in 0..60 {
        let masses: [Mass; 5] = std::array::from_fn(|_| any_mass(&mut rng));
        let at = [rng.range(0.5, 2.0), rng.range(-1.0, 1.0)];
        let zeta = if k % 3 == 0 { 0.0 } else { rng.range(0.0, 0.05) };
        let told = match k % 4 {
            0 => held(&list(zeta, &[masses[0], masses[1]].map(built)), at, &[masses[0], masses[1]]),
            1 => {
                let three = [masses[0], masses[1], masses[2]];
                held(&list(zeta, &three.map(built)), at, &three)
            }
            2 => held(&list(zeta, &masses.map(built)), at, &masses),
            _ => {
                let acts = if k % 8 == 3 { Acts::Base } else { Acts::Primary };
                let system = list(zeta, &masses.map(built));
                held(&driven(&system, push(0.5, 1.05, acts)), at, &masses)
            }
        };
        episodes += told.0;
        for (sum, more) in counted.iter_mut().zip(told.1) {
            *sum += more;
        }
    }
    assert!(episodes > 60 && counted.iter().all(|count| *count > 100), "{episodes} {counted:?}");
}

fn held<H: Host<Real = f64>, const N: usize>(
    system: &List<H>,
    at: [f64; 2],
    masses: &[Mass; N],
) -> (usize, [usize; 5]) {
    let run = run(system, &start(at, masses), &limits(40.0)).unwrap();
    assert_eq!(run.tally.outcome, Outcome::Finished);
    assert!(run.measures.energy_residual.abs() < 1e-12, "{:e}", run.measures.energy_residual);
    let mut counted = [0; 5];
    for impact in &run.impacts {
        let e = masses[usize::from(impact.absorber)][1];
        let (w, after) = (impact.gap_velocity_before, impact.gap_velocity_after);
        assert!(w * impact.wall.sign() > 0.0 && (after + e * w).abs() <= 1e-15 * w.abs());
        counted[usize::from(impact.absorber)] += 1;
    }
    assert!(run.impacts.windows(2).all(|two| two[0].time <= two[1].time), "in order of time");
    let lost: f64 = run.impacts.iter().map(|impact| impact.energy_loss).sum();
    assert!((lost - run.tally.energy_impacts).abs() < 1e-6 * (1.0 + lost), "{lost}");
    for (gap, [_, _, d, offset, ..]) in system.gaps(&run.tally.state).into_iter().zip(masses) {
        assert!((gap.y - offset).abs() <= *d);
    }
    (run.episodes.len(), counted)
}

/// Of two impacts at one instant each loses the work of its own impulse: an elastic one nothing, whatever the other does.
#[test]
fn each_impact_loses_the_work_of_its_own_impulse() {
    let mut rng = Rng::new(101);
    for _ in 0..50 {
        let speeds = [rng.range(0.1, 1.0), rng.range(0.1, 1.0)];
        let touching = |k: usize, e: f64| -> Mass { [[0.3, 0.8][k], e, 1.0, 0.0, 1.0, speeds[k]] };
        let masses = [touching(0, 1.0), touching(1, rng.range(0.0, 0.9))];
        let system = list(0.0, &masses.map(built));
        let before = system.begin(&start([0.2, rng.range(-1.0, 1.0)], &masses));
        let of = |k: usize| system.impact(&system.turned_to(&before, k), 0.0);
        let [(after, elastic), (_, other)] = [of(0), of(1)];
        assert_eq!(elastic.energy_loss, 0.0);
        let lost = system.energy(&before) - system.energy(&after);
        assert!((lost - other.energy_loss).abs() < 1e-14, "{lost} {}", other.energy_loss);
    }
}

/// Energy under all that can drive a structure at once: a force, a record on a moving base, and impulses, which come while
/// masses fly and while some are stuck.
#[test]
fn energy_holds_under_records_and_impulses() {
    let mut rng = Rng::new(71);
    let mut episodes = 0;
    for _ in 0..30 {
        let masses: [Mass; 3] = std::array::from_fn(|_| any_mass(&mut rng));
        let times: Vec<f64> = (0..8).map(|k| 2.0 + 1.5 * f64::from(k)).collect();
        let values = times.iter().map(|_| rng.range(-1.0, 1.0)).collect();
        let history = Arc::new(History::new(times, values).unwrap());
        let record = Record { history, acts: Acts::Base, rate: 1.0, scale: 0.5 };
        let kick = |time| Impulse { velocity: rng.range(-1.0, 1.0), time };
        let kicks: Vec<Impulse> = [1.0, 4.0, 9.0, 16.0].map(kick).to_vec();
        let harmonics = push::<f64>(0.3, 1.2, Acts::Primary).harmonics().to_vec();
        let force = Force::new(harmonics, vec![record], &kicks).unwrap();
        let system = driven(&list(0.02, &masses.map(built)), force);
        episodes += held(&system, [1.0, 0.0], &masses).0;
    }
    assert!(episodes > 20, "{episodes} episodes");
}

/// A run that is divided at any instant, also while masses are stuck or in a chatter, ends as the whole one.
#[test]
fn a_divided_run_goes_on() {
    let mut rng = Rng::new(83);
    let mut stuck = 0;
    for _ in 0..24 {
        let masses: [Mass; 3] = std::array::from_fn(|_| any_mass(&mut rng));
        let system = list(Twofold::from(0.02), &masses.map(built));
        let start = start([1.5, 0.0], &masses);
        let whole = simulate(&system, &start, &limits(14.0), None, &mut ()).unwrap();
        let middle: f64 = rng.range(2.0, 12.0);
        let first = simulate(&system, &start, &limits(middle), None, &mut ()).unwrap();
        stuck += usize::from((0..3).any(|k| system.is_stuck(&system.turned_to(&first.state, k))));
        let second = resume(&system, &first.instant(), &limits(14.0), None, &mut ()).unwrap();
        assert_eq!(whole.impacts, first.impacts + second.impacts);
        for (a, b) in system.gaps(&whole.state).into_iter().zip(system.gaps(&second.state)) {
            let off = [a.y - b.y, a.w - b.w].map(|it| f64::from(it).abs());
            assert!(off[0].max(off[1]) < 1e-13, "{middle}: {off:?}");
        }
    }
    assert!(stuck > 0, "{stuck} divided while a mass was stuck");
}

/// The impacts in the window of the steady state are those that are listed, also where low rebounds of a chatter turn out
/// not to be, while other masses have impacts.
#[test]
fn impacts_per_cycle_are_those_listed() {
    let mut rng = Rng::new(97);
    let mut unlisted = 0;
    for _ in 0..40 {
        let masses: [Mass; 3] = std::array::from_fn(|_| {
            let [mu, e, d, offset, y, w] = any_mass(&mut rng);
            [mu, 0.6 * e, d, offset, y, w]
        });
        let force = push::<f64>(0.4, 0.8, Acts::Primary);
        let harmonic = force.harmonics()[0];
        let system = driven(&list(0.03, &masses.map(built)), force);
        let from = 10.0;
        let window = Window { from, cycle: Some(harmonic) };
        let wanted = SteadyWanted { impacts: true, ..SteadyWanted::default() };
        let limits = Limits { chatter_floor: 0.05, ..limits(60.0) };
        let mut seen = (Steady::new(window, wanted), Events::default());
        simulate(&system, &start([0.5, 0.0], &masses), &limits, None, &mut seen).unwrap();
        let (steady, events) = seen;
        let listed = events.impacts.iter().filter(|it| it.time >= from).count();
        let cycles = 0.8 * (60.0 - from) / std::f64::consts::TAU;
        let counted = steady.values().impacts_per_cycle.unwrap() * cycles;
        assert!((counted - listed as f64).abs() < 1e-9, "{counted} of {listed}");
        unlisted += events.episodes.len();
    }
    assert!(unlisted > 40, "{unlisted} episodes");
}

/// The mirror image of a scene has the mirror image of its events, to the bit.
#[test]
fn a_mirrored_scene_is_mirrored_to_the_bit() {
    let mut rng = Rng::new(23);
    for _ in 0..40 {
        let masses: [Mass; 3] = std::array::from_fn(|_| any_mass(&mut rng));
        let at = [rng.range(-2.0, 2.0), rng.range(-1.0, 1.0)];
        let image = masses.map(|[mu, e, d, offset, y, w]| [mu, e, d, -offset, -y, -w]);
        let system = |masses: [Mass; 3]| list(0.01, &masses.map(built));
        let one = run(&system(masses), &start(at, &masses), &limits(40.0)).unwrap();
        let other = run(&system(image), &start(at.map(|it| -it), &image), &limits(40.0)).unwrap();
        let turned =
            |(index, [time, wall, v, v1, w, w1]): Row| (index, [time, -wall, -v, -v1, -w, -w1]);
        let back: Vec<_> = rows(&other.impacts).into_iter().map(turned).collect();
        assert_eq!(rows(&one.impacts), back);
        assert_eq!(one.episodes.len(), other.episodes.len());
    }
}

/// Two equal masses that mirror each other leave a structure at rest where it is: their impacts come at once, and each is
/// that on a wall that does not move. With restitution e the n-th comes after d/w (1 + 2 (1/e + … + 1/eⁿ⁻¹)).
#[test]
fn two_that_mirror_each_other_leave_the_structure_at_rest() {
    let (mu, e, d, w) = (0.3, 0.8, 0.5, 0.7);
    let masses = [[mu, e, d, 0.0, 0.0, w], [mu, e, d, 0.0, 0.0, -w]];
    let system = list(0.02, &masses.map(built));
    let run = run(&system, &start([0.0, 0.0], &masses), &limits(30.0)).unwrap();
    let mut expected = d / w;
    let mut crossing = 2.0 * d / w;
    assert!(run.impacts.len() >= 16 && run.impacts.len() % 2 == 0, "{}", run.impacts.len());
    for pair in run.impacts.chunks(2) {
        assert_eq!((pair[0].absorber, pair[1].absorber), (0, 1));
        assert_eq!(pair[0].wall, pair[1].wall.opposite());
        assert_eq!(pair[0].time, pair[1].time);
        let all = [pair[0].displacement, pair[0].velocity_before, pair[0].velocity_after];
        // The impulses of the two are no more apart than rounding in twice the precision.
        assert!(all.iter().all(|it| it.abs() < 1e-31), "{all:?}");
        assert!((pair[0].time - expected).abs() < 1e-14 * expected, "{}", pair[0].time);
        crossing /= e;
        expected += crossing;
    }
}

/// Equal masses in one phase are one of all their mass, in decays with chatter and sticks and under a force.
#[test]
fn equal_masses_in_one_phase_are_one() {
    let mut rng = Rng::new(31);
    let [mut impacts, mut episodes] = [0, 0];
    for k in 0..12 {
        let [mu, e, d, offset, y, w] = any_mass(&mut rng);
        let e = 0.5 * e;
        // A power of two, so that the masses have the sum.
        let three = [[0.25 * mu, e, d, offset, y, w]; 4];
        let one = [[mu, e, d, offset, y, w]];
        let at = [rng.range(-2.0, 2.0), rng.range(-1.0, 1.0)];
        let zeta = Twofold::from(rng.range(0.0, 0.1));
        let many = list(zeta, &three.map(built));
        let single = list(zeta, &one.map(built));
        let limits = limits(12.0);
        let [many, single] = if k % 2 == 0 {
            [
                told(run(&many, &start(at, &three), &limits)),
                told(run(&single, &start(at, &one), &limits)),
            ]
        } else {
            let force = || push::<Twofold>(0.4, 1.1, Acts::Primary);
            [
                told(run(&driven(&many, force()), &start(at, &three), &limits)),
                told(run(&driven(&single, force()), &start(at, &one), &limits)),
            ]
        };
        for index in 0..4 {
            let of = many.0.iter().filter(|(absorber, _)| *absorber == index).copied();
            let rows: Vec<_> = of.map(|(_, row)| (0, row)).collect();
            let off = furthest(&rows, &single.0);
            assert!(off < 1e-12, "scene {k}: {off:e}");
        }
        assert_eq!(many.1.len(), 4 * single.1.len(), "scene {k}: episodes");
        impacts += single.0.len();
        episodes += single.1.len() / 3;
    }
    assert!(impacts > 40 && episodes > 2, "{impacts} impacts, {episodes} episodes");
}

/// A mass that never meets its walls changes no bit of the other's run.
#[test]
fn one_far_from_its_walls_changes_nothing() {
    let mut rng = Rng::new(43);
    for _ in 0..60 {
        let mass = any_mass(&mut rng);
        let at = [rng.range(-2.0, 2.0), rng.range(-1.0, 1.0)];
        let both = [mass, [0.4, 0.7, 1e4, 0.0, 3.0, 0.1]];
        let pair = list(0.02, &both.map(built));
        let alone = list(0.02, &[mass].map(built));
        let pair = run(&pair, &start(at, &both), &limits(40.0)).unwrap();
        let alone = run(&alone, &start(at, &[mass]), &limits(40.0)).unwrap();
        assert_eq!(rows(&pair.impacts), rows(&alone.impacts));
        assert_eq!(pair.episodes, alone.episodes);
    }
}

/// A stuck mass is carried by an impact that pushes its wall against it, and left behind by one that pulls it away:
/// Δv = μ (1 + e) w over 1 + μ, and over 1 + μ and the mass carried.
#[test]
fn a_stuck_mass_is_carried_or_left_behind() {
    // With x > 0 the structure is pulled back, so that the first mass presses on its wall + and sticks there at once. The
    // second one flies against the wall + or −.
    for wall in [1.0, -1.0] {
        let (mu, e, d) = (0.2, 0.5, 0.4);
        let masses = [[0.3, 0.6, 1.0, 0.0, 1.0, 0.0], [mu, e, d, 0.0, 0.0, wall * 2.0]];
        let system = list(0.0, &masses.map(built));
        let run = run(&system, &start([1.0, 0.0], &masses), &limits(1.0)).unwrap();
        let impact = run.impacts.iter().find(|impact| impact.absorber == 1).unwrap();
        let left = run.episodes.iter().find(|episode| episode.absorber == 0).unwrap();
        let wall_of_first = left.wall.sign();
        let away = wall_of_first * impact.wall.sign() > 0.0;
        let together = 1.0 + mu + if away { 0.0 } else { 0.3 };
        let gained = mu * (1.0 + e) * impact.gap_velocity_before / together;
        let seen = impact.velocity_after - impact.velocity_before;
        assert!((seen - gained).abs() < 1e-15, "{seen} {gained}");
        let released = left.release_time == Some(impact.time);
        assert_eq!(released, away, "{left:?}");
    }
}

/// In doubles, runs agree with those in numbers of twice the precision as far as conditioning allows: over short times.
#[test]
fn doubles_agree_with_twice_the_precision() {
    let mut rng = Rng::new(57);
    let mut worst: f64 = 0.0;
    for _ in 0..12 {
        let masses: [Mass; 4] = std::array::from_fn(|_| any_mass(&mut rng));
        let at = [rng.range(-2.0, 2.0), rng.range(-1.0, 1.0)];
        let plain = list(0.01, &masses.map(built));
        let precise = list(Twofold::from(0.01), &masses.map(built));
        let plain = run(&plain, &start(at, &masses), &limits(12.0)).unwrap();
        let precise = run(&precise, &start(at, &masses), &limits(12.0)).unwrap();
        let [plain, precise] = [rows(&plain.impacts), rows(&precise.impacts)];
        for (a, b) in plain.iter().zip(&precise).take(12) {
            assert_eq!(a.0, b.0);
            worst = worst.max((a.1[0] - b.1[0]).abs());
        }
    }
    assert!(worst < 1e-11, "{worst:e}");
}

/// A start beyond a wall is refused with the absorber's number, and so is a list that is too long.
#[test]
fn a_bad_list_is_refused() {
    let masses = [[0.1, 0.5, 0.4, 0.0, 0.0, 0.0], [0.1, 0.5, 0.4, 0.0, 0.5, 0.0]];
    let system = list(0.0, &masses.map(built::<f64>));
    let error = system.check_start(&start([1.0, 0.0], &masses)).unwrap_err().to_string();
    assert!(error.contains("start.1.gap_displacement"), "{error}");
    assert!((system.mass_ratio() - 0.2).abs() < 1e-15);
    let too_many = [(built::<f64>(masses[0]), PRIMARY); modal::MOST + 1];
    let structure = ModalStructure::moving_as_one(0.0).unwrap();
    let error = Modal::of(structure, &too_many).unwrap_err().to_string();
    assert!(error.contains("give from 1 to 64 absorbers"), "{error}");
}

/// A list with room for more masses than it has makes the same run to the bit, and tells of each mass what its events say.
#[test]
fn a_list_of_any_length_is_the_same_run() {
    let mut rng = Rng::new(59);
    let mut episodes = 0;
    for k in 0..40 {
        let masses: [Mass; 3] = std::array::from_fn(|_| any_mass(&mut rng));
        let at = [rng.range(0.5, 2.0), rng.range(-1.0, 1.0)];
        let structure = ModalStructure::moving_as_one(0.02).unwrap();
        let exact = masses.map(|mass| (built::<f64>(mass), PRIMARY));
        let exact = FewModes::with_room(structure, &exact).unwrap();
        let room = list(0.02, &masses.map(built::<f64>));
        let (wide, limits) = (start(at, &masses), limits(25.0));
        let unused = GapPoint { y: 0.0, w: 0.0 };
        let gap = |[.., y, w]: &Mass| GapPoint { y: *y, w: *w };
        let gaps = std::array::from_fn(|k| masses.get(k).map_or(unused, gap));
        let starts = ModalStart::new(&[at[0]], &[at[1]], gaps).unwrap();
        let force = || push::<f64>(0.3, 0.9, Acts::Primary);
        if k % 2 == 0 {
            episodes += same(&exact, &starts, &room, &wide, &limits, masses);
        } else {
            let exact = exact.under(force(), PRIMARY).unwrap();
            let room = driven(&room, force());
            episodes += same(&exact, &starts, &room, &wide, &limits, masses);
        }
    }
    assert!(episodes > 8, "{episodes} episodes");
}

/// Compares the runs of two lists of the same masses; returns the number of stick episodes.
fn same<H: Host<Real = f64>, const N: usize>(
    exact: &FewModes<H>,
    start: &ModalStart<f64, 4, 4>,
    room: &List<H>,
    wide: &Starts<f64>,
    limits: &Limits,
    masses: [Mass; N],
) -> usize {
    let one = run(exact, start, limits).unwrap();
    let other = run(room, wide, limits).unwrap();
    assert_eq!(one.impacts, other.impacts);
    assert_eq!(one.episodes, other.episodes);
    assert_eq!(one.measures, other.measures);
    let mut seen = (Summary::<List<H>>::new(Wanted::NONE, None), Sampler::at(vec![3.0, 7.0]));
    let tally = simulate(room, wide, limits, None, &mut seen).unwrap();
    let each = seen.0.absorbers();
    assert_eq!(each.len(), N);
    for (k, of) in each.iter().enumerate() {
        let mine: Vec<_> = one.impacts.iter().filter(|it| usize::from(it.absorber) == k).collect();
        assert_eq!(of.impacts, mine.len() as u64);
        assert_eq!(of.effective_impacts, mine.iter().filter(|it| it.effective()).count() as u64);
        let mut fastest = [0.0_f64; 2];
        let mut impulse = 0.0_f64;
        for it in &mine {
            fastest[it.wall.index()] = fastest[it.wall.index()].max(it.approach_speed());
            let gained = it.absorber_velocity_after() - it.absorber_velocity_before();
            impulse = impulse.max(masses[k][0] * gained.abs());
        }
        assert!(of.approach_speeds[0] >= fastest[0] && of.approach_speeds[1] >= fastest[1]);
        if of.episodes == 0 {
            assert_eq!((of.approach_speeds, of.impulse), (fastest, impulse));
            let lost: f64 = mine.iter().map(|it| it.energy_loss).sum();
            assert!(
                (of.energy_impacts - lost).abs() <= 1e-14 * lost,
                "{} {lost}",
                of.energy_impacts
            );
        }
        let stuck = one.episodes.iter().filter(|it| usize::from(it.absorber) == k);
        assert_eq!(of.episodes, stuck.clone().count() as u64);
        let time: f64 = stuck.map(|it| it.release_time.unwrap_or(25.0) - it.stick_time).sum();
        assert!((of.time_stuck - time).abs() < 1e-13, "{} {time}", of.time_stuck);
    }
    let energy: f64 = each.iter().map(|of| of.energy_impacts).sum();
    assert!((energy - tally.energy_impacts).abs() < 1e-14 * energy.max(1.0));
    assert_eq!(each.iter().map(|of| of.impacts).sum::<u64>(), tally.impacts);
    let fastest = |wall: usize| each.iter().map(|of| of.approach_speeds[wall]).fold(0.0, f64::max);
    assert_eq!(tally.approach_speeds, [fastest(0), fastest(1)]);
    let states = &seen.1.states;
    assert_eq!(states.len(), 2 * N);
    for (k, state) in states.iter().enumerate() {
        assert_eq!(usize::from(state.absorber), k % N);
        let [_, _, d, offset, ..] = masses[k % N];
        assert!((state.gap_displacement - offset).abs() <= d * (1.0 + 1e-15));
        let of = &states[k - k % N];
        assert_eq!((state.time, state.displacement), (of.time, of.displacement));
    }
    one.episodes.len()
}

/// The extremes of each mass are those of dense samples, to the samples' distance.
#[test]
fn the_extremes_are_those_of_each_mass() {
    let mut rng = Rng::new(61);
    for _ in 0..10 {
        let masses: [Mass; 2] = std::array::from_fn(|_| any_mass(&mut rng));
        let at = [rng.range(0.5, 2.0), rng.range(-1.0, 1.0)];
        let pair = list(0.02, &masses.map(built::<f64>));
        let wide = start(at, &masses);
        let times = (0..=20_000).map(|k| f64::from(k) * 1e-3).collect();
        let mut seen = (Extremes::new(0.0), Sampler::with_events(times));
        simulate(&pair, &wide, &limits(20.0), None, &mut seen).unwrap();
        for (k, of) in seen.0.values().iter().enumerate() {
            let mine = seen.1.states.iter().filter(|it| usize::from(it.absorber) == k);
            let gaps = mine.clone().map(|it| it.gap_displacement);
            let [most, least] =
                [gaps.clone().fold(-9.0_f64, f64::max), gaps.clone().fold(9.0_f64, f64::min)];
            let furthest = mine.map(|it| (it.displacement + it.gap_displacement).abs());
            let furthest = furthest.fold(0.0, f64::max);
            let near = |found: Option<f64>, seen: f64| (found.unwrap() - seen).abs() < 1e-5;
            assert!(near(of.stroke, most - least), "{of:?} {most} {least}");
            assert!(near(of.gap_displacement, most.max(-least)), "{of:?} {most} {least}");
            assert!(near(of.absorber_displacement, furthest), "{of:?} {furthest}");
        }
    }
}

/// A force that sets in and ends at once frees a stuck mass in a list of one as it frees the free mass itself.
#[test]
fn a_jump_of_the_force_frees_one_in_a_list() {
    let mut rng = Rng::new(83);
    let mut episodes = 0;
    for k in 0..60 {
        let mut masses = [any_mass(&mut rng)];
        masses[0][1] = rng.range(0.0, 0.4);
        let at = [rng.range(-2.0, 2.0), rng.range(-1.0, 1.0)];
        let n = Twofold::from;
        let listed = list(n(0.02), &masses.map(built));
        let [mu, e, d, offset, y, w] = masses[0];
        let siva = Siva::new(n(mu), n(e), n(d), n(0.02)).unwrap().with_offset(n(offset)).unwrap();
        let step = |from: f64| {
            let times = vec![from, from + 2.5];
            let history = Arc::new(History::new(times, vec![-1.5, 1.5]).unwrap());
            let record = Record { history, acts: Acts::Primary, rate: n(1.0), scale: n(1.0) };
            Force::new(vec![], vec![record], &[]).unwrap()
        };
        let [displacement, velocity, gap_displacement, gap_velocity] = [at[0], at[1], y, w].map(n);
        let alone = Start { displacement, velocity, gap_displacement, gap_velocity };
        let limits = limits::<Twofold>(12.0);
        let from = rng.range(1.0, 5.0);
        let a = told(run(&driven(&listed, step(from)), &start(at, &masses), &limits));
        let b = told(run(&siva.under(step(from)), &alone, &limits));
        assert!(furthest(&a.0, &b.0) < 1e-12, "scene {k}");
        assert_eq!(a.1.len(), b.1.len(), "scene {k}: episodes");
        for (one, other) in a.1.iter().zip(&b.1) {
            assert!((one - other).abs() < 1e-12, "scene {k}: {one} is {other} alone");
        }
        episodes += a.1.len() / 3;
    }
    assert!(episodes > 30, "{episodes} episodes");
}

/// Tables that a system shares with another, as points of a sweep do, change no bit of its run, whatever force and damping the other has. The
/// gaps are so wide that runs without a force coast.
#[test]
fn shared_tables_change_no_bit() {
    let mut rng = Rng::new(107);
    let (mut impacts, mut coasts) = (0, 0);
    for k in 0..16_usize {
        let masses: [Mass; 2] = std::array::from_fn(|_| {
            let [mu, e, ..] = any_mass(&mut rng);
            [mu, e, 1.2, 0.0, 0.0, rng.range(0.2, 0.5)]
        });
        let built = |zeta: f64, amplitude: f64| {
            let harmonic = push::<f64>(amplitude, 0.9, Acts::Primary).harmonics().to_vec();
            let parts = if amplitude == 0.0 { vec![] } else { harmonic };
            driven(&list(zeta, &masses.map(built)), Force::harmonic(parts).unwrap())
        };
        let amplitudes = [[0.0, 0.0], [0.1, 0.0], [0.0, 0.1], [0.1, 0.2]][k % 4];
        let zeta = if (k / 4) % 2 == 0 { 0.02 } else { 0.05 };
        let (start, limits) = (start([0.2, 0.0], &masses), limits(40.0));
        let before = built(0.02, amplitudes[0]);
        run(&before, &start, &limits).unwrap();
        let [own, shared] = [(); 2].map(|()| built(zeta, amplitudes[1]));
        shared.share(&before);
        coasts += usize::from(own.coasts(&own.begin(&start), 40.0).is_some());
        let [own, shared] = [own, shared].map(|system| run(&system, &start, &limits).unwrap());
        assert_eq!(rows(&own.impacts), rows(&shared.impacts), "{k}");
        assert_eq!(own.measures, shared.measures, "{k}");
        impacts += own.impacts.len();
    }
    assert!(impacts > 60 && coasts == 8, "{impacts} {coasts}");
}
