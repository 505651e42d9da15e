"""Structures with several modes, which take the place of :class:`iva.Primary`.

What the entries mean stands in the compiled part, which checks them; the class here only carries
them. Study files have the same entries in their section ``[structure]``.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from operator import index
from os import PathLike

from iva import _iva
from iva.parameters import is_list, number, numbers, shown
from iva.spelling import hint, spell_checked

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Any

    import polars as pl

    Numbers = float | Iterable[float]
    Matrix = Iterable[Iterable[float]]

#: The entries by their form.
NUMBERS = (
    "frequencies",
    "frequencies_hz",
    "damping_ratios",
    "base",
    "start_displacements",
    "start_velocities",
)
MATRICES = ("mass", "stiffness", "damping")
NAMES = ("absorber_at", "force_at", "seen_at")
MODES = ("seen_mode", "natural_mode")


@spell_checked
@dataclass(frozen=True, kw_only=True, slots=True, repr=False)
class Structure:
    """A structure with several modes, in SI units, in the place of :class:`iva.Primary`.

    Either its modes are given (frequencies, damping ratios, shapes) or its matrices of mass,
    stiffness and damping. Absorbers ride at points of it: free masses on a level line of motion,
    with their `mass` in kg.

    Runs see the structure at one point, `seen_at`; measures, envelopes and trajectories tell its
    motion there, or with `seen_mode` the part of one mode in it. Periods, settling times and
    `relative_frequency` go by the first mode, or by `natural_mode`. ``start.displacement`` and
    ``start.velocity`` are what the point seen does in that mode.

    Parameters
    ----------
    frequencies : sequence of float, shape (n,), optional
        Natural frequencies of the modes in rad/s; 0 of a motion that nothing holds. That of the
        natural mode is > 0.
    frequencies_hz : sequence of float, shape (n,), optional
        The same in Hz.
    damping_ratios : float or sequence of float, shape (n,), optional
        Damping ratios of the modes; 0 by default.
    mass, stiffness, damping : array_like, shape (n, n), optional
        Symmetric matrices in kg, N/m and N s/m (or with angles as coordinates in the units that go
        with them), instead of modes. Without `damping` there is none; it need not be proportional.
    points : mapping of str to sequence of float, or sequence of str
        For modes: the mass-normalised shapes of all modes at each named point, in kg^(-1/2). For
        matrices: the names of their coordinates.
    base : sequence of float, shape (n,), optional
        How a motion of the base takes part, which only ``base_acceleration`` needs: for modes their
        participation factors φᵀ M r in kg^(1/2), for matrices the displacement r of each coordinate
        as the base moves by 1.
    absorber_at : str or sequence of str, optional
        The point at which the absorber rides, or those of all absorbers of a list; needed where
        there are several points. ``"absorber.0"`` is the mass of the first absorber of the list, if
        it is a free mass without units: a stop that stands there stops that mass, and absorbers
        after it in the list may ride on it.
    force_at : str or sequence of str, optional
        The point at which forces act, or those of all forces of a list in their order; by default
        that of the first absorber. Records and impulses have one point together. A force at
        ``"absorber.0"`` acts on the mass of the first absorber of the list itself.
    seen_at : str, optional
        The point that runs see; by default that of the first absorber, also of a run without.
    seen_mode : int, optional
        The number of a mode, from 1: runs see only the part φq of this mode in the motion of the
        point, so that all measures are those of the mode. Parts of all modes add up to the whole.
        An absolute acceleration has all of that of the base.
    natural_mode : int, optional
        The number of the mode whose frequency is the natural one; by default the first.
    start_displacements, start_velocities : sequence of float, shape (n,), optional
        Start of the coordinates of matrices in m and m/s, or of the modes in m kg^(1/2) and its
        rate; added to what ``start`` says. Absorbers are carried along: each starts with the
        velocity of its point, to which its ``start.gap_velocity`` is added.

    Raises
    ------
    TypeError
        If a value is of another form.
    ValueError
        If entries do not fit each other, or a matrix is not what it must be.

    Notes
    -----
    Between impacts the motion is a power series of the linear system with a bound on what is left
    out, impacts are Newton's law at the points; see "More than one" in the documentation.

    Examples
    --------
    Two storeys, with the absorber on the upper one:

    >>> frame = Structure(
    ...     points=["first", "top"],
    ...     mass=[[2000.0, 0.0], [0.0, 1000.0]],
    ...     stiffness=[[300e3, -100e3], [-100e3, 100e3]],
    ...     damping=[[300.0, -100.0], [-100.0, 100.0]],
    ...     absorber_at="top",
    ... )
    >>> frame.modes()["frequency_hz"].round(3).to_list()
    [1.125, 2.251]
    """

    frequencies: Sequence[float] | None = None
    frequencies_hz: Sequence[float] | None = None
    damping_ratios: float | Sequence[float] | None = None
    mass: Sequence[Sequence[float]] | None = None
    stiffness: Sequence[Sequence[float]] | None = None
    damping: Sequence[Sequence[float]] | None = None
    points: Mapping[str, Sequence[float]] | Sequence[str] | None = None
    base: Sequence[float] | None = None
    absorber_at: str | Sequence[str] | None = None
    force_at: str | Sequence[str] | None = None
    seen_at: str | None = None
    seen_mode: int | None = None
    natural_mode: int | None = None
    start_displacements: Sequence[float] | None = None
    start_velocities: Sequence[float] | None = None

    def __post_init__(self) -> None:
        """Turn every number into a float, and check that the entries fit each other."""
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not None:
                object.__setattr__(self, field.name, entry(field.name, value))
        _iva.modes(self._entries())

    def __repr__(self) -> str:
        """Show what was given, as an expression that gives it again."""
        return f"Structure({', '.join(f'{k}={v!r}' for k, v in self._entries().items())})"

    def _entries(self) -> dict[str, Any]:
        """Return the entries given, by name."""
        values = ((field.name, getattr(self, field.name)) for field in fields(self))
        return {name: value for name, value in values if value is not None}

    def _moves_as_seen(self) -> bool:
        """Return whether runs see the point of all absorbers, and all of its motion."""
        if self.seen_mode is not None:
            return False
        at = (
            {self.absorber_at} if isinstance(self.absorber_at, str) else set(self.absorber_at or ())
        )
        return len(at | ({self.seen_at} if self.seen_at and at else set())) <= 1

    def modes(self) -> pl.DataFrame:
        """Return the modes, a row for each.

        Returns
        -------
        polars.DataFrame, n rows
            ``mode`` (from 1), ``frequency`` in rad/s, ``frequency_hz``, ``damping_ratio``, and
            ``shape_`` with the name of each point: the mass-normalised shape there in kg^(-1/2).

        Examples
        --------
        >>> Structure(frequencies_hz=[1, 3], points={"top": [0.1, 0.2]}).modes().columns
        ['mode', 'frequency', 'frequency_hz', 'damping_ratio', 'shape_top']
        """
        import polars as pl

        each, points, _ = _iva.modes(self._entries())
        frequencies, damping_ratios = zip(*each, strict=True)
        return pl.DataFrame(
            {
                "mode": range(1, len(each) + 1),
                "frequency": frequencies,
                "frequency_hz": [frequency / (2 * math.pi) for frequency in frequencies],
                "damping_ratio": damping_ratios,
                **{f"shape_{name}": shapes for name, shapes in points},
            }
        )

    @classmethod
    def read(
        cls,
        file: str | PathLike[str],
        *,
        directions: str = "xyz",
        nodes: Iterable[int] | None = None,
        modes: Iterable[int] | None = None,
        modal_masses: Numbers | None = None,
        mass_unit: str | None = None,
        **entries: Any,
    ) -> Structure:
        """Read modes or matrices from a CSV file, a MAT file or a universal file.

        Parameters
        ----------
        file : path
            Its name tells what it is. ``.mat``: variables of MATLAB. ``.uff``, ``.unv``, ``.uf``: a
            universal file. All others are CSV. See the notes.
        directions : str, default "xyz"
            Of universal files: those directions of each node that become points.
        nodes : sequence of int, optional
            Of universal files: numbers of the nodes that become points, by default all.
        modes : sequence of int, optional
            Of universal files: numbers of the modes that are read, by default all.
        modal_masses : float or sequence of float, shape (n,), optional
            Of universal files: modal masses φᵀ M φ in kg of the shapes φ as the file has them, one
            for all modes or one for each by increasing frequency, in the place of those of the
            file.
        mass_unit : {"kg", "g", "t", "lb", "slug", "slinch"}, optional
            Unit of the modal masses of a universal file without units (dataset 164). If the file
            states another one, that is refused.
        **entries
            All other parameters of the class. They take the place of what the file has.

        Returns
        -------
        Structure

        Raises
        ------
        TypeError
            If an argument is unknown or of another form.
        ValueError
            If something is missing in the file or of another form, if a unit or a modal mass is
            stated nowhere, or if a mode is not real.
        ImportError
            If the package is missing that reads the file: pip install 'iva-dynamics[export]'.
        iva.IvaError, OSError
            If the file cannot be read.

        Notes
        -----
        *CSV:* a row for each mode. Columns are ``frequency`` (rad/s) or ``frequency_hz``,
        ``damping_ratio`` if there is any, ``base`` if the base moves, and ``shape_`` with the name
        of each point, as :meth:`modes` returns them. Other columns are left alone.

        *MAT* (versions up to 7.2, needs SciPy): variables have names, meanings and units of the
        parameters of the class. Shapes are a matrix ``shapes``, a row for each mode and a column
        for each point, and ``points`` is a cell array with the names; matrices may also be called
        ``M``, ``K`` and ``C``, and be sparse. Other variables are left alone.

        *Universal files* (datasets 55 of normal modes or complex eigenvalues, needs pyuff): a point
        is a node and a direction, ``"12x"``, ``"12y"``, ``"12z"``; those that no mode moves are
        left out, and so are rotations. Modes are sorted by frequency. A viscous damping ratio of 0
        is taken as it is. Shapes are divided by the root of the modal mass, in the units of dataset
        164. That of a complex eigenvalue of first order follows from its modal A; that of one of
        second order must be given. Some software writes modal masses of 1 for shapes that nobody
        scaled: then give `modal_masses`. Complex shapes are turned, which leaves their signs open,
        and taken as real if their phases then scatter by at most 10°; the tangent of that angle is
        the root of the sum of the squares of the imaginary parts over that of the real parts.

        Examples
        --------
        >>> Structure.read("modes.uff", directions="x", absorber_at="12x")  # doctest: +SKIP
        """
        from iva.structure_files import Choices, entries_of

        known = [field.name for field in fields(cls)]
        for name, value in entries.items():
            if name not in known:
                rule = (
                    hint(name, [*known, *Choices.__slots__]) or f"; give some of {', '.join(known)}"
                )
                raise TypeError(
                    f"{name} = {shown(value)}: Structure.read has no such argument{rule}"
                )
        choices = Choices(directions, nodes, modes, modal_masses, mass_unit)
        return cls(**entries_of(os.fspath(file), choices, entries))


def entry(name: str, value: Any) -> Any:
    """Return an entry with floats for all numbers and plain containers.

    Raises
    ------
    TypeError
        If it is of another form.
    """
    path = f"structure.{name}"
    if name in NUMBERS:
        if name == "damping_ratios" and not is_list(value):
            return [number(path, value)]
        return numbers(path, value)
    if name in MATRICES:
        if not is_list(value):
            raise TypeError(f"{path} = {shown(value)}: give the rows of a matrix")
        return [numbers(f"{path}[{row}]", values) for row, values in enumerate(value)]
    if name in NAMES:
        return word_or_words(path, value)
    if name in MODES:
        return mode_of(path, value)
    if isinstance(value, Mapping):
        return {
            word_of(path, point): numbers(f"{path}[{point!r}]", shapes)
            for point, shapes in value.items()
        }
    return word_or_words(path, value)


def mode_of(path: str, value: object) -> int:
    """Return the number of a mode."""
    rule = "give the number of a mode, from 1"
    if isinstance(value, bool) or not hasattr(value, "__index__"):
        raise TypeError(f"{path} = {shown(value)}: {rule}")
    if (mode := index(value)) < 1:
        raise ValueError(f"{path} = {shown(value)}: {rule}")
    return mode


def word_or_words(path: str, value: object) -> str | list[str]:
    """Return a name, or a list of names."""
    if isinstance(value, str):
        return value
    if not isinstance(value, Iterable):
        raise TypeError(f"{path} = {shown(value)}: give the name of a point")
    return [word_of(path, one) for one in value]


def word_of(path: str, value: object) -> str:
    """Return a name.

    Raises
    ------
    TypeError
        If it is none.
    """
    if not isinstance(value, str):
        raise TypeError(f"{path} = {shown(value)}: give the name of a point")
    return value
