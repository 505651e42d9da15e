//! Free masses on a structure that moves as one, any number of them.

use iva_core::{
    absorber::Point,
    absorber::modal::{MOST, Modal, ModalStart, ModalStructure, PRIMARY},
    flight::GapPoint,
    force::Force,
    host::{DrivenHost, UndrivenHost},
    real::Real,
    siva::FreeMass,
};

/// A list with room for the most masses that there may be, on one mode.
pub type List<H> = Modal<H, MOST, 1>;
/// Its start.
pub type Starts<R> = ModalStart<R, MOST, 1>;

/// Masses on a structure of a damping ratio, without drive.
pub fn list<R: Real>(damping_ratio: R, masses: &[FreeMass<R>]) -> List<UndrivenHost<R>> {
    let structure = ModalStructure::moving_as_one(damping_ratio).unwrap();
    let masses: Vec<_> = masses.iter().map(|mass| (*mass, PRIMARY)).collect();
    List::with_room(structure, &masses).unwrap()
}

/// The same list under a force.
pub fn driven<R: Real>(list: &List<UndrivenHost<R>>, force: Force<R>) -> List<DrivenHost<R>> {
    list.under(force, PRIMARY).unwrap()
}

/// A start of the structure and of each mass in its gap.
pub fn begun<R: Real>(Point { x, v }: Point<R>, gaps: &[GapPoint<R>]) -> Starts<R> {
    let unused = GapPoint { y: R::ZERO, w: R::ZERO };
    let gaps = std::array::from_fn(|k| gaps.get(k).copied().unwrap_or(unused));
    ModalStart::new(&[x], &[v], gaps).unwrap()
}
