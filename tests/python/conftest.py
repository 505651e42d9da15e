"""Scenes that several tests run."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

import iva
from axes_seen import DRIVEN, MAST, STRUCTURE, decaying

# How long an example takes says nothing on a busy machine, nor how long drawing it takes.
settings.register_profile("iva", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("iva")

# What a script of the shell starts in the background is deaf to Ctrl-C, and so are its children:
# a sweep that is to be interrupted would go on to its end.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


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


@pytest.fixture(autouse=True)
def no_figure_is_left() -> Iterator[None]:
    """Close all figures after a test: others count those that are open."""
    yield
    if pyplot := sys.modules.get("matplotlib.pyplot"):
        pyplot.close("all")


@pytest.fixture
def pictures_are_closed() -> Iterator[None]:
    """Close all figures after a test, and see that no setting was changed for everybody else."""
    mpl = pytest.importorskip("matplotlib")
    plt = pytest.importorskip("matplotlib.pyplot")
    before = dict(mpl.rcParams)
    yield
    plt.close("all")
    assert dict(mpl.rcParams) == before, "settings of everybody else"


@pytest.fixture
def metric() -> iva.Run:
    """Return a decay in SI units."""
    return iva.simulate(
        iva.Siva(mass=0.3, restitution=0.6, gap_mm=6.0),
        STRUCTURE,
        start=iva.Start(displacement_mm=4.0),
        duration=1.0,
    )


@pytest.fixture
def pendulum() -> iva.Run:
    """Return a decay with a pendulum."""
    return iva.simulate(
        iva.Piva(mass=20.0, length=0.75, restitution=0.5, gap_mm=140.0),
        MAST,
        start=iva.Start(displacement_mm=50.0),
        duration=5.0,
    )


@pytest.fixture
def chattering() -> iva.Run:
    """Return a decay with chatter and stick."""
    return decaying(iva.Siva(mass_ratio=0.15, relative_clearance=0.1, restitution=0.5))


@pytest.fixture(scope="module")
def response() -> iva.Table:
    """Return a sweep over the frequency of a force."""
    return iva.sweep(
        DRIVEN[0],
        DRIVEN[1],
        force=DRIVEN[2],
        over={"force.relative_frequency": np.linspace(0.95, 1.05, 11)},
        start=iva.Start(),
        cycles=300,
        discard=250,
    )
