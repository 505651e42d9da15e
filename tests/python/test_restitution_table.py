"""The restitution by a table of points over the approach speed.

Numbers come from `numpy.interp` (linear between points, constant outside, as docs/study-file.md
says), from runs with a number in the place of a table of that number, and from the power law.
"""

from __future__ import annotations

import copy
import pickle
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import iva
from iva import _iva, dynamics, scenes

PRIMARY = iva.Primary(damping_ratio=0.01)
START = iva.Start(displacement=1.0)
POINTS = [[0.1, 0.9], [0.5, 0.7], [1.5, 0.4]]
TABLES = ("summary", "impacts", "episodes", "envelope", "absorbers")


def siva(**more: Any) -> iva.Siva:
    """Return a free mass with some law of restitution."""
    return iva.Siva(**({"mass_ratio": 0.1, "clearance": 0.6} | more))


def run(absorber: Any, **more: Any) -> iva.Run:
    """Return a decay."""
    return iva.simulate(absorber, PRIMARY, start=START, **({"periods": 20} | more))


def rebounds(hits: pl.DataFrame) -> tuple[np.ndarray, np.ndarray]:
    """Return approach speeds and what each rebound is of its approach."""
    after = hits["absorber_velocity_after"] - hits["velocity_after"]
    speeds = hits["approach_velocity"].abs().to_numpy()
    return speeds, (-after / hits["approach_velocity"]).to_numpy()


def interpolated(speeds: np.ndarray, points: Any = POINTS) -> np.ndarray:
    """Return the restitution at some speeds."""
    at, e = np.transpose(points)
    found: np.ndarray = np.interp(speeds, at, e)
    return found


@pytest.mark.parametrize(
    ("primary", "size", "periods"),
    [
        (PRIMARY, 1.0, 20),
        (iva.Primary(natural_frequency=3.0, damping_ratio=0.01), 1.0, 20),
        (iva.Primary(mass=2.0, stiffness=800.0, damping=0.8), 0.1, 20),
    ],
)
def test_every_rebound_is_that_of_the_table(
    primary: iva.Primary, size: float, periods: float
) -> None:
    """In all units: below the first point, between points and above the last one."""
    found = iva.simulate(
        siva(restitution_table=POINTS, clearance=0.6 * size),
        primary,
        start=iva.Start(displacement=size),
        periods=periods,
    )
    speeds, told = rebounds(found.impacts)
    assert (speeds < 1.5).sum() > 3
    assert ((speeds > 0.1) & (speeds < 1.5)).sum() > 3
    assert np.abs(told - interpolated(speeds)).max() < 1e-13


def test_speeds_beyond_the_points_have_the_last_restitutions() -> None:
    """A table that ends below all speeds but the slowest, and begins above all of them."""
    for points, e in (([[1e-9, 0.9], [2e-9, 0.6]], 0.6), ([[1e9, 0.6], [2e9, 0.9]], 0.6)):
        speeds, told = rebounds(run(siva(restitution_table=points)).impacts)
        assert (speeds > 2e-9).all()
        assert np.abs(told - e).max() < 1e-13


@pytest.mark.parametrize("force", [None, iva.Harmonic(amplitude=0.1, frequency=1.0)])
@pytest.mark.parametrize(
    "points", [[[0.1, 0.6], [1.0, 0.6]], [[0.5, 0.6]], [[1e9, 0.6], [2e9, 0.3]]]
)
def test_a_table_of_one_restitution_gives_the_bits_of_the_number(
    points: Any, force: iva.Harmonic | None
) -> None:
    """In every column; the last table has another restitution only at speeds that do not occur."""
    number, table = (
        run(siva(**law), force=force)
        for law in ({"restitution": 0.6}, {"restitution_table": points})
    )
    assert number.impacts.height > 3
    for name in TABLES:
        assert getattr(table, name).equals(getattr(number, name)), name


