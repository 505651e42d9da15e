"""From a map to a decision: a design that holds although much is not known exactly.

:func:`iva.optimise` asks: what may be chosen (:mod:`~iva.optimisation.choices`), what is not known
exactly (:mod:`~iva.optimisation.cases`), and by which number a design is judged
(:mod:`~iva.optimisation.criteria`); all together are a :class:`~iva.optimisation.problem.Problem`.
:mod:`~iva.optimisation.stages` has the way to an answer: a first look and a search
(:mod:`~iva.optimisation.search`), a race (:mod:`~iva.optimisation.race`), and a judgement by fresh
cases, of the best and of the plateau around it (:mod:`~iva.optimisation.plateau`). Whatever is run
goes through one :class:`~iva.optimisation.evaluation.Evaluation`.

Examples
--------
The clearance with which a tenth of the mass damps the first three cycles best, as made to 5 %:

>>> found = iva.optimise(
...     iva.Siva(mass_ratio=0.1, restitution=0.6), iva.Primary(damping_ratio=0.01),
...     choose={"relative_clearance": (0.2, 1.2)}, off={"relative_clearance": "5%"},
...     maximise="damping_ratio_3", start=iva.Start(displacement=1.0), periods=20, runs=2000)
>>> low, high = found.tolerance["relative_clearance"]
>>> low <= found.best["relative_clearance"] <= high
True
"""

from iva.optimisation.optimising import optimise
from iva.optimisation.optimum import Optimum

__all__ = ["Optimum", "optimise"]
