"""Whole scenes: absorber (or none), primary system, forces, start and run as one spec."""

from __future__ import annotations

from collections.abc import Mapping

from iva.forces import fields_of, listed
from iva.parameters import Absorber, Primary, Start, shown, spec

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from iva.parameters import Spec


def scene(
    absorber: object,
    primary: object,
    start: object,
    force: object,
    run: Mapping[str, float | None],
) -> Spec:
    """Return the spec of a whole scene, after a look at the types of its parts.

    Raises
    ------
    TypeError
        If a part is of the wrong class, or a setting of the run is not a number.
    """
    if absorber is not None and not isinstance(absorber, Absorber):
        raise TypeError(f"absorber = {shown(absorber)}: give an iva.Siva, an iva.Piva or None")
    if not isinstance(primary, Primary):
        raise TypeError(f"primary = {shown(primary)}: give an iva.Primary")
    if not isinstance(start, Start):
        raise TypeError(f"start = {shown(start)}: give an iva.Start")
    made = spec(absorber, primary, start, run=run)
    if forces := [fields_of(force) for force in listed(force)]:
        made["forces"] = forces
    return made
