//! Leaps under a drive, and what measures take from leaps: turns of the structure, and losses.
//!
//! Numbers come from closed forms: an undamped mode under harmonic force and base motion, also at resonance; a speed whose smallest
//! value is planted; the energy of a damped sine; and from runs in numbers of twice the precision, which never leap.
#![allow(clippy::unwrap_used, clippy::panic)]

use iva_core::{
    absorber::modal::{Modal, ModalStart, ModalStructure, Tie},
    absorber::{Absorber, OnStructure},
    flight::{GapPoint, Motion, Turns},
    force::{Acts, Force, Harmonic, Impulse},
    host::{DrivenHost, UndrivenHost},
    observe::{Observer, Span},
    real::{Real, twofold::Twofold},
    run::run,
    simulate::{Limits, simulate},
    siva::FreeMass,
};
use iva_tests::rng::Rng;

type Driven = Modal<DrivenHost<f64>, 1>;

/// A mass of 10⁻²⁸ in a gap of clearance d on an undamped mode of frequency 1 that takes part in the motion of its base by γ.
fn driven(d: f64, part: f64, harmonics: &[Harmonic]) -> Driven {
    let structure = ModalStructure::new(&[1.0], &[0.0]).unwrap();
    let structure = structure.with_point("p", &[1.0]).unwrap().with_base(&[part]).unwrap();
    // With a point that moves half as far the structure does not move as one, which would not leap.
    let structure = structure.with_point("below", &[0.5]).unwrap();
    let system = Modal::new(structure, [(FreeMass::new(1e-28, 0.5, d).unwrap(), "p")]).unwrap();
    system.under(Force::harmonic(harmonics.to_vec()).unwrap(), "p").unwrap()
}

/// What an observer is shown of x, beside a function of time.
struct Shown<F> {
    x: F,
    spans: usize,
    off: f64,
}

impl<F: Fn(f64) -> f64> Observer<Driven> for Shown<F> {
    fn span<M: Motion<Real = f64, State = <Driven as OnStructure>::State>>(
        &mut self,
        _system: &Driven,
        span: &Span<'_, M>,
    ) {
        self.spans += 1;
        let x = (self.x)(span.start.value + span.length);
        self.off = self.off.max((span.to.x - x).abs());
    }
}

/// At resonance without damping x = (a/2) t sin t + q cos t + v sin t: leaps have no special case.
#[test]
fn a_structure_leaps_at_resonance() {
    let (a, q, v, duration) = (0.3, 0.4, -0.2, 200.0);
    let harmonic = Harmonic { amplitude: a, frequency: 1.0, phase: 0.0, acts: Acts::Primary };
    let system = driven(500.0, 1.0, &[harmonic]);
    let start = ModalStart::new(&[q], &[v], [GapPoint { y: 0.0, w: 0.0 }]).unwrap();
    let coast = system.coasts(&system.begin(&start), duration);
    let steps = coast.map_or(0, |(steps, _)| steps);
    assert!(steps > 1, "{steps}");
    let x = |t: f64| (0.5 * a * t + v) * t.sin() + q * t.cos();
    let mut shown = Shown { x, spans: 0, off: 0.0 };
    let tally = simulate(&system, &start, &Limits::new(duration, 1e-9), None, &mut shown).unwrap();
    assert_eq!(tally.impacts, 0);
    assert!(shown.spans > 100, "{}", shown.spans);
    // The closed form itself rounds angles of 200 rad.
    assert!(shown.off < 30.0 * 200.0 * 4e-16, "{:e}", shown.off);
}

