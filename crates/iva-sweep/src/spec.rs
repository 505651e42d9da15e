//! The fields of one run as a user gives them.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::choices::{Choices, Kind, only};
use crate::engine::design::Design;
use crate::engine::given::Given;
use crate::error::{Invalid, number};
use crate::fields::{FIELD_COUNT, FieldId, Part};
use crate::forces::{ForceSpec, Recorded};
use crate::restitution_table::{NAME, RestitutionTable};
use crate::slot::Slot;
use crate::structure::Structure;
use crate::units::{STANDARD_GRAVITY, UnitSystem};
use iva_core::absorber::modal;

mod units;

/// The fields of one run as given; all others have defaults or follow from them.
#[derive(Debug, Clone, PartialEq)]
pub struct Spec {
    choices: Choices,
    /// The values of all fields except those of forces, and of absorbers after the first.
    values: Values,
    /// The table of the restitution of the first absorber, if one is given.
    table: Option<RestitutionTable>,
    forces: Vec<ForceSpec>,
    /// The absorbers after the first.
    more: Vec<AbsorberSpec>,
    /// What units have of their own in the start, by field, number of the absorber and number of the unit.
    of_units: BTreeMap<(FieldId, usize, usize), f64>,
    /// The structure with several modes that takes the place of the primary, if one is given.
    structure: Option<Arc<Structure>>,
    /// True if a single absorber is a system of members, too.
    one_system: bool,
}

/// A value for each field.
type Values = [Option<f64>; FIELD_COUNT];

/// An absorber after the first, as given.
#[derive(Debug, Clone, PartialEq)]
struct AbsorberSpec {
    choices: Choices,
    /// The values of its fields, and of those of its start.
    values: Box<Values>,
    /// The table of its restitution, if one is given.
    table: Option<RestitutionTable>,
}

impl AbsorberSpec {
    /// One without fields.
    fn new(choices: Choices) -> Self {
        Self { choices, values: Box::new([None; FIELD_COUNT]), table: None }
    }
}

/// Largest number of absorbers.
pub const MOST_ABSORBERS: usize = modal::MOST;

impl Default for Spec {
    fn default() -> Self {
        Self::new(Choices::default())
    }
}

impl Spec {
    /// A spec without fields.
    pub fn new(choices: Choices) -> Self {
        Self {
            choices,
            values: [None; FIELD_COUNT],
            table: None,
            forces: Vec::new(),
            more: Vec::new(),
            of_units: BTreeMap::new(),
            structure: None,
            one_system: false,
        }
    }

    /// A spec of several absorbers without fields.
    ///
    /// # Errors
    /// [`Invalid`] for none or too many, and for one that is none.
    pub fn several(absorbers: &[Choices]) -> Result<Self, Invalid> {
        let count = absorbers.len();
        let Some((first, others)) = absorbers.split_first().filter(|_| count <= MOST_ABSORBERS)
        else {
            let rule = format!("give 1 to {MOST_ABSORBERS} absorbers");
            return Err(Invalid::new("absorber", format!("a list of {count}"), rule));
        };
        if let Some(number) = absorbers.iter().position(|it| it.kind == Kind::None && count > 1) {
            let rule = "a list has absorbers only; leave it out";
            return Err(Invalid::new(format!("absorber.{number}.kind"), "\"none\"", rule));
        }
        let more = others.iter().copied().map(AbsorberSpec::new);
        Ok(Self { more: more.collect(), ..Self::new(*first) })
    }

    /// A spec of the same absorbers and structure without fields and forces: with what is no number alone.
    pub fn emptied(&self) -> Self {
        let more = self.more.iter();
        let more = more
            .map(|it| AbsorberSpec { table: it.table.clone(), ..AbsorberSpec::new(it.choices) });
        let (table, structure) = (self.table.clone(), self.structure.clone());
        Self { more: more.collect(), table, structure, ..Self::new(self.choices) }
    }

    /// Gives the absorber of this number a table of its restitution, of points (approach speed, restitution).
    ///
    /// # Errors
    /// As [`RestitutionLaw::table`](iva_core::absorber::restitution::RestitutionLaw::table), and for an absorber that is
    /// not there or no free mass.
    pub fn set_restitution_table(
        &mut self,
        absorber: usize,
        points: &[[f64; 2]],
    ) -> Result<(), Invalid> {
        let path = self.table_path(absorber);
        let table = RestitutionTable::new(&path, points)?;
        // Those that have a restitution by another law.
        let slot = Slot { number: Some(absorber), ..FieldId::YieldSpeed.into() };
        self.check(slot).map_err(|rule| Invalid::new(path, table.shown(), rule))?;
        if let Some(place) = self.table_mut(absorber) {
            *place = Some(table);
        }
        Ok(())
    }

