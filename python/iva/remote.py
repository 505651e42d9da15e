"""Sweeps into a folder behind a URL: every worker writes its parts there, by fsspec.

Study and manifest are made in a folder here and copied; parts go from the worker to the URL. A file
is written under another name and then moved, so that a name in its place is a whole file.
"""

from __future__ import annotations

import hashlib
import json
import tempfile
import uuid
from collections.abc import Callable
from concurrent.futures import Executor, Future
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from iva import _iva
from iva.distributed import Part, results
from iva.faults import fault
from iva.frames import NAMES, Frames, to_polars
from iva.manifests import FILE, manifest_of, sum_of
from iva.progress import Report
from iva.tables import Table
from iva.units import from_metadata

if TYPE_CHECKING:
    import polars as pl

STUDY = "study.toml"
#: Folder of unfinished files.
WORK = ".iva-work"
#: Bytes read at once.
PIECE = 1 << 20


class Remote:
    """A folder behind a URL.

    Parameters
    ----------
    url : str
        As fsspec takes it.

    Raises
    ------
    ValueError
        If fsspec is not installed or does not know such URLs.
    """

    def __init__(self, url: str) -> None:
        try:
            import fsspec
        except ImportError:
            raise ValueError(
                f"out = {url!r}: URLs need fsspec, python3 -m pip install fsspec"
            ) from None
        try:
            fs, root = fsspec.core.url_to_fs(url)
        except (ValueError, ImportError) as error:
            raise ValueError(f"out = {url!r}: {error}") from error
        self.url = url
        self.fs: Any = fs
        self.root: str = root.rstrip("/")

    def path(self, name: str) -> str:
        """Return the full name of a file."""
        return f"{self.root}/{name}"

    def refuse_links(self) -> None:
        """Refuse a folder in which something of ours is a symbolic link.

        Raises
        ------
        ValueError
            Where what is written would go to another place.
        """
        inputs = self.path("inputs")
        names = [FILE, STUDY, WORK, "inputs", *NAMES]
        found = [self.path(name) for name in names]
        if self.fs.isdir(inputs):
            found += self.fs.ls(inputs, detail=False)
        for path in found:
            # Only file systems with links tell of them; a link to nothing does not "exist".
            try:
                info = self.fs.info(path)
            except (FileNotFoundError, NotADirectoryError):
                continue
            if info.get("islink") or info.get("type") == "link":
                raise ValueError(
                    f"out = {self.url!r}: {_iva.visible(path)} is a symbolic link, and iva writes "
                    "through none"
                )

    def put(self, file: Path, name: str) -> None:
        """Copy a file there under another name, then move it."""
        aside = self.path(f"{WORK}/{uuid.uuid4().hex}")
        self.fs.makedirs(self.path(WORK), exist_ok=True)
        self.fs.put_file(str(file), aside)
        self.fs.makedirs(self.path(name).rpartition("/")[0], exist_ok=True)
        try:
            self.fs.mv(aside, self.path(name))
        except FileExistsError:  # not all replace what is there
            self.fs.rm_file(self.path(name))
            self.fs.mv(aside, self.path(name))

    def get(self, name: str, file: Path) -> bool:
        """Copy a file here; False if there is none."""
        if not self.fs.exists(self.path(name)):
            return False
        self.fs.get_file(self.path(name), str(file))
        return True

    def is_whole(self, name: str, contents: dict[str, Any]) -> bool:
        """Tell whether a file has the bytes that its checksum is of."""
        if (
            not self.fs.exists(self.path(name))
            or self.fs.size(self.path(name)) != contents["bytes"]
        ):
            return False
        found = hashlib.sha256()
        with self.fs.open(self.path(name), "rb") as file:
            while piece := file.read(PIECE):
                found.update(piece)
        return bool(found.hexdigest() == contents["sha256"])


def part_name(table: str, number: int, style: str) -> str:
    """Return the name of a part below the folder."""
    return f"{table}/part-{number:05}.{style}"


def run_part(study: _iva.Study, part: Part, url: str, style: str) -> str:
    """Run a part on a worker and put its files behind a URL; return what they hold."""
    number, first, last = part
    remote = Remote(url)
    with tempfile.TemporaryDirectory() as folder:
        staged = study.run_part(first, last, folder, style)
        made = json.loads(staged)
        for table in made["contents"]:
            file = Path(folder) / made["folder"] / f"{table}.{style}"
            remote.put(file, part_name(table, number, style))
    return staged


