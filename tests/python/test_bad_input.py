"""Bad values: one sentence with field, value and what is allowed."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import iva
from iva import _iva

PARTS = ("primary", "absorber", "start", "run")
INF = math.inf
NAN = math.nan
SIZE = "0 or a number of size 1e-30 to 1e30"
POSITIVE = "a number greater than 0, from 1e-30 to 1e30"
NON_NEGATIVE = "0 or a number from 1e-30 to 1e30"
MASS_RATIO = "a number greater than 0, at most 1e9"
TOLERANCE = "0 (full accuracy) or a number up to 1e-3"
ANGLE = "an angle in rad, from -π to π"

# class, field, value, what is allowed
FIELDS: list[tuple[Any, str, float, str]] = [
    (iva.Primary, "primary.damping_ratio", -0.1, "a number from 0 to 1e9"),
    (iva.Primary, "primary.damping_ratio", NAN, "a number from 0 to 1e9"),
    (iva.Primary, "primary.damping", -1.0, NON_NEGATIVE),
    (iva.Primary, "primary.natural_frequency", 0.0, POSITIVE),
    (iva.Primary, "primary.frequency_hz", -3.0, POSITIVE),
    (iva.Primary, "primary.stiffness", INF, POSITIVE),
    (iva.Primary, "primary.mass", 0.0, POSITIVE),
    (iva.Siva, "absorber.mass_ratio", 0.0, MASS_RATIO),
    (iva.Siva, "absorber.mass_ratio", -INF, MASS_RATIO),
    (iva.Siva, "absorber.mass", -1.0, POSITIVE),
    (iva.Siva, "absorber.restitution", 1.0000001, "a number from 0 to 1"),
    (iva.Siva, "absorber.restitution", -0.5, "a number from 0 to 1"),
    (iva.Siva, "absorber.restitution", NAN, "a number from 0 to 1"),
    (iva.Siva, "absorber.relative_clearance", 0.0, POSITIVE),
    (iva.Siva, "absorber.clearance", -0.5, POSITIVE),
    (iva.Siva, "absorber.clearance_mm", NAN, POSITIVE),
    (iva.Siva, "absorber.gap", 0.0, POSITIVE),
    (iva.Siva, "absorber.gap_mm", INF, POSITIVE),
    (iva.Piva, "absorber.mass_ratio", 0.0, MASS_RATIO),
    (iva.Piva, "absorber.restitution", 1.5, "a number from 0 to 1"),
    (iva.Piva, "absorber.frequency_ratio", 0.0, POSITIVE),
    (iva.Piva, "absorber.frequency_ratio", NAN, POSITIVE),
    (iva.Piva, "absorber.length", -10.0, POSITIVE),
    (iva.Piva, "absorber.gravity", 0.0, POSITIVE),
    (iva.Piva, "absorber.gravity", INF, POSITIVE),
    (iva.Piva, "absorber.inertia_ratio", 0.999, "a number from 1 (point bob) to 1e9"),
    (iva.Piva, "absorber.inertia_ratio", NAN, "a number from 1 (point bob) to 1e9"),
    (iva.Piva, "absorber.contact_distance", 0.0, POSITIVE),
    (iva.Piva, "absorber.pivot_damping_ratio", -0.1, "a number from 0 to 1e9"),
    (iva.Start, "start.displacement", NAN, SIZE),
    (iva.Start, "start.displacement_mm", INF, SIZE),
    (iva.Start, "start.velocity", -INF, SIZE),
    (iva.Start, "start.gap_displacement", NAN, SIZE),
    (iva.Start, "start.gap_velocity", INF, SIZE),
    (iva.Start, "start.angle", 3.2, ANGLE),
    (iva.Start, "start.angle", NAN, ANGLE),
    (iva.Start, "start.angular_velocity", -INF, SIZE),
]


def assert_one_sentence(message: str, *pieces: str) -> None:
    for internal in ("\n", "_iva", str(Path(iva.__file__).parent), "Traceback"):
        assert internal not in message
    for piece in pieces:
        assert piece in message


@pytest.mark.parametrize(("part", "path", "value", "allowed"), FIELDS)
def test_a_field_out_of_range(part: Any, path: str, value: float, allowed: str) -> None:
    with pytest.raises(ValueError, match="=") as caught:
        part(**{path.partition(".")[2]: value})
    shown = {"inf": "inf", "-inf": "-inf", "nan": "NaN"}.get(str(value), f"{value:g}")
    assert_one_sentence(str(caught.value), path, shown, allowed)


@pytest.mark.parametrize("digits", [400, 5000])
def test_an_integer_too_large_for_a_float(digits: int) -> None:
    with pytest.raises(ValueError, match="finite") as caught:
        iva.Primary(mass=10**digits)
    assert_one_sentence(
        str(caught.value), f"primary.mass = a whole number of about {digits} digits"
    )


# class, two fields that set the same quantity: the second is refused
ALTERNATIVES: list[tuple[Any, str, str]] = [
    (iva.Primary, "damping_ratio", "damping"),
    (iva.Primary, "natural_frequency", "frequency_hz"),
    (iva.Primary, "natural_frequency", "stiffness"),
    (iva.Siva, "mass_ratio", "mass"),
    (iva.Siva, "relative_clearance", "gap_mm"),
    (iva.Siva, "clearance", "gap"),
    (iva.Start, "displacement", "displacement_mm"),
    (iva.Piva, "mass_ratio", "mass"),
    (iva.Piva, "clearance", "gap"),
    (iva.Start, "gap_displacement", "angle"),
    (iva.Start, "gap_velocity", "angular_velocity"),
]


@pytest.mark.parametrize(("part", "first", "second"), ALTERNATIVES)
def test_alternatives_given_twice(part: Any, first: str, second: str) -> None:
    with pytest.raises(ValueError, match="give one of them") as caught:
        part(**{first: 0.5, second: 2})
    said = str(caught.value)
    name = part._part
    assert said == f"{name}.{second} = 2: {name}.{first} is given as well; give one of them"
    # A scene that is complete but for that is refused in the same words.
    pendulum = {} if part is iva.Siva else {"kind": "piva", "length": 3.0}
    scene: dict[str, dict[str, Any]] = {
        "primary": {"mass": 1.0, "stiffness": 1.0},
        "absorber": {"restitution": 0.5, "clearance": 0.5, "mass": 0.1} | pendulum,
        "run": {"periods": 1.0},
    }
    replaced = {"natural_frequency": "stiffness", "mass_ratio": "mass"}.get(first, "clearance")
    scene.get(name, {}).pop(replaced, None)
    scene[name] = scene.get(name, {}) | {first: 0.5, second: 2.0}
    spec = {f"{part}.{field}": v for part, values in scene.items() for field, v in values.items()}
    with pytest.raises(ValueError, match="give one of them") as again:
        _iva.states(spec, [])
    assert str(again.value) == said


# From one end of what is allowed to the other.
SIZES = (1e-30, 1e-12, 1.0, 1e12, 1e30)


@pytest.mark.parametrize("kind", ["siva", "piva"])
@pytest.mark.parametrize("system", [{"primary.mass": 1.0, "primary.stiffness": 1.0}, {}])
def test_the_field_that_is_blamed_was_given(system: dict[str, float], kind: str) -> None:
    pendulum = {"absorber.frequency_ratio": 0.4, "absorber.length": 3.0} if kind == "piva" else {}
    base: dict[str, float | str] = (
        {"absorber.kind": kind}
        | system
        | pendulum
        | {
            "absorber.mass_ratio": 0.1,
            "absorber.clearance": 1.0,
            "absorber.restitution": 0.5,
            "run.periods": 1.0,
            "run.max_work": 10.0,
        }
    )
    paths = [f"{part}.{name}" for part in PARTS for name, _, _ in _iva.fields(part, kind)]
    paths.remove("run.max_work")  # it keeps the runs short
    blamed = set()
    for one, other in itertools.combinations(paths, 2):
        for sizes in itertools.product(SIZES, repeat=2):
            given = base | dict(zip((one, other), sizes, strict=True))
            try:
                _iva.states(given, [])
            except ValueError as error:
                said = str(error)
                blamed.add((" is missing: " in said or said.partition(" = ")[0] in given, said))
    assert {said for fair, said in blamed if not fair} == set()
    assert len(blamed) > 50


SIVA = iva.Siva(mass_ratio=0.1, relative_clearance=0.5, restitution=0.5)
START = iva.Start(displacement=1.0)


def simulate(
    absorber: Any = SIVA, primary: Any = None, start: Any = START, **arguments: Any
) -> iva.Run:
    if not {"periods", "duration"} & set(arguments):
        arguments["periods"] = 2
    return iva.simulate(absorber, primary or iva.Primary(), start=start, **arguments)


def sweep(over: Any, **arguments: Any) -> iva.Table:
    return iva.sweep(SIVA, iva.Primary(), over=over, start=START, periods=2, **arguments)


def siva(**clearance: float) -> iva.Siva:
    return iva.Siva(mass_ratio=0.1, restitution=0.5, **clearance)


def piva(**changes: Any) -> iva.Piva:
    whole = {"mass_ratio": 0.12, "restitution": 0.5, "clearance": 1.4}
    return iva.Piva(**(whole | {"frequency_ratio": 0.4, "length": 10.0} | changes))


# what is called, pieces of the message
CALLS: list[tuple[Callable[[], object], tuple[str, ...]]] = [
    (
        lambda: simulate(iva.Siva(mass_ratio=0.1, clearance=1)),
        ("absorber.restitution", "missing", "0 to 1"),
    ),
    (
        lambda: simulate(iva.Siva(restitution=0.1, clearance=1)),
        ("absorber.mass_ratio", "missing", "mass"),
    ),
    (lambda: simulate(siva()), ("absorber.clearance", "missing", "gap")),
    (
        lambda: simulate(siva(relative_clearance=0.5), start=iva.Start(velocity=1)),
        ("absorber.relative_clearance", "0.5", "use clearance"),
    ),
    (lambda: simulate(siva(clearance_mm=5.0)), ("absorber.clearance_mm", "5", "SI")),
    (
        lambda: simulate(start=iva.Start(displacement=1, gap_displacement=0.7)),
        ("gap_displacement", "0.7", "0.5"),
    ),
    (
        lambda: simulate(start=iva.Start(displacement=1, gap_displacement=-0.7)),
        ("gap_displacement", "-0.7", "0.5"),
    ),
    (lambda: simulate(primary=iva.Primary(mass=1)), ("primary.stiffness", "missing")),
    (lambda: simulate(primary=iva.Primary(stiffness=1)), ("primary.mass", "missing")),
    (lambda: simulate(primary=iva.Primary(damping=0.1)), ("primary.damping", "0.1", "mass")),
    (
        lambda: simulate(iva.Siva(mass=0.1, restitution=0.5, clearance=1)),
        ("absorber.mass", "0.1", "primary.mass"),
    ),
    (
        lambda: simulate(start=iva.Start(angle=0.1)),
        ("start.angle = 0.1", 'only a pendulum (kind "piva") has it'),
    ),
    (
        lambda: simulate(start=iva.Start(angular_velocity=0.1)),
        ("start.angular_velocity = 0.1", "only a pendulum"),
    ),
    (lambda: simulate(tolerance=0.01), ("run.tolerance = 0.01", "0 (full accuracy)")),
    (lambda: sweep({"length": [1.0]}), ("sweep.length", "only a pendulum")),
    (lambda: piva(angles="tiny"), ('absorber.angles = "tiny"', '"large" or "small"')),
    (
        lambda: piva(impact_law=""),
        ('absorber.impact_law = ""', '"consistent" or "printed"'),
    ),
    (lambda: simulate(piva(), tolerance=0.01), ("run.tolerance = 0.01", TOLERANCE)),
    (lambda: simulate(piva(), tolerance=-1e-9), ("run.tolerance = -1e-9", TOLERANCE)),
    (lambda: simulate(piva(), tolerance=NAN), ("run.tolerance = NaN", TOLERANCE)),
    (lambda: simulate(piva(length=None)), ("absorber.length is missing", "large angles")),
    (lambda: simulate(piva(frequency_ratio=None)), ("absorber.frequency_ratio is missing",)),
    (
        lambda: simulate(piva(frequency_ratio=None, length=None)),
        ("absorber.length is missing", "frequency_ratio", "gravity"),
    ),
    # κ L ωp² = 10 · 0.4²
    (lambda: simulate(piva(gravity=1.7)), ("absorber.gravity = 1.7", "1.6", "two of the three")),
    (
        lambda: simulate(piva(angles="small", length=None, contact_distance=3.0)),
        ("absorber.length is missing", "contact_distance"),
    ),
    (
        lambda: simulate(piva(angles="small", length=None), start=iva.Start(angle=0.1)),
        ("absorber.length is missing", "the start is an angle"),
    ),
    # asin(1.4/10) = 0.1405
    (
        lambda: simulate(piva(), start=iva.Start(angle=-0.15)),
        ("start.angle = -0.15", "between the stops", "0.1404"),
    ),
    (
        lambda: simulate(piva(), start=iva.Start(gap_displacement=1.5)),
        ("start.gap_displacement = 1.5", "from -1.4 to 1.4"),
    ),
    (
        lambda: simulate(piva(clearance=30.0), start=iva.Start(gap_displacement=10.5)),
        ("start.gap_displacement = 10.5", "from -10 to 10"),
    ),
    (lambda: simulate(periods=None), ("run.periods", "missing", "duration")),
    (lambda: simulate(periods=0), ("run.periods", "0", POSITIVE)),
    (lambda: simulate(duration=INF), ("run.duration", "inf", POSITIVE)),
    (lambda: simulate(periods=1, duration=1), ("run.duration", "run.periods")),
    (lambda: simulate(max_impacts=0), ("run.max_impacts", "0", "a whole number from 1")),
    (lambda: simulate(max_impacts=2.5), ("run.max_impacts", "2.5", "a whole number")),
    (lambda: simulate(max_work=-1), ("run.max_work", "-1", "a whole number")),
    (lambda: simulate(chatter_floor=0), ("run.chatter_floor", "0", POSITIVE)),
    (lambda: simulate(periods=1e308), ("run.periods", "1e308", POSITIVE)),
    (
        lambda: simulate(max_work=10**5000),
        ("run.max_work = a whole number of about 5000 digits", "finite"),
    ),
    (
        lambda: simulate(measures=["dampin_ratio_3"]),
        ("measures = `dampin_ratio_3`", "did you mean `damping_ratio_3`?"),
    ),
    (lambda: simulate(measures=["zzz"]), ("measures = `zzz`", "settling_time_5")),
    (lambda: simulate().trajectory(0), ("samples_per_period", "0", "1 or greater")),
    (lambda: simulate().trajectory(2**70), ("samples_per_period", "1 or greater")),
    (lambda: simulate().trajectory(10**5000), ("samples_per_period = a huge number", "most")),
    (lambda: simulate().at([10**5000]), ("times[0] = a whole number of about 5000 digits",)),
    (lambda: simulate().at([-0.1]), ("times[0]", "-0.1")),
    (lambda: simulate().at([1e9]), ("times[0]", "1e9")),
    (lambda: simulate().at([NAN]), ("times[0]", "NaN")),
    (lambda: sweep({"mass_ratio": []}), ("sweep.mass_ratio", "[]", "at least one value")),
    (
        lambda: sweep({"mass_ratio": [0.1, NAN]}),
        ("sweep.mass_ratio[1]", "NaN", MASS_RATIO),
    ),
    (lambda: sweep({"restitution": [1.5]}), ("sweep.restitution[0]", "1.5", "0 to 1")),
    (lambda: sweep({"mass_ration": [0.1]}), ("`mass_ration`", "did you mean `mass_ratio`?")),
    (lambda: sweep({"mass": [0.1]}), ("`mass`", "`primary.mass`", "`absorber.mass`")),
    (
        lambda: sweep({"mass_ratio": [0.1], "absorber.mass_ratio": [0.2]}),
        ("sweep.absorber.mass_ratio", "sweep.mass_ratio", "one of them"),
    ),
    (
        lambda: sweep({"clearance": [0.1], "gap": [0.2]}),
        ("sweep.gap", "sweep.clearance", "one of them"),
    ),
    (
        lambda: sweep({"gap_displacement": [0.0, 0.6]}),
        ("gap_displacement", "0.6", "point 1"),
    ),
    (
        lambda: sweep(
            {
                "mass_ratio": np.linspace(0.1, 0.2, 70_000),
                "restitution": np.linspace(0, 1, 70_000),
            }
        ),
        ("70000 × 70000", "2^32"),
    ),
    (
        lambda: sweep({"mass_ratio": [0.1]}, tables=("sumary",)),
        ("tables = `sumary`", "did you mean `summary`?"),
    ),
    (lambda: sweep({"mass_ratio": [0.1]}, tables=("trajectory",)), ("tables", "`trajectory`")),
    (lambda: sweep({"mass_ratio": [0.1]}, tables=()), ("tables", "summary")),
    (lambda: sweep({}), ("over = {}", "at least one axis", "iva.simulate")),
    (lambda: sweep({"mass_ratio": [0.1]}, threads=10**400), ("threads = 1000", "…", "1024")),
    (lambda: sweep({"mass_ratio": [0.1]}, threads=0), ("threads", "0", "1 or greater")),
    (lambda: sweep({"mass_ratio": [0.1]}, threads=-2), ("threads", "-2", "1 or greater")),
]


@pytest.mark.parametrize(("call", "pieces"), CALLS)
def test_a_bad_call(call: Callable[[], object], pieces: tuple[str, ...]) -> None:
    with pytest.raises(ValueError, match=r"\w") as caught:
        call()
    assert_one_sentence(str(caught.value), *pieces)


# what is called, the argument named
TYPES: list[tuple[Callable[[], object], str]] = [
    (lambda: simulate(absorber=iva.Primary()), "absorber = Primary"),
    (lambda: simulate(primary=SIVA), "primary = Siva"),
    (lambda: simulate(start=1.0), "start = 1.0"),
    (lambda: simulate(periods="3"), "run.periods = '3'"),
    (lambda: simulate(max_impacts=True), "run.max_impacts = True"),
    (lambda: simulate(piva(), tolerance="1e-6"), "run.tolerance = '1e-6'"),
    (lambda: piva(angles=3), "absorber.angles = 3: give a word"),
    (lambda: piva(impact_law=None), "absorber.impact_law = None: give a word"),
    (lambda: piva(length="10"), "absorber.length = '10'"),
    (lambda: iva.Start(angle=True), "start.angle = True"),
    (lambda: simulate(measures=[1]), "measures has 1"),
    (lambda: simulate(measures=5), "measures = 5"),
    (
        lambda: simulate(max_impacts=np.timedelta64(5, "s")),
        f"run.max_impacts = {np.timedelta64(5, 's')!r}",
    ),
    (
        lambda: simulate(duration=np.timedelta64(5, "ns")),
        f"run.duration = {np.timedelta64(5, 'ns')!r}",
    ),
    (lambda: simulate(absorber=10**5000), "absorber = a whole number of about 5000 digits"),
    (lambda: simulate().at(np.array([1], "m8[ns]")), f"times[0] = {np.timedelta64(1, 'ns')!r}"),
    (lambda: simulate().trajectory(True), "samples_per_period = True"),
    (lambda: simulate().trajectory(2.5), "samples_per_period = 2.5"),  # type: ignore[arg-type]
    (lambda: simulate().at(1.0), "times = 1.0"),  # type: ignore[arg-type]
    (lambda: simulate().at(["a"]), "times[0] = 'a'"),  # type: ignore[list-item]
    (lambda: simulate().at(np.zeros((2, 2))), "times has shape (2, 2)"),
    (lambda: sweep([("mass_ratio", [0.1])]), "over = ["),
    (lambda: sweep({"mass_ratio": 0.1}), "mass_ratio = 0.1"),
    (lambda: sweep({"mass_ratio": "0.1"}), "mass_ratio = '0.1'"),
    (lambda: sweep({"mass_ratio": {0.1, 0.2}}), "mass_ratio = {"),
    (lambda: sweep({1: [0.1]}), "over has the key 1"),
    (lambda: sweep({10**5000: [0.1]}), "over has the key a whole number of about 5000 digits"),
    (lambda: sweep({"mass_ratio": [0.1]}, threads="2"), "threads = 2"),
    (lambda: sweep({"mass_ratio": [0.1]}, progress="yes"), "progress = 'yes'"),
    (lambda: sweep({"mass_ratio": [0.1]}, tables=[1]), "tables has 1"),
    (lambda: sweep({"mass_ratio": [0.1]}, tables=5), "tables = 5"),
    (lambda: sweep({"mass_ratio": [0.1]}, tables=None), "tables = None"),
]


@pytest.mark.parametrize(("call", "named"), TYPES)
def test_a_wrong_type(call: Callable[[], object], named: str) -> None:
    with pytest.raises(TypeError) as caught:
        call()
    assert_one_sentence(str(caught.value), named)
