//! Free masses whose restitution depends on the approach speed, against `tests/reference/restitution.json`: three scenes
//! to 17 digits and more.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::{OnStructure, restitution::RestitutionLaw},
    observe::{Events, Observer},
    real::{Real, twofold::Twofold},
    simulate::{Instant, Limits, Outcome, simulate},
    siva::{Siva, SivaState},
};
use iva_tests::{
    U,
    dd::Dd,
    laws::{Free, start},
};
use serde_json::Value;

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

/// An event of the reference: its kind, and instant, velocity of the structure and gap velocity before it.
type Event<R> = (&'static str, f64, [R; 3]);

/// The events of a reference scene, without impacts of chatters that end in stick at or below 1e-6.
fn events<R: Read>(scene: &Value) -> Vec<Event<R>> {
    let [mu, d, zeta, end] = ["mu", "gamma", "zeta", "tau_end"].map(|key| R::read(&scene[key]));
    let numbers: Vec<R> = scene["numbers"].as_array().unwrap().iter().map(R::read).collect();
    let law = match scene["law"].as_str().unwrap() {
        "power" => {
            let part = |k: usize| u32::try_from(scene["exponent"][k].as_u64().unwrap()).unwrap();
            RestitutionLaw::power(numbers[0], [part(0), part(1)])
        }
        "plastic" => RestitutionLaw::plastic(numbers[0]),
        _ => {
            let points: Vec<_> = numbers.chunks(2).map(|point| [point[0], point[1]]).collect();
            RestitutionLaw::table(&points)
        }
    };
    let system = Siva::new(mu, R::ONE, d, zeta).unwrap().with_restitution_law(law.unwrap());
    let limits = Limits { chatter_floor: R::from(1e-6), ..Limits::new(end, d) };
    let mut sticks = Sticks(Vec::new());
    let mut seen = (Events::default(), &mut sticks);
    let tally = simulate(&system, &start(), &limits, None, &mut seen).unwrap();
    assert_eq!((tally.outcome, tally.undecided), (Outcome::Finished, 0));
    let mut found: Vec<Event<R>> = Vec::new();
    for it in &seen.0.impacts {
        found.push((
            "impact",
            it.wall.sign(),
            [it.time, it.velocity_before, it.gap_velocity_before],
        ));
    }
    for it in &seen.0.episodes {
        found.push(("stick", it.wall.sign(), [it.stick_time, R::NAN, R::ZERO]));
        found.extend(
            it.release_time.map(|time| ("release", it.wall.sign(), [time, R::NAN, R::ZERO])),
        );
    }
    for ((_, _, numbers), (time, v)) in
        found.iter_mut().filter(|it| it.0 == "release").zip(&sticks.0)
    {
        assert_eq!(numbers[0], *time);
        numbers[1] = *v;
    }
    found.sort_by(|a, b| a.2[0].total_cmp(&b.2[0]));
    found
}

/// The instants of releases, and the velocity of the structure there.
struct Sticks<R>(Vec<(R, R)>);

impl<R: Real> Observer<Free<R>> for Sticks<R> {
    fn release(&mut self, system: &Free<R>, from: &Instant<SivaState<(), R>, R>) {
        self.0.push((from.time.value, system.primary(&from.state).v));
    }
}

/// Three scenes of `tests/reference/restitution.json`: every event in twice the precision as far as the reference is known,
/// and in doubles to rounding.
#[test]
fn reference_events_are_met() {
    let file: Value =
        serde_json::from_str(include_str!("../../../reference/restitution.json")).unwrap();
    let mut kinds = [0, 0, 0];
    for (name, scene) in file.as_object().unwrap() {
        let plain = events::<f64>(&scene["scene"]);
        let exact = events::<Twofold>(&scene["scene"]);
        let expected = scene["events"].as_array().unwrap();
        assert_eq!([plain.len(), exact.len()], [expected.len(); 2], "{name}");
        // Of the instants after the chatter of a power law the reference knows 17 digits; in these numbers the sum of a
        // chatter is meant to be right to 1e-22.
        let known = if name == "power" { 1e-17 } else { 1e-22 };
        let mut largest = 0.0_f64;
        for ((a, b), expected) in plain.iter().zip(&exact).zip(expected) {
            assert_eq!((a.0, b.0), (b.0, expected["kind"].as_str().unwrap()), "{name}");
            assert_eq!([a.1, b.1], [expected["side"].as_f64().unwrap(); 2], "{name}");
            kinds[["impact", "stick", "release"].iter().position(|kind| *kind == a.0).unwrap()] +=
                1;
            let condition = expected["condition"].as_f64().unwrap();
            let numbers = ["tau", "v_main", "approach"].map(|key| Twofold::read(&expected[key]));
            for (k, number) in numbers.into_iter().enumerate().filter(|(k, _)| !b.2[*k].is_nan()) {
                let off = f64::from((b.2[k] - number).abs());
                assert!(off <= known * condition.max(1.0), "{name} {:?} {k}: {off:e}", b.2[0]);
            }
            let unit = U * (condition.max(1.0) + a.2[0]);
            largest = largest.max(f64::from((numbers[0] - a.2[0]).abs()) / unit);
        }
        assert!(largest <= 6.0, "{name}: {largest} rounding units");
    }
    assert!(kinds[0] > 100 && kinds[1] >= 3 && kinds[2] >= 2, "{kinds:?}");
}
