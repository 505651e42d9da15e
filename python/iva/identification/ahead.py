"""Where the next impact of a trail would be, from the last one that was seen."""

from __future__ import annotations

import numpy as np

from iva.identification.records import Inputs
from iva.identification.responses import Values, to_jump, to_release
from iva.identification.walls import Absorber

#: Instants a period at which walls are looked at.
FINE = 400


def next_after(
    inputs: Inputs, hits: int, absorber: Absorber, until: float, faster: float = 1.0
) -> tuple[float, float]:
    """Return when a free mass strikes next and the jump that follows.

    The instant is in s from the first sample, infinite if it is not before `until`.

    The jump of the last impact tells the speed of its rebound, e |Δv| (1 + 1/μ) / (1 + e), and the
    mass flies straight from that wall on.

    Parameters
    ----------
    inputs : Inputs
        The numbers of the record.
    hits : int
        Number of impacts of the trail.
    absorber : Absorber
        The numbers of the mass.
    until : float
        End of the record in s from the first sample.
    faster : float
        How fast the rebound is, over what is expected.
    """
    omega, zeta, _, release, size = inputs.head
    last, jump = float(inputs.times[hits - 1]), float(inputs.jumps[hits - 1])
    step = 2 * np.pi / omega / FINE
    time = last + step * np.arange(1, max(int((until - last) / step), 1) + 1)
    at = np.concatenate([[last + 1e-3 * step], time])

    def motion(order: int) -> Values:
        begun = to_jump if inputs.blow else to_release
        free = begun(omega, zeta, 0.0, order).total(at, np.array([release]), np.array([size]))
        struck = to_jump(omega, zeta, 0.0, order)
        return free + struck.total(at, inputs.times[:hits], inputs.jumps[:hits])

    x, v = motion(0), motion(1)
    e = absorber.restitution
    rebound = -faster * e * jump * (1 + absorber.heaviness) / (1 + e)
    flown = (v[0] + rebound) * (at - last) - (x - x[0])
    wall = np.sign(jump) * absorber.clearance
    beyond = np.flatnonzero(np.abs(wall + flown[1:]) > absorber.clearance)
    if not beyond.size:
        return np.inf, 0.0
    approach = v[0] + rebound - v[beyond[0] + 1]
    return float(time[beyond[0]]), float((1 + e) * approach / (1 + absorber.heaviness))


__all__ = ["next_after"]
