"""Sections of a run: its states at instants that repeat."""

from __future__ import annotations

from iva.design import design_of
from iva.dynamics.search import NAMES, whole
from iva.parameters import shown
from iva.simulation import Run
from iva.spelling import spell_checked

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Literal

    import polars as pl

#: The instants that there are.
INSTANTS = ("strobe", "wall+", "wall-", "peak")


@spell_checked
def section(
    run: Run, at: Literal["strobe", "wall+", "wall-", "peak"] = "strobe", *, discard: int = 0
) -> pl.DataFrame:
    """Return the states of a run at instants that repeat: a Poincaré section.

    Parameters
    ----------
    run : Run
        A run with the table that it needs: ``stroboscope``, ``impacts`` or ``envelope``; all are
        made unless :func:`iva.simulate` was given others.
    at : {"strobe", "wall+", "wall-", "peak"}, default "strobe"
        ``strobe``: where the phase of the harmonic force is a multiple of 2π, after the cycles that
        the run discards. ``wall+``, ``wall-``: just before the impacts on the wall at y = +d or
        y = −d. ``peak``: where |x| is largest between two zeros of x.
    discard : int, default 0
        Number of states to leave out at the begin.

    Returns
    -------
    polars.DataFrame
        One row an instant: time, displacement, velocity, gap_displacement and gap_velocity, in the
        units of the run.

    Raises
    ------
    TypeError
        If an argument is of the wrong class.
    ValueError
        If there are no such instants, or the run has no absorber or was made without the table.

    Examples
    --------
    >>> run = iva.simulate(
    ...     iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5),
    ...     iva.Primary(damping_ratio=0.05),
    ...     start=iva.Start(gap_velocity=0.1),
    ...     force=iva.Harmonic(amplitude=1.0, frequency=1.0),
    ...     cycles=300,
    ... )
    >>> section(run, discard=200)["displacement"].round(3).unique().to_list()
    [-1.103]
    """
    if not isinstance(run, Run):
        raise TypeError(f"run = {shown(run)}: give an iva.Run, of iva.simulate")
    if at not in INSTANTS:
        raise ValueError(f"at = {shown(at)}: give {', '.join(INSTANTS)}")
    if isinstance(run.absorber, tuple) and len(run.absorber) > 1:
        count = len(run.absorber)
        raise ValueError(f"run has {count} absorbers: a section is of one; give such a run")
    if run.absorber is None:
        raise ValueError("run: it has no absorber; a section shows the motion in the gap as well")
    skipped = whole("discard", discard, 0, 10**12)
    try:
        frame = made(run, at)
    except AttributeError as error:
        raise ValueError(str(error)) from None
    return frame.slice(skipped)


def made(run: Run, at: str) -> pl.DataFrame:
    """Return all states of a section.

    Raises
    ------
    AttributeError
        If the run was made without the table.
    """
    import polars as pl

    columns = ("time", *NAMES)
    if at == "strobe":
        return run.stroboscope.select(columns)
    if at == "peak":
        times = run.envelope["time"]
        return run.at(times).select(columns)
    side = 1 if at == "wall+" else -1
    design = design_of(run)
    assert design.clearance is not None
    hits = run.impacts.filter(pl.col("wall") == side)
    return hits.select(
        "time",
        "displacement",
        pl.col("velocity_before").alias("velocity"),
        pl.lit(design.gap_offset + side * design.clearance).alias("gap_displacement"),
        pl.col("approach_velocity").alias("gap_velocity"),
    )
