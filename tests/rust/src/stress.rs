//! Extreme scenes, and the properties that every one of them must have.

pub mod scene;
pub mod watch;

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::{U, rng::Rng};
use iva_core::simulate::Outcome;
use scene::Scene;
use watch::Watch;

/// The results of a campaign.
#[derive(Debug, Default)]
pub struct Report {
    /// Number of scenes tried.
    pub scenes: u64,
    /// Number of checks, by name of the property.
    pub checks: BTreeMap<&'static str, u64>,
    /// Number of scenes with each outcome.
    pub outcomes: BTreeMap<&'static str, u64>,
    /// The first scenes that ended at `max_work`.
    pub work_limits: Vec<String>,
    /// The first failures.
    pub failures: Vec<String>,
    /// Number of failures.
    pub failed: u64,
    /// Largest error over the allowed one, by property.
    pub closest: BTreeMap<&'static str, f64>,
}

/// Time after which a scene counts as endless; no scene of a campaign takes a hundredth of it.
const ENDLESS: Duration = Duration::from_secs(300);
/// Number of failures and work limits that are kept as texts.
const KEPT: usize = 12;

impl Report {
    /// Counts a check; `share` is the error over the allowed one.
    pub fn check(&mut self, name: &'static str, count: u64, share: f64) {
        *self.checks.entry(name).or_default() += count;
        let closest = self.closest.entry(name).or_default();
        *closest = closest.max(share);
    }

    fn fail(&mut self, what: String) {
        self.failed += 1;
        if self.failures.len() < KEPT {
            self.failures.push(what);
        }
    }

    fn add(&mut self, other: Report) {
        self.scenes += other.scenes;
        for (name, count) in other.checks {
            self.check(name, count, other.closest[name]);
        }
        for (name, count) in other.outcomes {
            *self.outcomes.entry(name).or_default() += count;
        }
        self.failed += other.failed;
        self.failures.extend(other.failures);
        self.failures.truncate(KEPT);
        self.work_limits.extend(other.work_limits);
        self.work_limits.truncate(KEPT);
    }

    /// Prints the counts, and fails if a check failed.
    ///
    /// # Panics
    /// If a property did not hold.
    pub fn conclude(&self, title: &str) {
        println!("{title}: {} scenes tried, outcomes {:?}", self.scenes, self.outcomes);
        for (name, count) in &self.checks {
            println!(
                "  {count:>12} × {name} (at most {:.3} of what is allowed)",
                self.closest[name]
            );
        }
        for scene in &self.work_limits {
            println!("  work_limit: {scene}");
        }
        println!("  failures {}", self.failed);
        assert_eq!(self.failed, 0, "{:#?}", self.failures);
    }
}

/// Tries scenes `0..count` of a kind, each drawn with its own seed, on two threads.
pub fn campaign(count: u64, seed: u64, draw: impl Fn(&mut Rng) -> Scene + Sync) -> Report {
    let next = AtomicU64::new(0);
    let total = Mutex::new(Report::default());
    let working = [const { Mutex::new(None) }; 2];
    let work = &|now: &Mutex<Option<(Instant, Scene)>>| {
        let mut mine = Report::default();
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= count {
                break;
            }
            let scene = draw(&mut Rng::new((seed << 32) + number + 1));
            *now.lock().expect("no worker panicked") = Some((Instant::now(), scene.clone()));
            examine(&scene, &mut mine);
        }
        *now.lock().expect("no worker panicked") = None;
        total.lock().expect("no worker panicked").add(mine);
    };
    std::thread::scope(|scope| {
        let workers = working.each_ref().map(|now| scope.spawn(move || work(now)));
        // An endless scene would block the campaign without a message.
        while workers.iter().any(|worker| !worker.is_finished()) {
            std::thread::sleep(Duration::from_millis(20));
            for now in &working {
                if let Some((since, scene)) = &*now.lock().expect("no worker panicked")
                    && since.elapsed() > ENDLESS
                {
                    eprintln!("a scene does not end: {scene:?}");
                    std::process::exit(1);
                }
            }
        }
    });
    total.into_inner().expect("no worker panicked")
}

