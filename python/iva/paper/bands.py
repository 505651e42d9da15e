"""Curves that jump from point to point, drawn as median and band over neighbouring points."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from iva.paper.measures import Curve

#: Shares of the values in a window between which the band lies.
BAND = (0.1, 0.9)
#: A curve that turns at more than this share of its points jumps.
TURNS = 0.15
#: What a figure with such curves says.
NOTE = (
    f"lines: medians over a tenth of the axis; bands: from {100 * BAND[0]:g} to "
    f"{100 * BAND[1]:g} % of the values there; faint: every point, a few beyond the panel"
)


def jumps(curve: Curve) -> bool:
    """Return whether a curve turns up and down at many points."""
    steps = np.diff(curve[np.isfinite(curve)])
    moves = steps[steps != 0.0]
    turns = int(np.sum(np.diff(np.sign(moves)) != 0.0))
    return turns > TURNS * curve.size


def over_neighbours(curve: Curve, shares: tuple[float, ...]) -> Curve:
    """Return quantiles over a tenth of the points around each one, a row for each share.

    At the ends the window is cut; values that are missing (NaN) do not count.
    """
    half = max(1, curve.size // 20)
    padded = np.pad(curve, half, constant_values=np.nan)
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * half + 1)
    found = np.full((len(shares), curve.size), np.nan)
    some = np.isfinite(windows).any(axis=1)
    found[:, some] = np.nanquantile(windows[some], shares, axis=1)
    return found


def draw(axes: Axes, at: Curve, curve: Curve, color: str, label: str, width: float) -> None:
    """Draw every point faintly, and the median of its neighbours over their band."""
    axes.plot(at, curve, color=color, linewidth=0.35, alpha=0.4, label="_every point", zorder=1)
    low, middle, high = over_neighbours(curve, (BAND[0], 0.5, BAND[1]))
    axes.fill_between(at, low, high, color=color, alpha=0.18, linewidth=0.0, zorder=1.5)
    axes.plot(at, middle, color=color, linewidth=width, label=label)
