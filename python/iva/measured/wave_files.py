"""WAV files of sound cards and portable recorders: samples as fractions of full scale.

What full scale is stands nowhere in such a file, so it is asked for. Read are PCM of 8 to 32 bits
and floating-point samples, in the container RIFF (Microsoft and IBM, 1991).
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray

from iva.measured.channels import Channel
from iva.measured.clocks import evenly

#: Codes of the format: PCM, floating point, and one whose code stands further on.
PCM, FLOAT, EXTENSIBLE = 1, 3, 0xFFFE

#: Begin of the chunk ``fmt``: code, channels, rate, bytes a second, bytes a frame, bits a sample.
FIELDS = struct.Struct("<HHIIHH")

#: Where the code stands in the chunk of an extensible format.
CODE_AT = 24


def channels_of_wave(path: str, contents: bytes) -> list[Channel]:
    """Return the channels of a WAV file, ``channel 1``, ``channel 2``, …, from −1 to 1.

    Raises
    ------
    ValueError
        If it is damaged, or its samples are compressed.
    """
    if contents[:4] != b"RIFF" or contents[8:12] != b"WAVE":
        raise ValueError(f"{path}: not a WAV file (RIFF); give one of PCM or floating point")
    chunks = dict(chunks_of(contents))
    header, data = chunks.get(b"fmt ", b""), chunks.get(b"data", b"")
    if len(header) < FIELDS.size or not data:
        raise ValueError(f"{path}: a damaged WAV file without format or samples; record it anew")
    code, count, rate, _, _, bits = FIELDS.unpack_from(header)
    if code == EXTENSIBLE and len(header) >= CODE_AT + 2:
        (code,) = struct.unpack_from("<H", header, CODE_AT)
    samples = fractions(data, code, bits)
    if samples is None or not count or not rate:
        raise ValueError(
            f"{path}: a WAV file of format {code} with {bits} bits; give PCM of 8, 16, 24 or 32 "
            "bits, or floating point of 32 or 64"
        )
    frames = samples[: len(samples) // count * count].reshape(-1, count)
    return [
        Channel(
            name=f"channel {place + 1}",
            also=(),
            unit=None,
            stated="",
            length=len(frames),
            load=frames[:, place].copy,
            clock=partial(evenly, 0.0, 1.0 / rate, len(frames)),
            is_fraction=True,
        )
        for place in range(count)
    ]


def chunks_of(contents: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Give names and contents of the chunks of a RIFF file."""
    at = 12
    while at + 8 <= len(contents):
        (size,) = struct.unpack_from("<I", contents, at + 4)
        yield contents[at : at + 4], contents[at + 8 : at + 8 + size]
        at += 8 + size + size % 2  # chunks begin at even places


def fractions(data: bytes, code: int, bits: int) -> NDArray[np.float64] | None:
    """Return samples as fractions of full scale, or none if their format is not read."""
    width = bits // 8
    if (code, bits) in {(FLOAT, 32), (FLOAT, 64)}:
        whole = data[: len(data) // width * width]
        return np.frombuffer(whole, dtype=f"<f{width}").astype(np.float64)
    if code != PCM or bits not in (8, 16, 24, 32):
        return None
    raw = np.frombuffer(data[: len(data) // width * width], dtype=np.uint8).reshape(-1, width)
    if width == 1:  # the only one without a sign
        return raw[:, 0].astype(np.float64) / 128.0 - 1.0
    # The bytes are the upper ones of whole numbers of 32 bits.
    upper = np.zeros((len(raw), 4), dtype=np.uint8)
    upper[:, 4 - width :] = raw
    return upper.view("<i4")[:, 0].astype(np.float64) / 2.0**31
