//! A pendulum with Coulomb friction in its pivot.
//!
//! Numbers come from pencil and paper, for a structure that the pendulum cannot move (mass ratio 1e-30): the angles at which it turns follow from the energy that friction
//! takes on the way, and it stays where gravity no longer overcomes friction.
#![allow(clippy::unwrap_used, clippy::panic)]

use iva_core::{
    absorber::Absorber,
    absorber::modal::{Modal, ModalStart, ModalStructure, PRIMARY},
    flight::GapPoint,
    host::UndrivenHost,
    piva::{Angles, Parameters},
    run::run,
    simulate::{Limits, Outcome},
    siva::FreeMass,
};

const NOTHING: f64 = 1e-30;
/// Length, distance to the stops, and half of the way between them.
const LENGTH: f64 = 1.0;
const CONTACT: f64 = 0.8;
const CLEARANCE: f64 = 0.7;

fn hanging(frequency_ratio: f64, inertia_ratio: f64, angles: Angles) -> Parameters {
    Parameters {
        frequency_ratio,
        inertia_ratio,
        contact_distance: CONTACT,
        angles,
        ..Parameters::point_bob(NOTHING, 0.5, CLEARANCE, 0.0, LENGTH)
    }
}

fn system(parameters: Parameters, friction: f64) -> Modal<UndrivenHost, 1, 2> {
    let mass = FreeMass::new(NOTHING, 0.5, CLEARANCE).unwrap();
    let one = ModalStructure::moving_as_one(0.0).unwrap();
    let system = Modal::with_room(one, &[(mass, PRIMARY)]).unwrap();
    system.with_pendulums(&[Some(parameters)]).unwrap().with_friction(&[friction]).unwrap()
}

/// The arc of the next turn, on the other side of the middle, from that of this one: where the height lost is what friction takes. It is negative where friction
/// is so large that the pendulum stops before the middle, and not before `edge` on this side, where friction can hold it.
fn next_turn(turn: f64, edge: f64, height: impl Fn(f64) -> f64, friction: f64) -> f64 {
    let left = |next: f64| height(turn) - height(next) - friction * (turn + next);
    let (mut low, mut high) = (-edge, turn);
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if left(middle) > 0.0 { low = middle } else { high = middle }
    }
}

#[test]
fn it_swings_until_friction_holds_it() {
    for (friction, angles, r, kappa) in [
        (0.01, Angles::Large, 0.7, 1.0),
        (0.05, Angles::Large, 1.3, 1.2),
        (0.11, Angles::Large, 0.6, 1.0),
        (0.02, Angles::Small, 0.7, 1.0),
        (0.07, Angles::Small, 1.1, 1.4),
    ] {
        let begin = 0.6;
        let small = angles == Angles::Small;
        let arc = |y: f64| if small { y } else { CONTACT * (y / CONTACT).asin() };
        let height = |arc: f64| {
            let chord = if small { arc } else { 2.0 * CONTACT * (0.5 * arc / CONTACT).sin() };
            0.5 * (r * chord).powi(2)
        };
        let edge = arc(friction / (r * r));
        let (mut turn, mut side, mut way, mut turns) = (arc(begin), 1.0, 0.0, 0);
        while turn > edge {
            let next = next_turn(turn, edge, height, friction);
            way += turn + next;
            (turn, side, turns) = (next, -side, turns + 1);
        }
        let parameters = hanging(r, kappa, angles);
        let system = system(parameters, friction);
        let start = ModalStart::new(&[0.0], &[0.0], [GapPoint { y: begin, w: 0.0 }]).unwrap();
        let run = run(&system, &start, &Limits::new(300.0, 1e-9)).unwrap();
        assert_eq!(run.tally.outcome, Outcome::Finished);
        assert_eq!((run.tally.undecided, run.impacts.len()), (0, 0));
        assert_eq!((run.tally.friction.stops, run.tally.friction.holds), (turns, 1));
        let rest = system.angle(&run.tally.state).unwrap();
        let off = rest.value * CONTACT - side * turn;
        assert!(rest.rate == 0.0 && off.abs() < 1e-13, "{friction}: {rest:?} {turn}");
        let inertia = NOTHING * kappa * (LENGTH / CONTACT).powi(2);
        let taken = run.measures.energy_friction / (inertia * friction);
        assert!((taken / way - 1.0).abs() < 1e-13, "{friction}: {taken} {way}");
    }
}
