//! The core in numbers of twice the precision, with the decimals of the references as input: it must
//! reproduce their 30 digits to a hundredth of a rounding unit of doubles. So it is a valid standard for the
//! core in doubles.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

use arrow_array::RecordBatch;
use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use iva_core::{
    absorber::{Absorber, Start},
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    piva::{Parameters, Piva, PivaStart},
    real::{Real, twofold::Twofold},
    run::{Run, run},
    simulate::{Limits, Outcome},
    siva::Siva,
};
use iva_sweep::{
    design::Spec,
    fields::FieldId as F,
    study::{Study, Table},
    sweep::{Control, Workers, sweep},
};
use iva_tests::{
    dd::Dd,
    oracle::Kind,
    reference::{Expected, forced_scenes, piva_scenes, scenes},
    units,
};
use iva_verify::{Finding, verify};

/// Approach speed at or below which impacts are missing in the references.
const FLOOR: f64 = 1e-9;
/// Largest error, in rounding units of doubles.
const ALLOWED: f64 = 0.01;

fn twofold(number: Dd) -> Twofold {
    Twofold::new(number.hi, number.lo)
}

/// Events in order of time; at one instant an impact comes before the stick that it ends in.
fn marks<S>(run: &Run<S, Twofold>) -> Vec<(Kind, f64, Twofold)> {
    let mut marks: Vec<(Kind, f64, Twofold)> = Vec::new();
    for impact in run.impacts.iter().filter(|impact| impact.approach_speed() > FLOOR) {
        marks.push((Kind::Impact, impact.wall.sign(), impact.time));
    }
    for episode in &run.episodes {
        marks.push((Kind::Stick, episode.wall.sign(), episode.stick_time));
        marks.extend(episode.release_time.map(|it| (Kind::Release, episode.wall.sign(), it)));
    }
    marks.sort_by(|a, b| a.2.total_cmp(&b.2));
    marks
}

fn check<S: Absorber<Real = Twofold>>(
    name: &str,
    system: &S,
    start: &S::Start,
    duration: f64,
    events: &[Expected],
) {
    let limits =
        Limits { chatter_floor: FLOOR.into(), ..Limits::new(duration.into(), system.clearance()) };
    let run = run(system, start, &limits).unwrap();
    assert_eq!((run.tally.outcome, run.tally.undecided), (Outcome::Finished, 0));
    let marks = marks(&run);
    let found: Vec<_> = marks.iter().map(|mark| (mark.0, mark.1)).collect();
    let expected: Vec<_> = events.iter().map(|event| (event.kind, event.wall)).collect();
    assert_eq!(found, expected, "{name}");
    let off = |((_, _, time), event): (&(Kind, f64, Twofold), &Expected)| {
        let error = f64::from(*time - twofold(event.time));
        units(error, event.condition, event.time.value())
    };
    let worst = marks.iter().zip(events).map(off).fold(0.0, f64::max);
    println!("{name:28} {:4} events, worst {worst:.1e} units", marks.len());
    assert!(worst <= ALLOWED, "{name}: {worst}");
}

#[test]
fn free_masses_reproduce_the_references() {
    for reference in scenes() {
        let scene = &reference.scene;
        let system = Siva::new(
            twofold(scene.mass_ratio),
            twofold(scene.restitution),
            twofold(scene.clearance),
            twofold(scene.damping_ratio),
        );
        let [displacement, velocity, gap_displacement, gap_velocity] = scene.start.map(twofold);
        let start = Start { displacement, velocity, gap_displacement, gap_velocity };
        check(&reference.name, &system.unwrap(), &start, scene.duration, &reference.events);
    }
}

/// A run of n whole periods ends at a strobe, and at an instant that measures look at, apart from the
/// rounding of its duration: its rows must still describe the same events.
#[test]
fn runs_of_whole_periods_agree_to_their_very_end() {
    let never = AtomicBool::new(false);
    for (n, omega) in (1..=30).flat_map(|n| [1.0, 1.3, 7.7].map(|omega| (n, omega))) {
        for amplitude in [None, Some(0.3)] {
            let mut spec = Spec::default();
            let fields = [
                (F::MassRatio, 0.1),
                (F::Restitution, 0.5),
                (F::Clearance, 0.5),
                (F::DampingRatio, 0.05),
                (F::NaturalFrequency, omega),
                (F::Displacement, 1.0),
                (F::Duration, f64::from(n) * std::f64::consts::TAU / omega),
            ];
            let force = amplitude.map(|it| [(F::Amplitude, it), (F::ForceFrequency, omega)]);
            for (field, value) in fields.into_iter().chain(force.into_iter().flatten()) {
                spec.set(field, value).unwrap();
            }
            let found = verify(&Study::single(spec), &never).unwrap();
            for finding in &found.findings {
                assert!(finding.agrees(), "{n} periods at {omega}, {amplitude:?}: {finding:?}");
            }
        }
    }
}

