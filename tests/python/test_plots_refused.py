"""Pictures that cannot be drawn: one sentence with field, value and what is allowed."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import polars as pl
import pytest
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

import iva
from axes_seen import DRIVEN, STRUCTURE, decaying
from iva import plots

mpl.use("Agg")
import matplotlib.pyplot as plt

pytestmark = pytest.mark.usefixtures("pictures_are_closed")


def wrong(call: Callable[[], object], error: type[Exception], sentence: str) -> None:
    """Check that a call is refused, and that it leaves no figure behind."""
    with pytest.raises(error, match=re.escape(sentence)):
        call()
    assert not plt.get_fignums()


def with_values(table: iva.Table, **columns: list[float | None]) -> iva.Table:
    """Return a table with other columns in its summary."""
    summary = table.summary.with_columns(
        pl.Series(name, values, dtype=pl.Float64) for name, values in columns.items()
    )
    return iva.Table(table.swept, table.units, iva.frames.Frames({"summary": lambda: summary}))


def test_runs_that_cannot_be_drawn(run: iva.Run, metric: iva.Run, table: iva.Table) -> None:
    anything: Any = table
    for draw in (
        plots.decay,
        plots.velocities,
        plots.accelerations,
        plots.phase,
        plots.energy,
        plots.animation,
    ):
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
    meant = "no such column; did you mean `damping_ratio_3`? Others are point, relative_clearance, "
    wrong(lambda: plots.curves(table, "dampin"), ValueError, f"y = 'dampin': {meant}")
    wrong(lambda: plots.heatmap(table, "damping"), ValueError, f"value = 'damping': {meant}")
    wrong(lambda: plots.raster(table, by="dampin"), ValueError, f"by = 'dampin': {meant}")
    wrong(
        lambda: plots.curves(table, "impacts", x="mass"),
        ValueError,
        "x = 'mass': no such column; did you mean `mass_ratio`? Others are point, ",
    )
    wrong(lambda: plots.curves(table, "outcome"), ValueError, "y = 'outcome': it holds String")
    wrong(lambda: plots.curves(table, "digits"), ValueError, "y = 'digits': it is null at every")
    wrong(lambda: plots.curves(table, 3), TypeError, "y = 3: give the name of a column")  # type: ignore[arg-type]
    wrong(lambda: plots.heatmap(table, "impacts", best="most"), ValueError, "best = 'most': give")  # type: ignore[arg-type]
    wrong(
        lambda: plots.heatmap(table, "impacts", y="wide"),
        ValueError,
        "y = 'wide': no such column; there is point, relative_clearance, mass_ratio, impacts, ",
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
