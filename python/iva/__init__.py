"""Reference simulator for impact vibration absorbers.

Single runs with :func:`simulate`, grids with :func:`sweep`, folders that the command ``iva`` wrote
with :func:`read`. Results are polars frames; polars is loaded with the first of them. NumPy arrays
are welcome wherever a sequence of numbers is; NumPy is loaded only by who asks for the points of a
:class:`Recorded` force.

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

from iva.processor import require as _require

_require()

# What type checkers call typing.TYPE_CHECKING: typing itself takes 2 ms to import.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from iva import dynamics, examples, sampling, theory
    from iva import paper as paper
    from iva import plots as plots
    from iva._iva import SCHEMA_VERSION, VERSION, IvaError
    from iva.choosing import best, pareto, robust
    from iva.explorer import explore
    from iva.forces import Harmonic, Impulse, Recorded
    from iva.identification import Fit, identify
    from iva.measured import Measured
    from iva.optimisation import Optimum, optimise
    from iva.parameters import Piva, Primary, Siva, Start, Stop
    from iva.reading import read
    from iva.run_tables import Gradient, Verification
    from iva.scanning import Scan, scan
    from iva.simulation import Run, simulate
    from iva.structures import Structure
    from iva.sweeping import sweep
    from iva.tables import Table
    from iva.units import Units
    from iva.versions import show_versions

    __version__ = VERSION

__all__ = [
    "SCHEMA_VERSION",
    "Fit",
    "Gradient",
    "Harmonic",
    "Impulse",
    "IvaError",
    "Measured",
    "Optimum",
    "Piva",
    "Primary",
    "Recorded",
    "Run",
    "Scan",
    "Siva",
    "Start",
    "Stop",
    "Structure",
    "Table",
    "Units",
    "Verification",
    "__version__",
    "best",
    "dynamics",
    "examples",
    "explore",
    "identify",
    "optimise",
    "pareto",
    "read",
    "robust",
    "sampling",
    "scan",
    "show_versions",
    "simulate",
    "sweep",
    "theory",
]

# Where each name is defined. It is imported when first asked for, so that the command ``iva``,
# which needs none of them, starts at once. ``paper`` and ``plots`` are not in `__all__`: they need
# matplotlib, and ``from iva import *`` must work without.
_HOMES = {
    "SCHEMA_VERSION": "_iva",
    "Fit": "identification",
    "Gradient": "run_tables",
    "Harmonic": "forces",
    "Impulse": "forces",
    "IvaError": "_iva",
    "Measured": "measured",
    "Optimum": "optimisation",
    "Piva": "parameters",
    "Primary": "parameters",
    "Recorded": "forces",
    "Run": "simulation",
    "Scan": "scanning",
    "Siva": "parameters",
    "Start": "parameters",
    "Stop": "parameters",
    "Structure": "structures",
    "Table": "tables",
    "Units": "units",
    "Verification": "run_tables",
    "__version__": "_iva",
    "best": "choosing",
    "dynamics": "dynamics",
    "examples": "examples",
    "explore": "explorer",
    "identify": "identification",
    "optimise": "optimisation",
    "paper": "paper",
    "pareto": "choosing",
    "plots": "plots",
    "read": "reading",
    "robust": "choosing",
    "sampling": "sampling",
    "scan": "scanning",
    "show_versions": "versions",
    "simulate": "simulation",
    "sweep": "sweeping",
    "theory": "theory",
}

if not TYPE_CHECKING:  # checkers would believe in every name

    def __getattr__(name: str) -> object:
        """Import a public name and keep it."""
        home = _HOMES.get(name)
        if home is None:
            said = f"module {__name__!r} has no attribute {name!r}"
            if not name.startswith("_"):
                from iva.spelling import hint

                said += hint(name, _HOMES)
            raise AttributeError(said)
        from importlib import import_module

        module = import_module(f"{__name__}.{home}")
        if name == home:
            return module
        value = getattr(module, "VERSION" if name == "__version__" else name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    """Return the names that are there and those that can be imported."""
    return sorted({*globals(), *_HOMES})
