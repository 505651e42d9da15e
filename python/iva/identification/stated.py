"""What the user knows, sorted by the number that it is about."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from iva.identification.priors import Exactly, Prior, prior_of
from iva.parameters import Piva, Primary, Siva, Start, given, shown
from iva.spelling import hint

#: Field → number, and the factor that brings it to SI units of that number.
FIELDS = {
    "frequency_hz": ("frequency_hz", 1.0),
    "natural_frequency": ("frequency_hz", 1 / (2 * np.pi)),
    "damping_ratio": ("damping_ratio", 1.0),
    "mass_ratio": ("mass_ratio", 1.0),
    "restitution": ("restitution", 1.0),
    "gap": ("gap", 1.0),
    "gap_mm": ("gap", 1e-3),
    "clearance": ("gap", 2.0),
    "clearance_mm": ("gap", 2e-3),
    "frequency_ratio": ("frequency_ratio", 1.0),
    "displacement": ("displacement", 1.0),
    "displacement_mm": ("displacement", 1e-3),
    "impulse_velocity": ("impulse_velocity", 1.0),
    "gap_displacement": ("gap_displacement", 1.0),
    "gap_displacement_mm": ("gap_displacement", 1e-3),
    "time": ("release", 1.0),
    "release_s": ("release", 1.0),
}
#: Bounds of each number in SI units.
BOUNDS = {
    "frequency_hz": (1e-6, np.inf),
    "damping_ratio": (0.0, 0.9),
    "mass_ratio": (1e-6, np.inf),
    "restitution": (0.0, 1.0),
    "gap": (1e-9, np.inf),
    "frequency_ratio": (1e-6, np.inf),
    "displacement": (-np.inf, np.inf),
    "impulse_velocity": (-np.inf, np.inf),
    "gap_displacement": (-np.inf, np.inf),
    "release": (-np.inf, np.inf),
}
#: Fields that change neither the motion nor what is fitted.
IDLE = {"contact_time", "contact_stiffness", "reference"}
#: Fields that may be set because the fit takes them as they are.
TAKEN = {"length", "gravity", "gap_velocity", "inertia_ratio", "contact_distance"}
#: Fields that must be zero where they are set.
ZERO = {"velocity", "inclination", "inclination_deg", "gap_offset", "gap_offset_mm"}


@dataclass(frozen=True)
class Stated:
    """Priors by number, exact values among them, and settings that are taken as they are."""

    priors: dict[str, Prior]
    taken: dict[str, float] = field(default_factory=dict)

    def exactly(self, name: str) -> float | None:
        """Return the value of a number that is set."""
        prior = self.priors.get(name)
        return prior.value if isinstance(prior, Exactly) else None

    @property
    def blow(self) -> bool:
        """Whether the structure is set in motion by a blow, from rest, and not let go."""
        return "impulse_velocity" in self.priors


def stated(
    absorber: Siva | Piva | None, primary: Primary, start: Start, known: Mapping[str, object] | None
) -> Stated:
    """Return what is known of each number.

    Raises
    ------
    TypeError
        If `known` is no mapping from names to distributions.
    ValueError
        If a field is set that cannot be fitted around, or a number is known twice.
    """
    priors: dict[str, Prior] = {}
    taken: dict[str, float] = {}
    masses: dict[str, float] = {}
    for part in (absorber, primary, start):
        if part is None:
            continue
        for name, value in given(part).items():
            path = f"{part._part}.{name}"
            if name in ("mass", "stiffness", "impulse"):
                masses[path] = value
            elif name in FIELDS:
                number, factor = FIELDS[name]
                priors[number] = Exactly(value * factor)
            elif name in TAKEN:
                taken[name] = value
            elif name in ZERO and value != 0:
                raise ValueError(f"{path} = {value!r}: it must be 0 in a decay that is identified")
            elif name not in IDLE and name not in ZERO:
                raise ValueError(f"{path} = {value!r}: leave it out, it is not identified with it")
    weighed(masses, priors)
    if known is not None and not isinstance(known, Mapping):
        raise TypeError(f"known = {shown(known)}: give a mapping from field names to distributions")
    for key, distribution in (known or {}).items():
        name = str(key).rpartition(".")[2]
        if name not in FIELDS:
            rule = hint(name, FIELDS) or f"; give some of {', '.join(FIELDS)}"
            raise ValueError(f"known[{shown(key)}]: there is no such number{rule}")
        number, factor = FIELDS[name]
        if number in priors:
            raise ValueError(f"known[{shown(key)}]: this number is set already; leave out one")
        priors[number] = prior_of(name, distribution, factor, *BOUNDS[number])  # type: ignore[arg-type]
    if "impulse_velocity" in priors:
        if "displacement" in priors:
            raise ValueError(
                "start.displacement: a structure that is set in motion by a blow is at rest at 0 "
                "before; leave it out"
            )
        if not isinstance(absorber, Siva):
            raise ValueError(
                "start.impulse_velocity: a start by a blow is identified with a free mass only; "
                "give the record after the blow and absorber = None"
            )
    return Stated(priors, taken)


def weighed(masses: dict[str, float], priors: dict[str, Prior]) -> None:
    """Add the mass ratio and the frequency where masses and stiffness give them."""
    whole = masses.get("primary.mass")
    part = masses.get("absorber.mass")
    if part is not None:
        if whole is None:
            raise ValueError(f"absorber.mass = {part!r}: give primary.mass too, or mass_ratio")
        priors["mass_ratio"] = Exactly(part / whole)
    if (impulse := masses.get("start.impulse")) is not None:
        if whole is None:
            raise ValueError(
                f"start.impulse = {impulse!r}: give primary.mass too, or impulse_velocity"
            )
        priors["impulse_velocity"] = Exactly(impulse / whole)
    if (stiffness := masses.get("primary.stiffness")) is not None and whole is not None:
        priors["frequency_hz"] = Exactly(float(np.sqrt(stiffness / whole)) / (2 * np.pi))


__all__ = ["Stated", "stated"]
