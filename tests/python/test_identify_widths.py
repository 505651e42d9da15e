"""What a sample beside an impact tells of a pendulum: the same on either side of the impact.

The motion is that of iva.simulate at numbers that are known; no record is identified.
"""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("dynesty")

from iva.identification.around import Gauss, gauss_of
from iva.identification.responses import Values
from iva.identification.shooting import Shot, Target, derivatives
from iva.identification.swings import HEAD, NUMBERS, Rig, Swing, swing
from iva.identification.widths import over_widths

#: Frequency, mass ratio, gap, frequency ratio, displacement; damping ratio, release, offset.
HEADS = np.array([*np.log([2.7, 0.077, 0.102, 0.347, 0.0447]), 0.0055, 0.26, 0.0])
RESTITUTION, SCATTER = 0.54, 0.03
SECONDS, RATE, NOISE = 4.6, 200.0, 2e-5


def deviations(time: Values, hits: int) -> tuple[Values, Values]:
    """Return the deviations of all numbers by derivatives at a point, and over the widths."""
    at = np.concatenate([HEADS, np.full(hits, RESTITUTION)])

    def flown(other: Values, resumed: tuple[Swing, int] | None = None) -> Swing:
        return swing(time, 0, other[:HEAD], other[HEAD:], Rig(), SECONDS, resumed)

    motion = flown(at)
    deviation = np.full(HEAD, np.inf)
    target = Target(time, motion.values, 0, NOISE, np.zeros(HEAD), deviation, Rig())
    slopes, by_impact = derivatives(at, motion, flown, np.ones(at.size, bool))
    made = Shot(at[:HEAD], at[HEAD:], motion, 1.0, slopes, by_impact, SECONDS)
    gauss = gauss_of(target, made)
    wide = gauss_of(target, over_widths(target, made, gauss, RESTITUTION, SCATTER))

    def told(found: Gauss) -> Values:
        made: Values = np.sqrt(np.diag(found.covariance(RESTITUTION, SCATTER)[1]))[:HEAD]
        return made

    return told(gauss), told(wide)


def test_a_sample_beside_an_impact_is_of_both_sides() -> None:
    none = np.zeros(1)
    times = swing(none, 0, HEADS, np.full(1, RESTITUTION), Rig(), SECONDS).times
    # A late impact, the 13th: its sample lies 20 µs before or after it, less than its instant is
    # known to.
    grid = times[12] + np.arange(-2000, 2000) / RATE
    by_side = []
    for aside in (-20e-6, 20e-6):
        time = grid + aside
        by_side.append(deviations(time[(time > 0) & (time < SECONDS)], len(times)))
    at_a_point, over = (by_side[0][way] / by_side[1][way] for way in (0, 1))
    assert at_a_point[NUMBERS.index("damping_ratio")] > 1.4
    assert over == pytest.approx(np.ones(HEAD), abs=0.01)
