"""What a run is made of: primary system, absorber, start.

Names, ranges and meanings stand in one table of the compiled part; the classes here only carry
the values. Every value is a float after construction, or a tuple of pairs of floats for a table,
``None`` where nothing was given.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, fields
from numbers import Real

from iva import _iva
from iva.spelling import spell_checked

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Any, Literal

    # What the compiled part takes: "part.field" to number or word, "forces" to a list of dicts.
    Spec = dict[str, Any]


def shown(value: object) -> str:
    """Return a value for a message: its expression on one line, at most 60 characters of it.

    Examples
    --------
    >>> shown("0.1"), shown(10**5000)
    ("'0.1'", 'a whole number of about 5000 digits')
    """
    if isinstance(value, int) and value.bit_length() > 200:
        return f"a whole number of about {int(value.bit_length() * math.log10(2))} digits"
    try:
        text = " ".join(repr(value).split())
    except Exception:  # of somebody else's class: anything may be raised
        text = f"an object of class {type(value).__name__}"
    return text if len(text) <= 60 else f"{text[:60]}…"


def number(field: str, value: object) -> float:
    """Return a number given for `field` as a float.

    Parameters
    ----------
    field : str
        Name for the message, for example ``"absorber.restitution"``.
    value : real number
        A Python or NumPy number; booleans, text and spans of time are refused.

    Returns
    -------
    float

    Raises
    ------
    TypeError
        If the value is not a real number.
    ValueError
        If it is too large for a float.
    """
    # NumPy counts a timedelta64 among its integers.
    kind = getattr(getattr(value, "dtype", None), "kind", "f")
    if isinstance(value, bool) or not isinstance(value, Real) or kind not in "iuf":
        raise TypeError(f"{field} = {shown(value)}: give a number, not {type(value).__name__}")
    try:
        return float(value)
    except OverflowError:
        raise ValueError(f"{field} = {shown(value)}: give a finite number") from None


def numbers(field: str, values: object) -> list[float]:
    """Return a one-dimensional sequence of numbers given for `field` as a list of floats.

    Parameters
    ----------
    field : str
        Name for the message.
    values : iterable of real numbers
        A list, tuple, range, NumPy array of shape (n,), polars series, …

    Returns
    -------
    list of float

    Raises
    ------
    TypeError
        If `values` has no order or is not a sequence of numbers.
    ValueError
        If a number is too large for a float.
    """
    if not isinstance(values, Iterable) or isinstance(values, (str, bytes, Mapping, Set)):
        raise TypeError(f"{field} = {shown(values)}: give a one-dimensional sequence of numbers")
    if getattr(values, "ndim", 1) != 1:
        shape = getattr(values, "shape", "unknown")
        raise TypeError(f"{field} has shape {shape}: give a one-dimensional sequence of numbers")
    return [number(f"{field}[{index}]", value) for index, value in enumerate(values)]


def pairs(field: str, values: object) -> tuple[tuple[float, float], ...]:
    """Return the points of a table given for `field` as pairs of floats.

    Parameters
    ----------
    field : str
        Name for the message.
    values : iterable of pairs of real numbers
        Lists or tuples, or a NumPy array of shape (n, 2).

    Returns
    -------
    tuple of (float, float)

    Raises
    ------
    TypeError
        If `values` has no order or is not a sequence of pairs of numbers.
    ValueError
        If a number is too large for a float.

    Examples
    --------
    >>> pairs("absorber.restitution_table", [[0.1, 1], [1, 0.6]])
    ((0.1, 1.0), (1.0, 0.6))
    """
    # A frame gives its columns one after the other, which two rows could not be told from.
    strange = isinstance(values, (str, bytes, Mapping, Set)) or hasattr(values, "columns")
    if strange or not isinstance(values, Iterable):
        rule = "give a list of pairs [approach speed, restitution]"
        raise TypeError(f"{field} = {shown(values)}: {rule}")
    made: list[tuple[float, float]] = []
    for place, pair in enumerate(values):
        path = f"{field}[{place}]"
        found = None if not is_list(pair) else numbers(path, pair)
        if found is None or len(found) != 2:
            rule = "give a pair [approach speed, restitution]"
            raise TypeError(f"{path} = {shown(pair)}: {rule}")
        made.append((found[0], found[1]))
    return tuple(made)


def percentage(field: str, given: str) -> float:
    """Return a percentage given for `field` as a number.

    Raises
    ------
    ValueError
        If it is none, or not greater than 0 and below 100.

    Examples
    --------
    >>> percentage("within['gap']", "20%")
    0.2
    """
    text = given.strip()
    try:
        share = float(text.removesuffix("%")) / 100 if text.endswith("%") else math.nan
    except ValueError:
        share = math.nan
    if not 0 < share < 1:
        raise ValueError(f"{field} = {shown(given)}: give a percentage below 100, such as '5%'")
    return share


class Part:
    """What the three parts of a scene have in common."""

    __slots__ = ()
    # Of the study file; without annotations, so that they are no fields.
    _part = ""
    _words: tuple[str, ...] = ()
    # Fields that may be lists, with a number for each of several absorbers or units.
    _of_each: tuple[str, ...] = ()
    # Fields that are tables, each of points that are pairs of numbers.
    _tables: tuple[str, ...] = ()
    # Fields with a number for each mode of a structure, to whose entries they belong.
    _of_modes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Turn every value into a float; check ranges, and that no two set the same quantity."""
        for name in self._words:
            if not isinstance(value := getattr(self, name), str):
                raise TypeError(f"{self._part}.{name} = {shown(value)}: give a word")
        for name, path in numeric(type(self)):
            value = getattr(self, name)
            if value is None:
                continue
            if name in self._tables:
                object.__setattr__(self, name, pairs(path, value))
            elif name in self._of_modes or (name in self._of_each and is_list(value)):
                object.__setattr__(self, name, tuple(numbers(path, value)))
            else:
                object.__setattr__(self, name, number(path, value))
        checked(self)
        if self._words:
            _iva.check_choices(choices(self))  # type: ignore[arg-type]

    def __repr__(self) -> str:
        """Show what was given, as an expression that gives it again."""
        return constructor(self)


