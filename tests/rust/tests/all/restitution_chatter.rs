//! Chatter where the restitution depends on the approach speed.
//!
//! Numbers come from closed forms (a light mass that bounces on a structure at rest), and from runs in numbers of twice the
//! precision, which go on one by one to rebounds a thousand times lower.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use Law::Power as PowerLaw;
use iva_core::{
    absorber::{
        Absorber, ImpactLaw, OnStructure, Point, Start, Wall,
        chatter::{Power, Rebound},
    },
    flight::{Curve, GapPoint},
    force::Force,
    host::UndrivenHost,
    observe::{Contact, Events, Observer},
    propagation::Errors,
    real::{Real, twofold::Twofold},
    run::{Run, run},
    simulate::{Limits, Outcome, simulate},
    siva::{FreeMass, SivaState},
};
use iva_tests::list::{List, begun, list};
use iva_tests::{
    U,
    laws::{Free, LAWS, Law, decay, mass, start},
};

/// A light mass on the lower stop of a structure at rest: the pressure is G, so that rebounds of speed u last 2u/G and
/// the next has e(u) u. They are followed here in numbers of twice the precision.
#[test]
fn a_light_mass_bounces_until_its_rebounds_say() {
    let (gravity, first, duration) = (2.0, 0.75, 12.0);
    for law in LAWS {
        let light = [1e-20, 1.0, 0.0];
        let system = mass(light, law).inclined(gravity, Force::default());
        let start = Start { gap_displacement: -1.0, gap_velocity: first, ..Start::default() };
        let limits = Limits::new(duration, 1.0);
        let found = run(&system, &start, &limits).unwrap();
        assert_eq!((found.tally.outcome, found.tally.undecided), (Outcome::Finished, 0));
        let exact = law.made::<Twofold>();
        let (mut time, mut speed) = (Twofold::ZERO, Twofold::from(first));
        let mut listed = found.impacts.iter();
        let mut rounds = 0;
        while time < duration && rounds < 200_000 && speed > 1e-40 {
            time += speed * 2.0 / gravity;
            if speed > limits.chatter_floor && time < duration {
                let impact = listed.next().unwrap();
                let off = f64::from(time - impact.time).abs();
                assert!(off <= 64.0 * U * impact.time, "{law:?} {}: {off:e}", impact.time);
                let off = f64::from(speed - impact.approach_speed()).abs();
                assert!(off <= 64.0 * U, "{law:?} {}: {off:e}", impact.time);
            }
            speed *= exact.restitution(speed);
            rounds += 1;
        }
        assert!(listed.next().is_none(), "{law:?}");
        if !law.sticks() {
            assert_eq!(found.tally.episodes, 0, "{law:?}");
            assert!(time >= duration, "{law:?}: {time:?} {rounds}");
            continue;
        }
        // The rest of a power law: u/g (1/(1 − b) − b g/2), but for a share of g².
        let rest = match law {
            PowerLaw(a, [p, q]) if speed > 0.0 => {
                let (b, u) = (f64::from(p) / f64::from(q), f64::from(speed));
                let g = a * u.powf(b);
                u / g * (1.0 / (1.0 - b) - 0.5 * b * g) * 2.0 / gravity
            }
            _ => 0.0,
        };
        let stick = time + rest;
        let episode = &found.episodes[0];
        let off = f64::from(stick - episode.stick_time).abs();
        assert!(off <= 64.0 * U * episode.stick_time, "{law:?}: {off:e}");
        assert_eq!((episode.wall, found.episodes.len()), (Wall::Minus, 1));
    }
}

/// The bound of the rest of a chatter at each of its rebounds.
#[derive(Debug, Default)]
struct Bounds {
    /// Instants, sums and bounds.
    rebounds: Vec<[Twofold; 3]>,
}

impl Observer<Free<Twofold>> for Bounds {
    fn contact(
        &mut self,
        system: &Free<Twofold>,
        contact: &Contact<'_, SivaState<(), Twofold>, Twofold>,
    ) {
        let Contact { time, states: [_, after], summed } = *contact;
        let leave = system.distance(after);
        if summed || leave.curvature >= 0.0 {
            return;
        }
        let law = system.law_at(system.wall(after), leave.rate);
        let power = law.power.map(|exponent| {
            let kick = law.gain + law.pressure * law.pressure / law.gain;
            Power { exponent, kick }
        });
        let rebound = Rebound {
            speed: leave.rate,
            pressure: -leave.curvature,
            jerk: leave.jerk,
            gain: law.pressure,
            fourth: system.flight(after).fourth(),
            ratio: law.rebound,
            spread: law.spread,
            power,
            back: None,
        };
        let error = rebound.tail_error();
        if power.is_some() && error < 1.0 {
            self.rebounds.push([time, rebound.tail(), error]);
        }
    }
}

