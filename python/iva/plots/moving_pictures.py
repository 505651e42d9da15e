"""Animations: the mass in its gap, the pendulum between its stops."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from functools import partial
from html import escape
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import polars as pl
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from iva.design import Design, design_of
from iva.exports import aside
from iva.forces import file_name
from iva.parameters import number, shown
from iva.plots.arguments import Numbers, checked_run, frame_of, limit, motion_of, values_of
from iva.plots.axis_units import in_millimetres, name_axis
from iva.plots.impact_ticks import impact_ticks
from iva.plots.labels import labelled
from iva.plots.scenery import scenery
from iva.plots.styles import GREY, STRUCTURE, WALLS, style
from iva.simulation import Run
from iva.spelling import spell_checked

#: A wall that was hit goes dark again in so many frames.
FLASH = 5
#: Megabytes that an HTML page may hold; matplotlib drops frames beyond.
MOST = 2_000.0
FIGURE: dict[str, Any] = {"figsize": (3.35, 2.3), "dpi": 160, "layout": "constrained"}
#: Height of x(t) in inches, its labels with it.
TRACE = 1.5
#: What stands on the buttons, instead of an icon font from elsewhere.
BUTTONS = {
    "minus": "−",
    "fast-backward": "⏮",
    "step-backward": "‹",
    "play fa-flip-horizontal": "◀",
    "pause": "❚❚",
    "play": "▶",
    "step-forward": "›",
    "fast-forward": "⏭",
    "plus": "+",
}


@spell_checked
def animation(
    run: Run, *, until: float | None = None, frames: int = 200, fps: int = 25
) -> FuncAnimation:
    """Make an animation of a run: the scene to scale, and x(t) below it.

    Displacements, play and arm are to scale; the size of the masses, which nobody has given, is
    not. Of several absorbers there is a row for each, with the structure that carries them all. Of
    a pendulum at small angles without length the arm is drawn 4 times as long as it swings wide. A
    wall that is hit lights up in the colour of its impacts, and glows while the absorber sticks to
    it.

    Parameters
    ----------
    run : Run
        The run, with its table ``impacts``.
    until : float, optional
        Last instant to show, in the unit of time of the run; all of it by default.
    frames : int, default 200
        Number of pictures, equidistant in time.
    fps : int, default 25
        Pictures a second, up to 50.

    Returns
    -------
    matplotlib.animation.FuncAnimation
        Keep it as long as it is to run. In a notebook ``HTML(animation(run).to_jshtml())`` shows
        it; :func:`animate` writes it.

    Raises
    ------
    TypeError
        If an argument is of the wrong class.
    ValueError
        If a value is out of range, the table is missing, or the run has no absorber.

    Examples
    --------
    >>> moving = animation(run)  # doctest: +SKIP
    """
    checked(run, until, frames, fps)
    # Only here, for it chooses a backend.
    import matplotlib.pyplot as plt

    with style():
        figure = plt.figure(**FIGURE)
        try:
            return moving(figure, run, until, frames, fps)
        except BaseException:
            plt.close(figure)
            raise


def checked(run: Run, until: float | None, frames: int, fps: int) -> None:
    """Check what an animation is made of.

    Raises
    ------
    TypeError, ValueError
        If something cannot be used.
    """
    if checked_run(run, several=True).absorber is None:
        raise ValueError("this run has no absorber, and so no gap to show")
    for absorber in range(design_of(run).absorbers):
        drawable(design_of(run, absorber))
    frame_of(run, "impacts")
    limit(until)
    for field, value, least, most in (("frames", frames, 2, 100_000), ("fps", fps, 1, 50)):
        given = number(field, value)
        if not least <= given <= most or not given.is_integer():
            raise ValueError(
                f"{field} = {shown(value)}: give a whole number from {least} to {most}"
            )


def drawable(design: Design) -> None:
    """Look whether there is a picture of an absorber.

    Raises
    ------
    ValueError
        If there is none.
    """
    if design.mass_ratio == 0.0:
        raise ValueError("this run has a stop on the ground: animations show walls that move")
    if not all(design.walls):
        raise ValueError("this run has a gap with one wall: animations show two")
    if (pendulum := design.pendulum) is None:
        return
    if pendulum.inclination != 0.0:
        raise ValueError("the pivot moves on a line that rises: animations show level ones")
    if design.gap_offset != 0.0:
        raise ValueError("the gap of the pendulum has an offset: animations show none")


def moving(figure: Figure, run: Run, until: float | None, frames: int, fps: int) -> FuncAnimation:
    """Draw the first picture on a figure, and return what draws the others."""
    count = design_of(run).absorbers
    motions, end = [], 0.0
    for absorber in range(count):
        motion, end = motion_of(run, until, absorber)
        motions.append(motion)
    instants = np.linspace(motions[0]["time"][0], end, int(frames))
    hits = frame_of(run, "impacts").filter(pl.col("time") <= end)
    *above, below = figure.subplots(count + 1)
    largest = float(np.abs(motions[0]["displacement"]).max())
    seen, sceneries = states_of(run, instants, count), []
    for absorber, (axes, motion) in enumerate(zip(above, motions, strict=True)):
        reach = float(np.abs(motion["gap_displacement"]).max())
        sceneries.append(scenery(axes, design_of(run, absorber), largest, reach))
    glows = [
        {wall: brightness(instants, states["wall"], own, wall) for wall in WALLS}
        for states, own in zip(seen, hits_of(hits, count), strict=True)
    ]
    # All to one scale.
    ends = np.array([axes.get_xlim() for axes in above])
    for axes in above:
        axes.set_xlim(ends[:, 0].min(), ends[:, 1].max())
    heights = [scene_height(axes) for axes in above]
    figure.set_figheight(sum(heights) + TRACE)
    grid = below.get_gridspec()
    assert grid is not None
    grid.set_height_ratios([*heights, TRACE])
    motion, _ = motion_of(run, until)
    past, now = trace(below, run, motion, hits, end)

    def show(index: int) -> list[Artist]:
        time, x = (float(seen[0][name][index]) for name in ("time", "displacement"))
        for scene, states, glow in zip(sceneries, seen, glows, strict=True):
            scene.move(x, *(float(states[name][index]) for name in ("gap_displacement", "angle")))
            for wall, strength in glow.items():
                scene.light(wall, float(strength[index]))
        passed = motion["time"] <= time
        past.set_data(
            np.append(motion["time"][passed], time), np.append(motion["displacement"][passed], x)
        )
        now.set_data([time], [x])
        return [past, now]

    show(0)
    # Laid out once: nothing should tremble from picture to picture.
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    return FuncAnimation(figure, show, frames=int(frames), interval=1e3 / fps)


def states_of(run: Run, instants: Numbers, count: int) -> list[dict[str, Numbers]]:
    """Return the motion of each absorber at some instants."""
    rows = run.at(instants)
    each = rows.partition_by("absorber") if count > 1 else [rows]
    # Of a run that ended early the last instant is not in it any more.
    whole = [one.fill_null(strategy="forward") for one in each]
    return [{name: values_of(one[name]) for name in one.columns} for one in whole]


def hits_of(hits: pl.DataFrame, count: int) -> list[pl.DataFrame]:
    """Return the impacts of each absorber."""
    if count == 1:
        return [hits]
    return [hits.filter(pl.col("absorber") == absorber) for absorber in range(count)]


def scene_height(axes: Axes) -> float:
    """Return the height in inches that a scene to scale needs, within limits."""
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    return min(max(3.2 * (top - bottom) / (right - left), 0.5), 2.8)


def trace(
    axes: Axes, run: Run, motion: Mapping[str, Numbers], hits: pl.DataFrame, end: float
) -> tuple[Line2D, Line2D]:
    """Draw x(t) with all impacts; return the lines of what has passed, and of now."""
    axes.plot(motion["time"], motion["displacement"], color=GREY, linewidth=0.5)
    impact_ticks(axes, hits, end)
    (past,) = axes.plot([], [], color=STRUCTURE)
    (now,) = axes.plot([], [], "o", color=STRUCTURE, markersize=4)
    units = run.units["trajectory"]
    axes.set_xlim(motion["time"][0], end)
    axes.margins(y=0.08)
    name_axis(axes.xaxis, partial(labelled, "time", "t"), units["time"])
    in_mm = in_millimetres(run)
    name_axis(axes.yaxis, partial(labelled, "x", ""), units["displacement"], millimetres=in_mm)
    return past, now


def brightness(instants: Numbers, stuck: Numbers, hits: pl.DataFrame, wall: int) -> Numbers:
    """Return for every picture how much a wall is lit: 1 at an impact, fading, ½ while stuck."""
    times = hits.filter(pl.col("wall") == wall)["time"].to_numpy()
    step = instants[1] - instants[0]
    count = np.searchsorted(times, instants, side="right")
    since = instants - np.concatenate([[-np.inf], times])[count]
    fading: Numbers = np.clip(1.0 - since / (FLASH * step), 0.0, 1.0)
    return np.where(stuck == wall, np.maximum(fading, 0.5), fading)


@spell_checked
def animate(
    run: Run,
    path: str | os.PathLike[str],
    *,
    until: float | None = None,
    frames: int = 200,
    fps: int = 25,
) -> Path:
    """Write an animation of a run: a GIF, or an HTML page that needs no other file.

    Parameters
    ----------
    run : Run
        The run, with its table ``impacts``.
    path : path-like
        The file, with the suffix .gif or .html. It is written whole or not at all.
    until, frames, fps
        As in :func:`animation`.

    Returns
    -------
    pathlib.Path
        The file.

    Raises
    ------
    TypeError
        If an argument is of the wrong class.
    ValueError
        If a value is out of range, the suffix is another one, the table is missing, the run has no
        absorber, or `path` is not a file in a folder that exists.
    iva.IvaError
        If the file cannot be written.

    Examples
    --------
    >>> animate(run, "decay.gif", until=20.0)  # doctest: +SKIP
    """
    file = Path(file_name(path))
    suffix = file.suffix.lower()
    if suffix not in (".gif", ".html"):
        raise ValueError(f"path = {shown(str(file))}: give a name that ends in .gif or .html")
    checked(run, until, frames, fps)
    # Of its own, not of pyplot: nobody is to see it.
    with aside(file) as made, style(), mpl.rc_context({"animation.embed_limit": MOST}):
        drawn = moving(Figure(**FIGURE), run, until, frames, fps)
        if suffix == ".gif":
            # Of a name without an ending the writer would not know the format.
            animated = made.with_suffix(suffix)
            drawn.save(animated, writer=PillowWriter(fps=fps))
            animated.rename(made)
        else:
            made.write_text(page(drawn.to_jshtml(fps=fps), file.stem), encoding="utf-8")
    return file


def page(player: str, title: str) -> str:
    """Return a whole page around the player of matplotlib, which needs nothing from elsewhere."""
    alone = re.sub(r"<link\b[^>]*>", "", player)
    named = re.sub(r'<i class="fa fa-([^"]*)"></i>', button, alone)
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f"<title>{escape(title)}</title>\n</head>\n<body>\n{named}\n</body>\n</html>\n"
    )


def button(icon: re.Match[str]) -> str:
    """Return what stands on a button instead of an icon."""
    return BUTTONS.get(icon[1], icon[1])
