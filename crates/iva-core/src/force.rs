//! The excitation of a scene: harmonic and recorded forces on the primary, motion of the base, impulses
//! (paper, f(t) of Eqs. 1 and 3).
//!
//! With x and the gap relative to the base, a_g the acceleration of the base and A = ẍ + a_g the absolute
//! acceleration of the primary, the equations without drive hold with A in place of ẍ and f/M added on the right;
//! then ẍ = A − a_g. The free absorber feels A, not ẍ, so base motion is not the same as f/M = −a_g.
//!
//! A motion takes the force as Taylor coefficients about an instant, exact but for rounding. The phase of a
//! harmonic is reduced to one turn in double-double, so that it does not drift in long runs. A record is
//! piecewise linear: each piece is a linear force of its own, and steps end where two pieces meet.
//!
//! An impulse is an event ([`Force::due`]) that changes velocities only. Where a record jumps, at an end
//! whose value is not 0, an impulse of size 0 is placed, so that the test for sticking is made anew there.

use crate::error::Invalid;
use crate::number::clock::SLACK;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;

pub use drive::{Drive, Push, Pushes, Smooth};
pub use harmonic::Harmonic;
pub use record::{History, Record};

mod drive;
mod harmonic;
mod record;

/// The body that a force acts on.
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
    /// The instant, in 1/ωn.
    pub time: R,
}

/// A sum of forces; the empty one is free decay.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Force<R = f64> {
    harmonics: Vec<Harmonic<R>>,
    records: Vec<Record<R>>,
    kicks: Vec<Kick<R>>,
    elsewhere: Vec<(usize, Harmonic<R>)>,
}

