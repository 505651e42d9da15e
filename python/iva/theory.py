"""Steady states of a free mass in its gap that are known in closed form.

Pure functions: nothing is simulated, and no simulation uses them. They are there to hold
simulations against, and to start them from.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from iva import _iva
from iva.forces import Harmonic, fields_of
from iva.parameters import Primary, Siva, Start, number, shown, spec
from iva.spelling import spell_checked

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Any

    from iva.parameters import Spec


@dataclass(frozen=True, slots=True)
class Orbit:
    """One symmetric motion with two impacts a cycle, in the units of the primary system.

    Parameters
    ----------
    speed : float
        Absolute velocity s > 0 of the absorber between impacts.
    phase : float
        Phase of the force (argument of its cosine) at the impact on wall +, in (−π, π] rad.
    displacement : float
        Displacement of the primary at that impact.
    velocity_before : float
        Velocity of the primary just before that impact.
    velocity_after : float
        Velocity of the primary just after it.
    approach_speed : float
        Speed of approach of every impact, 2s(1 + μ)/(1 + e).
    amplitude : float
        Largest |x| of the cycle.
    admissible : bool
        The absorber touches no wall between the impacts (proven, not sampled); otherwise the
        formulas describe no motion.
    multipliers : tuple of complex, length 4
        What a small change of the state is multiplied by in half a cycle, seen in the mirror;
        largest first. Their product is e² exp(−2πζωn/Ω).
    stable : bool
        All multipliers are smaller than 1.
    start : Start
        State from which a run under the given force, with its own phase, stays on the orbit.
    """

    speed: float
    phase: float
    displacement: float
    velocity_before: float
    velocity_after: float
    approach_speed: float
    amplitude: float
    admissible: bool
    multipliers: tuple[complex, complex, complex, complex]
    stable: bool
    start: Start


@dataclass(frozen=True, slots=True)
class MasriCaughey:
    """The symmetric motions with two impacts a cycle of one scene.

    Parameters
    ----------
    amplitude_without_absorber : float
        Largest |x| of the steady vibration of the primary alone.
    largest_clearance : float
        Clearance beyond which there is no such motion; may be infinite.
    orbits : tuple, length 2
        The two motions, that with the larger speed first; ``None`` where there is none.
    """

    amplitude_without_absorber: float
    largest_clearance: float
    orbits: tuple[Orbit | None, Orbit | None]

    @property
    def stable(self) -> Orbit | None:
        """The admissible and stable motion, to which a run may settle; ``None`` without one."""
        found = (orbit for orbit in self.orbits if orbit and orbit.admissible and orbit.stable)
        return next(found, None)


@spell_checked
def masri_caughey(absorber: Siva, primary: Primary, force: Harmonic) -> MasriCaughey:
    """Return the symmetric motions with two impacts a cycle: existence, admissibility, stability.

    Parameters
    ----------
    absorber : Siva
        A free mass; its clearance not relative to a start. An offset of its gap moves the starts.
    primary : Primary
        The primary system, with a damping ratio up to 100.
    force : Harmonic
        Force on the primary, or motion of the base; Ω from 10⁻³ to 10³ ωn.

    Returns
    -------
    MasriCaughey

    Raises
    ------
    TypeError
        If an argument is of the wrong class.
    ValueError
        If a value is missing or out of range, or the answer is not determined: without damping at
        Ω = ωn, ωn/3, ωn/5, …

    Notes
    -----
    S. F. Masri and T. K. Caughey, On the stability of the impact damper, J. Appl. Mech. 33 (1966)
    586–592. Multipliers: exact derivative of the flow, saltation matrix at the impact (P. C.
    Müller, Chaos, Solitons & Fractals 5 (1995) 1671–1681).

    Examples
    --------
    >>> siva = iva.Siva(mass_ratio=0.05, restitution=0.8, clearance=2.0)
    >>> primary = iva.Primary(damping_ratio=0.02)
    >>> force = iva.Harmonic(amplitude=0.1, frequency=1.0)
    >>> orbit = masri_caughey(siva, primary, force).stable
    >>> round(orbit.amplitude, 12)
    0.353285319189
    >>> run = iva.simulate(siva, primary, start=orbit.start, force=force, cycles=30)
    >>> run.summary["regime"].item()
    '2:1'
    """
    scene = checked(absorber, primary)
    if not isinstance(force, Harmonic):
        raise TypeError(f"force = {shown(force)}: give an iva.Harmonic")
    scene["forces"] = [fields_of(force)]
    found = _iva.masri_caughey(scene)
    one, other = (orbit(fields) for fields in found.pop("orbits"))
    return MasriCaughey(**found, orbits=(one, other))


def orbit(fields: dict[str, Any] | None) -> Orbit | None:
    """Return the orbit that the compiled part describes."""
    if fields is None:
        return None
    names = ("displacement", "velocity", "gap_displacement", "gap_velocity")
    state = dict(zip(names, fields["start"], strict=True))
    multipliers = tuple(complex(*parts) for parts in fields["multipliers"])
    return Orbit(**fields | {"multipliers": multipliers, "start": Start(**state)})


@dataclass(frozen=True, slots=True)
class SlowManifold:
    """The slow invariant manifold of a vibro-impact energy sink, to first order in μ.

    Two amplitudes over the clearance d: θ is that of the absolute displacement of the absorber, a
    zigzag of speed (2/π) θ d ωn between the walls (not the angle of a pendulum), ξ that of the
    displacement of the primary. On the manifold ξ² = (θ − 1)² + ρ²θ².

    Parameters
    ----------
    rho : float
        ρ = (2/π)(1 − e)/(1 + e).
    activation : float
        Smallest ξ at which the absorber keeps two impacts a cycle, ρ/√(1 + ρ²).
    activation_amplitude : float
        The same as an amplitude of the primary, ξ d: below it the absorber is not active.
    stable_theta : tuple of float, length 2
        θ of the stable motions: from 1/(1 + ρ²) to π²/(π² − 4), or to where the absorber would
        touch the wall it has just left (for e below about 0.09).
    stable_amplitude : tuple of float, length 2
        ξ at both ends of it.
    largest_added_damping : float
        Largest damping ratio that the absorber adds, (2μ/π)(1 + e)/(1 − e).
    best_amplitude : float
        Amplitude of the primary at which it does, d (2/π)(1 − e)/(1 + e).
    scene : dict
        What it is made of.
    """

    rho: float
    activation: float
    activation_amplitude: float
    stable_theta: tuple[float, float]
    stable_amplitude: tuple[float, float]
    largest_added_damping: float
    best_amplitude: float
    scene: Spec = field(repr=False, hash=False)

    def amplitude(self, theta: float) -> float:
        """Return ξ at a θ."""
        return self._at(theta)[0]

    def added_damping(self, theta: float) -> float:
        """Return the damping ratio that the absorber adds to the primary at a θ."""
        return self._at(theta)[1]

    def admissible(self, theta: float) -> bool:
        """Return whether the absorber touches no wall between its two impacts of a cycle."""
        return self._at(theta)[2]

    def _at(self, theta: float) -> tuple[float, float, bool]:
        theta = number("theta", theta)
        if not 0.0 < theta <= 1e6:
            raise ValueError(f"theta = {theta}: give a number greater than 0, up to 1e6")
        return _iva.on_slow_manifold(self.scene, theta)


@spell_checked
def slow_manifold(absorber: Siva, primary: Primary | None = None) -> SlowManifold:
    """Return the slow invariant manifold: activation threshold, stable range, added damping.

    Parameters
    ----------
    absorber : Siva
        A free mass; its clearance not relative to a start.
    primary : Primary, optional
        The primary system, where masses or millimetres are given.

    Raises
    ------
    TypeError
        If an argument is of the wrong class.
    ValueError
        If a value is missing or out of range.

    Notes
    -----
    O. V. Gendelman, J. Sound Vib. 331 (2012) 4599–4608; E. Gourc, G. Michon, S. Seguy and
    A. Berlioz, J. Vib. Acoust. 137 (2015) 031008. First order in μ, vibration at ωn.

    Examples
    --------
    >>> manifold = slow_manifold(iva.Siva(mass_ratio=0.01, restitution=0.6, clearance=1.0))
    >>> round(manifold.activation_amplitude, 6), round(manifold.largest_added_damping, 6)
    (0.157177, 0.025465)
    """
    made = checked(absorber, Primary() if primary is None else primary)
    return SlowManifold(**_iva.slow_manifold(made), scene=made)


def checked(absorber: object, primary: object) -> Spec:
    """Return the spec of a free mass on its primary system.

    Raises
    ------
    TypeError
        If one is of the wrong class.
    """
    if not isinstance(absorber, Siva):
        raise TypeError(f"absorber = {shown(absorber)}: give an iva.Siva; the theory is of that")
    if not isinstance(primary, Primary):
        raise TypeError(f"primary = {shown(primary)}: give an iva.Primary")
    return spec(absorber, primary)
