"""A warning where a length was given in metres that was meant in millimetres."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Any

    from iva.parameters import Spec

#: Fields that say how wide the gap is, and how far the structure is displaced, in m or in mm.
GAP = ("clearance", "gap", "clearance_mm", "gap_mm")
START = ("displacement", "displacement_mm")
#: From how many times the other a length is a slip: with a start of 4 mm, 2 m for 2 mm.
LEAST = 500.0
#: And up to how many times: a gap that is wider still is one without stops, on purpose.
MOST = 1e5
#: The least length in m that can be such a slip: fewer tenths of a millimetre are seldom given.
SHORTEST = 0.1


@dataclass(frozen=True, slots=True)
class Length:
    """A length of a scene as it was given: part and field, value, and whether an axis has it."""

    part: str
    field: str
    value: float
    is_swept: bool = False

    @property
    def is_metric(self) -> bool:
        """Whether it is in metres, not in millimetres."""
        return not self.field.endswith("_mm")

    @property
    def metres(self) -> float:
        """Its size in metres."""
        return abs(self.value) if self.is_metric else abs(self.value) / 1000.0

    def __str__(self) -> str:
        """Show field, value and unit."""
        value = f"{self.value:g} {'m' if self.is_metric else 'mm'}"
        if self.is_swept:
            return f"sweep.{self.field} = {value} (the middle of the axis)"
        return f"{self.part}.{self.field} = {value}"


def warn_of_metres(spec: Spec, points: tuple[Any, ...] | None = None) -> None:
    """Warn if gap and start of a scene in SI units differ as metres and millimetres do.

    For public functions that are `spell_checked`: the warning points to the line that calls them.

    Parameters
    ----------
    spec : dict
        The scene.
    points : tuple, optional
        What is swept, as :func:`iva.sampling.points_of` returns it.
    """
    axes = {} if points is None else {key: axis for key, *axis in points[1]}
    # Lengths are in metres where a mass is given. A start that goes on from another run, which
    # has a reference, is as small as that run left it.
    metric = "structure" in spec or "primary.mass" in spec or "primary.mass" in axes
    if not metric or "start.reference" in spec:
        return
    gap = length("absorber", GAP, spec, axes)
    start = length("start", START, spec, axes)
    if gap is None or start is None:
        return
    small, large = sorted((gap, start), key=lambda one: one.metres)
    if not large.is_metric or large.metres < SHORTEST or small.metres == 0.0:
        return
    times = large.metres / small.metres
    if LEAST <= times <= MOST:
        import warnings

        given = "a structure" if "structure" in spec else "the primary mass"
        warnings.warn(
            f"{large} is {times:.0f} times {small}: lengths are in metres where {given} is "
            f"given; where millimetres are meant, give {large.field}_mm",
            stacklevel=4,
        )


def length(
    part: str, names: Sequence[str], spec: Spec, axes: Mapping[str, Sequence[Any]]
) -> Length | None:
    """Return the length that one of some fields of a part gives; an axis replaces all of them."""
    for key, axis in axes.items():
        name = key.removeprefix(f"{part}.")
        if name in names:
            return Length(part, name, middle(*axis), is_swept=True)
    if part == "absorber" and {"relative_clearance", "absorber.relative_clearance"} & axes.keys():
        return None
    for name in names:
        if (value := spec.get(f"{part}.{name}")) is not None:
            return Length(part, name, value)
    return None


def middle(values: Any, numbers: Mapping[str, float] | None = None) -> float:
    """Return the median of an axis, or the middle of a distribution of which the name is given.

    An axis from very small to very large values is meant so, and has one between in its middle.

    Examples
    --------
    >>> middle([0.1, 1.0, 10.0]), middle("normal", {"mean": 3.0, "deviation": 0.1})
    (1.0, 3.0)
    """
    if numbers is None:
        ordered: list[float] = sorted(values, key=abs)
        return ordered[len(ordered) // 2]
    if values == "uniform":
        return (numbers["low"] + numbers["high"]) / 2.0
    return numbers["mean"] if values == "normal" else numbers["median"]
