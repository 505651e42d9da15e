"""A linear spring between a free mass and its structure, and lines that rise in lists and units.

Without impacts the mass and its structure are a linear system of two degrees of freedom. Expected
motions are its matrix exponential by SciPy, amplitudes those that J. P. Den Hartog gives for a
tuned mass damper (Mechanical Vibrations, 1934), here with damping of the structure as well.
"""

from __future__ import annotations

import dataclasses
import math
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from polars.testing import assert_frame_equal
from scipy.linalg import expm

import iva
from iva import _iva
from iva.plots.energy_split import split_of

Array = NDArray[np.float64]

MASS, STIFFNESS, ZETA, OMEGA = 100.0, 90e3, 0.01, 30.0
PRIMARY = iva.Primary(mass=MASS, stiffness=STIFFNESS, damping_ratio=ZETA)
START = iva.Start(displacement=0.025)
M, K, C = 10.0, 7000.0, 40.0
STRUCTURE = iva.Structure(
    points=["top"], mass=[[MASS]], stiffness=[[STIFFNESS]], damping=[[60.0]], base=[1.0]
)
STUDY = """
version = 1
[primary]
mass = 100.0
stiffness = 90_000.0
damping_ratio = 0.01
[absorber]
kind = "siva"
mass = 10.0
restitution = 0.6
clearance = 0.01
gap_damping = 40.0
[start]
displacement = 0.025
[run]
periods = 4
tables = ["summary"]
[sweep]
spring = [0.0, 7000.0]
"""
STARTS = ("displacements", "velocities")


def siva(**more: Any) -> iva.Siva:
    """Return a free mass on a spring, with a dashpot."""
    given: dict[str, Any] = {"mass": M, "restitution": 0.6, "clearance": 0.01}
    return iva.Siva(**(given | {"spring": K, "gap_damping": C} | more))


def rates(spring: float, dashpot: float) -> Array:
    """Return the matrix of the motion of x, y, ẋ and ẏ in flight."""
    own = np.array([-STIFFNESS, spring, -2 * ZETA * OMEGA * MASS, dashpot]) / MASS
    gap = np.array([0.0, -spring, 0.0, -dashpot]) / M - own
    return np.array([[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0], own, gap])


def amplitudes(force: float, omega: float) -> tuple[float, float]:
    """Return the amplitudes of x and y under F cos ωt, once they are steady."""
    inverse = np.linalg.inv(1j * omega * np.eye(4) - rates(K, C))
    x, y, *_ = inverse @ (force * np.array([0.0, 0.0, 1.0, -1.0]) / MASS)
    return abs(x), abs(y)


@pytest.mark.parametrize("dashpot", [0.0, C])
@pytest.mark.parametrize("modal", [False, True])
def test_without_impacts_the_motion_is_that_of_a_linear_system(modal: bool, dashpot: float) -> None:
    """The matrix exponential of the equations of motion."""
    begin = np.array([0.025, -0.01, 0.2, 0.3])
    gap: Any = {"gap_displacement": begin[1], "gap_velocity": begin[3]}
    own: Any = {"displacement": begin[0], "velocity": begin[2]}
    of_mode: Any = {f"start_{key}": [begin[k]] for key, k in zip(STARTS, (0, 2), strict=True)}
    times = np.linspace(0.0, 6.0, 61)
    run = iva.simulate(
        siva(clearance=2.0, gap_damping=dashpot),
        dataclasses.replace(STRUCTURE, **of_mode) if modal else PRIMARY,
        start=iva.Start(**gap) if modal else iva.Start(**own, **gap),
        duration=6.0,
    )
    assert run.impacts.height == 0
    names = ["displacement", "gap_displacement", "velocity", "gap_velocity"]
    found = run.at(times).select(names).to_numpy()
    expected = np.array([expm(rates(K, dashpot) * t) @ begin for t in times])
    assert np.abs(found - expected).max() < 1e-12 * np.abs(expected).max()


