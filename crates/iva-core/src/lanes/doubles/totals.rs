//! Sums over the flights of a lane: energy losses, work and ∫x² as integrals, and largest sizes.
//!
//! The integrals are Gaussian quadratures of the four polynomials that the motion consists of, never
//! differences of energies, so that the energy ledger is an independent check. With [`NODES`] the square of a
//! motion over the longest flight is integrated with a relative error of some 10⁻¹⁶.

use super::lane::Lanes;
use super::motion::{BASE, State, Structure};
use super::responses::{TERMS, Tables};
use super::step::Rounds;
use super::turning::{Jets, Turned, turned};
use crate::compensated::DoubleDouble;
use crate::flight::{Arc, Extreme};
use crate::lanes::arrays::arrays;
use crate::lanes::pick;
use crate::taylor::unrolled;

/// Nodes and weights on [0, 1] (zeros of the Legendre polynomial of degree 9).
const NODES: [(f64, f64); 9] = [
    (0.015919880246186954, 0.040637194180787206),
    (0.0819844463366821, 0.0903240803474287),
    (0.1933142836497048, 0.13030534820146772),
    (0.33787328829809554, 0.15617353852000143),
    (0.5, 0.1651196775006299),
    (0.6621267117019045, 0.15617353852000143),
    (0.8066857163502952, 0.13030534820146772),
    (0.9180155536633179, 0.0903240803474287),
    (0.984080119753813, 0.040637194180787206),
];

/// Number of coefficients of a sum of P, Q, C, B and a linear function, in powers of t = h/longest.
const LENGTH: usize = TERMS + 4;

arrays! {
    /// The sums of a run since they were last added to its observers.
    Total,
    /// [`Total`] of many runs: every field an array over the lanes.
    Totals:
    /// Energy lost in the damper, work, and ∫x², in double-double.
    lost, lost_rest, worked, worked_rest, square, square_rest,
    /// The largest |x| and |A| so far in the window.
    displacement, acceleration,
    /// 1 in the window of the steady state; the number of impacts in it.
    counts, impacts,
}

/// The sums that are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Asked {
    pub ledger: bool,
    pub square: bool,
    pub displacement: bool,
    pub acceleration: bool,
    pub impacts: bool,
}

/// A polynomial of each lane: coefficients in powers of t = h/longest.
type Course<const W: usize> = [[f64; W]; LENGTH];

/// The polynomial first + second h + p P + q Q + c C + b B of each lane; `of` gives these coefficients and
/// `longest`.
#[allow(clippy::needless_range_loop, reason = "a lane is an index into every row")]
#[inline(always)]
fn combine<const W: usize>(
    tables: &Tables<W>,
    of: impl Fn(usize) -> ([f64; 2], [f64; 4], f64),
) -> Course<W> {
    let mut course = [[0.0; W]; LENGTH];
    for i in 0..W {
        let ([first, second], [p, q, c, b], longest) = of(i);
        let square = longest * longest;
        let (p, q, c, b) =
            (p * square, q * (square * longest), c * (square * square), b * (square * longest));
        course[0][i] = first;
        course[1][i] = second * longest;
        unrolled!(k < TERMS + 2 => {
            let mut sum = 0.0;
            if k < TERMS {
                sum = p * tables.terms[0][k][i];
            }
            if k > 0 && k <= TERMS {
                sum = q.mul_add(tables.terms[1][k - 1][i], sum);
                sum = b.mul_add(tables.terms[3][k - 1][i], sum);
            }
            if k > 1 {
                sum = c.mul_add(tables.terms[2][k - 2][i], sum);
            }
            course[k + 2][i] = sum;
        });
    }
    course
}

/// Nodes evaluated together: enough independent sums to hide the latency of each.
const AT_ONCE: usize = 3;

/// The values of a polynomial at some points of each lane.
#[inline(always)]
fn at<const W: usize>(course: &Course<W>, t: &[[f64; W]; AT_ONCE]) -> [[f64; W]; AT_ONCE] {
    let [mut first, mut second, mut third] = [course[LENGTH - 1]; AT_ONCE];
    for k in (0..LENGTH - 1).rev() {
        for i in 0..W {
            first[i] = f64::mul_add(first[i], t[0][i], course[k][i]);
            second[i] = f64::mul_add(second[i], t[1][i], course[k][i]);
            third[i] = f64::mul_add(third[i], t[2][i], course[k][i]);
        }
    }
    [first, second, third]
}

/// The nodes of one group, scaled to the stretch of each lane.
#[inline(always)]
fn nodes<const W: usize>(group: usize, parts: &[f64; W]) -> [[f64; W]; AT_ONCE] {
    let mut t = [[0.0; W]; AT_ONCE];
    for (n, t) in t.iter_mut().enumerate() {
        let (node, _) = NODES[AT_ONCE * group + n];
        for i in 0..W {
            t[i] = node * parts[i];
        }
    }
    t
}

