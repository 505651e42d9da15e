//! Stops that stand on the ground: the impact oscillator, and stops beside absorbers on several modes.
//!
//! Numbers come from closed forms (an undamped oscillator between its stops, a point that a force presses on a stop), from the mirror image of a scene, from the
//! ledger of energies, and from runs in numbers of twice the precision.
#![allow(clippy::unwrap_used, clippy::panic)]

use iva_core::{
    absorber::Wall,
    absorber::modal::{Modal, ModalStart, ModalStructure, PRIMARY},
    flight::GapPoint,
    force::Acts,
    host::UndrivenHost,
    real::Real,
    run::run,
    simulate::Limits,
    siva::FreeMass,
};
use iva_tests::composed::{self, Composed, Scenes};
use iva_tests::modal::{POINTS, any_mass, any_structure, built, furthest, push, reals, rows, ties};
use iva_tests::rng::Rng;
use iva_tests::some;

const REST: GapPoint = GapPoint { y: 0.0, w: 0.0 };

/// An oscillator between two stops at ±d.
fn oscillator(e: f64, d: f64) -> Modal<UndrivenHost, 1, 2> {
    let stop = FreeMass::on_ground(e, d).unwrap();
    Modal::with_room(ModalStructure::moving_as_one(0.0).unwrap(), &[(stop, PRIMARY)]).unwrap()
}

/// From one stop to the other with a speed v takes 2 atan(d/v), and each impact leaves e v.
#[test]
fn an_oscillator_between_stops_follows_its_closed_form() {
    for (e, d, v, count) in [(1.0, 0.5, 1.0, 200), (0.8, 0.3, 2.0, 8), (0.97, 1.1, 3.0, 60)] {
        let system = oscillator(e, d);
        let start = ModalStart::new(&[0.0], &[v], [REST]).unwrap();
        let mut speed = (v * v - d * d).sqrt();
        let (mut time, mut side) = ((d / v).asin(), 1.0);
        let run = run(&system, &start, &Limits::new(10_000.0, d)).unwrap();
        let mut compared = 0;
        for impact in run.impacts.iter().take(count) {
            let off = (impact.time - time).abs() / time.max(1.0);
            assert!(off < 4e-15, "{e}: impact {compared} at {time}: {off:e}");
            assert!((impact.displacement - side * d).abs() < 4e-15);
            assert!((impact.velocity_before - side * speed).abs() < 1e-14 * v);
            assert!((impact.velocity_after + side * e * speed).abs() < 1e-14 * v);
            assert!(impact.absorber_velocity_before().abs() < 1e-14 * v);
            let lost = 0.5 * (1.0 - e * e) * speed * speed;
            assert!((impact.energy_loss - lost).abs() < 1e-14 * v * v);
            assert_eq!(impact.wall.sign(), side);
            speed *= e;
            time += 2.0 * (d / speed).atan();
            (side, compared) = (-side, compared + 1);
        }
        assert_eq!(compared, count);
    }
}

/// A force f cos Ωt that presses the point on its stop lets it go where f cos (Ωt + 0.3) = d, without damping.
#[test]
fn a_point_stays_on_its_stop_while_a_force_presses() {
    for e in [0.0, 0.4] {
        let (d, f, omega) = (0.2, 1.7, 0.05);
        let driven = oscillator(e, d).under(push(f, omega, Acts::Primary), PRIMARY).unwrap();
        let start = ModalStart::new(&[0.0], &[0.0], [REST]).unwrap();
        let run = run(&driven, &start, &Limits::new(40.0, 1e-9)).unwrap();
        let begin = &run.episodes[0];
        let released = ((d / f).acos() - 0.3) / omega;
        assert!((begin.release_time.unwrap() - released).abs() < 1e-12, "{e}: {begin:?}");
        assert!(run.measures.energy_residual.abs() < 1e-14);
    }
}

/// A spring that presses the point on its stop with p, and a force f cos (Ωt + 0.3) that lifts it for an instant only if f > p: the dip below 0 is a thousandth of a
/// cycle long.
#[test]
fn a_release_for_an_instant_is_not_missed() {
    let (p, d) = (0.7, 0.4);
    let stop = FreeMass::on_ground(0.0, d).unwrap().with_offset(-p - d).unwrap();
    let one = || ModalStructure::moving_as_one(0.0).unwrap();
    let start = ModalStart::new(&[-p], &[0.0], [REST]).unwrap();
    for k in 0..60 {
        let omega = 0.3 + 0.03 * f64::from(k);
        for more in [1e-5, -1e-5] {
            let f = p * (1.0 + more);
            let system = Modal::<_, 1, 2>::with_room(one(), &[(stop, PRIMARY)]).unwrap();
            let driven = system.under(push(f, omega, Acts::Primary), PRIMARY).unwrap();
            let run = run(&driven, &start, &Limits::new(7.0 / omega, 1e-9)).unwrap();
            let released = run.episodes[0].release_time;
            if more < 0.0 {
                assert_eq!((run.episodes.len(), released), (1, None), "{omega}");
            } else {
                let expected = ((-p / f).acos() - 0.3) / omega;
                assert!((released.unwrap() - expected).abs() < 1e-11, "{omega}: {released:?}");
            }
        }
    }
}

