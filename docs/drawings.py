"""Drawings of the physics, by matplotlib: sketches to scale, and motions from real runs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, Rectangle
from numpy.typing import NDArray

import iva
from iva.plots.styles import ABSORBER, STRUCTURE, WALLS

INK, STEEL, MASS, FORCE = "#222222", "#d5dae1", "#e8a33d", "#b3261e"
BLUE, ORANGE, GREY = "#1f5fa8", "#d9822b", "#7a828c"
STYLE = {
    "font.size": 10,
    "svg.fonttype": "path",
    "svg.hashsalt": "iva",
    "axes.spines.top": False,
    "axes.spines.right": False,
}


def sheet(width: float, height: float, extent: tuple[float, float, float, float]) -> Axes:
    """Return axes to draw on, all of a figure, of equal scale in both directions."""
    axes = Figure(figsize=(width, height)).add_axes((0, 0, 1, 1))
    left, right, bottom, top = extent
    axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
    axes.axis("off")
    return axes


def save(figure: Figure | None, file: Path) -> None:
    """Write a figure; the same bytes each time."""
    assert figure is not None
    figure.savefig(file, metadata={"Date": None})


def arrow(
    axes: Axes, begin: tuple[float, float], end: tuple[float, float], color: str = INK
) -> None:
    """Draw an arrow."""
    style = {"arrowstyle": "-|>", "color": color, "shrinkA": 0, "shrinkB": 0, "linewidth": 1.2}
    axes.annotate("", end, begin, arrowprops=style)


def dimension(axes: Axes, begin: float, end: float, height: float, text: str) -> None:
    """Draw a horizontal dimension with its text above."""
    style = {"arrowstyle": "<|-|>", "color": INK, "shrinkA": 0, "shrinkB": 0, "linewidth": 0.9}
    axes.annotate("", (end, height), (begin, height), arrowprops=style)
    axes.text((begin + end) / 2, height + 0.06, text, ha="center", va="bottom")


def line(axes: Axes, *points: tuple[float, float], **style: object) -> None:
    """Draw a broken line."""
    across, up = zip(*points, strict=True)
    axes.plot(across, up, **{"color": INK, "linewidth": 1.2, **style})  # type: ignore[arg-type]


def hatched(axes: Axes, left: float, bottom: float, width: float, height: float) -> None:
    """Draw what does not move."""
    axes.add_patch(
        Rectangle((left, bottom), width, height, facecolor="white", edgecolor=GREY, hatch="////")
    )


def base(axes: Axes) -> None:
    """Draw base, spring and damper to the left of a structure that begins at 0."""
    hatched(axes, -1.9, -0.1, 0.18, 2.2)
    hatched(axes, -1.72, -0.1, 6.4, 0.14)
    coils = np.linspace(0, 1, 15)
    across = -1.72 + 0.3 + 1.1 * coils
    up = 1.55 + 0.13 * np.array([0, *np.resize([1, -1], 13), 0])
    line(axes, (-1.72, 1.55), *zip(across, up, strict=True), (0, 1.55))
    axes.text(-0.87, 1.78, "$k$", ha="center")
    line(axes, (-1.72, 0.75), (-0.95, 0.75))
    line(axes, (-0.6, 0.93), (-1.05, 0.93), (-1.05, 0.57), (-0.6, 0.57))
    line(axes, (-0.85, 0.9), (-0.85, 0.6))
    line(axes, (-0.85, 0.75), (0, 0.75))
    axes.text(-0.87, 1.0, "$c$", ha="center")
    for across in (0.5, 3.5):
        axes.add_patch(Circle((across, 0.16), 0.12, facecolor="white", edgecolor=INK))
    arrow(axes, (-1.9, -0.42), (-1.2, -0.42), FORCE)
    axes.text(-1.12, -0.42, "$a_g$: the base moves", va="center", color=FORCE)
    arrow(axes, (4.05, 0.5), (4.75, 0.5), FORCE)
    axes.text(4.45, 0.58, "$f(t)$", ha="center", va="bottom", color=FORCE)


def siva(file: Path) -> None:
    """Draw the free mass in its gap, and what is positive."""
    axes = sheet(8.2, 4.2, (-2.1, 5.3, -0.65, 3.14))
    base(axes)
    # The structure is a body with a slot.
    axes.add_patch(Rectangle((0, 0.28), 4, 0.5, facecolor=STEEL, edgecolor="none"))
    axes.add_patch(Rectangle((0, 0.28), 0.5, 1.6, facecolor=STEEL, edgecolor="none"))
    axes.add_patch(Rectangle((3.5, 0.28), 0.5, 1.6, facecolor=STEEL, edgecolor="none"))
    outline = [(0, 0.28), (4, 0.28), (4, 1.88), (3.5, 1.88), (3.5, 0.78), (0.5, 0.78), (0.5, 1.88)]
    line(axes, *outline, (0, 1.88), (0, 0.28))
    axes.text(2, 0.52, "primary system, $M$", ha="center", va="center")
    axes.text(0.25, 1.33, "wall −1", ha="center", va="center", rotation=90)
    axes.text(3.75, 1.33, "wall +1", ha="center", va="center", rotation=90)
    # The mass, off the middle by y.
    middle, off, half = 2.0, 0.45, 0.4
    axes.add_patch(Rectangle((middle + off - half, 0.8), 2 * half, 0.7, fc=MASS, ec=INK))
    axes.text(middle + off, 1.15, "$m$", ha="center", va="center")
    dashed = {"linestyle": (0, (6, 3)), "linewidth": 0.8, "color": GREY}
    line(axes, (middle, 0.8), (middle, 2.95), **dashed)
    line(axes, (middle + off, 0.8), (middle + off, 2.68), **dashed)
    # Walls seen by the middle of the mass.
    for sign, text in ((-1, "$y=-d$"), (1, "$y=+d$")):
        across = middle + sign * (1.5 - half)
        line(axes, (across, 1.52), (across, 2.2), linestyle=":", linewidth=1)
        axes.text(across, 2.24, text, ha="center", va="bottom")
    dimension(axes, middle - (1.5 - half), middle, 1.98, "$d$")
    arrow(axes, (middle, 1.7), (middle + off, 1.7), BLUE)
    axes.text(middle + off / 2, 1.73, "$y$", ha="center", va="bottom", color=BLUE)
    arrow(axes, (middle, 2.86), (middle + 0.75, 2.86))
    axes.text(middle - 0.08, 2.86, "$x$", ha="right", va="center")
    arrow(axes, (middle + off, 2.58), (middle + off + 0.75, 2.58))
    axes.text(middle + off + 0.82, 2.58, "$x_1 = x + y$", va="center")
    axes.text(middle + 0.82, 2.86, "positive", va="center", color=GREY)
    save(axes.figure, file)  # type: ignore[arg-type]


def piva(file: Path) -> None:
    """Draw the pendulum between its stops, and what is positive."""
    axes = sheet(8.2, 5.2, (-2.1, 5.3, -0.65, 4.05))
    base(axes)
    axes.add_patch(Rectangle((0, 0.28), 4, 0.4, facecolor=STEEL, edgecolor="none"))
    axes.add_patch(Rectangle((0, 0.28), 0.3, 3.3, facecolor=STEEL, edgecolor="none"))
    axes.add_patch(Rectangle((0, 3.3), 2.35, 0.28, facecolor=STEEL, edgecolor="none"))
    frame = [(0.3, 0.68), (0.3, 3.3), (2.35, 3.3), (2.35, 3.58), (0, 3.58), (0, 0.28), (4, 0.28)]
    line(axes, *frame, (4, 0.68), (0.3, 0.68))
    axes.text(2, 0.47, "primary system, $M$", ha="center", va="center")
    pivot, length, angle = np.array([2.0, 3.3]), 2.0, np.radians(17)
    bob = pivot + length * np.array([np.sin(angle), -np.cos(angle)])
    radius, reach = 0.2, 1.05
    for sign, text in ((-1, "wall −1"), (1, "wall +1")):
        left = pivot[0] + sign * (reach + radius) - (0.12 if sign < 0 else 0)
        axes.add_patch(Rectangle((left, 0.68), 0.12, 1.25, facecolor=STEEL, edgecolor=INK))
        axes.text(left + 0.06 + sign * 0.2, 1.2, text, rotation=90, ha="center", va="center")
        across = pivot[0] + sign * reach
        line(axes, (across, 0.86), (across, 2.15), linestyle=":", linewidth=1)
        sign_text = "$y=-d$" if sign < 0 else "$y=+d$"
        axes.text(across, 2.18, sign_text, ha="center", va="bottom")
    line(axes, tuple(pivot), (2.0, 0.86), linestyle=(0, (6, 3)), linewidth=0.8, color=GREY)
    line(axes, tuple(pivot), tuple(bob), linewidth=2)
    axes.add_patch(Circle(tuple(bob), radius, facecolor=MASS, edgecolor=INK, zorder=3))
    axes.text(*bob, "$m$", ha="center", va="center", zorder=4)
    axes.add_patch(Circle(tuple(pivot), 0.07, facecolor="white", edgecolor=INK, zorder=3))
    axes.add_patch(Arc(tuple(pivot), 1.9, 1.9, theta1=270, theta2=287, color=BLUE))
    axes.text(2.2, 2.18, r"$\theta$", color=BLUE, ha="center")
    axes.text(2.47, 2.62, "$L$", ha="center")
    arrow(axes, (2.0, 0.93), (float(bob[0]), 0.93), BLUE)
    axes.text((2 + bob[0]) / 2, 0.72, r"$y=b\,\sin\theta$", ha="center", va="bottom", color=BLUE)
    arrow(axes, (3.9, 3.4), (3.9, 2.7))
    axes.text(3.98, 3.05, "$g$", va="center")
    arrow(axes, (2.0, 3.82), (2.75, 3.82))
    axes.text(1.92, 3.82, "$x$", ha="right", va="center")
    axes.text(2.82, 3.82, "positive", va="center", color=GREY)
    line(axes, (2.0, 3.4), (2.0, 3.95), linewidth=0.8, color=GREY)
    save(axes.figure, file)  # type: ignore[arg-type]


def chatter_run() -> tuple[iva.Run, NDArray[np.float64], dict[str, NDArray[np.float64]]]:
    """Return the scene of the paper's Fig. 4 without damping, and a fine trajectory."""
    run = iva.simulate(
        iva.Siva(mass_ratio=0.15, relative_clearance=0.1, restitution=0.5),
        iva.Primary(),
        start=iva.Start(displacement=1.0),
        periods=1,
    )
    motion = run.trajectory(2000)
    columns = ("gap_displacement", "displacement", "wall")
    return run, motion["time"].to_numpy(), {name: motion[name].to_numpy() for name in columns}


