"""Impulses, recorded forces, sums of forces, and the columns of steady states."""

from __future__ import annotations

import copy
import math
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import iva
from iva import _iva

SIVA = iva.Siva(mass_ratio=0.05, clearance=2.0, restitution=0.8)
PIVA = iva.Piva(mass_ratio=0.1, clearance=1.0, restitution=0.6, frequency_ratio=0.4, length=4.0)
PRIMARY = iva.Primary(damping_ratio=0.02)
HARMONIC = iva.Harmonic(amplitude=0.1, frequency=1.0)
RAMP = iva.Recorded([0.0, 1.0, 3.0], [0.0, 0.5, 0.0])


def driven(force: Any, absorber: Any = SIVA, primary: Any = PRIMARY, **arguments: Any) -> iva.Run:
    given: dict[str, Any] = {"start": iva.Start(), "duration": 60.0} | arguments
    return iva.simulate(absorber, primary, force=force, **given)


def test_the_stable_orbit_has_its_columns() -> None:
    # Masri and Caughey (1966): from rest this scene locks to two impacts a cycle, largest |x| from
    # the closed form; without absorber it swings by F/(2ζ) = 2.5.
    run = driven(HARMONIC, duration=None, cycles=700, discard=600)
    row = run.summary.row(0, named=True)
    assert row["amplitude_max"] == pytest.approx(0.3532853191886, rel=0, abs=1e-9)
    assert row["reduction"] == pytest.approx(1 - row["amplitude_max"] / 2.5, rel=0, abs=1e-15)
    assert row["regime"] == "2:1"
    assert row["impacts_per_cycle"] == pytest.approx(2.0)
    assert row["transmissibility"] is None
    assert row["residual_amplitude"] is None
    strobes = run.stroboscope
    assert strobes["cycle"].to_list() == list(range(600, 701))
    assert strobes["time"].to_numpy() == pytest.approx(2 * math.pi * np.arange(600, 701), rel=1e-15)
    assert set(strobes["impacts"][1:]) == {2}
    # The states of the table are those of the motion at these instants.
    states = run.at(strobes["time"][:-1])
    for name in ("displacement", "velocity", "gap_displacement", "gap_velocity"):
        assert strobes[name][:-1].to_numpy() == pytest.approx(states[name].to_numpy(), abs=1e-12)
    assert strobes["displacement"].to_numpy().std() < 1e-9
    told = "amplitude_max 0.3533 units of length, without absorber 2.5 units of length"
    assert f"{told}, reduction 0.8587, impacts_per_cycle 2\n" in repr(run)


def test_free_decay_has_none_of_them() -> None:
    run = iva.simulate(SIVA, PRIMARY, start=iva.Start(displacement=3.0), periods=3)
    row = run.summary.row(0, named=True)
    names = (
        "amplitude_max amplitude_rms reduction transmissibility impacts_per_cycle regime".split()
    )
    assert [row[name] for name in names] == [None] * 6
    assert run.stroboscope.height == 0


def test_transmissibility_of_the_bare_structure() -> None:
    # T = √((1 + (2ζr)²)/((1 − r²)² + (2ζr)²)); the gap is out of reach.
    siva = iva.Siva(mass_ratio=0.05, clearance=1e6, restitution=0.8)
    primary = iva.Primary(damping_ratio=0.1)
    for r in (0.5, 1.0, 2.0):
        base = iva.Harmonic(base_acceleration=0.3, frequency=r)
        run = driven(base, siva, primary, duration=None, cycles=200, discard=150)
        row = run.summary.row(0, named=True)
        truth = math.sqrt((1 + (0.2 * r) ** 2) / ((1 - r * r) ** 2 + (0.2 * r) ** 2))
        assert row["transmissibility"] == pytest.approx(truth, rel=1e-12)
        assert row["reduction"] == pytest.approx(0.0, abs=1e-12)
        assert row["regime"] == "no_impacts"


