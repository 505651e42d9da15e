"""Measures that jump from point to point: medians of neighbours, steady ridges, bands."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
import polars as pl
import pytest
from matplotlib.collections import QuadMesh

import iva
from axes_seen import Numbers, line
from iva import plots
from iva.paper import bands
from iva.plots.neighbours import medians
from iva.plots.styles import figure_of

mpl.use("Agg")

pytestmark = pytest.mark.usefixtures("pictures_are_closed")

COLUMNS, ROWS = 24, 20


def mapped(values: Numbers) -> iva.Table:
    """Return a table of a grid, rows up, with some settling times."""
    across, up = np.linspace(0.1, 1.2, COLUMNS), np.linspace(0.05, 0.2, ROWS)
    frame = pl.DataFrame(
        {
            "point": np.arange(values.size),
            "relative_clearance": np.tile(across, ROWS),
            "mass_ratio": np.repeat(up, COLUMNS),
            "settling_time_5": values.ravel(),
        }
    ).with_columns(pl.col("settling_time_5").fill_nan(None))
    swept = ("relative_clearance", "mass_ratio")
    units = iva.units.Units("natural", swept)
    return iva.Table(swept, units, iva.frames.Frames({"summary": lambda: frame}))


def valley() -> tuple[Numbers, Numbers]:
    """Return settling times that are smallest along the middle row, and the same with luck."""
    smooth = np.abs(np.arange(ROWS) - ROWS // 2)[:, None] + 10.0 + np.zeros((1, COLUMNS))
    lucky = smooth.copy()
    # One point in 20 settles at once, far from the valley.
    random = np.random.default_rng(1)
    lucky[random.random(smooth.shape) < 0.05] = 1.0
    return smooth, lucky


def colours(axes: Any) -> Numbers:
    """Return the values that a map shows."""
    (mesh,) = [one for one in axes.collections if isinstance(one, QuadMesh)]
    array: Any = mesh.get_array()
    values: Numbers = array.filled(np.nan)
    return values


def test_luck_does_not_move_a_ridge() -> None:
    _, lucky = valley()
    axes = plots.heatmap(mapped(lucky), "settling_time_5")
    assert colours(axes).tolist() == lucky.tolist(), "the map is as it is"
    rows = np.linspace(0.05, 0.2, ROWS)
    _, ridge = line(axes, "smallest at each γ (medians of 5 × 5)")
    assert np.abs(ridge - rows[ROWS // 2]).max() <= 1.01 * (rows[1] - rows[0])
    raw = rows[lucky.argmin(axis=0)]
    assert np.abs(raw - rows[ROWS // 2]).max() > 5 * (rows[1] - rows[0]), "luck does"


def test_the_ridge_of_what_is_robust_is_left_as_it_is() -> None:
    _, lucky = valley()
    raw = mapped(lucky)
    frame = raw.summary.rename({"settling_time_5": "settling_time_5_q90"})
    judged = iva.Table(raw.swept, raw.units, iva.frames.Frames({"summary": lambda: frame}))
    axes = plots.heatmap(judged, "settling_time_5_q90")
    _, ridge = line(axes, "smallest at each γ")
    assert ridge.tolist() == np.linspace(0.05, 0.2, ROWS)[lucky.argmin(axis=0)].tolist()
    label = figure_of(axes).axes[1].get_ylabel()
    assert label == "5 % settling time ωₙt₅\n90 % of the neighbours"


@pytest.mark.parametrize("count", [4, 12], ids=["as it is", "steadied"])
def test_a_ridge_has_a_gap_where_nothing_impacts(count: int) -> None:
    damping = 0.02
    # The mass stays where it is until the first impact, and the structure swings from 1 to −δ.
    reach = 1.0 + np.exp(-np.pi * damping / np.sqrt(1.0 - damping**2))
    clearances = np.linspace(0.4, 3.6, count)
    table = iva.sweep(
        iva.Siva(restitution=0.6),
        iva.Primary(damping_ratio=damping),
        over={"relative_clearance": clearances, "mass_ratio": np.linspace(0.02, 0.2, count)},
        start=iva.Start(displacement=1.0),
        periods=60,
    )
    axes = plots.heatmap(table, "settling_time_5")
    [ridge] = axes.lines
    assert np.isnan(np.asarray(ridge.get_ydata())).tolist() == (clearances > reach).tolist()


def test_a_map_without_impacts_has_no_ridge() -> None:
    table = iva.sweep(
        iva.Siva(restitution=0.6),
        iva.Primary(damping_ratio=0.02),
        over={"clearance": [2.5, 3.0], "mass_ratio": [0.1, 0.2]},
        start=iva.Start(displacement=1.0),
        periods=60,
    )
    assert table.summary["impacts"].sum() == 0
    axes = plots.heatmap(table, "settling_time_5")
    assert not axes.lines
    assert axes.get_legend() is None


def test_a_pendulum_has_a_best_frequency_without_impacts() -> None:
    table = iva.sweep(
        iva.Piva(mass_ratio=0.1, restitution=0.6, length=10.0),
        iva.Primary(damping_ratio=0.02),
        over={"clearance": [8.0, 9.0], "frequency_ratio": [0.5, 0.8, 1.1]},
        start=iva.Start(displacement=1.0),
        periods=60,
    )
    assert table.summary["impacts"].sum() == 0
    [ridge] = plots.heatmap(table, "residual_amplitude").lines
    times = table.summary.filter(pl.col("clearance") == 8.0).sort("residual_amplitude")
    assert np.asarray(ridge.get_ydata()).tolist() == 2 * [times["frequency_ratio"][0]]
    # Of gaps that no pendulum crosses none is the best.
    assert not plots.heatmap(table, "residual_amplitude", x="frequency_ratio").lines


def test_a_map_of_medians_and_its_ridge() -> None:
    smooth, lucky = valley()
    axes = plots.heatmap(mapped(lucky), "settling_time_5", median_of=3)
    shown = colours(axes)
    for row, column in ((0, 0), (5, 7), (ROWS - 1, 3)):
        window = lucky[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
        assert shown[row, column] == np.median(window)
    inside = shown[1:-1, 1:-1]
    assert np.abs(inside - smooth[1:-1, 1:-1]).max() <= 1.0, "without luck"
    _, ridge = line(axes, "smallest at each γ")
    assert ridge.tolist() == np.linspace(0.05, 0.2, ROWS)[shown.argmin(axis=0)].tolist()
    label = figure_of(axes).axes[1].get_ylabel()
    assert label == "5 % settling time ωₙt₅\nmedian of 3 × 3 neighbours"


def test_medians_of_what_is_missing() -> None:
    smooth, _ = valley()
    smooth[3, 4] = np.nan
    smooth[8:13, 8:13] = np.nan
    shown = colours(plots.heatmap(mapped(smooth), "settling_time_5", median_of=3))
    assert np.isfinite(shown[3, 4]), "one that is null has neighbours"
    assert np.isnan(shown[9:12, 9:12]).all(), "many that are null have not"
    none = np.full((ROWS, COLUMNS), np.nan)
    none[0, 0] = 1.0
    with pytest.raises(ValueError, match="median_of = 3: most values are null around every point"):
        plots.heatmap(mapped(none), "settling_time_5", median_of=3)


def test_what_never_settles_is_worse_than_what_does() -> None:
    values = np.full((ROWS, COLUMNS), 5.0)
    # Around the point: four that never settle, 5, 5, 5, 7, 7. Without the four the median is 5.
    values[9, 9:12] = values[10, 9] = np.nan
    values[10, 10] = values[11, 9] = 7.0
    shown = colours(plots.heatmap(mapped(values), "settling_time_5", median_of=3))
    assert shown[10, 10] == 7.0
    values[11, 10] = np.nan  # five of nine
    shown = colours(plots.heatmap(mapped(values), "settling_time_5", median_of=3))
    assert np.isnan(shown[10, 10])


def test_windows_are_odd() -> None:
    smooth, _ = valley()
    for wrong in (0, 2, -1, 2.5, float("inf")):
        with pytest.raises(ValueError, match=r"median_of = .*: give "):
            plots.heatmap(mapped(smooth), "settling_time_5", median_of=wrong)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="median_of = '3'"):
        plots.heatmap(mapped(smooth), "settling_time_5", median_of="3")  # type: ignore[arg-type]


def test_medians_as_numpy_has_them() -> None:
    grid = np.random.default_rng(2).normal(size=(7, 9))
    grid[grid > 1.2] = np.nan
    for points in (1, 3, 5):
        half = points // 2
        for row, column in np.ndindex(grid.shape):
            window = grid[
                max(row - half, 0) : row + half + 1, max(column - half, 0) : column + half + 1
            ]
            known = window[np.isfinite(window)]
            found = medians(grid, points)[row, column]
            if 2 * known.size >= window.size:
                assert found == pytest.approx(np.median(known), rel=1e-15)
            else:
                assert np.isnan(found)


def test_bands_hold_the_values_around() -> None:
    random = np.random.default_rng(3)
    curve = random.normal(size=101)
    low, middle, high = bands.over_neighbours(curve, (0.1, 0.5, 0.9))
    for place in (0, 5, 50, 100):
        window = curve[max(place - 5, 0) : place + 6]
        wanted = np.quantile(window, (0.1, 0.5, 0.9))
        assert [low[place], middle[place], high[place]] == pytest.approx(wanted.tolist())
    curve[20:40] = np.nan
    assert np.isnan(bands.over_neighbours(curve, (0.5,))[0, 26:34]).all()
    assert np.isfinite(bands.over_neighbours(curve, (0.5,))[0, 22])


def test_only_curves_that_jump_are_banded() -> None:
    at = np.linspace(0.0, 1.0, 101)
    assert not bands.jumps(np.sin(6.0 * at))
    assert not bands.jumps(np.floor(10.0 * at)), "steps are no jumps up and down"
    assert bands.jumps(at + 0.1 * np.random.default_rng(4).normal(size=101))


def test_fig7_shows_medians_bands_and_every_point() -> None:
    report = iva.paper.reproduce("fig7")
    made = report.items["fig7"]
    figure = made.draw()
    smooth, *_, jumping = figure.axes
    assert not smooth.collections, "one cycle is smooth"
    assert len(jumping.collections) == 4
    summary = made.tables["summary"]
    part = summary.filter(pl.col("mass_ratio") == 0.2)
    damping = np.log(20.0) / part["settling_time_5"].to_numpy()
    every = [one for one in jumping.lines if one.get_label() == "_every point"]
    assert np.asarray(every[-1].get_ydata()) == pytest.approx(damping, rel=1e-12)
    _, middle = line(jumping, "μ = 0.2")
    assert middle.tolist() == bands.over_neighbours(damping, (0.5,))[0].tolist()
    assert np.abs(np.diff(middle)).sum() < 0.4 * np.abs(np.diff(damping)).sum()
