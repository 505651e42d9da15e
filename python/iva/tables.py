"""The tables of many runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from iva._iva import visible
from iva.frames import Frames
from iva.units import Units

if TYPE_CHECKING:
    from os import PathLike

    import polars as pl


class Table:
    """Result of :func:`sweep` or :func:`iva.read`: the tables of many runs.

    Attributes of tables are polars frames, made on first use; all begin with ``point``, the number
    of the point (of a grid row-major, last axis fastest). `swept` are the keys of the axes, `units`
    names the unit of every column. Tables can be copied, pickled and compared.

    Examples
    --------
    >>> table = iva.sweep(
    ...     iva.Siva(mass_ratio=0.1, restitution=0.5),
    ...     iva.Primary(damping_ratio=0.01),
    ...     over={"relative_clearance": [0.4, 0.6]},
    ...     start=iva.Start(displacement=1.0),
    ...     periods=20,
    ... )
    >>> table.swept, table.summary["relative_clearance"].to_list()
    (('relative_clearance',), [0.4, 0.6])
    """

    def __init__(self, swept: tuple[str, ...], units: Units, frames: Frames) -> None:
        self.swept = swept
        self.units = units
        self._frames = frames

    @property
    def tables(self) -> tuple[str, ...]:
        """Names of the tables that are there."""
        return self._frames.names

    @property
    def summary(self) -> pl.DataFrame:
        """Swept parameters, then outcome, counts, measures and energies, a row a point."""
        return self._frame("summary")

    @property
    def impacts(self) -> pl.DataFrame:
        """Time, wall (±1), both states, energy loss and ``effective``, a row an impact."""
        return self._frame("impacts")

    @property
    def episodes(self) -> pl.DataFrame:
        """One row a chatter that ends in stick, a plastic stick, or a start at rest on a wall."""
        return self._frame("episodes")

    @property
    def envelope(self) -> pl.DataFrame:
        """One row a peak of the primary displacement."""
        return self._frame("envelope")

    @property
    def stroboscope(self) -> pl.DataFrame:
        """One row a cycle of the harmonic force (of several, the first), after `discard`."""
        return self._frame("stroboscope")

    @property
    def absorbers(self) -> pl.DataFrame:
        """Impacts, energy loss, time stuck and largest impulse, a row an absorber and point."""
        return self._frame("absorbers")

    @property
    def trajectory(self) -> pl.DataFrame:
        """The motion in time, only in a folder that ``iva run`` wrote."""
        return self._frame("trajectory")

    def _frame(self, name: str) -> pl.DataFrame:
        if name not in self.tables:
            there = ", ".join(self.tables)
            advice = (
                "simulate one run and call its trajectory()"
                if name == "trajectory"
                else f"ask for it with tables=(…, {name!r})"
            )
            raise AttributeError(f"no table {name!r}, only {there}: {advice}")
        return self._frames[name]

    def filter(self, *conditions: pl.Expr) -> Table:
        """Return the points of which some conditions hold, to draw or to judge a part of a sweep.

        Parameters
        ----------
        *conditions : polars expressions
            Of columns of the summary, for example ``pl.col("restitution") == 0.6``.

        Returns
        -------
        Table
            Swept over what still varies; all tables have the rows of these points.

        Raises
        ------
        AttributeError
            If there is no summary.
        polars.exceptions.PolarsError
            If there is no such column.

        Examples
        --------
        >>> import polars as pl
        >>> table = iva.sweep(
        ...     iva.Siva(mass_ratio=0.1),
        ...     iva.Primary(damping_ratio=0.01),
        ...     over={"relative_clearance": [0.4, 0.6], "restitution": [0.5, 0.6, 0.7]},
        ...     start=iva.Start(displacement=1.0),
        ...     periods=20,
        ... )
        >>> part = table.filter(pl.col("restitution") == 0.6)
        >>> part.swept, part.summary.height
        (('relative_clearance',), 2)
        """
        kept = self.summary.filter(*conditions)
        points = kept.select("point")

        def source(name: str) -> Callable[[], pl.DataFrame]:
            if name == "summary":
                return lambda: kept
            return lambda: self._frames[name].join(
                points, on="point", how="semi", maintain_order="left"
            )

        varied = tuple(key for key in self.swept if kept[key].n_unique() > 1)
        return Table(varied, self.units, Frames({name: source(name) for name in self.tables}))

    @property
    def in_mm(self) -> Table:
        """The same tables with lengths in mm; all else is in the units of the table.

        Only where lengths are in metres (SI units).

        Examples
        --------
        >>> table = iva.sweep(
        ...     iva.Siva(mass=0.3, restitution=0.6),
        ...     iva.Primary(mass=3.0, stiffness=12_000.0),
        ...     over={"gap_mm": [4.0, 5.0]},
        ...     start=iva.Start(displacement_mm=4.0),
        ...     duration=1.0,
        ...     measures=["stroke"],
        ... )
        >>> table.in_mm.summary["stroke"].round(6).to_list()
        [4.0, 5.0]
        """
        if self.units.millimetres:
            return self
        from iva.lengths_in_mm import scaled

        return Table(self.swept, self.units.in_mm(), scaled(self._frames, self.units))

    def write_mat(self, path: str | PathLike[str]) -> None:
        """Write all tables into a file for MATLAB and Octave; needs SciPy.

        In MATLAB::

            S = load("clearance.mat");
            summary = struct2table(S.summary);
            plot(summary.relative_clearance, summary.settling_time_5)
            S.units.summary.settling_time_5

        Octave reads the file too, but has no ``struct2table``: use ``S.summary.settling_time_5``.

        Every table is a struct of columns. Numbers are doubles, with NaN for null; flags are
        logical, or doubles if one of them is null; words are cell arrays, with '' for null. A dot
        in a name becomes ``_``: ``force_frequency``. The struct ``units`` names the unit of every
        column, ``iva_version`` is the version of iva.

        Parameters
        ----------
        path : str or path
            The file, usually ``*.mat`` (MAT files of version 7). It is written whole or not at all.

        Raises
        ------
        ImportError
            Without SciPy (``pip install 'iva-dynamics[export]'``).
        TypeError, ValueError
            If `path` is not a file in a folder that exists, or a table takes more than 2.1 GB.
        iva.IvaError
            If the file cannot be written.
        """
        from iva import exports

        exports.write_mat(path, self._frames, self.units)

    def __eq__(self, other: object) -> bool:
        """Compare axes, units and all tables."""
        if not isinstance(other, Table):
            return NotImplemented
        return (
            self.swept == other.swept
            and self.units == other.units
            and self._frames == other._frames
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        """Show axes, tables and units."""
        over = " × ".join(self.swept) or "no axis"
        return visible(f"Table over {over}: {', '.join(self.tables)}\n  {self.units}")

    def _repr_html_(self) -> str:
        """Show axes, outcomes, tables and units in a notebook; this reads the summary."""
        from iva import markup

        return markup.of_table(self)
