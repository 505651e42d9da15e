"""What `iva check` says of gravity before anything is run."""

from __future__ import annotations

import math
import re
import subprocess
import sys
from pathlib import Path

import pytest

STUDY = """version = 1
[primary]
mass = 1200.0
frequency_hz = 4.2
[absorber]
kind = "siva"
mass = 60.0
restitution = 0.6
gap_mm = 4.0
ANGLE
[force]
FORCE
[start]
displacement_mm = 2.4
[run]
periods = 3
"""
#: ωn² A of the start.
ACCELERATION = (2.0 * math.pi * 4.2) ** 2 * 2.4e-3


def told(folder: Path, angle: str, force: str = "") -> str:
    """Return what is said of gravity, on one line."""
    text = STUDY.replace("ANGLE", angle).replace("FORCE", force)
    if not force:
        text = text.replace("[force]\n", "")
    study = folder / "study.toml"
    study.write_text(text, encoding="utf-8")
    command = [sys.executable, "-m", "iva", "check", str(study)]
    ran = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=True)
    said = re.search(r"The line of motion .*?(?=\nTime)", ran.stdout, re.DOTALL)
    assert said, ran.stdout
    assert all(len(line) <= 80 for line in said[0].splitlines())
    return said[0].replace("\n", " ")


@pytest.mark.parametrize(
    ("angle", "begin", "share"),
    [
        ("", "is level. Upright (inclination_deg = 90) gravity would be ", 1.0),
        ("inclination_deg = 90", "rises. Gravity along it is ", 1.0),
        ("inclination_deg = 30", "rises. Gravity along it is ", 0.5),
        (
            "inclination_deg = 30\ngravity = 1.62",
            "rises. Gravity along it is ",
            0.5 * 1.62 / 9.80665,
        ),
    ],
)
def test_a_decay(tmp_path: Path, angle: str, begin: str, share: float) -> None:
    """The number is g sin α over ωn² A, from the numbers of the study."""
    said = told(tmp_path, angle)
    expected = f"The line of motion {begin}"
    assert said.startswith(expected)
    number = float(said.removeprefix(expected).split()[0])
    assert number == pytest.approx(share * 9.80665 / ACCELERATION, rel=1e-3)
    assert said.endswith("above 1 a mass that lies on its lower stop stays there")


def test_under_a_force(tmp_path: Path) -> None:
    """At 3 ωn a force f/M moves the structure by f/(8 M ωn²): 9/8 f/M beside that of the start."""
    said = told(tmp_path, "inclination_deg = 90", "amplitude = 8.0\nrelative_frequency = 3.0")
    share = float(said.split("Gravity along it is ")[1].split()[0])
    assert share == pytest.approx(9.80665 / (ACCELERATION + 9.0), rel=1e-3)


def test_where_only_a_run_would_tell(tmp_path: Path) -> None:
    """A structure that is struck is accelerated by more than its start tells."""
    assert told(tmp_path, "inclination_deg = 90", "velocity = 5.0") == "The line of motion rises"
    assert told(tmp_path, "", "velocity = 5.0") == "The line of motion is level"
