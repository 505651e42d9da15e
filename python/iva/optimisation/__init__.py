"""From a map to a decision: a design that holds although much is not known exactly.

:func:`iva.optimise` asks: what may be chosen (:mod:`~iva.optimisation.choices`), what is not known
exactly (:mod:`~iva.optimisation.cases`), and by which number a design is judged
(:mod:`~iva.optimisation.criteria`); all together are a :class:`~iva.optimisation.problem.Problem`.
:mod:`~iva.optimisation.stages` has the way to an answer: a first look and a search
(:mod:`~iva.optimisation.search`), a race (:mod:`~iva.optimisation.race`), and a judgement by fresh
cases, of the best and of the plateau around it (:mod:`~iva.optimisation.plateau`). Whatever is run
goes through one :class:`~iva.optimisation.evaluation.Evaluation`.
"""

from iva.optimisation.optimising import optimise
from iva.optimisation.optimum import Optimum

__all__ = ["Optimum", "optimise"]
