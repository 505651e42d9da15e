"""Several free masses on one structure: what must hold whatever the numbers are.

Numbers themselves are held against an integration in `test_several_integrated.py`; sweeps and what
a run can do are in `test_several_runs.py`, what is refused in `test_several_refused.py`.
"""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import polars as pl
import pytest
from polars.testing import assert_frame_equal

import iva
from planted_rows import Mass, Row

UNIT = 2.0**-53
TABLES = ("summary", "impacts", "episodes", "envelope", "stroboscope")
#: What changes its sign with x.
SIGNED = {
    *("displacement", "velocity", "gap_displacement", "gap_velocity", "wall", "acceleration"),
    *("absorber_acceleration", "velocity_before", "velocity_after", "approach_velocity"),
    *("absorber_velocity_before", "absorber_velocity_after"),
}

#: Without chatter: a decay, a force with which two masses once hit at once, and a base in motion.
FREE = Row(
    (Mass(0.05, 0.8, 0.5, 0.1, -0.2), Mass(0.08, 0.7, 0.7, -0.3, 0.1, 0.1)), 0.01, 1.2, 0.3, 25.0
)
PUSHED = Row(
    (Mass(0.06, 0.85, 0.6, 0.2, 0.0, -0.1, 0.75), Mass(0.03, 0.8, 0.9), Mass(0.1, 0.7, 0.8, -0.4)),
    0.03, -0.8, 0.2, 40.0, (0.25, 0.9, 0.4),
)  # fmt: skip
SHAKEN = replace(FREE, harmonic=(0.3, 1.2, 1.0), base=True, duration=30.0)
#: With chatter, sticks and releases, and a plastic mass that others strike off its stop.
STICKING = Row(
    (Mass(0.1, 0.4, 0.2, 0.05), Mass(0.05, 0.8, 0.6, -0.1, -0.4), Mass(0.07, 0.0, 0.3, 0.1)),
    0.02, 1.1, 0.0, 25.0,
)  # fmt: skip
ROWS = {
    "free": FREE,
    "pushed": PUSHED,
    "shaken": SHAKEN,
    "sticking": STICKING,
    "sticking and pushed": replace(STICKING, harmonic=(0.3, 0.8, 0.2), duration=30.0),
    "sticking and shaken": replace(STICKING, harmonic=(0.3, 0.8, 0.2), base=True),
}


@pytest.fixture(params=ROWS)
def row(request: pytest.FixtureRequest) -> Row:
    """Return each of the scenes."""
    found: Row = ROWS[request.param]
    return found


def flipped(frame: pl.DataFrame) -> pl.DataFrame:
    """Return a frame of the mirrored motion; a number of 0 has no sign in a comparison."""
    return frame.with_columns(-pl.col(name) for name in frame.columns if name in SIGNED)


def mirrored(row: Row) -> Row:
    """Return the mirror image of a scene."""
    masses = tuple(
        replace(
            mass, y=-mass.y, w=-mass.w, offset=-mass.offset, e=mass.restitution(-1), e_minus=mass.e
        )
        for mass in row.masses
    )
    harmonic = row.harmonic and (-row.harmonic[0], *row.harmonic[1:])
    return replace(row, masses=masses, x=-row.x, v=-row.v, harmonic=harmonic)


def test_the_mirror_image_is_the_mirror_image_to_the_bit(row: Row) -> None:
    one = row.run()
    other = mirrored(row).run()
    assert one.impacts.height > 10
    for name in TABLES:
        assert_frame_equal(flipped(getattr(other, name)), getattr(one, name), check_exact=True)
    assert_frame_equal(other.absorbers, one.absorbers, check_exact=True)
    motion = one.trajectory(20)
    assert_frame_equal(flipped(other.trajectory(20)), motion, check_exact=True)


