"""The numbers of a scene, whatever alternatives they were given by."""

from __future__ import annotations

import math
from dataclasses import dataclass

from iva.parameters import Piva, Primary
from iva.simulation import Run

#: In SI units, where nothing else is given: that of the compiled part.
STANDARD_GRAVITY = 9.80665


@dataclass(frozen=True, slots=True)
class Pendulum:
    """A pendulum, in the units of the run; of a free mass there is none.

    `length` is ``None`` where angles are small and only its frequency is known; then it drops out.
    """

    length: float | None
    contact_distance: float | None
    inertia_ratio: float
    frequency: float
    damping_ratio: float
    small: bool

    @property
    def lever(self) -> float:
        """L/b: velocity of the centre of mass per gap velocity."""
        if self.length is None or self.contact_distance is None:
            return 1.0
        return self.length / self.contact_distance


@dataclass(frozen=True, slots=True)
class Design:
    """The numbers of a scene, in the units of its run; M = 1 where no mass is given."""

    mass: float
    natural_frequency: float
    damping_ratio: float
    mass_ratio: float
    clearance: float
    pendulum: Pendulum | None

    @property
    def lever(self) -> float:
        """Velocity of the absorber's centre of mass per gap velocity."""
        return 1.0 if self.pendulum is None else self.pendulum.lever


def design_of(run: Run) -> Design:
    """Return the numbers of a run's scene."""
    absorber, primary = run.absorber, run.primary
    mass = 1.0 if primary.mass is None else primary.mass
    natural_frequency = frequency_of(primary, mass)
    damping_ratio = primary.damping_ratio or 0.0
    if primary.damping is not None:
        damping_ratio = primary.damping / (2.0 * mass * natural_frequency)
    mass_ratio = absorber.mass_ratio
    if mass_ratio is None:
        assert absorber.mass is not None
        mass_ratio = absorber.mass / mass
    pendulum = None
    if isinstance(absorber, Piva):
        pendulum = pendulum_of(absorber, natural_frequency)
    return Design(mass, natural_frequency, damping_ratio, mass_ratio, clearance_of(run), pendulum)


def frequency_of(primary: Primary, mass: float) -> float:
    """Return ωn of the bare structure."""
    if primary.natural_frequency is not None:
        return primary.natural_frequency
    if primary.frequency_hz is not None:
        return 2.0 * math.pi * primary.frequency_hz
    if primary.stiffness is not None:
        return math.sqrt(primary.stiffness / mass)
    return 1.0


def clearance_of(run: Run) -> float:
    """Return the one-sided clearance d of a run."""
    absorber, start = run.absorber, run.start
    if absorber.clearance is not None:
        return absorber.clearance
    if absorber.clearance_mm is not None:
        return absorber.clearance_mm / 1e3
    if absorber.gap is not None:
        return absorber.gap / 2.0
    if absorber.gap_mm is not None:
        return absorber.gap_mm / 2e3
    displacement = start.displacement or (start.displacement_mm or 0.0) / 1e3
    assert absorber.relative_clearance is not None
    return absorber.relative_clearance * abs(displacement)


def pendulum_of(absorber: Piva, natural_frequency: float) -> Pendulum:
    """Return the pendulum: two of length, gravity and frequency give the third."""
    inertia_ratio = absorber.inertia_ratio or 1.0
    length, gravity, ratio = absorber.length, absorber.gravity, absorber.frequency_ratio
    if ratio is None:
        assert length is not None
        frequency = math.sqrt((gravity or STANDARD_GRAVITY) / (inertia_ratio * length))
    else:
        frequency = ratio * natural_frequency
        if length is None and gravity is not None:
            length = gravity / (inertia_ratio * frequency**2)
    return Pendulum(
        length=length,
        contact_distance=length if absorber.contact_distance is None else absorber.contact_distance,
        inertia_ratio=inertia_ratio,
        frequency=frequency,
        damping_ratio=absorber.pivot_damping_ratio or 0.0,
        small=absorber.angles == "small",
    )
