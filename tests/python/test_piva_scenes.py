"""The pendulum absorber in the package: units, gravity, starts, columns, tolerance, sweeps."""

from __future__ import annotations

import copy
import dataclasses
import math
import pickle
from typing import Any

import numpy as np
import polars as pl
import pytest
from numpy.typing import NDArray
from polars.testing import assert_frame_equal

import iva

CENTRED = iva.Start(displacement=1.0)
PIVA = iva.Piva(mass_ratio=0.12, restitution=0.5, clearance=1.4, frequency_ratio=0.4, length=10.0)
# sin θ reaches 0.75
STEEP = iva.Piva(mass_ratio=0.1, restitution=0.7, clearance=1.5, frequency_ratio=0.5, length=2.0)


def decay(
    absorber: iva.Piva = PIVA, start: iva.Start = CENTRED, periods: float = 6, **options: Any
) -> iva.Run:
    primary = iva.Primary(damping_ratio=0.01)
    return iva.simulate(absorber, primary, start=start, periods=periods, **options)


def changed(absorber: iva.Piva = PIVA, **fields: Any) -> iva.Piva:
    return dataclasses.replace(absorber, **fields)


# Columns that came with the pendulum.
NEW = {
    "summary": ["energy_pivot", "stop_reachable", "gravity", "energy_work"],
    "impacts": ["angle", "angular_velocity_before", "angular_velocity_after"],
    "trajectory": ["angle", "angular_velocity"],
}


def new_columns(run: iva.Run) -> dict[str, pl.DataFrame]:
    frames = {"summary": run.summary, "impacts": run.impacts, "trajectory": run.trajectory(10)}
    return {name: frame.select(NEW[name]) for name, frame in frames.items()}


def all_null(frame: pl.DataFrame) -> bool:
    return frame.height > 0 and all(
        frame[name].null_count() == frame.height and frame[name].dtype == pl.Float64
        for name in frame.columns
    )


def test_columns_of_a_pendulum() -> None:
    run = decay()
    found = new_columns(run)
    assert {name: frame.columns for name, frame in found.items()} == NEW
    assert sum(frame.null_count().sum_horizontal().item() for frame in found.values()) == 0
    # g = κ L ωp² = 10 · 0.4², y = L sin θ
    assert found["summary"].row(0) == (0.0, True, pytest.approx(1.6, rel=1e-15), 0.0)
    assert np.allclose(found["impacts"]["angle"].abs(), math.asin(0.14), rtol=1e-15, atol=0)
    assert run.units["impacts"]["angle"] == "rad"
    assert run.at([0.0, 3.0]).columns == run.trajectory().columns


def test_columns_of_a_free_mass(run: iva.Run) -> None:
    found = new_columns(run)
    assert {name: frame.columns for name, frame in found.items()} == NEW
    assert found["summary"].row(0) == (0.0, True, None, 0.0)
    assert found["summary"]["gravity"].dtype == pl.Float64
    assert all_null(found["impacts"])
    assert all_null(found["trajectory"])
    assert all_null(run.at([1.0, 2.0]).select(NEW["trajectory"]))


def test_small_angles_without_a_length() -> None:
    # y and x depend on μ, r, d, e, ζ only; with a length the angle is y/L.
    unknown = decay(changed(angles="small", length=None))
    found = new_columns(unknown)
    assert found["summary"].row(0) == (0.0, True, None, 0.0)
    assert all_null(found["impacts"])
    assert all_null(found["trajectory"])
    known = decay(changed(angles="small"))
    old = [name for name in unknown.impacts.columns if name not in NEW["impacts"]]
    assert unknown.impacts.height >= 5
    assert_frame_equal(unknown.impacts[old], known.impacts[old], rel_tol=1e-13, abs_tol=1e-13)
    assert known.summary["gravity"].item() == pytest.approx(1.6, rel=1e-15)
    states = known.trajectory(20)
    assert np.allclose(states["angle"], states["gap_displacement"] / 10, rtol=1e-14, atol=0)


@pytest.mark.parametrize(("clearance", "reachable"), [(9.999, True), (10.0, False), (12.0, False)])
def test_stops_out_of_reach(clearance: float, reachable: bool) -> None:
    run = decay(changed(clearance=clearance))
    row = run.summary.row(0, named=True)
    assert row["stop_reachable"] is reachable
    assert (row["outcome"], row["impacts"]) == ("finished", 0)
    assert run.trajectory(20)["angle"].abs().max() > 0.05  # type: ignore[operator]
    # y = bθ has no bound.
    small = decay(changed(clearance=clearance, angles="small"))
    assert small.summary["stop_reachable"].item() is True


def test_an_angle_is_a_gap_displacement() -> None:
    # y = b sin θ, w = b cos θ θ̇; a rounding of the start is amplified to 1e-13 at most here.
    absorber = changed(clearance=1.0, length=3.0, inertia_ratio=1.3, contact_distance=4.0)
    angle = iva.Start(displacement=1.0, angle=0.2, angular_velocity=-0.1)
    gap = {"gap_displacement": 4 * math.sin(0.2), "gap_velocity": -0.4 * math.cos(0.2)}
    one = decay(absorber, angle, periods=4).impacts
    other = decay(absorber, iva.Start(displacement=1.0, **gap), periods=4).impacts
    assert one.height >= 3
    assert one["time"].to_list() == pytest.approx(other["time"].to_list(), rel=0, abs=1e-12)


