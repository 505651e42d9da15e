"""Units of records in studies: a study and :meth:`iva.Recorded.read` take a file for the same."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

import iva
from iva import _iva
from iva.measured.sensor_units import FORCES, GRAVITIES, LENGTHS, TIMES
from recordings import TIMES as INSTANTS
from recordings import VALUES, table, written

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


def with_keys(kind: str, keys: dict[str, Any]) -> str:
    """Return the text of the study with more keys of the force; words are those of Python."""
    lines = [f"{key} = {value!r}" for key, value in keys.items()]
    return STUDY.format(kind=kind).replace("[run]", "\n".join([*lines, "[run]"]))


def ran(tmp_path: Path, kind: str, **keys: Any) -> iva.Table:
    """Run the study with the record beside it, and return the result."""
    study = written(tmp_path, with_keys(kind, keys), "my.toml")
    out = tmp_path / "out"
    assert _iva.main(["iva", "run", str(study), "--out", str(out), "--quiet"]) == 0
    return iva.read(out)


def simulated(force: iva.Recorded) -> iva.Run:
    """Run the scene of the study under a force."""
    return iva.simulate(
        iva.Siva(mass=20.0, restitution=0.6, gap_mm=20.0),
        iva.Primary(mass=200.0, stiffness=16e3, damping=30.0),
        start=iva.Start(),
        force=force,
        duration=2.0,
    )


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
    same = simulated(force)
    assert same.summary["amplitude_max"].item() > 0.0
    assert ran(tmp_path, kind).summary.equals(same.summary)


@pytest.mark.parametrize(
    ("head", "kind", "message"),
    [
        ("t,a", "base_acceleration", "may be in m/s^2 or in g; give force.unit, or"),
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
        same = simulated(force)
        assert ran(folder, kind).summary.equals(same.summary), head


#: A recorder's file: two clocks, three sensors, and a word in each line.
MANY = "\n".join(
    ["# made by a recorder", "t [s],clock [ms],left [g],left [m/s^2],push [kN],state"]
    + [
        f"{t},{round(1000 * t)},{v},{-v},{0.1 * v},ok"
        for t, v in zip(INSTANTS, VALUES, strict=True)
    ]
)
#: The same values without instants and names.
SAMPLES = "\n".join(map(str, VALUES))
#: Three columns without names.
NAMELESS = "\n".join(f"{-v} {v} {t}" for t, v in zip(INSTANTS, VALUES, strict=True))
#: The time behind the values.
TURNED = "\n".join(["a [g],t", *(f"{v},{t}" for t, v in zip(INSTANTS, VALUES, strict=True))])
#: What a recorder writes above the names, and units below them.
BELOW = "\n".join(
    ["Recorder 5000, 2024", "Rate;100", "Zeit;At left;Right", "ms;g;m/s²"]
    + [f"{1000 * t};{v};{-v}" for t, v in zip(INSTANTS, VALUES, strict=True)]
)
#: Names with blanks in them between tabs, and a remark.
TABS = "\n".join(
    ["# Zeit [s]\tForce at top [kN]\ta right [g]", "# made by hand"]
    + [f"{t}\t{v}\t{-v}" for t, v in zip(INSTANTS, VALUES, strict=True)]
)
#: An accelerogram, which its fourth line tells.
QUAKE = (
    "A LINE\nANOTHER\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 40, DT= .0100 SEC\n" + SAMPLES
)


@pytest.mark.parametrize(
    ("text", "kind", "keys"),
    [
        (MANY, "base_acceleration", {"column": "left [g]", "time": "t"}),
        (MANY, "base_acceleration", {"column": 3, "time": "clock [ms]", "unit": "m/s**2"}),
        (MANY, "force_newtons", {"column": "push", "time": 0}),
        (NAMELESS, "base_acceleration", {"column": 1, "time": 2, "unit": "g"}),
        (NAMELESS, "base_acceleration", {"column": 0, "time": 2, "unit": "1"}),
        (BELOW, "base_acceleration", {"column": "At left"}),
        (BELOW, "base_acceleration", {"column": "Right"}),
        (TABS, "force_newtons", {"column": "Force at top"}),
        (TABS, "base_acceleration", {"column": "a right [g]", "time": 0}),
        (SAMPLES, "base_acceleration", {"sampling_hz": 128, "unit": "mm/s^2"}),
        ("# a [g]\n" + SAMPLES, "force", {"sampling_hz": 30.5, "column": "a"}),
        ("dt = 0.01\n" + SAMPLES, "force", {"unit": "ft/s^2"}),
        (table("t,a"), "base_acceleration", {"unit": "g"}),
        (TURNED, "base_acceleration", {"column": "a", "time": "t"}),
        (table("v,a"), "force", {"column": 0, "sampling_hz": 10.0}),
        (QUAKE, "base_acceleration", {}),
        (QUAKE, "base_acceleration", {"column": "acceleration", "unit": "g"}),
    ],
)
def test_a_study_reads_what_the_package_reads(
    tmp_path: Path, text: str, kind: str, keys: dict[str, Any]
) -> None:
    path = written(tmp_path, text, "ground.csv")
    force = iva.Recorded.read(path, kind, **keys)  # type: ignore[arg-type]
    same = simulated(force)
    assert same.summary["amplitude_max"].item() > 0.0
    assert ran(tmp_path, kind, **keys).summary.equals(same.summary)
    # The resolved study is in another folder, and says all that the first one says.
    again = tmp_path / "again"
    resolved = tmp_path / "out" / "study.toml"
    assert _iva.main(["iva", "run", str(resolved), "--out", str(again), "--quiet"]) == 0
    assert iva.read(again).summary.equals(same.summary)


@pytest.mark.parametrize(
    ("text", "keys"),
    [
        (MANY, {}),
        (MANY, {"column": "left"}),
        (MANY, {"column": "rigth"}),
        (MANY, {"column": "pusch"}),
        (MANY, {"column": 6}),
        (MANY, {"column": "clock"}),
        (MANY, {"column": "push"}),
        (MANY, {"column": "push", "time": "push"}),
        (MANY, {"column": "push", "time": "left [g]"}),
        (MANY, {"column": "push", "time": "t", "sampling_hz": 5.0}),
        (MANY, {"column": "left [g]", "time": "t", "unit": "mm/s^2"}),
        (MANY, {"column": "left [g]", "time": "t", "unit": "V"}),
        (BELOW, {}),
        (BELOW, {"column": "Right", "unit": "g"}),
        (NAMELESS, {}),
        (NAMELESS, {"column": 3}),
        (NAMELESS, {"column": "a"}),
        (SAMPLES, {}),
        (SAMPLES, {"column": 0}),
        (table("t,a"), {"sampling_hz": 100.0}),
        (QUAKE, {"sampling_hz": 100.0}),
        (QUAKE, {"column": "velocity"}),
    ],
)
def test_a_study_refuses_in_the_words_of_the_package(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], text: str, keys: dict[str, Any]
) -> None:
    """What differs: fields have their section, quotes are double, and units are of the study."""
    path = written(tmp_path, text, "ground.csv")
    kind = "force_newtons" if "push" in keys.values() else "force"
    with pytest.raises(ValueError, match=r"^\w+ = ") as caught:
        iva.Recorded.read(path, kind, **keys)  # type: ignore[arg-type]
    words = re.sub(r"^(\w+) = None", r"\1 is missing", str(caught.value)).replace("'", '"')
    for ours, theirs in [
        ("give sampling_hz", "give force.sampling_hz"),
        ("those of the scene", "those of the study"),
        ("not a motion", "not a force"),
    ]:
        words = words.replace(ours, theirs)
    study = written(tmp_path, with_keys(kind, keys), "my.toml")
    assert _iva.main(["iva", "check", str(study)]) == 2
    said = " ".join(capfd.readouterr().err.split())
    assert f"force.{words}" in said


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"column": 1.5}, "force.column = 1.5: give the name of a column, in quotes, or its index"),
        (
            {"time": -1},
            "force.time = -1: give the name of a column, in quotes, or its",
        ),
        ({"unit": 3}, "force.unit = 3: give a unit, in quotes"),
        ({"sampling_hz": 0}, "force.sampling_hz = 0: give a number greater than 0, from 1e-30"),
        ({"colum": "a"}, "force.colum: no such key; did you mean `column`?"),
    ],
)
def test_keys_of_records_have_their_types(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], keys: dict[str, Any], message: str
) -> None:
    written(tmp_path, MANY, "ground.csv")
    study = written(tmp_path, with_keys("force", keys), "my.toml")
    assert _iva.main(["iva", "check", str(study)]) == 2
    assert message in " ".join(capfd.readouterr().err.split())


def test_keys_of_records_need_a_record(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    text = with_keys("force", {"column": "a"}).replace('record = "ground.csv"\n', "")
    study = written(tmp_path, text.replace('kind = "force"\n', ""), "my.toml")
    assert _iva.main(["iva", "check", str(study)]) == 2
    said = " ".join(capfd.readouterr().err.split())
    assert "force.column is one of a record: give record, the name of a file" in said


def test_records_of_earlier_results_are_read_without_asking(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """A record made in Python, and its file as it was written before it had a unit in its head."""
    out, again = tmp_path / "out", tmp_path / "again"
    found = iva.sweep(
        iva.Siva(mass=20.0, restitution=0.6, gap_mm=20.0),
        iva.Primary(mass=200.0, stiffness=16e3, damping=30.0),
        start=iva.Start(),
        force=iva.Recorded(INSTANTS, VALUES, "base_acceleration"),
        over={"restitution": [0.5, 0.6]},
        duration=2.0,
        out=out,
    )
    record, resolved = out / "inputs" / "record-0.csv", out / "study.toml"
    text = record.read_text(encoding="utf-8")
    assert text.startswith("time,value (1)\n")
    record.write_text(text.replace("value (1)", "value"), encoding="utf-8")
    for study, folder in ((resolved, again), (again / "study.toml", tmp_path / "third")):
        assert _iva.main(["iva", "sweep", str(study), "--out", str(folder), "--quiet"]) == 0
        assert iva.read(folder).summary.equals(found.summary)
    # Of a study that somebody has written nobody knows that.
    own = resolved.read_text(encoding="utf-8").replace("# Resolved by", "# After that of")
    resolved.write_text(own, encoding="utf-8")
    capfd.readouterr()
    assert _iva.main(["iva", "check", str(resolved)]) == 2
    assert "may be in m/s^2 or in g; give force.unit" in capfd.readouterr().err
