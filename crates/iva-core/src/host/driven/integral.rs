//! Integrals along a motion: Gaussian quadrature, exact for polynomials up to degree 15.
//!
//! The square of a motion within one time scale of oscillator and force is integrated with a relative error
//! of some 10⁻¹⁷. Losses and work are never differences of energies, so that the energy ledger is an
//! independent check.

use crate::number::real::Real;
use crate::segment::taylor::{ORDER, Row};

/// Number of nodes.
pub(crate) const COUNT: usize = 8;

/// Nodes on [0, 1] as double-doubles: high and low part (zeros of the Legendre polynomial of degree 8).
const NODES: [(f64, f64); COUNT] = [
    (0.019855071751231884, -1.1322220207511075e-20),
    (0.10166676129318664, -5.812859914874862e-18),
    (0.2372337950418355, 2.4999537888879484e-18),
    (0.4082826787521751, -1.2429403704321504e-17),
    (0.591717321247825, -4.308174752693632e-17),
    (0.7627662049581645, -2.4999537888879484e-18),
    (0.8983332387068134, 5.812859914874862e-18),
    (0.9801449282487681, 2.7766897835836425e-17),
];

/// Weights of the nodes as double-doubles: high and low part.
const WEIGHTS: [(f64, f64); COUNT] = [
    (0.05061426814518813, 2.431871133231763e-19),
    (0.11119051722668724, -5.753650714613641e-18),
    (0.15685332293894363, 9.134300218895555e-18),
    (0.181341891689181, -3.62383661760509e-18),
    (0.181341891689181, -3.62383661760509e-18),
    (0.15685332293894363, 9.134300218895555e-18),
    (0.11119051722668724, -5.753650714613641e-18),
    (0.05061426814518813, 2.431871133231763e-19),
];

/// The values of a function at all nodes.
pub(crate) type Nodes<R> = [R; COUNT];

/// Node n on [from, to].
#[inline(always)]
pub(crate) fn node<R: Real>(n: usize, [from, to]: [R; 2]) -> R {
    let (at, rest) = NODES[n];
    (R::from(at) + R::from(rest)) * (to - from) + from
}

/// The weight of node n on an interval of length 1.
#[inline(always)]
pub(crate) fn weight<R: Real>(n: usize) -> R {
    let (weight, rest) = WEIGHTS[n];
    R::from(weight) + R::from(rest)
}

/// All nodes on [from, to].
#[inline(always)]
pub(crate) fn nodes<R: Real>(ends: [R; 2]) -> Nodes<R> {
    let mut nodes = [R::ZERO; COUNT];
    for (n, at) in nodes.iter_mut().enumerate() {
        *at = node(n, ends);
    }
    nodes
}

/// The values of a polynomial at all nodes.
#[inline(always)]
pub(crate) fn at_nodes<R: Real>(row: &Row<R>, t: &Nodes<R>) -> Nodes<R> {
    let mut values = [R::ZERO; COUNT];
    for k in (0..=ORDER).rev() {
        for (value, t) in values.iter_mut().zip(t) {
            *value = value.mul_add(*t, row[k]);
        }
    }
    values
}

/// The mean of f g over the interval of the nodes.
#[inline(always)]
pub(crate) fn mean_product<R: Real>(f: &Nodes<R>, g: &Nodes<R>) -> R {
    let mut terms = [R::ZERO; COUNT];
    for (n, term) in terms.iter_mut().enumerate() {
        *term = weight::<R>(n) * (f[n] * g[n]);
    }
    sum_of(&terms)
}

/// The sum over all nodes; nodes of equal weight are added first.
#[inline(always)]
pub(crate) fn sum_of<R: Real>(terms: &Nodes<R>) -> R {
    ((terms[0] + terms[7]) + (terms[1] + terms[6]))
        + ((terms[2] + terms[5]) + (terms[3] + terms[4]))
}
