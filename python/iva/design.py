"""The numbers of a scene, whatever alternatives they were given by."""

from __future__ import annotations

from dataclasses import dataclass

from iva import _iva
from iva.simulation import Run


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
    spring_frequency: float
    small: bool

    @property
    def lever(self) -> float:
        """L/b: velocity of the centre of mass per gap velocity."""
        if self.length is None or self.contact_distance is None:
            return 1.0
        return self.length / self.contact_distance


@dataclass(frozen=True, slots=True)
class Design:
    """The numbers of a scene, in the units of its run; M = 1 where no mass is given.

    Of several absorbers, of which there are so many, they are those of one. Without absorber
    `mass_ratio`, `clearance` and `pendulum` are ``None``. The stops are at
    `gap_offset` ± `clearance`. `gravity_along` is that part of gravity which acts along the motion
    of a free mass, 0 where that is level. `friction` is the force m k g cos α on a mass that rubs,
    of a pendulum the moment in its pivot over the contact distance; `spring` and `gap_damping` are
    the constants k and c of the spring and of the dashpot between a free mass and its structure; 0
    without.
    """

    absorbers: int
    mass: float
    natural_frequency: float
    damping_ratio: float
    mass_ratio: float | None
    clearance: float | None
    gap_offset: float
    gravity_along: float
    friction: float
    spring: float
    gap_damping: float
    pendulum: Pendulum | None

    @property
    def lever(self) -> float:
        """Velocity of the absorber's centre of mass per gap velocity."""
        return 1.0 if self.pendulum is None else self.pendulum.lever


def design_of(run: Run, absorber: int = 0) -> Design:
    """Return the numbers of a run's scene, of several absorbers with those of one."""
    numbers = _iva.design(run._spec, absorber)
    pendulum = numbers.pop("pendulum")
    return Design(**numbers, pendulum=None if pendulum is None else Pendulum(**pendulum))
