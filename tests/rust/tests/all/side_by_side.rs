//! Single runs, and the same runs side by side, as texts: floats are printed with all their digits, so equal texts are
//! equal bits.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::extremes::Extremes;
use iva_core::measures::Wanted;
use iva_core::measures::near_wall::NearWall;
use iva_core::measures::pass::{Pass, Passes};
use iva_core::observe::Events;
use iva_core::propagation::Errors;
use iva_core::run::side_by_side::{self, Ended, Job, Listed, Listing, NewPass, SideBySide};
use iva_core::simulate::simulate_from;
use iva_core::steady::Steady;
use iva_core::summary::Summary;

pub(crate) fn alone<S: SideBySide>(decay: &Job<S>) -> String {
    alone_wanting(decay, Wanted::ALL)
}

pub(crate) fn alone_wanting<S: SideBySide>(decay: &Job<S>, wanted: Wanted) -> String {
    let Job { system, start, begin, limits, steady, .. } = decay;
    let from = steady.map_or(*begin, |(_, window)| window.from);
    let looks = (Extremes::new(from), Passes::new(from, vec![near_wall()]));
    let observers = ((Events::default(), Errors::default()), looks);
    let wanted = Wanted { envelope: true, ..wanted };
    let mut watch = (Summary::<S>::new(wanted, decay.steady), observers);
    let tally = simulate_from(system, start, *begin, limits, None, &mut watch).unwrap();
    let (summary, ((events, errors), (extremes, passes))) = watch;
    let ended = (tally, *summary.values(), summary.steady_values().copied());
    let (peaks, strobes) = (summary.envelope(), summary.steady().and_then(Steady::all_strobes));
    let (extremes, passes) = (extremes.values().to_vec(), passes.values().collect::<Vec<_>>());
    let seen = format!("{peaks:?} {strobes:?} {extremes:?} {passes:?} {:?}", summary.absorbers());
    format!("{ended:?} {events:?} {} {seen}", told(&errors))
}

fn near_wall() -> Box<dyn Pass<f64>> {
    Box::new(NearWall::default())
}

/// What users are told of errors.
fn told(errors: &Errors) -> String {
    format!("{:?} {:?} {:?}", errors.impacts, errors.condition(), errors.digits())
}

pub(crate) fn together<S: SideBySide>(scenes: &[Job<S>]) -> Vec<String> {
    together_wanting(scenes, Wanted::ALL)
}

pub(crate) fn together_wanting<S: SideBySide>(scenes: &[Job<S>], wanted: Wanted) -> Vec<String> {
    let mut found = vec![String::new(); scenes.len()];
    side_by_side::run(scenes, wanted, None, &mut |i, decayed: &Ended<S>| {
        assert!(found[i].is_empty(), "scene {i} came twice");
        found[i] = format!("{decayed:?}");
    })
    .unwrap();
    // The same runs with their impacts and stick episodes, and with errors, or peaks, or what looks within flights.
    let of = |events, errors, envelope, extremes| {
        let passes: Vec<NewPass> = if extremes { vec![near_wall] } else { Vec::new() };
        Listing { events, errors, envelope, extremes, passes }
    };
    let listings = [
        of(true, true, false, false),
        of(true, false, true, false),
        of(false, false, false, true),
        of(true, true, true, true),
    ];
    let mut listed = listings.map(|listing| {
        let mut listed = vec![Listed::default(); scenes.len()];
        side_by_side::run_listed(
            scenes,
            (wanted, &listing),
            None,
            &mut |i, ended: &Ended<S>, more| {
                assert_eq!(found[i], format!("{ended:?}"), "scene {i} by {listing:?}");
                listed[i] = more;
            },
        )
        .unwrap();
        listed
    });
    for i in 0..scenes.len() {
        let [estimated, peaked, looked, all] =
            listed.each_mut().map(|listed| std::mem::take(&mut listed[i]));
        let seen = |it: &Listed| format!("{:?} {:?}", it.extremes, it.passes);
        assert_eq!(seen(&looked), seen(&all), "scene {i}");
        assert_eq!(looked.strobes, all.strobes, "scene {i}");
        assert_eq!(all.events, peaked.events, "scene {i}");
        assert_eq!(all.envelope, peaked.envelope, "scene {i}");
        assert_eq!(estimated.events, peaked.events, "scene {i}");
        let (events, errors) = (peaked.events.unwrap(), told(&estimated.errors.unwrap()));
        assert_eq!(told(&all.errors.unwrap()), errors, "scene {i}");
        let (peaks, strobes) = (peaked.envelope.unwrap(), peaked.strobes);
        assert_eq!(estimated.strobes, strobes, "scene {i}");
        assert_eq!(format!("{:?}", all.absorbers), format!("{:?}", peaked.absorbers));
        let seen = format!("{peaks:?} {strobes:?} {} {:?}", seen(&looked), peaked.absorbers);
        found[i] = format!("{} {events:?} {errors} {seen}", found[i]);
    }
    found
}
