//! Basins of attraction over two numbers of the start, in the user's units, see [`iva_core::orbit::basins`].

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use iva_core::error::Invalid;
use iva_core::orbit::attractors::{self as core, Attractor, Class, Search};
use iva_core::orbit::basin_entropy::entropy;
use iva_core::orbit::basins::{Cell, Ending};
use iva_core::orbit::neighbourhood::neighbourhoods;
use iva_core::orbit::{Coordinates, Trajectory};

use super::attractors::{searched, told_of};
use super::family::{Family, OfMember, with_member};
use super::starts::{Numbers, Startable, name_of};
use super::{Found, Missed, Outcome, Tracker};
use crate::choices::Kind;
use crate::design::Spec;
use crate::sweep::SweepError;
use crate::workers::Workers;

pub use iva_core::orbit::basin_entropy::Entropy;

/// The label of a cell that is not decided.
pub const UNDECIDED: i32 = -1;
/// The label of a cell that ends in a motion without impacts.
pub const NO_IMPACTS: i32 = -2;
/// The label of a cell that a cancelled call has not come to the end of.
pub const CUT: i32 = -3;
/// Most cells whose ends are looked at for attractors.
const MOST_SEARCHED: usize = 256;
/// So many times as many cycles as a cell has are run in search of attractors.
const SEARCHED_TIMES: u64 = 10;

/// A grid of starts: the other two numbers are those of the start of the spec.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane {
    /// The places of the number that goes across and of that which goes up, see [`place_of`](super::starts::place_of).
    pub axes: [usize; 2],
    /// The values of each.
    pub values: [Vec<f64>; 2],
}

/// What is asked of basins.
#[derive(Debug, Clone, PartialEq)]
pub struct Asked {
    /// The starts of known orbits, in the order of their labels; `None`: orbits are found from the cells.
    pub orbits: Option<Vec<Numbers>>,
    /// Most periods of an orbit.
    pub most_periods: u32,
    /// Most cycles of a cell.
    pub most_cycles: u64,
    /// Side of the boxes of the entropy, in cells.
    pub side: usize,
}

/// An orbit that no cell has the label of.
#[derive(Debug, Clone, PartialEq)]
pub enum LeftOut {
    /// The run from a given orbit ends in something else: it is no stable orbit of the scene.
    Elsewhere {
        /// Its index among those given.
        index: usize,
        /// What the run ends in.
        class: Class,
    },
    /// A given orbit is one with another label.
    Again {
        /// Its index among those given.
        index: usize,
        /// The label.
        label: usize,
    },
    /// Starts end in an orbit that cannot be described.
    Untold {
        /// A start on it.
        start: Numbers,
        /// Number of periods after which it repeats.
        periods: u32,
        /// Why it cannot be described.
        why: Missed,
    },
    /// No neighbourhood of an orbit was found in which trajectories stay with it.
    NoNeighbourhood {
        /// Its label.
        label: usize,
    },
}

/// Basins.
#[derive(Debug, Clone)]
pub struct Basins {
    /// The attractors that were found from the cells, in the order of their labels; none where orbits were given, whose places are
    /// the labels then.
    pub attractors: Vec<Found>,
    /// Number of periods after which each repeats.
    pub periods: Vec<u32>,
    /// The labels, row by row upwards: index of an attractor, [`NO_IMPACTS`], [`UNDECIDED`] or [`CUT`].
    pub labels: Vec<i32>,
    /// The same where also cells that rounding errors may have decided have a label.
    pub likely: Vec<i32>,
    /// Number of cycles until each was known.
    pub cycles: Vec<u64>,
    /// The entropy of the likely labels.
    pub entropy: Option<Entropy>,
    /// The orbits that no cell can have the label of, with the reasons: cells that end in them are not decided.
    pub left_out: Vec<LeftOut>,
}

/// The basins of a scene. Once cancelled, the cells that are not finished are [`CUT`]: all of them, if the attractors are not
/// known yet. Cells are counted row by row.
///
/// # Errors
/// [`SweepError::Invalid`] as [`Family::new`], or if a start lies outside the gap.
pub fn basins(
    spec: &Spec,
    plane: &Plane,
    asked: &Asked,
    tracker: Tracker<'_>,
) -> Result<Basins, SweepError> {
    let family = Family::new(spec, None, 1)?;
    with_member!(&family.member, |it| labelled(&family, it, (plane, asked), tracker))
}

