"""Legends above the axes, where they cover nothing, no wider than the axes."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.legend import Legend

from iva.plots.styles import figure_of


def legend_above(
    axes: Axes,
    handles: Sequence[Artist] | None = None,
    *,
    title: str | None = None,
    markerscale: float | None = None,
) -> None:
    """Put a legend above axes, in as many columns as their width has room for.

    Parameters
    ----------
    axes : matplotlib axes
        The axes, with everything drawn and labelled.
    handles : sequence of matplotlib artists, optional
        The entries; all labelled ones by default. Without any there is no legend.
    title : str, optional
        What stands above the entries.
    markerscale : float, optional
        How many times as large markers are as on the axes.
    """
    entries = axes.get_legend_handles_labels()[0] if handles is None else list(handles)
    if not entries:
        return
    figure = figure_of(axes)
    if figure.get_layout_engine() is not None:
        # Only the layout knows how wide the axes will be.
        figure.draw_without_rendering()
    room = axes.get_window_extent().width

    def made(columns: int) -> Legend:
        return axes.legend(
            handles=entries,
            loc="lower center",
            bbox_to_anchor=(0.5, 1.0),
            ncols=columns,
            borderaxespad=0.3,
            title=title,
            markerscale=markerscale,
        )

    for rows in range(1, len(entries) + 1):
        legend = made(math.ceil(len(entries) / rows))
        width = legend.get_window_extent().width
        if width <= room:
            return
    # No entry fits: those that are too long are broken into lines of about the same length.
    longest = max(len(text.get_text()) for text in legend.get_texts())
    letters = max(8, math.ceil(longest / math.ceil(width / room)) + 2)
    for text in legend.get_texts():
        text.set_text(textwrap.fill(text.get_text(), letters))