# M = 2 kg, k = 800 N/m: ωn = 20 rad/s; ζ = c/(2 M ωn) = 0.02; m = 0.24 kg.
STRUCTURE = iva.Primary(mass=2.0, stiffness=800.0, damping=1.6)


def structure(length: float | None = 0.1, **fields: Any) -> iva.Run:
    return iva.simulate(
        iva.Piva(mass=0.24, restitution=0.5, length=length, **fields),
        STRUCTURE,
        start=iva.Start(displacement_mm=10.0, velocity=0.06, angle=-0.05, angular_velocity=4.0),
        periods=6,
    )


def test_si_is_the_natural_scene_scaled() -> None:
    # Lengths by 0.01 m, times by 1/20 s, masses by 2 kg. In these six periods rounding is
    # amplified by less than 1e3.
    natural = iva.simulate(
        iva.Piva(
            mass_ratio=0.12,
            restitution=0.5,
            relative_clearance=1.4,
            frequency_ratio=0.4,
            length=10.0,
            inertia_ratio=1.1,
            contact_distance=12.0,
            pivot_damping_ratio=0.03,
        ),
        iva.Primary(damping_ratio=0.02),
        start=iva.Start(displacement=1.0, velocity=0.3, angle=-0.05, angular_velocity=0.2),
        periods=6,
    )
    run = structure(
        gap_mm=28.0,
        frequency_ratio=0.4,
        inertia_ratio=1.1,
        contact_distance=0.12,
        pivot_damping_ratio=0.03,
    )
    assert "SI units" in repr(run)
    factors = {"s": 1 / 20, "m": 0.01, "m/s": 0.2, "J": 0.08, "N s": 0.4, "N": 8.0, "1": 1.0}
    factors |= {"rad": 1.0, "rad/s": 20.0, "m/s²": 4.0}
    seen = set()
    for name in ("summary", "impacts", "envelope"):
        found, base = getattr(run, name), getattr(natural, name)
        assert found.height == base.height > 0
        for column in found.select(pl.selectors.numeric()).columns:
            unit = run.units[name][column]
            seen.add(unit)
            expected = base[column].to_numpy().astype(float) * factors[unit]
            limit = 1e-11 * max(np.nanmax(np.abs(expected), initial=0.0), 1e-3 * factors[unit])
            assert np.allclose(
                found[column].to_numpy().astype(float), expected, 0, limit, equal_nan=True
            ), (name, column)
    assert seen == set(factors)
    assert run.impacts.height >= 5


def test_gravity_in_si_units() -> None:
    # Standard gravity when only the length is given, else κ L ωp² with ωp = r ωn.
    kappa = 1.2
    default = structure(clearance_mm=12.0, inertia_ratio=kappa)
    assert default.summary["gravity"].item() == pytest.approx(9.80665, rel=1e-15)
    ratio = math.sqrt(9.80665 / (kappa * 0.1)) / 20
    given = structure(clearance_mm=12.0, inertia_ratio=kappa, frequency_ratio=ratio)
    assert given.summary["gravity"].item() == pytest.approx(9.80665, rel=1e-15)
    assert default.impacts.height >= 5
    assert default.impacts["time"].to_list() == pytest.approx(
        given.impacts["time"].to_list(), rel=1e-12
    )
    follows = structure(clearance_mm=12.0, inertia_ratio=kappa, frequency_ratio=0.4)
    assert follows.summary["gravity"].item() == pytest.approx(kappa * 0.1 * 8.0**2, rel=1e-15)
    moon = structure(clearance_mm=12.0, inertia_ratio=kappa, gravity=1.62)
    assert moon.summary["gravity"].item() == pytest.approx(1.62, rel=1e-15)


@pytest.mark.parametrize("left_out", ["frequency_ratio", "length", "gravity"])
@pytest.mark.parametrize("angles", ["large", "small"])
def test_any_two_of_the_three(left_out: str, angles: str) -> None:
    # 1.25 · 10 · 0.4² = 2. Six periods amplify a rounding of the third by less than 1e3.
    whole = changed(inertia_ratio=1.25, gravity=2.0, angles=angles)
    base, run = decay(whole), decay(changed(whole, **{left_out: None}))
    assert base.impacts.height >= 5
    for column in ("time", "angle", "approach_velocity"):
        assert np.allclose(run.impacts[column], base.impacts[column], rtol=1e-12, atol=0)
    assert run.summary["gravity"].item() == pytest.approx(2.0, rel=1e-15)


