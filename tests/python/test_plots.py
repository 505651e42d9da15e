"""What pictures show: the numbers of runs and sweeps, with their symbols and units."""

from __future__ import annotations

import base64
import doctest
import importlib
import itertools
import math
import pkgutil
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import polars as pl
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection, QuadMesh
from matplotlib.colors import same_color, to_rgb
from matplotlib.lines import Line2D
from numpy.typing import NDArray
from PIL import Image

import iva
from iva import design, plots, theory
from iva.plots import energy_split, styles

mpl.use("Agg")
import matplotlib.pyplot as plt

Numbers = NDArray[np.float64]

STRUCTURE = iva.Primary(mass=3.0, stiffness=12_000.0, damping=2.0)
MAST = iva.Primary(mass=200.0, stiffness=16_000.0, damping=30.0)
DRIVEN = (
    iva.Siva(mass_ratio=0.05, restitution=0.8, clearance=2.0),
    iva.Primary(damping_ratio=0.02),
    iva.Harmonic(amplitude=0.1),
)


@pytest.fixture(autouse=True)
def _close() -> Iterator[None]:
    before = dict(mpl.rcParams)
    yield
    plt.close("all")
    assert dict(mpl.rcParams) == before, "settings of everybody else"


@pytest.fixture
def metric() -> iva.Run:
    """Return a decay in SI units."""
    return iva.simulate(
        iva.Siva(mass=0.3, restitution=0.6, gap_mm=6.0),
        STRUCTURE,
        start=iva.Start(displacement_mm=4.0),
        duration=1.0,
    )


@pytest.fixture
def pendulum() -> iva.Run:
    """Return a decay with a pendulum."""
    return iva.simulate(
        iva.Piva(mass=20.0, length=0.75, restitution=0.5, gap_mm=140.0),
        MAST,
        start=iva.Start(displacement_mm=50.0),
        duration=5.0,
    )


@pytest.fixture
def chattering() -> iva.Run:
    """Return a decay with chatter and stick."""
    return decaying(iva.Siva(mass_ratio=0.15, relative_clearance=0.1, restitution=0.5))


def decaying(absorber: iva.Siva | iva.Piva, **more: Any) -> iva.Run:
    """Return a decay without dimensions."""
    start = more.pop("start", iva.Start(displacement=1.0))
    return iva.simulate(absorber, iva.Primary(damping_ratio=0.01), start=start, periods=6, **more)


def line(axes: Axes, label: str) -> tuple[Numbers, Numbers]:
    """Return the points of the line with a label."""
    (found,) = [one for one in axes.lines if one.get_label() == label]
    return np.asarray(found.get_xdata()), np.asarray(found.get_ydata())


def labels(axes: Axes) -> list[str]:
    """Return the entries of the legend."""
    legend = axes.get_legend()
    return [] if legend is None else [text.get_text() for text in legend.get_texts()]


@pytest.mark.parametrize(
    "module", [module.name for module in pkgutil.iter_modules(plots.__path__, "iva.plots.")]
)
def test_examples(module: str) -> None:
    found = doctest.testmod(importlib.import_module(module), extraglobs={"iva": iva})
    assert found.failed == 0


