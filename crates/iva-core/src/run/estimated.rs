//! In which way the errors of the runs of each absorber are estimated.

use crate::absorber::modal::Modal;
use crate::absorber::piva::Piva;
use crate::absorber::siva::Siva;
use crate::host::Host;
use crate::measures::propagation::{ByLists, ByTangents, Estimated};

impl<H: Host<Real = f64>> Estimated for Siva<H> {
    type Way = ByTangents;
}

impl<H: Host<Real = f64>> Estimated for Piva<H> {
    type Way = ByTangents;
}

impl<H: Host<Real = f64>, const N: usize, const M: usize> Estimated for Modal<H, N, M> {
    type Way = ByLists;
}
