"""Sweeps whose parts are run by other processes, here or on other machines.

A part is a piece of a few seconds. It is sent to a worker with what describes it (some hundred
bytes, of a Latin hypercube or a frame its points), and is run there on one thread. Where a folder
is written the worker writes the files of the part, and this process moves them into place; else
the tables of the part travel back.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from iva import _iva
from iva.frames import Frames, to_polars
from iva.parameters import shown
from iva.progress import Report
from iva.tables import Table
from iva.units import from_metadata

if TYPE_CHECKING:
    import polars as pl

T = TypeVar("T")
#: Number of a part, its first point, and the one after its last.
Part = tuple[int, int, int]

#: Parts that wait for each worker, so that none is ever idle.
AHEAD = 3
#: Workers of an executor that does not say how many it has.
UNKNOWN = 64
#: Seconds between looks at Ctrl-C.
WAKE = 0.2


def pool_of(executor: Executor | None, client: Any) -> Executor:
    """Return the executor that is to run the parts.

    Raises
    ------
    TypeError
        If it is none.
    ValueError
        If both are given.
    """
    if client is None:
        if not isinstance(executor, Executor):
            raise TypeError(f"executor = {shown(executor)}: give a concurrent.futures.Executor")
        return executor
    if executor is not None:
        raise ValueError("executor and client are given: give one of them")
    if not hasattr(client, "get_executor"):
        raise TypeError(f"client = {shown(client)}: give a dask.distributed.Client")
    # Not pure: a part that writes files is never taken from a cache.
    pool: Executor = client.get_executor(pure=False)
    return pool


def workers_of(pool: Executor) -> int:
    """Return how many parts an executor runs at a time."""
    client = getattr(pool, "_client", None)
    if client is not None:
        threads: dict[str, int] = client.nthreads()
        return max(1, sum(threads.values()))
    known = getattr(pool, "_max_workers", UNKNOWN)
    return known if isinstance(known, int) else UNKNOWN


def run_part(study: _iva.Study, first: int, last: int, folder: str, style: str) -> str:
    """Run a part on a worker and write its files into a folder; return what they hold."""
    return study.run_part(first, last, folder, style)


def part_tables(study: _iva.Study, first: int, last: int) -> dict[str, pl.DataFrame]:
    """Run a part on a worker and return its tables."""
    return {name: to_polars(table) for name, table in study.run_points(first, last).items()}


def results(
    pool: Executor,
    parts: list[Part],
    submit: Callable[[Part], Future[T]],
) -> Iterator[tuple[Part, T]]:
    """Give the parts with their results, as they come; on any error the others are cancelled."""
    waiting = iter(parts)
    futures: dict[Future[T], Part] = {}
    try:
        while True:
            # Asked each time: a cluster may grow.
            for part in islice(waiting, max(0, AHEAD * workers_of(pool) - len(futures))):
                futures[submit(part)] = part
            if not futures:
                return
            # Wakes now and then: on some systems a wait without end is deaf to Ctrl-C.
            ended, _ = wait(futures, timeout=WAKE, return_when=FIRST_COMPLETED)
            for future in ended:
                part = futures.pop(future)
                yield part, future.result()
    finally:
        for future in futures:
            future.cancel()


def gathered(
    study: _iva.Study, pool: Executor, memory_limit: float, report: Report | None
) -> Table:
    """Run a study and gather its tables.

    Raises
    ------
    ValueError
        For an invalid point, and if the tables would exceed `memory_limit` bytes.
    """
    import polars as pl

    points = study.points
    size = study.part_points(memory_limit)
    parts = [
        (number, first, min(points, first + size))
        for number, first in enumerate(range(0, points, size))
    ]

    def submit(part: Part) -> Future[dict[str, pl.DataFrame]]:
        _, first, last = part
        return pool.submit(part_tables, study.part(first, last), first, last)

    made: dict[int, dict[str, pl.DataFrame]] = {}
    done = failed = 0
    for (number, first, last), tables in results(pool, parts, submit):
        made[number] = tables
        done += last - first
        if "summary" in tables:
            failed += int((tables["summary"]["outcome"] != "finished").sum())
        if report is not None:
            report(done, points, failed)
    empty = study.run_points(0, 0)
    metadata = next(iter(empty.values())).metadata
    frames = {name: pl.concat([made[part[0]][name] for part in parts]) for name in empty}
    swept = tuple(study.swept)

    def source(frame: pl.DataFrame) -> Callable[[], pl.DataFrame]:
        return lambda: frame

    sources = {name: source(frame) for name, frame in frames.items()}
    return Table(swept, from_metadata(metadata, swept), Frames(sources))


@contextmanager
def closing(folder: _iva.SweepFolder) -> Iterator[None]:
    """Leave a folder in order, however the sweep ends."""
    try:
        yield
    except BaseException as error:
        error.add_note(folder.abandon())
        raise
    folder.close()


def written(
    study: _iva.Study,
    pool: Executor,
    out: Path,
    style: str,
    resume: bool,
    overwrite: bool,
    report: Report | None,
) -> list[str]:
    """Run a study into a folder that every worker can write.

    Returns
    -------
    list of str
        Files of an earlier process that were not what they should be, and are computed again.

    Raises
    ------
    ValueError
        If the folder cannot take the sweep, or for an invalid point.
    iva.IvaError
        If a file cannot be written.
    """
    folder, damaged = _iva.SweepFolder.open(study, out, style, resume, overwrite)
    with closing(folder):
        points = study.points
        done, failed = folder.done
        work = str(folder.work.resolve())

        def submit(part: Part) -> Future[str]:
            _, first, last = part
            return pool.submit(run_part, study.part(first, last), first, last, work, style)

        for (number, _, _), staged in results(pool, folder.missing, submit):
            folder.take(number, staged)
            done, failed = folder.done
            if report is not None:
                report(done, points, failed)
    return damaged