def test_without_matplotlib() -> None:
    program = (
        "import sys; sys.modules['matplotlib'] = None\n"
        "from iva import *\n"
        "import iva\n"
        "try: iva.plots\n"
        "except ImportError as error: print(error)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout == "iva.plots needs matplotlib: pip install 'iva-dynamics[plots]'\n"
    assert "plots" in dir(iva)


def test_importing_chooses_no_backend() -> None:
    program = "import sys, iva; iva.plots; print('matplotlib.pyplot' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout == "False\n"


def test_decay_shows_states_peaks_and_impacts(run: iva.Run) -> None:
    bare = decaying(iva.Siva(mass_ratio=0.15, clearance=50.0, restitution=0.5))
    axes = plots.decay(run, bare=bare)
    motion = run.trajectory()
    time, x = line(axes, "with absorber")
    assert time.tolist() == motion["time"].to_list()
    assert x.tolist() == motion["displacement"].to_list()
    assert line(axes, "without absorber")[1].tolist() == bare.trajectory()["displacement"].to_list()
    assert line(axes, "envelope")[1].tolist() == run.envelope["amplitude"].to_list()
    assert line(axes, "_lower envelope")[1].tolist() == (-run.envelope["amplitude"]).to_list()
    for wall, label, edge in ((1, "impacts, wall +", 1.0), (-1, "impacts, wall −", 0.0)):
        ticks, heights = line(axes, label)
        side = run.impacts.filter(pl.col("wall") == wall)
        assert ticks.tolist() == side["time"].to_list()
        assert set(heights.tolist()) == {edge}
    assert axes.get_xlabel() == "time ωₙt"
    assert axes.get_ylabel() == "displacement x/A₀"
    figure = axes.get_figure(root=True)
    assert figure is not None
    assert figure.get_size_inches()[0] == 3.35


def test_decay_is_relative_to_the_reference_amplitude(metric: iva.Run) -> None:
    motion = metric.trajectory()
    axes = plots.decay(metric, label="gap 6 mm")
    assert line(axes, "gap 6 mm")[1] == pytest.approx(motion["displacement"] / 0.004, rel=1e-15)
    time = metric.summary["settling_time_10"].item()
    assert line(axes, "_settled to 10 %")[0].tolist() == [time]
    assert abs(line(axes, "_settled to 10 %")[1].item()) == pytest.approx(0.1, abs=1e-9)
    levels = sorted(
        float(np.asarray(one.get_ydata())[0]) for one in axes.lines if one.get_linestyle() == ":"
    )
    assert levels == pytest.approx([-0.1, -0.05, -0.02, 0.02, 0.05, 0.1])
    assert "±10, 5, 2 %" in [text.get_text() for text in axes.texts]
    axes = plots.decay(metric, relative=False, settle=(), impacts=False, envelope=False)
    assert line(axes, "structure")[1].tolist() == motion["displacement"].to_list()
    assert len(axes.lines) == 1
    assert axes.get_xlabel() == "time t (s)"
    assert axes.get_ylabel() == "displacement x (m)"


def test_a_start_without_displacement_relates_to_the_first_peak() -> None:
    run = decaying(
        iva.Siva(mass_ratio=0.15, clearance=0.6, restitution=0.5), start=iva.Start(velocity=2.0)
    )
    first = run.envelope["amplitude"][0]
    drawn = line(plots.decay(run), "structure")[1]
    assert drawn == pytest.approx(run.trajectory()["displacement"] / first, rel=1e-15)


def test_until_cuts(run: iva.Run) -> None:
    axes = plots.decay(run, until=10.0)
    assert line(axes, "structure")[0].max() <= 10.0
    ticks = sum(len(line(axes, f"impacts, wall {side}")[0]) for side in "+−")
    assert ticks == run.impacts.filter(pl.col("time") <= 10.0).height > 0
    assert axes.get_xlim() == (0.0, 10.0)


@pytest.mark.parametrize("scene", ["run", "metric", "pendulum"])
def test_velocities_jump(scene: str, request: pytest.FixtureRequest) -> None:
    run: iva.Run = request.getfixturevalue(scene)
    axes = plots.velocities(run)
    for label, name in (("structure ẋ", "velocity"), ("absorber ẋ₁", "absorber_velocity")):
        time, velocity = line(axes, label)
        for row in run.impacts.iter_rows(named=True):
            at = np.flatnonzero(time == row["time"])
            assert velocity[at[0]] == pytest.approx(row[f"{name}_before"], abs=1e-12)
            assert velocity[at[1]] == pytest.approx(row[f"{name}_after"], abs=1e-12)
    unit = "(unit of x₀ · ωₙ)" if scene == "run" else "(m/s)"
    assert axes.get_ylabel() == f"velocity ẋ, ẋ₁ {unit}"


@pytest.mark.parametrize("scene", ["run", "metric", "pendulum"])
@pytest.mark.parametrize("relative", [False, True])
def test_phase_plane(scene: str, relative: bool, request: pytest.FixtureRequest) -> None:
    run: iva.Run = request.getfixturevalue(scene)
    axes = plots.phase(run, relative=relative)
    (jumps,) = [one for one in axes.collections if isinstance(one, LineCollection)]
    segments = np.array(jumps.get_segments())
    assert segments.shape == (run.impacts.height, 2, 2)
    assert (segments[:, 0, 0] == segments[:, 1, 0]).all(), "vertical"
    x, y = line(axes, "flight")
    assert np.isnan(x).sum() == run.impacts.height, "lifted at impacts"
    motion = run.trajectory()
    if relative:
        assert segments[:, 0, 1].tolist() == run.impacts["approach_velocity"].to_list()
        assert y[~np.isnan(y)].tolist() == motion["gap_velocity"].to_list()
        clearance = {"run": 0.6, "metric": 0.003, "pendulum": 0.07}[scene]
        assert line(axes, "walls")[0].tolist() == pytest.approx([clearance] * 2)
        assert np.abs(segments[:, 0, 0]) == pytest.approx(clearance, rel=1e-9)
        assert axes.get_ylabel().startswith("gap velocity w (")
    else:
        assert segments[:, 0, 1].tolist() == run.impacts["velocity_before"].to_list()
        assert segments[:, 1, 1].tolist() == run.impacts["velocity_after"].to_list()
        assert x[~np.isnan(x)].tolist() == motion["displacement"].to_list()
    unit = "unit of x₀" if scene == "run" else "m"
    words = "gap displacement y" if relative else "displacement x"
    assert axes.get_xlabel() == f"{words} ({unit})"


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


SMALL = {"mass_ratio": 0.1, "restitution": 0.5, "frequency_ratio": 0.4, "angles": "small"}
DECAYS: dict[str, Callable[[], iva.Run]] = {
    "free mass": lambda: decaying(
        iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5)
    ),
    "chatter": lambda: decaying(iva.Siva(mass_ratio=0.15, relative_clearance=0.1, restitution=0.5)),
    "unlisted rebounds": lambda: decaying(
        iva.Siva(mass_ratio=0.15, relative_clearance=0.1, restitution=0.5), chatter_floor=0.05
    ),
    "plastic": lambda: decaying(iva.Siva(mass_ratio=0.15, clearance=0.5, restitution=0.0)),
    "cut short": lambda: decaying(
        iva.Siva(mass_ratio=0.15, clearance=0.6, restitution=0.5), max_impacts=5
    ),
    "pendulum": lambda: decaying(
        iva.Piva(
            mass_ratio=0.1,
            restitution=0.5,
            clearance=1.2,
            frequency_ratio=0.4,
            length=2.0,
            inertia_ratio=1.3,
            contact_distance=1.5,
            pivot_damping_ratio=0.1,
        )
    ),
    "over the top": lambda: decaying(
        iva.Piva(mass_ratio=0.1, restitution=0.5, clearance=3.0, frequency_ratio=0.4, length=2.0),
        start=iva.Start(displacement=1.0, angular_velocity=1.0),
    ),
    "no length": lambda: decaying(iva.Piva(clearance=0.2, **SMALL)),  # type: ignore[arg-type]
    "small angles": lambda: decaying(
        iva.Piva(
            clearance=0.2,
            length=3.0,
            contact_distance=2.0,
            inertia_ratio=1.2,
            **SMALL,  # type: ignore[arg-type]
        )
    ),
    "length from gravity": lambda: decaying(
        iva.Piva(mass_ratio=0.1, restitution=0.5, clearance=0.2, frequency_ratio=0.4, gravity=1.5)
    ),
    "seconds": lambda: iva.simulate(
        iva.Siva(mass_ratio=0.3, restitution=0.6, gap=1.0),
        iva.Primary(frequency_hz=3.0, damping_ratio=0.02),
        start=iva.Start(displacement=2.0, velocity=1.0),
        duration=2.0,
    ),
    "metric pendulum": lambda: iva.simulate(
        iva.Piva(mass=20.0, length=0.75, restitution=0.5, gap_mm=140.0),
        MAST,
        start=iva.Start(displacement_mm=50.0),
        duration=5.0,
    ),
    "metric": lambda: iva.simulate(
        iva.Siva(mass=0.3, restitution=0.6, clearance_mm=3.0),
        iva.Primary(mass=3.0, natural_frequency=60.0, damping=2.0),
        start=iva.Start(displacement_mm=4.0),
        duration=1.0,
    ),
    "overdamped": lambda: iva.simulate(
        iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=0.2),
        iva.Primary(damping_ratio=30.0),
        start=iva.Start(displacement=1.0),
        periods=2,
    ),
}