@pytest.mark.parametrize(
    "absorber", [iva.Siva(mass_ratio=0.1, clearance=0.5, restitution=0.6), PIVA]
)
def test_units_change_nothing(absorber: Any) -> None:
    # 2 kg at 9 rad/s: force in N over mass, time in s; lengths are the same.
    omega, mass = 9.0, 2.0
    primary = iva.Primary(mass=mass, natural_frequency=omega, damping_ratio=0.02)
    points = [0.0, 4.0, 9.0, 30.0], [0.0, 0.7, -0.6, 0.2]
    scaled = [time / omega for time in points[0]], [value * omega**2 for value in points[1]]
    natural = driven([iva.Recorded(*points), iva.Impulse(velocity=0.4, time=5.0)], absorber)
    newtons = [value * mass for value in scaled[1]]
    for forces in (
        [iva.Recorded(*scaled), iva.Impulse(velocity=0.4 * omega, time=5.0 / omega)],
        [
            iva.Recorded(scaled[0], newtons, "force_newtons"),
            iva.Impulse(impulse=0.4 * omega * mass, time=5.0 / omega),
        ],
        [
            iva.Recorded(scaled[0], [value / 4 for value in scaled[1]], "force", scale=4),
            iva.Impulse(impulse=0.4 * omega * mass, time=5.0 / omega),
        ],
    ):
        run = driven(forces, absorber, primary, duration=60.0 / omega)
        assert run.impacts.height == natural.impacts.height > 2
        times = run.impacts["time"].to_numpy() * omega
        assert times == pytest.approx(natural.impacts["time"].to_numpy(), rel=1e-9)


def test_a_list_is_a_sum() -> None:
    one = driven(iva.Harmonic(amplitude=0.2, frequency=1.0))
    two = driven([HARMONIC, HARMONIC])
    assert two.impacts["time"].to_numpy() == pytest.approx(
        one.impacts["time"].to_numpy(), rel=0, abs=1e-9
    )
    assert driven([]) == iva.simulate(SIVA, PRIMARY, start=iva.Start(), duration=60.0)
    assert driven([HARMONIC]).impacts.equals(driven(HARMONIC).impacts)


def test_a_sweep_over_one_of_several_forces() -> None:
    table = iva.sweep(
        SIVA,
        PRIMARY,
        start=iva.Start(),
        force=[RAMP, iva.Harmonic(amplitude=0.1)],
        over={"force.1.frequency": [0.9, 1.0], "force.0.scale": [1.0, 2.0]},
        duration=60,
        tables=("summary", "stroboscope"),
    )
    forces = [RAMP, iva.Harmonic(amplitude=0.1, frequency=1.0)]
    assert table.summary["energy_work"][2] == driven(forces).summary["energy_work"].item()
    doubled = [iva.Recorded(RAMP.times, RAMP.values, scale=2), forces[1]]
    assert table.summary["energy_work"][3] == driven(doubled).summary["energy_work"].item()
    assert table.stroboscope["point"].unique().to_list() == [0, 1, 2, 3]


def test_records_are_values() -> None:
    same = iva.Recorded((0, 1, 3), np.array([0, 0.5, 0]))
    assert same == RAMP
    assert hash(same) == hash(RAMP)
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        assert pickle.loads(pickle.dumps(RAMP, protocol)) == copy.deepcopy(RAMP) == RAMP
    with pytest.raises(AttributeError, match="make another"):
        RAMP.scale = 2.0
    # Too small to matter, and no fault: the tail of a pulse.
    assert iva.Recorded([0, 1, 3], [1e-300, 0.5, 1e-317]) == RAMP
    assert iva.Recorded([0, 1, 3], [0, 0.5, 0.1]) != RAMP
    assert iva.Recorded([0, 1, 3], [0, 0.5, 0], "base_acceleration") != RAMP
    assert iva.Recorded([0, 1, 3], [0, 0.5, 0], scale=2) != RAMP
    assert repr(RAMP) == "Recorded(3 points from 0 to 3, largest value 0.5, kind='force')"
    run = driven([RAMP, HARMONIC])
    assert pickle.loads(pickle.dumps(run)) == run
    assert pickle.loads(pickle.dumps(run)).force == (RAMP, HARMONIC)
    assert run != driven([RAMP, RAMP])
    assert "Recorded(3 points" in run._repr_html_()


QUAKE = Path(__file__).parents[2] / "studies" / "synthetic_quake.at2"


