"""Coordinates along the valleys that a record with few impacts leaves open.

The first impact fixes two combinations of the absorber's numbers sharply and nothing else: where
its wall is, s d = x₀ + y₀ − x(t₁), and Δv₁ (1 + 1/μ) = (1 + e) w₁. A sampler that draws d, y₀, μ
and e apart would have to find a valley as thin as the noise. So one number of each pair is computed
from the other one and from how far the condition is missed, in deviations.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iva.identification.priors import Exactly, Prior
from iva.identification.responses import Values
from iva.identification.walls import Contacts

#: How many deviations the first conditions may be missed by.
MISSED = 7.0


@dataclass(frozen=True)
class Valleys:
    """The map of a cube to absorbers, and the density of the prior in the cube.

    Parameters
    ----------
    found : Contacts
        Of the impacts that count.
    mass_ratio, clearance, restitution, scatter, play : Prior
        Of these numbers.
    place : Prior or None
        Of the gap displacement; ``None``: anywhere between the walls.
    """

    found: Contacts
    mass_ratio: Prior
    clearance: Prior
    restitution: Prior
    place: Prior | None
    scatter: Prior
    play: Prior

    @property
    def size(self) -> int:
        """Number of coordinates: six, less those of numbers that are set."""
        each = (self.mass_ratio, self.clearance, self.place, self.restitution)
        return 6 - sum(isinstance(one, Exactly) for one in each)

    def at(self, cube: Values) -> tuple[Values, float]:
        """Return 1/μ, d, y₀, e, scatter, play, and the logarithm of the prior's density here.

        Parameters
        ----------
        cube : ndarray, shape (size,)
            Each from 0 to 1.
        """
        shares = iter(cube)
        scatter, play = self.scatter.at(next(shares)), self.play.at(next(shares))
        hits = self.found.walls.size
        wall, reached, speed, jump = (
            self.found.walls[0],
            self.found.values[0, 0],
            self.found.values[3, 0],
            self.found.values[4, 0],
        )
        variances = self.found.blocks[::6, :: hits + 1][:, 0]  # of the first impact, by value
        weight = 0.0

        open_place = not isinstance(self.place, Exactly)
        open_wall = not isinstance(self.clearance, Exactly)
        blur = np.sqrt(variances[0] + (play * abs(reached)) ** 2)
        if open_place:
            clearance = self.clearance.at(next(shares) if open_wall else 0.5)
            off = MISSED * (2 * next(shares) - 1) * blur
            place = wall * clearance - reached + off
            if self.place is None:
                weight += -np.log(2 * clearance) if abs(place) <= clearance else -np.inf
            else:
                weight += self.place.log_density(place)
            weight += np.log(2 * MISSED * blur)
        else:
            assert self.place is not None
            place = self.place.at(0.5)
            clearance = self.clearance.at(0.5)
            if open_wall:
                off = MISSED * (2 * next(shares) - 1) * blur
                clearance = wall * (reached + place - off)
                weight += self.clearance.log_density(clearance) + np.log(2 * MISSED * blur)

        open_mass = not isinstance(self.mass_ratio, Exactly)
        open_law = not isinstance(self.restitution, Exactly)
        noise = variances[4] / jump**2 + variances[3] / speed**2
        if open_mass:
            e = self.restitution.at(next(shares) if open_law else 0.5)
            blur = np.sqrt((scatter * e) ** 2 + (1 + e) ** 2 * noise)
            own = e + MISSED * (2 * next(shares) - 1) * blur
            nu = (1 + own) * speed / jump - 1
            if nu <= 0:
                return np.zeros(6), -np.inf
            weight += self.mass_ratio.log_density(1 / nu) - 2 * np.log(nu)
            weight += np.log(2 * MISSED * blur * abs(speed / jump))
        else:
            nu = 1 / self.mass_ratio.at(0.5)
            e = self.restitution.at(0.5)
            if open_law:
                own = jump * (1 + nu) / speed - 1
                blur = np.sqrt((scatter * own) ** 2 + (1 + own) ** 2 * noise)
                e = own + MISSED * (2 * next(shares) - 1) * blur
                weight += self.restitution.log_density(e) + np.log(2 * MISSED * blur)
        if abs(place) > clearance:
            weight = -np.inf
        return np.array([nu, clearance, place, e, scatter, play]), float(weight)


__all__ = ["Valleys"]
