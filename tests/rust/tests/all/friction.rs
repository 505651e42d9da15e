//! A free mass with Coulomb friction in its gap.
//!
//! Where the numbers come from: pencil and paper for a structure that the mass cannot move (mass ratio 1e-30), so that it is a
//! block on a floor at rest or on one that shakes harmonically; `tests/reference/friction.json`, made by
//! `friction.py` with 80 digits, which shares nothing with this project; runs in numbers of twice the precision; and what must
//! hold for every scene: the ledger of energies, the mirror image, and the free mass at R = 0.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::Absorber,
    absorber::modal::{FEW, FewModes, Modal, ModalStart, ModalState, ModalStructure},
    flight::{GapPoint, Motion},
    force::{Acts, Force, Harmonic, History, Impulse, Record},
    host::DrivenHost,
    measures::{Measures, Wanted},
    observe::{Events, Observer, Span},
    real::{Real, twofold::Twofold},
    run::run,
    simulate::{Instant, Limits, Outcome, Tally, simulate},
    siva::FreeMass,
};
use iva_tests::{U, rng::Rng};
use serde_json::Value;
use std::sync::Arc;

/// A mass that rubs, on a driven structure of one mode.
type Sliding<R = f64> = FewModes<DrivenHost<R>>;
type State<R> = ModalState<DrivenHost<R>, FEW, FEW>;
type Begin<R> = ModalStart<R, FEW, FEW>;

/// μ, e, d, ζ, gravity and friction of a mass in a gap about this place, under a force.
fn sliding<R: Real>(
    [mu, e, d, zeta, gravity, friction]: [R; 6],
    offset: f64,
    force: Force<R>,
) -> Sliding<R> {
    let structure = ModalStructure::new(&[R::ONE], &[zeta]).unwrap();
    let structure = structure.with_point("top", &[R::ONE]).unwrap().with_base(&[R::ONE]).unwrap();
    let mass = FreeMass::new(mu, e, d).unwrap().with_offset(R::from(offset)).unwrap();
    let system = Modal::with_room(structure, &[(mass, "top")]).unwrap();
    let system = system.with_gravity(&[gravity]).unwrap().with_friction(&[friction]).unwrap();
    system.under(force, "top").unwrap()
}

/// x, ẋ, y and ẏ at the start.
fn begun<R: Real>([x, v, y, w]: [R; 4]) -> Begin<R> {
    let unused = GapPoint { y: R::ZERO, w: R::ZERO };
    let gaps = std::array::from_fn(|k| if k == 0 { GapPoint { y, w } } else { unused });
    ModalStart::new(&[x], &[v], gaps).unwrap()
}

/// A mass ratio that moves the structure by less than rounding.
const NOTHING: f64 = 1e-30;

/// What a mass does in its gap, and when.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Event<R> {
    kind: &'static str,
    /// The wall, or the direction in which the mass came (of a slip: in which it goes).
    side: f64,
    time: R,
    /// Velocity of the structure before, place in the gap, gap velocity before.
    numbers: [R; 3],
}

/// Lists the stops and slips of a run: the motion from a stop on is a ride or a slide the other way.
#[derive(Debug)]
struct Watch<R: Real> {
    events: Vec<Event<R>>,
    before: Option<(bool, State<R>)>,
    /// True after an event that is told in another way.
    told: bool,
    released: Vec<R>,
}

impl<R: Real> Watch<R> {
    fn new() -> Self {
        Self { events: Vec::new(), before: None, told: true, released: Vec::new() }
    }
}

impl<R: Real> Observer<Sliding<R>> for Watch<R> {
    fn span<M: Motion<Real = R, State = State<R>>>(
        &mut self,
        _system: &Sliding<R>,
        span: &Span<'_, M>,
    ) {
        let now = *span.motion.origin();
        let told = std::mem::replace(&mut self.told, false);
        if let Some((_, before)) = self.before.filter(|_| !told) {
            let [was, is] = [before, now].map(|it| it.direction(0).unwrap());
            if was != is && span.motion.wall().is_none() {
                let kind = match (was == 0.0, is == 0.0) {
                    (_, true) => "held",
                    (true, _) => "slips",
                    _ => "turned",
                };
                let side = if was == 0.0 { is } else { was }.double();
                let (primary, gap) = span.motion.place(R::ZERO);
                let numbers = [primary.v, gap.y, R::ZERO];
                self.events.push(Event { kind, side, time: span.start.value, numbers });
            }
        }
        self.before = Some((M::RIDING, *span.end));
    }
    fn impact(&mut self, _system: &Sliding<R>, _impact: &iva_core::impact::Impact<R>) {
        self.told = true;
    }
    fn stick(&mut self, _system: &Sliding<R>, _from: &Instant<State<R>, R>) {
        self.told = true;
    }
    fn release(&mut self, system: &Sliding<R>, from: &Instant<State<R>, R>) {
        use iva_core::absorber::OnStructure;
        self.told = true;
        self.released.push(system.primary(&from.state).v);
    }
    fn impulse(&mut self, _system: &Sliding<R>, _state: &State<R>, _work: R) {
        self.told = true;
    }
}

