"""How pictures look: one column wide, legible in print, colours that everybody can tell apart."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap

from iva.parameters import shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# M. Okabe and K. Ito, Color Universal Design (2008).
BLACK, ORANGE, SKY_BLUE, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
YELLOW, BLUE, VERMILLION, PURPLE = "#F0E442", "#0072B2", "#D55E00", "#CC79A7"
GREY = "#8C8C8C"

#: Of curves side by side; yellow is too light for lines on white.
CURVES = (BLUE, VERMILLION, GREEN, ORANGE, PURPLE, SKY_BLUE, BLACK)
#: Of more curves than that: viridis without its lightest end.
SHADES = ListedColormap(mpl.colormaps["viridis"](np.linspace(0.0, 0.9, 256)), "dark viridis")
STRUCTURE, ABSORBER = BLACK, ORANGE
#: Of the walls; also dark and light in grey.
WALLS = {1: VERMILLION, -1: BLUE}

RC: Any = {
    "figure.figsize": (3.35, 2.3),  # one column of most journals: 85 mm
    "figure.dpi": 200,
    "font.family": "DejaVu Sans",  # comes with matplotlib, and has all the symbols
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.labelsize": 8,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "legend.fontsize": 7,
    "legend.title_fontsize": 7,
    "legend.frameon": False,
    "legend.handlelength": 1.6,
    "legend.columnspacing": 1.2,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "lines.linewidth": 0.9,
    "lines.markersize": 3,
    "hatch.linewidth": 0.4,
    "axes.prop_cycle": cycler(color=CURVES),
}


def style() -> AbstractContextManager[None]:
    """Return the context in which all pictures of this package are made.

    Figures made in it are one column (3.35 in) wide, with text of 8 pt and the colours of Okabe and
    Ito. The settings of matplotlib are as before when it ends. Functions that make axes of their
    own use it; use it yourself around axes that you pass.

    Returns
    -------
    context manager

    Examples
    --------
    >>> import matplotlib.pyplot as plt
    >>> with style():
    ...     figure, (above, below) = plt.subplots(2, figsize=(3.35, 3.5), layout="constrained")
    >>> float(figure.get_figwidth())
    3.35
    >>> plt.close(figure)
    """
    return mpl.rc_context(RC)


@contextmanager
def drawing_on(ax: Axes | None) -> Iterator[Axes]:
    """Give the axes to draw on; where there are none, make some in :func:`style`.

    A figure made here is closed again if drawing fails, so that no notebook shows it.

    Raises
    ------
    TypeError
        If it is something else.
    """
    if ax is not None:
        if not isinstance(ax, Axes):
            raise TypeError(f"ax = {shown(ax)}: give the axes of a matplotlib figure")
        yield ax
        return
    # Only here, for it chooses a backend.
    import matplotlib.pyplot as plt

    with style():
        figure, made = plt.subplots(layout="constrained")
        try:
            yield made
        except BaseException:
            plt.close(figure)
            raise


def figure_of(ax: Axes) -> Figure:
    """Return the whole figure that axes belong to."""
    figure = ax.get_figure(root=True)
    assert figure is not None
    return figure