def test_a_record_of_a_file(tmp_path: Path) -> None:
    quake = iva.Recorded.read(QUAKE)
    assert quake.kind == "base_acceleration"
    assert len(quake.times) == 1000
    # 0.3 g, as the file says, in m/s².
    assert abs(quake.values).max() == pytest.approx(0.3 * 9.80665, rel=1e-7)
    columns = tmp_path / "quake.csv"
    rows = zip(quake.times.tolist(), quake.values.tolist(), strict=True)
    columns.write_text("".join(f"{time!r},{value!r}\n" for time, value in rows), encoding="utf-8")
    assert iva.Recorded.read(columns).kind == "force"
    same = iva.Recorded.read(str(columns), "base_acceleration")
    assert same.values.tolist() == quake.values.tolist()
    # Only the AT2 file says that it is in s and m/s².
    assert driven(same).summary["outcome"].item() == "finished"
    with pytest.raises(ValueError, match="its times are in s; give"):
        driven(quake)
    with pytest.raises(iva.IvaError, match=r"missing\.csv"):
        iva.Recorded.read(tmp_path / "missing.csv")
    columns.write_text("0, 1\n1, 2\n1, 3\n", encoding="utf-8")
    with pytest.raises(ValueError, match=r"quake\.csv:3:1: time 1.0 follows 1.0"):
        iva.Recorded.read(columns)


STUDY = """version = 1
[primary]
mass = 10000
frequency_hz = 1.5
damping_ratio = 0.02
[absorber]
kind = "siva"
mass_ratio = 0.05
restitution = 0.6
clearance_mm = 90
[[force]]
record = "quake.at2"
kind = "base_acceleration"
[[force]]
impulse = 2000
time = 1.0
[run]
duration = 40
"""


def test_a_study_with_several_forces_is_the_same_run(tmp_path: Path) -> None:
    (tmp_path / "quake.at2").write_bytes(QUAKE.read_bytes())
    study, out, again = (tmp_path / name for name in ("my.toml", "out", "again"))
    study.write_text(STUDY, encoding="utf-8")
    assert _iva.main(["iva", "run", str(study), "--out", str(out), "--quiet"]) == 0
    same = iva.simulate(
        iva.Siva(mass_ratio=0.05, restitution=0.6, clearance_mm=90),
        iva.Primary(mass=10000, frequency_hz=1.5, damping_ratio=0.02),
        start=iva.Start(),
        force=[iva.Recorded.read(QUAKE), iva.Impulse(impulse=2000, time=1)],
        duration=40,
    )
    assert iva.read(out).impacts.equals(same.impacts)
    assert iva.read(out).summary.equals(same.summary)
    # The resolved study stands elsewhere and still finds the record.
    resolved = str(out / "study.toml")
    assert _iva.main(["iva", "run", resolved, "--out", str(again), "--quiet"]) == 0
    assert (again / "study.toml").read_bytes() == (out / "study.toml").read_bytes()
    assert iva.read(again).summary.equals(iva.read(out).summary)


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ('"quake.at2"', '"none.at2"', 12, 'force.record = "none.at2": it cannot be read: No such'),
        ('"quake.at2"', "3", 12, "force.record = 3: give the name of a file, in quotes"),
        ('"base_acceleration"', '"base"', 13, 'did you mean "base_acceleration"?'),
        ('kind = "base_acceleration"\n', "", 12, "force.kind is missing"),
        ("impulse = 2000", "amplitude = 1", 15, "force.1.amplitude = 1: that is of a harmonic"),
        ("impulse = 2000\ntime = 1.0", "amplitude = 1", 14, "force.1.frequency is missing"),
        ("impulse = 2000", "impulse = 2000\nphase = 1", 16, "force.1.phase = 1: that is of a"),
        ("impulse = 2000", "impuls = 2000", 15, "did you mean `impulse`?"),
        ("time = 1.0", "time = -1.0", 16, "force.1.time = -1.0: give 0 or a number"),
        ("time = 1.0", "velocity = 1.0", 15, "force.1.velocity is given as well"),
        ("duration = 40", "cycles = 40", 18, "run.cycles = 40: it counts cycles of a harmonic"),
        ("mass = 10000\n", "", 14, "force.1.impulse = 2000: give primary.mass"),
    ],
)
def test_faults_of_a_study_are_shown_at_their_line(
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
    old: str,
    new: str,
    line: int,
    message: str,
) -> None:
    (tmp_path / "quake.at2").write_bytes(QUAKE.read_bytes())
    text = STUDY.replace("clearance_mm = 90", "clearance = 0.09")
    assert text.count(old) == 1
    study = tmp_path / "my.toml"
    study.write_text(text.replace(old, new), encoding="utf-8")
    code = _iva.main(["iva", "check", str(study)])
    error = capfd.readouterr().err
    assert code == 2
    assert message in error
    assert f"my.toml:{line}:" in error


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: iva.Recorded([0, 1, 1], [0, 1, 2]), r"times\[2\] = 1: it must be later"),
        (lambda: iva.Recorded([0, 1], [0, math.nan]), r"values\[1\] = NaN: give"),
        (lambda: iva.Recorded([0, math.inf], [0, 1]), r"times\[1\] = inf: give"),
        (lambda: iva.Recorded([0, 1], [0, 1, 2]), "there are 3 values"),
        (lambda: iva.Recorded([0], [0]), "two points or more"),
        (lambda: iva.Recorded([0, 1], [0, 1], kind="n"), 'kind = "n": give one of "force"'),  # type: ignore[arg-type]
        (lambda: iva.Recorded([0, 1], [0, 1], scale=math.nan), r"force\.scale = NaN"),
        (lambda: iva.Impulse(velocity=1, impulse=1), "give one of them"),
        (lambda: iva.Impulse(velocity=1, time=-1), r"force\.time = -1: give 0 or"),
        (lambda: driven(iva.Impulse(time=1)), r"force\.velocity is missing"),
        (lambda: driven(iva.Impulse()), r"force\.velocity is missing"),
        (lambda: driven(iva.Impulse(impulse=1)), "needs? primary.mass|give primary.mass"),
        (
            lambda: driven(iva.Recorded([0, 1], [0, 1], "force_newtons")),
            r"force\.kind = \"force_newtons\": values in N need primary\.mass",
        ),
        (lambda: driven(RAMP, duration=None, cycles=3), r"run\.cycles = 3: it counts cycles"),
        (lambda: driven(RAMP, discard=3), r"run\.discard = 3: it counts cycles"),
        (
            lambda: driven(HARMONIC, duration=None, cycles=3, discard=3),
            r"run\.discard = 3: the run has 3 cycles",
        ),
        (lambda: driven(HARMONIC, cycles=3), r"run\.cycles = 3: run\.duration is given as well"),
    ],
)
def test_bad_values_are_named(make: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message) as caught:
        make()
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: driven([HARMONIC, 3]), r"force\[1\] = 3: give an iva\.Harmonic"),
        (lambda: driven("quake.at2"), "force = 'quake.at2': give"),
        (lambda: iva.Recorded("times", [1, 2]), "times = 'times': give a one-dimensional"),  # type: ignore[arg-type]
        (lambda: iva.Recorded([0, "a"], [1, 2]), r"times\[1\] = 'a': give a number"),  # type: ignore[list-item]
        (lambda: iva.Recorded([0, 1], [1, 2], 3), "kind = 3: give a word"),  # type: ignore[arg-type]
        (lambda: iva.Recorded.read(3), "path = 3: give the name"),  # type: ignore[arg-type]
    ],
)
def test_wrong_types_are_named(make: Any, message: str) -> None:
    with pytest.raises(TypeError, match=message):
        make()


