//! Which members move with their points, and the impulses at the points of some of them.

use std::ops::Deref;
use std::sync::{Arc, Mutex};

use super::Modal;
use super::state::Place;
use crate::host::Host;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

/// What the equations depend on beside the state: which masses move with their points, and which way the others slide.
#[derive(Debug, Clone)]
pub(super) struct Regime<'a, R, const N: usize> {
    pub stuck: Carried<'a, R>,
    /// G of each mass, and s R of one that slides.
    pub pulls: [DoubleDouble<R>; N],
}

/// What a set of stuck or held masses needs.
#[derive(Debug, Clone)]
pub(super) struct Stuck<R> {
    /// Their indices.
    pub masses: Vec<usize>,
    /// (μ⁻¹ + ΦᵀΦ)⁻¹, row by row.
    pub inverse: Vec<DoubleDouble<R>>,
}

/// What a set needs: that of the empty one, or what was made for a set.
#[derive(Debug, Clone)]
pub(super) enum Carried<'a, R> {
    None(&'a Stuck<R>),
    Some(Arc<Stuck<R>>),
}

/// A set of members, and what was made for it.
type Made<R> = Option<(usize, Arc<Stuck<R>>)>;

/// What sets of stuck or held masses need: of the empty one, and of that which was asked for last.
#[derive(Debug, Clone)]
pub(super) struct Sets<R> {
    empty: Stuck<R>,
    last: Arc<Mutex<Made<R>>>,
}

impl<R> Deref for Carried<'_, R> {
    type Target = Stuck<R>;

    #[inline(always)]
    fn deref(&self) -> &Stuck<R> {
        match self {
            Self::None(empty) => empty,
            Self::Some(made) => made,
        }
    }
}

impl<R> Sets<R> {
    pub fn new() -> Self {
        Self { empty: Stuck { masses: vec![], inverse: vec![] }, last: Arc::default() }
    }

    /// What a set needs, made if it is not that of the last call.
    #[inline(always)]
    fn of(&self, set: usize, make: impl FnOnce() -> Stuck<R>) -> Carried<'_, R> {
        if set == 0 { Carried::None(&self.empty) } else { Carried::Some(self.made(set, make)) }
    }

    #[inline(never)]
    fn made(&self, set: usize, make: impl FnOnce() -> Stuck<R>) -> Arc<Stuck<R>> {
        // Who is in the way makes it anew.
        let Ok(mut last) = self.last.try_lock() else { return Arc::new(make()) };
        match &*last {
            Some((known, made)) if *known == set => Arc::clone(made),
            _ => {
                let made = Arc::new(make());
                *last = Some((set, Arc::clone(&made)));
                made
            }
        }
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// What the equations of the modes are while the masses have these places.
    pub(super) fn regime(&self, places: &[Place<R>; N]) -> Regime<'_, R, N> {
        let set = self.carried_set(places);
        let over = |k: usize| (set >> k & 1 == 1).then(|| self.lightness(k));
        let made = || self.stuck_set(&std::array::from_fn(over));
        let pull = |k: usize| {
            if k < self.count() { self.pull(k, &places[k]) } else { DoubleDouble::ZERO }
        };
        Regime { stuck: self.sets.of(set, made), pulls: std::array::from_fn(pull) }
    }

    /// Which members are stuck or held, one bit each.
    pub(super) fn carried_set(&self, places: &[Place<R>; N]) -> usize {
        let all = places[..self.count()].iter().enumerate();
        all.fold(0, |set, (k, place)| set | usize::from(place.carried()) << k)
    }

    /// What stuck members and pendulums in flight need.
    pub(super) fn fixed_at(&self, places: &[Place<R>; N]) -> Stuck<R> {
        let of = |k: usize| self.inertia_over(k, &places[k], places[k].carried());
        self.stuck_set(&std::array::from_fn(|k| if k < self.count() { of(k) } else { None }))
    }

    /// What members need whose inertias have these reciprocals, if they move with their points.
    pub(super) fn stuck_set(&self, over: &[Option<DoubleDouble<R>>; N]) -> Stuck<R> {
        let masses: Vec<usize> = (0..N).filter(|k| over[*k].is_some()).collect();
        let count = masses.len();
        let mut inverse = vec![DoubleDouble::ZERO; count * count];
        for column in 0..count {
            let mut unit = [DoubleDouble::ZERO; N];
            unit[masses[column]] = DoubleDouble::new(R::ONE);
            let solved = self.impulses(over, unit);
            for (row, k) in masses.iter().enumerate() {
                inverse[row * count + column] = solved[*k];
            }
        }
        Stuck { masses, inverse }
    }

    /// Solves (μ⁻¹ + ΦᵀΦ) P = rhs for the members that are included with a reciprocal 1/μ, by Gauss's elimination: the matrix is symmetric and
    /// positive definite. The others have no impulse.
    pub(super) fn impulses(
        &self,
        over: &[Option<DoubleDouble<R>>; N],
        rhs: [DoubleDouble<R>; N],
    ) -> [DoubleDouble<R>; N] {
        let (mut masses, mut count) = ([0; N], 0);
        for k in (0..self.count()).filter(|k| over[*k].is_some()) {
            masses[count] = k;
            count += 1;
        }
        let masses = &masses[..count];
        let mut impulses = [DoubleDouble::ZERO; N];
        let over = |k: usize| over[k].unwrap_or(DoubleDouble::ZERO);
        if let [k] = *masses {
            impulses[k] = rhs[k] / (self.mobility(k, k) + over(k));
            return impulses;
        }
        let mut a: Vec<DoubleDouble<R>> = Vec::with_capacity(count * count);
        for k in masses {
            a.extend(masses.iter().map(|l| self.mobility(*k, *l)));
        }
        let mut b: Vec<DoubleDouble<R>> = masses.iter().map(|k| rhs[*k]).collect();
        for (p, k) in masses.iter().enumerate() {
            a[p * (count + 1)] = a[p * (count + 1)] + over(*k);
        }
        for p in 0..count {
            for i in p + 1..count {
                let share = a[i * count + p] / a[p * (count + 1)];
                for j in p..count {
                    a[i * count + j] = a[i * count + j] - share * a[p * count + j];
                }
                b[i] = b[i] - share * b[p];
            }
        }
        for p in (0..count).rev() {
            let left =
                (p + 1..count).fold(b[p], |left, j| left - a[p * count + j] * impulses[masses[j]]);
            impulses[masses[p]] = left / a[p * (count + 1)];
        }
        impulses
    }

    /// The velocity at the point of a mass that impulses on the structure at those of others give it.
    pub(super) fn pushed_by(&self, k: usize, impulses: &[DoubleDouble<R>; N]) -> DoubleDouble<R> {
        if self.oscillates() {
            // All points move as one.
            return impulses.iter().fold(DoubleDouble::ZERO, |sum, impulse| sum + *impulse);
        }
        let given = (0..self.count()).filter(|l| impulses[*l].value != 0.0);
        given.fold(DoubleDouble::ZERO, |sum, l| sum + self.mobility(k, l) * impulses[l])
    }
}
