//! Contacts that last so long that they are no impacts.

use iva_core::absorber::Wall;

use crate::engine::given::Given;
use crate::spec::Spec;

/// The share of a natural period up to which a contact is short: the structure then turns by some 18° in phase.
const SHORT: f64 = 0.05;

/// What the contacts of a run amount to, in a sentence; `None` where nothing is known of how long they last.
///
/// `impacts` are the instants of its impacts in order, in the user's unit, and the number of the absorber of each.
pub fn verdict(spec: &Spec, impacts: impl Iterator<Item = (f64, u64)>) -> Option<String> {
    let shares = shares(spec);
    let longest = shares.iter().copied().flatten().reduce(f64::max)?;
    let (scale, _) = Given::<f64>::new(spec).scale().ok()?;
    let period = scale.time(std::f64::consts::TAU);
    let mut before = vec![f64::NEG_INFINITY; shares.len()];
    let (mut count, mut sooner) = (0, 0);
    for (time, absorber) in impacts {
        count += 1;
        let place = usize::try_from(absorber).unwrap_or(usize::MAX);
        let (Some(before), Some(Some(share))) = (before.get_mut(place), shares.get(place)) else {
            continue;
        };
        sooner += u64::from(time - std::mem::replace(before, time) < share * period);
    }
    let of = format!("a contact lasts {:.2} % of a natural period", longest * 100.0);
    Some(match sooner {
        0 => format!("{of}; no impact follows another one before its contact would have ended"),
        _ => format!(
            "{of}; {sooner} of {count} impacts follow another one before its contact would have ended: to real stops \
             they are one contact"
        ),
    })
}

/// A doubt about each absorber whose contacts are a large part of a natural period.
pub(super) fn doubts(spec: &Spec) -> Vec<String> {
    let doubt = |(place, share): (usize, Option<f64>)| {
        let share = share.filter(|share| *share > SHORT)?;
        let whose =
            if spec.count() > 1 { format!("absorber {place}") } else { "the absorber".to_owned() };
        Some(format!(
            "a contact of {whose} lasts {:.2} % of a natural period: impacts take no time here, and contacts that last \
             more than some {:.0} % change the motion",
            share * 100.0,
            SHORT * 100.0
        ))
    };
    shares(spec).into_iter().enumerate().filter_map(doubt).collect()
}

/// How long a contact of each absorber lasts, over a natural period.
fn shares(spec: &Spec) -> Vec<Option<f64>> {
    let Ok(design) = Given::<f64>::new(spec).design() else { return Vec::new() };
    let share = |place: usize| {
        let contact = design.contacts.get(place).copied().flatten()?;
        let absorber = design.scene.absorber_of(place)?;
        let restitution = design.scene.restitution_of(place, Wall::Plus, 0.0);
        let reduced = absorber.mass_ratio / (1.0 + absorber.mass_ratio);
        Some(contact.duration(reduced, restitution) / std::f64::consts::TAU)
    };
    (0..design.scene.count()).map(share).collect()
}
