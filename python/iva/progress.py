"""How far a sweep is: a bar or a line for people who watch, or what the user calls."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta
from time import perf_counter
from typing import TypeAlias

from iva.parameters import shown

#: What a user gives: told (done, total), where a total of 0 says that it is not known.
Progress: TypeAlias = Callable[[int, int], object]
#: What the compiled part calls: told (done, total, failed).
Report: TypeAlias = Callable[[int, int, int], object]


@contextmanager
def reporting(progress: bool | Progress) -> Iterator[Report | None]:
    """Give the function that is told (done, total, failed), or None if nobody wants to know.

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
        told = progress
        yield lambda done, total, _failed: told(done, total)
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
def drawing() -> Iterator[Report]:
    """Give the function that draws the state of things; what it began is ended in any case."""
    try:
        from tqdm.auto import tqdm
    except ImportError:
        with line() as draw_line:
            yield draw_line
        return
    bars: list[tqdm[object]] = []

    def draw(done: int, total: int, failed: int) -> None:
        if not bars:
            # What was done before counts for neither rate nor time left.
            bars.append(tqdm(total=total or None, initial=done, unit="point", unit_scale=True))
        if failed:
            bars[0].set_postfix_str(f"{failed} failed", refresh=False)
        bars[0].update(done - bars[0].n)

    try:
        yield draw
    finally:
        for bar in bars:
            bar.close()


@contextmanager
def line() -> Iterator[Report]:
    """Give the function that rewrites a line on stderr."""
    begun: list[tuple[float, int]] = []
    longest = 0

    def draw(done: int, total: int, failed: int) -> None:
        if not begun:
            begun.append((perf_counter(), done))
        text = (
            f"{done} of {total} points{speed(begun[0], done, total)}" if total else f"{done} points"
        )
        if failed:
            text += f", {failed} failed"
        nonlocal longest
        longest = max(longest, len(text))
        print(f"\r{text:<{longest}}", end="", file=sys.stderr, flush=True)

    try:
        yield draw
    finally:
        if begun:
            print(file=sys.stderr)


def speed(begun: tuple[float, int], done: int, total: int) -> str:
    """Return the rate since the begin and the time left at it; nothing yet if it is too early."""
    seconds = perf_counter() - begun[0]
    more = done - begun[1]
    if more <= 0 or seconds < 0.1:
        return ""
    rate = more / seconds
    left = timedelta(seconds=round((total - done) / rate))
    return f", {rate:.3g} a second, {left} left"
