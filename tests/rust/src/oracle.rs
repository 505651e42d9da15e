//! An independent simulator of the SIVA in double-double: slow, simple, complete.
//!
//! It shares no code with the simulator under test. A flight is the power series on segments of half a radian
//! at most. In a segment the zeros of ẍ, then those of the gap velocity, divide the motion into pieces on
//! which the gap displacement is monotonic (ẍ has at most one zero in half a radian). So a change of sign of
//! the distance to a wall over a piece is a contact, and no contact is missed. The distance to the wall last
//! touched is a variable of its own, so that the lowest rebound is resolved. A chatter is followed until the
//! time that remains of it is known to within 1e-19; then the absorber sticks.

use crate::{
    dd::Dd,
    flight::{Segment, root},
    rng::Rng,
};
use iva_core::{absorber::Start, siva::Siva};

/// Parameters and start of a free decay, natural units.
#[derive(Debug, Clone, Copy)]
pub struct Scene {
    /// Mass ratio.
    pub mass_ratio: Dd,
    /// Restitution.
    pub restitution: Dd,
    /// One-sided clearance.
    pub clearance: Dd,
    /// Damping ratio.
    pub damping_ratio: Dd,
    /// Displacement, velocity, gap displacement, gap velocity at time zero.
    pub start: [Dd; 4],
    /// Length of the run, in 1/ωn.
    pub duration: f64,
}

impl Scene {
    /// The standard start: displacement 1, everything else at rest.
    pub fn decay(mu: f64, e: f64, clearance: f64, zeta: f64, duration: f64) -> Self {
        Self {
            mass_ratio: mu.into(),
            restitution: e.into(),
            clearance: clearance.into(),
            damping_ratio: zeta.into(),
            start: [Dd::ONE, Dd::ZERO, Dd::ZERO, Dd::ZERO],
            duration,
        }
    }

    /// The same scene for the simulator under test (parameters rounded to doubles).
    pub fn absorber(&self) -> Siva {
        Siva::new(self.mass_ratio.hi, self.restitution.hi, self.clearance.hi, self.damping_ratio.hi)
            .expect("a valid absorber")
    }

    /// The start for the simulator under test.
    pub fn begin(&self) -> Start {
        Start {
            displacement: self.start[0].hi,
            velocity: self.start[1].hi,
            gap_displacement: self.start[2].hi,
            gap_velocity: self.start[3].hi,
        }
    }
}

/// The kind of an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Contact and jump.
    Impact,
    /// The absorber sticks to the wall.
    Stick,
    /// The absorber leaves the wall.
    Release,
}

/// One event with the state around it.
#[derive(Debug, Clone, Copy)]
pub struct Event {
    /// Kind of the event.
    pub kind: Kind,
    /// Instant, in 1/ωn.
    pub time: Dd,
    /// Wall, ±1.
    pub wall: f64,
    /// Displacement of the primary system.
    pub displacement: Dd,
    /// Velocity of the primary before and after.
    pub velocity: [Dd; 2],
    /// Gap velocity before and after.
    pub gap_velocity: [Dd; 2],
}

/// Size of the changes by which conditions are measured: far above the rounding of double-double, far below
/// any nonlinearity.
const CHANGE: f64 = 8.470_329_472_543_003e-22; // 2^-70

/// Number of changed runs per condition number.
const RUNS: u64 = 8;

struct Noise(Option<(Rng, f64)>);

impl Noise {
    /// `value` changed by ±size · max(1, |value|): relatively for |value| > 1, as for the reference
    /// conditions.
    fn input(&mut self, value: Dd) -> Dd {
        match &mut self.0 {
            Some((rng, size)) => value + rng.sign() * *size * value.hi.abs().max(1.0),
            None => value,
        }
    }

    /// `value` changed by a relative ±size.
    fn state(&mut self, value: Dd) -> Dd {
        match &mut self.0 {
            Some((rng, size)) => value * (Dd::ONE + rng.sign() * *size),
            None => value,
        }
    }
}

