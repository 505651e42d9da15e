"""Whole scenes: absorber (or none), primary system, forces, start and run as one spec."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from iva.forces import Force, Harmonic, Impulse, Recorded, fields_of, listed
from iva.parameters import Absorber, Piva, Primary, Siva, Start, Stop, shown, spec
from iva.structures import Structure

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Any

    from iva.parameters import Spec
    from iva.simulation import Run

#: What only an impulse has.
OF_IMPULSES = frozenset({"velocity", "impulse", "time"})


def scene(
    absorber: object,
    primary: object,
    start: object,
    force: object,
    run: Mapping[str, float | None],
    *,
    several: bool = False,
) -> Spec:
    """Return the spec of a whole scene, after a look at the types of its parts.

    Parameters
    ----------
    absorber, primary, start, force
        Its parts.
    run : mapping
        Settings of the run, by name.
    several : bool, default False
        Whether `absorber` may be a list, and `primary` a structure with several modes.

    Raises
    ------
    TypeError
        If a part is of the wrong class, or a setting of the run is not a number.
    ValueError
        If a list of absorbers is empty, or a start has modes where there are none.
    """
    if not several or not isinstance(absorber, (list, tuple)):
        if absorber is not None and not isinstance(absorber, Absorber):
            raise TypeError(f"absorber = {shown(absorber)}: give {wanted(several)}")
    else:
        fits(absorber)
    if not isinstance(primary, (Primary, Structure) if several else Primary):
        rule = "give an iva.Primary or an iva.Structure" if several else "give an iva.Primary"
        raise TypeError(f"primary = {shown(primary)}: {rule}")
    if not isinstance(start, Start):
        raise TypeError(f"start = {shown(start)}: give an iva.Start")
    for name in start._of_modes if isinstance(primary, Primary) else ():
        if (all_ := getattr(start, name)) is not None:
            rule = "an iva.Structure has several modes; give displacement and velocity"
            raise ValueError(f"start.{name} = {shown(list(all_))}: {rule}")
    if isinstance(primary, Structure):
        made = spec(absorber, start, run=run)
        begun = {name: getattr(start, name) for name in start._of_modes}
        own = {f"start_{name}": list(all_) for name, all_ in begun.items() if all_ is not None}
        made["structure"] = primary._entries() | own
    else:
        made = spec(absorber, primary, start, run=run)
    if forces := [fields_of(force) for force in listed(force)]:
        made["forces"] = forces
    return made


def seen_with_absorbers(run: Run) -> None:
    """Look whether a run sees its structure where its absorbers are.

    Raises
    ------
    ValueError
        If it does not: then the motion of absorbers in space is not told.
    """
    structure = run.primary
    if run.absorber is None or not isinstance(structure, Structure) or structure._moves_as_seen():
        return
    if structure.seen_mode is not None:
        rule = "leave seen_mode out for the motion of absorbers in space"
        raise ValueError(f"run sees only a part of its structure's motion: {rule}")
    rule = "give seen_at the point of all absorbers for their motion in space"
    raise ValueError(f"run has absorbers at other points than that which it sees: {rule}")


def absorbers(given: Absorber | Sequence[Absorber] | None) -> tuple[Absorber | None, ...]:
    """Return one absorber, none or several as a tuple; where there is none it has one ``None``."""
    return tuple(given) if isinstance(given, Sequence) else (given,)


def wanted(several: bool) -> str:
    """Return what a scene takes as its absorber."""
    one = "an iva.Siva, an iva.Piva, an iva.Stop"
    return f"{one}, a list of them or None" if several else f"{one} or None"


def fits(absorbers: Sequence[object]) -> None:
    """Look at the absorbers of a list.

    Raises
    ------
    TypeError
        If something is no absorber.
    ValueError
        If the list is empty.
    """
    if not absorbers:
        raise ValueError(f"absorber = {shown(absorbers)}: give {wanted(several=True)}")
    for place, one in enumerate(absorbers):
        if not isinstance(one, Absorber):
            rule = "give an iva.Siva, an iva.Piva or an iva.Stop"
            raise TypeError(f"absorber[{place}] = {shown(one)}: {rule}")


def parts(made: Spec) -> dict[str, Any]:
    """Return a spec as the arguments of :func:`iva.simulate` that make it."""
    given: dict[str, dict[str, Any]] = {"absorber": {}, "primary": {}, "start": {}, "run": {}}
    several: dict[int, dict[str, Any]] = {}
    for path, value in made.items():
        part, dot, name = path.partition(".")
        place, numbered, field = name.partition(".")
        if numbered:
            several.setdefault(int(place), {})[field] = value
        elif dot:
            given[part][name] = value
    listed_absorbers = [absorber_of(several[place]) for place in sorted(several)]
    forces = [force_of(fields) for fields in made.get("forces", ())]
    drives = {"force": forces[0] if len(forces) == 1 else forces} if forces else {}
    return {
        "absorber": listed_absorbers or absorber_of(given["absorber"]),
        "primary": primary_of(made, given["primary"]),
        "start": Start(**given["start"]),
        **drives,
        **given["run"],
    }


def primary_of(made: Spec, fields: Mapping[str, Any]) -> Primary | Structure:
    """Return the primary of a spec."""
    return Structure(**made["structure"]) if "structure" in made else Primary(**fields)


def absorber_of(words: Mapping[str, Any]) -> Absorber | None:
    """Return the absorber of its fields."""
    kind = words.get("kind", Siva._kind)
    fields = {name: value for name, value in words.items() if name != "kind"}
    kinds: dict[str, type[Absorber]] = {one._kind: one for one in (Siva, Piva, Stop)}
    return kinds[kind](**fields) if kind in kinds else None


def force_of(fields: Mapping[str, Any]) -> Force:
    """Return the force of its fields."""
    if "record" in fields:
        return Recorded._made(fields["record"], fields.get("scale", 1.0))
    return Harmonic(**fields) if OF_IMPULSES.isdisjoint(fields) else Impulse(**fields)
