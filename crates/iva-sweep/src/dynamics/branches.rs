//! Branches of periodic orbits over a field of a scene, and curves of their special points over two fields.
//!
//! A field is given in the user's units, and so is a row, but for the unknowns of its chain: those are in natural units. Lengths
//! along a branch are those of [`iva_core::orbit::branch`], shares of the range and of the sizes of the unknowns.

use std::borrow::Cow;
use std::sync::atomic::AtomicBool;

use iva_core::error::{Invalid, number};
use iva_core::orbit::Trajectory;
use iva_core::orbit::branch::{self, Along, Branch, BranchPoint, SpecialPoint, shooting};
use iva_core::orbit::curve::{self, AlongCurve, CurvePoint, SpecialCurve};
use iva_core::orbit::periodic::find;

use super::family::{Family, Member, OfMember, changeable, middled, with_member};
use super::{Found, Missed, Tracker, told};
use crate::design::Spec;
use crate::fields::FieldId;
use crate::slot::Slot;

pub use iva_core::absorber::Wall;
pub use iva_core::orbit::branch::End;
pub use iva_core::orbit::chain::Chain;
pub use iva_core::orbit::conditions::{Condition, Kind};
pub use iva_core::orbit::multipliers::Complex;

/// How a branch is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Way {
    /// The field that is changed.
    pub over: Slot,
    /// Its range, in the user's units.
    pub between: [f64; 2],
    /// Longest step, as a share of the range and of the sizes of the unknowns.
    pub longest: f64,
    /// Most points in each direction.
    pub most_points: usize,
}

/// A point of a branch.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The field that is changed.
    pub value: f64,
    /// Length along the branch.
    pub arclength: f64,
    /// Largest |x|.
    pub amplitude: f64,
    /// The multipliers, largest first.
    pub multipliers: Vec<Complex<f64>>,
    /// True if all are smaller than 1.
    pub stable: bool,
    /// Smallest distance of an extremum of the gap displacement between impacts from the wall that the absorber turns back
    /// from; infinite without one.
    pub grazing_margin: f64,
    /// Smallest approach speed, those within stick episodes after their first impact apart.
    pub approach_speed_min: f64,
    /// The unknowns of the chain, in natural units; without a chain the section, as a share of the cycle, and the numbers of the
    /// state there.
    pub unknowns: Vec<f64>,
}

/// A special point of a branch.
#[derive(Debug, Clone, PartialEq)]
pub struct Special {
    /// What happens there.
    pub condition: Condition,
    /// The orbit.
    pub row: Row,
}

/// A branch.
#[derive(Debug, Clone, PartialEq)]
pub struct Followed {
    /// Its sequence of impacts; without impacts where there are several members or modes, or something rubs.
    pub chain: Chain,
    /// The walls of such a branch.
    pub sequence: Option<String>,
    /// Its points in order.
    pub rows: Vec<Row>,
    /// The special points in the same order.
    pub special: Vec<Special>,
    /// Why it ends on either side.
    pub ends: [End; 2],
}

/// Why a branch was not followed.
#[derive(Debug, Clone, PartialEq)]
pub enum NoBranch {
    /// There is no orbit at the start.
    Missed(Missed),
    /// The orbit was not found as a solution of the equations of its chain, or no branch begins at the point.
    Lost,
}

/// The scene with other values of some fields, and the absorber in the middle of its gap, where it fits any clearance.
fn changed(spec: &Spec, slots: &[Slot], values: &[f64]) -> Result<Spec, Invalid> {
    let mut spec = spec.clone();
    for (slot, value) in slots.iter().zip(values) {
        spec.replace(*slot, *value)?;
    }
    middled(&spec)
}

fn family_at(spec: &Spec, slots: &[Slot], values: &[f64]) -> Result<Family, Invalid> {
    Family::new(&changed(spec, slots, values)?, None, 1)
}

