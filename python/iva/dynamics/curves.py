"""Curves of special points of branches over two numbers of a scene."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from iva import _iva
from iva.dynamics.branches import MOST_POINTS, Point, complexes
from iva.dynamics.changed_scenes import Scene
from iva.dynamics.orbits import Missed
from iva.dynamics.search import whole
from iva.parameters import numbers, shown
from iva.progress import Progress, reporting
from iva.spelling import spell_checked

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    import polars as pl


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Curve:
    """A curve of special points over two numbers; it is true.

    Parameters
    ----------
    kind : str
        The kind of the points, see `Point`.
    scene : Scene
        The scene of the branch that the first point is on.
    over : tuple of str, length 2
        The two numbers.
    values : tuple of (float, float)
        The numbers of each point, in order along the curve.
    multipliers : tuple of tuple of complex
        The multipliers of the orbit at each point.
    ends : tuple of str, length 2
        Why it ends on either side, as of `Branch`; at a grazing or a vanishing impact another
        impact than that of the curve would begin or vanish. A curve of Neimark–Sacker points ends
        at a ``resonance``, where its pair of multipliers becomes real.
    missed : tuple of float
        The wanted values of the first number that it has no point at: it does not come by, or
        Newton's method finds none there.
    """

    kind: str
    scene: Scene
    over: tuple[str, str]
    values: tuple[tuple[float, float], ...]
    multipliers: tuple[tuple[complex, ...], ...]
    ends: tuple[str, str]
    missed: tuple[float, ...]

    @property
    def table(self) -> pl.DataFrame:
        """Its points as a frame: the two numbers, by their names, and the largest multiplier."""
        import polars as pl

        columns = {name: [pair[k] for pair in self.values] for k, name in enumerate(self.over)}
        sizes = [max(abs(one) for one in four) for four in self.multipliers]
        return pl.DataFrame({**columns, "largest_multiplier": sizes})

    def __repr__(self) -> str:
        """Show the kind, the numbers and the ranges that they go through."""
        spans = [
            f"{name} from {min(column):.6g} to {max(column):.6g}"
            for name, column in zip(self.over, zip(*self.values, strict=True), strict=True)
        ]
        ends = ", ".join(self.ends)
        count = f"{len(self.values)} points"
        line = f"Curve: {self.kind}, {count}, {' and '.join(spans)}; ends: {ends}"
        if not self.missed:
            return line
        missed = ", ".join(f"{value:g}" for value in self.missed)
        return f"{line}\n  no point at {self.over[0]} = {missed}"


@spell_checked
def curve(
    point: Point,
    *,
    over: tuple[str, str],
    between: tuple[tuple[float, float], tuple[float, float]],
    at: Iterable[float] = (),
    step: float = 0.05,
    most_points: int = 2000,
    progress: bool | Progress = False,
) -> Curve | Missed:
    """Follow a special point of a branch over two numbers of its scene.

    Parameters
    ----------
    point : Point
        The point to begin with, of :func:`follow`.
    over : tuple of str, length 2
        The two numbers; one of them is that of the branch.
    between : tuple of (float, float), length 2
        Their ranges.
    at : iterable of float, optional
        Values of the first number at which points are wanted, wherever the curve comes by; those at
        which it has none are told in `missed`.
    step : float, default 0.05
        Longest step, as a share of the ranges and of the sizes of the state.
    most_points : int, default 2000
        Most points to either side.
    progress : bool or callable, default False
        As in :func:`follow`.

    Returns
    -------
    Curve or Missed
        The curve, or why there is none: a curve is true, a `Missed` is false.

    Raises
    ------
    TypeError
        If an argument is of the wrong class.
    ValueError
        If the scene does not have the numbers, neither is that of the branch, or a range is not one
        of them.
    KeyboardInterrupt
        On Ctrl-C before there is a second point. Later it ends the curve with what it has, within
        about a second, and `ends` say ``"cancelled"``.

    Examples
    --------
    >>> siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5)
    >>> primary = iva.Primary(damping_ratio=0.05)
    >>> force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    >>> first = iva.dynamics.orbit(siva, primary, force=force, start=(0, 0, 0, 0.1), settle=200)
    >>> branch = iva.dynamics.follow(first, over="clearance", between=(3.0, 8.0))
    >>> ranges = ((0.95, 1.05), (2.0, 8.0))
    >>> found = curve(branch.points[0], over=("force.frequency", "clearance"), between=ranges)
    >>> found.kind, found.ends
    ('pitchfork', ('range', 'range'))
    """
    if not isinstance(point, Point):
        raise TypeError(f"point = {shown(point)}: give one of the points of dynamics.follow")
    one, other = over
    ranges = tuple((float(low), float(high)) for low, high in between)
    if point.scene.over not in over or len(ranges) != 2:
        rule = f"give two numbers, one of them {point.scene.over}, and their ranges"
        raise ValueError(f"over = {shown(over)}: {rule}")
    values = tuple(
        point.value if name == point.scene.over else point.scene.given(name) for name in over
    )
    steps = (numbers("at", at), float(step), whole("most_points", most_points, 1, MOST_POINTS))
    given = (point.chain, point.condition, point.value, point.row.unknowns)
    made = point.scene.spec()
    ways = ((values[0], values[1]), (ranges[0], ranges[1]))
    with reporting(progress) as report:
        found = _iva.curve(made, given, (one, other), ways, steps, report)
    if "reason" in found:
        return Missed(**found)
    low, high = found["ends"]
    return Curve(
        kind=point.kind,
        scene=point.scene,
        over=(one, other),
        values=tuple((first, second) for first, second in found["values"]),
        multipliers=tuple(complexes(four) for four in found["multipliers"]),
        ends=(low, high),
        missed=tuple(found["missed"]),
    )
