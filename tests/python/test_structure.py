"""Structures with several modes, as studies and Python give them.

Numbers come from SciPy: the matrix exponential and frequency responses of the same matrices, and
DOP853 with event location for impacts. The core has references to 150 digits of its own.
"""

from __future__ import annotations

import math
import pickle
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from numpy.typing import NDArray
from polars.testing import assert_frame_equal
from scipy.integrate import solve_ivp
from scipy.linalg import eigh, expm

import iva

Array = NDArray[np.float64]

#: Two storeys whose damping is not proportional.
MASS = np.array([[2000.0, 0.0], [0.0, 1000.0]])
STIFFNESS = np.array([[300e3, -100e3], [-100e3, 100e3]])
DAMPING = np.array([[900.0, -100.0], [-100.0, 100.0]])
FRAME: dict[str, Any] = {
    "points": ["first", "top"],
    "mass": MASS,
    "stiffness": STIFFNESS,
    "damping": DAMPING,
    "absorber_at": "top",
}
SIVA = iva.Siva(mass=60.0, restitution=0.6, clearance=0.01)
START = iva.Start(displacement=0.05)


def frame(**more: Any) -> iva.Structure:
    """Return the two storeys with other entries."""
    return iva.Structure(**(FRAME | more))


def rates(state: Array) -> Array:
    """Return the rates of x₁, x₂, ẋ₁, ẋ₂ of the frame in flight."""
    x, v = state[:2], state[2:4]
    return np.concatenate([v, np.linalg.solve(MASS, -STIFFNESS @ x - DAMPING @ v)])


def in_mode_one(displacement: float) -> Array:
    """Return the displacements of the first mode of which the top has this one."""
    _, shapes = eigh(STIFFNESS, MASS)
    return np.asarray(shapes[:, 0] / shapes[1, 0] * displacement)


def test_one_mode_is_a_primary() -> None:
    """The same scene, by two ways through the core: to a few rounding units."""
    scale = 2.5
    one = iva.Structure(frequencies=[3.0], damping_ratios=0.02, points={"it": [scale]})
    # A shape φ makes the mass 1/φ².
    primary = iva.Primary(mass=scale**-2, natural_frequency=3.0, damping_ratio=0.02)
    absorber = iva.Siva(mass=0.02, restitution=0.6, clearance=0.02)
    found, known = (
        iva.simulate(absorber, it, start=iva.Start(displacement=0.05), periods=12)
        for it in (one, primary)
    )
    assert found.impacts.height == known.impacts.height > 10
    for name in ("time", "displacement", "velocity_after", "approach_velocity", "energy_loss"):
        there, here = known.impacts[name].to_numpy(), found.impacts[name].to_numpy()
        assert np.abs(there - here).max() < 3e-13 * np.abs(there).max()
    for name in ("settling_time_10", "residual_amplitude", "energy_viscous", "impulse_max"):
        assert found.summary[name].item() == pytest.approx(known.summary[name].item(), rel=1e-12)
    assert_frame_equal(
        found.trajectory(20).drop("time"), known.trajectory(20).drop("time"), abs_tol=1e-12
    )


def test_the_structure_alone_swings_as_the_matrix_exponential_says() -> None:
    """That of SciPy is right to some 1e-13 here: it squares a matrix of norm 800."""
    start = [0.03, -0.02]
    run = iva.simulate(
        None, frame(start_displacements=start, seen_at="first"), start=iva.Start(), periods=3
    )
    motion = run.trajectory(20)
    a = np.block(
        [
            [np.zeros((2, 2)), np.eye(2)],
            [-np.linalg.solve(MASS, STIFFNESS), -np.linalg.solve(MASS, DAMPING)],
        ]
    )
    for t, x, v in motion.select("time", "displacement", "velocity").iter_rows():
        state = expm(a * t) @ [*start, 0.0, 0.0]
        assert x == pytest.approx(state[0], abs=1e-13)
        assert v == pytest.approx(state[2], abs=1e-12)
    assert run.summary["impacts"].item() is None or run.summary["impacts"].item() == 0


