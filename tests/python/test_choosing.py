"""Best points, fronts and neighbourhoods, against definitions written out in plain Python."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st

import iva


@pytest.fixture(scope="module")
def table() -> iva.Table:
    """Return a small map with points that never settle among them."""
    return iva.sweep(
        iva.Siva(mass_ratio=0.1, restitution=0.6),
        iva.Primary(damping_ratio=0.01),
        over={
            "relative_clearance": np.linspace(0.2, 2.2, 21),
            "mass_ratio": np.linspace(0.02, 0.2, 4),
        },
        start=iva.Start(displacement=1.0),
        periods=25,
    )


def test_best_is_the_top_of_the_sorted_table(table: iva.Table) -> None:
    settled = table.summary.drop_nulls("settling_time_5")
    assert 0 < settled.height < table.summary.height
    found = iva.best(table, count=7)
    assert found.equals(settled.sort("settling_time_5", maintain_order=True).head(7))
    damped = iva.best(table.summary, "damping_ratio_3", count=1)
    assert damped["damping_ratio_3"].item() == table.summary["damping_ratio_3"].max()


def test_conditions_narrow_the_choice(table: iva.Table) -> None:
    light = pl.col("mass_ratio") < 0.1
    found = iva.best(table, where=[light, pl.col("impacts") > 3])
    assert found.height
    assert found.filter(light & (pl.col("impacts") > 3)).equals(found)
    assert iva.pareto(table, ["settling_time_5"], where=light)["mass_ratio"].item() < 0.1


def test_lazy_frames_stay_lazy(table: iva.Table, tmp_path: Path) -> None:
    table.summary.write_parquet(tmp_path / "part-0.parquet")
    lazy = pl.scan_parquet(tmp_path / "*.parquet")
    pairs = [
        (iva.best(lazy), iva.best(table)),
        (
            iva.pareto(lazy, ["settling_time_5", "mass_ratio"]),
            iva.pareto(table, ["settling_time_5", "mass_ratio"]),
        ),
        (
            iva.robust(lazy, within={"mass_ratio": 0.06}),
            iva.robust(table, within={"mass_ratio": 0.06}).summary,
        ),
    ]
    for late, now in pairs:
        assert isinstance(late, pl.LazyFrame)
        assert late.collect().equals(now)


@given(
    st.lists(st.tuples(*[st.one_of(st.none(), st.integers(0, 6).map(float))] * 3), max_size=40),
    st.integers(1, 3),
)
def test_a_front_is_what_nothing_beats(rows: list[tuple[float | None, ...]], columns: int) -> None:
    names = ["time", "damping_ratio_3", "cost"][:columns]
    schema = dict.fromkeys(names, pl.Float64)
    chosen = [row[:columns] for row in rows]
    frame = pl.DataFrame(chosen, schema, orient="row").with_row_index("at")
    # Of a damping ratio the larger is the better.
    signs = [-1 if name.startswith("damping") else 1 for name in names]
    points = [
        (at, [sign * value for sign, value in zip(signs, row, strict=True)])
        for at, *row in frame.rows()
        if None not in row
    ]

    def beats(a: list[float], b: list[float]) -> bool:
        return a != b and all(x <= y for x, y in zip(a, b, strict=True))

    truth = {at for at, own in points if not any(beats(other, own) for _, other in points)}
    found = iva.pareto(frame, names)
    assert set(found["at"]) == truth
    assert found[names[0]].is_sorted(descending=signs[0] < 0)


def test_the_worst_and_quantiles_of_neighbours(table: iva.Table) -> None:
    for by, larger in (("settling_time_5", False), ("damping_ratio_1", True)):
        judged = iva.robust(table, by, within={"relative_clearance": 0.2}, quantiles=[0.25])
        found = judged.summary
        assert found.drop("neighbours", f"{by}_worst", f"{by}_q25").equals(table.summary)
        rows = table.summary.select("relative_clearance", "mass_ratio", by).rows()
        for (d, mass, _), own in zip(rows, found.iter_rows(named=True), strict=True):
            near = [v for c, m, v in rows if m == mass and abs(c - d) <= 0.2 + 1e-9]
            bad = sorted(math.inf if v is None else (-v if larger else v) for v in near)
            worst, quarter = bad[-1], bad[math.ceil(0.25 * (len(bad) - 1))]
            for name, value in (("worst", worst), ("q25", quarter)):
                shown = None if value == math.inf else (-value if larger else value)
                assert own[f"{by}_{name}"] == shown
            assert own["neighbours"] == len(near)


def test_neighbours_in_two_directions(table: iva.Table) -> None:
    found = iva.robust(table, within={"relative_clearance": 0.1, "mass_ratio": 0.06}, quantiles=())
    counts = found.summary["neighbours"].to_list()
    inner = [[2 + (0 < i < 20), 2 + (0 < j < 3)] for i, j in itertools.product(range(21), range(4))]
    assert counts == [a * b for a, b in inner]


def test_neighbours_of_scattered_points() -> None:
    rng = np.random.default_rng(3)
    drawn = {"gap": rng.random(200), "mass": rng.random(200)}
    value = rng.random(200)
    points = pl.DataFrame({**drawn, "outcome": ["finished"] * 200, "residual_amplitude": value})
    found = iva.robust(points, "residual_amplitude", within={"gap": 0.1, "mass": 0.2})
    near = (abs(drawn["gap"][:, None] - drawn["gap"]) <= 0.1) & (
        abs(drawn["mass"][:, None] - drawn["mass"]) <= 0.2
    )
    assert found["neighbours"].to_list() == near.sum(axis=1).tolist()
    worst = np.where(near, value, 0).max(axis=1)
    assert found["residual_amplitude_worst"].to_list() == worst.tolist()


def test_relative_distances_and_points_of_interest(table: iva.Table) -> None:
    few = (pl.col("mass_ratio") == 0.2) & (pl.col("relative_clearance") > 0.5)
    found = iva.robust(table, within={"relative_clearance": "20%"}, quantiles=(), where=few)
    assert found.swept == ("relative_clearance",)
    assert found.units == table.units
    rows = table.summary.filter(pl.col("mass_ratio") == 0.2)["relative_clearance"].to_list()
    of_interest = [d for d in rows if d > 0.5]
    assert found.summary["relative_clearance"].to_list() == of_interest
    near = [sum(abs(c - d) <= 0.2 * d * (1 + 1e-9) for c in rows) for d in of_interest]
    assert found.summary["neighbours"].to_list() == near
    assert len(set(near)) > 1


def test_bad_input_gets_one_sentence(table: iva.Table) -> None:
    slips: list[tuple[Callable[[], object], str]] = [
        (lambda: iva.best(table, "settling_time"), "by = 'settling_time'"),
        (lambda: iva.robust(table, "settling_tme_5", within={}), "by = 'settling_tme_5'"),
        (lambda: iva.pareto(table, ["impacts", "setling_time_5"]), "by = 'setling_time_5'"),
        (lambda: iva.pareto(table, [], larger=["Settling_Time_5"]), "larger = 'Settling_Time_5'"),
    ]
    for call, said in slips:
        with pytest.raises(
            ValueError,
            match=rf"^{said}: no such column; did you mean `settling_time_5`\? Others are point, "
            r"relative_clearance, mass_ratio, impacts, [a-z_, ]* and \d\d more$",
        ):
            call()
    with pytest.raises(ValueError, match=r"^by = 'zeta': no such column; there is point, .*stroke"):
        iva.best(table, "zeta")
    with pytest.raises(
        ValueError, match=r"^within\['mass'\]: no such column; did you mean `mass_r"
    ):
        iva.robust(table, within={"mass": 0.1})
    with pytest.raises(TypeError, match="3 is no name of a column: give a text"):
        iva.robust(table, within={3: 0.1})  # type: ignore[dict-item]
    with pytest.raises(TypeError, match="the column 'outcome' is of String: give one of numbers"):
        iva.best(table, "outcome")
    with pytest.raises(ValueError, match="count = 0: ask for at least one point"):
        iva.best(table, count=0)
    with pytest.raises(ValueError, match="name at least one column"):
        iva.pareto(table, [])
    with pytest.raises(ValueError, match="'impacts' was not swept; there is relative_clearance, "):
        iva.robust(table, within={"impacts": 1})
    with pytest.raises(ValueError, match=r"within\['mass_ratio'\] = '20': give a percentage below"):
        iva.robust(table, within={"mass_ratio": "20"})
    with pytest.raises(ValueError, match="'mass_ratio' = nan: give a number of 0 or more"):
        iva.robust(table, within={"mass_ratio": math.nan})
    with pytest.raises(ValueError, match="quantiles: 90 does not lie between 0 and 1"):
        iva.robust(table, within={"mass_ratio": 0.1}, quantiles=[90])


def test_the_best_of_what_is_robust_is_by_its_last_column() -> None:
    points = pl.DataFrame(
        {
            "point": [0, 1, 2, 3],
            "gap": [1.0, 2.0, 3.0, 4.0],
            "outcome": ["finished"] * 4,
            "settling_time_5": [9.0, 1.0, 9.0, 5.0],
            "damping_ratio_3": [0.1, 0.5, 0.4, 0.3],
        }
    )
    judged = iva.robust(points, within={"gap": 1.0}, quantiles=[0.9])
    assert iva.best(judged, count=1)["gap"].to_list() == [1.0]
    assert iva.best(judged, "settling_time_5", count=1)["gap"].to_list() == [2.0]
    assert iva.best(judged.drop("settling_time_5_q90"), count=1)["gap"].to_list() == [1.0]
    larger = iva.robust(points, "damping_ratio_3", within={"gap": 1.0}, quantiles=[])
    assert iva.best(larger)["damping_ratio_3_worst"].to_list() == [0.3, 0.3, 0.1, 0.1]
    assert iva.best(points, count=1)["gap"].to_list() == [2.0]


def test_a_part_of_a_sweep_is_a_table() -> None:
    table = iva.sweep(
        iva.Siva(mass_ratio=0.1),
        iva.Primary(damping_ratio=0.01),
        over={"relative_clearance": [0.4, 0.6, 0.8], "restitution": [0.5, 0.7]},
        start=iva.Start(displacement=1.0),
        periods=10,
        tables=("summary", "impacts"),
    )
    part = table.filter(pl.col("restitution") == 0.7, pl.col("relative_clearance") > 0.5)
    assert part.swept == ("relative_clearance",)
    assert part.summary.equals(table.summary[[3, 5]])
    assert part.impacts.equals(table.impacts.filter(pl.col("point").is_in([3, 5])))
    assert part.impacts.height > 2
    assert part.units["summary"]["restitution"] == "1"
    assert iva.robust(part, within={"relative_clearance": 0.2}).summary.height == 2
