"""What `iva check` says of absorbers: of the study, not of what they are divided into."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

HEAD = """version = 1
[primary]
damping_ratio = 0.01
[start]
displacement = 1
[run]
periods = 2
"""
ONE = (
    HEAD
    + """[absorber]
kind = "siva"
mass_ratio = 0.1
clearance = 0.5
"""
)
LIST = (
    HEAD
    + """[[absorber]]
kind = "siva"
mass_ratio = 0.1
restitution = 0.5
clearance = 0.6
units = 2
clearance_spread = 0.5
[[absorber]]
kind = "siva"
mass_ratio = 0.2
restitution = 0.7
clearance = 0.4
"""
)


def checked(tmp_path: Path, text: str) -> str:
    """Return what the command prints of a study, as one line."""
    study = tmp_path / "study.toml"
    study.write_text(text)
    command = [sys.executable, "-m", "iva", "check", str(study)]
    told = subprocess.run(command, capture_output=True, text=True, check=True)
    return " ".join(told.stdout.split())


@pytest.mark.parametrize(
    ("given", "swept", "told"),
    [
        ("restitution = 0.5", "", "restitution 0.5"),
        ("restitution = 0.5", "restitution = [0.5, 0.6]", "restitution 0.5 … 0.6"),
        ("", "restitution = [0.5, 0.6]", "restitution 0.5 … 0.6"),
        ("restitution_table = [[0.1, 0.9]]", "", "restitution a table of the approach speed"),
        ("restitution_table = [[0.1, 0.9]]", "restitution = [0.5, 0.6]", "restitution 0.5 … 0.6"),
        (
            "restitution_table = [[0.1, 0.9]]",
            "yield_speed = [0.1, 0.2]",
            "restitution that of plastic spheres",
        ),
        ("yield_speed = 0.1", "", "restitution that of plastic spheres"),
        (
            "restitution = 0.5\nreference_speed = 0.3",
            "restitution = [0.5, 0.6]",
            "restitution a power law of the approach speed",
        ),
        (
            "restitution = 0.5",
            "reference_speed = [0.1, 0.2]",
            "restitution a power law of the approach speed",
        ),
    ],
)
def test_the_restitution_is_what_the_points_have(
    tmp_path: Path, given: str, swept: str, told: str
) -> None:
    text = f"{ONE}{given}\n[sweep]\n{swept}\n" if swept else f"{ONE}{given}\n"
    assert f"Absorber: free mass, mass ratio 0.1, {told} " in checked(tmp_path, text)


def test_units_belong_to_their_absorber(tmp_path: Path) -> None:
    told = checked(tmp_path, f'{LIST}[sweep]\n"absorber.1.clearance" = [0.4, 0.5]\n')
    first = "Absorber 0: free mass in 2 units, mass ratio 0.1, restitution 0.5, clearance 0.3 … 0.9"
    second = "Absorber 1: free mass, mass ratio 0.2, restitution 0.7, clearance 0.4 … 0.5"
    assert first in told
    assert second in told


@pytest.mark.parametrize(
    ("structure", "start", "told"),
    [
        ("start_velocities = [0.1, 0.2]", "", "start_velocities carry the absorber along: it sta"),
        ("", "velocity = 0.1", "start.velocity carries the absorber along: it starts with that"),
        ("", "displacement = 0.1", None),
        ("start_velocities = [0, 0]", "", None),
        ("start_velocities = [0.1, 0.2]", "gap_velocity = 0.5", None),
    ],
)
def test_velocities_that_carry_absorbers_along_are_told(
    tmp_path: Path, structure: str, start: str, told: str | None
) -> None:
    said = checked(
        tmp_path,
        f"""version = 1
[structure]
points = ["first", "top"]
mass = [[2000.0, 0.0], [0.0, 1000.0]]
stiffness = [[300e3, -100e3], [-100e3, 100e3]]
absorber_at = "top"
{structure}
[absorber]
kind = "siva"
mass = 100
gap_mm = 30
restitution = 0.5
[start]
{start}
[run]
duration = 3
""",
    )
    assert told in said if told else " along: " not in said
