//! The units in which numbers are printed: those of the tables, but lengths in mm where a study gives any in mm.

use iva_sweep::fields::Quantity;
use iva_sweep::study::Study;
use iva_sweep::units::UnitSystem;

/// The units in which the numbers of a study are printed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shown {
    units: UnitSystem,
    millimetres: bool,
}

impl Shown {
    /// Those of a study.
    pub(crate) fn of(study: &Study, units: UnitSystem) -> Self {
        let given = study.spec.given().map(|(slot, _)| slot);
        let mut slots = given.chain(study.sampling.keys().map(|swept| swept.slot));
        let millimetres = units == UnitSystem::Si
            && slots.any(|slot| slot.info().quantity == Quantity::Millimetre);
        Self { units, millimetres }
    }

    /// A number of a table as it is printed.
    pub(crate) fn value(self, quantity: Quantity, value: f64) -> f64 {
        if self.millimetres && quantity == Quantity::Length { 1000.0 * value } else { value }
    }

    /// The unit of that number, or nothing if it is 1 or too long for a column.
    pub(crate) fn unit(self, quantity: Quantity) -> &'static str {
        if self.millimetres && quantity == Quantity::Length {
            return "mm";
        }
        self.unit_of_axis(quantity)
    }

    /// The same for a swept value, which is printed as it was given.
    pub(crate) fn unit_of_axis(self, quantity: Quantity) -> &'static str {
        match self.units.unit(quantity) {
            "1" => "",
            unit if unit.chars().count() <= 8 => unit,
            _ => "",
        }
    }
}

#[cfg(test)]
mod tests {
    use iva_sweep::design::Spec;
    use iva_sweep::fields::FieldId;

    use super::*;

    #[test]
    fn lengths_are_in_mm_where_one_is_given_so() {
        for (field, length) in [(FieldId::GapMm, (4.0, "mm")), (FieldId::Gap, (0.004, "m"))] {
            let mut spec = Spec::default();
            spec.set(field, 1.0).unwrap();
            let shown = Shown::of(&Study::single(spec), UnitSystem::Si);
            assert_eq!(
                (shown.value(Quantity::Length, 0.004), shown.unit(Quantity::Length)),
                length
            );
            assert_eq!(shown.value(Quantity::Velocity, 0.004), 0.004);
        }
    }
}
