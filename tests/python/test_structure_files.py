"""Structures from MAT files, and files that are none of a structure."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io
from numpy.typing import NDArray
from polars.testing import assert_frame_equal
from scipy.sparse import csc_matrix

import iva
from planted_modes import DAMPING, MASS, OMEGA, RATIOS, SHAPES, STIFFNESS
from recordings import written

NAMES = ["first", "second", "top"]

Array = NDArray[Any]


def cells(names: list[str]) -> Array:
    """Return names as a cell array of MATLAB."""
    return np.array(names, dtype=object)


def matlab(folder: Path, **variables: Any) -> Path:
    """Write a MAT file."""
    path = folder / "frame.mat"
    scipy.io.savemat(path, variables)
    return path


@pytest.mark.parametrize("points", [cells(NAMES), NAMES])
def test_modes_in_mat_files(tmp_path: Path, points: Any) -> None:
    """A cell array, and a matrix of letters, whose rows end with blanks."""
    path = matlab(
        tmp_path,
        frequencies=OMEGA.reshape(-1, 1),
        damping_ratios=RATIOS,
        shapes=SHAPES.T,
        points=points,
        absorber_at="top",
        note="a chain",
        fs=100.0,
    )
    structure = iva.Structure.read(path)
    assert structure.absorber_at == "top"
    found = structure.modes()
    assert found["frequency"].to_list() == OMEGA.tolist()
    assert found["damping_ratio"].to_list() == RATIOS.tolist()
    for name, shapes in zip(NAMES, SHAPES, strict=True):
        assert found[f"shape_{name}"].to_list() == shapes.tolist()
    other = iva.Structure.read(
        path, points=["a", "b", "c"], absorber_at=["a", "c"], damping_ratios=0
    )
    assert other.points == dict(zip("abc", SHAPES.tolist(), strict=True))
    hertz = iva.Structure.read(
        path, frequencies_hz=[1, 2, 3], points={"a": [1, 2, 3]}, absorber_at="a"
    )
    assert hertz.modes().columns[4:] == ["shape_a"]


@pytest.mark.parametrize(
    ("mass", "stiffness", "damping"), [("M", "K", "C"), ("mass", "stiffness", "damping")]
)
@pytest.mark.parametrize("form", [np.asarray, csc_matrix])
def test_matrices_in_mat_files(
    tmp_path: Path, mass: str, stiffness: str, damping: str, form: Any
) -> None:
    matrices = {mass: form(MASS), stiffness: form(STIFFNESS), damping: form(DAMPING)}
    path = matlab(tmp_path, **matrices, points=cells(NAMES), absorber_at=cells(["first", "top"]))
    structure = iva.Structure.read(path)
    assert structure.absorber_at == ["first", "top"]
    true = iva.Structure(mass=MASS, stiffness=STIFFNESS, damping=DAMPING, points=NAMES)
    assert_frame_equal(structure.modes(), true.modes(), check_exact=True)
    undamped = iva.Structure.read(matlab(tmp_path, M=MASS, K=STIFFNESS, C=[]), points=NAMES)
    assert undamped.modes()["damping_ratio"].to_list() == [0.0] * 3


def test_a_run_of_a_structure_from_a_file(tmp_path: Path) -> None:
    """It is bit for bit the run of the same numbers."""
    path = matlab(tmp_path, M=MASS, K=STIFFNESS, C=DAMPING, points=cells(NAMES), base=[1, 1, 1])
    read = iva.Structure.read(path, absorber_at="top")
    true = iva.Structure(
        mass=MASS,
        stiffness=STIFFNESS,
        damping=DAMPING,
        points=NAMES,
        base=[1, 1, 1],
        absorber_at="top",
    )
    assert read == true
    absorber = iva.Siva(mass=0.1, restitution=0.6, clearance=0.005)
    one, other = (
        iva.simulate(absorber, it, start=iva.Start(displacement=0.02), periods=5).impacts
        for it in (read, true)
    )
    assert one.height > 5
    assert_frame_equal(one, other, check_exact=True)


@pytest.mark.parametrize(
    ("variables", "told"),
    [
        (
            {"note": "none"},
            r"frame.mat: no structure in it; give variables frequencies_hz, damping_rat",
        ),
        (
            {"frequencies": OMEGA, "shapes": SHAPES},
            r"frame.mat: shapes, but no points; give a cell arr",
        ),
        (
            {"frequencies": OMEGA, "shapes": SHAPES, "points": cells(["a", "b"])},
            r"frame.mat: shapes has 3 columns, points 2 names; give a row of shapes for each",
        ),
        (
            {"frequencies": OMEGA, "shapes": SHAPES, "points": cells(["a", "b", "a"])},
            r"frame.mat: points has 'a' twice; give each point another name",
        ),
        (
            {"frequencies": OMEGA, "points": [12, 7, 30]},
            r"frame.mat: points holds something else than names;",
        ),
        (
            {"frequencies": OMEGA, "points": cells(["a", 1.0])},  # type: ignore[list-item]
            r"frame.mat: points holds something else than names; give a cell array",
        ),
        (
            {"frequencies": "ten"},
            r"frame.mat: frequencies holds something else than real numbers; give",
        ),
        (
            {"frequencies": OMEGA + 1j},
            r"frame.mat: frequencies holds something else than real numbers",
        ),
        (
            {"frequencies": MASS},
            r"frame.mat: frequencies is an array of 3 × 3; give a row or a column ",
        ),
        ({"M": np.zeros((2, 2, 2))}, r"frame.mat: M is an array of 2 × 2 × 2; give a matrix$"),
        (
            {"M": csc_matrix((90000, 90000))},
            r"frame.mat: M has 90000 rows; give at most 40, as many mo",
        ),
        (
            {"M": MASS, "mass": MASS},
            r"frame.mat: it has (M|mass) and (M|mass), which mean the same; kee",
        ),
        ({"M": MASS, "K": STIFFNESS}, r"structure.points is missing: give a list with the names"),
        ({"M": MASS, "frequencies": OMEGA}, r"structure.mass = .*; give modes or matrices"),
    ],
)
def test_mat_files_that_are_refused(tmp_path: Path, variables: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        iva.Structure.read(matlab(tmp_path, **variables))


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    newer = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512) + b"\x89HDF\r\n\x1a\n" + bytes(99)
    with pytest.raises(
        ValueError, match=r"new.mat: a MAT file of version 7.3, which is HDF5; save it "
    ):
        iva.Structure.read(written(tmp_path, newer, "new.mat"))
    with pytest.raises(ValueError, match=r"bad.mat: a damaged MAT file \(.*\); save it anew"):
        iva.Structure.read(written(tmp_path, b"nothing of the kind" * 20, "bad.mat"))
    for ending in ("mat", "uff", "unv", "uf"):
        with pytest.raises(
            iva.IvaError, match=rf"none.{ending} cannot be read: No such file or dir"
        ):
            iva.Structure.read(tmp_path / f"none.{ending}")
    with pytest.raises(OSError, match=r"none.csv"):
        iva.Structure.read(tmp_path / "none.csv")
    with pytest.raises(TypeError, match=r"^file = b'modes.uff': give the name of a file$"):
        iva.Structure.read(b"modes.uff")  # type: ignore[arg-type]
    for ending in ("csv", "mat"):
        with pytest.raises(
            ValueError, match=rf"^nodes = 3: a.{ending} is no universal file \(.uff, .u"
        ):
            iva.Structure.read(tmp_path / f"a.{ending}", nodes=3)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("module", "name", "message"),
    [
        (
            "scipy.io",
            "a.mat",
            r"reading a MAT file needs SciPy: pip install 'iva-dynamics\[export\]'",
        ),
        (
            "pyuff",
            "a.uff",
            r"reading a universal file needs pyuff: pip install 'iva-dynamics\[export",
        ),
    ],
)
def test_packages_that_are_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, module: str, name: str, message: str
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=message):
        iva.Structure.read(written(tmp_path, b"MATLAB 5.0 MAT-file", name))
