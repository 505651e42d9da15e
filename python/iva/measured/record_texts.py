"""The text of a recorded force, as a study reads it."""

from __future__ import annotations

from collections.abc import Iterator

from iva.exports import aside
from iva.forces import Recorded


def write_record(path: object, force: Recorded) -> None:
    """Write times and values of a record, times its factor, into a file.

    Raises
    ------
    TypeError, ValueError, iva.IvaError
        As :meth:`iva.Recorded.write`.
    """
    with aside(path) as made:
        made.write_text("\n".join(lines(force)) + "\n", encoding="utf-8")


def lines(force: Recorded) -> Iterator[str]:
    """Give the head with the units, and a time and a value a line, with all their digits.

    Examples
    --------
    >>> list(lines(Recorded([0, 0.1], [0, 5], "force_newtons", scale=2)))
    ['time (s),force (N)', '0.0,0.0', '0.1,10.0']
    """
    if force.is_metric:
        yield "time (s),acceleration (m/s^2)"
    elif force.kind == "force_newtons":
        yield "time (s),force (N)"
    else:  # in the units of the scene
        yield "time,value (1)"
    values = force.values * force.scale
    for time, value in zip(force.times.tolist(), values.tolist(), strict=True):
        yield f"{time!r},{value!r}"