@pytest.mark.parametrize("scene", DECAYS)
def test_energy_is_somewhere_at_every_instant(scene: str) -> None:
    run = DECAYS[scene]()
    axes = plots.energy(run)
    assert axes.get_ylabel() == "energy E/E(0)"
    layers = [one for one in axes.collections if isinstance(one, PolyCollection)]
    top = layers[-1].get_paths()[0].vertices
    assert np.asarray(top)[:, 1].max() == pytest.approx(1.0, abs=1e-8)
    split = energy_split.split_of(run)
    row = run.summary.row(0, named=True)
    whole = row["energy_initial"]
    assert split.total / whole == pytest.approx(1.0, abs=1e-8)
    held = split.layers["structure"] + split.layers["absorber"]
    assert held[0] / whole == pytest.approx(1.0, abs=1e-14)
    assert held[-1] / whole == pytest.approx(row["energy_final"] / whole, abs=1e-13)
    for name, column in (
        ("damper", "energy_viscous"),
        ("impacts", "energy_impacts"),
        ("pivot", "energy_pivot"),
    ):
        last = split.layers[name][-1] if name in split.layers else 0.0
        assert last / whole == pytest.approx(row[column] / whole, abs=1e-8), name
        if name in split.layers:
            assert np.diff(split.layers[name]).min() > -1e-9 * whole, "a loss only grows"
    assert ("pivot" in split.layers) == (scene == "pendulum")