@pytest.mark.parametrize("key", ["force.frequency", "force.2.frequency"])
def test_an_axis_over_a_force_that_is_not_there(key: str) -> None:
    with pytest.raises(ValueError, match="there are 2 forces"):
        iva.sweep(
            SIVA,
            PRIMARY,
            start=iva.Start(),
            force=[RAMP, HARMONIC],
            over={key: [1.0]},
            duration=1,
        )


def test_tables_that_are_not_asked_for_are_not_made() -> None:
    run = driven(HARMONIC, tables=["stroboscope"])
    assert run.stroboscope.height > 0
    assert run.summary.equals(driven(HARMONIC).summary)
    assert pickle.loads(pickle.dumps(run)) == run
    with pytest.raises(AttributeError, match=r"no table 'impacts': ask for it with tables="):
        run.impacts  # noqa: B018
    assert "impacts" in repr(driven(HARMONIC, tables=[]))
    with pytest.raises(ValueError, match="tables"):
        driven(HARMONIC, tables=["impact"])


MEMORY = """
import resource, sys, iva
siva = iva.Siva(mass_ratio=0.05, clearance=2.0, restitution=0.8)
force = iva.Harmonic(amplitude=0.1, frequency=1.0)
run = iva.simulate(siva, iva.Primary(damping_ratio=0.02), start=iva.Start(), force=force,
                   cycles=int(sys.argv[1]), discard=100, tables=[])
assert run.summary["regime"].item() == "2:1"
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere the unit is another, or none")
def test_a_long_run_takes_no_more_memory() -> None:
    def peak(cycles: int) -> int:
        command = [sys.executable, "-c", MEMORY, str(cycles)]
        done = subprocess.run(command, capture_output=True, check=True, text=True)
        return int(done.stdout)

    # In kB. The impacts of the longer run alone would be some 5 MB.
    assert peak(20_000) - peak(200) < 2000
