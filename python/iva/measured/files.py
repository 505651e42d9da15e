"""Files of measured records: opened, and read as what their names say they are."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from stat import S_ISDIR, S_ISREG

from iva import _iva
from iva.faults import fault
from iva.forces import file_name
from iva.measured.accelerograms import channels_of_accelerogram, is_accelerogram
from iva.measured.channels import Channel
from iva.measured.labview_text import channels_of_labview_text
from iva.measured.mat_files import channels_of_mat
from iva.measured.number_series import series_in
from iva.measured.plain_text import channels_of_points, channels_of_stepped, is_plain, is_stepped
from iva.measured.strong_motion import channels_of_strong_motion
from iva.measured.tdms_files import channels_of_tdms
from iva.measured.text_files import channels_of_text, lines_of
from iva.measured.universal_files import channels_of_universal
from iva.measured.wave_files import channels_of_wave

#: Largest size of a file in bytes; an hour at 10 kHz takes about as much as text.
MOST_BYTES = 1 << 30

#: Ends of the names of texts, whose content tells what they are.
TEXTS = (".csv", ".txt", ".tsv", ".dat", ".asc", ".lvm", ".v2", ".v2c")

#: Readers of the contents of other files by the ends of their names.
READERS: dict[str, Callable[[str, bytes], list[Channel]]] = {
    ".mat": channels_of_mat,
    ".tdms": channels_of_tdms,
    ".wav": channels_of_wave,
}

#: The same by what the content says that they are, whatever their names are.
BY_CONTENT: dict[str | None, Callable[[str, bytes], list[Channel]]] = {
    "mat": channels_of_mat,
    "mat in hdf5": channels_of_mat,
    "tdms": channels_of_tdms,
    "wave": channels_of_wave,
}

#: What no reader takes, by its content, and what to do.
UNREAD: dict[str | None, str] = {
    "hdf5": "an HDF5 file; save it as text, or in MATLAB with '-v7'",
    "zip": "an Excel workbook, NPZ or other ZIP archive; save it as text (CSV)",
    "old workbook": "an Excel workbook; save it as text (CSV)",
    "npy": "an array of NumPy; give what numpy.load returns to iva.Recorded or iva.Measured",
}

#: So many lines tell what a text is.
TELLING = 250

#: Readers of files that another library opens.
OPENERS: dict[str, Callable[[str], list[Channel]]] = {
    ".at2": channels_of_accelerogram,
    ".uff": channels_of_universal,
    ".unv": channels_of_universal,
}


def channels_of(path: object, *, of_force: bool = False) -> tuple[str, list[Channel]]:
    """Return the name of a file, and its channels.

    Parameters
    ----------
    path : path-like
        The file.
    of_force : bool, default False
        It is one of a recorded force, whose name may end otherwise: text of two columns is read by
        the reader of studies, which names line and column of what it refuses.

    Raises
    ------
    TypeError
        If `path` is not the name of a file.
    ImportError
        If the package is missing that reads files of this kind.
    ValueError
        If the end of the name is not known, or something in the file cannot be used.
    iva.IvaError
        If the file cannot be read.
    """
    name = file_name(path)
    ending = Path(name).suffix.lower()
    known = (*TEXTS, *READERS, *OPENERS)
    if ending not in known and not of_force:
        raise ValueError(
            f"path = {name!r}: give a file whose name ends with one of {', '.join(known)}"
        )
    check(name)
    if ending in OPENERS:
        return name, OPENERS[ending](name)
    contents = contents_of(name)
    kind = _iva.kind_of_file(contents)
    if reader := READERS.get(ending) or BY_CONTENT.get(kind):
        return name, reader(_iva.visible(name), contents)
    if kind == "universal":
        return name, channels_of_universal(name)
    if words := UNREAD.get(kind):
        raise ValueError(f"{_iva.visible(name)}: {words}")
    lines = lines_of(_iva.visible(name), contents)
    channels = channels_of_points(name, lines) if of_force and is_plain(contents) else None
    return name, channels or channels_in_text(name, lines)


def channels_in_text(name: str, lines: Sequence[str]) -> list[Channel]:
    """Return the channels of a text, whose lines tell what it is whatever its name is.

    Raises
    ------
    ValueError
        If something in it cannot be used.
    """
    if is_accelerogram(lines):
        return channels_of_accelerogram(name)
    shown = _iva.visible(name)
    kind = _iva.kind_of_file("\n".join(lines[:TELLING]).encode())
    if kind in ("strong motion", "raw strong motion"):
        return channels_of_strong_motion(shown, lines)
    if kind == "labview text":
        return channels_of_labview_text(shown, lines)
    if is_stepped(lines):
        return channels_of_stepped(name, lines)
    return series_in(shown, lines) or channels_of_text(shown, lines)


def contents_of(name: str) -> bytes:
    """Return what a file holds.

    Raises
    ------
    ValueError
        If that is nothing.
    iva.IvaError
        If it cannot be read.
    """
    try:
        contents = Path(name).read_bytes()
    except OSError as error:
        raise fault(f"{name} cannot be read: {error.strerror}") from error
    if not contents:
        raise ValueError(f"{_iva.visible(name)}: the file is empty; give times and values")
    return contents


def check(name: str) -> None:
    """Check that a file is there, regular, and of at most 1 GiB.

    Raises
    ------
    iva.IvaError
        If it is not.
    """
    try:
        state = Path(name).stat()
    except (OSError, ValueError) as error:  # a name may hold a zero
        raise fault(f"{name} cannot be read: {getattr(error, 'strerror', error)}") from error
    if S_ISDIR(state.st_mode):
        raise fault(f"{name} cannot be read: it is a folder; give a file")
    if not S_ISREG(state.st_mode):
        raise fault(f"{name} cannot be read: it is no regular file; give a regular file")
    if state.st_size > MOST_BYTES:
        raise fault(f"{name} cannot be read: it is larger than 1 GiB")
