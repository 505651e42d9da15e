"""Scenes under a harmonic force or on a moving base."""

from __future__ import annotations

import math
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import iva
from iva import _iva

SIVA = iva.Siva(mass_ratio=0.05, clearance=2.0, restitution=0.8)
PRIMARY = iva.Primary(damping_ratio=0.02)
FORCE = iva.Harmonic(amplitude=0.1, relative_frequency=1.0)

# First and second impact of the reference scene siva_forced_masri (tests/reference/forced.json).
FIRST, SECOND = 16.2944166033175, 24.6911878110251


def simulate(absorber: Any = SIVA, **arguments: Any) -> iva.Run:
    given: dict[str, Any] = {
        "start": iva.Start(displacement=1.0),
        "force": FORCE,
        "periods": 40,
    } | arguments
    return iva.simulate(absorber, given.pop("primary", PRIMARY), **given)


def test_reference_impacts() -> None:
    times = simulate().impacts["time"]
    # 76 impacts; the conditions of the first two are 84 and 790.
    assert times.len() == 76
    assert times[0] == pytest.approx(FIRST, rel=0, abs=1e-13)
    assert times[1] == pytest.approx(SECOND, rel=0, abs=1e-12)


def test_measures_of_decay_are_null_and_the_ledger_has_the_work() -> None:
    row = simulate().summary.row(0, named=True)
    null = [name for name in row if name.startswith(("damping_ratio", "settling_time"))]
    assert [row[name] for name in null] == [None] * 8
    # Four integrals along 40 periods, each of some hundred steps of rounding.
    assert abs(row["energy_residual"]) < 1e-13 * row["energy_work"]
    assert row["energy_work"] > 1.0
    assert iva.simulate(SIVA, PRIMARY, start=iva.Start(displacement=1), periods=1).summary[
        "energy_work"
    ].to_list() == [0.0]


def test_no_impacts_gives_the_linear_resonance() -> None:
    # At Ω = ωn the bare structure settles to f/(2ζ M ωn²) = 2.5; 200 periods: e^(−25) of the start.
    run = simulate(iva.Siva(mass_ratio=0.05, clearance=50.0, restitution=0.8), periods=200)
    assert run.impacts.height == 0
    last = run.trajectory(200)["displacement"][-200:].abs().max()
    assert last == pytest.approx(2.5, rel=2e-4)  # between samples at most ½ (π/200)²


@pytest.mark.parametrize("kind", ["force", "base"])
def test_units_of_force(kind: str) -> None:
    # M = 2 kg, k = 800 N/m: ωn = 20 rad/s. f = 80 N is f/M = 40 m/s² = 0.1 ωn² · 1 m.
    given: dict[str, Any] = {"force": 80.0} if kind == "force" else {"base_acceleration": 40.0}
    name = "amplitude" if kind == "force" else "base_acceleration"
    natural = simulate(force=iva.Harmonic(**{name: 0.1}, relative_frequency=1.0, phase=0.3))
    for frequency in ({"frequency": 20.0}, {"frequency_hz": 20.0 / (2 * math.pi)}):
        run = simulate(
            primary=iva.Primary(mass=2.0, stiffness=800.0, damping_ratio=0.02),
            force=iva.Harmonic(**given, **frequency, phase=0.3),
        )
        assert run.impacts.height == natural.impacts.height > 20
        times = natural.impacts["time"][:5] / 20.0
        # Rounding of the frequency, 1e-16, grows by a factor of about 10 at each impact.
        assert run.impacts["time"][:5].to_list() == pytest.approx(times.to_list(), rel=1e-10)


def test_a_moving_base_is_felt_by_the_absorber() -> None:
    base = simulate(force=iva.Harmonic(base_acceleration=0.1, relative_frequency=1.0))
    force = simulate(force=iva.Harmonic(amplitude=-0.1, relative_frequency=1.0))
    assert base.impacts["time"].to_list() != force.impacts["time"].to_list()


def test_a_heavy_gap_on_a_moving_base_in_the_inertial_frame() -> None:
    # Before the first impact the absorber does not move: x + y + x_g, x_g = −(a/Ω²) cos Ωt, stays.
    run = simulate(force=iva.Harmonic(base_acceleration=0.1, relative_frequency=0.5), periods=0.5)
    state = run.at([0.0, 1.0, 2.0])
    x, y = state["displacement"], state["gap_displacement"]
    base = [-0.4 * math.cos(0.5 * t) for t in (0.0, 1.0, 2.0)]
    outside = [a + b + c for a, b, c in zip(x, y, base, strict=True)]
    # ẋ₁ in the inertial frame is that of the base at time zero, 0.
    assert outside == pytest.approx([0.6] * 3, rel=0, abs=1e-15)


