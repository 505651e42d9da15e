"""Lyapunov exponents: how fast neighbouring motions of a steady state separate."""

from __future__ import annotations

from dataclasses import dataclass

from iva import _iva
from iva.doubts import warn_of_doubts
from iva.dynamics.diagrams import MOST_CYCLES
from iva.dynamics.orbits import Orbit, scene_told
from iva.dynamics.search import alone_or_all, start_of, whole
from iva.dynamics.starts import MOST_SEED, MOST_STARTS, Range, box_of, boxed
from iva.forces import Drive, Harmonic, listed, single
from iva.parameters import Absorbers, Primary, Start
from iva.progress import reporting
from iva.scenes import scene
from iva.spelling import spell_checked
from iva.structures import Structure

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from typing import Any

    from iva import theory
    from iva.progress import Progress
    from iva.simulation import Run

#: So many standard errors make a sign sure.
SURE = 4.0
#: Logarithm of the least factor by which neighbours separate in a run of chaos.
SLOW = 10.0


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Spectrum:
    """The Lyapunov exponents of a steady state.

    Parameters
    ----------
    absorber : Siva, Piva, Stop, or a list of them
        The absorber.
    primary : Primary or Structure
        The primary system.
    force : Harmonic
        The force.
    exponents : tuple of float, length 4 or more
        The exponents in 1/s (in ωn where no frequency is given), largest first: as many as a state
        has numbers. With rides on a wall two are −∞ (four where two absorbers ride at once), with
        plastic impacts, or friction that holds an absorber, one.
    standard_errors : tuple of float, of the same length
        Their standard errors, from blocks of periods or from whole runs, whichever are larger.
    sum_error : float or None
        Their sum minus its exact value, (2 ln e) × (number of impacts per time) − 2 ζ ωn, of
        several modes with the sum of their ζ ω. ``None`` with rides, plastic impacts, friction,
        unlike walls or restitutions, or a pendulum.
    dimension : float
        The dimension of the attractor in the section of the strobes, after J. L. Kaplan and J. A.
        Yorke.
    impacts_per_cycle, impacts_per_cycle_error : float
        Mean number of impacts in a period of the force, and its standard error. With rides the
        number depends on the chatter floor.
    rides : int
        Number of rides on a wall.
    cycles : int
        Number of periods that count, of all runs together.
    time : float
        Length of the part of each run that counts.
    outcome : str
        ``finished``, or how the first run ended that did not: ``impact_limit``, ``work_limit``,
        ``not_finite``, or ``cancelled`` by Ctrl-C.
    box : tuple of pairs of float, length 4 or more
        The box of the starts: displacement, velocity, gap displacement and gap velocity, of
        several absorbers the latter two of each.
    """

    # Any: an absorber or a list, a primary or a structure, as they were given.
    absorber: Any
    primary: Any
    force: Drive
    exponents: tuple[float, ...]
    standard_errors: tuple[float, ...]
    sum_error: float | None
    dimension: float
    impacts_per_cycle: float
    impacts_per_cycle_error: float
    rides: int
    cycles: int
    time: float
    outcome: str
    box: tuple[Range, ...]

    @property
    def sign(self) -> int:
        """Sign of the largest exponent: 0 where it cannot be told from 0.

        +1: chaos; 0: a torus, or not enough periods to tell; −1: a periodic motion. An exponent
        counts as 0 within four standard errors, or where neighbours separate or approach by less
        than e¹⁰ in a run: on a torus they do so by a bounded factor, or in proportion to the time.
        """
        largest, error = self.exponents[0], self.standard_errors[0]
        if not abs(largest) > max(SURE * error, SLOW / self.time):
            return 0
        return 1 if largest > 0.0 else -1

    def __repr__(self) -> str:
        """Show exponents with their errors, what else is told, and the scene."""
        pairs = zip(self.exponents, self.standard_errors, strict=True)
        lines = [
            f"Spectrum: {', '.join(f'{one:.5f} ± {error:.5f}' for one, error in pairs)}",
            f"  dimension {self.dimension:.4g}, {self.impacts_per_cycle:.6g} impacts per period, "
            f"{self.rides} rides in {self.cycles} periods, {self.outcome}",
        ]
        lines += scene_told(self.absorber, self.primary, *listed(self.force))
        return "\n".join(lines)


