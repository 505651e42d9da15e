//! Largest displacements and accelerations under records, whose pieces end in kinks and jumps, compared with
//! samples.
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use iva_core::{
    absorber::Point,
    force::{Acts, Force, History, Impulse, Record},
    run::states,
    simulate::{Limits, simulate},
    steady::{Steady, SteadyWanted, Window},
};
use iva_tests::cases;
use iva_tests::list::{begun, driven, list};
use proptest::prelude::*;

const SAMPLES: usize = 8000;

/// Largest |x| and |A| of a structure without absorber, as measured by the simulator.
fn measured(zeta: f64, force: Force, start: Point, duration: f64) -> [f64; 2] {
    let structure = driven(&list(zeta, &[]), force);
    let wanted = SteadyWanted { amplitude: true, acceleration: true, ..SteadyWanted::default() };
    let mut steady = Steady::new(Window::default(), wanted);
    simulate(&structure, &begun(start, &[]), &Limits::new(duration, 1.0), None, &mut steady)
        .unwrap();
    let values = steady.values();
    [values.amplitude_max.unwrap(), values.acceleration_max.unwrap()]
}

fn record(times: Vec<f64>, values: Vec<f64>, acts: Acts) -> Record {
    let history = Arc::new(History::new(times, values).unwrap());
    Record { history, acts, rate: 1.0, scale: 1.0 }
}

/// The linear interpolation of a record at an instant; 0 outside.
fn line(times: &[f64], values: &[f64], time: f64) -> f64 {
    let after = times.partition_point(|knot| *knot <= time);
    if after == 0 || after == times.len() {
        return 0.0;
    }
    let share = (time - times[after - 1]) / (times[after] - times[after - 1]);
    values[after - 1] + share * (values[after] - values[after - 1])
}

proptest! {
    #![proptest_config(cases(300))]

    /// No sample is larger, and the largest value is nearly reached, also where the record jumps at its ends.
    #[test]
    fn samples_come_close_and_no_further(
        knots in prop::collection::vec((0.3..1.5f64, -3.0..3.0f64), 2..7),
        jumps in any::<bool>(), on_base in any::<bool>(),
        zeta in 0.0..0.2f64, x in -1.0..1.0f64, v in -1.0..1.0f64,
    ) {
        let mut time = 0.4;
        let times: Vec<f64> = knots.iter().map(|(length, _)| { time += length; time }).collect();
        let mut values: Vec<f64> = knots.iter().map(|(_, value)| *value).collect();
        if !jumps {
            values[0] = 0.0;
            *values.last_mut().unwrap() = 0.0;
        }
        let acts = if on_base { Acts::Base } else { Acts::Primary };
        let duration = time + 0.7;
        let force = Force::new(vec![], vec![record(times.clone(), values.clone(), acts)], &[]).unwrap();
        let start = Point { x, v };
        let [largest_x, largest_a] = measured(zeta, force.clone(), start, duration);

        let structure = driven(&list(zeta, &[]), force);
        // The last instant is the end itself: a rounding before it there would be no sample.
        let before = (0..SAMPLES).map(|k| duration * k as f64 / SAMPLES as f64);
        let instants: Vec<f64> = before.chain([duration]).collect();
        let sampled = states(&structure, &begun(start, &[]), &Limits::new(duration, 1.0), &instants).unwrap();
        let (mut most_x, mut most_a) = (0.0f64, 0.0f64);
        for state in &sampled {
            let force = if on_base { 0.0 } else { line(&times, &values, state.time) };
            most_x = most_x.max(state.displacement.abs());
            let a = force - state.displacement - 2.0 * zeta * state.velocity;
            most_a = most_a.max(a.abs());
        }
        // At a jump the largest value is a one-sided limit, which samples miss by up to one sampling
        // interval.
        prop_assert!(largest_x >= most_x - 1e-12, "{largest_x} {most_x}");
        prop_assert!(largest_a >= most_a - 1e-12, "{largest_a} {most_a}");
        prop_assert!(largest_x <= most_x + 1e-5, "{largest_x} {most_x}");
        prop_assert!(largest_a <= most_a + 2e-2, "{largest_a} {most_a}");
    }
}

/// Found by review: the record jumps at the end of the flight, and the acceleration beyond the jump made x
/// look monotonic.
#[test]
fn a_crest_just_before_a_jump_counts() {
    // From rest at x₀; at t₁ an impulse makes the state (cos θ, −sin θ), and the record begins.
    let (theta, x0): (f64, f64) = (-0.680_619_2, 1.007_031_529_304_719);
    let [x, v] = [theta.cos(), -theta.sin()];
    let t1 = (x / x0).acos();
    let hit = Impulse { velocity: v + x0 * t1.sin(), time: t1 };
    let (times, values) = (vec![t1, t1 + 1.182_49], vec![-0.291_694_7, 1.139_773_1]);
    let record = record(times, values, Acts::Primary);
    let force = Force::new(vec![], vec![record], &[hit]).unwrap();
    let [largest, _] = measured(0.0, force, Point { x: x0, v: 0.0 }, t1 + 1.182_49);
    assert!((largest - 1.007_290_06).abs() < 1e-6, "{largest}");
}