    /// The place of the table of the absorber of this number; `None` if there is no such absorber.
    fn table_mut(&mut self, absorber: usize) -> Option<&mut Option<RestitutionTable>> {
        match absorber.checked_sub(1) {
            None => Some(&mut self.table),
            Some(other) => self.more.get_mut(other).map(|it| &mut it.table),
        }
    }

    /// The table of the restitution of the absorber of this number, if one is given.
    pub fn restitution_table(&self, absorber: usize) -> Option<&RestitutionTable> {
        match absorber.checked_sub(1) {
            None => self.table.as_ref(),
            Some(other) => self.more.get(other)?.table.as_ref(),
        }
    }

    /// The path of that table, for messages.
    pub(crate) fn table_path(&self, absorber: usize) -> String {
        let slot = self.slot(FieldId::Restitution, absorber);
        match slot.number {
            Some(number) => format!("{}.{number}.{NAME}", Part::Absorber.name()),
            None => format!("{}.{NAME}", Part::Absorber.name()),
        }
    }

    /// The tables given, each with its path.
    pub(crate) fn tables(&self) -> impl Iterator<Item = (String, &RestitutionTable)> {
        let table = |k| Some((self.table_path(k), self.restitution_table(k)?));
        (0..self.count()).filter_map(table)
    }

    /// The same with a structure with several modes in the place of the primary.
    pub fn with_structure(self, structure: Arc<Structure>) -> Self {
        Self { structure: Some(structure), ..self }
    }

    /// The structure with several modes, if one is given.
    pub fn structure(&self) -> Option<&Arc<Structure>> {
        self.structure.as_ref()
    }

    /// The same, of which a single absorber is a system of members whatever terms it has: one kind for a term that vanishes.
    pub(crate) fn in_one_system(self) -> Self {
        Self { one_system: true, ..self }
    }

    /// True if a single absorber is such a system.
    pub(crate) fn is_one_system(&self) -> bool {
        self.one_system
    }

    /// Number of absorbers; 1 for a structure without absorber as well.
    pub fn count(&self) -> usize {
        1 + self.more.len()
    }

    /// Kind of absorber, and model of a pendulum; of several those of the first.
    pub fn choices(&self) -> &Choices {
        &self.choices
    }

    /// Those of the absorber of this number in a list.
    pub fn choices_of(&self, absorber: usize) -> &Choices {
        let other = absorber.checked_sub(1).and_then(|k| self.more.get(k));
        other.map_or(&self.choices, |it| &it.choices)
    }

    /// True if a field belongs to a kind of absorber that is given.
    pub fn has(&self, slot: Slot) -> bool {
        let kinds = slot.info().kinds;
        let mut absorbers = self.reached(slot);
        absorbers.any(|absorber| kinds.contains(&self.choices_of(absorber).kind))
    }

    /// The numbers of the absorbers that a slot is about; all for a field that is not of an absorber.
    fn reached(&self, slot: Slot) -> std::ops::Range<usize> {
        match slot.number.filter(|_| slot.field.of_absorber()) {
            Some(number) => number..self.count().min(number + 1),
            None => 0..self.count(),
        }
    }

