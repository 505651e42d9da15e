//! Periodic orbits of several members, and on several modes: derivatives against differences, the product of the multipliers against its exact
//! value; exponents, neighbourhoods and diagrams against the orbits.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iva_core::{
    absorber::{
        Absorber, Clock, Wall,
        modal::{FEW, FewModes, ModalStart, ModalStructure, PRIMARY, Tie},
    },
    flight::GapPoint,
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    observe::Events,
    orbit::{
        Coordinates, Cycle, Trajectory,
        attractors::{Search, attractors},
        basins::{Ending, basins},
        description::describe,
        diagram::{Direction, diagram},
        lyapunov::{Window, lyapunov},
        map,
        multipliers::Complex,
        neighbourhood::neighbourhoods,
        periodic::{Orbit, find},
        spectrum::spectrum,
    },
    piva::Parameters,
    propagation::{Derivative, Tangents},
    simulate::{Instant, Limits, Outcome, resume},
    siva::FreeMass,
};
use iva_tests::rng::Rng;
use nalgebra::{DMatrix, DVector};

type System = FewModes<DrivenHost>;

/// What the systems of a test have beside plain masses.
const KINDS: [&str; 7] =
    ["two masses", "tied mass", "pendulum", "friction", "two modes", "stop", "three masses"];

/// A system of this kind under F cos Ωτ, and the period of its drive.
fn system(kind: usize, rng: &mut Rng) -> (System, f64) {
    let frequency = rng.range(0.7, 1.4);
    let amplitude = rng.range(0.3, 1.0);
    let harmonic = Harmonic { amplitude, frequency, phase: 0.0, acts: Acts::Primary };
    let (e, d) = (rng.range(0.2, 0.8), rng.range(0.3, 0.8));
    let mass = |rng: &mut Rng| {
        FreeMass::new(rng.range(0.05, 0.2), rng.range(0.2, 0.8), rng.range(0.3, 1.0)).unwrap()
    };
    let hung = Parameters {
        frequency_ratio: rng.range(0.3, 1.2),
        ..Parameters::point_bob(0.1, e, d, 0.0, d * rng.range(1.5, 4.0))
    };
    let one = ModalStructure::moving_as_one(0.03).unwrap();
    let two = || {
        let modes = ModalStructure::new(&[1.0, 2.3 + 0.3 * frequency], &[0.03, 0.02]).unwrap();
        let modes = modes.with_point("top", &[1.0, 0.7]).unwrap();
        modes.with_point("middle", &[0.6, -0.8]).unwrap()
    };
    let [first, second, third] = [(); 3].map(|()| mass(rng));
    let (structure, members, seen): (_, Vec<(FreeMass, &str)>, _) = match KINDS[kind] {
        "two modes" => (two(), vec![(first, "top"), (second, "middle")], "top"),
        "stop" => {
            let stop = FreeMass::on_ground(e, d).unwrap();
            (one, vec![(first, PRIMARY), (stop, PRIMARY)], PRIMARY)
        }
        "three masses" => (one, [first, second, third].map(|it| (it, PRIMARY)).to_vec(), PRIMARY),
        "pendulum" => {
            let pendulum = FreeMass::new(0.1, e, d).unwrap();
            (one, vec![(first, PRIMARY), (pendulum, PRIMARY)], PRIMARY)
        }
        _ => (one, vec![(first, PRIMARY), (second, PRIMARY)], PRIMARY),
    };
    let count = members.len();
    let of_second = |value: f64, is: &str| {
        let own = if KINDS[kind] == is { value } else { 0.0 };
        (0..count).map(|k| if k == 1 { own } else { 0.0 }).collect::<Vec<_>>()
    };
    let (springs, dashpots) = (of_second(0.03, "tied mass"), of_second(0.01, "tied mass"));
    let tie = |(spring, damping): (&f64, &f64)| Tie { spring: *spring, damping: *damping };
    let ties: Vec<_> = springs.iter().zip(&dashpots).map(tie).collect();
    let swings = |k: usize| (KINDS[kind] == "pendulum" && k == 1).then_some(hung);
    let pendulums: Vec<_> = (0..count).map(swings).collect();
    let system = FewModes::with_room(structure, &members).unwrap().seen_at(seen).unwrap();
    let system = system.with_pendulums(&pendulums).unwrap().with_ties(&ties).unwrap();
    let system = system.with_gravity(&vec![0.0; count]).unwrap();
    let system = system.with_friction(&of_second(0.1, "friction")).unwrap();
    let system = system.with_static_friction(&of_second(0.16, "friction")).unwrap();
    (system.under(Force::harmonic(vec![harmonic]).unwrap(), seen).unwrap(), TAU / frequency)
}

/// What a run over a time from a point at time zero comes to: the point at its end, its derivative, and who meets which wall in
/// which order.
struct Ran {
    end: DVector<f64>,
    derivative: DMatrix<f64>,
    met: Vec<(u8, Wall)>,
    rides: usize,
}

