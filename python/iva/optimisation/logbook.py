"""What was run, batch by batch, so that a search that was stopped goes on where it was.

The search is determined by its seed. To go on it is begun again, and takes what it has run already
from here: no state is kept that could fail to fit.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING
from zipfile import BadZipFile

import numpy as np

from iva.own_files import replacing

if TYPE_CHECKING:
    from iva.optimisation.criteria import Numbers

#: Folder of the batches inside the one that is written.
RUNS = "runs"


@dataclass
class Logbook:
    """Keeps batches of runs in a folder, or nowhere.

    Parameters
    ----------
    folder : Path or None
        Where to; it exists.
    asked : str
        Digest of the problem.
    """

    folder: Path | None
    asked: str
    _batch: int = field(default=0)

    def entry(
        self, rows: list[tuple[str, Numbers]], run: Callable[[], Numbers], measures: int
    ) -> Numbers:
        """Return the values of some rows, from the folder or by running them.

        Raises
        ------
        iva.IvaError
            If a file cannot be read or written, or does not belong to these rows.
        """
        self._batch += 1
        if self.folder is None:
            return run()
        path = self.folder / RUNS / f"{self._batch:06}.npz"
        digest = hashlib.sha256(self.asked.encode())
        for key, values in rows:
            digest.update(key.encode() + b"\0" + np.ascontiguousarray(values).tobytes())
        mark = digest.hexdigest()
        count = rows[0][1].size
        if path.is_file():
            found = read(path, mark, (measures, count))
            if found is not None:
                return found
        values = run()
        written(path, mark, values)
        return values


def read(path: Path, mark: str, shape: tuple[int, int]) -> Numbers | None:
    """Return the values of a file; ``None`` if it is damaged or of other rows."""
    try:
        with np.load(path, allow_pickle=False) as file:
            values = np.asarray(file["values"], dtype=float)
            fits = str(file["mark"]) == mark and values.shape == shape
    except (OSError, ValueError, KeyError, EOFError, MemoryError, BadZipFile):
        return None
    return values if fits and not np.isnan(values).any() else None


def written(path: Path, mark: str, values: Numbers) -> None:
    """Write a batch; the file has its name only once it is complete.

    Raises
    ------
    iva.IvaError
        If it cannot be written.
    """
    with replacing(path) as made, made.open("wb") as file:
        np.savez(file, mark=np.array(mark), values=values)
