"""Modes from universal files (UFF, UNV): the shapes of datasets 55, as the file has them.

A complex eigenvalue is λ = −ζω + i ω √(1 − ζ²).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from iva.measured.universal_files import sets_of
from iva.parameters import is_list, numbers, shown

#: Analysis types of dataset 55 whose data are mode shapes.
NORMAL, FIRST_ORDER, SECOND_ORDER = 2, 3, 7

#: Specific data types of shapes: unknown, general, displacement, and those of other motions.
DISPLACEMENTS = (0, 1, 8)
RATES = {11: "velocity", 12: "acceleration"}

#: Largest scatter in degrees of the phases of a mode that is taken for a real one.
SCATTER = 10.0

#: So many numbers are listed in a message.
FEW = 12


@dataclass(frozen=True, slots=True)
class Mode:
    """A mode as the file has it.

    Parameters
    ----------
    label : int
        Its number.
    kind : int
        Analysis type.
    frequency_hz : float
        Natural frequency in Hz.
    eigenvalue : complex
        In rad/s; of a normal mode iω.
    damping_ratio : float
        1.
    hysteretic : float
        The hysteretic damping ratio of a normal mode.
    modal_mass : complex
        That of a normal mode, or modal A; 0 if the file states none.
    kilogram : float or None
        What dataset 164 says of the unit of mass: so many kg; ``None`` without one.
    quantity : int
        Specific data type.
    nodes : ndarray of int, shape (n,)
        Nodes with a shape.
    shape : ndarray of complex, shape (n, 3)
        In x, y and z.
    """

    label: int
    kind: int
    frequency_hz: float
    eigenvalue: complex
    damping_ratio: float
    hysteretic: float
    modal_mass: complex
    kilogram: float | None
    quantity: int
    nodes: NDArray[np.int64]
    shape: NDArray[np.complex128]

    @property
    def told(self) -> str:
        """What it is called in messages."""
        return f"mode {self.label} ({self.frequency_hz:.5g} Hz)"


def chosen(field: str, given: object, there: Sequence[int]) -> list[int]:
    """Return the numbers that the caller chose among those in the file.

    Raises
    ------
    TypeError
        If they are no numbers.
    ValueError
        If there are none, or one is not in the file.
    """
    found = numbers(field, given if is_list(given) else [given])
    wrong = next((one for one in found if one not in there), None)
    if wrong is not None or not found:
        listed = ", ".join(map(str, there[:FEW]))
        more = f" and {len(there) - FEW} more" if len(there) > FEW else ""
        what = shown(given) if wrong is None else f"{wrong:g}"
        raise ValueError(f"{field} = {what}: give some that the file has, {listed}{more}")
    return sorted({int(one) for one in found})


def modes_of(file: str, labels: object, path: str) -> list[Mode]:
    """Return the modes of a file by their frequencies; of conjugate ones the first.

    Parameters
    ----------
    file : str
        Name of the file.
    labels : object
        Numbers of the modes that are read, by default of all.
    path : str
        Name of the file for messages.

    Raises
    ------
    ValueError
        If there is none, or one is there twice or of another form.
    """
    sets: list[tuple[dict[str, Any], float | None]] = []
    kilogram = None
    for one in sets_of(file, (55, 164), ", with three numbers for each node"):
        if one["type"] == 164:
            kilogram = kilogram_of(one, path)  # holds for the sets behind it
        elif is_of_modes(one):
            sets.append((one, kilogram))
    if not sets:
        raise ValueError(
            f"{path}: no mode shapes (dataset 55 of analysis type 2, 3 or 7) in it; export some"
        )
    there = [int(one["mode_n"]) for one, _ in sets]
    wanted = set(there if labels is None else chosen("modes", labels, sorted(set(there))))
    modes: list[Mode] = []
    for one, kilogram in sets:
        if one["mode_n"] not in wanted:
            continue
        mode = mode_of(one, kilogram, path)
        if any(mode.eigenvalue.conjugate() == known.eigenvalue for known in modes):
            continue
        if any(mode.label == known.label for known in modes):
            raise ValueError(f"{path}: mode {mode.label} is there twice; export each mode once")
        modes.append(mode)
    return sorted(modes, key=lambda mode: mode.frequency_hz)


def is_of_modes(one: Mapping[str, Any]) -> bool:
    """Return whether a dataset 55 holds a mode shape: no strain, no response."""
    kinds = (NORMAL, FIRST_ORDER, SECOND_ORDER)
    return one["analysis_type"] in kinds and one["spec_data_type"] in (*DISPLACEMENTS, *RATES)


def kilogram_of(one: Mapping[str, Any], path: str) -> float:
    """Return the kg in a unit of mass of dataset 164.

    Raises
    ------
    ValueError
        If its factors are not greater than 0.

    Examples
    --------
    >>> kilogram_of({"length": 1000.0, "force": 1.0}, "modes.uff")  # mm, N, s: tonnes
    1000.0
    """
    length, force = float(one["length"]), float(one["force"])
    if not (0.0 < length < math.inf and 0.0 < force < math.inf):
        raise ValueError(
            f"{path}: dataset 164 has factors {length:g} of length and {force:g} of force; give "
            "factors greater than 0"
        )
    return length / force


def mode_of(one: Mapping[str, Any], kilogram: float | None, path: str) -> Mode:
    """Return the mode of a dataset 55.

    Raises
    ------
    ValueError
        If its numbers are not three for each node, or six with rotations; if some are not finite;
        if a node is there twice; or if its eigenvalue is that of no vibration.
    """
    label, kind = int(one["mode_n"]), int(one["analysis_type"])
    nodes = np.asarray(one["node_nums"], dtype=np.int64)
    parts = [np.asarray(one[key], dtype=np.complex128) for key in ("r1", "r2", "r3")]
    if one["n_data_per_node"] not in (3, 6) or any(part.shape != nodes.shape for part in parts):
        raise ValueError(
            f"{path}: mode {label} has {one['n_data_per_node']} numbers for each node, or too few; "
            "give those in x, y and z"
        )
    if len(np.unique(nodes)) < len(nodes):
        raise ValueError(f"{path}: mode {label} has a node twice; export each node once")
    shape = np.column_stack(parts)
    if kind == NORMAL:
        frequency, modal = float(one["freq"]), complex(one["modal_m"])
        eigenvalue = 2j * math.pi * frequency
        ratio, hysteretic = float(one["modal_damp_vis"]), float(one["modal_damp_his"])
    else:
        eigenvalue, modal = complex(one["eig"]), complex(one["modal_a"])
        frequency = abs(eigenvalue) / (2.0 * math.pi)
        ratio, hysteretic = -eigenvalue.real / (abs(eigenvalue) or 1.0), 0.0
    if not np.isfinite([*shape.ravel(), eigenvalue, modal, ratio, hysteretic]).all():
        raise ValueError(f"{path}: mode {label} has a number that is not finite; export it anew")
    if eigenvalue.imag == 0.0:
        raise ValueError(
            f"{path}: mode {label} does not vibrate, for its eigenvalue is {eigenvalue.real:g}; "
            "choose others with modes"
        )
    return Mode(
        label=label,
        kind=kind,
        frequency_hz=frequency,
        eigenvalue=eigenvalue,
        damping_ratio=ratio,
        hysteretic=hysteretic,
        modal_mass=modal,
        kilogram=kilogram,
        quantity=int(one["spec_data_type"]),
        nodes=nodes,
        shape=shape,
    )


def turned(shape: NDArray[np.complex128]) -> tuple[NDArray[np.float64], float, float]:
    """Return the real part of a shape whose phases are turned so that it is as large as can be.

    Parameters
    ----------
    shape : ndarray of complex

    Returns
    -------
    real : ndarray of float
    angle : float
        By which the phases were turned back, in rad.
    scatter : float
        Scatter of the phases about 0° and 180° in degrees: the tangent is the root of the sum of
        the squares of all imaginary parts over that of the real parts.

    Examples
    --------
    >>> real, angle, scatter = turned(np.array([3j, -1j]))
    >>> real.round(12).tolist(), round(scatter, 12)
    ([3.0, -1.0], 0.0)
    >>> round(turned(np.array([1.0, 1j / 2]))[2], 3)
    26.565
    """
    angle = 0.5 * float(np.angle(np.sum(shape**2)))
    back = shape * np.exp(-1j * angle)
    scatter = math.atan2(float(np.linalg.norm(back.imag)), float(np.linalg.norm(back.real)))
    return back.real, angle, math.degrees(scatter)


def real_shape(mode: Mode, path: str) -> NDArray[np.float64]:
    """Return the shape of a mode as real numbers, shape (n, 3).

    Raises
    ------
    ValueError
        If it is not real to within the scatter of phases that is allowed.
    """
    shape, _, scatter = turned(mode.shape)
    if scatter > SCATTER:
        raise ValueError(
            f"{path}: the phases of {mode.told} scatter by {scatter:.3g}°; give modes whose phases "
            f"scatter by at most {SCATTER:g}°, or the matrices of the structure"
        )
    return shape


def damping_of(mode: Mode, path: str) -> float:
    """Return the viscous damping ratio of a mode.

    Raises
    ------
    ValueError
        If the file states only a hysteretic one.
    """
    if mode.damping_ratio == 0.0 and mode.hysteretic != 0.0:
        raise ValueError(
            f"damping_ratios = None: {path} states only a hysteretic damping ratio of {mode.told}, "
            f"{mode.hysteretic:g}; give viscous damping ratios, one for all modes or one for each"
        )
    return mode.damping_ratio