@pytest.mark.parametrize("at", ["first", "top"])
def test_impacts_are_those_of_an_integrator(at: str) -> None:
    """DOP853 with its own events; each error grows by the impacts before it."""
    k = FRAME["points"].index(at)
    x = in_mode_one(0.05)
    run = iva.simulate(SIVA, frame(absorber_at=at, seen_at="top"), start=START, duration=6.0)
    mass, d, e = 60.0, 0.01, 0.6

    def moving(_: float, z: Array) -> Array:
        return np.concatenate([rates(z[:4]), [z[5], 0.0]])

    def plus(_: float, z: Array) -> float:
        return float(d - (z[4] - z[k]))

    def minus(_: float, z: Array) -> float:
        return float(d + (z[4] - z[k]))

    for wall in (plus, minus):
        wall.terminal, wall.direction = True, -1.0  # type: ignore[attr-defined]
    time, state = 0.0, np.array([*x, 0.0, 0.0, x[k], 0.0])
    found: list[tuple[float, float, float]] = []
    reduced = 1.0 / (1.0 / mass + 1.0 / MASS[k, k])
    while len(found) < 25:
        # The steps are short, for a contact between two steps of an integrator is missed.
        step = solve_ivp(
            moving,
            (time, 6.0),
            state,
            "DOP853",
            events=(plus, minus),
            rtol=1e-13,
            atol=1e-15,
            max_step=2e-3,
        )
        time, state = float(step.t[-1]), step.y[:, -1].copy()
        if step.status == 0:
            break
        impulse = (1.0 + e) * reduced * (state[5] - state[2 + k])
        state[2 + k] += impulse / MASS[k, k]
        state[5] -= impulse / mass
        found.append((time, state[2 + k], impulse))
    count = min(len(found), run.impacts.height)
    assert count > 5
    times, after, impulses = np.array(found[:count]).T
    hits = run.impacts.head(count)
    assert np.abs(hits["time"].to_numpy() - times).max() < 1e-8
    assert np.abs(hits["velocity_after"].to_numpy() - after).max() < 1e-7
    told = mass * (hits["absorber_velocity_before"] - hits["absorber_velocity_after"])
    assert np.abs(told.to_numpy() - impulses).max() < 1e-5
    own = mass * (run.impacts["absorber_velocity_before"] - run.impacts["absorber_velocity_after"])
    assert run.summary["impulse_max"].item() == pytest.approx(own.abs().max(), rel=1e-12)


def test_steady_states_are_frequency_responses() -> None:
    """(K + iωC − ω²M) X = F, of a force on the first storey and of a moving base."""
    omega = 9.0
    response = STIFFNESS + 1j * omega * DAMPING - omega**2 * MASS
    pushed = np.linalg.solve(response, [500.0, 0.0])
    shaken = np.linalg.solve(response, -MASS @ [1.0, 1.0] * 0.3)
    for force, true in (
        (iva.Harmonic(force=500.0, frequency=omega), pushed),
        (iva.Harmonic(base_acceleration=0.3, frequency=omega), shaken),
    ):
        for k, seen in enumerate(("first", "top")):
            run = iva.simulate(
                None,
                frame(force_at="first", seen_at=seen, base=[1.0, 1.0]),
                start=iva.Start(),
                force=force,
                cycles=900,
                discard=890,
            )
            amplitude = run.summary["amplitude_max"].item()
            assert amplitude == pytest.approx(abs(true[k]), rel=1e-9)
            assert run.summary["reduction"].item() is None


def test_a_structure_that_is_free_to_move() -> None:
    """Two carts of 1 kg and 2 kg with a spring between them, by matrices and by modes.

    The centre of mass keeps its velocity: the impulse of all impacts together is that of the mass.
    """
    carts = iva.Structure(
        points=["left", "right"],
        mass=[[1.0, 0.0], [0.0, 2.0]],
        stiffness=[[3.0, -3.0], [-3.0, 3.0]],
        natural_mode=2,
        absorber_at="left",
    )
    table = carts.modes()
    assert table["frequency"].to_list() == pytest.approx([0.0, math.sqrt(4.5)], abs=1e-12)
    assert table["damping_ratio"].to_list() == [0.0, 0.0]
    shapes = {"left": [3**-0.5, (2 / 3) ** 0.5], "right": [3**-0.5, -(6**-0.5)]}
    modes = iva.Structure(
        frequencies=[0.0, math.sqrt(4.5)], points=shapes, natural_mode=2, absorber_at="left"
    )
    mass = iva.Siva(mass=0.3, clearance=0.1, restitution=0.6)
    runs = [
        iva.simulate(mass, one, start=iva.Start(velocity=0.8, gap_velocity=0.1), duration=6.0)
        for one in (carts, modes)
    ]
    first, second = (run.impacts for run in runs)
    assert first.height == second.height > 5
    for name in ("time", "velocity_after", "approach_velocity"):
        assert second[name][:5].to_numpy() == pytest.approx(first[name][:5].to_numpy(), rel=1e-9)
    with pytest.raises(ValueError, match="that of mode 1 is the unit of time, and this is 0"):
        iva.Structure(frequencies=[0.0, 2.0], points=shapes)


