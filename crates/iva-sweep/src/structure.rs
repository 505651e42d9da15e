//! A structure with several modes as given by the user, in SI units.
//!
//! It takes the place of the fields of the primary. Its entries have the same names in a study file, where they are the
//! section `[structure]`, and in Python. Either its modes are given or its matrices.

use iva_core::absorber::Point;
use iva_core::absorber::modal::ModalStructure;
use iva_core::error::{Invalid, number};
use iva_core::number::real::Real;

use crate::fields::nearest;
use crate::forces::ForceSpec;

use reader::{Reader, counted, form};

mod reader;

/// Name of the section.
pub const SECTION: &str = "structure";

/// Names of its entries, in the order in which they are written.
pub const ENTRIES: [&str; 15] = [
    "frequencies",
    "frequencies_hz",
    "damping_ratios",
    "mass",
    "stiffness",
    "damping",
    "points",
    "base",
    "absorber_at",
    "force_at",
    "seen_at",
    "seen_mode",
    "natural_mode",
    "start_displacements",
    "start_velocities",
];

/// Those that are the number of a mode.
pub const MODES: [&str; 2] = ["seen_mode", "natural_mode"];

/// A frequency for the unit of time below this share of the largest is that of a structure that is free to move, but for rounding.
const ROUNDING: f64 = 1e-7;

/// The value of an entry.
#[derive(Debug, Clone, PartialEq)]
pub enum Entry {
    /// The number of a mode, from 1.
    Mode(usize),
    /// A name.
    Name(String),
    /// Names.
    Names(Vec<String>),
    /// Numbers.
    Numbers(Vec<f64>),
    /// The rows of a matrix.
    Rows(Vec<Vec<f64>>),
    /// Numbers by name.
    Named(Vec<(String, Vec<f64>)>),
}

/// A structure with several modes.
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    entries: Vec<(&'static str, Entry)>,
    system: System,
    /// Named points, with the mass-normalised shapes of the modes there in kg^(−1/2); without shapes where the points are
    /// the coordinates of matrices.
    points: Vec<(String, Vec<f64>)>,
    /// Of each mode or coordinate: how it takes part in a motion of the base.
    base: Option<Vec<f64>>,
    absorbers_at: Vec<String>,
    forces_at: Vec<String>,
    seen_at: Option<String>,
    /// Index of the mode of which runs see the part in the motion of their point; `None`: they see all of it.
    seen_mode: Option<usize>,
    /// Index of the mode whose frequency is the natural one.
    natural_mode: usize,
    /// Of each mode, in m kg^(1/2), or of each coordinate in m; and their rates.
    begun: [Vec<f64>; 2],
    /// ω of that mode in rad/s, whose reciprocal is the unit of time.
    natural_frequency: f64,
}

/// Names of points, each with the shapes of all modes there.
type Points = Vec<(String, Vec<f64>)>;

/// What moves.
#[derive(Debug, Clone, PartialEq)]
enum System {
    /// Frequencies in rad/s, or in Hz, and damping ratios.
    Modes { frequencies: Vec<f64>, hertz: bool, damping_ratios: Vec<f64> },
    /// Matrices of n rows, row by row.
    Matrices { mass: Vec<f64>, stiffness: Vec<f64>, damping: Vec<f64> },
}