def test_values_and_axes() -> None:
    run = simulate()
    assert "Harmonic(amplitude=0.1, relative_frequency=1.0)" in repr(run)
    assert "Harmonic" in run._repr_html_()
    assert pickle.loads(pickle.dumps(run)) == run
    assert pickle.loads(pickle.dumps(run)).force == FORCE
    assert run.at([FIRST])["wall"].to_list() == [0]
    table = iva.sweep(
        SIVA,
        PRIMARY,
        start=iva.Start(displacement=1.0),
        force=iva.Harmonic(amplitude=0.1),
        over={"force.relative_frequency": [0.9, 1.0]},
        periods=40,
        tables=("impacts",),
    )
    same = table.impacts.filter(point=1)["time"]
    assert same.to_list() == run.impacts["time"].to_list()


def test_a_study_is_the_same_run(tmp_path: Path) -> None:
    study = tmp_path / "driven.toml"
    study.write_text(
        "version = 1\n[primary]\ndamping_ratio = 0.02\n[absorber]\nkind = 'siva'\n"
        "mass_ratio = 0.05\nclearance = 2.0\nrestitution = 0.8\n[force]\namplitude = 0.1\n"
        "relative_frequency = 1.0\n[start]\ndisplacement = 1.0\n[run]\nperiods = 40\n",
        encoding="utf-8",
    )
    out = tmp_path / "out"
    assert _iva.main(["iva", "check", str(study)]) == 0
    assert _iva.main(["iva", "run", str(study), "--out", str(out), "--quiet"]) == 0
    assert iva.read(out).impacts["time"].to_list() == simulate().impacts["time"].to_list()
    again = tmp_path / "again"
    resolved = str(out / "study.toml")
    assert _iva.main(["iva", "run", resolved, "--out", str(again), "--quiet"]) == 0
    assert (again / "study.toml").read_bytes() == (out / "study.toml").read_bytes()
    assert iva.read(again).summary.equals(iva.read(out).summary)


@pytest.mark.parametrize(
    ("force", "pieces"),
    [
        ({"amplitude": 1.0}, ("force.frequency is missing", "relative_frequency")),
        ({"frequency": 1.0}, ("force.amplitude is missing", "base_acceleration")),
        ({"force": 1.0, "frequency": 1.0}, ("force.force = 1", "primary.mass")),
    ],
)
def test_what_is_missing_is_named(force: dict[str, float], pieces: tuple[str, ...]) -> None:
    with pytest.raises(ValueError, match="force") as caught:
        simulate(force=iva.Harmonic(**force))
    assert all(piece in str(caught.value) for piece in pieces)
    assert "\n" not in str(caught.value)


def test_bad_values_are_named() -> None:
    with pytest.raises(ValueError, match=r"force\.frequency = 0: give a number greater than 0"):
        iva.Harmonic(amplitude=1.0, frequency=0.0)
    with pytest.raises(ValueError, match=r"force\.phase = 90: give an angle in rad"):
        iva.Harmonic(amplitude=1.0, frequency=1.0, phase=90.0)
    with pytest.raises(ValueError, match="give one of them"):
        iva.Harmonic(amplitude=1.0, base_acceleration=1.0)
    with pytest.raises(TypeError, match=r"force = 3: give an iva\.Harmonic"):
        simulate(force=3)
    with pytest.raises(ValueError, match=r"did you mean `force\.amplitude`"):
        iva.sweep(SIVA, PRIMARY, start=iva.Start(), over={"amplitude": [1.0]}, periods=1)


def test_a_mass_at_rest_on_its_wall_has_nothing_undecided() -> None:
    # Until the record begins nothing moves: D = 0 throughout, which is no grazing.
    siva = iva.Siva(mass_ratio=1.0, restitution=0.5, clearance=0.4)
    primary = iva.Primary(damping_ratio=0.01)
    start = iva.Start(gap_displacement=-0.4)
    runs = []
    for begin in (0.5, 20.0):
        record = iva.Recorded([begin, begin + 5, begin + 10], [0.05, 0.0, 0.8])
        run = iva.simulate(siva, primary, start=start, force=record, duration=begin + 20.0)
        assert run.summary["undecided"].item() == 0
        assert run.impacts.height > 0
        runs.append(run.impacts["time"] - begin)
    assert np.abs((runs[0] - runs[1]).to_numpy()).max() < 1e-12
    kicked = iva.Impulse(velocity=1.0, time=3.0)
    run = iva.simulate(siva, primary, start=start, force=kicked, duration=20.0)
    assert run.summary["undecided"].item() == 0
