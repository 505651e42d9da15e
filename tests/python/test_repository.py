"""The pages for people who change the code: files and make targets that they name exist."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md")]
PAGES += sorted((ROOT / "docs").glob("*.md"))
# Folders in which the project keeps its own; a path that begins with one of them is whole.
FOLDERS = (".ci", ".github", "benches", "crates", "docs", "python", "studies", "tests")
# What a command of the project makes.
MADE = {"tests/fuzz/artifacts"}
FENCE = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
SPAN = re.compile(r"`([^`\n]+)`")
LINK = re.compile(r"\]\(([^)#:\s]+)(?:#[^)\s]*)?\)")


def paths(text: str) -> set[str]:
    """Return what a text names in backticks that is a path of the repository.

    A path has no spaces and (1) begins with one of `FOLDERS`, or with a crate of `crates`; or (2)
    ends in `.rs`, `.py` or `.yml`, whole or from some folder on: `siva/motion.rs`; or (3) is a name
    in capitals with an ending, such as `CHANGELOG.md`, or `pyproject.toml` or one of Cargo's. Other
    names may be files of a user.
    """
    named = set()
    for span in SPAN.findall(FENCE.sub("", text)):
        if not re.fullmatch(r"[\w.-]+(/[\w.-]+)*/?", span):
            continue
        whole = "/" in span and span.split("/")[0] in FOLDERS
        crate = re.match(r"iva-\w+/", span)
        source = re.search(r"\w\.(rs|py|pyi|yml)$", span)
        capitals = re.fullmatch(r"[A-Z-]{2,}\.\w+|Cargo\.(toml|lock)|pyproject\.toml", span)
        if whole or crate or source or capitals:
            named.add(span.rstrip("/"))
    return named


def exists(path: str) -> bool:
    """Return whether the repository has a path, or, of code, a file that ends with it."""
    if path in MADE or (ROOT / path).exists() or (ROOT / "crates" / path).exists():
        return True
    if path.split("/")[0] in FOLDERS or path.startswith("iva-"):
        return False
    name = path.rpartition("/")[2]
    return any(
        found.as_posix().endswith(f"/{path}")
        for folder in FOLDERS
        for found in (ROOT / folder).rglob(name)
    )


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_what_a_page_names_exists(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert [path for path in sorted(paths(text)) if not exists(path)] == []


@pytest.mark.parametrize("page", PAGES[:3], ids=lambda page: page.name)
def test_links_of_the_front_pages_lead_to_files(page: Path) -> None:
    links = LINK.findall(FENCE.sub("", page.read_text(encoding="utf-8")))
    assert [link for link in links if not (ROOT / link).exists()] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_targets_of_make_that_a_page_names_exist(page: Path) -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([a-z-]+):", makefile, flags=re.MULTILINE))
    named = set(re.findall(r"(?:^|`|&& )make ([a-z-]+)", page.read_text(encoding="utf-8"), re.M))
    assert named <= targets


def test_what_counts_as_a_path() -> None:
    text = "`siva/motion.rs`, `iva-sweep/src/no.rs`, `docs/`, `DIR/study.toml`, `map.toml`, `N.md`,"
    text += " `results/a`, `CHANGELOG.md`, `tests/none`, `a b.rs`\n```sh\n`tests/fenced`\n```\n"
    named = paths(text)
    assert named == {
        "siva/motion.rs",
        "iva-sweep/src/no.rs",
        "docs",
        "CHANGELOG.md",
        "tests/none",
    }
    assert {path for path in named if not exists(path)} == {"iva-sweep/src/no.rs", "tests/none"}
