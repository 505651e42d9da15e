//! Watches a run of any length in bounded memory: impact law, energy ledger, walls, and a digest of all its
//! numbers.

use super::Report;
use crate::{U, dd::Dd};
use iva_core::{
    absorber::Absorber,
    flight::{Losses, Motion},
    impact::Impact,
    observe::{Observer, Span, StickEpisode},
    piva::{Angles, Parameters},
    simulate::{Instant, Outcome, Tally},
};

/// Number of impacts that are kept.
const KEPT: usize = 64;

/// Largest error over the allowed one, and the number of checks.
#[derive(Debug, Clone, Copy, Default)]
struct Worst {
    count: u64,
    share: f64,
    at: f64,
}

impl Worst {
    fn see(&mut self, error: f64, allowed: f64, at: f64) {
        self.count += 1;
        // NaN counts as too large.
        let share = if error == 0.0 { 0.0 } else { error / allowed };
        if share.is_nan() || share > self.share {
            (self.share, self.at) = (if share.is_nan() { f64::INFINITY } else { share }, at);
        }
    }
}

/// Observations of a run.
#[derive(Debug, Clone)]
pub struct Watch {
    parameters: Parameters,
    factor: f64,
    /// A hash of all numbers of the run: equal runs have equal hashes.
    pub digest: u64,
    /// The first impacts.
    pub first: Vec<Impact>,
    /// The outcome of the run.
    pub outcome: Option<Outcome>,
    /// The instant at which it ended.
    pub end: f64,
    impacts: u64,
    episodes: u64,
    undecided: u64,
    restitution: Worst,
    momentum: Worst,
    loss: Worst,
    walls: Worst,
    energy: [f64; 2],
    lost: Dd,
    worked: Dd,
    turned_over: f64,
    residual: f64,
    impact_losses: f64,
    finite: bool,
}

impl Watch {
    /// An observer for a run; lengths enter the digest times `factor`.
    pub fn new(parameters: &Parameters, factor: f64) -> Self {
        Self {
            parameters: *parameters,
            factor,
            digest: 0xcbf2_9ce4_8422_2325,
            first: Vec::new(),
            outcome: None,
            end: 0.0,
            impacts: 0,
            episodes: 0,
            undecided: 0,
            restitution: Worst::default(),
            momentum: Worst::default(),
            loss: Worst::default(),
            walls: Worst::default(),
            energy: [0.0; 2],
            lost: Dd::ZERO,
            worked: Dd::ZERO,
            turned_over: 0.0,
            residual: 0.0,
            impact_losses: 0.0,
            finite: true,
        }
    }

    fn digest(&mut self, value: f64) {
        self.finite &= value.is_finite();
        // Adding 0 makes −0 equal to 0.
        self.digest = (self.digest ^ (value + 0.0).to_bits()).wrapping_mul(0x0100_0000_01b3);
        self.digest ^= self.digest >> 29;
    }

    /// A short summary of the run.
    pub fn run_inline(&self) -> (Option<Outcome>, u64, u64, u64, f64, Option<Impact>) {
        let Self { outcome, impacts, episodes, undecided, end, .. } = *self;
        (outcome, impacts, episodes, undecided, end, self.first.last().copied())
    }

    /// Checks all observations; the ledger must close to 1e-12 of the energy exchanged.
    ///
    /// # Errors
    /// The first property that does not hold.
    pub fn judge(&self, report: &mut Report) -> Result<(), String> {
        if !self.finite {
            return Err("a number that is none".to_owned());
        }
        let mut ledger = Worst::default();
        ledger.see(self.residual.abs(), 1e-12 * self.turned_over, self.end);
        for (name, worst) in [
            ("restitution", self.restitution),
            ("momentum", self.momentum),
            ("energy loss", self.loss),
            ("between the walls", self.walls),
            ("ledger", ledger),
        ] {
            report.check(name, worst.count, worst.share);
            if worst.share > 1.0 {
                return Err(format!(
                    "{name}: {:.3e} of what is allowed at {:e}",
                    worst.share, worst.at
                ));
            }
        }
        Ok(())
    }
}

impl<S: Absorber<Real = f64>> Observer<S> for Watch {
    fn start(&mut self, system: &S, Instant { state, .. }: &Instant<S::State>, _duration: f64) {
        self.energy[0] = system.energy(state);
    }

