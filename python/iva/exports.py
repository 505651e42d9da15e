"""Files for others: MAT files for MATLAB and Octave, universal files for the software of test rigs.

Neither NumPy nor SciPy nor pyuff is imported before a file is written.
"""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from stat import S_IFREG, S_ISDIR, S_ISREG
from tempfile import TemporaryDirectory

from iva import _iva
from iva.design import design_of
from iva.faults import fault
from iva.forces import file_name, listed, written
from iva.parameters import number, shown
from iva.scenes import absorbers, seen_with_absorbers

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Any

    import numpy as np
    import polars as pl
    from numpy.typing import NDArray

    from iva.frames import Frames
    from iva.simulation import Run
    from iva.units import Units

# Bytes that MATLAB takes in one variable of a MAT file of version 7.
MAT_LIMIT = 2**31 - 1
# What a cell with a word takes in it.
CELL_BYTES = 80
# Samples of one universal file.
UFF_LIMIT = 10_000_000


@contextmanager
def aside(path: object) -> Iterator[Path]:
    """Give a file beside `path` to write to, and move it there once it is complete.

    Of a symbolic link it is what the link leads to that is written, as any program does.

    Raises
    ------
    TypeError
        If `path` is not the name of a file.
    ValueError
        If it is a folder, a pipe or a device, or in a folder that does not exist.
    iva.IvaError
        If it cannot be written; what `path` held before is then as it was.
    """
    name = file_name(path)
    try:
        target = Path(name).resolve()
        kind = target.stat().st_mode if target.exists() else S_IFREG
    except (OSError, ValueError, RuntimeError) as error:  # too long, with a zero, a loop of links
        raise ValueError(f"path = {shown(name)}: {error}; give the name of a file") from error
    if S_ISDIR(kind):
        raise ValueError(f"path = {name!r}: this is a folder, give the name of a file")
    if not S_ISREG(kind):
        raise ValueError(f"path = {name!r}: this is a pipe or a device, give the name of a file")
    if not target.parent.is_dir():
        raise ValueError(f"path = {name!r}: there is no folder {str(Path(name).parent)!r}")
    try:
        with TemporaryDirectory(prefix=".iva-", dir=target.parent) as folder:
            made = Path(folder) / "made"
            yield made
            made.replace(target)
    except OSError as error:
        reason = error.strerror or error
        raise fault(f"{name} cannot be written: {reason}") from error


def field_name(column: str) -> str:
    """Return the name of a column as that of a field of MATLAB.

    Examples
    --------
    >>> field_name("force.0.relative_frequency")
    'force_0_relative_frequency'
    """
    return re.sub(r"\W", "_", column, flags=re.ASCII)


def ascii_unit(unit: str) -> str:
    """Return a unit in letters that every program reads.

    Examples
    --------
    >>> ascii_unit("rad · ωn"), ascii_unit("m/s²")
    ('rad * omega_n', 'm/s^2')
    """
    return unit.replace("ωn", "omega_n").replace("·", "*").replace("²", "^2")


def column_of(series: pl.Series) -> NDArray[Any]:
    """Return a column as an array of shape (n, 1) that SciPy writes as MATLAB has it.

    Numbers become doubles with NaN for null, as do flags with nulls; flags without nulls stay
    flags; words become a cell array with '' for null.
    """
    import numpy as np
    import polars as pl

    if series.dtype == pl.String:
        values = np.array(series.fill_null("").to_list(), dtype=object)
    elif series.dtype == pl.Boolean and series.null_count() == 0:
        values = series.to_numpy()
    else:
        values = series.cast(pl.Float64).fill_null(math.nan).to_numpy()
    return values.reshape(-1, 1)


def struct(name: str, frame: pl.DataFrame) -> dict[str, NDArray[Any]]:
    """Return a table as a struct of columns.

    Raises
    ------
    ValueError
        If it takes more than a variable can hold.
    """
    import polars as pl

    width = sum(CELL_BYTES if kind == pl.String else 8 for kind in frame.dtypes)
    if frame.height * width > MAT_LIMIT:
        raise ValueError(
            f"{name} would take {frame.height * width / 1e9:.1f} GB, but a MAT file holds at most "
            f"{MAT_LIMIT / 1e9:.1f} GB in one table: sweep without this table, or let "
            "MATLAB read the Parquet files of a sweep with parquetread"
        )
    return {field_name(column.name): column_of(column) for column in frame}


