use std::collections::BTreeMap;
use std::path::Path;

use iva_sweep::choices::{CHOICES, Choices, Kind};
use iva_sweep::columns::{SUMMARY, Selection, ranked};
use iva_sweep::design::Spec;
use iva_sweep::identity::Identity;
use iva_sweep::sampling::Rows;
use iva_sweep::study::Study;
use iva_sweep::tables::schema;
use iva_sweep::variable::Variable;
use proptest::prelude::*;

use super::*;
use crate::report::Report;
use crate::source::Source;
use crate::study_file::parse_study;

/// Numbers that a field accepts.
fn accepted(field: FieldId) -> BoxedStrategy<f64> {
    match field.info().allowed {
        Allowed::Size => prop_oneof![-1e3..1e3, Just(0.0), Just(-1e30)]
            .prop_filter("subnormal", |x: &f64| *x == 0.0 || x.abs() >= 1e-30)
            .boxed(),
        Allowed::Positive => prop_oneof![1e-9..1e3, Just(1e-30), Just(1e30)].boxed(),
        Allowed::NonNegative => prop_oneof![1e-9..1e3, Just(0.0)].boxed(),
        Allowed::MassRatio | Allowed::DampingRatio => {
            prop_oneof![1e-9..1e3, Just(5e-324), Just(1e9)].boxed()
        }
        Allowed::UnitInterval => (0.0..=1.0).boxed(),
        Allowed::Exponent => {
            (1..=8_u64).prop_flat_map(|q| (1..=q).prop_map(move |p| p as f64 / q as f64)).boxed()
        }
        Allowed::Units => (1..=8_u64).prop_map(|n| n as f64).boxed(),
        Allowed::InertiaRatio => prop_oneof![1.0..2.0, Just(1.0), Just(1e9)].boxed(),
        Allowed::Angle => (-3.1..3.1).boxed(),
        Allowed::Inclination => (0.0..1.57).boxed(),
        Allowed::InclinationDeg => (0.0..=90.0).boxed(),
        Allowed::Phase => (-12.5..12.5).boxed(),
        Allowed::Tolerance => prop_oneof![0.0..1e-3, Just(0.0), Just(1e-3)].boxed(),
        Allowed::PositiveInteger => (1..=9_007_199_254_740_992_u64).prop_map(|n| n as f64).boxed(),
    }
}

fn axis(field: FieldId) -> BoxedStrategy<Axis> {
    let key = field.path();
    let list = {
        let key = key.clone();
        prop::collection::vec(accepted(field), 1..6)
            .prop_map(move |values| Axis::new(&key, values).unwrap())
    };
    let range = (accepted(field), accepted(field), 3..40_u64)
        .prop_filter_map("a whole number between", move |(start, stop, count)| {
            Axis::linspace(&key, start, stop, count).ok()
        });
    prop_oneof![list, range].boxed()
}

/// Kinds of absorber with the choices that go with them.
fn choices() -> impl Strategy<Value = Choices> {
    let word = |index: usize| prop::sample::select(CHOICES[index].words);
    (word(0), word(1), word(2)).prop_map(|(kind, angles, law)| {
        let mut choices = Choices::default();
        choices.choose("kind", kind).unwrap();
        if choices.kind == Kind::Piva {
            choices.choose("angles", angles).unwrap();
            choices.choose("impact_law", law).unwrap();
        }
        choices
    })
}

/// The fields of a kind of absorber.
fn fields(kind: Kind) -> Vec<FieldId> {
    FieldId::all().filter(|field| field.info().kinds.contains(&kind)).collect()
}

fn axes(kind: Kind) -> impl Strategy<Value = Vec<Axis>> {
    let fields = fields(kind);
    prop::sample::subsequence(fields, 0..4).prop_shuffle().prop_flat_map(|fields| {
        let mut kept: Vec<FieldId> = Vec::new();
        for field in fields {
            if !kept.iter().any(|other| other.same_quantity(field)) {
                kept.push(field);
            }
        }
        kept.into_iter().map(axis).collect::<Vec<_>>()
    })
}

