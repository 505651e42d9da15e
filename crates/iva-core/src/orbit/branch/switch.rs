//! From a special point of a branch to the branch that begins there.

use nalgebra::DVector;

use super::super::chain::{Chain, Passed};
use super::super::conditions::Condition;
use super::super::continuation::{Curve, Equations, OnCurve, kernel};
use super::super::coordinates::Coordinates;
use super::super::episode::Episode;
use super::super::family::{Family, Scenes};
use super::super::margins::extrema;
use super::follower::{Follower, Side, Stop};
use super::halves::{half, whole};
use super::{Along, Branch, End, SpecialPoint, follow, scales};
use crate::absorber::Wall;

/// First steps away from a point that are tried, in scales.
const TRIED: [f64; 5] = [1e-2, 3e-3, 3e-2, 1e-3, 1e-4];
/// The halves of an orbit are alike where their times differ by less, in cycles.
const ALIKE: f64 = 1e-9;

/// A chain with one impact more: with this wall at an instant in a flight of the chain.
fn with_impact(
    chain: &Chain,
    unknowns: &[f64],
    (flight, wall, time): (usize, Wall, f64),
) -> (Chain, Vec<f64>) {
    let (mut chain, mut unknowns) = (chain.clone(), unknowns.to_vec());
    chain.walls.insert(flight + 1, wall);
    chain.sticks.insert(flight + 1, false);
    unknowns.insert(4 + flight, time);
    (chain, unknowns)
}

/// A chain that begins one impact later.
fn rotated<S: Coordinates>(
    system: &S,
    (chain, unknowns): (&Chain, &[f64]),
    passed: &Passed<S::State>,
    length: f64,
) -> Option<(Chain, Vec<f64>)> {
    let second = passed.flights.iter().find(|it| it.after == 1 && !chain.sticks[1])?;
    let at = system.coordinates(&second.from);
    let mut walls = chain.walls[1..].to_vec();
    let first = chain.walls[0];
    walls.push(if chain.symmetric { first.opposite() } else { first });
    let mut rotated = vec![second.begin, at[0], at[1], at[3]];
    rotated.extend_from_slice(&unknowns[5..]);
    rotated.push(unknowns[0] + length);
    let mut sticks = chain.sticks.clone();
    sticks.rotate_left(1);
    Some((Chain { walls, sticks, ..chain.clone() }, rotated))
}

/// A chain without one of its impacts, counted from 1.
fn without_impact<S: Coordinates>(
    system: &S,
    (chain, unknowns): (&Chain, &[f64]),
    passed: &Passed<S::State>,
    (impact, length): (usize, f64),
) -> Option<(Chain, Vec<f64>)> {
    let count = chain.walls.len();
    let (mut chain, mut unknowns) = if impact == count {
        rotated(system, (chain, unknowns), passed, length)?
    } else {
        (chain.clone(), unknowns.to_vec())
    };
    let index = if impact == count { count - 1 } else { impact };
    chain.walls.remove(index);
    chain.sticks.remove(index);
    unknowns.remove(3 + index);
    Some((chain, unknowns))
}

/// The chain of the branch that begins at a special point, with the values of its unknowns there.
fn begun<S: Coordinates>(
    scenes: Scenes<'_, S>,
    chain: &Chain,
    SpecialPoint { condition, at }: &SpecialPoint,
) -> Option<(Chain, Vec<f64>)> {
    let (system, cycle) = scenes(&[at.value]).ok()?;
    let length = chain.length(cycle);
    let passed = chain.passed(&system, length, &at.unknowns, false).ok()?;
    match *condition {
        Condition::Pitchfork if !chain.symmetric => None,
        Condition::Pitchfork | Condition::Flip => Some(whole(chain, cycle, &at.unknowns)),
        Condition::Grazing { flight, wall } => {
            let all = extrema(&system, &passed.flights, cycle);
            let here = all.iter().filter(|it| it.flight == flight && it.wall == wall);
            let nearest = here.min_by(|a, b| a.margin.abs().total_cmp(&b.margin.abs()))?;
            let within = |it: &Episode| it.impact == flight && nearest.time < it.begin + it.release;
            if passed.episodes.iter().any(within) {
                return None;
            }
            Some(with_impact(chain, &at.unknowns, (flight, wall, nearest.time)))
        }
        Condition::ImpactVanishes { impact }
            if chain.walls.len() > 1 && !chain.sticks[impact % chain.walls.len()] =>
        {
            without_impact(&system, (chain, &at.unknowns), &passed, (impact, length))
        }
        Condition::ImpactVanishes { .. } | Condition::StickBegins { .. } => None,
        Condition::Fold | Condition::NeimarkSacker => None,
        Condition::ImpactsCoincide | Condition::SlideChanges => None,
    }
}

