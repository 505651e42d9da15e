"""Nothing on a picture covers anything else: legends, tick labels, names of axes."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from functools import cache

import matplotlib as mpl
import numpy as np
import polars as pl
import pytest
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.transforms import Bbox

import iva
from axes_seen import DECAYS, DRIVEN, STRUCTURE, decaying
from iva import plots
from iva.identification import Fit
from iva.plots.styles import figure_of

mpl.use("Agg")
import matplotlib.pyplot as plt

pytestmark = pytest.mark.usefixtures("pictures_are_closed")

Draw = Callable[[Axes | None], Axes]

#: As long as a thoughtful person may write it.
LONG = "steel mast, absorber of 0.3 kg in a play of 6 mm, measured at the top on a calm day"
SI = (iva.Siva(mass=0.3, restitution=0.6, gap_mm=6.0), STRUCTURE)


def metric(size: float = 1.0, **more: object) -> iva.Run:
    """Return a decay in mm, so many times as large."""
    return iva.simulate(
        iva.Siva(mass=0.3, restitution=0.6, gap=0.006 * size),
        STRUCTURE,
        start=iva.Start(displacement=0.004 * size),
        duration=1.0,
        **more,  # type: ignore[arg-type]
    )


@cache
def several(count: int) -> iva.Run:
    """Return a decay with several absorbers."""
    absorbers = [
        iva.Siva(mass_ratio=0.03, clearance=0.3 + 0.1 * place, restitution=0.5)
        for place in range(count)
    ]
    return decaying(absorbers)  # type: ignore[arg-type]


@cache
def grid() -> iva.Table:
    """Return a grid of 9 × 10 points in mm."""
    return iva.sweep(
        SI[0],
        SI[1],
        over={"gap_mm": np.linspace(0.5, 12.0, 9), "displacement_mm": np.linspace(1.0, 10.0, 10)},
        start=iva.Start(),
        duration=1.0,
        tables=("summary", "impacts"),
    )


@cache
def few() -> iva.Table:
    """Return a sweep with seven values of a second parameter, all of them long."""
    return iva.sweep(
        iva.Siva(restitution=0.6, mass=0.3),
        STRUCTURE,
        over={"clearance": [0.001, 0.002, 0.003], "start.velocity": [k / 700 for k in range(1, 8)]},
        start=iva.Start(displacement_mm=4.0),
        duration=1.0,
    )


@cache
def answers() -> iva.Table:
    """Return a response to a harmonic force from several starts."""
    return iva.sweep(
        DRIVEN[0],
        DRIVEN[1],
        force=DRIVEN[2],
        over={
            "force.relative_frequency": np.linspace(0.95, 1.05, 5),
            "displacement": [0.0, 1.0, 2.0, 3.0],
        },
        start=iva.Start(),
        cycles=60,
        discard=40,
    )


FORCED = (iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5), iva.Primary(damping_ratio=0.05))
FORCE = iva.Harmonic(amplitude=1.0, frequency=1.0)


@cache
def followed() -> iva.dynamics.Branch:
    """Return a branch with two special points."""
    first = iva.dynamics.orbit(*FORCED, force=FORCE, start=(0, 0, 0, 0.1), settle=200)
    assert isinstance(first, iva.dynamics.Orbit)
    branch = iva.dynamics.follow(first, over="clearance", between=(3.0, 8.0))
    assert isinstance(branch, iva.dynamics.Branch)
    return branch


@cache
def driven() -> iva.Run:
    """Return a run under a harmonic force."""
    return iva.simulate(*FORCED, start=iva.Start(gap_velocity=0.1), force=FORCE, cycles=60)


@cache
def charted() -> iva.dynamics.Curve:
    """Return the curve of a special point of a branch."""
    curve = iva.dynamics.curve(
        followed().points[1], over=("clearance", "restitution"), between=((3.0, 8.0), (0.6, 0.8))
    )
    assert isinstance(curve, iva.dynamics.Curve)
    return curve


@cache
def basins() -> iva.dynamics.Basins:
    """Return coarse basins."""
    axis = np.linspace(-4, 4, 8)
    over = {"displacement": axis, "velocity": axis}
    return iva.dynamics.basins(*FORCED, force=FORCE, over=over)


@cache
def found(*chosen: str) -> iva.Optimum:
    """Return the best of a few designs."""
    ends = {"gap_mm": (1.0, 12.0), "absorber.mass": (0.1, 0.4)}
    return iva.optimise(
        iva.Siva(mass=None if "absorber.mass" in chosen else 0.3, restitution=0.6),
        STRUCTURE,
        choose={name: ends[name] for name in chosen},
        minimise="settling_time_5",
        start=iva.Start(displacement_mm=4.0),
        duration=4.0,
        runs=500,
    )


@cache
def fitted() -> Fit:
    """Return a fit as it would be, without fitting."""
    time = np.linspace(0.0, 1.0, 400)
    motion = 0.004 * np.cos(60.0 * time) * np.exp(-time)
    rows = {name: [0.6, 0.62] for name in ("restitution", "restitution_low", "restitution_high")}
    speeds = {f"approach_speed{end}": [0.1, 0.2] for end in ("", "_low", "_high")}
    impacts = pl.DataFrame({"time": [0.1, 0.2], "wall": [1, -1], **rows, **speeds})
    numbers = {"parameter": ["restitution"], "value": [0.6], "low": [0.55], "high": [0.65]}
    nothing = pl.DataFrame()
    return Fit(
        pl.DataFrame(numbers), impacts, (), (), (), time, motion, motion, motion - 1e-4,
        motion + 1e-4, np.ones(400, dtype=bool), 1e-4, nothing, "displacement", SI[0], SI[1],
        iva.Start(displacement_mm=4.0), 1.0,
    )  # fmt: skip


PICTURES: dict[str, Draw] = {
    "decay": lambda ax: plots.decay(metric(), relative=False, ax=ax),
    "decay of a long name": lambda ax: plots.decay(
        metric(), bare=metric(2.0), settle=(50, 20, 10, 5, 2), label=LONG, ax=ax
    ),
    "decay, small": lambda ax: plots.decay(metric(1e-3), relative=False, ax=ax),
    "decay, short": lambda ax: plots.decay(metric(), relative=False, until=0.0123, ax=ax),
    "decay, large": lambda ax: plots.decay(metric(300.0), relative=False, ax=ax),
    "decay of several": lambda ax: plots.decay(several(5), ax=ax),
    "velocities": lambda ax: plots.velocities(metric(), ax=ax),
    "velocities, small": lambda ax: plots.velocities(metric(1e-3), ax=ax),
    "velocities of several": lambda ax: plots.velocities(several(8), ax=ax),
    "accelerations": lambda ax: plots.accelerations(metric(), ax=ax),
    "accelerations, small": lambda ax: plots.accelerations(metric(1e-4), ax=ax),
    "accelerations of several": lambda ax: plots.accelerations(several(8), ax=ax),
    "phase": lambda ax: plots.phase(metric(), ax=ax),
    "phase of the gap": lambda ax: plots.phase(metric(), relative=True, ax=ax),
    "phase of several": lambda ax: plots.phase(several(5), ax=ax),
    "energy": lambda ax: plots.energy(DECAYS["free mass"](), ax=ax),
    "energy of a pendulum": lambda ax: plots.energy(DECAYS["pendulum"](), ax=ax),
    "energy with friction": lambda ax: plots.energy(
        iva.simulate(
            iva.Siva(mass=0.3, restitution=0.6, gap_mm=6.0, friction=0.05),
            STRUCTURE, start=iva.Start(displacement_mm=4.0), duration=1.0,
            force=iva.Impulse(impulse=0.1, time=0.2),
        ), ax=ax,
    ),
    "energy of several": lambda ax: plots.energy(several(5), ax=ax),
    "raster": lambda ax: plots.raster(grid(), ax=ax),
    "raster of a run": lambda ax: plots.raster(metric(), ax=ax),
    "heatmap": lambda ax: plots.heatmap(grid(), "settling_time_5", ax=ax),
    "heatmap of medians": lambda ax: plots.heatmap(grid(), "energy_impacts", median_of=3, ax=ax),
    "curves": lambda ax: plots.curves(few(), "settling_time_5", ax=ax),
    "curves with a colour bar": lambda ax: plots.curves(grid(), "energy_impacts", ax=ax),
    "forced response": lambda ax: plots.forced_response(answers(), theory=DRIVEN, ax=ax),
    "branch": lambda ax: plots.branch(followed(), ax=ax),
    "multipliers": lambda ax: plots.multipliers(followed(), ax=ax),
    "stability chart": lambda ax: plots.stability_chart(charted(), ax=ax),
    "diagram": lambda ax: plots.diagram(
        iva.dynamics.diagram(*FORCED, force=FORCE, over={"clearance": [3.7, 4.1, 4.5]}), ax=ax
    ),
    "section": lambda ax: plots.section(driven(), ax=ax),
    "section at a wall": lambda ax: plots.section(driven(), "wall-", ax=ax),
    "slow manifold": lambda ax: plots.slow_manifold(
        iva.simulate(
            iva.Siva(mass_ratio=0.02, restitution=0.6, clearance=1.0),
            iva.Primary(damping_ratio=0.01),
            force=iva.Harmonic(amplitude=0.008, frequency=1.0),
            start=iva.Start(gap_velocity=0.1), cycles=60,
        ), ax=ax,
    ),
    "basins": lambda ax: plots.basins(basins(), ax=ax),
    "design of one": lambda ax: plots.design(found("gap_mm"), ax=ax),
    "design of two": lambda ax: plots.design(found("gap_mm", "absorber.mass"), ax=ax),
    "fit": lambda ax: plots.fit(fitted(), ax=ax),
    "fit, what is left": lambda ax: plots.fit(fitted(), "residual", ax=ax),
    "fit of impacts": lambda ax: plots.fit(fitted(), "restitution", ax=ax),
}  # fmt: skip

#: Names of the functions of iva.plots whose pictures are not in the list above, and why.
ELSEWHERE = {
    "style": "draws nothing",
    "animation": "has no legend; its axes are in the test below",
    "animate": "writes what animation draws",
}


def overlap(one: Bbox, other: Bbox) -> bool:
    """Return whether two boxes share more than the width of a pixel."""
    shared = Bbox.intersection(one, other)
    return shared is not None and min(shared.width, shared.height) > 1.0


def labels(axis: Axis) -> list[tuple[str, Bbox]]:
    """Return the tick labels that can be seen, with their boxes, and a factor at the end."""
    low, high = sorted(axis.get_view_interval())
    margin = 1e-9 * (high - low)
    texts = [
        tick.label1
        for tick in axis.get_major_ticks()
        if low - margin <= tick.get_loc() <= high + margin and tick.label1.get_visible()
    ]
    drawn = [*texts, axis.get_offset_text()]
    return [(text.get_text(), text.get_window_extent()) for text in drawn if text.get_text()]


def keeps_apart(axes: Axes) -> None:
    """Check a picture as matplotlib draws it."""
    figure = figure_of(axes)
    figure.canvas.draw()
    inside = figure.bbox.padded(1.0)
    legend = axes.get_legend()
    if legend is not None:
        box, panel = legend.get_window_extent(), axes.get_window_extent()
        assert not overlap(box, panel), "the legend covers data"
        assert box.width <= panel.width + 1.0, "the legend outgrows its axes"
        assert inside.containsx(box.x0)
        assert inside.containsx(box.x1)
        assert inside.containsy(box.y0)
        assert inside.containsy(box.y1), "the legend leaves the figure"
    for name in (axes.xaxis.label, axes.yaxis.label):
        box = name.get_window_extent()
        assert inside.contains(box.x0, box.y0), f"{name.get_text()!r} leaves the figure"
        assert inside.contains(box.x1, box.y1), f"{name.get_text()!r} leaves the figure"
    for each in figure.axes:
        ticks = [*labels(each.xaxis), *labels(each.yaxis)]
        if each is axes:
            assert ticks
        for (one, its), (other, box) in itertools.combinations(ticks, 2):
            assert not overlap(its, box), f"{one!r} and {other!r} run into each other"
        if legend is not None and each is axes:
            for text, box in ticks:
                assert not overlap(box, legend.get_window_extent()), f"the legend covers {text!r}"


def test_every_picture_is_looked_at() -> None:
    first = {name.replace(",", "").split(" ")[0] for name in PICTURES}
    names = {name.split("_")[0] for name in plots.__all__ if name not in ELSEWHERE}
    assert first == names


@pytest.mark.parametrize("name", PICTURES)
def test_nothing_covers_anything(name: str) -> None:
    draw = PICTURES[name]
    # On axes of its own; on those of a person who knows no style; in half a column.
    keeps_apart(draw(None))
    _, axes = plt.subplots(layout="constrained")
    keeps_apart(draw(axes))
    with plots.style():
        _, panels = plt.subplots(1, 2, figsize=(7.0, 2.6), layout="constrained")
        keeps_apart(draw(panels[0]))


def test_an_animation_keeps_apart() -> None:
    moving = plots.animation(metric(), frames=3)
    moving._draw_was_started = True  # type: ignore[attr-defined]
    axes = plt.gcf().axes[-1]
    keeps_apart(axes)
    box = axes.yaxis.label.get_window_extent()
    assert box.x0 >= 0.0, "also outside of the style that it was laid out in"