/// The scenes of a spec at values of some fields, of the kind of a trajectory: the system, and the period of its drive.
fn scenes_like<'a, S: OfMember>(
    _like: &Trajectory<S>,
    spec: &'a Spec,
    slots: &'a [Slot],
) -> impl Fn(&[f64]) -> Result<(S, f64), Invalid> + 'a {
    move |values| {
        let Family { member, period, .. } = family_at(spec, slots, values)?;
        let other = || Invalid::missing("absorber", "give one of the kind of the orbit");
        Ok((S::of(member).ok_or_else(other)?.system, period))
    }
}

/// True if a field is one of friction, which no chain of impacts has.
fn is_friction(slot: Slot) -> bool {
    matches!(slot.field, FieldId::Friction | FieldId::StaticFriction)
}

/// The scene as its orbits are followed: as one of no chain of impacts, if it has none.
fn as_followed<'a>(spec: &'a Spec, chain: &Chain) -> Cow<'a, Spec> {
    if chain.tells() { Cow::Borrowed(spec) } else { Cow::Owned(spec.clone().in_one_system()) }
}

/// Checks fields and their ranges.
fn check(spec: &Spec, slots: &[Slot], between: &[[f64; 2]]) -> Result<(), Invalid> {
    for [low, high] in between {
        if low.is_nan() || high.is_nan() || low >= high {
            let shown = format!("({}, {})", number(*low), number(*high));
            return Err(Invalid::new("between", shown, "give two numbers, the smaller one first"));
        }
    }
    slots.iter().try_for_each(|slot| changeable(*slot))?;
    for end in [0, 1] {
        let values: Vec<_> = between.iter().map(|range| range[end]).collect();
        family_at(spec, slots, &values)?;
    }
    Ok(())
}

impl Row {
    fn new(spec: &Spec, slots: &[Slot], at: &BranchPoint) -> Result<Self, Invalid> {
        let Family { scale, .. } = family_at(spec, slots, &[at.value])?;
        Ok(Self {
            value: at.value,
            arclength: at.length,
            amplitude: at.amplitude,
            multipliers: at.multipliers.clone(),
            stable: at.is_stable(),
            grazing_margin: at.margin,
            approach_speed_min: scale.velocity(at.slowest),
            unknowns: at.unknowns.clone(),
        })
    }
}

impl Followed {
    fn new(spec: &Spec, slots: &[Slot], branch: &Branch) -> Result<Self, Invalid> {
        let Branch { chain, sequence, points, special, ends } = branch;
        let special = special.iter().map(|SpecialPoint { condition, at }| {
            Ok(Special { condition: *condition, row: Row::new(spec, slots, at)? })
        });
        Ok(Self {
            chain: chain.clone(),
            sequence: sequence.clone(),
            rows: points.iter().map(|at| Row::new(spec, slots, at)).collect::<Result<_, _>>()?,
            special: special.collect::<Result<_, Invalid>>()?,
            ends: *ends,
        })
    }
}

impl Followed {
    /// Number of impacts in a cycle; a stick episode counts as one.
    pub fn impacts(&self) -> usize {
        let listed = |walls: &String| walls.chars().filter(|it| "+-".contains(*it)).count();
        self.sequence.as_ref().map_or_else(|| self.chain.impacts(), listed)
    }
}

/// The value of a field in a spec.
///
/// # Errors
/// [`Invalid`] if the spec gives the quantity in another way, or not at all.
pub fn value_of(spec: &Spec, slot: Slot) -> Result<f64, Invalid> {
    let given = || spec.given().filter(|(other, _)| other.field == slot.field);
    if let Some((_, value)) = given().find(|(other, _)| *other == slot) {
        return Ok(value);
    }
    let (_, value) = given().next().ok_or_else(|| {
        Invalid::missing(
            slot.path(),
            "give the scene by the field that the branch is followed over",
        )
    })?;
    match given().find(|(_, other)| *other != value) {
        None => Ok(value),
        Some((other, _)) => {
            let rule =
                format!("not all of them have this value; follow one, such as {}", other.path());
            Err(Invalid::new(slot.path(), number(value), rule))
        }
    }
}