/// All ways of choosing points, with axes that fit the kind of absorber.
fn sampling(kind: Kind) -> impl Strategy<Value = Sampling> {
    let seeds = (1..=1_000_000_u64, 0..=1_u64 << 53, any::<bool>());
    (axes(kind), 0..5_usize, seeds).prop_map(|(mut axes, way, (count, seed, scramble))| {
        if axes.is_empty() || way == 0 {
            return Sampling::Grid(axes);
        }
        if way == 1 {
            let least = axes.iter().map(|axis| axis.values.len()).min().unwrap();
            axes.iter_mut().for_each(|axis| axis.values.truncate(least));
            return Sampling::Rows(Rows::new(axes, 0).unwrap());
        }
        let method = Method::ALL[way - 2];
        let variable = |axis: &Axis| {
            let (low, high) = (axis.values[0], (2.0 * axis.values[0].abs() + 1.0).min(1e30));
            let bounds = |names: [(&str, f64); 4]| {
                names.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
            };
            let (name, mut given): (&str, BTreeMap<String, f64>) = match axis.values.len() % 3 {
                0 => (
                    "normal",
                    bounds([("mean", low), ("deviation", 0.5), ("low", low), ("high", high)]),
                ),
                1 => (
                    "lognormal",
                    bounds([("median", 0.5), ("sigma", 0.1), ("low", low), ("high", high)]),
                ),
                _ => ("uniform", BTreeMap::from([("low".into(), low), ("high".into(), high)])),
            };
            if scramble && name != "uniform" {
                given.remove("low");
            }
            Variable::new(&axis.key, name, &given).ok()
        };
        let variables: Option<Vec<Variable>> = axes.iter().map(variable).collect();
        // A subnormal number is a valid damping ratio, but not a valid parameter of a distribution.
        let Some(variables) = variables else { return Sampling::Grid(axes) };
        let scramble = scramble || method != Method::Sobol;
        let sample = Sample::new(method, count, seed, scramble, variables).unwrap();
        let slots: Vec<Slot> = sample.variables().iter().map(|variable| variable.slot).collect();
        let sampling = Sampling::Sample(sample);
        // The first point must be valid.
        let fits =
            slots.iter().zip(sampling.values(0)).all(|(slot, value)| slot.check(value).is_ok());
        if fits { sampling } else { Sampling::Grid(axes) }
    })
}

fn spec(absorbers: Vec<Choices>) -> impl Strategy<Value = Spec> {
    let fields = fields(absorbers[0].kind);
    prop::sample::subsequence(fields, 0..12)
        .prop_flat_map(|fields| {
            fields
                .into_iter()
                .map(|field| (accepted(field), 0..3_usize).prop_map(move |it| (field, it)))
                .collect::<Vec<_>>()
        })
        .prop_map(move |fields| {
            let mut spec = Spec::several(&absorbers).unwrap();
            for (field, (value, number)) in fields {
                let in_start = field.info().part == Part::Start;
                let slot = spec.slot(field, number % spec.count());
                // A list in [start] has a number for each absorber.
                let slot = if in_start || !spec.has(slot) { field.into() } else { slot };
                spec.set(slot, value).unwrap();
            }
            spec
        })
}

/// One absorber or none, or a list of up to three absorbers.
fn absorbers() -> impl Strategy<Value = Vec<Choices>> {
    let list = prop::collection::vec(choices(), 2..4);
    let list = list.prop_filter("absorbers", |it| it.iter().all(|it| it.kind != Kind::None));
    // What only a pendulum has in its start is no list of all.
    let alike = |it: &Vec<Choices>| it.iter().all(|other| other.kind == it[0].kind);
    prop_oneof![choices().prop_map(|one| vec![one]), list.prop_filter("alike", alike)]
}

fn study_file() -> impl Strategy<Value = StudyFile> {
    let names: Vec<&str> = SUMMARY.iter().map(|column| column.name).collect();
    let tables = prop::sample::subsequence(Table::SWEEP.to_vec(), 1..=4);
    let measures = prop::sample::subsequence(names, 0..=SUMMARY.len())
        .prop_map(|names| Selection::from_names(names).unwrap());
    let ranked: Vec<&str> = ranked().map(|column| column.name).collect();
    let report = (prop::sample::select(ranked), 1..1000_usize);
    let model = absorbers().prop_flat_map(|list| (spec(list.clone()), sampling(list[0].kind)));
    (model, tables, measures, report, 1..=1_000_000_u32, any::<bool>()).prop_map(
        |((spec, sampling), tables, measures, (best_by, count), samples_per_period, errors)| {
            let study = Study { spec, sampling, tables, measures, errors };
            StudyFile {
                report: Report {
                    best_by: Some(best_by).filter(|name| measures.contains(name)).or(Report::new(
                        measures,
                        &study.spec(0).unwrap(),
                    )
                    .best_by),
                    count,
                },
                study,
                samples_per_period,
                source: Source::new(Path::new("made.toml"), ""),
            }
        },
    )
}

