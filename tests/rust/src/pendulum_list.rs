//! Random lists of free masses and pendulums on one structure, in any numbers.

use iva_core::{
    absorber::Point,
    flight::GapPoint,
    force::{Acts, Force, Harmonic},
    host::{DrivenHost, UndrivenHost},
    piva::{Angles, Given, Parameters, Piva, PivaStart},
    real::Real,
    simulate::Limits,
    siva::FreeMass,
};

use crate::list::{self, List, Starts};
use crate::rng::Rng;

/// An absorber and its start, in plain numbers.
#[derive(Debug, Clone, Copy)]
pub struct Any {
    /// [`None`] for a free mass, else L/d, r, κ, b/L, ζp, σ and whether its angles are small.
    pub swing: Option<([f64; 6], bool)>,
    /// μ, e, e at wall −, d.
    pub common: [f64; 4],
    /// Offset of the gap of a free mass.
    pub offset: f64,
    /// y from the middle of the gap, over d, and w.
    pub start: [f64; 2],
}

/// A random absorber.
pub fn any(rng: &mut Rng, pendulum: bool) -> Any {
    let swing = [
        rng.range(1.4, 6.0),
        rng.range(0.3, 1.5),
        rng.pick(&[1.0, 1.0, 1.3]),
        rng.pick(&[1.0, 1.0, 1.2, 0.9]),
        rng.pick(&[0.0, 0.0, 0.05]),
        rng.pick(&[0.0, 0.0, 0.7]),
    ];
    let small = rng.unit() < 0.2;
    Any {
        swing: pendulum.then_some((swing, small)),
        common: [
            rng.log_range(0.02, 1.0),
            rng.range(0.2, 0.9),
            rng.range(0.2, 0.9),
            rng.range(0.2, 1.5),
        ],
        offset: rng.range(-0.2, 0.2),
        start: [rng.range(-0.9, 0.9), rng.range(-0.5, 0.5)],
    }
}

/// A list with at least one pendulum.
pub fn any_list(rng: &mut Rng, count: usize) -> Vec<Any> {
    (0..count)
        .map(|k| {
            let pendulum = k == 0 || rng.unit() < 0.5;
            any(rng, pendulum)
        })
        .collect()
}

/// The parameters of a pendulum.
pub fn parameters<R: Real>(any: &Any, zeta: f64) -> Parameters<R> {
    let ([length, ratio, inertia, contact, pivot, spring], small) = any.swing.unwrap();
    let [mu, e, _, d] = any.common;
    let n = R::from;
    Parameters {
        frequency_ratio: n(ratio),
        inertia_ratio: n(inertia),
        contact_distance: n(length * d) * contact,
        pivot_damping_ratio: n(pivot),
        spring_ratio: n(spring),
        angles: if small { Angles::Small } else { Angles::Large },
        ..Parameters::point_bob(n(mu), n(e), n(d), n(zeta), n(length * d))
    }
}

/// A pendulum.
pub fn piva<R: Real>(any: &Any, zeta: f64) -> Piva<UndrivenHost<R>> {
    let minus = R::from(any.common[2]);
    Piva::new(parameters(any, zeta)).unwrap().with_restitution_minus(minus).unwrap()
}

/// A free mass.
pub fn mass<R: Real>(any: &Any) -> FreeMass<R> {
    let [mu, e, minus, d] = any.common.map(R::from);
    let mass = FreeMass::new(mu, e, d).unwrap().with_offset(any.offset.into()).unwrap();
    mass.with_restitution_minus(minus).unwrap()
}

/// A list on a structure of damping ratio ζ.
pub fn mixed<R: Real>(all: &[Any], zeta: f64) -> List<UndrivenHost<R>> {
    let masses: Vec<_> = all
        .iter()
        .map(|any| {
            mass(&Any { offset: if any.swing.is_some() { 0.0 } else { any.offset }, ..*any })
        })
        .collect();
    let pendulums: Vec<_> =
        all.iter().map(|any| any.swing.map(|_| parameters(any, zeta))).collect();
    list::list(R::from(zeta), &masses).with_pendulums(&pendulums).unwrap()
}

/// y, with the offset of the gap, and w.
pub fn placed<R: Real>(any: &Any) -> [R; 2] {
    let [y, w] = any.start;
    let offset = if any.swing.is_some() { 0.0 } else { any.offset };
    [R::from(offset) + R::from(y * any.common[3]), w.into()]
}

/// The start of a list, from x and ẋ.
pub fn start<R: Real>([x, v]: [f64; 2], all: &[Any]) -> Starts<R> {
    list::begun(Point { x: x.into(), v: v.into() }, &gaps(all))
}

/// y and w of each.
pub fn gaps<R: Real>(all: &[Any]) -> Vec<GapPoint<R>> {
    all.iter().map(placed).map(|[y, w]| GapPoint { y, w }).collect()
}

/// The start of a pendulum by itself.
pub fn by_itself<R: Real>([x, v]: [f64; 2], any: &Any) -> PivaStart<R> {
    let [place, rate] = placed(any).map(Given::Gap);
    PivaStart { displacement: x.into(), velocity: v.into(), place, rate }
}

/// A harmonic force, or motion of the base.
pub fn push<R: Real>(amplitude: f64, frequency: f64, acts: Acts) -> Force<R> {
    let [amplitude, frequency, phase] = [amplitude, frequency, 0.3].map(R::from);
    Force::harmonic(vec![Harmonic { amplitude, frequency, phase, acts }]).unwrap()
}

/// Those of a run of this length.
pub fn limits<R: Real>(duration: f64) -> Limits<R> {
    Limits::new(duration.into(), R::from(0.3))
}

/// A pendulum on a structure that could be driven, but is not.
pub fn still<R: Real>(piva: &Piva<UndrivenHost<R>>) -> Piva<DrivenHost<R>> {
    piva.under(Force::harmonic(vec![]).unwrap())
}
