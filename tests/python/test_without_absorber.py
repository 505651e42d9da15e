"""A structure without absorber: closed forms, tables, and what is refused.

Unless a line says otherwise ωn = M = 1. The equation is ẍ + 2ζẋ + x = f/M.
"""

from __future__ import annotations

import copy
import dataclasses
import math
import pickle
import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from numpy.typing import NDArray
from polars.testing import assert_frame_equal

import iva
from axes_seen import STRUCTURE
from iva import _iva, design

Array = NDArray[np.float64]
LET_GO = iva.Start(displacement=1.0)
TABLES = ("summary", "impacts", "episodes", "envelope", "stroboscope", "absorbers")
GAP = ["gap_displacement", "gap_velocity", "angle", "angular_velocity"]


def alone(damping_ratio: float = 0.02, **given: Any) -> iva.Run:
    """Return a run of the structure alone."""
    arguments: dict[str, Any] = {"start": LET_GO} | given
    if not {"periods", "duration", "cycles"} & set(given):
        arguments["periods"] = 30
    return iva.simulate(None, iva.Primary(damping_ratio=damping_ratio), **arguments)


def free(zeta: float, t: Array, x: float = 1.0, v: float = 0.0) -> tuple[Array, Array]:
    """Return displacement and velocity of an underdamped structure that is let go."""
    omega = math.sqrt(1.0 - zeta**2)
    swing = (v + zeta * x) / omega
    cosine, sine, fading = np.cos(omega * t), np.sin(omega * t), np.exp(-zeta * t)
    moved = fading * (x * cosine + swing * sine)
    speed = fading * (v * cosine - (zeta * swing + omega * x) * sine)
    return moved, speed


@pytest.mark.parametrize("zeta", [0.0, 0.01, 0.2, 0.9])
def test_free_decay(zeta: float) -> None:
    run = alone(zeta, start=iva.Start(displacement=0.7, velocity=-0.4), periods=10)
    motion = run.trajectory(50)
    instants = np.linspace(0.0, 20.0 * math.pi, 97)
    # 500 steps and the end.
    assert motion.height in (501, 502)
    for states in (motion, run.at(instants)):
        x, v = free(zeta, states["time"].to_numpy(), 0.7, -0.4)
        assert np.allclose(states["displacement"], x, rtol=0, atol=1e-13)
        assert np.allclose(states["velocity"], v, rtol=0, atol=1e-13)


def test_free_decay_of_critical_and_greater_damping() -> None:
    t = np.linspace(0.0, 4.0 * math.pi, 33)
    # (1 + t) exp(−t), and two exponentials with the rates 2 ± √3.
    fast, slow = 2.0 + math.sqrt(3.0), 2.0 - math.sqrt(3.0)
    over = (fast * np.exp(-slow * t) - slow * np.exp(-fast * t)) / (fast - slow)
    for zeta, expected in ((1.0, (1.0 + t) * np.exp(-t)), (2.0, over)):
        found = alone(zeta, periods=2).at(t)["displacement"]
        assert np.allclose(found, expected, rtol=0, atol=1e-14)


def test_free_decay_in_si_units() -> None:
    mass, stiffness, damping = 3.0, 12_000.0, 2.0
    run = iva.simulate(None, STRUCTURE, start=iva.Start(displacement_mm=4.0), duration=2.0)
    omega = math.sqrt(stiffness / mass)
    zeta = damping / (2.0 * mass * omega)
    motion = run.trajectory(60)
    x, v = free(zeta, omega * motion["time"].to_numpy())
    assert np.allclose(motion["displacement"], 4e-3 * x, rtol=0, atol=1e-15)
    assert np.allclose(motion["velocity"], 4e-3 * omega * v, rtol=0, atol=1e-13)
    row = run.summary.row(0, named=True)
    assert row["energy_initial"] == pytest.approx(0.5 * stiffness * 4e-3**2, rel=1e-14)
    # Peaks fall by exp(−2πζ/√(1 − ζ²)) a cycle: the damping ratio follows from them.
    assert row["damping_ratio_3"] == pytest.approx(zeta, rel=1e-9)
    assert run.units["trajectory"]["displacement"] == "m"


