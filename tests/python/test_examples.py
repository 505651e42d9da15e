"""The studies that come with the package: all of them, copied without harm, and each is valid."""

from __future__ import annotations

from pathlib import Path

import pytest

import iva
from iva import _iva

STUDIES = Path(__file__).parents[2] / "studies"


def test_they_are_those_of_the_repository(tmp_path: Path) -> None:
    written = iva.examples.copy(tmp_path / "new")
    assert [file.name for file in written] == list(iva.examples.names())
    assert sorted(iva.examples.names()) == sorted(file.name for file in STUDIES.iterdir())
    for file in written:
        assert file.read_bytes() == (STUDIES / file.name).read_bytes()
    assert iva.examples.copy(tmp_path / "new") == []


def test_each_study_runs_from_where_it_was_copied_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert _iva.main(["iva", "examples"]) == 0
    assert "Written to studies: 14 files." in capfd.readouterr().out
    assert _iva.main(["iva", "examples"]) == 0
    assert "All 14 files are in studies already." in capfd.readouterr().out
    for study in sorted(Path("studies").glob("*.toml")):
        assert _iva.main(["iva", "check", str(study)]) == 0, study
        assert "is valid" in capfd.readouterr().out


def test_a_file_of_the_user_is_kept(tmp_path: Path) -> None:
    mine = tmp_path / "earthquake.toml"
    mine.write_text("mine", encoding="utf-8")
    with pytest.raises(ValueError, match=r"earthquake\.toml is there and has other contents"):
        iva.examples.copy(tmp_path)
    assert [file.name for file in tmp_path.iterdir()] == ["earthquake.toml"]
    assert mine.read_text(encoding="utf-8") == "mine"
    with pytest.raises(TypeError, match="folder = 3: give a path"):
        iva.examples.copy(3)  # type: ignore[arg-type]