/// All events of a scene up to its duration, in order, at most `most` of them.
pub fn events(scene: &Scene, most: usize) -> Vec<Event> {
    simulate(scene, most, &mut Noise(None))
}

/// For every number that `measure` takes from an event list, its change per unit change of the inputs and of
/// every state after an impact (all at once, signs at random, the largest of `RUNS` runs): the factor by
/// which rounding errors are amplified. Infinite where the changed runs have other events.
pub fn conditions(scene: &Scene, truth: &[Event], measure: impl Fn(&Event) -> Dd) -> Vec<f64> {
    let mut worst = vec![0.0_f64; truth.len()];
    for run in 0..RUNS {
        let noisy = simulate(scene, truth.len(), &mut Noise(Some((Rng::new(run + 1), CHANGE))));
        let mut same = true;
        for (k, event) in truth.iter().enumerate() {
            let other = noisy.get(k);
            same = same && other.is_some_and(|o| (o.kind, o.wall) == (event.kind, event.wall));
            worst[k] = match other {
                Some(other) if same => {
                    worst[k].max((measure(other) - measure(event)).abs().hi / CHANGE)
                }
                _ => f64::INFINITY,
            };
        }
    }
    worst
}

/// Index of the first event from which on changes of sixteen roundings (2⁻⁴⁹, applied as in [`conditions`])
/// may give other events, so that double precision cannot decide them. The number of events if there is none.
pub fn fragile_from(scene: &Scene, truth: &[Event]) -> usize {
    let size = 16.0 * f64::EPSILON / 2.0;
    (0..2 * RUNS)
        .map(|run| {
            let other =
                simulate(scene, truth.len() + 1, &mut Noise(Some((Rng::new(run + 1), size))));
            let same = |(a, b): (&Event, &Event)| (a.kind, a.wall) == (b.kind, b.wall);
            match truth.iter().zip(&other).position(|pair| !same(pair)) {
                Some(first) => first,
                None if other.len() == truth.len() => usize::MAX,
                None => other.len().min(truth.len()),
            }
        })
        .min()
        .map_or(truth.len(), |first| first.min(truth.len()))
}

struct Walk {
    time: Dd,
    x: Dd,
    v: Dd,
    /// Distance to `wall` and its rate.
    distance: Dd,
    rate: Dd,
    wall: f64,
    /// True just after a release, where the second derivative of the distance is zero by definition.
    released: bool,
}

fn simulate(scene: &Scene, most: usize, noise: &mut Noise) -> Vec<Event> {
    let mu = noise.input(scene.mass_ratio);
    let e = if scene.restitution.hi == 0.0 || scene.restitution.hi == 1.0 {
        scene.restitution
    } else {
        noise.input(scene.restitution)
    };
    let d = noise.input(scene.clearance);
    let [x, v, y, w] = scene.start;
    let on_wall = y.abs() == scene.clearance;
    let wall = if y.hi < 0.0 { -1.0 } else { 1.0 };
    let mut walk = Walk {
        time: Dd::ZERO,
        x: noise.input(x),
        v: noise.input(v),
        distance: if on_wall { Dd::ZERO } else { d - y * wall },
        rate: -(w * wall),
        wall,
        released: false,
    };
    let share = mu / (mu + 1.0);
    let mut list = Vec::new();
    // A start on a wall is treated like the state after an impact: moving into the wall, or at rest on it.
    let mut touching = on_wall;
    loop {
        if touching && walk.rate.hi < 0.0 {
            impact(&mut walk, &mut list, share, e, noise);
        }
        if touching && sticks(&mut walk, &mut list, scene, share, e) {
            let Some(()) = release(&mut walk, &mut list, scene, mu) else {
                break;
            };
        }
        if !fly(&mut walk, scene, d) {
            break;
        }
        impact(&mut walk, &mut list, share, e, noise);
        touching = true;
        if list.len() >= most {
            break;
        }
    }
    list.truncate(most);
    list
}

fn acceleration(walk: &Walk, zeta: Dd) -> Dd {
    -(walk.x + zeta * 2.0 * walk.v)
}