def test_a_sweep_of_a_flat_table_gives_the_bits_of_the_number() -> None:
    """Points of a number run side by side; so do those of a flat table, to the bit."""
    both = [
        iva.sweep(
            siva(**law),
            PRIMARY,
            over={"displacement": np.linspace(0.7, 2.0, 9)},
            start=iva.Start(),
            periods=20,
            tables=("summary", "impacts"),
        )
        for law in ({"restitution": 0.6}, {"restitution_table": [[0.2, 0.6], [2.0, 0.6]]})
    ]
    assert both[0].summary.equals(both[1].summary)
    assert both[0].impacts.equals(both[1].impacts)


def test_a_fine_table_of_a_power_law_agrees_with_it() -> None:
    """To the error of linear interpolation, h²/8 max |e''| with e'' = a b (1 − b) u^(b − 2)."""
    law = run(siva(restitution=0.6, reference_speed=1.0, restitution_exponent=0.5), periods=4)
    speeds, _ = rebounds(law.impacts)
    at = np.linspace(0.9 * speeds.min(), 1.1 * speeds.max(), 16)
    points = np.column_stack([at, 1.0 - 0.4 * at**0.5])
    table = run(siva(restitution_table=points), periods=4)
    assert table.impacts.height == law.impacts.height > 3
    bound = (at[1] - at[0]) ** 2 / 8.0 * 0.4 * 0.25 * at[0] ** -1.5
    assert bound < 2e-2
    own, told = rebounds(table.impacts)
    assert np.abs(told - (1.0 - 0.4 * own**0.5)).max() < bound + 1e-13
    # What the rebounds are off by adds up over the impacts.
    off = (table.impacts["time"] - law.impacts["time"]).abs().to_numpy()
    assert off[0] < 1e-13
    assert off.max() < 10.0 * off.size * bound


def test_the_energy_goes_where_it_is_said_to_go() -> None:
    """The ledger closes."""
    row = run(siva(restitution_table=POINTS), periods=30).summary.row(0, named=True)
    assert abs(row["energy_residual"]) < 1e-14


def test_each_of_a_list_has_its_own() -> None:
    """Two tables and a number beside each other."""
    other = [[0.2, 0.3], [1.0, 0.8]]
    found = run(
        [
            siva(restitution_table=POINTS),
            siva(restitution=0.5, clearance=0.4),
            siva(restitution_table=other, clearance=0.8),
        ]
    )
    for absorber, points in ((0, POINTS), (1, [[1.0, 0.5]]), (2, other)):
        speeds, told = rebounds(found.impacts.filter(pl.col("absorber") == absorber))
        assert speeds.size > 1
        assert np.abs(told - interpolated(speeds, points)).max() < 1e-13


def test_a_sweep_over_another_field_has_the_rows_of_single_runs() -> None:
    """To the bit."""
    over = {"clearance": [0.4, 0.6, 0.8]}
    base = iva.Siva(mass_ratio=0.1, restitution_table=POINTS)
    table = iva.sweep(
        base, PRIMARY, over=over, start=START, periods=20, tables=("summary", "impacts")
    )
    for point, clearance in enumerate(over["clearance"]):
        alone = run(siva(restitution_table=POINTS, clearance=clearance))
        own = table.impacts.filter(pl.col("point") == point).drop("point")
        assert own.equals(alone.impacts.drop("point"))


def test_a_scene_of_a_study_has_it_still() -> None:
    """Through the compiled part and back, of one absorber and of a list, which pickle as well."""
    for absorber in (siva(restitution_table=POINTS), [siva(), siva(restitution_table=POINTS)]):
        spec = scenes.scene(absorber, PRIMARY, START, None, {"periods": 3.0}, several=True)
        study = _iva.Study(spec, ("grid", [("displacement", [1.0, 2.0])]), ["summary"])
        for one in (study, pickle.loads(pickle.dumps(study))):
            parts = scenes.parts(one.scene(1))
            assert parts["absorber"] == absorber
            assert parts["start"] == iva.Start(displacement=2.0)


def test_an_axis_over_the_restitution_takes_its_place() -> None:
    """As it takes that of a yield speed: the points are those of numbers."""
    over = {"restitution": [0.5, 0.6]}
    swept = [
        iva.sweep(absorber, PRIMARY, over=over, start=START, periods=8, tables=("impacts",))
        for absorber in (siva(restitution_table=POINTS), siva())
    ]
    assert swept[0].impacts.equals(swept[1].impacts)