def is_list(value: object) -> bool:
    """Return whether a value is given as several numbers."""
    return isinstance(value, Iterable) and not isinstance(value, (str, bytes, Real))


def checked(part: Part) -> None:
    """Check the ranges of a part's fields, and that no two set the same quantity.

    Raises
    ------
    ValueError
        If a value is out of range, a list is empty, or two fields set the same quantity.
    """
    fields_given = given(part)
    tables = [fields_given.pop(name) for name in part._tables if name in fields_given]
    for name in part._of_modes:
        fields_given.pop(name, None)
    for name, values in fields_given.items():
        if isinstance(values, tuple):
            if not values:
                rule = "give a number, or a list with one for each absorber or unit"
                raise ValueError(f"{part._part}.{name} = []: {rule}")
            for place, value in enumerate(values):
                try:
                    _iva.check(part._part, [(name, value)])
                except ValueError as error:
                    path = f"{part._part}.{name}"
                    raise ValueError(str(error).replace(path, f"{path}[{place}]", 1)) from None
    first = (value[0] if isinstance(value, tuple) else value for value in fields_given.values())
    values_given = list(zip(fields_given, first, strict=True))
    _iva.check(part._part, values_given)
    for table in tables:
        _iva.check_restitution_table(table, values_given)


def given(part: Part) -> dict[str, Any]:
    """Return the fields of a part that were given, by name: numbers, or tuples of them or pairs."""
    values = ((name, getattr(part, name)) for name, _ in numeric(type(part)))
    return {name: value for name, value in values if value is not None}


def numeric(kind: type[Part]) -> tuple[tuple[str, str], ...]:
    """Return name and path ``"part.name"`` of every field of a kind of part that holds numbers."""
    if kind not in NUMERIC:
        names = (field.name for field in fields(kind) if field.name not in kind._words)  # type: ignore[arg-type]
        NUMERIC[kind] = tuple((name, f"{kind._part}.{name}") for name in names)
    return NUMERIC[kind]


