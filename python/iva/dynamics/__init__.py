"""Periodic orbits of a driven absorber: where they are, whether they last, and how they change.

A run shows what a scene settles on from one start. :func:`orbit` finds the periodic motion itself,
stable or not, by Newton's method with the exact derivative of the motion, and tells its Floquet
multipliers. :func:`follow` follows it over any number of the scene and locates the special points
on the way: folds, pitchforks, flips, Neimark–Sacker points, grazings. :meth:`Branch.switch` follows
the branch that begins at a pitchfork, a flip, a grazing or where an impact vanishes, and
:func:`curve` follows the point over two numbers.

What a machine does is told by :func:`diagram`, which follows steady states up and down,
:func:`attractors`, which finds all that many starts end in, :func:`basins`, which start ends where,
:func:`lyapunov`, whether neighbouring motions separate, :func:`regimes`, what kinds of motion there
are, and :func:`section`, which shows a run at instants that repeat.

Examples
--------
>>> siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5)
>>> primary = iva.Primary(damping_ratio=0.05)
>>> force = iva.Harmonic(amplitude=1.0, frequency=1.0)
>>> found = orbit(siva, primary, force=force, start=(0, 0, 0, 0.1), settle=200)
>>> branch = follow(found, over="clearance", between=(4.0, 7.0))
>>> [point.kind for point in branch.points]
['pitchfork', 'neimark_sacker']
>>> branch.switch(0).points[0].kind
'flip'
"""

from iva.dynamics.basin_maps import Basins, basins
from iva.dynamics.branches import Branch, Point, Row, follow
from iva.dynamics.curves import Curve, curve
from iva.dynamics.diagrams import Diagram, Outcome, diagram
from iva.dynamics.exponents import Spectrum, lyapunov
from iva.dynamics.inventories import Attractor, Attractors, attractors
from iva.dynamics.kinds import Regime, regimes
from iva.dynamics.orbits import Episode, Impact, Missed, Orbit
from iva.dynamics.search import orbit
from iva.dynamics.sections import section

__all__ = [
    "Attractor",
    "Attractors",
    "Basins",
    "Branch",
    "Curve",
    "Diagram",
    "Episode",
    "Impact",
    "Missed",
    "Orbit",
    "Outcome",
    "Point",
    "Regime",
    "Row",
    "Spectrum",
    "attractors",
    "basins",
    "curve",
    "diagram",
    "follow",
    "lyapunov",
    "orbit",
    "regimes",
    "section",
]
