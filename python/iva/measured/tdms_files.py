"""TDMS files of LabVIEW and DIAdem; needs npTDMS."""

from __future__ import annotations

import math
from functools import partial
from io import BytesIO
from typing import Any

import numpy as np

from iva.measured.channels import Channel
from iva.measured.clocks import evenly
from iva.measured.sensor_units import parted, unit_of


def channels_of_tdms(path: str, contents: bytes) -> list[Channel]:
    """Return the channels of numbers in a TDMS file, ``group.channel``.

    Units are those of the property ``unit_string``, steps those of ``wf_increment``; the name of
    the group may be left out where it is the only one.

    Raises
    ------
    ImportError
        Without npTDMS.
    ValueError
        If the file is damaged, or has no numbers.
    """
    try:
        from nptdms import TdmsFile
    except ImportError as error:
        raise ImportError(
            "reading a TDMS file needs npTDMS: pip install 'iva-dynamics[tdms]'"
        ) from error
    try:
        groups = TdmsFile.read(BytesIO(contents)).groups()
        there = [(group.name, one, one[:]) for group in groups for one in group.channels()]
    except Exception as error:  # npTDMS raises what comes, of several classes
        raise ValueError(f"{path}: a damaged TDMS file ({error}); save it anew") from error
    channels = [
        channel(group, one, np.asarray(values), is_alone=len(groups) == 1)
        for group, one, values in there
        if np.asarray(values).dtype.kind in "iuf" and len(values) > 1
    ]
    if not channels:
        raise ValueError(f"{path}: no channels of numbers in it; give times and values")
    return channels


def channel(group: str, one: Any, values: Any, *, is_alone: bool) -> Channel:
    """Return a channel of npTDMS with its samples."""
    name, unit = parted(one.name)
    stated = str(one.properties.get("unit_string", "")).strip() or unit
    begin, step = (number(one, key) for key in ("wf_start_offset", "wf_increment"))
    return Channel(
        name=f"{group}.{one.name}",
        also=(one.name, name) if is_alone else (f"{group}.{name}",),
        unit=unit_of(stated) if stated else None,
        stated=stated,
        length=len(values),
        load=partial(values.astype, np.float64),
        clock=partial(evenly, begin, step, len(values)) if step > 0.0 else None,
    )


def number(one: Any, key: str) -> float:
    """Return a property of a channel that is a finite number, 0 if it is none."""
    value = one.properties.get(key, 0.0)
    return float(value) if isinstance(value, (int, float)) and math.isfinite(value) else 0.0
