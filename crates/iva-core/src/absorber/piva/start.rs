//! The start of a pendulum, given by its gap displacement or by its angle.

use std::f64::consts::PI;

use super::{Angles, Parameters, Piva, PivaState};
use crate::absorber::siva::FreeMass;
use crate::absorber::siva::free_mass::ON_WALL;
use crate::absorber::{Clock, Start, Wall};
use crate::error::{Invalid, number};
use crate::host::oscillator::Primary;
use crate::host::{Host, Phase, Structure};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;
use crate::segment::flight::GapPoint;
use crate::segment::taylor::Pendulum;

/// Displacement or velocity of the pendulum, in the coordinate in which it was given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Given<R = f64> {
    /// Gap displacement y, or gap velocity w, for a pendulum below its pivot (cosθ > 0).
    Gap(R),
    /// Angle θ, or angular velocity θ̇ in ωn.
    Angle(R),
}

/// State at time zero, in natural units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PivaStart<R = f64> {
    /// Displacement x of the primary system.
    pub displacement: R,
    /// Velocity ẋ of the primary system.
    pub velocity: R,
    /// Gap displacement or angle.
    pub place: Given<R>,
    /// Gap velocity or angular velocity.
    pub rate: Given<R>,
}

impl<R: Real> From<Start<R>> for PivaStart<R> {
    fn from(start: Start<R>) -> Self {
        let Start { displacement, velocity, gap_displacement, gap_velocity } = start;
        let (place, rate) = (Given::Gap(gap_displacement), Given::Gap(gap_velocity));
        Self { displacement, velocity, place, rate }
    }
}

impl<R: Real> PivaStart<R> {
    fn structure(&self) -> Primary<R> {
        let [x, v] = [self.displacement, self.velocity].map(DoubleDouble::new);
        Primary { x, v }
    }
}

/// Position and velocity of the pendulum at the start.
#[derive(Debug, Clone, Copy)]
struct Pose<R = f64> {
    /// Gap displacement.
    y: R,
    /// cosθ.
    cosine: DoubleDouble<R>,
    /// W = b θ̇.
    w: R,
}

impl<R: Real> Pose<R> {
    fn new(pendulum: &Pendulum<R>, place: Given<R>, rate: Given<R>) -> Self {
        let (b, small) = (pendulum.contact_distance, pendulum.small_angles);
        let (y, cosine) = match place {
            Given::Gap(y) => (y, pendulum.precise_cosine(DoubleDouble::new(y))),
            Given::Angle(angle) if small => (b * angle, DoubleDouble::new(R::ONE)),
            Given::Angle(angle) => {
                let (sine, cosine) = R::sincos(angle);
                (b * sine, DoubleDouble::new(cosine))
            }
        };
        #[allow(clippy::redundant_guards)] // a generic number is not allowed in a pattern
        let w = match rate {
            Given::Gap(w) if w == 0.0 => R::ZERO,
            Given::Gap(w) => w / cosine.value,
            Given::Angle(rate) => b * rate,
        };
        Self { y, cosine, w }
    }
}

impl<R: Real> Parameters<R> {
    /// Gap displacement and gap velocity of a pendulum below its pivot, between the stops of this gap.
    ///
    /// # Errors
    /// [`Invalid`] for an angle beyond the stops, naming `start.angle`.
    pub fn gap(
        &self,
        place: Given<R>,
        rate: Given<R>,
        gap: &FreeMass<R>,
    ) -> Result<GapPoint<R>, Invalid> {
        let Pose { y, cosine, w } = Pose::new(&self.pendulum(), place, rate);
        let (b, walls) = (self.contact_distance, gap.walls());
        if let Given::Angle(angle) = place {
            let [low, high] = walls;
            let size = gap.clearance() + gap.offset().abs();
            let beyond = (low - y).max(y - high) > size * ON_WALL;
            if beyond || cosine.value <= 0.0 || angle.is_nan() {
                let [low, high] = walls.map(|y| {
                    let sine = y.max(-b).min(b) / b;
                    let cosine = (R::ONE - sine * sine).max(0.0).sqrt();
                    let turned = R::atan2(sine, cosine);
                    number(if self.angles == Angles::Small { sine } else { turned })
                });
                let rule = format!("it must lie between the stops, from {low} to {high} rad");
                return Err(Invalid::new("start.angle", number(angle), rule));
            }
        }
        let w = match rate {
            Given::Gap(w) => w,
            Given::Angle(_) => cosine.value * w,
        };
        Ok(GapPoint { y, w })
    }
}

impl<R: Real, H: Host<Real = R>> Piva<H> {
    fn pose(&self, start: &PivaStart<R>) -> Pose<R> {
        Pose::new(&self.pendulum, start.place, start.rate)
    }

