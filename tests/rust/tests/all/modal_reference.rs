//! Free masses on structures with several modes, against the event lists of `tests/reference/modal.json`: a two-storey frame
//! whose matrices of mass and damping couple all, and three modes under a force; with chatter, stick and release. The
//! scenes that `modal.py --all` adds are taken as well, where they are in the file.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::modal::{Modal, ModalStart, ModalStructure},
    flight::GapPoint,
    force::{Acts, Force, Harmonic},
    host::Host,
    real::{Real, twofold::Twofold},
    run::run,
    simulate::{Limits, Outcome},
    siva::FreeMass,
};
use iva_tests::{U, dd::Dd};
use serde_json::Value;

fn scenes() -> Vec<Value> {
    serde_json::from_str(include_str!("../../../reference/modal.json")).unwrap()
}

/// A number type that a decimal is read into.
trait Read: Real {
    fn read(text: &Value) -> Self;

    fn all(list: &Value) -> Vec<Self> {
        let read = |it: &Value| if it.is_array() { Self::all(it) } else { vec![Self::read(it)] };
        list.as_array().unwrap().iter().flat_map(read).collect()
    }
}

impl Read for f64 {
    fn read(text: &Value) -> f64 {
        text.as_str().unwrap().parse().unwrap()
    }
}

impl Read for Twofold {
    fn read(text: &Value) -> Twofold {
        let Dd { hi, lo } = Dd::parse(text.as_str().unwrap());
        Twofold::new(hi, lo)
    }
}

/// An event: kind, absorber, wall, and the numbers that are compared, of which the first is the instant.
type Event<R> = (String, u64, i64, Vec<R>);

/// The structure of a scene, and the names of its displacements.
fn structure<R: Read>(scene: &Value) -> ModalStructure<R> {
    let [mass, stiffness, damping] = ["mass", "stiffness", "damping"].map(|it| R::all(&scene[it]));
    let n = scene["mass"].as_array().unwrap().len();
    let names = ["0", "1", "2"];
    let plain = ModalStructure::from_matrices(&names[..n], &mass, &stiffness, &damping).unwrap();
    let shapes: Vec<Vec<R>> =
        names[..n].iter().map(|it| plain.shapes(it).unwrap().to_vec()).collect();
    let influence = &scene["force"]["influence"];
    let mut structure = plain.clone();
    if influence.is_array() {
        let parts = plain.modal(&mass, &R::all(influence)).unwrap();
        structure = structure.with_base(&parts).unwrap();
    }
    for (name, point) in scene["points"].as_object().unwrap() {
        let point: Vec<R> = R::all(point);
        let shape: Vec<R> =
            (0..n).map(|j| (0..n).fold(R::ZERO, |sum, i| sum + point[i] * shapes[i][j])).collect();
        structure = structure.with_point(name, &shape).unwrap();
    }
    structure
}

/// The modal coordinates of displacements.
fn modal<R: Read>(scene: &Value, displacements: &Value) -> Vec<R> {
    let matrices = ["mass", "stiffness", "damping"].map(|it| R::all(&scene[it]));
    let n = scene["mass"].as_array().unwrap().len();
    let [mass, stiffness, damping] = &matrices;
    let plain = ModalStructure::from_matrices(&["0", "1", "2"][..n], mass, stiffness, damping);
    plain.unwrap().modal(mass, &R::all(displacements)).unwrap()
}

/// The events of a run, without impacts at or below a share of 1e-6 of the clearance, and y and w at its end.
fn events<R: Read, H: Host<Real = R>, const N: usize>(
    system: &Modal<H, N>,
    scene: &Value,
) -> (Vec<Event<R>>, Vec<R>) {
    let start = &scene["start"];
    let gaps = std::array::from_fn(|k| {
        let [y, w] = [0, 1].map(|n| R::read(&start["gaps"][k][n]));
        GapPoint { y, w }
    });
    let [q, v] = ["displacements", "velocities"].map(|it| modal::<R>(scene, &start[it]));
    let start = ModalStart::new(&q, &v, gaps).unwrap();
    let limits = Limits::new(R::read(&scene["duration"]), R::from(1e-3));
    let run = run(system, &start, &limits).unwrap();
    assert_eq!((run.tally.outcome, run.tally.undecided), (Outcome::Finished, 0));
    let residual = run.measures.energy_residual.double();
    assert!(residual.abs() < 1e-13, "{}: ledger {residual:e}", scene["id"]);
    let mut events = Vec::new();
    for it in &run.impacts {
        let clearance = system.masses()[usize::from(it.absorber)].clearance();
        if it.approach_speed() > clearance * 1e-6 {
            let numbers = vec![
                it.time,
                it.velocity_before,
                it.velocity_after,
                it.gap_velocity_before,
                it.gap_velocity_after,
            ];
            let wall = it.wall.sign() as i64;
            events.push(("impact".to_owned(), u64::from(it.absorber), wall, numbers));
        }
    }
    for it in &run.episodes {
        let (absorber, wall) = (u64::from(it.absorber), it.wall.sign() as i64);
        events.push(("stick".to_owned(), absorber, wall, vec![it.stick_time]));
        if let Some(time) = it.release_time {
            events.push(("release".to_owned(), absorber, wall, vec![time]));
        }
    }
    let gaps = system.gaps(&run.tally.state);
    (events, gaps.iter().flat_map(|gap| [gap.y, gap.w]).collect())
}