/// Impulses come between leaps, at their instants; and more harmonic parts than leaps take are left to the power series. Both in closed form.
#[test]
fn impulses_and_many_harmonics_are_met() {
    let (duration, kicks) = (60.0, [(0.3, 3.37), (-0.5, 11.1), (0.2, 11.3), (0.4, 40.0)]);
    for count in [0, 1, 4, 5] {
        let harmonics: Vec<Harmonic> = (0..count)
            .map(|k| Harmonic {
                amplitude: 0.1 + 0.05 * f64::from(k),
                frequency: 0.3 + 0.45 * f64::from(k),
                phase: 0.7 * f64::from(k),
                acts: Acts::Primary,
            })
            .collect();
        let impulses = kicks.map(|(velocity, time)| Impulse { velocity, time });
        let force = Force::new(harmonics.clone(), vec![], &impulses).unwrap();
        let structure = ModalStructure::new(&[1.0], &[0.0]).unwrap();
        let structure = structure.with_point("p", &[1.0]).unwrap();
        let structure = structure.with_point("below", &[0.5]).unwrap();
        let mass = FreeMass::new(1e-28, 0.5, 500.0).unwrap();
        let system: Driven =
            Modal::new(structure, [(mass, "p")]).unwrap().under(force, "p").unwrap();
        let start = ModalStart::new(&[0.0], &[0.0], [GapPoint { y: 0.0, w: 0.0 }]).unwrap();
        let coast = system.coasts(&system.begin(&start), duration);
        let steps = coast.map_or(0, |(steps, _)| steps);
        assert_eq!(steps > 1, count < 5, "{count} harmonics: {steps}");
        let x = |t: f64| {
            let of = |it: &Harmonic| {
                let (w, over) = (it.frequency, it.amplitude / (1.0 - it.frequency.powi(2)));
                let (s, c) = it.phase.sin_cos();
                over * ((w * t + it.phase).cos() - c * t.cos() + w * s * t.sin())
            };
            let swings: f64 = harmonics.iter().map(of).sum();
            let pushed = kicks.iter().filter(|kick| kick.1 < t);
            swings + pushed.map(|(v, at)| v * (t - at).sin()).sum::<f64>()
        };
        let mut shown = Shown { x, spans: 0, off: 0.0 };
        let limits = Limits::new(duration, 1e-9);
        simulate(&system, &start, &limits, None, &mut shown).unwrap();
        assert!(shown.spans > 50 && shown.off < 1e-12, "{count}: {} {:e}", shown.spans, shown.off);
    }
}

/// The first contact of a mass that nothing holds, over a structure under a force and on a base that moves.
#[test]
fn contacts_after_driven_leaps_are_those_of_the_closed_form() {
    let mut rng = Rng::new(74);
    let [mut met, mut later] = [0, 0];
    for scene in 0..400 {
        let [f, g] = [Acts::Primary, Acts::Base].map(|acts| Harmonic {
            amplitude: rng.range(0.05, 0.4),
            frequency: if rng.unit() < 0.5 { rng.range(0.2, 0.8) } else { rng.range(1.3, 4.0) },
            phase: rng.range(-3.0, 3.0),
            acts,
        });
        let (part, d) = (rng.range(-1.0, 1.0), rng.range(1.5, 6.0));
        let [q, v, w] = [rng.range(-1.0, 1.0), rng.range(-1.0, 1.0), rng.range(-0.5, 0.5)];
        let wave = |it: &Harmonic, t: f64| it.amplitude * (it.frequency * t + it.phase).cos();
        let rate = |it: &Harmonic, t: f64| {
            -it.amplitude * it.frequency * (it.frequency * t + it.phase).sin()
        };
        let [by_f, by_g] = [1.0 / (1.0 - f.frequency.powi(2)), -part / (1.0 - g.frequency.powi(2))];
        let steady = |t: f64| by_f * wave(&f, t) + by_g * wave(&g, t);
        let steady_rate = |t: f64| by_f * rate(&f, t) + by_g * rate(&g, t);
        let u = |t: f64| (q - steady(0.0)) * t.cos() + (v - steady_rate(0.0)) * t.sin() + steady(t);
        let square = g.frequency.powi(2);
        let absolute =
            |t: f64| q + (v + w) * t + (wave(&g, t) - wave(&g, 0.0) - rate(&g, 0.0) * t) / square;
        let y = |t: f64| absolute(t) - u(t);
        // The closed form, in steps that a contact cannot hide in unless it grazes.
        let (step, mut first, mut least) = (1e-3, None, f64::INFINITY);
        for k in 1..30_000 {
            let [a, b, c] = [-1.0, 0.0, 1.0].map(|i| y(step * (f64::from(k) + i)).abs());
            if b >= d {
                first = Some(step * f64::from(k));
                break;
            }
            if b > a && b > c {
                least = least.min((d - b).abs());
            }
        }
        let Some(mut time) = first.filter(|_| least > 1e-4) else { continue };
        let mut before = time - step;
        for _ in 0..60 {
            let middle = 0.5 * (before + time);
            if y(middle).abs() >= d { time = middle } else { before = middle }
        }
        let slope = (y(time + 1e-6) - y(time - 1e-6)) * 5e5;
        if slope.abs() < 1e-2 {
            continue;
        }
        let system = driven(d, part, &[f, g]);
        let start = ModalStart::new(&[q], &[v], [GapPoint { y: 0.0, w }]).unwrap();
        let found = run(&system, &start, &Limits::new(time + 0.1, 1e-9)).unwrap();
        let impact = found.impacts.first().unwrap_or_else(|| panic!("scene {scene}: {time}"));
        let off = (impact.time - time).abs() * slope.abs();
        // In the sum of terms of size 40 of the closed form.
        assert!(off < 40.0 * 4e-16 * (4.0 + time), "scene {scene}: {off:e} at {time}");
        met += 1;
        later += usize::from(time > 5.0);
    }
    println!("{met} contacts, {later} of them after 5");
    assert!(met > 250 && later > 80, "{met} {later}");
}

