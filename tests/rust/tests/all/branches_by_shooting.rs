//! Branches of systems without a chain of impacts: those of one free mass are the branches by chains, and those of the 30-digit references;
//! on a structure with a second mode that the mass does not see they have the same points; those of lists and of friction are orbits.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iva_core::{
    absorber::{
        Start,
        modal::{FewModes, ModalStart, ModalStructure, PRIMARY},
    },
    error::Invalid,
    flight::GapPoint,
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    orbit::{
        Coordinates, Cycle, Trajectory,
        branch::{Along, Branch, End, SpecialPoint, follow, shooting},
        chain::Chain,
        conditions::Kind,
        curve::{AlongCurve, SpecialCurve, curve},
        map,
        periodic::{Orbit, find},
    },
    siva::{FreeMass, Siva},
};

type System = FewModes<DrivenHost>;

fn pushed(amplitude: f64, frequency: f64) -> Result<Force, Invalid> {
    Force::harmonic(vec![Harmonic { amplitude, frequency, phase: 0.0, acts: Acts::Primary }])
}

/// The orbit that a run from a start settles on.
fn settled<S>(system: S, start: &S::Start, length: f64, symmetric: bool) -> Orbit<S>
where
    S: Coordinates + Clone,
{
    let cycle = Cycle { begin: 0.0, length };
    let mut trajectory = Trajectory::new(system, start, cycle).unwrap();
    for _ in 0..300 {
        trajectory.state = map(&trajectory, false, None).unwrap().state;
    }
    find(&trajectory, symmetric, None).unwrap()
}

/// Family A of the references: μ = .2, e = .7, ζ = .05, F = Ω = 1.
fn mass(clearance: f64) -> Result<(Siva<DrivenHost>, f64), Invalid> {
    Ok((Siva::new(0.2, 0.7, clearance, 0.05)?.under(pushed(1.0, 1.0)?), TAU))
}

/// The same mass at a point of a structure whose second mode does not move there.
fn beside_a_mode(clearance: f64) -> Result<(System, f64), Invalid> {
    let modes = ModalStructure::new(&[1.0, 2.3], &[0.05, 0.03])?;
    let modes = modes.with_point("top", &[1.0, 0.0])?.with_point("side", &[1.0, 0.4])?;
    let members = [(FreeMass::new(0.2, 0.7, clearance)?, "top")];
    let system = FewModes::with_room(modes, &members)?.seen_at("top")?;
    Ok((system.under(pushed(1.0, 1.0)?, "top")?, TAU))
}

/// Kind and value of the special points, of these kinds.
fn located(branch: &Branch, kinds: &[Kind]) -> Vec<(Kind, f64)> {
    let all = branch.special.iter().map(|it| (it.condition.kind(), it.at.value));
    let mut found: Vec<_> = all.filter(|(kind, _)| kinds.contains(kind)).collect();
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    found
}

const SMOOTH: [Kind; 4] = [Kind::Fold, Kind::Pitchfork, Kind::Flip, Kind::NeimarkSacker];

#[test]
fn a_free_mass_has_the_points_of_its_chain_and_of_the_references() {
    let at_rest = Start { gap_velocity: 0.1, ..Start::default() };
    let scenes = |values: &[f64]| mass(values[0]);
    for (clearance, symmetric, between) in [(4.5, true, [3.0, 8.0]), (4.15, false, [3.5, 4.3])] {
        let orbit = settled(mass(clearance).unwrap().0, &at_rest, TAU, symmetric);
        let along = Along::new(between);
        let (chain, unknowns) = Chain::of(&orbit, 1).unwrap();
        let known = follow(&scenes, (&chain, &unknowns), clearance, along).unwrap();
        let found = shooting::follow(&scenes, (&orbit, 1), clearance, along).unwrap();
        let pairs = located(&known, &SMOOTH).into_iter().zip(located(&found, &SMOOTH));
        for ((kind, truth), (other, value)) in pairs {
            assert_eq!(kind, other);
            assert!((truth - value).abs() < 1e-10, "{kind:?}: {truth} {value}");
        }
        assert_eq!(located(&known, &SMOOTH).len(), located(&found, &SMOOTH).len());
        // Of the ends those at which the sequence changes.
        for (side, place) in [(0, 0), (1, found.points.len() - 1)] {
            if matches!(known.ends[side], End::Grazing | End::ImpactVanishes | End::Range) {
                assert_eq!(known.ends[side], found.ends[side]);
                let truth = if side == 0 { known.points.first() } else { known.points.last() };
                let off = (truth.unwrap().value - found.points[place].value).abs();
                assert!(off < 1e-9, "{:?} {off:e}", known.ends[side]);
            }
        }
    }
}