fn labelled<S: Startable + OfMember>(
    family: &Family,
    like: &Trajectory<S>,
    (plane, asked): (&Plane, &Asked),
    Tracker { cancel, done }: Tracker<'_>,
) -> Result<Basins, SweepError> {
    if family.structure.is_some() && asked.orbits.is_some() {
        let rule = "of several modes they are found from the cells; leave them out";
        return Err(Invalid::new("attractors", "given", rule).into());
    }
    plane.check(family)?;
    let starts = plane.starts();
    let all = |orbit: &Numbers| orbit.iter().copied().enumerate().collect::<Changed>();
    let sought = match &asked.orbits {
        Some(orbits) => orbits.iter().map(all).collect(),
        None => spread(&starts),
    };
    let begun = |starts: &[Changed]| -> Result<Vec<_>, Invalid> {
        starts.iter().map(|changed| family.begun(like, changed)).collect()
    };
    let search = Search {
        most_periods: asked.most_periods,
        most_cycles: asked.most_cycles.saturating_mul(SEARCHED_TIMES),
        join_mirrored: false,
    };
    let begins = begun(&sought)?;
    // What is counted are cells.
    let uncounted = Tracker { cancel, done: &AtomicU64::new(0) };
    let found = searched(&begins, search, uncounted)?;
    let Labels { attractors, periods, known, mut left_out } = match &asked.orbits {
        Some(_) => given_ones(&begins, &found),
        None => described(family, like, found.attractors, cancel),
    };
    let count = asked.orbits.as_ref().map_or(attractors.len(), Vec::len);
    let (labels, known): (Vec<usize>, Vec<_>) = known.into_iter().unzip();
    let mut near = neighbourhoods(like, &known, Some(cancel));
    near.iter_mut().for_each(|it| it.attractor = labels[it.attractor]);
    let without = labels.iter().filter(|label| near.iter().all(|it| it.attractor != **label));
    left_out.extend(without.map(|label| LeftOut::NoNeighbourhood { label: *label }));
    let columns = plane.values[0].len();
    let found_all = !cancel.load(Ordering::Relaxed);
    let rows = plane.values[1].len() as u64;
    let row = |row: u64| -> Result<Vec<Cell>, Invalid> {
        if cancel.load(Ordering::Relaxed) {
            let ending = Ending::Open(Outcome::Cancelled);
            return Ok(vec![Cell { ending, cycles: 0, error: 0.0 }; columns]);
        }
        let first = row as usize * columns;
        let trajectories = begun(&starts[first..first + columns])?;
        let cells =
            iva_core::orbit::basins::basins(&trajectories, &near, asked.most_cycles, Some(cancel));
        done.fetch_add(columns as u64, Ordering::Relaxed);
        cells
    };
    let rows = Workers::new(None)?.map(rows, row);
    let cells = rows.into_iter().collect::<Result<Vec<_>, Invalid>>()?.concat();
    let likely = |cell: &Cell| if found_all { ending(cell, asked.most_cycles) } else { CUT };
    let likely: Vec<i32> = cells.iter().map(likely).collect();
    let decided = |label: &i32| match *label {
        UNDECIDED | CUT => None,
        NO_IMPACTS => Some(count),
        label => usize::try_from(label).ok(),
    };
    let classes: Vec<Option<usize>> = likely.iter().map(decided).collect();
    let sure = |(cell, likely): (&Cell, &i32)| {
        if cell.is_sure() || *likely == CUT { *likely } else { UNDECIDED }
    };
    Ok(Basins {
        attractors,
        periods,
        labels: cells.iter().zip(&likely).map(sure).collect(),
        cycles: cells.iter().map(|cell| cell.cycles).collect(),
        entropy: entropy(&classes, columns, asked.side),
        likely,
        left_out,
    })
}

/// The orbits that cells can have the label of.
struct Labels<S: Coordinates> {
    /// What is told of those that were found from the cells, and the number of periods after which each repeats.
    attractors: Vec<Found>,
    periods: Vec<u32>,
    /// Labels and orbits.
    known: Vec<(usize, Attractor<S>)>,
    left_out: Vec<LeftOut>,
}

impl<S: Coordinates> Labels<S> {
    fn none() -> Self {
        Self { attractors: vec![], periods: vec![], known: vec![], left_out: vec![] }
    }
}

