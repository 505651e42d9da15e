"""Reference simulator for impact vibration absorbers.

Single runs with :func:`simulate`, grids with :func:`sweep`, folders that the command ``iva`` wrote
with :func:`read`. Results are polars frames; polars is loaded with the first of them. NumPy arrays
are welcome wherever a sequence of numbers is, but nothing here loads NumPy.

Examples
--------
>>> import iva
>>> run = iva.simulate(
...     iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5),
...     iva.Primary(damping_ratio=0.01),
...     start=iva.Start(displacement=1.0),
...     periods=30,
... )
>>> run.summary["outcome"].item()
'finished'
>>> round(run.impacts["time"][0], 6)
1.164243
"""

from iva._iva import SCHEMA_VERSION, VERSION, IvaError
from iva.parameters import Primary, Siva, Start
from iva.reading import read
from iva.simulation import Run, simulate
from iva.sweeping import Table, sweep
from iva.units import Units
from iva.versions import show_versions

__version__ = VERSION

__all__ = [
    "SCHEMA_VERSION",
    "IvaError",
    "Primary",
    "Run",
    "Siva",
    "Start",
    "Table",
    "Units",
    "__version__",
    "read",
    "show_versions",
    "simulate",
    "sweep",
]
