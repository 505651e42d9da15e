//! What drives a scene from outside: harmonic and recorded forces on the primary, motion of the base,
//! impulses (paper, f(t) of Eqs. 1 and 3).
//!
//! With x and the gap relative to the base, a_g the acceleration of the base and A = ẍ + a_g the
//! absolute acceleration of the primary, every equation of the free scene holds with A in place of
//! ẍ, the force f/M added on the right, and u̇ = A − a_g: the free absorber feels A, not ẍ. So base
//! motion is not the same as f/M = −a_g.
//!
//! A force is given to a flight as the Taylor coefficients of its time, exact but for rounding. The
//! phase of a harmonic is reduced to twice the precision, so that it does not drift in long runs. Of a
//! record each straight piece is a linear force of its own: steps end where it bends.
//!
//! An impulse is an event ([`Force::due`]): it changes velocities and nothing else. Where a record
//! jumps, at an end that is not 0, there is an impulse of 0, so that what rides on a wall is judged
//! anew.

use crate::compensated::DoubleDouble;
use crate::error::Invalid;
use crate::range;
use crate::real::Real;
use crate::sample::SLACK;
use crate::taylor::{ORDER, unrolled};

pub use harmonic::Harmonic;
pub use record::{History, Record};

mod harmonic;
mod record;

/// Where a force acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Acts {
    /// On the primary: values are f/M.
    Primary,
    /// On all masses, through the base: values are a_g.
    Base,
}

/// An impulse P on the primary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impulse<R = f64> {
    /// P/M.
    pub velocity: R,
    /// Instant, in 1/ωn.
    pub time: R,
}

/// A sum of forces; the empty one is free decay.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Force<R = f64> {
    harmonics: Vec<Harmonic<R>>,
    records: Vec<Record<R>>,
    kicks: Vec<Kick<R>>,
}

/// An impulse, or a jump of a record (then of velocity 0).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Kick<R = f64> {
    time: DoubleDouble<R>,
    velocity: R,
}

/// Taylor coefficients of f/M and a_g over a step.
#[derive(Debug, Clone, Copy)]
pub struct Drive<T, const LENGTH: usize = { ORDER + 1 }> {
    /// Of f/M.
    pub primary: [T; LENGTH],
    /// Of a_g.
    pub base: [T; LENGTH],
}

/// A drive at one instant, with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Push<R = f64> {
    /// f/M or a_g.
    pub value: DoubleDouble<R>,
    /// Its derivative.
    pub rate: DoubleDouble<R>,
    /// Its second derivative.
    pub second: DoubleDouble<R>,
    /// Its third derivative.
    pub third: R,
}

/// All that drives a structure at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pushes<R = f64> {
    /// f/M.
    pub primary: Push<R>,
    /// a_g.
    pub base: Push<R>,
}

impl<R: Real> Push<R> {
    /// Nothing.
    pub const NONE: Push<R> = Push {
        value: DoubleDouble::ZERO,
        rate: DoubleDouble::ZERO,
        second: DoubleDouble::ZERO,
        third: R::ZERO,
    };

    /// Its first two coefficients in powers of time.
    #[inline(always)]
    pub(crate) fn beginning(&self) -> [DoubleDouble<R>; 2] {
        [self.value, self.rate]
    }

    #[inline(always)]
    fn add(&mut self, other: &Push<R>) {
        self.value = self.value + other.value;
        self.rate = self.rate + other.rate;
        self.second = self.second + other.second;
        self.third += other.third;
    }
}

impl<R: Real> Force<R> {
    /// A sum of forces.
    ///
    /// # Errors
    /// [`Invalid`] naming the first number out of [`crate::range`].
    pub fn new(
        harmonics: Vec<Harmonic<R>>,
        records: Vec<Record<R>>,
        impulses: &[Impulse<R>],
    ) -> Result<Self, Invalid> {
        harmonics.iter().try_for_each(Harmonic::check)?;
        records.iter().try_for_each(Record::check)?;
        let jumps = records.iter().flat_map(Record::jumps).filter(|time| time.value > 0.0);
        let mut kicks: Vec<Kick<R>> = jumps.map(|time| Kick { time, velocity: R::ZERO }).collect();
        for Impulse { velocity, time } in impulses {
            range::size("force.velocity", *velocity)?;
            if *time != 0.0 {
                range::positive("force.time", *time)?;
            }
            if *velocity != 0.0 {
                kicks.push(Kick { time: DoubleDouble::new(*time), velocity: *velocity });
            }
        }
        kicks.sort_by(|a, b| (a.time - b.time).value.total_cmp(&R::ZERO));
        Ok(Self { harmonics, records, kicks })
    }

