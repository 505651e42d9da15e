"""Values that no sensor measured: not finite, constant, or held while the signal was lost."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from iva import _iva

#: No sensor shows more in SI units; squares of larger values would be infinite.
LARGEST = 1e100

#: So many equal values in a row between two jumps are a dropout.
HELD = 8

#: A jump is larger than so many standard deviations of the record, and than so many times the least
#: change from one sample to the next, which of a coarse recorder is its resolution.
JUMP, LEVELS = 0.5, 8.0


def check_values(name: str, times: NDArray[np.float64], values: NDArray[np.float64]) -> None:
    """Check that a record can be that of a sensor.

    A dropout is a number that is missing, or a value that is held for 8 samples or more between
    two jumps. A value held at the begin or the end, or where a coarse recorder sees nothing move,
    is none.

    Parameters
    ----------
    name : str
        For messages.
    times : ndarray, shape (n,)
        Instants in s.
    values : ndarray, shape (n,)
        Values in SI units.

    Raises
    ------
    ValueError
        If it cannot.
    """
    name = _iva.visible(name)
    finite = np.isfinite(values)
    if not finite.all():
        at = int(np.argmin(finite))
        count = int(len(values) - finite.sum())
        raise ValueError(
            f"{name}: {count} of {len(values)} values are missing or not finite, the first at "
            f"{times[at]:.9g} s; give a record without dropouts, or cut it with begin and end"
        )
    if max(abs(values.max()), abs(values.min())) > LARGEST:
        raise ValueError(f"{name}: give values of at most {LARGEST:g} in size")
    if values.max() == values.min():
        raise ValueError(
            f"{name}: all {len(values)} values are {values[0]:.6g}; give a channel that moves"
        )
    # Begins of runs of equal values, and the end of the last.
    changes = np.abs(np.diff(values))
    edges = np.concatenate(([0], np.flatnonzero(changes) + 1, [len(values)]))
    first, last = edges[1:-2], edges[2:-1]
    jump = max(JUMP * float(values.std()), LEVELS * float(changes[changes > 0.0].min()))
    lost = (last - first >= HELD) & (changes[first - 1] > jump) & (changes[last - 1] > jump)
    if lost.any():
        at = int(np.argmax(lost))
        raise ValueError(
            f"{name}: the value is {values[first[at]]:.6g} from {times[first[at]]:.9g} s to "
            f"{times[last[at] - 1]:.9g} s, with a jump before and after; give a record without "
            "dropouts, or cut it with begin and end"
        )