/// The bound holds at every rebound of a chatter, from the first for which it is known, and is not much larger than the
/// error.
#[test]
fn the_rest_of_a_chatter_is_within_its_bound() {
    let (mut checked, mut episodes, mut closest) = (0, 0, 0.0_f64);
    for (law, d) in [
        (PowerLaw(0.4, [1, 5]), 0.1),
        (PowerLaw(1.1, [1, 5]), 0.2),
        (PowerLaw(2.0, [1, 3]), 0.1),
        (PowerLaw(3.0, [1, 2]), 0.1),
        (PowerLaw(0.7, [1, 8]), 0.15),
        (PowerLaw(60.0, [3, 4]), 0.1),
    ] {
        for zeta in [0.0, 0.05, 0.6] {
            let system = mass::<Twofold>([0.1, d, zeta], law);
            let mut seen = (Bounds::default(), Events::default());
            let limits = Limits::new(Twofold::from(5.0), system.clearance());
            simulate(&system, &start(), &limits, None, &mut seen).unwrap();
            let (Bounds { rebounds }, Events { episodes: found, .. }) = seen;
            for episode in &found {
                let within =
                    |time: Twofold| time >= episode.start_time && time <= episode.stick_time;
                for [time, tail, error] in rebounds.iter().filter(|[time, ..]| within(*time)) {
                    let off = f64::from((episode.stick_time - *time - *tail).abs());
                    let bound = f64::from(*error);
                    assert!(off <= bound + 1e-21, "{law:?} {zeta} {time:?}: {off:e} {bound:e}");
                    closest = closest.max(off / bound);
                    checked += 1;
                }
            }
            episodes += found.len();
        }
    }
    assert!(episodes >= 12 && checked > 1000, "{episodes} {checked}");
    assert!(closest > 0.05, "{closest}");
}

/// Impacts within their estimated errors, and sticks and releases to rounding; where no chatter ends, none does.
#[test]
fn doubles_agree_with_twice_the_precision() {
    for law in LAWS {
        let mut sticks = 0;
        for d in [0.05, 0.1, 0.3, 0.8] {
            let numbers = [0.15, d, 0.02];
            let [plain, exact] = [3.0, 3.0].map(|periods| periods * TAU);
            let (plain, exact) = (
                decay(&mass::<f64>(numbers, law), plain),
                decay(&mass::<Twofold>(numbers, law), exact),
            );
            let mut errors = Errors::default();
            let system = mass::<f64>(numbers, law);
            simulate(&system, &start(), &Limits::new(3.0 * TAU, d), None, &mut errors).unwrap();
            assert_eq!(plain.tally.outcome, Outcome::Finished);
            assert_eq!(plain.impacts.len(), exact.impacts.len(), "{law:?} {d}");
            for ((a, b), error) in plain.impacts.iter().zip(&exact.impacts).zip(&errors.impacts) {
                let (off, estimate) = (f64::from(b.time - a.time).abs(), error.time.unwrap());
                assert!(
                    off <= 4.0 * estimate + 4.0 * U,
                    "{law:?} {d} {}: {off:e} {estimate:e}",
                    a.time
                );
            }
            assert_eq!(plain.episodes.len(), exact.episodes.len(), "{law:?} {d}");
            for (a, b) in plain.episodes.iter().zip(&exact.episodes) {
                let off = f64::from(b.stick_time - a.stick_time).abs();
                assert!(off <= 2e-13, "{law:?} {d} {}: {off:e}", a.stick_time);
                let releases = a.release_time.zip(b.release_time);
                let off = releases.map_or(0.0, |(a, b)| f64::from(b - a).abs());
                assert!(off <= 2e-13, "{law:?} {d} {:?}: {off:e}", a.release_time);
                assert_eq!(a.impacts, b.impacts);
            }
            sticks += plain.episodes.len();
        }
        assert_eq!(sticks > 0, law.sticks(), "{law:?}: {sticks}");
    }
}

