"""What notebooks and reports of faults show."""

from __future__ import annotations

import platform
import re
from importlib.metadata import PackageNotFoundError
from xml.etree import ElementTree

import polars as pl
import pytest

import iva
from iva import _iva, markup


def cells(html: str) -> dict[str, list[str | None]]:
    """Parse the markup; return heading → cells of every row."""
    tree = ElementTree.fromstring(html)
    return {str(line[0].text): [cell.text for cell in line[1:]] for line in tree.iter("tr")}


def test_a_run(run: iva.Run) -> None:
    html = run._repr_html_()
    shown = cells(html)
    assert "Run: finished" in html
    assert "ωn = 1: time in 1/ωn" in html
    assert shown["absorber"][0] == repr(run.absorber)
    assert shown["primary"][0] == "Primary(damping_ratio=0.01)"
    assert shown["impacts"][0] == str(run.impacts.height)
    assert shown["energy_initial"] == ["0.5", run.units["summary"]["energy_initial"]]


def test_measures_without_value_are_left_out(siva: iva.Siva) -> None:
    run = iva.simulate(
        siva,
        iva.Primary(),
        start=iva.Start(displacement=1.0),
        periods=2,
        measures=["damping_ratio_1"],
    )
    assert list(cells(run._repr_html_())) == ["absorber", "primary", "start", "damping_ratio_1"]


def test_a_table(table: iva.Table) -> None:
    html = table._repr_html_()
    shown = cells(html)
    assert "Table over relative_clearance × mass_ratio" in html
    assert shown["relative_clearance"][0] == "0.4 … 0.8, 3 values"
    assert shown["points"][0] == "6"
    assert shown["outcome finished"][0] == "6"
    assert shown["tables"][0] == "summary, impacts, episodes, envelope"


def test_a_table_without_summary(siva: iva.Siva) -> None:
    table = iva.sweep(
        siva,
        iva.Primary(),
        over={"mass_ratio": [0.1]},
        start=iva.Start(displacement=1.0),
        periods=1,
        tables="impacts",
    )
    assert list(cells(table._repr_html_())) == ["tables"]


def test_what_looks_like_markup_is_escaped() -> None:
    html = markup.page("<b>", [("<i>", "a & b", "<u>")], "<script>")
    assert re.findall(r"<(b|i|u|script)>", html) == []
    assert cells(html) == {"<i>": ["a & b", "<u>"]}


def test_show_versions(capsys: pytest.CaptureFixture[str]) -> None:
    iva.show_versions()
    lines = dict(line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines())
    assert lines["iva"].startswith(_iva.VERSION)
    assert lines["python"].startswith(platform.python_version())
    assert lines["polars"] == pl.__version__
    assert int(lines["threads"].split()[0]) >= 1
    assert set(lines) == {"iva", "python", "polars", "numpy", "tqdm", "platform", "threads"}


def test_show_versions_without_a_package(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(name: str) -> str:
        raise PackageNotFoundError(name)

    monkeypatch.setattr("importlib.metadata.version", missing)
    iva.show_versions()
    assert "tqdm      not installed" in capsys.readouterr().out