def test_forces_at_several_points_with_phases_of_their_own() -> None:
    """(K + iωC − ω²M) X = (F₁, F₂ exp(iφ)); an integrator for unlike frequencies."""
    omega, phase = 9.0, 1.1
    response = STIFFNESS + 1j * omega * DAMPING - omega**2 * MASS
    true = np.linalg.solve(response, [500.0, 300.0 * np.exp(1j * phase)])
    forces = [
        iva.Harmonic(force=500.0, frequency=omega),
        iva.Harmonic(force=300.0, frequency=omega, phase=phase),
    ]
    for k, seen in enumerate(("first", "top")):
        structure = frame(force_at=["first", "top"], seen_at=seen)
        assert pickle.loads(pickle.dumps(structure)) == structure
        run = iva.simulate(
            None, structure, start=iva.Start(), force=forces, cycles=900, discard=890
        )
        amplitude = run.summary["amplitude_max"].item()
        assert amplitude == pytest.approx(abs(true[k]), rel=1e-9)
    # By an integrator, over the first second from rest, of unlike frequencies.
    forces = [
        iva.Harmonic(force=200.0, frequency=7.0, phase=0.3),
        iva.Harmonic(force=900.0, frequency=25.0, phase=-1.0),
    ]

    def driven(time: float, state: Array) -> Array:
        push = [200.0 * math.cos(7.0 * time + 0.3), 900.0 * math.cos(25.0 * time - 1.0)]
        pushed: Array = np.concatenate([np.zeros(2), np.linalg.solve(MASS, push)])
        return rates(state) + pushed

    known = solve_ivp(driven, (0.0, 1.0), np.zeros(4), method="DOP853", rtol=1e-12, atol=1e-14)
    run = iva.simulate(
        None,
        frame(force_at=["first", "top"], seen_at="top"),
        start=iva.Start(),
        force=forces,
        duration=1.0,
    )
    last = run.at([1.0])
    assert last["displacement"].item() == pytest.approx(known.y[1, -1], rel=1e-9)
    assert last["velocity"].item() == pytest.approx(known.y[3, -1], rel=1e-9)


def test_studies_have_forces_at_several_points(tmp_path: Path) -> None:
    folder = tmp_path / "one"
    swept = iva.sweep(
        SIVA,
        frame(force_at=["first", "top"]),
        over={"restitution": [0.4, 0.7]},
        start=START,
        force=[
            iva.Harmonic(force=200.0, frequency=7.0),
            iva.Harmonic(force=300.0, frequency=25.0, phase=1.0),
        ],
        duration=1.0,
        out=folder,
    )
    study = folder / "study.toml"
    assert 'force_at = ["first", "top"]' in study.read_text()
    command = [sys.executable, "-m", "iva", "run", str(study), "--point", "1", "--out", "two"]
    subprocess.run(command, check=True, capture_output=True, cwd=tmp_path)
    again = iva.read(tmp_path / "two").summary
    for name in ("impacts", "energy_work", "amplitude_max"):
        assert again[name].item() == swept.summary[name][1]


@pytest.mark.parametrize(
    ("force_at", "told"),
    [
        (["first", "top", "top"], "force_at = 3 names: give one point for all, or 2"),
        (["first", "roof"], 'force_at = "roof": give one of the points first, top'),
    ],
)
def test_points_of_forces_that_do_not_fit_are_told(force_at: list[str], told: str) -> None:
    """One sentence with field, value and what is allowed."""
    force = [iva.Harmonic(force=1.0, frequency=9.0), iva.Harmonic(force=2.0, frequency=8.0)]
    with pytest.raises(ValueError, match=told):
        iva.simulate(None, frame(force_at=force_at), start=iva.Start(), force=force, duration=1.0)