def test_energy_lost_in_impacts_is_that_of_the_table(run: iva.Run) -> None:
    split = energy_split.split_of(run)
    for row in run.impacts.iter_rows(named=True):
        before, after = np.flatnonzero(split.time == row["time"])[:2]
        step = split.layers["impacts"][after] - split.layers["impacts"][before]
        assert step == pytest.approx(row["energy_loss"], abs=1e-15)


FORCED: dict[str, Any] = {
    "harmonic": iva.Harmonic(force=2.0, relative_frequency=1.0),
    "base": iva.Harmonic(base_acceleration=2.0, relative_frequency=1.0),
    "record": iva.Recorded([0.0, 0.1, 0.2, 0.5], [0.0, 3.0, -3.0, 0.0]),
    "impulses": [iva.Impulse(impulse=0.5), iva.Impulse(impulse=0.4, time=0.1234)],
}


@pytest.mark.parametrize("force", FORCED)
@pytest.mark.parametrize("kind", ["mass", "pendulum"])
def test_energy_under_force_is_what_was_put_in(force: str, kind: str) -> None:
    absorber = (
        iva.Siva(mass=0.3, restitution=0.6, gap_mm=4.0)
        if kind == "mass"
        else iva.Piva(mass=0.3, length=0.1, restitution=0.6, gap_mm=4.0)
    )
    run = iva.simulate(
        absorber,
        STRUCTURE,
        start=iva.Start(displacement_mm=1.0),
        force=FORCED[force],
        duration=2.0,
    )
    split = energy_split.split_of(run)
    row = run.summary.row(0, named=True)
    put_in = row["energy_initial"] + row["energy_work"]
    assert split.total[-1] == pytest.approx(put_in, rel=1e-8)
    assert plots.energy(run).get_ylabel() == "energy E (J)"
    if force == "impulses":
        kicked = split.time >= 0.1234
        assert np.ptp(split.total[~kicked]) < 1e-8 * put_in
        assert np.ptp(split.total[kicked]) < 1e-8 * put_in


def test_impacts_that_add_energy_are_no_loss() -> None:
    run = decaying(
        iva.Piva(
            mass_ratio=2.0,
            restitution=1.0,
            clearance=0.4,
            frequency_ratio=0.4,
            length=10.0,
            impact_law="printed",
        ),
        max_impacts=10,
    )
    assert run.summary["energy_impacts"].item() < 0.0
    with pytest.raises(ValueError, match="impacts add energy in this run"):
        plots.energy(run)


@pytest.fixture(scope="module")
def response() -> iva.Table:
    """Return a sweep over the frequency of a force."""
    return iva.sweep(
        DRIVEN[0],
        DRIVEN[1],
        force=DRIVEN[2],
        over={"force.relative_frequency": np.linspace(0.95, 1.05, 11)},
        start=iva.Start(),
        cycles=300,
        discard=250,
    )


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
    assert axes.get_ylabel() == "amplitude max |x| (unit of x₀)"
    assert axes.get_yscale() == "log"


def drawn(axes: Axes, kind: str) -> list[str]:
    """Return the labels of the curves of a theory."""
    names = (str(one.get_label()) for one in axes.lines)
    return [name for name in names if re.fullmatch(rf"theory, {kind}|_{kind} \d", name)]


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
    assert axes.get_ylabel() == "amplitude max |x| (m)"
    assert {"x₀ = 0 mm", "x₀ = 10 mm"} <= set(labels(axes))