/// Checks all properties of one scene.
pub fn examine(scene: &Scene, report: &mut Report) {
    report.scenes += 1;
    if let Err(what) = examined(scene, report) {
        report.fail(format!("{what} — {scene:?}"));
    }
}

fn examined(scene: &Scene, report: &mut Report) -> Result<(), String> {
    let watch = scene.watch(1.0).map_err(|e| format!("refused: {e}"))?;
    let outcome = watch.outcome.ok_or("no end")?;
    *report.outcomes.entry(outcome.name()).or_default() += 1;
    if outcome == Outcome::WorkLimit && report.work_limits.len() < KEPT {
        report.work_limits.push(format!("at {:.3e}: {scene:?}", watch.end));
    }
    if outcome == Outcome::NotFinite {
        return Err("not_finite".to_owned());
    }
    watch.judge(report)?;
    // Rounding to nearest does not depend on the sign or on powers of two.
    for (name, factor) in [("mirror image", -1.0), ("lengths × 2¹¹", 2048.0)] {
        let other = scene.scaled(factor).watch(1.0 / factor).map_err(|e| format!("{name}: {e}"))?;
        report.check(name, 1, 0.0);
        if other.digest != watch.digest {
            return Err(format!("{name}: {:?} for {:?}", other.run_inline(), watch.run_inline()));
        }
    }
    restart(scene, &watch, report)
}

/// Checks that a run restarted in the flight before one of its impacts finds this impact.
fn restart(scene: &Scene, watch: &Watch, report: &mut Report) -> Result<(), String> {
    let count = watch.first.len();
    if count < 2 || scene.harmonic.is_some() {
        return Ok(());
    }
    let [before, impact] = [watch.first[count / 2 - 1], watch.first[count / 2]];
    let time = 0.5 * (before.time + impact.time);
    if !(before.time < time && time < impact.time) {
        return Ok(());
    }
    let states = scene.states(&[time]).map_err(|e| e.to_string())?;
    let Some(state) = states.first().filter(|state| state.wall == 0) else { return Ok(()) };
    let rest = impact.time - time;
    let Some(again) = scene.again(state, 4.0 * rest + 1e-60) else { return Ok(()) };
    let watch = again.watch(1.0).map_err(|e| format!("restart refused: {e}"))?;
    let p = &scene.parameters;
    // The state is rounded to doubles, which changes the gap by some U of the motion at the contact.
    let speed = state.velocity.abs() + state.displacement.abs() + state.gap_velocity.abs();
    let growth = (1.0 + rest * (1.0 + p.frequency_ratio)).powi(2);
    let moved = 64.0 * U * (p.clearance + speed * rest.min(1.0) * growth);
    let w = impact.gap_velocity_before.abs();
    let pull = (speed + p.frequency_ratio.powi(2) * p.clearance) * (1.0 + p.damping_ratio);
    if w * w < 1e4 * pull * moved || w < 1e-6 * speed {
        return Ok(()); // a grazing: the impact may not exist
    }
    let allowed = moved / w + 8.0 * U * impact.time;
    match watch.first.first() {
        Some(found) if found.wall == impact.wall => {
            let off = (found.time + time - impact.time).abs();
            report.check("restart", 1, off / allowed);
            if off <= allowed {
                return Ok(());
            }
            Err(format!("restart at {time:e}: off by {off:e}, allowed {allowed:e}, {impact:?}"))
        }
        // An extremum before the impact that may just hit or just miss a wall.
        Some(found) if found.gap_velocity_before.powi(2) < 1e4 * pull * moved => Ok(()),
        found => Err(format!("restart at {time:e}: {found:?} for {impact:?}")),
    }
}
