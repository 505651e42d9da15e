"""Files of structures with several modes: what they hold, as entries of :class:`iva.Structure`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from pathlib import Path

from iva import _iva
from iva.parameters import shown
from iva.structures import MATRICES, NAMES, NUMBERS, word_or_words

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Any

    import polars as pl

#: Names of matrices in the equations of motion, which variables of a MAT file may have.
LETTERS = {"M": "mass", "K": "stiffness", "C": "damping"}

#: So many modes a structure has at most.
MOST = 40

#: Directions of the numbers of a node in a universal file.
DIRECTIONS = "xyz"

#: How to give names in a MAT file; SciPy does not read strings of MATLAB in double quotes.
CELLS = "give a cell array of names in single quotes, such as {'first', 'top'}"


@dataclass(frozen=True, slots=True)
class Choices:
    """What the caller says of a universal file; of other files nothing is to be said.

    Parameters
    ----------
    directions : str
        Those that become points.
    nodes, modes : object
        Numbers of those that are read, by default of all.
    modal_masses : object
        In kg, in the place of those of the file.
    mass_unit : object
        Unit of the modal masses of the file.
    """

    directions: object = "xyz"
    nodes: object = None
    modes: object = None
    modal_masses: object = None
    mass_unit: object = None


def entries_of(file: object, choices: Choices, given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entries that a file has, together with those given, which come first.

    Raises
    ------
    TypeError
        If `file` is not the name of one.
    ImportError
        If the package is missing that reads files of this kind.
    ValueError
        If something in the file cannot be used.
    iva.IvaError, OSError
        If the file cannot be read.
    """
    if not isinstance(file, str):
        raise TypeError(f"file = {shown(file)}: give the name of a file")
    ending = Path(file).suffix.lower()
    universal = ending in (".uff", ".unv", ".uf")
    if not universal:
        for field in fields(Choices):
            value = getattr(choices, field.name)
            if value is not field.default and not (isinstance(value, str) and value == "xyz"):
                raise ValueError(
                    f"{field.name} = {shown(value)}: {_iva.visible(Path(file).name)} is no "
                    "universal file (.uff, .unv, .uf), for which this is; leave it out"
                )
    if universal or ending == ".mat":
        from iva.measured.files import check, contents_of

        check(file)
    if universal:
        found = entries_of_universal(file, choices, given)
    elif ending == ".mat":
        found = entries_of_mat(_iva.visible(file), contents_of(file), given.get("points"))
        if isinstance(found.get("points"), Mapping) and not isinstance(
            given.get("points"), Mapping
        ):
            given = {key: it for key, it in given.items() if key != "points"}  # the names are used
    else:
        found = entries_of_csv(file)
    if not given.keys().isdisjoint(("frequencies", "frequencies_hz")):
        found = {key: it for key, it in found.items() if key not in given and "freq" not in key}
    return found | dict(given)


def entries_of_csv(file: str) -> dict[str, Any]:
    """Return the modes of a CSV file, a row for each.

    Raises
    ------
    ValueError
        If a column is missing or has something else than numbers.
    OSError
        If the file cannot be read.
    """
    import polars as pl

    frame = pl.read_csv(file)
    points = {
        name.removeprefix("shape_"): column(frame, name)
        for name in frame.columns
        if name.startswith("shape_")
    }
    if not points:
        raise ValueError(f"{file}: there is no column shape_…, with the shapes at a point")
    found: dict[str, Any] = {"points": points}
    for name, told in (
        ("frequency", "frequencies"),
        ("frequency_hz", "frequencies_hz"),
        ("damping_ratio", "damping_ratios"),
        ("base", "base"),
    ):
        if name in frame.columns and not (told == "frequencies_hz" and "frequencies" in found):
            found[told] = column(frame, name)
    return found


def column(frame: pl.DataFrame, name: str) -> list[float]:
    """Return a column of numbers.

    Raises
    ------
    ValueError
        If it has something else.
    """
    values = frame[name]
    if not values.dtype.is_numeric() or values.null_count():
        raise ValueError(f"column {name}: give a number in every row")
    return [float(value) for value in values]


def entries_of_mat(path: str, contents: bytes, points: object = None) -> dict[str, Any]:
    """Return the entries in the variables of a MAT file; variables with other names are left alone.

    Parameters
    ----------
    path : str
        Name of the file, for messages.
    contents : bytes
        What it holds.
    points : object
        Names of the points in the place of those in the file, or their shapes.

    Raises
    ------
    ImportError
        Without SciPy.
    ValueError
        If the file is damaged or of version 7.3, has none of the variables, or one of another form.
    """
    from iva.measured.mat_files import variables

    found: dict[str, Any] = {}
    for name, value in variables(path, contents).items():
        entry = LETTERS.get(name, name)
        if entry not in (*NUMBERS, *MATRICES, *NAMES, "points", "shapes"):
            continue
        if entry in found:
            raise ValueError(f"{path}: it has {name} and {entry}, which mean the same; keep one")
        if value.shape and 0 not in value.shape:  # an empty one stands for none
            found[entry] = entry_of(f"{path}: {name}", entry, value)
    if found.keys().isdisjoint((*NUMBERS, *MATRICES, "shapes")):
        raise ValueError(
            f"{path}: no structure in it; give variables frequencies_hz, damping_ratios, shapes "
            "and points, or M, K, C and points"
        )
    if "shapes" in found:
        shapes = found.pop("shapes")
        if not isinstance(points, Mapping):
            names = found.get("points") if points is None else word_or_words("points", points)
            found["points"] = named(path, shapes, [names] if isinstance(names, str) else names)
    return found


