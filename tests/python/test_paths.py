"""The ways in which a user can have points run: every kind of scene has the same bits by each.

`tests/rust/tests/all/every_field.rs` does the same for the paths below: threads, chunks, tables
beside, errors, order, every field.
"""

from __future__ import annotations

import dataclasses
import inspect
import re
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from polars.testing import assert_frame_equal

import iva
from iva import _iva

PRIMARY = iva.Primary(mass=100.0, natural_frequency=30.0, damping_ratio=0.02)
PUSH = iva.Harmonic(amplitude=2.0, frequency=29.0)
SHAKEN = iva.Harmonic(base_acceleration=2.0, frequency=31.0)
BLOW = iva.Impulse(velocity=0.1, time=0.3)
QUAKE = iva.Recorded(np.arange(200) * 0.01, np.sin(0.3 * np.arange(200)), kind="base_acceleration")

#: Every kind of absorber, under every kind of force.
FREE: dict[str, Any] = {"mass_ratio": 0.1, "restitution": 0.6, "clearance": 0.005}
ABSORBERS: dict[str, Any] = {
    "siva": iva.Siva(**FREE),
    "unlike walls": iva.Siva(**FREE, restitution_minus=0.8, gap_offset=0.001),
    "inclined": iva.Siva(**FREE, inclination_deg=20.0, gravity=9.81),
    "piva": iva.Piva(**FREE, length=0.4),
    "small angles": iva.Piva(**FREE, length=0.4, angles="small"),
    "several": [iva.Siva(**FREE), iva.Siva(**FREE, contact_time=1e-3)],
    "units": iva.Siva(**FREE, units=3, clearance_spread=0.1),
    "a power law": iva.Siva(**FREE, reference_speed=0.5),
    "none": None,
}
FORCES: dict[str, Any] = {
    "decay": None,
    "force": PUSH,
    "base": SHAKEN,
    "two forces": [PUSH, iva.Harmonic(amplitude=1.0, frequency=50.0)],
    "impulse": BLOW,
    "record": QUAKE,
}
SCENES = [(absorber, force) for absorber in ABSORBERS for force in FORCES]

#: What says which points are run, and what is computed of them.
OF_THE_SCENE = """absorber primary start over sampling force periods duration cycles discard tables
    measures max_impacts max_work chatter_floor tolerance errors""".split()
#: What says how they are run. Each is taken by one of the PATHS below.
OF_THE_PATH = "out resume overwrite format memory_limit threads executor client progress".split()
#: The same of the command, and what it says of the scene.
OPTIONS = "out resume overwrite format threads log quiet units-row tables help".split()


def scene(absorber: str, force: str) -> dict[str, Any]:
    damping = {"primary.damping_ratio": [0.02, 0.03, 0.05]}
    over = {"restitution": [0.4, 0.6, 0.8], "clearance": [0.004, 0.006]}
    return {
        "absorber": ABSORBERS[absorber],
        "primary": PRIMARY,
        "over": damping if ABSORBERS[absorber] is None else over,
        "start": iva.Start(displacement=0.01),
        "force": FORCES[force],
        "periods": 5,
        "tables": ("summary", "impacts", "episodes", "envelope", "stroboscope", "absorbers"),
    }


Way = Callable[[dict[str, Any], Path], iva.Table]


def on_threads(given: dict[str, Any], folder: Path) -> iva.Table:
    del folder
    seen: list[tuple[int, int]] = []
    return iva.sweep(**given, threads=2, progress=lambda *it: seen.append(it), memory_limit=1e8)


def on_an_executor(given: dict[str, Any], folder: Path) -> iva.Table:
    del folder
    with ThreadPoolExecutor(2) as executor:
        return iva.sweep(**given, executor=executor)


def into(style: str) -> Way:
    def write(given: dict[str, Any], folder: Path) -> iva.Table:
        iva.sweep(**given, out=folder / "out", format=style)
        return iva.read(folder / "out")

    return write