def chatter(file: Path) -> None:
    """Draw a gap displacement from start to release, and the end of its chatter."""
    run, time, motion = chatter_run()
    gap = motion["gap_displacement"] / 0.1
    episode = run.episodes.row(0, named=True)
    figure = Figure(figsize=(8.2, 5.4), layout="constrained")
    above, below = figure.subplots(2)
    for axes in (above, below):
        for wall, color in WALLS.items():
            axes.axhline(wall, color=color, linewidth=2)
        axes.plot(time, gap, color=ABSORBER, linewidth=1.2)
        stuck = (episode["stick_time"], episode["release_time"])
        axes.plot(stuck, [episode["wall"]] * 2, color=INK, linewidth=4, solid_capstyle="butt")
        axes.set(ylabel="y / d", xlabel=r"$\tau=\omega_n t$")
    above.set(xlim=(0, 2 * np.pi), ylim=(-1.3, 1.45))
    above.text(0.05, 1.12, "wall +1", fontsize=9)
    above.text(0.05, -1.24, "wall −1", fontsize=9)
    pointed(above, "first contact", (float(run.impacts["time"][0]), 1), (1.0, 0.2))
    wall = episode["wall"]
    pointed(above, "chatter", (episode["stick_time"] - 0.3, 0.97 * wall), (3.5, 0.1 * wall))
    pointed(above, "stick", (episode["stick_time"], wall), (4.1, 0.3 * wall))
    pointed(above, "release", (episode["release_time"], wall), (5.0, 0.3 * wall))
    near = (episode["stick_time"] - 0.32, episode["stick_time"] + 0.06)
    below.set(xlim=near, ylim=(0.93, 1.015) if wall > 0 else (-1.015, -0.93))
    impacts = run.impacts.filter(run.impacts["time"].is_between(*near))
    below.plot(impacts["time"], [wall] * impacts.height, "o", color=WALLS[wall], markersize=3)
    pointed(below, "stick", (episode["stick_time"], wall), (near[1] - 0.03, 0.975 * wall))
    save(figure, file)


