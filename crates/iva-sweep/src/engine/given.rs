//! The fields of one run as a user gives them, converted to the number type of the motion.

use iva_core::real::Real;

use crate::choices::Choices;
use crate::error::{Invalid, number};
use crate::fields::FieldId;
use crate::slot::Slot;
use crate::spec::Spec;

/// The fields of one run.
#[derive(Debug, Clone, Copy)]
pub struct Given<'a, R = f64> {
    /// The fields.
    pub spec: &'a Spec,
    /// The number of the absorber whose fields are read.
    pub(super) absorber: usize,
    /// The number of the unit of that absorber whose start is read; `None`: that of all its units.
    unit: Option<usize>,
    /// A field whose value is another by this much, if there is one.
    shift: Option<(Slot, R)>,
}

impl<'a, R: Real> Given<'a, R> {
    /// The fields of a spec.
    pub fn new(spec: &'a Spec) -> Self {
        Self { spec, absorber: 0, unit: None, shift: None }
    }

    /// The fields of a spec, of which one, which is given, is larger by a step that doubles may not resolve.
    pub fn shifted(spec: &'a Spec, slot: Slot, step: R) -> Self {
        Self { shift: Some((slot, step)), ..Self::new(spec) }
    }

    /// The same fields, with those of the absorber of this number in a list.
    pub(crate) fn of(&self, absorber: usize) -> Self {
        Self { absorber, unit: None, ..*self }
    }

    /// The same fields, with the start of one unit of the absorber of this number.
    pub(super) fn of_unit(&self, absorber: usize, unit: usize) -> Self {
        Self { absorber, unit: Some(unit), ..*self }
    }

    /// What the unit has of its own, with its number.
    fn own(&self, field: FieldId) -> Option<(usize, f64)> {
        let unit = self.unit?;
        Some((unit, self.spec.get_of_unit(field, (self.absorber, unit))?))
    }

    /// The value given for a field that is not of a force, as it was given.
    fn value(&self, field: FieldId) -> Option<f64> {
        let own = self.own(field).map(|(_, value)| value);
        own.or_else(|| self.spec.get_of(self.absorber, field))
    }

    /// Kind of the absorber, and model of a pendulum.
    pub(super) fn choices(&self) -> &Choices {
        self.spec.choices_of(self.absorber)
    }

    /// The place of a field that is not of a force.
    pub(super) fn slot(&self, field: FieldId) -> Slot {
        match self.own(field) {
            Some((unit, _)) => Slot::of_unit(field, self.absorber, unit),
            None => self.spec.slot(field, self.absorber),
        }
    }

    /// The path of a field that is not of a force, for messages.
    pub(crate) fn path(&self, field: FieldId) -> String {
        self.slot(field).path()
    }

    /// The value given for a field that is not of a force.
    pub(super) fn get(&self, field: FieldId) -> Option<R> {
        Some(self.number(self.slot(field), self.value(field)?))
    }

    /// A value given for a field, as a number of the motion.
    pub(super) fn number(&self, slot: Slot, value: f64) -> R {
        let here = |by: &Slot| by.field == slot.field && by.same_quantity(slot);
        match self.shift {
            Some((by, step)) if here(&by) => R::from(value) + step,
            _ => R::from(value),
        }
    }

    pub(super) fn at_most_one(&self, fields: &[FieldId]) -> Result<(), Invalid> {
        let mut given = fields.iter().filter_map(|field| Some((*field, self.value(*field)?)));
        let (Some((first, _)), Some((second, value))) = (given.next(), given.next()) else {
            return Ok(());
        };
        let rule = format!("{} is given as well; give one of them", self.path(first));
        Err(Invalid::new(self.path(second), number(value), rule))
    }
}