#: What :func:`numeric` returns, by kind; to look through the fields takes longer than a short run.
NUMERIC: dict[type[Part], tuple[tuple[str, str], ...]] = {}


def constructor(part: Part) -> str:
    """Return the expression that builds the part."""
    defaults = {field.name: field.default for field in fields(part)}  # type: ignore[arg-type]
    words = ((name, getattr(part, name)) for name in part._words)
    chosen = {name: word for name, word in words if word != defaults[name]}
    shown_fields = (given(part) | chosen).items()
    arguments = ", ".join(f"{name}={value!r}" for name, value in shown_fields)
    return f"{type(part).__name__}({arguments})"


@spell_checked
@dataclass(frozen=True, kw_only=True, slots=True, repr=False)
class Primary(Part):
    """The damped linear oscillator that is to be quietened.

    What is given decides the units of everything else:

    * ``mass`` with ``stiffness`` (or a frequency): SI, that is kg, N/m, N s/m, m, s, J.
    * only ``natural_frequency`` or ``frequency_hz``: time in s, lengths in the unit of the start
      displacement, energies per unit primary mass.
    * neither: ωn = 1, time in 1/ωn, lengths and energies as above.

    Parameters
    ----------
    damping_ratio : float, optional
        Damping ratio ζ ≥ 0 of the bare primary system; 0 if no damping is given.
    damping : float, optional
        Viscous damping constant c ≥ 0 in N s/m, instead of `damping_ratio`; needs a mass.
    natural_frequency : float, optional
        ωn > 0 of the bare primary system in rad/s.
    frequency_hz : float, optional
        The same in Hz.
    stiffness : float, optional
        Spring stiffness k > 0 in N/m, instead of a frequency; needs a mass.
    mass : float, optional
        Mass M > 0 in kg.

    Raises
    ------
    TypeError
        If a value is not a number.
    ValueError
        If a value is out of range, or two set the same quantity.

    Examples
    --------
    >>> Primary(mass=2.0, stiffness=800.0, damping=0.8).mass
    2.0
    """

    _part = "primary"

    damping_ratio: float | None = None
    damping: float | None = None
    natural_frequency: float | None = None
    frequency_hz: float | None = None
    stiffness: float | None = None
    mass: float | None = None

    def __repr__(self) -> str:
        """Show what was given, the units that follow from it, and the frequency in rad/s and Hz."""
        try:
            units = _iva.primary_units(spec(self))
        except ValueError:  # a frequency is still missing
            return constructor(self)
        from iva.scene_lines import in_both, natural_frequency

        frequency = natural_frequency(self)
        told = units if frequency is None else f"{units}; {in_both(frequency)}"
        return f"{constructor(self)}  # {told}"


