"""Structures from universal files: the modes that are written into them come back.

Eigenvalues, modal A and modal masses follow from the modes of a chain of masses by the formulas
that stand beside. Files keep six digits of each number.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyuff
from numpy.typing import NDArray
from polars.testing import assert_frame_equal

import iva
from planted_modes import DAMPING, MASS, OMEGA, RATIOS, SHAPES
from recordings import written

pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")  # pyuff leaves files open

#: What the shapes of the file are multiplied by; their modal masses are the squares.
SCALES = np.array([4.0, -0.5, 30.0])
NODES = [12, 7, 30]
DIGITS = 1e-5

Array = NDArray[Any]


def mode(number: int, **changes: Any) -> dict[str, Any]:
    """Return dataset 55 of a mode from 1, whose masses move in x, and half as far back in z."""
    shape = SHAPES[:, number - 1] * SCALES[number - 1]
    made = {
        "type": 55,
        "model_type": 1,
        "analysis_type": 2,
        "data_ch": 2,
        "spec_data_type": 8,
        "load_case": 1,
        "mode_n": number,
        "freq": OMEGA[number - 1] / (2 * math.pi),
        "modal_m": SCALES[number - 1] ** 2,
        "modal_damp_vis": RATIOS[number - 1],
        "modal_damp_his": 0.0,
        "node_nums": NODES,
        "r1": shape,
        "r2": 0.0 * shape,
        "r3": -0.5 * shape,
    }
    return made | changes


def turned(number: int, phases: Array | float, **changes: Any) -> dict[str, Any]:
    """Return the dataset of a complex eigenvalue, with shapes of these phases in rad.

    λ = −ζω + iω√(1 − ζ²), and modal A = φᵀ(2λM + C)φ of the shape as it is in the file.
    """
    damped = OMEGA[number - 1] * math.sqrt(1.0 - RATIOS[number - 1] ** 2)
    eigenvalue = complex(-RATIOS[number - 1] * OMEGA[number - 1], damped)
    real = SHAPES[:, number - 1] * SCALES[number - 1]
    shape = real * np.exp(1j * np.asarray(phases))
    modal = shape @ (2.0 * eigenvalue * MASS + DAMPING) @ shape
    made = mode(number, analysis_type=3, eig=eigenvalue, modal_a=modal, modal_b=-eigenvalue * modal)
    return made | {"r1": shape, "r2": 0.0 * shape, "r3": -0.5 * shape} | changes


def units(length: float, force: float) -> dict[str, Any]:
    """Return dataset 164: so many units make a metre, and a newton."""
    made = {"type": 164, "units_code": 9, "units_description": "OURS", "temp_mode": 1}
    return made | {"length": length, "force": force, "temp": 1.0, "temp_offset": 273.15}


SI = units(1.0, 1.0)


def universal(folder: Path, *sets: dict[str, Any], name: str = "modes.uff") -> Path:
    """Write datasets into a file."""
    path = folder / name
    path.unlink(missing_ok=True)
    pyuff.UFF(str(path)).write_sets([dict(one) for one in sets], "add")
    return path


def matches(structure: iva.Structure, signs: Array | None = None) -> None:
    """Check that a structure has the planted modes in x and z; without signs up to those."""
    found = structure.modes()
    assert found["frequency"].to_numpy() == pytest.approx(OMEGA, rel=DIGITS)
    assert found["damping_ratio"].to_numpy() == pytest.approx(RATIOS, rel=DIGITS)
    told = np.array([found[f"shape_{node}x"].to_numpy() for node in NODES])
    known = np.sign(told[0] / SHAPES[0]) if signs is None else signs
    assert told == pytest.approx(SHAPES * known, rel=DIGITS)
    backwards = np.array([found[f"shape_{node}z"].to_numpy() for node in NODES])
    assert backwards == pytest.approx(-0.5 * told, rel=DIGITS)
    assert len(found.columns) == 4 + 2 * len(NODES)  # none in y


@pytest.mark.parametrize("name", ["modes.uff", "modes.unv", "MODES.UF"])
def test_normal_modes(tmp_path: Path, name: str) -> None:
    """Numbers of modes and their order in the file do not matter."""
    path = universal(tmp_path, SI, mode(3), mode(1), mode(2), name=name)
    for file in (path, str(path)):
        matches(iva.Structure.read(file, absorber_at="30x"), np.sign(SCALES))
    phases = universal(tmp_path, SI, *(turned(k, 0.4 * k, analysis_type=2) for k in (1, 2, 3)))
    matches(iva.Structure.read(phases))


#: Two masses of 2 kg between walls, on springs of 800 N/m: ω² = 400 and 1200 rad²/s², shapes (1, 1)
#: and (1, −1) with modal masses of 4 kg, here 0.004 t, as lengths are in mm and forces in N. A
#: third node moves in no mode, and may be missing; rotations, of the second mode, are left out.
#: Typed by hand from the description of the format.
TYPED = """\
    -1
   164
         9  mm (newton)                1
  1.00000000000000000D+03  1.00000000000000000D+00  1.00000000000000000D+00
  2.73150000000000000D+02
    -1
    -1
    55
