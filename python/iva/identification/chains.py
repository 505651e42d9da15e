"""What stands between an impact and the samples: contact force, filter of the recorder.

Contact is far shorter than a period, so an impact leaves the pulse of its force, as large as its
jump of velocity. A recorder filters it. Filters are named here by their frequency response over the
corner; the clock is shifted by their delay at low frequencies, so that a pulse has its centroid at
its impact. The motion itself, far below the corner, passes unchanged.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicSpline

from iva.identification.responses import Values
from iva.measured.filters import KINDS, delay, force, passed

#: Points a sample of the tables.
FINE = 32
#: Half length of a table in samples.
HALF = 64
#: Variance of a half sine over the square of its length.
VARIANCE = 0.25 - 2 / np.pi**2


@dataclass(frozen=True)
class SensorChain:
    """A filter, its corner over the sampling rate, and the length of a contact in samples."""

    kind: str = "linear phase"
    cutoff: float = 0.42
    contact: float = 1.2

    @property
    def delay(self) -> float:
        """What the filter delays the motion by, in samples; 0 where its recorder has none."""
        return delay(self.kind) / (2 * np.pi * self.cutoff)

    def words(self, sampling_hz: float) -> str:
        """Return what it is, for a reader."""
        contact = f"contacts of about {1e3 * self.contact / sampling_hz:.2g} ms"
        if self.kind == "none":
            return f"no filter, {contact}"
        corner = f"its corner near {self.cutoff * sampling_hz:.3g} Hz"
        if self.kind == "causal":
            return f"a causal filter, {corner}, delay {1e3 * self.delay / sampling_hz:.2g} ms"
        return f"a filter of {self.kind}, {corner}"


@dataclass(frozen=True)
class Pulse:
    """The pulse of a unit jump at one sample a second, over samples from the impact.

    ``height`` (area 1, centroid 0), ``width``: its derivative by the variance of the contact, and
    ``step``: what a contact of no length makes of a unit step, less that step.
    """

    height: CubicSpline
    width: CubicSpline
    step: CubicSpline

    def smear(self, offset: Values) -> Values:
        """Return what the filter makes of a unit step, less the step, at offsets in samples."""
        inside = np.abs(offset) < HALF - 1
        made: Values = np.where(
            inside, self.step(np.where(inside, offset, 0.0)) - (offset > 0), 0.0
        )
        return made


@lru_cache(maxsize=64)
def pulse_of(chain: SensorChain) -> Pulse:
    """Return the pulse that a chain makes."""
    at = np.arange(-HALF * FINE, HALF * FINE) / FINE
    if chain.kind == "none":
        length = max(chain.contact, 2.0 / FINE)
        change = 0.02 * length
        longer, shorter = half_sine(at, length + change), half_sine(at, length - change)
        wider = VARIANCE * ((length + change) ** 2 - (length - change) ** 2)
        sharp = CubicSpline(at, (at > 0).astype(float))
        height = CubicSpline(at, half_sine(at, length))
        return Pulse(height, CubicSpline(at, (longer - shorter) / wider), sharp)
    frequency: Values = np.fft.fftfreq(at.size, 1 / FINE).astype(np.float64)
    ratio = frequency / chain.cutoff
    filtered = passed(chain.kind, ratio) * np.exp(1j * ratio * delay(chain.kind))
    spectrum = filtered * force(frequency * chain.contact)
    # Of a contact whose variance is larger by v the spectrum is smaller by v (2πf)²/2.
    wide = -0.5 * (2 * np.pi * frequency) ** 2 * spectrum
    height, width, short = (
        CubicSpline(at, np.fft.fftshift(np.fft.ifft(one).real) * FINE)
        for one in (spectrum, wide, filtered)
    )
    return Pulse(height, width, short.antiderivative())


def half_sine(at: Values, length: float) -> Values:
    """Return a half sine of area 1, averaged over the steps of its table, shape (n,)."""
    step = at[1] - at[0]
    edges = np.clip((np.concatenate([at - step / 2, [at[-1] + step / 2]])) / length, -0.5, 0.5)
    made: Values = np.diff(np.sin(np.pi * edges)) / 2 / step
    return made


__all__ = ["KINDS", "Pulse", "SensorChain", "pulse_of"]
