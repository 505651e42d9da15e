"""Many runs over a grid of parameters."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from iva import _iva
from iva.forces import Force
from iva.frames import Frames, from_arrow
from iva.parameters import Absorber, Primary, Start, numbers, shown
from iva.progress import Progress, reporting
from iva.scenes import scene
from iva.simulation import names, truth
from iva.units import Units, from_metadata

if TYPE_CHECKING:
    import polars as pl


class Table:
    """Result of :func:`sweep` or :func:`iva.read`: the tables of many runs.

    Attributes of tables are polars frames, made on first use; all begin with ``point``, the index
    into the grid (row-major, last axis fastest). `swept` are the keys of the axes, `units` names
    the unit of every column. Tables can be copied, pickled and compared.
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
        """One row a point: the swept parameters, then outcome, counts, measures, energies."""
        return self._frame("summary")

    @property
    def impacts(self) -> pl.DataFrame:
        """One row an impact: time, wall (±1), both states, energy loss, ``effective``."""
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
    def trajectory(self) -> pl.DataFrame:
        """The motion in time: only in a folder that ``iva run`` wrote."""
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
        return f"Table over {over}: {', '.join(self.tables)}\n  {self.units}"

    def _repr_html_(self) -> str:
        """Show axes, outcomes, tables and units in a notebook; this reads the summary."""
        from iva import markup

        return markup.of_table(self)


def sweep(
    absorber: Absorber,
    primary: Primary,
    *,
    over: Mapping[str, Iterable[float]],
    start: Start,
    force: Force | Sequence[Force] | None = None,
    periods: float | None = None,
    duration: float | None = None,
    cycles: float | None = None,
    discard: float | None = None,
    tables: Iterable[str] = ("summary",),
    measures: Iterable[str] | None = None,
    max_impacts: float | None = None,
    max_work: float | None = None,
    chatter_floor: float | None = None,
    tolerance: float | None = None,
    errors: bool = False,
    threads: int | None = None,
    progress: bool | Progress = False,
) -> Table:
    """Simulate every point of a grid, in parallel.

    Parameters
    ----------
    absorber, primary, start, force
        As in :func:`iva.simulate`; what is swept may be left out.
    over : mapping of str to sequence of float
        The axes: field name (``"mass_ratio"``; ``"absorber.mass"`` where the bare name is not
        unique; ``"force.frequency"`` of a force, ``"force.0.frequency"`` of several) → values,
        shape (n,). The product of all axes is run, in the order of the mapping, the last axis
        fastest. A swept field replaces its alternatives, so that an axis over ``gap`` replaces a
        given ``clearance``.
    periods, duration, cycles, discard, measures, max_impacts, max_work, chatter_floor, tolerance
        As in :func:`iva.simulate`.
    errors : bool, default False
        Estimate the error of every impact time: the columns ``time_error`` and ``near_grazing`` of
        the impacts, ``condition`` and ``digits`` of the summary. It takes about ten times as long.
    tables : iterable of str, default ("summary",)
        Tables to make: ``summary``, ``impacts``, ``episodes``, ``envelope``, ``stroboscope``.
    threads : int, optional
        Worker threads, one a core by default. The result does not depend on it.
    progress : bool or callable, default False
        True: a bar of tqdm where that is installed, else a line on stderr; neither where stderr
        is no terminal and Python runs in no notebook. A callable is called with (done, total) on
        the calling thread, at most every 50 ms; what it raises ends the sweep and comes out as
        it is.

    Returns
    -------
    Table
        A point that fails is a row of the summary with its outcome.

    Raises
    ------
    TypeError
        If an argument is of the wrong type.
    ValueError
        If there is no axis, a key is unknown, an axis is empty, a value is out of range at any
        point, or the grid has more than 2³² points.
    KeyboardInterrupt
        On Ctrl-C, within about a second; nothing of the sweep comes back. Python hands the signal
        to its main thread only: a sweep in another thread goes on to its end.

    Examples
    --------
    >>> table = iva.sweep(
    ...     iva.Siva(mass_ratio=0.1, restitution=0.5), iva.Primary(damping_ratio=0.01),
    ...     over={"relative_clearance": [0.4, 0.5, 0.6]},
    ...     start=iva.Start(displacement=1.0), periods=20)
    >>> table.summary.height
    3
    """
    if not isinstance(over, Mapping):
        raise TypeError(f"over = {shown(over)}: give a mapping from field names to values")
    for key in over:
        if not isinstance(key, str):
            raise TypeError(f"over has the key {shown(key)}: give field names")
    if not over:
        raise ValueError(
            "over = {}: give at least one axis, for example {'mass_ratio': [0.05, 0.1]}, or call "
            "iva.simulate for a single run"
        )
    chosen = names("tables", tables)
    if chosen is None:
        raise TypeError("tables = None: give names")
    spec = scene(
        absorber,
        primary,
        start,
        force,
        {
            "periods": periods,
            "duration": duration,
            "cycles": cycles,
            "discard": discard,
            "max_impacts": max_impacts,
            "max_work": max_work,
            "chatter_floor": chatter_floor,
            "tolerance": tolerance,
        },
    )
    axes = [(key, numbers(f"sweep.{key}", values)) for key, values in over.items()]
    with reporting(progress) as report:
        made = _iva.sweep(
            spec,
            axes,
            chosen,
            names("measures", measures),
            threads,
            report,
            truth("errors", errors),
        )
    swept = tuple(key for key, _ in axes)
    metadata = next(iter(made.values())).metadata
    return Table(swept, from_metadata(metadata, swept), from_arrow(made))