def test_three_that_agree() -> None:
    # g = 10 · 0.4² = 1.6; they may differ by 1e-9 of it.
    assert decay(changed(gravity=1.6 * (1 + 5e-10))).impacts.equals(decay().impacts)
    for factor in (1 + 2e-9, 1 - 2e-9):
        with pytest.raises(ValueError, match=r"absorber\.gravity = 1\.\d+: .*two of the three"):
            decay(changed(gravity=1.6 * factor))


def test_a_power_of_two_in_the_lengths_changes_no_bit() -> None:
    # Scaling by a power of two commutes with every rounding; angles do not scale.
    base = decay(STEEP)
    scaled = decay(changed(STEEP, clearance=12.0, length=16.0), iva.Start(displacement=8.0))
    assert base.impacts.height >= 5
    kept = ["time", *NEW["impacts"]]
    assert scaled.impacts[kept].equals(base.impacts[kept])
    assert (scaled.impacts["displacement"] / 8).equals(base.impacts["displacement"])


def times(run: iva.Run) -> NDArray[np.float64]:
    return run.impacts["time"].to_numpy()


def test_tolerance() -> None:
    # The largest change of an event time per unit change of an input, by differences, says what a
    # relative error of the motion does to it.
    full = times(decay(STEEP))
    assert full.size >= 5
    small = 1e-8
    inputs: list[tuple[iva.Piva, iva.Start]] = [
        (STEEP, dataclasses.replace(CENTRED, displacement=1 + small)),
        (STEEP, dataclasses.replace(CENTRED, velocity=small)),
        (STEEP, dataclasses.replace(CENTRED, gap_displacement=small)),
        (STEEP, dataclasses.replace(CENTRED, gap_velocity=small)),
        (changed(STEEP, clearance=1.5 + small), CENTRED),
        (changed(STEEP, mass_ratio=0.1 + small), CENTRED),
        (changed(STEEP, restitution=0.7 + small), CENTRED),
    ]
    moved = [np.abs(times(decay(other, start)) - full) / small for other, start in inputs]
    condition = np.maximum(np.max(moved, axis=0), 1)
    assert condition.max() < 1e4
    worst = []
    for tolerance in (1e-3, 1e-6, 1e-9, 1e-12):
        error = np.abs(times(decay(STEEP, tolerance=tolerance)) - full)
        assert (error <= 10 * tolerance * condition).all(), tolerance
        worst.append(error.max())
    assert worst[0] > worst[1] > worst[2] > worst[3]
    assert worst[1] > 1e-12  # it spares work
    assert decay(STEEP, tolerance=0).impacts.equals(decay(STEEP).impacts)


def test_small_angles_need_no_tolerance() -> None:
    # It changes nothing: their flight is linear.
    small = changed(STEEP, angles="small")
    assert decay(small, tolerance=1e-3).impacts.equals(decay(small).impacts)


AXES = {"frequency_ratio": [0.3, 0.4], "length": [8.0, 10.0], "angle": [-0.02, 0.0, 0.12]}


def sweep(threads: int | None = None) -> iva.Table:
    return iva.sweep(
        PIVA,
        iva.Primary(damping_ratio=0.01),
        over=AXES,
        start=CENTRED,
        periods=6,
        tables=("summary", "impacts", "episodes", "envelope"),
        threads=threads,
    )


def test_a_point_of_a_sweep_is_the_run_of_its_values() -> None:
    table = sweep()
    assert table.summary.columns[:4] == ["point", *AXES]
    assert table.summary.height == 12
    for point in table.summary.iter_rows(named=True):
        absorber = changed(frequency_ratio=point["frequency_ratio"], length=point["length"])
        run = decay(absorber, iva.Start(displacement=1.0, angle=point["angle"]))
        impacts = table.impacts.filter(point=point["point"]).drop("point")
        assert impacts.height >= 5
        assert impacts.equals(run.impacts.drop("point"))
        row = run.summary.row(0, named=True)
        assert {name: point[name] for name in row if name != "point"} == {
            name: value for name, value in row.items() if name != "point"
        }
    gravity = table.summary["length"] * table.summary["frequency_ratio"] ** 2
    assert np.allclose(table.summary["gravity"], gravity, rtol=1e-15, atol=0)


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_threads_change_nothing(threads: int) -> None:
    assert sweep(threads) == sweep()


def test_an_axis_replaces_the_same_quantity() -> None:
    start = iva.Start(displacement=1.0, gap_displacement=0.3)
    table = iva.sweep(PIVA, iva.Primary(), over={"angle": [0.1]}, start=start, periods=2)
    run = iva.simulate(PIVA, iva.Primary(), start=iva.Start(displacement=1.0, angle=0.1), periods=2)
    assert table.summary.drop("angle").equals(run.summary)


def test_results_are_values() -> None:
    run = decay()
    for twin in (pickle.loads(pickle.dumps(run)), copy.copy(run), copy.deepcopy(run)):
        assert twin == run
        assert_frame_equal(twin.trajectory(7), run.trajectory(7))
    assert run != decay(changed(angles="small"))
    assert "Piva(mass_ratio=0.12" in repr(run)
    assert f"{run.impacts.height} impacts" in repr(run)
    assert "angles='small'" in repr(decay(changed(angles="small")))
