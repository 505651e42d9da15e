//! The least-squares line through the logarithms of peaks.

use crate::number::real::Real;

/// Peaks below this share of A₀ end the least-squares fit.
pub const FIT_FLOOR: f64 = 0.05;

/// Running least-squares line of ln a over t (updated means, after Welford 1962).
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Fit<R = f64> {
    pub(super) closed: bool,
    count: R,
    mean_t: R,
    mean_l: R,
    square_t: R,
    product: R,
}

impl<R: Real> Fit<R> {
    /// Takes a peak: its time, and its size over A₀.
    pub(super) fn take(&mut self, time: R, amplitude: R) {
        // Where nothing moves, the size is 0/0.
        if self.closed || amplitude.is_nan() || amplitude < FIT_FLOOR {
            self.closed = true;
            return;
        }
        let log = amplitude.ln();
        self.count += 1.0;
        let dt = time - self.mean_t;
        self.mean_t += dt / self.count;
        self.mean_l += (log - self.mean_l) / self.count;
        self.square_t += dt * (time - self.mean_t);
        self.product += dt * (log - self.mean_l);
    }

    /// Its slope, if there are three peaks or more.
    pub(super) fn slope(&self) -> Option<R> {
        (self.count >= 3.0).then(|| self.product / self.square_t)
    }
}
