"""The paper's scenes: the two absorbers in free decay, under the assumptions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import iva
from iva.paper.assumptions import Assumptions

#: The displacement from which the structure is let go; lengths are in units of it.
START = iva.Start(displacement=1.0)

#: Length of a decay in periods: a structure with ζ = 0.01 settles to 5 % in 48.
PERIODS = 60.0


def primary(a: Assumptions, damping_ratio: float | None = None) -> iva.Primary:
    """Return the structure."""
    return iva.Primary(damping_ratio=a.damping_ratio if damping_ratio is None else damping_ratio)


def siva(a: Assumptions, **given: float) -> iva.Siva:
    """Return the free mass, with what is given in the place of what is assumed."""
    return iva.Siva(**({"mass_ratio": a.mass_ratio, "restitution": a.restitution} | given))


def piva(a: Assumptions, **given: Any) -> iva.Piva:
    """Return the pendulum, with what is given in the place of what is assumed."""
    assumed = {
        "mass_ratio": a.mass_ratio,
        "restitution": a.restitution,
        "relative_clearance": a.relative_clearance,
        "frequency_ratio": a.frequency_ratio,
        "gravity": a.gravity,
        "impact_law": a.impact_law,
    }
    return iva.Piva(**(assumed | given))


def bare(a: Assumptions, damping_ratio: float | None = None, periods: float = PERIODS) -> iva.Run:
    """Return the decay of the structure alone."""
    return iva.simulate(None, primary(a, damping_ratio), start=START, periods=periods)


def decay(
    absorber: iva.Siva | iva.Piva, structure: iva.Primary, periods: float = PERIODS
) -> iva.Run:
    """Return one decay."""
    return iva.simulate(absorber, structure, start=START, periods=periods)


def decays(
    absorber: iva.Siva | iva.Piva,
    structure: iva.Primary,
    over: Mapping[str, Sequence[float]],
    tables: Sequence[str] = (),
    periods: float = PERIODS,
) -> iva.Table:
    """Return the decays of a grid."""
    return iva.sweep(
        absorber,
        structure,
        over=over,
        start=START,
        periods=periods,
        tables=("summary", *tables),
    )
