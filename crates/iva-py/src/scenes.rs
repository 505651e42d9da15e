//! Conversion of a spec into a Python dict, the opposite of [`arguments::spec`](crate::arguments::spec).

use iva_sweep::design::Spec;
use iva_sweep::fields::Part;
use iva_sweep::restitution_table;
use iva_sweep::structure::{Entry, SECTION};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::arguments::{FORCES, RECORD};
use crate::record::PyRecord;

/// A dict `"part.field"` → number, word, the list of points of a table of the restitution or a list of the start, under `"forces"` the list of
/// forces, and under `"structure"` the entries of a structure with several modes.
pub fn spec_dict<'py>(py: Python<'py>, spec: &Spec) -> PyResult<Bound<'py, PyDict>> {
    let scene = PyDict::new(py);
    let (part, count) = (Part::Absorber.name(), spec.count());
    for number in 0..count {
        let path = |name: &str| match count {
            1 => format!("{part}.{name}"),
            _ => format!("{part}.{number}.{name}"),
        };
        for (name, word) in spec.choices_of(number).words() {
            scene.set_item(path(name), word)?;
        }
        if let Some(table) = spec.restitution_table(number) {
            scene.set_item(path(restitution_table::NAME), table.points())?;
        }
    }
    if let Some(structure) = spec.structure() {
        let entries = PyDict::new(py);
        for (name, entry) in structure.entries() {
            match entry {
                Entry::Mode(mode) => entries.set_item(name, mode)?,
                Entry::Name(one) => entries.set_item(name, one)?,
                Entry::Names(all) => entries.set_item(name, all)?,
                Entry::Numbers(all) => entries.set_item(name, all)?,
                Entry::Rows(rows) => entries.set_item(name, rows)?,
                Entry::Named(all) => {
                    let named = PyDict::new(py);
                    for (name, numbers) in all {
                        named.set_item(name, numbers)?;
                    }
                    entries.set_item(name, named)?;
                }
            }
        }
        scene.set_item(SECTION, entries)?;
    }
    let forces = PyList::empty(py);
    for force in spec.forces() {
        let fields = PyDict::new(py);
        if let Some(record) = &force.record {
            fields.set_item(RECORD, PyRecord::of(record.clone()))?;
        }
        forces.append(fields)?;
    }
    for (slot, value) in spec.given() {
        match slot.info().part {
            Part::Force => {
                forces.get_item(slot.number.unwrap_or(0))?.set_item(slot.info().name, value)?;
            }
            _ if slot.info().part == Part::Start && slot.number.is_some() => {
                scene.set_item(slot.field.path(), spec.starts(slot.field))?;
            }
            _ => scene.set_item(slot.path(), value)?,
        }
    }
    if !forces.is_empty() {
        scene.set_item(FORCES, forces)?;
    }
    Ok(scene)
}
