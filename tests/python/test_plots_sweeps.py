"""Pictures of sweeps: curves, maps, rasters, responses."""

from __future__ import annotations

import math
from typing import Any

import matplotlib as mpl
import numpy as np
import polars as pl
import pytest
from matplotlib.collections import LineCollection, QuadMesh
from matplotlib.colors import same_color

import iva
from axes_seen import DRIVEN, STRUCTURE, drawn, labels, line
from iva import plots, theory
from iva.plots import styles

mpl.use("Agg")

pytestmark = pytest.mark.usefixtures("pictures_are_closed")


def test_curves_with_gaps(table: iva.Table) -> None:
    axes = plots.curves(table, "damping_ratio_3")
    assert [one.get_label() for one in axes.lines] == ["0.05", "0.1"]
    for value in (0.05, 0.1):
        rows = table.summary.filter(pl.col("mass_ratio") == value).sort("relative_clearance")
        x, y = line(axes, f"{value:g}")
        assert x.tolist() == rows["relative_clearance"].to_list()
        assert y.tolist() == rows["damping_ratio_3"].to_list()
    assert axes.get_xlabel() == "relative clearance γ = d/x₀"
    assert axes.get_ylabel() == "damping ratio, 3 cycles, ζ₃"
    legend = axes.get_legend()
    assert legend is not None
    assert legend.get_title().get_text() == "μ"
    axes = plots.curves(table, "impacts", x="mass_ratio")
    assert [one.get_label() for one in axes.lines] == ["0.4", "0.6", "0.8"]
    assert axes.get_ylabel() == "number of impacts"


def with_values(table: iva.Table, **columns: list[float | None]) -> iva.Table:
    """Return a table with other columns in its summary."""
    summary = table.summary.with_columns(
        pl.Series(name, values, dtype=pl.Float64) for name, values in columns.items()
    )
    return iva.Table(table.swept, table.units, iva.frames.Frames({"summary": lambda: summary}))


def test_nulls_are_gaps_and_lone_points_dots(table: iva.Table) -> None:
    settling = [None, 10.0, 20.0, None, None, 30.0]
    axes = plots.curves(with_values(table, settling_time_5=settling), "settling_time_5")
    first, second = line(axes, "0.05")[1], line(axes, "0.1")[1]
    assert np.isnan(first).tolist() == [True, False, True]
    assert np.isnan(second).tolist() == [False, True, False]
    dots = [one for one in axes.lines if one.get_marker() == "."]
    assert [np.asarray(one.get_ydata()).tolist() for one in dots] == [[20.0], [10.0, 30.0]]
    assert labels(axes) == ["0.05", "0.1"]
    assert axes.get_ylabel() == "5 % settling time ωₙt₅"


def test_many_curves_have_a_colour_bar() -> None:
    table = iva.sweep(
        iva.Siva(restitution=0.5),
        STRUCTURE,
        over={"gap_mm": [4.0, 6.0], "absorber.mass": np.linspace(0.1, 0.3, 9)},
        start=iva.Start(displacement_mm=4.0),
        duration=1.0,
    )
    axes = plots.curves(table, "residual_amplitude")
    assert len(axes.lines) == 9
    assert len({str(one.get_color()) for one in axes.lines}) == 9
    figure = axes.get_figure()
    assert figure is not None
    assert figure.axes[1].get_ylabel() == "absorber mass m (kg)"
    assert axes.get_xlabel() == "total play 2d (mm)"
    assert axes.get_legend() is None


def test_heatmap_and_its_ridge(table: iva.Table) -> None:
    values: list[float | None] = [3.0, 1.0, None, 5.0, None, None]
    some = with_values(table, settling_time_5=values)
    for best, label, expected in (
        (None, "smallest at each γ", [0.1, 0.1, math.nan]),
        ("max", "largest at each γ", [0.05, 0.1, math.nan]),
    ):
        axes = plots.heatmap(some, "settling_time_5", best=best)  # type: ignore[arg-type]
        (mesh,) = [one for one in axes.collections if isinstance(one, QuadMesh)]
        drawn: Any = mesh.get_array()
        assert drawn.shape == (2, 3)
        assert drawn.mask.tolist() == [[False, True, True], [False, False, True]]
        assert drawn.compressed().tolist() == [3.0, 1.0, 5.0]
        x, y = line(axes, label)
        assert x.tolist() == [0.4, 0.6, 0.8]
        assert y.tolist() == pytest.approx(expected, nan_ok=True)
        assert axes.patch.get_hatch() == "/////"
        assert labels(axes) == ["no value (null)", label]
        figure = axes.get_figure()
        assert figure is not None
        assert figure.axes[1].get_ylabel() == "5 % settling time ωₙt₅"
    axes = plots.heatmap(table, "damping_ratio_3", x="mass_ratio")
    x, y = line(axes, "largest at each μ")
    for mass_ratio, clearance in zip(x, y, strict=True):
        column = table.summary.filter(pl.col("mass_ratio") == mass_ratio)
        best_row = column.sort("damping_ratio_3", descending=True).row(0, named=True)
        assert clearance == best_row["relative_clearance"]
    assert axes.get_ylabel() == "relative clearance γ = d/x₀"
    assert axes.patch.get_hatch() is None
    assert not plots.heatmap(table, "impacts").lines
    assert not plots.heatmap(table, "damping_ratio_3", best="none").lines