def write_mat(
    path: object, frames: Frames, units: Units, trajectory: pl.DataFrame | None = None
) -> None:
    """Write tables, their units and the version of iva into a MAT file.

    Raises
    ------
    ImportError
        Without SciPy.
    TypeError, ValueError, iva.IvaError
        As :func:`aside` and :func:`struct`.
    """
    try:
        from scipy.io import savemat
    except ImportError as error:
        raise needs("write_mat", "SciPy") from error
    tables = {name: frames[name] for name in frames.names}
    if trajectory is not None:
        tables["trajectory"] = trajectory
    with aside(path) as made:
        contents: dict[str, object] = {name: struct(name, frame) for name, frame in tables.items()}
        contents["units"] = {
            name: {field_name(key): ascii_unit(units[name][key]) for key in frame.columns}
            for name, frame in tables.items()
        }
        contents["iva_version"] = _iva.VERSION
        savemat(
            made,
            contents,
            appendmat=False,
            format="5",
            long_field_names=True,
            do_compression=True,
            oned_as="column",
        )


def needs(method: str, package: str) -> ImportError:
    """Return what to say if a package of the extra ``export`` is missing."""
    return ImportError(f"{method} needs {package}: pip install 'iva-dynamics[export]'")


@dataclass(frozen=True, slots=True)
class Measure:
    """What an axis of a dataset 58 shows.

    Parameters
    ----------
    name : str
        In words.
    kind : int
        Its specific data type in SI units.
    units : mapping of str to str
        Its unit by system of units, in at most 20 letters.
    """

    name: str
    kind: int
    units: Mapping[str, str]


TIME = Measure("time", 17, {"si": "s", "seconds": "s", "natural": "1/omega_n"})
DISPLACEMENT = Measure(
    "displacement", 8, {"si": "m", "seconds": "unit of x", "natural": "unit of x"}
)
VELOCITY = Measure(
    "velocity", 11, {"si": "m/s", "seconds": "unit of x/s", "natural": "unit of x*omega_n"}
)
GENERAL = 1  # the specific data type of what has a unit of its own
# The units of a file: m, N and degrees Celsius, as they are.
SI = {
    "type": 164,
    "units_code": 1,
    "units_description": "SI",
    "temp_mode": 1,
    "length": 1.0,
    "force": 1.0,
    "temp": 1.0,
    "temp_offset": 273.15,
}


def write_uff(
    path: object,
    run: Run,
    samples_per_period: float | None,
    samples_per_second: float | None,
    binary: bool,
) -> None:
    """Write the motion of a run into a universal file.

    Raises
    ------
    ImportError
        Without pyuff.
    TypeError, ValueError, iva.IvaError
        As :meth:`iva.Run.write_uff`.
    """
    try:
        import pyuff
    except ImportError as error:
        raise needs("write_uff", "pyuff") from error
    if not isinstance(binary, bool):
        raise TypeError(f"binary = {shown(binary)}: give True or False")
    sets = datasets(run, instants(run, samples_per_period, samples_per_second), binary)
    with aside(path) as made:
        file = pyuff.UFF(str(made))
        try:
            with warnings.catch_warnings():
                # pyuff 2.5.8 leaves the file of a binary set to be closed when it is forgotten.
                warnings.simplefilter("ignore", ResourceWarning)
                # "overwrite" would cut off the head of the first binary set.
                file.write_sets(sets, "add")
        except Exception as error:  # pyuff hides what the system said behind a word of its own
            raise OSError(str(error.__context__ or error)) from error
        if file.get_n_sets() != len(sets):  # what fails as a file is forgotten raises nothing
            raise OSError("a part of it is missing")


