"""Measures of the orbits of a branch: energies of a cycle, a closed form, what is refused."""

from __future__ import annotations

from dataclasses import replace

import pytest

import iva
from iva import dynamics


@pytest.fixture(scope="module")
def first() -> dynamics.Orbit:
    """Return the symmetric orbit with two impacts of family A, which a run settles on."""
    siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5)
    force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    primary = iva.Primary(damping_ratio=0.05)
    found = dynamics.orbit(siva, primary, force=force, start=(0, 0, 0, 0.1), settle=200)
    assert isinstance(found, dynamics.Orbit)
    return found


def test_measures_of_a_branch_are_those_of_runs(first: dynamics.Orbit) -> None:
    branch = dynamics.follow(first, over="clearance", between=(4.0, 13.0), step=0.2)
    assert isinstance(branch, dynamics.Branch)
    names = ("amplitude_rms", "amplitude_max", "energy_impacts", "acceleration_max", "impacts")
    powers = ("mean_power", "mean_power_impacts", "mean_power_viscous", "peak_force_estimate")
    found = branch.measures(*names, *powers)
    assert found.columns == ["value", "arclength", "outcome", *names, *powers]
    assert found["outcome"].unique().to_list() == ["finished"]
    assert found["value"].equals(branch.table["value"])
    for index in range(0, found.height - 1, 4):
        orbit, row = branch.orbit(index), found.row(index, named=True)
        assert isinstance(orbit, dynamics.Orbit)
        lost = sum(one.energy_loss for one in orbit.impacts)
        assert row["energy_impacts"] == pytest.approx(lost, rel=1e-10)
        assert row["mean_power_impacts"] == pytest.approx(lost / orbit.period, rel=1e-10)
        # What goes in comes out in a cycle.
        out = row["mean_power_impacts"] + row["mean_power_viscous"]
        assert row["mean_power"] == pytest.approx(out, rel=1e-9)
        assert row["amplitude_max"] == pytest.approx(branch.rows[index].amplitude, rel=1e-12)
        run = orbit.run(measures=["acceleration_max"])
        assert row["acceleration_max"] == run.summary["acceleration_max"].item()
        assert row["impacts"] == 2
    # Where the last impact vanishes the structure vibrates alone: F/(2ζ) in resonance.
    last = found.row(-1, named=True)
    assert last["amplitude_max"] == pytest.approx(10.0, rel=1e-12)
    assert last["amplitude_rms"] == pytest.approx(10.0 / 2.0**0.5, rel=1e-12)
    assert last["mean_power"] == pytest.approx(0.5 * 10.0, rel=1e-12)
    assert found["peak_force_estimate"].null_count() == found.height


def test_measures_are_null_where_there_is_no_orbit(first: dynamics.Orbit) -> None:
    branch = dynamics.follow(first, over="clearance", between=(4.4, 4.6))
    assert isinstance(branch, dynamics.Branch)
    rows = list(branch.rows[:3])
    nowhere = (float("nan"),) * len(rows[1].unknowns)
    rows[1] = replace(rows[1], unknowns=nowhere)
    with pytest.warns(UserWarning, match="1 of 3 orbits cannot be run"):
        found = replace(branch, rows=tuple(rows)).measures("amplitude_rms", "regime")
    assert found["amplitude_rms"].is_null().to_list() == [False, True, False]
    assert found["outcome"][0] == found["outcome"][2] == "finished"
    assert found["outcome"][1] != "finished"
    for names, match in (
        ((), "at least one"),
        (("amplitude_rm",), "did you mean `amplitude_rms`[?] There are the columns"),
        (("zzz",), "no such measure; there are the columns of run.summary, and mean_power"),
        (("outcome",), "no such measure"),
        (("impacts", "impacts"), "once"),
    ):
        with pytest.raises(ValueError, match=match):
            branch.measures(*names)
    with pytest.raises(TypeError, match="3 in it: give names"):
        branch.measures(3)  # type: ignore[arg-type]
