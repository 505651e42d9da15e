"""How far a sweep is: a line on the terminal, or what the user calls."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeAlias

Progress: TypeAlias = Callable[[int, int], object]


@contextmanager
def reporting(progress: bool | Progress) -> Iterator[Progress | None]:
    """Give the function that is told (done, total), or None if nobody wants to know.

    Parameters
    ----------
    progress : bool or callable
        True: a line on stderr, if that is a terminal.

    Raises
    ------
    TypeError
        If `progress` is neither.
    """
    if callable(progress):
        yield progress
    elif not isinstance(progress, bool):
        raise TypeError(f"progress = {progress!r}: give True, False or a callable (done, total)")
    elif progress and sys.stderr.isatty():
        try:
            yield line
        finally:
            print(file=sys.stderr)
    else:
        yield None


def line(done: int, total: int) -> None:
    """Rewrite the line on stderr."""
    print(f"\r{done} of {total} points", end="", file=sys.stderr, flush=True)
