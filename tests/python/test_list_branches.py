"""Branches of several absorbers, of what rubs, and on structures with several modes."""

from __future__ import annotations

import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import polars as pl
import pytest
from matplotlib import pyplot

import iva
from iva import dynamics
from test_list_orbits import found

#: 30 digits: `tests/reference/bifurcations.json`, family A: μ = .2, e = .7, ζ = .05, F = Ω = 1.
PITCHFORK, NEIMARK_SACKER = 4.239825482999316, 6.716344592097102
FAMILY = iva.Primary(damping_ratio=0.05)
PUSHED = iva.Harmonic(amplitude=1.0, frequency=1.0)


def branch(name: str, over: str, between: tuple[float, float]) -> dynamics.Branch:
    """Return the branch of the orbit of a scene."""
    few: dict[str, Any] = {
        "step": 0.2,
        "most_points": 2 if name in ("pendulum", "friction") else 2000,
    }
    followed = dynamics.follow(found(name), over=over, between=between, **few)
    assert isinstance(followed, dynamics.Branch), followed
    return followed


@pytest.mark.parametrize(
    ("name", "over", "between"),
    [
        ("two masses", "absorber.1.clearance", (0.7, 0.9)),
        ("pendulum", "force.amplitude", (0.45, 0.55)),
        ("friction", "absorber.1.friction", (0.045, 0.055)),
        ("two modes", "force.force", (240.0, 260.0)),
    ],
)
def test_orbits_of_a_branch_are_those_of_runs(
    name: str, over: str, between: tuple[float, float]
) -> None:
    made = branch(name, over, between)
    assert "stalled" not in made.ends
    assert made.impacts == sum(made.walls.count(sign) for sign in "+-") > 0
    assert made.table.height == len(made.rows)
    for index in (0, len(made.rows) // 2, -1):
        orbit = made.orbit(index)
        assert isinstance(orbit, dynamics.Orbit)
        end = orbit.run().state_at(orbit.period)
        size = made.rows[index].amplitude
        assert end.displacement == pytest.approx(orbit.start.displacement, abs=1e-9 * size)
        assert orbit.amplitude == pytest.approx(size, rel=1e-12)
    again = pickle.loads(pickle.dumps(made))
    assert again.rows == made.rows
    assert repr(again) == repr(made)
    if name != "pendulum":
        figure, axes = pyplot.subplots()
        iva.plots.branch(made, ax=axes)
        assert over.rpartition(".")[2] in axes.get_xlabel()
        pyplot.close(figure)
    assert len(made.measures("amplitude_rms")["amplitude_rms"].drop_nulls()) == len(made.rows)


def test_a_light_absorber_far_from_its_walls_leaves_the_points_of_the_other() -> None:
    """The second mass, on a spring, is 1e-13 of the structure: all else is family A."""
    mass = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5)
    light = iva.Siva(mass_ratio=1e-13, restitution=0.5, clearance=1e3, spring_ratio=2.5)
    first = dynamics.orbit(
        [mass, light],
        FAMILY,
        force=PUSHED,
        start=iva.Start(gap_velocity=[0.1, 0.0]),
        settle=2000,
        symmetric=True,
    )
    assert isinstance(first, dynamics.Orbit), first
    made = dynamics.follow(first, over="absorber.0.clearance", between=(4.0, 7.0))
    assert isinstance(made, dynamics.Branch), made
    kinds = [(point.kind, point.value) for point in made.points]
    expected = [("pitchfork", PITCHFORK), ("neimark_sacker", NEIMARK_SACKER)]
    assert [kind for kind, _ in kinds] == [kind for kind, _ in expected]
    for (_, value), (_, truth) in zip(kinds, expected, strict=True):
        assert value == pytest.approx(truth, rel=1e-9)
    other = made.switch(0)
    assert isinstance(other, dynamics.Branch)
    assert not other.symmetric
    assert other.ends[0] == "origin"
    ranges = ((4.0, 7.0), (0.19, 0.21))
    over = ("absorber.0.clearance", "absorber.0.mass_ratio")
    curve = dynamics.curve(made.points[0], over=over, between=ranges)
    assert isinstance(curve, dynamics.Curve)
    assert curve.ends == ("range", "range")


