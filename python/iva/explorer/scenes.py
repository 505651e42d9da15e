"""Scenes for the explorer: words and numbers by the paths that they have in a study."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, TypedDict

from iva import _iva, scenes

#: The words of a study that are not numbers.
WORDS = ("kind", "angles", "impact_law")
NO_SPRING = "the explorer takes no spring in the gap; leave it out"
#: Fields that the page has no room for → the value that is as good as none, and what to do.
REFUSED: dict[str, tuple[float | None, str]] = {
    "absorber.units": (1.0, "the explorer shows one absorber of one unit; leave it out"),
    "absorber.friction": (0.0, "the explorer takes none; leave it out"),
    "absorber.static_friction": (0.0, "the explorer takes no friction; leave it out"),
    "absorber.spring": (0.0, NO_SPRING),
    "absorber.gap_damping": (0.0, "the explorer takes no dashpot; leave it out"),
    "absorber.gap_damping_ratio": (0.0, "the explorer takes no dashpot; leave it out"),
    "start.impulse": (None, "the explorer takes no impulse; give a start velocity"),
    "start.impulse_velocity": (None, "the explorer takes no impulse; give a start velocity"),
    "run.tolerance": (0.0, "the explorer shows the exact motion; leave it out"),
}
ALONE = "the explorer takes it for a free mass only; leave it out"
#: Those of a pendulum.
OF_PENDULUM: dict[str, tuple[float | None, str]] = {
    "absorber.gap_offset": (0.0, ALONE),
    "absorber.gap_offset_mm": (0.0, ALONE),
    "absorber.reference_speed": (None, ALONE),
    "absorber.yield_speed": (None, ALONE),
    "absorber.inclination": (0.0, ALONE),
    "absorber.inclination_deg": (0.0, ALONE),
}
#: What a force has that is not harmonic.
IMPULSES_AND_RECORDS = frozenset({"velocity", "impulse", "time", "record", "scale"})


class Explored(TypedDict):
    """A scene: choices by name, and values by path."""

    choices: dict[str, str]
    values: dict[str, float]


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
}


def explored(spec: Mapping[str, Any]) -> Explored:
    """Return the scene of a spec, as :func:`iva.scenes.scene` makes it.

    Raises
    ------
    ValueError
        If it has several absorbers, more than one force, one that is not harmonic, a structure with
        several modes, a table of the restitution, or a field of :data:`REFUSED`.
    """
    if "structure" in spec:
        raise ValueError("primary: the explorer takes no structure with several modes")
    if (count := sum(path.endswith(".kind") for path in spec)) > 1:
        rule = "the explorer shows one absorber; give one of them"
        raise ValueError(f"absorber = a list of {count}: {rule}")
    if spec.get("absorber.kind") == "stop":
        raise ValueError('absorber.kind = "stop": the explorer shows an absorber; give one')
    if "absorber.walls" in spec:
        raise ValueError("absorber.walls: the explorer shows a gap with two walls; leave it out")
    # Of a pendulum it is a spring in the pivot, which the page has.
    swings = spec.get("absorber.kind") == "piva"
    own = OF_PENDULUM if swings else {"absorber.spring_ratio": (0.0, NO_SPRING)}
    for path, (without, rule) in (REFUSED | own).items():
        if (value := spec.get(path)) is not None and value != without:
            raise ValueError(f"{path} = {value:g}: {rule}")
    if "absorber.restitution_table" in spec:
        raise ValueError("absorber.restitution_table: the explorer takes none; give a number")
    words = {f"absorber.{word}" for word in WORDS}
    choices = {path.partition(".")[2]: str(spec[path]) for path in spec if path in words}
    numbers = {
        # A list of the start has one number for one absorber.
        path: float(value[0] if isinstance(value, tuple) else value)
        for path, value in spec.items()
        if path not in words and path != "forces"
    }
    forces = list(spec.get("forces", ()))
    return {
        "choices": {"kind": "siva"} | choices,
        "values": numbers | dict(of_forces(forces)),
    }


def parts(scene: Explored) -> dict[str, Any]:
    """Return a scene as the arguments of :func:`iva.simulate`."""
    spec: dict[str, Any] = {f"absorber.{name}": word for name, word in scene["choices"].items()}
    force = {}
    for path, value in scene["values"].items():
        part, _, name = path.partition(".")
        if part == "force":
            force[name] = value
        else:
            spec[path] = value
    if force:
        spec["forces"] = [force]
    return scenes.parts(spec)


def of_forces(forces: list[Mapping[str, Any]]) -> Iterator[tuple[str, float]]:
    """Yield the numbers of a force by path.

    Raises
    ------
    ValueError
        If there is more than one, or one that is not harmonic.
    """
    for force in forces:
        if len(forces) > 1 or not IMPULSES_AND_RECORDS.isdisjoint(force):
            raise ValueError("force: the explorer takes one harmonic force or base motion")
        for name, value in force.items():
            if value is not None:
                yield f"force.{name}", float(value)


def of_study(path: Path, point: int = 0) -> Explored:
    """Return the scene of a point of a study file.

    Raises
    ------
    ValueError
        If the study or the point is invalid, has more than one force, or one that is not harmonic.
    iva.IvaError
        If the file cannot be read.
    """
    words, numbers = _iva.scene_of_study(path, point)
    return {"choices": dict(words), "values": dict(numbers)}
