//! Integrals along a motion: Gaussian quadrature.
//!
//! Losses and work are never differences of energies, so that the energy ledger is an independent check. The
//! square of a motion is integrated with a relative error of some 10⁻¹⁷ by 8 nodes within 1.2 time scales of
//! oscillator and force, and of some 10⁻¹⁶ by 9 nodes within 2.

use crate::number::real::Real;
use crate::number::series::unrolled;

/// A node on [0, 1] and its weight, each as a double-double: high and low part.
type Node = [(f64, f64); 2];

/// The zeros of the Legendre polynomial of degree 8.
const EIGHT: [Node; 8] = [
    [(0.019855071751231884, -1.1322220207511075e-20), (0.05061426814518813, 2.431871133231763e-19)],
    [(0.10166676129318664, -5.812859914874862e-18), (0.11119051722668724, -5.753650714613641e-18)],
    [(0.2372337950418355, 2.4999537888879484e-18), (0.15685332293894363, 9.134300218895555e-18)],
    [(0.4082826787521751, -1.2429403704321504e-17), (0.181341891689181, -3.62383661760509e-18)],
    [(0.591717321247825, -4.308174752693632e-17), (0.181341891689181, -3.62383661760509e-18)],
    [(0.7627662049581645, -2.4999537888879484e-18), (0.15685332293894363, 9.134300218895555e-18)],
    [(0.8983332387068134, 5.812859914874862e-18), (0.11119051722668724, -5.753650714613641e-18)],
    [(0.9801449282487681, 2.7766897835836425e-17), (0.05061426814518813, 2.431871133231763e-19)],
];

/// The zeros of the Legendre polynomial of degree 9.
const NINE: [Node; 9] = [
    [
        (0.015919880246186954, 1.4781967966885047e-18),
        (0.040637194180787206, -1.465752262798417e-19),
    ],
    [(0.0819844463366821, 1.4974854717233135e-18), (0.0903240803474287, 4.0723785249407524e-18)],
    [(0.1933142836497048, 7.957069420242026e-18), (0.13030534820146772, 1.2254449113110457e-17)],
    [
        (0.33787328829809554, -6.6118940172217434e-18),
        (0.15617353852000143, -1.1405650041570611e-17),
    ],
    [(0.5, 0.0), (0.1651196775006299, -9.54920474040151e-18)],
    [(0.6621267117019045, -4.889925721403608e-17), (0.15617353852000143, -1.1405650041570611e-17)],
    [(0.8066857163502952, 1.979850619538689e-17), (0.13030534820146772, 1.2254449113110457e-17)],
    [(0.9180155536633179, 1.2380302336091143e-17), (0.0903240803474287, 4.0723785249407524e-18)],
    [(0.984080119753813, 1.9912501552651095e-18), (0.040637194180787206, -1.465752262798417e-19)],
];

/// The quadrature with G nodes, 8 or 9.
const fn rule<const G: usize>() -> [Node; G] {
    let rule: &[Node] = if G == 8 { &EIGHT } else { &NINE };
    assert!(rule.len() == G, "8 or 9 nodes");
    let mut nodes = [[(0.0, 0.0); 2]; G];
    let mut n = 0;
    while n < G {
        nodes[n] = rule[n];
        n += 1;
    }
    nodes
}

/// Node n of G on [from, to].
#[inline(always)]
pub(crate) fn node<R: Real, const G: usize>(n: usize, [from, to]: [R; 2]) -> R {
    let [(at, rest), _] = const { rule::<G>() }[n];
    (R::from(at) + R::from(rest)) * (to - from) + from
}

/// The weight of node n of G on an interval of length 1.
#[inline(always)]
pub(crate) fn weight<R: Real, const G: usize>(n: usize) -> R {
    let [_, (weight, rest)] = const { rule::<G>() }[n];
    R::from(weight) + R::from(rest)
}

/// All nodes on [from, to].
#[inline(always)]
pub(crate) fn nodes<R: Real, const G: usize>(ends: [R; 2]) -> [R; G] {
    let mut nodes = [R::ZERO; G];
    for (n, at) in nodes.iter_mut().enumerate() {
        *at = node::<R, G>(n, ends);
    }
    nodes
}

/// The values of a polynomial of this order at all nodes.
#[inline(always)]
pub(crate) fn values<const ORDER: usize, R: Real, const L: usize, const G: usize>(
    row: &[R; L],
    t: &[R; G],
) -> [R; G] {
    let mut values = [R::ZERO; G];
    unrolled!(k < ORDER + 1 => for (value, t) in values.iter_mut().zip(t) {
        *value = value.mul_add(*t, row[ORDER - k]);
    });
    values
}

/// The derivatives of a polynomial of this order at all nodes.
#[inline(always)]
pub(crate) fn rates<const ORDER: usize, R: Real, const L: usize, const G: usize>(
    row: &[R; L],
    t: &[R; G],
) -> [R; G] {
    let mut rates = [R::ZERO; G];
    unrolled!(k < ORDER => for (rate, t) in rates.iter_mut().zip(t) {
        *rate = rate.mul_add(*t, row[ORDER - k] * ((ORDER - k) as f64));
    });
    rates
}

/// The mean of a function over the interval of the nodes; nodes of equal weight are added first.
#[inline(always)]
pub(crate) fn mean<R: Real, const G: usize>(f: &[R; G]) -> R {
    let term = |n: usize| weight::<R, G>(n) * f[n];
    let pair = |n: usize| term(n) + term(G - 1 - n);
    let pairs = (pair(0) + pair(1)) + (pair(2) + pair(3));
    if G % 2 == 1 { pairs + term(G / 2) } else { pairs }
}

/// The mean of f g over the interval of the nodes.
#[inline(always)]
pub(crate) fn mean_product<R: Real, const G: usize>(f: &[R; G], g: &[R; G]) -> R {
    let mut product = *f;
    for (f, g) in product.iter_mut().zip(g) {
        *f *= *g;
    }
    mean(&product)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The integral of tᵏ from 1 to 3 up to the degree 2 G − 1 that a Gaussian quadrature is exact for, and not beyond it.
    #[test]
    fn powers_are_integrated_exactly_up_to_their_degree() {
        fn off<const G: usize>(degree: i32) -> f64 {
            let t = nodes::<f64, G>([1.0, 3.0]);
            let truth = (3f64.powi(degree + 1) - 1.0) / f64::from(degree + 1);
            mean(&t.map(|t| t.powi(degree))) * 2.0 / truth - 1.0
        }
        for degree in 0..16 {
            assert!(off::<8>(degree).abs() < 1e-15, "{degree}: {:e}", off::<8>(degree));
        }
        for degree in 0..18 {
            assert!(off::<9>(degree).abs() < 1e-15, "{degree}: {:e}", off::<9>(degree));
        }
        assert!(off::<8>(24).abs() > 1e-13 && off::<9>(28).abs() > 1e-13);
    }

    #[test]
    fn values_and_rates_are_those_of_the_polynomial() {
        let row = [1.0, 2.0, 3.0, 4.0, f64::NAN];
        let t = nodes::<f64, 8>([0.0, 1.0]);
        let (value, rate) = (values::<3, _, _, _>(&row, &t), rates::<3, _, _, _>(&row, &t));
        for (n, t) in t.into_iter().enumerate() {
            assert!((value[n] - (1.0 + t * (2.0 + t * (3.0 + t * 4.0)))).abs() < 1e-14);
            assert!((rate[n] - (2.0 + t * (6.0 + t * 12.0))).abs() < 1e-14);
        }
    }
}