@spell_checked
@dataclass(frozen=True, kw_only=True, slots=True, repr=False)
class Siva(Part):
    """Single-mass impact vibration absorber: a free mass in a gap of the primary system.

    The line of motion is level unless `inclination` says otherwise. Where it rises, gravity acts
    along it, displacements are measured from where the structure rests with the absorber on its
    lower stop, y = −d, and there the absorber starts unless `Start` says otherwise.

    Parameters
    ----------
    mass_ratio : float, optional
        Absorber mass over primary mass, μ = m/M > 0. This or `mass` is needed.
    mass : float, optional
        Absorber mass m > 0 in kg; needs a primary mass.
    restitution : float
        Newton's coefficient e on the gap velocity, from 0 (plastic) to 1 (elastic).
    restitution_minus : float, optional
        The same at the wall y = −d, if it is another there.
    reference_speed : float, optional
        Makes the restitution a power law of the approach speed u, 1 − a u^b and at least 0: this is
        the u > 0 at which it is `restitution`.
    restitution_exponent : float, optional
        b of a power law, a quotient of whole numbers from 1 to 8 that is at most 1; 0.2 by default,
        as of viscoelastic spheres.
    yield_speed : float, optional
        Makes the restitution that of elastic and perfectly plastic spheres: 1 up to this approach
        speed > 0, and falling from there on. It stands in the place of `restitution`.
    restitution_table : array_like, shape (n, 2), optional
        The restitution as measured, in the place of `restitution`: 1 to 16 pairs of approach speed
        (in m/s in SI units, else as `reference_speed`) and restitution from 0 to 1, with speeds ≥ 0
        that rise. It is linear between them, constant outside, and the same at both walls. Kept as
        a tuple of pairs.
    relative_clearance : float, optional
        γ > 0, clearance over the size of the start displacement. One of the five ways to give the
        clearance is needed.
    clearance : float, optional
        One-sided clearance d > 0, half of the total play, in the unit of lengths.
    clearance_mm : float, optional
        The same in mm; SI units only.
    gap : float, optional
        Total play 2d > 0, in the unit of lengths.
    gap_mm : float, optional
        The same in mm; SI units only.
    gap_offset : float, optional
        Gap displacement of the middle of the gap, 0 by default: the stops are at this ± d. With the
        start at y = 0 it says how far from the middle the mass starts.
    gap_offset_mm : float, optional
        The same in mm; SI units only.
    contact_time : float, optional
        How long an impact lasts. It turns each impulse into an estimate of the largest force, that
        of a half sine: ``peak_force_estimate``. The motion does not depend on it.
    contact_stiffness : float, optional
        Stiffness of a stop in N/m, from which that time is estimated; SI units only.
    units : float, optional
        Number of equal units that share the mass, 1 to 64, each in a gap of its own; 1 by default.
        Tables number them in their column ``absorber``.
    clearance_spread : float, optional
        How far the clearances of the units spread, evenly, from 0 (all alike, the default) to below
        1: from 1 − this to 1 + this times the clearance. Units in gaps all alike that start alike
        move as one.
    friction : float, optional
        Coefficient k ≥ 0 of Coulomb friction between the mass and its way, 0 by default: its slides
        are decelerated by k g cos α, and it is held where that is enough.
    static_friction : float, optional
        Coefficient of friction of a mass at rest, k at least (the default): it is held where that
        times g cos α is enough, and slides off with a jump of its acceleration.
    spring : float, optional
        Stiffness k ≥ 0 in N/m of a linear spring between the mass and the structure, slack at y = 0
        wherever the stops are; 0, no spring, by default; of all units together. With it the mass is
        a tuned mass damper with end stops.
    spring_ratio : float, optional
        The same as the frequency √(k/m) of the mass on its spring alone over that of the bare
        structure.
    gap_damping : float, optional
        Constant c ≥ 0 in N s/m of a linear dashpot between the mass and the structure, 0 by
        default; of all units together.
    gap_damping_ratio : float, optional
        The same as c/(2 M ωn), the damping ratio that it would give the structure beside a mass at
        rest.
    inclination : float, optional
        Angle in rad by which the line of motion rises, from 0 (level, the default) to π/2
        (upright).
    inclination_deg : float, optional
        The same in degrees, from 0 to 90.
    gravity : float, optional
        Acceleration of gravity g > 0, of a motion that rises or of a mass that rubs; 9.80665 m/s²
        by default in SI units, needed in others. Nothing else depends on it: it is refused without
        inclination and friction.
    walls : {"both", "plus", "minus"}, optional
        ``"plus"`` for the wall at y = `gap_offset` + d alone, ``"minus"`` for that at
        `gap_offset` − d alone: on the other side nothing limits the way of the mass.

    Raises
    ------
    TypeError
        If a value is not a number.
    ValueError
        If a value is out of range, or two set the same quantity.

    Examples
    --------
    >>> Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5)
    Siva(mass_ratio=0.15, restitution=0.5, relative_clearance=0.6)

    With the restitution measured at three approach speeds:

    >>> Siva(mass_ratio=0.15, gap=1.2, restitution_table=[[0.1, 0.9], [0.5, 0.7], [2, 0.6]])
    Siva(mass_ratio=0.15, restitution_table=((0.1, 0.9), (0.5, 0.7), (2.0, 0.6)), gap=1.2)
    """

    _part = "absorber"
    _kind = "siva"
    _words = ("walls",)
    _tables = ("restitution_table",)

    mass_ratio: float | None = None
    mass: float | None = None
    restitution: float | None = None
    restitution_minus: float | None = None
    reference_speed: float | None = None
    restitution_exponent: float | None = None
    yield_speed: float | None = None
    # An array, which is no Sequence, or any other pairs.
    restitution_table: Any = None
    relative_clearance: float | None = None
    clearance: float | None = None
    clearance_mm: float | None = None
    gap: float | None = None
    gap_mm: float | None = None
    gap_offset: float | None = None
    gap_offset_mm: float | None = None
    contact_time: float | None = None
    contact_stiffness: float | None = None
    units: float | None = None
    clearance_spread: float | None = None
    friction: float | None = None
    static_friction: float | None = None
    gap_damping: float | None = None
    gap_damping_ratio: float | None = None
    spring: float | None = None
    inclination: float | None = None
    inclination_deg: float | None = None
    gravity: float | None = None
    spring_ratio: float | None = None
    # Any, so that all other fields may come from a dict of numbers in a typed program.
    walls: Any = "both"


