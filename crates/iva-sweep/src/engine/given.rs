//! The numbers of one run as a user gives them, taken as numbers that the motion is carried in.

use super::core::real::{self, Real};
use crate::error::Invalid;
use crate::fields::FieldId;
use crate::slot::Slot;
use crate::spec::Spec;

/// The fields of one run.
#[derive(Debug, Clone, Copy)]
pub struct Given<'a> {
    /// The fields.
    pub spec: &'a Spec,
    /// The one that results are differentiated by, if any.
    by: Option<Slot>,
}

impl<'a> Given<'a> {
    /// The fields of a spec.
    pub fn new(spec: &'a Spec) -> Self {
        Self { spec, by: None }
    }

    /// The same, one of them to differentiate by.
    pub fn differentiated(spec: &'a Spec, by: Slot) -> Self {
        Self { spec, by: Some(by) }
    }

    /// The value given for a field that is not of a force.
    pub(super) fn get(&self, field: FieldId) -> Option<Real> {
        self.spec.get(field).map(|value| self.number(field.into(), value))
    }

    /// A value given for a field.
    pub(super) fn number(&self, slot: Slot, value: f64) -> Real {
        let chosen = self.by.is_some_and(|by| by.field == slot.field && by.same_quantity(slot));
        real::given(value, chosen)
    }

    pub(super) fn at_most_one(&self, fields: &[FieldId]) -> Result<(), Invalid> {
        self.spec.at_most_one(fields)
    }
}