def test_records_and_impulses_have_one_point() -> None:
    """A harmonic force may act elsewhere; a second record at another point is refused."""
    push = iva.Recorded([0.0, 0.1, 0.2], [0.0, 900.0, 0.0], "force_newtons")
    hum = iva.Harmonic(force=200.0, frequency=25.0)
    with pytest.raises(ValueError, match="another record or impulse acts at first"):
        iva.simulate(
            None,
            frame(force_at=["first", "top"]),
            start=iva.Start(),
            force=[push, push],
            duration=1.0,
        )
    run = iva.simulate(
        SIVA,
        frame(force_at=["first", "top"], seen_at="top"),
        start=START,
        force=[push, hum],
        duration=2.0,
        verify=True,
    )
    assert run.verification is not None
    assert run.verification.agrees
    assert run.impacts.height > 0


def test_two_absorbers_at_two_points() -> None:
    """Each row of the trajectory has the point seen; absorbers in flight feel no acceleration.

    Errors estimated along the run are no smaller than the true ones of `verify`.
    """
    structure = frame(absorber_at=["first", "top"], seen_at="first")
    run = iva.simulate([SIVA, SIVA], structure, start=START, periods=4, verify=True, errors=True)
    # The rounding to seconds is not that of the run.
    rounded = run.impacts["time_error"] + 3e-16 * run.impacts["time"]
    assert (run.verification.impacts["time"].abs() <= rounded).all()
    assert 10 < run.summary["digits"].item() <= 16
    assert (
        run.verification.findings["rows"].to_list() == run.verification.findings["alike"].to_list()
    )
    assert set(run.impacts["absorber"]) == {0, 1}
    motion = run.trajectory(40)
    flying = motion.filter(pl.col("wall") == 0)
    assert flying["absorber_acceleration"].abs().max() == 0.0
    at_once = motion.group_by("time", maintain_order=True)
    assert at_once.agg(pl.col("displacement").n_unique())["displacement"].max() == 1
    total = run.summary.select(
        pl.col("energy_impacts") + pl.col("energy_viscous") + pl.col("energy_final")
    ).item()
    assert total == pytest.approx(run.summary["energy_initial"].item(), rel=1e-14)


def test_sweeps_are_runs_and_folders_read_back(tmp_path: Path) -> None:
    over = {"clearance": [0.005, 0.01, 0.02], "absorber.mass": [30.0, 60.0]}
    arguments: dict[str, Any] = {"start": START, "periods": 4, "over": over}
    tables = ("summary", "impacts")
    table = iva.sweep(SIVA, frame(), tables=tables, **arguments)
    for point, (clearance, mass) in enumerate(
        (c, m) for c in over["clearance"] for m in over["absorber.mass"]
    ):
        absorber = iva.Siva(mass=mass, restitution=0.6, clearance=clearance)
        alone = iva.simulate(absorber, frame(), start=START, periods=4).impacts.drop("point")
        swept = table.impacts.filter(pl.col("point") == point).drop("point")
        assert_frame_equal(swept, alone, check_exact=True)
    with ThreadPoolExecutor(2) as pool:
        iva.sweep(SIVA, frame(), tables=tables, out=tmp_path / "one", executor=pool, **arguments)
    assert_frame_equal(iva.read(tmp_path / "one").summary, table.summary, check_exact=True)
    study = (tmp_path / "one" / "study.toml").read_text()
    assert "[structure]" in study
    assert "[primary]" not in study
    again = iva.sweep(SIVA, frame(), tables=tables, out=tmp_path / "one", resume=True, **arguments)
    assert_frame_equal(again.summary, table.summary, check_exact=True)
    with pytest.raises(ValueError, match=r"structure\.damping was .* is "):
        iva.sweep(
            SIVA,
            frame(damping=2 * DAMPING),
            tables=tables,
            out=tmp_path / "one",
            resume=True,
            **arguments,
        )


