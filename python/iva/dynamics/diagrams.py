"""Bifurcation diagrams: what steady states do while a number of their scene goes up and down."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from iva import _iva
from iva.doubts import warn_of_doubts
from iva.dynamics.orbits import Orbit, scene_told
from iva.dynamics.search import alone_or_all, start_of, whole
from iva.forces import Drive, Harmonic, listed, single
from iva.parameters import Absorbers, Primary, Start, numbers, shown
from iva.progress import Progress, reporting
from iva.scenes import scene
from iva.spelling import spell_checked
from iva.structures import Structure

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from typing import Any, Literal

    import polars as pl

    from iva import theory
    from iva.simulation import Run

#: Most periods that are run for one value.
MOST_CYCLES = 10**9
#: Word for the directions → the directions.
DIRECTIONS = {"both": ("up", "down"), "up": ("up",), "down": ("down",)}


@dataclass(frozen=True, slots=True)
class Outcome:
    """How the runs for one value of a diagram ended.

    Parameters
    ----------
    value : float
        The number that is changed.
    direction : str
        ``up`` or ``down``.
    outcome : str
        ``finished``; or ``impact_limit``, ``work_limit`` or ``not_finite``: then it has fewer
        strobes, and the next value begins anew, from rest in the middle of the gap.
    strobes : int
        Number of strobes kept.
    """

    value: float
    direction: str
    outcome: str
    strobes: int


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Diagram:
    """A bifurcation diagram.

    Parameters
    ----------
    absorber : Siva, Piva, Stop, or a list of them
        The absorber; the number that is changed has the value of the scene that was given.
    primary : Primary or Structure
        The primary system.
    force : Harmonic
        The force.
    start : Start
        The state that the first value of each direction begins from.
    over : str
        The number that is changed.
    discard, keep : int
        Number of periods of the force left out and kept for each value.
    outcomes : tuple of Outcome
        How the runs ended: for each direction its values, increasing.

    Examples
    --------
    >>> siva = iva.Siva(mass_ratio=0.2, restitution=0.7)
    >>> primary = iva.Primary(damping_ratio=0.05)
    >>> force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    >>> found = iva.dynamics.diagram(
    ...     siva, primary, force=force, over={"clearance": [3.7, 4.1, 4.5]}, keep=20
    ... )
    >>> [outcome.strobes for outcome in found.outcomes]
    [20, 20, 20, 20, 20, 20]
    """

    # Any: an absorber or a list, a primary or a structure, as they were given.
    absorber: Any
    primary: Any
    force: Drive
    start: Start
    over: str
    discard: int
    keep: int
    outcomes: tuple[Outcome, ...]
    #: The names of the numbers of a strobe.
    names: tuple[str, ...] = field(repr=False)
    #: The numbers of each strobe, and its impacts, in the order of the outcomes.
    strobes: tuple[tuple[float, ...], ...] = field(repr=False)

    @property
    def table(self) -> pl.DataFrame:
        """Its strobes as a frame.

        One row a strobe: value, direction, cycle (from 0, of those kept), displacement, velocity,
        gap_displacement, gap_velocity (of several absorbers those of each, as in
        ``gap_velocity.1``), and impacts in the period that ends there.
        """
        import polars as pl

        heads = [
            (one.value, one.direction, cycle)
            for one in self.outcomes
            for cycle in range(one.strobes)
        ]
        rows = [head + strobe for head, strobe in zip(heads, self.strobes, strict=True)]
        floats = dict.fromkeys(self.names, pl.Float64)
        schema = {"value": pl.Float64, "direction": pl.String, "cycle": pl.Int64, **floats}
        return pl.DataFrame(rows, {**schema, "impacts": pl.Int64}, orient="row")

    def __repr__(self) -> str:
        """Show range, directions and the scene."""
        values = sorted({one.value for one in self.outcomes})
        ways = list(dict.fromkeys(one.direction for one in self.outcomes))
        bad = sum(one.outcome != "finished" for one in self.outcomes)
        lines = [
            f"Diagram: {len(values)} values of {self.over} from {values[0]:g} to {values[-1]:g}, "
            f"{' and '.join(ways)}",
            f"  {self.keep} strobes each after {self.discard} periods, {bad} values not finished",
        ]
        lines += scene_told(self.absorber, self.primary, *listed(self.force), self.start)
        return "\n".join(lines)


@spell_checked
def diagram(
    absorber: Absorbers,
    primary: Primary | Structure,
    *,
    force: Harmonic | Sequence[Harmonic],
    over: Mapping[str, Iterable[float]],
    direction: Literal["both", "up", "down"] = "both",
    start: Start | Run | theory.Orbit | Orbit | Iterable[float] | None = None,
    discard: int = 300,
    keep: int = 60,
    progress: bool | Progress = False,
) -> Diagram:
    """Follow a steady state through values of a number of its scene, each from the end of the last.

    Where the diagram upwards is another than that downwards there are two steady states: the
    machine jumps at the end of each, and not at the same value.

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
        The number that is changed, by the name that a sweep has for it, such as ``"clearance"`` or
        ``"force.frequency"``, and its values, increasing; it takes the place of what the scene has.
    direction : {"both", "up", "down"}, default "both"
        Go through the values upwards, downwards, or both: once upwards and once downwards.
    start : Start, Run, theory.Orbit, Orbit or sequence of float, shape (4,), optional
        Where the first value of each direction begins, as for :func:`orbit`; at rest in the middle
        of the gap by default. In a gap that is wider than the structure moves, an absorber at rest
        stays so: give it a gap velocity to see what it does when it moves.
    discard : int, default 300
        Number of periods of the force to leave out for each value.
    keep : int, default 60
        Number of periods that follow, at whose ends the state is kept.
    progress : bool or callable, default False
        As in :func:`iva.sweep`; a point is a value in one direction.

    Returns
    -------
    Diagram

    Raises
    ------
    TypeError
        If an argument is of the wrong class.
    ValueError
        If a value is missing or out of range, the values do not increase, the start lies outside
        the gap, or the force is not one harmonic force.
    KeyboardInterrupt
        On Ctrl-C before there is a strobe. Later it ends the diagram with what it has, within about
        a second, and `outcomes` say ``"cancelled"``.

    Notes
    -----
    Where the gap becomes narrower than the place of the absorber, it is put on the wall. Near
    a bifurcation transients are long: with too small a `discard` they smear the diagram.

    Examples
    --------
    >>> siva = iva.Siva(mass_ratio=0.2, restitution=0.7)
    >>> primary = iva.Primary(damping_ratio=0.05)
    >>> force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    >>> found = diagram(siva, primary, force=force, over={"clearance": [3.7, 4.1, 4.5]}, keep=20)
    >>> found.table.columns[:4]
    ['value', 'direction', 'cycle', 'displacement']
    >>> found.table.height
    120
    """
    name, values = axis_of(over)
    if direction not in DIRECTIONS:
        raise ValueError(f"direction = {shown(direction)}: give 'both', 'up' or 'down'")
    absorber = alone_or_all(absorber)
    begin = Start() if start is None else start_of(start, absorber)
    made = scene(absorber, primary, begin, force, {}, several=True)
    warn_of_doubts(made)
    window = (whole("discard", discard, 0, MOST_CYCLES), whole("keep", keep, 1, MOST_CYCLES))
    with reporting(progress) as report:
        found = _iva.diagram(made, name, values, DIRECTIONS[direction], window, report)
    heads = zip(
        found["values"], found["directions"], found["outcomes"], found["counts"], strict=True
    )
    pairs = zip(found["states"], found["impacts"], strict=True)
    return Diagram(
        absorber=absorber,
        primary=primary,
        force=single(force),
        start=begin,
        over=name,
        discard=window[0],
        keep=window[1],
        outcomes=tuple(Outcome(*head) for head in heads),
        names=tuple(found["names"]),
        strobes=tuple((*state, impacts) for state, impacts in pairs),
    )


def axis_of(over: object) -> tuple[str, list[float]]:
    """Return name and values of the one number that is changed.

    Raises
    ------
    TypeError
        If it is no mapping of a name to numbers.
    ValueError
        If there is not exactly one.
    """
    if not isinstance(over, Mapping) or not all(isinstance(name, str) for name in over):
        rule = "give a name with its values, such as {'clearance': [1.0, 2.0]}"
        raise TypeError(f"over = {shown(over)}: {rule}")
    if len(over) != 1:
        raise ValueError(f"over has {len(over)} numbers: give one with its values")
    [(name, values)] = over.items()
    return name, numbers(f"over[{name!r}]", values)
