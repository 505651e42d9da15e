//! The fields of one run as a user gives them, converted to the number type of the motion.

use std::marker::PhantomData;

use iva_core::real::Real;

use crate::choices::Choices;
use crate::error::Invalid;
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
    /// The field with respect to which results are differentiated, if any.
    by: Option<Slot>,
    numbers: PhantomData<R>,
}

impl<'a, R: Real> Given<'a, R> {
    /// The fields of a spec.
    pub fn new(spec: &'a Spec) -> Self {
        Self { spec, absorber: 0, by: None, numbers: PhantomData }
    }

    /// The fields of a spec, with the field to differentiate with respect to.
    pub fn differentiated(spec: &'a Spec, by: Slot) -> Self {
        Self { spec, absorber: 0, by: Some(by), numbers: PhantomData }
    }

    /// The same fields, with those of the absorber of this number in a list.
    pub(crate) fn of(&self, absorber: usize) -> Self {
        Self { absorber, ..*self }
    }

    /// Kind of the absorber, and model of a pendulum.
    pub(super) fn choices(&self) -> &Choices {
        self.spec.choices_of(self.absorber)
    }

    /// The place of a field that is not of a force.
    pub(super) fn slot(&self, field: FieldId) -> Slot {
        self.spec.slot(field, self.absorber)
    }

    /// The path of a field that is not of a force, for messages.
    pub(crate) fn path(&self, field: FieldId) -> String {
        self.slot(field).path()
    }

    /// The value given for a field that is not of a force.
    pub(super) fn get(&self, field: FieldId) -> Option<R> {
        let value = self.spec.get_of(self.absorber, field)?;
        Some(self.number(self.slot(field), value))
    }

    /// A value given for a field, as a number of the motion.
    pub(super) fn number(&self, slot: Slot, value: f64) -> R {
        let chosen = self.by.is_some_and(|by| by.field == slot.field && by.same_quantity(slot));
        R::given(value, chosen)
    }

    pub(super) fn at_most_one(&self, fields: &[FieldId]) -> Result<(), Invalid> {
        self.spec.at_most_one(self.absorber, fields)
    }
}
