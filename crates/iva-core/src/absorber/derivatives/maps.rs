//! What a motion, an impact and a stick of free masses and pendulums on a linear structure do to a small difference of a state.
//!
//! Each changes few of its variables: a map changes them in place, and is only written as a matrix where one is asked for.

use std::borrow::{Borrow, Cow};

use nalgebra::{DMatrix, DVector, DVectorViewMut};

use super::masses::{LinearStructure, Pull};

/// A linear map of small differences, which changes one in place.
pub type Map<'a> = Box<dyn FnMut(&mut [f64]) + 'a>;

/// Carries each column of a matrix through a map.
pub fn map_columns(matrix: &mut DMatrix<f64>, map: &mut Map<'_>) {
    let size = matrix.nrows();
    matrix.as_mut_slice().chunks_exact_mut(size).for_each(map);
}

/// Carries a covariance P through a map A, to A P Aᵀ.
pub fn carry_covariance(covariance: &mut DMatrix<f64>, map: &mut Map<'_>) {
    for _ in 0..2 {
        map_columns(covariance, map);
        covariance.transpose_mut();
    }
}

/// The map by a matrix.
pub fn by_matrix<'a>(matrix: impl Borrow<DMatrix<f64>> + 'a) -> Map<'a> {
    let mut before = DVector::zeros(matrix.borrow().ncols());
    Box::new(move |it| {
        before.copy_from_slice(it);
        let matrix = matrix.borrow();
        DVectorViewMut::from_slice(it, matrix.nrows()).gemv(1.0, matrix, &before, 0.0);
    })
}

/// That of a motion of length h in which these members are carried, and none swings: y + φq of another moves uniformly.
pub(in crate::absorber) fn flow<'a>(
    linear: Cow<'a, LinearStructure>,
    carried: &'a [bool],
    h: f64,
) -> Map<'a> {
    let n = linear.coordinates();
    let structure = linear.flow_of_structure(carried, h);
    let mut before = vec![0.0; 2 * n];
    Box::new(move |it| {
        before.copy_from_slice(&it[..2 * n]);
        for row in 0..2 * n {
            it[row] = (0..2 * n).map(|column| structure[(row, column)] * before[column]).sum();
        }
        for (k, shape) in linear.shapes.iter().enumerate() {
            let [y, w] = linear.of(k);
            if carried[k] {
                it[w] = 0.0;
                continue;
            }
            let moved = along(shape, |j| h.mul_add(before[n + j], before[j]) - it[j]);
            let gained = along(shape, |j| before[n + j] - it[n + j]);
            it[y] += h * it[w] + moved;
            it[w] += gained;
        }
    })
}

/// That of an impact of some members, with the slopes of their laws, at a fixed instant; `carried` before and after it, and what q̇ gains.
pub(in crate::absorber) fn impact<'a>(
    linear: Cow<'a, LinearStructure>,
    struck: Vec<(usize, f64)>,
    [before, after]: [&'a [bool]; 2],
    faster: &DVector<f64>,
) -> Map<'a> {
    let n = linear.coordinates();
    let strikes = |k: &usize| struck.iter().any(|(own, _)| own == k);
    let others = linear.compliance(|k| if strikes(&k) { None } else { linear.moves(k, after) });
    let blows = linear.blows(&struck, &others);
    let flying: Vec<usize> = (0..after.len()).filter(|k| !after[*k] && !strikes(k)).collect();
    // A pendulum in flight takes more or less of its mass along with its place.
    let whole =
        |k: usize| if strikes(&k) { Some(linear.lightness[k]) } else { linear.moves(k, after) };
    let heavier = |k: &usize| {
        let [_, more] = linear.pulls[*k].inertia;
        (more != 0.0).then(|| {
            let shape = &linear.shapes[*k];
            let pushed = shape.dot(faster);
            (*k, pushed, linear.compliance(whole) * shape * -(more * pushed))
        })
    };
    let heavier: Vec<_> = flying.iter().filter_map(heavier).collect();
    let freed: Vec<usize> = (0..after.len()).filter(|k| before[*k] && !after[*k]).collect();
    let mut gained = DVector::zeros(n);
    Box::new(move |it| {
        for k in &freed {
            it[linear.of(*k)[1]] = 0.0;
        }
        gained.fill(0.0);
        for ((k, slope), blow) in struck.iter().zip(blows.column_iter()) {
            let [_, w] = linear.of(*k);
            gained.axpy(it[w], &blow, 1.0);
            it[w] *= -slope;
        }
        for (k, pushed, slower) in &heavier {
            let [y, w] = linear.of(*k);
            gained.axpy(it[y], slower, 1.0);
            it[w] -= linear.pulls[*k].follows[1] * pushed * it[y];
        }
        push(&linear, it, &flying, [n, 1], &gained);
    })
}

/// That of the stop of a member on its wall, where it comes to rest; `carried` with it.
pub(in crate::absorber) fn stick<'a>(
    linear: Cow<'a, LinearStructure>,
    mass: usize,
    carried: &[bool],
) -> Map<'a> {
    let n = linear.coordinates();
    let [share, damped] = linear.stick(mass, carried);
    let flying: Vec<usize> = (0..carried.len()).filter(|k| !carried[*k]).collect();
    Box::new(move |it| {
        let [y, w] = linear.of(mass).map(|variable| std::mem::take(&mut it[variable]));
        push(&linear, it, &flying, [0, 0], &(&share * y));
        push(&linear, it, &flying, [n, 1], &(&share * w + &damped * y));
    })
}

/// Moves q, from index 0 on, or q̇, from n on, and with it y or ẏ of those that fly.
fn push(
    linear: &LinearStructure,
    it: &mut [f64],
    flying: &[usize],
    [first, rate]: [usize; 2],
    by: &DVector<f64>,
) {
    it[first..].iter_mut().zip(by.iter()).for_each(|(own, by)| *own += by);
    for k in flying {
        let Pull { follows: [follows, _], .. } = linear.pulls[*k];
        it[linear.of(*k)[rate]] -= follows * along(&linear.shapes[*k], |j| by[j]);
    }
}

/// What coordinates come to at a point of this shape.
fn along(shape: &DVector<f64>, of: impl Fn(usize) -> f64) -> f64 {
    shape.iter().enumerate().map(|(j, phi)| phi * of(j)).sum()
}
