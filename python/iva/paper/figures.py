"""The list of what can be reproduced."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from iva.paper import comparison, piva_curves, piva_decays, rig, siva_curves, siva_decays, table1
from iva.paper.assumptions import Assumptions
from iva.paper.made import Made


@dataclass(frozen=True, slots=True)
class Item:
    """A figure or table of the paper: its name, what it is, and the study behind it."""

    name: str
    title: str
    study: Callable[[Assumptions], Made]


#: Figs 1 and 2 are drawings of the model and the rig.
ITEMS = (
    Item("fig3", "Decay with the free mass at three clearances", siva_decays.fig3),
    Item("fig4", "Velocities in a small gap", siva_decays.fig4),
    Item("fig5", "Velocities in a middle gap", siva_decays.fig5),
    Item("fig6", "Number of impacts over the clearance, by mass ratio", siva_curves.fig6),
    Item("fig7", "Damping over the clearance, by mass ratio", siva_curves.fig7),
    Item("fig8", "Number of impacts over the clearance, by restitution", siva_curves.fig8),
    Item("fig9", "Damping over the clearance, by restitution", siva_curves.fig9),
    Item("fig10", "Phase plane with e = 0.5", siva_decays.fig10),
    Item("fig11", "Phase plane with e = 0.9", siva_decays.fig11),
    Item("fig12", "Decay with a long and a short pendulum", piva_decays.fig12),
    Item("fig13", "Phase plane with the long pendulum", piva_decays.fig13),
    Item("fig14", "Phase plane with the short pendulum", piva_decays.fig14),
    Item("fig15", "Damping over the clearance of the pendulum", piva_curves.fig15),
    Item("fig16", "Damping over the frequency of the pendulum", piva_curves.fig16),
    Item("fig17", "Damping over the mass ratio of the pendulum", piva_curves.fig17),
    Item("fig18", "Free mass against pendulum", comparison.fig18),
    Item("fig19", "Rig at γ = 1, by mass ratio", rig.fig19),
    Item("fig20", "Rig at γ = 1.4, by mass ratio", rig.fig20),
    Item("fig21", "Rig at μ = 0.12, by clearance", rig.fig21),
    Item("fig22", "Rig at μ = 0.02, by clearance", rig.fig22),
    Item("table1", "Damping ratios by experiment and simulation", table1.table1),
)
