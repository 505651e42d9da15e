"""Files for MATLAB and for test rigs: what they hold is what the tables hold."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
import pyuff
import scipy.io

import iva
from iva import exports


def columns(loaded: Any) -> dict[str, Any]:
    """Return the fields of a struct that SciPy read."""
    return {name: loaded[name][0, 0] for name in loaded.dtype.names}


def words(cells: Any) -> list[str]:
    """Return a cell array of words, shape (n, 1)."""
    assert cells.dtype == object
    assert cells.shape[1:] == (1,)
    return [str(cell[0]) if cell.size else "" for cell in cells[:, 0]]


def agrees(frame: pl.DataFrame, loaded: Any) -> None:
    """Compare a table with its struct, to the bit."""
    found = columns(loaded)
    assert list(found) == [name.replace(".", "_") for name in frame.columns]
    for column, values in zip(frame, found.values(), strict=True):
        assert values.shape == (frame.height, 1), column.name
        if column.dtype == pl.String:
            assert words(values) == column.fill_null("").to_list()
        elif column.dtype == pl.Boolean and not column.null_count():
            assert values.dtype == np.uint8  # how SciPy shows a logical array
            assert values[:, 0].tolist() == column.to_list()
        else:
            assert values.dtype == np.float64, column.name
            expected = column.cast(pl.Float64).fill_null(float("nan")).to_numpy()
            np.testing.assert_array_equal(values[:, 0], expected)


def test_a_table_as_mat(tmp_path: Path, table: iva.Table) -> None:
    table.write_mat(tmp_path / "table.mat")
    read = scipy.io.loadmat(tmp_path / "table.mat")
    assert read["__version__"] == "1.0"
    names = {"summary", "impacts", "episodes", "envelope"}
    assert {name for name in read if not name.startswith("__")} == {*names, "units", "iva_version"}
    for name in names:
        agrees(getattr(table, name), read[name])
        units = {key: "".join(text) for key, text in columns(columns(read["units"])[name]).items()}
        assert set(units) == set(columns(read[name]))
        assert [text for text in units.values() if not text.isascii()] == []
    assert columns(columns(read["units"])["summary"])["settling_time_5"] == ["1/omega_n"]
    assert columns(columns(read["units"])["impacts"])["angular_velocity_after"] == ["rad * omega_n"]
    energy = "(length of displacement * omega_n)^2 per unit primary mass"
    assert columns(columns(read["units"])["summary"])["energy_final"] == [energy]
    assert read["iva_version"] == [iva.__version__]
    # What the comparison above is to have met: nulls, flags, words.
    assert table.impacts["near_grazing"].null_count() == table.impacts.height > 0
    assert table.impacts["effective"].null_count() == 0
    assert table.summary["regime"].null_count() == 6


def test_flags_stay_logical(tmp_path: Path, table: iva.Table) -> None:
    table.write_mat(tmp_path / "table.mat")
    # The types that MATLAB will see, a flag of the file among them.
    impacts = columns(scipy.io.loadmat(tmp_path / "table.mat", mat_dtype=True)["impacts"])
    assert impacts["effective"].dtype == np.bool_
    assert impacts["near_grazing"].dtype == impacts["wall"].dtype == np.float64


def test_a_run_as_mat_has_its_trajectory(tmp_path: Path, run: iva.Run) -> None:
    run.write_mat(tmp_path / "run.mat", samples_per_period=30)
    read = scipy.io.loadmat(tmp_path / "run.mat")
    agrees(run.trajectory(30), read["trajectory"])
    for name in ("summary", "impacts", "episodes", "envelope", "stroboscope"):
        agrees(getattr(run, name), read[name])
    assert read["stroboscope"]["time"][0, 0].shape == (0, 1)
    with pytest.raises(ValueError, match="samples_per_period = 0: give a whole number"):
        run.write_mat(tmp_path / "other.mat", samples_per_period=0)
    assert [file.name for file in tmp_path.iterdir()] == ["run.mat"]


def test_names_are_names_in_matlab(tmp_path: Path, siva: iva.Siva) -> None:
    driven = iva.sweep(
        siva,
        iva.Primary(damping_ratio=0.01),
        over={"force.0.relative_frequency": [0.9, 1.0], "force.1.velocity": [0.0, 0.1]},
        force=[iva.Harmonic(amplitude=0.1), iva.Impulse()],
        start=iva.Start(displacement=1.0),
        cycles=20,
        tables=("summary", "impacts", "stroboscope"),
    )
    driven.write_mat(tmp_path / "driven.mat")
    read = scipy.io.loadmat(tmp_path / "driven.mat")
    agrees(driven.summary, read["summary"])
    swept = columns(read["summary"])["force_0_relative_frequency"]
    assert swept[:, 0].tolist() == [0.9, 0.9, 1.0, 1.0]
    for name in ("summary", "impacts", "stroboscope"):
        for field in columns(read[name]):
            assert re.fullmatch(r"[a-z]\w{0,62}", field, flags=re.ASCII)


def test_a_table_that_is_too_large_for_mat(
    tmp_path: Path, table: iva.Table, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(exports, "MAT_LIMIT", 2000)
    with pytest.raises(
        ValueError, match=r"summary would take .* at most .*: sweep without this table"
    ):
        table.write_mat(tmp_path / "table.mat")
    assert list(tmp_path.iterdir()) == []


WRITERS = ["write_mat", "write_uff"]


@pytest.mark.parametrize("writer", WRITERS)
def test_a_file_that_cannot_be_written_is_as_before(
    tmp_path: Path, run: iva.Run, writer: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(file: object, *_: object, **__: object) -> None:
        Path(getattr(file, "_filename", file)).write_text("half of it")  # type: ignore[arg-type]
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(scipy.io, "savemat", fails)
    monkeypatch.setattr(pyuff.UFF, "write_sets", fails)
    before = tmp_path / "before"
    before.write_text("as it was")
    with pytest.raises(iva.IvaError, match=r"before cannot be written: .*No space left on device"):
        getattr(run, writer)(before)
    assert before.read_text() == "as it was"
    assert list(tmp_path.iterdir()) == [before]


def test_a_universal_file_that_lacks_a_part_is_none(
    tmp_path: Path, run: iva.Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    def half(file: pyuff.UFF, sets: list[dict[str, object]], mode: str) -> None:
        whole(file, sets[:2], mode)

    whole = pyuff.UFF.write_sets
    monkeypatch.setattr(pyuff.UFF, "write_sets", half)
    with pytest.raises(iva.IvaError, match="cannot be written: a part of it is missing"):
        run.write_uff(tmp_path / "run.uff")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("writer", WRITERS)
def test_bad_paths(tmp_path: Path, run: iva.Run, writer: str) -> None:
    write = getattr(run, writer)
    with pytest.raises(ValueError, match=r"path = .*: this is a folder, give the name of a file"):
        write(tmp_path)
    with pytest.raises(ValueError, match=r"path = .*none.run': there is no folder '.*none'"):
        write(tmp_path / "none" / "run")
    with pytest.raises(TypeError, match="path = 3: give the name of a file"):
        write(3)


@pytest.mark.parametrize(
    ("writer", "module", "says"),
    [
        ("write_mat", "scipy.io", "write_mat needs SciPy: pip install 'iva-dynamics[export]'"),
        ("write_uff", "pyuff", "write_uff needs pyuff: pip install 'iva-dynamics[export]'"),
    ],
)
def test_without_the_extra(
    tmp_path: Path,
    run: iva.Run,
    writer: str,
    module: str,
    says: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=f"^{re.escape(says)}$"):
        getattr(run, writer)(tmp_path / "run")


PIVA = iva.Piva(mass=20.0, length=0.75, contact_distance=0.6, restitution=0.5, gap_mm=140.0)
HEAVY = iva.Primary(mass=200.0, stiffness=16_000.0, damping=30.0)
SCENES = {
    "si": iva.simulate(
        iva.Siva(mass=0.3, restitution=0.6, gap_mm=5.0),
        iva.Primary(mass=3.0, stiffness=12_000.0, damping=2.0),
        start=iva.Start(displacement_mm=4.0),
        duration=1.0,
    ),
    "pendulum": iva.simulate(PIVA, HEAVY, start=iva.Start(displacement_mm=50.0), duration=10.0),
    # The same, its length by gravity and frequency: g = κ L ωp².
    "length of gravity": iva.simulate(
        iva.Piva(
            mass=20.0,
            frequency_ratio=9.80665**0.5 / (0.75**0.5 * 80.0**0.5),
            gravity=9.80665,
            contact_distance=0.6,
            restitution=0.5,
            gap_mm=140.0,
        ),
        HEAVY,
        start=iva.Start(displacement_mm=50.0),
        duration=10.0,
    ),
    "seconds": iva.simulate(
        iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=0.5),
        iva.Primary(frequency_hz=7.0),
        start=iva.Start(displacement=1.0),
        force=iva.Harmonic(amplitude=100.0, relative_frequency=1.0),
        cycles=5,
    ),
    "natural": iva.simulate(
        iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=0.5),
        iva.Primary(damping_ratio=0.01),
        start=iva.Start(displacement=1.0),
        periods=5,
    ),
    "cut short": iva.simulate(
        iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=0.5),
        iva.Primary(natural_frequency=20.0),
        start=iva.Start(displacement=1.0),
        periods=50,
        max_impacts=3,
    ),
}


def read_uff(file: Path) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Return the sets of units and the time responses of a universal file."""
    sets = pyuff.UFF(str(file)).read_sets()
    assert [one["type"] for one in sets[-4:]] == [58] * 4
    return sets[:-4], sets[-4:]


