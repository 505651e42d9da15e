"""Periodic orbits of a driven absorber: where they are, whether they last, and what they are like.

A run shows what a scene settles on from one start. :func:`orbit` finds the periodic motion itself,
stable or not, by Newton's method with the exact derivative of the motion, and tells its Floquet
multipliers.
"""

from iva.dynamics.orbits import Episode, Impact, Missed, Orbit
from iva.dynamics.search import orbit

__all__ = ["Episode", "Impact", "Missed", "Orbit", "orbit"]