/// The polynomial of ẋ.
#[inline(always)]
fn velocity<const W: usize, const DRIVE: u8>(lanes: &Lanes<W>, tables: &Tables<W>) -> Course<W> {
    combine::<W>(tables, |i| {
        let (state, structure) = (lanes.state.get(i), lanes.structure.get(i));
        let Structure { damping, frequency, .. } = structure;
        let [_, [a, ..]] = structure.derivatives::<DRIVE>(&state);
        let rapid = frequency * frequency;
        let (k, j) = (rapid * state.force, frequency * state.quadrature);
        let p = a.mul_add(-damping, -(state.v + j));
        ([state.v, a], [p, a, -(j * rapid), -k], structure.longest)
    })
}

/// The polynomial of x.
#[inline(always)]
fn displacement<const W: usize, const DRIVE: u8>(
    lanes: &Lanes<W>,
    tables: &Tables<W>,
) -> Course<W> {
    combine::<W>(tables, |i| {
        let (state, structure) = (lanes.state.get(i), lanes.structure.get(i));
        let Structure { frequency, .. } = structure;
        let [_, [a, ..]] = structure.derivatives::<DRIVE>(&state);
        let rapid = frequency * frequency;
        let (k, j) = (rapid * state.force, frequency * state.quadrature);
        ([state.x, state.v], [a, state.v, k, -j], structure.longest)
    })
}

/// The polynomial of f.
#[inline(always)]
fn force<const W: usize, const DRIVE: u8>(lanes: &Lanes<W>, tables: &Tables<W>) -> Course<W> {
    combine::<W>(tables, |i| {
        let (state, structure) = (lanes.state.get(i), lanes.structure.get(i));
        let Structure { damping, frequency, .. } = structure;
        let rapid = frequency * frequency;
        let (k, j) = (rapid * state.force, frequency * state.quadrature);
        let c = k.mul_add(1.0 - rapid, -(j * (damping * rapid)));
        let b = -k.mul_add(damping, j * (1.0 - rapid));
        ([state.force, -j], [-k, -j, c, b], structure.longest)
    })
}

/// The length of the completed stretch of each lane; 0: none.
#[inline(always)]
fn lengths<const W: usize>(rounds: &Rounds<W>) -> [f64; W] {
    let mut lengths = [0.0; W];
    for (i, length) in lengths.iter_mut().enumerate() {
        *length = pick(rounds.passed[i] > 0.0, rounds.length[i] + rounds.later[i], 0.0);
    }
    lengths
}

/// Lengths of stretches in units of the longest flight.
#[inline(always)]
fn parts<const W: usize>(lanes: &Lanes<W>, lengths: &[f64; W]) -> [f64; W] {
    let mut parts = [0.0; W];
    for i in 0..W {
        parts[i] = lengths[i] * lanes.structure.over_longest[i];
    }
    parts
}

/// Adds terms to sums in double-double.
#[inline(always)]
fn add<const W: usize>(sum: &mut [f64; W], rest: &mut [f64; W], terms: &[f64; W]) {
    for i in 0..W {
        let DoubleDouble { value, rest: lost } =
            DoubleDouble { value: sum[i], rest: rest[i] }.plus(terms[i]);
        (sum[i], rest[i]) = (value, lost);
    }
}

/// Adds the energy lost in the damper and the work of the force or base in each completed stretch.
#[inline(always)]
pub(super) fn lose<const W: usize, const DRIVE: u8>(
    lanes: &Lanes<W>,
    tables: &Tables<W>,
    rounds: &Rounds<W>,
    totals: &mut Totals<W>,
) {
    let (lengths, course) = (lengths(rounds), velocity::<W, DRIVE>(lanes, tables));
    let parts = parts(lanes, &lengths);
    let push = force::<W, DRIVE>(lanes, tables);
    let [mut squares, mut works, mut pushed] = [[0.0; W]; 3];
    for group in 0..NODES.len() / AT_ONCE {
        let t = nodes(group, &parts);
        let velocities = at(&course, &t);
        let forces = at(&push, &t);
        for (n, (velocity, force)) in velocities.iter().zip(&forces).enumerate() {
            let (_, weight) = NODES[AT_ONCE * group + n];
            for i in 0..W {
                squares[i] = f64::mul_add(weight * velocity[i], velocity[i], squares[i]);
                works[i] = f64::mul_add(weight * force[i], velocity[i], works[i]);
                pushed[i] = f64::mul_add(weight, force[i], pushed[i]);
            }
        }
    }
    for i in 0..W {
        // Where a force is too fast for the polynomials, the sums are not numbers.
        let passed = lengths[i] > 0.0;
        squares[i] = pick(passed, squares[i] * (lanes.structure.damping[i] * lengths[i]), 0.0);
        works[i] = pick(passed, works[i] * lengths[i], 0.0);
        if DRIVE == BASE {
            // ∫ f (ẋ + μ (ẋ + w)) with f = −a_g: the absorber is in free flight, so its velocity ẋ + w is the
            // one at the begin + ∫f.
            let state = lanes.state.get(i);
            let absorber = state.v - state.side * state.rate;
            let pushed = pushed[i] * lengths[i];
            let carried = lanes.mass_ratio[i] * (pushed * (0.5 * pushed + absorber));
            works[i] += pick(passed, carried, 0.0);
        }
    }
    add(&mut totals.lost, &mut totals.lost_rest, &squares);
    add(&mut totals.worked, &mut totals.worked_rest, &works);
}

