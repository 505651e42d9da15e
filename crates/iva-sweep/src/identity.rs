//! The identity of a study, by which its tables are distinguished from those of other studies.

use std::fmt;

use iva_core::error::Invalid;

use crate::choices::CHOICES;
use crate::fields::FieldId;
use crate::sampling::Sampling;
use crate::study::Study;

/// A digest of a study and its number of points. It belongs to the whole study, also where only some of its
/// points are available.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Identity {
    /// Hash of everything that determines the results of the study.
    pub digest: u64,
    /// Number of points of the whole study.
    pub points: u64,
}

impl Identity {
    /// The identity of a study whose points are all available.
    ///
    /// # Errors
    /// As [`Study::points`] and [`Study::units`].
    pub fn of(study: &Study) -> Result<Self, Invalid> {
        Ok(Self { digest: digest(study)?, points: study.points()? })
    }
}

/// The digest as written to files: 16 hexadecimal digits.
impl fmt::Display for Identity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.digest)
    }
}

/// The 64-bit FNV-1a hash of everything that determines the results of a study: given fields, points,
/// measures.
///
/// A default value gives the same hash whether it was written or left out.
fn digest(study: &Study) -> Result<u64, Invalid> {
    let mut hash = 0xcbf2_9ce4_8422_2325;
    let mut add = |bytes: &[u8]| {
        for byte in bytes {
            hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    for absorber in 0..study.spec.count() {
        for (name, word) in study.spec.choices_of(absorber).words() {
            if CHOICES.iter().all(|choice| (choice.name, choice.words[0]) != (name, word)) {
                if absorber > 0 {
                    add(&[absorber as u8]);
                }
                add(word.as_bytes());
            }
        }
    }
    let spec = study.spec(study.sampling.first())?;
    for (slot, value) in spec.given() {
        let swept = study.sampling.sets(slot);
        let default = study.default(slot.field);
        // The quantity may be given as 0 under another name (displacement_mm); 0 is the default of most
        // quantities.
        let nothing = value == 0.0
            && default.is_none_or(|default| default == 0.0)
            && !(slot.field == FieldId::GapDisplacement && study.begins_on_a_stop());
        if !swept && !nothing && default != Some(value) {
            add(slot.path().as_bytes());
            add(&value.to_le_bytes());
        }
    }
    for (path, table) in spec.tables() {
        add(path.as_bytes());
        add(&(table.points().len() as u64).to_le_bytes());
        table.points().iter().flatten().for_each(|number| add(&number.to_le_bytes()));
    }
    for (name, entry) in spec.structure().map_or(&[][..], |it| it.entries()) {
        add(name.as_bytes());
        // The shortest decimals of doubles tell them apart.
        add(format!("{entry:?}").as_bytes());
    }
    for recorded in spec.forces().iter().filter_map(|force| force.record.as_ref()) {
        add(recorded.kind.name().as_bytes());
        let numbers = recorded.history.times().iter().chain(recorded.history.values());
        numbers.for_each(|number| add(&number.to_le_bytes()));
    }
    let axes = match &study.sampling {
        Sampling::Grid(axes) => axes.as_slice(),
        Sampling::Rows(rows) => {
            add(b"rows");
            rows.axes()
        }
        Sampling::Sample(sample) => {
            add(sample.method.name().as_bytes());
            add(&sample.count.to_le_bytes());
            add(&sample.seed.to_le_bytes());
            add(&[u8::from(sample.scramble)]);
            for variable in sample.variables() {
                let (name, numbers) = variable.given();
                add(variable.key.as_bytes());
                add(name.as_bytes());
                for (name, value) in numbers {
                    add(name.as_bytes());
                    add(&value.to_le_bytes());
                }
            }
            &[]
        }
    };
    for axis in axes {
        add(axis.key.as_bytes());
        add(&(axis.values.len() as u64).to_le_bytes());
        axis.values.iter().for_each(|value| add(&value.to_le_bytes()));
    }
    study.measures.names().for_each(|name| add(name.as_bytes()));
    if study.errors {
        add(b"errors");
    }
    Ok(hash)
}
