//! The proofs of the quintic hold on densely sampled stretches, and its constants are attained by the extreme
//! function.

use super::*;
use crate::absorber::Absorber;
use crate::absorber::siva::exact::InFlight;
use crate::absorber::siva::motion::{SivaFlight, arrived};
use crate::absorber::siva::trial::{Trial, search};
use crate::absorber::siva::{Siva, SivaState};
use crate::force::{Acts, Force, Harmonic};
use crate::host::oscillator::Primary;
use crate::host::{DrivenHost, Host, HostState, Phase, Structure};
use crate::number::compensated::DoubleDouble;
use crate::segment::flight::Meets;

/// t³(1 − t)³/720 has the sixth derivative −1 and the quintic 0: it attains the largest error for M = 1.
#[test]
fn the_constants_are_those_of_the_extreme_function() {
    let most = |f: &dyn Fn(f64) -> f64| {
        (0..=10_000).map(|i| f(f64::from(i) * 1e-4).abs()).fold(0.0, f64::max)
    };
    let (p, q) = (|t: f64| t * (1.0 - t), |t: f64| 1.0 - 2.0 * t);
    let off = most(&|t| p(t).powi(3) / 720.0);
    let slope_off = most(&|t| p(t).powi(2) * q(t) / 240.0);
    let bend_off = most(&|t| p(t) * (q(t).powi(2) - p(t)) / 120.0);
    let rise_off = most(&|t| t * t * (1.0 - t).powi(3) / 720.0);
    for (constant, found) in
        [(OFF, off), (SLOPE_OFF, slope_off), (RISE_OFF, rise_off), (RISE_SLOPE_OFF, 0.5 * bend_off)]
    {
        assert!((found..1.001 * found).contains(&(constant * (1.0 + 1e-9))), "{constant} {found}");
    }
}

/// Numbers spread evenly over [0, 1): the fractional parts of multiples of an irrational number.
fn spread(i: u32, k: u32) -> f64 {
    (f64::from(i) * f64::from(2 * k + 3).sqrt()).fract()
}

/// A stretch that starts within the gap and nearly touches a wall: at some instant its distance and its rate
/// are small.
struct Stretch<H: Host<Real = f64>> {
    siva: Siva<H>,
    from: SivaState<Phase<H>>,
    length: f64,
}

/// A free mass, without drive.
fn undriven(i: u32) -> Siva {
    let u = |k| spread(i, k);
    let zeta = [0.0, 0.02, 0.9, 2.0][(4.0 * u(0)) as usize];
    Siva::new(0.1, 0.5, [0.03, 0.4, 1.6][(3.0 * u(1)) as usize], zeta).unwrap()
}

/// A free mass under force, or on a moving base, slow or fast.
fn driven(i: u32) -> Siva<DrivenHost> {
    let u = |k| spread(i, k);
    let acts = if u(20) < 0.5 { Acts::Primary } else { Acts::Base };
    let (amplitude, frequency) = (2.0 * u(21), 0.1 + 3.0 * u(22));
    let harmonic = Harmonic { amplitude, frequency, phase: 6.0 * u(23), acts };
    undriven(i).under(Force::harmonic(vec![harmonic]).unwrap())
}

/// The state after a flight.
fn flown<H: Host<Real = f64>>(
    siva: &Siva<H>,
    from: &SivaState<Phase<H>>,
    h: f64,
) -> SivaState<Phase<H>> {
    let free = siva.host.free();
    arrived(free, &free.course(&from.host), from, h)
}

impl<H: Host<Real = f64>> Stretch<H> {
    fn planted(i: u32, siva: Siva<H>) -> Option<Self> {
        let u = |k| spread(i, k);
        let small = |k| 10f64.powf(-12.0 * u(k)) * if u(k + 1) < 0.5 { 1.0 } else { -1.0 };
        let (v, x) = (std::f64::consts::TAU * u(4)).sin_cos();
        let primary = Primary { x: DoubleDouble::new(x), v: DoubleDouble::new(v) };
        let host = siva.host.state(siva.host.begin_at(DoubleDouble::ZERO), primary);
        let length = siva.host.free().reach(&host) * if u(2) < 0.5 { 1.0 } else { u(3) };
        let wall = if u(5) < 0.5 { 0.0 } else { 2.0 * siva.clearance() };
        let touching = SivaState {
            host,
            side: if u(6) < 0.5 { 1.0 } else { -1.0 },
            distance: DoubleDouble::new(wall + small(7)),
            rate: DoubleDouble::new(if u(9) < 0.5 { 0.0 } else { small(10) }),
        };
        let mut from = flown(&siva, &touching, -(1.2 * u(12) - 0.1) * length);
        if u(13) < 0.3 {
            // Starts on the wall, as a low rebound.
            from.distance = DoubleDouble::ZERO;
            from.rate = DoubleDouble::new(small(14).abs());
        }
        let inside = (0.0..=2.0 * siva.clearance()).contains(&from.distance.value);
        inside.then_some(Self { siva, from, length })
    }

