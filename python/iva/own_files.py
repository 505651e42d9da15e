"""Files in a folder of ours: each is there whole or not at all, and no link is followed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from iva import _iva


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a new file to write to, which takes the place of `path` once it is complete.

    A link that somebody put there is replaced; what it leads to is not touched.

    Raises
    ------
    iva.IvaError
        If it cannot be written; what was there before is then as it was.
    """
    try:
        with TemporaryDirectory(prefix=".iva-", dir=path.parent) as folder:
            made = Path(folder) / path.name
            yield made
            made.replace(path)
    except OSError as fault:
        raise _iva.IvaError(f"{path} cannot be written: {fault.strerror or fault}") from fault