type Told<R> = (Tally<State<R>, R>, Vec<Event<R>>);

/// All events of a run in order of time. Of a chatter that ends in stick the turns are left out.
fn events<R: Real>(system: &Sliding<R>, start: &Begin<R>, limits: &Limits<R>) -> Told<R> {
    let mut seen = (Events::default(), Watch::new());
    let tally = simulate(system, start, limits, None, &mut seen).unwrap();
    let (Events { impacts, episodes }, Watch { events: mut found, released, .. }) = seen;
    for it in &episodes {
        // The chatter begins with its first impact, or with the first one after a hold.
        let within = |time: R| time >= it.start_time && time <= it.stick_time;
        let holds = found.iter().filter(|event| event.kind != "turned" && within(event.time));
        let held = holds.fold(it.start_time, |last, event| R::larger(last, event.time));
        let mut times = impacts.iter().map(|it| it.time);
        let begin = times.find(|time| *time >= held).unwrap_or(held);
        let chatters = |event: &Event<R>| event.time >= begin && event.time <= it.stick_time;
        found.retain(|event| event.kind != "turned" || !chatters(event));
    }
    for it in &impacts {
        let mass = &system.masses()[0];
        let place = mass.offset() + R::from(it.wall.sign()) * mass.clearance();
        let numbers = [it.velocity_before, place, it.gap_velocity_before];
        let (side, time) = (it.wall.sign(), it.time);
        found.push(Event { kind: "impact", side, time, numbers });
    }
    let mut released = released.into_iter();
    for it in &episodes {
        let (side, none) = (it.wall.sign(), [R::NAN; 3]);
        found.push(Event { kind: "stick", side, time: it.stick_time, numbers: none });
        if let Some(time) = it.release_time {
            let numbers = [released.next().unwrap(), R::NAN, R::NAN];
            found.push(Event { kind: "release", side, time, numbers });
        }
    }
    found.sort_by(|a, b| a.time.total_cmp(&b.time));
    (tally, found)
}

fn free<R: Real>() -> Force<R> {
    Force::default()
}

/// A block on a floor that it does not move, with walls far away.
fn block<R: Real>(gravity: f64, friction: f64, clearance: f64) -> Sliding<R> {
    sliding([NOTHING, 0.5, clearance, 0.0, gravity, friction].map(R::from), 0.0, free())
}

fn start<R: Real>(numbers: [f64; 4]) -> Begin<R> {
    begun(numbers.map(R::from))
}

/// A block that slides on a floor at rest stops after w²/2R and w/R, and stays there (closed form).
#[test]
fn a_block_stops_after_its_braking_distance() {
    for (w, friction) in [(1.0, 0.3), (-0.7, 0.02), (1e-3, 5.0), (2.0, 1e-3)] {
        let system = block::<f64>(0.0, friction, 5e3);
        let limits = Limits::new(3.0 * w.abs() / friction, 5e3);
        let (tally, found) = events(&system, &start([0.0, 0.0, 0.0, w]), &limits);
        assert_eq!((tally.outcome, tally.undecided), (Outcome::Finished, 0));
        assert_eq!(found.len(), 1, "{found:?}");
        let Event { kind, side, time, numbers: [_, y, _] } = found[0];
        assert_eq!((kind, side), ("held", w.signum()));
        let (expected, way) = (w.abs() / friction, w * w.abs() / (2.0 * friction));
        assert!((time / expected - 1.0).abs() < 4.0 * U, "{time} {expected}");
        // Distances are measured from a wall at 5e3.
        assert!((y - way).abs() < 8.0 * U * 5e3, "{y} {way}");
        assert!((tally.friction.time_held.value - 2.0 * expected).abs() < 8.0 * U * expected);
        assert_eq!([tally.friction.stops, tally.friction.holds], [1, 1]);
        let lost = NOTHING * 0.5 * w * w;
        assert!((tally.friction.energy.value / lost - 1.0).abs() < 1e-9, "{w}");
    }
}

/// On an incline with G < R a block thrown up stops after w²/2(G + R) and stays.
#[test]
fn a_block_stays_on_a_gentle_incline() {
    for (gravity, friction) in [(0.2, 0.3), (0.299, 0.3), (0.3, 0.3), (1e-6, 0.1)] {
        let system = block::<f64>(gravity, friction, 10.0);
        let limits = Limits::new(50.0, 10.0);
        let (tally, found) = events(&system, &start([0.0, 0.0, -3.0, 0.8]), &limits);
        assert_eq!(tally.outcome, Outcome::Finished);
        assert_eq!(found.len(), 1, "{found:?}");
        let Event { kind, time, numbers: [_, y, _], .. } = found[0];
        assert_eq!(kind, "held");
        let slowing = gravity + friction;
        assert!((time * slowing / 0.8 - 1.0).abs() < 8.0 * U, "{time}");
        assert!((y + 3.0 - 0.32 / slowing).abs() < 64.0 * U, "{y}");
    }
}

