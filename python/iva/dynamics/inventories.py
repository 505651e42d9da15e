"""The attractors of a scene: what many starts end in, and how often."""

from __future__ import annotations

import math
from dataclasses import dataclass

from iva import _iva
from iva.doubts import warn_of_doubts
from iva.dynamics.diagrams import MOST_CYCLES
from iva.dynamics.orbits import Orbit, scene_told
from iva.dynamics.search import MOST_PERIODS, NAMES, alone_or_all, orbit_of, whole
from iva.dynamics.starts import MOST_SEED, MOST_STARTS, Range, box_of, boxed, names_of
from iva.forces import Drive, Harmonic, listed, single
from iva.parameters import Absorbers, Primary, Start
from iva.progress import reporting
from iva.scenes import scene
from iva.spelling import spell_checked
from iva.structures import Structure

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import Any

    import polars as pl

    from iva.progress import Progress

#: Outcome of a start that Ctrl-C has cut.
CANCELLED = "cancelled"


@dataclass(frozen=True, slots=True, kw_only=True)
class Attractor:
    """A stable periodic orbit that starts end in.

    Parameters
    ----------
    orbit : Orbit
        The orbit, at the phase of the force at time zero.
    count : int
        Number of starts that end in it, or in its mirror image if that is another orbit.
    share : float
        The same over the number of all starts.
    standard_error : float
        Binomial standard error of the share. It is 0 for a share of 0 or 1, where 3/n of n starts
        bounds what was missed at 95 %.
    pair : bool
        True if its mirror image is another orbit, which is counted with it.
    """

    orbit: Orbit
    count: int
    share: float
    standard_error: float
    pair: bool

    @property
    def name(self) -> str:
        """Impacts and periods of the force until it repeats, such as ``3:1``."""
        return f"{len(self.orbit.impacts)}:{self.orbit.periods}"


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Attractors:
    """What the starts of a scene end in.

    Parameters
    ----------
    absorber : Siva, Piva, Stop, or a list of them
        The absorber.
    primary : Primary or Structure
        The primary system.
    force : Harmonic
        The force.
    attractors : tuple of Attractor
        The periodic ones, in the order of the starts that found them.
    no_impacts : int
        Number of starts that end in a motion without impacts.
    aperiodic : int
        Number of starts that end in none of these: a torus, chaos, a modulated response, a longer
        period than was sought, a transient that is not over, or an orbit that is left out.
    aperiodic_start : Start or None
        The first of these starts.
    unfinished : tuple of str
        Outcomes of runs that did not end: ``impact_limit``, ``work_limit`` or ``not_finite``.
    left_out : tuple of str
        Why an orbit that starts end in is not among the attractors, each in a sentence.
    starts : int
        Number of starts that were run to their end, which all shares are of.
    cancelled : int
        Number of other starts, which Ctrl-C has cut. Those that come to their orbit soon are
        finished first, so that the shares of a call that was cut lean towards their orbits.
    box : tuple of pairs of float, length 4 or more
        The box that they fill: displacement, velocity, gap displacement and gap velocity, of
        several absorbers or units the latter two of each.

    Examples
    --------
    >>> siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=3.4)
    >>> primary = iva.Primary(damping_ratio=0.05)
    >>> force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    >>> found = iva.dynamics.attractors(siva, primary, force=force, starts=40)
    >>> [attractor.orbit.walls for attractor in found.attractors]
    ['++-']
    """

    # Any: an absorber or a list, a primary or a structure, as they were given.
    absorber: Any
    primary: Any
    force: Drive
    attractors: tuple[Attractor, ...]
    no_impacts: int
    aperiodic: int
    aperiodic_start: Start | None
    unfinished: tuple[str, ...]
    left_out: tuple[str, ...]
    starts: int
    cancelled: int
    box: tuple[Range, ...]

    @property
    def shares(self) -> dict[str, float]:
        """Share of the starts that end in each kind.

        A periodic attractor goes by its name, such as ``3:1`` (of several with one name the later
        ones with a number, ``3:1 #2``); the others are ``no_impacts``, ``aperiodic`` and
        ``unfinished``. What no start ends in is left out.
        """
        return {name: count / self.starts for name, count in self.counts().items()}

    def counts(self) -> dict[str, int]:
        """Return the number of starts that end in each kind, by the names of `shares`."""
        found: dict[str, int] = {}
        seen: dict[str, int] = {}
        for one in self.attractors:
            seen[one.name] = seen.get(one.name, 0) + 1
            again = f" #{seen[one.name]}" if seen[one.name] > 1 else ""
            found[one.name + again] = one.count
        found["no_impacts"] = self.no_impacts
        found["aperiodic"] = self.aperiodic
        found["unfinished"] = len(self.unfinished)
        return {name: count for name, count in found.items() if count > 0}

    @property
    def table(self) -> pl.DataFrame:
        """One row a kind that starts end in.

        Columns: name, impacts and periods (null if not periodic), pair, count, share,
        standard_error, amplitude, largest_multiplier (its size).
        """
        import polars as pl

        rows: list[tuple[object, ...]] = []
        for index, (name, count) in enumerate(self.counts().items()):
            share = (count, count / self.starts, binomial(count, self.starts))
            if index < len(self.attractors):
                one = self.attractors[index]
                orbit = one.orbit
                shape = (len(orbit.impacts), orbit.periods, one.pair)
                rows.append((name, *shape, *share, orbit.amplitude, abs(orbit.multipliers[0])))
            else:
                rows.append((name, None, None, None, *share, None, None))
        schema = {
            "name": pl.String,
            "impacts": pl.Int64,
            "periods": pl.Int64,
            "pair": pl.Boolean,
            "count": pl.Int64,
            "share": pl.Float64,
            "standard_error": pl.Float64,
            "amplitude": pl.Float64,
            "largest_multiplier": pl.Float64,
        }
        return pl.DataFrame(rows, schema, orient="row")

    def __repr__(self) -> str:
        """Show shares and the scene."""
        lines = [f"Attractors: of {self.starts} starts"]
        pairs = [one.pair for one in self.attractors]
        for index, (name, count) in enumerate(self.counts().items()):
            mirrored = " and its mirror image" if index < len(pairs) and pairs[index] else ""
            error = binomial(count, self.starts)
            lines.append(f"  {count / self.starts:.3f} ± {error:.3f} in {name}{mirrored}")
        if self.cancelled:
            lines.append(f"  cancelled: {self.cancelled} more starts are not finished")
        lines += [f"  left out: {reason}" for reason in self.left_out]
        ranges = (
            f"{name} {low:.4g} to {high:.4g}"
            for name, (low, high) in zip(names_of(len(self.box)), self.box, strict=True)
        )
        lines.append(f"  starts in {', '.join(ranges)}")
        lines += scene_told(self.absorber, self.primary, *listed(self.force))
        return "\n".join(lines)


