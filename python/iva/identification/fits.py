"""What an identification has found."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from iva.identification.responses import Values
from iva.parameters import Piva, Primary, Siva, Start
from iva.spelling import spell_checked

if TYPE_CHECKING:
    import polars as pl

    from iva.simulation import Run


@dataclass(frozen=True)
class Found:
    """What the identification of any absorber hands on.

    Attributes
    ----------
    draws : dict of str to ndarray, shape (n,)
        Equally likely values of each number, SI units.
    each : ndarray, shape (n, 4, k)
        Draws of instant, jump, approach speed and restitution of every impact.
    walls : ndarray, shape (k,)
        +1 or −1.
    prediction, own, sigma : ndarray, shape (m,)
        What the model has at each sample, its standard deviation, and that of the noise.
    mask : ndarray of bool, shape (m,)
        True where a sample was used.
    noise : float
    combinations, reasons, notes : tuple of str
        As in :class:`Fit`.
    chain : str
        As in :class:`Fit`.
    """

    draws: dict[str, Values]
    each: Values
    walls: Values
    prediction: Values
    own: Values
    sigma: Values
    mask: NDArray[np.bool_]
    noise: float
    combinations: tuple[str, ...]
    reasons: tuple[str, ...]
    notes: tuple[str, ...]
    chain: str = ""


@spell_checked
@dataclass(frozen=True, repr=False, eq=False)
class Fit:
    """Parameters of a measured decay with their uncertainty.

    Attributes
    ----------
    parameters : polars.DataFrame
        A row a number: ``parameter``, ``value`` (the median), ``low`` and ``high`` (90 %),
        ``determined_by``: ``record``, ``prior`` (the record hardly narrowed what was thought
        possible before) or ``given``.
    impacts : polars.DataFrame
        A row an impact of the record: ``time`` in s on the clock of the record, ``wall``, ``jump``
        of the structure's velocity and ``approach_speed`` in m/s, ``restitution``, each with
        ``_low`` and ``_high`` (90 %).
    combinations : tuple of str
        What the record does not tell apart, in words.
    adequate : bool
        False if the model does not explain the record; `reasons` say why.
    reasons : tuple of str
        What the record has that the model has not.
    notes : tuple of str
        What was done with the record that a reader should know.
    time, values, prediction, low, high, residual : numpy.ndarray, shape (n,)
        Instants in s on the clock of the record, what was measured in SI units, what the model has
        there with its interval (90 %), and the difference. NaN where the window has ended.
    mask : numpy.ndarray of bool, shape (n,)
        True where a sample was used.
    noise : float
        Standard deviation of the noise, in SI units.
    draws : polars.DataFrame
        Equally likely sets of numbers, a row a set, columns named like the parameters.
    quantity : str
        What was measured: displacement, velocity or acceleration.
    absorber, primary, start
        The scene at the values of `parameters`; without an absorber that is ``None``, and there are
        no impacts.
    duration : float
        From the release to the end of the record in s.
    chain : str
        What the pulses of impacts say of filter and contact, in words; empty where the record shows
        none. Instants of impacts and release are those of the motion, before that filter.
    """

    parameters: pl.DataFrame
    impacts: pl.DataFrame
    combinations: tuple[str, ...]
    reasons: tuple[str, ...]
    notes: tuple[str, ...]
    time: Values
    values: Values
    prediction: Values
    low: Values
    high: Values
    mask: NDArray[np.bool_]
    noise: float
    draws: pl.DataFrame
    quantity: str
    absorber: Siva | Piva | None
    primary: Primary
    start: Start
    duration: float
    chain: str = ""
    _run: list[Run] = field(default_factory=list)

    @property
    def adequate(self) -> bool:
        """Whether the model explains the record."""
        return not self.reasons

    @property
    def residual(self) -> Values:
        """What was measured less what the model has."""
        return self.values - self.prediction

    @property
    def run(self) -> Run:
        """The run of the fitted scene, from the release to the end of the record."""
        if not self._run:
            from iva.simulation import simulate

            self._run.append(
                simulate(self.absorber, self.primary, start=self.start, duration=self.duration)
            )
        return self._run[0]

    def __repr__(self) -> str:
        """Show the numbers, what is not determined, and whether the model will do."""
        lines = [
            f"Fit of {self.time.size} samples of {self.quantity}, {self.impacts.height} impacts"
        ]
        for name, value, low, high, by in self.parameters.rows():
            lines.append(f"  {name} {value:.5g} ({low:.5g} … {high:.5g}), {by}")
        lines += [f"  {words}" for words in self.combinations]
        verdict = "adequate" if self.adequate else f"not adequate: {'; '.join(self.reasons)}"
        lines.append(f"  {verdict}")
        lines += [f"  note: {words}" for words in self.notes]
        return "\n".join(lines)


__all__ = ["Fit"]
