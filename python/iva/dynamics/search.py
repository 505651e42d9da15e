"""The search for a periodic orbit: from a start, a state, a run or a theory."""

from __future__ import annotations

from collections.abc import Iterable

from iva import _iva, theory
from iva.doubts import warn_of_doubts
from iva.dynamics.orbits import Course, Episode, Impact, Missed, Orbit
from iva.forces import Drive, Harmonic, listed, single
from iva.parameters import Absorbers, Primary, Start, Stop, numbers, shown
from iva.scenes import absorbers, scene
from iva.simulation import Run, state_of, truth
from iva.spelling import spell_checked
from iva.structures import Structure

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

#: Most periods of the force in a cycle of an orbit.
MOST_PERIODS = 1000
#: Most periods that are run before the search.
MOST_SETTLING = 10**9
#: A start without a reference.
REST = Start()
NAMES = ("displacement", "velocity", "gap_displacement", "gap_velocity")


@spell_checked
def orbit(
    absorber: Absorbers,
    primary: Primary | Structure,
    *,
    force: Harmonic | Sequence[Harmonic],
    start: Start | Run | theory.Orbit | Orbit | Iterable[float],
    periods: int = 1,
    symmetric: bool | None = None,
    settle: int = 0,
    verify: bool = False,
) -> Orbit | Missed:
    """Find the periodic orbit near a start, by Newton's method; stable or not.

    Parameters
    ----------
    absorber : Siva, Piva, Stop, or a list of them
        A free mass, a pendulum, or a stop on the ground; or up to four of them, or of their units,
        on up to four modes, among which masses with a spring or a dashpot and stops count as well.
    primary : Primary or Structure
        The primary system; what it is given decides the units.
    force : Harmonic
        A harmonic force, or motion of the base; or several whose frequencies are fractions of each
        other: a period is then the shortest after which all of them repeat.
    start : Start, Run, theory.Orbit, Orbit or sequence of float, shape (4,)
        Where the search begins: a start, the last state of a run, the start of an orbit, or, of one
        absorber on one mode, displacement and velocity of the primary system, gap displacement and
        gap velocity at time zero. The instant of the start sets the phase of the force at which
        `state` and `start` of the result are given.
    periods : int, default 1
        Number n of periods of the force after which the orbit repeats, up to 1000.
    symmetric : bool, optional
        True: an orbit that is its own mirror image half a cycle later, by the map over half a
        cycle, which stays regular at a pitchfork; then n is odd, the walls are alike, and the
        motion is level. False: any orbit, by the map over the whole cycle. By default a
        symmetric orbit is sought first where the start is nearly symmetric, otherwise any; and then
        the other, if none is found. The result says whether the orbit is symmetric.
    settle : int, default 0
        Number of periods of the force to run before the search.
    verify : bool, default False
        Solve the orbit again in numbers of twice the precision, and give states and events rounded
        from these, `residual` as it is before rounding, and the error of the orbit in doubles as
        `state_error`. It takes some 50 times as long. Multipliers are those in doubles, with their
        bounds.

    Returns
    -------
    Orbit or Missed
        The orbit, or why none was found: an orbit is true, a `Missed` is false.

    Raises
    ------
    TypeError
        If an argument is of the wrong class.
    ValueError
        If a value is missing or out of range, the start lies outside the gap, or the force is not
        one harmonic force.
    KeyboardInterrupt
        On Ctrl-C, within about a second.

    Notes
    -----
    The search moves the section of the map to the middle of the longest flight between two impacts.
    Without impacts there is no isolated orbit where an absorber may stand anywhere in its gap: of
    one on a spring, or a pendulum, there is. A free mass has none with impacts on one wall only.

    Examples
    --------
    >>> siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5)
    >>> primary = iva.Primary(damping_ratio=0.05)
    >>> force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    >>> found = orbit(siva, primary, force=force, start=(0, 0, 0, 0.1), settle=200)
    >>> found.walls, found.symmetric, found.stable
    ('+-', True, True)
    >>> round(abs(found.multipliers[0]), 6)
    0.722149
    """
    absorber = alone_or_all(absorber)
    begin = start_of(start, absorber)
    forces = listed(force)
    made = scene(absorber, primary, begin, forces, {}, several=True)
    warn_of_doubts(made)
    asked = (
        whole("periods", periods, 1, MOST_PERIODS),
        either("symmetric", symmetric),
        whole("settle", settle, 0, MOST_SETTLING),
        truth("verify", verify),
    )
    found = _iva.orbit(made, *asked)
    return orbit_of(found, (absorber, primary, single(force)), asked[0], begin)