def test_brightness_of_walls(chattering: iva.Run) -> None:
    from iva.plots.moving_pictures import FLASH, brightness

    hits = pl.DataFrame({"time": [1.0, 5.0], "wall": [1, -1]})
    instants = np.linspace(0.0, 10.0, 21)
    light = brightness(instants, np.where(instants > 9.0, 1.0, 0.0), hits, 1)
    assert (light[instants < 1.0] == 0.0).all()
    assert light[2] == 1.0
    assert (np.diff(light[2 : 2 + FLASH]) < 0.0).all()
    assert (light[2 + FLASH : 19] == 0.0).all()
    assert (light[19:] == 0.5).all()
    assert chattering.episodes.height > 0


def png_frames(html: str) -> list[bytes]:
    """Return the pictures inside a page."""
    found = re.findall(r'"data:image/png;base64,([^"]*)"', html)
    return [base64.b64decode(text.replace("\\\n", "")) for text in found]


def test_animations(tmp_path: Path, run: iva.Run, pendulum: iva.Run) -> None:
    for name, one in (("mass", run), ("pendulum", pendulum)):
        file = plots.animate(one, tmp_path / f"{name}.gif", until=5.0, frames=7, fps=10)
        with Image.open(file) as picture:
            assert picture.n_frames == 7  # type: ignore[attr-defined]
            assert picture.info["duration"] == 100
    page = plots.animate(run, str(tmp_path / "mass.html"), frames=5).read_text(encoding="utf-8")
    assert len(png_frames(page)) == 5
    assert all(frame.startswith(b"\x89PNG") for frame in png_frames(page))
    assert page.startswith("<!DOCTYPE html>")
    assert "http" not in page
    assert "<link" not in page
    assert 'class="fa' not in page
    assert not plt.get_fignums(), "nothing is left open"


@pytest.mark.parametrize(
    "scene", ["free mass", "pendulum", "over the top", "no length", "cut short"]
)
def test_scenes_are_to_scale(scene: str) -> None:
    run = DECAYS[scene]()
    moving = plots.animation(run, frames=9)
    above, below = plt.gcf().axes
    moving._draw_was_started = True  # type: ignore[attr-defined]
    end = run.trajectory()["time"][-1]
    instants = np.linspace(0.0, end, 9)
    states = run.at(instants)
    from matplotlib.patches import Circle

    def mass() -> Numbers:
        circles = [one for one in above.patches if isinstance(one, Circle)]
        return np.array(circles[-1].center)

    for index in (0, 3, 7):
        moving._func(index)  # type: ignore[attr-defined]
        x, y = states["displacement"][index], states["gap_displacement"][index]
        found = design.design_of(run)
        if found.pendulum is None or found.pendulum.small:
            assert mass()[0] == pytest.approx(x + found.lever * y, abs=1e-12)
        else:
            length, angle = found.pendulum.length, states["angle"][index]
            assert length is not None
            place = [x + length * math.sin(angle), -length * math.cos(angle)]
            assert mass() == pytest.approx(place, abs=1e-12)
        now = next(one for one in below.lines if one.get_marker() == "o")
        assert np.asarray(now.get_ydata()).tolist() == [x]
    assert above.get_aspect() == 1.0
    assert below.get_ylabel() == "x (unit of x₀)"
    limits = above.get_xlim()
    assert limits[0] < mass()[0] < limits[1]


def test_axes_of_the_user_are_drawn_on(run: iva.Run, table: iva.Table) -> None:
    _, axes = plt.subplots(3, 2)
    flat = axes.ravel()
    assert plots.decay(run, ax=flat[0]) is flat[0]
    assert plots.velocities(run, ax=flat[1]) is flat[1]
    assert plots.phase(run, ax=flat[2]) is flat[2]
    assert plots.energy(run, ax=flat[3]) is flat[3]
    assert plots.curves(table, "impacts", ax=flat[4]) is flat[4]
    assert plots.heatmap(table, "impacts", ax=flat[5]) is flat[5]
    assert len(plt.get_fignums()) == 1


def test_style_leaves_no_trace() -> None:
    before = mpl.rcParams["font.size"]
    with plots.style():
        assert mpl.rcParams["font.size"] == 8
        assert mpl.rcParams["figure.figsize"][0] == 3.35
    assert mpl.rcParams["font.size"] == before