@pytest.mark.parametrize("relative", [0.7, 0.88, 0.97, 1.1])
def test_a_tuned_mass_damper_under_a_force(relative: float) -> None:
    """Amplitudes of structure and gap with stops that are far away, for all frequencies."""
    force, omega = 400.0, relative * OMEGA
    run = iva.simulate(
        siva(clearance=5.0),
        PRIMARY,
        start=iva.Start(),
        force=iva.Harmonic(force=force, frequency=omega),
        cycles=400,
        discard=380,
    )
    x, _ = amplitudes(force, omega)
    row = run.summary.row(0, named=True)
    assert row["impacts"] == 0
    assert row["amplitude_max"] == pytest.approx(x, rel=1e-10)
    bare = force / abs(STIFFNESS - MASS * omega**2 + 2j * ZETA * OMEGA * MASS * omega)
    assert row["reduction"] == pytest.approx(1 - x / bare, rel=1e-9)


def test_den_hartogs_fixed_points() -> None:
    """Without damping of the structure, with √(k/m) = ωn/(1+μ) both have |X| K/F = √(1 + 2/μ)."""
    mu = 0.05
    ratio = 1 / (1 + mu)
    for sign in (-1, 1):
        g = math.sqrt((1 + sign * math.sqrt(mu / (2 + mu))) / (1 + mu))
        for damping in (0.1, 0.15):
            absorber = iva.Siva(
                mass_ratio=mu,
                restitution=0.5,
                clearance=1e3,
                spring_ratio=ratio,
                gap_damping_ratio=damping * mu * ratio,
            )
            summary = iva.simulate(
                absorber,
                iva.Primary(),
                start=iva.Start(),
                force=iva.Harmonic(amplitude=1.0, frequency=g),
                cycles=400,
                discard=390,
            ).summary
            assert summary["amplitude_max"].item() == pytest.approx(math.sqrt(1 + 2 / mu), rel=1e-9)


def test_ratio_and_stiffness_are_one_and_natural_units_take_the_ratio() -> None:
    """The ratio is √(k/m)/ωn, m the mass of all units together."""
    ratio = math.sqrt(K / M) / OMEGA
    one = iva.simulate(siva(), PRIMARY, start=START, periods=4)
    two = iva.simulate(siva(spring=None, spring_ratio=ratio), PRIMARY, start=START, periods=4)
    assert_frame_equal(one.impacts, two.impacts, rel_tol=1e-9)
    assert one.impacts.height > 5
    bare = iva.Siva(
        mass_ratio=0.1,
        restitution=0.6,
        clearance=0.4,
        spring_ratio=ratio,
        gap_damping_ratio=C / (2 * MASS * OMEGA),
    )
    natural = iva.simulate(
        bare, iva.Primary(damping_ratio=ZETA), start=iva.Start(displacement=1.0), periods=4
    )
    expected = one.impacts["time"].to_numpy()
    assert natural.impacts["time"].to_numpy() / OMEGA == pytest.approx(expected, rel=1e-8)


def test_units_share_the_spring() -> None:
    """Two units are two masses with half of the spring and half of the dashpot each."""
    shared = iva.simulate(siva(units=2), PRIMARY, start=START, periods=3)
    half = siva(mass=M / 2, spring=K / 2, gap_damping=C / 2)
    listed = iva.simulate([half, half], PRIMARY, start=START, periods=3)
    assert shared.impacts["time"].to_list() == listed.impacts["time"].to_list()
    ratio = siva(spring=None, spring_ratio=math.sqrt(K / M) / OMEGA, units=2)
    other = iva.simulate(ratio, PRIMARY, start=START, periods=3)
    assert_frame_equal(other.impacts, shared.impacts, rel_tol=1e-9)


