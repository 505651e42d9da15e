//! Series and forces of a step of every lane.

use crate::force::Drive;
use crate::segment::taylor::{ORDER, Series, unrolled};

/// Coefficients of motion and force, each an array over the lanes.
#[derive(Debug)]
#[repr(align(64))]
pub(super) struct Rows<const W: usize>(Series<[f64; W]>, Drive<[f64; W]>);

impl<const W: usize> Rows<W> {
    pub const fn new() -> Self {
        let row = [[0.0; W]; ORDER + 1];
        let drive = Drive { primary: row, base: row };
        Self(Series { x: row, u: row, a: row, y: row, w: row, c: row }, drive)
    }

    /// Series of the primary's displacement and absolute acceleration in all lanes.
    #[inline(always)]
    pub fn primary(&self) -> [&[[f64; W]; ORDER + 1]; 2] {
        [&self.0.x, &self.0.a]
    }

    /// The coefficients of the force in a lane.
    #[inline(always)]
    pub fn drive(&self, i: usize) -> Drive<f64> {
        let mut drive = Drive::NONE;
        unrolled!(k < ORDER + 1 => {
            drive.primary[k] = self.1.primary[k][i];
            drive.base[k] = self.1.base[k][i];
        });
        drive
    }

    #[inline(always)]
    pub fn set_drive(&mut self, i: usize, drive: &Drive<f64>) {
        unrolled!(k < ORDER + 1 => {
            self.1.primary[k][i] = drive.primary[k];
            self.1.base[k][i] = drive.base[k];
        });
    }

    /// The series of a lane, up to the order N.
    #[inline(always)]
    pub fn get<const N: usize>(&self, i: usize) -> Series<f64> {
        let row = [0.0; ORDER + 1];
        let mut series = Series { x: row, u: row, a: row, y: row, w: row, c: row };
        unrolled!(k < N + 1 => {
            series.x[k] = self.0.x[k][i];
            series.u[k] = self.0.u[k][i];
            series.a[k] = self.0.a[k][i];
            series.y[k] = self.0.y[k][i];
            series.w[k] = self.0.w[k][i];
            series.c[k] = self.0.c[k][i];
        });
        series
    }

    #[inline(always)]
    pub fn set<const N: usize>(&mut self, i: usize, series: &Series<f64>) {
        unrolled!(k < N + 1 => {
            self.0.x[k][i] = series.x[k];
            self.0.u[k][i] = series.u[k];
            self.0.a[k][i] = series.a[k];
            self.0.y[k][i] = series.y[k];
            self.0.w[k][i] = series.w[k];
            self.0.c[k][i] = series.c[k];
        });
    }
}