    /// Checks that a start is in [`crate::range`] and lies in the gap.
    ///
    /// # Errors
    /// [`Invalid`] naming field, value and allowed range.
    pub(crate) fn check(&self, start: &PivaStart<R>) -> Result<(), Invalid> {
        range::size("start.displacement", start.displacement)?;
        range::size("start.velocity", start.velocity)?;
        let Pose { y, cosine, w } = self.pose(start);
        self.check_place(start.place, y, cosine.value)?;
        let (field, rate) = match start.rate {
            Given::Gap(w) => ("start.gap_velocity", w),
            Given::Angle(rate) => ("start.angular_velocity", rate),
        };
        range::size(field, rate)?;
        if range::size(field, w).is_ok() {
            return Ok(());
        }
        let rule = "the pendulum cannot move sideways so fast where it points there; give start.angular_velocity";
        Err(Invalid::new(field, number(rate), rule))
    }

    fn check_place(&self, place: Given<R>, y: R, cosine: R) -> Result<(), Invalid> {
        let (d, b) = (self.parameters.clearance, self.parameters.contact_distance);
        let beyond = y.abs() - d > d * ON_WALL;
        match place {
            Given::Gap(value) => {
                let invalid =
                    |rule| Err(Invalid::new("start.gap_displacement", number(value), rule));
                range::size("start.gap_displacement", value)?;
                if beyond {
                    return invalid(format!("it must lie in the gap, from -{0} to {0}", number(d)));
                }
                if !self.pendulum.small_angles && value.abs() > b {
                    return invalid(format!("the pendulum reaches from -{0} to {0}", number(b)));
                }
            }
            Given::Angle(angle) => {
                let invalid = |rule| Err(Invalid::new("start.angle", number(angle), rule));
                if angle.is_nan() || angle.abs() > PI {
                    return invalid("give an angle in rad, from -π to π".to_owned());
                }
                if beyond || (self.stop_reachable() && cosine < 0.0) {
                    let most = number(self.wall_angle());
                    return invalid(format!(
                        "it must lie between the stops, from -{most} to {most} rad"
                    ));
                }
            }
        }
        Ok(())
    }

    /// The first state of a run, from a start and the instant of the drive.
    pub(super) fn first_state(
        &self,
        start: &PivaStart<R>,
        time: Clock<R>,
    ) -> PivaState<Phase<H>, R> {
        let phase = self.host.begin_at(time);
        let primary = start.structure();
        let pull = self.host.free().acceleration(&phase, &primary).value;
        let leaning = [pull].into_iter().chain(self.host.leaning(&phase));
        self.placed(start, leaning).with_phase(phase)
    }

    /// The first state without drive; `leaning`: what moves the structure after a start at rest.
    pub(crate) fn placed(
        &self,
        start: &PivaStart<R>,
        leaning: impl IntoIterator<Item = R>,
    ) -> PivaState<(), R> {
        let primary = start.structure();
        let Pose { y, cosine, w } = self.pose(start);
        // Distances are measured from the wall that the pendulum is nearest to or moves towards, so that a
        // mirrored start gives the same numbers with opposite signs.
        let side = [y, w, start.displacement, start.velocity]
            .into_iter()
            .chain(leaning)
            .find(|value| *value != 0.0)
            .unwrap_or(R::ONE);
        let wall = if side > 0.0 { Wall::Plus } else { Wall::Minus };
        let clearance = self.parameters.clearance;
        let distance = match start.place {
            Given::Angle(_) if self.stops.steep => self.height(cosine, y * wall.sign()),
            _ => DoubleDouble::new(clearance).plus(y * -wall.sign()),
        };
        let touching = distance.value <= clearance * ON_WALL;
        #[allow(clippy::redundant_guards)] // a generic number is not allowed in a pattern
        let w = match start.rate {
            Given::Gap(rate) if w != 0.0 => DoubleDouble::new(rate).over_sum(cosine),
            _ => DoubleDouble::new(w),
        };
        PivaState {
            phase: (),
            primary,
            wall,
            distance: if touching { DoubleDouble::ZERO } else { distance },
            clearance,
            w,
            cosine: if touching { self.stops.cosine } else { cosine },
            released: false,
        }
    }

    /// Distance d − y to a wall from cosθ: b² (cos²θ − cos² at the wall)/(d + y), more accurate than from y
    /// where the pendulum is nearly horizontal.
    fn height(&self, cosine: DoubleDouble<R>, y: R) -> DoubleDouble<R> {
        let b = self.parameters.contact_distance;
        let over = (cosine - self.stops.cosine) * (cosine + self.stops.cosine);
        over.times(b).times(b).over_sum(DoubleDouble::new(self.parameters.clearance).plus(y))
    }
}