def test_the_spring_is_slack_where_the_gap_displacement_is_0() -> None:
    """In a gap with an offset a mass stays where y = 0, and swings from the middle of its gap."""
    heavy = iva.Primary(mass=1e12, stiffness=1e12)
    absorber = iva.Siva(mass=2.0, restitution=0.5, clearance=0.3, gap_offset=0.2, spring=18.0)
    still = iva.simulate(absorber, heavy, start=iva.Start(gap_displacement=0.0), duration=5.0)
    assert np.abs(still.trajectory(50)["gap_displacement"]).max() < 1e-18
    start = iva.Start(gap_displacement=0.2)
    (swung,) = iva.simulate(absorber, heavy, start=start, duration=1.0).at([0.3])[
        "gap_displacement"
    ]
    assert swung == pytest.approx(0.2 * math.cos(3.0 * 0.3), rel=1e-10)


def test_everything_that_a_run_has() -> None:
    """Ledger, verification, errors, energies, pickling and the text of the absorber."""
    force = iva.Harmonic(force=400.0, frequency=29.0)
    run = iva.simulate(
        siva(), PRIMARY, start=START, force=force, cycles=8, verify=True, errors=True
    )
    row = run.summary.row(0, named=True)
    assert abs(row["energy_residual"]) < 1e-12 * row["energy_work"]
    assert run.verification.agrees
    decay = iva.simulate(siva(), PRIMARY, start=START, periods=6)
    row = decay.summary.row(0, named=True)
    assert row["energy_initial"] == pytest.approx(STIFFNESS * 0.025**2 / 2, rel=1e-14)
    split = split_of(decay)
    total = sum(split.layers.values())
    assert np.abs(total / row["energy_initial"] - 1).max() < 1e-4
    assert split.layers["dashpot"][-1] == pytest.approx(row["energy_pivot"], rel=1e-4)
    both = split.layers["structure"][-1] + split.layers["absorber"][-1]
    assert both == pytest.approx(row["energy_final"], rel=1e-10)
    assert pickle.loads(pickle.dumps(siva())) == siva()
    assert "spring=7000.0" in repr(siva())


def test_gradients_are_those_of_the_linear_system() -> None:
    """The derivative of the first impact by the stiffness: −∂y/∂k over ẏ at the stop."""
    run = iva.simulate(siva(), PRIMARY, start=START, periods=2, gradients=["spring"])
    (told, *_) = run.gradients["spring"].impacts["time"]
    first = run.impacts.row(0, named=True)
    begin = np.array([0.025, 0.0, 0.0, 0.0])
    by = 1e-2
    above, below = ((expm(rates(K + off, C) * first["time"]) @ begin)[1] for off in (by, -by))
    slope = (above - below) / (2 * by)
    assert told == pytest.approx(-slope / first["approach_velocity"], rel=1e-6)


def test_lines_that_rise_in_lists_and_units_start_on_their_lower_stops() -> None:
    """Unless a place is given; a mass that is level starts in the middle of its gap."""
    rising = {"spring": None, "gap_damping": None, "inclination_deg": 90.0}
    level = siva(spring=None, gap_damping=None)
    absorbers = [siva(**rising), level, siva(**rising | {"gap_offset": 0.002, "spring": 50.0})]
    for structure in (PRIMARY, STRUCTURE):
        start = START if structure is PRIMARY else iva.Start()
        run = iva.simulate(absorbers, structure, start=start, periods=1)
        assert run.at([0.0])["gap_displacement"].to_list() == [-0.01, 0.0, -0.008]
    given = iva.Start(displacement=0.025, gap_displacement=[0.0, 0.001, 0.004])
    run = iva.simulate(absorbers, PRIMARY, start=given, periods=1)
    assert run.at([0.0])["gap_displacement"].to_list() == pytest.approx(
        [0.0, 0.001, 0.004], abs=1e-17
    )
    units = siva(**rising | {"units": 3, "clearance_spread": 0.1})
    run = iva.simulate(units, PRIMARY, start=START, periods=1)
    expected = pytest.approx([-0.009, -0.01, -0.011], rel=1e-12)
    assert run.at([0.0])["gap_displacement"].to_list() == expected