@spell_checked
@dataclass(frozen=True, kw_only=True, slots=True, repr=False)
class Stop(Part):
    """A stop on the ground, between whose walls a point of the structure moves.

    It has no mass: the ground, or the base where that moves, takes what impulse it needs. The gap
    displacement is that of the point itself, u, and its walls are met at u = ±d (or `gap_offset`
    ± d). A point that is pressed on a wall stays there at rest until it is pulled off. Alone or in
    a list, beside absorbers, on a primary system or at any point of a :class:`Structure`. With one
    of the `walls` it is the stop of the impact oscillator.

    Parameters
    ----------
    restitution : float
        Newton's coefficient e on the velocity of the point, from 0 (plastic) to 1 (elastic).
    restitution_minus : float, optional
        The same at the wall u = −d, if it is another there.
    reference_speed, restitution_exponent, yield_speed, restitution_table : optional
        Laws by which the restitution depends on the approach speed, as of :class:`Siva`.
    relative_clearance : float, optional
        γ > 0, clearance over the size of the start displacement. One of the five ways to give the
        clearance is needed.
    clearance : float, optional
        One-sided clearance d > 0, half of the way from wall to wall, in the unit of lengths.
    clearance_mm : float, optional
        The same in mm; SI units only.
    gap : float, optional
        2d > 0, in the unit of lengths.
    gap_mm : float, optional
        The same in mm; SI units only.
    gap_offset : float, optional
        Displacement of the middle between the walls, 0 by default: they are at this ± d.
    gap_offset_mm : float, optional
        The same in mm; SI units only.
    contact_time : float, optional
        How long an impact lasts, for an estimate of the largest force: ``peak_force_estimate``. The
        motion does not depend on it.
    walls : {"both", "plus", "minus"}, optional
        ``"plus"`` for the wall at u = `gap_offset` + d alone, ``"minus"`` for that at
        `gap_offset` − d alone.

    Raises
    ------
    TypeError
        If a value is not a number.
    ValueError
        If a value is out of range, or two set the same quantity.

    Examples
    --------
    The impact oscillator with a stop at 1.5:

    >>> Stop(clearance=1.5, restitution=0.8, walls="plus")
    Stop(restitution=0.8, clearance=1.5, walls='plus')
    """

    _part = "absorber"
    _kind = "stop"
    _words = ("walls",)
    _tables = ("restitution_table",)

    restitution: float | None = None
    restitution_minus: float | None = None
    reference_speed: float | None = None
    restitution_exponent: float | None = None
    yield_speed: float | None = None
    # An array, which is no Sequence, or any other pairs.
    restitution_table: Any = None
    relative_clearance: float | None = None
    clearance: float | None = None
    clearance_mm: float | None = None
    gap: float | None = None
    gap_mm: float | None = None
    gap_offset: float | None = None
    gap_offset_mm: float | None = None
    contact_time: float | None = None
    # Any, so that all other fields may come from a dict of numbers in a typed program.
    walls: Any = "both"


