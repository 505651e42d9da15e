//! A free mass in flight in the fast tier: its state in plain doubles.

use super::responses::Values;
use super::{State, Structure};
use crate::absorber::chatter::REBOUND_LOOK;
use crate::absorber::siva::Law;
use crate::absorber::siva::trial::FreeMass;
use crate::number::real::{Real, pick};

/// A free mass on a structure with this kind of drive, and the responses of the structure.
#[derive(Debug)]
pub(crate) struct Mass<V, const DRIVE: u8> {
    pub structure: Structure,
    pub responses: V,
}

impl<V: Values, const DRIVE: u8> FreeMass for Mass<V, DRIVE> {
    type Real = f64;
    type State = State;
    const STRAIGHT: f64 = 0.05;
    const CLOSE: f64 = 0.25;

    #[inline(always)]
    fn curve(&self, at: &State) -> [f64; 3] {
        let [[a, ..], _] = self.structure.derivatives::<DRIVE>(at);
        [at.distance, at.rate, at.side * a]
    }

    #[inline(always)]
    fn ahead(&self, from: &State, h: f64) -> [f64; 3] {
        self.curve(&self.nearly(from, h))
    }

    #[inline(always)]
    fn in_doubles(at: &State) -> State {
        *at
    }

    #[inline(always)]
    fn rebound(rate: f64, pressure: f64, over: f64) -> f64 {
        REBOUND_LOOK * f64::about(over * rate, over * pressure)
    }

    #[inline(always)]
    fn bounds(&self, from: &State) -> [f64; 2] {
        [self.structure.bound::<3>(from), self.structure.bound::<4>(from)]
    }

    #[inline(always)]
    fn nearly(&self, from: &State, h: f64) -> State {
        from.after::<DRIVE>(&self.structure, &self.responses, h)
    }

    #[inline(always)]
    fn near(&self, at: &State, beyond: f64) -> [f64; 5] {
        let [[a, jerk, snap, ..], _] = self.structure.derivatives::<DRIVE>(at);
        [at.distance - beyond, at.rate, at.side * a, at.side * jerk, at.side * snap]
    }

    #[inline(always)]
    fn touching(&self, at: &State, hit: bool, far: bool, t: f64) -> State {
        let mut touching = at.shortly_after::<DRIVE>(&self.structure, t);
        let turn = pick(hit & far, -1.0, 1.0);
        touching.side *= turn;
        touching.rate *= turn;
        touching.distance = pick(hit, 0.0, touching.distance);
        touching
    }

    #[inline(always)]
    fn struck(&self, touching: &State, hit: bool, law: &Law) -> State {
        let State { v, side, rate, .. } = *touching;
        let approach = pick(hit, -rate, 0.0);
        let v = law.share.value.mul_add(side * approach, v);
        State { v, rate: pick(hit, law.restitution * approach, rate), ..*touching }
    }
}