@pytest.mark.parametrize("binary", [True, False], ids=["binary", "text"])
@pytest.mark.parametrize("name", SCENES)
def test_a_run_as_uff(tmp_path: Path, name: str, binary: bool) -> None:
    run = SCENES[name]
    run.write_uff(tmp_path / "run.uff", samples_per_period=77, binary=binary)
    units, responses = read_uff(tmp_path / "run.uff")
    # With L/b for the centre of mass of the pendulum.
    reach = 0.75 / 0.6 if isinstance(run.absorber, iva.Piva) else 1.0
    expected = []
    for response in responses:
        assert response["binary"] == binary
        assert response["func_type"] == 1
        assert (response["abscissa_spacing"], response["ord_data_type"]) == (1, 4)
        times = response["x"]
        states = run.at(times)
        x, v, y, w = (
            states[key].to_numpy()
            for key in ("displacement", "velocity", "gap_displacement", "gap_velocity")
        )
        expected = [x, v, x + reach * y, v + reach * w]
        values = expected[response["func_id"] - 1]
        if binary:
            np.testing.assert_array_equal(response["data"], values)
        else:
            np.testing.assert_allclose(response["data"], values, rtol=6e-12, atol=0)
        assert times[0] == 0.0
        end = run.trajectory(1)["time"][-1]
        assert end - response["abscissa_inc"] < times[-1] <= end
    assert [one["rsp_node"] for one in responses] == [1, 1, 2, 2]
    assert [one["rsp_dir"] for one in responses] == [1] * 4
    # The motion is one, with impacts: absorber and structure differ.
    assert run.impacts.height > 2
    assert not np.array_equal(expected[0], expected[2])
    kinds = [one["ordinate_spec_data_type"] for one in responses]
    labels = [one["ordinate_axis_units_lab"] for one in responses]
    time = {(one["abscissa_spec_data_type"], one["abscissa_axis_units_lab"]) for one in responses}
    if name in {"si", "pendulum", "length of gravity"}:
        assert [(one["type"], one["units_code"], one["length"]) for one in units] == [(164, 1, 1.0)]
        assert (kinds, labels, time) == ([8, 11, 8, 11], ["m", "m/s"] * 2, {(17, "s")})
    elif name == "natural":
        assert (kinds, units, time) == ([1] * 4, [], {(1, "1/omega_n")})
        assert labels == ["unit of x", "unit of x*omega_n"] * 2
    else:
        assert (kinds, units, time) == ([1] * 4, [], {(17, "s")})
        assert labels == ["unit of x", "unit of x/s"] * 2


