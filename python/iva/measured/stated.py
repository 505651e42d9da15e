"""What was measured, and in which unit: as a file or the caller states it."""

from __future__ import annotations

import math
from pathlib import Path

from iva.measured.channels import Channel
from iva.measured.sensor_units import Unit, unit_of
from iva.parameters import number, shown
from iva.spelling import hint

#: SI unit of each quantity that sensors measure.
SI = {"acceleration": "m/s²", "velocity": "m/s", "displacement": "m"}

#: Units for messages, in a spelling that is common.
COMMON = (
    "m/s^2, mm/s^2, g, mg or in/s^2 of acceleration; m/s, mm/s or in/s of velocity; m, mm, um or "
    "in of displacement"
)


def quantity_of(quantity: object) -> str:
    """Return the quantity if it is one that sensors measure.

    Raises
    ------
    TypeError
        If it is no word.
    ValueError
        If it is unknown.
    """
    if not isinstance(quantity, str):
        raise TypeError(f"quantity = {shown(quantity)}: give a word")
    if quantity not in SI:
        raise ValueError(
            f"quantity = {quantity!r}: give one of {', '.join(SI)}{hint(quantity, SI)}"
        )
    return quantity


def sign_of(direction: object) -> float:
    """Return the direction as a factor.

    Raises
    ------
    TypeError
        If it is not a number.
    ValueError
        If it is neither 1 nor -1.
    """
    sign = number("direction", direction)
    if abs(sign) != 1.0:
        raise ValueError(f"direction = {shown(direction)}: give 1 or -1")
    return sign


def scale_of(channel: Channel, source: str, scale: object) -> float:
    """Return the factor on the numbers of a channel, 1 if none is given.

    Raises
    ------
    TypeError
        If it is not a number.
    ValueError
        If it is 0 or not finite, or needed and not given.
    """
    if scale is None:
        if channel.is_fraction:
            raise ValueError(
                f"scale = None: {Path(source).name} holds fractions of full scale; give scale, "
                "which is full scale in the unit of the values"
            )
        return 1.0
    factor = number("scale", scale)
    if factor == 0.0 or not math.isfinite(factor):
        raise ValueError(f"scale = {shown(scale)}: give a finite number other than 0")
    return factor


def unit_for(channel: Channel, source: str, given: object, quantity: str | None) -> Unit:
    """Return the unit of a channel: the one that the file states, or the one given.

    Raises
    ------
    TypeError
        If the one given is no word.
    ValueError
        If it is unknown or not that of the file, if there is none, or if it is one of another
        quantity.
    """
    stated = channel.unit if channel.unit and channel.unit.quantity in SI else None
    unit = stated
    if given is not None:
        if not isinstance(given, str):
            raise TypeError(f"unit = {shown(given)}: give a word")
        unit = unit_of(given)
        if unit is None or unit.quantity not in SI:
            raise ValueError(f"unit = {given!r}: give a unit of a motion, such as {COMMON}")
        if stated and not unit.is_same(stated):
            raise ValueError(
                f"unit = {given!r}: the file says that {channel.name!r} is in {stated.text}; leave "
                "unit out, or correct the file"
            )
    if unit is None:
        of_file = (
            f"unit {channel.stated!r}, which is none of a motion" if channel.stated else "none"
        )
        raise ValueError(
            f"unit = None: {Path(source).name} states {of_file} for "
            f"{shown(channel.name) if channel.name else 'its columns'}; give one, such as {COMMON}"
        )
    if quantity is not None and quantity != unit.quantity:
        raise ValueError(f"quantity = {quantity!r}: {unit.text} is a unit of {unit.quantity}")
    return unit
