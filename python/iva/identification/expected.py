"""What is known of a free mass and its structure, by where the fit has it."""

from __future__ import annotations

import numpy as np

from iva.identification.posterior import Beliefs
from iva.identification.priors import Bell, Between, Exactly, Prior
from iva.identification.records import OMEGA, RELEASE, SIZE, ZETA
from iva.identification.responses import Values
from iva.identification.stated import Stated

#: Number → place in the head of a record, and the factor from its unit to that of the head.
HEADS = {
    "frequency_hz": (OMEGA, 2 * np.pi),
    "damping_ratio": (ZETA, 1.0),
    "release": (RELEASE, 1.0),
    "displacement": (SIZE, 1.0),
    "impulse_velocity": (SIZE, 1.0),
}


def heads(known: Stated, clock: float) -> tuple[dict[int, float], dict[int, tuple[float, float]]]:
    """Return what is set and what is expected of the numbers of the record, by place."""
    fixed: dict[int, float] = {}
    expected: dict[int, tuple[float, float]] = {}
    for name, (place, factor) in HEADS.items():
        prior = known.priors.get(name)
        shift = clock if name == "release" else 0.0
        if isinstance(prior, Exactly):
            fixed[place] = (prior.value - shift) * factor
        elif isinstance(prior, Bell) and not prior.by_logarithm:
            expected[place] = ((prior.middle - shift) * factor, prior.width * factor)
    return fixed, expected


def beliefs_of(known: Stated, size: float) -> Beliefs:
    """Return the priors of the absorber; where nothing is known they are wide."""
    gap = known.priors.get("gap")
    wide = Between(0.01 * size, 20 * size, by_logarithm=True)
    return Beliefs(
        known.priors.get("mass_ratio", Between(1e-3, 1.0, by_logarithm=True)),
        wide if gap is None else halved(gap),
        known.priors.get("restitution", Between(0.0, 1.0)),
        known.priors.get("gap_displacement"),
    )


def halved(gap: Prior) -> Prior:
    """Return the prior of the clearance from that of the gap."""
    if isinstance(gap, Exactly):
        return Exactly(gap.value / 2)
    if isinstance(gap, Between):
        return Between(gap.low / 2, gap.high / 2, gap.by_logarithm)
    assert isinstance(gap, Bell)
    width = gap.width if gap.by_logarithm else gap.width / 2
    return Bell(gap.middle / 2, width, gap.low / 2, gap.high / 2, gap.by_logarithm)


def pull_of(beliefs: Beliefs) -> tuple[Values, Values]:
    """Return mean and deviation of 1/μ, d, y₀ and e beforehand, as of normal distributions."""
    shares = (0.1587, 0.5, 0.8413)
    mass = [1 / beliefs.mass_ratio.at(share) for share in shares]
    clearance = [beliefs.clearance.at(share) for share in shares]
    restitution = [beliefs.restitution.at(share) for share in shares]
    half = clearance[2] / np.sqrt(3)
    place = [-half, 0.0, half]
    if beliefs.place is not None:
        place = [beliefs.place.at(share) for share in shares]
    columns = np.array([mass, clearance, place, restitution])
    deviation = np.abs(columns[:, 2] - columns[:, 0]) / 2
    wide = np.array(
        [
            not isinstance(one, Bell | Exactly)
            for one in (beliefs.mass_ratio, beliefs.clearance, beliefs.place, beliefs.restitution)
        ]
    )
    # Flat priors pull nowhere: the window has to find its way from far.
    return columns[:, 1], np.where(wide, 10 * deviation, deviation)


__all__ = ["HEADS", "beliefs_of", "heads", "pull_of"]
