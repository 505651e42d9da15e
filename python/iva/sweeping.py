"""Many runs: over a grid, or at points of any other choice."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import TYPE_CHECKING, Any

from iva import _iva
from iva.doubts import warn_of_doubts
from iva.forces import Force
from iva.frames import from_arrow
from iva.manifests import FILE, manifest_of
from iva.parameters import Absorbers, Primary, Start, number, shown
from iva.progress import Progress, reporting
from iva.reading import read
from iva.sampling import Over, Sampling, points_of
from iva.scenes import scene
from iva.simulation import names, truth
from iva.spelling import spell_checked
from iva.structures import Structure
from iva.tables import Table
from iva.units import from_metadata

if TYPE_CHECKING:
    pass

#: Default of `memory_limit` in bytes.
MEMORY_LIMIT = 4e9


@spell_checked
def sweep(
    absorber: Absorbers | None,
    primary: Primary | Structure,
    *,
    over: Over,
    start: Start,
    sampling: Sampling | str = "grid",
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
    out: str | os.PathLike[str] | None = None,
    resume: bool = False,
    overwrite: bool = False,
    format: str = "parquet",  # noqa: A002 (the word of the command)
    memory_limit: float = MEMORY_LIMIT,
    threads: int | None = None,
    executor: Executor | None = None,
    client: Any = None,
    progress: bool | Progress = False,
) -> Table:
    """Simulate many points, in parallel.

    Parameters
    ----------
    absorber, primary, start, force
        As in :func:`iva.simulate`, `absorber` also a list of several, or ``None``: the structure
        alone. What is swept may be left out.
    over : mapping of str to sequence of float, or a frame of polars or pandas
        The axes: field name (``"mass_ratio"``; ``"absorber.mass"`` where the bare name is not
        unique; ``"force.frequency"`` of a force, ``"force.0.frequency"`` of several;
        ``"absorber.1.clearance"`` of one of several absorbers, ``"clearance"`` of all) → values,
        shape (n,). The product of all axes is run, in the order of the mapping, the last axis
        fastest. A swept field replaces its alternatives, so that an axis over ``gap`` replaces a
        given ``clearance``. With `sampling` field name → distribution. Of a frame each row is a
        point, its columns are named like axes.
    sampling : {"grid", "zip"} or a sample of :mod:`iva.sampling`
        ``"zip"`` reads the values of all axes in step. A sample
        (:class:`iva.sampling.Sobol`, ``LatinHypercube``, ``Random``) draws points from
        distributions.
    periods, duration, cycles, discard, measures, max_impacts, max_work, chatter_floor
        As in :func:`iva.simulate`.
    tolerance : float, default 0
        As in :func:`iva.simulate`. Above 0, sweeps of free masses under a harmonic force that ask
        for the summary alone are 1.4 to 1.7 times as fast; impact times are off by some rounding
        units more.
    errors : bool, default False
        Estimate the error of every impact time: the columns ``time_error`` and ``near_grazing`` of
        the impacts, ``condition`` and ``digits`` of the summary. Sweeps of free masses take twice
        as long, those of pendulums ten times.
    tables : iterable of str, default ("summary",)
        Tables to make: ``summary``, ``impacts``, ``episodes``, ``envelope``, ``stroboscope``,
        ``absorbers``.
    out : str or path, optional
        Folder to write the tables into, part by part as they are done; memory stays small whatever
        the number of points. Without it tables are gathered in memory. With `executor` or `client`
        every worker must be able to write it under the same name, and it may also be a URL that
        fsspec knows.
    resume : bool, default False
        Go on with the sweep that `out` holds: its complete parts are checked and kept, the others
        are run. Where it holds none the sweep begins.
    overwrite : bool, default False
        Replace the tables that `out` holds, once the new ones are complete.
    format : {"parquet", "arrow", "csv"}
        What tables are written as into `out`.
    memory_limit : float, default 4e9
        Bytes that the tables may take in memory. A sweep that would take more is refused before it
        begins; `out` has no such limit.
    threads : int, optional
        Worker threads, one a core by default. The result does not depend on it.
    executor : concurrent.futures.Executor, optional
        Runs the parts of the sweep, each on one thread of one of its workers, instead of `threads`.
    client : dask.distributed.Client, optional
        Runs the parts of the sweep on a cluster. A part whose worker dies is run by another.
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
        point, there are more than 2³² points, the tables would exceed `memory_limit`, or `out`
        holds something else.
    iva.IvaError
        If a file cannot be written; complete parts are kept.
    KeyboardInterrupt
        On Ctrl-C, within about a second. With `out` complete parts are kept, and ``resume=True``
        goes on; else nothing of the sweep comes back. Python hands the signal to its main thread
        only: a sweep in another thread goes on to its end.

    Warns
    -----
    UserWarning
        As :func:`iva.simulate`, of what is swept by the middle of its axis; or if files that `out`
        holds were not what was written.

    Examples
    --------
    >>> table = iva.sweep(
    ...     iva.Siva(mass_ratio=0.1, restitution=0.5), iva.Primary(damping_ratio=0.01),
    ...     over={"relative_clearance": [0.4, 0.5, 0.6]},
    ...     start=iva.Start(displacement=1.0), periods=20)
    >>> table.summary.height
    3
    """
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
        several=True,
    )
    points = points_of(over, sampling)
    study = _iva.Study(
        spec,
        points,
        chosen,
        names("measures", measures),
        truth("errors", errors),
    )
    warn_of_doubts(spec, points)
    limit = number("memory_limit", memory_limit)
    if out is None:
        for name, asked in (("resume", resume), ("overwrite", overwrite)):
            if truth(name, asked):
                raise ValueError(f"{name} = True: it is about a folder; give out")
        if format != "parquet":
            raise ValueError(f"format = {shown(format)}: it is about a folder; give out")
    with reporting(progress) as report:
        pool = None
        if executor is not None or client is not None:
            from iva import distributed

            pool = distributed.pool_of(executor, client)
            if out is None:
                return distributed.gathered(study, pool, limit, report)
        if out is None:
            made = study.run(threads, report, limit)
            metadata = next(iter(made.values())).metadata
            swept = tuple(study.swept)
            return Table(swept, from_metadata(metadata, swept), from_arrow(made))
        how = (format, truth("resume", resume), truth("overwrite", overwrite))
        if isinstance(out, str) and "://" in out:
            from iva import remote

            if pool is None:
                raise ValueError(f"out = {out!r}: a URL needs executor or client; give a folder")
            table, damaged = remote.written(study, pool, out, *how, report)
            warned(damaged)
            return table
        folder = Path(out)
        if pool is not None:
            warned(distributed.written(study, pool, folder, *how, report))
        else:
            replaces = overwrite and (folder / FILE).exists()
            try:
                warned(_iva.sweep_into(study, folder, *how, threads, report))
            except KeyboardInterrupt as interrupt:
                interrupt.add_note(_iva.visible(kept(folder, replaces)))
                raise
    return read(folder)


def kept(folder: Path, replaces: bool) -> str:
    """Return a sentence on what is left of a sweep that was interrupted.

    Parameters
    ----------
    folder : Path
        Where it wrote to.
    replaces : bool
        It was to replace tables that the folder holds; new ones grow in a hidden folder.
    """
    new = folder / ".iva-new"
    what = f"; {folder} is as it was" if replaces else ", so nothing was written"
    if replaces and not new.is_dir():
        return f"nothing was finished{what}"
    try:
        manifest = manifest_of(new if replaces else folder)
    except _iva.IvaError as error:
        return str(error)
    if manifest is None or not manifest.parts:
        return f"nothing was finished{what}"
    how = "overwrite=True, resume=True" if replaces else "resume=True"
    done = f"{manifest.done} of {manifest.points} points are written to {folder}"
    return f"{done}; go on with {how}"


def warned(damaged: Sequence[str]) -> None:
    """Warn of files that were not what was written, and have been computed again.

    The warning points to the line that calls :func:`sweep`, which is `spell_checked`.
    """
    if damaged:
        import warnings

        files = ", ".join(damaged)
        warnings.warn(f"not what was written, and computed again: {files}", stacklevel=4)
