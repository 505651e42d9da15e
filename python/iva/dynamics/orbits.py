"""A periodic orbit, and the outcome of a search that found none."""

from __future__ import annotations

from dataclasses import astuple, dataclass, field, fields, replace

from iva import _iva
from iva.forces import Drive, Force, Harmonic, listed
from iva.parameters import Primary, Start, spec
from iva.scene_lines import scene_lines
from iva.scenes import absorbers
from iva.structures import Structure

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Any, Literal

    import polars as pl

    from iva.parameters import Absorbers
    from iva.simulation import Run

#: A primary system in the units of a structure with several modes.
IN_SI = Primary(mass=1.0, stiffness=1.0)
#: So many of the marks of walls are shown in a line.
MOST_WALLS = 24
#: Displacement and velocity of the primary system, gap displacement and gap velocity of each
#: absorber.
State = tuple[float, ...]
#: Multipliers, as many as the numbers of a state.
Multipliers = tuple[complex, ...]


@dataclass(frozen=True, slots=True)
class Impact:
    """One impact of a periodic orbit, in the units of the primary system.

    Parameters
    ----------
    time : float
        Instant of the impact, on the clock of the force.
    wall : int
        +1 (y = +d) or −1 (y = −d).
    displacement : float
        Displacement of the primary system.
    velocity_before, velocity_after : float
        Its velocity just before and just after.
    absorber_velocity_before, absorber_velocity_after : float
        Absolute velocity of the absorber's centre of mass just before and just after.
    approach_velocity : float
        Signed gap velocity just before.
    energy_loss : float
        Energy lost in the impact.
    absorber : int
        The number of its absorber or unit, from 0, in the order of the list.
    """

    time: float
    wall: int
    displacement: float
    velocity_before: float
    velocity_after: float
    absorber_velocity_before: float
    absorber_velocity_after: float
    approach_velocity: float
    energy_loss: float
    absorber: int = 0


@dataclass(frozen=True, slots=True)
class Episode:
    """One stick episode of a periodic orbit, in the units of the primary system.

    Parameters
    ----------
    wall : int
        +1 (y = +d) or −1 (y = −d).
    start_time : float
        Its first impact, after which only this wall is met until the stick; it may lie in the cycle
        before.
    stick_time : float
        End of the chatter, begin of the ride on the wall.
    release_time : float or None
        End of the ride.
    impacts : int
        Number of its listed impacts.
    energy_loss : float
        Energy lost in all its impacts, listed or summed.
    absorber : int
        The number of its absorber or unit, from 0, in the order of the list.
    """

    wall: int
    start_time: float
    stick_time: float
    release_time: float | None
    impacts: int
    energy_loss: float
    absorber: int = 0


