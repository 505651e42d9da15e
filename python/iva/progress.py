"""How far a sweep is: a bar or a line for people who watch, or what the user calls."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeAlias

from iva.parameters import shown

Progress: TypeAlias = Callable[[int, int], object]


@contextmanager
def reporting(progress: bool | Progress) -> Iterator[Progress | None]:
    """Give the function that is told (done, total), or None if nobody wants to know.

    Parameters
    ----------
    progress : bool or callable
        True: a bar of tqdm where that is installed, else a line on stderr; neither where stderr
        is no terminal and Python runs in no notebook.

    Raises
    ------
    TypeError
        If `progress` is neither.
    """
    if callable(progress):
        yield progress
    elif not isinstance(progress, bool):
        raise TypeError(
            f"progress = {shown(progress)}: give True, False or a callable (done, total)"
        )
    elif progress and watched():
        with drawing() as draw:
            yield draw
    else:
        yield None


def watched() -> bool:
    """Tell whether somebody sees what is drawn: on a terminal, or in a notebook."""
    terminal = sys.stderr is not None and sys.stderr.isatty()
    return terminal or "ipykernel" in sys.modules


@contextmanager
def drawing() -> Iterator[Progress]:
    """Give the function that draws the state of things; what it began is ended in any case."""
    try:
        from tqdm.auto import tqdm
    except ImportError:
        with line() as draw_line:
            yield draw_line
        return
    bars: list[tqdm[object]] = []

    def draw(done: int, total: int) -> None:
        if not bars:
            bars.append(tqdm(total=total, unit="point", unit_scale=True))
        bars[0].update(done - bars[0].n)

    try:
        yield draw
    finally:
        for bar in bars:
            bar.close()


@contextmanager
def line() -> Iterator[Progress]:
    """Give the function that rewrites a line on stderr."""
    begun = False

    def draw(done: int, total: int) -> None:
        nonlocal begun
        begun = True
        print(f"\r{done} of {total} points", end="", file=sys.stderr, flush=True)

    try:
        yield draw
    finally:
        if begun:
            print(file=sys.stderr)
