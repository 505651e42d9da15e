"""The pulse that an impact leaves in a record of acceleration.

Contact is far shorter than a period, so all impacts leave the same pulse, as large as their jump of
velocity: the contact force seen through the filter before the recorder. The filter is band-limited
and has linear phase with the delay removed. So the pulse is a symmetric sum of shifted sinc
functions, Σ c_m sinc(p − m) with Σ c_m = 1, p in samples from the impact.
"""

from __future__ import annotations

import numpy as np

from iva.identification.responses import Values

#: Samples on each side that a pulse may last, beyond the ringing of usual filters.
REACH = 30
#: Samples on each side on which its sum is evaluated.
WIDE = REACH + 8


def first_guess(cutoff: float = 0.42, contact: float = 1.2) -> Values:
    """Return c_1 … c_REACH of a usual filter and contact, shape (REACH,).

    Parameters
    ----------
    cutoff : float
        Corner of the filter over the sampling rate.
    contact : float
        Length of a half sine in samples.
    """
    fine = np.linspace(-contact / 2, contact / 2, 41)
    force = np.cos(np.pi * fine / contact)
    force /= force.sum()
    at = np.arange(-REACH, REACH + 1)[:, None] - fine[None, :]
    window = np.clip(1 - np.abs(at) / (REACH + 1), 0, None)
    made = (2 * cutoff * np.sinc(2 * cutoff * at) * window) @ force
    made = (made + made[::-1]) / 2
    shares: Values = (made / made.sum())[REACH + 1 :]
    return shares


def sincs(offset: Values) -> tuple[Values, Values]:
    """Return sinc and its derivative at offsets in samples."""
    value = np.sinc(offset)
    safe = np.where(np.abs(offset) < 1e-6, 1.0, offset)
    slope = np.where(np.abs(offset) < 1e-6, 0.0, (np.cos(np.pi * offset) - value) / safe)
    return value, slope


def shapes(places: Values, count: int) -> tuple[np.ndarray, Values, Values]:
    """Return where pulses fall and their parts.

    Parameters
    ----------
    places : ndarray, shape (k,)
        Instants of the impacts in samples from the first one.
    count : int
        Samples of the record.

    Returns
    -------
    samples : ndarray of int, shape (k, 2 WIDE + 1)
        Indices; those outside the record are clipped, with parts of zero.
    parts : ndarray, shape (k, 2 WIDE + 1, REACH + 1)
        Column m is sinc(p − m) + sinc(p + m), column 0 sinc(p).
    slopes : ndarray, of the same shape
        Their derivatives by p, the distance from the impact.
    """
    near = np.rint(places).astype(int)
    samples = near[:, None] + np.arange(-WIDE, WIDE + 1)[None, :]
    inside = (samples >= 0) & (samples < count)
    offset = samples - places[:, None]
    shifts = np.arange(REACH + 1)
    right, right_slope = sincs(offset[:, :, None] - shifts)
    left, left_slope = sincs(offset[:, :, None] + shifts)
    twice = np.where(shifts == 0, 0.5, 1.0)
    parts = (right + left) * twice * inside[:, :, None]
    slopes = (right_slope + left_slope) * twice * inside[:, :, None]
    return np.clip(samples, 0, count - 1), parts, slopes


def whole(shares: Values) -> Values:
    """Return c_0 … c_REACH, c_0 such that the pulse has area 1."""
    return np.concatenate([[1.0 - 2.0 * shares.sum()], shares])


def envelope(shares: Values) -> Values:
    """Return the largest |c| at or beyond each distance of 0 … WIDE samples, shape (WIDE + 1,)."""
    sizes = np.abs(whole(shares))
    beyond = np.maximum.accumulate(sizes[::-1])[::-1]
    tail = beyond[-1] * np.exp(-np.arange(1, WIDE - REACH + 1) / 3.0)
    made: Values = np.concatenate([beyond, tail])
    return made