def damaged_in(remote: Remote, mirror: Path, style: str) -> list[str]:
    """Take parts out of the manifest that are not what it says; return their names."""
    manifest = manifest_of(mirror)
    bad = []
    for number, part in (manifest.parts if manifest else {}).items():
        names = {part_name(table, number, style): it for table, it in part["tables"].items()}
        bad += [(number, name) for name, it in names.items() if not remote.is_whole(name, it)]
    if bad:
        file = mirror / FILE
        found = json.loads(file.read_text(encoding="utf-8"))
        for number, _ in bad:
            found["parts"].pop(str(number), None)
        file.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    return [name for _, name in bad]


def written(
    study: _iva.Study,
    pool: Executor,
    url: str,
    style: str,
    resume: bool,
    overwrite: bool,
    report: Report | None,
) -> tuple[Table, list[str]]:
    """Run a study into a folder behind a URL; return its tables and the files computed again.

    Raises
    ------
    ValueError
        If the folder cannot take the sweep, or for an invalid point.
    """
    remote = Remote(url)
    if overwrite:
        raise ValueError(
            f"overwrite = True: remove what is at {url} yourself, nothing else is safe"
        )
    remote.refuse_links()
    begun = remote.fs.exists(remote.path(FILE))
    if begun and not resume:
        raise ValueError(
            f"out = {url!r} already holds a sweep; give another URL, or resume=True to go on"
        )
    if not begun and any(remote.fs.exists(remote.path(name)) for name in NAMES):
        raise ValueError(
            f"out = {url!r} holds tables and no {FILE} to go on from; give another URL"
        )
    with tempfile.TemporaryDirectory() as folder:
        mirror = Path(folder) / "mirror"
        mirror.mkdir()
        for name in (FILE, STUDY):
            remote.get(name, mirror / name)
        damaged = damaged_in(remote, mirror, style)
        sweep, _ = _iva.SweepFolder.open(study, mirror, style, resume, False, True)
        # The manifest first: what stands beside it is told by it.
        for file in (mirror / FILE, *mirror.glob("inputs/*"), mirror / STUDY):
            remote.put(file, str(file.relative_to(mirror).as_posix()))

        def submit(part: Part) -> Future[str]:
            return pool.submit(run_part, study.part(*part[1:]), part, url, style)

        try:
            for part, staged in results(pool, sweep.missing, submit):
                sweep.enter(part[0], staged)
                remote.put(mirror / FILE, FILE)
                if report is not None:
                    done, failed = sweep.done
                    report(done, study.points, failed)
        except BaseException as error:
            done, _ = sweep.done
            sweep.abandon()
            if (mirror / FILE).exists():
                remote.put(mirror / FILE, FILE)
            error.add_note(
                f"{done} of {study.points} points are written to {url}; go on with resume=True"
            )
            raise
        sweep.close()
        remote.put(mirror / FILE, FILE)
        if remote.fs.exists(remote.path(WORK)):
            remote.fs.rm(remote.path(WORK), recursive=True)
        return opened(study, remote, mirror, style), damaged


def opened(study: _iva.Study, remote: Remote, mirror: Path, style: str) -> Table:
    """Return the tables behind a URL, each read when first asked for."""
    manifest = manifest_of(mirror)
    parts = manifest.parts if manifest else {}
    empty = study.run_points(0, 0)
    sources: dict[str, Callable[[], pl.DataFrame]] = {
        table: partial(
            rows,
            remote,
            {part_name(table, number, style): sum_of(it, table) for number, it in parts.items()},
            made,
        )
        for table, made in empty.items()
    }
    swept = tuple(study.swept)
    metadata = next(iter(empty.values())).metadata
    return Table(swept, from_metadata(metadata, swept), Frames(sources))


def rows(remote: Remote, sums: dict[str, str], table: _iva.ArrowTable) -> pl.DataFrame:
    """Return the rows of some files, each with its SHA-256; `table` has their columns and no rows.

    Raises
    ------
    iva.IvaError
        If a file is not what was written.
    """
    import polars as pl

    schema = to_polars(table).schema
    readers: dict[str, Callable[[Any], pl.DataFrame]] = {
        "parquet": pl.read_parquet,
        "arrow": pl.read_ipc,
        "csv": partial(pl.read_csv, schema=schema),
    }
    frames = []
    for name, expected in sums.items():
        with remote.fs.open(remote.path(name), "rb") as file:
            content = file.read()
        if hashlib.sha256(content).hexdigest() != expected:
            raise fault(
                f"{remote.url}/{name} is not what was written: its SHA-256 is not that of the "
                "manifest; resume the sweep to compute it again"
            )
        frames.append(readers[name.rpartition(".")[2]](content))
    return pl.concat(frames)
