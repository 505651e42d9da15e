//! The reference event lists of `tests/reference`, whose README gives their origin and the meaning of the
//! fields.

use std::collections::BTreeMap;

use crate::{
    dd::Dd,
    driven,
    oracle::{Kind, Scene},
};
use iva_core::force::{Acts, Force, Harmonic};
use iva_core::host::DrivenHost;
use iva_core::piva;
use iva_core::siva::Siva;
use serde_json::Value;

/// One reference event.
#[derive(Debug, Clone)]
pub struct Expected {
    /// Kind of the event.
    pub kind: Kind,
    /// Instant, in 1/ωn.
    pub time: Dd,
    /// Wall, ±1.
    pub wall: f64,
    /// Velocity of the primary just before the event.
    pub velocity: Dd,
    /// Velocity of the absorber just before the event.
    pub absorber_velocity: Dd,
    /// Gap velocity just before the event.
    pub approach: Dd,
    /// Largest change of the time per unit change of an input.
    pub condition: f64,
}

/// A reference scene.
#[derive(Debug, Clone)]
pub struct Reference {
    /// Its name.
    pub name: String,
    /// Parameters, as the decimals of the file.
    pub scene: Scene,
    /// Its events in order, without the impacts of |approach| ≤ 1e-9.
    pub events: Vec<Expected>,
}

fn number(value: &Value) -> Dd {
    match value {
        Value::String(text) => Dd::parse(text),
        other => panic!("not a decimal in quotes: {other}"),
    }
}

/// All nine free decays of the free mass.
pub fn scenes() -> Vec<Reference> {
    let text = include_str!("../../reference/siva_free_decay.json");
    let file: Value = serde_json::from_str(text).expect("a JSON file");
    file.as_object().expect("an object").iter().map(|(name, value)| read(name, value)).collect()
}

/// A reference scene of the pendulum absorber.
#[derive(Debug, Clone)]
pub struct PivaReference {
    /// Its name.
    pub name: String,
    /// The numbers of the file under their names there, to 31 digits.
    pub given: BTreeMap<String, Dd>,
    /// Parameters as the nearest doubles.
    pub parameters: piva::Parameters,
    /// The force that drives it.
    pub force: Force,
    /// Displacement of the primary at the start, which is at rest.
    pub displacement: f64,
    /// Length of the run.
    pub duration: f64,
    /// Its events in order, without the impacts of |approach| ≤ 1e-9.
    pub events: Vec<Expected>,
}

impl PivaReference {
    /// The free mass under its force; `None` for a pendulum.
    pub fn mass(&self) -> Option<Siva<DrivenHost>> {
        if self.given.contains_key("r") {
            return None;
        }
        let p = &self.parameters;
        let under = driven::mass(p.mass_ratio, p.restitution, p.clearance, p.damping_ratio);
        Some(under(self.force.clone()))
    }
}

/// The four free decays of the pendulum absorber.
pub fn piva_scenes() -> Vec<PivaReference> {
    read_pendulums(include_str!("../../reference/piva_free_decay.json"))
}

/// The scenes under a harmonic force. A free mass is given by the parameters of a pendulum at small angles
/// without gravity; [`PivaReference::mass`] returns it as a free mass.
pub fn forced_scenes() -> Vec<PivaReference> {
    read_pendulums(include_str!("../../reference/forced.json"))
}

fn read_pendulums(text: &str) -> Vec<PivaReference> {
    let file: Value = serde_json::from_str(text).expect("a JSON file");
    let read = |(name, value): (&String, &Value)| {
        let scene = &value["scene"];
        let key = |key: &str| number(&scene[key]).value();
        let (mu, e, gamma, zeta) = (key("mu"), key("e"), key("gamma"), key("zeta"));
        let parameters = match scene.get("r") {
            None => piva::Parameters::free_mass(mu, e, gamma, zeta),
            Some(_) => piva::Parameters {
                frequency_ratio: key("r"),
                ..piva::Parameters::point_bob(mu, e, gamma, zeta, key("lam"))
            },
        };
        let harmonic = scene.get("F").map(|_| Harmonic {
            amplitude: key("F"),
            frequency: key("Omega"),
            phase: 0.0,
            acts: Acts::Primary,
        });
        let numbers = scene.as_object().expect("an object").iter();
        let given =
            numbers.filter(|(_, it)| it.is_string()).map(|(name, it)| (name.clone(), number(it)));
        PivaReference {
            name: name.clone(),
            given: given.collect(),
            parameters,
            force: Force::harmonic(harmonic.into_iter().collect()).expect("a force"),
            displacement: scene.get("x").map_or(1.0, |x| number(x).value()),
            duration: number(&value["tau_end"]).value(),
            events: events(value),
        }
    };
    file.as_object().expect("an object").iter().map(read).collect()
}

fn events(value: &Value) -> Vec<Expected> {
    let expected = |event: &Value| Expected {
        kind: match event["kind"].as_str() {
            Some("impact") => Kind::Impact,
            Some("stick") => Kind::Stick,
            Some("release") => Kind::Release,
            other => panic!("unknown kind {other:?}"),
        },
        time: number(&event["tau"]),
        wall: event["side"].as_f64().expect("a wall"),
        velocity: number(&event["v_main"]),
        absorber_velocity: number(&event["v_absorber"]),
        approach: number(&event["approach"]),
        condition: event["condition"].as_f64().expect("a condition"),
    };
    value["events"].as_array().expect("a list").iter().map(expected).collect()
}

fn read(name: &str, value: &Value) -> Reference {
    let scene = &value["scene"];
    let key = |key: &str, otherwise: f64| scene.get(key).map_or(otherwise.into(), number);
    Reference {
        name: name.to_owned(),
        scene: Scene {
            mass_ratio: number(&scene["mu"]),
            restitution: number(&scene["e"]),
            clearance: number(&scene["gamma"]),
            damping_ratio: number(&scene["zeta"]),
            start: [key("x", 1.0), key("v", 0.0), key("y", 0.0), key("dy", 0.0)],
            duration: number(&value["tau_end"]).value(),
        },
        events: events(value),
    }
}