/// The speed c + b cos(3t + φ) is smallest within a flight, and there δ b: no proof that the structure does not turn where it does.
#[test]
fn a_turn_within_a_flight_is_not_denied() {
    let mut rng = Rng::new(75);
    let [mut turning, mut proved, mut smooth] = [0, 0, 0];
    for _ in 0..4000 {
        let (b, at) = (rng.log_range(0.1, 10.0), rng.range(0.02, 0.28));
        let turns_round = rng.unit() < 0.5;
        let above = if turns_round { -rng.log_range(1e-5, 0.04) } else { rng.log_range(1e-5, 0.4) };
        let (angle, sign) = (std::f64::consts::PI - 3.0 * at, rng.sign());
        // A mode so slow that its speed is constant.
        let structure = ModalStructure::new(&[1e-4, 3.0], &[0.0; 2]).unwrap();
        let structure = structure.with_point("p", &[1.0; 2]).unwrap();
        let mass = FreeMass::new(1e-28, 0.5, 500.0).unwrap();
        let system: Modal<UndrivenHost, 1> = Modal::new(structure, [(mass, "p")]).unwrap();
        let q = [0.0, sign * b * angle.sin() / 3.0];
        let v = [sign * b * (1.0 + above), sign * b * angle.cos()];
        let start = ModalStart::new(&q, &v, [GapPoint { y: 0.0, w: 0.0 }]).unwrap();
        let flight = system.flight(&system.begin(&start));
        let length = flight.reach();
        assert!(length > 0.3, "{length}");
        let turns = flight.turns(length, &flight.state(length));
        if above < 0.0 {
            assert_eq!(turns, Turns::Unknown, "{above} at {at}");
            turning += 1;
        } else if above > 0.08 {
            smooth += 1;
            proved += usize::from(turns == Turns::Never);
        }
    }
    println!("{turning} turn; {proved} of {smooth} are proved not to");
    assert!(turning > 1500 && 4 * proved > 3 * smooth, "{turning} {proved} {smooth}");
}

/// Between two bumps the speed dips to δ, where both ends and the slopes there tell of a bump alone: two modes whose curvatures cancel. Only
/// the bound on what lies between the ends knows.
#[test]
fn a_dip_between_bumps_is_not_denied() {
    let mut rng = Rng::new(79);
    let [mut turning, mut proved] = [0, 0];
    for _ in 0..400 {
        let structure = ModalStructure::new(&[1e-4, 1.5, 3.0], &[0.0; 3]).unwrap();
        let structure = structure.with_point("p", &[1.0; 3]).unwrap();
        let mass = FreeMass::new(1e-28, 0.5, 500.0).unwrap();
        let system: Modal<UndrivenHost, 1> = Modal::new(structure, [(mass, "p")]).unwrap();
        let rest = [GapPoint { y: 0.0, w: 0.0 }];
        let still = ModalStart::new(&[], &[1.0], rest).unwrap();
        let length = system.flight(&system.begin(&still)).reach();
        // v = δ + q s² − s⁴ + … with s from the middle on, whose bumps are at s² = q/2, within the flight but beyond half of its square.
        let square = 0.25 * length * length;
        let q = 2.0 * square * rng.range(0.6, 0.8);
        // q = −(9 a + 2.25 b)/2 and 1 = −(81 a + 5.0625 b)/24 with a, b the speeds of the modes 3 and 1.5.
        let a = (-24.0 + 4.5 * q) / (81.0 - 20.25);
        let b = (-2.0 * q - 9.0 * a) / 2.25;
        let high = q * square - square * square;
        let dips = rng.unit() < 0.5;
        let delta = high * if dips { -rng.range(0.05, 0.9) } else { rng.range(0.0, 40.0) };
        let half = 0.5 * length;
        let places = [0.0, -b / 1.5 * f64::sin(1.5 * half), -a / 3.0 * f64::sin(3.0 * half)];
        let speeds = [delta - a - b, b * f64::cos(1.5 * half), a * f64::cos(3.0 * half)];
        let start = ModalStart::new(&places, &speeds, rest).unwrap();
        let flight = system.flight(&system.begin(&start));
        let turns = flight.turns(length, &flight.state(length));
        if dips {
            assert_eq!(turns, Turns::Unknown, "{delta:e} of {high:e}");
            turning += 1;
        } else if delta > 10.0 * high {
            proved += usize::from(turns == Turns::Never);
        }
    }
    println!("{turning} dip below 0; {proved} others are proved to stay above");
    assert!(turning > 150 && proved > 20, "{turning} {proved}");
}