    fn span<M: Motion<Real = f64, State = S::State>>(&mut self, system: &S, span: &Span<'_, M>) {
        let length = span.length;
        self.digest(length);
        for value in [span.to.x, span.to.v] {
            self.digest(value * self.factor);
        }
        let Losses { viscous, pivot, work } = span.motion.losses(length);
        let lost = viscous + pivot;
        self.finite &= work.is_finite() && lost >= 0.0;
        self.lost = self.lost + lost;
        self.worked = self.worked + work;
        self.turned_over += work.abs();
        let d = self.parameters.clearance;
        for share in [1e-9, 0.5, 1.0 - 1e-9] {
            let h = share * length;
            let distance = system.distance(&span.motion.state(h));
            let beyond = (-distance.value).max(distance.value - 2.0 * d);
            self.finite &= distance.value.is_finite() && distance.rate.is_finite();
            // The instant of a contact is rounded to a double, in which the distance changes at its rate. An
            // extremum within 16 U d counts as no contact, and is evaluated with a similar error.
            let allowed = 32.0 * U * d + f64::EPSILON * h * distance.rate.abs();
            self.walls.see(beyond.max(0.0), allowed, span.start.value + h);
        }
    }

    fn impact(&mut self, _system: &S, impact: &Impact) {
        if self.first.len() < KEPT {
            self.first.push(*impact);
        }
        let Parameters { mass_ratio: mu, restitution: e, inertia_ratio, .. } = self.parameters;
        let [v0, v1] = [impact.velocity_before, impact.velocity_after];
        let [w0, w1] = [impact.gap_velocity_before, impact.gap_velocity_after];
        let approaching = impact.wall.sign() * w0 > 0.0;
        let off = if approaching { (w1 + e * w0).abs() } else { f64::INFINITY };
        self.restitution.see(off, 8.0 * U * w1.abs() + f64::MIN_POSITIVE, impact.time);
        // (1 + μ) ẋ + μ λ w in double-double, so that only the roundings of the velocities matter.
        let lever = mu * impact.lever;
        let momentum = |v: f64, w: f64| (Dd::from(mu) + 1.0) * v + Dd::from(mu) * impact.lever * w;
        let change = (momentum(v1, w1) - momentum(v0, w0)).abs().hi;
        let allowed = (1.0 + mu) * (16.0 * (v1 - v0).abs() + v0.abs() + v1.abs())
            + 4.0 * lever * (w0.abs() + w1.abs());
        self.momentum.see(change, U * allowed + f64::MIN_POSITIVE, impact.time);
        // ½ μ (1 − e²)(λ w)² [κ/c² − μ/(1 + μ)], c = cosθ at the wall
        let cosine_squared = self.wall_cosine_squared();
        let scale = 0.5 * mu * (impact.lever * w0).powi(2);
        let bracket = inertia_ratio / cosine_squared - mu / (1.0 + mu);
        let loss = scale * (1.0 - e) * (1.0 + e) * bracket;
        let allowed = scale * (1.0 + inertia_ratio / cosine_squared) / cosine_squared;
        self.loss.see((impact.energy_loss - loss).abs(), 64.0 * U * allowed, impact.time);
        self.digest(impact.time);
        self.digest(impact.wall.sign() * self.factor.signum());
        for value in [impact.displacement, v0, v1, w0, w1] {
            self.digest(value * self.factor);
        }
        self.digest(impact.energy_loss * self.factor * self.factor);
    }

    fn episode(&mut self, episode: &StickEpisode) {
        self.digest(episode.start_time);
        self.digest(episode.stick_time);
        self.digest(episode.release_time.unwrap_or(-1.0));
        self.digest(episode.energy_loss * self.factor * self.factor);
    }

    fn end(&mut self, system: &S, tally: &Tally<S::State>) {
        self.energy[1] = system.energy(&tally.state);
        self.impact_losses = tally.energy_impacts;
        let [initial, last] = self.energy;
        self.turned_over = self.turned_over.max(initial).max(last);
        let balance = Dd::from(initial) + self.worked - self.lost - tally.energy_impacts - last;
        self.residual = balance.hi;
        self.outcome = Some(tally.outcome);
        self.end = tally.end_time;
        (self.impacts, self.episodes) = (tally.impacts, tally.episodes);
        self.undecided = tally.undecided;
        for count in [tally.impacts, tally.effective_impacts, tally.episodes, tally.undecided] {
            self.digest(count as f64);
        }
        self.digest(tally.time_stuck);
        self.digest(tally.end_time);
        for energy in [last, tally.energy_impacts] {
            self.digest(energy * self.factor * self.factor);
        }
    }
}

impl Watch {
    fn wall_cosine_squared(&self) -> f64 {
        let Parameters { clearance, contact_distance, angles, .. } = self.parameters;
        if angles == Angles::Small {
            return 1.0;
        }
        let sine = clearance / contact_distance;
        (1.0 - sine) * (1.0 + sine)
    }
}
