"""Whole scenes: absorber (or none), primary system, forces, start and run as one spec."""

from __future__ import annotations

from collections.abc import Mapping

from iva.forces import Force, Harmonic, Impulse, Recorded, fields_of, listed
from iva.parameters import Absorber, Piva, Primary, Siva, Start, shown, spec

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Any

    from iva.parameters import Spec

#: What only an impulse has.
OF_IMPULSES = frozenset({"velocity", "impulse", "time"})


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


def parts(made: Spec) -> dict[str, Any]:
    """Return a spec as the arguments of :func:`iva.simulate` that make it."""
    given: dict[str, dict[str, Any]] = {"absorber": {}, "primary": {}, "start": {}, "run": {}}
    for path, value in made.items():
        part, dot, name = path.partition(".")
        if dot:
            given[part][name] = value
    words = given["absorber"]
    kind = words.pop("kind", Siva._kind)
    if kind != Piva._kind:
        words = {name: value for name, value in words.items() if not isinstance(value, str)}
    absorber = {Siva._kind: Siva, Piva._kind: Piva}.get(kind)
    forces = [force_of(fields) for fields in made.get("forces", ())]
    drives = {"force": forces[0] if len(forces) == 1 else forces} if forces else {}
    return {
        "absorber": absorber(**words) if absorber else None,
        "primary": Primary(**given["primary"]),
        "start": Start(**given["start"]),
        **drives,
        **given["run"],
    }


def force_of(fields: Mapping[str, Any]) -> Force:
    """Return the force of its fields."""
    if "record" in fields:
        return Recorded._made(fields["record"], fields.get("scale", 1.0))
    return Harmonic(**fields) if OF_IMPULSES.isdisjoint(fields) else Impulse(**fields)