def pointed(axes: Axes, text: str, at: tuple[float, float], beside: tuple[float, float]) -> None:
    """Write a text with an arrow to what it tells of."""
    style = {"arrowstyle": "->", "color": GREY}
    axes.annotate(text, at, beside, ha="center", va="center", arrowprops=style, color=INK)


def measures(file: Path) -> None:
    """Draw what the damping measures are read from."""
    run = iva.simulate(
        iva.Siva(mass_ratio=0.1, relative_clearance=0.6, restitution=0.5),
        iva.Primary(damping_ratio=0.01),
        start=iva.Start(displacement=1.0),
        periods=8,
    )
    motion = run.trajectory(200)
    figure = Figure(figsize=(8.2, 3.7), layout="constrained")
    axes = figure.subplots()
    axes.axhline(0, color=GREY, linewidth=0.6)
    axes.plot(motion["time"], motion["displacement"], color=BLUE, linewidth=1.2)
    peaks = run.envelope
    axes.plot(peaks["time"], peaks["displacement"], "o", color=ORANGE, markersize=5)
    for row in peaks.filter(peaks["peak"] < 7).iter_rows(named=True):
        above = row["displacement"] > 0
        at = (max(row["time"], 0.6), row["displacement"] + (0.04 if above else -0.05))
        place = {"va": "bottom" if above else "top", "ha": "center", "fontsize": 9}
        axes.text(*at, f"$a_{row['peak']}$", **place)
    summary = run.summary.row(0, named=True)
    for level in (10, 5):
        for sign in (1, -1):
            axes.axhline(sign * level / 100, color=GREY, linewidth=0.6, linestyle="--")
        time = summary[f"settling_time_{level}"]
        height = float(run.at([time])["displacement"][0])
        axes.plot([time], [height], "o", color=FORCE, markersize=5)
        to = (time + 3.0, 0.45 if level == 10 else 0.28)
        pointed(axes, f"settling_time_{level}", (time, height), to)
    axes.set(xlim=(0, float(motion["time"][-1])), ylim=(-1.1, 1.15))
    axes.set(xlabel=r"$\tau=\omega_n t$", ylabel=r"$x\,/\,x_0$")
    save(figure, file)