/// With one stop only, at d > 0, the oscillator comes back to it after 2π − 2 atan(v/d).
#[test]
fn an_oscillator_before_one_stop_follows_its_closed_form() {
    for (e, d, v) in [(0.9, 0.5, 3.0), (1.0, 0.2, 1.0), (0.8, 2.0, 9.0)] {
        let stop = FreeMass::on_ground(e, d).unwrap().with_only(Wall::Plus);
        let one = ModalStructure::moving_as_one(0.0).unwrap();
        let system = Modal::<_, 1, 2>::with_room(one, &[(stop, PRIMARY)]).unwrap();
        let start = ModalStart::new(&[0.0], &[v], [REST]).unwrap();
        let mut speed = (v * v - d * d).sqrt();
        let mut time = (d / v).asin();
        let run = run(&system, &start, &Limits::new(60.0, 1e-9)).unwrap();
        assert!(run.impacts.len() > 8);
        for impact in &run.impacts {
            // Speeds shrink, and with them how well the contact is conditioned.
            let off = (impact.time - time).abs() * speed / (time * v);
            assert!(off < 4e-15, "{e}: {time}: {off:e}");
            assert!((impact.velocity_before - speed).abs() < 1e-13 * v);
            speed *= e;
            time += std::f64::consts::TAU - 2.0 * (speed / d).atan();
        }
    }
}

/// A mass with one wall has the events of one whose other wall is far away.
#[test]
fn a_wall_out_of_reach_is_no_wall() {
    let mut compared = 0;
    for seed in 0..some(60) as u64 {
        let mut rng = Rng::new(9100 + seed);
        let mut masses = [any_mass(&mut rng), any_mass(&mut rng)];
        for mass in &mut masses {
            (mass[4], mass[5]) = (mass[3], 0.0);
        }
        let structure = any_structure::<f64>(&mut rng, 3, seed.is_multiple_of(3));
        let rubs = [rng.log_range(1e-3, 0.1), 0.0].map(|it| if seed % 4 < 2 { it } else { 0.0 });
        let of = |only: bool| {
            let built = |k: usize, wall: Wall, sign: f64| {
                let [mu, e, d, offset, ..] = masses[k];
                let mass = FreeMass::new(mu, e, d).unwrap().with_offset(offset).unwrap();
                if only {
                    return mass.with_only(wall);
                }
                // The same wall, and one that is 100 d away.
                let mass = FreeMass::new(mu, e, 50.0 * d).unwrap();
                mass.with_offset(offset - sign * 49.0 * d).unwrap()
            };
            let members = [(built(0, Wall::Plus, 1.0), "p0"), (built(1, Wall::Minus, -1.0), "p1")];
            let system = Modal::<_, 2>::new(structure.clone(), members).unwrap();
            let system = system.with_friction(&rubs).unwrap();
            // Their weights lead them back to their walls.
            let system = system.with_gravity(&[-0.4, 0.3]).unwrap();
            let gaps = [0, 1].map(|k: usize| GapPoint { y: masses[k][3], w: 0.0 });
            let start = ModalStart::new(&[1.0, 0.3], &[0.2], gaps).unwrap();
            let run = run(&system, &start, &Limits::new(25.0, 1e-9)).unwrap();
            assert!(run.measures.energy_residual.abs() < 1e-12, "{seed}");
            run.impacts
        };
        let [one, two] = [true, false].map(of);
        let few = one.len().min(two.len()).min(8);
        let off = furthest(&rows(&one[..few]), &rows(&two[..few]));
        assert!(off < 1e-10, "{seed}: {off:e}");
        compared += few;
    }
    assert!(compared > some(200), "{compared}");
}