fn assert_same(one: &StudyFile, other: &StudyFile, text: &str) {
    assert_eq!(one.study, other.study, "{text}");
    assert_eq!(one.report, other.report, "{text}");
    assert_eq!(one.samples_per_period, other.samples_per_period, "{text}");
}

proptest! {
    #[test]
    fn what_is_written_reads_back_the_same(file in study_file()) {
        let resolved = fill_in(&file).unwrap();
        let text = text_of(&resolved, "any units");
        let read = parse_study(Path::new("study.toml"), &text)
            .unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_same(&read, &resolved, &text);
        // Resolving a resolved study changes nothing, down to the bytes.
        let again = fill_in(&read).unwrap();
        assert_same(&again, &resolved, &text);
        prop_assert_eq!(text_of(&again, "any units"), text);
    }
}

const STUDY: &str = "version = 1\n[absorber]\nkind = \"siva\"\nmass_ratio = 0.1\nrestitution = 0.5\n\
    clearance = 0.6\n[start]\nvelocity = 1\n[run]\nperiods = 60\n[sweep]\n\
    \"absorber.gap\" = { start = 0.1, stop = 1.2, count = 12 }\ndamping_ratio = [0, 0.01]\n";

#[test]
fn defaults_are_filled_in_and_replaced_values_left_out() {
    let file = parse_study(Path::new("my.toml"), STUDY).unwrap();
    let text = text_of(&resolve(&file).unwrap(), "any units");
    for line in [
        "displacement = 0.0",
        "velocity = 1.0",
        "max_impacts = 10000000",
        "max_work = 100000000",
        "tables = [\"summary\", \"impacts\"]",
        "samples_per_period = 200",
        "\"absorber.gap\" = { start = 0.1, stop = 1.2, count = 12 }",
        "damping_ratio = [0.0, 0.01]",
        "best_by = \"settling_time_5\"",
        "count = 10",
    ] {
        assert!(text.lines().any(|other| other == line), "{line}\n{text}");
    }
    assert!(text.starts_with(HEADER));
    assert!(!text.contains("\nclearance"), "{text}");
    assert!(text.find("absorber.gap") < text.find("damping_ratio = ["), "{text}");
}

/// Also beside a stop, which has none.
#[test]
fn starts_of_units_read_back_the_same() {
    let text = STUDY.split("[sweep]").next().unwrap().replace("[absorber]", "[[absorber]]\nunits = 2").replace(
        "[start]",
        "[[absorber]]\nkind = \"stop\"\nrestitution = 0.5\nclearance = 3\n[start]\ngap_displacement = [0.1, 0.2, 0]",
    );
    let file = resolve(&parse_study(Path::new("my.toml"), &text).unwrap()).unwrap();
    let again = parse_study(Path::new("study.toml"), &write(&file).unwrap()).unwrap();
    assert_same(&again, &file, &text);
    assert_eq!(again.study.spec.starts(FieldId::GapDisplacement), [0.1, 0.2, 0.0]);
    let other = parse_study(Path::new("my.toml"), &text.replace("0.2, 0]", "0.3, 0]")).unwrap();
    assert_ne!(Identity::of(&other.study).unwrap(), Identity::of(&file.study).unwrap());
}

#[test]
fn the_designs_are_the_same_before_and_after() {
    let hung = STUDY
        .replace("\"siva\"", "\"piva\"\nlength = 2.0\nmass = 0.1")
        .replace("mass_ratio = 0.1\n", "")
        .replace("[absorber]\n", "[primary]\nmass = 1.0\nstiffness = 9.0\n[absorber]\n");
    for text in [STUDY, &hung] {
        let file = parse_study(Path::new("my.toml"), text).unwrap();
        let text = write(&resolve(&file).unwrap()).unwrap();
        let read = parse_study(Path::new("study.toml"), &text).unwrap();
        let of = |file: &StudyFile| {
            schema(&file.study, Table::Summary, Identity::of(&file.study).unwrap())
                .unwrap()
                .metadata()["iva.study"]
                .clone()
        };
        assert_eq!(of(&file), of(&read), "{text}");
        assert!(text.contains("gravity = 9.80665") == text.contains("piva"), "{text}");
        for point in 0..file.study.points().unwrap() {
            let (one, other) = (file.study.design(point), read.study.design(point));
            assert_eq!(format!("{one:?}"), format!("{other:?}"));
        }
    }
}
