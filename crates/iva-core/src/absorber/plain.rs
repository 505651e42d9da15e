//! A free mass on its structure in plain doubles: its state, and the motion from it.
//!
//! Let f = F cos(Ω t + φ) be the force on the structure, or −a_g of its base, f̂ = F sin(Ω t + φ),
//! a = f − x − 2ζv, and P, Q, C, B, K the [`responses`]. Then
//!
//! ```text
//! x(h) = x + v h + a P + v Q + Ω²f C − Ωf̂ B,
//! v(h) = v + a S − v P − Ω²f B − Ωf̂ (P + Ω²C),
//! f(h) = f (1 − Ω²κ) − f̂ Ωσ,    κ = (1 − cos Ωh)/Ω² = P + (Ω² − 1) C + 2ζB,
//! f̂(h) = f̂ (1 − Ω²κ) + f Ωσ,    σ = sin Ωh/Ω = h + Q + (1 − Ω²) B + 2ζΩ²C.
//! ```
//!
//! The distance to the wall gains ∬A, where A = ẍ on a base at rest. On a moving base A = ẍ − f = −x − 2ζv, which
//! above resonance is small against both ẍ and f, so ∬A is not taken as a difference of theirs:
//!
//! ```text
//! ∬A = (a − f) P + v Q + f (C − 2ζB) − Ωf̂ (K + 2ζC).
//! ```

use crate::force::{Acts, Harmonic};
use crate::host::oscillator::Equation;
use crate::number::arrays::arrays;
use crate::number::compensated::DoubleDouble;
use responses::{Responses, Values};

pub(crate) mod mass;
pub(crate) mod responses;

/// Kind of drive: a harmonic force on the structure.
pub(crate) const FORCE: u8 = 1;
/// Kind of drive: a harmonic motion of the base.
pub(crate) const BASE: u8 = 2;

arrays! {
    /// The state of structure and absorber at an instant.
    State, States:
    /// x and ẋ, f and f̂.
    x, v, force, quadrature,
    /// Distance to the wall last touched, its rate, and the sign of that wall.
    distance, rate, side,
}

arrays! {
    /// The constants of a structure.
    Structure, Structures:
    /// 2ζ, Λ of [`Equation`], and Ω.
    damping, growth, frequency,
    /// F and φ of the force, or of −a_g where the base moves.
    amplitude, phase,
    /// The longest flight that the polynomials hold for, and its reciprocal.
    longest, over_longest,
    /// Contribution of the force to the bounds on the derivatives of A of order 3, 4 and 6.
    excess_3, excess_4, excess_6,
    /// A bound on the fourth derivative of a_g.
    base_4,
}

/// A free mass under one harmonic force, or on a base that it moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scene {
    /// Damping ratio ζ.
    pub damping_ratio: f64,
    /// Mass ratio μ.
    pub mass_ratio: f64,
    /// One-sided clearance d.
    pub clearance: f64,
    /// The middle of the gap, as a value of y.
    pub offset: f64,
    /// The force.
    pub harmonic: Harmonic,
    /// True if it moves the base.
    pub moves_base: bool,
}

impl Structure {
    /// A bound on √(x² + v²) at every later time in free motion.
    #[inline(always)]
    fn radius(at: &State) -> f64 {
        at.x.abs() + at.v.abs()
    }

    /// A bound on the Nth derivative of A in every motion from a state: the third, fourth or sixth.
    #[inline(always)]
    pub fn bound<const N: usize>(&self, at: &State) -> f64 {
        let square = self.growth * self.growth;
        let power = square * square;
        let (power, excess) = match N {
            3 => (power, self.excess_3),
            4 => (power * self.growth, self.excess_4),
            _ => (power * (square * self.growth), self.excess_6),
        };
        power * Self::radius(at) + excess
    }

    /// A with its first five derivatives, and ẍ with its first five derivatives.
    #[inline(always)]
    pub fn derivatives<const DRIVE: u8>(&self, at: &State) -> [[f64; 6]; 2] {
        let Self { damping, frequency, .. } = *self;
        // next = −(lower + 2ζ upper).
        let next = |lower: f64, upper: f64| upper.mul_add(-damping, -lower);
        let rate = -(frequency * at.quadrature);
        let square = -(frequency * frequency);
        let (second, third) = (square * at.force, square * rate);
        let absolute = next(at.x, at.v);
        let a = absolute + at.force;
        let absolute_jerk = next(at.v, a);
        let jerk = absolute_jerk + rate;
        let absolute_snap = next(a, jerk);
        let snap = absolute_snap + second;
        let absolute_fifth = next(jerk, snap);
        let fifth = absolute_fifth + third;
        let absolute_sixth = next(snap, fifth);
        let sixth = square.mul_add(second, absolute_sixth);
        let absolute_seventh = next(fifth, sixth);
        let relative = [a, jerk, snap, fifth, sixth, square.mul_add(third, absolute_seventh)];
        if DRIVE == BASE {
            let low = [absolute, absolute_jerk, absolute_snap];
            let high = [absolute_fifth, absolute_sixth, absolute_seventh];
            return [[low[0], low[1], low[2], high[0], high[1], high[2]], relative];
        }
        [relative, relative]
    }

    /// The constants of a structure without force.
    pub fn new(equation: &Equation, longest: f64) -> Self {
        let Equation { damping, growth, .. } = *equation;
        Self { damping, growth, longest, over_longest: 1.0 / longest, ..Self::default() }
    }

