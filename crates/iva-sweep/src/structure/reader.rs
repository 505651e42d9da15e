//! Reading of the entries of a structure.

use iva_core::error::{Invalid, number};

use super::{Entry, Points, System, path};

/// The error for an entry of another form.
pub(super) fn form(name: &str, entry: &Entry, wanted: &str) -> Invalid {
    let given = match entry {
        Entry::Mode(number) => number.to_string(),
        Entry::Name(name) => format!("\"{name}\""),
        Entry::Names(all) => format!("{} names", all.len()),
        Entry::Numbers(all) if all.is_empty() => "an empty list".to_owned(),
        Entry::Numbers(all) => format!("{} numbers", all.len()),
        Entry::Rows(rows) => format!("{} rows", rows.len()),
        Entry::Named(all) => format!("numbers by {} names", all.len()),
    };
    Invalid::new(path(name), given, format!("give {wanted}"))
}

/// Numbers, if there are so many.
pub(super) fn counted(entry: &str, numbers: Vec<f64>, needed: usize) -> Result<Vec<f64>, Invalid> {
    if numbers.len() == needed {
        return Ok(numbers);
    }
    let rule = format!("give {needed}, one for each mode or coordinate");
    Err(Invalid::new(path(entry), format!("{} numbers", numbers.len()), rule))
}

/// Reads entries.
pub(super) struct Reader<'a> {
    pub entries: &'a [(&'static str, Entry)],
}

