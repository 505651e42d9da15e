"""Runs that go on from a state of another run, and runs that begin at another instant.

Expected numbers are closed forms, or those of the run that was not cut: the same motion. Both
differ by rounding, some 1e-15 of the numbers of the state, which `condition` (the largest change
of an impact time per change of the start, of ``errors=True``) says how to carry on.
"""

from __future__ import annotations

import cmath
import copy
import math
import pickle
from typing import Any

import numpy as np
import polars as pl
import pytest

import iva

EPS = 2.0**-52
END = 25.0
SIVA: dict[str, Any] = {"mass_ratio": 0.15, "restitution": 0.7, "clearance": 0.6}
STICKY: dict[str, Any] = {"mass_ratio": 0.15, "restitution": 0.4, "clearance": 0.1}
PIVA: dict[str, Any] = {**SIVA, "frequency_ratio": 0.5, "length": 2.0}
QUAKE = iva.Recorded([0.5, 2.0, 9.0, 15.0, 18.0], [0.4, 1.2, -0.9, 0.8, 0.0], "base_acceleration")
FORCE = iva.Harmonic(amplitude=0.3, frequency=0.95, phase=0.4)
BASE = iva.Harmonic(base_acceleration=0.3, frequency=0.95, phase=1.0)
#: Absorber and force; all from x = 1, ẋ = 0.2, at rest in the middle of the gap, ζ = 0.03.
SCENES: dict[str, tuple[Any, Any]] = {
    "decay": (iva.Siva(**SIVA), None),
    "relative": (iva.Siva(mass_ratio=0.15, restitution=0.7, relative_clearance=0.6), None),
    "force": (iva.Siva(**SIVA), FORCE),
    "base": (iva.Siva(**SIVA), [BASE, iva.Harmonic(amplitude=0.1, frequency=1.7)]),
    "quake": (iva.Siva(**SIVA), QUAKE),
    "blow": (iva.Siva(**SIVA), [iva.Impulse(velocity=0.7, time=t) for t in (0.0, 6.0, 14.0)]),
    "upright": (iva.Siva(**SIVA, inclination_deg=90.0, gravity=0.2), FORCE),
    "pendulum": (iva.Piva(**PIVA), None),
    "compound": (iva.Piva(**PIVA, inertia_ratio=1.2, contact_distance=2.5), BASE),
    "small": (iva.Piva(**PIVA, angles="small", pivot_damping_ratio=0.02), QUAKE),
    "sticky": (iva.Siva(**STICKY), None),
    "stuck pendulum": (iva.Piva(**PIVA | STICKY), None),
}
FLYING = [name for name in SCENES if name not in {"sticky", "stuck pendulum"}]


def simulate(absorber: Any, force: Any, start: Any = None, **run: Any) -> iva.Run:
    """Run it to `END`, slightly damped."""
    begin = iva.Start(displacement=1.0, velocity=0.2, gap_displacement=0.0)
    start = begin if start is None else start
    primary = run.pop("primary", iva.Primary(damping_ratio=0.03))
    if not {"duration", "periods", "cycles"} & set(run):
        run["duration"] = END - (start.time or 0.0)
    return iva.simulate(absorber, primary, start=start, force=force, **run)


def later(table: pl.DataFrame, time: float) -> pl.DataFrame:
    """Return the rows after an instant, without their numbers."""
    drop = [name for name in ("impact", "episode", "peak", "cycle") if name in table.columns]
    return table.filter(pl.col("time") > time).drop(drop)


def bits(table: pl.DataFrame) -> str:
    """Return all values such that equal texts are equal bits."""
    return repr([table.columns, table.rows()])


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("time", [0.0, 3.3, 9.7, 16.1])
def test_a_state_is_that_of_at(name: str, time: float) -> None:
    """Contract: the attributes are the columns of `at`, to the bit; nothing is an integer."""
    run = simulate(*SCENES[name])
    state, row = run.state_at(time), run.at([time]).row(0, named=True)
    if (name, time) == ("blow", 0.0):
        # The blow of time zero is still to come in a run from there.
        assert state == run.start
        return
    for field in ("time", "displacement", "velocity", "gap_displacement", "gap_velocity"):
        assert repr(getattr(state, field)) == repr(row[field]), field
    assert state == run.state_at(time)
    assert state != run.state_at(time + 0.1)