/// On an incline with G > R it comes back and bounces on its lower stop, each time lower by e √((G − R)/(G + R)), until it rests
/// there: times, speeds, the end of the chatter and the energies (closed form, geometric sums).
#[test]
fn a_block_comes_down_a_steep_incline_and_rests_on_its_stop() {
    for (gravity, friction, e) in
        [(0.5, 0.2, 0.7), (0.5, 0.49, 0.9), (2.0, 1e-3, 0.3), (1.0, 0.4, 1.0)]
    {
        let system = sliding([NOTHING, e, 10.0, 0.0, gravity, friction], 0.0, free());
        let (out, back) = (gravity + friction, gravity - friction);
        let (r, each) = (f64::sqrt(back / out), 1.0 / out + 1.0 / f64::sqrt(out * back));
        let rho: f64 = e * r;
        let first = 0.8;
        let rest = first * each / (1.0 - rho);
        let mut limits = Limits::new(2.0 * rest, 10.0);
        limits.chatter_floor = 1e-5;
        let (tally, found) = events(&system, &start([0.0, 0.0, -10.0, first]), &limits);
        assert_eq!((tally.outcome, tally.undecided), (Outcome::Finished, 0));
        let (mut time, mut speed) = (0.0, first);
        let mut count = 0;
        for it in found.iter().filter(|it| it.kind == "impact") {
            time += speed * each;
            let approach = speed * r;
            assert!((it.time / time - 1.0).abs() < 1e-14, "{} {time}", it.time);
            assert!(
                (-it.numbers[2] / approach - 1.0).abs() < 1e-13 * f64::from(count + 1),
                "{gravity} {friction} {e}: {count} {it:?} {approach}"
            );
            speed = approach * e;
            count += 1;
        }
        let expected = (f64::ln(1e-5 / (first * r)) / f64::ln(rho)).ceil();
        assert_eq!(f64::from(count), expected, "{gravity} {friction} {e}");
        let sticks: Vec<_> = found.iter().filter(|it| it.kind == "stick").collect();
        assert_eq!((sticks.len(), sticks[0].side), (1, -1.0));
        assert!((sticks[0].time / rest - 1.0).abs() < 1e-14, "{} {rest}", sticks[0].time);
        let lost = NOTHING * 0.5 * first * first;
        let rubbed = lost * (1.0 - r * r) / (1.0 - rho * rho);
        let [by_friction, by_impacts] = [tally.friction.energy.value, tally.energy_impacts];
        assert!((by_friction / rubbed - 1.0).abs() < 1e-10, "{by_friction:e} {rubbed:e}");
        assert!(((by_friction + by_impacts) / lost - 1.0).abs() < 1e-10);
    }
}

/// The instant at which a block stops that slipped off a floor of acceleration −sin τ at sin τ = R: the zero of
/// w = cos t₁ − cos τ − R (τ − t₁) by bisection in numbers of twice the precision.
fn stop_after(friction: Twofold) -> [Twofold; 2] {
    let of = Twofold::from;
    let slip = friction.atan2((of(1.0) - friction * friction).sqrt());
    let speed = |at: Twofold| slip.sincos().1 - at.sincos().1 - friction * (at - slip);
    // The speed rises to sin τ = R again, at π − t₁, and falls from there on.
    let half = Twofold::TURN.value * 0.5;
    let (mut low, mut high) = (half - slip, half * 2.0 + slip);
    for _ in 0..110 {
        let middle = (low + high) * 0.5;
        if speed(middle) > 0.0 { low = middle } else { high = middle }
    }
    [slip, (low + high) * 0.5]
}