impl Reader<'_> {
    fn get(&self, name: &str) -> Option<&Entry> {
        self.entries.iter().find(|(it, _)| *it == name).map(|(_, entry)| entry)
    }

    pub fn numbers(&self, name: &str) -> Result<Option<Vec<f64>>, Invalid> {
        match self.get(name) {
            None => Ok(None),
            Some(Entry::Numbers(numbers)) => {
                finite(name, numbers)?;
                Ok(Some(numbers.clone()))
            }
            Some(other) => Err(form(name, other, "a list of numbers")),
        }
    }

    pub fn names(&self, name: &str) -> Result<Option<Vec<String>>, Invalid> {
        match self.get(name) {
            None => Ok(None),
            Some(Entry::Name(one)) => Ok(Some(vec![one.clone()])),
            Some(Entry::Names(names)) => Ok(Some(names.clone())),
            Some(other) => Err(form(name, other, "the name of a point, or a list of them")),
        }
    }

    /// The index of a mode, of so many.
    pub fn mode(&self, name: &str, n: usize) -> Result<Option<usize>, Invalid> {
        match self.get(name) {
            None => Ok(None),
            Some(Entry::Mode(mode)) if (1..=n).contains(mode) => Ok(Some(mode - 1)),
            Some(Entry::Mode(mode)) => {
                let rule = format!("give the number of a mode, from 1 to {n}");
                Err(Invalid::new(path(name), mode.to_string(), rule))
            }
            Some(other) => Err(form(name, other, "the number of a mode, from 1")),
        }
    }

    /// A matrix of n rows and columns, row by row.
    fn matrix(&self, name: &str, n: usize) -> Result<Option<Vec<f64>>, Invalid> {
        let rows = match self.get(name) {
            None => return Ok(None),
            Some(Entry::Rows(rows)) => rows,
            Some(other) => {
                return Err(form(name, other, "the rows of a matrix, each a list of numbers"));
            }
        };
        if rows.len() != n || rows.iter().any(|row| row.len() != n) {
            let rule = format!("give {n} rows of {n} numbers, as there are {n} points");
            return Err(Invalid::new(path(name), format!("{} rows", rows.len()), rule));
        }
        let all = rows.concat();
        finite(name, &all)?;
        Ok(Some(all))
    }

    /// The modes or the matrices, with the points.
    pub fn system(&self) -> Result<(System, Points), Invalid> {
        let modal = ["frequencies", "frequencies_hz", "damping_ratios"];
        let of_matrices = ["mass", "stiffness", "damping"];
        let given = |names: [&'static str; 3]| names.into_iter().find(|it| self.get(it).is_some());
        match (given(modal), given(of_matrices)) {
            (Some(one), Some(other)) => {
                let rule = format!("{} is given as well; give modes or matrices", path(one));
                Err(Invalid::new(path(other), "a matrix", rule))
            }
            (None, None) => {
                let rule = "give frequencies with damping_ratios and points, or mass, stiffness and damping";
                Err(Invalid::missing(path("frequencies"), rule))
            }
            (Some(_), None) => self.modal(),
            (None, Some(_)) => self.matrices(),
        }
    }

    fn modal(&self) -> Result<(System, Points), Invalid> {
        let [plain, hertz] = [self.numbers("frequencies")?, self.numbers("frequencies_hz")?];
        if let (Some(_), Some(hertz)) = (&plain, &hertz) {
            let rule = format!("{} is given as well; give one of them", path("frequencies"));
            return Err(Invalid::new(
                path("frequencies_hz"),
                format!("{} numbers", hertz.len()),
                rule,
            ));
        }
        let in_hertz = hertz.is_some();
        let frequencies = plain.or(hertz).ok_or_else(|| {
            Invalid::missing(path("frequencies"), "give those of all modes, in rad/s")
        })?;
        let given = if in_hertz { "frequencies_hz" } else { "frequencies" };
        if frequencies.is_empty() {
            return Err(Invalid::new(path(given), "an empty list", "give those of all modes"));
        }
        let negative = frequencies.iter().enumerate().find(|(_, frequency)| **frequency < 0.0);
        if let Some((mode, frequency)) = negative {
            let field = path(&format!("{given}[{mode}]"));
            return Err(Invalid::new(
                field,
                number(*frequency),
                "give 0 or a number greater than 0",
            ));
        }
        let n = frequencies.len();
        let damping_ratios = match self.numbers("damping_ratios")? {
            None => vec![0.0; n],
            Some(one) if one.len() == 1 => vec![one[0]; n],
            Some(all) => counted("damping_ratios", all, n)?,
        };
        let points = match self.get("points") {
            Some(Entry::Named(points)) if !points.is_empty() => points.clone(),
            Some(other) => {
                return Err(form("points", other, "the shapes of all modes at each named point"));
            }
            None => {
                let rule = "give the mass-normalised shapes of all modes at each named point";
                return Err(Invalid::missing(path("points"), rule));
            }
        };
        for (name, shapes) in &points {
            finite(&format!("points.{name}"), shapes)?;
            if shapes.len() != n {
                let rule = format!("give {n}, one for each mode");
                let field = path(&format!("points.{name}"));
                return Err(Invalid::new(field, format!("{} numbers", shapes.len()), rule));
            }
        }
        Ok((System::Modes { frequencies, hertz: in_hertz, damping_ratios }, points))
    }

    fn matrices(&self) -> Result<(System, Points), Invalid> {
        let names = match self.get("points") {
            Some(Entry::Names(names)) => names.clone(),
            Some(Entry::Name(name)) => vec![name.clone()],
            Some(other) => {
                return Err(form("points", other, "a list with the names of the coordinates"));
            }
            None => {
                let rule = "give a list with the names of the coordinates of the matrices";
                return Err(Invalid::missing(path("points"), rule));
            }
        };
        let n = names.len();
        let needed = |name: &str| {
            let rule = format!("give {n} rows of {n} numbers");
            self.matrix(name, n)?.ok_or_else(|| Invalid::missing(path(name), rule))
        };
        let [mass, stiffness] = [needed("mass")?, needed("stiffness")?];
        let damping = self.matrix("damping", n)?.unwrap_or_else(|| vec![0.0; n * n]);
        let points = names.into_iter().map(|name| (name, Vec::new())).collect();
        Ok((System::Matrices { mass, stiffness, damping }, points))
    }
}

/// Checks that all numbers are finite.
fn finite(name: &str, numbers: &[f64]) -> Result<(), Invalid> {
    match numbers.iter().find(|value| !value.is_finite()) {
        None => Ok(()),
        Some(value) => Err(Invalid::new(path(name), number(*value), "give finite numbers")),
    }
}