fn run(system: &System, point: &DVector<f64>, time: f64) -> Option<Ran> {
    let from = Instant::at(system, &system.start_of(point)?, 0.0);
    let mut seen = (Events::default(), Tangents::default());
    let limits = Limits::new(time, system.clearance());
    let tally = resume(system, &from, &limits, None, &mut seen).unwrap();
    let (Events { impacts, episodes }, mut tangents) = seen;
    let met = impacts.iter().map(|it| (it.absorber, it.wall)).collect();
    let end = system.point(&tally.state);
    let derivative = tangents.factor(system);
    let rides = episodes.len();
    (tally.outcome == Outcome::Finished).then_some(Ran { end, derivative, met, rides })
}

/// Central differences of runs with the same impacts and rides.
#[test]
fn derivatives_are_those_of_differences() {
    let mut rng = Rng::new(11);
    let (mut worst, mut compared, mut rides) = ([0.0_f64; 7], [0; 7], 0);
    for _ in 0..6 {
        for kind in 0..KINDS.len() {
            let (system, period) = system(kind, &mut rng);
            let at = system.point(&system.begin(&start(&system, &mut rng)));
            assert_eq!(at.len(), system.dimension(), "{}", KINDS[kind]);
            let Some(ran) = run(&system, &at, 1.3 * period) else { continue };
            rides += ran.rides;
            for column in 0..at.len() {
                let moved = |by: f64| {
                    let mut beside = at.clone();
                    beside[column] += by;
                    let moved = run(&system, &beside, 1.3 * period)?;
                    let alike = moved.met == ran.met && moved.rides == ran.rides;
                    alike.then_some(moved.end)
                };
                let (tangent, size) = (&ran.derivative, ran.derivative.amax().max(1.0));
                let off = |step: f64| {
                    let slope = (moved(step)? - moved(-step)?) / (2.0 * step);
                    Some((slope - tangent.column(column)).amax() / size.powi(2))
                };
                // Where an impact is slow a small difference is better, elsewhere a larger one.
                let Some(least) = [1e-6, 1e-7, 1e-8].into_iter().filter_map(off).reduce(f64::min)
                else {
                    continue;
                };
                // What is summed of a chatter counts as stuck, for a pendulum to first order in its length of some 1e-6.
                let rests = KINDS[kind] == "pendulum" && ran.rides > 0;
                let least = if rests { 0.01 * least } else { least };
                worst[kind] = worst[kind].max(least);
                compared[kind] += 1;
            }
        }
    }
    assert!(rides > 5 && compared.iter().all(|count| *count > 20), "{rides} {compared:?}");
    assert!(worst.iter().all(|off| *off < 1e-8), "{worst:?}");
}

/// A start in all gaps; of a stop on the ground the structure is within its walls.
fn start(system: &System, rng: &mut Rng) -> ModalStart<f64, FEW, FEW> {
    let mut within = |size: f64| size * rng.range(-1.0, 1.0);
    let q = [within(0.2), 0.1 * within(1.0)];
    let rates = [within(1.0), within(0.2)];
    let modes = system.structure().count();
    let gaps = std::array::from_fn(|_| GapPoint { y: within(0.2), w: within(1.0) });
    ModalStart::new(&q[..modes], &rates[..modes], gaps).unwrap()
}

/// The orbit that a run of a kind settles on, if that is one.
fn settled(kind: usize, rng: &mut Rng) -> Option<Orbit<System>> {
    let (system, period) = system(kind, rng);
    let start = start(&system, rng);
    let cycle = Cycle { begin: 0.0, length: period };
    let mut trajectory = Trajectory::new(system, &start, cycle).unwrap();
    for _ in 0..200 {
        trajectory.state = map(&trajectory, false, None).unwrap().state;
    }
    (1..=3).find_map(|periods| {
        let cycle = Cycle { length: period * f64::from(periods), ..cycle };
        find(&Trajectory { cycle, ..trajectory.clone() }, false, None).ok()
    })
}

/// e² of each impact, and what the dampers take; with a ride two multipliers of who rides are 0. A run comes back to the point.
#[test]
fn orbits_have_the_known_product_of_their_multipliers() {
    let mut rng = Rng::new(5);
    let (mut found, mut known, mut worst) = ([0; 7], 0, 0.0_f64);
    for _ in 0..4 {
        for (kind, found) in found.iter_mut().enumerate() {
            let Some(orbit) = settled(kind, &mut rng) else { continue };
            *found += 1;
            let system = &orbit.trajectory.system;
            let description = describe(&orbit, None).unwrap();
            let spectrum = spectrum(&orbit, &description, None).unwrap();
            assert_eq!(spectrum.multipliers.len(), system.dimension());
            assert!(orbit.residual < 1e-10, "{}: {:e}", KINDS[kind], orbit.residual);
            assert!(description.amplitude.is_some_and(|it| it > 0.0));
            let rest = &spectrum.multipliers[spectrum.rank..];
            assert!(rest.iter().all(|it| it.norm() == 0.0));
            if let Some(error) = spectrum.determinant_error {
                known += 1;
                worst = worst.max(error.abs());
            }
            let cycle = orbit.trajectory.cycle;
            let at = system.point(&orbit.trajectory.state);
            let later = system.begin_at(&system.start_of(&at).unwrap(), Clock::new(cycle.begin));
            assert!((system.point(&later) - &at).amax() < 1e-14 * at.amax().max(1.0));
        }
    }
    assert!(found.iter().sum::<i32>() > 8 && known > 3, "{found:?} {known}");
    assert!(worst < 1e-12, "{worst:e}");
}

