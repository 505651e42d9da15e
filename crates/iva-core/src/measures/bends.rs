//! How a path bends where it meets a wall: what tells how near an impact is to a grazing.

use crate::absorber::Absorber;
use crate::absorber::impact::Impact;
use crate::engine::observe::{Contact, Observer};

/// A listed impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bend {
    /// The index of the absorber.
    pub absorber: u8,
    /// Its instant, in 1/ωn.
    pub time: f64,
    /// Its approach speed.
    pub speed: f64,
    /// D̈ just before, where it bends the path away from the wall, else 0; `None` for an impact of a summed chatter.
    pub curvature: Option<f64>,
}

impl Bend {
    /// True if a shift of the instant could turn the impact into a grazing, to first order: the distance changes by w dτ, and
    /// w²/(2|D̈|) is what is missing to a grazing.
    pub fn is_grazing_within(&self, shift: f64) -> bool {
        self.curvature.is_some_and(|bend| 2.0 * bend * shift.abs() >= self.speed)
    }
}

/// An observer that keeps the listed impacts of a run in doubles.
#[derive(Debug, Clone, Default)]
pub struct Bends {
    /// The impacts in order of time.
    pub impacts: Vec<Bend>,
    /// The curvature at the contact that comes before an impact.
    curvature: Option<f64>,
}

impl<S: Absorber<Real = f64>> Observer<S> for Bends {
    fn looks_within(&self) -> bool {
        false
    }

    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State>) {
        if !contact.summed {
            self.curvature = Some(system.distance(contact.states[0]).curvature.max(0.0));
        }
    }

    fn impact(&mut self, _system: &S, impact: &Impact) {
        let (time, speed) = (impact.time, impact.approach_speed());
        let curvature = self.curvature.take();
        self.impacts.push(Bend { absorber: impact.absorber, time, speed, curvature });
    }

    fn unlist(&mut self, absorber: u8, first: u64, floor: f64) {
        let mut index = 0;
        self.impacts.retain(|it| {
            let mine = it.absorber == absorber;
            index += u64::from(mine);
            !mine || index <= first || it.speed > floor
        });
    }
}
