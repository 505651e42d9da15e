//! A scene from the lines that describe it.

use std::sync::Arc;

use iva_sweep::Invalid;
use iva_sweep::axis::Axis;
use iva_sweep::choices::Choices;
use iva_sweep::design::Spec;
use iva_sweep::fields::{FieldId, Part};
use iva_sweep::forces::{ForceSpec, History, RecordKind, Recorded, Selection};
use iva_sweep::slot::Slot;
use iva_sweep::structure::{Entry, Structure};
use iva_sweep::watched::check;

use crate::json;

/// What the lines of a text say.
#[derive(Debug, Default)]
pub struct Scene {
    /// The choices and fields.
    pub spec: Spec,
    /// The axes of a map.
    pub axes: Vec<Axis>,
    /// The measure of a map.
    pub measure: Option<String>,
}

impl Scene {
    /// Reads the lines.
    ///
    /// # Errors
    /// [`Invalid`] for the first value that cannot be used, and for a line that says nothing known.
    pub fn read(text: &str) -> Result<Self, Invalid> {
        let lines = || text.lines().map(|line| line.split(' ').collect::<Vec<_>>());
        let mut absorbers: Vec<Choices> = vec![];
        let mut entries = vec![];
        for words in lines() {
            match words[..] {
                ["choose", name, word] => {
                    if name == "kind" || absorbers.is_empty() {
                        absorbers.push(Choices::default());
                    }
                    if let Some(last) = absorbers.last_mut() {
                        last.choose(name, word)?;
                    }
                }
                ["entry", name, form, ref values @ ..] => add(&mut entries, name, form, values)?,
                _ => {}
            }
        }
        let mut spec = Spec::several(&absorbers)?;
        if !entries.is_empty() {
            spec = spec.with_structure(Arc::new(Structure::new(entries)?));
        }
        let mut scene = Self { spec, ..Self::default() };
        for words in lines() {
            match words[..] {
                [""] | ["choose" | "entry", ..] => {}
                ["set", path, value] => {
                    scene.spec.set(Slot::from_key(path)?, number(path, value)?)?
                }
                ["starts", name, ref values @ ..] => {
                    let field = FieldId::find(Part::Start, name);
                    let field =
                        field.ok_or_else(|| Invalid::new("start", name, "no such field"))?;
                    scene.spec.set_starts(field, &numbers(values)?)?;
                }
                ["force"] => scene.spec.add_force(ForceSpec::new(None)),
                ["record", kind, ref values @ ..] => {
                    scene.spec.add_force(ForceSpec::new(Some(record(kind, &numbers(values)?)?)));
                }
                ["table", absorber, ref values @ ..] => {
                    let absorber = absorber.parse().unwrap_or(usize::MAX);
                    scene.spec.set_restitution_table(absorber, numbers(values)?.as_chunks().0)?;
                }
                ["axis", path, ref values @ ..] => {
                    let values = values.iter().map(|value| number(path, value));
                    scene.axes.push(Axis::new(path, values.collect::<Result<_, _>>()?)?);
                }
                ["measure", name] => scene.measure = Some(name.to_owned()),
                _ => return Err(Invalid::new("line", words.join(" "), "no such instruction")),
            }
        }
        Ok(scene)
    }
}

/// Adds what a line tells of an entry of a structure: all of it, or one more row or named list of numbers.
fn add(
    entries: &mut Vec<(String, Entry)>,
    name: &str,
    form: &str,
    values: &[&str],
) -> Result<(), Invalid> {
    let texts = || values.iter().map(|text| decoded(text));
    let entry = match (form, values) {
        ("row", _) => Entry::Rows(vec![numbers(values)?]),
        ("named", [point, own @ ..]) => Entry::Named(vec![(decoded(point), numbers(own)?)]),
        ("mode", [mode]) => Entry::Mode(mode.parse().unwrap_or(0)),
        ("name", [_]) => Entry::Name(texts().collect()),
        ("names", _) => Entry::Names(texts().collect()),
        ("numbers", _) => Entry::Numbers(numbers(values)?),
        _ => return Err(Invalid::new("entry", format!("{name} {form}"), "no such form")),
    };
    let begun = entries.iter_mut().find(|(known, _)| known == name).map(|(_, entry)| entry);
    match (begun, entry) {
        (Some(Entry::Rows(rows)), Entry::Rows(more)) => rows.extend(more),
        (Some(Entry::Named(all)), Entry::Named(more)) => all.extend(more),
        (_, entry) => entries.push((name.to_owned(), entry)),
    }
    Ok(())
}

