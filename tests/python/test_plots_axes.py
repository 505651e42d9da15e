"""Axes of pictures: units, prefixes, ticks, and the labels of levels."""

from __future__ import annotations

import itertools
import pickle
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.text import Text

import iva
from axes_seen import STRUCTURE, decaying, line
from iva import plots
from iva.plots.axis_units import Prefixed, name_axis
from iva.plots.level_labels import spread
from iva.plots.styles import figure_of

mpl.use("Agg")
import matplotlib.pyplot as plt

pytestmark = pytest.mark.usefixtures("pictures_are_closed")


def released(**lengths: Any) -> iva.Run:
    """Return a decay in SI units from lengths in m or mm."""
    gap = {name: value for name, value in lengths.items() if name.startswith("gap")}
    start = {name: value for name, value in lengths.items() if name.startswith("displacement")}
    absorber = iva.Siva(mass=0.3, restitution=0.6, **gap)
    return iva.simulate(absorber, STRUCTURE, start=iva.Start(**start), duration=1.0)


def shown(axes: Axes, axis: str) -> dict[float, str]:
    """Return the ticks that can be seen of an axis: place in data coordinates and text."""
    figure_of(axes).draw_without_rendering()
    one = axes.xaxis if axis == "x" else axes.yaxis
    low, high = sorted(one.get_view_interval())
    places, texts = one.get_majorticklocs(), one.get_ticklabels()
    return {
        float(place): text.get_text()
        for place, text in zip(places, texts, strict=True)
        if low <= place <= high
    }


@pytest.mark.parametrize(
    ("lengths", "unit", "times"),
    [
        ({"gap_mm": 6.0, "displacement_mm": 4.0}, "mm", 1e3),
        ({"gap": 0.006, "displacement": 0.004}, "mm", 1e3),
        ({"gap": 0.6, "displacement": 0.4}, "m", 1.0),
        ({"gap_mm": 600.0, "displacement": 0.4}, "mm", 1e3),
        ({"gap": 0.6, "displacement_mm": 400.0}, "mm", 1e3),
        ({"gap": 6e-5, "displacement": 4e-5}, "µm", 1e6),
        ({"gap_mm": 0.06, "displacement_mm": 0.04}, "mm", 1e3),
    ],
)
def test_lengths_are_in_the_unit_that_they_have_in_words(
    lengths: dict[str, float], unit: str, times: float
) -> None:
    run = released(**lengths)
    axes = plots.decay(run, relative=False)
    assert axes.get_ylabel() == f"displacement x ({unit})"
    drawn = line(axes, "structure")[1]
    assert drawn.tolist() == run.trajectory()["displacement"].to_list(), "data are those of tables"
    ticks = shown(axes, "y")
    assert len(ticks) > 2
    for place, text in ticks.items():
        assert float(text.replace("−", "-")) == pytest.approx(times * place, abs=1e-9 * times)


def test_every_tick_has_as_many_decimals() -> None:
    axes = plots.decay(released(gap_mm=3.0, displacement_mm=1.0), relative=False)
    axes.set_ylim(-0.001, 0.001)
    axes.set_yticks([-0.001, -0.0005, 0.0, 0.0005, 0.001])
    assert list(shown(axes, "y").values()) == ["−1.0", "−0.5", "0.0", "0.5", "1.0"]


@pytest.mark.parametrize(
    ("unit", "largest", "expected"),
    [
        ("m/s", 0.02, "m/s"),
        ("m/s", 0.005, "mm/s"),
        ("m/s²", 0.005, "mm/s²"),
        ("J", 0.5, "J"),
        ("J", 0.002, "mJ"),
        ("J", 2e-6, "µJ"),
        ("J", 20_000.0, "kJ"),
        ("N", 9_000.0, "N"),
        ("N", 3e4, "kN"),
        ("N", 3e7, "MN"),
        ("N s", 0.004, "mN s"),
        ("m", 0.09, "mm"),
        ("m", 30_000.0, "km"),
        ("mm", 1e-4, "mm"),
        ("s", 1e-4, "s"),
        ("1", 1e-4, "1"),
        ("m", 0.0, "m"),
    ],
)
def test_small_and_large_values_have_a_prefix(unit: str, largest: float, expected: str) -> None:
    _, axes = plt.subplots()
    axes.plot([0.0, 1.0], [-0.5 * largest, largest])
    name_axis(axes.yaxis, "size in {}".format, unit)
    assert axes.get_ylabel() == f"size in {expected}"


def test_axes_that_share_their_ticks_share_the_unit() -> None:
    small, large = released(gap=0.006, displacement=0.004), released(gap=0.6, displacement=0.4)
    for runs in ((small, large), (large, small)):
        _, panels = plt.subplots(2, sharey=True)
        for run, panel in zip(runs, panels, strict=True):
            plots.decay(run, relative=False, ax=panel)
        assert {panel.get_ylabel() for panel in panels} == {"displacement x (m)"}
        assert {float(text.replace("−", "-")) for text in shown(panels[0], "y").values()} >= {0.4}
    _, panels = plt.subplots(2, sharey=True)
    plots.decay(small, relative=False, ax=panels[0])
    panels[0].set_ylabel("deflection (mm)")
    plots.decay(small, relative=False, ax=panels[1])
    assert panels[0].get_ylabel() == "deflection (mm)", "what somebody else has written stays"