def test_columns_of_an_absorber_are_empty() -> None:
    bare = alone()
    with_absorber = iva.simulate(
        iva.Siva(mass_ratio=0.1, clearance=0.5, restitution=0.5),
        iva.Primary(damping_ratio=0.02),
        start=LET_GO,
        periods=30,
    )
    for name in TABLES:
        assert getattr(bare, name).schema == getattr(with_absorber, name).schema
    assert bare.impacts.height == bare.episodes.height == bare.stroboscope.height == 0
    assert bare.envelope.height == 60
    row = bare.summary.row(0, named=True)
    assert row["outcome"] == "finished"
    for name in ("impacts", "effective_impacts", "episodes", "undecided", "time_stuck"):
        assert row[name] == 0, name
    assert row["stop_reachable"] is row["gravity"] is None
    assert row["energy_impacts"] == row["energy_pivot"] == row["energy_work"] == 0.0
    assert row["energy_initial"] == 0.5
    assert abs(row["energy_residual"]) < 1e-14
    assert row["damping_ratio_1"] == pytest.approx(0.02, rel=1e-12)
    for states in (bare.trajectory(20), bare.at([0.0, 3.0])):
        assert states.columns == with_absorber.at([0.0]).columns
        assert [states[name].null_count() for name in GAP] == [states.height] * 4
        assert set(states["wall"]) == {0}
    numbers = design.design_of(bare)
    assert (numbers.mass_ratio, numbers.clearance, numbers.pendulum) == (None, None, None)
    assert (numbers.mass, numbers.natural_frequency, numbers.damping_ratio) == (1.0, 1.0, 0.02)


def response(zeta: float, ratio: float) -> float:
    """Return the amplitude of the steady state under a unit force."""
    return 1.0 / math.hypot(1.0 - ratio**2, 2.0 * zeta * ratio)


# With ζ = 0.05 a transient is below 1e-13 after 100 cycles, for Ω up to 1.1.
STEADY: dict[str, Any] = {"cycles": 160, "discard": 100}


@pytest.mark.parametrize("ratio", [0.5, 0.9, 1.0, 1.1])
@pytest.mark.parametrize("of", ["amplitude", "base_acceleration"])
def test_a_harmonic_force(of: str, ratio: float) -> None:
    zeta, size = 0.05, 0.3
    force = iva.Harmonic(relative_frequency=ratio, phase=0.4, **{of: size})
    run = alone(zeta, force=force, **STEADY)
    row = run.summary.row(0, named=True)
    expected = size * response(zeta, ratio)
    assert row["amplitude_max"] == pytest.approx(expected, rel=1e-9)
    assert row["amplitude_rms"] == pytest.approx(expected / math.sqrt(2.0), rel=1e-9)
    assert row["reduction"] is None
    assert row["regime"] == "no_impacts"
    assert row["impacts_per_cycle"] == 0.0
    if of == "amplitude":
        assert row["transmissibility"] is None
    else:
        through = math.hypot(1.0, 2.0 * zeta * ratio) * response(zeta, ratio)
        assert row["transmissibility"] == pytest.approx(through, rel=1e-9)
    assert abs(row["energy_residual"]) < 1e-12 * (1.0 + row["energy_work"])
    strobes = run.stroboscope
    assert strobes.height in (60, 61)
    assert strobes["gap_displacement"].null_count() == strobes.height
    assert strobes["gap_velocity"].null_count() == strobes.height
    assert strobes["displacement"].to_numpy().std() < 1e-12
    assert set(strobes["impacts"]) == {0}


def test_without_damping_at_resonance() -> None:
    # ẍ + x = F cos t from rest: x = F t sin(t)/2.
    run = alone(0.0, start=iva.Start(), force=iva.Harmonic(amplitude=0.2, frequency=1.0), cycles=10)
    t = np.linspace(0.0, 20.0 * math.pi, 41)
    assert np.allclose(run.at(t)["displacement"], 0.1 * t * np.sin(t), rtol=0, atol=1e-12)


def test_an_impulse() -> None:
    zeta, kick, at = 0.1, 0.5, 2.0
    blow = iva.Impulse(velocity=kick, time=at)
    run = alone(zeta, start=iva.Start(), force=blow, duration=20.0)
    t = np.linspace(0.0, 18.0, 37)
    x, v = free(zeta, t, 0.0, kick)
    after = run.at(at + t)
    assert np.allclose(after["displacement"], x, rtol=0, atol=1e-14)
    assert np.allclose(after["velocity"], v, rtol=0, atol=1e-14)
    assert run.at([1.0])["displacement"].item() == 0.0
    assert run.summary["energy_work"].item() == pytest.approx(0.5 * kick**2, rel=1e-14)