Two masses
NONE
NONE
NONE
NONE
         1         2         2         8         2         3
         2         4         1         1
  3.18310e+00  4.00000e-03  1.00000e-02  0.00000e+00
       101
  1.00000e+00  0.00000e+00  0.00000e+00
       102
  1.00000e+00  0.00000e+00  0.00000e+00
    -1
    -1
    55
Two masses
NONE
NONE
NONE
NONE
         1         2         3         8         2         6
         2         4         1         2
  5.51329e+00  4.00000e-03  2.00000e-02  0.00000e+00
       101
  1.00000e+00  0.00000e+00  0.00000e+00  7.00000e+00  7.00000e+00  7.00000e+00
       102
 -1.00000e+00  0.00000e+00  0.00000e+00  0.00000e+00  0.00000e+00  0.00000e+00
       103
  0.00000e+00  0.00000e+00  0.00000e+00  0.00000e+00  0.00000e+00  0.00000e+00
    -1
"""


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_a_file_typed_by_hand(tmp_path: Path, end: str) -> None:
    path = written(tmp_path, TYPED.replace("\n", end), "typed.unv")
    modes = iva.Structure.read(path, absorber_at="101x").modes()
    assert modes.columns[4:] == ["shape_101x", "shape_102x"]
    assert modes["frequency"].to_numpy() == pytest.approx(np.sqrt([400, 1200]), rel=DIGITS)
    assert modes["damping_ratio"].to_list() == [0.01, 0.02]
    assert modes["shape_101x"].to_numpy() == pytest.approx([0.5, 0.5], rel=DIGITS)
    assert modes["shape_102x"].to_numpy() == pytest.approx([0.5, -0.5], rel=DIGITS)


@pytest.mark.parametrize(
    ("length", "force", "kilogram", "unit"),
    [
        (1000.0, 1000.0, 1.0, "kg"),  # mm, mN
        (1000.0, 1.0, 1000.0, "t"),  # mm, N
        (1000.0, 1 / 9.80665, 9806.65, None),  # mm, kgf: a unit of mass without a name
        (1 / 0.3048, 1 / 4.4482216152605, 14.593902937206364, "slug"),  # ft, lbf (NIST SP 811, B.8)
        (1 / 0.0254, 1 / 4.4482216152605, 175.12683524647636, "slinch"),  # in, lbf
        (1 / 0.3048, 1 / 0.138254954376, 0.45359237, "lb"),  # ft, poundal (NIST SP 811, B.8)
    ],
)
def test_units_of_mass(
    tmp_path: Path, length: float, force: float, kilogram: float, unit: str | None
) -> None:
    """A modal mass of the file times the kg in its unit is the one of the truth."""
    modes = [mode(k, modal_m=SCALES[k - 1] ** 2 / kilogram) for k in (1, 2, 3)]
    stated = universal(tmp_path, units(length, force), *modes)
    matches(iva.Structure.read(stated), np.sign(SCALES))
    if unit is None:
        return
    matches(iva.Structure.read(stated, mass_unit=unit), np.sign(SCALES))
    other = "kg" if unit == "t" else "t"
    told = rf"^mass_unit = '{other}': dataset 164 of modes.uff says that masses are in units of "
    with pytest.raises(ValueError, match=told):
        iva.Structure.read(stated, mass_unit=other)
    silent = universal(tmp_path, *modes)
    matches(iva.Structure.read(silent, mass_unit=unit), np.sign(SCALES))
    told = r"^mass_unit = None: modes.uff states no units \(dataset 164\) before mode 1 \(.* Hz"
    with pytest.raises(ValueError, match=told):
        iva.Structure.read(silent)


def test_complex_eigenvalues_of_first_order(tmp_path: Path) -> None:
    """Phases of 0, 45° (as of a modal A of 1) and 110°, the last of a pair of conjugates."""
    pair = turned(3, 1.92)
    conjugate = {key: np.conj(pair[key]) for key in ("eig", "modal_a", "r1", "r2", "r3")}
    unity = turned(2, math.pi / 4)
    root = np.sqrt(unity["modal_a"])
    unity |= {key: unity[key] / root for key in ("r1", "r2", "r3")} | {"modal_a": 1.0}
    sets = [turned(1, 0.0), unity, pair, pair | conjugate | {"mode_n": 4}]
    for order in (sets, sets[::-1]):
        matches(iva.Structure.read(universal(tmp_path, SI, *order)))


def test_complex_eigenvalues_of_second_order(tmp_path: Path) -> None:
    """Their modal masses are those of the caller."""
    sets = [turned(k, 0.3, analysis_type=7) for k in (1, 2, 3)]
    path = universal(tmp_path, SI, *sets)
    matches(iva.Structure.read(path, modal_masses=SCALES**2))
    told = (
        r"^modal_masses = None: .* none of mode 1 \(.* Hz\), a complex eigenvalue of second order"
    )
    with pytest.raises(ValueError, match=told):
        iva.Structure.read(path)


def test_phases_that_scatter(tmp_path: Path) -> None:
    """One mass of the first mode is out of phase; the least scatter is sought by trials."""
    shape = SHAPES[:, 0]
    for degrees, real in ((12.0, True), (40.0, False)):
        phases = np.radians([0.0, 0.0, degrees])
        trials = np.exp(-1j * np.linspace(-math.pi / 2, math.pi / 2, 20001))
        imaginary = np.linalg.norm((np.outer(trials, shape * np.exp(1j * phases))).imag, axis=1)
        scatter = math.degrees(math.asin(imaginary.min() / np.linalg.norm(shape)))
        assert (scatter < 10.0) is real
        path = universal(tmp_path, SI, turned(1, phases), turned(2, 0.0), turned(3, 0.0))
        if real:
            found = iva.Structure.read(path).modes()["shape_30x"][0]
            assert abs(found) == pytest.approx(abs(shape[2]), rel=math.radians(degrees) ** 2)
        else:
            told = rf"^modes.uff: the phases of mode 1 \(.* Hz\) scatter by {scatter:.3g}°; "
            with pytest.raises(ValueError, match=told):
                iva.Structure.read(path)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        (
            {"modal_m": 0.0},
            r"modes.uff states none of mode 2 \(.* Hz\); give modal masses in kg, φᵀMφ",
        ),
        ({"modal_m": -1.0}, r"modes.uff states -1 of mode 2"),
        (
            {"spec_data_type": 12},
            r"modes.uff has mode 2 \(.* Hz\) as a shape of acceleration, whose",
        ),
    ],
)
def test_modal_masses_that_are_missing(tmp_path: Path, changes: dict[str, Any], told: str) -> None:
    """Those of the caller go with increasing frequency, and need no unit of the file."""
    for head in ((SI,), ()):
        path = universal(tmp_path, *head, mode(3), mode(2, **changes), mode(1))
        with pytest.raises(ValueError, match=rf"^modal_masses = None: {told}"):
            iva.Structure.read(path, mass_unit="kg")
        matches(iva.Structure.read(path, modal_masses=SCALES**2), np.sign(SCALES))
    equal = [mode(k, modal_m=0.0, r1=SHAPES[:, k - 1] * 3.0) for k in (1, 2, 3)]
    found = iva.Structure.read(universal(tmp_path, *equal), modal_masses=9, directions="x")
    assert found.modes()["shape_7x"].to_numpy() == pytest.approx(SHAPES[1], rel=DIGITS)


def test_a_modal_a_that_is_none(tmp_path: Path) -> None:
    """Real shapes with 1 in the place of modal A, where 2iωm would stand."""
    sets = [turned(k, 0.0, modal_a=1.0) for k in (1, 2, 3)]
    told = r"^modal_masses = None: .* a modal A of mode 1 \(.*\) that has not the phase of its sh"
    with pytest.raises(ValueError, match=told):
        iva.Structure.read(universal(tmp_path, SI, *sets))
    sets = [turned(k, 0.0, modal_a=0.0) for k in (1, 2, 3)]
    with pytest.raises(
        ValueError, match=r"^modal_masses = None: modes.uff states none of mode 1 \("
    ):
        iva.Structure.read(universal(tmp_path, SI, *sets))


def test_what_is_chosen(tmp_path: Path) -> None:
    path = universal(tmp_path, SI, mode(1), mode(2), mode(3))
    whole = iva.Structure.read(path).modes()
    some = iva.Structure.read(path, directions="zy", nodes=[30, 12], modes=[3, 1]).modes()
    names = ["frequency_hz", "damping_ratio", "shape_12z", "shape_30z"]
    assert some.columns == ["mode", "frequency", *names]
    assert_frame_equal(some.select(names), whole[[0, 2]].select(names), check_exact=True)
    other = iva.Structure.read(
        path, damping_ratios=0.5, frequencies=[1.0, 2.0, 3.0], absorber_at="7x", base=[1, 1, 1]
    )
    assert other.modes()["damping_ratio"].to_list() == [0.5] * 3
    assert other.modes()["frequency"].to_list() == [1.0, 2.0, 3.0]
    assert (other.absorber_at, other.base) == ("7x", [1.0, 1.0, 1.0])


@pytest.mark.parametrize(
    ("arguments", "error", "told"),
    [
        (
            {"directions": "xw"},
            ValueError,
            r"directions = 'xw': give some of the letters x, y and z",
        ),
        ({"directions": ""}, ValueError, r"directions = '': give some of"),
        ({"directions": 1}, TypeError, r"directions = 1: give a word"),
        (
            {"directions": "y"},
            ValueError,
            r"directions = 'y': modes.uff has only zeros there; give o",
        ),
        ({"nodes": [12, 8]}, ValueError, r"nodes = 8: give some that the file has, 7, 12, 30$"),
        ({"nodes": []}, ValueError, r"nodes = \[\]: give some that the file has"),
        ({"nodes": "12"}, TypeError, r"nodes\[0\] = '12': give a number"),
        ({"modes": [4]}, ValueError, r"modes = 4: give some that the file has, 1, 2, 3$"),
        (
            {"modal_masses": [1, 2]},
            ValueError,
            r"modal_masses = \[1, 2\]: there are 3 modes; give a nu",
        ),
        ({"modal_masses": 0}, ValueError, r"modal_masses = 0: give numbers greater than 0"),
        ({"modal_masses": "kg"}, TypeError, r"modal_masses = 'kg': give a number"),
        (
            {"modal_masses": 1, "mass_unit": "t"},
            ValueError,
            r"mass_unit = 't': modal_masses are in kg",
        ),
        (
            {"mass_unit": "slg"},
            ValueError,
            r"mass_unit = 'slg': give one of kg.*did you mean `slug`\?",
        ),
        ({"mass_unit": 1}, TypeError, r"mass_unit = 1: give a word"),
        (
            {"modal_mass": 1},
            TypeError,
            r"modal_mass = 1: Structure.read .*did you mean `modal_masses`",
        ),
        (
            {"absorber_at": "12y"},
            ValueError,
            r"absorber_at = .12y.: give one of the points 7x, 7z, 1",
        ),
    ],
)
def test_choices_that_are_refused(
    tmp_path: Path, arguments: dict[str, Any], error: type[Exception], told: str
) -> None:
    path = universal(tmp_path, SI, mode(1), mode(2), mode(3))
    with pytest.raises(error, match=told):
        iva.Structure.read(path, **arguments)


@pytest.mark.parametrize(
    ("sets", "told"),
    [
        (
            [mode(1), mode(1, freq=99.0)],
            r"^modes.uff: mode 1 is there twice; export each mode once$",
        ),
        ([mode(1, node_nums=[7, 7, 30])], r"^modes.uff: mode 1 has a node twice"),
        (
            [mode(1, freq=0.0)],
            r"^modes.uff: mode 1 does not vibrate, for its eigenvalue is 0; choose",
        ),
        ([turned(1, 0.0, eig=-3.0 + 0j)], r"^modes.uff: mode 1 does not vibrate, .* is -3; choose"),
        ([mode(1, modal_m=math.nan)], r"^modes.uff: mode 1 has a number that is not finite"),
        (
            [mode(1, modal_damp_vis=0.0, modal_damp_his=0.04)],
            r"^damping_ratios = None: .* only a hyst",
        ),
        (
            [mode(1, spec_data_type=3)],
            r"^modes.uff: no mode shapes \(dataset 55 of analysis type 2, 3",
        ),
        ([mode(1, analysis_type=5, freq_step_n=1)], r"^modes.uff: no mode shapes"),
        ([], r"^modes.uff: no mode shapes"),
        (
            [units(0.0, 1.0), mode(1)],
            r"^modes.uff: dataset 164 has factors 0 of length and 1 of force;",
        ),
    ],
)
def test_universal_files_that_are_refused(
    tmp_path: Path, sets: list[dict[str, Any]], told: str
) -> None:
    with pytest.raises(ValueError, match=told):
        iva.Structure.read(universal(tmp_path, SI, *sets))


def test_damaged_universal_files(tmp_path: Path) -> None:
    for old, new in (
        ("  1.00000e+00  0.00000e+00  0.00000e+00\n       102", "  1.0e+00\n       102"),
        ("  3.18310e+00", "  three      "),
    ):
        damaged = written(tmp_path, TYPED.replace(old, new, 1), "bad.uff")
        with pytest.raises(
            ValueError, match=r"bad.uff: a damaged universal file \(.*\); export it a"
        ):
            iva.Structure.read(damaged)
    scalar = TYPED.replace(
        "         2         8         2         3", "         1         8         2         1"
    )
    with pytest.raises(
        ValueError, match=r"^one.uff: mode 1 has 1 numbers for each node, or too few; g"
    ):
        iva.Structure.read(written(tmp_path, scalar, "one.uff"))


def test_hysteretic_damping_is_for_the_caller_to_turn(tmp_path: Path) -> None:
    path = universal(tmp_path, SI, mode(1, modal_damp_vis=0.0, modal_damp_his=0.04))
    assert iva.Structure.read(path, damping_ratios=0.02).modes()["damping_ratio"].to_list() == [
        0.02
    ]


def test_rigid_modes_are_left_out_by_choice(tmp_path: Path) -> None:
    rigid = mode(1, freq=0.0, mode_n=9)
    path = universal(tmp_path, SI, rigid, mode(1), mode(2), mode(3))
    matches(iva.Structure.read(path, modes=[1, 2, 3]), np.sign(SCALES))
