"""Points of a sweep that is no grid: samples of distributions.

A sample is given to :func:`iva.sweep` as ``sampling=…``; ``over`` then maps field names to
distributions. The same points come from the command: the section ``[sampling]`` of a study.

Examples
--------
Half a thousand absorbers as a workshop may deliver them:

>>> table = iva.sweep(
...     iva.Siva(mass_ratio=0.1),
...     iva.Primary(damping_ratio=0.01),
...     over={
...         "relative_clearance": iva.sampling.Normal(0.8, 0.02),
...         "restitution": iva.sampling.Normal(0.6, 0.05, low=0.0, high=1.0),
...     },
...     sampling=iva.sampling.Sobol(512),
...     start=iva.Start(displacement=1.0),
...     periods=30,
... )
>>> table.summary["relative_clearance"].mean().__round__(3)
0.8
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

from iva import _iva
from iva.pandas_frames import from_pandas, is_of_pandas
from iva.parameters import number, numbers, shown
from iva.spelling import spell_checked

if TYPE_CHECKING:
    import polars as pl

    from iva.pandas_frames import PandasFrame

#: Largest seed: the whole numbers that a float holds.
MOST_SEED = 1 << 53


@spell_checked
@dataclass(frozen=True)
class Sample:
    """Points drawn from distributions.

    Parameters
    ----------
    count : int
        Number of points, 1 to 2³².
    seed : int, default 0
        Seed of all that is random in it, 0 to 2⁵³. The same seed gives the same points, always.

    Raises
    ------
    TypeError
        If a value is no whole number.
    ValueError
        If it is out of range.
    """

    _method: ClassVar[str] = ""

    count: int
    seed: int = 0

    def __post_init__(self) -> None:
        """Check the numbers."""
        whole("sampling.count", self.count, 1, 1 << 32)
        whole("sampling.seed", self.seed, 0, MOST_SEED)


@spell_checked
@dataclass(frozen=True)
class Sobol(Sample):
    """Sobol points: more even than random ones, also in their projections on few axes.

    The directions are those of Joe and Kuo (SIAM J. Sci. Comput. 30 (2008) 2635), for at most 37
    axes. Counts that are powers of two are the most even.

    Parameters
    ----------
    count : int
        As in :class:`Sample`.
    seed : int, default 0
        As in :class:`Sample`.
    scramble : bool, default True
        Scramble the digits after Owen, by the seed: points then are unbiased. Without it they are
        those of ``scipy.stats.qmc.Sobol(d, scramble=False)``, which begin with the lowest values.

    Examples
    --------
    >>> iva.sampling.Sobol(1024, seed=1)
    Sobol(count=1024, seed=1, scramble=True)
    """

    _method: ClassVar[str] = "sobol"

    scramble: bool = True


@spell_checked
@dataclass(frozen=True)
class LatinHypercube(Sample):
    """One point in each of `count` slices of equal probability of every axis.

    At most 10 million points.
    """

    _method: ClassVar[str] = "latin_hypercube"


@spell_checked
@dataclass(frozen=True)
class Random(Sample):
    """Independent points.

    The word of a point and axis is that of ``numpy.random.Philox`` with the key (seed, axis), the
    last of the 53 bits taken of it set.
    """

    _method: ClassVar[str] = "random"


class Distribution:
    """Distribution of a parameter."""

    _name: ClassVar[str] = ""

    def __post_init__(self) -> None:
        """Turn the numbers into floats."""
        for field in fields(self):  # type: ignore[arg-type]
            value = getattr(self, field.name)
            if value is not None:
                object.__setattr__(self, field.name, number(field.name, value))


@spell_checked
@dataclass(frozen=True)
class Uniform(Distribution):
    """Of equal density from `low` to `high`.

    Parameters
    ----------
    low : float
        Lower bound, in the unit of the parameter.
    high : float
        Upper bound.
    """

    _name: ClassVar[str] = "uniform"

    low: float
    high: float


@spell_checked
@dataclass(frozen=True)
class Normal(Distribution):
    """Normal, truncated where bounds are given.

    Truncated: nothing is drawn outside the bounds, and between them the density has the shape of
    the normal one, multiplied by a constant so that the whole has probability 1.

    Parameters
    ----------
    mean : float
        Mean before truncation, in the unit of the parameter.
    deviation : float
        Standard deviation before truncation, in the same unit.
    low : float, optional
        Lower bound.
    high : float, optional
        Upper bound.
    """

    _name: ClassVar[str] = "normal"

    mean: float
    deviation: float
    low: float | None = None
    high: float | None = None


@spell_checked
@dataclass(frozen=True)
class LogNormal(Distribution):
    """Its logarithm is normal; truncated where bounds are given, as :class:`Normal` is.

    Parameters
    ----------
    median : float
        Median before truncation, in the unit of the parameter.
    sigma : float
        Standard deviation of the logarithm: 0.1 is a scatter of some 10 %.
    low : float, optional
        Lower bound.
    high : float, optional
        Upper bound.
    """

    _name: ClassVar[str] = "lognormal"

    median: float
    sigma: float
    low: float | None = None
    high: float | None = None


Sampling: TypeAlias = Sample | str
Over: TypeAlias = "Mapping[str, Any] | pl.DataFrame | PandasFrame"


@spell_checked
def points(over: Over, sampling: Sampling = "grid") -> pl.DataFrame:
    """Return the points that a sweep would run.

    Parameters
    ----------
    over : mapping, polars.DataFrame or pandas.DataFrame
        As in :func:`iva.sweep`.
    sampling : str or Sample, default "grid"
        As in :func:`iva.sweep`.

    Returns
    -------
    polars.DataFrame
        A row a point, with the columns ``point`` and those of `over`.

    Raises
    ------
    TypeError, ValueError
        As :func:`iva.sweep`, for what shows before anything is run.

    Examples
    --------
    >>> iva.sampling.points(
    ...     {"restitution": iva.sampling.Uniform(0.4, 0.8)}, iva.sampling.Sobol(4, scramble=False)
    ... )["restitution"].to_list()
    [0.4, 0.6000000000000001, 0.7000000000000001, 0.5]
    """
    import polars as pl

    study = _iva.Study({"absorber.kind": "piva"}, points_of(over, sampling), ["summary"])
    columns = study.values(0, study.points)
    index = pl.Series("point", range(study.points), dtype=pl.UInt32)
    return pl.DataFrame([index, *(pl.Series(key, values) for key, values in columns)])


def points_of(over: Over, sampling: Sampling) -> tuple[Any, ...]:
    """Return the points as the compiled part takes them.

    Raises
    ------
    TypeError
        If something is of the wrong type.
    ValueError
        If there is no axis, or something does not go with the sampling.
    """
    check_sampling(sampling)
    if not isinstance(over, Mapping):
        return of_frame(over, sampling)
    for key in over:
        if not isinstance(key, str):
            raise TypeError(f"over has the key {shown(key)}: give field names")
    if not over:
        raise ValueError(
            "over = {}: give at least one axis, for example {'mass_ratio': [0.05, 0.1]}, or call "
            "iva.simulate for a single run"
        )
    if isinstance(sampling, Sample):
        variables = [variable(key, value) for key, value in over.items()]
        scramble = getattr(sampling, "scramble", True)
        return "sample", variables, sampling._method, sampling.count, sampling.seed, scramble
    for key, value in over.items():
        if isinstance(value, Distribution):
            raise ValueError(
                f"over[{key!r}] = {shown(value)}: a distribution needs a sample, for example "
                "sampling=iva.sampling.Sobol(1024)"
            )
    columns = [(key, numbers(f"sweep.{key}", values)) for key, values in over.items()]
    if sampling == "grid":
        return "grid", columns
    return "rows", columns, 0


def check_sampling(sampling: object) -> None:
    """Check that a sampling is a known word or a sample.

    Raises
    ------
    TypeError
        If it is of another class.
    ValueError
        If the word is unknown.
    """
    allowed = "give 'grid', 'zip' or a sample of iva.sampling"
    if isinstance(sampling, str):
        if sampling not in ("grid", "zip"):
            raise ValueError(f"sampling = {shown(sampling)}: {allowed}")
    elif not isinstance(sampling, Sample):
        # Frames of polars and pandas; a comparison with a word is one of every cell of them.
        if hasattr(type(sampling), "columns"):
            package = type(sampling).__module__.partition(".")[0]
            raise TypeError(
                f"sampling is a {type(sampling).__name__} of {package}: {allowed}; a frame of "
                "points goes to over"
            )
        raise TypeError(f"sampling = {shown(sampling)}: {allowed}")


def variable(key: str, value: object) -> tuple[str, str, dict[str, float]]:
    """Return key, distribution and its numbers."""
    if not isinstance(value, Distribution):
        raise TypeError(
            f"over[{key!r}] = {shown(value)}: with a sample give a distribution, for example "
            "iva.sampling.Uniform(0.4, 0.8)"
        )
    given = {field.name: getattr(value, field.name) for field in fields(value)}  # type: ignore[arg-type]
    return key, value._name, {name: it for name, it in given.items() if it is not None}


def of_frame(over: object, sampling: Sampling) -> tuple[Any, ...]:
    """Return the points of a frame of polars or pandas, each row one."""
    import polars as pl

    if is_of_pandas(over):
        over = from_pandas(over)
    if not isinstance(over, pl.DataFrame):
        raise TypeError(
            f"over = {shown(over)}: give a mapping from field names to values, or a frame of "
            "polars or pandas"
        )
    if isinstance(sampling, Sample):
        raise ValueError(f"sampling = {shown(sampling)}: a frame has its points, leave it out")
    if not over.width or not over.height:
        raise ValueError(f"over has the shape {over.shape}: a row is a point, a column a quantity")
    columns = []
    for series in over:
        if not series.dtype.is_numeric():
            raise TypeError(f"over has the column {series.name!r} of {series.dtype}: give numbers")
        if series.null_count():
            row = series.is_null().arg_true()[0]
            raise ValueError(f"over[{series.name!r}] has no number in row {row}")
        columns.append((series.name, series.cast(pl.Float64).to_list()))
    return "rows", columns, 0


def whole(field: str, value: object, least: int, most: int) -> None:
    """Check a whole number.

    Raises
    ------
    TypeError
        If it is none.
    ValueError
        If it is out of range.
    """
    rule = f"give a whole number from {least} to {most}"
    if not isinstance(value, int) or isinstance(value, bool):
        raise TypeError(f"{field} = {shown(value)}: {rule}")
    if not least <= value <= most:
        raise ValueError(f"{field} = {value}: {rule}")
