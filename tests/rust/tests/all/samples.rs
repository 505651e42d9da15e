//! Samples of the motion: none is lost at the ends of a run, and both rows of an impact are states that exist.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::{OnStructure, Start},
    extremes::Extremes,
    force::{Acts, Force, Harmonic},
    sample::{Sampler, State},
    simulate::{Limits, Outcome, simulate, simulate_from},
    siva::Siva,
};
use iva_tests::rng::Rng;

fn start(rng: &mut Rng) -> Start {
    Start { displacement: rng.range(-1.0, 1.0), velocity: rng.range(-1.0, 1.0), ..Start::default() }
}

/// Times in the user's unit are converted there and back, so they may be a rounding off the end or the begin.
#[test]
fn samples_within_a_rounding_of_the_ends_are_taken() {
    let mut rng = Rng::new(3);
    for number in 0..2000 {
        let force = Harmonic { amplitude: 0.4, frequency: 0.9, phase: 0.3, acts: Acts::Primary };
        let force = Force::new(vec![force], Vec::new(), &[]).unwrap();
        let siva = Siva::new(0.1, rng.pick(&[0.0, 0.6]), 0.4, 0.05).unwrap().under(force);
        let begin = rng.pick(&[0.0, 1.0]) * rng.log_range(1e-2, 1e3);
        let end = begin + rng.log_range(0.1, 30.0);
        let mut times = vec![begin.next_down().max(0.0), begin, begin.next_up()];
        times.extend([end.next_down().next_down(), end.next_down(), end]);
        let limits = Limits::new(end, 0.4);
        for events in [false, true] {
            let mut sampler = match events {
                true => Sampler::with_events(times.clone()),
                false => Sampler::at(times.clone()),
            };
            let tally =
                simulate_from(&siva, &start(&mut rng), begin, &limits, None, &mut sampler).unwrap();
            assert_eq!(tally.outcome, Outcome::Finished);
            let last = sampler.states.last().unwrap();
            assert_eq!(last.time, end, "scene {number} from {begin} to {end}");
            let point = siva.primary(&tally.state);
            assert_eq!((last.displacement, last.velocity), (point.x, point.v));
            if !events {
                let found: Vec<f64> = sampler.states.iter().map(|state| state.time).collect();
                assert_eq!(found, times, "scene {number}");
            }
        }
    }
}

/// A run that ends early has a last state, which is a sample if it is asked for.
#[test]
fn the_end_of_a_run_that_ended_early_is_a_sample() {
    let mut rng = Rng::new(4);
    for _ in 0..200 {
        let siva = Siva::new(0.1, rng.pick(&[0.0, 0.6]), 0.3, 0.05).unwrap();
        let limits = Limits { max_impacts: 3, ..Limits::new(40.0, 0.3) };
        let start = start(&mut rng);
        let end = simulate(&siva, &start, &limits, None, &mut ()).unwrap();
        if end.outcome != Outcome::ImpactLimit {
            continue;
        }
        let times = vec![end.end_time.next_down(), end.end_time, end.end_time + 1e-9];
        let mut sampler = Sampler::at(times.clone());
        let tally = simulate(&siva, &start, &limits, None, &mut sampler).unwrap();
        let found: Vec<f64> = sampler.states.iter().map(|state| state.time).collect();
        assert_eq!(found, times[..2]);
        assert_eq!(sampler.states[1].velocity, siva.primary(&tally.state).v);
    }
}

/// With e = 0 the absorber sticks at once where the wall presses: from then on there is one mass, which the
/// impact accelerates no more than its motion does afterwards.
#[test]
fn the_second_row_of_a_plastic_impact_is_a_state_on_the_wall() {
    let mut rng = Rng::new(6);
    let mut stuck = 0;
    for _ in 0..200 {
        let siva = Siva::new(rng.log_range(0.05, 0.5), 0.0, 0.4, rng.pick(&[0.0, 0.1])).unwrap();
        let start = start(&mut rng);
        let mut observers = (Sampler::with_events(Vec::new()), Extremes::new(0.0));
        simulate(&siva, &start, &Limits::new(30.0, 0.4), None, &mut observers).unwrap();
        let (Sampler { states, .. }, extremes) = observers;
        let largest = extremes.values()[0].acceleration.unwrap();
        for pair in states.chunks(2) {
            let [before, after]: [State; 2] = pair.try_into().unwrap();
            assert_eq!(before.wall, 0);
            assert!(after.acceleration.abs() <= largest * (1.0 + 1e-14), "{after:?} {largest}");
            if after.wall != 0 {
                // (1 + μ) ẍ + 2ζ ẋ + x = 0 for both masses together.
                let (mu, zeta) = (siva.mass_ratio(), siva.damping_ratio());
                let together = -(after.displacement + 2.0 * zeta * after.velocity) / (1.0 + mu);
                assert!((after.acceleration - together).abs() < 1e-15);
                assert_eq!(after.absorber_acceleration, after.acceleration);
                assert_eq!(f64::from(after.wall), after.gap_displacement.signum());
                stuck += 1;
            }
        }
    }
    assert!(stuck > 200, "{stuck}");
}
