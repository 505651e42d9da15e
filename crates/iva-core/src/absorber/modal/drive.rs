//! What drives the modes: the force at its point, harmonic forces at other points, the base, and gravity and friction as pulls; for power
//! series, and for leaps.

use super::propagator::{Feed, MOST_WAVES};
use super::series::{EXACT, scaled};
use super::{Modal, ModalState};
use crate::force::{Acts, Drive, Force, Harmonic};
use crate::host::{Host, Phase};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::taylor::ORDER;

/// Coefficients of f, of a_g, and of gravity, which is 1 at all times.
pub(super) type Pushed<R> = [DoubleDouble<R>; 3];

/// What a harmonic force at another point is in powers of t, with the index of its point.
pub(super) type Aside<R> = (usize, [DoubleDouble<R>; ORDER + 1]);

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// The coefficients of f, a_g and gravity from a state of the drive on, in powers of t = h/`unit`.
    pub(super) fn pushes(
        &self,
        phase: &Phase<H>,
        unit: R,
    ) -> impl Fn(usize) -> Pushed<R> + use<R, H, N, M> {
        let drive: Option<Drive<R>> = self.host.drive(phase, unit);
        let now = self.host.drive_now(phase);
        move |m| {
            let gravity = DoubleDouble::new(if m == 0 { R::ONE } else { R::ZERO });
            let Some(drive) = &drive else {
                return [DoubleDouble::ZERO, DoubleDouble::ZERO, gravity];
            };
            let [f, a] = match &now {
                Some(now) if m < 2 => {
                    let power = if m == 0 { R::ONE } else { unit };
                    [scaled(now.primary[m], power), scaled(now.base[m], power)]
                }
                _ => [drive.primary[m], drive.base[m]].map(DoubleDouble::new),
            };
            [f, a, gravity]
        }
    }

    /// The harmonic forces at other points from a state of the drive on, in powers of t = h/`unit` up to `order`; plain beyond those that
    /// the series have to twice the precision.
    pub(super) fn asides(&self, phase: &Phase<H>, unit: R, order: usize) -> Vec<Aside<R>> {
        let elsewhere = self.host.force().map_or(&[][..], Force::elsewhere);
        let Some(time) = self.host.time(phase).filter(|_| !elsewhere.is_empty()) else {
            return vec![];
        };
        let of = |(point, harmonic): &(usize, Harmonic<R>)| {
            let mut row = [DoubleDouble::ZERO; ORDER + 1];
            harmonic.add_precise(&mut row[..EXACT.min(order + 1)], time, unit);
            let turn = harmonic.frequency * unit;
            for m in EXACT..=order {
                let over = R::reciprocal(m) * R::reciprocal(m - 1);
                row[m] = DoubleDouble::new(-(row[m - 2].value * (turn * turn) * over));
            }
            (*point, row)
        };
        elsewhere.iter().map(of).collect()
    }

    /// Adds what a derivative of the drive is to the modes.
    pub(super) fn push_by(
        &self,
        waves: &[[DoubleDouble<R>; 2]; MOST_WAVES],
        order: usize,
        bent: &mut [R; M],
    ) {
        for ((harmonic, point), [cosine, sine]) in self.waves().zip(waves) {
            let turned = [cosine.value, sine.value, -cosine.value, -sine.value][order % 4];
            let size = (0..order).fold(turned, |size, _| size * harmonic.frequency);
            let (shape, size) = match harmonic.acts {
                Acts::Primary => (self.whole.shape(point), size),
                Acts::Base => (self.whole.participation().unwrap_or(&[]), -size),
            };
            for (bent, part) in bent.iter_mut().zip(shape) {
                *bent = part.mul_add(size, *bent);
            }
        }
    }

    /// The harmonic parts of the drive, each with the index of the point on which it acts unless it moves the base.
    pub(super) fn waves(&self) -> impl Iterator<Item = (&Harmonic<R>, usize)> {
        let own = self.host.force().map_or(&[][..], Force::harmonics).iter();
        let elsewhere = self.host.force().map_or(&[][..], Force::elsewhere).iter();
        own.map(|it| (it, self.pushed)).chain(elsewhere.map(|(point, it)| (it, *point)))
    }

    /// What feeds the structure from a state on, in which the masses pull so.
    pub(super) fn feed(
        &self,
        state: &ModalState<H, N, M>,
        pulls: [DoubleDouble<R>; N],
    ) -> Feed<R, N> {
        let mut waves = [[DoubleDouble::ZERO; 2]; MOST_WAVES];
        if let Some(time) = self.host.time(&state.phase) {
            for (wave, (harmonic, _)) in waves.iter_mut().zip(self.waves()) {
                let (s, c) = R::precise_sincos(harmonic.angle(time));
                *wave = [c, -s].map(|part| part.times(harmonic.amplitude));
            }
        }
        Feed { pulls, waves }
    }
}