    fn flight(&self) -> SivaFlight<'_, H> {
        self.siva.flight(&self.from)
    }

    /// The signs of the distances beyond both walls, sampled in time, without repetitions. Samples within
    /// rounding of a wall are left out.
    fn sides(&self) -> Vec<i32> {
        let far = 2.0 * self.siva.clearance();
        let mut sides = Vec::new();
        for i in 1..=300 {
            let h = self.length * f64::from(i) / 300.0;
            let distance = flown(&self.siva, &self.from, h).distance;
            let (near, beyond) = (distance.value, distance.minus(far));
            if near.abs() < 1e-15 || beyond.abs() < 1e-15 {
                continue;
            }
            let side = if near < 0.0 { -1 } else { i32::from(beyond > 0.0) };
            if sides.last() != Some(&side) {
                sides.push(side);
            }
        }
        sides
    }
}

#[test]
fn what_is_proved_of_a_stretch_holds_all_along_it() {
    proofs_hold(undriven);
    proofs_hold(driven);
}

fn proofs_hold<H: Host<Real = f64>>(siva: impl Fn(u32) -> Siva<H>) {
    let mut seen = [0; 4];
    for i in 1..40_000 {
        let Some(stretch) = Stretch::planted(i, siva(i)) else { continue };
        let Stretch { siva, from, length } = &stretch;
        let free = siva.host.free();
        let mass = InFlight { free, course: &free.course(&from.host) };
        let sight = search(&mass, from, &Trial::new(*length), 1.0 / siva.clearance());
        let (verdict, claimed) = match (sight.free, sight.meets, sight.far) {
            (false, false, _) => {
                seen[3] += 1;
                continue;
            }
            (true, false, false) => (0, [0].as_slice()),
            (false, true, false) => (1, [0, -1].as_slice()),
            (false, true, true) => (2, [0, 1].as_slice()),
            other => panic!("stretch {i}: {other:?}"),
        };
        seen[verdict] += 1;
        let sides = stretch.sides();
        // The contact may be earlier than the first sample.
        let at_once = verdict > 0 && sides == claimed[1..];
        assert!(
            at_once || sides == claimed,
            "stretch {i}: {sight:?}, {sides:?}, {from:?}, {length}"
        );
    }
    assert!(seen.iter().all(|count| *count > 500), "{seen:?}");
}

#[test]
fn a_contact_found_is_on_the_wall() {
    contacts_are_on_the_wall(undriven);
    contacts_are_on_the_wall(driven);
}

fn contacts_are_on_the_wall<H: Host<Real = f64>>(siva: impl Fn(u32) -> Siva<H>) {
    let mut contacts = 0;
    for i in 1..40_000 {
        let Some(stretch) = Stretch::planted(i, siva(i)) else { continue };
        let Stretch { siva, from, length } = &stretch;
        let fast = stretch.flight().fast_flight(*length);
        let Some(fast) = fast.filter(|fast| fast.meets == Meets::Wall) else { continue };
        contacts += 1;
        let HostState { primary, acceleration, phase } = &fast.end.host;
        assert_eq!(*acceleration, siva.host.free().acceleration(phase, primary), "stretch {i}");
        let there = flown(siva, from, fast.length + fast.later);
        let far = fast.end.side != from.side;
        let left =
            if far { there.distance.minus(2.0 * siva.clearance()) } else { there.distance.value };
        // The clock is rounded to `length`; that changes the distance in proportion to its rate.
        let rounding = f64::EPSILON * (there.rate.value.abs() + siva.clearance());
        assert!(left.abs() <= 2.0 * rounding, "stretch {i}: {left:e}");
    }
    assert!(contacts > 2000, "{contacts}");
}