def test_a_recorded_force() -> None:
    # A constant force from time zero on: x = F (1 − what a structure let go from 1 does).
    zeta, size = 0.1, 0.3
    step = iva.Recorded([0.0, 100.0], [size, size])
    run = alone(zeta, start=iva.Start(), force=step, duration=30.0)
    t = np.linspace(0.0, 30.0, 61)
    x, v = free(zeta, t)
    states = run.at(t)
    assert np.allclose(states["displacement"], size * (1.0 - x), rtol=0, atol=1e-13)
    assert np.allclose(states["velocity"], -size * v, rtol=0, atol=1e-13)
    assert run.summary["reduction"].item() is None


def test_it_is_the_structure_of_a_gap_that_is_never_closed() -> None:
    for force in (None, iva.Harmonic(amplitude=0.1, relative_frequency=0.97)):
        wide = iva.simulate(
            iva.Siva(mass_ratio=0.1, clearance=1e3, restitution=0.5),
            iva.Primary(damping_ratio=0.02),
            start=LET_GO,
            force=force,
            periods=20,
        )
        run = alone(force=force, periods=20)
        for name in ("displacement", "velocity"):
            assert np.allclose(
                run.trajectory(40)[name], wide.trajectory(40)[name], rtol=0, atol=1e-12
            )
        assert np.allclose(run.envelope["time"], wide.envelope["time"], rtol=0, atol=1e-11)


def test_verified() -> None:
    run = alone(verify=True, errors=True)
    found = run.verification
    assert found.agrees
    assert found.findings["table"].to_list() == list(TABLES)
    assert found.impacts.height == 0
    assert found.envelope["displacement"].abs().max() < 1e-14  # type: ignore[operator]
    assert abs(found.summary["energy_final"].item()) < 1e-15
    # There is no impact time, and so no error of one.
    assert run.summary["condition"].item() is run.summary["digits"].item() is None
    assert "Verification: the same events" in repr(found)


def test_verified_under_force() -> None:
    force = iva.Harmonic(amplitude=0.1, relative_frequency=0.9)
    found = alone(0.05, force=force, cycles=40, verify=True).verification
    assert found.agrees
    assert abs(found.summary["amplitude_max"].item()) < 1e-13


def test_gradients() -> None:
    zeta, ratio, size = 0.05, 0.9, 0.3
    force = iva.Harmonic(amplitude=size, relative_frequency=ratio)
    by = ("damping_ratio", "force.amplitude", "force.relative_frequency")
    gradients = alone(zeta, force=force, gradients=by, **STEADY).gradients
    # A = F/√D with D = (1 − Ω²)² + (2ζΩ)².
    unit = response(zeta, ratio)
    slopes = {
        "damping_ratio": -size * unit**3 * 4.0 * zeta * ratio**2,
        "force.amplitude": unit,
        "force.relative_frequency": -size
        * unit**3
        * (4.0 * zeta**2 * ratio - 2.0 * ratio * (1.0 - ratio**2)),
    }
    for name, slope in slopes.items():
        found = gradients[name].summary["amplitude_max"].item()
        assert found == pytest.approx(slope, rel=1e-7), name
        assert gradients[name].summary["sensitive_from"].item() is None
    # Of free decay: x = exp(−ζt) (cos + …) grows with the start.
    decay = alone(gradients=("displacement",))
    peaks = decay.gradients["displacement"].envelope["amplitude"]
    assert np.allclose(peaks, decay.envelope["amplitude"], rtol=1e-12, atol=0)


def test_a_run_that_is_cut_short() -> None:
    force = iva.Harmonic(amplitude=0.1, relative_frequency=0.9)
    run = alone(force=force, cycles=50, max_work=3)
    assert run.summary["outcome"].item() == "work_limit"
    states = run.at([0.0, 300.0])
    assert states["displacement"].to_list() == [1.0, None]
    assert states["wall"].to_list() == [0, None]


# A sweep of the structure alone.
RATIOS = [0.01, 0.05, 0.2]


def test_a_sweep_has_a_row_a_point() -> None:
    table = iva.sweep(
        None,
        iva.Primary(),
        over={"damping_ratio": RATIOS},
        start=LET_GO,
        periods=20,
        tables=TABLES,
    )
    assert table.tables == TABLES
    assert table.summary["damping_ratio"].to_list() == RATIOS
    assert table.summary["outcome"].to_list() == ["finished"] * 3
    assert table.summary["damping_ratio_1"].to_numpy() == pytest.approx(RATIOS, rel=1e-9)
    assert table.summary["impacts"].to_list() == [0] * 3
    assert table.summary["stop_reachable"].null_count() == 3
    assert table.impacts.height == table.episodes.height == table.stroboscope.height == 0
    assert set(table.envelope["point"]) == {0, 1, 2}
    # The same bits as in runs of their own.
    for point, zeta in enumerate(RATIOS):
        run = alone(zeta, periods=20)
        row = table.summary.filter(point=point).drop("point", "damping_ratio")
        assert_frame_equal(row, run.summary.drop("point"), check_exact=True)
        peaks = table.envelope.filter(point=point).drop("point")
        assert_frame_equal(peaks, run.envelope.drop("point"), check_exact=True)
    again = pickle.loads(pickle.dumps(table))
    assert again == table == copy.deepcopy(table)
    assert "Table over damping_ratio" in repr(table)