fn impact(walk: &mut Walk, list: &mut Vec<Event>, share: Dd, e: Dd, noise: &mut Noise) {
    let before = -(walk.rate * walk.wall);
    let after = -(e * before);
    let velocity = walk.v + share * (e + 1.0) * before;
    list.push(Event {
        kind: Kind::Impact,
        time: walk.time,
        wall: walk.wall,
        displacement: walk.x,
        velocity: [walk.v, velocity],
        gap_velocity: [before, after],
    });
    walk.x = noise.state(walk.x);
    walk.v = noise.state(velocity);
    walk.rate = noise.state(-(after * walk.wall));
    walk.distance = Dd::ZERO;
    walk.released = false;
}

/// Whether the absorber, touching the wall, sticks: at rest and pressed, or in a chatter whose duration is
/// known to within 1e-19. Then the state becomes the stuck one.
fn sticks(walk: &mut Walk, list: &mut Vec<Event>, scene: &Scene, share: Dd, e: Dd) -> bool {
    let zeta = scene.damping_ratio;
    let a = acceleration(walk, zeta);
    let jerk = -(walk.v + zeta * 2.0 * a) * walk.wall;
    let press = -(a * walk.wall);
    let resting = walk.rate.hi == 0.0;
    if press.hi < 0.0 || (press.hi == 0.0 && !(resting && jerk.hi < 0.0)) || walk.released {
        return false;
    }
    let mut tail = Dd::ZERO;
    if !resting {
        if e.hi >= 1.0 {
            return false;
        }
        // First order: 2u/(A(1−e)); second order relative to it: (|J|u/A² + 4ζu/A)/(1−e).
        tail = walk.rate * 2.0 / (press * (Dd::ONE - e));
        let bend = (jerk.hi.abs() * walk.rate.hi / (press.hi * press.hi)
            + 4.0 * zeta.hi * walk.rate.hi / press.hi)
            / (1.0 - e.hi);
        if tail.hi * bend > 1e-19 {
            return false;
        }
    }
    let gap = -(walk.rate * walk.wall);
    let together = walk.v + share * gap;
    walk.time = walk.time + tail;
    // Over the tail x and the common velocity follow the stuck motion.
    let segment = Segment::new(walk.x, together, zeta, Dd::ONE / (Dd::ONE - share));
    let (x, v, _) = segment.at(tail);
    list.push(Event {
        kind: Kind::Stick,
        time: walk.time,
        wall: walk.wall,
        displacement: x,
        velocity: [v, v],
        gap_velocity: [Dd::ZERO; 2],
    });
    (walk.x, walk.v, walk.rate) = (x, v, Dd::ZERO);
    true
}

/// Follows a stick episode until ẍ changes sign; `None` if the run ends first.
fn release(walk: &mut Walk, list: &mut Vec<Event>, scene: &Scene, mu: Dd) -> Option<()> {
    let pressing = -walk.wall;
    loop {
        if walk.time.hi > scene.duration {
            return None;
        }
        let segment = Segment::new(walk.x, walk.v, scene.damping_ratio, mu + 1.0);
        let end = Dd::from(segment.length);
        let (x, v, a) = segment.at(end);
        if a.hi * pressing > 0.0 {
            (walk.time, walk.x, walk.v) = (walk.time + end, x, v);
            continue;
        }
        // ẍ = −(x + 2ζẋ)/(1 + μ) vanishes with g = x + 2ζẋ, ġ = ẋ + 2ζẍ
        let zeta = scene.damping_ratio * 2.0;
        let h = root(
            |h| {
                let (x, v, a) = segment.at(h);
                (x + zeta * v, v + zeta * a)
            },
            Dd::ZERO,
            end,
        );
        let (x, v, _) = segment.at(h);
        walk.time = walk.time + h;
        (walk.x, walk.v, walk.distance, walk.rate) = (x, v, Dd::ZERO, Dd::ZERO);
        walk.released = true;
        if walk.time.hi > scene.duration {
            return None;
        }
        list.push(Event {
            kind: Kind::Release,
            time: walk.time,
            wall: walk.wall,
            displacement: x,
            velocity: [v, v],
            gap_velocity: [Dd::ZERO; 2],
        });
        return Some(());
    }
}

