"""Bad values: one sentence with field, value and what is allowed."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import iva

INF = math.inf
NAN = math.nan
POSITIVE = "a finite number greater than 0"

# class, field, value, what is allowed
FIELDS: list[tuple[Any, str, float, str]] = [
    (iva.Primary, "primary.damping_ratio", -0.1, "a finite number, 0 or greater"),
    (iva.Primary, "primary.damping_ratio", NAN, "a finite number, 0 or greater"),
    (iva.Primary, "primary.damping", -1.0, "a finite number, 0 or greater"),
    (iva.Primary, "primary.natural_frequency", 0.0, POSITIVE),
    (iva.Primary, "primary.frequency_hz", -3.0, POSITIVE),
    (iva.Primary, "primary.stiffness", INF, POSITIVE),
    (iva.Primary, "primary.mass", 0.0, POSITIVE),
    (iva.Siva, "absorber.mass_ratio", 0.0, POSITIVE),
    (iva.Siva, "absorber.mass_ratio", -INF, POSITIVE),
    (iva.Siva, "absorber.mass", -1.0, POSITIVE),
    (iva.Siva, "absorber.restitution", 1.0000001, "a number from 0 to 1"),
    (iva.Siva, "absorber.restitution", -0.5, "a number from 0 to 1"),
    (iva.Siva, "absorber.restitution", NAN, "a number from 0 to 1"),
    (iva.Siva, "absorber.relative_clearance", 0.0, POSITIVE),
    (iva.Siva, "absorber.clearance", -0.5, POSITIVE),
    (iva.Siva, "absorber.clearance_mm", NAN, POSITIVE),
    (iva.Siva, "absorber.gap", 0.0, POSITIVE),
    (iva.Siva, "absorber.gap_mm", INF, POSITIVE),
    (iva.Start, "start.displacement", NAN, "a finite number"),
    (iva.Start, "start.displacement_mm", INF, "a finite number"),
    (iva.Start, "start.velocity", -INF, "a finite number"),
    (iva.Start, "start.gap_displacement", NAN, "a finite number"),
    (iva.Start, "start.gap_velocity", INF, "a finite number"),
]


def assert_one_sentence(message: str, *pieces: str) -> None:
    assert "\n" not in message
    for piece in pieces:
        assert piece in message


@pytest.mark.parametrize(("part", "path", "value", "allowed"), FIELDS)
def test_a_field_out_of_range(part: Any, path: str, value: float, allowed: str) -> None:
    with pytest.raises(ValueError, match="=") as caught:
        part(**{path.partition(".")[2]: value})
    shown = {"inf": "inf", "-inf": "-inf", "nan": "NaN"}.get(str(value), f"{value:g}")
    assert_one_sentence(str(caught.value), path, shown, allowed)


def test_an_integer_too_large_for_a_float() -> None:
    with pytest.raises(ValueError, match=r"primary\.mass = 1000.*finite"):
        iva.Primary(mass=10**400)


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
    (lambda: simulate(siva(gap=1.0, clearance=0.5)), ("absorber.gap", "absorber.clearance")),
    (
        lambda: simulate(siva(relative_clearance=0.5), start=iva.Start(velocity=1)),
        ("absorber.relative_clearance", "0.5", "use clearance"),
    ),
    (lambda: simulate(siva(clearance_mm=5.0)), ("absorber.clearance_mm", "5", "SI")),
    (
        lambda: simulate(start=iva.Start(displacement=1, displacement_mm=3)),
        ("start.displacement_mm", "start.displacement"),
    ),
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
        lambda: simulate(primary=iva.Primary(frequency_hz=1, natural_frequency=2)),
        ("primary.frequency_hz", "primary.natural_frequency"),
    ),
    (
        lambda: simulate(iva.Siva(mass=0.1, restitution=0.5, clearance=1)),
        ("absorber.mass", "0.1", "primary.mass"),
    ),
    (lambda: simulate(periods=None), ("run.periods", "missing", "duration")),
    (lambda: simulate(periods=0), ("run.periods", "0", POSITIVE)),
    (lambda: simulate(duration=INF), ("run.duration", "inf", POSITIVE)),
    (lambda: simulate(periods=1, duration=1), ("run.duration", "run.periods")),
    (lambda: simulate(max_impacts=0), ("run.max_impacts", "0", "a whole number from 1")),
    (lambda: simulate(max_impacts=2.5), ("run.max_impacts", "2.5", "a whole number")),
    (lambda: simulate(max_work=-1), ("run.max_work", "-1", "a whole number")),
    (lambda: simulate(chatter_floor=0), ("run.chatter_floor", "0", POSITIVE)),
    (lambda: simulate(measures=["damping"]), ("measures", "`damping`", "damping_ratio_1")),
    (lambda: simulate().trajectory(0), ("samples_per_period", "0", "1 or greater")),
    (lambda: simulate().trajectory(2**70), ("samples_per_period", "1 or greater")),
    (lambda: simulate().at([-0.1]), ("time", "-0.1")),
    (lambda: simulate().at([1e9]), ("time", "1000000000")),
    (lambda: simulate().at([NAN]), ("time", "NaN")),
    (lambda: sweep({"mass_ratio": []}), ("sweep.mass_ratio", "[]", "at least one value")),
    (
        lambda: sweep({"mass_ratio": [0.1, NAN]}),
        ("sweep.mass_ratio[1]", "NaN", POSITIVE),
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
    (lambda: sweep({"mass_ratio": [0.1]}, tables=("sumary",)), ("tables", "`sumary`", "summary")),
    (lambda: sweep({"mass_ratio": [0.1]}, tables=("trajectory",)), ("tables", "`trajectory`")),
    (lambda: sweep({"mass_ratio": [0.1]}, tables=()), ("tables", "summary")),
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
    (lambda: simulate(measures=[1]), "measures"),
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
    (lambda: sweep({"mass_ratio": [0.1]}, threads="2"), "threads = 2"),
    (lambda: sweep({"mass_ratio": [0.1]}, progress="yes"), "progress = 'yes'"),
    (lambda: sweep({"mass_ratio": [0.1]}, tables=[1]), "tables"),
]


@pytest.mark.parametrize(("call", "named"), TYPES)
def test_a_wrong_type(call: Callable[[], object], named: str) -> None:
    with pytest.raises(TypeError) as caught:
        call()
    assert_one_sentence(str(caught.value), named)
