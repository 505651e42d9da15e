//! The fields of one run as a user gives them.

use crate::choices::{Choices, Kind, only};
use crate::engine::design::Design;
use crate::engine::given::Given;
use crate::error::{Invalid, number};
use crate::fields::{FIELD_COUNT, FieldId, Part};
use crate::forces::{ForceSpec, Recorded};
use crate::slot::Slot;
use crate::units::{STANDARD_GRAVITY, UnitSystem};

/// The fields of one run as given; all others have defaults or follow from them.
#[derive(Debug, Clone, PartialEq)]
pub struct Spec {
    choices: Choices,
    /// The values of all fields except those of forces.
    values: [Option<f64>; FIELD_COUNT],
    forces: Vec<ForceSpec>,
}

impl Default for Spec {
    fn default() -> Self {
        Self::new(Choices::default())
    }
}

impl Spec {
    /// A spec without fields.
    pub fn new(choices: Choices) -> Self {
        Self { choices, values: [None; FIELD_COUNT], forces: Vec::new() }
    }

    /// Kind of absorber, and model of a pendulum.
    pub fn choices(&self) -> &Choices {
        &self.choices
    }

    /// Adds a force; its fields are set afterwards.
    pub fn add_force(&mut self, force: ForceSpec) {
        self.forces.push(force);
    }

    /// The forces given.
    pub fn forces(&self) -> &[ForceSpec] {
        &self.forces
    }

    /// The records of forces, mutable so that their files can be named.
    pub fn records_mut(&mut self) -> impl Iterator<Item = &mut Recorded> {
        self.forces.iter_mut().filter_map(|force| force.record.as_mut())
    }

    /// True if a harmonic or recorded force is given.
    pub fn is_driven(&self) -> bool {
        self.forces.iter().any(ForceSpec::lasts)
    }

    /// Sets a field after checking its range. A field of a force adds a force if there is none.
    ///
    /// # Errors
    /// [`Invalid`] with field, value and range; for a field of another kind of absorber; or for a force that
    /// does not exist.
    pub fn set(&mut self, slot: impl Into<Slot>, value: f64) -> Result<(), Invalid> {
        let slot = slot.into();
        let kinds = slot.info().kinds;
        if !kinds.contains(&self.choices.kind) {
            return Err(Invalid::new(slot.path(), number(value), only(kinds)));
        }
        let value = slot.check(value)?;
        if slot.info().part == Part::Force {
            self.force_at(slot, value)?.put(slot.field, Some(value));
        } else {
            self.values[slot.field as usize] = Some(value);
        }
        Ok(())
    }

    fn force_at(&mut self, slot: Slot, value: f64) -> Result<&mut ForceSpec, Invalid> {
        let count = self.forces.len();
        let wrong = |rule: String| Err(Invalid::new(slot.path(), number(value), rule));
        if count == 0 && slot.force.unwrap_or(0) == 0 {
            self.forces.push(ForceSpec::new(None));
        } else if slot.force.is_none() && count > 1 {
            let name = slot.info().name;
            return wrong(format!(
                "there are {count} forces; write force.0.{name}, force.1.{name}, …"
            ));
        }
        match self.forces.get_mut(slot.force.unwrap_or(0)) {
            Some(force) => Ok(force),
            None if count == 1 => wrong("there is one force, number 0".to_owned()),
            None => wrong(format!("there are {count} forces, numbered from 0")),
        }
    }

    /// Sets a field in place of it and its alternatives.
    ///
    /// # Errors
    /// As [`Spec::set`].
    pub fn replace(&mut self, slot: impl Into<Slot>, value: f64) -> Result<(), Invalid> {
        let slot = slot.into();
        self.clear(slot);
        self.set(slot, value)
    }

    /// Removes a field and its alternatives.
    pub(crate) fn clear(&mut self, slot: Slot) {
        for other in FieldId::all().filter(|other| other.same_quantity(slot.field)) {
            if other.info().part != Part::Force {
                self.values[other as usize] = None;
            } else if let Some(force) = self.forces.get_mut(slot.force.unwrap_or(0)) {
                force.put(other, None);
            }
        }
    }

    /// The value given for a field that does not belong to a force.
    pub fn get(&self, field: FieldId) -> Option<f64> {
        self.values[field as usize]
    }

    /// The fields given, in table order, with those of the forces last.
    pub fn given(&self) -> impl Iterator<Item = (Slot, f64)> + '_ {
        let plain = FieldId::all().filter_map(|id| Some((Slot::from(id), self.get(id)?)));
        let count = self.forces.len();
        let of_forces = self.forces.iter().enumerate().flat_map(move |(number, force)| {
            force.given().map(move |(id, value)| (Slot::of_force(id, number, count), value))
        });
        plain.chain(of_forces)
    }

    /// Checks that no quantity is given twice, even if an axis replaces it.
    ///
    /// # Errors
    /// [`Invalid`] naming the later of two fields.
    pub fn distinct(&self) -> Result<(), Invalid> {
        let given: Vec<(Slot, f64)> = self.given().collect();
        for (index, (slot, value)) in given.iter().enumerate() {
            if let Some((earlier, _)) = given[..index].iter().find(|it| it.0.same_quantity(*slot)) {
                let rule = format!("{} is given as well; give one of them", earlier.path());
                return Err(Invalid::new(slot.path(), number(*value), rule));
            }
        }
        Ok(())
    }

    /// Standard gravity, where gravity is needed and has a default (SI units); `None` otherwise.
    ///
    /// # Errors
    /// As [`Spec::units`].
    pub fn standard_gravity(&self) -> Result<Option<f64>, Invalid> {
        let weighs = match self.choices().kind {
            Kind::Siva => true,
            Kind::Piva => self.get(FieldId::FrequencyRatio).is_none(),
            Kind::None => false,
        };
        let standard = weighs && self.units()? == UnitSystem::Si;
        Ok(standard.then_some(STANDARD_GRAVITY))
    }

    /// The unit system that follows from the fields of the primary system.
    ///
    /// # Errors
    /// [`Invalid`] if a frequency is missing beside a mass, or given twice.
    pub fn units(&self) -> Result<UnitSystem, Invalid> {
        Ok(Given::<f64>::new(self).scale()?.1)
    }

    /// The design that follows from these fields, in natural units.
    ///
    /// # Errors
    /// As [`Given::design`].
    pub fn design(&self) -> Result<Design, Invalid> {
        Given::new(self).design()
    }

    pub(crate) fn at_most_one(&self, fields: &[FieldId]) -> Result<(), Invalid> {
        let mut given = fields.iter().filter(|id| self.get(**id).is_some());
        match (given.next(), given.next()) {
            (Some(first), Some(second)) => Err(Invalid::new(
                second.path(),
                self.get(*second).map_or(String::new(), number),
                format!("{} is given as well; give one of them", first.path()),
            )),
            _ => Ok(()),
        }
    }
}