/// On a stable orbit they are ln |λ| over the time of its cycle, −∞ where λ is 0; their sum is exact where no one rides.
#[test]
fn exponents_are_the_logarithms_of_multipliers() {
    let mut rng = Rng::new(5);
    let (mut compared, mut lost, mut summed) = (0, 0, 0);
    for (kind, name) in KINDS.iter().enumerate() {
        let Some(orbit) = settled(kind, &mut rng).filter(Orbit::is_stable) else { continue };
        let description = describe(&orbit, None).unwrap();
        let known = spectrum(&orbit, &description, None).unwrap();
        let length = orbit.trajectory.cycle.length;
        let window = Window { discard: 60, keep: 32 };
        let found = lyapunov(&[orbit.trajectory], window, None).unwrap();
        assert_eq!(found.exponents.len(), known.multipliers.len());
        for (exponent, multiplier) in found.exponents.iter().zip(&known.multipliers) {
            let truth = multiplier.norm().ln() / length;
            lost += usize::from(truth == f64::NEG_INFINITY);
            // Of a pair, and of others of like size, directions turn: the mean over so many cycles is off by a bounded share of one.
            let size = multiplier.norm();
            let like_size = |it: &&Complex<f64>| it.norm() < 2.0 * size && size < 2.0 * it.norm();
            let turns = known.multipliers.iter().filter(like_size).count() > 1;
            let near = 2e-6 + if turns { 3.0 / (32.0 * length) } else { 0.0 };
            let like = *exponent == truth || (exponent - truth).abs() < near;
            assert!(like, "{}: {:?} {:?}", name, found.exponents, known.multipliers);
            compared += 1;
        }
        if let Some(error) = found.sum_error {
            summed += 1;
            assert!(error.abs() < 1e-12, "{}: {error:e}", name);
        }
    }
    assert!(compared > 15 && lost > 0, "{compared} {lost} {summed}");
}

/// Starts end where a run of many cycles is; a diagram without a change of the scene has the strobes of the map.
#[test]
fn starts_end_where_their_runs_do() {
    let mut rng = Rng::new(21);
    let (mut decided, mut tried) = ([0; 7], 0);
    for kind in [0, 1, 3, 4, 5] {
        let (system, length) = system(kind, &mut rng);
        let cycle = Cycle { begin: 0.0, length };
        let begun =
            |rng: &mut Rng| Trajectory::new(system.clone(), &start(&system, rng), cycle).unwrap();
        let all: Vec<_> = (0..6).map(|_| begun(&mut rng)).collect();
        let search = Search { most_periods: 4, most_cycles: 150, join_mirrored: false };
        let found = attractors(&all, search, None).unwrap();
        let near = neighbourhoods(&all[0], &found.attractors, None);
        let cells = basins(&all, &near, 150, None).unwrap();
        for (trajectory, cell) in all.iter().zip(&cells) {
            tried += 1;
            let Ending::Attractor(index) = cell.ending else { continue };
            let mut at = trajectory.clone();
            for _ in 0..300 {
                at.state = map(&at, false, None).unwrap().state;
            }
            let strobe = system.strobe(&at.state);
            let near = found.attractors[index].is_near(&strobe, system.clearance());
            assert!(near || !cell.is_sure(), "{}", KINDS[kind]);
            decided[kind] += 1;
        }
        let window = Window { discard: 1, keep: 2 };
        let same = [all[0].clone(), all[0].clone()];
        let columns = diagram(&same, Direction::Up, window, None, None).unwrap();
        let mut at = all[0].clone();
        for column in &columns {
            at.state = map(&at, false, None).unwrap().state;
            for strobe in &column.strobes {
                at.state = map(&at, false, None).unwrap().state;
                assert_eq!(strobe.at, system.strobe(&at.state));
            }
            // The next value begins from the numbers of the last state.
            let again = system.start_at_strobe(&system.strobe(&at.state)).unwrap();
            at = Trajectory::new(system.clone(), &again, cycle).unwrap();
        }
    }
    assert!(decided.iter().sum::<i32>() > 12, "{decided:?} of {tried}");
}
