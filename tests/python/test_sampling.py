"""Points that are no grid: from which distributions, and the same from command and package."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st
from polars.testing import assert_frame_equal
from scipy import stats

import iva
from iva import _iva
from iva.sampling import LatinHypercube, LogNormal, Normal, Random, Sobol, Uniform

STUDY = """
version = 1
[primary]
damping_ratio = 0.01
[absorber]
kind = "siva"
mass_ratio = 0.1
restitution = 0.5
relative_clearance = 0.6
[start]
displacement = 1.0
[run]
periods = 3
tables = ["summary"]
"""


def sweep(over: Any, sampling: Any, **more: Any) -> iva.Table:
    return iva.sweep(
        iva.Siva(mass_ratio=0.1, restitution=0.5, relative_clearance=0.6),
        iva.Primary(damping_ratio=0.01),
        over=over,
        sampling=sampling,
        start=iva.Start(displacement=1.0),
        periods=3,
        **more,
    )


def command(folder: Path, sections: str, code: int = 0) -> Path:
    (folder / "study.toml").write_text(STUDY + sections, encoding="utf-8")
    out = folder / "out"
    args = ["sweep", str(folder / "study.toml"), "--out", str(out), "--quiet"]
    assert _iva.main(["iva", *args]) == code
    return out


def test_sobol_points_are_those_of_scipy() -> None:
    names = [
        "mass_ratio", "length", "relative_clearance", "damping_ratio", "displacement",
        "start.velocity", "frequency_ratio", "gap_velocity", "frequency_hz", "inertia_ratio",
    ]  # fmt: skip
    ours = iva.sampling.points(
        {name: Uniform(1.0, 2.0) for name in names}, Sobol(4096, scramble=False)
    )
    theirs = stats.qmc.Sobol(len(names), scramble=False).random(4096)
    # From 1 to 2, which every one of them may be; the sum is exact.
    assert np.array_equal(ours.drop("point").to_numpy(), 1.0 + theirs)


def test_scrambled_sobol_points_are_as_even_as_those_of_scipy() -> None:
    names = ["mass_ratio", "restitution", "relative_clearance"]
    over = {name: Uniform(0.0, 1.0) for name in names}
    ours = iva.sampling.points(over, Sobol(1024, seed=3)).drop("point").to_numpy()
    theirs = stats.qmc.Sobol(3, scramble=True, rng=3).random(1024)
    random = np.random.default_rng(3).random((1024, 3))
    even, uneven = (stats.qmc.discrepancy(points) for points in (theirs, random))
    assert stats.qmc.discrepancy(ours) < 2 * even < uneven / 4


def test_random_points_are_those_of_numpy() -> None:
    over = {"mass_ratio": Uniform(0.0, 1.0), "restitution": Uniform(0.0, 1.0)}
    points = iva.sampling.points(over, Random(1000, seed=7))
    for axis, name in enumerate(over):
        generator = np.random.Generator(np.random.Philox(key=[7, axis]))
        # Ours are never 0: the last of their 53 bits is set.
        assert np.abs(points[name].to_numpy() - generator.random(1000)).max() <= 2**-53


def test_a_latin_hypercube_has_a_point_in_every_slice() -> None:
    over = {"mass_ratio": Uniform(0.0, 1.0), "restitution": Normal(0.5, 0.1)}
    points = iva.sampling.points(over, LatinHypercube(500, seed=1))
    slices = np.floor(500 * points["mass_ratio"].to_numpy())
    assert sorted(slices) == list(range(500))
    slices = np.floor(500 * stats.norm.cdf(points["restitution"].to_numpy(), 0.5, 0.1))
    assert sorted(slices) == list(range(500))


@pytest.mark.parametrize(
    ("distribution", "frozen"),
    [
        (Uniform(-2.0, 3.0), stats.uniform(-2.0, 5.0)),
        (Normal(0.5, 0.1), stats.norm(0.5, 0.1)),
        (Normal(0.9, 0.1, low=0.8, high=1.0), stats.truncnorm(-1.0, 1.0, 0.9, 0.1)),
        (Normal(0.9, 0.1, high=1.0), stats.truncnorm(-math.inf, 1.0, 0.9, 0.1)),
        (LogNormal(0.1, 0.25), stats.lognorm(0.25, scale=0.1)),
    ],
)
def test_distributions_are_those_of_scipy(distribution: Any, frozen: Any) -> None:
    # start.velocity takes any number; one axis of plain points is i / 1024 in another order.
    sample = Sobol(1024, seed=5)
    found = iva.sampling.points({"start.velocity": distribution}, sample)["start.velocity"]
    unit = iva.sampling.points({"start.velocity": Uniform(0.0, 1.0)}, sample)["start.velocity"]
    np.testing.assert_allclose(found.to_numpy(), frozen.ppf(unit.to_numpy()), rtol=1e-12)


@pytest.mark.parametrize(
    ("sections", "over", "sampling"),
    [
        (
            "[sampling]\nmethod = 'sobol'\ncount = 37\nseed = 9\n[sweep]\n"
            "relative_clearance = { low = 0.4, high = 1.2 }\n"
            "restitution = { distribution = 'normal', mean = 0.6, deviation = 0.1, high = 1.0 }\n",
            {"relative_clearance": Uniform(0.4, 1.2), "restitution": Normal(0.6, 0.1, high=1.0)},
            Sobol(37, seed=9),
        ),
        (
            "[sampling]\nmethod = 'sobol'\ncount = 8\nscramble = false\n[sweep]\n"
            "absorber.mass_ratio = { low = 0.05, high = 0.2 }\n",
            {"absorber.mass_ratio": Uniform(0.05, 0.2)},
            Sobol(8, scramble=False),
        ),
        (
            "[sampling]\nmethod = 'latin_hypercube'\ncount = 20\n[sweep]\n"
            "mass_ratio = { distribution = 'lognormal', median = 0.1, sigma = 0.3 }\n",
            {"mass_ratio": LogNormal(0.1, 0.3)},
            LatinHypercube(20),
        ),
        (
            "[sampling]\nmethod = 'random'\ncount = 20\nseed = 4\n[sweep]\n"
            "mass_ratio = { distribution = 'uniform', low = 0.1, high = 0.3 }\n",
            {"mass_ratio": Uniform(0.1, 0.3)},
            Random(20, seed=4),
        ),
        (
            "[sampling]\nmethod = 'zip'\n[sweep]\n"
            "mass_ratio = [0.1, 0.2]\nrestitution = [0.3, 0.9]",
            {"mass_ratio": [0.1, 0.2], "restitution": [0.3, 0.9]},
            "zip",
        ),
        (
            "[sampling]\nmethod = 'grid'\n[sweep]\n"
            "mass_ratio = [0.1, 0.2]\nrestitution = [0.3, 0.9]",
            {"mass_ratio": [0.1, 0.2], "restitution": [0.3, 0.9]},
            "grid",
        ),
    ],
)
def test_command_and_package_run_the_same_points(
    tmp_path: Path, sections: str, over: Any, sampling: Any
) -> None:
    out = command(tmp_path, sections)
    table = sweep(over, sampling)
    assert iva.read(out) == table
    assert_frame_equal(table.summary.select("point", *over), iva.sampling.points(over, sampling))
    # What both write is the same, and the resolved study gives it again.
    sweep(over, sampling, out=tmp_path / "package")
    assert _iva.main(
        ["iva", "sweep", str(out / "study.toml"), "--out", str(tmp_path / "again"), "--quiet"]
    ) == 0  # fmt: skip
    for folder in ("package", "again"):
        for name in ("study.toml", "manifest.json", "summary/part-00000.parquet"):
            assert (tmp_path / folder / name).read_bytes() == (out / name).read_bytes(), name


@given(rows=st.lists(st.tuples(st.floats(0.01, 1.0), st.floats(0.0, 1.0)), min_size=1, max_size=9))
def test_a_frame_and_its_columns_in_step_are_one(rows: list[tuple[float, float]]) -> None:
    frame = pl.DataFrame(rows, schema=["mass_ratio", "restitution"], orient="row")
    columns = {name: frame[name] for name in frame.columns}
    table = sweep(frame, "grid")
    assert table == sweep(columns, "zip")
    assert table.summary.select("mass_ratio", "restitution").rows() == rows


@pytest.mark.parametrize("ending", ["parquet", "arrow", "csv"])
def test_points_of_a_file(tmp_path: Path, ending: str) -> None:
    frame = pl.DataFrame({"mass_ratio": [0.1, 0.2, 0.05], "max_impacts": [5, 50, 500]})
    file = tmp_path / f"points.{ending}"
    if ending == "parquet":
        frame.write_parquet(file)
    elif ending == "arrow":
        frame.write_ipc(file)
    else:
        frame.write_csv(file)
    out = command(tmp_path, f"[sampling]\npoints = '{file.name}'\n")
    assert iva.read(out) == sweep(frame, "grid")
    assert str(file) in (out / "study.toml").read_text(encoding="utf-8")


def test_many_points_of_a_frame_are_written_beside_the_tables(tmp_path: Path) -> None:
    frame = pl.DataFrame({"mass_ratio": np.linspace(0.01, 0.3, 3000)})
    out = tmp_path / "out"
    sweep(frame, "grid", out=out)
    points = pl.read_parquet(out / "inputs" / "points.parquet")
    assert_frame_equal(points, frame)
    again = tmp_path / "again"
    assert _iva.main(["iva", "sweep", str(out / "study.toml"), "--out", str(again), "--quiet"]) == 0
    assert iva.read(again) == iva.read(out)
    sweep(frame, "grid", out=out, overwrite=True)
    sweep(frame, "grid", out=out, resume=True)
    with pytest.raises(ValueError, match="numbers of a record or of the points differ"):
        sweep(frame * 1.01, "grid", out=out, resume=True)
    # Replaced by itself: the points are those of the folder that goes.
    study = str(out / "study.toml")
    args = ["iva", "sweep", study, "--out", str(out), "--quiet", "--overwrite"]
    assert _iva.main(args) == 0
    assert iva.read(out) == iva.read(again)
    assert_frame_equal(pl.read_parquet(out / "inputs" / "points.parquet"), frame)
    sweep(frame[:5], "grid", out=out, overwrite=True)
    assert not (out / "inputs").exists()


def test_a_file_of_the_user_is_no_input(tmp_path: Path) -> None:
    mine = tmp_path / "inputs" / "points.parquet"
    mine.parent.mkdir()
    mine.write_text("mine", encoding="utf-8")
    frame = pl.DataFrame({"mass_ratio": np.linspace(0.01, 0.3, 3000)})
    with pytest.raises(ValueError, match=r"points\.parquet was not written by iva"):
        sweep(frame, "grid", out=tmp_path)
    assert mine.read_text(encoding="utf-8") == "mine"
    sweep(frame[:9], "grid", out=tmp_path)
    sweep(frame[:8], "grid", out=tmp_path, overwrite=True)
    assert mine.read_text(encoding="utf-8") == "mine"


FILES: list[tuple[str, str, str]] = [
    ("points.csv", "mass_ratio\n0.1\nmany\n", "many"),
    ("points.csv", 'mass_ratio\n0.1\n""\n', "no number in row 2"),
    ("points.csv", "mass_ratio,restitution\n0.1,0.5\n0.2\n", "incorrect number of fields"),
    ("points.csv", "mass_ratio\n0.1\n-0.1\n", "sweep.mass_ratio[1] = -0.1"),
    ("points.csv", "mass\n0.1\n", "write `primary.mass` or `absorber.mass`"),
    ("points.csv", "mass_ratio,mass_ratio\n0.1,0.2\n", "two columns `mass_ratio`"),
    ("points.csv", "mass_ratio,absorber.mass_ratio\n0.1,0.2\n", "sets the same quantity"),
    ("points.csv", "length\n0.1\n", "piva"),
    ("points.csv", "mass_ratio\n", "no rows"),
    ("points.csv", "", "no rows"),
    ("points.parquet", "no parquet", "Parquet"),
    ("points.arrow", "no arrow", "not an Arrow file"),
    ("points.xlsx", "", ".parquet, .arrow or .csv"),
]


@pytest.mark.parametrize(("name", "content", "said"), FILES)
def test_a_malformed_file_of_points_is_refused(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], name: str, content: str, said: str
) -> None:
    (tmp_path / name).write_text(content, encoding="utf-8")
    out = command(tmp_path, f"[sampling]\npoints = '{name}'\n", code=2)
    error = capfd.readouterr().err
    assert said in error
    assert name in error
    assert not out.exists()


SECTIONS: list[tuple[str, str]] = [
    ("[sampling]\npoints = 'nowhere.csv'", "it cannot be read"),
    ("[sampling]\npoints = 5", "give the name of a file, in quotes"),
    (
        "[sampling]\npoints = 'a.csv'\n[sweep]\nmass_ratio = [0.1]",
        "remove this section, or that key",
    ),
    ("[sampling]\npoints = 'a.csv'\nmethod = 'grid'", "a file has its own points"),
    ("[sampling]\nmethod = 'sobol'\ncount = 4", "give the section [sweep]"),
    ("[sampling]\nmethod = 'sobel'", 'did you mean "sobol"'),
    ("[sampling]\nseeds = 1", "did you mean `seed`"),
    ("[sampling]\ncount = 4\n[sweep]\nmass_ratio = [0.1]", "sampling.count: only the methods"),
    ("[sampling]\nmethod = 'random'\ncount = 4\nscramble = true", 'only the method "sobol" has it'),
    (
        "[sampling]\nmethod = 'random'\n[sweep]\nmass_ratio = { low = 0.1, high = 0.2 }",
        "sampling.count is missing",
    ),
    ("[sampling]\nmethod = 'sobol'\ncount = 0", "whole number from 1 to 4294967296"),
    ("[sampling]\nmethod = 'sobol'\ncount = 4\nseed = -1", "whole number from 0 to"),
    (
        "[sampling]\nmethod = 'latin_hypercube'\ncount = 10_000_001\n[sweep]\n"
        "mass_ratio = { low = 0.1, high = 0.2 }",
        "whole number from 1 to 10000000",
    ),
    (
        "[sampling]\nmethod = 'random'\ncount = 4\n[sweep]\nmass_ratio = [0.1]",
        "give a distribution",
    ),
    ("[sweep]\nmass_ratio = { low = 0.1, high = 0.2 }", "start, stop, count"),
    (
        "[sampling]\nmethod = 'random'\ncount = 4\n[sweep]\n"
        "mass_ratio = { distribution = 'gaussian', mean = 0.1 }",
        'give one of "uniform", "normal", "lognormal"',
    ),
    (
        "[sampling]\nmethod = 'random'\ncount = 4\n[sweep]\n"
        "mass_ratio = { distribution = 'normal', mean = 0.1 }",
        "needs mean and deviation",
    ),
    (
        "[sampling]\nmethod = 'random'\ncount = 4\n[sweep]\nmass_ratio = { low = 0.1, hgih = 0.2 }",
        "sweep.mass_ratio.hgih",
    ),
    (
        "[sampling]\nmethod = 'random'\ncount = 4\n[sweep]\nmass_ratio = { low = 0.2, high = 0.1 }",
        "sweep.mass_ratio.high",
    ),
    (
        "[sampling]\nmethod = 'random'\ncount = 50\n[sweep]\n"
        "restitution = { distribution = 'normal', mean = 1.0, deviation = 0.1 }",
        "absorber.restitution",
    ),
    (
        "[sampling]\nmethod = 'sobol'\ncount = 50\nscramble = false\n[sweep]\n"
        "restitution = { distribution = 'normal', mean = 0.5, deviation = 0.01 }",
        "leave scramble at true",
    ),
    (
        "[sampling]\nmethod = 'zip'\n[sweep]\nmass_ratio = [0.1]\nrestitution = [0.1, 0.2]",
        "one length",
    ),
    (
        "[sampling]\nmethod = 'zip'\n[sweep]\nmass_ratio = [0.1]\nabsorber.mass = [0.1]",
        "sets the same quantity",
    ),
]


@pytest.mark.parametrize(("sections", "said"), SECTIONS)
def test_a_section_that_makes_no_sample_is_refused(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], sections: str, said: str
) -> None:
    out = command(tmp_path, sections, code=2)
    error = capfd.readouterr().err
    assert said in error
    assert "study.toml" in error
    assert not out.exists()


ARGUMENTS: list[tuple[Any, Any, type[Exception], str]] = [
    ({"mass_ratio": Uniform(0.1, 0.2)}, "grid", ValueError, "a distribution needs a sample"),
    ({"mass_ratio": [0.1]}, Sobol(4), TypeError, "with a sample give a distribution"),
    ({"mass_ratio": [0.1]}, "sobol", ValueError, "'grid', 'zip' or a sample"),
    ({"mass_ratio": [0.1]}, 5, TypeError, "'grid', 'zip' or a sample"),
    ({"mass_ratio": [0.1]}, np.array([0.1, 0.2]), TypeError, "'grid', 'zip' or a sample"),
    *(
        (over, frame, TypeError, f"sampling is a {given}: give 'grid', 'zip' or a sample {goes}")
        for over in ({"mass_ratio": [0.1]}, pl.DataFrame({"mass_ratio": [0.1]}))
        for frame, given in (
            (pl.DataFrame({"mass_ratio": [0.1, 0.2]}), "DataFrame of polars"),
            (pl.LazyFrame({"mass_ratio": [0.1, 0.2]}), "LazyFrame of polars"),
        )
        for goes in ("of iva.sampling; a frame of points goes to over",)
    ),
    (pl.DataFrame({"mass_ratio": [0.1]}), 5, TypeError, "'grid', 'zip' or a sample"),
    (pl.DataFrame({"mass_ratio": [0.1]}), "lhs", ValueError, "sampling = 'lhs': give 'grid', "),
    ({"mass_ratio": Uniform(0.2, 0.1)}, Sobol(4), ValueError, "sweep.mass_ratio.high = 0.1"),
    ({"mass_ratio": Normal(0.2, 0.0)}, Sobol(4), ValueError, "sweep.mass_ratio.deviation = 0"),
    ({"mas_ratio": Uniform(0.1, 0.2)}, Sobol(4), ValueError, "did you mean `mass_ratio`"),
    (pl.DataFrame({"mass_ratio": [0.1]}), Sobol(4), ValueError, "a frame has its points"),
    (pl.DataFrame({"mass_ratio": ["a"]}), "grid", TypeError, "column 'mass_ratio' of String"),
    (pl.DataFrame({"mass_ratio": [0.1, None]}), "grid", ValueError, "no number in row 1"),
    (pl.DataFrame(), "grid", ValueError, "a row is a point"),
    ([1, 2], "grid", TypeError, "a mapping from field names"),
    ({"mass_ratio": [0.1], "restitution": [0.1, 0.2]}, "zip", ValueError, "of one length"),
]


@pytest.mark.parametrize(("over", "sampling", "error", "said"), ARGUMENTS)
def test_arguments_that_make_no_sample_are_refused(
    over: Any, sampling: Any, error: type[Exception], said: str
) -> None:
    with pytest.raises(error, match=said.replace("[", r"\[")):
        sweep(over, sampling)


@pytest.mark.parametrize("count", [0, 2**32 + 1, 1.5, True, "4"])
def test_a_count_is_a_whole_number(count: Any) -> None:
    with pytest.raises((TypeError, ValueError), match=r"sampling\.count = .*: give a whole number"):
        Sobol(count)


def test_samples_are_the_same_for_any_number_of_threads() -> None:
    over = {"relative_clearance": Normal(0.8, 0.1), "restitution": Uniform(0.2, 0.9)}
    for sample in (Sobol(999), LatinHypercube(999), Random(999)):
        assert sweep(over, sample, threads=1) == sweep(over, sample, threads=3)
