"""Moving pictures, and what all pictures have in common."""

from __future__ import annotations

import base64
import itertools
import math
import re
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import polars as pl
import pytest
from matplotlib.colors import to_rgb
from PIL import Image

import iva
from axes_seen import DECAYS, Numbers
from iva import design, plots
from iva.plots import energy_split, styles

mpl.use("Agg")
import matplotlib.pyplot as plt

pytestmark = pytest.mark.usefixtures("pictures_are_closed")


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
            lever = 1.0 if found.pendulum is None else found.pendulum.lever
            assert mass()[0] == pytest.approx(x + lever * y, abs=1e-12)
        else:
            length, angle = found.pendulum.length, states["angle"][index]
            assert length is not None
            place = [x + length * math.sin(angle), -length * math.cos(angle)]
            assert mass() == pytest.approx(place, abs=1e-12)
        now = next(one for one in below.lines if one.get_marker() == "o")
        assert np.asarray(now.get_ydata()).tolist() == [x]
    assert above.get_aspect() == 1.0
    assert below.get_ylabel() == "x (unit of length)"
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
