"""Scenes that several tests run."""

from __future__ import annotations

import pytest
from hypothesis import settings

import iva

# How long an example takes says nothing on a busy machine.
settings.register_profile("iva", deadline=None)
settings.load_profile("iva")


@pytest.fixture
def siva() -> iva.Siva:
    """Return the absorber of the front page."""
    return iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5)


@pytest.fixture
def run(siva: iva.Siva) -> iva.Run:
    """Return a short damped decay with that absorber."""
    return iva.simulate(
        siva, iva.Primary(damping_ratio=0.01), start=iva.Start(displacement=1.0), periods=6
    )


@pytest.fixture
def table(siva: iva.Siva) -> iva.Table:
    """Return a grid of 3 × 2 points with all tables."""
    return iva.sweep(
        siva,
        iva.Primary(damping_ratio=0.01),
        over={"relative_clearance": [0.4, 0.6, 0.8], "mass_ratio": [0.05, 0.1]},
        start=iva.Start(displacement=1.0),
        periods=6,
        tables=("summary", "impacts", "episodes", "envelope"),
    )
