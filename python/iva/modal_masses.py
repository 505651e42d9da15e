"""Modal masses of the modes in a universal file, in kg.

A modal mass is m = φᵀ M φ with the shape φ as the file has it, so that φ/√m is mass-normalised,
whatever the unit of φ. Dataset 164 tells by which factors lengths and forces are divided to get SI
units; a mass is a force over a length, times s².

The modal A of a complex eigenvalue λ is φᵀ (2λM + C) φ, which for a real shape is 2i Im(λ) m
(R. J. Allemang and D. L. Brown, report AFWAL-TR-87-3069, University of Cincinnati 1987).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from iva.parameters import is_list, number, numbers, shown
from iva.spelling import hint
from iva.structure_files import Choices
from iva.universal_modes import FIRST_ORDER, RATES, SCATTER, SECOND_ORDER, Mode, turned

#: Kilograms in a unit of mass. The pound is 0.45359237 kg, and standard gravity makes it a force:
#: a slug is lbf s²/ft, a slinch lbf s²/in.
MASSES = {
    "kg": 1.0,
    "g": 1e-3,
    "t": 1e3,
    "lb": 0.45359237,
    "slug": 0.45359237 * 9.80665 / 0.3048,
    "slinch": 0.45359237 * 9.80665 / 0.0254,
}


def masses_of(modes: Sequence[Mode], choices: Choices, path: str) -> list[float]:
    """Return the modal masses in kg: those given, or those of the file.

    Raises
    ------
    TypeError
        If those given are no numbers, or the unit no word.
    ValueError
        If some are not greater than 0 or not as many as modes, if the file states none, or if the
        unit is unknown, stated nowhere or not that of the file.
    """
    given, unit = choices.modal_masses, choices.mass_unit
    if unit is not None and not isinstance(unit, str):
        raise TypeError(f"mass_unit = {shown(unit)}: give a word")
    if unit is not None and unit not in MASSES:
        rule = f"give one of {', '.join(MASSES)}{hint(unit, MASSES)}"
        raise ValueError(f"mass_unit = {shown(unit)}: {rule}")
    if given is None:
        return [mass_of(mode, path) * kilograms(mode, unit, path) for mode in modes]
    if unit is not None:
        raise ValueError(f"mass_unit = {shown(unit)}: modal_masses are in kg; leave mass_unit out")
    masses = numbers("modal_masses", given) if is_list(given) else [number("modal_masses", given)]
    if len(masses) not in (1, len(modes)):
        raise ValueError(
            f"modal_masses = {shown(given)}: there are {len(modes)} modes; give a number for all, "
            "or one for each"
        )
    for mass in masses:
        if not 0.0 < mass < math.inf:
            raise ValueError(f"modal_masses = {shown(given)}: give numbers greater than 0")
    return masses * len(modes) if len(masses) == 1 else masses


def mass_of(mode: Mode, path: str) -> float:
    """Return the modal mass of a mode in the unit of the file.

    Raises
    ------
    ValueError
        If the file states none that its shape can be scaled by.
    """
    mass = mode.modal_mass
    why = ""
    if mode.kind == SECOND_ORDER:
        why = f"states none of {mode.told}, a complex eigenvalue of second order (analysis type 7)"
    elif mass == 0:
        why = f"states none of {mode.told}"
    elif mode.quantity in RATES:
        why = f"has {mode.told} as a shape of {RATES[mode.quantity]}, whose scale is another"
    elif mode.kind == FIRST_ORDER:
        _, angle, _ = turned(mode.shape)
        mass *= np.exp(-2j * angle) / (2j * mode.eigenvalue.imag)
        # An error of the phase of a shape is twice as large in its modal A.
        if abs(np.angle(mass, deg=True)) > 2.0 * SCATTER:
            why = f"states a modal A of {mode.told} that has not the phase of its shape"
    elif mass.real < 0.0:
        why = f"states {mass.real:g} of {mode.told}"
    if why:
        raise ValueError(
            f"modal_masses = None: {path} {why}; give modal masses in kg, φᵀMφ of the shapes as "
            "the file has them"
        )
    return abs(mass)


def kilograms(mode: Mode, unit: str | None, path: str) -> float:
    """Return the kg in the unit of a modal mass: what the file says, or the unit given.

    Raises
    ------
    ValueError
        If there is none, or the file says another.
    """
    stated = mode.kilogram
    if unit is None and stated is None:
        raise ValueError(
            f"mass_unit = None: {path} states no units (dataset 164) before {mode.told}; give the "
            f"unit of its modal masses, one of {', '.join(MASSES)}"
        )
    if unit is None or stated is None:
        return stated or MASSES[unit or "kg"]
    if not math.isclose(stated, MASSES[unit], rel_tol=1e-4):
        raise ValueError(
            f"mass_unit = {unit!r}: dataset 164 of {path} says that masses are in units of "
            f"{stated:.6g} kg; leave mass_unit out, or correct the file"
        )
    return stated
