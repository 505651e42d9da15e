"""What must agree before a version is released."""

from __future__ import annotations

import re
import runpy
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import iva

ROOT = Path(__file__).parents[2]
PROGRAM = runpy.run_path(str(ROOT / ".ci" / "release.py"))
faults: Callable[[Path, str | None], list[str]] = PROGRAM["faults"]
FILES = ("Cargo.toml", "crates/iva-wasm/Cargo.toml", "CITATION.cff", *PROGRAM["LOCKS"])


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """Return a copy of the files that state a version, with a section of the change log for it."""
    for name in FILES:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    citation = tmp_path / "CITATION.cff"
    undated = re.sub(r"^date-released:.*\n", "", citation.read_text(encoding="utf-8"), flags=re.M)
    citation.write_text(f"{undated}date-released: 2001-02-03\n", encoding="utf-8")
    sections = (f"## {iva.__version__} (2001-02-03)", "- It works.", "## 0.0.1 (2000-01-01)")
    log = "\n\n".join(("# Changelog", *sections, ""))
    (tmp_path / "CHANGELOG.md").write_text(log, encoding="utf-8")
    return tmp_path


def replace(file: Path, old: str, new: str) -> None:
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new), encoding="utf-8")


def test_all_files_name_one_version() -> None:
    assert faults(ROOT, None) == []


def test_a_tag_that_is_ready(root: Path) -> None:
    assert faults(root, f"v{iva.__version__}") == []


@pytest.mark.parametrize("tag", ["9.9.9", "v9.9.9", f"{iva.__version__}"])
def test_a_tag_of_another_version(root: Path, tag: str) -> None:
    (said,) = faults(root, tag)
    assert f"the tag is {tag}" in said
    assert f"it must be v{iva.__version__}" in said


@pytest.mark.parametrize("name", FILES)
def test_another_version_in_one_file(root: Path, name: str) -> None:
    replace(root / name, iva.__version__, "9.9.9")
    said = faults(root, None)
    assert said != []
    assert all("9.9.9" in line for line in said)


def test_a_change_log_without_the_section(root: Path) -> None:
    replace(root / "CHANGELOG.md", f"## {iva.__version__} (2001-02-03)", "## Unreleased")
    said = faults(root, f"v{iva.__version__}")
    assert said == [
        f'CHANGELOG.md has no section "## {iva.__version__} (date)" with something in it'
    ]


def test_an_empty_section(root: Path) -> None:
    replace(root / "CHANGELOG.md", "- It works.\n", "")
    (said,) = faults(root, f"v{iva.__version__}")
    assert "with something in it" in said


def test_a_date_that_is_missing_or_another(root: Path) -> None:
    replace(root / "CITATION.cff", "2001-02-03", "2001-02-04")
    (said,) = faults(root, f"v{iva.__version__}")
    assert said == "date-released of CITATION.cff is 2001-02-04, CHANGELOG.md says 2001-02-03"
    replace(root / "CITATION.cff", "date-released: 2001-02-04\n", "")
    (said,) = faults(root, f"v{iva.__version__}")
    assert said == "date-released of CITATION.cff is none, CHANGELOG.md says 2001-02-03"