/// The orbits that were given, whose places are their labels. A run from each has to stay on it.
fn given_ones<S: Startable>(begins: &[Trajectory<S>], found: &core::Found<S>) -> Labels<S> {
    let mut all = Labels::none();
    for (index, (begin, class)) in begins.iter().zip(&found.classes).enumerate() {
        let orbit = match class {
            Class::Periodic(orbit) => found.attractors.get(*orbit),
            _ => None,
        };
        let start = begin.system.strobe(&begin.state);
        let near = |orbit: &Attractor<S>| orbit.is_near(&start, begin.system.clearance());
        let before = all.known.iter().find(|(_, known)| near(known));
        match (orbit.filter(|it| near(it)), before) {
            (Some(_), Some((label, _))) => {
                all.left_out.push(LeftOut::Again { index, label: *label });
            }
            (Some(orbit), None) => all.known.push((index, orbit.clone())),
            (None, _) => all.left_out.push(LeftOut::Elsewhere { index, class: *class }),
        }
    }
    all
}

/// The orbits that cells end in, with all that is told of them.
fn described<S: Startable>(
    family: &Family,
    like: &Trajectory<S>,
    found: Vec<Attractor<S>>,
    cancel: &AtomicBool,
) -> Labels<S> {
    let mut all = Labels::none();
    for orbit in found {
        match told_of(family, like, &orbit, cancel) {
            Ok(told) => {
                all.periods.push(orbit.periods() as u32);
                all.known.push((all.attractors.len(), orbit));
                all.attractors.push(told);
            }
            Err(why) => all.left_out.push(untold(family, like, &orbit, why)),
        }
    }
    all
}

/// Says of an orbit why it cannot be described.
pub(super) fn untold<S: Startable>(
    family: &Family,
    like: &Trajectory<S>,
    orbit: &Attractor<S>,
    why: Missed,
) -> LeftOut {
    let first = orbit.strobes.first();
    let start = first.map_or_else(Vec::new, |strobe| family.numbers_at(&like.system, strobe));
    LeftOut::Untold { start, periods: orbit.periods() as u32, why }
}

/// The label of a cell of at most so many cycles, whether it is sure or not.
fn ending(cell: &Cell, most_cycles: u64) -> i32 {
    match cell.ending {
        Ending::Attractor(index) => i32::try_from(index).unwrap_or(UNDECIDED),
        Ending::NoImpacts => NO_IMPACTS,
        Ending::Open(Outcome::Cancelled) => CUT,
        Ending::Open(Outcome::Finished) if cell.cycles < most_cycles => CUT,
        Ending::Open(_) => UNDECIDED,
    }
}

/// The numbers in which a start differs from that of the spec, by their places.
type Changed = Vec<(usize, f64)>;

impl Plane {
    /// Checks that no number is one of a stop in a list, which has no start of its own.
    fn check(&self, family: &Family) -> Result<(), Invalid> {
        let stands = |place: &usize| {
            let owner = place.checked_sub(2).and_then(|it| family.spec.owners().nth(it / 2));
            owner.is_some_and(|it| family.spec.choices_of(it).kind == Kind::Stop)
        };
        match self.axes.iter().find(|place| family.is_several() && stands(place)) {
            Some(place) => {
                let rule = "a stop on the ground has no start; give a number of the structure";
                Err(Invalid::new("over", name_of(*place, usize::MAX), rule))
            }
            None => Ok(()),
        }
    }

    /// The starts of all cells, row by row upwards.
    fn starts(&self) -> Vec<Changed> {
        let ([across, up], [x, y]) = (self.axes, &self.values);
        let cell = |x: &f64, y: &f64| vec![(across, *x), (up, *y)];
        y.iter().flat_map(|y| x.iter().map(move |x| cell(x, y))).collect()
    }
}

/// Some of many starts, spread evenly.
fn spread(starts: &[Changed]) -> Vec<Changed> {
    if starts.len() <= MOST_SEARCHED {
        return starts.to_vec();
    }
    // The multiples of the golden ratio: no two of them are in the same row or column for long.
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let place = |k: usize| (k as f64 * GOLDEN).fract() * starts.len() as f64;
    (0..MOST_SEARCHED).map(|k| starts[place(k) as usize].clone()).collect()
}
