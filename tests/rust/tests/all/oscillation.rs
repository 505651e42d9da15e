//! What only bounds know of, on a structure that moves as one: the end of a hold, and a stop, between two instants at which nothing tells
//! of it. Both are planted in closed form.
#![allow(clippy::unwrap_used)]

use iva_core::{
    absorber::{OnStructure, Point},
    flight::GapPoint,
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    observe::Observer,
    sample::Sampler,
    simulate::{Instant, Limits, simulate},
    siva::FreeMass,
    steady::{Steady, SteadyWanted, Window},
};
use iva_tests::list::{List, begun, list};

type Driven = List<DrivenHost<f64>>;
type State = <Driven as OnStructure>::State;

/// The first instants at which a held mass slides off, and at which a mass stops.
#[derive(Default)]
struct Watch {
    slips: Vec<f64>,
    stops: Vec<f64>,
}

impl Observer<Driven> for Watch {
    fn slip(&mut self, _system: &Driven, from: &Instant<State, f64>) {
        self.slips.push(from.time.value);
    }
    fn stop(&mut self, _system: &Driven, time: f64, _states: [&State; 2]) {
        self.stops.push(time);
    }
}

/// Lowest of the frequencies that are planted; the others are multiples of it.
const BASE: f64 = 1.3;

/// Runs a mass so light that the structure does not feel it on an undamped structure whose acceleration is
/// Σ aₖ cos kΩs + bₖ sin kΩs, with Ωs = Ωτ − `before`.
fn ran(parts: &[[f64; 2]], friction: f64, w: f64, before: f64, duration: f64) -> Watch {
    let mut harmonics = vec![];
    let (mut x, mut v) = (0.0, 0.0);
    for (k, [a, b]) in parts.iter().enumerate() {
        let frequency = BASE * (k + 1) as f64;
        let begin = -before * (k + 1) as f64;
        let size = a.hypot(*b);
        // a cos θ + b sin θ = size cos(θ + phase).
        let phase = (-b).atan2(*a);
        let square = frequency * frequency;
        // x = −A/ω² belongs to the force (1 − ω²) x.
        let amplitude = -size * (1.0 - square) / square;
        harmonics.push(Harmonic {
            amplitude,
            frequency,
            phase: phase + begin,
            acts: Acts::Primary,
        });
        x -= size / square * (begin + phase).cos();
        v += size / frequency * (begin + phase).sin();
    }
    let mass = FreeMass::new(1e-28, 0.5, 50.0).unwrap();
    let rubs = list(0.0, &[mass]).with_friction(&[friction]).unwrap();
    let system = rubs.under(Force::harmonic(harmonics).unwrap(), "primary").unwrap();
    let mut watch = Watch::default();
    let start = begun(Point { x, v }, &[GapPoint { y: 0.0, w }]);
    simulate(&system, &start, &Limits::new(duration, 1e-6), None, &mut watch).unwrap();
    watch
}

/// The first sign change of a function that is positive at the begin.
fn zero(of: impl Fn(f64) -> f64, [mut low, end]: [f64; 2]) -> f64 {
    let mut high = low;
    while of(high) > 0.0 {
        (low, high) = (high, high + 1e-3);
        assert!(high < end, "no zero");
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if of(middle) > 0.0 { low = middle } else { high = middle }
    }
    low
}

fn sum(parts: &[[f64; 2]], s: f64) -> f64 {
    let of = |(k, [a, b]): (usize, &[f64; 2])| {
        let (sin, cos) = ((k + 1) as f64 * s).sin_cos();
        a * cos + b * sin
    };
    parts.iter().enumerate().map(of).sum()
}

