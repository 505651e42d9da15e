"""What drives a scene: harmonic forces, impulses, records, and sums of them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from os import PathLike, fspath

from iva import _iva
from iva.parameters import Part, constructor, given, number, numbers, shown
from iva.spelling import spell_checked
from iva.structures import Structure

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Literal

    import numpy as np
    from numpy.typing import NDArray


@spell_checked
@dataclass(frozen=True, kw_only=True, slots=True, repr=False)
class Harmonic(Part):
    """A harmonic force on the primary system, or a harmonic motion of its base.

    The force over the primary mass is f(t)/M = amplitude · cos(Ωt + phase). A moving base is not
    the same as f/M = −a_g, for the free absorber feels it too; displacements are then relative
    to it.

    Parameters
    ----------
    amplitude : float, optional
        Amplitude of f/M, an acceleration. One of the amplitudes is needed.
    force : float, optional
        Amplitude of f in N; needs a primary mass.
    base_acceleration : float, optional
        Amplitude of the acceleration of the base.
    base_velocity : float, optional
        Amplitude V of the velocity of the base, V cos(Ωt + phase), in its place.
    base_displacement : float, optional
        Amplitude X of its displacement, X cos(Ωt + phase): a table that moves as told.
    base_displacement_mm : float, optional
        The same in mm; SI units only.
    frequency : float, optional
        Ω > 0 in rad/s (in ωn where no frequency is given). One of the three frequencies is needed.
    relative_frequency : float, optional
        Ω/ωn > 0, over the frequency of the bare primary system.
    frequency_hz : float, optional
        Ω/2π > 0 in Hz.
    phase : float, optional
        Phase of the cosine at time zero in rad, −4π to 4π; 0 by default.

    Raises
    ------
    TypeError
        If a value is not a number.
    ValueError
        If a value is out of range, or two set the same quantity.

    Examples
    --------
    >>> Harmonic(amplitude=0.1, relative_frequency=1.0)
    Harmonic(amplitude=0.1, relative_frequency=1.0)
    """

    _part = "force"

    amplitude: float | None = None
    force: float | None = None
    base_acceleration: float | None = None
    base_velocity: float | None = None
    base_displacement: float | None = None
    base_displacement_mm: float | None = None
    frequency: float | None = None
    relative_frequency: float | None = None
    frequency_hz: float | None = None
    phase: float | None = None


@spell_checked
@dataclass(frozen=True, kw_only=True, slots=True, repr=False)
class Impulse(Part):
    """An impulse on the primary system: it changes velocities and nothing else.

    The free primary gains P/M at once (with a pendulum on it less, for that resists); an absorber
    stuck to the wall that is pushed into it goes along, one pulled off is set free.

    Parameters
    ----------
    velocity : float, optional
        P/M, a velocity. This or `impulse` is needed.
    impulse : float, optional
        P in N s; needs a primary mass.
    time : float, optional
        Instant ≥ 0; 0 by default.

    Raises
    ------
    TypeError
        If a value is not a number.
    ValueError
        If a value is out of range, or two set the same quantity.

    Examples
    --------
    >>> Impulse(velocity=0.5, time=2)
    Impulse(velocity=0.5, time=2.0)
    """

    _part = "force"

    velocity: float | None = None
    impulse: float | None = None
    time: float | None = None


@spell_checked
class Recorded:
    """A recorded force or base motion: straight lines between points, 0 before and after them.

    The motion under each straight line is exact. A record that does not end at 0 jumps there.

    Parameters
    ----------
    times : sequence of float, shape (n,)
        Increasing instants, n ≥ 2, in the unit of time; time zero is the begin of the run.
    values : sequence of float, shape (n,)
        Values at these instants.
    kind : {"force", "force_newtons", "base_acceleration"}, default "force"
        What the values are: f/M, an acceleration; f in N, which needs a primary mass; the
        acceleration a_g of the base.
    scale : float, default 1
        Factor on the values.

    Raises
    ------
    TypeError
        If `times` or `values` is not a sequence of numbers.
    ValueError
        If times do not increase, a number is not finite, the two are of different length, or the
        kind is unknown; the message names the first offender.

    Examples
    --------
    >>> push = Recorded([0, 1, 2], [0, 0.3, 0])
    >>> push
    Recorded(3 points from 0 to 2, largest value 0.3, kind='force')
    >>> push.values
    array([0. , 0.3, 0. ])
    """

    __slots__ = ("_record", "scale")
    _record: _iva.Record
    scale: float

    def __init__(
        self,
        times: Iterable[float],
        values: Iterable[float],
        kind: Literal["force", "force_newtons", "base_acceleration"] = "force",
        *,
        scale: float = 1.0,
    ) -> None:
        if not isinstance(kind, str):
            raise TypeError(f"kind = {shown(kind)}: give a word")
        record = _iva.Record(numbers("times", times), numbers("values", values), kind)
        self._hold(record, scale)

    def _hold(self, record: _iva.Record, scale: float) -> None:
        object.__setattr__(self, "_record", record)
        object.__setattr__(self, "scale", number("scale", scale))
        _iva.check("force", [("scale", self.scale)])

    @classmethod
    @spell_checked
    def read(
        cls,
        path: str | PathLike[str],
        kind: Literal["force", "force_newtons", "base_acceleration"] | None = None,
        *,
        scale: float | None = None,
        column: str | int | None = None,
        time: str | int | None = None,
        unit: str | None = None,
        sampling_hz: float | None = None,
    ) -> Recorded:
        """Read a record from a file.

        Times and values are turned into SI units where the file or `unit` says what they are in;
        else they are in those of the scene.

        Parameters
        ----------
        path : path-like
            Text of two columns (time and value), ``dt = …`` and values, an accelerogram, or another
            file that :meth:`iva.Measured.read` takes. The page on the study file has a table.
        kind : {"force", "force_newtons", "base_acceleration"}, optional
            What the values are. By default ``"base_acceleration"`` of an accelerogram (AT2, CSMIP,
            COSMOS), ``"force_newtons"`` of values in N or kN, else ``"force"``.
        scale : float, optional
            Factor on the values, 1 by default. Of a ``.wav`` file it must be given: what full scale
            is in `unit`.
        column : str or int, optional
            The channel: its name with or without its unit, or its index from 0. It may be left out
            if only one does not hold the time, or in an accelerogram.
        time : str or int, optional
            The column of the time, by default the one that has a unit of time or is called time, or
            the first of two.
        unit : str, optional
            Unit of the values, such as ``"g"`` or ``"kN"``; ``"1"`` for that of the scene. It must
            be given if the file states none and accelerations may be in g or mm/s² by their size:
            those of the base, or in a column that is called so, of up to 2 or beyond 50.
        sampling_hz : float, optional
            Sampling rate in Hz of a file without times, which then begin at 0.

        Raises
        ------
        TypeError
            If an argument is of the wrong type.
        ValueError
            If something in the file cannot be used, a unit is missing, unknown or not that of the
            file, or the kind does not go with it; the message names the line where there is one.
        ImportError
            If the package is missing that reads the file.
        iva.IvaError
            If the file cannot be read.

        Examples
        --------
        >>> quake = iva.Recorded.read("studies/synthetic_quake.at2")  # doctest: +SKIP
        >>> quake  # doctest: +SKIP
        Recorded(1000 points from 0 to 19.98, largest value 2.942, kind='base_acceleration')
        """
        name = file_name(path)
        if kind is not None and not isinstance(kind, str):
            raise TypeError(f"kind = {shown(kind)}: give a word")
        from iva.measured.driving import record_of  # with NumPy, which a scene does not need

        record = cls.__new__(cls)
        points = record_of(
            name, kind, column=column, time=time, unit=unit, scale=scale, sampling_hz=sampling_hz
        )
        record._hold(points, 1.0 if scale is None else scale)
        return record

    def write(self, path: str | PathLike[str]) -> None:
        """Write it as text that a study reads: ``record = "shaker.csv"`` in a section of a force.

        The head states the units; values are written times `scale`, with all their digits.

        Parameters
        ----------
        path : path-like
            The file, such as ``"shaker.csv"``. One that exists is replaced.

        Raises
        ------
        TypeError
            If `path` is not the name of a file.
        ValueError
            If it is a folder, a pipe or a device, or in a folder that does not exist.
        iva.IvaError
            If it cannot be written.

        Examples
        --------
        >>> push = Recorded([0, 1, 2], [0, 0.3, 0])
        >>> push.write("shaker.csv")  # doctest: +SKIP
        """
        from iva.measured.record_texts import write_record  # with NumPy, as above

        write_record(path, self)

    @classmethod
    def _made(cls, record: _iva.Record, scale: float) -> Recorded:
        made = cls.__new__(cls)
        made._hold(record, scale)
        return made

    def __reduce__(self) -> tuple[object, ...]:
        """Say how to make it again."""
        return (Recorded._made, (self._record, self.scale))

    def __setattr__(self, name: str, value: object) -> None:
        """Refuse: forces are values."""
        raise AttributeError(f"cannot assign to {name!r}: make another iva.Recorded")

    @property
    def times(self) -> NDArray[np.float64]:
        """Instants, shape (n,)."""
        import numpy as np

        return np.array(self._record.times)

    @property
    def values(self) -> NDArray[np.float64]:
        """Values as given, without `scale`, shape (n,)."""
        import numpy as np

        return np.array(self._record.values)

    @property
    def kind(self) -> str:
        """What the values are."""
        return self._record.kind

    @property
    def is_metric(self) -> bool:
        """Whether the file stated that the values are accelerations in SI units."""
        return self._record.is_metric

    def __eq__(self, other: object) -> bool:
        """Compare all points, kind and factor."""
        if not isinstance(other, Recorded):
            return NotImplemented
        return self._record == other._record and self.scale == other.scale

    def __hash__(self) -> int:
        """Return a hash of kind and factor, which is enough for equal records to have the same."""
        return hash((self.kind, self.scale))

    def __repr__(self) -> str:
        """Show how many points there are, their extent and what they are."""
        times, values = self.times, self.values
        scale = "" if self.scale == 1.0 else f", scale={self.scale!r}"
        return (
            f"Recorded({len(times)} points from {times[0]:.6g} to {times[-1]:.6g}, "
            f"largest value {abs(values).max():.4g}, kind={self.kind!r}{scale})"
        )


def file_name(path: object) -> str:
    """Return the text of a path.

    Raises
    ------
    TypeError
        If it is none, or made of bytes.
    """
    name = fspath(path) if isinstance(path, (str, PathLike)) else None
    if not isinstance(name, str):
        raise TypeError(f"path = {shown(path)}: give the name of a file")
    return name


#: What drives a scene.
Force = Harmonic | Impulse | Recorded
#: What drives a steady motion: a harmonic force, or several.
Drive = Harmonic | tuple[Harmonic, ...]


def listed(force: object) -> tuple[Force, ...]:
    """Return the forces given as one, as several, or as ``None``.

    Raises
    ------
    TypeError
        If something is no force.
    """
    if force is None:
        return ()
    if isinstance(force, Force):
        return (force,)
    if not isinstance(force, (list, tuple)):
        raise TypeError(
            f"force = {shown(force)}: give an iva.Harmonic, iva.Impulse or iva.Recorded, or a list "
            "of them"
        )
    for index, one in enumerate(force):
        if not isinstance(one, Force):
            raise TypeError(
                f"force[{index}] = {shown(one)}: give an iva.Harmonic, iva.Impulse or iva.Recorded"
            )
    return tuple(force)


def fields_of(force: Force) -> dict[str, float | _iva.Record]:
    """Return the given fields of a force by name, those of a record with its points."""
    if isinstance(force, Recorded):
        return {"record": force._record, "scale": force.scale}
    # An impulse is one even if only a sweep says of what size.
    default = {"time": 0.0} if isinstance(force, Impulse) else {}
    return {**default, **given(force)}


def written(part: Part | Force | Structure | None) -> str:
    """Return the expression that builds a part, or what stands for a record or no absorber."""
    if part is None:
        return "no absorber"
    return repr(part) if isinstance(part, (Recorded, Structure)) else constructor(part)


def single(force: object) -> Drive:
    """Return the harmonic force of a scene that the compiled part has accepted, or several."""
    forces = tuple(one for one in listed(force) if isinstance(one, Harmonic))
    return forces[0] if len(forces) == 1 else forces
