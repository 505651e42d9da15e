"""What a sensor shows of a damped oscillator: its release, and its answer to a jump of velocity.

With λ = −ζω + iω_d the displacement after a unit jump of velocity is Im(exp(λt))/ω_d, and every
derivative multiplies by λ. A first-order high pass of corner a (rad/s), as sensors with a
built-in amplifier have, turns exp(λt) into (λ exp(λt) + a exp(−at))/(λ + a): all that is recorded
is a sum of two exponentials that begin at an instant, so nothing is integrated step by step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Values: TypeAlias = NDArray[np.float64]

#: How often the displacement is differentiated to give a quantity.
ORDERS = {"displacement": 0, "velocity": 1, "acceleration": 2}


@dataclass(frozen=True)
class Response:
    """The two exponentials of an answer: Im(fast · exp(λt)) + slow · exp(−at) from t = 0 on."""

    rate: complex
    corner: float
    fast: complex
    slow: float

    def columns(self, time: Values, begins: Values) -> Values:
        """Return the answers to unit events, shape (n, k), zero before each begins.

        Parameters
        ----------
        time : ndarray, shape (n,)
            Instants in s.
        begins : ndarray, shape (k,)
            Instants of the events in s.
        """
        since = time[:, None] - begins[None, :]
        made = (
            np.exp(self.rate * time)[:, None] * (self.fast * np.exp(-self.rate * begins))[None, :]
        )
        answer = made.imag
        if self.slow:
            answer = answer + self.slow * np.exp(-self.corner * np.maximum(since, 0.0))
        return np.where(since > 0, answer, 0.0)

    def total(self, time: Values, begins: Values, sizes: Values) -> Values:
        """Return the sum of the answers to events of given sizes, shape (n,)."""
        order = np.argsort(begins)
        begins, sizes = begins[order], sizes[order]
        seen = np.searchsorted(begins, time, side="left")
        gathered = np.concatenate([[0.0], np.cumsum(sizes * np.exp(-self.rate * begins))])
        answer = (self.fast * gathered[seen] * np.exp(self.rate * time)).imag
        if self.slow:
            slow = np.concatenate([[0.0], np.cumsum(sizes * np.exp(self.corner * begins))])
            answer = answer + self.slow * slow[seen] * np.exp(-self.corner * time)
        made: Values = answer
        return made

    def slope(self) -> Response:
        """Return the time derivative of the answer."""
        return Response(self.rate, self.corner, self.fast * self.rate, -self.corner * self.slow)


def rate_of(omega: float, damping_ratio: float) -> complex:
    """Return λ in 1/s."""
    return omega * complex(-damping_ratio, np.sqrt(1.0 - damping_ratio**2))


def to_jump(omega: float, damping_ratio: float, corner: float, order: int) -> Response:
    """Return the answer to a unit jump of velocity, without the pulse of an acceleration."""
    rate = rate_of(omega, damping_ratio)
    fast = rate**order / rate.imag
    slow = 0.0
    if order == 2 and corner:
        slow = (fast * corner / (rate + corner)).imag - corner
        fast = fast * rate / (rate + corner)
    return Response(rate, corner, fast, slow)


def to_release(omega: float, damping_ratio: float, corner: float, order: int) -> Response:
    """Return the answer to the release from unit displacement at rest.

    Of a displacement it is what follows the release; before it the record stands at 1.
    """
    rate = rate_of(omega, damping_ratio)
    if order == 0:
        return Response(rate, 0.0, (rate + 2 * damping_ratio * omega) / rate.imag, 0.0)
    fast = -(omega**2) * rate ** (order - 1) / rate.imag
    slow = 0.0
    if order == 2 and corner:
        slow = (fast * corner / (rate + corner)).imag
        fast = fast * rate / (rate + corner)
    return Response(rate, corner, fast, slow)