def test_what_cannot_be_followed_says_so() -> None:
    orbit = found("two masses")
    with pytest.raises(ValueError, match=r"not all of them.*absorber\.1\.clearance"):
        dynamics.follow(orbit, over="clearance", between=(0.4, 0.9))
    with pytest.raises(ValueError, match=r"absorber\.1\.clearance = 0\.8: the orbit is outside"):
        dynamics.follow(orbit, over="absorber.1.clearance", between=(0.4, 0.7))


def test_friction_is_followed_from_none_on() -> None:
    """At the end without friction the orbit is that of the same mass without."""
    mass = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5, friction=0.0, gravity=1.0)
    start = (0, 0, 0, 0.1)
    first = dynamics.orbit(mass, FAMILY, force=PUSHED, start=start, settle=200)
    assert isinstance(first, dynamics.Orbit), first
    made = dynamics.follow(first, over="friction", between=(0.0, 0.05), step=0.2)
    assert isinstance(made, dynamics.Branch), made
    assert made.ends == ("range", "range")
    for index, friction in ((0, 0.0), (-1, 0.05)):
        orbit = made.orbit(index)
        assert isinstance(orbit, dynamics.Orbit), orbit
        assert orbit.absorber == replace(mass, friction=friction)
        end = orbit.run().state_at(orbit.period)
        assert end.displacement == pytest.approx(orbit.start.displacement, abs=1e-9)
    assert made.rows[0].amplitude == pytest.approx(first.amplitude, rel=1e-12)
    assert made.rows[-1].amplitude != pytest.approx(first.amplitude, rel=1e-3)
    plain = replace(mass, friction=None, gravity=None)
    other = dynamics.orbit(plain, FAMILY, force=PUSHED, start=start, settle=200)
    assert isinstance(other, dynamics.Orbit), other
    branch = dynamics.follow(other, over="clearance", between=(4.0, 5.0))
    assert isinstance(branch, dynamics.Branch), branch
    over, ranges = ("clearance", "friction"), ((4.0, 5.0), (0.0, 0.1))
    with pytest.raises(ValueError, match="friction"):
        dynamics.curve(branch.points[0], over=over, between=ranges)
    with pytest.raises(ValueError, match=r"absorber\.x\.mass_ratio"):
        dynamics.curve(
            branch.points[0], over=("clearance", "absorber.x.mass_ratio"), between=ranges
        )


STUDY = """version = 1
[[absorber]]
kind = "siva"
mass_ratio = 0.08
restitution = 0.6
clearance = 0.5
[[absorber]]
kind = "siva"
mass_ratio = 0.05
restitution = 0.5
clearance = 0.8
[primary]
damping_ratio = 0.03
[force]
amplitude = 0.5
frequency = 0.95
[start]
gap_velocity = [0.1, 0.2]
[run]
duration = 100.0
"""


def test_the_command_follows_a_list(tmp_path: Path) -> None:
    (tmp_path / "pair.toml").write_text(STUDY, encoding="utf-8")
    between = ["--from", "0.75", "--to", "0.85", "--step", "0.5", "--csv", "points.csv"]
    command = ["branch", "pair.toml", "--over", "absorber.1.clearance", "--settle", "400", *between]
    told = subprocess.run(
        [sys.executable, "-m", "iva", *command], cwd=tmp_path, capture_output=True, text=True
    )
    assert told.returncode == 0, told.stderr
    assert "symmetric orbits with 4 impacts in 1 periods" in told.stdout
    assert "ends: range, range" in told.stdout
    points = pl.read_csv(tmp_path / "points.csv")
    assert points["absorber.1.clearance"].to_list()[0] == 0.75
    assert "multiplier_6_im" in points.columns
