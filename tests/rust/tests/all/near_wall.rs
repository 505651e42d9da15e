//! A measure with a pass of its own: the time close to a wall.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;
use std::sync::atomic::AtomicBool;

use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use iva_core::absorber::Start;
use iva_core::measures::near_wall::NearWall;
use iva_core::measures::pass::Passes;
use iva_core::observe::Events;
use iva_core::simulate::{Limits, simulate};
use iva_core::siva::Siva;
use iva_sweep::choices::Kind;
use iva_sweep::columns::Selection;
use iva_sweep::study::{Study, Table};
use iva_verify::{gradients, verify};

use super::every_field::{Drive, scene};

fn passes() -> Passes<f64> {
    Passes::new(0.0, vec![Box::new(NearWall::default())])
}

/// Between the walls of a structure that nothing moves, a mass goes to and fro at constant speed: it is within a
/// hundredth of the clearance of a wall for a hundredth of the time.
#[test]
fn a_ball_between_walls_at_rest_is_close_for_a_hundredth_of_the_time() {
    let siva = Siva::new(1e-14, 1.0, 0.5, 0.0).unwrap();
    for speed in [0.3, 1.0, 2.7] {
        let start = Start { gap_velocity: speed, ..Start::default() };
        // From the middle to the middle: 40 times the whole play.
        let duration = 40.0 / speed;
        let mut passes = passes();
        simulate(&siva, &start, &Limits::new(duration, 0.5), None, &mut passes).unwrap();
        let time = passes.values().next().unwrap().unwrap();
        assert!((time - 0.01 * duration).abs() < 1e-11 * duration, "{speed}: {time}");
    }
}

/// A stuck mass is on its wall.
#[test]
fn time_stuck_is_time_close_to_a_wall() {
    let siva = Siva::new(0.1, 0.0, 0.2, 0.02).unwrap();
    let start = Start { displacement: 1.0, ..Start::default() };
    let mut watch = (Events::default(), passes());
    let limits = Limits::new(10.0 * TAU, 0.2);
    let tally = simulate(&siva, &start, &limits, None, &mut watch).unwrap();
    let time = watch.1.values().next().unwrap().unwrap();
    assert!(tally.time_stuck > 5.0, "{}", tally.time_stuck);
    // Besides, it leaves its wall, and comes to another, slowly.
    let gained = time - tally.time_stuck;
    assert!(gained > 0.0 && gained < 0.3 * tally.time_stuck, "{time} {}", tally.time_stuck);
}

/// Verified and differentiated for every kind of scene: the derivative is that of differences.
#[test]
fn it_is_verified_and_differentiated() {
    let never = AtomicBool::new(false);
    for kind in [Kind::Siva, Kind::Piva] {
        for drive in [Drive::Nothing, Drive::Harmonic, Drive::Record] {
            let measures = Selection::from_names(["time_near_wall"]).unwrap();
            let study = |restitution: f64| {
                let mut spec = scene(kind, drive, false);
                spec.set(iva_sweep::fields::FieldId::Restitution, restitution).unwrap();
                Study { tables: vec![Table::Summary], measures, ..Study::single(spec) }
            };
            let value = |tables: &iva_sweep::sweep::Tables| {
                let column = &tables[&Table::Summary]["time_near_wall"];
                column.as_primitive::<Float64Type>().value(0)
            };
            let found = verify(&study(0.6), &never).unwrap();
            let error = value(&found.errors).abs();
            assert!(found.findings[0].agrees() && error < 1e-12, "{kind:?} {drive:?}: {error:e}");
            let slope = value(&gradients(&study(0.6), "restitution", &never).unwrap());
            let workers = iva_sweep::sweep::Workers::new(Some(1)).unwrap();
            let at = |e: f64| value(&super::every_field::run(&study(e), &workers, None, 0..1));
            let step = 1e-7;
            let truth = (at(0.6 + step) - at(0.6 - step)) / (2.0 * step);
            let size = slope.abs().max(1e-3);
            assert!((slope - truth).abs() < 1e-5 * size, "{kind:?} {drive:?}: {slope} {truth}");
        }
    }
}