@pytest.mark.parametrize("name", ["sticky", "compound"])
def test_a_state_travels(name: str) -> None:
    """Contract: frozen, pickled and copied to the same."""
    state = simulate(*SCENES[name]).state_at(5.0)
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        assert pickle.loads(pickle.dumps(state, protocol)) == state
    assert copy.copy(state) == copy.deepcopy(state) == state
    with pytest.raises(AttributeError):
        state.displacement = 0.0  # type: ignore[misc]


def test_a_structure_alone_has_no_gap() -> None:
    """By x = cos t without damping; its gap is None, and it goes on as cos t."""
    run = simulate(None, None, iva.Start(displacement=1.0), primary=iva.Primary(), duration=9.0)
    state = run.state_at(5.0)
    assert (state.gap_displacement, state.gap_velocity) == (None, None)
    found = simulate(None, None, state, primary=iva.Primary(), duration=20.0)
    times = np.linspace(5.0, 25.0, 50)
    expected = np.cos(times).tolist()
    assert found.at(times)["displacement"].to_list() == pytest.approx(expected, rel=0, abs=1e-14)


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("time", [3.3, 9.7, 16.1])
def test_the_motion_goes_on(name: str, time: float) -> None:
    """The events of the run that was not cut, to what `condition` makes of rounding."""
    absorber, force = SCENES[name]
    run = simulate(absorber, force, errors=True)
    found = simulate(absorber, force, run.state_at(time), errors=True)
    error = 8.0 * EPS * (run.summary["condition"].item() + END)
    assert error < 1e-10
    have, want = found.impacts, later(run.impacts, time)
    assert have.height == want.height > 1
    assert have["wall"].to_list() == want["wall"].to_list()
    assert min(have["time"]) > time
    assert have["impact"].to_list() == list(range(have.height))
    for column in ("time", "displacement", "velocity_after", "approach_velocity", "energy_loss"):
        assert have[column].to_list() == pytest.approx(want[column].to_list(), rel=0, abs=error)
    rides, expected = found.episodes["release_time"], run.episodes["release_time"]
    kept = expected.fill_null(END).filter(expected.fill_null(END) > time)
    assert rides.fill_null(END).to_list() == pytest.approx(kept.to_list(), rel=0, abs=error)
    times = np.linspace(time, END, 200)
    for column in ("displacement", "velocity", "gap_displacement"):
        states = (of.at(times)[column].to_numpy() for of in (found, run))
        assert np.abs(np.subtract(*states)).max() < error
    row = found.summary.row(0, named=True)
    assert row["damping_ratio_energy"] is None
    assert row["energy_final"] == pytest.approx(run.summary["energy_final"].item(), abs=error)
    assert abs(row["energy_residual"]) < 1e-14


@pytest.mark.parametrize("name", SCENES)
def test_the_begin_has_the_same_bits(name: str) -> None:
    """Contract: a run that goes on from time zero is the run."""
    absorber, force = SCENES[name]
    run = simulate(absorber, force)
    again = simulate(absorber, force, run.state_at(0.0))
    for table in ("impacts", "episodes", "envelope", "stroboscope"):
        assert bits(getattr(again, table)) == bits(getattr(run, table)), table
    for frames in zip(*(of.summary.rows() for of in (again, run)), strict=True):
        assert frames[0] == frames[1]


@pytest.mark.parametrize("name", FLYING)
@pytest.mark.parametrize("index", [0, 2])
def test_at_an_impact_it_is_the_state_after_it(name: str, index: int) -> None:
    """To the bit, at the very wall; the impact itself is not listed again."""
    absorber, force = SCENES[name]
    run = simulate(absorber, force)
    hit = run.impacts.row(index, named=True)
    state: Any = run.state_at(hit["time"])
    assert (state.velocity, abs(state.gap_displacement or 0.0)) == (hit["velocity_after"], 0.6)
    found = simulate(absorber, force, state)
    assert found.impacts.height == run.impacts.height - index - 1 > 0


