"""A trail of impacts, each of which follows from those before as that of one free mass.

A small impact that is not seen changes the motion for good, and so what is found of everything
before. A record is used up to where its trail ends. That of a velocity is taken up again from
there: what comes next is where the mass is bound to strike, and a step that hides in the noise of
its samples shows in those of the whole motion that follows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iva.identification.ahead import next_after
from iva.identification.expected import beliefs_of, heads, pull_of
from iva.identification.explaining import Explained, explained
from iva.identification.growing import Grown, grown
from iva.identification.posterior import Beliefs
from iva.identification.pulses import WIDE
from iva.identification.records import HEAD, OMEGA, RELEASE, SIZE, Inputs, Recording
from iva.identification.responses import Values
from iva.identification.stated import Stated
from iva.identification.walls import Absorber, contacts

#: Periods and impacts of a record that is cut at a missed impact are more than these.
FEW = 3
LEAST_PERIODS = 2.0
#: Samples before an impact that is not seen, and after the last one, that count at least.
CLOSE = 3
#: Part of a period within which an impact is the one that was expected.
NEAR = 0.06
#: How far the speed of a rebound may be from what is expected, relative.
UNLIKE = 0.1
#: How often the window of a velocity is looked at, how much longer it is each time, and what part
#: of a period follows an impact at least.
WINDOWS, LONGER, AFTER = 16, 1.5, 0.2
#: Share of impacts that follow below which a window is too long.
MOST = 0.5


@dataclass(frozen=True)
class Trail:
    """What explains a record, the absorber whose impacts follow each other, and the priors."""

    shown: Explained
    grown: Grown
    beliefs: Beliefs

    @property
    def inputs(self) -> Inputs:
        """The numbers of the record."""
        return self.shown.refined.inputs

    @property
    def follows(self) -> bool:
        """Whether most impacts follow."""
        return self.grown.hits >= MOST * self.inputs.times.size

    @property
    def long(self) -> bool:
        """Whether there is enough of it for a window that ends with it."""
        last = self.inputs.times[self.grown.hits - 1] - self.inputs.head[RELEASE]
        return bool(last * self.shown.hertz > LEAST_PERIODS and self.grown.hits > FEW)


@dataclass(frozen=True)
class Told:
    """A trail, notes on it, whether most impacts follow, and whether one was interrupted."""

    trail: Trail
    notes: list[str]
    follow: bool
    interrupted: bool = False


def trailed(recording: Recording, clock: float, floor: float, known: Stated) -> Told:
    """Return what explains a record up to where its trail of impacts ends.

    Parameters
    ----------
    recording : Recording
        The record.
    clock : float
        Instant of the first sample on the clock of the record in s.
    floor : float
        Least standard deviation of the noise.
    known : Stated
        What is known beforehand.

    Raises
    ------
    KeyboardInterrupt
        If it is interrupted before there is a trail.
    """
    until = target = float(recording.time[-1])

    def follow(end: float, seen: tuple[Values, Values] | None = None) -> Trail:
        return followed(cut(recording, end), clock, floor, known, seen)

    whole = window = follow(until)
    best, words, stride, interrupted = whole, "", LONGER, False
    try:
        for _ in range(WINDOWS):
            end, told = ending(window, target)
            spoiled = recording.order == 1 and not window.follows
            made = None
            if not spoiled and not end < target:
                made, words = window, ""
            elif spoiled and best is whole and window.inputs.times.size > 2 * FEW:
                # What is missed late spoils all.
                times = window.inputs.times
                target = float(times[times.size // 2]) - CLOSE / recording.sampling_hz
                window = follow(target)
                continue
            elif window.long:
                part = follow(end, before(window, end))
                if best is whole or part.grown.hits > best.grown.hits:
                    made, words = part, told.format(end + clock)
            if made is None and (best is whole or stride == 1.0):
                break
            best = best if made is None else made
            if recording.order == 2 or (made is window and not target < until):
                break
            # By long windows, and where these fail by single impacts.
            stride = 1.0 if made is None else LONGER
            ahead = next_after(best.inputs, best.grown.hits, best.grown.absorber, until)
            begin, last = float(best.inputs.head[RELEASE]), float(best.shown.recording.time[-1])
            target = begin + stride * (last - begin)
            target = min(max(target, ahead[0] + AFTER / best.shown.hertz), until)
            window = follow(target, continued(best, whole, ahead, target))
    except KeyboardInterrupt:
        interrupted = True
    last = float(best.shown.recording.time[-1])
    if last < until and not words:
        words = f"the record was used up to {last + clock:.4g} s"
    follows = best.grown.hits >= MOST * whole.inputs.times.size
    return Told(best, [words] if words else [], follows, interrupted)


def followed(
    recording: Recording,
    clock: float,
    floor: float,
    known: Stated,
    seen: tuple[Values, Values] | None = None,
) -> Trail:
    """Return what explains a record and how far its impacts follow each other.

    ``seen`` are instants and jumps of impacts where some have been found already.
    """
    fixed, expected = heads(known, clock)
    shown = explained(recording, floor, fixed, expected, seen)
    inputs = shown.refined.inputs
    size = abs(float(inputs.head[SIZE])) / (float(inputs.head[OMEGA]) if inputs.blow else 1.0)
    beliefs = beliefs_of(known, size)
    pull = pull_of(beliefs)
    every = contacts(
        inputs,
        shown.refined.covariance,
        inputs.times.size,
        known.taken.get("gap_velocity", 0.0),
    )
    nu, clearance, place, restitution = map(float, pull[0])
    begin = Absorber(nu, clearance, place, restitution, scatter=0.1, play=0.01)
    return Trail(shown, grown(every, begin, pull), beliefs)


def cut(recording: Recording, end: float) -> Recording:
    """Return a record up to an instant from its first sample in s."""
    few = int(np.searchsorted(recording.time, end, side="right"))
    return replace(
        recording,
        time=recording.time[:few],
        values=recording.values[:few],
        weights=np.zeros(0),
    )


def ending(trail: Trail, until: float) -> tuple[float, str]:
    """Return up to which instant a record tells of the mass, and why, to be filled with it.

    It does up to where the next impact of the trail would be, if none is seen there.
    """
    inputs, rate, hits = trail.inputs, trail.shown.recording.sampling_hz, trail.grown.hits
    last, every = float(inputs.times[hits - 1]), inputs.times.size
    least = last + CLOSE / rate
    own = float(trail.shown.refined.covariance[HEAD + every + hits - 1, HEAD + every + hits - 1])
    doubt = np.hypot(UNLIKE, 2 * np.sqrt(own) / abs(float(inputs.jumps[hits - 1])))
    faster = (1.0, 1.0 + doubt, max(1.0 - doubt, 0.0))
    absorber = trail.grown.absorber
    ahead = min(next_after(inputs, hits, absorber, until, each)[0] for each in faster)
    ahead -= CLOSE / rate
    if hits < every:
        return max(min(last + (WIDE + 2) / rate, ahead), least), (
            f"the first {hits} of {every} impacts were used, up to {{:.4g}} s: the next one does "
            "not follow from them, one may have been missed"
        )
    return max(ahead, least), (
        "the record was used up to {:.4g} s, where the next impact would be: none is seen, it is "
        "too weak or the mass stays at its wall"
    )


def before(trail: Trail, end: float) -> tuple[Values, Values] | None:
    """Return the impacts of a trail before an instant, for a velocity."""
    if trail.shown.recording.order == 2:
        return None
    early = trail.inputs.times < end
    return trail.inputs.times[early], trail.inputs.jumps[early]


def continued(
    trail: Trail, whole: Trail, ahead: tuple[float, float], until: float
) -> tuple[Values, Values]:
    """Return the impacts of a trail, the one that comes next, and those found after it.

    Parameters
    ----------
    trail, whole : Trail
        The record up to where the trail ends, and the whole record.
    ahead : tuple of float
        Instant and jump of the one that comes next.
    until : float
        Instant from the first sample in s up to which they are asked for.
    """
    own, later, hits = trail.inputs, whole.inputs, trail.grown.hits
    near = NEAR / trail.shown.hertz
    until -= CLOSE / trail.shown.recording.sampling_hz
    after = (later.times > own.times[hits - 1] + near) & (later.times < until)
    times, jumps = later.times[after], later.jumps[after]
    if ahead[0] < until and not np.any(np.abs(times - ahead[0]) < near):
        times, jumps = np.append(times, ahead[0]), np.append(jumps, ahead[1])
    times = np.concatenate([own.times[:hits], times])
    order = np.argsort(times)
    return times[order], np.concatenate([own.jumps[:hits], jumps])[order]


__all__ = ["Told", "Trail", "trailed"]