/// A block on a floor that shakes with acceleration −sin τ (an undamped structure that is let go): held for good if R > 1;
/// stopped in every half cycle if R > 1/√(1 + π²/4); sliding for ever below that (J. P. Den Hartog, 1931). Slips and stops are those of
/// pencil and paper.
#[test]
fn a_block_on_a_shaking_floor_sticks_and_slips() {
    let limit = 1.0 / f64::sqrt(1.0 + std::f64::consts::PI.powi(2) / 4.0);
    for friction in [0.99, 0.8, 0.6, 0.54] {
        let [slip, stop] = stop_after(Twofold::from(friction));
        assert!(friction > limit && (stop - slip) < Twofold::TURN.value * 0.5);
        let plain = block::<f64>(0.0, friction, 100.0);
        let exact = block::<Twofold>(0.0, friction, 100.0);
        let begin = [0.0, 1.0, 0.0, 0.0];
        let (tally, found) = events(&plain, &start(begin), &Limits::new(40.0, 100.0));
        let limits = Limits::new(Twofold::from(40.0), Twofold::from(100.0));
        let (_, twofold) = events(&exact, &start(begin), &limits);
        assert_eq!((tally.outcome, tally.undecided), (Outcome::Finished, 0));
        assert!(found.len() >= 24 && found.len() == twofold.len(), "{friction}: {}", found.len());
        for (k, (a, b)) in found.iter().zip(&twofold).enumerate() {
            let half = Twofold::TURN.value * 0.5;
            let truth = [slip, stop][k % 2] + half * ((k / 2) as f64);
            let side = if (k / 2) % 2 == 0 { 1.0 } else { -1.0 };
            assert_eq!((a.kind, a.side), (["slips", "held"][k % 2], side), "{friction} {k}");
            assert_eq!((b.kind, b.side), (a.kind, a.side));
            let off = f64::from((b.time - truth).abs());
            // The series of order 20 leave .375¹⁹/19! of A out of each step in these numbers; times the steepness of arcsin R.
            assert!(off < 1e-28, "{friction} {k}: {off:e}");
            // The instant of a slip is as sensitive as arcsin R.
            let off = f64::from((truth - a.time).abs());
            let steep = 1.0 + 1.0 / f64::sqrt(1.0 - friction * friction);
            assert!(off < 8.0 * U * (steep + a.time), "{friction} {k}: {off:e}");
        }
    }
    let (tally, found) = events(
        &block::<f64>(0.0, 1.0, 100.0),
        &start([0.0, 0.999, 0.0, 0.0]),
        &Limits::new(90.0, 9.0),
    );
    assert_eq!((found.len(), tally.friction.stops), (0, 0));
    assert!((tally.friction.time_held.value - 90.0).abs() < 1e-12);
}

/// Below the limit the block never rests; in the end it turns where π R/2 = cos τ (Den Hartog).
#[test]
fn a_block_on_a_hard_shaking_floor_never_rests() {
    for friction in [0.53, 0.3, 0.05] {
        let system = block::<f64>(0.0, friction, 1000.0);
        let (tally, found) =
            events(&system, &start([0.0, 1.0, 0.0, 0.2]), &Limits::new(4000.0, 1000.0));
        assert_eq!((tally.outcome, tally.undecided), (Outcome::Finished, 0));
        let turns = found.iter().filter(|it| it.kind == "turned").count();
        assert!(turns > 1200 && found.len() <= turns + 6, "{friction}: {turns} {}", found.len());
        let last = found.last().unwrap();
        let phase = last.time.rem_euclid(std::f64::consts::PI);
        let truth = f64::acos(std::f64::consts::FRAC_PI_2 * friction);
        assert!((phase - truth).abs() < 1e-10, "{friction}: {phase} {truth}");
    }
}