@spell_checked
def attractors(
    absorber: Absorbers,
    primary: Primary | Structure,
    *,
    force: Harmonic | Sequence[Harmonic],
    starts: int = 500,
    seed: int = 1,
    most_periods: int = 16,
    most_cycles: int = 3000,
    box: Mapping[str, Range | Sequence[Range]] | None = None,
    progress: bool | Progress = False,
) -> Attractors:
    """Find what the steady states of a scene are, and how likely each is, from many random starts.

    Parameters
    ----------
    absorber : Siva, Piva, Stop, or a list of them
        A free mass, a pendulum, or a stop on the ground; or several, as for :func:`orbit`.
    primary : Primary or Structure
        The primary system; what it is given decides the units.
    force : Harmonic
        A harmonic force, or motion of the base; or several whose frequencies are fractions of each
        other: a period is then the shortest after which all of them repeat.
    starts : int, default 500
        Number n of starts, drawn from the box evenly, all at time zero. An attractor with the share
        p is missed with the probability (1 − p)ⁿ.
    seed : int, default 1
        The seed of the starts, 0 to 2⁶⁴ − 1.
    most_periods : int, default 16
        Most periods of the force after which an orbit repeats, up to 1000.
    most_cycles : int, default 3000
        Most periods that are run from each start.
    box : mapping of str to pair of float, optional
        The box, as for :func:`lyapunov`.
    progress : bool or callable, default False
        As in :func:`iva.sweep`; a point is a start.

    Returns
    -------
    Attractors

    Raises
    ------
    TypeError
        If an argument is of the wrong class.
    ValueError
        If a value is missing or out of range, a start lies outside the gap, or the force is not one
        harmonic force.
    KeyboardInterrupt
        On Ctrl-C before a start is finished. Later it returns what the finished ones end in.

    Notes
    -----
    A run is on a periodic orbit where its strobes repeat and Newton's method finds a stable one
    there. An orbit and its mirror image count as one.

    Examples
    --------
    >>> siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=3.4)
    >>> primary = iva.Primary(damping_ratio=0.05)
    >>> force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    >>> found = attractors(siva, primary, force=force, starts=40)
    >>> found.shares, found.attractors[0].pair
    ({'3:1': 1.0}, True)
    """
    absorber = alone_or_all(absorber)
    made = scene(absorber, primary, Start(), force, {}, several=True)
    warn_of_doubts(made)
    count = whole("starts", starts, 1, MOST_STARTS)
    given = (count, whole("seed", seed, 0, MOST_SEED), box_of(box, absorber), False)
    limits = (
        whole("most_periods", most_periods, 1, MOST_PERIODS),
        whole("most_cycles", most_cycles, 1, MOST_CYCLES),
    )
    with reporting(progress) as report:
        found = _iva.attractors(made, given, *limits, report)
    unfinished = [outcome for outcome in found["unfinished"] if outcome != CANCELLED]
    cancelled = len(found["unfinished"]) - len(unfinished)
    count -= cancelled
    one = single(force)
    rows = zip(found["orbits"], found["periods"], found["counts"], found["pairs"], strict=True)
    periodic = []
    for described, periods, hits, pair in rows:
        orbit = orbit_of(described, (absorber, primary, one), periods, Start())
        assert isinstance(orbit, Orbit)
        periodic.append(
            Attractor(
                orbit=orbit,
                count=hits,
                share=hits / count,
                standard_error=binomial(hits, count),
                pair=pair,
            )
        )
    first = found["aperiodic_start"]
    return Attractors(
        absorber=absorber,
        primary=primary,
        force=one,
        attractors=tuple(periodic),
        no_impacts=found["no_impacts"],
        aperiodic=found["aperiodic"],
        aperiodic_start=None if first is None else start_with(first),
        unfinished=tuple(unfinished),
        left_out=tuple(found["left_out"]),
        starts=count,
        cancelled=cancelled,
        box=boxed(found["box"]),
    )


def start_with(values: Sequence[float]) -> Start:
    """Return the start with these numbers of the structure and of each absorber."""
    if len(values) == len(NAMES):
        return Start(**dict(zip(NAMES, values, strict=True)))
    x, v, *gaps = values
    return Start(displacement=x, velocity=v, gap_displacement=gaps[::2], gap_velocity=gaps[1::2])


def binomial(count: int, of: int) -> float:
    """Return the standard error of a share.

    Examples
    --------
    >>> binomial(50, 100)
    0.05
    """
    share = count / of
    return math.sqrt(share * (1.0 - share) / of)
