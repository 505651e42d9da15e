"""Basins of attraction: which steady state each start ends in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from iva import _iva
from iva.doubts import warn_of_doubts
from iva.dynamics.diagrams import MOST_CYCLES
from iva.dynamics.inventories import Attractors
from iva.dynamics.orbits import Orbit, scene_told
from iva.dynamics.search import MOST_PERIODS, alone_or_all, members, orbit_of, start_of, whole
from iva.dynamics.starts import is_name, names_of
from iva.forces import Drive, Harmonic, listed, single
from iva.parameters import Absorbers, Primary, Start, numbers, shown
from iva.progress import Progress, reporting
from iva.scenes import scene
from iva.spelling import spell_checked
from iva.structures import Structure

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from typing import Any

    from iva import theory
    from iva.simulation import Run

#: Labels of cells, row by row.
Labels = NDArray[np.int32]
#: Label of a cell that is not decided, and of one that ends without impacts.
UNDECIDED, NO_IMPACTS = -1, -2
#: Label of a cell that was not finished before Ctrl-C.
CANCELLED = -3
#: Most cells of a grid.
MOST_CELLS = 10**7
#: Most cells along the side of a box.
MOST_SIDE = 1000


@dataclass(frozen=True, slots=True, kw_only=True, repr=False, eq=False)
class Basins:
    """Basins of attraction over two numbers of the start.

    Parameters
    ----------
    absorber : Siva, Piva, Stop, or a list of them
        The absorber.
    primary : Primary or Structure
        The primary system.
    force : Harmonic
        The force.
    start : Start
        The start; two of its numbers are replaced.
    over : tuple of str, length 2
        The number across and the number up.
    x, y : ndarray of float, shape (nx,) and (ny,)
        Their values.
    attractors : tuple of Orbit
        The periodic attractors; their labels are their indices. Where orbits are given, those.
    left_out : tuple of str
        Why no cell has the label of one of these, or why an orbit that cells end in is not among
        them, each in a sentence; cells that end in it are undecided.
    labels : ndarray of int, shape (ny, nx)
        The label of each cell: index of an attractor, −2 for a motion without impacts, −1 where
        `most_cycles` did not suffice or rounding errors may have decided, −3 where Ctrl-C came
        before the cell was finished.
    likely : ndarray of int, shape (ny, nx)
        The same, where also those cells have a label that rounding errors may have decided.
    cycles : ndarray of int, shape (ny, nx)
        Number of periods of the force until each cell was decided.
    entropy : float or None
        Basin entropy of the likely labels, in boxes of `side` × `side` cells: 0 where each box has
        one label, at most ln of the number of labels. ``None`` without labels, and after Ctrl-C.
    boundary_entropy : float or None
        The same of the boxes with more than one label; a value above ln 2, which takes three labels
        or more, shows that the boundary is fractal. ``None`` where there are none.
    side : int
        Side of these boxes, in cells.

    Examples
    --------
    >>> siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=3.4)
    >>> primary = iva.Primary(damping_ratio=0.05)
    >>> force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    >>> found = iva.dynamics.basins(
    ...     siva, primary, force=force, over={"displacement": [-4, 0, 4], "velocity": [-2, 2]}
    ... )
    >>> found.labels.shape
    (2, 3)
    """

    # Any: an absorber or a list, a primary or a structure, as they were given.
    absorber: Any
    primary: Any
    force: Drive
    start: Start
    over: tuple[str, str]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    attractors: tuple[Orbit, ...]
    left_out: tuple[str, ...]
    labels: Labels
    likely: Labels
    cycles: NDArray[np.int64]
    entropy: float | None
    boundary_entropy: float | None
    side: int

    @property
    def fractions(self) -> dict[int, float]:
        """Likely label → its share of all cells; −1 for the cells that have none, −3 cancelled."""
        labels, counts = np.unique(self.likely, return_counts=True)
        pairs = zip(labels.tolist(), counts.tolist(), strict=True)
        return {label: count / self.likely.size for label, count in pairs}

    @property
    def undecided(self) -> float:
        """Share of the cells whose label is not sure: of −1 in `labels`."""
        return float(np.mean(self.labels == UNDECIDED))

    def __eq__(self, other: object) -> bool:
        """Compare the scene and all numbers."""
        if not isinstance(other, Basins):
            return NotImplemented
        pairs = ((getattr(self, one.name), getattr(other, one.name)) for one in fields(self))
        return all(np.array_equal(a, b) if isinstance(a, np.ndarray) else a == b for a, b in pairs)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        """Show the grid, the share of each label, the entropies and the scene."""
        across, up = self.over
        lines = [f"Basins: {self.x.size} values of {across}, {self.y.size} of {up}"]
        for label, share in self.fractions.items():
            lines.append(f"  {share:.4f} {self.name_of(label)}")
        lines.append(f"  {self.undecided:.4f} of the cells not sure")
        if cancelled := int(np.count_nonzero(self.labels == CANCELLED)):
            done = self.labels.size - cancelled
            lines.append(f"  cancelled: {done} of {self.labels.size} cells are finished")
        lines += [f"  left out: {reason}" for reason in self.left_out]
        if self.entropy is not None:
            of = self.boundary_entropy
            boundary = "" if of is None else f", of the boundary {of:.4g}"
            lines.append(f"  entropy {self.entropy:.4g}{boundary} (boxes of {self.side} cells)")
        lines += scene_told(self.absorber, self.primary, *listed(self.force), self.start)
        return "\n".join(lines)

    def name_of(self, label: int) -> str:
        """Return the words for a label.

        Parameters
        ----------
        label : int
            Index of an attractor, −1, −2 or −3.

        Raises
        ------
        IndexError
            If there is no such attractor.
        """
        if label == UNDECIDED:
            return "undecided"
        if label == NO_IMPACTS:
            return "no impacts"
        if label == CANCELLED:
            return "cancelled"
        orbit = self.attractors[label]
        return f"{len(orbit.impacts)}:{orbit.periods}, {label}"


@spell_checked
def basins(
    absorber: Absorbers,
    primary: Primary | Structure,
    *,
    force: Harmonic | Sequence[Harmonic],
    over: Mapping[str, Iterable[float]],
    start: Start | Run | theory.Orbit | Orbit | Iterable[float] | None = None,
    attractors: Attractors | Sequence[Orbit] | None = None,
    most_cycles: int = 150,
    most_periods: int = 16,
    side: int = 4,
    progress: bool | Progress = False,
) -> Basins:
    """Find which periodic attractor each start of a grid ends in.

    Parameters
    ----------
    absorber : Siva, Piva, Stop, or a list of them
        A free mass, a pendulum, or a stop on the ground; or several, as for :func:`orbit`.
    primary : Primary or Structure
        The primary system; what it is given decides the units.
    force : Harmonic
        A harmonic force, or motion of the base; or several whose frequencies are fractions of each
        other: a period is then the shortest after which all of them repeat.
    over : mapping of str to sequence of float
        The number across and the number up with their values: two of ``displacement``,
        ``velocity``, ``gap_displacement`` and ``gap_velocity``, of several absorbers with the index
        of one, as in ``gap_velocity.1``.
    start : Start, Run, theory.Orbit, Orbit or sequence of float, shape (4,), optional
        The other two numbers and the instant, as for :func:`orbit`; 0 by default.
    attractors : Attractors or sequence of Orbit, optional
        The attractors to tell apart, stable orbits of the same scene at the phase of the start;
        their labels are their indices. Of :class:`Attractors` the two orbits of a mirror pair have
        a label each. Of several modes they are found from the cells only. By default those that up
        to 256 of the cells end in.
    most_cycles : int, default 150
        Most periods of the force that are run from each cell; what has come to no orbit by then is
        undecided, as is what ends in chaos or on a torus.
    most_periods : int, default 16
        Most periods after which an orbit that is found repeats, up to 1000.
    side : int, default 4
        Side of the boxes of the entropies, in cells.
    progress : bool or callable, default False
        As in :func:`iva.sweep`; a point is a cell.

    Returns
    -------
    Basins

    Raises
    ------
    TypeError
        If an argument is of the wrong class.
    ValueError
        If a value is missing or out of range, a start lies outside the gap, the force is not one
        harmonic force, or the orbits are of another scene or not stable.
    KeyboardInterrupt
        On Ctrl-C before a cell is finished. Later it ends the basins with what they have, once the
        rows that have begun are finished, and the other cells have the label −3.

    Notes
    -----
    A cell is decided as soon as it is so near to an orbit that it stays there; that region has been
    tried with many points, not proven. Rounding errors are carried along by the exact derivative:
    where they reach 10⁻⁷ of the state on the way, the label is not sure. Entropies: A. Daza et al.,
    Scientific Reports 6 (2016) 31416.

    Examples
    --------
    >>> siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=3.4)
    >>> primary = iva.Primary(damping_ratio=0.05)
    >>> force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    >>> x, v = np.linspace(-4, 4, 12), np.linspace(-4, 4, 8)
    >>> found = basins(siva, primary, force=force, over={"displacement": x, "velocity": v})
    >>> found.labels.shape, len(found.attractors)
    ((8, 12), 2)
    """
    absorber = alone_or_all(absorber)
    names, values = plane(over, absorber)
    begin = Start() if start is None else start_of(start, absorber)
    made = scene(absorber, primary, begin, force, {}, several=True)
    warn_of_doubts(made)
    given = None
    if attractors is not None:
        given = known(attractors, (absorber, primary, force), begin)
    longest = max((orbit.least_periods for orbit in given or ()), default=1)
    limits = (
        max(longest, whole("most_periods", most_periods, 1, MOST_PERIODS)),
        whole("most_cycles", most_cycles, 1, MOST_CYCLES),
        whole("side", side, 1, MOST_SIDE),
    )
    states: list[Any] | None = None if given is None else [orbit.state for orbit in given]
    with reporting(progress) as report:
        found = _iva.basins(made, names, values, states, limits, report)
    parts = (absorber, primary, single(force))
    orbits = given or []
    for described, periods in zip(found["orbits"], found["periods"], strict=True):
        orbit = orbit_of(described, parts, periods, begin)
        assert isinstance(orbit, Orbit)
        orbits.append(orbit)
    shape = (len(values[1]), len(values[0]))
    return Basins(
        absorber=absorber,
        primary=primary,
        force=parts[2],
        start=begin,
        over=names,
        x=np.array(values[0]),
        y=np.array(values[1]),
        attractors=tuple(orbits),
        left_out=tuple(found["left_out"]),
        labels=np.array(found["labels"], np.int32).reshape(shape),
        likely=np.array(found["likely"], np.int32).reshape(shape),
        cycles=np.array(found["cycles"], np.int64).reshape(shape),
        entropy=found["entropy"],
        boundary_entropy=found["boundary_entropy"],
        side=limits[2],
    )


def plane(
    over: object, absorber: object
) -> tuple[tuple[str, str], tuple[list[float], list[float]]]:
    """Return names and values of the two numbers of a grid.

    Raises
    ------
    TypeError
        If it is no mapping of names to numbers.
    ValueError
        If there are not two numbers of the start, or there are too many cells.
    """
    rule = f"give values of two of {', '.join(names_of(2 + 2 * members(absorber)))}"
    if not isinstance(over, Mapping):
        raise TypeError(f"over = {shown(over)}: {rule}")
    if len(over) != 2 or not all(is_name(name, absorber) for name in over):
        raise ValueError(f"over of {shown(list(over))}: {rule}")
    across, up = over
    one, other = (numbers(f"over[{name!r}]", over[name]) for name in (across, up))
    if not 0 < len(one) * len(other) <= MOST_CELLS:
        raise ValueError(f"over has {len(one)} × {len(other)} cells: give 1 to {MOST_CELLS}")
    return (across, up), (one, other)


def known(given: object, parts: tuple[object, object, object], begin: Start) -> list[Orbit]:
    """Return the orbits that are given, with both of each mirror pair.

    Raises
    ------
    TypeError
        If something is no orbit.
    ValueError
        If there is none, or one is of another scene, at another phase, or not stable.
    """
    orbits: list[Orbit] = []
    if isinstance(given, Attractors):
        for one in given.attractors:
            orbits += [one.orbit, one.orbit.mirror()] if one.pair else [one.orbit]
    else:
        orbits += given if isinstance(given, (list, tuple)) else (given,)
    if not orbits:
        raise ValueError("attractors: there is none; leave them out to find some")
    absorber, primary, force = parts
    for index, orbit in enumerate(orbits):
        if not isinstance(orbit, Orbit):
            raise TypeError(f"attractors: {shown(orbit)} is no orbit of iva.dynamics")
        if (orbit.absorber, orbit.primary, orbit.force) != (absorber, primary, single(force)):
            raise ValueError("attractors: give orbits of the same absorber, primary and force")
        if (orbit.start.time or 0.0) != (begin.time or 0.0):
            raise ValueError("attractors: give orbits that begin at the instant of the start")
        if not orbit.stable:
            rule = "give stable orbits, whose multipliers are all smaller than 1 in size"
            size = abs(orbit.multipliers[0])
            raise ValueError(f"attractors[{index}] has a multiplier of size {size:.6g}: {rule}")
    return orbits
