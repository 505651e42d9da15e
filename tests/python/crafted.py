"""Small files that claim more than they hold, written byte by byte after the specifications.

A Parquet file of one column x of doubles whose rows are all equal: a dictionary of one value, and
one run of indices of no bits. Whatever the number of rows, it takes some 200 bytes.
"""

from __future__ import annotations

import struct
from pathlib import Path

import polars as pl

I32, I64, BINARY, LIST, STRUCT = 5, 6, 8, 9, 12


def varint(value: int) -> bytes:
    out = b""
    while value > 0x7F:
        out += bytes([value & 0x7F | 0x80])
        value >>= 7
    return out + bytes([value])


def whole(value: int) -> bytes:
    return varint(value << 1 if value >= 0 else (-value << 1) - 1)


def text(value: str) -> bytes:
    return varint(len(value)) + value.encode()


def several(kind: int, *items: bytes) -> bytes:
    return bytes([len(items) << 4 | kind]) + b"".join(items)


def fields(*given: tuple[int, int, bytes]) -> bytes:
    """Return a structure of (number, type, value) in Thrift's compact protocol."""
    out, last = b"", 0
    for number, kind, value in given:
        out += bytes([(number - last) << 4 | kind]) + value
        last = number
    return out + b"\0"


def equal_rows(file: Path, rows: int, value: float = 0.25, claimed: int | None = None) -> Path:
    """Write so many equal rows; the footer says `claimed`."""
    double, plain, rle, dictionary = 5, 0, 3, 8
    stored = struct.pack("<d", value)
    run = b"\x01" + varint(rows << 1) + b"\0"  # indices of one bit, a run of zeros
    pages = b""
    for kind, body, number, head in (
        (2, stored, 7, fields((1, I32, whole(1)), (2, I32, whole(plain)))),
        (
            0,
            run,
            5,
            fields(
                (1, I32, whole(rows)),
                (2, I32, whole(dictionary)),
                (3, I32, whole(rle)),
                (4, I32, whole(rle)),
            ),
        ),
    ):
        length = whole(len(body))
        pages += fields(
            (1, I32, whole(kind)), (2, I32, length), (3, I32, length), (number, STRUCT, head)
        )
        pages += body
        if kind == 2:
            dictionary_end = 4 + len(pages)
    count = whole(rows if claimed is None else claimed)
    size = whole(len(pages))
    column = fields(
        (1, I32, whole(double)),
        (2, LIST, several(I32, whole(plain), whole(dictionary))),
        (3, LIST, several(BINARY, text("mass_ratio"))),
        (4, I32, whole(0)),
        (5, I64, count),
        (6, I64, size),
        (7, I64, size),
        (9, I64, whole(dictionary_end)),
        (11, I64, whole(4)),
    )
    group = fields(
        (1, LIST, several(STRUCT, fields((2, I64, whole(4)), (3, STRUCT, column)))),
        (2, I64, size),
        (3, I64, count),
    )
    root = fields((4, BINARY, text("schema")), (5, I32, whole(1)))
    leaf = fields((1, I32, whole(double)), (3, I32, whole(0)), (4, BINARY, text("mass_ratio")))
    footer = fields(
        (1, I32, whole(1)),
        (2, LIST, several(STRUCT, root, leaf)),
        (3, I64, count),
        (4, LIST, several(STRUCT, group)),
    )
    file.write_bytes(b"PAR1" + pages + footer + struct.pack("<I", len(footer)) + b"PAR1")
    return file


def arrow_claims(file: Path, bytes_claimed: int) -> Path:
    """Write three rows as Arrow, in a footer that claims so many bytes of numbers."""
    pl.DataFrame({"mass_ratio": [0.05, 0.1, 0.15]}).write_ipc(file)
    content = bytearray(file.read_bytes())
    (length,) = struct.unpack("<i", content[-10:-6])
    # The block of the footer: offset, length of the head, 4 bytes of nothing, length of the body.
    for at in range(len(content) - 10 - length, len(content) - 34):
        offset, head, _, body = struct.unpack_from("<qiiq", content, at)
        if (
            0 < offset < len(content)
            and 0 < head < 1000
            and body > 0
            and offset + head + body <= at
        ):
            struct.pack_into("<q", content, at + 16, bytes_claimed)
            file.write_bytes(content)
            return file
    raise AssertionError("no block in the footer")