@pytest.mark.parametrize("name", ["sticky", "stuck pendulum"])
@pytest.mark.parametrize("share", [0.0, 0.4])
def test_a_ride_goes_on(name: str, share: float) -> None:
    """Stuck at the begin, it is an episode that begins there."""
    absorber, force = SCENES[name]
    run = simulate(absorber, force)
    episode = run.episodes.row(0, named=True)
    first, last = episode["stick_time"], episode["release_time"]
    state: Any = run.state_at(first + share * (last - first))
    found = simulate(absorber, force, state)
    assert found.episodes.height == run.episodes.height
    ride = found.episodes.row(0, named=True)
    begin = (ride["wall"], ride["start_time"], ride["stick_time"], ride["impacts"])
    assert begin == (episode["wall"], state.time, state.time, 0)
    assert ride["release_time"] == pytest.approx(last, rel=1e-13)
    assert found.at([state.time])["wall"].item() == episode["wall"]
    want = later(run.impacts, state.time)
    assert found.impacts.height == want.height
    assert found.impacts["time"][:3].to_list() == pytest.approx(
        want["time"][:3].to_list(), rel=1e-12
    )


@pytest.mark.parametrize("time", [0.5, 2.0, 2.5, 9.0, 11.3])
def test_a_pendulum_that_goes_over_the_top(time: float) -> None:
    """Beyond 90° y = b sin θ does not tell θ: the angle goes on, over a stop that is out of reach.

    The two motions differ by rounding of numbers of the order of 1, over 20 time units.
    """
    absorber = iva.Piva(**PIVA | {"clearance": 5.0})
    start = iva.Start(displacement=1.0, angle=2.5, angular_velocity=0.1)
    run = simulate(absorber, None, start, duration=20.0)
    angle = run.at([time])["angle"].item()
    assert (abs(angle) > 0.5 * math.pi) == (time in {0.5, 2.0, 11.3})
    found = simulate(absorber, None, run.state_at(time), duration=20.0 - time)
    times = np.linspace(time, 20.0, 60)
    for column in ("displacement", "angle", "angular_velocity"):
        states = (of.at(times)[column].to_numpy() for of in (found, run))
        assert np.abs(np.subtract(*states)).max() < 5e-14, column


@pytest.mark.parametrize("time", [6.0, 9.5])
def test_settling_is_told_on_the_clock(time: float) -> None:
    """By their definitions: |x| is p·A₀ at these instants, A₀ that of the state."""
    absorber = iva.Siva(**STICKY)
    start = iva.Start(displacement=1.0)
    state: Any = simulate(absorber, None, start).state_at(time)
    run = simulate(absorber, None, state, duration=190.0)
    row = run.summary.row(0, named=True)
    instants = [row[f"settling_time_{percent}"] for percent in (10, 5, 2)]
    assert time < instants[0] < instants[1] < instants[2] < time + 190.0
    sizes = run.at(instants)["displacement"].abs() / abs(state.displacement)
    assert sizes.to_list() == pytest.approx([0.1, 0.05, 0.02], rel=0, abs=1e-13)
    x, v, w = state.displacement, state.velocity, state.gap_velocity
    energy = 0.5 * (x**2 + v**2 + 0.15 * (v + w) ** 2)
    assert row["energy_initial"] == pytest.approx(energy, rel=4 * EPS)


def test_chains() -> None:
    """A run in five pieces has the impacts of the run in one."""
    absorber, force = SCENES["upright"]
    run, pieces = simulate(absorber, force, errors=True), list[float]()
    start: Any = None
    for _ in range(5):
        piece = simulate(absorber, force, start, duration=5.0)
        pieces += piece.impacts["time"].to_list()
        start = piece.state_at((start.time if start else 0.0) + 5.0)
    error = 40.0 * EPS * (run.summary["condition"].item() + END)
    assert start.time == END
    assert pieces == pytest.approx(run.impacts["time"].to_list(), rel=0, abs=error)


