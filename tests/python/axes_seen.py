"""What several tests of pictures look at, and the scenes that they draw."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

import iva

Numbers = NDArray[np.float64]

STRUCTURE = iva.Primary(mass=3.0, stiffness=12_000.0, damping=2.0)

MAST = iva.Primary(mass=200.0, stiffness=16_000.0, damping=30.0)

DRIVEN = (
    iva.Siva(mass_ratio=0.05, restitution=0.8, clearance=2.0),
    iva.Primary(damping_ratio=0.02),
    iva.Harmonic(amplitude=0.1),
)


def decaying(absorber: iva.Siva | iva.Piva, **more: Any) -> iva.Run:
    """Return a decay without dimensions."""
    start = more.pop("start", iva.Start(displacement=1.0))
    return iva.simulate(absorber, iva.Primary(damping_ratio=0.01), start=start, periods=6, **more)


SMALL = {"mass_ratio": 0.1, "restitution": 0.5, "frequency_ratio": 0.4, "angles": "small"}
DECAYS: dict[str, Callable[[], iva.Run]] = {
    "free mass": lambda: decaying(
        iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5)
    ),
    "chatter": lambda: decaying(iva.Siva(mass_ratio=0.15, relative_clearance=0.1, restitution=0.5)),
    "unlisted rebounds": lambda: decaying(
        iva.Siva(mass_ratio=0.15, relative_clearance=0.1, restitution=0.5), chatter_floor=0.05
    ),
    "plastic": lambda: decaying(iva.Siva(mass_ratio=0.15, clearance=0.5, restitution=0.0)),
    "cut short": lambda: decaying(
        iva.Siva(mass_ratio=0.15, clearance=0.6, restitution=0.5), max_impacts=5
    ),
    "pendulum": lambda: decaying(
        iva.Piva(
            mass_ratio=0.1,
            restitution=0.5,
            clearance=1.2,
            frequency_ratio=0.4,
            length=2.0,
            inertia_ratio=1.3,
            contact_distance=1.5,
            pivot_damping_ratio=0.1,
        )
    ),
    "spring": lambda: decaying(
        iva.Piva(
            mass_ratio=0.1,
            restitution=0.5,
            clearance=1.2,
            frequency_ratio=0.4,
            length=2.0,
            spring_ratio=0.5,
        )
    ),
    "over the top": lambda: decaying(
        iva.Piva(mass_ratio=0.1, restitution=0.5, clearance=3.0, frequency_ratio=0.4, length=2.0),
        start=iva.Start(displacement=1.0, angular_velocity=1.0),
    ),
    "no length": lambda: decaying(iva.Piva(clearance=0.2, **SMALL)),  # type: ignore[arg-type]
    "small angles": lambda: decaying(
        iva.Piva(
            clearance=0.2,
            length=3.0,
            contact_distance=2.0,
            inertia_ratio=1.2,
            **SMALL,  # type: ignore[arg-type]
        )
    ),
    "length from gravity": lambda: decaying(
        iva.Piva(mass_ratio=0.1, restitution=0.5, clearance=0.2, frequency_ratio=0.4, gravity=1.5)
    ),
    "seconds": lambda: iva.simulate(
        iva.Siva(mass_ratio=0.3, restitution=0.6, gap=1.0),
        iva.Primary(frequency_hz=3.0, damping_ratio=0.02),
        start=iva.Start(displacement=2.0, velocity=1.0),
        duration=2.0,
    ),
    "metric pendulum": lambda: iva.simulate(
        iva.Piva(mass=20.0, length=0.75, restitution=0.5, gap_mm=140.0),
        MAST,
        start=iva.Start(displacement_mm=50.0),
        duration=5.0,
    ),
    "metric": lambda: iva.simulate(
        iva.Siva(mass=0.3, restitution=0.6, clearance_mm=3.0),
        iva.Primary(mass=3.0, natural_frequency=60.0, damping=2.0),
        start=iva.Start(displacement_mm=4.0),
        duration=1.0,
    ),
    "overdamped": lambda: iva.simulate(
        iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=0.2),
        iva.Primary(damping_ratio=30.0),
        start=iva.Start(displacement=1.0),
        periods=2,
    ),
}


def line(axes: Axes, label: str) -> tuple[Numbers, Numbers]:
    """Return the points of the line with a label."""
    (found,) = [one for one in axes.lines if one.get_label() == label]
    return np.asarray(found.get_xdata()), np.asarray(found.get_ydata())


def labels(axes: Axes) -> list[str]:
    """Return the entries of the legend."""
    legend = axes.get_legend()
    return [] if legend is None else [text.get_text() for text in legend.get_texts()]


def drawn(axes: Axes, kind: str) -> list[str]:
    """Return the labels of the curves of a theory."""
    names = (str(one.get_label()) for one in axes.lines)
    return [name for name in names if re.fullmatch(rf"theory, {kind}|_{kind} \d", name)]