def test_a_sweep_under_force_with_threads() -> None:
    frequencies = np.linspace(0.8, 1.2, 41)

    def on(threads: int) -> iva.Table:
        return iva.sweep(
            None,
            iva.Primary(damping_ratio=0.05),
            over={"force.relative_frequency": frequencies, "displacement": [0.0, 1.0]},
            start=iva.Start(),
            force=iva.Harmonic(amplitude=0.3),
            threads=threads,
            **STEADY,
        )

    table = on(1)
    expected = [0.3 * response(0.05, ratio) for ratio in frequencies for _ in range(2)]
    assert table.summary["amplitude_max"].to_numpy() == pytest.approx(expected, rel=1e-9)
    assert table.summary["reduction"].null_count() == table.summary.height
    assert on(2) == table


def test_a_sample_and_a_frame_of_points() -> None:
    scene: dict[str, Any] = {"start": LET_GO, "periods": 10}
    sampled = iva.sweep(
        None,
        iva.Primary(),
        over={"damping_ratio": iva.sampling.Uniform(0.01, 0.1)},
        sampling=iva.sampling.Sobol(16),
        **scene,
    )
    assert sampled.summary.height == 16
    points = sampled.summary.select("damping_ratio")
    framed = iva.sweep(None, iva.Primary(), over=points, **scene)
    assert_frame_equal(framed.summary, sampled.summary, check_exact=True)


STUDY = """version = 1
[primary]
damping_ratio = 0.02
[absorber]
kind = "none"
[start]
displacement = 1.0
[run]
periods = 10
tables = ["summary", "impacts", "envelope"]
[sweep]
damping_ratio = [0.01, 0.05, 0.2]
"""


def test_folders_and_studies(tmp_path: Path) -> None:
    scene: dict[str, Any] = {
        "over": {"damping_ratio": RATIOS},
        "start": LET_GO,
        "periods": 10,
        "tables": ("summary", "impacts", "envelope"),
    }
    table = iva.sweep(None, iva.Primary(damping_ratio=0.02), out=tmp_path / "out", **scene)
    assert table == iva.sweep(None, iva.Primary(damping_ratio=0.02), **scene)
    written = tomllib.loads((tmp_path / "out" / "study.toml").read_text(encoding="utf-8"))
    assert written["absorber"] == {"kind": "none"}
    assert not {"gap_displacement", "gap_velocity"} & set(written["start"])
    assert not {"chatter_floor", "tolerance"} & set(written["run"])
    file = tmp_path / "alone.toml"
    file.write_text(STUDY, encoding="utf-8")
    shell = tmp_path / "shell"
    assert _iva.main(["iva", "check", str(file)]) == 0
    assert _iva.main(["iva", "sweep", str(file), "--out", str(shell), "--quiet"]) == 0
    assert iva.read(shell) == table
    # What was written can be run again, and a point of it by itself.
    resolved, point = str(shell / "study.toml"), tmp_path / "point"
    words = ["iva", "run", resolved, "--point", "1", "--out", str(point), "--quiet"]
    assert _iva.main(words) == 0
    motion = iva.read(point).trajectory
    assert_frame_equal(motion, alone(0.05, periods=10).trajectory(), check_exact=True)


def refused(call: Callable[[], object], name: str) -> None:
    """Check that one sentence names a field."""
    with pytest.raises(ValueError, match=re.escape(name)) as caught:
        call()
    assert "\n" not in str(caught.value)


OF_ABSORBERS = [
    field.name
    for field in dataclasses.fields(iva.Piva)
    if field.name not in (*iva.Piva._words, *iva.Piva._tables)
]
VALUES = {"tolerance": 1e-6, "gap_displacement": 0.0, "gap_velocity": 0.0, "angle": 0.0}


def swept(key: str, value: float) -> Callable[[], object]:
    return lambda: iva.sweep(None, iva.Primary(), over={key: [value]}, start=LET_GO, periods=1)