@pytest.mark.parametrize("count", [2, 3, 8])
@pytest.mark.parametrize("d", [0.6, 0.15])
def test_equal_masses_in_one_phase_are_one_of_their_sum(count: int, d: float) -> None:
    """Sums of the masses are exact; with the narrow gap they chatter and ride."""
    mass = Mass(1 / 64, 0.5 if d < 0.5 else 0.8, d, 0.1, -0.1)
    several = Row((mass,) * count, 0.01, 1.0, 0.0, 12.0)
    single = replace(mass, mu=count / 64).absorber()
    start = iva.Start(displacement=1.0, gap_displacement=0.1, gap_velocity=-0.1)
    primary = iva.Primary(damping_ratio=0.01)
    one = iva.simulate(single, primary, start=start, duration=12.0, errors=True)
    run = several.run()
    worst = 1e-13 + 30 * UNIT * one.summary["condition"].item()
    assert worst < 1e-9
    columns = ("time", "displacement", "velocity_before", "velocity_after", "approach_velocity")
    assert run.impacts.height == count * one.impacts.height > 0
    assert (run.episodes.height > 0) == (one.episodes.height > 0) == (d < 0.5)
    for k in range(count):
        hits = run.impacts.filter(absorber=k)
        assert hits["wall"].equals(one.impacts["wall"])
        off = hits.select(columns) - one.impacts.select(columns)
        assert np.abs(off.to_numpy()[:5]).max() < 1e-13
        assert np.abs(off.to_numpy()).max() < worst
        rides = run.episodes.filter(absorber=k)
        times = ("stick_time", "release_time")
        off = rides.select(times) - one.episodes.select(times)
        assert np.abs(off.drop_nulls().to_numpy()).max(initial=0.0) < worst
    sums = ("energy_initial", "energy_impacts", "energy_viscous", "energy_final")
    expected = one.summary.select(sums).row(0)
    assert run.summary.select(sums).row(0) == pytest.approx(expected, rel=0, abs=worst)


@pytest.mark.parametrize("first", [True, False])
def test_a_mass_that_meets_no_stop_changes_no_bit(row: Row, first: bool) -> None:
    far = Mass(0.3, 0.5, 1e6, 0.2, -0.3)
    alone = row.run()
    masses = (far, *row.masses) if first else (*row.masses, far)
    run = replace(row, masses=masses).run()
    for name in ("impacts", "episodes"):
        found = getattr(run, name).with_columns(pl.col("absorber") - int(first))
        expected = getattr(alone, name)
        assert_frame_equal(found, expected, check_exact=True, check_dtypes=False)
    assert run.envelope.equals(alone.envelope)


def test_a_list_of_one_is_that_one() -> None:
    """To rounding: the first impacts are those of the absorber without a list."""
    for mass in (*FREE.masses, Mass(0.15, 0.4, 0.15)):
        row = replace(FREE, masses=(mass,), duration=8.0)
        start = iva.Start(
            displacement=1.2, velocity=0.3, gap_displacement=mass.y, gap_velocity=mass.w
        )
        primary = iva.Primary(damping_ratio=0.01)
        one = iva.simulate(mass.absorber(), primary, start=start, duration=8.0)
        run = row.run()
        assert set(run.impacts["absorber"]) == {0}
        assert run.impacts["wall"].equals(one.impacts["wall"])
        off = (run.impacts["time"] - one.impacts["time"]).abs().max()
        assert off is not None
        assert off < 1e-12  # type: ignore[operator]
        assert run.episodes.height == one.episodes.height


@pytest.mark.parametrize("row", [FREE, STICKING], ids=["free", "sticking"])
def test_the_order_of_the_list_is_only_a_number(row: Row) -> None:
    """To rounding, for sums over the masses are made in their order."""
    run = row.run()
    count = len(row.masses)
    for order in itertools.permutations(range(count)):
        other = replace(row, masses=tuple(row.masses[k] for k in order)).run()
        number = pl.col("absorber").replace_strict(dict(enumerate(order)), return_dtype=pl.Int64)
        for name, by in (("impacts", "time"), ("episodes", "stick_time"), ("absorbers", "point")):
            left_out = [name[:-1]] if name != "absorbers" else []  # their number in the run
            found, expected = (
                frame.sort(by, "absorber").drop(left_out)
                for frame in (getattr(other, name).with_columns(number), getattr(run, name))
            )
            assert_frame_equal(found, expected, rel_tol=0, abs_tol=1e-13)
        assert_frame_equal(other.envelope, run.envelope, rel_tol=0, abs_tol=1e-13)


