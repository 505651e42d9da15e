//! The ledger must notice a wrong impact law, and the closed form its own definition.

use super::*;
use crate::run::run;
use crate::simulate::Limits;

/// A SIVA whose gap velocity rebounds with a restitution other than the one in the momentum
/// balance: e changed in one velocity only.
struct Broken {
    siva: Siva,
    wrong_restitution: f64,
}

impl System for Broken {
    type State = SivaState;
    type Flight<'a> = SivaFlight<'a>;
    type Ride<'a> = SivaRide<'a>;

    fn impact(&self, state: &SivaState) -> (SivaState, Jump) {
        let (right, jump) = self.siva.impact(state);
        let rate = Sum::new(-self.wrong_restitution * state.rate.value);
        let wrong = SivaState { rate, ..right };
        (wrong, Jump { gap_velocity_after: wrong.gap_velocity(), ..jump })
    }

    fn clearance(&self) -> f64 {
        self.siva.clearance()
    }
    fn rebound_ratio(&self) -> f64 {
        self.siva.rebound_ratio()
    }
    fn pressure_gain(&self) -> f64 {
        self.siva.pressure_gain()
    }
    fn check_start(&self, start: &Start) -> Result<(), Invalid> {
        self.siva.check_start(start)
    }
    fn begin(&self, start: &Start) -> (SivaState, bool) {
        self.siva.begin(start)
    }
    fn flight(&self, state: &SivaState) -> SivaFlight<'_> {
        self.siva.flight(state)
    }
    fn ride(&self, state: &SivaState) -> SivaRide<'_> {
        self.siva.ride(state)
    }
    fn wall(&self, state: &SivaState) -> Wall {
        self.siva.wall(state)
    }
    fn distance(&self, state: &SivaState) -> Jet {
        self.siva.distance(state)
    }
    fn touch(&self, state: &SivaState, wall: Wall) -> SivaState {
        self.siva.touch(state, wall)
    }
    fn stick(&self, state: &SivaState) -> (SivaState, f64) {
        self.siva.stick(state)
    }
    fn release(&self, state: &SivaState) -> SivaState {
        self.siva.release(state)
    }
    fn primary(&self, state: &SivaState) -> Point {
        self.siva.primary(state)
    }
    fn energy(&self, state: &SivaState) -> f64 {
        self.siva.energy(state)
    }
}

/// The ledger closes to 1e-12 with the right law and misses by far more than that with e off by a
/// millionth in the gap velocity alone.
#[test]
fn ledger_notices_a_broken_impact_law() {
    let start = Start { displacement: 1.0, ..Start::default() };
    let limits = Limits::new(60.0, 0.6);
    for (damping_ratio, error) in [(0.0, 1e-6), (0.01, 1e-6), (0.01, 0.1)] {
        let siva = Siva::new(0.15, 0.5, 0.6, damping_ratio).unwrap();
        let right = run(&siva, &start, &limits).unwrap();
        assert!(right.tally.impacts > 10);
        assert!(right.measures.energy_residual.abs() <= 1e-12 * right.measures.energy_initial);
        let broken = Broken { siva, wrong_restitution: 0.5 + error };
        let wrong = run(&broken, &start, &limits).unwrap();
        assert!(wrong.measures.energy_residual.abs() > 1e-2 * error, "{error}");
    }
}

/// A mirrored start runs through mirrored numbers: the same bits with other signs.
#[test]
fn mirror_image_has_the_same_bits() {
    let siva = Siva::new(0.1, 0.7, 0.2, 0.02).unwrap();
    let limits = Limits::new(100.0, 0.2);
    for (x, v, y, w) in [(1.0, 0.0, 0.0, 0.0), (0.3, -1.0, 0.1, 0.4), (0.0, 1.0, 0.2, 0.0)] {
        let start = Start { displacement: x, velocity: v, gap_displacement: y, gap_velocity: w };
        let mirror =
            Start { displacement: -x, velocity: -v, gap_displacement: -y, gap_velocity: -w };
        let (run, image) =
            (run(&siva, &start, &limits).unwrap(), run(&siva, &mirror, &limits).unwrap());
        assert!(run.tally.impacts > 20);
        assert_eq!(run.impacts.len(), image.impacts.len());
        for (impact, mirrored) in run.impacts.iter().zip(&image.impacts) {
            assert_eq!(impact.time.to_bits(), mirrored.time.to_bits());
            assert_eq!(impact.wall, mirrored.wall.opposite());
            assert_eq!(impact.velocity_after, -mirrored.velocity_after);
        }
    }
}
