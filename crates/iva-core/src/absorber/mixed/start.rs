//! The start of a list of free masses and pendulums.

use super::{MOST, Mixed, MixedState, OneOf, Placed};
use crate::absorber::piva::{Given, PivaStart};
use crate::absorber::siva::free_mass::check_place;
use crate::absorber::{Clock, Point, Wall};
use crate::error::{Invalid, number};
use crate::host::oscillator::Primary;
use crate::host::{Host, Structure as _};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;

/// Place and velocity of one absorber at the start: the angle is that of a pendulum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Posed<R = f64> {
    /// Gap displacement or angle.
    pub place: Given<R>,
    /// Gap velocity or angular velocity.
    pub rate: Given<R>,
}

/// A start of the structure and of a list of absorbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MixedStart<R = f64> {
    /// Displacement and velocity of the structure.
    pub primary: Point<R>,
    /// That of each absorber; those after the last absorber mean nothing.
    pub each: [Posed<R>; MOST],
}

impl<R: Real> MixedStart<R> {
    /// A start of some absorbers.
    pub fn of(primary: Point<R>, each: &[Posed<R>]) -> Self {
        let unused = Posed { place: Given::Gap(R::ZERO), rate: Given::Gap(R::ZERO) };
        let each = std::array::from_fn(|k| each.get(k).copied().unwrap_or(unused));
        Self { primary, each }
    }

    /// That of the structure with the absorber of this index alone.
    fn alone(&self, absorber: usize) -> PivaStart<R> {
        let Point { x, v } = self.primary;
        let Posed { place, rate } = self.each[absorber];
        PivaStart { displacement: x, velocity: v, place, rate }
    }
}

/// y and w of a free mass; `None` where an angle is given.
fn of_mass<R: Copy>(posed: &Posed<R>) -> Option<[R; 2]> {
    match *posed {
        Posed { place: Given::Gap(y), rate: Given::Gap(w) } => Some([y, w]),
        _ => None,
    }
}

impl<R: Real, H: Host<Real = R>> Mixed<H> {
    /// Checks the start of each.
    pub(super) fn check(&self, start: &MixedStart<R>) -> Result<(), Invalid> {
        range::size("start.displacement", start.primary.x)?;
        range::size("start.velocity", start.primary.v)?;
        for (k, (member, posed)) in self.members.iter().zip(start.each).enumerate() {
            let field = |name: &str| format!("start.{k}.{name}");
            match &member.one {
                OneOf::Mass(mass) => {
                    let Some([y, w]) = of_mass(&posed) else {
                        let rule =
                            "a free mass has no angle; give its gap displacement and velocity";
                        return Err(Invalid::new(field("angle"), number(R::ZERO), rule));
                    };
                    range::size(&field("gap_displacement"), y)?;
                    range::size(&field("gap_velocity"), w)?;
                    check_place(&field("gap_displacement"), y, [mass.clearance, mass.offset])?;
                }
                OneOf::Pendulum(piva) => {
                    piva.check(&start.alone(k)).map_err(|error| {
                        let name = error.field.strip_prefix("start.").unwrap_or(&error.field);
                        Invalid { field: field(name), ..error }
                    })?;
                }
            }
        }
        Ok(())
    }

    /// The first state of a run, from a start and the instant of the drive.
    pub(super) fn first_state(&self, start: &MixedStart<R>, time: Clock<R>) -> MixedState<H> {
        let phase = self.host.begin_at(time);
        let Point { x, v } = start.primary;
        let primary = Primary { x: DoubleDouble::new(x), v: DoubleDouble::new(v) };
        let pull = self.host.free().acceleration(&phase, &primary).value;
        let leaning = self.host.leaning(&phase);
        let mut places = [Placed::UNUSED; MOST];
        for (k, (member, place)) in self.members.iter().zip(&mut places).enumerate() {
            *place = match &member.one {
                OneOf::Mass(mass) => {
                    let [y, w] = of_mass(&start.each[k]).unwrap_or([R::ZERO; 2]);
                    let leaning = [-pull, v].into_iter().chain(leaning);
                    let (side, distance) = mass.begun([y, w], leaning);
                    let wall = if side > 0.0 { Wall::Plus } else { Wall::Minus };
                    Placed { wall, distance, w: DoubleDouble::new(w), ..Placed::UNUSED }
                }
                OneOf::Pendulum(piva) => {
                    let leaning = [pull].into_iter().chain(leaning);
                    Placed::UNUSED.moved_to(&piva.placed(&start.alone(k), leaning))
                }
            };
        }
        MixedState { phase, primary, places, at_hand: 0 }
    }
}