def named(path: str, shapes: list[list[float]], names: list[str] | None) -> dict[str, list[float]]:
    """Return the shapes of all modes at each point, by its name.

    Raises
    ------
    ValueError
        If there are no names, not as many as columns, or two that are the same.
    """
    if names is None:
        raise ValueError(f"{path}: shapes, but no points; {CELLS}, one for each column of shapes")
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"{path}: points has {twice!r} twice; give each point another name")
    if len(shapes[0]) != len(names):
        raise ValueError(
            f"{path}: shapes has {len(shapes[0])} columns, points {len(names)} names; give a row "
            "of shapes for each mode and a column for each point"
        )
    columns = map(list, zip(*shapes, strict=True))
    return dict(zip(names, columns, strict=True))


def entry_of(field: str, entry: str, value: Any) -> Any:
    """Return a variable of a MAT file in the form of an entry.

    Parameters
    ----------
    field : str
        File and name of the variable, for messages.
    entry : str
        Name of the entry.
    value : ndarray or sparse matrix
        As SciPy reads it; not empty.

    Raises
    ------
    ValueError
        If it is of another form.

    Examples
    --------
    >>> import numpy as np
    >>> entry_of("modes.mat: shapes", "shapes", np.array([[0.1, 0.2]]))
    [[0.1, 0.2]]
    >>> entry_of("modes.mat: frequencies_hz", "frequencies_hz", np.array([[1.5], [4.0]]))
    [1.5, 4.0]
    """
    if entry in NAMES or entry == "points":
        words = list(words_of(field, value))
        return words[0] if entry in NAMES and len(words) == 1 else words
    if value.dtype.kind not in "iuf":
        raise ValueError(f"{field} holds something else than real numbers; give real numbers")
    if value.ndim != 2 or (entry in NUMBERS and 1 not in value.shape):
        size = " × ".join(map(str, value.shape))
        form = "a row or a column of numbers" if entry in NUMBERS else "a matrix"
        raise ValueError(f"{field} is an array of {size}; give {form}")
    if entry not in NUMBERS and (
        value.shape[0] > MOST or (entry in MATRICES and value.shape[1] > MOST)
    ):
        raise ValueError(
            f"{field} has {value.shape[0]} rows; give at most {MOST}, as many modes as a structure "
            "may have"
        )
    # Matrices from finite elements are often sparse.
    rows = (value.toarray() if hasattr(value, "toarray") else value).tolist()
    if entry in NUMBERS:
        return [float(number) for row in rows for number in row]
    return [[float(number) for number in row] for row in rows]


def words_of(field: str, value: Any) -> Iterator[str]:
    """Give the words in a text, in the rows of a matrix of letters, or in a cell array.

    Raises
    ------
    ValueError
        If there is something else.
    """
    for cell in value.ravel() if value.dtype.kind in "OU" else [()]:
        # SciPy makes a text of each row of letters, and an array of such texts of each cell.
        words = [cell] if isinstance(cell, str) else getattr(cell, "flat", ())
        texts = [str(word).rstrip() for word in words if isinstance(word, str)]
        if len(texts) != 1:
            raise ValueError(f"{field} holds something else than names; {CELLS}")
        yield texts[0]


def entries_of_universal(file: str, choices: Choices, given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entries of a structure in a universal file, modes by their frequencies.

    Raises
    ------
    ImportError
        Without pyuff.
    TypeError
        If a choice is of another form.
    ValueError
        If the file is damaged, has no modes, states no modal masses or no unit of them, or a mode
        is not real; or if a choice is none.
    """
    import numpy as np

    from iva.modal_masses import masses_of
    from iva.universal_modes import chosen, damping_of, modes_of, real_shape

    path = _iva.visible(Path(file).name)
    axes = axes_of(choices.directions)
    modes = modes_of(file, choices.modes, path)
    nodes = sorted({int(node) for mode in modes for node in mode.nodes})
    kept = nodes if choices.nodes is None else chosen("nodes", choices.nodes, nodes)
    masses = masses_of(modes, choices, path)
    shapes = np.zeros((len(modes), len(nodes), len(DIRECTIONS)))
    for shape, mode, mass in zip(shapes, modes, masses, strict=True):
        shape[np.searchsorted(nodes, mode.nodes)] = real_shape(mode, path) / np.sqrt(mass)
    of_points = shapes[:, np.searchsorted(nodes, kept)][:, :, axes].reshape(len(modes), -1)
    names = [f"{node}{DIRECTIONS[axis]}" for node in kept for axis in axes]
    points = {
        name: column.tolist()
        for name, column in zip(names, of_points.T, strict=True)
        if column.any()
    }
    if not points:
        raise ValueError(
            f"directions = {shown(choices.directions)}: {path} has only zeros there; give others, "
            "or other nodes"
        )
    found = {"frequencies_hz": [mode.frequency_hz for mode in modes], "points": points}
    if "damping_ratios" not in given:
        found["damping_ratios"] = [damping_of(mode, path) for mode in modes]
    return found


def axes_of(directions: object) -> list[int]:
    """Return the places of directions among x, y and z.

    Raises
    ------
    TypeError
        If it is no word.
    ValueError
        If it has other letters, or one twice.

    Examples
    --------
    >>> axes_of("xz")
    [0, 2]
    """
    if not isinstance(directions, str):
        raise TypeError(f"directions = {shown(directions)}: give a word, such as 'xyz' or 'z'")
    if not directions or len(set(directions)) < len(directions) or set(directions) - set("xyz"):
        raise ValueError(f"directions = {shown(directions)}: give some of the letters x, y and z")
    return sorted(DIRECTIONS.index(letter) for letter in directions)