impl Structure {
    /// A structure from its entries.
    ///
    /// # Errors
    /// [`Invalid`] naming the entry that is unknown, missing, of another form, or does not fit the others.
    pub fn new(given: impl IntoIterator<Item = (String, Entry)>) -> Result<Self, Invalid> {
        let mut entries: Vec<(&'static str, Entry)> = Vec::new();
        for (name, entry) in given {
            let Some(known) = ENTRIES.into_iter().find(|it| *it == name) else {
                let near = nearest(&name, ENTRIES.into_iter());
                let rule = near.map_or_else(
                    || format!("no such entry; there are {}", ENTRIES.join(", ")),
                    |near| format!("no such entry; did you mean `{near}`?"),
                );
                return Err(Invalid::new(SECTION, format!("`{name}`"), rule));
            };
            entries.push((known, entry));
        }
        entries.sort_by_key(|(name, _)| ENTRIES.iter().position(|it| it == name));
        let read = Reader { entries: &entries };
        let (system, points) = read.system()?;
        let n = match &system {
            System::Modes { frequencies, .. } => frequencies.len(),
            System::Matrices { .. } => points.len(),
        };
        let base = read.numbers("base")?.map(|numbers| counted("base", numbers, n)).transpose()?;
        let begun = |name| -> Result<Vec<f64>, Invalid> {
            read.numbers(name)?.map_or(Ok(Vec::new()), |numbers| counted(name, numbers, n))
        };
        let begun = [begun("start_displacements")?, begun("start_velocities")?];
        let named = |name| -> Result<Option<String>, Invalid> {
            read.names(name)?.map_or(Ok(None), |names| match names.as_slice() {
                [one] => Ok(Some(one.clone())),
                _ => Err(form(name, &Entry::Names(names), "the name of a point")),
            })
        };
        let mut seen_at = named("seen_at")?;
        let seen_mode = read.mode("seen_mode", n)?;
        let natural_mode = read.mode("natural_mode", n)?.unwrap_or(0);
        let named = |name: &mut String| {
            if name == "absorber" && points.iter().all(|(it, _)| it != name) {
                "absorber.0".clone_into(name);
            }
        };
        let [mut absorbers_at, mut forces_at] =
            [read.names("absorber_at")?, read.names("force_at")?].map(Option::unwrap_or_default);
        absorbers_at.iter_mut().chain(&mut forces_at).chain(&mut seen_at).for_each(named);
        let all = [
            ("force_at", &forces_at[..]),
            ("seen_at", seen_at.as_slice()),
            ("absorber_at", &absorbers_at[..]),
        ];
        for (field, given) in all {
            let known = |name: &String| points.iter().any(|(it, _)| it == name);
            if let Some(name) = given.iter().find(|name| !known(name) && body(name).is_none()) {
                let all: Vec<&str> = points.iter().map(|(name, _)| name.as_str()).collect();
                let rule = format!(
                    "give one of the points {}, or absorber.0 for the mass of the first absorber",
                    all.join(", ")
                );
                return Err(Invalid::new(path(field), format!("\"{name}\""), rule));
            }
        }
        let mut structure = Self {
            entries,
            system,
            points,
            base,
            absorbers_at,
            forces_at,
            seen_at,
            seen_mode,
            natural_mode,
            begun,
            natural_frequency: 1.0,
        };
        let modes: ModalStructure = structure.modes(1.0)?;
        let frequencies = (0..n).filter_map(|mode| modes.frequency(mode));
        let natural = modes.frequency(natural_mode).unwrap_or(0.0);
        if natural <= ROUNDING * frequencies.fold(0.0, f64::max) {
            let rule = format!(
                "that of mode {} is the unit of time, and this is 0 or rounding; hold the structure, or give \
                 natural_mode",
                natural_mode + 1
            );
            return Err(Invalid::new(path("frequencies"), number(natural), rule));
        }
        structure.natural_frequency = natural;
        Ok(structure)
    }

    /// The entries given.
    pub fn entries(&self) -> &[(&'static str, Entry)] {
        &self.entries
    }

    /// The same structure that begins at displacements of its modes or coordinates, with these rates.
    ///
    /// # Errors
    /// [`Invalid`] if there are more or fewer.
    pub fn begun_at(&self, [at, rates]: &[Vec<f64>; 2]) -> Result<Self, Invalid> {
        let [place, rate] = ["start_displacements", "start_velocities"];
        let kept = self.entries.iter().filter(|(name, _)| ![place, rate].contains(name));
        let kept = kept.map(|(name, entry)| ((*name).to_owned(), entry.clone()));
        let begun = [(place, at), (rate, rates)];
        let begun = begun.map(|(name, numbers)| (name.to_owned(), Entry::Numbers(numbers.clone())));
        Self::new(kept.chain(begun))
    }

    /// ω of the mode that natural frequency and period are those of, in rad/s.
    pub fn natural_frequency(&self) -> f64 {
        self.natural_frequency
    }

    /// What a force of 1 on a structure of 1 kg that moves as the natural mode does is to the point that runs see, where it acts there.
    ///
    /// # Errors
    /// As [`Structure::new`], which has made them once.
    pub(crate) fn natural_share(&self) -> Result<f64, Invalid> {
        let modes = self.in_si()?;
        let shape = modes.shapes(self.seen()).map_or(0.0, |shapes| shapes[self.natural_mode]);
        Ok(shape * shape)
    }

    /// Its modes in SI units.
    ///
    /// # Errors
    /// As [`Structure::new`], which has made them once.
    pub fn in_si(&self) -> Result<ModalStructure, Invalid> {
        self.modes(1.0)
    }

    /// The numbers of the absorbers whose masses are points, at which others ride, forces act or that runs see.
    pub(crate) fn bodies(&self) -> Vec<usize> {
        let all = self.absorbers_at.iter().chain(&self.forces_at).chain(&self.seen_at);
        let others = all.filter(|name| self.points().all(|it| it != **name));
        let mut bodies: Vec<usize> = others.filter_map(|name| body(name)).collect();
        bodies.sort_unstable();
        bodies.dedup();
        bodies
    }

    /// Names of its points.
    pub fn points(&self) -> impl Iterator<Item = &str> {
        self.points.iter().map(|(name, _)| name.as_str())
    }

    /// The point at which the absorber of this number rides, of so many.
    ///
    /// # Errors
    /// [`Invalid`] where no point is given, or not one for each.
    pub fn absorber_at(&self, absorber: usize, count: usize) -> Result<&str, Invalid> {
        match self.absorbers_at.as_slice() {
            [one] => Ok(one),
            [] => match self.points.as_slice() {
                [(one, _)] => Ok(one),
                _ => {
                    let names: Vec<&str> = self.points().collect();
                    let rule = format!("give one of the points {}", names.join(", "));
                    Err(Invalid::missing(path("absorber_at"), rule))
                }
            },
            all if all.len() == count => Ok(&all[absorber]),
            all => {
                let rule = format!("give one point for all, or {count}, one for each absorber");
                Err(Invalid::new(path("absorber_at"), format!("{} names", all.len()), rule))
            }
        }
    }

    /// The point of the first absorber, also where there is none, or else the first of all.
    fn first_absorber_at(&self) -> Option<&str> {
        self.absorbers_at.first().map(String::as_str).or_else(|| self.points().next())
    }

    /// The point that runs see.
    pub fn seen(&self) -> &str {
        self.seen_at.as_deref().or(self.first_absorber_at()).unwrap_or_default()
    }

    /// The number of the mode of which runs see the part, from 1; `None`: they see all of the motion.
    pub(crate) fn seen_mode(&self) -> Option<usize> {
        self.seen_mode.map(|mode| mode + 1)
    }

    /// What runs see, in words: a point, or the part of one mode in its motion.
    pub fn seen_in_words(&self) -> String {
        match self.seen_mode {
            Some(mode) => format!("{}, mode {}", self.seen(), mode + 1),
            None => self.seen().to_owned(),
        }
    }

    /// The modes with the point that runs see, and its name: where they see the part of one mode, a point that moves in no
    /// other.
    ///
    /// # Errors
    /// [`Invalid`] if a point has this name already.
    pub(crate) fn seen_of<R: Real>(
        &self,
        modes: ModalStructure<R>,
    ) -> Result<(ModalStructure<R>, String), Invalid> {
        let name = self.seen_in_words();
        let Some(mode) = self.seen_mode else { return Ok((modes, name)) };
        let mut part = vec![R::ZERO; modes.count()];
        part[mode] = modes.shapes(self.seen()).map_or(R::ZERO, |shapes| shapes[mode]);
        Ok((modes.with_point(&name, &part)?, name))
    }

    /// The point at which the force of this number acts, of so many.
    ///
    /// # Errors
    /// [`Invalid`] where several points are given, but not one for each force.
    pub(crate) fn force_at(&self, force: usize, count: usize) -> Result<&str, Invalid> {
        match self.forces_at.as_slice() {
            [] => Ok(self.first_absorber_at().unwrap_or_default()),
            [one] => Ok(one),
            all if all.len() == count => Ok(&all[force]),
            all => {
                let rule = format!("give one point for all, or {count}, one for each force");
                Err(Invalid::new(path("force_at"), format!("{} names", all.len()), rule))
            }
        }
    }

    /// The point on which records and impulses act, and harmonic forces unless they say otherwise: that of the first record or impulse
    /// that does not move the base, or else that of the first force.
    ///
    /// # Errors
    /// As [`Structure::force_at`], and if records and impulses have several points.
    pub(crate) fn pushed(&self, forces: &[ForceSpec]) -> Result<&str, Invalid> {
        let count = forces.len();
        let mut bound = (0..count).filter(|number| forces[*number].is_bound());
        let first = self.force_at(bound.next().unwrap_or(0), count.max(1))?;
        for number in bound {
            let point = self.force_at(number, count)?;
            if point != first {
                let rule = format!(
                    "another record or impulse acts at {first}: give all of them one point"
                );
                return Err(Invalid::new(path("force_at"), format!("\"{point}\""), rule));
            }
        }
        Ok(first)
    }

    /// The index of a point. Masses of absorbers come after the points of the structure.
    pub(crate) fn index_of(&self, point: &str) -> usize {
        let of_mass = || {
            let rank = self.bodies().iter().position(|it| Some(*it) == body(point));
            rank.map_or(0, |rank| self.points.len() + rank)
        };
        self.points().position(|name| name == point).unwrap_or_else(of_mass)
    }

    /// The structure of the core, with 1/`omega` (in s) as the unit of time.
    ///
    /// # Errors
    /// As of the core.
    pub(crate) fn modes<R: Real>(&self, omega: f64) -> Result<ModalStructure<R>, Invalid> {
        let omega = R::from(omega);
        let number = |values: &[f64]| -> Vec<R> { values.iter().copied().map(R::from).collect() };
        let (mut modes, mass) = match &self.system {
            System::Modes { frequencies, hertz, damping_ratios } => {
                let unit = if *hertz { R::TURN.value } else { R::ONE };
                let of = |frequency: &f64| unit * R::from(*frequency) / omega;
                let frequencies: Vec<R> = frequencies.iter().map(of).collect();
                (ModalStructure::new(&frequencies, &number(damping_ratios))?, None)
            }
            System::Matrices { mass, stiffness, damping } => {
                let names: Vec<&str> = self.points().collect();
                let scaled = |values: &[f64], by: R| -> Vec<R> {
                    values.iter().map(|value| R::from(*value) / by).collect()
                };
                let mass = number(mass);
                let [stiffness, damping] =
                    [scaled(stiffness, omega * omega), scaled(damping, omega)];
                let modes = ModalStructure::from_matrices(&names, &mass, &stiffness, &damping)?;
                (modes, Some(mass))
            }
        };
        for (name, shapes) in self.points.iter().filter(|_| mass.is_none()) {
            modes = modes.with_point(name, &number(shapes))?;
        }
        let Some(base) = &self.base else { return Ok(modes) };
        let base = number(base);
        let parts = match &mass {
            Some(mass) => modes.modal(mass, &base)?,
            None => base,
        };
        modes.with_base(&parts)
    }

    /// q and q̇ of all modes at the begin, of which those of the natural mode are what the point seen does there by
    /// `primary`: its displacement and velocity. The rates are in the unit of time of `modes`, that is 1/`omega`.
    ///
    /// # Errors
    /// [`Invalid`] if the point seen is at a node of the natural mode and is to move.
    pub(crate) fn begin<R: Real>(
        &self,
        modes: &ModalStructure<R>,
        primary: [R; 2],
        omega: f64,
    ) -> Result<[Vec<R>; 2], Invalid> {
        let mut begun = [Vec::new(), Vec::new()];
        for (k, (given, all)) in self.begun.iter().zip(&mut begun).enumerate() {
            let unit = R::from(if k == 0 { 1.0 } else { omega });
            let given: Vec<R> = given.iter().map(|value| R::from(*value) / unit).collect();
            *all = match &self.system {
                System::Matrices { mass, .. } if !given.is_empty() => {
                    let mass: Vec<R> = mass.iter().copied().map(R::from).collect();
                    modes.modal(&mass, &given)?
                }
                _ if given.is_empty() => vec![R::ZERO; modes.count()],
                _ => given,
            };
            if primary[k] == 0.0 {
                continue;
            }
            let shape = modes.shapes(self.seen()).map(|shapes| shapes[self.natural_mode]);
            let Some(shape) = shape.filter(|shape| *shape != 0.0) else {
                let field = ["start.displacement", "start.velocity"][k];
                let (seen, mode) = (self.seen(), self.natural_mode + 1);
                let rule = format!("{seen} is at a node of mode {mode}; give structure.seen_at");
                return Err(Invalid::new(field, crate::number(primary[k]), rule));
            };
            all[self.natural_mode] += primary[k] / shape;
        }
        Ok(begun)
    }

    /// Displacements of the modes or coordinates and their rates, as a start has them, by q and q̇ of the modes; masses that are
    /// points come after these.
    ///
    /// # Errors
    /// [`Invalid`] as of [`Structure::modes`].
    pub(crate) fn started(&self, modes: &[Point<f64>]) -> Result<[Vec<f64>; 2], Invalid> {
        let omega = self.natural_frequency;
        let structure: ModalStructure = self.modes(omega)?;
        let own = || modes.iter().take(structure.count());
        let of_modes = [own().map(|it| it.x).collect(), own().map(|it| it.v).collect()];
        let at = |q: &[f64], name| {
            let shapes = structure.shapes(name).unwrap_or_default();
            shapes.iter().zip(q).map(|(shape, q)| shape * q).sum()
        };
        let [displacements, mut velocities] = match &self.system {
            System::Modes { .. } => of_modes,
            System::Matrices { .. } => {
                of_modes.map(|q: Vec<f64>| self.points().map(|it| at(&q, it)).collect())
            }
        };
        velocities.iter_mut().for_each(|rate| *rate *= omega);
        Ok([displacements, velocities])
    }
}

/// The number of the absorber whose mass has this name, as a point.
fn body(name: &str) -> Option<usize> {
    name.strip_prefix("absorber.")?.parse().ok()
}

/// The path of an entry.
pub(crate) fn path(entry: &str) -> String {
    format!("{SECTION}.{entry}")
}
