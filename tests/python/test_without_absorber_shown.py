"""A structure without absorber: what results of it show, files for others, and pictures."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import matplotlib as mpl
import numpy as np
import pytest
import pyuff
import scipy.io

import iva
from axes_seen import DRIVEN, STRUCTURE, labels, line
from iva import plots
from iva.plots import energy_split

mpl.use("Agg")
import matplotlib.pyplot as plt

pytestmark = pytest.mark.usefixtures("pictures_are_closed")

# Drives the structure at its natural frequency, long enough for the transient to die.
RESONANT: dict[str, Any] = {
    "force": iva.Harmonic(amplitude=0.1, frequency=1.0),
    "cycles": 160,
    "discard": 100,
}


def alone(damping_ratio: float = 0.02, **given: Any) -> iva.Run:
    """Return a run of the structure alone."""
    if not {"duration", "cycles"} & set(given):
        given["periods"] = 30
    primary = iva.Primary(damping_ratio=damping_ratio)
    return iva.simulate(None, primary, start=iva.Start(displacement=1.0), **given)


@pytest.fixture
def bare() -> iva.Run:
    """Return a decay of the structure alone."""
    return alone()


def test_repr(bare: iva.Run) -> None:
    row = bare.summary.row(0, named=True)
    assert repr(bare).splitlines() == [
        "Run: finished",
        f"  settling_time_5 {row['settling_time_5']:.4g}/ωn, damping_ratio_3 0.02, "
        f"residual_amplitude {row['residual_amplitude']:.4g}",
        "  no absorber",
        "  Primary(damping_ratio=0.02)",
        "  Start(displacement=1.0)",
        f"  {bare.units}",
    ]
    driven = repr(alone(0.05, **RESONANT))
    assert driven.splitlines()[1] == "  amplitude_max 1 unit of length"
    assert driven.splitlines()[4] == "  Harmonic(amplitude=0.1, frequency=1.0)"


def test_markup(bare: iva.Run) -> None:
    html = bare._repr_html_()
    tree = ElementTree.fromstring(html)
    shown = {str(one[0].text): one[1].text for one in tree.iter("tr")}
    assert list(shown)[:3] == ["absorber", "primary", "start"]
    assert shown["absorber"] == "none"
    assert shown["impacts"] == "0"
    assert "stop_reachable" not in shown


def test_a_mat_file(tmp_path: Path, bare: iva.Run) -> None:
    bare.write_mat(tmp_path / "bare.mat", samples_per_period=20)
    read = scipy.io.loadmat(tmp_path / "bare.mat")
    motion = bare.trajectory(20)
    found = read["trajectory"]
    np.testing.assert_array_equal(found["displacement"][0, 0][:, 0], motion["displacement"])
    assert np.isnan(found["gap_displacement"][0, 0]).all()
    assert (found["wall"][0, 0] == 0.0).all()
    assert np.isnan(read["summary"]["stop_reachable"][0, 0]).all()
    assert read["impacts"]["time"][0, 0].shape == (0, 1)


@pytest.mark.parametrize("binary", [True, False], ids=["binary", "text"])
def test_a_universal_file_has_the_structure_alone(tmp_path: Path, binary: bool) -> None:
    run = iva.simulate(None, STRUCTURE, start=iva.Start(displacement_mm=4.0), duration=1.0)
    run.write_uff(tmp_path / "bare.uff", samples_per_second=1000, binary=binary)
    units, *responses = pyuff.UFF(str(tmp_path / "bare.uff")).read_sets()
    assert units["type"] == 164
    assert [one["rsp_node"] for one in responses] == [1, 1]
    assert [one["func_id"] for one in responses] == [1, 2]
    for response, name in zip(responses, ("displacement", "velocity"), strict=True):
        expected = run.at(response["x"])[name].to_numpy()
        assert np.allclose(response["data"], expected, rtol=6e-12, atol=0)
        assert response["id1"].startswith(f"{name} of structure")
        assert response["id2"] == "no absorber"


def test_pictures_of_a_decay(bare: iva.Run, run: iva.Run) -> None:
    axes = plots.decay(bare)
    assert line(axes, "structure")[1].tolist() == bare.trajectory()["displacement"].to_list()
    assert line(axes, "envelope")[1].tolist() == bare.envelope["amplitude"].to_list()
    assert labels(axes) == ["structure", "envelope"]
    # No table of impacts is needed where there can be none.
    assert labels(plots.decay(alone(tables=("envelope",)))) == ["structure", "envelope"]
    both = plots.decay(run, bare=bare)
    behind = line(both, "without absorber")[1]
    assert behind.tolist() == bare.trajectory()["displacement"].to_list()
    assert "with absorber" in labels(both)
    more = alone(0.1)
    assert labels(plots.decay(more, bare=bare))[:2] == ["without absorber", "structure"]


def test_pictures_of_velocities_and_the_phase_plane(bare: iva.Run) -> None:
    motion = bare.trajectory()
    axes = plots.velocities(bare)
    assert labels(axes) == ["structure ẋ"]
    assert line(axes, "structure ẋ")[1].tolist() == motion["velocity"].to_list()
    assert axes.get_ylabel() == "velocity ẋ (unit of length · ωₙ)"
    axes = plots.phase(bare)
    assert labels(axes) == ["flight", "start"]
    x, v = line(axes, "flight")
    assert x.tolist() == motion["displacement"].to_list()
    assert v.tolist() == motion["velocity"].to_list()


FORCES: dict[str, Any] = {
    "none": None,
    "harmonic": iva.Harmonic(amplitude=0.2, frequency=0.9),
    "base": iva.Harmonic(base_acceleration=0.2, frequency=0.9),
    "impulses": [iva.Impulse(velocity=0.5), iva.Impulse(velocity=0.3, time=7.1)],
}


@pytest.mark.parametrize("name", FORCES)
def test_pictures_of_energy(name: str) -> None:
    run = alone(0.05, force=FORCES[name], duration=40.0)
    axes = plots.energy(run)
    assert [layer.get_label() for layer in axes.collections] == ["structure", "damper"]
    split = energy_split.split_of(run)
    row = run.summary.row(0, named=True)
    put_in = row["energy_initial"] + row["energy_work"]
    assert split.total[-1] == pytest.approx(put_in, rel=1e-8)
    assert split.layers["damper"][-1] == pytest.approx(row["energy_viscous"], rel=1e-8)
    assert split.layers["structure"][-1] == pytest.approx(row["energy_final"], rel=1e-12)


def test_pictures_of_sweeps() -> None:
    table = iva.sweep(
        None,
        DRIVEN[1],
        over={"force.relative_frequency": [0.95, 1.0, 1.05]},
        start=iva.Start(),
        force=DRIVEN[2],
        cycles=500,
        discard=400,
    )
    axes = plots.forced_response(table)
    points = line(axes, "computed")[1]
    assert [drawn.get_label() for drawn in axes.get_lines()] == ["computed"]
    expected = [0.1 / math.hypot(1.0 - ratio**2, 2.0 * 0.02 * ratio) for ratio in (0.95, 1.0, 1.05)]
    assert points == pytest.approx(expected, rel=1e-9)


def test_pictures_of_a_gap_are_refused(bare: iva.Run, tmp_path: Path) -> None:
    path = tmp_path / "bare.gif"
    calls: list[tuple[Callable[[], object], str]] = [
        (
            lambda: plots.phase(bare, relative=True),
            "relative = True: this run has no absorber, and so no gap; give False",
        ),
        (lambda: plots.raster(bare), "this run has no absorber, and so no impacts to draw"),
        (lambda: plots.animation(bare), "this run has no absorber, and so no gap to show"),
        (lambda: plots.animate(bare, path), "this run has no absorber, and so no gap to show"),
    ]
    for call, says in calls:
        with pytest.raises(ValueError, match=f"^{re.escape(says)}$"):
            call()
    assert not plt.get_fignums()
    assert not path.exists()