/// An event of the force: an impulse, or a jump of a record (with velocity 0).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Kick<R = f64> {
    time: DoubleDouble<R>,
    velocity: R,
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
        Ok(Self { harmonics, records, kicks, elsewhere: vec![] })
    }

    /// The same force, with harmonic parts at other points of a structure than that on which it acts itself: each with the index of its
    /// point. Only [`crate::absorber::modal`] has points.
    ///
    /// # Errors
    /// As [`Force::new`].
    pub fn with_elsewhere(mut self, elsewhere: Vec<(usize, Harmonic<R>)>) -> Result<Self, Invalid> {
        elsewhere.iter().try_for_each(|(_, harmonic)| harmonic.check())?;
        self.elsewhere = elsewhere;
        Ok(self)
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

    /// Its harmonic parts at other points, each with the index of its point.
    pub fn elsewhere(&self) -> &[(usize, Harmonic<R>)] {
        &self.elsewhere
    }

    /// The first of its harmonic parts, wherever it acts.
    pub fn first_harmonic(&self) -> Option<&Harmonic<R>> {
        self.harmonics.iter().chain(self.elsewhere.iter().map(|(_, it)| it)).next()
    }

    /// Its recorded parts.
    pub fn records(&self) -> &[Record<R>] {
        &self.records
    }

    /// Its impulses, in order of time.
    pub fn impulses(&self) -> impl Iterator<Item = Impulse<R>> + '_ {
        let impulse = |kick: &Kick<R>| Impulse { velocity: kick.velocity, time: kick.time.value };
        self.kicks.iter().filter(|kick| kick.velocity != 0.0).map(impulse)
    }

    /// True if there is no force at all.
    pub fn is_none(&self) -> bool {
        !self.lasts() && self.kicks.is_empty()
    }

    /// True if it consists of one harmonic force only.
    pub fn is_single(&self) -> bool {
        let others = self.records.is_empty() && self.kicks.is_empty() && self.elsewhere.is_empty();
        self.harmonics.len() == 1 && others
    }

    /// The number of its impulses and jumps.
    pub(crate) fn kicks(&self) -> u32 {
        self.kicks.len() as u32
    }

    /// The record, if it consists of one record only. (Its jumps are at its ends.)
    pub(crate) fn record_alone(&self) -> Option<&Record<R>> {
        let alone = self.first_harmonic().is_none() && self.impulses().next().is_none();
        if let [record] = self.records.as_slice() { alone.then_some(record) } else { None }
    }

    /// True if it has harmonic or recorded parts, not impulses only.
    pub fn lasts(&self) -> bool {
        self.first_harmonic().is_some() || !self.records.is_empty()
    }

    /// True if the base moves.
    pub fn moves_base(&self) -> bool {
        self.harmonics.iter().any(|harmonic| harmonic.acts == Acts::Base)
            || self.records.iter().any(|record| record.acts == Acts::Base)
    }

    /// Largest |a_g| between two instants, if the force is one harmonic or recorded motion of the base.
    pub fn largest_base(&self, between: [R; 2]) -> Option<R> {
        if let Some(record) = self.record_alone().filter(|it| it.acts == Acts::Base) {
            return Some(record.largest_between(between));
        }
        let harmonic = self.harmonics.first().filter(|it| it.acts == Acts::Base)?;
        self.is_single().then(|| harmonic.largest_between(between))
    }

    /// The highest frequency of its harmonic parts in ωn, 0 without any.
    pub fn fastest(&self) -> R {
        let all = self.harmonics.iter().chain(self.elsewhere.iter().map(|(_, it)| it));
        all.fold(R::ZERO, |most, harmonic| most.max(harmonic.frequency))
    }

    /// Taylor coefficients of f/M and a_g about `time`, in powers of t/h.
    #[inline(always)]
    pub fn drive<const LENGTH: usize>(&self, time: DoubleDouble<R>, h: R) -> Drive<R, LENGTH> {
        let mut drive = Drive::NONE;
        for harmonic in &self.harmonics {
            harmonic.add(drive.row(harmonic.acts), time, h);
        }
        for record in &self.records {
            let [value, slope] = record.piece(time).at(time);
            let row = drive.row(record.acts);
            for (coefficient, line) in row.iter_mut().zip([value.value, slope.value * h]) {
                *coefficient += line;
            }
        }
        drive
    }

    /// The smooth piece that acts from `time` on, when the first `done` kicks have acted, and f/M and a_g at its begin.
    /// The first record is looked up near the piece of an earlier instant.
    #[inline(always)]
    pub fn smooth(
        &self,
        time: DoubleDouble<R>,
        done: u32,
        near: &Smooth<R>,
    ) -> (Smooth<R>, Pushes<R>) {
        let mut pushes = self.harmonic_pushes(time);
        let mut smooth = Smooth { end: self.kick(done), passed: 0 };
        for (number, record) in self.records.iter().enumerate() {
            let passed = match number {
                0 => record.passed_near(near.passed as usize, time),
                _ => record.passed(time),
            };
            if number == 0 {
                smooth.passed = passed as u32;
            }
            pushes.on(record.acts).add(&record.piece_after(passed).push(time));
            smooth.end = smooth.end.into_iter().chain(record.knot_after(passed)).min_by(earlier);
        }
        (smooth, pushes)
    }

    /// f/M and a_g at `time`, from those at an earlier instant of the same smooth piece.
    #[inline(always)]
    pub fn later(
        &self,
        from: DoubleDouble<R>,
        pushes: &Pushes<R>,
        time: DoubleDouble<R>,
    ) -> Pushes<R> {
        if self.records.is_empty() {
            return self.harmonic_pushes(time);
        }
        if !self.harmonics.is_empty() {
            return self.pushes(from, time);
        }
        let by = time - from;
        Pushes { primary: pushes.primary.later(by), base: pushes.base.later(by) }
    }

    #[inline(always)]
    fn harmonic_pushes(&self, time: DoubleDouble<R>) -> Pushes<R> {
        let mut pushes = Pushes::NONE;
        for harmonic in &self.harmonics {
            pushes.on(harmonic.acts).add(&harmonic.push(time));
        }
        pushes
    }

    /// f/M and a_g with their derivatives at `time`, of the smooth piece that acts from `from` on.
    #[inline(always)]
    pub fn pushes(&self, from: DoubleDouble<R>, time: DoubleDouble<R>) -> Pushes<R> {
        let mut pushes = self.harmonic_pushes(time);
        for record in &self.records {
            pushes.on(record.acts).add(&record.piece(from).push(time));
        }
        pushes
    }

    /// Bounds on the derivative of this order of f/M and of a_g, within smooth pieces.
    pub fn largest(&self, order: i32) -> [R; 2] {
        [Acts::Primary, Acts::Base].map(|acts| {
            let harmonics = self.harmonics.iter().filter(|harmonic| harmonic.acts == acts);
            let records = self.records.iter().filter(|record| record.acts == acts);
            harmonics.map(|harmonic| harmonic.largest(order)).sum::<R>()
                + records.map(|record| record.largest(order)).sum::<R>()
        })
    }

    /// Taylor coefficients of f/M and a_g about `from` in powers of t/h, in double-double.
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

    /// Bounds Σ_{k≥N} |F_k| for the coefficients F_k of (t/h)ᵏ of f/M and of a_g, N ≥ 2; ∞ where h is too long for the
    /// bound. A piece of a record is linear and has no such coefficients.
    #[inline(always)]
    pub fn left_out<const N: usize>(&self, h: R) -> [R; 2] {
        let mut left_out = [R::ZERO; 2];
        for harmonic in &self.harmonics {
            left_out[usize::from(harmonic.acts == Acts::Base)] += harmonic.left_out::<N>(h);
        }
        left_out
    }

    /// The instant of the next kick, when the first `done` have acted.
    #[inline(always)]
    fn kick(&self, done: u32) -> Option<DoubleDouble<R>> {
        self.kicks.get(done as usize).map(|kick| kick.time)
    }

    /// The instant at which the force is read where a run begins at `time`, and the number of kicks that have
    /// acted by then.
    ///
    /// The begin of a run and the points of a record are converted to natural time one by one and may differ
    /// by a rounding where the user gave the same number. So the last bend, jump or impulse up to a rounding
    /// after `time` counts as reached, for the value of the force as for its kicks. A run from time zero
    /// still has the kicks of time zero before it.
    pub(crate) fn begin(&self, time: DoubleDouble<R>) -> (DoubleDouble<R>, u32) {
        let slack = time.value * SLACK;
        let over = |kick: &&Kick<R>| (kick.time - time).value < slack;
        let kicks = self.kicks.iter().take_while(over).count();
        let kick = kicks.checked_sub(1).map(|last| self.kicks[last].time);
        let knots = self.records.iter().filter_map(|record| record.last_knot(time.plus(slack)));
        let later = |a: DoubleDouble<R>, b: DoubleDouble<R>| {
            if (b - a).value > R::ZERO { b } else { a }
        };
        (knots.chain(kick).fold(time, later), kicks as u32)
    }

    /// P/M of the kick that is due at `time`, when the first `done` have acted.
    pub fn due(&self, time: DoubleDouble<R>, done: u32) -> Option<R> {
        let next = self.kicks.get(done as usize)?;
        ((next.time - time).value <= 0.0).then_some(next.velocity)
    }
}

/// The order of two instants.
fn earlier<R: Real>(a: &DoubleDouble<R>, b: &DoubleDouble<R>) -> std::cmp::Ordering {
    (*a - *b).value.total_cmp(&R::ZERO)
}
