"""Pictures of a run: the numbers of its tables, with their symbols and units."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
import subprocess
import sys

import matplotlib as mpl
import numpy as np
import polars as pl
import pytest
from matplotlib.collections import LineCollection

import iva
from axes_seen import decaying, line
from iva import plots

mpl.use("Agg")

pytestmark = pytest.mark.usefixtures("pictures_are_closed")


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
    assert [text.get_text() for text in axes.texts] == ["±2 %", "±5 %", "±10 %"]
    axes = plots.decay(metric, relative=False, settle=(), impacts=False, envelope=False)
    assert line(axes, "structure")[1].tolist() == motion["displacement"].to_list()
    assert len(axes.lines) == 1
    assert axes.get_xlabel() == "time t (s)"
    assert axes.get_ylabel() == "displacement x (mm)", "its lengths were given in mm"


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


def test_runs_that_go_on_are_drawn_from_their_begin(run: iva.Run) -> None:
    begin = 30.0
    later = iva.simulate(run.absorber, run.primary, start=run.state_at(begin), periods=5)
    end = later.trajectory()["time"][-1]
    for axes in (
        plots.decay(later),
        plots.decay(later, relative=False),
        plots.velocities(later),
        plots.energy(later),
    ):
        assert axes.get_xlim() == (begin, end)
    displacement, scaled = (
        line(plots.decay(later, relative=relative), "structure")[1] for relative in (False, True)
    )
    assert displacement / abs(displacement[0]) == pytest.approx(scaled, rel=1e-14)
    moving = plots.animation(later, frames=2)
    assert moving._fig.axes[-1].get_xlim() == (begin, end)  # type: ignore[attr-defined]
    moving._draw_was_started = True  # type: ignore[attr-defined]
    for name in ("decay", "velocities", "animation"):
        with pytest.raises(ValueError, match="the run begins at 30; give a later time"):
            getattr(plots, name)(later, until=10.0)


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
    unit = "(unit of length · ωₙ)" if scene == "run" else "(m/s)"
    assert axes.get_ylabel() == f"velocity ẋ, ẋ₁ {unit}"


@pytest.mark.parametrize("scene", ["run", "metric", "pendulum"])
@pytest.mark.parametrize("relative", [False, True])
def test_phase_plane(scene: str, relative: bool, request: pytest.FixtureRequest) -> None:
    run: iva.Run = request.getfixturevalue(scene)
    axes = plots.phase(run, relative=relative)
    jumps = {one.get_label(): one for one in axes.collections if isinstance(one, LineCollection)}
    segments = np.empty((run.impacts.height, 2, 2))
    for wall, label in ((1, "impacts, wall +"), (-1, "impacts, wall −")):
        segments[(run.impacts["wall"] == wall).to_numpy()] = jumps.pop(label).get_segments()
    assert not jumps
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
    unit = "unit of length" if scene == "run" else "mm"
    words = "gap displacement y" if relative else "displacement x"
    assert axes.get_xlabel() == f"{words} ({unit})"


@pytest.mark.parametrize("scene", ["run", "metric", "pendulum"])
def test_accelerations_are_those_of_the_trajectory(
    scene: str, request: pytest.FixtureRequest
) -> None:
    run: iva.Run = request.getfixturevalue(scene)
    axes = plots.accelerations(run)
    motion = run.trajectory()
    for label, name in (("structure a", "acceleration"), ("absorber a₁", "absorber_acceleration")):
        time, values = line(axes, label)
        lifted = np.isnan(values)
        assert lifted.sum() == run.impacts.height, "no line joins what an impact parts"
        assert time[lifted].tolist() == run.impacts["time"].to_list()
        assert values[~lifted].tolist() == motion[name].to_list()
    for wall, label in ((1, "impacts, wall +"), (-1, "impacts, wall −")):
        side = run.impacts.filter(pl.col("wall") == wall)
        assert line(axes, label)[0].tolist() == side["time"].to_list()
    unit = "(unit of length · ωₙ²)" if scene == "run" else "(m/s²)"
    assert axes.get_ylabel() == f"acceleration a, a₁ {unit}"


def test_accelerations_have_the_base_in_them() -> None:
    shaken = iva.simulate(
        None,
        iva.Primary(mass=3.0, stiffness=12_000.0, damping=2.0),
        start=iva.Start(),
        force=iva.Harmonic(base_acceleration=2.0, frequency_hz=5.0),
        duration=1.0,
    )
    axes = plots.accelerations(shaken)
    (drawn,) = axes.lines
    motion = shaken.trajectory()
    # From the balance of forces: only spring and damper act on the structure.
    forces = -(12_000.0 * motion["displacement"] + 2.0 * motion["velocity"]).to_numpy()
    assert np.asarray(drawn.get_ydata()) == pytest.approx(forces / 3.0, abs=1e-9)
    assert axes.get_ylabel() == "acceleration a (m/s²)"


def test_accelerations_of_a_run_without_impacts_in_its_tables() -> None:
    few = decaying(iva.Siva(mass_ratio=0.1, clearance=0.6, restitution=0.5), tables=["envelope"])
    with pytest.raises(ValueError, match="no table 'impacts'"):
        plots.accelerations(few)
    axes = plots.accelerations(few, impacts=False, until=5.0)
    assert axes.get_xlim() == (0.0, 5.0)
    assert [one.get_label() for one in axes.lines] == ["absorber a₁", "structure a"]