@spell_checked
def lyapunov(
    absorber: Absorbers,
    primary: Primary | Structure,
    *,
    force: Harmonic | Sequence[Harmonic],
    start: Start | Run | theory.Orbit | Orbit | Iterable[float] | None = None,
    cycles: int = 20_000,
    discard: int = 500,
    seeds: int = 8,
    seed: int = 1,
    box: Mapping[str, Range | Sequence[Range]] | None = None,
    progress: bool | Progress = False,
) -> Spectrum:
    """Compute the Lyapunov exponents of a steady state, with standard errors.

    Parameters
    ----------
    absorber : Siva, Piva, Stop, or a list of them
        A free mass, a pendulum, or a stop on the ground; or several, as for :func:`orbit`.
    primary : Primary or Structure
        The primary system; what it is given decides the units.
    force : Harmonic
        A harmonic force, or motion of the base; or several whose frequencies are fractions of each
        other: a period is then the shortest after which all of them repeat.
    start : Start, Run, theory.Orbit, Orbit or sequence of float, shape (4,), optional
        Runs begin from this start and from others within 10⁻⁶ of its size, as for :func:`orbit`. By
        default starts are drawn from a box; if steady states of different kinds coexist, the
        exponents are then a mixture, and their errors large: see :func:`attractors` first.
    cycles : int, default 20_000
        Number of periods of the force that count in each run.
    discard : int, default 500
        Number of periods that each run leaves out first.
    seeds : int, default 8
        Number of runs.
    seed : int, default 1
        The seed of the random starts, 0 to 2⁶⁴ − 1.
    box : mapping of str to pair of float, optional
        The range of displacement, velocity, gap_displacement and gap_velocity that starts are drawn
        from; of several absorbers a range of the gaps is that of all, and a list has one for each.
        Of several modes displacement and velocity are those of the natural one. By default
        displacement and velocity of the structure up to those of its steady state
        without absorber, the whole gap, and gap velocities up to the same velocity.
    progress : bool or callable, default False
        As in :func:`iva.sweep`; a point is a run.

    Returns
    -------
    Spectrum

    Raises
    ------
    TypeError
        If an argument is of the wrong class.
    ValueError
        If a value is missing or out of range, a start lies outside the gap, the force is not one
        harmonic force, or both `start` and `box` are given.
    KeyboardInterrupt
        On Ctrl-C before a period counts. Later it ends the runs where they are, and the exponents
        are those of the periods until then.

    Notes
    -----
    G. Benettin et al., Meccanica 15 (1980) 9–30, with the exact derivative of the motion through
    every impact.

    Examples
    --------
    >>> siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=3.85)
    >>> primary = iva.Primary(damping_ratio=0.05)
    >>> force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    >>> found = lyapunov(siva, primary, force=force, cycles=1000)
    >>> found.sign, abs(found.sum_error) < 1e-12
    (1, True)
    """
    if start is not None and box is not None:
        raise ValueError("box: give it without a start, or a start without it")
    absorber = alone_or_all(absorber)
    begin = Start() if start is None else start_of(start, absorber)
    made = scene(absorber, primary, begin, force, {}, several=True)
    warn_of_doubts(made)
    count = whole("seeds", seeds, 1, MOST_STARTS)
    starts = (count, whole("seed", seed, 0, MOST_SEED), box_of(box, absorber), start is not None)
    window = (whole("discard", discard, 0, MOST_CYCLES), whole("cycles", cycles, 1, MOST_CYCLES))
    with reporting(progress) as report:
        found = _iva.lyapunov(made, starts, window, report)
    found["box"] = boxed(found["box"])
    for name in ("exponents", "standard_errors"):
        found[name] = tuple(found[name])
    return Spectrum(absorber=absorber, primary=primary, force=single(force), **found)
