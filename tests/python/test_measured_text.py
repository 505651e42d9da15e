"""Text of recorders in its dialects: planted numbers come back, and lines that are wrong are named.

Expected values are the decimal numbers that the tests write, read by Python's own ``float``.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given
from hypothesis import strategies as st

from iva.measured import Measured
from recordings import VALUES, rows, written


@dataclass(frozen=True)
class Style:
    """How a record is written."""

    delimiter: str
    decimal: str
    end: str
    encoding: str
    preamble: list[str]
    header: str
    number: str
    extra: str
    time_first: bool
    quoted: bool
    closed: bool
    comments: str


# What stands between the columns, and the decimal marks that go with it.
SEPARATIONS = [
    (";", ","),
    (";", "."),
    ("\t", ","),
    ("\t", "."),
    (",", "."),
    (", ", "."),
    (" ", "."),
    (" ", ","),
    ("   ", "."),
    (" ; ", ","),
]
PREAMBLES = [
    "Messung;Ausschwingversuch vom 3. Mai",
    "Abtastrate;2000 Hz",
    "Recorder 7, channel 2, IEPE 100 mV/g",
    "***End_of_Header***",
    "2000",
    'Sensor: 5" cable',
    "Gerät: Prüfstand µ°²",
    "",
]


@st.composite
def styles(draw: st.DrawFn) -> Style:
    """Draw a style in which nothing is ambiguous."""
    delimiter, decimal = draw(st.sampled_from(SEPARATIONS))
    single = delimiter.strip() != ""
    return Style(
        delimiter=delimiter,
        decimal=decimal,
        end=draw(st.sampled_from(["\n", "\r\n", "\r"])),
        encoding=draw(st.sampled_from(["utf-8", "utf-8-sig", "latin-1", "utf-16"])),
        preamble=draw(st.lists(st.sampled_from(PREAMBLES), max_size=4)),
        header=draw(
            st.sampled_from(["brackets", "round", "suffix", "comment", "row"][: 5 if single else 4])
        ),
        number=draw(st.sampled_from(["f", "e", "E", "+"])),
        extra=draw(st.sampled_from(["", "numbers", "words"])),
        time_first=draw(st.booleans()),
        quoted=draw(st.booleans()) if delimiter in ";,\t" else False,
        closed=draw(st.booleans()) if single else False,
        comments=draw(st.sampled_from(["", "#", "%", "//"])),
    )


def number(style: Style, value: float) -> str:
    """Return a number as text."""
    form = {"f": f"{value:.6f}", "e": f"{value:.9e}", "E": f"{value:.9E}", "+": f"{value:+.6f}"}
    text = form[style.number].replace(".", style.decimal)
    return f'"{text}"' if style.quoted else text


def text_of(style: Style, time: list[float], values: list[float]) -> str:
    """Return a record as text."""
    names = {
        "brackets": ["Zeit [s]", "a1 [mm/s²]"],
        "round": ["t(s)", "a1(mm/s2)"],
        "suffix": ["time_s", "a1_mm_s2"],
        "comment": ["time_s", "a1_mm_s2"],
        "row": ["Time", "a1"],
    }[style.header]
    units = ["s", "mm/s^2"]
    cells = [[number(style, t), number(style, v)] for t, v in zip(time, values, strict=True)]
    for row in [names, units, *cells]:
        if not style.time_first:
            row.reverse()
    if style.extra:
        names.insert(1, "other")
        units.insert(1, "-")
        for k, row in enumerate(cells):
            row.insert(1, number(style, k * 0.5) if style.extra == "numbers" else f"x{k}")
    table = [names, *([units] if style.header == "row" else []), *cells]
    closing = style.delimiter if style.closed else ""
    text = [style.delimiter.join(row) + closing for row in table]
    if style.header == "comment":
        text[0] = f"# {text[0]}"
    if style.comments:
        text.insert(len(text) // 2, f"{style.comments} the door was closed, 3 ; 4\t5")
        text.append("")
    return style.end.join([*style.preamble, *text]) + style.end


@given(
    styles(),
    st.lists(st.integers(-(10**6), 10**6), min_size=20, max_size=60, unique=True),
    st.integers(0, 5000),
    st.sampled_from([100, 1000, 2000, 2048, 51200]),
)
def test_what_is_written_in_any_dialect_comes_back(
    style: Style, thousandths: list[int], begin: int, rate: int
) -> None:
    values = [k / 1000 for k in thousandths]
    time = [begin / 10 + k / rate for k in range(len(values))]
    with TemporaryDirectory() as folder:
        text = text_of(style, time, values)
        path = written(Path(folder), text.encode(style.encoding, "replace"))
        record = Measured.read(path, "a1")
        assert record.values.tolist() == [value * 1e-3 for value in values]
        # Instants are rounded to 1e-6 s: the first by half of it, a straight line through them
        # may tilt by as much again from end to end.
        assert record.time == pytest.approx(time, abs=1.5e-6)
        assert record.sampling_hz == pytest.approx(rate, rel=1.5e-6 * rate / (len(values) - 1))
        assert record.quantity == "acceleration"
        assert record.name.startswith("a1")


def test_a_record_of_a_millisecond_is_not_rounded_to_seconds() -> None:
    """Of 52 samples at 51.2 kHz, written to 1e-6 s; all are less than 1e-3 s after time zero."""
    times = [k / 51200 for k in range(52)]
    written_times = [round(time, 6) for time in times]
    record = Measured(written_times, list(range(52)), "acceleration")
    assert record.time == pytest.approx(times, abs=1.5e-6)
    assert record.sampling_hz == pytest.approx(51200, rel=1.5e-6 * 51200 / 51)


@given(st.sampled_from(SEPARATIONS), st.lists(st.integers(-999, 999), min_size=20, unique=True))
def test_columns_without_names(separation: tuple[str, str], tenths: list[int]) -> None:
    delimiter, decimal = separation
    values = [k / 10 for k in tenths]
    lines = [f"{k / 100:.2f}{delimiter}{v}\n" for k, v in enumerate(values)]
    with TemporaryDirectory() as folder:
        text = "".join(line.replace(".", decimal) for line in lines)
        record = Measured.read(written(Path(folder), text), 1, time=0, unit="m")
    assert record.values.tolist() == values
    assert record.sampling_hz == 100.0
    assert record.name == ""


@pytest.mark.parametrize(
    "text",
    [
        "time a1 [g]\n{}",
        "Channel 1   Channel 2\ntime [s]   a1 [g]\n{}",
        "# time, a1 (g)\n{}",
        "% t [s]\ta1 / g\n{}",
        "# t a1_g\n# sensor 3\n# recorded by the night shift\n{}",
        "Time a1\n[s] [g]\n{}",
        "Time a1\ns g\n- 100mV/g\n{}",
        "// Zeit [s];a1 [g]\n\n\n{}",
    ],
)
def test_headers_above_blanks(tmp_path: Path, text: str) -> None:
    path = written(tmp_path, text.format("\n".join(rows(" "))))
    record = Measured.read(path, "a1", unit="g")
    assert record.values.tolist() == [value * 9.80665 for value in VALUES]
    assert record.sampling_hz == 100.0


def test_a_preamble_of_the_same_width_is_no_header(tmp_path: Path) -> None:
    # The line nearest to the numbers names the columns, not the two above it.
    text = "\n".join(["Messung;Mast", "Zeit;a [mm]", "t;b [g]", *rows()])
    record = Measured.read(written(tmp_path, text))
    assert record.name == "b [g]"
    text = "\n".join(["t;b [g]", "nothing of it", *rows()])
    with pytest.raises(ValueError, match=r"there is columns without names, 0 to 1$"):
        Measured.read(written(tmp_path, text), "b")


def test_a_preamble_longer_than_the_record(tmp_path: Path) -> None:
    preamble = [f"setting {k};on" for k in range(60)]
    path = written(tmp_path, "\n".join([*preamble, "t;a [mm]", *rows()]))
    assert Measured.read(path).values.tolist() == [value * 1e-3 for value in VALUES]


def test_decimal_commas_that_come_late(tmp_path: Path) -> None:
    values = [f"{k},5" if k > 31 else str(k) for k in range(40)]
    path = written(tmp_path, "t [ms];a [m]\n" + "\n".join(f"{k};{v}" for k, v in enumerate(values)))
    assert Measured.read(path).values.tolist() == [k + 0.5 * (k > 31) for k in range(40)]


def test_a_column_of_words_with_some_numbers(tmp_path: Path) -> None:
    lines = [f"{row};{'x' if k % 5 else k}" for k, row in enumerate(rows())]
    path = written(tmp_path, "t;a [m];note\n" + "\n".join(lines))
    assert Measured.read(path, "a").values.tolist() == VALUES


def test_numbers_of_fortran(tmp_path: Path) -> None:
    values = [f"{number:.3f}D+00" for number in VALUES]
    record = Measured.read(written(tmp_path, "t;a_g\n" + "\n".join(rows(values=values))))
    assert record.values.tolist() == [value * 9.80665 for value in VALUES]
    values = [f"{number:.3f}".replace("0.", ".").replace(".000", ".") for number in VALUES]
    record = Measured.read(written(tmp_path, "t;a_g\n" + "\n".join(rows(values=values))))
    assert record.values.tolist() == [value * 9.80665 for value in VALUES]


def test_one_column_with_decimal_commas(tmp_path: Path) -> None:
    numbers = [f"{k},{k % 9}" for k in range(40)]
    expected = [float(one.replace(",", ".")) for one in numbers]
    named = written(tmp_path, "a1 [mm]\n" + "\n".join(numbers))
    record = Measured.read(named, sampling_hz=100)
    assert record.values.tolist() == [value * 1e-3 for value in expected]
    # Of whole numbers none is written as 05, so that these are no columns.
    digits = [f"{k},{(7 * k) % 100:02}" for k in range(40)]
    record = Measured.read(written(tmp_path, "\n".join(digits)), unit="m", sampling_hz=100)
    assert record.values.tolist() == [float(one.replace(",", ".")) for one in digits]
    # Two columns of whole numbers, as their names say.
    two = written(tmp_path, "time [ms],a1 [mm]\n" + "\n".join(numbers))
    assert Measured.read(two).values.tolist() == [(k % 9) * 1e-3 for k in range(40)]
    for header in ("", "# fs = 2000\n", "Mast\n"):
        with pytest.raises(ValueError, match=r"csv: its commas may divide columns or be decimal m"):
            Measured.read(written(tmp_path, header + "\n".join(numbers)), unit="m", sampling_hz=9)


@pytest.mark.parametrize("missing", ["", "nan", "NaN", "n/a", "null", "--", "inf", "1.#QNAN"])
def test_values_that_are_missing(tmp_path: Path, missing: str) -> None:
    values: list[float | str] = [*VALUES[:11], missing, *VALUES[12:]]
    path = written(tmp_path, "t;a [g];note\n" + "\n".join(f"{row};x" for row in rows(";", values)))
    with pytest.raises(
        ValueError, match=r"^a \[g\]: 1 of 40 values are missing or not finite, the first at 0.11 s"
    ):
        Measured.read(path, "a")
    assert Measured.read(path, "a", begin=0.12).values[0] == VALUES[12] * 9.80665


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (
            "0.11;overload",
            r"csv:13: 'overload' is not a number; give numbers such as -0.5e-3, with",
        ),
        ("0.11;0,5", r"csv:13: '0,5' is not a number; give numbers such as -0.5e-3, with the same"),
        ("0.11;1.234.5", r"csv:13: '1.234.5' is not a number"),
        ("0.11;1_000", r"csv:13: '1_000' is not a number"),
        ("0.11;0x1F", r"csv:13: '0x1F' is not a number"),
        ("0.11", r"csv:13: this line has 1 columns, those before it have 2; give as many in each$"),
        ("0.11;1;2", r"csv:13: this line has 3 columns, those before it have 2; give as many in e"),
        ("pause", r"csv:13: this line has 1 columns, those before it have 2; give as many in each"),
        ("0.11;1 2", r"csv:13: '1 2' is not a number"),
        ("0.1s;1", r"csv:13: '0.1s' is not a number"),
    ],
)
def test_lines_that_are_wrong_are_named(tmp_path: Path, line: str, message: str) -> None:
    text = rows()
    text[11] = line
    with pytest.raises(ValueError, match=message):
        Measured.read(written(tmp_path, "t;a [g]\n" + "\n".join(text)))


def test_a_wrong_line_near_the_begin_does_not_become_preamble(tmp_path: Path) -> None:
    for place in (2, 3, 4):
        text = rows()
        text[place] = "pause;here"
        with pytest.raises(ValueError, match=rf"csv:{place + 2}: '(pause|here)' is not a number"):
            Measured.read(written(tmp_path, "t;a [g]\n" + "\n".join(text)))
    with pytest.raises(ValueError, match=r"csv:42: this line has 1 columns"):
        Measured.read(written(tmp_path, "t;a [g]\n" + "\n".join([*rows(), "end of record"])))


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        (b"", r"csv: the file is empty; give times and values$"),
        (b"\n\n  \n", r"csv: no columns of numbers in it; give times and values$"),
        (b"# only\n# comments\n", r"csv: no columns of numbers in it; give times and values$"),
        (b"some words\nand more\n", r"csv: no columns of numbers in it; give times and values$"),
        (b"t;a\n1;2\n", r"csv: no two lines of numbers in a row; give times and values$"),
        (b"t;a [g]\n1;2\n2;3\n", r"^the record has 2 samples; give at least 16$"),
        (b"1;2\n\x00\x00\n", r"csv: a binary file; give text in UTF-8$"),
        (b"\xff\xfe1\x00;", r"csv: damaged text \(utf-16\); give text in UTF-8$"),
        (b"\xef\xbb\xbf1;2\n\xff", r"csv: damaged text \(utf-8-sig\); give text in UTF-8$"),
    ],
)
def test_files_without_a_record(tmp_path: Path, contents: bytes, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Measured.read(written(tmp_path, contents))


def refusal(contents: bytes) -> str | None:
    """Return what is said of a file, or nothing if a record is read."""
    with TemporaryDirectory() as folder:
        path = written(Path(folder), contents, "any.txt")
        try:
            record = Measured.read(path, 0, unit="g", sampling_hz=100)
        except ValueError as error:
            return str(error)
    assert len(record) >= 16
    return None


@given(st.binary(max_size=400))
def test_any_bytes_are_read_or_refused(contents: bytes) -> None:
    assert "\n" not in (refusal(contents) or "")


@given(st.lists(st.text('01.,;-e\t "#%nat[]g/s', max_size=12), min_size=1, max_size=60))
def test_any_text_is_read_or_refused(lines: list[str]) -> None:
    assert "\n" not in (refusal("\n".join(lines).encode()) or "")


@pytest.mark.parametrize("ending", ["csv", "txt", "tsv", "dat", "asc"])
def test_endings_of_texts(tmp_path: Path, ending: str) -> None:
    path = written(tmp_path, "t;a [g]\n" + "\n".join(rows()), f"decay.{ending}")
    assert Measured.read(path).values.tolist() == [value * 9.80665 for value in VALUES]


def test_many_lines(tmp_path: Path) -> None:
    # A minute at 1 kHz: read whole, in order.
    text = "t [s]\ta [g]\n" + "".join(f"{k / 1000:.3f}\t{k % 977 - 488}\n" for k in range(60_000))
    record = Measured.read(written(tmp_path, text))
    assert record.values.tolist() == [(k % 977 - 488) * 9.80665 for k in range(60_000)]
    assert record.sampling_hz == 1000.0