/// A name without the signs that stand for spaces and other letters: %20 for a space.
fn decoded(text: &str) -> String {
    let mut parts = text.split('%');
    let mut bytes = parts.next().unwrap_or_default().as_bytes().to_vec();
    for part in parts {
        let (code, rest) = part.split_at_checked(2).unwrap_or((part, ""));
        bytes.extend(u8::from_str_radix(code, 16));
        bytes.extend(rest.as_bytes());
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// A recorded force of times and values in turns.
fn record(kind: &str, points: &[f64]) -> Result<Recorded, Invalid> {
    let known = RecordKind::from_name(kind);
    let kind = known.ok_or_else(|| Invalid::new("force.kind", kind, "no such kind"))?;
    let (times, values) = points.chunks_exact(2).map(|it| (it[0], it[1])).unzip();
    let history = Arc::new(History::new(times, values)?);
    Ok(Recorded { history, kind, file: None, selection: Selection::default(), is_metric: false })
}

/// The units of a scene that can be run, its natural frequency in the user's unit, and of each absorber its number in the
/// list, the point where it is, and its walls.
///
/// # Errors
/// [`Invalid`] for one that cannot, here or at all.
pub fn checked(spec: &Spec) -> Result<String, Invalid> {
    spec.distinct()?;
    let design = spec.design()?;
    check(&design)?;
    let owners = spec.owners().take(design.scene.count()).enumerate();
    let absorbers = owners.map(|(place, owner)| {
        let at = spec.structure().map(|it| it.absorber_at(owner, spec.count())).transpose()?;
        Ok(json::object([
            ("owner", owner.to_string()),
            ("point", at.map_or("null".to_owned(), json::text)),
            ("walls", json::list(design.scene.walls_of(place).map(json::number))),
        ]))
    });
    Ok(json::object([
        ("units", json::text(design.units.name())),
        ("natural", json::number(design.scale.natural_frequency)),
        ("absorbers", json::list(absorbers.collect::<Result<Vec<_>, Invalid>>()?)),
    ]))
}

fn numbers(values: &[&str]) -> Result<Vec<f64>, Invalid> {
    values.iter().map(|value| number("line", value)).collect()
}

fn number(path: &str, value: &str) -> Result<f64, Invalid> {
    value.parse().map_err(|_| Invalid::new(path, value, "give a number"))
}

/// An error as an object: the field, its value, what is allowed, and all in one sentence.
pub fn error(invalid: &Invalid) -> String {
    json::object([
        ("field", json::text(&invalid.field)),
        ("value", json::text(&invalid.value)),
        ("allowed", json::text(&invalid.allowed)),
        ("sentence", json::text(&invalid.to_string())),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "choose kind siva\nset absorber.mass_ratio 0.1\nset absorber.restitution 0.6\n\
                         set absorber.clearance 0.5\nset start.displacement 1\nset run.periods 5";

    fn told(more: &str) -> Result<String, String> {
        let read = Scene::read(&format!("{SCENE}\n{more}"));
        read.and_then(|scene| checked(&scene.spec)).map_err(|invalid| invalid.to_string())
    }

    #[test]
    fn what_cannot_be_run_is_refused_with_its_field() {
        let absorber = r#"{"owner":0,"point":null,"walls":[-0.5,0.5]}"#;
        let scene = format!(r#"{{"units":"natural","natural":1.0,"absorbers":[{absorber}]}}"#);
        assert_eq!(told(""), Ok(scene.clone()));
        assert_eq!(told("set force.amplitude 0.1\nset force.frequency 1"), Ok(scene));
        for (more, field) in [
            ("set absorber.restitution 1.5", "absorber.restitution"),
            ("set absorber.gap 1", "absorber.gap"),
            ("set absorber.mass_ratio much", "absorber.mass_ratio"),
            ("set run.tolerance 1e-9", "exact motion"),
            ("set force.velocity 1\nset force.frequency 1", "force.frequency"),
            ("table 0 1 0.5", "restitution_table"),
            ("entry points rows 1", "no such form"),
            ("record push 0 1", "no such kind"),
            ("drop everything", "no such instruction"),
        ] {
            let sentence = told(more).expect_err(more);
            assert!(sentence.contains(field), "{more}: {sentence}");
        }
    }

    #[test]
    fn a_list_rides_on_a_structure_with_modes() {
        let text = "choose kind siva\nchoose kind piva\nchoose angles small\n\
            entry frequencies numbers 6 20\nentry absorber_at names a%20b c\n\
            entry points named a%20b 0.1 0.08\nentry points named c 0.06 -0.09\n\
            set absorber.mass 2\nset absorber.restitution 0.6\nset absorber.clearance 0.1\n\
            set absorber.1.length 2\nset start.displacement 1\nset run.periods 2\nforce\nforce\n\
            set force.0.impulse 1\nset force.1.force 1\nset force.1.frequency 3";
        let scene = Scene::read(text).expect("a scene");
        let told = checked(&scene.spec).expect("one that can be run");
        assert!(told.starts_with(r#"{"units":"si","natural":6.0,"#), "{told}");
        assert!(told.contains(r#""owner":1,"point":"c""#), "{told}");
        let (text, _) = crate::run::run(&scene, 20, false).expect("a run");
        assert!(text.contains(r#""points":{"a b":["#), "{text}");
    }

    #[test]
    fn a_map_has_the_values_of_single_runs() {
        let more = "axis absorber.mass_ratio 0.05 0.2\naxis absorber.clearance 0.3 0.6 0.9\n\
                    measure settling_time_5";
        let map = crate::map::map(Scene::read(&format!("{SCENE}\n{more}")).expect("a scene"));
        let map = map.expect("a map");
        assert_eq!(map.len(), 6);
        let single = "set absorber.mass_ratio 0.2\nset absorber.clearance 0.6";
        let (text, _) = crate::run::run(
            &Scene::read(&format!("{SCENE}\n{single}")).expect("a scene"),
            20,
            false,
        )
        .expect("a run");
        let number = crate::json::number(map[4]);
        assert!(text.contains(&format!("\"settling_time_5\":{number}")), "{number}: {text}");
    }

    #[test]
    fn a_map_has_no_value_of_a_run_that_ended_early() {
        let more = "set run.max_work 10\naxis absorber.clearance 0.3 0.6\nmeasure impacts";
        let map = crate::map::map(Scene::read(&format!("{SCENE}\n{more}")).expect("a scene"));
        assert!(map.expect("a map").iter().all(|value| value.is_nan()));
    }
}
