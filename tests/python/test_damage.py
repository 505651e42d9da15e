"""Thousands of damaged files: no value changes unsaid, nothing panics, ends Python or hangs.

``IVA_DAMAGE=2500 pytest -s tests/python/test_damage.py`` makes so many mutations of each kind of
file (four of results, three of points, of which the seeds are 0, 1, 2 and so on) and prints what
became of them.
"""

from __future__ import annotations

import os
import random
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import polars as pl
import pytest

import iva
from iva import _iva

COUNT = int(os.environ.get("IVA_DAMAGE", "150"))
# Seconds that reading a small file may take on a busy machine.
PATIENCE = 20.0

STUDY = """version = 1
[primary]
damping_ratio = 0.01
[absorber]
kind = "siva"
restitution = 0.5
relative_clearance = 0.6
[start]
displacement = 1.0
[run]
periods = 6
tables = ["summary", "impacts", "envelope"]
"""
SINGLE = STUDY.replace("restitution", "mass_ratio = 0.15\nrestitution")
TABLES = ("summary", "impacts", "envelope")


def mutated(content: bytes, dice: random.Random) -> bytes:
    """Return a content with something in it changed."""
    new = bytearray(content)
    at = dice.randrange(len(new))
    match dice.randrange(8):
        case 0 | 1:
            new[at] ^= 1 << dice.randrange(8)
        case 2:
            new[at] = dice.choice((0, 1, 0x7F, 0x80, 0xFF, ord("0"), ord(","), ord("\n")))
        case 3:
            # Lengths and offsets have four or eight bytes.
            size = dice.choice((4, 8))
            value = dice.choice((0, 2**31 - 1, 10**15, 2**63 - 1, 2**64 - 1, dice.getrandbits(64)))
            new[at : at + size] = value.to_bytes(8, "little")[:size]
        case 4:
            del new[at:]
        case 5:
            del new[at : at + dice.randrange(1, 9)]
        case 6:
            new[at:at] = dice.randbytes(dice.randrange(1, 9))
        case _:
            other = dice.randrange(len(new))
            size = dice.randrange(1, 17)
            new[at : at + size] = new[other : other + size]
    return bytes(new)


@contextmanager
def damaged(file: Path, dice: random.Random) -> Iterator[bool]:
    """Damage a file for a while; says whether anything changed."""
    content = file.read_bytes()
    new = mutated(content, dice)
    stamp = dice.getrandbits(40)
    file.write_bytes(new)
    # Written twice within a moment it would seem unchanged to who remembers it.
    os.utime(file, ns=(stamp, stamp))
    begun = time.monotonic()
    try:
        yield new != content
    finally:
        assert time.monotonic() - begun < PATIENCE
        file.write_bytes(content)
        os.utime(file, ns=(stamp + 1, stamp + 1))


def one_line(error: Exception, named: str = "") -> None:
    assert "\n" not in str(error)
    assert "\x1b" not in str(error)
    assert named in str(error)


def is_same(one: iva.Table, other: iva.Table) -> bool:
    # NaN equals NaN here, and types count.
    return one == other


def report(name: str, found: Counter[str]) -> None:
    print(f"\n{name}: {', '.join(f'{count} {what}' for what, count in sorted(found.items()))}")


@pytest.mark.parametrize("style", ["parquet", "arrow", "csv"])
def test_no_value_of_a_sweep_changes_unsaid(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], style: str
) -> None:
    study = tmp_path / "study.toml"
    sweep = "[sweep]\nmass_ratio = [0.05, 0.1, 0.15]\n"
    study.write_text(STUDY + sweep, encoding="utf-8")
    out = tmp_path / "out"
    args = ["iva", "sweep", str(study), "--out", str(out), "--quiet", "--format", style]
    assert _iva.main(args) == 0
    whole = iva.read(out)
    assert whole == iva.read(out, check=False)
    # Parts more often than the two small files beside them.
    files = sorted(out.glob("*/part-*")) * 3 + [out / "manifest.json", out / "study.toml"]
    found: Counter[str] = Counter()
    for seed in range(COUNT):
        dice = random.Random(seed)
        file = dice.choice(files)
        with damaged(file, dice) as changed:
            try:
                table = iva.read(out)
                same = is_same(table, whole)
            except (iva.IvaError, ValueError) as error:
                one_line(error)
                found["refused"] += 1
                continue
        assert same, f"seed {seed}: {file} was read as something else"
        assert file.suffix in (".json", ".toml") or not changed, f"seed {seed}: {file}"
        found["no value of any table concerned"] += 1
    assert capfd.readouterr().err == ""
    with capfd.disabled():
        report(f"results as {style}", found)


@pytest.mark.parametrize("style", ["parquet", "arrow"])
def test_a_run_that_nothing_vouches_for_is_read_or_refused(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], style: str
) -> None:
    study = tmp_path / "study.toml"
    study.write_text(SINGLE, encoding="utf-8")
    out = tmp_path / "out"
    args = ["iva", "run", str(study), "--out", str(out), "--quiet", "--format", style]
    assert _iva.main(args) == 0
    files = sorted(out.glob("*/part-*"))
    found: Counter[str] = Counter()
    for seed in range(COUNT):
        dice = random.Random(seed)
        with damaged(dice.choice(files), dice):
            try:
                table = iva.read(out)
                for name in TABLES:
                    getattr(table, name)
                found["read"] += 1
            except (iva.IvaError, ValueError) as error:
                one_line(error)
                found["refused"] += 1
    assert capfd.readouterr().err == ""
    with capfd.disabled():
        report(f"a run as {style}", found)


@pytest.mark.parametrize("ending", ["parquet", "arrow", "csv", "pages.parquet"])
def test_any_file_of_points_is_read_or_refused(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], ending: str
) -> None:
    dice = random.Random(1)
    frame = pl.DataFrame(
        {
            "mass_ratio": [dice.uniform(0.05, 0.2) for _ in range(300)],
            "relative_clearance": np.repeat([0.5, 0.6, 0.7], 100),
            "max_impacts": range(1, 301),
        }
    )
    file = tmp_path / f"points.{ending}"
    if ending == "arrow":
        frame.write_ipc(file)
    elif ending == "csv":
        frame.write_csv(file)
    else:
        # With statistics and pages of their own, and without.
        small = {"compression": "snappy", "statistics": True, "data_page_size": 256}
        more = {"compression": "zstd"} if ending == "parquet" else small
        frame.write_parquet(file, **more)
    study = tmp_path / "study.toml"
    text = STUDY.replace("relative_clearance = 0.6\n", "")
    study.write_text(f"{text}[sampling]\npoints = '{file.name}'\n", encoding="utf-8")
    assert _iva.empty_tables(study)
    found: Counter[str] = Counter()
    for seed in range(COUNT):
        with damaged(file, random.Random(seed)):
            try:
                _iva.empty_tables(study)
                found["read"] += 1
            except iva.IvaError as error:
                one_line(error, file.name)
                found["refused"] += 1
    assert capfd.readouterr().err == ""
    with capfd.disabled():
        report(f"points as {ending}", found)