#[test]
fn a_mode_that_the_mass_does_not_see_changes_nothing() {
    let (system, period) = beside_a_mode(4.5).unwrap();
    let gap = GapPoint { y: 0.0, w: 0.1 };
    let start = ModalStart::new(&[0.0, 0.1], &[0.0, 0.0], std::array::from_fn(|_| gap)).unwrap();
    let orbit = settled(system, &start, period, true);
    let scenes = |values: &[f64]| beside_a_mode(values[0]);
    let found = shooting::follow(&scenes, (&orbit, 1), 4.5, Along::new([4.0, 8.0])).unwrap();
    // 30 digits: `reference/bifurcations.json`.
    let truth = [(Kind::Pitchfork, 4.239825482999316), (Kind::NeimarkSacker, 6.716344592097102)];
    let near = |of: &Branch, kinds: &[Kind], truth: &[(Kind, f64)]| {
        let found = located(of, kinds);
        assert_eq!(found.len(), truth.len(), "{found:?}");
        for ((kind, value), (other, truth)) in found.into_iter().zip(truth) {
            assert!(kind == *other && (value - truth).abs() < 1e-10, "{kind:?} {value} {truth}");
        }
    };
    near(&found, &SMOOTH, &truth);
    assert!(found.points.iter().all(|it| it.multipliers.len() == 6));
    let at = |branch: &Branch, kind: Kind| {
        branch.special.iter().find(|it| it.condition.kind() == kind).unwrap().clone()
    };
    let along = Along::new([3.5, 8.0]);
    let next = |shape: (bool, u32), special: SpecialPoint| {
        shooting::switch(&scenes, shape, &special, along).unwrap()
    };
    // The orbits that are not symmetric end in a grazing; in between their period doubles.
    let pitchfork = at(&found, Kind::Pitchfork);
    let asymmetric = next((true, 1), pitchfork);
    assert_eq!(asymmetric.ends, [End::Origin, End::Grazing]);
    let truth = [(Kind::Grazing, 3.611377826853068), (Kind::Flip, 4.045569270858858)];
    near(&asymmetric, &[Kind::Grazing, Kind::Flip], &truth);
    let doubled = next((false, 1), at(&asymmetric, Kind::Flip));
    assert_eq!((doubled.chain.cycles, doubled.ends[0]), (2, End::Origin));
    // Followed the other way, the branch ends where it begins, and from there goes on along that which it begins on.
    let orbit = shooting::orbit(
        &beside_a_mode(asymmetric.points[9].value).unwrap().0,
        (period, 1),
        (&asymmetric.points[9].unknowns, false),
        0.0,
    );
    let value = asymmetric.points[9].value;
    let again = shooting::follow(&scenes, (&orbit.unwrap(), 1), value, along).unwrap();
    assert!(again.ends.contains(&End::Origin), "{:?}", again.ends);
    near(&again, &[Kind::Pitchfork], &[(Kind::Pitchfork, 4.239825482999316)]);
    let symmetric = next((false, 1), at(&again, Kind::Pitchfork));
    assert!(symmetric.chain.symmetric);
    near(&symmetric, &[Kind::NeimarkSacker], &[(Kind::NeimarkSacker, 6.716344592097102)]);
}

