"""The pulses of impacts in a record of acceleration, as the record itself has them.

All impacts leave the same pulse, as large as their jump of velocity: that of a named chain
(:mod:`iva.identification.chains`) and what the record says beyond it, a sum of sinc functions and,
where a filter lets pass more than samples can hold, of narrow splines. What is added has neither
area nor first moment: the area is the jump, and the instant is that of the motion. Contacts differ
somewhat in length: each pulse has a width of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from iva.identification.chains import SensorChain, pulse_of
from iva.identification.responses import Values

#: Samples on each side that a pulse may last: the longest usual filters ring for some 32.
REACH = 40
#: Samples on each side on which its sum is evaluated.
WIDE = REACH + 8
#: Splines a sample, and how far beyond the contact they reach in samples.
DENSE = 3
BESIDE = 2.5
#: How far a pulse may be from that of its chain near the impact, and how many samples away that
#: has fallen to a third.
SHAPES = 0.15
FADING = 15.0
#: How far a pulse may be lopsided, over how far it may be otherwise, if its filter is symmetrical:
#: an odd part with long tails stands for a delay of the pulses that the motion has not.
LOPSIDED = 0.1
HALVED = np.sqrt(0.5)


@dataclass(frozen=True)
class Shape:
    """What pulses of a chain are made of.

    ``half`` is how far the splines reach in samples, by default somewhat beyond the contact.
    """

    chain: SensorChain
    half: float | None = None

    @cached_property
    def sincs(self) -> Values:
        """Places of pairs of sinc functions in samples from the impact, but for the middle ones."""
        if self.chain.kind == "none":
            return np.zeros(0)
        return np.arange(2, REACH + 1).astype(np.float64)

    @cached_property
    def splines(self) -> Values:
        """Places of the splines in samples from the impact."""
        if self.chain.kind == "linear phase":
            return np.zeros(0)
        half = self.chain.contact / 2 + BESIDE if self.half is None else self.half
        most = int(np.ceil(half * DENSE))
        return np.arange(-most, most + 1) / DENSE

    @property
    def size(self) -> int:
        """Number of shares: of the sinc functions, of the middle one, of the splines."""
        middle = 1 if self.sincs.size else 0
        return 2 * self.sincs.size + middle + max(self.splines.size - 2 * (1 - middle), 0)

    def deviations(self) -> Values:
        """Return how large each share may be, shape (size,)."""
        made = SHAPES * np.exp(-self.sincs / FADING)
        if self.sincs.size:
            odd = made if self.chain.kind == "causal" else LOPSIDED * made
            return np.concatenate([made, odd, np.full(1 + self.splines.size, SHAPES)])
        return np.full(self.size, SHAPES)

    def basis(self, offset: Values) -> tuple[Values, Values]:
        """Return the added functions and their derivatives, shape offset.shape + (size,)."""
        parts, slopes, areas, moments = [], [], [], []
        if self.sincs.size:
            value, slope = sincs(offset, np.arange(-1.0, 2.0))
            middle, middle_slope = value[..., 1:2], slope[..., 1:2]
            odd, odd_slope = (side[..., 2:3] - side[..., 0:1] for side in (value, slope))
            even = value[..., 2:3] + value[..., 0:1] - 2 * middle
            even_slope = slope[..., 2:3] + slope[..., 0:1] - 2 * middle_slope
            pairs = [sincs(offset, side * self.sincs) for side in (1.0, -1.0)]
            (after, after_slope), (before, before_slope) = pairs
            parts += [(after + before) * HALVED, (after - before) * HALVED, even]
            slopes += [(after_slope + before_slope) * HALVED]
            slopes += [(after_slope - before_slope) * HALVED, even_slope]
            none = np.zeros(self.sincs.size)
            areas += [none + 2 * HALVED, none, np.zeros(1)]
            moments += [none, 2 * HALVED * self.sincs, np.zeros(1)]
        if self.splines.size:
            value, slope = spline((offset[..., None] - self.splines) * DENSE)
            slope = slope * DENSE
            if not self.sincs.size:
                # Two in the middle take area and first moment of the others.
                half = self.splines.size // 2
                pair = [half - DENSE, half + DENSE]
                two, two_slope = value[..., pair], slope[..., pair]
                middle = DENSE * two.mean(axis=-1, keepdims=True)
                middle_slope = DENSE * two_slope.mean(axis=-1, keepdims=True)
                odd = DENSE * (two[..., 1:] - two[..., :1])
                odd_slope = DENSE * (two_slope[..., 1:] - two_slope[..., :1])
                keep = np.delete(np.arange(self.splines.size), pair)
                value, slope, places = value[..., keep], slope[..., keep], self.splines[keep]
            else:
                places = self.splines
            parts.append(value)
            slopes.append(slope)
            areas.append(np.full(places.size, 1 / DENSE))
            moments.append(places / DENSE)
        area, moment = np.concatenate(areas), np.concatenate(moments)
        part = np.concatenate(parts, axis=-1) - area * middle - moment / 2 * odd
        steep = np.concatenate(slopes, axis=-1) - area * middle_slope - moment / 2 * odd_slope
        return part, steep

    def pulse(self, offset: Values, shares: Values, widths: Values) -> Values:
        """Return pulses of unit jumps, shape (k, n), at offsets from their impacts (k, n).

        ``widths`` (k,) are what the variances of their contacts are more than usual, in samples².
        """
        made = pulse_of(self.chain)
        heights: Values = made.height(offset)
        if np.any(shares):
            heights = heights + self.basis(offset)[0] @ shares
        if np.any(widths):
            heights = heights + widths[:, None] * made.width(offset)
        return heights

    def derivatives(
        self, offset: Values, shares: Values, widths: Values
    ) -> tuple[Values, Values, Values, Values]:
        """Return pulses, their derivatives by offset and width (k, n), by share (k, n, s)."""
        made = pulse_of(self.chain)
        parts, slopes = self.basis(offset)
        width = made.width(offset)
        heights = made.height(offset) + parts @ shares + widths[:, None] * width
        steep = made.height(offset, 1) + slopes @ shares + widths[:, None] * made.width(offset, 1)
        return heights, steep, width, parts


def sincs(offset: Values, places: Values) -> tuple[Values, Values]:
    """Return sinc functions at whole places and their derivatives, shape offset.shape + (s,)."""
    # sin π(p − m) = (−1)^m sin πp: one sine for all places.
    away = offset[..., None] - places
    sign = 1.0 - 2.0 * (np.abs(places) % 2)
    near = np.abs(away) < 1e-6
    away[near] = 1.0
    value = np.sin(np.pi * offset)[..., None] * sign / (np.pi * away)
    slope = (np.cos(np.pi * offset)[..., None] * sign - value) / away
    value[near], slope[near] = 1.0, 0.0
    return value, slope


def spline(offset: Values) -> tuple[Values, Values]:
    """Return the cubic B-spline of area 1 and its derivative at offsets from its middle."""
    far = np.abs(offset)
    inner, outer = np.minimum(far, 1.0), np.clip(2.0 - far, 0.0, 1.0)
    near = far < 1.0
    value = np.where(near, 2 / 3 - inner**2 + inner**3 / 2, outer**3 / 6)
    slope = np.where(near, -2 * inner + 1.5 * inner**2, -(outer**2) / 2) * np.sign(offset)
    return value, slope


def places_of(instants: Values, sampling_hz: float, count: int) -> tuple[np.ndarray, Values]:
    """Return the samples about impacts and their offsets in samples, shape (k, 2 WIDE + 1) each.

    Samples outside the record are −1.
    """
    places = instants * sampling_hz
    samples = np.rint(places).astype(int)[:, None] + np.arange(-WIDE, WIDE + 1)[None, :]
    offset = samples - places[:, None]
    return np.where((samples >= 0) & (samples < count), samples, -1), offset
