"""Scenes for the explorer: words, numbers and lists by the paths that they have in a study."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypedDict

from iva import _iva, scenes

TABLE = "restitution_table"


class Explored(TypedDict):
    """A scene: choices by name, values by path, and what no slider changes.

    In a list of absorbers the names of choices have a number, ``"1.kind"``. What is fixed is under
    ``"structure"`` the entries of a structure with several modes, under ``"starts"`` lists of the
    start with a number for each unit, under ``"tables"`` tables of the restitution by the number of
    their absorber, and under ``"records"`` recorded forces by theirs.
    """

    choices: dict[str, str]
    values: dict[str, float]
    fixed: dict[str, dict[str, Any]]


#: A free mass that settles its structure well.
DEFAULT: Explored = {
    "choices": {"kind": "siva"},
    "values": {
        "primary.damping_ratio": 0.005,
        "absorber.mass_ratio": 0.1,
        "absorber.restitution": 0.6,
        "absorber.clearance": 0.5,
        "start.displacement": 1.0,
        "run.periods": 20.0,
    },
    "fixed": {},
}


def explored(spec: Mapping[str, Any]) -> Explored:
    """Return the scene of a spec, as :func:`iva.scenes.scene` makes it.

    Raises
    ------
    ValueError
        If it has a tolerance.
    """
    if spec.get("run.tolerance"):
        rule = "the explorer shows the exact motion; leave it out"
        raise ValueError(f"run.tolerance = {spec['run.tolerance']:g}: {rule}")
    scene: Explored = {"choices": {}, "values": {}, "fixed": {}}
    count = sum(path.endswith(".kind") for path in spec)
    for path, value in spec.items():
        _, _, name = path.partition(".")
        if path == "structure":
            scene["fixed"]["structure"] = dict(value)
        elif name.endswith(TABLE):
            number = name.removesuffix(TABLE).rstrip(".") or "0"
            scene["fixed"].setdefault("tables", {})[number] = [list(point) for point in value]
        elif isinstance(value, str):
            scene["choices"][name] = value
        elif path == "forces":
            continue
        elif isinstance(value, (list, tuple)) and len(value) != count:
            scene["fixed"].setdefault("starts", {})[name] = list(value)
        elif isinstance(value, (list, tuple)):
            own = (f"{place}." if count > 1 else "" for place in range(count))
            pairs = zip(own, value, strict=True)
            scene["values"] |= {f"start.{place}{name}": float(one) for place, one in pairs}
        else:
            scene["values"][path] = float(value)
    forces = list(spec.get("forces", ()))
    for place, force in enumerate(forces):
        prefix = f"force.{place}." if len(forces) > 1 else "force."
        given = {name: value for name, value in force.items() if value is not None}
        if (record := given.pop("record", None)) is not None:
            all_ = {name: getattr(record, name) for name in ("kind", "times", "values")}
            scene["fixed"].setdefault("records", {})[str(place)] = all_
        scene["values"] |= {f"{prefix}{name}": float(value) for name, value in given.items()}
    return scene


def parts(scene: Explored) -> dict[str, Any]:
    """Return a scene as the arguments of :func:`iva.simulate`."""
    fixed = scene["fixed"]
    spec: dict[str, Any] = {f"absorber.{name}": word for name, word in scene["choices"].items()}
    several = "absorber.0.kind" in spec
    for number, points in fixed.get("tables", {}).items():
        spec[f"absorber.{number}.{TABLE}" if several else f"absorber.{TABLE}"] = points
    if "structure" in fixed:
        spec["structure"] = fixed["structure"]
    for name, numbers in fixed.get("starts", {}).items():
        spec[f"start.{name}"] = tuple(numbers)
    forces: dict[int, dict[str, Any]] = {}
    starts: dict[str, dict[int, float]] = {}
    for number, record in fixed.get("records", {}).items():
        made = _iva.Record(record["times"], record["values"], record["kind"])
        forces[int(number)] = {"record": made}
    for path, value in scene["values"].items():
        part, _, name = path.partition(".")
        if part == "force":
            number, dot, field = name.rpartition(".")
            forces.setdefault(int(number) if dot else 0, {})[field] = value
        elif part == "start" and "." in name:
            number, _, field = name.partition(".")
            starts.setdefault(field, {})[int(number)] = value
        else:
            spec[path] = value
    count = sum(path.endswith(".kind") for path in spec)
    for name, own in starts.items():
        spec[f"start.{name}"] = tuple(own.get(place, 0.0) for place in range(count))
    if forces:
        spec["forces"] = [forces[number] for number in sorted(forces)]
    return scenes.parts(spec)


def of_study(path: Path, point: int = 0) -> Explored:
    """Return the scene of a point of a study file.

    Raises
    ------
    ValueError
        If the study or the point is invalid, or as :func:`explored`.
    iva.IvaError
        If the file cannot be read.
    """
    return explored(_iva.scene_of_study(path, point))