/// Adds ∫x² of each completed stretch within the window.
#[inline(always)]
pub(super) fn square<const W: usize, const DRIVE: u8>(
    lanes: &Lanes<W>,
    tables: &Tables<W>,
    rounds: &Rounds<W>,
    totals: &mut Totals<W>,
) {
    let (lengths, course) = (lengths(rounds), displacement::<W, DRIVE>(lanes, tables));
    let parts = parts(lanes, &lengths);
    let mut squares = [0.0; W];
    for group in 0..NODES.len() / AT_ONCE {
        let places = at(&course, &nodes(group, &parts));
        for (n, place) in places.iter().enumerate() {
            let (_, weight) = NODES[AT_ONCE * group + n];
            for i in 0..W {
                squares[i] = f64::mul_add(weight * place[i], place[i], squares[i]);
            }
        }
    }
    for i in 0..W {
        let counts = (totals.counts[i] > 0.0) & (lengths[i] > 0.0);
        squares[i] = pick(counts, squares[i] * lengths[i], 0.0);
    }
    add(&mut totals.square, &mut totals.square_rest, &squares);
}

/// Updates the largest |x| or |A| within the window. A stretch in which the largest size is not known is
/// halved.
#[inline(always)]
pub(super) fn largest<const W: usize, const DRIVE: u8, const ACCELERATION: bool>(
    lanes: &Lanes<W>,
    tables: &Tables<W>,
    rounds: &mut Rounds<W>,
    totals: &mut Totals<W>,
) {
    for i in 0..W {
        let (state, structure, round) = (lanes.state.get(i), lanes.structure.get(i), rounds.get(i));
        let length = round.length + round.later;
        let jets = |at: &State| {
            let [absolute, [bend, third, fourth, fifth, ..]] = structure.derivatives::<DRIVE>(at);
            if ACCELERATION { absolute } else { [at.x, at.v, bend, third, fourth, fifth] }
        };
        let (begin, end) = (jets(&state), jets(&round.end));
        let sixth = if ACCELERATION {
            structure.bound::<6>(&state)
        } else {
            structure.bound::<4>(&state) + structure.base_4
        };
        let leading = |[value, rate, bend, ..]: Jets| [value, rate, bend];
        let mut arc = Arc::new(leading(begin), leading(end), sixth, length);
        if ACCELERATION {
            // A may be a small difference of large terms.
            let longest = structure.longest;
            arc = arc.doubted(structure.bound::<3>(&state) * (longest * longest * longest));
        }
        let Turned { value: turned, exact, .. } = turned::<W, DRIVE>(
            (&structure, tables, i),
            &state,
            (&begin, &end),
            jets,
            (sixth, length),
        );
        let extreme = Extreme::new(&arc, arc.turns_once() & exact, turned);
        let least = if ACCELERATION { totals.acceleration[i] } else { totals.displacement[i] };
        let counts = (totals.counts[i] > 0.0) & (round.passed > 0.0);
        let plain = extreme.known | (extreme.limit < least);
        let most = pick(counts & extreme.known, least.max(extreme.most), least);
        if ACCELERATION {
            totals.acceleration[i] = most;
        } else {
            totals.displacement[i] = most;
        }
        let asks = counts & !plain;
        rounds.passed[i] = pick(asks, 0.0, round.passed);
        rounds.hit[i] = pick(asks, 0.0, round.hit);
    }
}

/// Counts the impacts within the window.
#[inline(always)]
pub(super) fn count<const W: usize>(rounds: &Rounds<W>, totals: &mut Totals<W>) {
    for i in 0..W {
        totals.impacts[i] += rounds.hit[i] * totals.counts[i];
    }
}