@spell_checked
@dataclass(frozen=True, kw_only=True, slots=True, repr=False)
class Piva(Part):
    """Pendulum impact vibration absorber: a pendulum on the primary system, between two stops.

    The gap displacement is y = b sin θ with b from the pivot to the point that meets the stops, at
    y = ±d (or `gap_offset` ± d). Of `frequency_ratio`, `length` and `gravity` two are needed, for
    g = κ L ωp²; in SI units `length` alone will do, with standard gravity.

    Parameters
    ----------
    mass_ratio : float, optional
        Absorber mass over primary mass, μ = m/M > 0. This or `mass` is needed.
    mass : float, optional
        Absorber mass m > 0 in kg; needs a primary mass.
    restitution : float
        Newton's coefficient e on the gap velocity, from 0 (plastic) to 1 (elastic).
    restitution_minus : float, optional
        The same at the wall y = −d, if it is another there.
    reference_speed : float, optional
        Makes the restitution a power law of the approach speed u, 1 − a u^b and at least 0: this is
        the u > 0 at which it is `restitution`.
    restitution_exponent : float, optional
        b of a power law, a quotient of whole numbers from 1 to 8 that is at most 1; 0.2 by default,
        as of viscoelastic spheres.
    yield_speed : float, optional
        Makes the restitution that of elastic and perfectly plastic spheres: 1 up to this approach
        speed > 0, and falling from there on. It stands in the place of `restitution`.
    restitution_table : array_like, shape (n, 2), optional
        The restitution as measured, in the place of `restitution`: 1 to 16 pairs of approach speed
        (in m/s in SI units, else as `reference_speed`) and restitution from 0 to 1, with speeds ≥ 0
        that rise. It is linear between them, constant outside, and the same at both walls. Kept as
        a tuple of pairs.
    relative_clearance : float, optional
        γ > 0, clearance over the size of the start displacement. One of the five ways to give the
        clearance is needed.
    clearance : float, optional
        One-sided clearance d > 0, half of the total play, in the unit of lengths. A clearance not
        below the contact distance is out of reach: the run says so in ``stop_reachable``.
    clearance_mm : float, optional
        The same in mm; SI units only.
    gap : float, optional
        Total play 2d > 0, in the unit of lengths.
    gap_mm : float, optional
        The same in mm; SI units only.
    gap_offset : float, optional
        Gap displacement of the middle of the gap, 0 by default: the stops are at this ± d. With the
        start at y = 0 it says how far from the middle the pendulum hangs at rest.
    gap_offset_mm : float, optional
        The same in mm; SI units only.
    contact_time : float, optional
        How long an impact lasts. It turns each impulse into an estimate of the largest force, that
        of a half sine: ``peak_force_estimate``. The motion does not depend on it.
    contact_stiffness : float, optional
        Stiffness of a stop in N/m, from which that time is estimated; SI units only.
    units : float, optional
        Number of equal units that share the mass, 1 to 64, each between stops of its own; 1 by
        default. Tables number them in their column ``absorber``.
    clearance_spread : float, optional
        How far the clearances of the units spread, evenly, from 0 (all alike, the default) to below
        1: from 1 − this to 1 + this times the clearance. Units in gaps all alike that start alike
        move as one.
    frequency_ratio : float, optional
        r = ωp/ωn > 0, frequency of the hanging pendulum over that of the bare primary system.
    length : float, optional
        L > 0 from the pivot to the centre of mass, in the unit of lengths. Needed unless angles are
        small, where the motion of a point bob does not depend on it (no angle is reported then).
    friction : float, optional
        T/(m g L) ≥ 0 of a moment T of Coulomb friction in the pivot, 0 by default: the sine of the
        largest angle at which it holds the pendulum at rest under gravity alone.
    static_friction : float, optional
        The same at rest, `friction` at least (the default).
    inclination : float, optional
        Angle in rad by which the line rises on which structure and pivot move, towards the + wall,
        from 0 (level, the default) to π/2 (upright). The pendulum hangs down all the same, and the
        motion of the structure then changes the stiffness that gravity gives it. Displacements
        are measured from where the structure rests under the weight of the pendulum.
    inclination_deg : float, optional
        The same in degrees, from 0 to 90.
    gravity : float, optional
        Acceleration of gravity g > 0. Follows from `frequency_ratio` and `length`; in SI units
        9.80665 m/s² if `frequency_ratio` is not given. All three must agree to 1e-9.
    inertia_ratio : float, optional
        κ = I/(m L²) ≥ 1, I the moment of inertia about the pivot; 1, a point bob, by default.
    contact_distance : float, optional
        b > 0 from the pivot to the point of contact; the length by default.
    pivot_damping_ratio : float, optional
        Damping ratio ≥ 0 of the hanging pendulum; 0 by default.
    spring_ratio : float, optional
        σ = ωs/ωn ≥ 0 of a torsional spring in the pivot, of moment −k θ: ωs² = k/I is the frequency
        of the pendulum on that spring alone. 0, no spring, by default. Its stops must be in reach.
    angles : {"large", "small"}, default "large"
        Exact, or linearised (sin θ = θ, cos θ = 1).
    impact_law : {"consistent", "printed"}, default "consistent"
        Momentum and restitution, or the paper's Eqs. 16 and 17 as printed, for comparison only:
        they do not conserve momentum, their rebounds shrink by 2μe/(1+μ), and ``energy_loss`` may
        be negative.
    walls : {"both", "plus", "minus"}, optional
        Both stops, or that at the upper (+) or lower end of the gap only. On the other side the
        pendulum swings freely, up to the horizontal: a run in which it gets there ends as
        ``not_finite``.

    Raises
    ------
    TypeError
        If a value is not a number, or a choice not a word.
    ValueError
        If a value is out of range, or two set the same quantity.

    Examples
    --------
    >>> Piva(mass_ratio=0.12, restitution=0.5, clearance=1.4, frequency_ratio=0.4, length=10)
    Piva(mass_ratio=0.12, restitution=0.5, clearance=1.4, frequency_ratio=0.4, length=10.0)
    """

    _part = "absorber"
    _kind = "piva"
    _words = ("angles", "impact_law", "walls")
    _tables = ("restitution_table",)

    mass_ratio: float | None = None
    mass: float | None = None
    restitution: float | None = None
    restitution_minus: float | None = None
    reference_speed: float | None = None
    restitution_exponent: float | None = None
    yield_speed: float | None = None
    # An array, which is no Sequence, or any other pairs.
    restitution_table: Any = None
    relative_clearance: float | None = None
    clearance: float | None = None
    clearance_mm: float | None = None
    gap: float | None = None
    gap_mm: float | None = None
    gap_offset: float | None = None
    gap_offset_mm: float | None = None
    contact_time: float | None = None
    contact_stiffness: float | None = None
    units: float | None = None
    clearance_spread: float | None = None
    frequency_ratio: float | None = None
    length: float | None = None
    friction: float | None = None
    static_friction: float | None = None
    inclination: float | None = None
    inclination_deg: float | None = None
    gravity: float | None = None
    inertia_ratio: float | None = None
    contact_distance: float | None = None
    pivot_damping_ratio: float | None = None
    spring_ratio: float | None = None
    angles: Literal["large", "small"] = "large"
    impact_law: Literal["consistent", "printed"] = "consistent"
    walls: Any = "both"


