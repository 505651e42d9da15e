"""The kinds of steady motion that a scene has."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import groupby

from iva.dynamics.diagrams import Diagram, diagram
from iva.dynamics.exponents import Spectrum, lyapunov
from iva.dynamics.inventories import attractors, binomial
from iva.dynamics.orbits import Orbit
from iva.dynamics.search import alone_or_all
from iva.dynamics.starts import Range
from iva.forces import Harmonic
from iva.parameters import Absorbers, Primary
from iva.scenes import absorbers
from iva.spelling import spell_checked
from iva.structures import Structure

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

#: Least share of the periods without an impact in a modulated response.
QUIET = 0.005
#: Periods that are looked at for it.
LOOKED_AT = 4000
#: The ways to give a clearance.
CLEARANCES = ("clearance", "clearance_mm", "gap", "gap_mm", "relative_clearance")
#: Most runs for the exponents of a motion that is not periodic.
RUNS = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class Regime:
    """A kind of steady motion.

    Parameters
    ----------
    kind : str
        ``periodic``, ``torus``, ``chaotic``, ``modulated``, ``no_impacts`` or ``unfinished``.
    name : str
        The same as a word; of a periodic motion impacts and periods, such as ``3:1``.
    share : float
        Share of the starts that end in it.
    standard_error : float
        Binomial standard error of the share.
    orbit : Orbit or None
        The orbit of a periodic motion, where one was found. A periodic motion that only its
        negative Lyapunov exponents show has none; its name is ``periodic`` then.
    spectrum : Spectrum or None
        The Lyapunov exponents of a motion without an orbit, unless it is without impacts.
    quiet : float or None
        Of such a motion the share of the periods of the force without an impact.
    burst : float or None
        The mean number of periods of a burst, a stretch of periods with impacts between two
        without; ``None`` where there are less than two pauses.
    amplitude : float or None
        The amplitude of the structure, as the square root of the mean of x² + (ẋ/Ω)² at the
        strobes, in the units of the primary system.
    """

    kind: str
    name: str
    share: float
    standard_error: float
    orbit: Orbit | None = None
    spectrum: Spectrum | None = None
    quiet: float | None = None
    burst: float | None = None
    amplitude: float | None = None


@spell_checked
def regimes(
    absorber: Absorbers,
    primary: Primary | Structure,
    *,
    force: Harmonic | Sequence[Harmonic],
    starts: int = 64,
    seed: int = 1,
    most_periods: int = 32,
    most_cycles: int = 3000,
    cycles: int = 5000,
    box: Mapping[str, Range | Sequence[Range]] | None = None,
) -> tuple[Regime, ...]:
    """Tell which kinds of steady motion a scene has, and how likely each is.

    Parameters
    ----------
    absorber : Siva, Piva, Stop, or a list of them
        A free mass, a pendulum, or a stop on the ground; or several, as for :func:`orbit`.
    primary : Primary or Structure
        The primary system; what it is given decides the units.
    force : Harmonic
        A harmonic force, or motion of the base; or several whose frequencies are fractions of each
        other: a period is then the shortest after which all of them repeat.
    starts, seed, most_periods, most_cycles, box
        As for :func:`attractors`.
    cycles : int, default 5000
        Number of periods of the force in each of the runs that the exponents are from.

    Returns
    -------
    tuple of Regime
        The likeliest first.

    Raises
    ------
    TypeError, ValueError
        As :func:`attractors`.
    KeyboardInterrupt
        On Ctrl-C, within about a second.

    Notes
    -----
    Starts whose strobes repeat are periodic. All others are taken for one motion, that of the first
    of them. It is

    * modulated, if impacts come in bursts, with stretches of a period or more without any between
      them, in at least one of 200 periods: the strongly modulated response (Y. Starosvetsky and
      O. V. Gendelman, Physica D 237 (2008) 1719–1733; of impact absorbers E. Gourc et al., Journal
      of Vibration and Acoustics 137 (2015) 031008), regular or chaotic;
    * else chaotic, if the largest Lyapunov exponent is above 0 (:attr:`Spectrum.sign`);
    * else a torus, if it cannot be told from 0;
    * else periodic, with a period or a transient that is too long to be seen.

    Examples
    --------
    >>> siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5)
    >>> primary = iva.Primary(damping_ratio=0.05)
    >>> force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    >>> found = regimes(siva, primary, force=force, starts=20)
    >>> [(one.kind, one.name, one.share) for one in found]
    [('periodic', '2:1', 1.0)]
    """
    found = attractors(
        absorber,
        primary,
        force=force,
        starts=starts,
        seed=seed,
        most_periods=most_periods,
        most_cycles=most_cycles,
        box=box,
    )

    def regime(kind: str, name: str, count: int, **more: object) -> Regime:
        share, error = count / found.starts, binomial(count, found.starts)
        made: dict[str, object] = {"kind": kind, "name": name, **more}
        return Regime(share=share, standard_error=error, **made)  # type: ignore[arg-type]

    listed = [regime("periodic", one.name, one.count, orbit=one.orbit) for one in found.attractors]
    if found.aperiodic_start is not None:
        scene = (absorber, primary)
        begin = found.aperiodic_start
        spectrum = lyapunov(
            *scene, force=force, start=begin, cycles=cycles, discard=most_cycles, seeds=RUNS
        )
        # One value of a number that the absorber has: the scene itself.
        absorber = alone_or_all(absorber)
        [first, *others] = absorbers(absorber)
        by = next(name for name in CLEARANCES if getattr(first, name) is not None)
        place = "absorber.0" if others else "absorber"
        strobes = diagram(
            *scene,
            force=force,
            over={f"{place}.{by}": [getattr(first, by)]},
            direction="up",
            start=begin,
            discard=most_cycles,
            keep=LOOKED_AT,
        )
        quiet = share_without_impacts(strobes)
        kind = kind_of(spectrum, quiet)
        frequency = 2 * math.pi * cycles / spectrum.time
        more = {
            "spectrum": spectrum,
            "quiet": quiet,
            "burst": burst_length(strobes),
            "amplitude": amplitude(strobes, frequency),
        }
        listed.append(regime(kind, kind, found.aperiodic, **more))
    if found.no_impacts:
        listed.append(regime("no_impacts", "no_impacts", found.no_impacts))
    if found.unfinished:
        listed.append(regime("unfinished", "unfinished", len(found.unfinished)))
    return tuple(sorted(listed, key=lambda one: -one.share))


def share_without_impacts(strobes: Diagram) -> float:
    """Return the share of periods without an impact."""
    impacts = [strobe[-1] for strobe in strobes.strobes]
    return sum(count == 0 for count in impacts) / max(len(impacts), 1)


def burst_length(strobes: Diagram) -> float | None:
    """Return the mean number of periods with impacts between two pauses."""
    impacts = [strobe[-1] > 0 for strobe in strobes.strobes]
    stretches = [(hits, len(list(periods))) for hits, periods in groupby(impacts)]
    # The first and the last one may have begun before, and go on.
    bursts = [length for hits, length in stretches[1:-1] if hits]
    return sum(bursts) / len(bursts) if bursts else None


def amplitude(strobes: Diagram, frequency: float) -> float:
    """Return the square root of the mean of x² + (ẋ/Ω)² at the strobes."""
    squares = [x * x + (v / frequency) ** 2 for x, v, *_ in strobes.strobes]
    return math.sqrt(sum(squares) / max(len(squares), 1))


def kind_of(spectrum: Spectrum, quiet: float) -> str:
    """Return the kind of a motion whose strobes do not repeat."""
    if quiet >= QUIET:
        return "modulated"
    return {1: "chaotic", 0: "torus", -1: "periodic"}[spectrum.sign]