/// What a damped sine loses in a flight of many leaps, E₀ − E in closed form.
#[test]
fn leaps_lose_what_a_damped_sine_loses() {
    let mut rng = Rng::new(76);
    for _ in 0..40 {
        let (zeta, omega, duration) =
            (rng.range(0.001, 0.2), rng.range(0.5, 4.0), rng.range(5.0, 40.0));
        let structure = ModalStructure::new(&[omega], &[zeta]).unwrap();
        let structure = structure.with_point("p", &[1.0]).unwrap();
        let mass = FreeMass::new(1e-28, 0.5, 500.0).unwrap();
        let system: Modal<UndrivenHost, 1> = Modal::new(structure, [(mass, "p")]).unwrap();
        let start = ModalStart::new(&[1.0], &[], [GapPoint { y: 0.0, w: 0.0 }]).unwrap();
        let found = run(&system, &start, &Limits::new(duration, 1e-9)).unwrap();
        let damped = omega * (1.0 - zeta * zeta).sqrt();
        let (s, c) = (damped * duration).sin_cos();
        let fallen = (-zeta * omega * duration).exp();
        let x = fallen * (c + zeta * omega / damped * s);
        let v = -fallen * omega * omega / damped * s;
        let lost = 0.5 * (omega * omega * (1.0 - x * x) - v * v);
        let off = found.measures.energy_viscous - lost;
        assert!(off.abs() < 1e-14 * omega * omega, "{zeta} {omega} {duration}: {off:e}");
    }
}

/// Losses of masses with springs and dashpots, of which leaps know forms: those of a run to twice the precision, and a closed ledger.
#[test]
fn leaps_of_tied_masses_lose_what_series_lose() {
    let mut rng = Rng::new(77);
    for scene in 0..12 {
        let numbers = [rng.range(0.0, 0.05), rng.range(0.0, 0.05), rng.range(1.5, 4.0)];
        let [mu, e, d] = [rng.range(0.05, 0.3), rng.range(0.3, 0.9), rng.range(0.4, 1.2)];
        let tie = [if scene % 3 == 0 { 0.0 } else { rng.range(0.01, 0.1) }, rng.range(0.001, 0.02)];
        let [shape, q] = [rng.range(-1.0, 1.0), rng.range(-1.0, 1.0)];
        fn ran<R: Real>(
            [zeta, other, omega]: [f64; 3],
            [mu, e, d]: [f64; 3],
            [spring, damping]: [f64; 2],
            [shape, q]: [f64; 2],
        ) -> [f64; 4] {
            let n = R::from;
            let structure = ModalStructure::new(&[n(1.0), n(omega)], &[n(zeta), n(other)]).unwrap();
            let structure = structure.with_point("p", &[n(1.0), n(shape)]).unwrap();
            let mass = FreeMass::new(n(mu), n(e), n(d)).unwrap();
            let system: Modal<UndrivenHost<R>, 1> = Modal::new(structure, [(mass, "p")]).unwrap();
            let tie = Tie { spring: n(spring), damping: n(damping) };
            let system = system.with_ties(&[tie]).unwrap();
            let rest = GapPoint { y: n(0.0), w: n(0.0) };
            let start = ModalStart::new(&[n(1.0), n(q)], &[], [rest]).unwrap();
            let measures = run(&system, &start, &Limits::new(n(25.0), n(1e-9))).unwrap().measures;
            let [all, gaps] = [measures.energy_viscous, measures.energy_pivot].map(R::double);
            [all, gaps, measures.energy_residual.double(), measures.energy_initial.double()]
        }
        let [viscous, gaps, residual, whole] = ran::<f64>(numbers, [mu, e, d], tie, [shape, q]);
        let [exact, in_gaps, ..] = ran::<Twofold>(numbers, [mu, e, d], tie, [shape, q]);
        let bound = 1e-12 * whole;
        assert!((viscous - exact).abs() < bound, "scene {scene}: {viscous} {exact}");
        assert!((gaps - in_gaps).abs() < bound, "scene {scene}: {gaps} {in_gaps}");
        assert!(residual.abs() < 1e-14 * whole, "scene {scene}: {residual:e} of {whole}");
    }
}
