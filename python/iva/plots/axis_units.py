"""Names and ticks of axes: millimetres, prefixes of units, and labels that keep apart.

Data coordinates are those of the tables, whatever the ticks say: a point at 0.003 m is drawn at
0.003 where the axis shows 3 mm, and ``axes.set_xlim(0.0, 0.005)`` ends it at 5 mm.

Which unit an axis shows, of all that is drawn on it and on axes that share it:

* a length (m) is in mm if lengths of the scene, or those of a sweep, were given in mm;
* otherwise in mm if everything is smaller than 0.1 m, in µm if it is smaller than 0.1 mm;
* m/s, m/s², J, N, N s and N/m take the prefix m if everything is smaller than 0.01, and µ if it is
  smaller than 0.01 of that;
* they and lengths take k from 10 000 on, and M from 10 000 k.

Every other unit stays as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis, XAxis
from matplotlib.cm import ScalarMappable
from matplotlib.ticker import AutoLocator, Formatter, MaxNLocator, ScalarFormatter

from iva.parameters import Absorber, Part, spec
from iva.plots.styles import figure_of
from iva.simulation import Run
from iva.tables import Table
from iva.units import given_in_mm

#: Units that take a prefix → the size below which everything has to be for the next smaller one.
SMALL = {"m": 0.1, "m/s": 0.01, "m/s²": 0.01, "J": 0.01, "N": 0.01, "N s": 0.01, "N/m": 0.01}
#: The size from which on they take the next larger one.
LARGE = 1e4
#: Power of ten by which tick labels are larger than the data → prefix.
PREFIXES = {6: "µ", 3: "m", 0: "", -3: "k", -6: "M"}
#: Differences that are this small, relative to what they are of, are rounding errors.
ROUNDING = 1e-9
#: Width of a digit of DejaVu Sans over its size; other fonts are narrower.
DIGIT = 0.64
#: Space between tick labels, in digits, and the largest number of steps between them.
SPACE, MOST = 1.5, 9
#: Distance of tick labels above each other, over their size.
LINE = 2.0

#: A label of an axis, given its unit.
Words = Callable[[str], str]


@dataclass(frozen=True)
class Named:
    """An axis with its label: what it is of, and what was written last."""

    axis: Axis
    words: Words
    unit: str
    millimetres: bool
    written: str


class Prefixed(Formatter):
    """Tick labels in a unit with a prefix, for values in the unit without it.

    Axes that share their ticks share this, too: they have the same prefix.
    """

    def __init__(self) -> None:
        self._power = 0
        self._named: list[Named] = []

    def name(self, axis: Axis, words: Words, unit: str, *, millimetres: bool) -> None:
        """Label an axis, and choose the prefix anew for all that have these ticks."""
        others = [one for one in self._named if one.axis is not axis]
        each = [*others, Named(axis, words, unit, millimetres, axis.get_label_text())]
        self._power = 0
        if len({one.unit for one in each}) == 1:
            largest = max(drawn_size(one.axis) for one in each)
            in_mm = any(one.millimetres for one in each)
            self._power = power_of(unit, largest, millimetres=in_mm)
        self._named = [self._written(one) for one in each]

    def _written(self, one: Named) -> Named:
        """Write the label of an axis; what somebody else has written since stays."""
        if one.axis.get_label_text() != one.written:
            return one
        text = one.words(PREFIXES[self._power] + one.unit)
        one.axis.set_label_text(text)
        return replace(one, written=text)

    def __call__(self, x: float, pos: int | None = None) -> str:  # noqa: ARG002 (of matplotlib)
        """Return one label."""
        return self.fix_minus(f"{x * 10.0**self._power:.6g}")

    def format_ticks(self, values: Any) -> list[str]:
        """Return all labels, each with as many decimals as any of them needs."""
        if self.axis is not None and self.axis.get_scale() != "linear":  # type: ignore[union-attr]
            return [self(value) for value in values]
        shown = np.asarray(values, dtype=float) * 10.0**self._power
        off = 1e-3 * np.diff(shown).min() if shown.size > 1 else 1e-6
        enough = (
            places for places in range(12) if (np.abs(shown - shown.round(places)) <= off).all()
        )
        places = next(enough, 12)
        # No tick is −0.
        return [self.fix_minus(f"{value:.{places}f}") for value in shown.round(places) + 0.0]


class Roomy(MaxNLocator):
    """Round ticks, so few that their labels keep apart.

    That of matplotlib does not look at the labels, and takes their size from the settings of the
    moment, which outside of :func:`iva.plots.style` are not those that the axes were made in.
    """

    def __init__(self) -> None:
        super().__init__(nbins=MOST, steps=[1, 2, 2.5, 5, 10])

    def tick_values(self, vmin: float, vmax: float) -> Any:
        """Return the ticks between two values, the most of them that keep apart."""
        ticks: Any = None
        for bins in range(MOST, 0, -1):
            self.set_params(nbins=bins, min_n_ticks=min(bins, 2))
            ticks = super().tick_values(vmin, vmax)
            if self.keeps_apart(ticks, abs(vmax - vmin)):
                break
        return ticks

    def keeps_apart(self, ticks: Any, span: float) -> bool:
        """Return whether there is room for the largest label between two ticks."""
        axis: Any = self.axis
        size = axis.get_major_ticks(1)[0].label1.get_size()
        box, point = axis.axes.bbox, figure_of(axis.axes).dpi / 72.0
        if isinstance(axis, XAxis):
            longest = max(map(len, axis.get_major_formatter().format_ticks(ticks)), default=0)
            needed, room = (longest + SPACE) * DIGIT * size, box.width / point
        else:
            needed, room = LINE * size, box.height / point
        step = np.diff(ticks).min() if len(ticks) > 1 else span
        return bool(needed <= room * step / span)


def name_axis(axis: Axis, words: Words, unit: str, *, millimetres: bool = False) -> None:
    """Write label and ticks of an axis, after everything is drawn on it.

    Parameters
    ----------
    axis : matplotlib axis
        The axis.
    words : callable
        Gives the label with the unit that it is given.
    unit : str
        The unit of the data.
    millimetres : bool, default False
        Whether lengths are in mm, however large.
    """
    if not isinstance(axis, XAxis):
        keep_calm(axis)
    # Broken into lines where it is longer than the figure.
    axis.label.set_wrap(True)
    if isinstance(axis.get_major_locator(), AutoLocator):
        axis.set_major_locator(Roomy())
    formatter = axis.get_major_formatter()
    if unit in SMALL:
        if not isinstance(formatter, Prefixed):
            formatter = Prefixed()
            axis.set_major_formatter(formatter)
        formatter.name(axis, words, unit, millimetres=millimetres)
        return
    if isinstance(formatter, Prefixed):
        axis.set_major_formatter(ScalarFormatter())
    axis.set_label_text(words(unit))


def keep_calm(axis: Axis) -> None:
    """Widen an axis up on which everything has one height, so that it does not show rounding."""
    axes = axis.axes
    low, high = axes.dataLim.intervaly
    if axes.get_autoscaley_on() and 0.0 < high - low < ROUNDING * abs(high):
        axes.set_ylim(low - 0.05 * abs(high), high + 0.05 * abs(high))


def colour_bar(
    axes: Axes,
    of: ScalarMappable,
    words: Words,
    unit: str,
    *,
    millimetres: bool = False,
    extend: Literal["neither", "both", "min", "max"] = "neither",
) -> None:
    """Draw a colour bar beside axes, with its label and ticks as :func:`name_axis` writes them."""
    # Set on its axis, it would be lost when somebody changes the ends of the colours.
    formatter = Prefixed() if unit in SMALL else None
    made = figure_of(axes).colorbar(of, ax=axes, extend=extend, format=formatter)
    name_axis(made.ax.yaxis, words, unit, millimetres=millimetres)


def drawn_size(axis: Axis) -> float:
    """Return the largest size of what is drawn along an axis and can be seen; 0 for nothing."""
    axes = axis.axes
    across = isinstance(axis, XAxis)
    data = axes.dataLim.intervalx if across else axes.dataLim.intervaly
    if not np.isfinite(data).all():
        return 0.0
    seen = axes.get_xlim() if across else axes.get_ylim()
    return float(min(np.abs(data).max(), np.abs(seen).max()))


def power_of(unit: str, largest: float, *, millimetres: bool = False) -> int:
    """Return the power of ten by which tick labels are larger than the data.

    Examples
    --------
    >>> power_of("m", 0.004), power_of("m", 0.2), power_of("m", 0.2, millimetres=True)
    (3, 0, 3)
    >>> power_of("J", 2e-6), power_of("m/s", 0.02), power_of("N", 25_000.0)
    (6, 0, -3)
    """
    if unit == "m" and millimetres:
        return 3
    if largest == 0.0:
        return 0
    power = 0
    while power < max(PREFIXES) and largest * 10.0**power < SMALL[unit]:
        power += 3
    while power > min(PREFIXES) and largest * 10.0**power >= LARGE:
        power -= 3
    return power


def in_millimetres(of: Run | Table | Iterable[str]) -> bool:
    """Return whether lengths of a run, or those that a sweep is over, were given in mm.

    Of anything else the names of the fields that were given.

    Examples
    --------
    >>> in_millimetres(["absorber.gap_mm", "start.displacement"]), in_millimetres(["clearance"])
    (True, False)
    """
    if isinstance(of, Run):
        return given_in_mm(of._spec)
    return given_in_mm(of.swept if isinstance(of, Table) else of)


def fields_of(*parts: Part | Absorber | tuple[Part, ...] | None) -> list[str]:
    """Return the names of the fields that some parts of a scene, or tuples of parts, were given."""
    flat = [one for part in parts for one in (part if isinstance(part, tuple) else (part,))]
    return list(spec(*flat))