def test_a_gradient_is_the_slope_of_differences() -> None:
    """Of the first impact instants by the clearance, to 1e-6."""
    small = 1e-6
    found, low, high = (
        run(siva(restitution_table=POINTS, clearance=0.6 + by), periods=2, **more)
        for by, more in ((0.0, {"gradients": ["clearance"]}), (-small, {}), (small, {}))
    )
    slope = (high.impacts["time"] - low.impacts["time"]).to_numpy() / (2.0 * small)
    told = found.gradients["clearance"].impacts["time"].to_numpy()
    assert np.abs(told - slope).max() < 1e-6
    assert np.abs(slope).max() > 1e-3


def test_an_orbit_is_its_own_mirror_image() -> None:
    """The table is that of both walls; the state is near A1 of the dynamics references."""
    force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    absorber = iva.Siva(mass_ratio=0.2, clearance=4.5, restitution_table=[[2.0, 0.75], [5.0, 0.65]])
    found = dynamics.orbit(
        absorber,
        iva.Primary(damping_ratio=0.05),
        force=force,
        start=(-1.103, 0.327, -4.038, 3.256),
    )
    assert found
    assert found.symmetric is True
    assert found.residual < 1e-13


def test_regimes_need_no_number_for_the_restitution() -> None:
    """Of a flat table they are those of the number, chaotic as in record L1 of the references."""
    both = [
        dynamics.regimes(
            iva.Siva(mass_ratio=0.2, clearance=3.85, **law),
            iva.Primary(damping_ratio=0.05),
            force=iva.Harmonic(amplitude=1.0, frequency=1.0),
            starts=4,
            most_cycles=100,
            cycles=200,
        )
        for law in ({"restitution": 0.7}, {"restitution_table": [[1.0, 0.7], [2.0, 0.7]]})
    ]
    assert [one.kind for one in both[0]] == [one.kind for one in both[1]] == ["chaotic"]
    assert both[0][0].quiet == both[1][0].quiet
    assert both[0][0].amplitude == both[1][0].amplitude


def test_value_semantics() -> None:
    """Pairs of floats whatever was given, and an expression that gives them again."""
    given = siva(restitution_table=[[0, 1], [np.float32(0.5), 0.25]])
    assert given.restitution_table == ((0.0, 1.0), (0.5, 0.25))
    assert repr(given) == (
        "Siva(mass_ratio=0.1, restitution_table=((0.0, 1.0), (0.5, 0.25)), clearance=0.6)"
    )
    assert eval(repr(given), {"Siva": iva.Siva}) == given
    assert pickle.loads(pickle.dumps(given)) == copy.deepcopy(given) == given
    for same in (
        np.array([[0.0, 1.0], [0.5, 0.25]]),
        ((0, 1), (0.5, 0.25)),
        [np.array([0, 1]), (0.5, 0.25)],
    ):
        assert siva(restitution_table=same) == given
        assert hash(siva(restitution_table=same)) == hash(given)
    assert siva(restitution_table=[[0, 1], [0.5, 0.2]]) != given


@pytest.mark.parametrize(
    ("points", "error", "told"),
    [
        (5, TypeError, r"restitution_table = 5: give a list of pairs \[approach speed, rest"),
        ("0.1", TypeError, "restitution_table = '0.1': give a list of pairs"),
        ({0.1: 0.9}, TypeError, "give a list of pairs"),
        (pl.DataFrame({"u": [0.1, 0.2], "e": [0.9, 0.8]}), TypeError, "give a list of pairs"),
        ([0.1, 0.9], TypeError, r"restitution_table\[0\] = 0.1: give a pair"),
        ([[0.1, 0.9, 1]], TypeError, r"restitution_table\[0\] = .*: give a pair"),
        ([[0.1, "0.9"]], TypeError, r"restitution_table\[0\]\[1\] = '0.9': give a number, not str"),
        ([], ValueError, "restitution_table = 0 points: give 1 to 16 points"),
        ([[k, 0.5] for k in range(17)], ValueError, "restitution_table = 17 points: give 1 to 16"),
        ([[0.1, 1.5]], ValueError, r"table\[0\].restitution = 1.5: give a number from 0 to 1"),
        ([[-0.1, 0.5]], ValueError, r"table\[0\].speed = -0.1: give 0 or a number from 1e-30"),
        ([[1e31, 0.5]], ValueError, r"table\[0\].speed = 1e31: give 0 or a number from 1e-30"),
        ([[0.5, 0.5], [0.5, 0.4]], ValueError, r"table\[1\].speed = 0.5: give a speed above 0.5"),
    ],
)
def test_what_is_no_table_is_refused(points: Any, error: type[Exception], told: str) -> None:
    """With field, value and what is allowed."""
    with pytest.raises(error, match=told):
        siva(restitution_table=points)


