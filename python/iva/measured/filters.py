"""Filters of recorders, by their frequency response over the corner."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

#: Kinds of filters, by name.
KINDS = ("none", "linear phase", "zero phase", "causal")
#: Order of the Butterworth filters: of zero phase it is that of each of two passes.
ORDERS = {"zero phase": 2, "causal": 4}
#: Width of the transition of a filter of linear phase, over its corner.
TRANSITION = 0.06


def passed(kind: str, ratio: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Return the frequency response of a filter at frequencies over its corner, shape (n,).

    Parameters
    ----------
    kind : str
        One of :data:`KINDS`. Of linear phase: the delay is removed. Causal: a Butterworth filter of
        order 4, |H|² = 1/(1 + r⁸). Zero phase: one of order 2, forth and back.
    ratio : ndarray, shape (n,)
        Frequency over the corner.
    """
    if kind == "none":
        return np.ones(ratio.size, np.complex128)
    if kind == "linear phase":
        return (0.5 - 0.5 * np.tanh((np.abs(ratio) - 1.0) / TRANSITION)).astype(np.complex128)
    if kind == "zero phase":
        return (1 / (1 + ratio ** (2 * ORDERS[kind]))).astype(np.complex128)
    made = np.ones(ratio.size, np.complex128)
    for pole in poles():
        made = made / (1 - 1j * ratio / pole)
    return made


def poles() -> NDArray[np.complex128]:
    """Return the poles of the causal filter over its corner, shape (4,)."""
    order = ORDERS["causal"]
    made: NDArray[np.complex128] = np.exp(
        1j * np.pi * (2 * np.arange(order) + order + 1) / (2 * order)
    )
    return made


def delay(kind: str) -> float:
    """Return the delay of slow motion times 2π times the corner."""
    return -float(np.sum(1 / poles()).real) if kind == "causal" else 0.0


def force(ratio: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the spectrum of a half sine of area 1 at frequencies times its length, shape (n,)."""
    near = np.abs(np.abs(ratio) - 0.5) < 1e-6
    safe = np.where(near, 0.0, ratio)
    made: NDArray[np.float64] = np.where(
        near, np.pi / 4, np.cos(np.pi * safe) / (1 - (2 * safe) ** 2)
    )
    return made


__all__ = ["KINDS", "delay", "force", "passed"]