def orbit_of(
    found: dict[str, Any],
    parts: tuple[Absorbers, Primary | Structure, Drive],
    periods: int,
    begin: Start,
) -> Orbit | Missed:
    """Return an orbit that the compiled part describes, or why there is none."""
    if "reason" in found:
        return Missed(**found)
    absorber, primary, force = parts
    reference = begin if given_relative(absorber) else None
    here = course(found.pop("course"), absorber, reference)
    image = found.pop("mirrored")
    for name in ("multipliers", "half_multipliers"):
        pairs = found[name]
        found[name] = None if pairs is None else tuple(complex(*pair) for pair in pairs)
    for name in ("multiplier_errors", "half_multiplier_errors"):
        found[name] = None if found[name] is None else tuple(found[name])
    return Orbit(
        absorber=absorber,
        primary=primary,
        force=force,
        periods=periods,
        state=here.state,
        start=here.start,
        impacts=here.impacts,
        episodes=here.episodes,
        walls=here.walls,
        image=None if image is None else course(image, absorber, reference),
        **found,
    )


def course(made: dict[str, Any], absorber: Absorbers, reference: Start | None) -> Course:
    """Return a cycle that the compiled part describes; `reference` is of a relative clearance."""
    rows, begin = made["states"], REST if reference is None else reference
    state = [rows[0][name] for name in NAMES[:2]]
    return Course(
        state=(*state, *(row[name] for row in rows for name in NAMES[2:])),
        start=state_of(rows, absorber, begin, made["modes"]),
        impacts=tuple(Impact(**fields) for fields in made["impacts"]),
        episodes=tuple(Episode(**fields) for fields in made["episodes"]),
        walls=made["walls"],
    )


def given_relative(absorber: Absorbers) -> bool:
    """Return whether a clearance is a multiple of a displacement."""
    return any(
        one is not None and one.relative_clearance is not None for one in absorbers(absorber)
    )


def start_of(start: object, absorber: object) -> Start:
    """Return the start that a search begins with; a stop has no gap of its own.

    Raises
    ------
    TypeError
        If it is nothing that has a start.
    ValueError
        If it is a sequence of another length than 4.
    """
    if isinstance(start, Start):
        return start
    if isinstance(start, (theory.Orbit, Orbit)):
        return start.start
    if isinstance(start, Run) and (several(start.absorber) or isinstance(start.primary, Structure)):
        return start.state_at(start.trajectory(1)["time"][-1])
    if isinstance(start, Run):
        row = start.trajectory(1).row(-1, named=True)
        return state_of([row], start.absorber, start.start)
    if isinstance(start, Iterable) and not isinstance(start, str):
        values = numbers("start", start)
        if several(absorber):
            rule = "of several absorbers or units give an iva.Start, a run or an orbit"
            raise ValueError(f"start: {rule}")
        if len(values) != len(NAMES):
            rule = f"give {', '.join(NAMES)}"
            raise ValueError(f"start has {len(values)} numbers: {rule}")
        given = dict(zip(NAMES, values, strict=True))
        kept = NAMES[:2] if isinstance(absorber, Stop) else NAMES
        return Start(**{name: given[name] for name in kept})
    rule = "give an iva.Start, four numbers, a run or an orbit"
    raise TypeError(f"start = {shown(start)}: {rule}")


def alone_or_all(absorber: Absorbers) -> Absorbers:
    """Return an absorber that is alone in its list, or the list."""
    alone = isinstance(absorber, (list, tuple)) and len(absorber) == 1
    return absorber[0] if alone else absorber  # type: ignore[index]


def several(absorber: object) -> bool:
    """Return whether there are several absorbers, or units."""
    return members(absorber) > 1


def members(absorber: object) -> int:
    """Return the number of absorbers and units."""
    each = absorber if isinstance(absorber, (list, tuple)) else [absorber]
    return sum(int(getattr(one, "units", None) or 1) for one in each)


def whole(field: str, value: object, least: int, most: int) -> int:
    """Return a whole number within a range.

    Raises
    ------
    TypeError
        If it is not a whole number.
    ValueError
        If it is out of range.
    """
    if isinstance(value, bool) or not hasattr(value, "__index__"):
        raise TypeError(f"{field} = {shown(value)}: give a whole number")
    count: int = value.__index__()
    if not least <= count <= most:
        raise ValueError(f"{field} = {shown(count)}: give a whole number from {least} to {most}")
    return count


def either(field: str, value: object) -> bool | None:
    """Return a truth value or ``None``.

    Raises
    ------
    TypeError
        If it is neither.
    """
    if value is not None and not isinstance(value, bool):
        raise TypeError(f"{field} = {shown(value)}: give True, False or None")
    return value