# G. M. Machado et al., IEEE Trans. Vis. Comput. Graph. 15 (2009) 1291: without one sort of cones.
SEEN = {
    "all": np.eye(3),
    "no red": [[0.152, 1.053, -0.205], [0.115, 0.786, 0.099], [-0.004, -0.048, 1.052]],
    "no green": [[0.367, 0.861, -0.228], [0.280, 0.673, 0.047], [-0.012, 0.043, 0.969]],
    "no blue": [[1.256, -0.077, -0.179], [-0.078, 0.931, 0.148], [0.005, 0.691, 0.304]],
}


def lab(colour: str, seen: Any) -> Numbers:
    """Return a colour as somebody sees it, in CIELAB."""
    srgb = np.array(to_rgb(colour))
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    linear = np.clip(np.asarray(seen) @ linear, 0.0, 1.0)
    xyz = (
        np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
        @ linear
        / np.array([0.9505, 1.0, 1.089])
    )
    root = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16.0 / 116.0)
    return np.array(
        [116.0 * root[1] - 16.0, 500.0 * (root[0] - root[1]), 200.0 * (root[1] - root[2])]
    )


@pytest.mark.parametrize("eye", SEEN)
@pytest.mark.parametrize(
    "colours",
    [styles.CURVES, tuple(styles.WALLS.values()), tuple(energy_split.COLOURS.values())],
    ids=["curves", "walls", "energies"],
)
def test_everybody_can_tell_colours_apart(eye: str, colours: tuple[str, ...]) -> None:
    for one, other in itertools.combinations(colours, 2):
        assert np.linalg.norm(lab(one, SEEN[eye]) - lab(other, SEEN[eye])) > 11.0, (one, other)


def wrong(call: Callable[[], object], error: type[Exception], sentence: str) -> None:
    """Check that a call is refused, and that it leaves no figure behind."""
    with pytest.raises(error, match=re.escape(sentence)):
        call()
    assert not plt.get_fignums()


def test_runs_that_cannot_be_drawn(run: iva.Run, metric: iva.Run, table: iva.Table) -> None:
    anything: Any = table
    for draw in (plots.decay, plots.velocities, plots.phase, plots.energy, plots.animation):
        wrong(lambda draw=draw: draw(anything), TypeError, "run = Table over")  # type: ignore[misc]
    wrong(lambda: plots.decay(run, until=0.0), ValueError, "until = 0.0: give a time greater")
    wrong(lambda: plots.decay(run, until="all"), TypeError, "until = 'all': give a number")  # type: ignore[arg-type]
    wrong(lambda: plots.decay(run, settle=(10, 0)), ValueError, "settle has 0.0 in it")
    wrong(lambda: plots.decay(run, bare=metric), ValueError, "bare is in other units")
    wrong(lambda: plots.decay(run, relative=1), TypeError, "relative = 1: give True or False")  # type: ignore[arg-type]
    wrong(lambda: plots.decay(run, ax=3), TypeError, "ax = 3: give the axes")  # type: ignore[arg-type]
    wrong(lambda: plots.phase(run, relative="y"), TypeError, "relative = 'y'")  # type: ignore[arg-type]
    few = decaying(iva.Siva(mass_ratio=0.1, clearance=0.6, restitution=0.5), tables=["envelope"])
    wrong(lambda: plots.decay(few), ValueError, "no table 'impacts': ask for it with tables=")
    plots.decay(few, impacts=False)
    plt.close("all")
    still = decaying(iva.Siva(mass_ratio=0.1, clearance=0.6, restitution=0.5), start=iva.Start())
    wrong(lambda: plots.decay(still), ValueError, "nothing moves in this run")
    wrong(lambda: plots.energy(still), ValueError, "nothing moves in this run")
    driven = iva.simulate(
        DRIVEN[0],
        DRIVEN[1],
        start=iva.Start(),
        force=iva.Harmonic(amplitude=0.1, frequency=1.0),
        cycles=3,
    )
    wrong(lambda: plots.decay(driven), ValueError, "nothing decays under a lasting force")
    assert not [one for one in plots.decay(driven, relative=False).texts if "%" in one.get_text()]