@pytest.mark.parametrize("name", GAP)
def test_a_start_has_no_gap(name: str) -> None:
    # Not even 0, which a start in the middle of a gap would have.
    start: Any = {"displacement": 1.0, name: VALUES.get(name, 0.1)}
    refused(lambda: alone(start=iva.Start(**start)), f"start.{name} = ")
    refused(swept(f"start.{name}", 0.1), f"start.{name}")
    refused(lambda: alone(gradients=(f"start.{name}",)), f"start.{name}")


@pytest.mark.parametrize("name", ["chatter_floor", "tolerance"])
def test_a_run_has_no_setting_of_absorbers(name: str) -> None:
    value = VALUES.get(name, 1e-3)
    refused(lambda: alone(**{name: value}), f"run.{name} = ")
    refused(swept(f"run.{name}", value), f"run.{name}")
    refused(lambda: alone(gradients=(f"run.{name}",)), f"run.{name}")


@pytest.mark.parametrize("name", OF_ABSORBERS)
def test_no_number_of_an_absorber_can_be_swept(name: str) -> None:
    refused(swept(f"absorber.{name}", 1.0), f"absorber.{name}")
    refused(lambda: alone(gradients=(f"absorber.{name}",)), f"absorber.{name}")
    spec = {"absorber.kind": "none", f"absorber.{name}": 1.0, "run.periods": 1.0}
    refused(lambda: _iva.states(spec, []), f"absorber.{name} = 1")


def test_words_of_a_pendulum_are_refused() -> None:
    for name in iva.Piva._words:
        word = {"angles": "small", "impact_law": "printed", "walls": "plus"}[name]
        spec = {"absorber.kind": "none", f"absorber.{name}": word, "run.periods": 1.0}
        refused(lambda spec=spec: _iva.states(spec, []), f"absorber.{name}")  # type: ignore[misc]


def test_the_table_of_fields() -> None:
    assert _iva.fields("absorber", "none") == []
    names = [name for name, _, _ in _iva.fields("start", "none")]
    shock = ["impulse", "impulse_velocity"]
    assert names == ["displacement", "displacement_mm", "velocity", *shock, "time"]
    of_run = {name for name, _, _ in _iva.fields("run", "none")}
    assert of_run == {"periods", "duration", "cycles", "discard", "max_impacts", "max_work"}


def test_a_wrong_type_is_told_what_to_give() -> None:
    wrong: Any = iva.Start(displacement=1.0)
    says = r"^absorber = {}: give an iva\.Siva, an iva\.Piva, an iva\.Stop, a list of them or None$"
    given: Any
    for given, shown in (
        (wrong, r"Start\(displacement=1\.0\)"),
        ("none", "'none'"),
        (False, "False"),
    ):
        with pytest.raises(TypeError, match=says.format(shown)):
            iva.simulate(given, iva.Primary(), start=LET_GO, periods=1)
        with pytest.raises(TypeError, match=says.format(shown)):
            iva.sweep(given, iva.Primary(), over={"damping_ratio": [0.1]}, start=LET_GO, periods=1)
    # It is said by `None`, not by leaving it out.
    nothing: Any = {"primary": iva.Primary(), "start": LET_GO, "periods": 1}
    with pytest.raises(TypeError, match="absorber"):
        iva.simulate(**nothing)


def test_theories_need_an_absorber() -> None:
    nothing: Any = None
    says = "absorber = None: give an iva.Siva; the theory is of that"
    with pytest.raises(TypeError, match=re.escape(says)):
        iva.theory.masri_caughey(nothing, iva.Primary(), iva.Harmonic(amplitude=0.1, frequency=1.0))
    with pytest.raises(TypeError, match=re.escape(says)):
        iva.theory.slow_manifold(nothing)


def test_results_are_values(siva: iva.Siva) -> None:
    bare = alone()
    assert bare.absorber is None
    for twin in (pickle.loads(pickle.dumps(bare)), copy.copy(bare), copy.deepcopy(bare)):
        assert twin == bare
        assert twin.absorber is None
        assert_frame_equal(twin.trajectory(7), bare.trajectory(7))
        assert repr(twin) == repr(bare)
    assert alone() == bare
    assert alone(periods=29) != bare
    primary = iva.Primary(damping_ratio=0.02)
    assert iva.simulate(siva, primary, start=LET_GO, periods=30) != bare


def test_points_of_a_sweep_are_chosen_as_any() -> None:
    table = iva.sweep(None, iva.Primary(), over={"damping_ratio": RATIOS}, start=LET_GO, periods=60)
    first = iva.best(table, count=1)
    assert first["damping_ratio"].to_list() == [0.2]
    assert iva.pareto(table, ["settling_time_5"])["point"].to_list() == [2]
    assert table.summary.filter(pl.col("settling_time_5").is_null()).height <= 1