    /// The place of a field that is not of a force, for the absorber of this number.
    pub fn slot(&self, field: FieldId, absorber: usize) -> Slot {
        if field.of_absorber() {
            Slot::of_absorber(field, absorber, self.count())
        } else {
            field.into()
        }
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

    /// Sets a field after checking its range. A field of a force adds a force if there is none. A field of an absorber
    /// without its number is set for all of several absorbers that have it.
    ///
    /// # Errors
    /// [`Invalid`] with field, value and range; for a field of another kind of absorber; or for a force that
    /// does not exist.
    pub fn set(&mut self, slot: impl Into<Slot>, value: f64) -> Result<(), Invalid> {
        let slot = slot.into();
        self.check(slot).map_err(|rule| Invalid::new(slot.path(), number(value), rule))?;
        let value = slot.check(value)?;
        if slot.info().part == Part::Force {
            self.force_at(slot, value)?.put(slot.field, Some(value));
        } else {
            self.put(slot, Some(value));
        }
        Ok(())
    }

    /// Checks that there is an absorber that has a field.
    ///
    /// # Errors
    /// What is allowed instead.
    pub fn check(&self, slot: Slot) -> Result<(), String> {
        let count = self.count();
        if slot.field.of_absorber() && slot.number.is_some_and(|number| number >= count) {
            return Err(match count {
                1 => "there is one absorber, number 0".to_owned(),
                _ => format!("there are {count} absorbers, numbered from 0"),
            });
        }
        if self.has(slot) { Ok(()) } else { Err(only(slot.info().kinds)) }
    }

    /// Puts a value of a field that is not of a force, for each absorber that a slot is about.
    fn put(&mut self, slot: Slot, value: Option<f64>) {
        let kinds = slot.info().kinds;
        if let (Some(absorber), Some(unit)) = (slot.number, slot.unit) {
            return self.put_of_unit(slot.field, (absorber, unit), value);
        }
        for absorber in self.reached(slot) {
            self.of_units.retain(|(field, owner, _), _| (*field, *owner) != (slot.field, absorber));
            if value.is_some() && !kinds.contains(&self.choices_of(absorber).kind) {
                continue;
            }
            let of_absorber = slot.field.of_absorber();
            let other = absorber.checked_sub(1).filter(|_| of_absorber);
            match other.map(|k| self.more.get_mut(k)) {
                Some(Some(other)) => other.values[slot.field as usize] = value,
                Some(None) => {}
                None => self.values[slot.field as usize] = value,
            }
        }
    }

    fn force_at(&mut self, slot: Slot, value: f64) -> Result<&mut ForceSpec, Invalid> {
        let count = self.forces.len();
        let wrong = |rule: String| Err(Invalid::new(slot.path(), number(value), rule));
        if count == 0 && slot.number.unwrap_or(0) == 0 {
            self.forces.push(ForceSpec::new(None));
        } else if slot.number.is_none() && count > 1 {
            let name = slot.info().name;
            return wrong(format!(
                "there are {count} forces; write force.0.{name}, force.1.{name}, …"
            ));
        }
        match self.forces.get_mut(slot.number.unwrap_or(0)) {
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
        if slot.field.same_quantity(FieldId::Restitution) {
            for absorber in self.reached(slot) {
                if let Some(place) = self.table_mut(absorber) {
                    *place = None;
                }
            }
        }
        for other in FieldId::all().filter(|other| other.same_quantity(slot.field)) {
            if other.info().part != Part::Force {
                self.put(Slot { field: other, ..slot }, None);
            } else if let Some(force) = self.forces.get_mut(slot.number.unwrap_or(0)) {
                force.put(other, None);
            }
        }
    }

    /// The value given for a field that does not belong to a force; of several absorbers that of the first.
    pub fn get(&self, field: FieldId) -> Option<f64> {
        self.values[field as usize]
    }

    /// The same, for the absorber of this number.
    pub fn get_of(&self, absorber: usize, field: FieldId) -> Option<f64> {
        match absorber.checked_sub(1).filter(|_| field.of_absorber()) {
            Some(other) => self.more.get(other)?.values[field as usize],
            None => self.get(field),
        }
    }

    /// The fields given, in table order, each for one absorber after the other, with those of the forces last.
    pub fn given(&self) -> impl Iterator<Item = (Slot, f64)> + '_ {
        let plain = FieldId::all().flat_map(move |id| {
            let absorbers = if id.of_absorber() { self.count() } else { 1 };
            (0..absorbers).filter_map(move |k| Some((self.slot(id, k), self.get_of(k, id)?)))
        });
        let of_units = self.of_units.iter();
        let of_units = of_units.map(|(&(field, absorber, unit), value)| {
            (Slot::of_unit(field, absorber, unit), *value)
        });
        let count = self.forces.len();
        let of_forces = self.forces.iter().enumerate().flat_map(move |(number, force)| {
            force.given().map(move |(id, value)| (Slot::of_force(id, number, count), value))
        });
        plain.chain(of_units).chain(of_forces)
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
            let same = slot.field.same_quantity(FieldId::Restitution);
            let absorber = slot.number.unwrap_or(0);
            if same && self.restitution_table(absorber).is_some() {
                let rule =
                    format!("{} is given as well; give one of them", self.table_path(absorber));
                return Err(Invalid::new(slot.path(), number(*value), rule));
            }
        }
        Ok(())
    }

    /// Standard gravity, where gravity is needed for an absorber and has a default (SI units); `None` otherwise.
    ///
    /// # Errors
    /// As [`Spec::units`].
    pub fn standard_gravity_of(&self, absorber: usize) -> Result<Option<f64>, Invalid> {
        let weighs = match self.choices_of(absorber).kind {
            Kind::Siva => true,
            Kind::Piva => self.get_of(absorber, FieldId::FrequencyRatio).is_none(),
            Kind::Stop | Kind::None => false,
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
}
