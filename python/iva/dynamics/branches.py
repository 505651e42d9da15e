"""Branches of periodic orbits: how an orbit changes with a number of its scene."""

from __future__ import annotations

import math
from dataclasses import dataclass

from iva import _iva
from iva.dynamics.branch_measures import measured
from iva.dynamics.changed_scenes import Scene
from iva.dynamics.orbits import Missed, Orbit, rounded, scene_told
from iva.dynamics.search import orbit_of, whole
from iva.forces import listed
from iva.parameters import shown
from iva.progress import Progress, reporting
from iva.spelling import spell_checked

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Any

    import polars as pl

#: Most points of a branch to either side.
MOST_POINTS = 10**6
#: The walls of a sequence of impacts, which of them begin a stick episode, the symmetry, and the
#: number of periods.
Chain = tuple[tuple[int, ...], tuple[bool, ...], bool, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """A point of a branch, in the units of the primary system.

    Parameters
    ----------
    value : float
        The number that is changed.
    arclength : float
        Length along the branch, in shares of the range and of the sizes of the state.
    amplitude : float
        Largest |x|.
    multipliers : tuple of complex
        Floquet multipliers, largest first, as many as a state has numbers. Not finite where the
        speed of an impact is 0.
    stable : bool
        All multipliers are smaller than 1 in size.
    grazing_margin : float or None
        Smallest distance of an extremum of the gap displacement between impacts to the wall that
        the absorber turns back from, also within a chatter; ``None`` without one.
    approach_speed_min : float
        Smallest approach speed of its impacts, of a stick episode of the first one.
    unknowns : tuple of float
        In natural units: the instant of the first impact, x, ẋ and ẏ (of a pendulum b θ̇) after it,
        and the instants of the others; of a symmetric orbit those of half a cycle. Of several
        absorbers or modes, and of what rubs: a phase of the cycle (0 to 1), and the numbers of the
        state there.
    """

    value: float
    arclength: float
    amplitude: float
    multipliers: tuple[complex, ...]
    stable: bool
    grazing_margin: float | None
    approach_speed_min: float
    unknowns: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Point:
    """A special point of a branch.

    Parameters
    ----------
    kind : str
        ``fold``, ``pitchfork``, ``flip``, ``neimark_sacker``, ``grazing``, ``impact_vanishes``,
        ``stick_begins``, ``impacts_coincide`` or ``slide_changes``.
    row : Row
        The orbit there, as a point of the branch; where a stick begins, with the multipliers of
        the last orbit before it.
    """

    kind: str
    row: Row
    scene: Scene
    chain: Chain
    condition: tuple[str, int, int]

    @property
    def value(self) -> float:
        """The number that is changed, where it happens."""
        return self.row.value

    @property
    def orbit(self) -> Orbit | Missed:
        """The orbit there, as a run makes it; where a stick begins, a run makes none."""
        return orbit_at(self.scene, self.chain, self.row)

    def __repr__(self) -> str:
        """Show kind, number and multipliers."""
        largest = rounded(self.row.multipliers[0])
        return f"Point: {self.kind} at {self.scene.over} = {self.value!r}, multiplier {largest}"


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Branch:
    """A branch of periodic orbits with one sequence of impacts; it is true.

    Parameters
    ----------
    scene : Scene
        Absorber, primary system, force, and the number that is changed.
    between : tuple of float, length 2
        The range of the number.
    chain : tuple
        Walls (+1 and −1) of the impacts until the motion repeats, of a symmetric orbit those of
        half of it; which of them begin a stick episode and stand for all its impacts; whether it
        is symmetric; and the number of periods of the force until it repeats. Without walls where
        there are several absorbers or modes, or something rubs.
    sequence : str or None
        The walls of such a branch.
    rows : tuple of Row
        Its points in order; the first is at the end that is reached towards smaller numbers.
    points : tuple of Point
        Its special points, in the same order.
    ends : tuple of str, length 2
        Why it ends on either side: ``range``, ``grazing``, ``impact_vanishes``, ``stick_begins``
        (beyond, the absorber leaves a wall before it sticks to it), ``impacts_coincide`` (of two
        absorbers; beyond, in the other order), ``slide_changes`` (a slide, or a time in which
        friction holds, begins or ends to be, or turns at the instant of an impact), ``origin``
        (the pitchfork or flip where it begins), ``closed``, ``stalled`` or ``points``.

    Notes
    -----
    Pseudo-arclength continuation (H. B. Keller) of the boundary-value problem in the instants of
    the impacts; special points by Newton's method on the orbit and its condition together. The
    motion from the first impact of a stick episode to its release is that of a run. Where there are
    several absorbers, units or modes, or something rubs, the equations are those of the map over
    the cycle with the derivatives of a run (single shooting); special points are sign changes along
    the branch, and its end is the last orbit with its sequence of events, down to rounding.

    Examples
    --------
    >>> siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5)
    >>> primary = iva.Primary(damping_ratio=0.05)
    >>> force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    >>> first = iva.dynamics.orbit(siva, primary, force=force, start=(0, 0, 0, 0.1), settle=200)
    >>> found = iva.dynamics.follow(first, over="clearance", between=(4.0, 5.0))
    >>> found.walls, found.ends
    ('-+', ('range', 'range'))
    """

    scene: Scene
    between: tuple[float, float]
    chain: Chain
    rows: tuple[Row, ...]
    points: tuple[Point, ...]
    ends: tuple[str, str]
    sequence: str | None
    steps: tuple[float, int]

    @property
    def symmetric(self) -> bool:
        """True if the orbits are their own mirror images half a cycle later."""
        return self.chain[2]

    @property
    def periods(self) -> int:
        """Number of periods of the force after which the orbits repeat."""
        return self.chain[3]

    @property
    def walls(self) -> str:
        """The walls until the motion repeats.

        ``+`` or ``-`` for an impact, ``(+)`` or ``(-)`` for a stick episode with all its impacts;
        of several absorbers each with the number of its absorber before it.
        """
        if self.sequence is not None:
            return self.sequence
        walls, sticks, symmetric, _ = self.chain
        both = (*walls, *(-wall for wall in walls)) if symmetric else walls
        signs = ("+" if wall > 0 else "-" for wall in both)
        marks = (*sticks, *sticks) if symmetric else sticks
        pairs = zip(signs, marks, strict=True)
        return "".join(f"({sign})" if mark else sign for sign, mark in pairs)

    @property
    def impacts(self) -> int:
        """Number of impacts until the motion repeats; a stick episode counts as one."""
        walls, _, symmetric, _ = self.chain
        if self.sequence is not None:
            return sum(self.sequence.count(sign) for sign in "+-")
        return 2 * len(walls) if symmetric else len(walls)

    @property
    def table(self) -> pl.DataFrame:
        """Its points as a frame.

        One row a point: value, arclength, amplitude, impacts, walls, stable, largest_multiplier
        (its size), grazing_margin, approach_speed_min, and the parts of the multipliers,
        multiplier_1_re, multiplier_1_im, …
        """
        import polars as pl

        plain = ("value", "arclength", "amplitude", "stable", "grazing_margin")
        columns: dict[str, list[object]] = {
            name: [getattr(row, name) for row in self.rows]
            for name in (*plain, "approach_speed_min")
        }
        sizes = [abs(row.multipliers[0]) for row in self.rows]
        frame = pl.DataFrame(columns).with_columns(
            pl.Series("largest_multiplier", sizes),
            pl.lit(self.impacts).alias("impacts"),
            pl.lit(self.walls).alias("walls"),
        )
        parts = [
            pl.Series(
                f"multiplier_{k + 1}_{name}", [getattr(row.multipliers[k], of) for row in self.rows]
            )
            for k in range(max(len(row.multipliers) for row in self.rows))
            for name, of in (("re", "real"), ("im", "imag"))
        ]
        return frame.with_columns(parts)

    def measures(self, *names: str) -> pl.DataFrame:
        """Return measures of its orbits, from a run of each over one cycle.

        A run takes some tenths of a millisecond, and as long again to find the orbit at its point:
        500 points about half a second.

        Parameters
        ----------
        *names : str
            Columns of the table ``summary`` of a run, such as ``amplitude_rms``,
            ``energy_impacts`` (lost in the impacts of a cycle), ``acceleration_max``,
            ``impulse_max`` and ``peak_force_estimate``; or the mean power over the cycle:
            ``mean_power`` of the force, ``mean_power_impacts`` lost in impacts and
            ``mean_power_viscous`` lost in the damper. A cycle is one until the orbit repeats.

        Returns
        -------
        polars.DataFrame
            One row a point of the branch: value, arclength, outcome and these. The outcome is
            ``finished``, else the measures are null: why there is no orbit, or how its run ended.

        Raises
        ------
        TypeError
            If a name is no text.
        ValueError
            If there is no name, or no such measure.
        KeyboardInterrupt
            On Ctrl-C, within about a second.

        Warns
        -----
        UserWarning
            If orbits cannot be run; it says how many.
        """
        return measured(self, names)

    def orbit(self, index: int) -> Orbit | Missed:
        """Return the orbit of a row.

        Parameters
        ----------
        index : int
            The index of the row.

        Raises
        ------
        IndexError
            If there is no such row.
        """
        return orbit_at(self.scene, self.chain, self.rows[index])

    def switch(self, index: int, *, progress: bool | Progress = False) -> Branch | Missed:
        """Follow the branch that begins at a special point, within the same range.

        At a pitchfork that of the asymmetric orbits (their mirror images are another one); at a
        flip that of the orbits that take twice as long; at a grazing that with the impact that
        begins there; where an impact vanishes that without it. Where this branch itself begins at
        the point, it is the branch that it begins on. At a fold, which the branch has rounded
        already, at a Neimark–Sacker point and where a stick begins, no branch of orbits begins: a
        `Missed` is returned, as where too few impacts are left for an isolated orbit. Of several
        absorbers or modes, and of what rubs, only those of pitchforks and flips are found.

        Parameters
        ----------
        index : int
            The index of the point.
        progress : bool or callable, default False
            As in :func:`follow`.

        Raises
        ------
        IndexError
            If there is no such point.
        """
        point = self.points[index]
        given = (point.chain, point.condition, point.value, point.row.unknowns)
        steps = (self.between, *self.steps)
        with reporting(progress) as report:
            found = _iva.switch(self.scene.spec(), given, self.scene.over, steps, report)
        return branch(found, self.scene, self.between, self.steps)

    def __repr__(self) -> str:
        """Show its range, impacts, ends and special points."""
        shape = "symmetric" if self.symmetric else "asymmetric"
        values = [row.value for row in self.rows]
        span = f"{min(values):.6g} to {max(values):.6g}"
        count = f"{self.impacts} impacts {self.walls} in {self.periods} periods"
        stable = sum(row.stable for row in self.rows)
        lines = [
            f"Branch: {self.scene.over} from {span}, {shape}, {count}",
            f"  {len(self.rows)} orbits, {stable} of them stable; ends: {', '.join(self.ends)}",
        ]
        lines += [f"  {point.kind} at {point.value:.12g}" for point in self.points]
        scene = self.scene
        lines += scene_told(scene.absorber, scene.primary, *listed(scene.force))
        return "\n".join(lines)


@spell_checked
def follow(
    orbit: Orbit,
    *,
    over: str,
    between: tuple[float, float],
    step: float = 0.02,
    most_points: int = 2000,
    progress: bool | Progress = False,
) -> Branch | Missed:
    """Follow a periodic orbit over a number of its scene, in both directions and around folds.

    Parameters
    ----------
    orbit : Orbit
        The orbit to begin with; it may be unstable.
    over : str
        The number that is changed, by the name that a sweep has for it, such as ``"clearance"`` or
        ``"force.frequency"``; the scene must give it.
    between : tuple of float, length 2
        Its range, in the unit that it is given in.
    step : float, default 0.02
        Longest step along the branch, as a share of the range and of the sizes of the state.
    most_points : int, default 2000
        Most points to either side.
    progress : bool or callable, default False
        As in :func:`iva.sweep`; how many points there will be is not known, and told as 0.

    Returns
    -------
    Branch or Missed
        The branch, or why it was not followed: a branch is true, a `Missed` is false.

    Raises
    ------
    TypeError
        If an argument is of the wrong class.
    ValueError
        If the scene does not have the number, or the range is not one of it.
    KeyboardInterrupt
        On Ctrl-C before there is a second point. Later it ends the branch with what it has, within
        about a second, and `ends` say ``"cancelled"``.

    Examples
    --------
    >>> siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5)
    >>> primary = iva.Primary(damping_ratio=0.05)
    >>> force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    >>> first = iva.dynamics.orbit(siva, primary, force=force, start=(0, 0, 0, 0.1), settle=200)
    >>> found = follow(first, over="clearance", between=(3.0, 8.0))
    >>> [(point.kind, round(point.value, 6)) for point in found.points]
    [('pitchfork', 4.239825), ('neimark_sacker', 6.716345)]
    """
    if not isinstance(orbit, Orbit):
        raise TypeError(f"orbit = {shown(orbit)}: give an orbit that dynamics.orbit has found")
    made = Scene(orbit.absorber, orbit.primary, orbit.force, orbit.start, over)
    low, high = between
    steps = (float(step), whole("most_points", most_points, 1, MOST_POINTS))
    if not 0.0 < steps[0] <= 1.0:
        raise ValueError(f"step = {shown(step)}: give a number above 0, up to 1")
    given = ((float(low), float(high)), *steps)
    shape = (orbit.least_periods, orbit.symmetric)
    with reporting(progress) as report:
        found = _iva.follow(made.spec(), *shape, over, given, report)
    return branch(found, made, (float(low), float(high)), steps)


def complexes(pairs: list[tuple[float, float]]) -> tuple[complex, ...]:
    """Return multipliers that the compiled part describes."""
    return tuple(complex(*pair) for pair in pairs)


def row(made: dict[str, Any]) -> Row:
    """Return a point that the compiled part describes."""
    made["multipliers"] = complexes(made["multipliers"])
    made["unknowns"] = tuple(made["unknowns"])
    if math.isinf(made["grazing_margin"]):
        made["grazing_margin"] = None
    return Row(**made)


def branch(
    found: dict[str, Any],
    scene: Scene,
    between: tuple[float, float],
    steps: tuple[float, int],
) -> Branch | Missed:
    """Return a branch that the compiled part describes, or why there is none."""
    if "reason" in found:
        return Missed(**found)
    walls, sticks, symmetric, cycles = found["chain"]
    chain = (tuple(walls), tuple(sticks), symmetric, cycles)
    points = []
    for made in found["points"]:
        kind, index, wall = made.pop("condition")
        condition = (kind, index, wall)
        points.append(
            Point(kind=kind, row=row(made), scene=scene, chain=chain, condition=condition)
        )
    return Branch(
        scene=scene,
        between=between,
        chain=chain,
        rows=tuple(row(made) for made in found["rows"]),
        points=tuple(points),
        ends=tuple(found["ends"]),
        sequence=found["sequence"],
        steps=steps,
    )


def orbit_at(scene: Scene, chain: Chain, row: Row) -> Orbit | Missed:
    """Return the orbit at a point of a branch."""
    found = _iva.orbit_at(scene.spec(), chain, scene.over, row.value, row.unknowns)
    there = scene.at(row.value)
    parts = (there.absorber, there.primary, there.force)
    return orbit_of(found, parts, chain[3], scene.start)