/// A(0) = R + δ, A″(0) = −ε, A⁗(0) = 10, all over Ω's powers: friction R gives way for a moment around 0, between two instants at which the
/// cubic through values and rates of R − A stays positive.
#[test]
fn a_hold_ends_where_only_the_bound_knows() {
    let (friction, bend) = (1.0, 0.08);
    for (k, depth) in [1e-4, 2e-4, 3e-4, 4e-4].into_iter().enumerate() {
        let a3 = (10.0 + 4.0 - 5.0 * bend) / 40.0;
        let a2 = (bend - 1.0 - 8.0 * a3) / 3.0;
        let scale = friction + depth;
        let parts = [1.0 - a2 - a3, a2, a3].map(|a| [a * scale, 0.0]);
        let before = 0.2 + 0.002 * k as f64;
        let watch = ran(&parts, friction, 0.0, before, 0.36 / BASE);
        let left = |s: f64| friction - sum(&parts, s);
        let truth = (zero(left, [-before, 0.0]) + before) / BASE;
        let found = watch.slips.first().copied().unwrap_or(f64::NAN);
        assert!((found - truth).abs() < 1e-9, "{depth}: {found} {truth}");
    }
}

/// The speed is −δ at 0, with the rate 0, the second derivative ε, and the fourth −1, over Ω's powers: the mass stops for a moment around 0.
#[test]
fn a_stop_comes_where_only_the_bound_knows() {
    let (friction, bend) = (0.05, 0.02);
    for (k, depth) in [2e-5, 5e-5, 1e-4, 1.5e-4].into_iter().enumerate() {
        // The acceleration of the mass in its gap is −(A + R), Ω times the rate over Ωs.
        let b2 = (bend - 1.0) / 6.0;
        let parts = [[-4.0 / 3.0 * friction, -bend - 2.0 * b2], [friction / 3.0, b2]];
        let before = 0.3 + 0.002 * k as f64;
        // ∫(A + R) ds from 0 to s.
        let gone = |s: f64| {
            let of = |(k, [a, b]): (usize, &[f64; 2])| {
                let n = (k + 1) as f64;
                (a * (n * s).sin() + b * (1.0 - (n * s).cos())) / n
            };
            friction * s + parts.iter().enumerate().map(of).sum::<f64>()
        };
        let speed = |s: f64| (-depth - gone(s)) / BASE;
        let watch = ran(&parts, friction, speed(-before), before, 0.58 / BASE);
        let truth = (zero(speed, [-before, 0.0]) + before) / BASE;
        let found = watch.stops.first().copied().unwrap_or(f64::NAN);
        assert!((found - truth).abs() < 1e-8, "{depth}: {found} {truth}");
    }
}

/// Weight and friction move the middle of the motion: its largest size and its mean square are those about 0, as samples tell.
#[test]
fn amplitudes_are_those_about_zero() {
    let masses = [(0.3, 0.7), (0.2, 0.9)].map(|(mu, d)| FreeMass::new(mu, 0.6, d).unwrap());
    let harmonic = Harmonic { amplitude: 0.1, frequency: 0.8, phase: 0.4, acts: Acts::Primary };
    let list = list(0.05, &masses).with_gravity(&[0.4, 0.3]).unwrap();
    let list = list.with_friction(&[0.05, 0.02]).unwrap();
    let system = list.under(Force::harmonic(vec![harmonic]).unwrap(), "primary").unwrap();
    let start = begun(Point { x: 0.1, v: 0.0 }, &[GapPoint { y: 0.0, w: 0.3 }; 2]);
    let (from, to, count) = (10.0, 40.0, 30_000);
    let step = (to - from) / f64::from(count);
    let times = (0..=count).map(|k| from + step * f64::from(k)).collect();
    let wanted = SteadyWanted { amplitude: true, rms: true, ..SteadyWanted::default() };
    let window = Window { from, cycle: None };
    let mut seen = (Steady::new(window, wanted), Sampler::at(times));
    simulate(&system, &start, &Limits::new(to, 1e-6), None, &mut seen).unwrap();
    // One sample of two is that of the second mass.
    let x: Vec<f64> = seen.1.states.iter().step_by(2).map(|it| it.displacement).collect();
    assert_eq!(x.len(), 30_001);
    let most = x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let ends = 0.5 * (x[0] * x[0] + x[30_000] * x[30_000]);
    let mean = (x.iter().map(|x| x * x).sum::<f64>() - ends) / f64::from(count);
    let values = seen.0.values();
    let [found, rms] = [values.amplitude_max, values.amplitude_rms].map(Option::unwrap);
    assert!(found >= most - 1e-12 && found - most < 1e-6, "{found} {most}");
    assert!((rms - mean.sqrt()).abs() < 1e-6, "{rms} {}", mean.sqrt());
}
