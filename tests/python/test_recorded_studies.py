"""Units of records in studies: a study and :meth:`iva.Recorded.read` take a file for the same."""

from __future__ import annotations

from pathlib import Path

import pytest

import iva
from iva import _iva
from iva.measured.driving import FORCES
from iva.measured.sensor_units import GRAVITIES, LENGTHS, TIMES
from recordings import table, written

STUDY = """version = 1
[primary]
mass = 200
stiffness = 16000
damping = 30
[absorber]
kind = "siva"
mass = 20
restitution = 0.6
gap_mm = 20
[force]
record = "ground.csv"
kind = "{kind}"
[run]
duration = 2
"""


def ran(tmp_path: Path, kind: str) -> iva.Table:
    """Run the study with the record beside it, and return the result."""
    study = written(tmp_path, STUDY.format(kind=kind), "my.toml")
    out = tmp_path / "out"
    assert _iva.main(["iva", "run", str(study), "--out", str(out), "--quiet"]) == 0
    return iva.read(out)


@pytest.mark.parametrize(
    ("head", "kind"),
    [
        ("time (s),acceleration (g)", "base_acceleration"),
        ("time (ms),acceleration (m/s^2)", "force"),
        ("time_s,acceleration_mm_s2", "base_acceleration"),
        ("# t [s], a [Gal]", "base_acceleration"),
        ("# t [s], a / (in/s^2)\nx,y", "base_acceleration"),
        ("t [s],shaker [kN]", "force_newtons"),
        ("t,force_N", "force_newtons"),
        ("t,a (1)", "base_acceleration"),
        ("t,f/M", "force"),
    ],
)
def test_a_study_uses_the_units_in_the_head(tmp_path: Path, head: str, kind: str) -> None:
    path = written(tmp_path, table(head), "ground.csv")
    force = iva.Recorded.read(path, kind)  # type: ignore[arg-type]
    same = iva.simulate(
        iva.Siva(mass=20.0, restitution=0.6, gap_mm=20.0),
        iva.Primary(mass=200.0, stiffness=16e3, damping=30.0),
        start=iva.Start(),
        force=force,
        duration=2.0,
    )
    assert same.summary["amplitude_max"].item() > 0.0
    assert ran(tmp_path, kind).summary.equals(same.summary)


@pytest.mark.parametrize(
    ("head", "kind", "message"),
    [
        ("t,a", "base_acceleration", "may be in m/s^2 or in g; write the unit behind the name of"),
        (
            "t [s],a [kN]",
            "base_acceleration",
            'its values are forces in N: give force.kind = "forc',
        ),
        ("t [s],a [g]", "force_newtons", "the values of this file are accelerations: give"),
        ("t [s],a [mm]", "force", 'unit "mm": give values in m/s^2, mm/s^2, g, N or kN'),
        ("t [min],a [g]", "force", 'unit "min": give times in s, ms or us'),
    ],
)
def test_units_that_a_study_refuses(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], head: str, kind: str, message: str
) -> None:
    written(tmp_path, table(head), "ground.csv")
    study = written(tmp_path, STUDY.format(kind=kind), "my.toml")
    assert _iva.main(["iva", "check", str(study)]) == 2
    assert message in capfd.readouterr().err
    with pytest.raises(ValueError):  # noqa: PT011 - in its own words
        iva.Recorded.read(tmp_path / "ground.csv", kind)  # type: ignore[arg-type]


def test_studies_know_every_unit_by_the_factor_of_the_package(tmp_path: Path) -> None:
    # The tables of units stand in both languages.
    heads = [f"t [s],a [{unit}]" for unit in (*GRAVITIES, *(f"{one}/s^2" for one in LENGTHS))]
    heads += [f"t [{unit}],a [m/s^2]" for unit in TIMES]
    kinds = ["base_acceleration"] * len(heads) + ["force_newtons"] * len(FORCES)
    heads += [f"t [s],F [{unit}]" for unit in FORCES]
    for number, (head, kind) in enumerate(zip(heads, kinds, strict=True)):
        folder = tmp_path / str(number)
        folder.mkdir()
        path = written(folder, table(head), "ground.csv")
        force = iva.Recorded.read(path, kind)  # type: ignore[arg-type]
        same = iva.simulate(
            iva.Siva(mass=20.0, restitution=0.6, gap_mm=20.0),
            iva.Primary(mass=200.0, stiffness=16e3, damping=30.0),
            start=iva.Start(),
            force=force,
            duration=2.0,
        )
        assert ran(folder, kind).summary.equals(same.summary), head
