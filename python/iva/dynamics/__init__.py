"""Periodic orbits of a driven absorber: where they are, whether they last, and how they change.

A run shows what a scene settles on from one start. :func:`orbit` finds the periodic motion itself,
stable or not, by Newton's method with the exact derivative of the motion, and tells its Floquet
multipliers. :func:`follow` follows it over any number of the scene and locates the special points
on the way: folds, pitchforks, flips, Neimark–Sacker points, grazings. From each the branch that
begins there is followed in turn, and :func:`curve` follows the point over two numbers.
"""

from iva.dynamics.branches import Branch, Point, Row, follow
from iva.dynamics.curves import Curve, curve
from iva.dynamics.orbits import Episode, Impact, Missed, Orbit
from iva.dynamics.search import orbit

__all__ = [
    "Branch",
    "Curve",
    "Episode",
    "Impact",
    "Missed",
    "Orbit",
    "Point",
    "Row",
    "curve",
    "follow",
    "orbit",
]