fn events_of<R: Read>(scene: &Value) -> (Vec<Event<R>>, Vec<R>) {
    match scene["absorbers"].as_array().unwrap().len() {
        2 => events_with::<R, 2>(scene),
        _ => events_with::<R, 3>(scene),
    }
}

fn events_with<R: Read, const N: usize>(scene: &Value) -> (Vec<Event<R>>, Vec<R>) {
    let masses = std::array::from_fn(|k| {
        let it = &scene["absorbers"][k];
        let numbers = ["mass_ratio", "restitution", "clearance", "offset"];
        let [mu, e, d, offset] = numbers.map(|name| R::read(&it[name]));
        let mass = FreeMass::new(mu, e, d).unwrap().with_offset(offset).unwrap();
        (mass, it["point"].as_str().unwrap())
    });
    let system = Modal::<_, N>::new(structure::<R>(scene), masses).unwrap();
    let force = &scene["force"];
    if force.is_null() {
        return events(&system, scene);
    }
    let [amplitude, frequency, phase] =
        ["amplitude", "frequency", "phase"].map(|name| R::read(&force[name]));
    let acts = if force["kind"] == "base" { Acts::Base } else { Acts::Primary };
    let point = force["point"].as_str().unwrap_or(masses[0].1);
    let harmonic = Harmonic { amplitude, frequency, phase, acts };
    let force = Force::harmonic(vec![harmonic]).unwrap();
    events(&system.under(force, point).unwrap(), scene)
}

/// The largest difference over the condition, of the events of a scene, each found by its kind, absorber and order; and
/// the number of events.
fn furthest<R: Real>(
    scene: &Value,
    found: &[Event<R>],
    exact: impl Fn(R) -> Twofold,
    kinds: &[&str],
) -> (f64, usize) {
    let (mut worst, mut count): (f64, usize) = (0.0, 0);
    for kind in kinds {
        for absorber in 0..3 {
            let found: Vec<_> =
                found.iter().filter(|it| it.0 == *kind && it.1 == absorber).collect();
            let all = scene["events"].as_array().unwrap().iter();
            let of = |it: &&Value| it["kind"] == *kind && it["absorber"] == absorber;
            let expected: Vec<_> = all.filter(of).collect();
            assert_eq!(found.len(), expected.len(), "{}: {kind} of {absorber}", scene["id"]);
            for (found, expected) in found.iter().zip(expected) {
                assert_eq!(found.2, expected["wall"], "{}: wall", scene["id"]);
                let mut numbers = vec![Twofold::read(&expected["time"])];
                if *kind == "impact" {
                    numbers.extend(Twofold::all(&expected["velocities"]));
                }
                let time = f64::from(numbers[0]);
                let condition = expected["condition"].as_f64().unwrap().max(1.0);
                for (a, b) in found.3.iter().zip(numbers) {
                    worst = worst.max(f64::from(exact(*a) - b).abs() / (condition + time));
                }
                count += 1;
            }
        }
    }
    (worst, count)
}

/// All that the reference lists.
const KINDS: [&str; 3] = ["impact", "stick", "release"];

/// In doubles, in rounding units of 2⁻⁵³ (condition + τ).
#[test]
fn doubles_are_within_their_conditioning() {
    let mut total = 0;
    for scene in scenes() {
        let (off, count) = furthest(&scene, &events_of::<f64>(&scene).0, Twofold::from, &KINDS);
        println!("{}: {} rounding units in {count} events", scene["id"], off / U);
        assert!(off / U < 4.0, "{}: {} rounding units", scene["id"], off / U);
        total += count;
    }
    assert!(total > 80, "{total} events");
}

/// In numbers of twice the precision, where the decimals are those of the reference. Sums of chatters are exact to 1e-22.
#[test]
fn twice_the_precision_has_22_digits() {
    for scene in scenes() {
        let (found, end) = events_of::<Twofold>(&scene);
        let (off, count) = furthest(&scene, &found, |it| it, &KINDS);
        println!("{}: {off:e} in {count} events", scene["id"]);
        assert!(off < 1e-22, "{}: {off:e}", scene["id"]);
        let condition = scene["end"]["condition"].as_f64().unwrap();
        for (found, expected) in end.iter().zip(Twofold::all(&scene["end"]["gaps"])) {
            let off = f64::from(*found - expected).abs();
            assert!(off < 1e-22 * (condition + 100.0), "{}: end {off:e}", scene["id"]);
        }
    }
}

/// A mass is released while another stays stuck: its episode ends, and that of the other does not.
#[test]
fn a_release_ends_no_other_episode() {
    assert!(scenes().iter().any(|it| it["id"] == "frame on a base"), "made by modal.py --all");
    for scene in scenes() {
        let (off, _) = furthest(&scene, &events_of::<f64>(&scene).0, Twofold::from, &KINDS);
        assert!(off / U < 4.0, "{}: {} rounding units", scene["id"], off / U);
    }
}