def test_the_clock_goes_on() -> None:
    """Contract: lengths count from the state, instants of rows, samples and strobes do not."""
    absorber, force = SCENES["force"]
    state = simulate(absorber, force).state_at(4.0)
    cycle = 2.0 * math.pi / 0.95
    for given, length in (
        ({"duration": 9.0}, 9.0),
        ({"periods": 2.0}, 4.0 * math.pi),
        ({"cycles": 3.5, "discard": 1.0}, 3.5 * cycle),
    ):
        run = simulate(absorber, force, state, **given)
        times = run.trajectory(50)["time"]
        assert (times[0], times[-1]) == (4.0, pytest.approx(4.0 + length, rel=2 * EPS))
        begin = 4.0 + given.get("discard", 0.0) * cycle
        strobes = [(2.0 * math.pi * k - 0.4) / 0.95 for k in range(1, 9)]
        expected = [t for t in strobes if begin <= t <= 4.0 + length]
        assert run.stroboscope["time"].to_list() == pytest.approx(expected, rel=4 * EPS)
        for outside in (3.9, 4.1 + length):
            with pytest.raises(ValueError, match="times"):
                run.at([outside])
        assert run.state_at(4.0) == state


@pytest.mark.parametrize("kind", ["amplitude", "base_acceleration"])
@pytest.mark.parametrize("time", [0.0, 2.0, 1000.25])
def test_the_phase_of_a_force_at_another_instant(kind: str, time: float) -> None:
    """From Re X e^(iΩt) at any t the structure has no transient: X (1 − Ω² + 2iζΩ) = F, or −A."""
    omega, zeta, load = 0.8, 0.03, 0.3 * cmath.exp(0.4j)
    x = (load if kind == "amplitude" else -load) / complex(1.0 - omega**2, 2.0 * zeta * omega)
    turned = x * cmath.exp(1j * omega * time)
    moved, speed = turned.real, (1j * omega * turned).real
    start = iva.Start(displacement=moved, velocity=speed, time=time)
    force: Any = iva.Harmonic(**{kind: 0.3}, frequency=omega, phase=0.4)
    run = simulate(None, force, start, duration=30.0)
    times = time + np.linspace(0.0, 30.0, 40)
    expected = [(x * cmath.exp(1j * omega * t)).real for t in times]
    # The phase Ωt of t = 1000 is rounded to some 1e-13.
    found = run.at(times)["displacement"].to_list()
    assert found == pytest.approx(expected, rel=0, abs=1e-14 + 4.0 * EPS * time)


def test_records_and_impulses_keep_their_instants() -> None:
    """Under f = t/10 up to t = 10, x = t/10 from any of its points; impulses before are over."""
    ramp = iva.Recorded([0.0, 10.0], [0.0, 1.0])
    start = iva.Start(displacement=0.3, velocity=0.1, time=3.0)
    blows = [iva.Impulse(velocity=0.5, time=t) for t in (2.0, 7.0)]
    run = simulate(None, [ramp, *blows], start, primary=iva.Primary(), duration=7.0)
    times = np.linspace(3.0, 10.0, 30)
    expected = 0.1 * times + 0.5 * np.sin(np.maximum(times - 7.0, 0.0))
    assert np.abs(run.at(times)["displacement"].to_numpy() - expected).max() < 1e-14


@pytest.mark.parametrize("time", [0.0, 6.0, 14.0])
@pytest.mark.parametrize("absorber", [None, iva.Siva(**SIVA)])
def test_a_blow_at_the_cut_counts_once(absorber: Any, time: float) -> None:
    """Whether the state is that before or after the impulse, the motion is that of the run."""
    force = SCENES["blow"][1]
    start = iva.Start(displacement=1.0)
    run = simulate(absorber, force, start, errors=absorber is not None)
    found = simulate(absorber, force, run.state_at(time))
    times = np.linspace(time + 0.1, END, 50)
    states = (of.at(times)["displacement"].to_numpy() for of in (found, run))
    condition = run.summary["condition"].item() or 1.0
    assert np.abs(np.subtract(*states)).max() < 8.0 * EPS * (condition + END)