@dataclass(frozen=True, slots=True)
class Course:
    """One cycle of an orbit: its state at the phase of the start, and the events from there on."""

    state: State
    start: Start
    impacts: tuple[Impact, ...]
    episodes: tuple[Episode, ...]
    walls: str


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Orbit:
    """A periodic orbit of a driven absorber, in the units of the primary system; it is true.

    Parameters
    ----------
    absorber, primary, force
        The scene.
    periods : int
        Number n of periods 2π/Ω of the force after which it was asked to repeat.
    least_periods : int
        Number of periods after which it does: a divisor of `periods`.
    period : float
        Time of `periods` periods of the force: the length of its cycle.
    state : tuple of float, length 4 or more
        Displacement and velocity of the primary system, gap displacement and gap velocity at the
        instant of `start`; of several absorbers or units the latter two of each.
    start : Start
        State from which a run stays on the orbit, at the phase of the force of the start that the
        orbit was sought from. The run drifts away in time from an orbit that is not stable.
    impacts : tuple of Impact
        The listed impacts of the cycle from that instant on, in order of time.
    episodes : tuple of Episode
        Its stick episodes, in order of the begin of their ride.
    walls : str
        The walls in order of time: ``+`` or ``-`` for an impact, ``(+)`` or ``(-)`` for a stick
        episode with all its impacts; of several absorbers or units each with its number before
        it, as in ``0+1+0-1-``.
    walls_of_start : str
        The same of the run from the start of the search, over one cycle. Where the two differ,
        the search has changed the sequence of impacts.
    symmetric : bool
        It is its own mirror image half a cycle later.
    multipliers : tuple of complex, length 4 or more
        Floquet multipliers: what a small change of the state is multiplied by in a cycle; largest
        first. There are two of each mode and each absorber. With a ride on a wall two are exactly
        0.
    multiplier_errors : tuple of float, of the same length
        Bounds on their absolute errors.
    half_multipliers : tuple of complex, of the same length, or None
        Of a symmetric orbit those of half a cycle, seen in the mirror; `multipliers` are their
        squares.
    half_multiplier_errors : tuple of float, of the same length, or None
        Bounds on the absolute errors of these.
    rank : int
        Largest rank that the derivative over a cycle can have: as many as there are multipliers,
        2 less for each absorber that rides on a wall at one instant, 1 less for another with a
        plastic impact then.
    stable : bool
        All multipliers are smaller than 1 in size.
    residual : float
        Largest difference between a coordinate and its image after a cycle, over the size of the
        state; some 2⁻⁵³ times the largest entry of the derivative in doubles, below 1e-18 with
        ``verify=True``.
    state_error : float or None
        Largest error of a coordinate of the orbit that doubles gave, over the size of the state,
        with ``verify=True``; `state` and the events are without it.
    determinant_error : float or None
        Product of the multipliers minus its exact value: e² for each impact, and what the dampers
        take. ``None`` with a ride on a wall, and for the printed impact law of a pendulum.
    amplitude : float
        Largest |x|.
    grazing_margin : float or None
        Smallest distance to a wall of an extremum of the gap displacement between impacts, the
        chatters of stick episodes and where the absorber leaves a wall from rest apart; ``None``
        where there is no extremum.
    approach_speed_min : float or None
        Smallest approach speed of its impacts; ``None`` with a stick episode, whose impacts become
        ever lower.
    approach_speed_max : float
        Largest approach speed.

    Notes
    -----
    Multipliers: exact derivative of the flow, saltation matrix at each impact (P. C. Müller, Chaos,
    Solitons & Fractals 5 (1995) 1671–1681), projection at a stick and at a release. Errors: to
    first order, by condition number and rounding.

    Examples
    --------
    >>> siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5)
    >>> primary = iva.Primary(damping_ratio=0.05)
    >>> force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    >>> found = iva.dynamics.orbit(siva, primary, force=force, start=(0, 0, 0, 0.1), settle=200)
    >>> [(round(impact.time, 4), impact.wall) for impact in found.impacts]
    [(3.0055, 1), (6.1471, -1)]
    """

    # Any: an absorber or a list, a primary or a structure, as they were given.
    absorber: Any
    primary: Any
    force: Drive
    periods: int
    least_periods: int
    period: float
    state: State
    start: Start
    impacts: tuple[Impact, ...]
    episodes: tuple[Episode, ...]
    walls: str
    walls_of_start: str
    symmetric: bool
    multipliers: Multipliers
    multiplier_errors: tuple[float, ...]
    half_multipliers: Multipliers | None
    half_multiplier_errors: tuple[float, ...] | None
    rank: int
    stable: bool
    residual: float
    state_error: float | None
    determinant_error: float | None
    amplitude: float | None
    grazing_margin: float | None
    approach_speed_min: float | None
    approach_speed_max: float
    #: The mirror image of the course.
    image: Course | None = field(repr=False)

    @property
    def table(self) -> pl.DataFrame:
        """Its impacts as a frame, one row an impact, columns as the fields of `Impact`."""
        import polars as pl

        whole = ("wall", "absorber")
        schema = {one.name: pl.Int64 if one.name in whole else pl.Float64 for one in fields(Impact)}
        return pl.DataFrame([astuple(impact) for impact in self.impacts], schema, orient="row")

    def mirror(self) -> Orbit:
        """Return the mirrored orbit: minus this motion, half a period of the force later.

        Gap displacements are mirrored about the middle of the gap.

        Of an odd number of periods it is minus the motion half a cycle later, which is one of the
        same orbits. Its state and start are at the same phase of the force as those of this orbit.
        A symmetric orbit is its own mirror image.

        Raises
        ------
        ValueError
            If the mirror image of a motion is no motion: the walls are unlike, or the line of
            motion is not level.
        """
        if self.image is None:
            raise ValueError("mirror: walls that are not alike, or a slope, have no mirror image")
        there = {one.name: getattr(self.image, one.name) for one in fields(Course)}
        here = Course(**{name: getattr(self, name) for name in there})
        return replace(self, **there, image=here)

    def run(self, cycles: float | None = None, **settings: Any) -> Run:
        """Simulate the scene from the start of the orbit.

        Parameters
        ----------
        cycles : float, optional
            Length in periods of the force, of several of the first; by default until the orbit
            repeats.
        **settings
            Further arguments of :func:`iva.simulate`, such as `tables` and `verify`.

        Returns
        -------
        Run

        Raises
        ------
        TypeError, ValueError
            As :func:`iva.simulate`.
        """
        from iva.simulation import simulate

        # Of several forces a cycle of a run is that of the first.
        if cycles is not None or isinstance(self.force, Harmonic):
            settings["cycles"] = self.periods if cycles is None else cycles
        else:
            settings["duration"] = self.period
        return simulate(self.absorber, self.primary, start=self.start, force=self.force, **settings)

    def __repr__(self) -> str:
        """Show what it is like, its multipliers, the scene and the units."""
        kind = "stable" if self.stable else "unstable"
        shape = "symmetric" if self.symmetric else "asymmetric"
        walls = self.walls if len(self.walls) <= MOST_WALLS else f"{self.walls[:MOST_WALLS]}…"
        count = f"{len(self.impacts)} impacts {walls}"
        span = "a period" if self.periods == 1 else f"{self.periods} periods"
        if self.least_periods < self.periods:
            span += f" ({self.least_periods} repeated)"
        sizes = [("amplitude", self.amplitude), ("grazing margin", self.grazing_margin)]
        known = [f"{name} {value:.4g}" for name, value in sizes if value is not None]
        lines = [f"Orbit: {kind}, {shape}, {count} in {span}"]
        lines.append(f"  multipliers {', '.join(rounded(one) for one in self.multipliers)}")
        lines += [f"  {', '.join(known)}"] if known else []
        lines += scene_told(self.absorber, self.primary, *listed(self.force), self.start)
        return "\n".join(lines)


