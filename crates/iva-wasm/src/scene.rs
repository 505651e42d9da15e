//! A scene from the lines that describe it.

use iva_sweep::Invalid;
use iva_sweep::axis::Axis;
use iva_sweep::choices::Choices;
use iva_sweep::design::Spec;
use iva_sweep::slot::Slot;

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