def test_runs_see_the_parts_of_modes() -> None:
    """The parts of all modes are the whole motion, and no mode is another run."""
    shaken: dict[str, Any] = {
        "start": START,
        "force": iva.Harmonic(base_acceleration=0.3, frequency=9.0),
        "cycles": 12,
    }
    whole, *parts = (
        iva.simulate(SIVA, frame(base=[1.0, 1.0], **more), **shaken)
        for more in ({}, {"seen_mode": 1}, {"seen_mode": np.int64(2)})
    )
    for column in ("displacement", "velocity"):
        first, second = (part.trajectory(30)[column].to_numpy() for part in parts)
        seen = whole.trajectory(30)[column].to_numpy()
        assert np.abs(first + second - seen).max() < 1e-13
        assert min(np.abs(part).max() for part in (first, second)) > 1e-3
    for part in parts:
        assert len(part.impacts) > 10
        assert part.impacts["time"].equals(whole.impacts["time"])
        assert part.summary["energy_impacts"].equals(whole.summary["energy_impacts"])
        largest = np.abs(part.trajectory(30)["displacement"].to_numpy()).max()
        told = part.summary["amplitude_max"].item()
        assert largest <= told < 1.05 * largest


def test_a_part_of_the_motion_is_not_all_of_it() -> None:
    """Neither an impulse nor a motion in space goes by the part of one mode."""
    part = frame(seen_mode=2)
    with pytest.raises(ValueError, match="run sees only a part of its structure"):
        iva.plots.velocities(iva.simulate(SIVA, part, start=START, periods=2))
    with pytest.raises(ValueError, match=r"structure\.seen_mode = 2: with impulses a run sees"):
        iva.simulate(SIVA, part, start=START, force=iva.Impulse(impulse=9.0), periods=2)


def test_a_mode_alone_decays_by_its_own_numbers() -> None:
    """In modes without exchange: x = φq with the frequency and damping ratio of the mode."""
    structure = frame(damping=2e-3 * STIFFNESS, natural_mode=2, seen_mode=2)
    second = structure.modes().row(1, named=True)
    run = iva.simulate(None, structure, start=START, periods=20)
    period = 2 * math.pi / second["frequency"]
    zeta, omega = second["damping_ratio"], second["frequency"]
    seen = run.trajectory(16)
    time = seen["time"].to_numpy()
    assert time[-1] == pytest.approx(20 * period, rel=1e-14)
    damped = omega * math.sqrt(1 - zeta**2)
    swing = np.cos(damped * time) + zeta * omega / damped * np.sin(damped * time)
    expected = 0.05 * np.exp(-zeta * omega * time) * swing
    assert np.abs(seen["displacement"].to_numpy() - expected).max() < 1e-14
    first = iva.simulate(None, replace(structure, seen_mode=1), start=START, periods=20)
    assert first.trajectory(16)["displacement"].abs().max() == 0.0


def test_the_natural_mode_is_the_unit_of_time() -> None:
    """The same run by other units; periods and relative frequencies are those of the mode."""
    by_first, by_second = (
        iva.simulate(
            SIVA,
            frame(natural_mode=mode, start_displacements=[0.02, 0.05]),
            start=iva.Start(),
            duration=8.0,
        )
        for mode in (1, 2)
    )
    assert len(by_first.impacts) > 10
    off = by_first.impacts["time"].to_numpy() - by_second.impacts["time"].to_numpy()
    assert np.abs(off).max() < 1e-11
    second = float(frame().modes()["frequency"].to_list()[1])
    one, other = (
        iva.simulate(
            None,
            frame(force_at="first", natural_mode=2),
            start=iva.Start(),
            force=force,
            cycles=5,
        )
        .summary["amplitude_max"]
        .item()
        for force in (
            iva.Harmonic(force=10.0, relative_frequency=1.0),
            iva.Harmonic(force=10.0, frequency=second),
        )
    )
    assert one == pytest.approx(other, rel=1e-12)


def test_modes_go_through_csv(tmp_path: Path) -> None:
    file = tmp_path / "modes.csv"
    modes = frame(damping=2e-3 * STIFFNESS).modes()
    modes.write_csv(file)
    read = iva.Structure.read(file, absorber_at="top")
    assert_frame_equal(read.modes(), modes, abs_tol=1e-15)
    one, other = (
        iva.simulate(SIVA, it, start=START, periods=5).impacts["time"].to_numpy()
        for it in (read, frame(damping=2e-3 * STIFFNESS))
    )
    assert np.abs(one - other).max() < 1e-11
    (tmp_path / "none.csv").write_text("frequency\n1\n")
    with pytest.raises(ValueError, match="no column shape_"):
        iva.Structure.read(tmp_path / "none.csv")