/// Distance to the wall last touched, its rate and second derivative, `h` after the start of a segment, with
/// relative accuracy for any small `h`.
struct Gap {
    c: Vec<Dd>,
}

impl Gap {
    fn new(walk: &Walk, segment: &Segment) -> Self {
        let mut c: Vec<Dd> = segment.x.iter().map(|c| *c * walk.wall).collect();
        c[0] = walk.distance;
        c[1] = walk.rate;
        if walk.released {
            c[2] = Dd::ZERO;
        }
        Self { c }
    }

    fn at(&self, h: Dd) -> [Dd; 3] {
        let mut out = [Dd::ZERO; 3];
        for k in (0..self.c.len()).rev() {
            out[0] = out[0] * h + self.c[k];
            if k >= 1 {
                out[1] = out[1] * h + self.c[k] * k as f64;
            }
            if k >= 2 {
                out[2] = out[2] * h + self.c[k] * (k * (k - 1)) as f64;
            }
        }
        out
    }

    /// A zero of the derivative of this order in (p, q), if its sign differs at the ends.
    fn turn(&self, order: usize, p: Dd, q: Dd) -> Option<Dd> {
        let (at_p, at_q) = (self.at(p)[order], self.at(q)[order]);
        if at_p.hi * at_q.hi >= 0.0 {
            return None;
        }
        let (mut low, mut high) = (p, q);
        for _ in 0..110 {
            let middle = (low + high) * 0.5;
            if (self.at(middle)[order].hi > 0.0) == (at_q.hi > 0.0) {
                high = middle;
            } else {
                low = middle;
            }
            if (high - low).hi <= 1e-32 * high.hi {
                break;
            }
        }
        Some((low + high) * 0.5)
    }
}

/// Flies to the next contact, whose wall becomes the wall of the walk; false if the run ends first.
fn fly(walk: &mut Walk, scene: &Scene, d: Dd) -> bool {
    loop {
        let left = Dd::from(scene.duration) - walk.time;
        if left.hi <= 0.0 {
            return false;
        }
        let segment = Segment::new(walk.x, walk.v, scene.damping_ratio, Dd::ONE);
        let end = if left.hi < segment.length { left } else { Dd::from(segment.length) };
        let gap = Gap::new(walk, &segment);
        let mut cuts = vec![Dd::ZERO, end];
        if let Some(h) = gap.turn(2, Dd::ZERO, end) {
            cuts.insert(1, h);
        }
        let mut pieces = vec![Dd::ZERO];
        for pair in cuts.windows(2) {
            if let Some(h) = gap.turn(1, pair[0], pair[1]) {
                pieces.push(h);
            }
            pieces.push(pair[1]);
        }
        for piece in pieces.windows(2) {
            let far = |h: Dd| d * 2.0 - gap.at(h)[0];
            let distance = gap.at(piece[1])[0];
            let hit = if distance.hi < 0.0 {
                Some((walk.wall, Dd::ZERO))
            } else if far(piece[1]).hi < 0.0 {
                Some((-walk.wall, d * 2.0))
            } else {
                None
            };
            let Some((wall, level)) = hit else { continue };
            let h = root(
                |h| {
                    let [distance, rate, _] = gap.at(h);
                    (distance - level, rate)
                },
                piece[0],
                piece[1],
            );
            let (x, v, _) = segment.at(h);
            let rate = gap.at(h)[1];
            walk.time = walk.time + h;
            (walk.x, walk.v) = (x, v);
            // The rate of the distance to the wall that is hit.
            walk.rate = if wall == walk.wall { rate } else { -rate };
            walk.wall = wall;
            return true;
        }
        let [distance, rate, _] = gap.at(end);
        let (x, v, _) = segment.at(end);
        walk.time = walk.time + end;
        (walk.x, walk.v, walk.distance, walk.rate) = (x, v, distance, rate);
        walk.released = false;
    }
}
