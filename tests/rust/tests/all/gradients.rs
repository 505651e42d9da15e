//! Derivatives of runs compared with other difference quotients, of runs of the core in numbers of twice the
//! precision with systems made by hand: away from grazings they agree to 1e-11 of the largest derivative so far.
//!
//! These differences are central, with steps h and 2h extrapolated: for h = 1e-12 their relative error is some
//! 1e-16 where the condition is below 1e8, and the runs in twice the precision reproduce the 50-digit references (`verified.rs`).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::atomic::AtomicBool;

use arrow_array::RecordBatch;
use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use iva_core::{
    absorber::{Absorber, Start},
    force::{Acts, Force, Harmonic},
    piva::{Parameters, Piva, PivaStart},
    real::{Real, twofold::Twofold},
    run::{Run, run},
    simulate::{Limits, Outcome},
    siva::Siva,
};
use iva_sweep::{
    choices::{Choices, Kind},
    design::Spec,
    fields::FieldId as F,
    study::{Study, Table},
    sweep::{Control, Workers, sweep},
};
use iva_tests::rng::Rng;
use iva_tests::some;
use iva_verify::gradients;

const STEP: f64 = 1e-12;
const ALLOWED: f64 = 1e-11;

/// The numbers of a run that are compared, in natural units.
#[derive(Debug)]
struct Numbers {
    kinds: Vec<f64>,
    impacts: Vec<[Twofold; 4]>,
    summary: Vec<(&'static str, Option<Twofold>)>,
}

fn numbers<S: Absorber<Real = Twofold>>(system: &S, start: &S::Start, duration: f64) -> Numbers {
    let limits = Limits::new(duration.into(), system.clearance());
    let run: Run<S::State, Twofold> = run(system, start, &limits).unwrap();
    assert_eq!(run.tally.outcome, Outcome::Finished);
    let m = run.measures;
    Numbers {
        kinds: run.impacts.iter().map(|impact| impact.wall.sign()).collect(),
        impacts: run
            .impacts
            .iter()
            .map(|it| [it.time, it.displacement, it.velocity_after, it.energy_loss])
            .collect(),
        summary: vec![
            ("time_stuck", Some(run.tally.time_stuck)),
            ("energy_impacts", Some(run.tally.energy_impacts)),
            ("energy_viscous", Some(m.energy_viscous)),
            ("energy_final", Some(m.energy_final)),
            ("damping_ratio_1", m.damping_ratio_1),
            ("damping_ratio_3", m.damping_ratio_3),
            ("damping_ratio_fit", m.damping_ratio_fit),
            ("damping_ratio_energy", m.damping_ratio_energy),
            ("settling_time_10", m.settling_time_10),
            ("settling_time_5", m.settling_time_5),
            ("residual_amplitude", m.residual_amplitude),
        ],
    }
}

/// (f(p + h) − f(p − h))/2h at h and 2h, extrapolated.
fn difference(at: [Twofold; 4], h: f64) -> f64 {
    let [low_2, low, high, high_2] = at;
    f64::from(((high - low) * 8.0 - (high_2 - low_2)) / (12.0 * h))
}

fn column(table: &RecordBatch, name: &str) -> Vec<Option<f64>> {
    let values = table.column_by_name(name).unwrap().as_primitive::<Float64Type>();
    values.iter().collect()
}

struct Check {
    largest: f64,
    worst: f64,
    compared: u64,
    flagged: u64,
}

impl Check {
    /// Adds an error relative to the largest derivative of the run so far, because errors grow with the
    /// derivatives even where one of them is small.
    fn take(&mut self, what: &str, value: f64, truth: f64) {
        self.largest = self.largest.max(truth.abs());
        let error = (value - truth).abs() / self.largest;
        self.worst = self.worst.max(error);
        self.compared += 1;
        assert!(error <= ALLOWED, "{what}: {value:e} instead of {truth:e}");
    }