/// Follows the branch of the orbit near the start of a spec, over a field.
///
/// # Errors
/// [`Invalid`] for a field or a range that the scene does not allow, and as [`super::orbit`].
pub fn follow(
    spec: &Spec,
    (periods, symmetric): (u32, bool),
    way: &Way,
    tracker: Tracker<'_>,
) -> Result<Result<Followed, NoBranch>, Invalid> {
    let slots = [way.over];
    let value = value_of(spec, way.over)?;
    check(spec, &slots, &[way.between])?;
    let [low, high] = way.between;
    if !(low..=high).contains(&value) {
        let rule =
            format!("the orbit is outside the range from {} to {}", number(low), number(high));
        return Err(Invalid::new(way.over.path(), number(value), rule));
    }
    let along = along(way, tracker);
    let family = Family::new(spec, None, periods)?;
    // Where friction is what changes, there is some along the branch.
    if family.has_chain() && !is_friction(way.over) {
        let branch = with_member!(&family.member, |it| {
            find(it, symmetric, Some(tracker.cancel)).map(|orbit| {
                let (chain, at) = Chain::of(&orbit, periods).ok()?;
                let scenes = scenes_like(it, spec, &slots);
                Some(branch::follow(&scenes, (&chain, &at), value, along))
            })
        });
        match branch {
            Ok(Some(branch)) => return told_of(spec, &slots, branch),
            Ok(None) => {}
            Err(missed) => return no_orbit(missed),
        }
    }
    let spec = spec.clone().in_one_system();
    let Member::System(it) = Family::new(&spec, None, periods)?.member else {
        return Ok(Err(NoBranch::Lost));
    };
    match find(&it, symmetric, Some(tracker.cancel)) {
        Ok(orbit) => {
            let scenes = scenes_like(&it, &spec, &slots);
            let branch = shooting::follow(&scenes, (&orbit, periods), value, along);
            told_of(&spec, &slots, branch)
        }
        Err(missed) => no_orbit(missed),
    }
}

/// Why there is no orbit to follow.
fn no_orbit<T>(missed: Missed) -> Result<Result<T, NoBranch>, Invalid> {
    match missed {
        Missed::Invalid(invalid) => Err(invalid),
        missed => Ok(Err(NoBranch::Missed(missed))),
    }
}

/// What is told of a branch.
fn told_of(
    spec: &Spec,
    slots: &[Slot],
    branch: Option<Branch>,
) -> Result<Result<Followed, NoBranch>, Invalid> {
    let followed = branch.map(|it| Followed::new(spec, slots, &it)).transpose()?;
    Ok(followed.ok_or(NoBranch::Lost))
}

fn along<'a>(way: &Way, Tracker { cancel, done }: Tracker<'a>) -> Along<'a> {
    let Way { between, longest, most_points, .. } = *way;
    Along { between, most_points, longest, cancel: Some(cancel), done: Some(done) }
}

/// A special point as the core knows it.
fn special(condition: Condition, value: f64, unknowns: &[f64]) -> SpecialPoint {
    let none = Complex::new(f64::NAN, 0.0);
    let at = BranchPoint {
        value,
        length: 0.0,
        unknowns: unknowns.to_vec(),
        multipliers: vec![none],
        half_multipliers: None,
        amplitude: f64::NAN,
        margin: f64::NAN,
        slowest: f64::NAN,
    };
    SpecialPoint { condition, at }
}

/// A special point on a branch: its chain, what happens there, the value of the field, and the unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Begin {
    /// The chain of the branch.
    pub chain: Chain,
    /// What happens there.
    pub condition: Condition,
    /// The field that is changed.
    pub value: f64,
    /// The unknowns of the chain, in natural units.
    pub unknowns: Vec<f64>,
}