def scene_told(
    absorber: Absorbers, primary: Primary | Structure, *others: Force | Start
) -> list[str]:
    """Return the lines of a scene, and one of its units, as results print them."""
    lines = [*scene_lines(*absorbers(absorber), primary, *others)]
    lines.append(_iva.primary_units(spec(in_units_of(primary))))
    return [f"  {line}" for line in lines]


def in_units_of(primary: Primary | Structure) -> Primary:
    """Return a primary system whose units are those of a scene."""
    return IN_SI if isinstance(primary, Structure) else primary


def rounded(value: complex) -> str:
    """Return a complex number with four digits, a real one without its imaginary part."""
    return f"{value.real:.4g}" if value.imag == 0.0 else f"{value:.4g}"


@dataclass(frozen=True, slots=True)
class Missed:
    """The outcome of a search that found no orbit; it is false.

    Parameters
    ----------
    reason : str
        ``no_impacts`` (fewer than two in three cycles, of an absorber that may stand anywhere in
        its gap): start with a gap velocity.
        ``singular``: ask for ``symmetric=True``, or move off the bifurcation.
        ``stalled``: settle longer, try more `periods`, or see :func:`attractors` and
        :func:`regimes`; a motion that is not periodic has no orbit.
        ``not_periodic``: the point found is no orbit; settle longer.
        ``no_stick``: a stick begins there, which no run can show.
        ``lost``: no branch begins at this kind of point, or the equations of the orbit with its
        sequence of impacts were not solved.
        ``invalid``: the scene is out of range there.
        ``impact_limit``, ``work_limit``, ``not_finite``: the outcome of a run that did not end.
    message : str
        The same as a sentence.
    """

    reason: str
    message: str

    def __bool__(self) -> Literal[False]:
        """Return False."""
        return False
