"""Studies of a pendulum: the command gives the rows of the package and says what is wrong where."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import polars as pl
import pytest
from polars.testing import assert_frame_equal

import iva
from iva import _iva

STUDY = """version = 1
[primary]
damping_ratio = 0.01
[absorber]
kind = "piva"
mass_ratio = 0.12
restitution = 0.5
clearance = 1.0
frequency_ratio = 0.4
length = 3.0
inertia_ratio = 1.3
contact_distance = 4.0
pivot_damping_ratio = 0.05
angles = "large"
impact_law = "consistent"
[start]
displacement = 1.0
angle = 0.1
angular_velocity = -0.2
[run]
periods = 6
tolerance = 0.0
"""
SWEEP = """tables = ["summary", "impacts", "episodes", "envelope"]
[sweep]
frequency_ratio = [0.3, 0.4]
length = [3.0, 5.0]
angle = { start = -0.2, stop = 0.2, count = 3 }
"""
PIVA = iva.Piva(
    mass_ratio=0.12,
    restitution=0.5,
    clearance=1.0,
    frequency_ratio=0.4,
    length=3.0,
    inertia_ratio=1.3,
    contact_distance=4.0,
    pivot_damping_ratio=0.05,
)
PRIMARY = iva.Primary(damping_ratio=0.01)
START = iva.Start(displacement=1.0, angle=0.1, angular_velocity=-0.2)
TABLES = ("summary", "impacts", "episodes", "envelope")


def command(folder: Path, study: str, *options: str) -> Path:
    """Run or sweep a study in a folder of its own."""
    folder.mkdir()
    file = folder / "study.toml"
    file.write_text(study, encoding="utf-8")
    out = folder / "out"
    name = "sweep" if "[sweep]" in study else "run"
    assert _iva.main(["iva", name, str(file), "--out", str(out), "--quiet", *options]) == 0
    return out


def replaced(old: str, new: str, study: str = STUDY) -> str:
    assert study.count(f"\n{old}\n") == 1
    return study.replace(f"\n{old}\n", f"\n{new}\n")


def without(study: str, *names: str) -> str:
    lines = study.splitlines(keepends=True)
    kept = [line for line in lines if line.partition(" =")[0] not in names]
    assert len(lines) - len(kept) == len(names)
    return "".join(kept)


def test_run_gives_the_rows_of_simulate(tmp_path: Path) -> None:
    run = iva.simulate(PIVA, PRIMARY, start=START, periods=6)
    read = iva.read(command(tmp_path / "run", STUDY))
    assert run.impacts.height >= 5
    for name in TABLES:
        assert_frame_equal(getattr(read, name), getattr(run, name), check_exact=True)
        assert read.units[name] == run.units[name]
    assert_frame_equal(read.trajectory, run.trajectory(), check_exact=True)


def test_sweep_gives_the_rows_of_sweep(tmp_path: Path) -> None:
    table = iva.sweep(
        PIVA,
        PRIMARY,
        over={"frequency_ratio": [0.3, 0.4], "length": [3.0, 5.0], "angle": [-0.2, 0.0, 0.2]},
        start=START,
        periods=6,
        tables=TABLES,
    )
    assert table.summary.height == 12
    assert iva.read(command(tmp_path / "sweep", STUDY + SWEEP)) == table
    axis = SWEEP.replace("angle =", "start.angle =")
    again = iva.read(command(tmp_path / "named", STUDY + axis))
    assert again.swept == ("frequency_ratio", "length", "start.angle")
    assert again.summary.drop("start.angle").equals(table.summary.drop("angle"))


def test_words_of_a_study_are_those_of_the_class(tmp_path: Path) -> None:
    for angles in ("large", "small"):
        for law in ("consistent", "printed"):
            study = replaced('angles = "large"', f'angles = "{angles}"')
            study = replaced('impact_law = "consistent"', f'impact_law = "{law}"', study)
            read = iva.read(command(tmp_path / f"{angles} {law}", study))
            words: Any = {"angles": angles, "impact_law": law}
            fields = {name: getattr(PIVA, name) for name in PIVA.__slots__}
            run = iva.simulate(iva.Piva(**(fields | words)), PRIMARY, start=START, periods=6)
            assert read.impacts.equals(run.impacts)


def test_defaults_count_the_same_written_or_left_out(tmp_path: Path) -> None:
    def digest(name: str, study: str) -> str:
        out = command(tmp_path / name, study)
        return pl.read_parquet_metadata(out / "summary" / "part-00000.parquet")["iva.study"]

    plain = digest("plain", STUDY)
    assert digest("left out", without(STUDY, "angles", "impact_law", "tolerance")) == plain
    assert digest("other", replaced("tolerance = 0.0", "tolerance = 1e-9")) != plain
    assert digest("small", replaced('angles = "large"', 'angles = "small"')) != plain


SMALL = replaced('angles = "large"', 'angles = "small"')
UNKNOWN = without(SMALL, "length", "contact_distance", "angle", "angular_velocity")


@pytest.mark.parametrize(
    "study",
    [
        STUDY,
        STUDY + SWEEP,
        replaced("tolerance = 0.0", "tolerance = 1e-7"),
        SMALL,
        UNKNOWN,
        replaced('impact_law = "consistent"', 'impact_law = "printed"', UNKNOWN),
    ],
    ids=["run", "sweep", "tolerance", "small", "no length", "printed"],
)
def test_the_resolved_study_is_the_study(tmp_path: Path, study: str) -> None:
    out = command(tmp_path / "first", study)
    text = (out / "study.toml").read_text(encoding="utf-8")
    given, resolved = tomllib.loads(study), tomllib.loads(text)
    # Everything that was given stands there, if no axis replaces it.
    axes = given.get("sweep", {})
    for part in ("primary", "absorber", "start", "run"):
        for name, value in given[part].items():
            assert name in axes or resolved[part][name] == value
    for name in ("kind", "angles", "impact_law"):
        assert name in resolved["absorber"]
    again = command(tmp_path / "second", text)
    assert (again / "study.toml").read_text(encoding="utf-8") == text
    assert iva.read(again) == iva.read(out)


def test_defaults_stand_in_the_resolved_study(tmp_path: Path) -> None:
    names = ("inertia_ratio", "contact_distance", "pivot_damping_ratio", "angles", "impact_law")
    study = without(STUDY, "tolerance", *names)
    out = command(tmp_path / "run", study)
    resolved = tomllib.loads((out / "study.toml").read_text(encoding="utf-8"))
    absorber = resolved["absorber"]
    assert (absorber["kind"], absorber["angles"]) == ("piva", "large")
    assert absorber["impact_law"] == "consistent"
    assert (absorber["inertia_ratio"], absorber["pivot_damping_ratio"]) == (1.0, 0.0)
    assert resolved["run"]["tolerance"] == 0.0


def test_check_writes_nothing(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "study.toml"
    file.write_text(STUDY + SWEEP, encoding="utf-8")
    assert _iva.main(["iva", "check", str(file)]) == 0
    shown = capfd.readouterr().out
    assert "Points: 12 (2 frequency_ratio × 2 length × 3 angle)" in shown
    for piece in ("pendulum", "mass ratio 0.12", "restitution 0.5", "0.3 … 0.4", "3 … 5"):
        assert piece in shown
    assert [path.name for path in tmp_path.iterdir()] == ["study.toml"]


FREE = """version = 1
[absorber]
kind = "siva"
mass_ratio = 0.12
restitution = 0.5
clearance = 1.4
[start]
displacement = 1.0
[run]
periods = 4
"""
PENDULUM_ONLY = 'only a pendulum (kind "piva") has it; leave it out'

# study, line replaced, by what, line and column, the sentence. The place is the value if it is out
# of its own range, else the key.
REFUSED = [
    (STUDY, 'kind = "piva"', 'kind = "pendulum"', "5:8", 'absorber.kind = "pendulum": give'),
    (STUDY, 'kind = "piva"', "kind = 1", "5:8", "absorber.kind = 1: give"),
    (
        STUDY,
        'kind = "piva"',
        "",
        "4:2",
        'absorber.kind is missing: give one of "siva", ',
    ),
    (
        STUDY,
        'kind = "piva"',
        'kind = "siva"',
        "14:10",
        f'absorber.angles = "large": {PENDULUM_ONLY}',
    ),
    (
        without(STUDY, "angles", "impact_law"),
        'kind = "piva"',
        'kind = "siva"',
        "9:19",
        f"absorber.frequency_ratio = 0.4: {PENDULUM_ONLY}",
    ),
    (
        STUDY,
        'angles = "large"',
        'angles = "tiny"',
        "14:10",
        'absorber.angles = "tiny": give "large" or "small"',
    ),
    (
        STUDY,
        'impact_law = "consistent"',
        "impact_law = 3",
        "15:14",
        'absorber.impact_law = 3: give "consistent" or "printed"',
    ),
    (STUDY, "length = 3.0", "lenght = 3.0", "10:1", "lenght: no such key; did you mean `length`?"),
    (STUDY, "length = 3.0", "length = -3.0", "10:10", "absorber.length = -3.0: give a number"),
    (STUDY, "inertia_ratio = 1.3", "inertia_ratio = 0.5", "11:17", "from 1 (point bob) to 1e9"),
    (STUDY, "length = 3.0", "", "4:2", "absorber.length is missing"),
    (STUDY, "angle = 0.1", "angle = 0.3", "18:1", "start.angle = 0.3: it must lie between"),
    (STUDY, "angle = 0.1", "gap_displacement = 1.1", "18:1", "start.gap_displacement = 1.1: it"),
    (STUDY, "angle = 0.1", "angle = 3.2", "18:9", "give an angle in rad, from -π to π"),
    (STUDY, "tolerance = 0.0", "tolerance = 0.01", "22:13", "0 (full accuracy) or a number up to"),
    (
        STUDY,
        "length = 3.0",
        "length = 3.0\ngravity = 1.0",
        "11:1",
        "absorber.gravity = 1: frequency_ratio and length make it",
    ),
    (
        STUDY,
        "tolerance = 0.0",
        "[sweep]\nangle = [0.0, 0.3]",
        "23:1",
        "start.angle = 0.3: it must lie between the stops",
    ),
    (FREE, "clearance = 1.4", 'clearance = 1\nangles = "small"', "7:10", PENDULUM_ONLY),
    (FREE, "clearance = 1.4", "clearance = 1\ngravity = 9.8", "7:1", "or friction too"),
    (FREE, "displacement = 1.0", "angle = 0.1", "8:9", PENDULUM_ONLY),
    (FREE, "displacement = 1.0", "angular_velocity = 0.1", "8:20", PENDULUM_ONLY),
    (FREE, "periods = 4", "periods = 4\n[sweep]\nlength = [1.0]", "12:1", PENDULUM_ONLY),
]


@pytest.mark.parametrize(("study", "old", "new", "place", "sentence"), REFUSED)
def test_a_refused_study(
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
    study: str,
    old: str,
    new: str,
    place: str,
    sentence: str,
) -> None:
    file = tmp_path / "study.toml"
    file.write_text(replaced(old, new, study), encoding="utf-8")
    assert _iva.main(["iva", "check", str(file)]) == 2
    said = capfd.readouterr().err
    assert sentence in said.splitlines()[0]
    assert said.startswith("error: ")
    assert f"{file}:{place}\n" in said
    assert [path.name for path in tmp_path.iterdir()] == ["study.toml"]


FORMATS = {
    "parquet": ["--format", "parquet"],
    "arrow": ["--format", "arrow"],
    "csv": ["--format", "csv"],
    "csv with units": ["--format", "csv", "--units-row"],
}
NEW = {
    "impacts": ("angle", "angular_velocity_before", "angular_velocity_after"),
    "trajectory": ("angle", "angular_velocity"),
}


@pytest.mark.parametrize("style", FORMATS)
def test_every_format_keeps_nulls_and_numbers(tmp_path: Path, style: str) -> None:
    free = iva.read(command(tmp_path / "free", FREE, *FORMATS[style]))
    unknown = iva.read(command(tmp_path / "unknown", UNKNOWN, *FORMATS[style]))
    known = iva.read(command(tmp_path / "known", STUDY, *FORMATS[style]))
    for read, null in ((free, True), (unknown, True), (known, False)):
        for name, columns in NEW.items():
            frame = getattr(read, name)
            assert frame.height >= 1
            for column in columns:
                assert frame[column].dtype == pl.Float64
                assert frame[column].null_count() == (frame.height if null else 0)
        row = read.summary.row(0, named=True)
        assert read.summary.schema["gravity"] == pl.Float64
        assert (row["gravity"] is None) == null
        assert row["stop_reachable"] is True
        assert row["energy_pivot"] == 0.0 if read is free else row["energy_pivot"] > 0
    # κ L ωp²
    assert known.summary["gravity"].item() == pytest.approx(1.3 * 3 * 0.16, rel=1e-15)
    run = iva.simulate(PIVA, PRIMARY, start=START, periods=6)
    assert known.impacts.equals(run.impacts)
    assert known.trajectory.equals(run.trajectory())