def test_two_that_rise_are_one_of_both() -> None:
    """Alike masses stay together, so that they are one mass, with and without a spring."""
    bare: dict[str, Any] = {"spring": None, "gap_damping": None}
    for more in (bare, {}):
        one = siva(**more, inclination_deg=40.0)
        halves: dict[str, Any] = {"mass": M / 2} | (more or {"spring": K / 2, "gap_damping": C / 2})
        half = siva(**halves, inclination_deg=40.0)
        run = iva.simulate(one, PRIMARY, start=START, periods=3)
        both = iva.simulate([half, half], PRIMARY, start=START, periods=3)
        hits = both.impacts.filter(absorber=0)
        assert hits.height == run.impacts.height > 3
        assert hits["time"].to_numpy()[:8] == pytest.approx(run.impacts["time"].to_numpy()[:8])
        energies = ["energy_initial", "energy_impacts", "energy_viscous", "energy_final"]
        assert_frame_equal(both.summary.select(energies), run.summary.select(energies))


def test_a_spring_carries_the_weight() -> None:
    """Upright, at y = −m g/k, nothing moves: the structure carries the weight either way."""
    g = 9.80665
    absorber = siva(clearance=0.02, inclination_deg=90.0)
    start = iva.Start(gap_displacement=-M * g / K)
    run = iva.simulate(absorber, PRIMARY, start=start, duration=2.0)
    motion = run.trajectory(40)
    assert np.abs(motion["gap_displacement"].to_numpy() + M * g / K).max() < 1e-15
    assert np.abs(motion["displacement"].to_numpy()).max() < 1e-15


def test_a_study_and_a_sweep_take_the_spring(tmp_path: Path) -> None:
    """A row of a sweep is the run of its values; 0 is no spring."""
    study = tmp_path / "tuned.toml"
    study.write_text(STUDY, encoding="utf-8")
    assert _iva.main(["iva", "sweep", str(study), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    written = iva.read(tmp_path / "out").summary
    asked: Any = {"start": START, "periods": 4}
    over: dict[str, Any] = {"spring": [0.0, 7000.0]}
    assert_frame_equal(iva.sweep(siva(spring=None), PRIMARY, over=over, **asked).summary, written)
    columns = ["impacts", "energy_impacts", "energy_viscous", "energy_pivot", "energy_final"]
    table = iva.sweep(
        siva(spring=None),
        PRIMARY,
        over={"absorber.spring_ratio": [0.0, 0.5, 0.9]},
        **asked,
    )
    for row, ratio in zip(table.summary.select(columns).rows(), (0.0, 0.5, 0.9), strict=True):
        absorber = siva(spring=None, spring_ratio=ratio)
        single = iva.simulate(absorber, PRIMARY, **asked).summary
        assert row == single.select(columns).row(0)


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: siva(spring=-1.0), r"absorber\.spring = -1: give 0 or"),
        (lambda: siva(spring=None, spring_ratio=-0.5), r"absorber\.spring_ratio = -0\.5: give 0"),
        (lambda: siva(spring_ratio=0.5), r"absorber\.spring is given as well; give one of them"),
        (
            lambda: iva.simulate(
                iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=0.5, spring=0.1),
                iva.Primary(),
                start=iva.Start(displacement=1.0),
                periods=1,
            ),
            "give primary.mass .* or give spring_ratio",
        ),
        (
            lambda: iva.simulate(
                siva(spring=None, gap_damping=None, spring_ratio=0.5),
                STRUCTURE,
                start=iva.Start(),
                periods=1,
            ),
            r"absorber\.spring_ratio = 0\.5: .* give spring \(N/m\)",
        ),
        (
            lambda: iva.simulate(
                siva(), PRIMARY, start=START, periods=1, gradients=["spring_ratio"]
            ),
            "spring_ratio",
        ),
    ],
)
def test_what_does_not_fit_is_told(call: Any, told: str) -> None:
    """One sentence with field, value and what is allowed."""
    with pytest.raises(ValueError, match=told) as caught:
        call()
    assert "\n" not in str(caught.value)