def instants(
    run: Run, samples_per_period: float | None, samples_per_second: float | None
) -> NDArray[np.float64]:
    """Return equidistant instants from 0 to the end of a run.

    Raises
    ------
    TypeError, ValueError
        As :meth:`iva.Run.write_uff`.
    """
    import numpy as np

    if samples_per_second is None:
        field = "samples_per_period"
        given = 200 if samples_per_period is None else samples_per_period
        step = 2.0 * math.pi / (design_of(run).natural_frequency * positive(field, given))
    else:
        field, given = "samples_per_second", samples_per_second
        if samples_per_period is not None:
            raise ValueError(f"{field} = {shown(given)}: samples_per_period is given as well")
        step = 1.0 / positive(field, given)
        if run.units.system == "natural":
            raise ValueError(
                f"{field} = {shown(given)}: the run has no seconds (ωn = 1), give "
                "samples_per_period"
            )
    # The file holds the step with six digits: the samples are taken where it says they are.
    step = float(f"{step:.5e}")
    end: float = run.trajectory(1)["time"][-1]
    count = math.floor(end / step) + 1
    if not 2 <= count <= UFF_LIMIT:
        raise ValueError(
            f"{field} = {shown(given)}: the file would have {count} of them, give a number that "
            f"makes it 2 to {UFF_LIMIT}"
        )
    times: NDArray[np.float64] = np.arange(count, dtype=np.float64) * step
    # Rounding may put the last one behind the end.
    return times if times[-1] <= end else times[:-1]


def positive(field: str, value: object) -> float:
    """Return a number greater than 0, at most a thousand million.

    Raises
    ------
    TypeError, ValueError
        If it is none.
    """
    found = number(field, value)
    if not 0.0 < found <= 1e9:
        raise ValueError(f"{field} = {shown(value)}: give a number greater than 0, at most 1e9")
    return found


def datasets(run: Run, times: NDArray[np.float64], binary: bool) -> list[dict[str, Any]]:
    """Return the datasets of a universal file: in SI units 164, then one 58 a measured motion."""
    import polars as pl

    seen_with_absorbers(run)
    states = run.at(times).filter(pl.col("displacement").is_finite())
    count = design_of(run).absorbers
    first = states[:: max(count, 1)]
    x, v = first["displacement"].to_numpy(), first["velocity"].to_numpy()
    motions = [(1, "structure", DISPLACEMENT, x), (1, "structure", VELOCITY, v)]
    for place in range(count):
        own = {name: column.to_numpy() for name, column in states[place::count].to_dict().items()}
        y, w = design_of(run, place).beside(own)
        node, body = place + 2, "absorber" if count == 1 else f"absorber {place}"
        motions += [(node, body, DISPLACEMENT, x + y), (node, body, VELOCITY, v + w)]
    system = run.units.system
    si = system == "si"
    made: list[dict[str, Any]] = [dict(SI)] if si else []
    driven = "; ".join(written(force) for force in listed(run.force)) or "free decay"
    for number_of_set, (node, body, measure, values) in enumerate(motions, start=1):
        made.append(
            {
                "type": 58,
                "binary": int(binary),
                "id1": line(f"{measure.name} of {body}, iva-dynamics {_iva.VERSION}"),
                "id2": line("; ".join(written(absorber) for absorber in absorbers(run.absorber))),
                "id3": "NONE",  # where others look for a date
                "id4": line(written(run.primary)),
                "id5": line(f"{written(run.start)}; {driven}"),
                "func_type": 1,
                "func_id": number_of_set,
                "rsp_node": node,
                "rsp_dir": 1,
                "ref_node": 0,
                "ref_dir": 0,
                "abscissa_spacing": 1,
                "abscissa_spec_data_type": GENERAL if system == "natural" else TIME.kind,
                "abscissa_axis_lab": TIME.name,
                "abscissa_axis_units_lab": TIME.units[system],
                "ordinate_spec_data_type": measure.kind if si else GENERAL,
                "ordinate_axis_lab": measure.name,
                "ordinate_axis_units_lab": measure.units[system],
                "orddenom_spec_data_type": 0,
                "x": times[: len(values)],
                "data": values,
            }
        )
    return made


def line(text: str) -> str:
    """Return a text as a line of a universal file: 80 letters of ASCII at most."""
    return " ".join(text.split()).encode("ascii", "replace").decode()[:80]
