"""The paper, reproduced: the study behind every figure and Table 1, and a verdict on every claim.

"Numerical Modelling and Experimental Investigation of a Single and a Compound Pendulum Impact
Dynamic Vibration Absorbers" studies a free mass in a gap (SIVA) and a pendulum between stops
(PIVA). :func:`reproduce` runs the studies behind Figs 3 to 22 and Table 1 (Figs 1 and 2 are
drawings), draws them, and puts each claim of the paper to the model. What the paper does not give
is named in :class:`Assumptions`, and can be changed.

Needs matplotlib and SciPy: ``pip install 'iva-dynamics[paper]'``.

Examples
--------
>>> report = iva.paper.reproduce("fig5")
>>> report.items["fig5"].parameters
'μ = 0.15, γ = 0.6, e = 0.5, ζ = 0.01'
"""

from iva.paper.needs import require

require()

from iva.paper.assumptions import Assumptions  # noqa: E402 (nothing below works without them)
from iva.paper.reproducing import Report, reproduce  # noqa: E402
from iva.paper.verdicts import Finding, Verdict, View  # noqa: E402

__all__ = ["Assumptions", "Finding", "Report", "Verdict", "View", "reproduce"]