fn force(given: &BTreeMap<String, Dd>) -> Force<Twofold> {
    let harmonic = given.get("F").map(|amplitude| Harmonic {
        amplitude: twofold(*amplitude),
        frequency: twofold(given["Omega"]),
        phase: Twofold::ZERO,
        acts: Acts::Primary,
    });
    Force::harmonic(harmonic.into_iter().collect()).unwrap()
}

/// The free mass of a reference; `None` for a pendulum.
fn mass(given: &BTreeMap<String, Dd>) -> Option<Siva<DrivenHost<Twofold>>> {
    let key = |name: &str| twofold(given[name]);
    if given.contains_key("r") {
        return None;
    }
    let siva = Siva::new(key("mu"), key("e"), key("gamma"), key("zeta")).unwrap();
    Some(siva.under(force(given)))
}

/// The pendulum of a reference; a free mass is a pendulum at small angles without gravity.
fn pendulum(given: &BTreeMap<String, Dd>) -> Piva<DrivenHost<Twofold>> {
    let key = |name: &str| twofold(given[name]);
    let [mass_ratio, restitution, clearance] = ["mu", "e", "gamma"].map(key);
    let damping_ratio = key("zeta");
    let parameters = if given.contains_key("r") {
        Parameters {
            frequency_ratio: key("r"),
            ..Parameters::point_bob(mass_ratio, restitution, clearance, damping_ratio, key("lam"))
        }
    } else {
        Parameters::free_mass(mass_ratio, restitution, clearance, damping_ratio)
    };
    Piva::new(parameters).unwrap().under(force(given))
}

#[test]
fn pendulums_and_forced_scenes_reproduce_the_references() {
    for reference in piva_scenes().into_iter().chain(forced_scenes()) {
        let displacement = reference.given.get("x").map_or(Twofold::ONE, |number| twofold(*number));
        let start = Start { displacement, ..Start::default() };
        let (duration, events) = (reference.duration, &reference.events);
        let piva = pendulum(&reference.given);
        check(&reference.name, &piva, &PivaStart::from(start), duration, events);
        if let Some(siva) = mass(&reference.given) {
            check(&reference.name, &siva, &start, duration, events);
        }
    }
}

/// The errors that a user sees, of runs with doubles as input: value minus error is the reference, apart from
/// the rounding of the inputs, which is 0.12 units at most, 0.20 in the heavy scene.
#[test]
fn errors_shown_to_users_are_those_against_the_references() {
    let never = AtomicBool::new(false);
    for reference in scenes() {
        let scene = &reference.scene;
        let [x, v, y, w] = scene.start.map(|number| number.hi);
        let mut spec = Spec::default();
        for (field, value) in [
            (F::MassRatio, scene.mass_ratio.hi),
            (F::Restitution, scene.restitution.hi),
            (F::Clearance, scene.clearance.hi),
            (F::DampingRatio, scene.damping_ratio.hi),
            (F::Displacement, x),
            (F::Velocity, v),
            (F::GapDisplacement, y),
            (F::GapVelocity, w),
            (F::Duration, scene.duration),
            (F::ChatterFloor, FLOOR),
        ] {
            spec.set(field, value).unwrap();
        }
        let study = Study { tables: vec![Table::Impacts], ..Study::single(spec) };
        let found = verify(&study, &never).unwrap();
        assert!(found.findings.iter().all(Finding::agrees), "{}", reference.name);
        let times = |table: &RecordBatch| -> Vec<f64> {
            let column = table.column_by_name("time").unwrap();
            column.as_primitive::<Float64Type>().values().to_vec()
        };
        let workers = Workers::new(Some(1)).unwrap();
        let control = Control { workers: &workers, chunk: None, cancel: &never, progress: &|_| {} };
        let run = sweep(&study, 0..1, &control).unwrap();
        let values = times(&run[&Table::Impacts]);
        let errors = times(&found.errors[&Table::Impacts]);
        let impacts = reference.events.iter().filter(|event| event.kind == Kind::Impact);
        let mut worst: f64 = 0.0;
        assert_eq!(values.len(), impacts.clone().count());
        for ((value, error), event) in values.iter().zip(&errors).zip(impacts) {
            let truth = Twofold::from(*value) - Twofold::from(*error);
            let off = f64::from(truth - twofold(event.time));
            worst = worst.max(units(off, event.condition, event.time.value()));
        }
        println!("{:28} {:4} impacts, worst {worst:.2} units", reference.name, values.len());
        assert!(worst <= 0.25, "{}: {worst}", reference.name);
    }
}