def test_the_centre_of_mass_of_a_pendulum_moves_as_its_impacts_say() -> None:
    run = SCENES["pendulum"]
    impacts = run.impacts
    _, _, _, velocity = exports.datasets(run, impacts["time"].to_numpy(), True)[1:]
    # The instants are rounded: some lie just before the impact, some just after it.
    before, after = (
        np.abs(velocity["data"] - impacts[f"absorber_velocity_{side}"].to_numpy())
        for side in ("before", "after")
    )
    assert np.minimum(before, after).max() < 1e-12
    assert np.maximum(before, after).min() > 1e-6
    assert impacts.height > 2


@pytest.mark.parametrize("name", SCENES)
def test_samples_are_as_close_as_asked(tmp_path: Path, name: str) -> None:
    run = SCENES[name]
    run.write_uff(tmp_path / "run.uff")
    step = read_uff(tmp_path / "run.uff")[1][0]["abscissa_inc"]
    assert step == pytest.approx(run.trajectory(200)["time"][1], rel=5e-6)
    if name != "natural":
        run.write_uff(tmp_path / "run.uff", samples_per_second=4096)
        assert read_uff(tmp_path / "run.uff")[1][0]["abscissa_inc"] == 2.44141e-4


def test_what_a_universal_file_says_of_itself(tmp_path: Path) -> None:
    record = iva.Recorded([0.0, 0.5, 1.0], [0.0, 1.0, 0.0], kind="base_acceleration")
    run = iva.simulate(
        PIVA, HEAVY, start=iva.Start(displacement_mm=50.0), force=record, duration=1.0
    )
    run.write_uff(tmp_path / "run.uff", binary=False)
    text = (tmp_path / "run.uff").read_bytes()
    assert text.isascii()
    assert max(map(len, text.splitlines())) <= 80
    one, *_, last = read_uff(tmp_path / "run.uff")[1]
    assert one["id1"] == f"displacement of structure, iva-dynamics {iva.__version__}"
    assert last["id1"] == f"velocity of absorber, iva-dynamics {iva.__version__}"
    assert one["id2"].startswith("Piva(mass=20.0, restitution=0.5, gap_mm=140.0, length=0.75")
    assert one["id4"] == "Primary(damping=30.0, stiffness=16000.0, mass=200.0)"
    assert one["id5"].startswith("Start(displacement_mm=50.0); Recorded(3 points")
    again = tmp_path / "again.uff"
    run.write_uff(again, binary=False)
    assert again.read_bytes() == text


