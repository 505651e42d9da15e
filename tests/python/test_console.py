"""The command that the wheel installs."""

from __future__ import annotations

import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

import iva

SCRIPT = Path(sysconfig.get_path("scripts")) / ("iva.exe" if sys.platform == "win32" else "iva")
COMMANDS = [[str(SCRIPT)], [sys.executable, "-m", "iva"]]


def call(command: list[str], *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*command, *arguments], capture_output=True, text=True, encoding="utf-8", timeout=60
    )


@pytest.mark.parametrize("command", COMMANDS, ids=["script", "module"])
def test_version_and_help(command: list[str]) -> None:
    version = call(command, "--version")
    assert (version.returncode, version.stdout) == (0, f"iva {iva.__version__}\n")
    usage = call(command, "--help")
    assert usage.returncode == 0
    for name in ("sweep", "run", "check"):
        assert name in usage.stdout
        assert call(command, name, "--help").returncode == 0


@pytest.mark.parametrize("command", COMMANDS, ids=["script", "module"])
def test_bad_input_is_exit_code_2(command: list[str], tmp_path: Path) -> None:
    study = tmp_path / "bad.toml"
    study.write_text("version = 1\n[absorber]\nrestitutoin = 0.5\n", encoding="utf-8")
    done = call(command, "check", str(study))
    assert done.returncode == 2
    assert "restitutoin" in done.stderr
    assert "restitution" in done.stderr
    assert "Traceback" not in done.stderr
    assert "panicked" not in done.stderr
    assert call(command, "sweep", str(tmp_path / "none.toml")).returncode == 2
    assert call(command, "no-such-command").returncode == 2
    assert list(tmp_path.iterdir()) == [study]


def test_a_small_study(tmp_path: Path) -> None:
    study = tmp_path / "small.toml"
    study.write_text(
        """
version = 1
[absorber]
kind = "siva"
mass_ratio = 0.1
restitution = 0.5
relative_clearance = 0.6
[start]
displacement = 1.0
[run]
periods = 20
[sweep]
mass_ratio = [0.05, 0.1]
""",
        encoding="utf-8",
    )
    out = tmp_path / "out"
    done = call(COMMANDS[0], "sweep", str(study), "--out", str(out))
    assert done.returncode == 0, done.stderr
    assert (out / "study.toml").is_file()
    assert iva.read(out).summary.height == 2
    again = call(COMMANDS[0], "sweep", str(study), "--out", str(out))
    assert again.returncode == 2
    assert "--overwrite" in again.stderr
