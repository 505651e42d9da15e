"""Results with lengths in millimetres: the same tables, times a thousand where metres stand."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from iva.frames import Frames
from iva.run_tables import RunTables
from iva.units import Units

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    import polars as pl

    from iva.simulation import Run


class RunInMm(RunTables):
    """The tables of a run with lengths in mm; all else is in the units of the run.

    It is what :attr:`iva.Run.in_mm` returns. `units` names the unit of every column.

    Examples
    --------
    >>> run = iva.simulate(
    ...     iva.Siva(mass=0.3, restitution=0.6, gap_mm=5.0),
    ...     iva.Primary(mass=3.0, stiffness=12_000.0),
    ...     start=iva.Start(displacement_mm=4.0),
    ...     duration=1.0,
    ... )
    >>> run.in_mm.at([0.0])["displacement"].item(), run.in_mm.units["trajectory"]["velocity"]
    (4.0, 'm/s')
    """

    def __init__(self, run: Run, frames: Frames) -> None:
        self.units = run.units.in_mm()
        super().__init__(scaled(frames, run.units))
        self._run = run

    def trajectory(self, samples_per_period: int = 200) -> pl.DataFrame:
        """Compute the motion in time, as :meth:`iva.Run.trajectory`."""
        rows = self._run.trajectory(samples_per_period)
        return times_thousand(rows, self._run.units["trajectory"])

    def at(self, times: Iterable[float]) -> pl.DataFrame:
        """Compute the state at given instants, as :meth:`iva.Run.at`."""
        return times_thousand(self._run.at(times), self._run.units["trajectory"])

    def __repr__(self) -> str:
        """Show the run and the units."""
        return f"RunInMm of {self._run!r}\n  here: {self.units}"


def scaled(frames: Frames, units: Units) -> Frames:
    """Return frames of which each column in metres is in millimetres."""

    def source(name: str) -> Callable[[], pl.DataFrame]:
        return lambda: times_thousand(frames[name], units[name])

    return Frames({name: source(name) for name in frames.names})


def times_thousand(frame: pl.DataFrame, units: Mapping[str, str]) -> pl.DataFrame:
    """Return a frame with its columns in metres times a thousand."""
    import polars as pl

    metric = [name for name in frame.columns if units.get(name) == "m"]
    return frame.with_columns(pl.col(metric) * 1000.0)