/// A number of the reference, with 30 digits.
fn read(value: &Value) -> Twofold {
    let text = value.as_str().unwrap();
    let (sign, text) = text.strip_prefix('-').map_or((1.0, text), |rest| (-1.0, rest));
    let (digits, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let (whole, part) = digits.split_once('.').unwrap_or((digits, ""));
    let mut number = Twofold::ZERO;
    for digit in whole.chars().chain(part.chars()) {
        number = number * 10.0 + f64::from(digit.to_digit(10).unwrap());
    }
    let power: i32 = exponent.parse::<i32>().unwrap() - part.len() as i32;
    let ten = Twofold::from(10.0).powi(power.abs());
    let number = if power < 0 { number / ten } else { number * ten };
    number * sign
}

/// A scene of the reference.
fn referred<R: Real>(scene: &Value, of: impl Fn(Twofold) -> R) -> Told<R> {
    let n = |key: &str| of(read(&scene[key]));
    let harmonic =
        Harmonic { amplitude: n("F"), frequency: n("Omega"), phase: R::ZERO, acts: Acts::Primary };
    let parts = if harmonic.amplitude == 0.0 { vec![] } else { vec![harmonic] };
    let force = Force::harmonic(parts).unwrap();
    let system = sliding(["mu", "e", "gamma", "zeta", "G", "R"].map(n), 0.0, force);
    let start = begun(["x", "v", "y", "w"].map(n));
    let mut limits = Limits::new(n("tau_end"), n("gamma"));
    limits.chatter_floor = of(Twofold::from(1e-6));
    events(&system, &start, &limits)
}

/// Every event of `tests/reference/friction.json`: in numbers of twice the precision as far as they are known, in doubles to
/// rounding.
#[test]
fn reference_events_are_met() {
    let file: Value =
        serde_json::from_str(include_str!("../../../reference/friction.json")).unwrap();
    let kinds = ["impact", "turned", "held", "slips", "stick", "release"];
    let mut counted = [0; 6];
    for (name, scene) in file.as_object().unwrap() {
        let (tally, plain) = referred::<f64>(&scene["scene"], f64::from);
        let (exactly, exact) = referred::<Twofold>(&scene["scene"], |it| it);
        assert_eq!((tally.outcome, tally.undecided), (Outcome::Finished, 0), "{name}");
        assert_eq!((exactly.outcome, exactly.undecided), (Outcome::Finished, 0), "{name}");
        let expected = scene["events"].as_array().unwrap();
        assert_eq!([plain.len(), exact.len()], [expected.len(); 2], "{name}");
        let (mut largest, mut worst) = (0.0_f64, 0.0_f64);
        for ((a, b), expected) in plain.iter().zip(&exact).zip(expected) {
            let kind = expected["kind"].as_str().unwrap();
            let side = expected["side"].as_f64().unwrap();
            assert_eq!((a.kind, a.side), (kind, side), "{name} {}", a.time);
            assert_eq!((b.kind, b.side), (kind, side), "{name} {}", a.time);
            counted[kinds.iter().position(|it| *it == kind).unwrap()] += 1;
            let condition = expected["condition"].as_f64().unwrap();
            let [tau, v, gap, w] =
                ["tau", "v_main", "gap", "approach"].map(|key| read(&expected[key]));
            let off = |k: f64| k / condition.max(1.0);
            worst = worst.max(off(f64::from((b.time - tau).abs())));
            for (number, truth) in b.numbers.iter().zip([v, gap, w]) {
                if !number.is_nan() {
                    worst = worst.max(off(f64::from((*number - truth).abs())));
                }
            }
            let unit = U * (condition.max(1.0) + a.time);
            largest = largest.max(f64::from((tau - a.time).abs()) / unit);
        }
        println!("{name}: {largest:.2} units, {worst:e}");
        assert!(largest <= 6.0, "{name}: {largest} rounding units");
        assert!(worst <= 1e-22, "{name}: {worst:e}");
    }
    assert!(counted.iter().all(|count| *count >= 2) && counted[0] > 50, "{counted:?}");
}

/// A scene drawn at random, level or not, driven or not.
#[derive(Debug, Clone, Copy)]
struct Drawn {
    numbers: [f64; 6],
    harmonic: Option<[f64; 3]>,
    base: bool,
    start: [f64; 4],
    offset: f64,
}

impl Drawn {
    fn new(rng: &mut Rng) -> Self {
        let clearance = rng.log_range(0.03, 2.0);
        let gravity = rng.pick(&[0.0, 0.0, 0.05, 0.4]);
        let numbers = [
            rng.log_range(0.01, 0.5),
            rng.range(0.0, 1.0),
            clearance,
            rng.pick(&[0.0, 0.01, 0.1]),
            gravity,
            rng.log_range(0.003, 0.8),
        ];
        let driven = rng.unit() < 0.6;
        let drive = [rng.range(0.05, 0.6), rng.range(0.5, 1.8), rng.range(-3.0, 3.0)];
        let start = [
            rng.range(-1.0, 1.0),
            rng.range(-1.0, 1.0),
            rng.range(-0.9, 0.9) * clearance,
            rng.pick(&[0.0, 1.0]) * rng.range(-1.0, 1.0),
        ];
        let harmonic = driven.then_some(drive);
        Self { numbers, harmonic, base: rng.unit() < 0.4, start, offset: 0.0 }
    }

    /// The scene with each number of it passed through `of`.
    fn system<R: Real>(&self, friction: R, of: impl Fn(f64) -> R) -> Sliding<R> {
        let [mu, e, d, zeta, gravity, _] = self.numbers.map(&of);
        let acts = if self.base { Acts::Base } else { Acts::Primary };
        let parts = self.harmonic.map(|it| {
            let [amplitude, frequency, phase] = it.map(&of);
            Harmonic { amplitude, frequency, phase, acts }
        });
        let force = Force::harmonic(parts.into_iter().collect()).unwrap();
        sliding([mu, e, d, zeta, gravity, friction], self.offset, force)
    }

    fn friction(&self) -> f64 {
        self.numbers[5]
    }

    fn mirrored(&self) -> Self {
        let mut image = Self { start: self.start.map(|it| -it), ..*self };
        image.numbers[4] *= -1.0;
        image.harmonic = self.harmonic.map(|[a, b, c]| [-a, b, c]);
        image
    }

    fn limits<R: Real>(&self, duration: f64) -> Limits<R> {
        let mut limits = Limits::new(R::from(duration), R::from(self.numbers[2]));
        limits.chatter_floor = R::from(1e-6 * self.numbers[2]);
        limits
    }
}

/// Doubles and numbers of twice the precision find the same events; the instants differ by rounding times the sensitivity, which
/// changed numbers of the scene show.
#[test]
fn random_scenes_agree_with_twice_the_precision() {
    const MOVED: f64 = 1e-15;
    let mut rng = Rng::new(11);
    let (mut compared, mut largest) = ([0; 6], 0.0_f64);
    let kinds = ["impact", "turned", "held", "slips", "stick", "release"];
    for scene in 0..120 {
        let drawn = Drawn::new(&mut rng);
        let (tally, plain) = events(
            &drawn.system(drawn.friction(), f64::from),
            &start(drawn.start),
            &drawn.limits(25.0),
        );
        assert_eq!(tally.outcome, Outcome::Finished, "{scene}: {drawn:?}");
        let exact = |moved: f64| {
            let mut draw = Rng::new(5);
            let draw = std::cell::RefCell::new(&mut draw);
            let of = |it: f64| {
                Twofold::from(it)
                    * (Twofold::from(1.0) + draw.borrow_mut().range(-1.0, 1.0) * moved)
            };
            let system = drawn.system(of(drawn.friction()), of);
            events(&system, &begun(drawn.start.map(of)), &drawn.limits(25.0))
        };
        let (exactly, truth) = exact(0.0);
        assert_eq!(exactly.outcome, Outcome::Finished, "{scene}: {drawn:?}");
        let (_, changed) = exact(MOVED);
        let mut sensitivity = 1.0_f64;
        for ((a, b), c) in plain.iter().zip(&truth).zip(&changed) {
            sensitivity = sensitivity.max(f64::from((c.time - b.time).abs()) / MOVED);
            // Beyond that events may come and go.
            if sensitivity > 1e7 {
                break;
            }
            assert_eq!((a.kind, a.side), (b.kind, b.side), "{scene} {}: {drawn:?}", a.time);
            let unit = U * (4.0 * sensitivity + a.time + 1.0);
            let off = f64::from((b.time - a.time).abs()) / unit;
            assert!(off < 64.0, "{scene} {} {}: {off} {sensitivity:e} {drawn:?}", a.kind, a.time);
            largest = largest.max(off);
            compared[kinds.iter().position(|it| *it == a.kind).unwrap()] += 1;
        }
        if sensitivity < 1e7 {
            assert_eq!(plain.len(), truth.len(), "{scene}: {drawn:?}");
        }
    }
    println!("{compared:?}, {largest:.1} units");
    assert!(compared.iter().all(|count| *count > 30), "{compared:?}");
}

/// The energies add up: E + viscous loss + impacts + friction − work is that of the start, to rounding. With a law of friction
/// that were wrong they would not.
#[test]
fn the_ledger_closes() {
    let mut rng = Rng::new(3);
    let mut largest = 0.0_f64;
    for scene in 0..150 {
        let mut drawn = Drawn::new(&mut rng);
        drawn.offset = rng.pick(&[0.0, 0.3]);
        drawn.start[2] += drawn.offset;
        let system = drawn.system(drawn.friction(), f64::from);
        let run = run(&system, &start(drawn.start), &drawn.limits(60.0)).unwrap();
        assert_eq!(run.tally.outcome, Outcome::Finished, "{scene}: {drawn:?}");
        let measures = &run.measures;
        let size = measures.energy_initial
            + measures.energy_work.abs()
            + measures.energy_friction
            + measures.energy_final
            + 1.0;
        let off = measures.energy_residual.abs() / size;
        assert!(off < 2e-14, "{scene}: {off:e} {drawn:?} {measures:?}");
        largest = largest.max(off);
        let parts = [measures.energy_friction, measures.energy_viscous, run.tally.energy_impacts];
        assert!(parts.iter().all(|part| *part >= 0.0) && parts[0] > 0.0, "{scene}");
        assert_eq!(measures.energy_friction, run.tally.friction.energy.value);
    }
    println!("{largest:e}");
}

/// The mirror image of a scene gives the same bits with opposite signs.
#[test]
fn the_mirror_image_has_the_same_bits() {
    let mut rng = Rng::new(7);
    let mut compared = 0;
    for scene in 0..60 {
        let drawn = Drawn::new(&mut rng);
        let of = |drawn: &Drawn| {
            let system = drawn.system(drawn.friction(), f64::from);
            events(&system, &start(drawn.start), &drawn.limits(40.0))
        };
        let ((tally, found), (_, image)) = (of(&drawn), of(&drawn.mirrored()));
        assert_eq!(found.len(), image.len(), "{scene}: {drawn:?}");
        for (a, b) in found.iter().zip(&image) {
            assert_eq!((a.kind, a.side, a.time), (b.kind, -b.side, b.time), "{scene}: {drawn:?}");
            let same = |(p, q): (&f64, &f64)| *p == -*q || (p.is_nan() && q.is_nan());
            assert!(a.numbers.iter().zip(&b.numbers).all(same), "{scene}: {a:?} {b:?}");
            compared += 1;
        }
        assert_eq!(tally.outcome, Outcome::Finished);
    }
    assert!(compared > 1000, "{compared}");
}

/// A block on a floor of acceleration −sin τ that starts with w₀ slows down until sin τ = R, where its speed has the minimum
/// δ = w₀ + 1 − cos t₁ − R t₁. With δ < 0 it stops before and is held until t₁, with δ > 0 it goes on; the truth is planted with δ down to
/// a few units of rounding.
#[test]
fn a_speed_that_nearly_vanishes_is_decided() {
    let of = Twofold::from;
    let (mut stopped, mut passed, mut undecided) = (0, 0, 0);
    let mut rng = Rng::new(31);
    for round in 0..400 {
        let friction = rng.range(0.05, 0.95);
        let slip = of(friction).atan2((of(1.0) - of(friction) * friction).sqrt());
        let planted = rng.sign() * rng.log_range(3e-16, 1e-3);
        let dip = |w: Twofold| w + 1.0 - slip.sincos().1 - slip * friction;
        let w = f64::from(of(planted) - dip(Twofold::ZERO));
        // As the numbers of the run are rounded.
        let truth = f64::from(dip(of(w)));
        let system = block::<f64>(0.0, friction, 50.0);
        let (tally, found) = events(&system, &start([0.0, 1.0, 0.0, w]), &Limits::new(1.57, 50.0));
        assert_eq!(tally.outcome, Outcome::Finished);
        let kinds: Vec<_> = found.iter().map(|it| it.kind).collect();
        if tally.undecided > 0 {
            assert!(truth.abs() < 64.0 * U && kinds.is_empty(), "{round} {friction}: {truth:e}");
            undecided += 1;
        } else if truth > 0.0 {
            assert_eq!(kinds, Vec::<&str>::new(), "{round} {friction}: {truth:e}");
            passed += 1;
        } else {
            assert_eq!(kinds, ["held", "slips"], "{round} {friction}: {truth:e}");
            let off = f64::from((slip - found[1].time).abs());
            assert!(off < 16.0 * U / (1.0 - friction * friction).sqrt(), "{round}: {off:e}");
            stopped += 1;
        }
    }
    println!("{stopped} {passed} {undecided}");
    assert!(stopped > 100 && passed > 100, "{stopped} {passed} {undecided}");
}

/// The gap velocity dips to δ between two bumps, where both ends of the flight and the slopes there tell of a bump alone: two modes whose
/// curvatures cancel, and friction that does next to nothing. Only the bound on what lies between the ends knows whether the mass stops.
#[test]
fn a_stop_between_two_bumps_is_not_missed() {
    let mut rng = Rng::new(139);
    let [mut stopped, mut passed] = [0, 0];
    for round in 0..200 {
        let structure = ModalStructure::new(&[1e-4, 1.5, 3.0], &[0.0; 3]).unwrap();
        let structure = structure.with_point("top", &[1.0; 3]).unwrap();
        let mass = FreeMass::new(NOTHING, 0.5, 500.0).unwrap();
        let system = Modal::new(structure, [(mass, "top")]).unwrap();
        let system = system.with_friction(&[1e-9]).unwrap();
        let begin = |q: [f64; 3], v: [f64; 3], w: f64| {
            ModalStart::new(&q, &v, [GapPoint { y: 0.0, w }]).unwrap()
        };
        let still = begin([0.0; 3], [0.0; 3], 1.0);
        let length = system.flight(&system.begin(&still)).reach();
        // w = δ + q s² − s⁴ + … with s from the middle on, as in `driven_leaps::a_dip_between_bumps_is_not_denied`.
        let (half, square) = (0.5 * length, 0.25 * length * length);
        let q = 2.0 * square * rng.range(0.6, 0.8);
        let a = (-24.0 + 4.5 * q) / (81.0 - 20.25);
        let b = (-2.0 * q - 9.0 * a) / 2.25;
        let high = q * square - square * square;
        let dips = rng.unit() < 0.5;
        let delta = high * if dips { -rng.range(0.05, 0.9) } else { rng.range(0.05, 0.9) };
        // The mass keeps its velocity in space, so that w falls by what the structure gains.
        let places = [0.0, b / 1.5 * f64::sin(1.5 * half), a / 3.0 * f64::sin(3.0 * half)];
        let speeds = [0.0, -b * f64::cos(1.5 * half), -a * f64::cos(3.0 * half)];
        let w = delta + a * (f64::cos(3.0 * half) - 1.0) + b * (f64::cos(1.5 * half) - 1.0);
        let start = begin(places, speeds, w);
        let found = run(&system, &start, &Limits::new(length, 500.0)).unwrap();
        assert_eq!(found.tally.friction.stops > 0, dips, "{round}: {delta:e} of {high:e}");
        stopped += u32::from(dips);
        passed += u32::from(!dips);
    }
    assert!(stopped > 60 && passed > 60, "{stopped} {passed}");
}

/// A block that stops just before its wall has no impact, one that would stop behind it has one.
#[test]
fn a_stop_at_a_wall_is_decided() {
    let (mut met, mut free_of, mut undecided) = (0, 0, 0);
    let mut rng = Rng::new(37);
    for round in 0..400 {
        let friction = rng.log_range(0.01, 3.0);
        let clearance = rng.log_range(0.1, 10.0);
        let place = rng.range(-0.5, 0.5) * clearance;
        let planted = rng.sign() * rng.log_range(1e-16, 1e-3) * clearance;
        let way = clearance - place - planted;
        let w = (2.0 * friction * way).sqrt();
        let twofold = Twofold::from;
        let stop = twofold(place) + twofold(w) * w / (twofold(friction) * 2.0);
        let truth = f64::from(twofold(clearance) - stop);
        let system = block::<f64>(0.0, friction, clearance);
        let (tally, found) = events(
            &system,
            &start([0.0, 0.0, place, w]),
            &Limits::new(1.5 * w / friction, clearance),
        );
        assert_eq!(tally.outcome, Outcome::Finished);
        let impacts = found.iter().filter(|it| it.kind == "impact").count();
        if tally.undecided > 0 {
            assert!(truth.abs() < 64.0 * U * clearance && impacts == 0, "{round}: {truth:e}");
            undecided += 1;
        } else if truth > 0.0 {
            assert_eq!((impacts, found[0].kind), (0, "held"), "{round}: {truth:e}");
            free_of += 1;
        } else {
            assert_eq!(found[0].kind, "impact", "{round}: {truth:e} {found:?}");
            assert!(impacts == 1 && found.last().unwrap().kind == "held", "{round} {found:?}");
            met += 1;
        }
    }
    println!("{met} {free_of} {undecided}");
    assert!(met > 100 && free_of > 100, "{met} {free_of} {undecided}");
}

/// Impulses and records: a held mass is thrown off by an impulse on the structure, and by a jump of a force beyond R; a jump below
/// R does not move it. The ledger closes.
#[test]
fn impulses_and_jumps_act_on_a_held_mass() {
    let still = start([0.0, 0.0, 0.5, 0.0]);
    let limits = Limits::new(30.0, 5.0);
    let watch = |force: Force| {
        let system = sliding([0.2, 0.5, 5.0, 0.05, 0.0, 0.3], 0.0, force);
        let found = events(&system, &still, &limits);
        let run = run(&system, &still, &limits).unwrap();
        assert!(run.measures.energy_residual.abs() < 1e-14, "{:e}", run.measures.energy_residual);
        found
    };
    let impulse = Impulse { time: 2.0, velocity: 0.5 };
    let (tally, found) = watch(Force::new(vec![], vec![], &[impulse]).unwrap());
    assert_eq!(tally.outcome, Outcome::Finished);
    // Before the impulse nothing moves; the mass stays behind the structure.
    assert!(found[0].side == -1.0 && found[0].time > 2.0, "{found:?}");
    assert_eq!(found.last().unwrap().kind, "held");
    assert!(tally.friction.time_held.value < 28.1 && tally.friction.time_held.value > 20.0);
    // A constant force that ends: of the held pair A = cos(τ/√1.2) · 0.35/1.2, but for damping. At 6.88 it is back where it began, so
    // that the jump leaves A at 0; at 3 it is −0.26 and jumps to −0.55.
    let ended = |end: f64| {
        let history = Arc::new(History::new(vec![0.0, end], vec![0.35, 0.35]).unwrap());
        let record = Record { history, acts: Acts::Primary, rate: 1.0, scale: 1.0 };
        Force::new(vec![], vec![record], &[]).unwrap()
    };
    let (tally, found) = watch(ended(6.88));
    assert_eq!((tally.friction.stops, found.len()), (0, 0), "{found:?}");
    assert!((tally.friction.time_held.value - 30.0).abs() < 1e-12);
    let (tally, found) = watch(ended(3.0));
    assert!(tally.friction.stops > 0 && found[0].side == 1.0, "{found:?}");
    assert!(found[0].time > 3.0 && tally.friction.time_held.value > 3.0);
    let measures = Measures::<Sliding>::new(Wanted::ALL);
    assert_eq!(measures.values().energy_friction, 0.0);
}

/// A negative friction is refused in one sentence.
#[test]
fn a_negative_friction_is_refused() {
    let structure = ModalStructure::new(&[1.0], &[0.0]).unwrap().with_point("top", &[1.0]).unwrap();
    let mass = FreeMass::new(0.1, 0.5, 1.0).unwrap();
    let system = Modal::new(structure, [(mass, "top")]).unwrap();
    let error = system.with_friction(&[-0.1]).unwrap_err().to_string();
    assert_eq!(error, "absorber.0.friction = -0.1: give 0 or more");
}