@pytest.mark.parametrize("name", ["decay", "quake", "pendulum"])
def test_other_parts_take_the_numbers(name: str) -> None:
    """Contract: another absorber, structure or force begins with the numbers that are shown.

    So does a `Start` that has them, to the bit.
    """
    state = simulate(*SCENES[name]).state_at(7.7)
    names = ("time", "displacement", "velocity", "gap_displacement", "gap_velocity")
    numbers = {field: getattr(state, field) for field in names}
    wide = {"mass_ratio": 0.3, "restitution": 0.5, "clearance": 0.9}
    absorber = iva.Piva(**(PIVA | wide)) if name == "pendulum" else iva.Siva(**wide)
    given: Any = {"primary": iva.Primary(damping_ratio=0.1), "duration": 12.0}
    run, same = (simulate(absorber, FORCE, s, **given) for s in (state, iva.Start(**numbers)))
    # A gap displacement is that from a wall, at 0.9, which rounds.
    found = run.at([7.7]).select(names).row(0)
    assert found[:3] == tuple(numbers.values())[:3]
    assert found[3:] == pytest.approx(tuple(numbers.values())[3:], rel=0, abs=EPS)
    assert run.impacts.height > 1
    assert bits(run.impacts) == bits(same.impacts)


def test_a_rider_of_a_narrower_gap_flies_in_a_wider_one() -> None:
    """On the wall of the gap of 0.1 it is in the middle of nothing in a gap of 0.3."""
    run = simulate(*SCENES["sticky"])
    episode = run.episodes.row(0, named=True)
    state: Any = run.state_at(0.5 * (episode["stick_time"] + episode["release_time"]))
    wider = simulate(iva.Siva(**STICKY | {"clearance": 0.3}), None, state)
    assert wider.at([state.time]).select("wall", "gap_velocity").row(0) == (0, 0.0)
    with pytest.raises(ValueError, match="gap_displacement"):
        simulate(iva.Siva(**STICKY | {"clearance": 0.05}), None, state)


@pytest.mark.parametrize("name", ["decay", "compound", "sticky"])
def test_with_all_that_a_run_can_do(name: str) -> None:
    """True errors are rounding; a sweep has the bits of runs; gradients are differences."""
    absorber, force = SCENES[name]
    given: dict[str, Any] = {"start": simulate(absorber, force).state_at(8.0), "duration": 4.0}
    run = simulate(absorber, force, **given, verify=True, errors=True, gradients=("restitution",))
    assert run.verification.agrees
    assert max(run.verification.impacts["time"].abs()) < 1e-14 * run.summary["condition"].item()
    assert pickle.loads(pickle.dumps(run)) == run
    e, step = absorber.restitution, 1e-5
    fields = {field: getattr(absorber, field) for field in type(absorber).__slots__}
    values = [e - step, e, e + step]
    primary = iva.Primary(damping_ratio=0.03)
    over, tables = {"restitution": values}, ("summary", "impacts")
    table = iva.sweep(absorber, primary, over=over, force=force, tables=tables, **given)
    ends = []
    for point, value in enumerate(values):
        alone = simulate(type(absorber)(**(fields | {"restitution": value})), force, **given)
        rows = table.impacts.filter(point=point).drop("point", "restitution", strict=False)
        assert bits(rows) == bits(alone.impacts.drop("point"))
        ends.append(alone.summary["energy_final"].item())
    slope = run.gradients["restitution"].summary["energy_final"].item()
    assert slope == pytest.approx((ends[2] - ends[0]) / (2.0 * step), rel=1e-5)


@pytest.mark.parametrize(
    ("time", "error"),
    [(-0.1, ValueError), (25.1, ValueError), (math.nan, ValueError), (math.inf, ValueError),
     ("5", TypeError), (None, TypeError), (True, TypeError), ([5.0], TypeError)],
)  # fmt: skip
def test_bad_instants_are_named(time: Any, error: type[Exception]) -> None:
    """Contract: the field `time`, the value, and what is allowed, in one line."""
    run = simulate(*SCENES["decay"])
    with pytest.raises(error, match=r"^time = ") as caught:
        run.state_at(time)
    said = str(caught.value)
    assert "give" in said
    assert "\n" not in said
    if error is ValueError:
        assert "from 0 to 25" in said