/// The pitchfork over clearance and mass ratio beside the curve of the chain.
#[test]
fn a_curve_of_special_points_is_that_of_the_chain() {
    let siva = |values: &[f64]| {
        let system = Siva::new(values[1], 0.7, values[0], 0.05)?;
        Ok((system.under(pushed(1.0, 1.0)?), TAU))
    };
    let at_rest = Start { gap_velocity: 0.1, ..Start::default() };
    let orbit = settled(siva(&[4.5, 0.2]).unwrap().0, &at_rest, TAU, true);
    let scenes = |values: &[f64]| siva(&[values[0], 0.2]);
    let along = Along::new([3.0, 8.0]);
    let at = |branch: &Branch| {
        let kind = Kind::Pitchfork;
        branch.special.iter().find(|it| it.condition.kind() == kind).unwrap().clone()
    };
    let (chain, unknowns) = Chain::of(&orbit, 1).unwrap();
    let [known, found] = [
        at(&follow(&scenes, (&chain, &unknowns), 4.5, along).unwrap()),
        at(&shooting::follow(&scenes, (&orbit, 1), 4.5, along).unwrap()),
    ];
    let wanted = [3.8, 4.0, 4.4];
    let over = AlongCurve {
        between: [[3.7, 4.5], [0.1, 0.3]],
        at: &wanted,
        most_points: 200,
        longest: 0.05,
        cancel: None,
        done: None,
    };
    let [known, found] = [
        curve(&siva, &chain, &known, [known.at.value, 0.2], over).unwrap(),
        shooting::curve(&siva, (true, 1), &found, [found.at.value, 0.2], over).unwrap(),
    ];
    for value in wanted {
        let of = |curve: &SpecialCurve| {
            let at = curve.points.iter().find(|it| it.values[0] == value);
            at.map(|it| it.values[1])
        };
        let (truth, found) = (of(&known), of(&found));
        assert!(
            truth.zip(found).is_some_and(|(a, b)| (a - b).abs() < 1e-10),
            "{truth:?} {found:?}"
        );
    }
    assert_eq!(known.ends, found.ends);
}

/// Two masses with friction at one of them, by its coefficient.
fn pair(frequency: f64, friction: f64) -> Result<(System, f64), Invalid> {
    let one = ModalStructure::moving_as_one(0.03)?;
    let members = [FreeMass::new(0.08, 0.6, 0.8)?, FreeMass::new(0.05, 0.7, 0.5)?];
    let system = FewModes::with_room(one, &members.map(|it| (it, PRIMARY)))?.seen_at(PRIMARY)?;
    let system = system.with_gravity(&[0.0; 2])?.with_friction(&[0.0, friction])?;
    let system = system.with_static_friction(&[0.0, 1.3 * friction])?;
    Ok((system.under(pushed(0.5, frequency)?, PRIMARY)?, TAU / frequency))
}

/// At each point a run comes back after its cycle, with the events of the branch; what has become small at its ends is told.
#[test]
fn branches_of_lists_and_of_friction_are_orbits() {
    let mut ends = vec![];
    for friction in [0.0, 0.02] {
        let (system, period) = pair(1.0, friction).unwrap();
        let gap = GapPoint { y: 0.1, w: 0.3 };
        let start = ModalStart::new(&[0.3], &[0.0], std::array::from_fn(|_| gap)).unwrap();
        let cycle = Cycle { begin: 0.0, length: period };
        let mut trajectory = Trajectory::new(system, &start, cycle).unwrap();
        for _ in 0..600 {
            trajectory.state = map(&trajectory, false, None).unwrap().state;
        }
        let (periods, orbit) = (1..=4)
            .find_map(|periods| {
                let cycle = Cycle { length: period * f64::from(periods), ..cycle };
                let from = Trajectory { cycle, ..trajectory.clone() };
                Some((periods, find(&from, false, None).ok()?))
            })
            .unwrap();
        let scenes = |values: &[f64]| pair(values[0], friction);
        let along = Along::new([0.8, 1.2]);
        let found = shooting::follow(&scenes, (&orbit, periods), 1.0, along).unwrap();
        for point in &found.points {
            let (system, period) = pair(point.value, friction).unwrap();
            let of = (&point.unknowns[..], false);
            let orbit = shooting::orbit(&system, (period, periods), of, 0.0).unwrap();
            assert!(orbit.residual < 1e-9, "{} {:e}", point.value, orbit.residual);
        }
        for special in &found.special {
            let largest = &special.at.multipliers;
            let near = |at: f64| largest.iter().any(|it| (it - at).norm() < 1e-6);
            match special.condition.kind() {
                Kind::Fold => assert!(near(1.0), "{largest:?}"),
                Kind::Flip => assert!(near(-1.0), "{largest:?}"),
                _ => {}
            }
        }
        ends.extend(found.ends);
    }
    assert!(ends.iter().all(|end| *end != End::Stalled), "{ends:?}");
}
