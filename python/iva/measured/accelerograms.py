"""Accelerograms of PEER (AT2), which the reader of recorded forces knows."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from iva import _iva
from iva.measured.channels import Channel
from iva.measured.sensor_units import unit_of

#: So many lines stand above the values.
HEADER_LINES = 4


def is_accelerogram(lines: Sequence[str]) -> bool:
    """Return whether lines are those of an AT2 file: one of the first four states NPTS."""
    return any(
        "NPTS" in line.upper() and not line.lstrip().startswith("#")
        for line in lines[:HEADER_LINES]
    )


def channels_of_accelerogram(path: str) -> list[Channel]:
    """Return the one channel of an AT2 file: accelerations, turned from g into m/s².

    Raises
    ------
    ValueError
        If something in the file cannot be used; the message names line and column.
    iva.IvaError
        If it cannot be read.
    """
    record = _iva.read_record(path)
    values = np.array(record.values)
    return [
        Channel(
            name="acceleration [g]",
            also=("acceleration",),
            unit=unit_of("g"),
            stated="g",
            length=len(values),
            load=values.copy,
            clock=partial(np.array, record.times),
            is_si=True,
            is_ground=True,
        )
    ]
