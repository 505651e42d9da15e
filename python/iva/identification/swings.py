"""The motion of a structure with a pendulum, impact by impact, each with a restitution of its own.

Flights are those of :func:`iva.simulate`; a run goes to its first impact, the next one starts from
the state after it.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import polars as pl

from iva import _iva
from iva.identification.responses import Values
from iva.parameters import Piva, Primary, Start
from iva.simulation import Run, simulate

#: Exact states a period between which a displacement is interpolated.
NODES = 40
#: Most impacts of a motion.
MOST = 400

#: Places of the numbers: logarithms of frequency (Hz), mass ratio, gap, frequency ratio and size of
#: the release; damping ratio, instant of the release, offset of the record.
NUMBERS = (
    "frequency_hz",
    "mass_ratio",
    "gap",
    "frequency_ratio",
    "displacement",
    "damping_ratio",
    "release",
    "offset",
)
HEAD = len(NUMBERS)
#: Those that stand as logarithms; the sign of the displacement is kept beside.
LOGARITHMS = 5


@dataclass(frozen=True)
class Rig:
    """What is set of a pendulum beside what is fitted.

    ``sign`` is that of the displacement; ``length`` where it is known, else it follows from gravity
    and the frequency ratio; ``known_ratio`` says that the frequency ratio follows from the length.
    """

    sign: float = 1.0
    gravity: float = 9.80665
    inertia_ratio: float = 1.0
    length: float | None = None
    contact_distance: float | None = None
    gap_velocity: float = 0.0
    place: float = 0.0


@dataclass
class Swing:
    """A motion: values at the asked instants, and the impacts that it had.

    ``begins`` are instant and state after release and each impact, from where it can be resumed.
    """

    values: Values
    times: list[float] = field(default_factory=list)
    jumps: list[float] = field(default_factory=list)
    approaches: list[float] = field(default_factory=list)
    begins: list[tuple[float, Start]] = field(default_factory=list)


def parts_of(numbers: Values, rig: Rig) -> tuple[Piva, Primary]:
    """Return the pendulum, all but its restitution, and the structure."""
    hertz, mass_ratio, gap, ratio, _ = np.exp(numbers[:LOGARITHMS])
    omega = 2 * np.pi * hertz
    if rig.length is not None:
        ratio = np.sqrt(rig.gravity / (rig.inertia_ratio * rig.length)) / omega
        length = rig.length
    else:
        length = rig.gravity / (rig.inertia_ratio * (ratio * omega) ** 2)
    pendulum = Piva(
        mass_ratio=float(mass_ratio),
        restitution=0.5,
        gap=float(gap),
        frequency_ratio=float(ratio),
        length=float(length),
        inertia_ratio=rig.inertia_ratio,
        contact_distance=rig.contact_distance,
    )
    damping = max(float(numbers[LOGARITHMS]), 0.0)
    return pendulum, Primary(frequency_hz=float(hertz), damping_ratio=damping)


def swing(
    time: Values,
    order: int,
    numbers: Values,
    restitutions: Values,
    rig: Rig,
    until: float,
    resumed: tuple[Swing, int] | None = None,
) -> Swing:
    """Return what a record has of the motion up to an instant.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Instants from the first sample, in order.
    order : int
        0 for the displacement, 1 for the velocity.
    numbers : ndarray, shape (8,)
        As :data:`NUMBERS`.
    restitutions : ndarray, shape (k,)
        Of the impacts in their order; further impacts have the last one's.
    rig : Rig
        What is set.
    until : float
        Instant from the first sample at which the motion may end.
    resumed : tuple of Swing and int, optional
        A motion that is the same up to the impact of this number, 0 the first.

    Raises
    ------
    ValueError
        If the numbers are of no scene.
    """
    pendulum, primary = parts_of(numbers, rig)
    size = rig.sign * float(np.exp(numbers[4]))
    offset = float(numbers[7])
    if resumed is None:
        made = Swing(np.full(time.size, (size if order == 0 else 0.0) + offset))
        begin, hit = float(numbers[6]), 0
        state = Start(displacement=size, gap_displacement=rig.place, gap_velocity=rig.gap_velocity)
    else:
        before, hit = resumed
        made = Swing(
            before.values.copy(),
            before.times[:hit],
            before.jumps[:hit],
            before.approaches[:hit],
            before.begins[:hit],
        )
        begin, state = before.begins[hit]
    while begin < until and hit < MOST:
        made.begins.append((begin, state))
        e = float(restitutions[min(hit, restitutions.size - 1)])
        last = until - begin
        run = simulate(
            replace(pendulum, restitution=e), primary, start=state, duration=last, max_impacts=1
        )
        impact = run.impacts
        ended = impact.height > 0 and impact["time"][0] < last
        flight = float(impact["time"][0]) if ended else last
        first = int(np.searchsorted(time, begin, side="right"))
        stop = int(np.searchsorted(time, begin + flight, side="right"))
        if stop > first:
            since = time[first:stop] - begin
            values = flown(run, since, flight, order, float(np.exp(-numbers[0])))
            made.values[first:stop] = values + offset
        if not ended:
            break
        row = impact.row(0, named=True)
        made.times.append(begin + flight)
        made.jumps.append(row["velocity_after"] - row["velocity_before"])
        made.approaches.append(row["approach_velocity"])
        state = Start(
            displacement=row["displacement"],
            velocity=row["velocity_after"],
            angle=row["angle"],
            angular_velocity=row["angular_velocity_after"],
        )
        begin, hit = begin + flight, hit + 1
    return made


def flown(run: Run, since: Values, flight: float, order: int, period: float) -> Values:
    """Return displacement or velocity at instants of a flight, shape (n,).

    A displacement between :data:`NODES` a period is that of cubics through the exact values and
    velocities, right to 1e-7 of the amplitude.
    """
    ends = flight * (1 - 1e-12)
    count = int(np.ceil(flight / period * NODES)) + 1
    if order == 1 or count > since.size:
        frame = pl.DataFrame(_iva.states(run._spec, np.minimum(since, ends).tolist()))
        exact: Values = frame["displacement" if order == 0 else "velocity"].to_numpy()
        return exact
    nodes = np.linspace(0.0, ends, max(count, 2))
    frame = pl.DataFrame(_iva.states(run._spec, nodes.tolist()))
    x, v = frame["displacement"].to_numpy(), frame["velocity"].to_numpy()
    step = nodes[1]
    left = np.minimum((since / step).astype(int), nodes.size - 2)
    u = since / step - left
    rise, first, last = x[left + 1] - x[left], v[left] * step, v[left + 1] * step
    made: Values = x[left] + u * (
        first + u * ((3 * rise - 2 * first - last) + u * (first + last - 2 * rise))
    )
    return made
