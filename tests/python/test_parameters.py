"""Primary, Siva, Piva and Start behave as values."""

from __future__ import annotations

import copy
import dataclasses
import pickle
import subprocess
import sys
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import iva
from iva import _iva

# part, a kind of absorber that has all its fields, class, words among the fields
PARTS: list[tuple[str, str, Any, list[str]]] = [
    ("primary", "siva", iva.Primary, []),
    ("absorber", "siva", iva.Siva, ["walls"]),
    ("absorber", "piva", iva.Piva, ["angles", "impact_law", "walls"]),
    ("start", "piva", iva.Start, []),
]


@pytest.mark.parametrize(("name", "kind", "part", "words"), PARTS)
def test_fields_are_those_of_the_table(name: str, kind: str, part: Any, words: list[str]) -> None:
    declared = [field.name for field in dataclasses.fields(part)]
    numbers = [field for field, _, _ in _iva.fields(name, kind)]
    modal = part._of_modes
    assert all(name in part.__doc__ for name in modal)
    declared = [name for name in declared if name not in modal]
    tables = [name for name in declared if name in part._tables]
    assert [name for name in declared if name not in tables] == numbers + words
    assert all(f"{name} : array_like" in part.__doc__ for name in tables)
    defaults = {field.name: field.default for field in dataclasses.fields(part)}
    assert all(defaults[name] is None for name in modal)
    assert all(defaults[field] is None for field in numbers)
    declared = numbers
    for field in declared:
        assert f"{field} : float" in part.__doc__


def test_the_fields_of_forces_are_those_of_the_table() -> None:
    declared = [
        field.name
        for part in (iva.Harmonic, iva.Impulse)
        for field in dataclasses.fields(part)
        if f"{field.name} : float" in str(part.__doc__)
    ]
    assert [*declared, "scale"] == [field for field, _, _ in _iva.fields("force", "siva")]


def test_value_semantics() -> None:
    siva = iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5)
    same = iva.Siva(restitution=0.5, mass_ratio=0.15, relative_clearance=0.6)
    assert siva == same
    assert hash(siva) == hash(same)
    assert pickle.loads(pickle.dumps(siva)) == siva
    assert copy.copy(siva) == copy.deepcopy(siva) == siva
    assert dataclasses.replace(siva, restitution=0.7) != siva
    with pytest.raises(dataclasses.FrozenInstanceError):
        siva.restitution = 0.6  # type: ignore[misc]
    with pytest.raises(ValueError, match=r"absorber\.restitution = 1\.5"):
        dataclasses.replace(siva, restitution=1.5)


def test_repr_shows_what_was_given() -> None:
    siva = iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5)
    assert repr(siva) == "Siva(mass_ratio=0.15, restitution=0.5, relative_clearance=0.6)"
    assert eval(repr(siva), vars(iva)) == siva
    primary = iva.Primary(mass=2, stiffness=800)
    assert repr(primary).startswith("Primary(stiffness=800.0, mass=2.0)  # SI units")
    assert eval(repr(primary), vars(iva)) == primary
    assert "ωn = 1" in repr(iva.Primary())
    assert repr(iva.Primary(mass=2)) == "Primary(mass=2.0)"  # no frequency yet, so no units


def test_a_pendulum_is_a_value() -> None:
    piva = iva.Piva(mass_ratio=0.12, restitution=0.5, clearance=1.4, frequency_ratio=0.4, length=10)
    same = iva.Piva(
        length=np.float32(10),  # type: ignore[arg-type]
        frequency_ratio=0.4,
        clearance=1.4,
        restitution=0.5,
        mass_ratio=0.12,
        angles="large",
        impact_law="consistent",
    )
    assert piva == same
    assert hash(piva) == hash(same)
    assert type(same.length) is float
    for twin in (pickle.loads(pickle.dumps(piva)), copy.copy(piva), copy.deepcopy(piva)):
        assert twin == piva
    assert "angles" not in repr(piva)
    assert eval(repr(piva), vars(iva)) == piva
    # Words are part of the value, and shown where they are not the default.
    other = dataclasses.replace(piva, angles="small", impact_law="printed")
    assert other != piva
    assert repr(other) == repr(piva)[:-1] + ", angles='small', impact_law='printed')"
    assert eval(repr(other), vars(iva)) == pickle.loads(pickle.dumps(other)) == other
    free: Any = iva.Siva(mass_ratio=0.12, restitution=0.5, clearance=1.4)
    assert piva != free
    with pytest.raises(dataclasses.FrozenInstanceError):
        piva.length = 6.0  # type: ignore[misc]
    with pytest.raises(ValueError, match=r'absorber\.angles = "tiny"'):
        dataclasses.replace(piva, angles="tiny")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "value", [1, np.float32(1), np.int64(1), np.float64(1), Fraction(1), np.linspace(0, 1, 3)[2]]
)
def test_any_real_number_becomes_a_float(value: Any) -> None:
    start = iva.Start(displacement=value)
    assert type(start.displacement) is float
    assert start == iva.Start(displacement=1.0)


@pytest.mark.parametrize("value", [True, "1", [1.0], np.array([1.0]), 1j, np.True_])
def test_anything_else_is_a_type_error(value: Any) -> None:
    with pytest.raises(TypeError, match=r"start\.displacement = .*: give a number"):
        iva.Start(displacement=value)


def test_import_is_light() -> None:
    program = """
import iva, sys
HEAVY = {"polars", "numpy", "tqdm", "matplotlib"}
print(sorted(HEAVY & set(sys.modules)))
run = iva.simulate(iva.Siva(mass_ratio=0.1, clearance=1, restitution=0.5), iva.Primary(),
    start=iva.Start(displacement=1), periods=2)
print(sorted(HEAVY & set(sys.modules)))
run.summary, run.impacts, run.at([1.0])
iva.show_versions()
print(sorted(HEAVY & set(sys.modules)))
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    lists = [line for line in done.stdout.splitlines() if line.startswith("[")]
    assert lists == ["[]", "[]", "['polars']"], done.stderr