def resumed(given: dict[str, Any], folder: Path) -> iva.Table:
    """Make a part that is lost again."""
    iva.sweep(**given, out=folder / "out", threads=1)
    for file in (folder / "out" / "summary").glob("part-*"):
        file.unlink()
    with pytest.warns(UserWarning, match="computed again"):
        iva.sweep(**given, out=folder / "out", resume=True, overwrite=False, threads=2)
    return iva.read(folder / "out")


def overwritten(given: dict[str, Any], folder: Path) -> iva.Table:
    iva.sweep(**(given | {"periods": 2}), out=folder / "out")
    return iva.sweep(**given, out=folder / "out", overwrite=True)


def by_the_command(given: dict[str, Any], folder: Path) -> iva.Table:
    """Run the study that a sweep has written by the command."""
    iva.sweep(**given, out=folder / "out")
    words = ["iva", "sweep", str(folder / "out" / "study.toml"), "--out", str(folder / "shell")]
    words += ["--threads", "2", "--format", "arrow", "--quiet", "--log", str(folder / "log")]
    assert _iva.main(words) == 0
    return iva.read(folder / "shell")


def by_a_frame(given: dict[str, Any], folder: Path) -> iva.Table:
    """Take the rows of a frame in place of a grid."""
    del folder
    points = iva.sampling.points(given["over"], "grid").drop("point")
    return iva.sweep(**(given | {"over": points}))


PATHS: dict[str, Way] = {
    "threads": on_threads,
    "executor": on_an_executor,
    "parquet": into("parquet"),
    "arrow": into("arrow"),
    "csv": into("csv"),
    "resume": resumed,
    "overwrite": overwritten,
    "command": by_the_command,
    "frame": by_a_frame,
}


def test_every_way_is_a_path() -> None:
    """What is added to a sweep must become a path here, or a part of the scenes."""
    assert {*inspect.signature(iva.sweep).parameters} == {*OF_THE_SCENE, *OF_THE_PATH}


def test_every_option_of_the_command_is_a_path(capfd: pytest.CaptureFixture[str]) -> None:
    assert _iva.main(["iva", "sweep", "--help"]) == 0
    options = set(re.findall(r"^ .*?--([a-z-]+)", capfd.readouterr().out, flags=re.MULTILINE))
    assert options == set(OPTIONS)


@pytest.mark.parametrize(("absorber", "force"), SCENES)
@pytest.mark.parametrize("errors", [False, True])
def test_every_path_makes_the_same_tables(
    tmp_path: Path, absorber: str, force: str, errors: bool
) -> None:
    given = scene(absorber, force) | {"errors": errors}
    truth = iva.sweep(**given, threads=1)
    for name, path in PATHS.items():
        folder = tmp_path / name
        folder.mkdir()
        found = path(given, folder)
        for table in truth.tables:
            a, b = (getattr(it, table) for it in (found, truth))
            assert_frame_equal(a, b, check_exact=True, check_column_order=name != "frame")


@pytest.mark.parametrize(("absorber", "force"), SCENES)
def test_every_row_is_a_run(absorber: str, force: str) -> None:
    given = scene(absorber, force) | {"errors": True}
    truth = iva.sweep(**given)
    over = given.pop("over")
    given.pop("tables")
    for point in range(truth.summary.height):
        row = truth.summary.row(point, named=True)
        parts = {"absorber": given["absorber"], "primary": given["primary"]}
        for key in over:
            part, field = key.split(".") if "." in key else ("absorber", key)
            changed, value = parts[part], {field: row[key]}
            if isinstance(changed, list):
                parts[part] = [dataclasses.replace(one, **value) for one in changed]
            else:
                parts[part] = dataclasses.replace(changed, **value)
        run = iva.simulate(**(given | parts))
        for table in truth.tables:
            rows = getattr(truth, table).filter(pl.col("point") == point)
            alone = getattr(run, table)
            same = [name for name in alone.columns if name in rows.columns and name != "point"]
            assert_frame_equal(rows.select(same), alone.select(same), check_exact=True)
