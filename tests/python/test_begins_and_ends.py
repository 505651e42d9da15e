"""Runs that begin at a jump of a record, and what is asked for at the very end of a run."""

import numpy as np
import pytest

import iva


def test_a_run_that_begins_at_the_jump_of_a_record_goes_on_after_it() -> None:
    """The absorber rests on its lower stop; the jump of the record frees it."""
    omega, jump = 7.0, 0.9
    absorber = iva.Siva(
        mass_ratio=0.1, clearance=0.5, restitution=0.5, inclination_deg=90, gravity=omega**2
    )
    force = iva.Recorded([jump, jump + 1], [-0.8 * omega**2, 1.1 * omega**2])

    def run(time: float) -> iva.Run:
        start = iva.Start(displacement=0.7, velocity=2.1, time=time)
        primary = iva.Primary(natural_frequency=omega)
        return iva.simulate(absorber, primary, start=start, force=force, duration=1.0)

    at, after = run(jump), run(jump * (1 + 1e-12))
    assert at.summary["energy_initial"].item() == pytest.approx(14.43, abs=0.01)
    assert abs(at.summary["energy_residual"].item()) < 1e-12
    assert at.at([jump])["displacement"].item() == 0.7
    times = np.linspace(jump + 0.01, jump + 0.9, 20)
    for column in ("displacement", "gap_displacement"):
        np.testing.assert_allclose(at.at(times)[column], after.at(times)[column], atol=1e-8)


def test_a_run_goes_on_from_its_state_at_the_jump_of_a_record() -> None:
    """Where the whole run is at T₀ + 0.2, the one that goes on from T₀ is too."""
    omega, jump = 34.14, 0.61
    absorber = iva.Siva(
        mass_ratio=0.1, clearance=0.5, restitution=0.5, inclination_deg=90, gravity=omega**2
    )
    primary = iva.Primary(damping_ratio=0.01, natural_frequency=omega)
    force = iva.Recorded([jump, jump + 1], [-5.0 * omega**2] * 2)
    whole = iva.simulate(absorber, primary, start=iva.Start(), force=force, duration=jump + 0.25)
    later = iva.simulate(absorber, primary, start=whole.state_at(jump), force=force, duration=0.25)
    there = [run.at([jump + 0.2])["gap_displacement"].item() for run in (whole, later)]
    assert there[1] == pytest.approx(there[0], abs=1e-11)


@pytest.mark.parametrize("begin", [0.0, 0.3, 17.1])
@pytest.mark.parametrize("omega", [1.0, 7.3, 0.031])
def test_the_last_instant_of_a_run_is_part_of_it(omega: float, begin: float) -> None:
    """A run can be asked at the last time of its trajectory and a rounding before its end."""
    run = iva.simulate(
        iva.Siva(mass_ratio=0.1, clearance=0.5, restitution=0.6),
        iva.Primary(damping_ratio=0.01, natural_frequency=omega),
        start=iva.Start(displacement=1.0, time=begin),
        periods=4.77,
    )
    trajectory = run.trajectory(2)
    last = trajectory["time"][-1]
    assert last == pytest.approx(begin + 4.77 * 2 * np.pi / omega, rel=1e-14)
    for time in (last, np.nextafter(last, 0.0), begin):
        assert run.at([time])["displacement"].null_count() == 0
    assert run.state_at(last).displacement == trajectory["displacement"][-1]


def test_the_end_of_a_run_that_ended_early_is_a_state() -> None:
    """A run that stops at its third impact ends with the state after it."""
    run = iva.simulate(
        iva.Siva(mass_ratio=0.1, clearance=0.5, restitution=0.6),
        iva.Primary(damping_ratio=0.01, natural_frequency=3.3),
        start=iva.Start(displacement=1.0),
        periods=20,
        max_impacts=3,
    )
    end = run.impacts["time"][-1]
    state = run.at([end, end + 1e-6])
    assert state["velocity"][0] == run.impacts["velocity_after"][-1]
    assert state["velocity"][1] is None


def test_a_plastic_impact_shows_no_acceleration_that_never_acts() -> None:
    """The second row of an impact that sticks at once lies on the wall, with one acceleration."""
    run = iva.simulate(
        iva.Siva(mass_ratio=0.5, clearance=0.2, restitution=0.0),
        iva.Primary(damping_ratio=0.01),
        start=iva.Start(displacement=1.0, gap_displacement=0.2),
        periods=3,
        measures=["acceleration_max"],
    )
    trajectory = run.trajectory()
    largest = run.summary["acceleration_max"].item()
    assert trajectory["acceleration"].abs().max() <= largest * (1 + 1e-14)
    sticks = run.episodes.filter(run.episodes["impacts"] == 1)["stick_time"]
    assert len(sticks) > 2
    for time in sticks:
        before, after = trajectory.filter(trajectory["time"] == time).rows(named=True)[-2:]
        assert (before["wall"], abs(after["wall"])) == (0, 1)
        assert after["acceleration"] == after["absorber_acceleration"] != before["acceleration"]
