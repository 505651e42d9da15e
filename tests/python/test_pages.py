"""The pages in docs: their code runs, they leave out no key and no column, their links lead on.

What there is to describe is asked of the program: numbers from its table of fields, the other keys
from a resolved study, columns from the units of a result, metadata from a written file, names from
the package. Pages are found and run by docs/pages.py, as by the build of the site.
"""

from __future__ import annotations

import importlib.util
import re
import shutil
import subprocess
import sys
import tomllib
import types
from pathlib import Path

import matplotlib as mpl
import polars as pl
import pytest

import iva
from iva import _iva

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
README = ROOT / "README.md"


def module_of_docs(name: str) -> types.ModuleType:
    """Return a module of docs, which is no package."""
    spec = importlib.util.spec_from_file_location(name, DOCS / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # as its dataclasses want
    spec.loader.exec_module(module)
    return module


pages = module_of_docs("pages")
PAGES: list[Path] = pages.pages()
WITH_CODE = [page for page in [*PAGES, README] if any(block.runs for block in pages.blocks(page))]
LINK = re.compile(r"(?<!!)\[[^\]]*\]\((?P<file>[^)#:\s]*)(?P<anchor>#[^)\s]+)?\)")

STUDY = """
version = 1
[absorber]
kind = "siva"
mass_ratio = 0.1
restitution = 0.5
relative_clearance = 0.6
[start]
displacement = 1.0
[run]
periods = 2
[sweep]
mass_ratio = [0.05, 0.1]
"""


def section(page: str, begin: str, end: str) -> str:
    """Return the rows of tables between a heading and the next of its kind."""
    text = (DOCS / page).read_text(encoding="utf-8")
    assert text.count(begin) == 1, f"{page} has not one {begin!r}"
    body = text.partition(begin)[2].partition(end)[0]
    return "\n".join(line for line in body.splitlines() if line.startswith("|"))


def names_of(page: Path) -> str:
    """Return the name of a page, from docs; of the front page of the project just its name."""
    return page.name if page == README else page.relative_to(DOCS).as_posix()


def test_fences_are_closed_and_say_their_language() -> None:
    known = {*pages.RUNNABLE, *pages.DIRECTIVES, "text"}
    for page in PAGES:
        fences = page.read_text(encoding="utf-8").count("\n```")
        languages = [block.language for block in pages.blocks(page)]
        assert fences == 2 * len(languages), f"{page.name} has a fence without its pair"
        assert set(languages) <= known, f"{page.name}: {languages}"


def test_most_pages_have_code() -> None:
    named = {names_of(page) for page in WITH_CODE}
    assert named >= {
        "basins.md",
        "bifurcations.md",
        "design-a-damper.md",
        "earthquake.md",
        "getting-started.md",
        "large-sweeps.md",
        "physics.md",
        "recipes.md",
        "reproducibility.md",
        "study-file.md",
        "tolerance-study.md",
    }


@pytest.mark.parametrize("page", WITH_CODE, ids=names_of)
def test_code_of_a_page(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pyplot = pytest.importorskip("matplotlib.pyplot")
    monkeypatch.chdir(tmp_path)
    with mpl.rc_context():
        pyplot.switch_backend("agg")
        try:
            assert pages.run_page(page, tmp_path) > 0
        finally:
            pyplot.close("all")
    # The build takes pictures from here; others are drawings, or kept.
    drawings = module_of_docs("drawings").DRAWINGS
    for shown in pages.pictures(page):
        name = shown.removeprefix(pages.MADE)
        assert name in drawings or any(
            (folder / name).is_file() for folder in (tmp_path, page.parent)
        ), f"{page.name} shows {shown}, and its code does not save it"


def test_a_page_must_print_what_it_says(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    text = "```python\nprint(2 + 2, 'or so')\n```\n\n<!-- printed -->\n```text\n{}\n```\n"
    page.write_text(text.format("4 ..."), encoding="utf-8")
    assert pages.run_page(page, tmp_path) == 1
    page.write_text(text.format("5 ..."), encoding="utf-8")
    with pytest.raises(AssertionError, match=r"page.md:7: printed was\n4 or so"):
        pages.run_page(page, tmp_path)


def test_links_lead_to_files_and_headings() -> None:
    for page in [*PAGES, README]:
        for match in LINK.finditer(page.read_text(encoding="utf-8")):
            target = (page.parent / match["file"]).resolve() if match["file"] else page
            assert target.is_file(), f"{page.name} links to {match['file']}"
            if match["anchor"]:
                there = anchors(target)
                assert match["anchor"][1:] in there, f"{page.name}: {match[0]}, of {there}"


def anchors(page: Path) -> list[str]:
    """Return the anchors of the headings of a page, as GitHub and the site make them."""
    text = pages.FENCE.sub("", page.read_text(encoding="utf-8"))
    headings = re.findall(r"^#+ (.+)$", text, flags=re.MULTILINE)
    words = (re.sub(r"[^\w\- ]", "", heading.lower()) for heading in headings)
    return [heading.replace(" ", "-") for heading in words]


def test_every_page_is_in_the_navigation() -> None:
    entries: list[str] = []
    for page in PAGES:
        for block in pages.blocks(page):
            if block.language == "{toctree}":
                lines = [line for line in block.code.splitlines() if line and line[0] != ":"]
                entries += [re.sub(r".*<(.+)>", r"\1", line) for line in lines]
    assert sorted(entries) == sorted({names_of(page)[:-3] for page in PAGES} - {"index"})


def test_every_public_name_is_in_the_reference() -> None:
    text = (DOCS / "python.md").read_text(encoding="utf-8")
    described = set(re.findall(r"^\.\. (?:auto\w+|data):: (\S+)$", text, flags=re.MULTILINE))
    missing = [name for name in iva.__all__ if f"iva.{name}" not in described]
    assert missing == []


def test_the_rust_example_prints_what_its_page_says() -> None:
    page = DOCS / "rust.md"
    blocks = pages.blocks(page)
    number, code = next(
        (number, block)
        for number, block in enumerate(blocks)
        if block.language == "{literalinclude}"
    )
    example = (page.parent / code.argument).resolve()
    told = blocks[number + 1].code
    cargo = shutil.which("cargo")
    if cargo is None:
        pytest.skip("no cargo")
    # Of the whole workspace, of which `make test` has built it.
    words = [cargo, "run", "--quiet", "--locked", "--release", "--example", example.stem]
    ran = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout == told


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder that `iva sweep` wrote."""
    home = tmp_path_factory.mktemp("written")
    (home / "small.toml").write_text(STUDY, encoding="utf-8")
    out = home / "out"
    assert _iva.main(["iva", "sweep", str(home / "small.toml"), "--out", str(out), "--quiet"]) == 0
    return out


@pytest.mark.parametrize("part", ["primary", "absorber", "force", "start", "run"])
def test_every_number_has_a_row_in_its_section(part: str) -> None:
    rows = section("study-file.md", f"| **`[{part}]`**", "| **`[")
    missing = [name for name, _, _ in _iva.fields(part, "piva") if f"| `{name}` |" not in rows]
    assert missing == []


def test_every_other_key_has_a_row_in_its_section(folder: Path) -> None:
    resolved = tomllib.loads((folder / "study.toml").read_text(encoding="utf-8"))
    assert "| `version` |" in (DOCS / "study-file.md").read_text(encoding="utf-8")
    for part in set(resolved) - {"version"}:
        rows = section("study-file.md", f"| **`[{part}]`**", "| **`[")
        # The keys of [sweep] are those of the other sections.
        keys = [] if part == "sweep" else resolved[part]
        assert [key for key in keys if f"| `{key}` |" not in rows] == [], part


@pytest.mark.parametrize(
    "table",
    ["summary", "impacts", "episodes", "envelope", "stroboscope", "absorbers", "trajectory"],
)
def test_every_column_is_described_at_its_table(table: str) -> None:
    rows = section("tables.md", f"## `{table}`", "\n## ").splitlines()
    described = {name for row in rows for name in re.findall(r"`(\w+)`", row.split("|")[1])}
    assert set(iva.Units("si")[table]) - described == {"point"}


def test_every_metadata_key_is_described(folder: Path) -> None:
    text = (DOCS / "tables.md").read_text(encoding="utf-8")
    metadata = pl.read_parquet_metadata(folder / "summary" / "part-00000.parquet")
    keys = [key for key in metadata if key.startswith("iva.")]
    assert "iva.schema_version" in keys
    assert [key for key in keys if f"`{key}`" not in text] == []
