"""The command that the wheel installs."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import sysconfig
import tomllib
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import iva
import iva.__main__ as console
from patience import PATIENCE, started, until

SCRIPT = Path(sysconfig.get_path("scripts")) / ("iva.exe" if sys.platform == "win32" else "iva")
COMMANDS = [[str(SCRIPT)], [sys.executable, "-m", "iva"]]


def call(command: list[str], *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*command, *arguments],
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=PATIENCE,
    )


@pytest.mark.parametrize("command", COMMANDS, ids=["script", "module"])
def test_version_and_help(command: list[str]) -> None:
    version = call(command, "--version")
    assert (version.returncode, version.stdout) == (0, f"iva {iva.__version__}\n")
    usage = call(command, "--help")
    assert usage.returncode == 0
    assert "reproduce  " in usage.stdout
    assert "explore  " in usage.stdout
    for name in ("sweep", "run", "check"):
        assert name in usage.stdout
        assert call(command, name, "--help").returncode == 0


TABLE = tomllib.loads(Path(__file__).with_name("exit_codes.toml").read_text(encoding="utf-8"))
CASES = [case for case in TABLE["case"] if not case.get("native", False)]


def test_the_table_has_every_exit_code() -> None:
    assert {case["exit_code"] for case in CASES} == {0, 1, 2, 130}


@pytest.mark.parametrize("command", COMMANDS, ids=["script", "module"])
@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"].replace(" ", "_"))
def test_exit_codes(command: list[str], case: dict[str, Any], tmp_path: Path) -> None:
    if "stdout" in case and not sys.platform.startswith("linux"):
        pytest.skip("only Linux has a device that is always full")
    if "interrupt" in case and sys.platform == "win32":
        pytest.skip("Windows has no SIGINT for one process")
    for name, study in TABLE["studies"].items():
        (tmp_path / f"{name}.toml").write_text(study, encoding="utf-8")
    with Path(case.get("stdout", os.devnull)).open("w", encoding="utf-8") as stdout:
        process = started(
            [*command, *case["arguments"].split()],
            cwd=tmp_path,
            stdout=stdout,
            stderr=subprocess.PIPE,
        )
        with process as child:
            if "interrupt" in case:
                until(lambda: any((tmp_path / "out").rglob("part-*")), child)
                child.send_signal(signal.SIGINT)
            said = child.communicate()[1]
    assert child.returncode == case["exit_code"], said
    assert case["says"] in said
    for internal in ("Traceback", "panicked", "_iva", str(Path(iva.__file__).parent)):
        assert internal not in said


def test_reproduce_is_done_in_python(monkeypatch: pytest.MonkeyPatch) -> None:
    called: list[list[str]] = []

    def main(arguments: list[str]) -> int:
        called.append(arguments)
        return 7

    command = ModuleType("iva.paper.command")
    vars(command)["main"] = main
    monkeypatch.setitem(sys.modules, "iva.paper", ModuleType("iva.paper"))
    monkeypatch.setitem(sys.modules, "iva.paper.command", command)
    monkeypatch.setattr(sys, "argv", ["iva", "reproduce", "--help", "fig6"])
    assert console.main() == 7
    assert called == [["--help", "fig6"]]


def test_other_commands_import_nothing_that_draws() -> None:
    script = """
import sys
from iva.__main__ import main
sys.argv = ["iva", "check", "none.toml"]
assert main() == 2
print(*(name for name in sys.modules if name.partition(".")[0] in {"numpy", "polars"}))
print(*(name for name in sys.modules if name.startswith("iva.")))
"""
    said = call([sys.executable, "-c", script]).stdout.splitlines()
    numbers, ours = said
    assert numbers == ""
    assert set(ours.split()) == {"iva.processor", "iva._iva", "iva.__main__"}


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
