"""What the tests of files from outside have in common."""

from __future__ import annotations

from pathlib import Path

import pytest

from iva import _iva

SCENE = """version = 1
[absorber]
kind = "siva"
mass_ratio = 0.1
restitution = 0.5
relative_clearance = 0.6
[start]
displacement = 1.0
"""
STUDY = SCENE + "[run]\nperiods = 5\n"
POINTS = SCENE.replace("mass_ratio = 0.1\n", "") + "[run]\nperiods = 5\n"


def command(*args: object) -> int:
    return _iva.main(["iva", *(str(arg) for arg in args)])


def said(capfd: pytest.CaptureFixture[str], *args: object, code: int = 2) -> str:
    """Return the one error of a command."""
    assert command(*args) == code
    error = capfd.readouterr().err
    assert "panicked" not in error
    assert "\x1b" not in error
    return error


def written(folder: Path, text: str) -> Path:
    file = folder / "study.toml"
    file.write_text(text, encoding="utf-8")
    return file


def of_points(folder: Path, file: Path) -> Path:
    return written(folder, POINTS + f"[sampling]\npoints = '{file.name}'\n")
