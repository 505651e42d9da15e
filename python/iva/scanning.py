"""Tables of a folder as lazy frames, for sweeps that do not fit into memory."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from iva import _iva
from iva.parts import lazy
from iva.reading import Found, found_in
from iva.spelling import spell_checked
from iva.units import Units

if TYPE_CHECKING:
    import polars as pl


class Scan:
    """Result of :func:`scan`: the tables of a folder, of which a query reads what it needs.

    Attributes of tables are polars lazy frames, with the columns of :class:`iva.Table`. `swept` are
    the keys of the axes, `units` names the unit of every column. Scans can be copied and pickled.
    """

    def __init__(self, folder: str, found: Found) -> None:
        self.folder = folder
        self.swept: tuple[str, ...] = found.swept
        self.units: Units = found.units
        self._found = found

    @property
    def tables(self) -> tuple[str, ...]:
        """Names of the tables that are there."""
        return tuple(self._found.parts)

    @property
    def summary(self) -> pl.LazyFrame:
        """Swept parameters, then outcome, counts, measures and energies, a row a point."""
        return self._lazy("summary")

    @property
    def impacts(self) -> pl.LazyFrame:
        """Time, wall (±1), both states, energy loss and ``effective``, a row an impact."""
        return self._lazy("impacts")

    @property
    def episodes(self) -> pl.LazyFrame:
        """One row a chatter that ends in stick, a plastic stick, or a start at rest on a wall."""
        return self._lazy("episodes")

    @property
    def envelope(self) -> pl.LazyFrame:
        """One row a peak of the primary displacement."""
        return self._lazy("envelope")

    @property
    def stroboscope(self) -> pl.LazyFrame:
        """One row a cycle of the harmonic force (of several, the first), after `discard`."""
        return self._lazy("stroboscope")

    @property
    def absorbers(self) -> pl.LazyFrame:
        """Impacts, energy loss, time stuck and largest impulse, a row an absorber and point."""
        return self._lazy("absorbers")

    def _lazy(self, name: str) -> pl.LazyFrame:
        if name not in self.tables:
            raise AttributeError(
                f"no table {name!r} in {self.folder!r}, only {', '.join(self.tables)}"
            )
        return lazy(self._found.parts[name], self._found.tables.get(name))

    def __reduce__(self) -> tuple[object, tuple[str]]:
        """Return what opens the same folder again."""
        return scan, (self.folder,)

    def __repr__(self) -> str:
        """Show folder, axes, tables and units."""
        over = " × ".join(self.swept) or "no axis"
        files = max(len(files) for files in self._found.parts.values())
        return _iva.visible(
            f"Scan of {self.folder} over {over}: {', '.join(self.tables)}; {files} parts\n"
            f"  {self.units}"
        )


@spell_checked
def scan(folder: str | os.PathLike[str], *, check: bool = False) -> Scan:
    """Open the tables of a folder without reading them.

    Parameters
    ----------
    folder : str or path
        As in :func:`iva.read`; also one that a sweep is filling just now, of which the complete
        parts are seen.
    check : bool, default False
        Compare all files with the SHA-256 that ``manifest.json`` holds of them, now: every byte is
        read once for that. Without it only sizes and metadata are checked, and what changed in a
        file since it was written may be read without a word, or end a query in an error of polars.

    Returns
    -------
    Scan
        Lazy frames.

    Raises
    ------
    TypeError, ValueError, iva.IvaError
        As :func:`iva.read`.

    Examples
    --------
    >>> found = iva.scan("results/siva_clearance")  # doctest: +SKIP
    >>> light = found.summary.filter(pl.col("mass_ratio") < 0.1)  # doctest: +SKIP
    >>> light.select("point", "settling_time_5").collect(engine="streaming")  # doctest: +SKIP
    """
    found = found_in(folder, check=check)
    _iva.check_files([sum_ for sums in found.sums.values() for sum_ in sums])
    return Scan(os.fspath(folder), found)
