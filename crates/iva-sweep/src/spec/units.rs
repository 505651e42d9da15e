//! The units of absorbers, and what each has of its own in the start.

use super::Spec;
use crate::choices::Kind;
use crate::error::{Invalid, number};
use crate::fields::FieldId;
use crate::slot::Slot;

impl Spec {
    /// Each unit of the scene, in the order of the list: the number of its absorber, and its own number there.
    pub fn members(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        (0..self.count()).flat_map(|k| (0..self.units_of(k)).map(move |unit| (k, unit)))
    }

    /// The number of the absorber of the list that each absorber of the scene is a unit of.
    pub fn owners(&self) -> impl Iterator<Item = usize> + '_ {
        self.members().map(|(absorber, _)| absorber)
    }

    /// Number of equal units of the absorber of this number.
    pub(crate) fn units_of(&self, absorber: usize) -> usize {
        self.get_of(absorber, FieldId::Units).map_or(1, |units| units as usize)
    }

    /// True if a unit has a start of its own.
    pub(crate) fn starts_units(&self) -> bool {
        !self.of_units.is_empty()
    }

    /// Puts what one unit has of its own.
    pub(super) fn put_of_unit(
        &mut self,
        field: FieldId,
        (absorber, unit): (usize, usize),
        value: Option<f64>,
    ) {
        let key = (field, absorber, unit);
        match value {
            Some(value) => self.of_units.insert(key, value),
            None => self.of_units.remove(&key),
        };
    }

    /// What one unit has of its own, if it has.
    pub(crate) fn get_of_unit(
        &self,
        field: FieldId,
        (absorber, unit): (usize, usize),
    ) -> Option<f64> {
        self.of_units.get(&(field, absorber, unit)).copied()
    }

    /// Where the numbers of a list belong that a field of the start is given as, so many: one for each absorber, or one for each
    /// unit. `None` is the place of a stop on the ground, which has no start of its own.
    ///
    /// # Errors
    /// What is allowed instead.
    pub fn start_slots(&self, field: FieldId, numbers: usize) -> Result<Vec<Option<Slot>>, String> {
        let (absorbers, units) = (self.count(), self.members().count());
        let starts = |slot: &Slot| self.choices_of(slot.number.unwrap_or(0)).kind != Kind::Stop;
        let one_of = |slot: Slot| Some(slot).filter(starts);
        Err(match (absorbers, units) {
            _ if self.choices().kind == Kind::None => {
                "there is no absorber; leave it out".to_owned()
            }
            _ if numbers == absorbers => {
                return Ok((0..absorbers).map(|k| one_of(self.slot(field, k))).collect());
            }
            _ if numbers == units => {
                let slots = self.members().map(|(k, unit)| one_of(Slot::of_unit(field, k, unit)));
                return Ok(slots.collect());
            }
            (1, 1) => "there is one absorber, so give one number".to_owned(),
            (1, _) => format!("give a number, or a list of {units}, one for each unit"),
            (_, _) if absorbers == units => {
                format!("give a number, or a list of {absorbers}, one for each absorber")
            }
            _ => format!(
                "give a number, or a list of {absorbers}, one for each absorber, or of {units}, one for each unit"
            ),
        })
    }

    /// Sets a field of the start from a list, see [`Spec::start_slots`].
    ///
    /// # Errors
    /// [`Invalid`] for a list of another length, and as [`Spec::set`].
    pub fn set_starts(&mut self, field: FieldId, numbers: &[f64]) -> Result<(), Invalid> {
        let slots = self.start_slots(field, numbers.len()).map_err(|rule| {
            let shown: Vec<String> = numbers.iter().map(|it| number(*it)).collect();
            Invalid::new(field.path(), format!("[{}]", shown.join(", ")), rule)
        })?;
        for (slot, value) in slots.into_iter().zip(numbers) {
            if let Some(slot) = slot {
                self.set(slot, *value)?;
            }
        }
        Ok(())
    }

    /// The list that a field of the start is given as, with 0 where nothing is given: a number for each unit where one has its own, or
    /// else for each of several absorbers. Empty where a number tells all, or nothing is given.
    pub fn starts(&self, field: FieldId) -> Vec<f64> {
        let of_units = self.of_units.keys().any(|(own, ..)| *own == field);
        let of = |(k, unit)| self.get_of_unit(field, (k, unit)).or(self.get_of(k, field));
        let all: Vec<Option<f64>> = match self.count() {
            _ if of_units => self.members().map(of).collect(),
            1 => Vec::new(),
            count => (0..count).map(|k| self.get_of(k, field)).collect(),
        };
        let is_given = all.iter().any(Option::is_some);
        all.into_iter().filter(|_| is_given).map(|value| value.unwrap_or(0.0)).collect()
    }
}