#: An absorber of any kind, or a stop on the ground.
Absorber = Siva | Piva | Stop
#: One absorber or several.
Absorbers = Absorber | Sequence[Absorber]


def choices(absorber: Absorber | None) -> list[tuple[str, str]]:
    """Return the kind of an absorber, or that there is none, and what was chosen by words."""
    if absorber is None:
        return [("kind", "none")]
    words = [(name, getattr(absorber, name)) for name in absorber._words]
    # Both walls need no word.
    return [("kind", absorber._kind), *(one for one in words if one != ("walls", "both"))]


@spell_checked
@dataclass(frozen=True, kw_only=True, slots=True, repr=False)
class Start(Part):
    """The state at the begin of a run; what is not given is 0.

    :meth:`Run.state_at` gives that of another run, to go on from. Each absorber, and each of its
    units, has its own place and velocity in its gap: a number is that of all, a list has one for
    each absorber, or one for each unit of the first absorber, then of the second, and so on.

    Parameters
    ----------
    displacement : float, optional
        Displacement of the primary system, in the unit of lengths.
    displacement_mm : float, optional
        The same in mm; SI units only.
    velocity : float, optional
        Velocity of the primary system.
    impulse : float, optional
        A shock: impulse on the primary system at time zero, in N s, which needs a mass. A free mass
        stays at rest, where `velocity` would carry it along. With several modes it acts at the
        point of the force. Settling is relative to the first peak where the displacement is 0.
    impulse_velocity : float, optional
        The same as impulse over primary mass, a velocity.
    gap_displacement : float or sequence of float, optional
        Absorber displacement minus primary displacement, at most the clearance in size. By default
        0, and where the line of motion rises the lower stop.
    gap_velocity : float or sequence of float, optional
        Absorber velocity minus primary velocity.
    angle : float or sequence of float, optional
        Angle of a pendulum from hanging in rad, −π to π, instead of `gap_displacement`.
    angular_velocity : float or sequence of float, optional
        Angular velocity of a pendulum, instead of `gap_velocity`.
    time : float, optional
        Instant at which the run begins, 0 or later: forces, base and records are where they stand
        then, and all instants of the results are on the same clock. Impulses up to then are over;
        in a run from time zero those of time zero act.
    reference : float, optional
        Displacement that the `relative_clearance` of the absorber is a multiple of; by default
        `displacement`.
    displacements, velocities : sequence of float, shape (n,), optional
        Of all modes of a :class:`Structure`, or of the coordinates of its matrices, in the place of
        its `start_displacements` and `start_velocities`.

    Raises
    ------
    TypeError
        If a value is not a number.
    ValueError
        If a value is out of range, or two set the same quantity.

    Examples
    --------
    >>> Start(displacement=1)
    Start(displacement=1.0)

    A shock on a structure at rest:

    >>> Start(impulse=0.8)
    Start(impulse=0.8)
    """

    _part = "start"
    _of_each = ("gap_displacement", "gap_velocity", "angle", "angular_velocity")
    _of_modes = ("displacements", "velocities")

    displacement: float | None = None
    displacement_mm: float | None = None
    velocity: float | None = None
    impulse: float | None = None
    impulse_velocity: float | None = None
    gap_displacement: float | Sequence[float] | None = None
    gap_velocity: float | Sequence[float] | None = None
    angle: float | Sequence[float] | None = None
    angular_velocity: float | Sequence[float] | None = None
    time: float | None = None
    reference: float | None = None
    # Any: else a dict of numbers would be no arguments of a start.
    displacements: Any = None
    velocities: Any = None


