//! Orbits whose two halves are alike: where such an orbit is met on a branch, the branch began at it.
//!
//! An orbit that is not symmetric may become its own mirror image half a cycle later, and one that takes twice as long
//! the same orbit run twice. There the number that is changed has an extremum, and beyond it the branch
//! goes through the mirror images of its orbits, or through the same orbits half their time later.

use nalgebra::DVector;

use super::super::chain::Chain;
use super::super::conditions::Condition;
use super::super::continuation::{distance, solved};
use super::super::coordinates::Coordinates;
use super::super::family::Family;

/// How far the orbit may be from the one that the branch is interpolated to, in steps along the branch.
const NEARBY: f64 = 2.0;

/// The chain of the first half, and the condition at which the whole chain branches off from it; `None` if its halves
/// cannot be alike.
pub(super) fn half(chain: &Chain) -> Option<(Chain, Condition)> {
    let count = chain.walls.len();
    if chain.symmetric || count == 0 || !count.is_multiple_of(2) {
        return None;
    }
    let (first, second) = chain.walls.split_at(count / 2);
    let (sticks, again) = chain.sticks.split_at(count / 2);
    if sticks != again {
        return None;
    }
    let sticks = sticks.to_vec();
    if first == second && chain.cycles.is_multiple_of(2) {
        let (walls, cycles) = (first.to_vec(), chain.cycles / 2);
        let half = Chain { walls, sticks, symmetric: false, cycles };
        return Some((half, Condition::Flip));
    }
    let mirrored = first.iter().zip(second).all(|(a, b)| *a == b.opposite());
    // After an even number of cycles the drive would not change its sign.
    let odd = !chain.cycles.is_multiple_of(2);
    let half = Chain { walls: first.to_vec(), sticks, symmetric: true, cycles: chain.cycles };
    (mirrored && odd).then_some((half, Condition::Pitchfork))
}

/// The whole of a chain that is half of it, and the values of its unknowns where a cycle of the scene has a length: of a
/// symmetric chain that over the full cycle, of any other that over twice the time.
pub(super) fn whole(chain: &Chain, cycle: f64, unknowns: &[f64]) -> (Chain, Vec<f64>) {
    let more: Vec<_> = match chain.symmetric {
        true => chain.walls.iter().map(|wall| wall.opposite()).collect(),
        false => chain.walls.clone(),
    };
    let cycles = if chain.symmetric { chain.cycles } else { 2 * chain.cycles };
    let walls = [chain.walls.as_slice(), &more].concat();
    let later = chain.length(cycle);
    let again = (0..chain.walls.len()).map(|i| chain.instant(unknowns, later, i) + later);
    let unknowns = unknowns.iter().copied().chain(again).collect();
    let sticks = chain.sticks.repeat(2);
    (Chain { walls, sticks, symmetric: false, cycles }, unknowns)
}

/// By how much the time of the first half differs from half the time of the chain; `None` if its halves cannot be alike.
pub(super) fn difference<S: Coordinates>(
    family: &Family<'_, S>,
    point: &DVector<f64>,
) -> Option<f64> {
    let chain = &family.chain;
    half(chain)?;
    let (unknowns, numbers) = point.as_slice().split_at(chain.unknowns());
    let (_, cycle) = (family.scenes)(numbers).ok()?;
    let middle = chain.instant(unknowns, 0.0, chain.walls.len() / 2);
    Some(middle - unknowns[0] - 0.5 * chain.length(cycle))
}

/// The point at which the branch begins, between two of its points between which the difference of the halves changes its
/// sign, after this share of the way; with the condition that the half orbit meets there.
pub(super) fn origin<S: Coordinates>(
    family: &Family<'_, S>,
    [from, to]: [&DVector<f64>; 2],
    share: f64,
) -> Option<(Condition, DVector<f64>)> {
    let (chain, condition) = half(&family.chain)?;
    let (all, count) = (family.chain.unknowns(), chain.unknowns());
    let kept = |whole: &DVector<f64>| {
        let mut kept = whole.rows(0, count + 1).into_owned();
        kept[count] = whole[all];
        kept
    };
    let [a, b, scales] = [from, to, &family.scales].map(kept);
    let guess = &a + (&b - &a) * share;
    let halves = Family { scenes: family.scenes, chain, scales };
    let equations = |at: &DVector<f64>| halves.with_condition(at, condition);
    let point = solved(&guess, &halves.scales, &equations)?;
    if distance(&point, &guess, &halves.scales) > NEARBY * distance(&a, &b, &halves.scales) {
        return None;
    }
    let (unknowns, numbers) = point.as_slice().split_at(count);
    let (_, cycle) = (family.scenes)(numbers).ok()?;
    let (_, unknowns) = whole(&halves.chain, cycle, unknowns);
    let point = unknowns.into_iter().chain(numbers.iter().copied());
    Some((condition, DVector::from_iterator(all + 1, point)))
}
