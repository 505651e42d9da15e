//! How well estimates of errors cover the true errors, which are those against runs in numbers of twice the precision.

use iva_core::impact::Impact;
use iva_core::propagation::Errors;
use iva_core::real::twofold::Twofold;

/// Counts of the impacts of some runs.
#[derive(Debug, Default)]
pub struct Covered {
    told: usize,
    beyond: usize,
    /// Estimates over true errors.
    ratios: Vec<f64>,
}

impl Covered {
    /// Counts the impacts of a run, up to the first that the precise run does not have.
    pub fn count(&mut self, impacts: &[Impact], precise: &[Impact<Twofold>], errors: &Errors) {
        assert_eq!(errors.impacts.len(), impacts.len());
        for ((one, other), error) in impacts.iter().zip(precise).zip(&errors.impacts) {
            let (true, Some(estimate)) = (one.absorber == other.absorber, error.time) else {
                return;
            };
            let off = f64::from(Twofold::from(one.time) - other.time).abs();
            self.told += 1;
            self.beyond += usize::from(off > estimate);
            if off > 0.0 {
                self.ratios.push(estimate / off);
            }
        }
    }

    /// Holds if there are more impacts than this, one in a hundred at most is beyond its estimate, and estimates are of the
    /// size of the errors.
    pub fn holds(mut self, least: usize) {
        self.ratios.sort_by(f64::total_cmp);
        let Self { told, beyond, ratios } = self;
        let typical = ratios[ratios.len() / 2];
        assert!(told > least, "{told} impacts");
        assert!(beyond * 100 < told, "{beyond} of {told} beyond their estimates");
        assert!((2.0..100.0).contains(&typical), "estimates are {typical} times the errors");
    }
}