def test_what_is_shown_and_kept() -> None:
    structure = frame(seen_at="first", seen_mode=2, natural_mode=2)
    assert eval(repr(structure), {"Structure": iva.Structure}) == structure
    assert pickle.loads(pickle.dumps(structure)) == structure
    run = iva.simulate(SIVA, structure, start=START, periods=2)
    assert pickle.loads(pickle.dumps(run)).impacts.equals(run.impacts)
    assert "Structure(" in repr(run)
    assert "Structure(" in run._repr_html_()
    assert run.units.system == "si"


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ({"mass": [[1.0, 2.0], [0.0, 1.0]]}, r"mass\[1\]\[0\] = 0: give a symmetric matrix"),
        ({"mass": [[1.0, 0.0], [0.0, -1.0]]}, "structure.mass = -1: .* positive definite"),
        ({"mass": [[1.0]]}, "structure.mass = 1 rows: give 2 rows of 2 numbers"),
        ({"stiffness": None}, "structure.stiffness is missing: give 2 rows"),
        ({"stiffness": [[1.0, 0.0], [0.0, -1.0]]}, "springs feed no energy"),
        ({"damping": [[1.0, 0.0], [0.0, -1.0]]}, "dampers feed no energy"),
        ({"frequencies": [1.0]}, "give modes or matrices"),
        ({"absorber_at": "roof"}, 'structure.absorber_at = "roof": give one of the points first'),
        ({"points": ["one"]}, "give 1 rows of 1 numbers, as there are 1 points"),
        ({"base": [1.0]}, "structure.base = 1 numbers: give 2"),
        ({"seen_mode": 3}, "structure.seen_mode = 3: give the number of a mode, from 1 to 2"),
        ({"natural_mode": 0}, "structure.natural_mode = 0: give the number of a mode, from 1"),
        ({"start_velocities": [float("nan"), 0.0]}, "start_velocities = NaN: give finite numbers"),
        ({"stiffness": [[1.0, -1.0], [-1.0, 1.0]]}, "frequencies = .*: .* hold the structure"),
    ],
)
def test_bad_entries_are_refused(more: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        frame(**more)


@pytest.mark.parametrize("mode", [True, 1.0, "2"])
def test_the_number_of_a_mode_is_a_number(mode: Any) -> None:
    with pytest.raises(TypeError, match=r"seen_mode = .*: give the number of a mode, from 1"):
        frame(seen_mode=mode)


def test_frequencies_are_told_as_they_were_given() -> None:
    told = r"frequencies_hz\[1\] = -2: give 0 or a number greater than 0"
    with pytest.raises(ValueError, match=told):
        iva.Structure(frequencies_hz=[1.0, -2.0], points={"a": [1.0, 1.0]})


@pytest.mark.parametrize(
    ("absorber", "more", "told"),
    [
        (iva.Siva(mass_ratio=0.1, restitution=0.5, clearance=0.01), {}, r"give mass \(kg\)"),
        (
            iva.Piva(mass=60.0, restitution=0.5, clearance=1.5, length=1.0),
            {},
            "absorber.clearance = 1.5: .* a pendulum must reach its stops",
        ),
        (SIVA, {"force": iva.Harmonic(amplitude=1.0, frequency=7.0)}, r"give force \(N\)"),
        (SIVA, {"force": iva.Impulse(velocity=1.0)}, r"give impulse \(N s\)"),
        (
            SIVA,
            {"force": iva.Harmonic(base_acceleration=1.0, frequency=7.0)},
            "structure.base is missing: a moving base needs",
        ),
        ([SIVA] * 65, {}, "absorber"),
    ],
)
def test_what_a_structure_does_not_take(absorber: Any, more: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        iva.simulate(absorber, frame(), start=START, periods=1, **more)


def test_what_is_of_one_mode_refuses_several(tmp_path: Path) -> None:
    run = iva.simulate(SIVA, frame(), start=START, periods=2)
    with pytest.raises(ValueError, match="structure with several modes"):
        iva.plots.energy(run)
    elsewhere = iva.simulate(SIVA, frame(seen_at="first"), start=START, periods=2)
    with pytest.raises(ValueError, match="give seen_at the point of all absorbers"):
        iva.plots.velocities(elsewhere)
    with pytest.raises(ValueError, match="give seen_at the point of all absorbers"):
        elsewhere.write_uff(tmp_path / "it.uff")
    bare = iva.simulate(None, frame(seen_at="first"), start=START, periods=2)
    assert iva.plots.velocities(bare).get_xlabel() == "time t (s)"
    assert iva.plots.velocities(run).get_xlabel() == "time t (s)"
    assert iva.plots.decay(elsewhere).get_xlabel() == "time t (s)"


def test_commands_say_what_the_structure_is(tmp_path: Path) -> None:
    study = tmp_path / "it.toml"
    study.write_text(
        """version = 1
[structure]
frequencies_hz = [1.0, 2.5]
damping_ratios = [0.01, 0.02]
points = { first = [0.01, 0.02], top = [0.02, -0.01] }
absorber_at = "top"
[absorber]
kind = "siva"
mass = 60
restitution = 0.5
clearance = 0.01
[force]
force = 100
relative_frequency = 1
[run]
cycles = 2
"""
    )

    def iva_(*words: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "iva", *words]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    told = iva_("check", str(study))
    assert told.returncode == 0
    assert "Structure: 2 modes, 1 … 2.5 Hz, damping ratio 0.01 … 0.02; seen at top" in told.stdout
    assert "Absorber: free mass, 60 kg at top, restitution 0.5" in told.stdout
    assert "Force on the structure, of 1 times the natural frequency" in told.stdout
    orbit = iva_("orbit", str(study))
    assert orbit.returncode == 2
    assert "no orbit: the motion has no impacts" in orbit.stderr


@pytest.mark.parametrize("count", [1, 2, 7])
def test_an_impulse_moves_the_structure_and_not_the_masses(count: int) -> None:
    """The structure gains P φ(p) φ(k) at each point, and the gaps the opposite."""
    structure = frame(absorber_at="top", force_at="top", seen_at="top")
    absorber = [SIVA] * count if count > 1 else SIVA
    blow = iva.Impulse(impulse=100.0)
    run = iva.simulate(absorber, structure, start=iva.Start(), force=blow, duration=5.0)
    first = run.at([0.0])
    gained = 100.0 / MASS[1, 1]
    assert first["velocity"].to_numpy() == pytest.approx([gained] * count, rel=1e-14)
    assert first["gap_velocity"].to_numpy() == pytest.approx([-gained] * count, rel=1e-14)
    assert run.impacts.height > count
    row = run.summary.row(0, named=True)
    assert abs(row["energy_residual"]) < 1e-13 * row["energy_work"]


def test_millimetres_are_not_taken_for_metres() -> None:
    with pytest.warns(UserWarning, match="where millimetres are meant"):
        iva.simulate(
            iva.Siva(mass=60.0, restitution=0.6, clearance=20.0),
            frame(),
            start=iva.Start(displacement=0.03),
            periods=1,
        )


@pytest.mark.parametrize(
    "law",
    [
        {"restitution": 0.5, "reference_speed": 0.2},
        {"yield_speed": 0.02},
        {"restitution_table": [[0.02, 0.8], [0.3, 0.5]]},
    ],
)
def test_restitution_may_depend_on_the_approach_speed(law: dict[str, Any]) -> None:
    """One mode is a primary, also beside a dashpot that is not felt; and rows obey the law."""
    siva = iva.Siva(mass=5.0, clearance=0.01, **law)
    primary = iva.Primary(mass=100.0, stiffness=90e3, damping_ratio=0.01)
    structure = iva.Structure(points=["top"], mass=[[100.0]], stiffness=[[90e3]], damping=[[60.0]])
    start = iva.Start(displacement=0.02)
    alone = iva.simulate(siva, primary, start=start, periods=2)
    oiled = replace(siva, gap_damping=1e-12)
    for run in (
        iva.simulate(siva, structure, start=start, periods=2),
        iva.simulate(oiled, primary, start=start, periods=2),
    ):
        assert len(run.impacts) == len(alone.impacts) > 4
        off = run.impacts["time"].to_numpy() - alone.impacts["time"].to_numpy()
        assert np.abs(off).max() < 1e-12
    run = iva.simulate(siva, frame(), start=START, periods=5, errors=True)
    number = iva.simulate(replace(SIVA, mass=5.0), frame(), start=START, periods=5)
    assert abs(run.summary["energy_residual"].item()) < 1e-12
    assert not run.impacts["time"].equals(number.impacts["time"])
    assert run.impacts["time_error"].drop_nulls().len() > 8
