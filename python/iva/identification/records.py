"""A record as the sum of what release, impacts and sensor leave in it.

With the instants and the jumps of the impacts as inputs, a record of the structure is linear but
for a few numbers: no flight of the absorber is followed here, so a wrong guess of the gap cannot
spoil it. What follows is one set of numbers with its Gaussian uncertainty, all the record says.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from iva.identification.chains import pulse_of
from iva.identification.pulses import WIDE, Shape, places_of
from iva.identification.responses import Response, Values, rate_of, to_jump, to_release

#: Numbers before the impacts: ω, ζ, corner of the high pass, instant and size of the release.
HEAD = 5
OMEGA, ZETA, CORNER, RELEASE, SIZE = range(HEAD)
#: Powers of time that stand for offset and drift: 1, t, t², t³.
TREND = 4
#: Numbers of one ringing mode: share in sine and in cosine, frequency (rad/s), damping ratio.
MODE = 4


@dataclass(frozen=True)
class Inputs:
    """All numbers that a record is made of; SI units, time from the first sample.

    ``head`` (5,), ``times`` and ``jumps`` (k,), ``trend`` (4,), ``hum`` (2h,), ``modes`` (m, 4),
    ``pulse`` (s,) shares of what pulses have beyond their chain, and ``widths`` (k,) what the
    variance of each contact is more than usual in samples²; both are empty where the record shows
    no pulses. After a ``blow`` the last number of the head is the velocity that it gave, not the
    displacement that the structure was let go from.
    """

    head: Values
    times: Values
    jumps: Values
    trend: Values
    hum: Values
    modes: Values
    pulse: Values
    widths: Values
    blow: bool = False

    def vector(self) -> Values:
        """Return all numbers in one row."""
        return np.concatenate(
            [
                self.head,
                self.times,
                self.jumps,
                self.trend,
                self.hum,
                self.modes.ravel(),
                self.pulse,
                self.widths,
            ]
        )

    def with_vector(self, numbers: Values) -> Inputs:
        """Return the same with other numbers."""
        sizes = [
            HEAD,
            self.times.size,
            self.jumps.size,
            TREND,
            self.hum.size,
            self.modes.size,
            self.pulse.size,
            self.widths.size,
        ]
        parts = np.split(numbers, np.cumsum(sizes)[:-1])
        head, times, jumps, trend, hum, modes, pulse, widths = parts
        modes = modes.reshape(self.modes.shape)
        return Inputs(head, times, jumps, trend, hum, modes, pulse, widths, self.blow)

    def with_more(self, times: Values, jumps: Values) -> Inputs:
        """Return the same with further impacts, all in the order of time."""
        order = np.argsort(np.concatenate([self.times, times]))
        every = [np.concatenate(pair)[order] for pair in ((self.times, times), (self.jumps, jumps))]
        widths = self.widths
        if widths.size:
            widths = np.concatenate([widths, np.zeros(times.size)])[order]
        return replace(self, times=every[0], jumps=every[1], widths=widths)

    @property
    def impacts(self) -> slice:
        """Where instants and jumps stand in the vector."""
        return slice(HEAD, HEAD + 2 * self.times.size)


@dataclass
class Recording:
    """The samples to be explained.

    Parameters
    ----------
    time, values : ndarray, shape (n,)
        Instants from the first sample in s, and what was measured there, in SI units.
    order : int
        0 for a displacement, 1 for a velocity, 2 for an acceleration.
    hum_hz : tuple of float
        Frequencies of the mains and their multiples.
    weights : ndarray, shape (n,)
        1/σ of each sample, 0 where it does not count.
    powers : int
        Powers of time that the trend has.
    shape : Shape or None
        What pulses of impacts are made of; ``None`` where the record shows none.
    blow : bool
        Whether the structure was at rest until a blow, and not let go.
    """

    time: Values
    values: Values
    order: int
    sampling_hz: float
    hum_hz: tuple[float, ...] = ()
    weights: Values = field(default_factory=lambda: np.zeros(0))
    powers: int = TREND
    shape: Shape | None = None
    blow: bool = False

    @cached_property
    def trends(self) -> Values:
        """The columns of trend and hum, shape (n, 4 + 2h)."""
        half = self.time[-1] / 2
        powers = (self.time / half - 1.0)[:, None] ** np.arange(TREND)
        phase = 2 * np.pi * self.time[:, None] * np.array(self.hum_hz)[None, :]
        waves = np.stack([np.sin(phase), np.cos(phase)], axis=2).reshape(self.time.size, -1)
        return np.hstack([powers, waves])

    def motion(self, inputs: Inputs) -> Values:
        """Return the smooth part that the structure's own motion leaves, shape (n,)."""
        omega, zeta, corner, release, size = inputs.head
        jump = to_jump(omega, zeta, corner, self.order)
        free = jump if inputs.blow else to_release(omega, zeta, corner, self.order)
        made = size * free.total(self.time, np.array([release]), np.ones(1))
        if self.order == 0:
            made = made + size * (self.time <= release)
        if self.shape is not None and not inputs.blow:
            # The acceleration steps at the release, and the filter smears that step.
            offset = (self.time - release) * self.sampling_hz
            made = made - size * omega**2 * pulse_of(self.shape.chain).smear(offset)
        moved: Values = made + jump.total(self.time, inputs.times, inputs.jumps)
        return moved

    def ringing(self, inputs: Inputs) -> Values:
        """Return what further modes add after each impact, shape (n,)."""
        made = np.zeros(self.time.size)
        for mode in inputs.modes:
            answer = mode_response(mode, inputs.head[CORNER])
            made = made + answer.total(self.time, inputs.times, inputs.jumps)
        return made

    def pulses(self, inputs: Inputs) -> Values:
        """Return the pulses of the impacts, shape (n,)."""
        made = np.zeros(self.time.size + 1)  # the last one gathers what lies outside
        if self.shape is not None and inputs.times.size:
            samples, offset = places_of(inputs.times, self.sampling_hz, self.time.size)
            heights = self.shape.pulse(offset, inputs.pulse, inputs.widths)
            np.add.at(made, samples, heights * inputs.jumps[:, None] * self.sampling_hz)
        return made[:-1]

    def nuisance(self, inputs: Inputs) -> Values:
        """Return offset, drift and hum, shape (n,)."""
        made: Values = self.trends @ np.concatenate([inputs.trend, inputs.hum])
        return made

    def model(self, inputs: Inputs) -> Values:
        """Return the whole record as these numbers have it, shape (n,)."""
        return (
            self.motion(inputs) + self.ringing(inputs) + self.pulses(inputs) + self.nuisance(inputs)
        )

    def jacobian(self, inputs: Inputs) -> Values:
        """Return the derivatives of the record by all numbers, shape (n, p)."""
        omega, zeta, corner, release, size = inputs.head
        count, hits = self.time.size, inputs.times.size
        made = np.zeros((count, inputs.vector().size))

        for index in (OMEGA, ZETA, CORNER):
            step = (1e-6 * omega, 1e-7, 1e-4)[index]
            ahead, back = inputs.head.copy(), inputs.head.copy()
            ahead[index] += step
            if index == CORNER and self.order != 2:
                continue
            # A corner is not below 0, a damping ratio may be.
            back[index] -= step
            new, old = replace(inputs, head=ahead), replace(inputs, head=back)
            change = self.motion(new) - self.motion(old)
            if index == CORNER:
                change = change + self.ringing(new) - self.ringing(old)
            made[:, index] = change / (ahead[index] - back[index])
        begun = to_jump if inputs.blow else to_release
        free = begun(omega, zeta, corner, self.order)
        made[:, RELEASE] = -size * free.slope().total(self.time, np.array([release]), np.ones(1))
        made[:, SIZE] = free.total(self.time, np.array([release]), np.ones(1))
        if self.shape is not None and not inputs.blow:
            offset = (self.time - release) * self.sampling_hz
            filtered = pulse_of(self.shape.chain)
            made[:, SIZE] -= omega**2 * filtered.smear(offset)
            near = np.abs(offset) < WIDE
            steep = filtered.step(offset[near], 1) * self.sampling_hz
            made[near, RELEASE] += size * omega**2 * steep
        if self.order == 0:
            made[:, SIZE] += self.time <= release

        answers = [to_jump(omega, zeta, corner, self.order)]
        answers += [mode_response(mode, corner) for mode in inputs.modes]
        by_time = slice(HEAD, HEAD + hits)
        by_jump = slice(HEAD + hits, HEAD + 2 * hits)
        for answer in answers:
            made[:, by_jump] += answer.columns(self.time, inputs.times)
            made[:, by_time] -= answer.slope().columns(self.time, inputs.times) * inputs.jumps
        place = HEAD + 2 * hits
        columns = self.trends
        made[:, place : place + columns.shape[1]] = columns
        place += columns.shape[1]
        for number, mode in enumerate(inputs.modes):
            for index in range(MODE):
                step = np.array([1e-6, 1e-6, 1e-5 * mode[2], 1e-6])[index]
                other = inputs.modes.copy()
                other[number, index] += step
                change = self.ringing(replace(inputs, modes=other)) - self.ringing(inputs)
                made[:, place + index] = change / step
            place += MODE
        if self.shape is not None and hits:
            self.by_pulse(inputs, made)
        return made

    def by_pulse(self, inputs: Inputs, made: Values) -> None:
        """Add the derivatives of the pulses to those of the record (n, p)."""
        assert self.shape is not None
        hits, rate = inputs.times.size, self.sampling_hz
        samples, offset = places_of(inputs.times, rate, self.time.size)
        heights, steep, width, parts = self.shape.derivatives(offset, inputs.pulse, inputs.widths)
        last = made.shape[1]
        shares = slice(last - hits - inputs.pulse.size, last - hits)
        for hit, jump in enumerate(inputs.jumps * rate):
            inside = samples[hit] >= 0
            rows = samples[hit][inside]
            made[rows, HEAD + hit] -= steep[hit][inside] * jump * rate
            made[rows, HEAD + hits + hit] += heights[hit][inside] * rate
            made[rows, shares] += parts[hit][inside] * jump
            made[rows, last - hits + hit] += width[hit][inside] * jump

    def reach(self, inputs: Inputs) -> Values:
        """Return how large a pulse may still be at each sample, for a soft mask, shape (n,)."""
        made = np.zeros(self.time.size + 1)
        if self.shape is None or not inputs.times.size:
            return made[:-1]
        fine = np.arange(-4 * WIDE, 4 * WIDE + 1)[None, :] / 4
        sizes = np.abs(self.shape.pulse(fine, inputs.pulse, np.zeros(1))[0]) * self.sampling_hz
        middle = 4 * WIDE
        sizes[: middle + 1] = np.maximum.accumulate(sizes[: middle + 1])
        sizes[middle:] = np.maximum.accumulate(sizes[middle:][::-1])[::-1]
        samples, _ = places_of(inputs.times, self.sampling_hz, self.time.size)
        np.add.at(made, samples, (sizes[None, ::4] * inputs.jumps[:, None]) ** 2)
        root: Values = np.sqrt(made[:-1])
        return root


def mode_response(mode: Values, corner: float) -> Response:
    """Return the answer of a further mode to a unit jump, through the same high pass."""
    rate, fast = rate_of(mode[2], mode[3]), complex(mode[0], mode[1])
    slow = (fast * corner / (rate + corner)).imag
    return Response(rate, corner, fast * rate / (rate + corner), slow)


__all__ = ["Inputs", "Recording"]
