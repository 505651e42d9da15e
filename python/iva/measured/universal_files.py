"""Universal files (UFF, UNV): the time responses of datasets 58; needs pyuff."""

from __future__ import annotations

import warnings
from collections.abc import Collection
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from iva import _iva
from iva.measured.channels import Channel
from iva.measured.sensor_units import Unit, unit_of

#: Specific data types of dataset 58 that motions have, and the SI unit of each.
MOTIONS = {8: "m", 11: "m/s", 12: "m/s^2"}

#: Specific data types of an abscissa that may be time: unknown, general, time.
TIME_TYPES = (0, 1, 17)

#: Functions of time: general or unknown, time response.
RESPONSES = (0, 1)

#: What stands in a field that is empty.
EMPTY = {"", "NONE"}

#: Directions of a degree of freedom by their codes.
AXES = {1: "+X", 2: "+Y", 3: "+Z", -1: "-X", -2: "-Y", -3: "-Z"}


def channels_of_universal(path: str) -> list[Channel]:
    """Return the time responses of a universal file.

    The unit is the one on the axis of the ordinate; where none stands there it follows from the
    type of the data and the factors of dataset 164.

    Raises
    ------
    ImportError
        Without pyuff.
    ValueError
        If the file is damaged, or has no time responses.
    """
    sets = sets_of(path, (58, 164))
    metre = 1.0
    channels = []
    for one in sets:
        if one["type"] == 164:
            metre = float(one["length"])  # holds for the sets behind it
        elif is_response(one):
            channels.append(channel(one, metre))
    if not channels:
        raise ValueError(f"{_iva.visible(path)}: no time responses (dataset 58) in it; export some")
    return channels


def sets_of(path: str, kinds: Collection[int], hint: str = "") -> list[dict[str, Any]]:
    """Return the datasets of some kinds in a universal file, as pyuff reads them.

    Parameters
    ----------
    path : str
        Name of the file.
    kinds : collection of int
        Their numbers, such as 58.
    hint : str
        End of the sentence that refuses a damaged file.

    Raises
    ------
    ImportError
        Without pyuff.
    ValueError
        If the file is damaged.
    """
    try:
        import pyuff
    except ImportError as error:
        raise ImportError(
            "reading a universal file needs pyuff: pip install 'iva-dynamics[export]'"
        ) from error
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # pyuff leaves files open
            file = pyuff.UFF(path)
            there = [int(kind) for kind in file.get_set_types()]
            return [file.read_sets(place) for place, kind in enumerate(there) if kind in kinds]
    except Exception as error:  # pyuff raises Exception itself
        raise ValueError(
            f"{_iva.visible(path)}: a damaged universal file ({error}); export it anew{hint}"
        ) from error


def is_response(one: dict[str, Any]) -> bool:
    """Return whether a dataset 58 holds real numbers over time."""
    return (
        one["func_type"] in RESPONSES
        and one["abscissa_spec_data_type"] in TIME_TYPES
        and second(one) is not None
        and len(one["data"]) > 1
        and not np.iscomplexobj(one["data"])
    )


def second(one: dict[str, Any]) -> float | None:
    """Return the seconds in a unit of the abscissa, if it is known to be time."""
    text = label(one, "abscissa_axis_units_lab")
    if not text:
        return 1.0 if one["abscissa_spec_data_type"] == 17 else None
    unit = unit_of(text)
    return unit.factor if unit is not None and unit.quantity == "time" else None


def label(one: dict[str, Any], key: str) -> str:
    """Return a text of a dataset, '' if it is empty."""
    text = " ".join(str(one.get(key, "")).split())
    return "" if text in EMPTY else text


def channel(one: dict[str, Any], metre: float) -> Channel:
    """Return a dataset 58 as a channel, with `metre` units of length to a metre."""
    values: NDArray[np.float64] = np.asarray(one["data"], dtype=np.float64)
    times: NDArray[np.float64] = np.asarray(one["x"], dtype=np.float64) * (second(one) or 1.0)
    stated = label(one, "ordinate_axis_units_lab")
    unit = unit_of(stated) if stated else None
    kind = int(one["ordinate_spec_data_type"])
    if not stated and kind in MOTIONS and (si := unit_of(MOTIONS[kind])) is not None:
        stated = si.text if metre == 1.0 else f"{si.text} / {metre:g}"
        unit = Unit(stated, si.quantity, 1.0 / metre)
    place = f"{one['rsp_node']}:{AXES.get(int(one['rsp_dir']), '0')}"
    return Channel(
        name=label(one, "id1") or place,
        also=(place,),
        unit=unit,
        stated=stated,
        length=len(values),
        load=values.copy,
        clock=partial(times.copy),
    )