    /// Compares the gradient with respect to one field with differences of `runs` at −2h, −h, h, 2h.
    fn gradient(&mut self, spec: &Spec, field: F, value: f64, runs: &dyn Fn(Twofold) -> Numbers) {
        let study = Study::single(spec.clone());
        let tables = gradients(&study, &field.path(), &AtomicBool::new(false)).unwrap();
        let around = [-2.0, -1.0, 1.0, 2.0]
            .map(|step| runs(Twofold::from(value) + Twofold::from(STEP) * step));
        let [a, b, c, d] = &around;
        if around.iter().any(|run| run.kinds != a.kinds) {
            self.flagged += 1;
            return;
        }
        let (impacts, summary) = (&tables[&Table::Impacts], &tables[&Table::Summary]);
        assert_eq!(impacts.num_rows(), a.kinds.len());
        let grazing = impacts.column_by_name("near_grazing").unwrap().as_boolean();
        self.largest = 1.0;
        let names = ["time", "displacement", "velocity_after", "energy_loss"];
        let columns = names.map(|name| column(impacts, name));
        for (row, near) in grazing.iter().enumerate() {
            if near == Some(true) {
                self.flagged += 1;
                continue;
            }
            for (place, name) in names.into_iter().enumerate() {
                let value = columns[place][row];
                let truth = [a, b, c, d].map(|run| run.impacts[row][place]);
                let what = format!("∂{name}/∂{field:?}, impact {row} of {spec:?}");
                self.take(&what, value.unwrap(), difference(truth, STEP));
            }
        }
        let near = grazing.iter().flatten().any(|met| met);
        for (place, (name, _)) in a.summary.iter().enumerate() {
            let [Some(a), Some(b), Some(c), Some(d)] = [a, b, c, d].map(|run| run.summary[place].1)
            else {
                continue;
            };
            if near {
                self.flagged += 1;
                continue;
            }
            let value = column(summary, name)[0].unwrap();
            let what = format!("∂{name}/∂{field:?} of {spec:?}");
            self.take(&what, value, difference([a, b, c, d], STEP));
        }
    }
}

fn spec(kind: Kind, fields: &[(F, f64)]) -> Spec {
    let mut choices = Choices::default();
    choices.choose("kind", kind.name()).unwrap();
    let mut spec = Spec::new(choices);
    for (field, value) in fields {
        spec.set(*field, *value).unwrap();
    }
    spec
}

#[test]
fn derivatives_of_free_masses_are_right() {
    let mut rng = Rng::new(61);
    let mut check = Check { largest: 1.0, worst: 0.0, compared: 0, flagged: 0 };
    for _ in 0..60 {
        let fields = [
            (F::MassRatio, rng.log_range(0.02, 1.0)),
            (F::Restitution, rng.pick(&[0.0, 0.3, 0.6, 0.9, 1.0]) * 0.999),
            (F::Clearance, rng.log_range(0.05, 1.5)),
            (F::DampingRatio, rng.pick(&[0.0, 0.01, 0.2, 1.0])),
            (F::Displacement, 1.0),
            (F::Velocity, rng.range(-0.5, 0.5)),
        ];
        let cycles = rng.range(1.0, 5.0);
        let mut spec = spec(Kind::Siva, &fields);
        spec.set(F::Periods, cycles).unwrap();
        let duration = cycles * std::f64::consts::TAU;
        for (number, (field, value)) in fields.into_iter().enumerate() {
            if value == 0.0 || value == 1.0 && field == F::Restitution {
                continue; // differences would leave the range
            }
            check.gradient(&spec, field, value, &|changed| {
                let mut all = fields.map(|(_, value)| Twofold::from(value));
                all[number] = changed;
                let [mass, e, d, zeta, displacement, velocity] = all;
                let siva = Siva::new(mass, e, d, zeta).unwrap();
                numbers(&siva, &Start { displacement, velocity, ..Start::default() }, duration)
            });
        }
    }
    println!(
        "{} derivatives, worst {:.1e}, {} close to a grazing",
        check.compared, check.worst, check.flagged
    );
    assert!(check.compared > 5000 && check.flagged < check.compared / 3);
}

/// Derivatives of free masses with gravity along their motion, which start on their lower stop.
#[test]
fn derivatives_where_the_motion_rises_are_right() {
    let mut rng = Rng::new(64);
    let mut check = Check { largest: 1.0, worst: 0.0, compared: 0, flagged: 0 };
    for _ in 0..40 {
        let fields = [
            (F::MassRatio, rng.log_range(0.02, 0.5)),
            (F::Restitution, rng.range(0.1, 0.9)),
            (F::Clearance, rng.log_range(0.1, 1.5)),
            (F::DampingRatio, rng.pick(&[0.01, 0.1])),
            (F::Displacement, rng.range(-2.0, 2.0)),
            (F::Gravity, rng.log_range(0.1, 2.0)),
            (F::Inclination, rng.range(0.1, 1.5)),
        ];
        let cycles = rng.range(1.0, 4.0);
        let mut spec = spec(Kind::Siva, &fields);
        spec.set(F::Periods, cycles).unwrap();
        let duration = cycles * std::f64::consts::TAU;
        for (number, (field, value)) in fields.into_iter().enumerate() {
            check.gradient(&spec, field, value, &|changed| {
                let mut all = fields.map(|(_, value)| Twofold::from(value));
                all[number] = changed;
                let [mass, e, d, zeta, displacement, gravity, inclination] = all;
                let (sine, _) = inclination.sincos();
                let siva = Siva::new(mass, e, d, zeta).unwrap();
                let siva = siva.inclined(gravity * sine, Force::default());
                let start = Start { displacement, gap_displacement: -d, ..Start::default() };
                numbers(&siva, &start, duration)
            });
        }
    }
    println!(
        "{} derivatives, worst {:.1e}, {} close to a grazing",
        check.compared, check.worst, check.flagged
    );
    assert!(check.compared > 3000 && check.flagged < check.compared / 3);
}

#[test]
fn derivatives_of_pendulums_are_right() {
    let mut rng = Rng::new(62);
    let mut check = Check { largest: 1.0, worst: 0.0, compared: 0, flagged: 0 };
    let scenes = some(25);
    for _ in 0..scenes {
        let clearance = rng.range(0.1, 1.2);
        let fields = [
            (F::MassRatio, rng.range(0.02, 0.4)),
            (F::Restitution, rng.range(0.1, 0.9)),
            (F::Clearance, clearance),
            (F::DampingRatio, rng.pick(&[0.01, 0.1])),
            (F::Displacement, 1.0),
            (F::FrequencyRatio, rng.range(0.1, 1.2)),
            (F::Length, clearance * rng.range(1.3, 20.0)),
            (F::InertiaRatio, rng.range(1.01, 1.3)),
            (F::PivotDampingRatio, rng.range(0.01, 0.1)),
            (F::SpringRatio, rng.range(0.1, 1.0)),
            (F::Amplitude, rng.range(0.01, 0.3)),
            (F::ForceFrequency, rng.range(0.5, 1.5)),
            (F::Phase, rng.range(-1.0, 1.0)),
        ];
        let mut spec = spec(Kind::Piva, &fields);
        let cycles = rng.range(1.0, 3.0);
        spec.set(F::Periods, cycles).unwrap();
        let duration = cycles * std::f64::consts::TAU;
        for (number, (field, value)) in fields.into_iter().enumerate() {
            check.gradient(&spec, field, value, &|changed| {
                let mut all = fields.map(|(_, value)| Twofold::from(value));
                all[number] = changed;
                let [mass, e, d, zeta, x, ratio, length, kappa, pivot, spring, ..] = all;
                let [.., amplitude, frequency, phase] = all;
                let parameters = Parameters {
                    frequency_ratio: ratio,
                    inertia_ratio: kappa,
                    pivot_damping_ratio: pivot,
                    spring_ratio: spring,
                    ..Parameters::point_bob(mass, e, d, zeta, length)
                };
                let harmonic = Harmonic { amplitude, frequency, phase, acts: Acts::Primary };
                let force = Force::harmonic(vec![harmonic]).unwrap();
                let piva = Piva::new(parameters).unwrap().under(force);
                let start = PivaStart::from(Start { displacement: x, ..Start::default() });
                numbers(&piva, &start, duration)
            });
        }
    }
    println!(
        "{} derivatives, worst {:.1e}, {} close to a grazing",
        check.compared, check.worst, check.flagged
    );
    assert!(check.compared > 120 * scenes as u64 && check.flagged < check.compared / 3);
}

/// A chaotic run whose last impacts depend on rounding: its derivatives once belonged to a run with other
/// impacts.
#[test]
fn derivatives_end_where_rounding_decides() {
    let fields = [
        (F::MassRatio, 0.1),
        (F::Restitution, 0.8),
        (F::Clearance, 1.0),
        (F::DampingRatio, 0.02),
        (F::Displacement, 0.5),
        (F::Amplitude, 0.78),
        (F::ForceFrequency, 1.3),
        (F::Cycles, 60.0),
    ];
    let never = AtomicBool::new(false);
    let study = Study { errors: true, ..Study::single(spec(Kind::Siva, &fields)) };
    let workers = Workers::new(Some(1)).unwrap();
    let control = Control { workers: &workers, chunk: None, cancel: &never, progress: &|_| {} };
    let run = sweep(&study, 0..1, &control).unwrap();
    let slopes = gradients(&study, "displacement", &never).unwrap();
    let (impacts, their) = (&run[&Table::Impacts], &slopes[&Table::Impacts]);
    assert!(impacts.num_rows() > 100);
    assert_eq!(impacts["wall"].as_ref(), their["wall"].as_ref());
    let (times, errors) = (column(impacts, "time"), column(impacts, "time_error"));
    let summary = &slopes[&Table::Summary];
    let from = column(summary, "sensitive_from")[0].unwrap();
    let slopes = column(their, "time");
    for row in 0..impacts.num_rows() {
        let meant = times[row].unwrap() < from;
        assert_eq!(meant, slopes[row].is_some(), "{row}");
        assert!(!meant || errors[row].unwrap() < 1e-3, "{row}");
    }
    let first = times.iter().position(|time| time.unwrap() == from).unwrap();
    assert!(first > 20 && errors[first].is_none_or(|error| error >= 1e-3));
    assert_eq!(column(summary, "amplitude_max"), [None]);
    assert_eq!(column(summary, "energy_initial"), [Some(0.5)]);
}

#[test]
fn derivatives_of_a_tame_run_go_to_its_end() {
    let fields = [
        (F::MassRatio, 0.1),
        (F::Restitution, 0.6),
        (F::Clearance, 0.5),
        (F::DampingRatio, 0.02),
        (F::Displacement, 1.0),
        (F::Periods, 8.0),
    ];
    let study = Study::single(spec(Kind::Siva, &fields));
    let slopes = gradients(&study, "clearance", &AtomicBool::new(false)).unwrap();
    assert_eq!(column(&slopes[&Table::Summary], "sensitive_from"), [None]);
    assert!(column(&slopes[&Table::Impacts], "time").iter().all(Option::is_some));
    assert!(column(&slopes[&Table::Summary], "settling_time_10")[0].is_some());
}