def test_raster_marks_every_impact(table: iva.Table, run: iva.Run) -> None:
    axes = plots.raster(table, by="relative_clearance")
    heights = {row["point"]: row["relative_clearance"] for row in table.summary.to_dicts()}
    for wall, label in ((1, "impacts, wall +"), (-1, "impacts, wall −")):
        (marks,) = [one for one in axes.collections if one.get_label() == label]
        assert isinstance(marks, LineCollection)
        segments = np.array(marks.get_segments())
        side = table.impacts.filter(pl.col("wall") == wall)
        assert segments[:, 0, 0].tolist() == side["time"].to_list()
        middles = segments[:, :, 1].mean(axis=1)
        assert middles == pytest.approx([heights[point] for point in side["point"]])
        colours: Any = marks.get_color()
        assert same_color(colours[0], styles.WALLS[wall])
    assert axes.get_ylabel() == "relative clearance γ = d/x₀"
    assert plots.raster(table).get_ylabel() == "point"
    single = plots.raster(run)
    assert sum(len(one.get_paths()) for one in single.collections) == run.impacts.height
    early = plots.raster(run, until=5.0)
    few = run.impacts.filter(pl.col("time") <= 5.0).height
    assert sum(len(one.get_paths()) for one in early.collections) == few


def test_forced_response_and_theory(response: iva.Table) -> None:
    axes = plots.forced_response(response, theory=DRIVEN)
    x, y = line(axes, "computed")
    assert x.tolist() == response.summary["force.relative_frequency"].to_list()
    assert y.tolist() == response.summary["amplitude_max"].to_list()
    fine, alone = line(axes, "without absorber")
    stable = {label: line(axes, label)[1] for label in drawn(axes, "stable")}
    unstable = {label: line(axes, label)[1] for label in drawn(axes, "unstable")}
    for index in range(0, len(fine), 7):
        force = iva.Harmonic(amplitude=0.1, relative_frequency=fine[index])
        found = theory.masri_caughey(DRIVEN[0], DRIVEN[1], force)
        assert alone[index] == found.amplitude_without_absorber
        for lines, wanted in ((stable, True), (unstable, False)):
            shown = {float(ys[index]) for ys in lines.values() if not np.isnan(ys[index])}
            assert shown == {
                orbit.amplitude
                for orbit in found.orbits
                if orbit and orbit.admissible and orbit.stable is wanted
            }
    at = int(np.flatnonzero(np.isclose(x, 1.0))[0])
    theirs = next(iter(stable.values()))[int(np.flatnonzero(fine == x[at])[0])]
    assert y[at] == pytest.approx(theirs, rel=1e-3)
    assert set(labels(axes)) == {
        "without absorber",
        "computed",
        "theory, stable",
        "theory, unstable",
    }
    assert axes.get_xlabel() == "force frequency Ω/ωₙ"
    assert axes.get_ylabel() == "amplitude max |x| (unit of length)"
    assert axes.get_yscale() == "log"


def test_forced_response_without_theory(response: iva.Table) -> None:
    axes = plots.forced_response(response)
    _, alone = line(axes, "without absorber")
    ratio = response.summary["force.relative_frequency"].to_numpy()
    bare = 0.1 / np.hypot(1.0 - ratio**2, 2.0 * 0.02 * ratio)
    assert alone == pytest.approx(bare, rel=1e-9)
    axes = plots.forced_response(response, value="reduction", theory=DRIVEN)
    stable = line(axes, "theory, stable")[1]
    assert np.nanmax(stable) == pytest.approx(response.summary["reduction"].max(), abs=0.02)
    assert axes.get_ylabel() == "reduction of the amplitude"
    assert plots.forced_response(response, value="impacts_per_cycle").get_yscale() == "linear"


def test_theory_without_damping_has_a_hole_at_resonance() -> None:
    scene = (DRIVEN[0], iva.Primary(), DRIVEN[2])
    table = iva.sweep(
        scene[0],
        scene[1],
        force=scene[2],
        over={"force.frequency": [0.95, 1.0, 1.05]},
        start=iva.Start(),
        cycles=50,
        discard=20,
    )
    axes = plots.forced_response(table, theory=scene)
    fine, alone = line(axes, "without absorber")
    assert fine[np.isnan(alone)].tolist() == [1.0]
    assert axes.get_xlabel() == "force frequency Ω/ωₙ"


def test_forced_response_in_si_units_by_start() -> None:
    scene = (iva.Siva(mass=0.3, restitution=0.6, gap_mm=4.0), STRUCTURE, iva.Harmonic(force=2.0))
    table = iva.sweep(
        scene[0],
        scene[1],
        force=scene[2],
        over={"force.frequency_hz": [9.9, 10.0, 10.1], "displacement_mm": [0.0, 10.0]},
        start=iva.Start(),
        cycles=100,
        discard=80,
    )
    axes = plots.forced_response(table, theory=scene)
    assert axes.get_xlabel() == "force frequency Ω/2π (Hz)"
    assert axes.get_ylabel() == "amplitude max |x| (mm)", "starts are swept in mm"
    assert {"x₀ = 0 mm", "x₀ = 10 mm"} <= set(labels(axes))
