"""Pictures of runs and sweeps, with matplotlib.

Each function takes a run or the tables of a sweep and, as ``ax=…``, axes to draw on; without them
it makes its own, one column wide (:func:`style`). It returns the axes, so that everything can be
changed afterwards. Every axis has its symbol and unit; colours are those of Okabe and Ito, which
everybody can tell apart. The wall + is vermillion and the wall − is blue in every picture.

Data coordinates are those of the tables, in SI units where those are. Tick labels and units of axes
may have a prefix: lengths are in mm where they were given in mm or are all smaller than 0.1 m;
m/s, m/s², J, N, N s and N/m have one where everything is smaller than 0.01, and all have one from
10 000 on. ``axes.set_ylim(-0.005, 0.005)`` ends an axis of displacements at 5 mm, whether it is
labelled in m or in mm. Where lengths have no unit of their own, axes say "unit of length": that in
which the scene gives its lengths, the clearance among them.

Needs matplotlib: ``pip install 'iva-dynamics[plots]'``.

Examples
--------
>>> import matplotlib.pyplot as plt
>>> run = iva.simulate(
...     iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5),
...     iva.Primary(damping_ratio=0.01),
...     start=iva.Start(displacement=1.0),
...     periods=6,
... )
>>> with iva.plots.style():
...     figure, (above, below) = plt.subplots(2, figsize=(3.35, 4.0), layout="constrained")
...     above = iva.plots.decay(run, ax=above)
...     below = iva.plots.energy(run, ax=below)
>>> below.get_ylabel()
'energy E/E(0)'
>>> plt.close(figure)
"""

try:
    import matplotlib as _matplotlib  # noqa: F401 (only whether it is there)
except ModuleNotFoundError as _missing:
    if _missing.name != "matplotlib":
        raise
    raise ImportError("iva.plots needs matplotlib: pip install 'iva-dynamics[plots]'") from None

from iva.plots.bifurcations import branch, multipliers, stability_chart
from iva.plots.designs import design
from iva.plots.energy_split import energy
from iva.plots.fits import fit
from iva.plots.frequency_response import forced_response
from iva.plots.histories import accelerations, decay, velocities
from iva.plots.impact_raster import raster
from iva.plots.maps import heatmap
from iva.plots.moving_pictures import animate, animation
from iva.plots.parameter_curves import curves
from iva.plots.phase_plane import phase
from iva.plots.slow_manifolds import slow_manifold
from iva.plots.steady_states import basins, diagram, section
from iva.plots.styles import style

__all__ = [
    "accelerations",
    "animate",
    "animation",
    "basins",
    "branch",
    "curves",
    "decay",
    "design",
    "diagram",
    "energy",
    "fit",
    "forced_response",
    "heatmap",
    "multipliers",
    "phase",
    "raster",
    "section",
    "slow_manifold",
    "stability_chart",
    "style",
    "velocities",
]