    /// A sum of harmonic forces.
    ///
    /// # Errors
    /// As [`Force::new`].
    pub fn harmonic(harmonics: Vec<Harmonic<R>>) -> Result<Self, Invalid> {
        Self::new(harmonics, Vec::new(), &[])
    }

    /// Its harmonic parts.
    pub fn harmonics(&self) -> &[Harmonic<R>] {
        &self.harmonics
    }

    /// Its recorded parts.
    pub fn records(&self) -> &[Record<R>] {
        &self.records
    }

    /// Its impulses, in the order of time.
    pub fn impulses(&self) -> impl Iterator<Item = Impulse<R>> + '_ {
        let impulse = |kick: &Kick<R>| Impulse { velocity: kick.velocity, time: kick.time.value };
        self.kicks.iter().filter(|kick| kick.velocity != 0.0).map(impulse)
    }

    /// True if nothing acts.
    pub fn is_none(&self) -> bool {
        !self.lasts() && self.kicks.is_empty()
    }

    /// True if it is one harmonic force and nothing else.
    pub fn is_single(&self) -> bool {
        self.harmonics.len() == 1 && self.records.is_empty() && self.kicks.is_empty()
    }

    /// True if something acts all the time, not only in impulses.
    pub fn lasts(&self) -> bool {
        !(self.harmonics.is_empty() && self.records.is_empty())
    }

    /// True if the base moves.
    pub fn moves_base(&self) -> bool {
        self.harmonics.iter().any(|harmonic| harmonic.acts == Acts::Base)
            || self.records.iter().any(|record| record.acts == Acts::Base)
    }

    /// Largest |a_g| from one instant to another, if it is one harmonic motion of the base.
    pub fn largest_base(&self, between: [R; 2]) -> Option<R> {
        let harmonic = self.harmonics.first().filter(|it| it.acts == Acts::Base)?;
        self.is_single().then(|| harmonic.largest_between(between))
    }

    /// The highest frequency in it, 0 without any: a straight line has none.
    pub fn fastest(&self) -> R {
        self.harmonics.iter().fold(R::ZERO, |most, harmonic| most.max(harmonic.frequency))
    }

    /// Coefficients of powers of t/h at `time`, of the smooth force that acts from `from` on.
    #[inline(always)]
    pub fn drive<const LENGTH: usize>(
        &self,
        from: DoubleDouble<R>,
        time: DoubleDouble<R>,
        h: R,
    ) -> Drive<R, LENGTH> {
        let mut drive = Drive::NONE;
        for harmonic in &self.harmonics {
            harmonic.add(drive.row(harmonic.acts), time, h);
        }
        for record in &self.records {
            let [value, slope] = record.piece(from).at(time);
            let row = drive.row(record.acts);
            for (coefficient, line) in row.iter_mut().zip([value.value, slope.value * h]) {
                *coefficient += line;
            }
        }
        drive
    }

    /// f/M and a_g at `time`, of the smooth force that acts from `from` on.
    #[inline(always)]
    pub fn pushes(&self, from: DoubleDouble<R>, time: DoubleDouble<R>) -> Pushes<R> {
        let mut pushes = Pushes::NONE;
        for harmonic in &self.harmonics {
            pushes.on(harmonic.acts).add(&harmonic.push(time));
        }
        for record in &self.records {
            let [value, rate] = record.piece(from).at(time);
            pushes.on(record.acts).add(&Push { value, rate, ..Push::NONE });
        }
        pushes
    }

    /// The largest size that the derivatives of this order of f/M and a_g have where they are smooth.
    pub fn largest(&self, order: i32) -> [R; 2] {
        [Acts::Primary, Acts::Base].map(|acts| {
            let harmonics = self.harmonics.iter().filter(|harmonic| harmonic.acts == acts);
            let records = self.records.iter().filter(|record| record.acts == acts);
            harmonics.map(|harmonic| harmonic.largest(order)).sum::<R>()
                + records.map(|record| record.largest(order)).sum::<R>()
        })
    }

    /// How far a motion goes that reaches so far: not beyond the next instant at which the force bends, jumps or
    /// kicks, and then that instant.
    pub fn until_bend(
        &self,
        time: DoubleDouble<R>,
        done: u32,
        reach: R,
    ) -> (R, Option<DoubleDouble<R>>) {
        let until = |bend: DoubleDouble<R>| (bend - time).value;
        match self.smooth_until(time, done).filter(|bend| until(*bend) <= reach) {
            Some(bend) => (until(bend), Some(bend)),
            None => (reach, None),
        }
    }

    /// The first two coefficients of powers of t at an instant, to twice the precision.
    #[inline(always)]
    pub(crate) fn beginning(&self, time: DoubleDouble<R>) -> Drive<DoubleDouble<R>, 2> {
        let Pushes { primary, base } = self.pushes(time, time);
        Drive { primary: primary.beginning(), base: base.beginning() }
    }

    /// Coefficients of powers of t/h at `from`, to twice the precision.
    pub fn precise<const LENGTH: usize>(
        &self,
        from: DoubleDouble<R>,
        h: R,
    ) -> Drive<DoubleDouble<R>, LENGTH> {
        let mut drive = Drive::NOTHING;
        for harmonic in &self.harmonics {
            harmonic.add_precise(drive.row(harmonic.acts), from, h);
        }
        for record in &self.records {
            let [value, slope] = record.piece(from).at(from);
            let row = drive.row(record.acts);
            for (coefficient, line) in row.iter_mut().zip([value, slope.times(h)]) {
                *coefficient = *coefficient + line;
            }
        }
        drive
    }

    /// Bounds |F_k| ≤ F̂ qᵏ/(k+1) on the coefficients of f/M and of a_g for every k ≥ N ≥ 2, of powers of t/h; ∞ if this
    /// q is too small. A straight line has no such coefficients.
    #[inline(always)]
    pub fn tail<const N: usize>(&self, h: R, ratio: R) -> [R; 2] {
        let mut tail = [R::ZERO; 2];
        for harmonic in &self.harmonics {
            tail[usize::from(harmonic.acts == Acts::Base)] += harmonic.tail::<N>(h, ratio);
        }
        tail
    }

    /// The next instant at which it is not smooth, once the first `done` kicks are over.
    pub fn smooth_until(&self, time: DoubleDouble<R>, done: u32) -> Option<DoubleDouble<R>> {
        let kick = self.kicks.get(done as usize).map(|kick| kick.time);
        let bends = self.records.iter().filter_map(|record| record.next_knot(time));
        bends.chain(kick).min_by(|a, b| (*a - *b).value.total_cmp(&R::ZERO))
    }

    /// How many kicks are over where a run begins at an instant: all up to then, but for those of time zero in a run
    /// from time zero.
    pub(crate) fn kicks_before(&self, time: DoubleDouble<R>) -> u32 {
        let slack = time.value * SLACK;
        let over = |kick: &&Kick<R>| kick.time.minus(time.value) < slack;
        self.kicks.iter().take_while(over).count() as u32
    }

    /// P/M of the kick that is due, once the first `done` are over.
    pub fn due(&self, time: DoubleDouble<R>, done: u32) -> Option<R> {
        let next = self.kicks.get(done as usize)?;
        ((next.time - time).value <= 0.0).then_some(next.velocity)
    }
}