    /// The constants of a structure under one harmonic force, with the contribution of that to the bounds on
    /// its derivatives ([`crate::host::Driven`]).
    pub fn driven(equation: &Equation, responses: &Responses, harmonic: &Harmonic) -> Self {
        let structure = Self::new(equation, responses.longest);
        let Self { growth, longest, .. } = structure;
        let mut drives = [harmonic.amplitude.abs(); 7];
        let mut powers = [1.0; 8];
        for n in 1..7 {
            drives[n] = drives[n - 1] * harmonic.frequency;
        }
        for n in 1..8 {
            powers[n] = powers[n - 1] * growth;
        }
        let excess = |order: usize| {
            let sum: f64 = (0..=order).map(|i| powers[order - i] * drives[i]).sum();
            powers[order + 1] * (longest * drives[0]) + sum + drives[order]
        };
        let (base, sign) = if harmonic.acts == Acts::Base { (1.0, -1.0) } else { (0.0, 1.0) };
        Self {
            amplitude: sign * harmonic.amplitude,
            frequency: harmonic.frequency,
            phase: harmonic.phase,
            excess_3: excess(3),
            excess_4: excess(4),
            excess_6: excess(6),
            base_4: base * drives[4],
            ..structure
        }
    }

    /// f and f̂ at an instant. They are computed anew after every stretch. Turned from stretch to stretch, their
    /// phase gathers rounding errors, and setting it right now and then leaves the absorber with a velocity
    /// that belongs to another phase.
    #[inline(always)]
    pub fn force_at(&self, clock: DoubleDouble) -> [f64; 2] {
        let Self { amplitude, frequency, phase, .. } = *self;
        Harmonic { amplitude, frequency, phase, acts: Acts::Primary }.turned(clock)
    }
}

impl State {
    /// The state after a flight of length h from here.
    #[inline(always)]
    pub fn after<const DRIVE: u8>(
        &self,
        structure: &Structure,
        responses: &impl Values,
        h: f64,
    ) -> Self {
        let Structure { damping: c, frequency, over_longest, .. } = *structure;
        let Self { x, v, force: f, quadrature: q, .. } = *self;
        let t = h * over_longest;
        let square = h * h;
        let p = square * responses.at::<0>(t);
        let cube = square * h;
        let carried = cube * responses.at::<1>(t);
        let s = h + p.mul_add(-c, carried);
        let a = v.mul_add(-c, f - x);
        let mut apart = a.mul_add(p, v * carried);
        let mut faster = a.mul_add(s, -(v * p));
        let cosine = (square * square) * responses.at::<2>(t);
        let sine = cube * responses.at::<3>(t);
        let rapid = frequency * frequency;
        let (k, j) = (rapid * f, frequency * q);
        apart += k.mul_add(cosine, -(j * sine));
        faster -= k.mul_add(sine, j * rapid.mul_add(cosine, p));
        let kappa = p + (rapid - 1.0).mul_add(cosine, c * sine);
        let sigma = h + (carried + (1.0 - rapid).mul_add(sine, (c * rapid) * cosine));
        let (less, turn) = (rapid * kappa, frequency * sigma);
        let force = f - f.mul_add(less, q * turn);
        let quadrature = q + f.mul_add(turn, -(q * less));
        let (mut absolute, mut gained) = (apart, faster);
        if DRIVE == BASE {
            let summed = (square * cube) * responses.at::<4>(t);
            let pulled = v.mul_add(-c, -x);
            let (slow, fast) = (c.mul_add(-sine, cosine), c.mul_add(cosine, summed));
            let falling = c.mul_add(rapid.mul_add(cosine, p), sine);
            absolute = pulled.mul_add(p, v * carried) + f.mul_add(slow, -(j * fast));
            gained = pulled.mul_add(s, -(v * p)) - f.mul_add(falling, j * slow);
        }
        let moved = self.moved([h, apart, faster], [absolute, gained]);
        Self { force, quadrature, ..moved }
    }

    /// The state after a time h, given the gains of displacement (beyond a uniform motion) and velocity, and
    /// ∬A and ∫A.
    #[inline(always)]
    fn moved(&self, [h, apart, faster]: [f64; 3], [absolute, gained]: [f64; 2]) -> Self {
        Self {
            x: self.x + self.v.mul_add(h, apart),
            v: self.v + faster,
            distance: self.distance + self.rate.mul_add(h, self.side * absolute),
            rate: self.side.mul_add(gained, self.rate),
            ..*self
        }
    }

    /// The state a short time t later, by the Taylor series of displacement and velocity up to t⁴.
    #[inline(always)]
    pub fn shortly_after<const DRIVE: u8>(&self, structure: &Structure, t: f64) -> Self {
        let [absolute, relative] = structure.derivatives::<DRIVE>(self);
        let sixth = t * (1.0 / 6.0);
        let (half, fourth) = (t * 0.5, t * 0.25);
        let rise = |[a, jerk, snap, fifth, ..]: [f64; 6]| {
            let last = fourth.mul_add(fifth, snap) * sixth;
            t * half.mul_add(jerk, a) + (t * t) * last
        };
        let bend = |[a, jerk, snap, ..]: [f64; 6]| {
            (t * half) * (sixth * 2.0).mul_add(fourth.mul_add(snap, jerk), a)
        };
        let [apart, faster] = [bend(relative), rise(relative)];
        let moved = match DRIVE {
            BASE => self.moved([t, apart, faster], [bend(absolute), rise(absolute)]),
            _ => self.moved([t, apart, faster], [apart, faster]),
        };
        let mut next = moved;
        let turn = structure.frequency * t;
        let z = turn * turn;
        let less = z * (0.5 - z * (1.0 / 24.0));
        let sine = turn * (1.0 - z * (1.0 / 6.0 - z * (1.0 / 120.0)));
        next.force = self.force - (self.force * less + self.quadrature * sine);
        next.quadrature = self.quadrature + (self.force * sine - self.quadrature * less);
        next
    }
}