def test_an_early_end_has_no_later_state() -> None:
    """Contract: that is outside the run."""
    run = simulate(*SCENES["decay"], max_impacts=2)
    assert run.summary["outcome"].item() == "impact_limit"
    with pytest.raises(ValueError, match=r"^time = 20"):
        run.state_at(20.0)


DIVIDED: dict[str, Any] = {
    "siva": iva.Siva(**SIVA, units=3, clearance_spread=0.2),
    "list": [
        iva.Siva(**SIVA | {"clearance": 0.45}),
        iva.Siva(**SIVA, units=2, clearance_spread=0.3),
    ],
    "upright": iva.Siva(**STICKY, units=2, clearance_spread=0.5, inclination_deg=90, gravity=0.2),
    "pendulum": iva.Piva(**PIVA, units=2, clearance_spread=0.2),
}


@pytest.mark.parametrize("time", [2.0, 7.3])
@pytest.mark.parametrize("name", DIVIDED)
def test_units_go_on(name: str, time: float) -> None:
    """Each from its own place: the impacts of the run that was not cut, to its condition."""
    given: dict[str, Any] = {"start": iva.Start(displacement=1.0), "duration": 12.0}
    run = simulate(DIVIDED[name], FORCE, **given, errors=True)
    state: Any = run.state_at(time)
    rows = run.at([time])
    assert rows.height == len(state.gap_displacement) == len(state.gap_velocity) > 1
    assert state.gap_displacement == tuple(rows["gap_displacement"])
    assert len(set(state.gap_displacement)) > 1
    found = simulate(DIVIDED[name], FORCE, state, duration=12.0 - time)
    lost = 64.0 * EPS * (run.summary["condition"].item() + 12.0)
    assert lost < 1e-6
    # Impacts below the floor of a chatter are listed or not by their speed.
    kept = pl.col("time").is_between(time, 11.9) & (pl.col("approach_velocity").abs() > 1e-4)
    seen, expected = (of.impacts.filter(kept).drop("point", "impact") for of in (found, run))
    assert expected.height > 3
    assert seen["absorber"].to_list() == expected["absorber"].to_list()
    for column in ("time", "velocity_after", "approach_velocity"):
        assert seen[column].to_numpy() == pytest.approx(expected[column].to_numpy(), abs=lost)


def test_a_sweep_begins_with_the_units_of_a_state() -> None:
    """Points have the bits of runs; a swept number of units has no such list."""
    units = DIVIDED["siva"]
    given: dict[str, Any] = {"start": simulate(units, None).state_at(5.0), "duration": 6.0}
    primary = iva.Primary(damping_ratio=0.03)
    table = iva.sweep(
        units, primary, over={"restitution": [0.7, 0.8]}, tables=("summary", "impacts"), **given
    )
    alone = simulate(units, None, **given)
    rows = table.impacts.filter(point=0).drop("point", "restitution", strict=False)
    assert bits(rows) == bits(alone.impacts.drop("point"))
    assert pickle.loads(pickle.dumps(alone)) == alone
    with pytest.raises(ValueError, match="a number for each unit; give one for all units"):
        iva.sweep(units, primary, over={"units": [2, 3]}, **given)


def test_pendulums_in_units_that_swing_far_are_told_by_their_angles() -> None:
    absorber = iva.Piva(**PIVA | {"clearance": 1.95}, units=2, clearance_spread=0.02)
    start = iva.Start(displacement=1.0, angle=[1.2, -1.0], angular_velocity=0.1)
    run = simulate(absorber, None, start, duration=9.0)
    state: Any = run.state_at(0.2)
    assert (len(state.angle), state.gap_displacement) == (2, None)
    found = simulate(absorber, None, state, duration=8.8)
    angles = [of.at([8.9])["angle"].to_list() for of in (found, run)]
    assert angles[0] == pytest.approx(angles[1], abs=1e-12)
