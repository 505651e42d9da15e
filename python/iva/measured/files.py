"""Files of measured records: opened, and read as what their names say they are."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from stat import S_ISDIR, S_ISREG

from iva import _iva
from iva.faults import fault
from iva.forces import file_name
from iva.measured.accelerograms import channels_of_accelerogram
from iva.measured.channels import Channel
from iva.measured.mat_files import channels_of_mat
from iva.measured.text_files import channels_of_text
from iva.measured.universal_files import channels_of_universal

#: Largest size of a file in bytes; an hour at 10 kHz takes about as much as text.
MOST_BYTES = 1 << 30

#: Readers of the contents of a file, and of one that another library opens, by the end of its name.
READERS: dict[str, Callable[[str, bytes], list[Channel]]] = {
    ".csv": channels_of_text,
    ".txt": channels_of_text,
    ".tsv": channels_of_text,
    ".dat": channels_of_text,
    ".asc": channels_of_text,
    ".mat": channels_of_mat,
}
OPENERS: dict[str, Callable[[str], list[Channel]]] = {
    ".at2": channels_of_accelerogram,
    ".uff": channels_of_universal,
    ".unv": channels_of_universal,
}


def channels_of(path: object) -> tuple[str, list[Channel]]:
    """Return the name of a file, and its channels.

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
    if ending not in READERS and ending not in OPENERS:
        known = ", ".join((*READERS, *OPENERS))
        raise ValueError(f"path = {name!r}: give a file whose name ends with one of {known}")
    check(name)
    if ending in OPENERS:
        return name, OPENERS[ending](name)
    return name, READERS[ending](_iva.visible(name), contents_of(name))


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
        raise fault(f"{name} cannot be read: it is no regular file")
    if state.st_size > MOST_BYTES:
        raise fault(f"{name} cannot be read: it is larger than 1 GiB")
