"""The tables of a result as polars frames, each converted or read when first asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Any

    import polars as pl

    from iva._iva import ArrowTable

NAMES = ("summary", "impacts", "episodes", "envelope", "stroboscope", "absorbers", "trajectory")


def to_polars(table: ArrowTable) -> pl.DataFrame:
    """Return an Arrow table as a polars frame, without copying."""
    import polars as pl

    return pl.DataFrame(table)


class Frames:
    """Frames by table name; a frame is made on first use and kept.

    Parameters
    ----------
    sources : mapping of str to callable
        For each table a function without arguments that returns its frame.
    """

    def __init__(self, sources: Mapping[str, Callable[[], pl.DataFrame]]) -> None:
        self._sources = dict(sources)
        self._frames: dict[str, pl.DataFrame] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the tables, in their customary order."""
        return tuple(name for name in NAMES if name in self._sources or name in self._frames)

    def __getitem__(self, name: str) -> pl.DataFrame:
        """Return a frame.

        Raises
        ------
        KeyError
            If there is no such table.
        """
        if name not in self._frames:
            # Two threads may both load it; the first to finish is kept.
            self._frames.setdefault(name, self._sources[name]())
        return self._frames[name]

    def __eq__(self, other: object) -> bool:
        """Compare names, column names and types, and all values."""
        if not isinstance(other, Frames):
            return NotImplemented
        return self.names == other.names and all(
            self[name].schema == other[name].schema and self[name].equals(other[name])
            for name in self.names
        )

    __hash__ = None  # type: ignore[assignment]

    def __getstate__(self) -> dict[str, Any]:
        """Return all frames: what is copied or sent elsewhere depends on nothing here."""
        return {name: self[name] for name in self.names}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Take the frames of `__getstate__`."""
        self._sources = {}
        self._frames = dict(state)


def from_arrow(tables: Mapping[str, ArrowTable]) -> Frames:
    """Return the frames of tables that the compiled part made."""

    def source(table: ArrowTable) -> Callable[[], pl.DataFrame]:
        return lambda: to_polars(table)

    return Frames({name: source(table) for name, table in tables.items()})
