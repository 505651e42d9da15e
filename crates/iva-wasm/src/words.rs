//! The fields and measures that a user may name, with their units and help.

use iva_sweep::choices::{CHOICES, Kind};
use iva_sweep::columns::{Better, SUMMARY};
use iva_sweep::fields::{FieldId, Quantity};
use iva_sweep::units::UnitSystem;

use crate::json::{self, list, object, text};

/// All fields, choices and measures.
pub fn described() -> String {
    let kinds = |kinds: &[Kind]| list(kinds.iter().map(|it| text(it.name())));
    let fields = FieldId::all().map(|id| {
        let field = id.info();
        object([
            ("path", text(&id.path())),
            ("part", text(field.part.name())),
            ("name", text(field.name)),
            ("quantity", text(&format!("{:?}", field.quantity))),
            ("units", units(field.quantity)),
            ("allowed", text(field.allowed.words())),
            ("help", text(field.help)),
            ("group", text(field.group)),
            ("kinds", kinds(field.kinds)),
            ("of_absorber", id.of_absorber().to_string()),
            ("default", id.default().map_or("null".to_owned(), json::number)),
        ])
    });
    let choices = CHOICES.iter().map(|choice| {
        object([
            ("name", text(choice.name)),
            ("words", list(choice.words.iter().map(|word| text(word)))),
            ("kinds", kinds(choice.kinds)),
            ("help", text(choice.help)),
        ])
    });
    let measures = SUMMARY.iter().map(|column| {
        let better = column.better.map(|better| match better {
            Better::Smaller => text("smaller"),
            Better::Larger => text("larger"),
        });
        object([
            ("name", text(column.name)),
            ("quantity", text(&format!("{:?}", column.quantity))),
            ("units", units(column.quantity)),
            ("help", text(column.help)),
            ("better", better.unwrap_or("null".to_owned())),
        ])
    });
    object([
        ("version", text(env!("CARGO_PKG_VERSION"))),
        ("fields", list(fields)),
        ("choices", list(choices)),
        ("measures", list(measures)),
    ])
}

/// The unit of a quantity in each system of units.
fn units(quantity: Quantity) -> String {
    object(UnitSystem::ALL.map(|system| (system.name(), text(system.unit(quantity)))))
}