@pytest.mark.parametrize(
    "name",
    ["restitution", "restitution_minus", "reference_speed", "restitution_exponent", "yield_speed"],
)
def test_nothing_else_of_the_restitution_stands_beside_it(name: str) -> None:
    """Of one absorber and of one in a list."""
    rule = r"restitution_table is given as well; give one of them$"
    with pytest.raises(ValueError, match=rf"^absorber\.{name} = 0.5: absorber\.{rule}"):
        run(siva(restitution_table=POINTS, **{name: 0.5}))
    with pytest.raises(ValueError, match=rf"absorber\.(1\.)?{name} = 0.5: absorber\.(1\.)?{rule}"):
        run([siva(restitution=0.5), siva(restitution_table=POINTS, **{name: 0.5})])


def test_what_takes_no_law_takes_no_table() -> None:
    """Theories and an axis."""
    table = siva(restitution_table=POINTS)
    with pytest.raises(ValueError, match="= a table of 3 points: the theory is of one mass"):
        iva.theory.masri_caughey(table, PRIMARY, iva.Harmonic(amplitude=0.1, frequency=1.0))
    with pytest.raises(ValueError, match="`restitution_table`: no such field"):
        iva.sweep(table, PRIMARY, over={"restitution_table": [0.5]}, start=START, periods=3)


STUDY = """version = 1
[primary]
damping_ratio = 0.01
[absorber]
kind = "siva"
mass_ratio = 0.1
clearance = 0.6
restitution_table = [[0.1, 0.9], [0.5, 0.7], [1.5, 0.4]]
[start]
displacement = 1
[run]
periods = 20
[sweep]
damping_ratio = [0.01, 0.02]
"""


def command(*words: object) -> int:
    """Run the command-line program quietly."""
    return _iva.main(["iva", *(str(word) for word in words), "--quiet"])


def test_a_study_file_gives_the_rows_of_python(tmp_path: Path) -> None:
    """The resolved study has the same table, and gives the same rows once more."""
    (tmp_path / "it.toml").write_text(STUDY, encoding="utf-8")
    assert command("sweep", tmp_path / "it.toml", "--out", tmp_path / "out") == 0
    resolved = tmp_path / "out" / "study.toml"
    assert tomllib.loads(resolved.read_text())["absorber"]["restitution_table"] == POINTS
    assert command("sweep", resolved, "--out", tmp_path / "again") == 0
    table = iva.sweep(
        siva(restitution_table=POINTS),
        PRIMARY,
        over={"damping_ratio": [0.01, 0.02]},
        start=START,
        periods=20,
        tables=("summary", "impacts"),
    )
    for folder in ("out", "again"):
        read = iva.read(tmp_path / folder)
        assert read.summary.equals(table.summary)
        assert read.impacts.equals(table.impacts)


def test_another_table_does_not_go_on_from_a_folder(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Neither in study files nor in Python; the same table does."""
    (tmp_path / "it.toml").write_text(STUDY, encoding="utf-8")
    (tmp_path / "other.toml").write_text(STUDY.replace("0.7", "0.71"), encoding="utf-8")
    out = tmp_path / "out"
    assert command("sweep", tmp_path / "it.toml", "--out", out) == 0
    assert command("sweep", tmp_path / "it.toml", "--out", out, "--resume") == 0
    assert command("sweep", tmp_path / "other.toml", "--out", out, "--resume") != 0
    told = " ".join(capfd.readouterr().err.split())
    assert "absorber.restitution_table was" in told