def test_a_second_run_on_the_same_axes_counts() -> None:
    axes = plots.decay(released(gap=0.006, displacement=0.004), relative=False)
    assert axes.get_ylabel() == "displacement x (mm)"
    plots.decay(released(gap=0.6, displacement=0.4), relative=False, ax=axes)
    assert axes.get_ylabel() == "displacement x (m)"
    plots.decay(released(gap=0.6, displacement=0.4), ax=axes)
    assert axes.get_ylabel() == "displacement x/A₀"
    assert not isinstance(axes.yaxis.get_major_formatter(), Prefixed)


def test_what_one_looks_at_decides() -> None:
    _, axes = plt.subplots()
    axes.plot([0.0, 1.0], [0.001, 5.0])
    axes.set_ylim(0.0, 0.01)
    name_axis(axes.yaxis, "x ({})".format, "m")
    assert axes.get_ylabel() == "x (mm)"


def test_rounding_errors_do_not_fill_an_axis() -> None:
    _, axes = plt.subplots()
    axes.plot([0.0, 1.0], [0.004, 0.004 * (1.0 + 1e-14)])
    name_axis(axes.yaxis, "x ({})".format, "m")
    low, high = axes.get_ylim()
    assert high - low == pytest.approx(0.1 * 0.004, rel=1e-6)
    assert max(map(len, shown(axes, "y").values())) < 6


def test_sweeps_in_millimetres() -> None:
    table = iva.sweep(
        iva.Siva(mass=0.3, restitution=0.6),
        STRUCTURE,
        over={"gap_mm": [4.0, 6.0, 8.0], "displacement": [0.2, 0.4]},
        start=iva.Start(),
        duration=1.0,
    )
    axes = plots.curves(table, "energy_impacts")
    assert axes.get_xlabel() == "total play 2d (mm)"
    assert set(shown(axes, "x")) >= {4.0, 6.0, 8.0}
    assert axes.get_ylabel() == "energy lost in impacts E (J)"
    axes = plots.heatmap(table, "displacement")
    assert axes.get_ylabel() == "start displacement x₀ (mm)"
    assert shown(axes, "y")[0.2] == "200"
    bar = figure_of(axes).axes[1]
    assert bar.get_ylabel() == "start displacement x₀ (mm)"
    axes.collections[0].set_clim(0.0, 0.1)
    assert shown(bar, "y")[0.1] == "100", "also after other ends of the colours"


def test_a_figure_can_be_pickled() -> None:
    axes = plots.decay(released(gap_mm=6.0, displacement_mm=4.0), relative=False)
    again = pickle.loads(pickle.dumps(figure_of(axes)))
    assert again.axes[0].get_ylabel() == "displacement x (mm)"
    assert shown(again.axes[0], "y") == shown(axes, "y")


def test_ticks_are_as_many_as_have_room() -> None:
    for width, least, most in ((7.0, 6, 10), (1.4, 2, 4)):
        figure, axes = plt.subplots(figsize=(width, 1.5), layout="constrained")
        axes.plot([0.0, 0.1], [-0.003, 0.002])
        name_axis(axes.xaxis, "t ({})".format, "s")
        assert least <= len(shown(axes, "x")) <= most
        axes.set_xticks([0.0, 0.1])
        name_axis(axes.xaxis, "t ({})".format, "s")
        assert list(shown(axes, "x")) == [0.0, 0.1], "ticks of the user stay"
        plt.close(figure)


def test_levels_have_a_label_each(run: iva.Run) -> None:
    for settle in ((10, 5, 2), (50, 20, 10, 5, 2, 1), (40,)):
        axes = plots.decay(run, settle=settle)
        figure_of(axes).canvas.draw()
        texts = axes.texts
        # Without the lines that join them.
        boxes = [Text.get_window_extent(text) for text in texts]
        # From the lowest level up.
        assert [text.get_text() for text in texts] == [f"±{level} %" for level in settle[::-1]]
        middles = [0.5 * (box.y0 + box.y1) for box in boxes]
        assert all(np.diff(middles) > 0.0)
        for one, other in itertools.pairwise(boxes):
            assert one.y1 <= other.y0 + 1.0
        assert min(box.x0 for box in boxes) > axes.get_window_extent().x1
        assert max(box.x1 for box in boxes) <= figure_of(axes).bbox.x1
    alone = axes.transData.transform((0.0, 0.4))[1]
    assert middles[0] == pytest.approx(alone, abs=1.0), "one that is alone is at its line"


def test_spread_moves_labels_as_little_as_can_be() -> None:
    # Two at one place move by half of the distance each; those with room stay.
    assert spread(np.array([0.0, 0.0, 9.0]), 4.0).tolist() == [-2.0, 2.0, 9.0]
    assert spread(np.array([3.0]), 4.0).tolist() == [3.0]
    assert spread(np.array([]), 4.0).tolist() == []
    # Each crowd around its mean: 1 and 20.5.
    at = np.array([0.0, 1.0, 2.0, 20.0, 21.0])
    assert spread(at, 5.0).tolist() == [-4.0, 1.0, 6.0, 18.0, 23.0]


def test_walls_have_one_colour_each() -> None:
    from matplotlib.collections import LineCollection
    from matplotlib.colors import same_color

    from iva.plots.styles import WALLS

    run = decaying(iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5))
    for axes in (plots.decay(run), plots.raster(run), plots.phase(run)):
        for wall, name in ((1, "impacts, wall +"), (-1, "impacts, wall −")):
            (drawn,) = [one for one in axes.get_children() if one.get_label() == name]
            colour: Any = (
                drawn.get_color()[0] if isinstance(drawn, LineCollection) else drawn.get_color()  # type: ignore[attr-defined]
            )
            assert same_color(colour, WALLS[wall])
    for at, wall in (("wall+", 1), ("wall-", -1)):
        (points,) = plots.section(run, at).lines
        assert same_color(points.get_color(), WALLS[wall])
