"""What the paper leaves open, and what is assumed in its place."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Literal

from iva.parameters import number, shown
from iva.spelling import spell_checked


@spell_checked
@dataclass(frozen=True, kw_only=True, slots=True)
class Assumptions:
    """Parameters that the paper does not give, all dimensionless: M = ωn = x₀ = 1.

    Parameters
    ----------
    damping_ratio : float, default 0.01
        ζ of the structure without absorber, Figs 3 to 18.
    restitution : float, default 0.5
        e where a figure does not say it: Figs 3, 6, 7, 15, 16, 18, and the rig of Figs 19 to 22 in
        the counterpart that is not fitted. The paper recommends 0.5.
    mass_ratio : float, default 0.1
        μ where a figure does not say it: Figs 8, 9, 15, 16, 18. The paper recommends 0.1.
    frequency_ratio : float, default 0.4
        r of the pendulum where a figure does not say it: Figs 15, 17, 19 to 22, Table 1.
    relative_clearance : float, default 1.4
        γ of the pendulum where a figure does not say it: Figs 12 to 14, 16, 17.
    gravity : float, default 10.0
        g/(x₀ ωn²): how small the angles are. It fixes the length, L/x₀ = g/(x₀ ωn² r²).
    rig_damping_ratio : float, default 0.014
        ζ of the test rig, Figs 19 to 22, in the counterpart that is not fitted to Table 1.
    impact_law : {"consistent", "printed"}, default "consistent"
        Momentum and restitution, or the pendulum's Eqs. 16 and 17 as printed.

    Raises
    ------
    TypeError, ValueError
        If a value is of the wrong type or out of range.
    """

    damping_ratio: float = 0.01
    restitution: float = 0.5
    mass_ratio: float = 0.1
    frequency_ratio: float = 0.4
    relative_clearance: float = 1.4
    gravity: float = 10.0
    rig_damping_ratio: float = 0.014
    impact_law: Literal["consistent", "printed"] = "consistent"

    def __post_init__(self) -> None:
        """Check each value."""
        for name, (low, high) in RANGES.items():
            value = number(name, getattr(self, name))
            if not low <= value <= high:
                raise ValueError(f"{name} = {value}: give a number from {low:g} to {high:g}")
            object.__setattr__(self, name, value)
        if self.impact_law not in ("consistent", "printed"):
            raise ValueError(
                f"impact_law = {shown(self.impact_law)}: give 'consistent' or 'printed'"
            )

    @property
    def dampings(self) -> tuple[float, float, float]:
        """Three dampings of the structure, where a claim may hang on it."""
        zeta = self.damping_ratio
        return (0.5 * zeta, zeta, 2.0 * zeta) if zeta > 0.0 else (0.0, 0.005, 0.01)


#: What each number may be: where the figures still show something.
RANGES = {
    "damping_ratio": (0.0, 0.2),
    "restitution": (0.0, 1.0),
    "mass_ratio": (1e-4, 1.0),
    "frequency_ratio": (0.01, 2.0),
    "relative_clearance": (0.05, 5.0),
    "gravity": (0.1, 1e6),
    "rig_damping_ratio": (0.0, 0.2),
}

#: A line on each for the report and the command line.
MEANINGS = {
    "damping_ratio": "ζ of the structure without absorber",
    "restitution": "coefficient of restitution e where a figure does not say it",
    "mass_ratio": "mass ratio μ where a figure does not say it",
    "frequency_ratio": "frequency ratio r = ωp/ωn of the pendulum where a figure does not say it",
    "relative_clearance": "relative clearance γ of the pendulum where a figure does not say it",
    "gravity": "g/(x₀ ωn²); it fixes the length of the pendulum, L/x₀ = g/(x₀ ωn² r²)",
    "rig_damping_ratio": "ζ of the test rig of Figs 19 to 22",
    "impact_law": "the pendulum's law of impact: consistent, or Eqs. 16 and 17 as printed",
}


def listed(assumptions: Assumptions) -> list[tuple[str, Any, str]]:
    """Return name, value and meaning of each assumption."""
    return [
        (field.name, getattr(assumptions, field.name), MEANINGS[field.name])
        for field in fields(assumptions)
    ]
