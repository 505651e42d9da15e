//! A scene from the lines that describe it.

use iva_sweep::Invalid;
use iva_sweep::axis::Axis;
use iva_sweep::choices::Choices;
use iva_sweep::design::Spec;
use iva_sweep::slot::Slot;
use iva_sweep::watched::{TAKEN, takes};

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
        let (mut choices, mut scene) = (Choices::default(), Self::default());
        let lines = || text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
        for words in lines() {
            if let ["choose", name, word] = words[..] {
                choices.choose(name, word)?;
            }
        }
        scene.spec = Spec::new(choices);
        for words in lines() {
            match words[..] {
                [] | ["choose", ..] => {}
                ["set", path, value] => {
                    scene.spec.set(Slot::from_key(path)?, number(path, value)?)?
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

/// The units of a scene that can be run.
///
/// # Errors
/// [`Invalid`] for one that cannot, here or at all.
pub fn units_of(spec: &Spec) -> Result<&'static str, Invalid> {
    spec.distinct()?;
    let design = spec.design()?;
    if takes(&design) { Ok(design.units.name()) } else { Err(refused(spec)) }
}

/// What is said of a scene that is not for the event loop alone.
pub fn refused(spec: &Spec) -> Invalid {
    Invalid::new("force", spec.forces().len(), TAKEN)
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

    fn told(more: &str) -> Result<&'static str, String> {
        let read = Scene::read(&format!("{SCENE}\n{more}"));
        read.and_then(|scene| units_of(&scene.spec)).map_err(|invalid| invalid.to_string())
    }

    #[test]
    fn what_cannot_be_run_is_refused_with_its_field() {
        assert_eq!(told(""), Ok("natural"));
        assert_eq!(told("set force.amplitude 0.1\nset force.frequency 1"), Ok("natural"));
        for (more, field) in [
            ("set absorber.restitution 1.5", "absorber.restitution"),
            ("set absorber.gap 1", "absorber.gap"),
            ("set absorber.mass_ratio much", "absorber.mass_ratio"),
            ("set run.tolerance 1e-9", "no tolerance"),
            ("set force.velocity 1", "one harmonic force"),
            ("drop everything", "no such instruction"),
        ] {
            let sentence = told(more).expect_err(more);
            assert!(sentence.contains(field), "{more}: {sentence}");
        }
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