/// Follows the branch that begins at a special point of another.
///
/// # Errors
/// As [`follow`].
pub fn switch(
    spec: &Spec,
    begin: &Begin,
    way: &Way,
    tracker: Tracker<'_>,
) -> Result<Result<Followed, NoBranch>, Invalid> {
    let slots = [way.over];
    let spec = &*as_followed(spec, &begin.chain);
    check(spec, &slots, &[way.between])?;
    let family = family_at(spec, &slots, &[begin.value])?;
    let point = special(begin.condition, begin.value, &begin.unknowns);
    let (chain, along) = (&begin.chain, along(way, tracker));
    let branch = match &family.member {
        Member::System(it) if !chain.tells() => {
            let shape = (chain.symmetric, chain.cycles);
            shooting::switch(&scenes_like(it, spec, &slots), shape, &point, along)
        }
        member => with_member!(member, |it| {
            branch::switch(&scenes_like(it, spec, &slots), chain, &point, along)
        }),
    };
    told_of(spec, &slots, branch)
}

/// The orbit at a point of a branch.
///
/// # Errors
/// As [`follow`].
pub fn orbit_at(
    spec: &Spec,
    chain: &Chain,
    (over, value): (Slot, f64),
    unknowns: &[f64],
    cancel: &AtomicBool,
) -> Result<Result<Found, Missed>, Invalid> {
    let spec = changed(&as_followed(spec, chain), &[over], &[value])?;
    let family = Family::new(&spec, None, chain.cycles)?;
    let (period, cycles) = (family.period, chain.cycles);
    Ok(match &family.member {
        Member::System(it) if !chain.tells() => {
            let begin = it.cycle.begin;
            let shape = (unknowns, chain.symmetric);
            let orbit = shooting::orbit(&it.system, (period, cycles), shape, begin);
            orbit.and_then(|orbit| told(&family, begin, (&orbit, cycles), Some(cancel)))
        }
        member => with_member!(member, |it| {
            let begin = it.cycle.begin;
            let orbit = chain.orbit(&it.system, period, unknowns, begin);
            orbit.and_then(|orbit| told(&family, begin, (&orbit, cycles), Some(cancel)))
        }),
    })
}

/// How a curve is followed.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveWay {
    /// The two fields.
    pub over: [Slot; 2],
    /// Their ranges, in the user's units.
    pub between: [[f64; 2]; 2],
    /// Values of the first field at which a point is wanted wherever the curve comes by.
    pub at: Vec<f64>,
    /// Longest step, as a share of the ranges and of the sizes of the unknowns.
    pub longest: f64,
    /// Most points in each direction.
    pub most_points: usize,
}

/// A curve of special points.
#[derive(Debug, Clone, PartialEq)]
pub struct Curved {
    /// Its points: the two fields, the multipliers, and the unknowns in natural units.
    pub points: Vec<CurvePoint>,
    /// Why it ends on either side.
    pub ends: [End; 2],
    /// The wanted values at which it has no point.
    pub missed: Vec<f64>,
}

/// Follows the curve of a special point over two fields, of which it has these values; `None` if it is no curve.
///
/// # Errors
/// As [`follow`].
pub fn follow_curve(
    spec: &Spec,
    begin: &Begin,
    values: [f64; 2],
    way: &CurveWay,
    tracker: Tracker<'_>,
) -> Result<Option<Curved>, Invalid> {
    let spec = &*as_followed(spec, &begin.chain);
    check(spec, &way.over, &way.between)?;
    if let Some(slot) = way.over.iter().find(|it| begin.chain.tells() && is_friction(**it)) {
        let rule = "the branch of this point is one without friction; give another number";
        return Err(Invalid::new("over", slot.path(), rule));
    }
    let family = family_at(spec, &way.over, &values)?;
    let point = special(begin.condition, begin.value, &begin.unknowns);
    let along = AlongCurve {
        between: way.between,
        at: &way.at,
        most_points: way.most_points,
        longest: way.longest,
        cancel: Some(tracker.cancel),
        done: Some(tracker.done),
    };
    let chain = &begin.chain;
    let found = match &family.member {
        Member::System(it) if !chain.tells() => {
            let shape = (chain.symmetric, chain.cycles);
            shooting::curve(&scenes_like(it, spec, &way.over), shape, &point, values, along)
        }
        member => with_member!(member, |it| {
            curve::curve(&scenes_like(it, spec, &way.over), chain, &point, values, along)
        }),
    };
    Ok(found.map(|SpecialCurve { points, ends, missed, .. }| Curved { points, ends, missed }))
}
