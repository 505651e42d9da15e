"""The picture of the front page: a structure alone, with a free mass, and with a pendulum.

python -m iva.paper.front docs/pictures/front.png
"""

from __future__ import annotations

import sys
from math import pi

from matplotlib.axes import Axes
from matplotlib.figure import Figure

import iva
from iva import plots
from iva.design import design_of
from iva.paper import scenes
from iva.paper.assumptions import Assumptions
from iva.plots.scenery import Body, scenery
from iva.plots.styles import GREY

#: Periods that are run: enough for the structure alone to settle to 10 %. And that are shown.
PERIODS, SHOWN = 45.0, 20.0
#: A pendulum short enough to be drawn to scale: 3 x₀ long.
GRAVITY = 0.48


def picture() -> Figure:
    """Return the figure: a row for each, the system to scale beside its decay."""
    a = Assumptions(gravity=GRAVITY)
    structure = scenes.primary(a)
    alone = scenes.bare(a, periods=PERIODS)
    rows: list[tuple[str, iva.Run]] = [
        ("structure alone, ζ = 0.01", alone),
        (
            "free mass (SIVA), μ = 0.1, γ = 0.4",
            scenes.decay(scenes.siva(a, relative_clearance=0.4), structure, PERIODS),
        ),
        (
            "pendulum (PIVA), μ = 0.1, γ = 1.4",
            scenes.decay(scenes.piva(a), structure, PERIODS),
        ),
    ]
    with plots.style():
        figure = Figure(figsize=(7.0, 4.6), layout="constrained")
        panels = figure.subplots(3, 2, width_ratios=(1.0, 2.9))
        for (left, right), (name, run) in zip(panels, rows, strict=True):
            sketch(left, run, alone=run is alone)
            history(right, name, run)
        for right in panels[:2, 1]:
            right.set_xlabel("")
            right.tick_params(labelbottom=False)
    return figure


def sketch(axes: Axes, run: iva.Run, *, alone: bool) -> None:
    """Draw the system to scale, at the start."""
    if alone:
        axes.set_aspect("equal")
        axes.set_axis_off()
        body = Body(axes, 0.9, 0.5, 1.0)
        body.add(-0.9, -0.5, 1.8, 1.0)
        body.shift(1.0)
        axes.set_ylim(-0.9, 0.9)
    else:
        drawn = scenery(axes, design_of(run), 1.0, 1.4)
        drawn.move(1.0, 0.0, 0.0)
        for wall in (1, -1):
            drawn.light(wall, 1.0)


def history(axes: Axes, name: str, run: iva.Run) -> None:
    """Draw the decay with its impacts, and say when it has settled."""
    plots.decay(run, settle=(10,), envelope=False, until=SHOWN * 2.0 * pi, ax=axes)
    if legend := axes.get_legend():
        legend.remove()
    settled = run.summary["settling_time_10"].item() / (2.0 * pi)
    axes.set_title(name, loc="left")
    axes.set_title(f"10 % after {settled:.1f} periods", loc="right", color=GREY)
    axes.set_ylim(-1.15, 1.15)
    axes.set_ylabel("x/x₀")


if __name__ == "__main__":
    picture().savefig(sys.argv[1], dpi=200, metadata={"Software": None})
