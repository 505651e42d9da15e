"""The steady state over the frequency of a harmonic force, and the exact theory over it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np
import polars as pl
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from iva import _iva
from iva.forces import Harmonic
from iva.parameters import Primary, Siva, shown, spec
from iva.plots.arguments import Numbers, checked_table, frame_of, numeric, values_of
from iva.plots.axis_units import in_millimetres, name_axis
from iva.plots.labels import of_column, valued
from iva.plots.legends import legend_above
from iva.plots.styles import BLACK, BLUE, GREEN, GREY, PURPLE, VERMILLION, drawing_on
from iva.spelling import spell_checked
from iva.tables import Table
from iva.theory import masri_caughey

#: Last part of a swept key over which a response can be drawn.
FREQUENCIES = ("frequency", "relative_frequency", "frequency_hz")
#: Of the points computed; the theory is drawn in vermillion.
POINTS = ((BLACK, "o"), (BLUE, "s"), (GREEN, "^"), (PURPLE, "v"))
#: Frequencies at which the theory is evaluated, beside those of the table.
FINE = 400

Theory = tuple[Siva, Primary, Harmonic]


@spell_checked
def forced_response(
    table: Table,
    *,
    value: str = "amplitude_max",
    theory: Theory | None = None,
    by: str | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw the steady state over the frequency of a harmonic force, with the exact theory over it.

    Parameters
    ----------
    table : Table
        Tables of a sweep over a frequency of the force.
    value : str, default "amplitude_max"
        The column to draw. Amplitudes have a logarithmic axis.
    theory : tuple of Siva, Primary and Harmonic, optional
        The scene of which to draw the symmetric motions with two impacts a cycle, solid where they
        are stable and dashed where not; those that no absorber can follow are left out. A table
        does not know its scene: give what was given to :func:`iva.sweep`. The frequency of the
        force is that of the table. For `value` "amplitude_max" and "reduction".
    by : str, optional
        The parameter that tells series of points apart; by default the first swept one that is no
        frequency of the force, if there is any.
    ax : matplotlib axes, optional
        Where to draw; axes of their own by default.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    TypeError
        If an argument is of the wrong class.
    ValueError
        If no frequency of a force was swept, there is no such column of numbers, it is null
        everywhere, or the theory is in other units, has no such value or refuses the scene.

    Notes
    -----
    S. F. Masri and T. K. Caughey, J. Appl. Mech. 33 (1966) 586–592, as
    :func:`iva.theory.masri_caughey`. With "amplitude_max" the structure without absorber is drawn
    in grey: that of the theory, else `amplitude_max` / (1 − `reduction`) of the table. A sweep
    without absorber is that structure itself, and has its points alone.

    Examples
    --------
    >>> scene = (
    ...     iva.Siva(mass_ratio=0.05, restitution=0.8, clearance=2.0),
    ...     iva.Primary(damping_ratio=0.02),
    ...     iva.Harmonic(amplitude=0.1),
    ... )
    >>> table = iva.sweep(
    ...     scene[0],
    ...     scene[1],
    ...     force=scene[2],
    ...     over={"force.relative_frequency": [0.98, 1.0, 1.02]},
    ...     start=iva.Start(),
    ...     cycles=200,
    ...     discard=150,
    ... )
    >>> axes = forced_response(table, theory=scene)
    >>> axes.get_xlabel()
    'force frequency Ω/ωₙ'
    """
    summary = frame_of(checked_table(table), "summary")
    key = frequency_key(table)
    frequency, sizes = numeric(summary, "x", key), numeric(summary, "value", value)
    if by is None:
        by = next((name for name in table.swept if name != key), None)
    groups = np.zeros_like(frequency) if by is None else numeric(summary, "by", by)
    branches = None
    if theory is not None:
        fine = np.union1d(frequency, np.linspace(frequency.min(), frequency.max(), FINE))
        branches = Branches(checked_theory(theory, table), key, fine, value)
    units = table.units["summary"]
    with drawing_on(ax) as axes:
        if value == "amplitude_max":
            if branches is not None:
                across, alone = branches.frequency, branches.without
            else:
                across, alone = without_absorber(frequency, summary)
            if np.isfinite(alone).any():
                axes.plot(across, alone, color=GREY, label="without absorber", zorder=1)
        for index, group in enumerate(np.unique(groups)):
            rows = groups == group
            colour, marker = POINTS[index % len(POINTS)]
            axes.plot(
                frequency[rows],
                sizes[rows],
                linestyle="none",
                marker=marker,
                markersize=2.5,
                markeredgewidth=0.5,
                markerfacecolor="none",
                color=colour,
                label="computed" if by is None else valued(by, units.get(by, ""), group),
            )
        if branches is not None:
            for line, kind, drawn in (("-", "stable", True), ("--", "unstable", False)):
                for number, amplitudes in enumerate(branches.amplitudes(stable=drawn)):
                    axes.plot(
                        branches.frequency,
                        amplitudes,
                        line,
                        color=VERMILLION,
                        linewidth=1.0,
                        label=f"_{kind} {number}" if number else f"theory, {kind}",
                    )
        if value.startswith("amplitude_"):
            axes.set_yscale("log")
            axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
            axes.yaxis.set_minor_formatter(NullFormatter())
        in_mm = in_millimetres(table)
        for axis, name in ((axes.xaxis, key), (axes.yaxis, value)):
            name_axis(axis, partial(of_column, name), units.get(name, ""), millimetres=in_mm)
        legend_above(axes)
    return axes