/// A list of one mass is the free mass, whatever its law.
#[test]
fn one_of_several_is_the_free_mass() {
    for law in LAWS {
        let numbers = [0.15, 0.1, 0.02];
        let n = Twofold::from;
        let masses = [FreeMass::new(n(0.15), Twofold::ONE, n(0.1))
            .unwrap()
            .with_restitution_laws([law.made(); 2])];
        let listed = list(n(0.02), &masses);
        let zero = Twofold::ZERO;
        let gaps = [GapPoint { y: zero, w: zero }];
        let starts = begun(Point { x: Twofold::ONE, v: zero }, &gaps);
        let limits = Limits::new(n(10.0), n(0.1));
        let (one, alone) =
            (run(&listed, &starts, &limits).unwrap(), decay(&mass::<Twofold>(numbers, law), 10.0));
        assert_eq!(one.impacts.len(), alone.impacts.len(), "{law:?}");
        for (a, b) in one.impacts.iter().zip(&alone.impacts) {
            let off = f64::from(a.time - b.time).abs();
            assert!(off < 1e-20, "{law:?}: {off:e}");
        }
        assert_eq!(one.episodes.len(), alone.episodes.len(), "{law:?}");
        for (a, b) in one.episodes.iter().zip(&alone.episodes) {
            let off = f64::from(a.stick_time - b.stick_time).abs();
            assert!(off < 1e-20, "{law:?}: {off:e}");
        }
    }
}

/// Two masses with laws of their own on one structure: energy adds up, and doubles agree with twice the precision. The
/// second never sticks, so that the chatter of the first is summed.
#[test]
fn several_masses_have_their_laws() {
    fn built<R: Real>(k: usize) -> List<UndrivenHost<R>> {
        let laws = [[LAWS[k], LAWS[(k + 1) % 8]], [LAWS[5], LAWS[7]]];
        let numbers = [(0.1, 0.1), (0.05, 0.7)].into_iter().zip(laws);
        let mut masses = numbers.map(|((mu, d), laws)| {
            let mass = FreeMass::new(R::from(mu), R::ONE, R::from(d)).unwrap();
            mass.with_restitution_laws(laws.map(Law::made))
        });
        let masses = [masses.next().unwrap(), masses.next().unwrap()];
        list(R::from(0.02), &masses)
    }
    fn ran<R: Real>(k: usize) -> Run<<List<UndrivenHost<R>> as OnStructure>::State, R> {
        let gaps = [GapPoint { y: R::ZERO, w: R::from(0.1) }; 2];
        let starts = begun(Point { x: R::ONE, v: R::ZERO }, &gaps);
        run(&built(k), &starts, &Limits::new(R::from(8.0), R::from(0.3))).unwrap()
    }
    let [mut impacts, mut sticks] = [0, 0];
    for k in 0..8 {
        let (plain, exact) = (ran::<f64>(k), ran::<Twofold>(k));
        assert!(plain.measures.energy_residual.abs() < 1e-13, "{k}");
        assert_eq!(plain.impacts.len(), exact.impacts.len(), "{k}");
        for (a, b) in plain.impacts.iter().zip(&exact.impacts) {
            let off = f64::from(b.time - a.time).abs();
            assert!(off < 1e-11 && a.absorber == b.absorber, "{k} {}: {off:e}", a.time);
            let first = [LAWS[k], LAWS[(k + 1) % 8]];
            let at = if a.absorber == 0 { first } else { [LAWS[5], LAWS[7]] }[a.wall.index()];
            let e = at.expected(a.approach_speed());
            assert!((a.gap_velocity_after + e * a.gap_velocity_before).abs() < 1e-14, "{k}");
        }
        assert_eq!(plain.episodes.len(), exact.episodes.len(), "{k}");
        for (a, b) in plain.episodes.iter().zip(&exact.episodes) {
            let off = f64::from(b.stick_time - a.stick_time).abs();
            assert!(off < 1e-12, "{k} {}: {off:e}", a.stick_time);
        }
        impacts += plain.impacts.len();
        sticks += plain.episodes.len();
    }
    assert!(impacts > 200 && sticks > 3, "{impacts} {sticks}");
}