impl<R: Real> Pushes<R> {
    /// Nothing.
    pub(crate) const NONE: Self = Self { primary: Push::NONE, base: Push::NONE };

    #[inline(always)]
    fn on(&mut self, acts: Acts) -> &mut Push<R> {
        match acts {
            Acts::Primary => &mut self.primary,
            Acts::Base => &mut self.base,
        }
    }
}

impl<R: Real, const LENGTH: usize> Drive<DoubleDouble<R>, LENGTH> {
    /// No force, to twice the precision.
    pub(crate) const NOTHING: Self =
        Self { primary: [DoubleDouble::ZERO; LENGTH], base: [DoubleDouble::ZERO; LENGTH] };
}

impl<R: Real, const LENGTH: usize> Drive<R, LENGTH> {
    /// No force.
    pub(crate) const NONE: Self = Self { primary: [R::ZERO; LENGTH], base: [R::ZERO; LENGTH] };

    /// Neither |f/M| nor |a_g| exceeds it within the step.
    #[inline(always)]
    pub fn size(&self) -> R {
        let mut size = R::ZERO;
        unrolled!(k < ORDER + 1 => if k < LENGTH {
            size += self.primary[k].abs() + self.base[k].abs();
        });
        size
    }
}

impl<T, const LENGTH: usize> Drive<T, LENGTH> {
    fn row(&mut self, acts: Acts) -> &mut [T; LENGTH] {
        match acts {
            Acts::Primary => &mut self.primary,
            Acts::Base => &mut self.base,
        }
    }
}