/// The first admissible point of the branch that begins at a point, and its begin with the tangent towards it.
fn ahead<S: Coordinates>(
    follower: &Follower<'_, S>,
    point: DVector<f64>,
    parts: bool,
) -> Option<Stop> {
    let family = follower.family;
    let (_, derivatives) = family.at(&point)?;
    let (count, scales) = (family.chain.unknowns(), &family.scales);
    // Where orbits part, the number that is changed has an extremum on the branch that begins.
    let tangent = if parts {
        let own = kernel(
            &derivatives.columns(0, count).into_owned(),
            &scales.rows(0, count).into_owned(),
        )?;
        own.push(0.0)
    } else {
        kernel(&derivatives, scales)?
    };
    let curve = Curve { equations: family, scales: scales.clone() };
    for step in TRIED {
        for tangent in [tangent.clone(), -&tangent] {
            let begin = OnCurve { point: point.clone(), tangent };
            let Some(next) = curve.next(&begin, step) else { continue };
            let Some(stop) = follower.stop(next, step) else { continue };
            let moved = (&stop.on.point - &point).component_div(scales);
            let forwards = moved.dot(&begin.tangent) > 0.5 * step && moved.norm() < 4.0 * step;
            if forwards && stop.tests.admissible() {
                return Some(stop);
            }
        }
    }
    None
}

/// The branch on which a branch begins whose orbit at this point has two halves that are alike, in both directions.
fn origin<S: Coordinates>(
    scenes: Scenes<'_, S>,
    chain: &Chain,
    SpecialPoint { condition, at }: &SpecialPoint,
    along: Along<'_>,
) -> Option<Branch> {
    let (half, by) = half(chain)?;
    let (_, cycle) = scenes(&[at.value]).ok()?;
    let middle = chain.instant(&at.unknowns, 0.0, chain.walls.len() / 2);
    let alike = (middle - at.unknowns[0] - 0.5 * chain.length(cycle)).abs() < ALIKE * cycle;
    if by != *condition || !alike {
        return None;
    }
    follow(scenes, (&half, &at.unknowns[..half.unknowns()]), at.value, along)
}

/// The branch that begins at a special point of another: at a pitchfork that of the asymmetric orbits (their mirror images
/// are a second one), at a flip that of the orbits that take twice as long, at a grazing that with the impact that begins
/// there, and where an impact vanishes that without it. Where the branch itself begins at the point
/// ([`End::Origin`]), it is the branch that it begins on. `None` for other points, for impacts of a chatter that ends in stick,
/// and if it was not found.
pub fn switch<S: Coordinates>(
    scenes: Scenes<'_, S>,
    chain: &Chain,
    special: &SpecialPoint,
    along: Along<'_>,
) -> Option<Branch> {
    if let Some(found) = origin(scenes, chain, special, along) {
        return Some(found);
    }
    let (chain, unknowns) = begun(scenes, chain, special)?;
    let [low, high] = along.between;
    let scales = scales(&chain, &unknowns, &[high - low]);
    let family = Family { scenes, chain, scales };
    let follower = Follower { family: &family, along, towards: 1.0 };
    let parts = matches!(special.condition, Condition::Pitchfork | Condition::Flip);
    let all = unknowns.into_iter().chain([special.at.value]);
    let point = DVector::from_iterator(family.chain.unknowns() + 1, all);
    let origin = follower
        .stop(OnCurve { tangent: DVector::zeros(point.len()), point: point.clone() }, 0.0)?;
    let first = ahead(&follower, point, parts)?;
    let (Side { mut points, special: found }, end) = follower.side(&first);
    points.splice(0..0, [origin.at, first.at]);
    let begin = match special.condition {
        Condition::Grazing { .. } => End::ImpactVanishes,
        Condition::ImpactVanishes { .. } => End::Grazing,
        _ => End::Origin,
    };
    let chain = family.chain;
    Some(Branch { chain, sequence: None, points, special: found, ends: [begin, end] })
}