def test_bad_samples(tmp_path: Path, run: iva.Run) -> None:
    cases: list[tuple[dict[str, Any], type[Exception], str]] = [
        ({"samples_per_period": 0}, ValueError, "samples_per_period = 0: give a number greater"),
        ({"samples_per_period": 1e10}, ValueError, "= 10000000000.0: give a number .* at most 1e9"),
        ({"samples_per_period": float("nan")}, ValueError, "samples_per_period = nan: give"),
        ({"samples_per_period": "many"}, TypeError, "samples_per_period = 'many': give a number"),
        ({"samples_per_period": 0.1}, ValueError, "samples_per_period = 0.1: .* have 1 of them"),
        ({"samples_per_period": 1e-300}, ValueError, "= 1e-300: .* makes it 2 to 10000000"),
        ({"samples_per_period": 1e8}, ValueError, "would have 59999.* makes it 2 to 10000000"),
        ({"samples_per_second": 50}, ValueError, "samples_per_second = 50: the run has no seconds"),
        (
            {"samples_per_second": 50, "samples_per_period": 50},
            ValueError,
            "samples_per_second = 50: samples_per_period is given as well",
        ),
        ({"binary": 1}, TypeError, "binary = 1: give True or False"),
    ]
    for given, error, says in cases:
        with pytest.raises(error, match=says):
            run.write_uff(tmp_path / "run.uff", **given)
    with pytest.raises(ValueError, match="samples_per_second = -1: give a number greater than 0"):
        SCENES["si"].write_uff(tmp_path / "run.uff", samples_per_second=-1)
    assert list(tmp_path.iterdir()) == []


def test_samples_end_with_the_run(tmp_path: Path) -> None:
    run = iva.simulate(
        iva.Siva(mass=0.3, restitution=0.6, gap_mm=5.0),
        iva.Primary(mass=3.0, stiffness=12_000.0, damping=2.0),
        start=iva.Start(displacement_mm=4.0),
        duration=1.7,
    )
    run.write_uff(tmp_path / "run.uff", samples_per_second=10)
    # 17 steps of 0.1 s are 1.7000000000000002 s, which the run does not have.
    assert read_uff(tmp_path / "run.uff")[1][0]["num_pts"] == 17


def test_a_run_that_was_cut_short_has_samples_up_to_its_end() -> None:
    run = SCENES["cut short"]
    end = run.trajectory(1)["time"][-1]
    for response in exports.datasets(run, np.array([0.0, end / 2, end, 1.01 * end]), True):
        assert response["data"].shape == response["x"].shape == (3,)
        assert np.isfinite(response["data"]).all()
