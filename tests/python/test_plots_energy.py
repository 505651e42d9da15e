"""Where the energy goes: the split is whole at every instant."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.collections import PolyCollection

import iva
from axes_seen import DECAYS, STRUCTURE, decaying
from iva import plots
from iva.plots import energy_split

mpl.use("Agg")

pytestmark = pytest.mark.usefixtures("pictures_are_closed")


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


LISTS: dict[str, list[iva.Siva | iva.Piva]] = {
    "masses": [
        iva.Siva(mass_ratio=0.2, clearance=0.3, restitution=0.5, units=2, clearance_spread=0.1),
        iva.Siva(mass_ratio=0.1, clearance=0.5, restitution=0.0),
    ],
    "mass and pendulum": [
        iva.Siva(mass_ratio=0.1, clearance=0.3, restitution=0.5),
        iva.Piva(
            mass_ratio=0.1,
            clearance=0.5,
            length=2.0,
            restitution=0.6,
            frequency_ratio=0.4,
            pivot_damping_ratio=0.02,
        ),
    ],
    "dashpots": [
        iva.Siva(mass_ratio=0.1, clearance=0.3, restitution=0.5, gap_damping_ratio=0.002),
        iva.Siva(mass_ratio=0.1, clearance=0.4, restitution=0.5, units=2, gap_damping_ratio=0.01),
    ],
}


DRIVES: dict[str, Any] = {
    "none": None,
    "harmonic": iva.Harmonic(amplitude=0.1, relative_frequency=1.0),
    "impulse": iva.Impulse(velocity=0.7, time=7.0),
    "both": [iva.Harmonic(amplitude=0.1, frequency=1.2), iva.Impulse(velocity=-0.5, time=12.0)],
}


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("scene", LISTS)
def test_energy_of_a_list_is_somewhere(scene: str, drive: str) -> None:
    run = iva.simulate(
        LISTS[scene],
        iva.Primary(damping_ratio=0.01),
        start=iva.Start(displacement=1.0),
        force=DRIVES[drive],
        periods=6,
    )
    split, row = energy_split.split_of(run), run.summary.row(0, named=True)
    whole = split.total.max()
    put_in = row["energy_initial"] + row["energy_work"]
    assert split.total[0] == pytest.approx(row["energy_initial"], rel=1e-12)
    assert split.total[-1] == pytest.approx(put_in, abs=1e-8 * whole)
    held = split.layers["structure"] + split.layers["absorber"]
    assert held[-1] == pytest.approx(row["energy_final"], abs=1e-12 * whole)
    own = {"mass and pendulum": "pivot", "dashpots": "dashpot"}.get(scene)
    for name, column in (
        ("damper", "energy_viscous"),
        ("impacts", "energy_impacts"),
        (own, "energy_pivot"),
    ):
        last = split.layers[name][-1] if name else 0.0
        assert last == pytest.approx(row[column], abs=1e-8 * whole), name
        if name:
            assert np.diff(split.layers[name]).min() > -1e-9 * whole, "a loss only grows"
    assert len(plots.energy(run).collections) == len(split.layers)


@pytest.mark.parametrize("time", [0.0, 100.0])
def test_energy_of_a_list_knows_the_impact_at_its_begin(time: float) -> None:
    run = iva.simulate(
        LISTS["masses"],
        iva.Primary(damping_ratio=0.01),
        start=iva.Start(
            displacement=1.0, gap_displacement=[0.0, 0.5], gap_velocity=[0.0, 1.0], time=time
        ),
        duration=time + 40.0,
    )
    split, row = energy_split.split_of(run), run.summary.row(0, named=True)
    assert run.impacts["time"][0] == time
    assert split.layers["impacts"][0] == pytest.approx(run.impacts["energy_loss"][0], rel=1e-9)
    assert split.total == pytest.approx(row["energy_initial"], rel=1e-8)


FORCED: dict[str, Any] = {
    "harmonic": iva.Harmonic(force=2.0, relative_frequency=1.0),
    "base": iva.Harmonic(base_acceleration=2.0, relative_frequency=1.0),
    "record": iva.Recorded([0.0, 0.1, 0.2, 0.5], [0.0, 3.0, -3.0, 0.0]),
    "impulses": [iva.Impulse(impulse=0.5), iva.Impulse(impulse=0.4, time=0.1234)],
}


@pytest.mark.parametrize("force", FORCED)
@pytest.mark.parametrize("kind", ["mass", "pendulum", "spring"])
def test_energy_under_force_is_what_was_put_in(force: str, kind: str) -> None:
    absorber = (
        iva.Siva(mass=0.3, restitution=0.6, gap_mm=4.0)
        if kind == "mass"
        else iva.Piva(
            mass=0.3,
            length=0.1,
            restitution=0.6,
            gap_mm=4.0,
            spring_ratio=0.7 if kind == "spring" else None,
        )
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
