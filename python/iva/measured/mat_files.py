"""MAT files of MATLAB and Octave, up to version 7; needs SciPy."""

from __future__ import annotations

import warnings
from collections.abc import Collection, Iterator
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from iva.measured.channels import Channel
from iva.measured.clocks import FEWEST
from iva.measured.sensor_units import parted, unit_of

#: The begin of a file of version 7.3, and the signature of the HDF5 that it is.
NEWER = (b"MATLAB 7.3", b"\x89HDF\r\n\x1a\n")


def channels_of_mat(path: str, contents: bytes) -> list[Channel]:
    """Return the vectors of numbers in a MAT file, those in structs as ``struct.field``.

    The columns of a matrix are ``name(:,1)``, ``name(:,2)``, …; of one with a row for each channel
    they are the rows, ``name(1,:)``, ``name(2,:)``, … A field of the same name in a struct
    ``units`` states the unit, as in files that this package writes.

    Raises
    ------
    ImportError
        Without SciPy.
    ValueError
        If it is of version 7.3, damaged, or has no vectors of numbers.
    """
    leaves = [
        leaf for name, value in variables(path, contents).items() for leaf in flattened(name, value)
    ]
    words = [(name, value) for name, value in leaves if value.dtype.kind == "U" and value.size]
    texts = {name: str(value.flat[0]) for name, value in words}
    sizes = [value.size for _, value in leaves if is_of_numbers(value) and 1 in value.shape]
    lengths = {size for size in sizes if size >= FEWEST}
    channels = [
        channel(name, values, texts.get(f"units.{name}", ""))
        for leaf, value in leaves
        for name, values in vectors(leaf, value, lengths)
    ]
    if not channels:
        raise ValueError(f"{path}: no vectors of real numbers in it; give times and values")
    return channels


def variables(path: str, contents: bytes) -> dict[str, Any]:
    """Return the variables of a MAT file by name, as SciPy reads them.

    Raises
    ------
    ImportError
        Without SciPy.
    ValueError
        If it is of version 7.3, or damaged.
    """
    if any(mark in contents[:1024] for mark in NEWER):
        raise ValueError(
            f"{path}: a MAT file of version 7.3, which is HDF5; save it in MATLAB with '-v7'"
        )
    try:
        from scipy.io import loadmat
    except ImportError as error:
        raise ImportError(
            "reading a MAT file needs SciPy: pip install 'iva-dynamics[export]'"
        ) from error
    from io import BytesIO

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of names that are there twice, of odd classes
            there = loadmat(BytesIO(contents), struct_as_record=True)
    except Exception as error:  # SciPy raises what comes, of several classes
        raise ValueError(f"{path}: a damaged MAT file ({error}); save it anew") from error
    return {name: value for name, value in there.items() if not name.startswith("__")}


def channel(name: str, values: NDArray[Any], stated: str) -> Channel:
    """Return a vector as a channel; its unit is the one stated, or that in its name."""
    stem, matrix, column = name.partition("(")
    bare, unit = parted(stem)
    unit = stated or unit
    return Channel(
        name=name,
        also=(bare + matrix + column,),
        unit=unit_of(unit) if unit else None,
        stated=unit,
        length=len(values),
        load=partial(values.astype, np.float64),
    )


def flattened(name: str, value: Any) -> Iterator[tuple[str, NDArray[Any]]]:
    """Give the arrays of a variable, those in structs by the names of their fields."""
    if not isinstance(value, np.ndarray):
        return
    if value.dtype.names is None:
        yield name, value
    elif value.size == 1:  # a struct; those of arrays of structs have no common name
        for field in value.dtype.names:
            yield from flattened(f"{name}.{field}", value.flat[0][field])


def is_of_numbers(value: NDArray[Any]) -> bool:
    """Return whether an array is a vector or a matrix of real numbers."""
    return value.ndim == 2 and value.dtype.kind in "iuf" and value.size > 1


def vectors(
    name: str, value: NDArray[Any], lengths: Collection[int]
) -> Iterator[tuple[str, NDArray[Any]]]:
    """Give the channels in an array: itself, or the columns or the rows of a matrix.

    Parameters
    ----------
    name : str
        Name of the array.
    value : ndarray
        The array.
    lengths : collection of int
        Lengths of the records among the vectors of the same file. Samples run along the side of a
        matrix that is as long as one of them, or else along the longer side.
    """
    if not is_of_numbers(value):
        return
    if 1 in value.shape:
        yield name, value.reshape(-1)
        return
    rows, columns = value.shape
    fits = (rows in lengths, columns in lengths)
    along_rows = fits[1] if fits[0] != fits[1] else columns > rows
    if along_rows:
        yield from ((f"{name}({row + 1},:)", value[row]) for row in range(rows))
    else:
        yield from ((f"{name}(:,{column + 1})", value[:, column]) for column in range(columns))