def test_tables_that_cannot_be_drawn(run: iva.Run, table: iva.Table) -> None:
    not_one: Any = run
    wrong(lambda: plots.curves(not_one, "impacts"), TypeError, "table = Run: finished")
    wrong(lambda: plots.heatmap(not_one, "impacts"), TypeError, "table = Run: finished")
    wrong(lambda: plots.curves(table, "dampin"), ValueError, "y = 'dampin': no such column, only")
    wrong(lambda: plots.curves(table, "outcome"), ValueError, "y = 'outcome': it holds String")
    wrong(lambda: plots.curves(table, "digits"), ValueError, "y = 'digits': it is null at every")
    wrong(lambda: plots.curves(table, 3), TypeError, "y = 3: give the name of a column")  # type: ignore[arg-type]
    wrong(lambda: plots.heatmap(table, "impacts", best="most"), ValueError, "best = 'most': give")  # type: ignore[arg-type]
    wrong(
        lambda: plots.heatmap(table, "impacts", y="wide"), ValueError, "y = 'wide': no such column"
    )
    bare = iva.sweep(
        iva.Siva(mass_ratio=0.1, relative_clearance=0.5),
        iva.Primary(),
        over={"restitution": [0.4, 0.5]},
        start=iva.Start(displacement=1.0),
        periods=3,
    )
    wrong(lambda: plots.heatmap(bare, "impacts"), ValueError, "y = None: the table is swept over")
    wrong(lambda: plots.raster(bare), ValueError, "no table 'impacts', only summary: ask for it")
    wrong(lambda: plots.raster(3), TypeError, "table = 3: give an iva.Table or an iva.Run")  # type: ignore[arg-type]
    cube = iva.sweep(
        iva.Siva(),
        iva.Primary(),
        over={
            "restitution": [0.4, 0.5],
            "mass_ratio": [0.1, 0.2],
            "relative_clearance": [0.4, 0.5],
        },
        start=iva.Start(displacement=1.0),
        periods=3,
    )
    for draw in (plots.curves, plots.heatmap):
        wrong(
            lambda draw=draw: draw(cube, "impacts"),  # type: ignore[misc]
            ValueError,
            "8 points have 4 different values of restitution and mass_ratio",
        )
    zipped = iva.sweep(
        iva.Siva(restitution=0.5),
        iva.Primary(),
        over={"mass_ratio": [0.1, 0.2], "relative_clearance": [0.4, 0.5]},
        sampling="zip",
        start=iva.Start(displacement=1.0),
        periods=3,
    )
    wrong(lambda: plots.heatmap(zipped, "impacts"), ValueError, "2 points are no grid of 2 values")


def test_theories_that_cannot_be_drawn(response: iva.Table, table: iva.Table) -> None:
    wrong(lambda: plots.forced_response(table), ValueError, "sweep a frequency of the force")
    wrong(
        lambda: plots.forced_response(response, theory=DRIVEN[:2]),  # type: ignore[arg-type]
        TypeError,
        "give (absorber, primary, force)",
    )
    wrong(
        lambda: plots.forced_response(response, theory=(DRIVEN[0], STRUCTURE, DRIVEN[2])),
        ValueError,
        "theory is in other units",
    )
    loose = iva.Siva(mass_ratio=0.05, restitution=0.8, relative_clearance=1.0)
    wrong(
        lambda: plots.forced_response(response, theory=(loose, DRIVEN[1], DRIVEN[2])),
        ValueError,
        "relative_clearance",
    )
    wrong(
        lambda: plots.forced_response(response, value="amplitude_rms", theory=DRIVEN),
        ValueError,
        "value = 'amplitude_rms': the theory has",
    )


def test_animations_that_cannot_be_made(run: iva.Run, tmp_path: Path) -> None:
    path = tmp_path / "decay.mp4"
    wrong(lambda: plots.animate(run, path), ValueError, "give a name that ends in .gif or .html")
    wrong(lambda: plots.animate(run, b"x.gif"), TypeError, "give the name of a file")  # type: ignore[arg-type]
    wrong(lambda: plots.animation(run, frames=1), ValueError, "frames = 1: give a whole number")
    wrong(lambda: plots.animation(run, fps=0), ValueError, "fps = 0: give a whole number from 1")
    wrong(lambda: plots.animation(run, fps="x"), TypeError, "fps = 'x': give a number")  # type: ignore[arg-type]
    assert not path.exists()


def test_a_figure_is_closed_where_drawing_fails(
    run: iva.Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> list[Line2D]:
        raise RuntimeError("no")

    monkeypatch.setattr(Axes, "plot", fail)
    wrong(lambda: plots.velocities(run), RuntimeError, "no")