/// The mirror image of a scene has the mirror image of all its events.
#[test]
fn a_mirrored_scene_has_mirrored_events() {
    let of = |sign: f64| {
        let stop = FreeMass::on_ground(0.6, 0.4).unwrap().with_offset(sign * 0.1).unwrap();
        let mass = FreeMass::new(0.1, 0.7, 0.3).unwrap();
        let structure = ModalStructure::moving_as_one(0.01).unwrap();
        let masses = [(stop, PRIMARY), (mass, PRIMARY)];
        let system = Modal::<_, 2, 2>::with_room(structure, &masses).unwrap();
        let start = ModalStart::new(&[sign * 0.2], &[sign * 1.5], [REST; 2]).unwrap();
        run(&system, &start, &Limits::new(30.0, 1e-9)).unwrap().impacts
    };
    let [one, other] = [1.0, -1.0].map(of);
    assert!(one.len() > 15 && one.len() == other.len());
    for (a, b) in one.iter().zip(&other) {
        assert!(a.time == b.time && a.wall != b.wall && a.absorber == b.absorber);
        assert!(a.velocity_before == -b.velocity_before && a.energy_loss == b.energy_loss);
    }
}

/// Three modes between stops at two points, with a mass that rubs and one with a spring and a dashpot.
struct BesideAbsorbers;

impl Scenes for BesideAbsorbers {
    fn scene<R: Real>(seed: u64) -> Composed<R> {
        let mut rng = Rng::new(7300 + seed);
        let structure = any_structure::<R>(&mut rng, 3, seed.is_multiple_of(3));
        let mut stop = || {
            let [e, d] = [rng.range(0.0, 0.95), rng.log_range(0.1, 0.6)];
            let stop = FreeMass::on_ground(R::from(e), R::from(d)).unwrap();
            stop.with_offset(R::from(d * rng.range(-0.6, 0.6))).unwrap()
        };
        let stops = [stop(), stop()];
        let masses = [any_mass(&mut rng), any_mass(&mut rng)];
        let members = [
            (stops[0], POINTS[0]),
            (built::<R>(masses[0]), POINTS[1]),
            (stops[1], POINTS[2]),
            (built::<R>(masses[1]), POINTS[0]),
        ];
        let mut any = || rng.log_range(1e-3, 0.1);
        let tied = [[0.0; 2], [any(), any()], [0.0; 2], [0.0; 2]];
        let rubs = [0.0, 0.0, 0.0, any()];
        let velocities: [f64; 3] = std::array::from_fn(|_| rng.range(-1.0, 1.0));
        let gap = |[_, _, _, offset, ..]: iva_tests::modal::Mass| GapPoint {
            y: R::from(offset),
            w: R::ZERO,
        };
        let rest = GapPoint { y: R::ZERO, w: R::ZERO };
        let gaps = [rest, gap(masses[0]), rest, gap(masses[1])];
        let start = ModalStart::new(&[R::ZERO; 3], &reals(&velocities), gaps).unwrap();
        let system = Modal::new(structure, members).unwrap();
        let system = system.with_ties(&ties(&tied)).unwrap().with_friction(&reals(&rubs)).unwrap();
        let acts = [None, Some(Acts::Primary), Some(Acts::Base)][seed as usize % 3];
        (system, start, acts.map(|acts| push(0.4, 0.9, acts)))
    }
}

/// The ledger closes, to all digits of either numbers.
#[test]
fn ledgers_close() {
    let (_, counted) = composed::ledgers_close::<BesideAbsorbers>(some(60));
    assert!(counted[0] > some(900) && counted[1] > some(20), "{counted:?}");
}

#[test]
fn doubles_agree_with_twice_the_precision() {
    let compared = composed::doubles_agree::<BesideAbsorbers>(some(150), some(1300));
    assert!(compared > some(600), "{compared}");
}

/// A stop at a node, with a spring, or beyond which the structure begins is refused.
#[test]
fn a_stop_without_sense_is_refused() {
    let still = ModalStructure::new(&[1.0], &[0.0]).unwrap().with_point("a", &[0.0]).unwrap();
    let stop = || FreeMass::on_ground(0.5, 0.4).unwrap();
    let error = Modal::<_, 1>::new(still, [(stop(), "a")]).unwrap_err().to_string();
    assert!(error.contains("absorber.0.point") && error.contains("moves"), "{error}");
    let system = oscillator(0.5, 0.4);
    let error = system.clone().with_ties(&ties(&[[0.1, 0.0]])).unwrap_err().to_string();
    assert!(error.contains("absorber.0.spring"), "{error}");
    let start = ModalStart::new(&[0.5], &[0.0], [REST]).unwrap();
    let error = run(&system, &start, &Limits::new(1.0, 1e-9)).unwrap_err().to_string();
    assert!(error.contains("start.displacement") && error.contains("0.4"), "{error}");
}