def front(file: Path) -> None:
    """Draw a decay with and without an absorber, and the impacts below."""
    scene = {
        "primary": iva.Primary(damping_ratio=0.005),
        "start": iva.Start(displacement=1.0),
        "periods": 12,
    }
    run = iva.simulate(iva.Siva(mass_ratio=0.1, relative_clearance=0.7, restitution=0.6), **scene)
    bare = iva.simulate(None, **scene)
    figure = Figure(figsize=(8.2, 4.3), layout="constrained")
    above, below = figure.subplots(2, sharex=True, height_ratios=(2.2, 1))
    for made, label, color in ((bare, "bare", GREY), (run, "with the absorber", STRUCTURE)):
        motion = made.trajectory(200)
        periods = motion["time"] / (2 * np.pi)
        width = 0.8 if made is bare else 1.4
        above.plot(periods, motion["displacement"], color=color, linewidth=width, label=label)
    above.legend(loc="upper right", frameon=False, ncols=2)
    above.set(ylabel=r"$x\,/\,x_0$", ylim=(-1.1, 1.4))
    for wall, color in WALLS.items():
        side = run.impacts.filter(run.impacts["wall"] == wall)
        times = side["time"] / (2 * np.pi)
        label = f"wall {wall:+d}".replace("-", "−")
        below.vlines(times, 0, side["approach_velocity"], color=color, linewidth=2, label=label)
    below.axhline(0, color=INK, linewidth=0.6)
    below.legend(loc="upper right", frameon=False, ncols=2)
    below.set(xlabel=r"periods $2\pi/\omega_n$", ylabel=r"$w\,/\,(\omega_n x_0)$", xlim=(0, 12))
    save(figure, file)


def drawn(draw: Callable[[Path], None]) -> Callable[[Path], None]:
    """Return a drawing in the style of the site."""

    def styled(file: Path) -> None:
        with mpl.rc_context(STYLE):
            draw(file)

    return styled


#: Name of the file → what draws it.
DRAWINGS = {
    "siva.svg": drawn(siva),
    "piva.svg": drawn(piva),
    "chatter.svg": drawn(chatter),
    "measures.svg": drawn(measures),
    "front.svg": drawn(front),
}