def test_the_ledger_closes(row: Row) -> None:
    run = row.run()
    book = run.summary.row(0, named=True)
    size = max(book["energy_initial"], abs(book["energy_work"]), book["energy_final"])
    assert abs(book["energy_residual"]) < 1e-14 * max(size, 1.0)
    left = book["energy_initial"] + book["energy_work"] - book["energy_final"]
    assert left == pytest.approx(
        book["energy_impacts"] + book["energy_viscous"], rel=0, abs=1e-13 * max(size, 1.0)
    )
    begin = row.x**2 + row.v**2 + sum(m.mu * (row.v + m.w) ** 2 for m in row.masses)
    assert book["energy_initial"] == pytest.approx(begin / 2, rel=1e-14)
    end = run.at([row.duration]).sort("absorber")
    u = end["velocity"] + end["gap_velocity"]
    mus = np.array([mass.mu for mass in row.masses])
    energy = end["displacement"][0] ** 2 + end["velocity"][0] ** 2 + (mus * u.to_numpy() ** 2).sum()
    assert book["energy_final"] == pytest.approx(energy / 2, rel=1e-12)


@pytest.mark.parametrize("row", [FREE, PUSHED, SHAKEN], ids=["free", "pushed", "shaken"])
def test_momentum_and_energy_of_each_impact(row: Row) -> None:
    """Of velocities of the size of 1, where nothing rides; two masses of a row hit at once."""
    run = row.run()
    assert run.episodes.height == 0
    e = [
        row.masses[k].restitution(wall) for k, wall in run.impacts.select("absorber", "wall").rows()
    ]
    before, after = pl.col("velocity_before"), pl.col("velocity_after")
    of, to = pl.col("absorber_velocity_before"), pl.col("absorber_velocity_after")
    mus = dict(enumerate(mass.mu for mass in row.masses))
    mu, w = pl.col("absorber").replace_strict(mus), pl.col("approach_velocity")
    hits = run.impacts.with_columns(mu=mu, e=pl.Series(e), rebound=to - after, apart=of - before)
    assert (hits["wall"] * hits["approach_velocity"] > 0).all()
    assert hits.select((pl.col("apart") - w).abs().max()).item() < 1e-15
    assert hits.select((pl.col("rebound") + pl.col("e") * w).abs().max()).item() < 1e-15
    at_once = hits.group_by("time").agg(
        size=pl.len(),
        kept=(after - before).first() + (mu * (to - of)).sum(),
        lost=(before**2 - after**2).first() / 2
        + (mu * (of**2 - to**2)).sum() / 2
        - pl.col("energy_loss").sum(),
    )
    assert at_once["size"].max() == (2 if row is PUSHED else 1)
    assert at_once.select(pl.col("kept", "lost").abs().max()).row(0) < (1e-15, 1e-15)


def test_the_table_of_absorbers_agrees_with_the_others(row: Row) -> None:
    run = row.run()
    table: pl.DataFrame = run.absorbers
    assert table["absorber"].to_list() == list(range(len(row.masses)))
    totals = run.summary.row(0, named=True)
    assert table["effective_impacts"].sum() == totals["effective_impacts"]
    for name in ("approach_speed_max", "impulse_max"):
        assert table[name].max() == totals[name]
    fastest = run.impacts.group_by("absorber").agg(pl.col("approach_velocity").abs().max()).rows()
    assert dict(table.select("absorber", "approach_speed_max").rows()) == dict(fastest)
    for name in ("impacts", "episodes"):
        assert table[name].sum() == totals[name]
        counted = getattr(run, name)["absorber"].value_counts()
        by = dict.fromkeys(range(len(row.masses)), 0) | dict(counted.rows())
        assert dict(table.select("absorber", name).rows()) == by
    assert table["energy_impacts"].sum() == pytest.approx(totals["energy_impacts"], rel=1e-13)
    assert table["time_stuck"].sum() == pytest.approx(totals["time_stuck"], rel=1e-13)
    rides = run.episodes.with_columns(pl.col("release_time").fill_null(row.duration))
    ride = pl.col("release_time") - pl.col("stick_time")
    stuck = dict(rides.group_by("absorber").agg(ride.sum()).rows())
    for k, time in table.select("absorber", "time_stuck").rows():
        assert time == pytest.approx(stuck.get(k, 0.0), rel=0, abs=1e-12)
    if not stuck:
        losses = dict(run.impacts.group_by("absorber").agg(pl.col("energy_loss").sum()).rows())
        assert dict(table.select("absorber", "energy_impacts").rows()) == pytest.approx(losses)
