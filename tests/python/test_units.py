"""The three cases of units."""

from __future__ import annotations

import math

import numpy as np
import polars as pl
import pytest

import iva
from iva import _iva

PERIODS = 8
SIVA = iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5)


@pytest.fixture
def natural() -> iva.Run:
    """Return the run with ωn = 1 and a start displacement of 1."""
    return iva.simulate(
        SIVA,
        iva.Primary(damping_ratio=0.02),
        start=iva.Start(displacement=1.0, velocity=0.3),
        periods=PERIODS,
    )


def said(run: iva.Run) -> str:
    """Return what a run says of itself, in one line."""
    return " ".join(repr(run).split())


def compare(run: iva.Run, natural: iva.Run, omega: float, length: float, mass: float) -> None:
    """Scale all columns by their quantity and compare.

    Eight periods hold about ten impacts, which amplify rounding by about 1e3.
    """
    factor = {
        "s": 1 / omega,
        "m": length,
        "m/s": length * omega,
        "rad": 1.0,
        "rad/s": omega,
        "m/s²": length * omega**2,
        "J": mass * (length * omega) ** 2,
        "N s": mass * length * omega,
        "N": mass * length * omega**2,
        "1": 1.0,
    }
    units = iva.Units("si")
    for name in ("summary", "impacts", "envelope"):
        got: pl.DataFrame = getattr(run, name)
        base: pl.DataFrame = getattr(natural, name)
        assert got.shape == base.shape
        for column in got.columns:
            unit = units[name][column]
            if unit == "" or column == "energy_residual":
                continue
            expected = base[column].to_numpy() * factor[unit]
            scale = np.nanmax(np.abs(expected.astype(float)), initial=1e-300)
            assert np.allclose(
                got[column].to_numpy().astype(float),
                expected.astype(float),
                rtol=0,
                atol=1e-11 * scale,
                equal_nan=True,
            ), (name, column)


def test_si(natural: iva.Run) -> None:
    # M = 2 kg, k = 800 N/m: ωn = 20 rad/s; ζ = c/(2 M ωn) = 0.02.
    run = iva.simulate(
        iva.Siva(mass=0.3, gap_mm=12.0, restitution=0.5),
        iva.Primary(mass=2.0, stiffness=800.0, damping=1.6),
        start=iva.Start(displacement_mm=10.0, velocity=0.3 * 0.01 * 20.0),
        periods=PERIODS,
    )
    assert "SI units" in repr(run)
    assert run.units["impacts"]["time"] == "s"
    assert run.units["impacts"]["energy_loss"] == "J"
    compare(run, natural, omega=20.0, length=0.01, mass=2.0)


def test_seconds(natural: iva.Run) -> None:
    omega = 2 * math.pi * 3.0
    run = iva.simulate(
        SIVA,
        iva.Primary(frequency_hz=3.0, damping_ratio=0.02),
        start=iva.Start(displacement=10.0, velocity=0.3 * 10.0 * omega),
        duration=PERIODS / 3.0,
    )
    assert "time in s, lengths in the unit of clearance and displacement" in said(run)
    assert run.units["impacts"]["time"] == "s"
    assert run.units["summary"]["energy_initial"].endswith("per unit primary mass")
    compare(run, natural, omega=omega, length=10.0, mass=1.0)


def test_natural(natural: iva.Run) -> None:
    assert "ωn = 1: time in 1/ωn, lengths in the unit of clearance and displ" in said(natural)
    assert natural.units["impacts"]["time"] == "1/ωn"


@pytest.mark.parametrize(
    ("system", "primary"),
    [
        ("si", {"primary.mass": 2.0, "primary.stiffness": 800.0}),
        ("seconds", {"primary.natural_frequency": 20.0}),
        ("natural", {}),
    ],
)
def test_field_metadata_say_the_same(system: str, primary: dict[str, float]) -> None:
    spec = primary | {
        "absorber.mass_ratio": 0.1,
        "absorber.restitution": 0.5,
        "start.displacement": 1.0,
        "run.periods": 1.0,
    }
    names = ["summary", "impacts", "episodes", "envelope"]
    made = _iva.Study(spec, ("grid", [("relative_clearance", [0.5])]), names).run()
    sentence, columns = _iva.column_units(system, ["relative_clearance"])
    for name in names:
        assert made[name].metadata["iva.units"] == system
        assert made[name].metadata["iva.units_sentence"] == sentence
        assert made[name].metadata["iva.schema_version"] == str(iva.SCHEMA_VERSION)
        assert made[name].units == columns[name]
