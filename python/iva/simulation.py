"""One run of a primary system, with an absorber or without."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from iva import _iva
from iva.doubts import warn_of_doubts
from iva.forces import Force, Impulse, listed
from iva.frames import Frames, from_arrow, to_polars
from iva.parameters import Absorber, Primary, Start, Stop, number, numbers, shown
from iva.run_tables import Gradients, RunTables, Verification, differentiated, verified
from iva.scenes import scene
from iva.spelling import spell_checked
from iva.structures import Structure
from iva.units import Units, from_metadata

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from os import PathLike
    from typing import Any

    import polars as pl

    from iva.lengths_in_mm import RunInMm
    from iva.measured import Measured
    from iva.measured.records import Quantity
    from iva.parameters import Absorbers, Spec


class Run(RunTables):
    """Result of :func:`simulate`: the tables of one run.

    Attributes of tables are polars frames, made on first use. `units` names the unit of every
    column. Runs can be copied, pickled and compared (same scene, same values).

    Attributes
    ----------
    gradients : mapping of str to Gradient
        Derivatives by the parameters given as ``gradients=…``.

    Examples
    --------
    >>> run = iva.simulate(
    ...     iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5),
    ...     iva.Primary(damping_ratio=0.01),
    ...     start=iva.Start(displacement=1.0),
    ...     periods=30,
    ... )
    >>> run.impacts.select("time", "wall").row(0)
    (1.1642..., 1)
    >>> run.units["impacts"]["approach_velocity"]
    'length of displacement · ωn'
    """

    def __init__(
        self,
        absorber: Absorber | tuple[Absorber, ...] | None,
        primary: Primary | Structure,
        start: Start,
        spec: Spec,
        units: Units,
        frames: Frames,
        force: Force | Sequence[Force] | None = None,
        verification: Verification | None = None,
        gradients: Gradients | None = None,
        measured: Sequence[str] | None = None,
    ) -> None:
        super().__init__(frames)
        self.absorber = absorber
        self.primary = primary
        self.start = start
        self.force = force
        self.units = units
        self._spec = spec
        self._verification = verification
        self._measured = measured
        self.gradients = gradients or Gradients({})

    @property
    def verification(self) -> Verification:
        """Its errors, if it was made with ``verify=True``."""
        if self._verification is None:
            raise AttributeError("no verification: ask for it with verify=True")
        return self._verification

    @property
    def in_mm(self) -> RunInMm:
        """Its tables, `trajectory` and `at` with lengths in mm; only where lengths are in metres.

        Columns of the run itself are in SI units however a length was given.
        """
        from iva.lengths_in_mm import RunInMm

        return RunInMm(self, self._frames)

    @spell_checked
    def trajectory(self, samples_per_period: int = 200) -> pl.DataFrame:
        """Compute the motion in time.

        Parameters
        ----------
        samples_per_period : int, default 200
            Equidistant samples a period 2π/ωn of the bare primary system.

        Returns
        -------
        polars.DataFrame
            ``time``, ``displacement``, ``velocity``, ``gap_displacement``, ``gap_velocity``,
            ``wall`` (0 in flight, ±1 stuck), ``angle`` and ``angular_velocity`` (null for a free
            mass), and the absolute ``acceleration`` and ``absorber_acceleration``, impacts apart,
            and ``absorber``: of several each has a row at every instant. Besides the samples, an
            impact appears twice: just before and just after, in rows of its absorber. Without
            absorber all columns of gap, angle and absorber are null, and ``wall`` is 0.

        Raises
        ------
        TypeError, ValueError
            If `samples_per_period` is not a whole number, 1 or greater, or makes more than 3e7.

        Examples
        --------
        >>> run.trajectory(50).plot.line("time", "displacement")  # doctest: +SKIP
        """
        return to_polars(_iva.trajectory(self._spec, samples_per_period))

    def at(self, times: Iterable[float]) -> pl.DataFrame:
        """Compute the state at given instants, exact at any of them (no interpolation).

        Parameters
        ----------
        times : sequence of float, shape (n,)
            Instants within the run, in any order, in the unit of time.

        Returns
        -------
        polars.DataFrame
            n rows in the order of `times`, of several absorbers n for each, columns as in
            :meth:`trajectory`. At an impact, to four
            rounding units of the time, it is the state just after it. After an early end of the run
            (an outcome other than ``finished``) all columns but ``point`` and ``time`` are null.
            An impact takes no time here, so ``acceleration`` has no pulse at it: what a sensor
            would have shown is made by :meth:`recorded`.

        Raises
        ------
        TypeError
            If `times` is not a one-dimensional sequence of numbers.
        ValueError
            If an instant is outside the run.

        Examples
        --------
        >>> run = iva.simulate(
        ...     iva.Siva(mass_ratio=0.1, clearance=3, restitution=0.5),
        ...     iva.Primary(),
        ...     start=iva.Start(displacement=1),
        ...     periods=1,
        ... )
        >>> run.at([3.0, 0.0])["displacement"].round(6).to_list()
        [-0.989992, 1.0]
        """
        return to_polars(_iva.states(self._spec, numbers("times", times)))

    @spell_checked
    def recorded(
        self,
        rate_hz: float,
        *,
        quantity: Quantity = "acceleration",
        contact_time: float = 1e-3,
        filter: str | None = "linear phase",  # noqa: A002 (the word of the field)
        cutoff_hz: float | None = None,
        before: float = 0.0,
        noise: float = 0.0,
        seed: int = 0,
    ) -> Measured:
        """Return the record that a sensor on the structure would have made.

        In an acceleration every impact leaves the half sine of its contact force, as large as its
        jump of velocity; a filter spreads it over many samples. It is needed to try out
        :func:`iva.identify`: the acceleration of :meth:`at` has no such pulses.

        Parameters
        ----------
        rate_hz : float
            Sampling rate.
        quantity : {"acceleration", "velocity", "displacement"}, default "acceleration"
            What is measured.
        contact_time : float, default 1e-3
            Length of a contact in s. It counts in an acceleration only.
        filter : {"linear phase", "zero phase", "causal", None}, default "linear phase"
            What the recorder filters with: linear phase with its delay removed, Butterworth filters
            of order 2 forth and back or of order 4 with its delay, or nothing.
        cutoff_hz : float, optional
            Its corner, 0.42 of the sampling rate by default.
        before : float, default 0.0
            Seconds of rest before the run that are recorded too.
        noise : float, default 0.0
            Standard deviation of white noise, in m/s², m/s or m.
        seed : int, default 0
            Of the noise.

        Returns
        -------
        iva.Measured

        Raises
        ------
        TypeError
            If an argument is of the wrong type.
        ValueError
            If an argument is out of range, lengths are not in metres, or the run has ended early.

        Examples
        --------
        >>> siva = iva.Siva(mass_ratio=0.1, gap_mm=9, restitution=0.6)
        >>> primary = iva.Primary(mass=3, frequency_hz=5, damping_ratio=0.008)
        >>> run = iva.simulate(siva, primary, start=iva.Start(displacement_mm=8), duration=2)
        >>> run.recorded(2048, noise=0.03, before=0.25)
        Measured(4609 samples of acceleration at 2048 Hz from -0.25 to 2 s, 'acceleration')
        """
        from iva.measured.recorders import recorded

        return recorded(
            self, rate_hz, quantity, contact_time, filter, cutoff_hz, before, noise, seed
        )

    def state_at(self, time: float) -> Start:
        """Return the state at an instant, for another run to go on from.

        Parameters
        ----------
        time : float
            An instant within the run, in its unit of time.

        Returns
        -------
        Start
            Displacements and velocities as :meth:`at` gives them, after the impact or the impulse
            of that instant if there is one, the instant, and the displacement that a relative
            clearance refers to. A run that starts from it goes on as this one does, stuck if this
            one is, to a rounding unit of each number: they are doubles, where a run carries their
            rounding rests too.

        Raises
        ------
        TypeError
            If `time` is not a number.
        ValueError
            If it is outside the run, or after its early end.

        Examples
        --------
        >>> siva = iva.Siva(mass_ratio=0.1, clearance=0.5, restitution=0.5)
        >>> run = iva.simulate(siva, iva.Primary(), start=iva.Start(displacement=1), periods=20)
        >>> later = iva.simulate(
        ...     siva, iva.Primary(damping_ratio=0.05), start=run.state_at(12.5), periods=20
        ... )
        >>> later.trajectory()["time"].min()
        12.5
        """
        at = number("time", time)
        begin = self.start.time or 0.0
        blows = (force.time or 0.0 for force in listed(self.force) if isinstance(force, Impulse))
        shock = self.start.impulse is not None or self.start.impulse_velocity is not None
        if at == begin == 0.0 and (shock or 0.0 in blows):
            return self.start  # before the impulses of time zero, which act in a run from it
        rows = to_polars(_iva.state(self._spec, at)).rows(named=True)
        if rows[0]["displacement"] is None:
            end = self.summary["outcome"].item()
            raise ValueError(f"time = {at!r}: the run ended before ({end}); give an earlier one")
        modes = None
        if isinstance(self.primary, Structure):
            modes = _iva.state_of_modes(self._spec, at)
        return state_of(rows, self.absorber, self.start, modes)

    @spell_checked
    def write_mat(self, path: str | PathLike[str], *, samples_per_period: int = 200) -> None:
        """Write all tables and the trajectory into a file for MATLAB and Octave; needs SciPy.

        As :meth:`Table.write_mat`; in MATLAB ``T = struct2table(load("run.mat").trajectory)``.

        Parameters
        ----------
        path : str or path
            The file, usually ``*.mat``. It is written whole or not at all.
        samples_per_period : int, default 200
            Of the trajectory, as in :meth:`trajectory`.

        Raises
        ------
        ImportError, TypeError, ValueError, iva.IvaError
            As :meth:`Table.write_mat` and :meth:`trajectory`.
        """
        from iva import exports

        trajectory = self.trajectory(samples_per_period)
        exports.write_mat(path, self._frames, self.units, trajectory)

    @spell_checked
    def write_uff(
        self,
        path: str | PathLike[str],
        *,
        samples_per_period: float | None = None,
        samples_per_second: float | None = None,
        binary: bool = True,
    ) -> None:
        """Write the motion into a universal file, which software of test rigs reads; needs pyuff.

        Time responses (dataset 58, +X): displacement and velocity of the structure (node 1) and of
        the absorber, if there is one (node 2, of several 2 and on; of a pendulum its centre of
        mass), relative to the base if that moves. Dataset 164 says SI units, axes say others. No
        acceleration: no sample shows its impulses.

        Parameters
        ----------
        path : str or path
            The file, usually ``*.uff``. It is written whole or not at all.
        samples_per_period : float, optional
            Samples a period 2π/ωn of the bare primary system; 200 by default. The format has six
            digits for the step: it is rounded to these, and the samples are exact where it says.
        samples_per_second : float, optional
            The same as a rate in Hz, where the run has seconds.
        binary : bool, default True
            Values to the last bit (dataset 58b). False writes text with 12 digits.

        Raises
        ------
        ImportError, TypeError, ValueError, iva.IvaError
            As :meth:`Table.write_mat`; also if a number of samples is out of range.
        """
        from iva import exports

        exports.write_uff(path, self, samples_per_period, samples_per_second, binary)

    def __eq__(self, other: object) -> bool:
        """Compare the scene and all tables."""
        if not isinstance(other, Run):
            return NotImplemented
        return self._spec == other._spec and self._frames == other._frames

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        """Show the outcome, some measures, the scene and the units."""
        from iva.run_lines import run_lines

        return "\n".join(run_lines(self))

    def _repr_html_(self) -> str:
        """Show parameters, outcome, measures and units in a notebook."""
        from iva import markup

        return markup.of_run(self)


@spell_checked
def simulate(
    absorber: Absorbers | None,
    primary: Primary | Structure,
    *,
    start: Start,
    force: Force | Sequence[Force] | None = None,
    periods: float | None = None,
    duration: float | None = None,
    cycles: float | None = None,
    discard: float | None = None,
    measures: Iterable[str] | None = None,
    tables: Iterable[str] | None = None,
    max_impacts: float | None = None,
    max_work: float | None = None,
    chatter_floor: float | None = None,
    tolerance: float | None = None,
    errors: bool = False,
    verify: bool = False,
    gradients: Iterable[str] = (),
) -> Run:
    """Simulate a primary system with impact absorbers, or alone, in free decay or under a force.

    Parameters
    ----------
    absorber : Siva, Piva, a list of them, or None
        The absorber: a free mass, or a pendulum. Of a list, up to 64 of either kind, all are on
        the structure; tables number them from 0 in their column ``absorber``. Or ``None``: the
        structure alone. Then the start has no gap and no angle, and there is neither
        `chatter_floor` nor `tolerance`.
    primary : Primary or Structure
        The primary system; what it is given decides the units. A structure with several modes has
        free masses, or none, and no reductions against the bare structure.
    start : Start
        The state at the begin, at time zero unless it says another instant: ``run.state_at(t)``
        goes on from another run. Lengths of a run count from there. Instants of results, settling
        times among them, are on the clock of the forces; ``damping_ratio_energy`` is that of the
        first period from time zero, null in a run that begins later.
    force : Harmonic, Impulse, Recorded, or a list of them, optional
        What drives it; free decay without. A list is a sum. Under harmonic and recorded forces
        damping ratios and settling times are null; steady states have columns of their own.
    periods : float, optional
        Length in periods 2π/ωn of the bare primary system. This, `duration` or `cycles`.
    duration : float, optional
        Length of the run as a time.
    cycles : float, optional
        Length of the run in cycles 2π/Ω of the harmonic force (of several, the first).
    discard : float, optional
        Cycles that the steady-state columns and the stroboscope leave out at the begin, or 0.
    measures : iterable of str, optional
        Summary columns to compute, the others are null. By default all but those that take more
        time and are computed only if named: ``acceleration_max``, ``gap_displacement_max``,
        ``stroke``, ``absorber_displacement_max`` and ``time_near_wall``.
    tables : iterable of str, optional
        Tables to make beside the summary: ``impacts``, ``episodes``, ``envelope``,
        ``stroboscope``, ``absorbers``; all by default. A long run without tables takes no memory.
    errors : bool, default False
        Estimate the error of every impact time: the columns ``time_error`` and ``near_grazing`` of
        the impacts, ``condition`` and ``digits`` of the summary. A pendulum takes ten times as
        long.
    verify : bool, default False
        Run the scene again in numbers of twice the precision: `verification` of the run holds the
        true error of every number. It takes some fifty times as long.
    gradients : iterable of str, optional
        Parameters to differentiate by, by their names in a sweep (``relative_clearance``,
        ``restitution``, ``force.frequency``): `gradients` of the run holds for each the derivative
        of every number. Each takes three runs to twice the precision, some 10 ms.
    max_impacts : int, optional
        Stop after so many impacts, 10 million by default; the outcome says so.
    max_work : int, optional
        Stop after so many flight segments, 100 million by default; the outcome says so.
    chatter_floor : float, optional
        A velocity: rebounds of a chatter episode at or below it are summed, not listed as
        impacts. Default 1e-6 ωn d, d the clearance. The motion does not depend on it.
    tolerance : float, optional
        0, the default, for full accuracy, up to 1e-3. Of a pendulum: what a step of its flight may
        leave out, relative to the size of each variable; small angles do not need it. Of a free
        mass under a harmonic force: above 0 its summary is made by the fast tier, in plain doubles,
        where no other table and no errors are asked for. Of any other free mass it changes nothing.
        The column ``tier`` of the summary says which tier made it.

    Returns
    -------
    Run
        The tables; a run cut short by a limit comes back with what it has.

    Raises
    ------
    TypeError
        If an argument is of the wrong type.
    ValueError
        If a value is missing, out of range, given twice, or belongs to an absorber where there is
        none, or the start lies outside the gap.
    KeyboardInterrupt
        On Ctrl-C, within about a second; nothing of the run comes back. Python hands the signal to
        its main thread only: a run in another thread goes on to its end.

    Warns
    -----
    UserWarning
        If the primary mass is given, so that lengths are in metres, and the gap is 500 times the
        start displacement or more, or the other way round: one of them seems to be meant in mm.

    Examples
    --------
    >>> run = iva.simulate(
    ...     iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5),
    ...     iva.Primary(damping_ratio=0.01),
    ...     start=iva.Start(displacement=1.0),
    ...     periods=30,
    ... )
    >>> run.summary["outcome"].item()
    'finished'

    The same structure without absorber:

    >>> bare = iva.simulate(
    ...     None, iva.Primary(damping_ratio=0.01), start=iva.Start(displacement=1.0), periods=30
    ... )
    >>> round(bare.summary["damping_ratio_3"].item(), 12)
    0.01

    Many scenes that are no grid, in processes of their own. Parameters and results travel between
    processes; start them afresh ("spawn"), for a fork of a process with threads can hang. In a
    script this belongs below ``if __name__ == "__main__":``.

    >>> from concurrent.futures import ProcessPoolExecutor
    >>> from functools import partial
    >>> from multiprocessing import get_context
    >>> absorbers = [
    ...     iva.Siva(mass_ratio=0.1, relative_clearance=gamma, restitution=0.5)
    ...     for gamma in (0.4, 0.8)
    ... ]
    >>> job = partial(
    ...     iva.simulate, primary=iva.Primary(), start=iva.Start(displacement=1.0), periods=5
    ... )
    >>> with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
    ...     runs = list(pool.map(job, absorbers))
    >>> [run.absorber.relative_clearance for run in runs]
    [0.4, 0.8]
    """
    spec = scene(
        absorber,
        primary,
        start,
        force,
        {
            "periods": periods,
            "duration": duration,
            "cycles": cycles,
            "discard": discard,
            "max_impacts": max_impacts,
            "max_work": max_work,
            "chatter_floor": chatter_floor,
            "tolerance": tolerance,
        },
        several=True,
    )
    warn_of_doubts(spec)
    asked = (names("measures", measures), names("tables", tables))
    by = names("gradients", gradients) or []
    truth("verify", verify)
    measured, tabled = asked
    # Derivatives are those of the exact tier, which makes whatever is more than a summary.
    more = ["episodes"] if by and tabled is not None and "episodes" not in tabled else []
    listed_tables = None if tabled is None else tabled + more
    made = _iva.simulate(spec, measured, listed_tables, truth("errors", errors))
    for name in more:
        del made[name]
    units = from_metadata(made["summary"].metadata)
    kept = tuple(force) if isinstance(force, Sequence) else force
    return Run(
        tuple(absorber) if isinstance(absorber, Sequence) else absorber,
        primary,
        start,
        spec,
        units,
        from_arrow(made),
        kept,
        verified(spec, *asked) if verify else None,
        differentiated(spec, by, *asked),
        measured,
    )


#: Where cos θ is smaller than this, the angle tells the place of a pendulum better than y does.
STEEP = 0.5


def state_of(
    rows: Sequence[Mapping[str, Any]],
    absorber: object,
    start: Start,
    modes: Sequence[Sequence[float]] | None = None,
) -> Start:
    """Return the state of some rows of a trajectory, one a unit, in a run from a start.

    Of a structure with several modes these have a state of their own.
    """
    row = rows[0]
    reference = start.reference
    if reference is None and start.displacement_mm is not None:
        reference = start.displacement_mm / 1000
    if reference is None:
        reference = start.displacement
    if modes is None:
        kept = {name: row[name] for name in ("time", "displacement", "velocity")}
    else:
        kept = {"time": row["time"], **dict(zip(start._of_modes, modes, strict=True))}
    angles = [one["angle"] for one in rows]
    if None not in angles and any(math.cos(angle) < STEEP for angle in angles):
        place = ("angle", "angular_velocity")
    else:
        place = ("gap_displacement", "gap_velocity")
    if isinstance(absorber, Stop):
        pass  # The structure is where its gap tells.
    elif len(rows) == 1:
        kept |= {name: row[name] for name in place}
    else:
        kept |= {name: [one[name] for one in rows] for name in place}
    return Start(reference=None if row["gap_displacement"] is None else reference, **kept)


def truth(field: str, value: object) -> bool:
    """Return a truth value.

    Raises
    ------
    TypeError
        If it is none.
    """
    if not isinstance(value, bool):
        raise TypeError(f"{field} = {shown(value)}: give True or False")
    return value


def names(field: str, values: Iterable[str] | None) -> list[str] | None:
    """Return one or several names as a list; ``None`` stays.

    Raises
    ------
    TypeError
        If it, or something in it, is not a text.
    """
    if values is None:
        return None
    if not isinstance(values, Iterable):
        raise TypeError(f"{field} = {shown(values)}: give names")
    listed = [values] if isinstance(values, str) else list(values)
    for value in listed:
        if not isinstance(value, str):
            raise TypeError(f"{field} has {shown(value)} in it: give names")
    return listed