class Branches:
    """The two symmetric motions with two impacts a cycle, over frequency."""

    def __init__(self, theory: Theory, key: str, frequency: Numbers, value: str) -> None:
        if value not in ("amplitude_max", "reduction"):
            raise ValueError(f"value = {value!r}: the theory has 'amplitude_max' and 'reduction'")
        absorber, primary, force = theory
        none = dict.fromkeys(FREQUENCIES)
        field = key.rpartition(".")[2]
        self.frequency = frequency
        self.without = np.full_like(frequency, np.nan)
        # Branch, stable or not, frequency.
        self._sizes = np.full((2, 2, frequency.size), np.nan)
        refused = None
        for index, at in enumerate(frequency):
            driven = replace(force, **{**none, field: float(at)})
            try:
                found = masri_caughey(absorber, primary, driven)
            except ValueError as error:
                # Without damping there is no answer at some frequencies, but between them.
                refused = error
                continue
            self.without[index] = found.amplitude_without_absorber
            for branch, orbit in enumerate(found.orbits):
                if orbit is not None and orbit.admissible:
                    self._sizes[branch, int(orbit.stable), index] = orbit.amplitude
        if refused is not None and np.isnan(self.without).all():
            raise refused
        if value == "reduction":
            self._sizes = 1.0 - self._sizes / self.without

    def amplitudes(self, *, stable: bool) -> Iterator[Numbers]:
        """Yield the amplitudes of each motion that exists somewhere, NaN where it does not."""
        for sizes in self._sizes[:, int(stable)]:
            if np.isfinite(sizes).any():
                yield sizes


def frequency_key(table: Table) -> str:
    """Return the swept key that is a frequency of a force.

    Raises
    ------
    ValueError
        If none is.
    """
    found = [
        key
        for key in table.swept
        if re.fullmatch(rf"force\.(\d+\.)?({'|'.join(FREQUENCIES)})", key)
    ]
    if not found:
        swept = ", ".join(table.swept) or "nothing"
        raise ValueError(
            f"the table is swept over {swept}: sweep a frequency of the force, for example "
            "force.relative_frequency"
        )
    return found[0]


def checked_theory(theory: object, table: Table) -> Theory:
    """Return absorber, structure and force, after a look at their classes and units.

    Raises
    ------
    TypeError
        If they are something else.
    ValueError
        If they are in other units than the table.
    """
    match theory:
        case (Siva() as absorber, Primary() as primary, Harmonic() as force):
            pass
        case _:
            raise TypeError(
                f"theory = {shown(theory)}: give (absorber, primary, force), an iva.Siva, an "
                "iva.Primary and an iva.Harmonic"
            )
    units = _iva.primary_units(spec(primary))
    if units != table.units.sentence:
        raise ValueError(f"theory is in other units ({units}) than the table ({table.units})")
    return absorber, primary, force


def without_absorber(frequency: Numbers, summary: pl.DataFrame) -> tuple[Numbers, Numbers]:
    """Return frequencies, increasing, and the amplitude of the structure alone."""
    left = 1.0 - values_of(summary["reduction"])
    amplitude = values_of(summary["amplitude_max"])
    alone = np.divide(amplitude, left, out=np.full_like(left, np.nan), where=left > 0.0)
    order = np.argsort(frequency, kind="stable")
    return frequency[order], alone[order]
