"""The numbers of a scene, whatever alternatives they were given by."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from iva import _iva
from iva.simulation import Run

Numbers = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Pendulum:
    """A pendulum, in the units of the run; of a free mass there is none.

    `length` is ``None`` where angles are small and only its frequency is known; then it drops out.
    `inclination` is the angle in rad by which the line rises on which the pivot moves.
    """

    length: float | None
    contact_distance: float | None
    inertia_ratio: float
    frequency: float
    damping_ratio: float
    spring_frequency: float
    inclination: float
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
    `gap_offset` ± `clearance`; `walls` says whether there is one at − and one at +. A stop on the
    ground has a `mass_ratio` of 0. `gravity_along` is that part of gravity which acts along the
    motion of a free mass, 0 where that is level. `friction` is the force m k g cos α on a mass that
    rubs, of a pendulum the moment in its pivot over the contact distance; `spring` and
    `gap_damping` are the constants k and c of the spring and of the dashpot between a free mass and
    its structure; 0 without.
    """

    absorbers: int
    mass: float
    natural_frequency: float
    damping_ratio: float
    mass_ratio: float | None
    clearance: float | None
    gap_offset: float
    walls: tuple[bool, bool]
    gravity_along: float
    friction: float
    spring: float
    gap_damping: float
    pendulum: Pendulum | None

    def beside(self, motion: Mapping[str, Numbers]) -> tuple[Numbers, Numbers]:
        """Return how far the centre of mass has gone along the line of the structure, and how fast.

        Both are relative to the structure, in a motion with the columns of a trajectory: of a stop
        on the ground they are those of the ground.
        """
        y, w = (motion[name] for name in ("gap_displacement", "gap_velocity"))
        if self.mass_ratio == 0.0:
            return -y, -w
        pendulum = self.pendulum
        if pendulum is None or pendulum.inclination == 0.0 or pendulum.length is None:
            lever = 1.0 if pendulum is None else pendulum.lever
            return lever * y, lever * w
        angle, length = motion["angle"] - pendulum.inclination, pendulum.length
        aside = length * (np.sin(angle) + np.sin(pendulum.inclination))
        return aside, length * np.cos(angle) * motion["angular_velocity"]


def design_of(run: Run, absorber: int = 0) -> Design:
    """Return the numbers of a run's scene, of several absorbers with those of one."""
    numbers = _iva.design(run._spec, absorber)
    pendulum = numbers.pop("pendulum")
    return Design(**numbers, pendulum=None if pendulum is None else Pendulum(**pendulum))
