//! Where structure and absorber are.

use crate::number::arrays::{Laned, Lanes};
use crate::number::real::pick;

/// A wall of the gap: `Plus` at y = +d, `Minus` at y = −d.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Wall {
    /// y = +d.
    Plus,
    /// y = −d.
    Minus,
}

impl Wall {
    /// 0 for wall +, 1 for wall −: the index into arrays over the walls.
    #[inline]
    pub fn index(self) -> usize {
        match self {
            Wall::Plus => 0,
            Wall::Minus => 1,
        }
    }

    /// +1 or −1.
    #[inline]
    pub fn sign(self) -> f64 {
        match self {
            Wall::Plus => 1.0,
            Wall::Minus => -1.0,
        }
    }

    /// The wall across the gap.
    #[inline]
    pub fn opposite(self) -> Self {
        match self {
            Wall::Plus => Wall::Minus,
            Wall::Minus => Wall::Plus,
        }
    }

    /// +1 or −1 as a small integer.
    pub fn number(self) -> i8 {
        match self {
            Wall::Plus => 1,
            Wall::Minus => -1,
        }
    }
}

impl Laned for Wall {
    type Lanes<const W: usize> = [f64; W];

    #[inline(always)]
    fn pick(which: bool, yes: &Wall, no: &Wall) -> Wall {
        pick(which, *yes, *no)
    }
}

/// A wall in each lane, by its sign.
impl<const W: usize> Lanes<Wall> for [f64; W] {
    fn new() -> Self {
        [1.0; W]
    }

    #[inline(always)]
    fn get(&self, i: usize) -> Wall {
        pick(self[i] > 0.0, Wall::Plus, Wall::Minus)
    }

    #[inline(always)]
    fn set(&mut self, i: usize, one: &Wall) {
        self[i] = one.sign();
    }
}

/// Displacement and velocity of the primary system, in natural units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point<R = f64> {
    /// Displacement x.
    pub x: R,
    /// Velocity ẋ.
    pub v: R,
}
