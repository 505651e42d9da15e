//! f/M and a_g at one instant, and about it.

use super::Acts;
use crate::number::arrays::laned;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::number::series::{ORDER, unrolled};

/// Taylor coefficients of f/M and a_g about an instant.
#[derive(Debug, Clone, Copy)]
pub struct Drive<T, const LENGTH: usize = { ORDER + 1 }> {
    /// Coefficients of f/M.
    pub primary: [T; LENGTH],
    /// Coefficients of a_g.
    pub base: [T; LENGTH],
}

/// f/M or a_g at one instant, with its derivatives in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Push<R = f64> {
    /// The value of f/M or a_g.
    pub value: DoubleDouble<R>,
    /// The first derivative in time.
    pub rate: DoubleDouble<R>,
    /// The second derivative in time.
    pub second: DoubleDouble<R>,
    /// The third derivative in time.
    pub third: R,
}

/// f/M and a_g at one instant, with their derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pushes<R = f64> {
    /// f/M.
    pub primary: Push<R>,
    /// a_g.
    pub base: Push<R>,
}

/// The smooth piece of a force that acts at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smooth<R = f64> {
    /// The instant at which the force bends, jumps or has an impulse next.
    pub end: Option<DoubleDouble<R>>,
    /// The number of points of the first record at or before the begin of the piece.
    pub passed: u32,
}

impl<R: Real> Smooth<R> {
    /// A force that is smooth for ever.
    pub const ALL: Self = Self { end: None, passed: 0 };
}

laned!(
    Push,
    ManyPushes { value: DoubleDouble, rate: DoubleDouble, second: DoubleDouble, third: f64 }
);

laned!(Pushes, AllPushes { primary: Push, base: Push });

impl<R: Real> Push<R> {
    /// No force.
    pub const NONE: Push<R> = Push {
        value: DoubleDouble::ZERO,
        rate: DoubleDouble::ZERO,
        second: DoubleDouble::ZERO,
        third: R::ZERO,
    };

    /// The first Taylor coefficients in powers of time, four at most.
    #[inline(always)]
    pub(crate) fn ahead<const LENGTH: usize>(&self) -> [R; LENGTH] {
        let [half, sixth] = [R::reciprocal(2), R::reciprocal(6)];
        let (value, rate) = (self.value.value, self.rate.value);
        let all = [value, rate, self.second.value * half, self.third * sixth];
        let mut row = [R::ZERO; LENGTH];
        row.copy_from_slice(&all[..LENGTH]);
        row
    }

    /// The force a time later, if it is linear.
    #[inline(always)]
    pub(super) fn later(&self, time: DoubleDouble<R>) -> Self {
        Self { value: self.value + self.rate * time, ..*self }
    }

    #[inline(always)]
    pub(super) fn add(&mut self, other: &Push<R>) {
        self.value = self.value + other.value;
        self.rate = self.rate + other.rate;
        self.second = self.second + other.second;
        self.third += other.third;
    }
}

impl<R: Real> Pushes<R> {
    /// No force.
    pub(crate) const NONE: Self = Self { primary: Push::NONE, base: Push::NONE };

    /// The first Taylor coefficients in powers of time, four at most.
    #[inline(always)]
    pub(crate) fn ahead<const LENGTH: usize>(&self) -> Drive<R, LENGTH> {
        Drive { primary: self.primary.ahead(), base: self.base.ahead() }
    }

    /// The first two of them to twice the precision.
    #[inline(always)]
    pub(crate) fn now(&self) -> Drive<DoubleDouble<R>, 2> {
        let now = |push: &Push<R>| [push.value, push.rate];
        Drive { primary: now(&self.primary), base: now(&self.base) }
    }

    #[inline(always)]
    pub(crate) fn on(&mut self, acts: Acts) -> &mut Push<R> {
        match acts {
            Acts::Primary => &mut self.primary,
            Acts::Base => &mut self.base,
        }
    }
}

impl<R: Real, const LENGTH: usize> Drive<DoubleDouble<R>, LENGTH> {
    /// No force, in double-double.
    pub(crate) const NOTHING: Self =
        Self { primary: [DoubleDouble::ZERO; LENGTH], base: [DoubleDouble::ZERO; LENGTH] };
}

impl<R: Real, const LENGTH: usize> Drive<R, LENGTH> {
    /// No force.
    pub(crate) const NONE: Self = Self { primary: [R::ZERO; LENGTH], base: [R::ZERO; LENGTH] };

    /// The coefficients of forces without second derivative.
    #[inline(always)]
    pub(crate) fn linear(pushes: &Pushes<R>, h: R) -> Self {
        let row = |push: &Push<R>| {
            let mut row = [R::ZERO; LENGTH];
            (row[0], row[1]) = (push.value.value, push.rate.value * h);
            row
        };
        Self { primary: row(&pushes.primary), base: row(&pushes.base) }
    }

    /// A bound on |f/M| and |a_g| within the step: the sum of the sizes of all coefficients.
    #[inline(always)]
    pub fn size(&self) -> R {
        let mut size = R::ZERO;
        unrolled!(k < ORDER + 1 => if k < LENGTH {
            size += self.primary[k].abs() + self.base[k].abs();
        });
        size
    }
}

impl<T, const LENGTH: usize> Drive<T, LENGTH> {
    pub(super) fn row(&mut self, acts: Acts) -> &mut [T; LENGTH] {
        match acts {
            Acts::Primary => &mut self.primary,
            Acts::Base => &mut self.base,
        }
    }
}
