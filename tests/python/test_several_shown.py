"""What is shown of runs with several absorbers: pictures, universal files, tables on disk.

Numbers come from the tables of the same runs.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
import polars as pl
import pytest
from matplotlib.colors import to_rgb
from matplotlib.patches import Circle, Patch

import iva
from iva.dynamics import section
from iva.plots.moving_pictures import FLASH
from iva.plots.scenery import DARK
from iva.plots.styles import WALLS
from iva.theory import slow_manifold

pytestmark = pytest.mark.usefixtures("pictures_are_closed")

mpl.use("Agg")

HEAVY = iva.Siva(mass_ratio=0.1, clearance=0.6, restitution=0.5)
LIGHT = iva.Siva(mass_ratio=0.05, clearance=0.3, restitution=0.7)
PAIR = [HEAVY, LIGHT]
PRIMARY = iva.Primary(damping_ratio=0.01)
START = iva.Start(displacement=1.0)


def pair(**more: object) -> iva.Run:
    """Return a decay with two masses."""
    return iva.simulate(PAIR, PRIMARY, start=START, periods=10, **more)  # type: ignore[arg-type]


def test_a_decay_shows_the_impacts_of_all() -> None:
    """A tick for each, at the edge of its wall; the line of the structure has each instant once."""
    run = pair()
    axes = iva.plots.decay(run)
    ticks = [line for line in axes.lines if str(line.get_label()).startswith("impacts")]
    assert sum(len(np.atleast_1d(line.get_xdata())) for line in ticks) == run.impacts.height
    curve = next(line for line in axes.lines if line.get_label() == "structure")
    times = np.asarray(curve.get_xdata(), dtype=float)
    assert (np.diff(times) >= 0.0).all()
    # An instant appears twice only where the structure's velocity has jumped.
    assert (np.diff(times) == 0.0).sum() <= run.impacts.height


def test_velocities_have_a_line_for_each() -> None:
    """ẋ + w of each absorber, with both states of its own impacts."""
    run = pair()
    axes = iva.plots.velocities(run)
    labels = [str(line.get_label()) for line in axes.lines]
    assert labels == ["absorber 0", "absorber 1", "structure ẋ"]
    motion = run.trajectory().filter(pl.col("absorber") == 1)
    shown = np.asarray(axes.lines[1].get_ydata(), dtype=float)
    assert shown.tolist() == (motion["velocity"] + motion["gap_velocity"]).to_list()


@pytest.mark.parametrize(("absorber", "clearance"), [(0, 0.6), (1, 0.3)])
def test_a_phase_plane_is_that_of_one(absorber: int, clearance: float) -> None:
    """Its gap displacements reach its own walls and not beyond."""
    axes = iva.plots.phase(pair(), relative=True, absorber=absorber)
    flight = next(line for line in axes.lines if line.get_label() == "flight")
    reached = np.nanmax(np.abs(np.asarray(flight.get_xdata(), dtype=float)))
    assert reached == pytest.approx(clearance, rel=1e-12)


def test_a_phase_plane_of_the_structure_has_all_jumps() -> None:
    """As many vertical jumps as there are impacts that change its velocity."""
    run = pair()
    axes = iva.plots.phase(run)
    for wall, jumps in zip((1, -1), axes.collections, strict=True):
        struck = run.impacts.filter(run.impacts["wall"] == wall)
        ends = np.array([np.asarray(path.vertices)[:, 1] for path in jumps.get_paths()])
        wanted = struck["velocity_before", "velocity_after"].sort("velocity_before").to_numpy()
        assert ends[np.argsort(ends[:, 0])].tolist() == wanted.tolist()


def test_an_animation_has_a_row_for_each() -> None:
    """Each mass is where the motion says, all to one scale."""
    import matplotlib.pyplot as plt

    run = pair()
    moving = iva.plots.animation(run, frames=201)
    moving._draw_was_started = True  # type: ignore[attr-defined]
    *above, _ = plt.gcf().axes
    assert len(above) == 2
    assert above[0].get_xlim() == above[1].get_xlim()
    instants = np.linspace(0.0, run.trajectory()["time"][-1], 201)
    for index in range(0, 201, 8):
        moving._func(index)  # type: ignore[attr-defined]
        states = run.at([instants[index]])
        for axes, row in zip(above, states.iter_rows(named=True), strict=True):
            (mass,) = (patch for patch in axes.patches if isinstance(patch, Circle))
            there = row["displacement"] + row["gap_displacement"]
            assert mass.center[0] == pytest.approx(there, abs=1e-12)
            # A wall is lit for a while after an impact of its own absorber, and only then.
            own = run.impacts.filter(pl.col("absorber") == row["absorber"])
            since = instants[index] - own["time"].to_numpy()
            lately = (since >= 0.0) & (since < FLASH * instants[1])
            walls = {*own["wall"].to_numpy()[lately], row["wall"] or 0}
            expected = {colour for wall, colour in WALLS.items() if wall in walls}
            lit = {
                wall for wall in WALLS.values() if any(glows(part, wall) for part in axes.patches)
            }
            assert lit == expected


def glows(part: Patch, wall: str) -> bool:
    """Return whether a part has some of the colour of a lit wall: it lies between dark and that."""
    dark, lit, seen = (np.array(to_rgb(it)) for it in (DARK, wall, part.get_facecolor()[:3]))
    share = float((seen - dark) @ (lit - dark) / ((lit - dark) @ (lit - dark)))
    return share > 1e-9 and bool(np.allclose(dark + share * (lit - dark), seen, atol=1e-9))


def test_what_shows_one_refuses_several() -> None:
    """With the number of absorbers, and what to give."""
    run = pair()
    with pytest.raises(ValueError, match="run has 2 absorbers: this is drawn for one"):
        iva.plots.slow_manifold(run)
    with pytest.raises(ValueError, match="run has 2 absorbers: a section is of one"):
        section(run, "wall+")
    for number in (2, -1, 0.5):
        with pytest.raises(ValueError, match="the run has 2, numbered from 0"):
            iva.plots.phase(run, relative=True, absorber=number)  # type: ignore[arg-type]
    units = iva.Siva(mass_ratio=0.1, clearance=0.6, restitution=0.5, units=2)
    with pytest.raises(ValueError, match="units"):
        slow_manifold(units, PRIMARY)


def test_a_universal_file_has_a_node_for_each(tmp_path: Path) -> None:
    """Node 1 is the structure, then the absorbers: x + y and ẋ + w."""
    pyuff = pytest.importorskip("pyuff")
    run = pair()
    run.write_uff(tmp_path / "pair.uff")
    sets = pyuff.UFF(str(tmp_path / "pair.uff")).read_sets()
    assert [one["rsp_node"] for one in sets] == [1, 1, 2, 2, 3, 3]
    times = sets[0]["x"]
    at = run.at(times)
    for absorber in range(2):
        own = at.filter(pl.col("absorber") == absorber)
        found = sets[2 + 2 * absorber]["data"]
        expected = (own["displacement"] + own["gap_displacement"]).to_numpy()
        assert np.abs(found - expected).max() < 1e-12


def test_units_are_a_list_of_equal_masses() -> None:
    """The same bits as that list, and as many rows."""
    units = iva.Siva(mass_ratio=0.2, clearance=0.5, restitution=0.6, units=4, clearance_spread=0.1)
    clearances = [
        0.5 * (1.0 + 0.1 * place) for place in (-1.0, 2.0 / 3.0 - 1.0, 4.0 / 3.0 - 1.0, 1.0)
    ]
    listed = [iva.Siva(mass_ratio=0.05, clearance=d, restitution=0.6) for d in clearances]
    one, other = (
        iva.simulate(absorber, PRIMARY, start=START, periods=10) for absorber in (units, listed)
    )
    assert one.impacts.equals(other.impacts)
    assert one.absorbers.equals(other.absorbers)
    assert one.absorbers.height == 4


def test_units_in_gaps_all_alike_are_one_mass() -> None:
    """Momentum of n equal impacts at once is that of one (closed form)."""
    one, four = (
        iva.simulate(
            iva.Siva(mass_ratio=0.2, clearance=0.5, restitution=0.6, units=units),
            PRIMARY,
            start=START,
            periods=3,
        )
        for units in (1, 4)
    )
    assert four.impacts.height == 4 * one.impacts.height
    times = four.impacts["time"].to_numpy().reshape(-1, 4)
    assert (times == times[:, :1]).all()
    assert np.abs(times[:, 0] - one.impacts["time"].to_numpy()).max() < 1e-12
    assert four.absorbers["impulse_max"].sum() == pytest.approx(
        one.absorbers["impulse_max"].item(), rel=1e-12
    )


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ({"units": 65}, "absorber.units = 65: give a whole number from 1 to 64"),
        ({"units": 2.5}, "absorber.units = 2.5: give a whole number from 1 to 64"),
        ({"units": 2, "clearance_spread": 1.0}, "the narrowest gap has no width"),
    ],
)
def test_bad_units_are_refused(more: dict[str, float], told: str) -> None:
    """With field, value and what is allowed."""

    def made() -> iva.Run:
        absorber = iva.Siva(mass_ratio=0.2, clearance=0.5, restitution=0.6, **more)
        return iva.simulate(absorber, PRIMARY, start=START, periods=1)

    with pytest.raises(ValueError, match=told):
        made()


def test_a_start_outside_a_narrow_unit_names_the_start() -> None:
    """The gap of the narrowest unit counts."""
    absorber = iva.Siva(
        mass_ratio=0.2, clearance=0.5, restitution=0.6, units=2, clearance_spread=0.5
    )
    start = iva.Start(displacement=1.0, gap_displacement=0.3)
    with pytest.raises(ValueError, match=r"start\.gap_displacement = 0\.3: it must lie in the gap"):
        iva.simulate(absorber, PRIMARY, start=start, periods=1)


def test_a_sweep_of_several_is_read_back(tmp_path: Path) -> None:
    """Parquet, Arrow and CSV hold the tables that memory has."""
    over = {"absorber.1.clearance": [0.2, 0.3], "restitution": [0.5, 0.6]}
    tables = ("summary", "impacts", "absorbers")
    how = {"over": over, "start": START, "periods": 5, "tables": tables}
    kept = iva.sweep(PAIR, PRIMARY, **how)  # type: ignore[arg-type]
    assert kept.absorbers.height == 8
    for name in ("parquet", "arrow", "csv"):
        out = tmp_path / name
        table = iva.sweep(PAIR, PRIMARY, out=out, format=name, **how)  # type: ignore[arg-type]
        assert table == kept
        assert iva.read(out) == kept


def test_an_optimum_is_found_for_two() -> None:
    """Among three sizes of the second clearance, the best of a sweep over them."""
    pytest.importorskip("scipy")
    sizes = [0.2, 0.3, 0.45]
    found = iva.optimise(
        [PAIR],
        PRIMARY,
        choose={"absorber.1.clearance": sizes},
        minimise="settling_time_5",
        start=START,
        periods=30,
        seed=1,
        runs=500,
    )
    table = iva.sweep(
        PAIR, PRIMARY, over={"absorber.1.clearance": sizes}, start=START, periods=30
    ).summary
    best = table.sort("settling_time_5")["absorber.1.clearance"][0]
    assert found.best["absorber.1.clearance"] == best


@pytest.mark.parametrize(
    ("key", "told"),
    [
        ("absorber.1.clearence", r"did you mean `absorber\.1\.clearance`"),
        ("absorber.01.clearance", "no such field"),
        ("start.1.displacement", "no such field of an absorber"),
    ],
)
def test_a_misspelt_key_is_refused(key: str, told: str) -> None:
    """With the nearest one that there is."""
    with pytest.raises(ValueError, match=told):
        iva.sweep(PAIR, PRIMARY, over={key: [0.2, 0.3]}, start=START, periods=5)


def test_lists_of_one_are_taken() -> None:
    """A program that builds lists of any length needs no case of its own for one."""
    listed, plain = (
        iva.simulate(absorber, PRIMARY, start=start, periods=5)
        for absorber, start in (
            ([HEAVY], iva.Start(displacement=1.0, gap_displacement=[0.1], gap_velocity=[0.2])),
            (HEAVY, iva.Start(displacement=1.0, gap_displacement=0.1, gap_velocity=0.2)),
        )
    )
    assert listed.impacts.equals(plain.impacts)