def spec(
    *parts: Part | Sequence[Absorber] | None, run: Mapping[str, float | None] | None = None
) -> Spec:
    """Return all given fields of some parts and of the section ``run`` as ``"part.field"``.

    A table is the tuple of its pairs, a list of the start that of its numbers. A part that is
    ``None`` stands for no absorber. Fields of several absorbers have the number of theirs, as in
    ``"absorber.1.mass"``.
    """
    fields_given: Spec = {}
    for part in parts:
        if part is None or isinstance(part, Part):
            add(fields_given, part, "")
        elif len(part) == 1:
            add(fields_given, part[0], "")
        else:
            for place, absorber in enumerate(part):
                add(fields_given, absorber, f"{place}.")
    for name, value in (run or {}).items():
        if value is not None:
            fields_given[f"run.{name}"] = number(f"run.{name}", value)
    return fields_given


def add(fields_given: Spec, part: Part | None, place: str) -> None:
    """Add the fields of a part to a spec, those of an absorber in a list with its place there."""
    if part is None or isinstance(part, Absorber):
        fields_given |= {f"absorber.{place}{name}": word for name, word in choices(part)}
    for name, value in ({} if part is None else given(part)).items():
        assert part is not None
        if name in part._of_modes:
            continue
        fields_given[f"{part._part}.{place}{name}"] = value
