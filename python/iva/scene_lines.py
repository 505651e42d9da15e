"""What results print of their scene: its parts, with what is easily given otherwise than meant."""

from __future__ import annotations

import math

from iva import _iva
from iva.forces import Force, Harmonic, written
from iva.parameters import Absorber, Part, Primary, Start
from iva.structures import Structure

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from collections.abc import Sequence

    #: A part of a scene; of several absorbers or forces each is one.
    Printed = Part | Force | Structure | None


def scene_lines(*parts: Printed) -> list[str]:
    """Return a line for each part of a scene, with its frequency where time has a unit.

    Examples
    --------
    >>> scene_lines(Primary(natural_frequency=10), Harmonic(amplitude=1, relative_frequency=2))
    ... # doctest: +NORMALIZE_WHITESPACE
    ['Primary(natural_frequency=10.0)  # 10 rad/s = 1.592 Hz',
     'Harmonic(amplitude=1.0, relative_frequency=2.0)  # 20 rad/s = 3.183 Hz']
    """
    return [with_frequency(part, parts) for part in parts]


def with_frequency(part: Printed, parts: Sequence[Printed]) -> str:
    """Return a part of a scene as it was given, with its frequency in rad/s and in Hz."""
    primaries = (one for one in parts if isinstance(one, (Primary, Structure)))
    natural = next((natural_frequency(one) for one in primaries), None)
    frequency = None
    if isinstance(part, (Primary, Structure)):
        frequency = natural
    elif isinstance(part, Harmonic) and natural is not None:
        frequency = frequency_of(part, natural)
    return written(part) if frequency is None else f"{written(part)}  # {in_both(frequency)}"


def in_both(frequency: float) -> str:
    """Return a frequency, given in rad/s, in both units.

    Examples
    --------
    >>> in_both(10.0)
    '10 rad/s = 1.592 Hz'
    """
    return f"{frequency:.4g} rad/s = {frequency / (2.0 * math.pi):.4g} Hz"


def natural_frequency(primary: Primary | Structure) -> float | None:
    """Return the natural frequency in rad/s, ``None`` where time has no unit.

    Examples
    --------
    >>> natural_frequency(Primary(mass=2, stiffness=800)), natural_frequency(Primary())
    (20.0, None)
    """
    if isinstance(primary, Structure):
        modes: Sequence[tuple[float, float]] = _iva.modes(primary._entries())[0]
        return modes[(primary.natural_mode or 1) - 1][0]
    if primary.natural_frequency is not None:
        return primary.natural_frequency
    if primary.frequency_hz is not None:
        return 2.0 * math.pi * primary.frequency_hz
    if primary.stiffness is not None and primary.mass is not None:
        return math.sqrt(primary.stiffness / primary.mass)
    return None


def frequency_of(force: Harmonic, natural: float) -> float | None:
    """Return the frequency of a force in rad/s, given the natural one."""
    if force.frequency_hz is not None:
        return 2.0 * math.pi * force.frequency_hz
    if force.relative_frequency is not None:
        return force.relative_frequency * natural
    return force.frequency


def carried_along(parts: Sequence[Printed]) -> list[str]:
    """Return which start velocities of the structure its absorbers have too.

    Where the start gives them a gap velocity of their own, nothing is said.

    Examples
    --------
    >>> from iva.parameters import Siva
    >>> carried_along([Siva(mass_ratio=0.1), Primary(), Start(velocity=1)])
    ['start.velocity carries the absorber along: it starts with that of the structure']
    """
    count = sum(isinstance(part, Absorber) for part in parts)
    starts = [part for part in parts if isinstance(part, Start)]
    given = (starts[0].gap_velocity, starts[0].angular_velocity) if starts else ()
    if count == 0 or any(velocity is not None for velocity in given):
        return []
    who = "the absorber" if count == 1 else "the absorbers"
    which = "it starts" if count == 1 else "each starts"
    lines = []
    if any(isinstance(part, Structure) and any(part.start_velocities or ()) for part in parts):
        lines.append(f"start_velocities carry {who} along: {which} with the velocity of its point")
    if any(one.velocity for one in starts):
        lines.append(f"start.velocity carries {who} along: {which} with that of the structure")
    return lines
