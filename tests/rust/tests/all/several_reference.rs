//! Several free masses on one structure, against the event lists of `tests/reference/several.json`: 28 scenes of 2 to 5
//! masses to 30 digits, four of them with impacts at one instant.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::Point,
    flight::GapPoint,
    force::{Acts, Force, Harmonic},
    host::Host,
    real::{Real, twofold::Twofold},
    run::run,
    simulate::{Limits, Outcome},
    siva::FreeMass,
};
use iva_tests::list::{List, begun, driven, list};
use iva_tests::{U, dd::Dd};
use serde_json::Value;

fn scenes() -> Vec<Value> {
    serde_json::from_str(include_str!("../../../reference/several.json")).unwrap()
}

/// A number type that a decimal is read into.
trait Read: Real {
    fn read(text: &Value) -> Self;
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

/// An event: the kind, the absorber, and the numbers that are compared, of which the first is the instant.
type Event<R> = (String, u64, Vec<R>);

/// The events of a run, without impacts at or below a share of 1e-6 of the clearance.
fn events<R: Read, H: Host<Real = R>>(
    system: &List<H>,
    scene: &Value,
) -> (Vec<Event<R>>, [Vec<R>; 2]) {
    let start = &scene["start"];
    let gap = |k: usize| {
        let [y, w] = [0, 1].map(|n| R::read(&start["gaps"][k][n]));
        GapPoint { y, w }
    };
    let [x, v] = ["displacement", "velocity"].map(|name| R::read(&start[name]));
    let gaps: Vec<_> = (0..system.masses().len()).map(gap).collect();
    let starts = begun(Point { x, v }, &gaps);
    let limits = Limits::new(R::read(&scene["duration"]), R::from(1e-3));
    let run = run(system, &starts, &limits).unwrap();
    assert_eq!((run.tally.outcome, run.tally.undecided), (Outcome::Finished, 0));
    let mut events = Vec::new();
    for it in &run.impacts {
        let clearance = system.masses()[usize::from(it.absorber)].clearance();
        if it.approach_speed() <= clearance * 1e-6 {
            continue;
        }
        let wall = R::from(it.wall.sign());
        let velocities = [it.velocity_before, it.velocity_after];
        let gap = [it.gap_velocity_before, it.gap_velocity_after];
        let numbers = [&[it.time, wall][..], &velocities, &gap].concat();
        events.push(("impact".to_owned(), u64::from(it.absorber), numbers));
    }
    for it in &run.episodes {
        let (absorber, wall) = (u64::from(it.absorber), R::from(it.wall.sign()));
        events.push(("stick".to_owned(), absorber, vec![it.stick_time, wall]));
        if let Some(time) = it.release_time {
            events.push(("release".to_owned(), absorber, vec![time, wall]));
        }
    }
    let end = [|gap: GapPoint<R>| gap.y, |gap: GapPoint<R>| gap.w]
        .map(|read| system.gaps(&run.tally.state).into_iter().map(read).collect());
    (events, end)
}

/// The events of a scene.
fn events_of<R: Read>(scene: &Value) -> (Vec<Event<R>>, [Vec<R>; 2]) {
    let count = scene["mass_ratios"].as_array().unwrap().len();
    let mass = |k: usize| {
        let key = |name: &str| R::read(&scene[name][k]);
        let [mu, e, d] = ["mass_ratios", "restitutions", "clearances"].map(key);
        FreeMass::new(mu, e, d).unwrap().with_offset(key("offsets")).unwrap()
    };
    let masses: Vec<_> = (0..count).map(mass).collect();
    let system = list(R::read(&scene["damping_ratio"]), &masses);
    let force = &scene["force"];
    if force.is_null() {
        return events(&system, scene);
    }
    let [amplitude, frequency, phase] =
        ["amplitude", "frequency", "phase"].map(|name| R::read(&force[name]));
    let harmonic = Harmonic { amplitude, frequency, phase, acts: Acts::Primary };
    events(&driven(&system, Force::harmonic(vec![harmonic]).unwrap()), scene)
}

/// The expected events, with the condition of each.
fn expected(scene: &Value) -> Vec<(Event<Twofold>, f64)> {
    let event = |it: &Value| {
        let wall = Twofold::from(it["wall"].as_f64().unwrap());
        let mut numbers = vec![Twofold::read(&it["time"]), wall];
        let velocities =
            ["velocity_before", "velocity_after", "gap_velocity_before", "gap_velocity_after"];
        if it["kind"] == "impact" {
            numbers.extend(velocities.map(|name| Twofold::read(&it[name])));
        }
        let kind = it["kind"].as_str().unwrap().to_owned();
        let condition = it["condition"].as_f64().unwrap();
        ((kind, it["absorber"].as_u64().unwrap(), numbers), condition)
    };
    scene["events"].as_array().unwrap().iter().map(event).collect()
}

/// The largest difference over the condition, of the events of a scene, each found by its kind, absorber and order.
fn furthest<R: Real>(scene: &Value, found: Vec<Event<R>>, exact: impl Fn(R) -> Twofold) -> f64 {
    let expected = expected(scene);
    assert_eq!(found.len(), expected.len(), "{}: number of events", scene["id"]);
    let mut worst: f64 = 0.0;
    for kind in ["impact", "stick", "release"] {
        for absorber in 0..5 {
            let of = |it: &&Event<R>| it.0 == kind && it.1 == absorber;
            let of_expected = |it: &&(Event<Twofold>, f64)| it.0.0 == kind && it.0.1 == absorber;
            let found: Vec<_> = found.iter().filter(of).collect();
            let expected: Vec<_> = expected.iter().filter(of_expected).collect();
            assert_eq!(found.len(), expected.len(), "{}: {kind} of {absorber}", scene["id"]);
            for (found, (expected, condition)) in found.iter().zip(expected) {
                let time = f64::from(expected.2[0]);
                for (a, b) in found.2.iter().zip(&expected.2) {
                    let off = f64::from(exact(*a) - *b).abs();
                    worst = worst.max(off / (condition.max(1.0) + time));
                }
            }
        }
    }
    worst
}

/// In doubles, in rounding units of 2⁻⁵³ (condition + τ).
#[test]
fn doubles_are_within_their_conditioning() {
    for scene in scenes() {
        let off = furthest(&scene, events_of::<f64>(&scene).0, Twofold::from) / U;
        assert!(off < 4.0, "{}: {off} rounding units", scene["id"]);
    }
}

/// In numbers of twice the precision, where the decimals are those of the reference. The series of the structure end at
/// some 1e-24.
#[test]
fn twice_the_precision_has_22_digits() {
    for scene in scenes() {
        let (found, end) = events_of::<Twofold>(&scene);
        let off = furthest(&scene, found, |it| it);
        assert!(off < 1e-22, "{}: {off:e}", scene["id"]);
        let condition = scene["end"]["condition"].as_f64().unwrap();
        for (k, gap) in scene["end"]["gaps"].as_array().unwrap().iter().enumerate() {
            for n in 0..2 {
                let off = f64::from(end[n][k] - Twofold::read(&gap[n])).abs();
                assert!(off < 1e-22 * (condition + 100.0), "{}: end {off:e}", scene["id"]);
            }
        }
    }
}
