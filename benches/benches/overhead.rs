//! The overhead of a sweep: the time of a summary sweep on one thread over that of the same runs in the core.
//!
//! `cargo bench -p iva-benches --bench overhead [-- POINTS]`, 100 000 points by default. The sweep includes
//! grid, checks, measures and Arrow tables, the core runs and measures only. They are timed in turn; the
//! ratio is the median over the rounds.

use std::hint::black_box;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use iva_core::error::Invalid;
use iva_core::measures::Wanted;
use iva_core::run::side_by_side::{self, Job, Tier};
use iva_core::siva::Siva;
use iva_sweep::axis::Axis;
use iva_sweep::design::Spec;
use iva_sweep::fields::FieldId;
use iva_sweep::sampling::Sampling;
use iva_sweep::scene::{Mounted, Scene};
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::{Control, SweepError, Workers, sweep};

const ROUNDS: usize = 7;
/// Number of points that a worker of a sweep takes at once.
const CHUNK: usize = 256;

/// 30 periods over mass ratio, clearance and restitution, `side`³ points.
fn study(side: u64) -> Result<Study, Invalid> {
    let mut spec = Spec::default();
    for (field, value) in
        [(FieldId::DampingRatio, 0.01), (FieldId::Displacement, 1.0), (FieldId::Periods, 30.0)]
    {
        spec.set(field, value)?;
    }
    let axes = vec![
        Axis::linspace("mass_ratio", 0.02, 0.2, side)?,
        Axis::linspace("relative_clearance", 0.4, 1.3, side)?,
        Axis::linspace("restitution", 0.4, 0.85, side)?,
    ];
    Ok(Study {
        sampling: Sampling::Grid(axes),
        tables: vec![Table::Summary],
        ..Study::single(spec)
    })
}

fn scenes(study: &Study) -> Result<Vec<Job<Siva>>, Invalid> {
    let mut scenes = Vec::new();
    for point in 0..study.points()? {
        let design = study.design(point)?;
        if let Scene::Siva(Mounted { system, start, .. }) = design.scene {
            scenes.push(Job {
                begin: 0.0,
                system,
                start,
                limits: design.limits,
                steady: None,
                tier: Tier::Exact,
            });
        }
    }
    Ok(scenes)
}

fn main() -> Result<(), SweepError> {
    let asked = std::env::args().skip(1).find_map(|word| word.parse::<f64>().ok());
    let side = asked.unwrap_or(1e5).cbrt().round() as u64;
    let study = study(side)?;
    let points = study.points()?;
    let (workers, never) = (Workers::new(Some(1))?, AtomicBool::new(false));
    let control = Control { workers: &workers, chunk: None, cancel: &never, progress: &|_| {} };
    let mut ratios = Vec::new();
    for _ in 0..ROUNDS {
        // Made anew in each round: tables that the first run computes and keeps count as part of the runs.
        let scenes = scenes(&study)?;
        let begin = Instant::now();
        for chunk in scenes.chunks(CHUNK) {
            side_by_side::run(chunk, Wanted::ALL, None, &mut |_, decayed| {
                black_box(decayed);
            })?;
        }
        let runs = begin.elapsed().as_secs_f64();
        let begin = Instant::now();
        black_box(sweep(&study, 0..points, &control)?);
        ratios.push(begin.elapsed().as_secs_f64() / runs);
    }
    ratios.sort_by(f64::total_cmp);
    let [least, median, most] = [0, ROUNDS / 2, ROUNDS - 1].map(|i| ratios[i]);
    println!("{points} points: sweep over runs {median:.3} ({least:.3} to {most:.3})");
    Ok(())
}
