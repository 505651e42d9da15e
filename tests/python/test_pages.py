"""The pages in docs: their code runs, they leave out no key and no column, their links lead on.

What there is to describe is asked of the program: numbers from its table of fields, the other keys
from a resolved study, columns from the units of a result, metadata from a written file.
"""

from __future__ import annotations

import re
import shlex
import tomllib
from dataclasses import dataclass
from pathlib import Path

import polars as pl
import pytest

import iva
from iva import _iva

DOCS = Path(__file__).parents[2] / "docs"
PAGES = sorted(DOCS.glob("*.md"))
RUNNABLE = ("python", "sh", "toml")
FENCE = re.compile(r"^```(?P<language>\w*)\n(?P<code>.*?)^```$", re.MULTILINE | re.DOTALL)
REMARK = re.compile(r"<!-- (?P<key>not run|file): (?P<value>.+) -->\n\Z")

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


@dataclass(frozen=True)
class Block:
    """A fenced block of a page, and what the comment just before it says."""

    language: str
    code: str
    line: int
    remark: dict[str, str]


def blocks(page: Path) -> list[Block]:
    text = page.read_text(encoding="utf-8")
    found = []
    for match in FENCE.finditer(text):
        remark = REMARK.search(text, 0, match.start())
        said = {remark["key"]: remark["value"]} if remark else {}
        line = text.count("\n", 0, match.start()) + 2
        found.append(Block(match["language"], match["code"], line, said))
    return found


def section(page: str, begin: str, end: str) -> str:
    """Return the rows of tables between a heading and the next of its kind."""
    text = (DOCS / page).read_text(encoding="utf-8")
    assert text.count(begin) == 1, f"{page} has not one {begin!r}"
    body = text.partition(begin)[2].partition(end)[0]
    return "\n".join(line for line in body.splitlines() if line.startswith("|"))


def run_commands(code: str, place: str) -> None:
    """Run lines of `iva …`; a comment `# exit code N` says what is expected, else 0."""
    for line in code.splitlines():
        words = shlex.split(line, comments=True)
        assert words[0] == "iva", f"{place}: only iva is run here, not {line!r}"
        expected = re.search(r"# exit code (\d+)$", line)
        assert _iva.main(words) == (int(expected[1]) if expected else 0), f"{place}: {line}"


def run_block(block: Block, page: Path, names: dict[str, object]) -> None:
    place = f"{page.name}:{block.line}"
    if block.language == "python":
        # Empty lines before it, so that a traceback shows the line of the page.
        source = "\n" * (block.line - 1) + block.code
        exec(compile(source, str(page), "exec"), names)
    elif block.language == "sh":
        run_commands(block.code, place)
    else:
        assert block.code.startswith("version"), f"{place}: not a whole study"
        file = Path(block.remark.get("file", "study.toml"))
        file.write_text(block.code, encoding="utf-8")
        assert _iva.main(["iva", "check", str(file)]) == 0, f"{place}: the study is refused"


def test_fences_are_closed_and_say_their_language() -> None:
    for page in PAGES:
        fences = page.read_text(encoding="utf-8").count("\n```")
        languages = [block.language for block in blocks(page)]
        assert fences == 2 * len(languages), f"{page.name} has a fence without its pair"
        assert set(languages) <= {*RUNNABLE, "text"}, f"{page.name}: {languages}"


WITH_CODE = ["large-sweeps.md", "recipes.md", "reproducibility.md", "study-file.md"]


@pytest.mark.parametrize("name", WITH_CODE)
def test_code_of_a_page(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "studies").symlink_to(DOCS.parent / "studies")
    page = DOCS / name
    names: dict[str, object] = {"__name__": "__main__"}
    ran = 0
    for block in blocks(page):
        if block.language in RUNNABLE and "not run" not in block.remark:
            run_block(block, page, names)
            ran += 1
    assert ran > 0


def test_pages_with_code_are_run() -> None:
    with_code = [
        page.name for page in PAGES if any(block.language in RUNNABLE for block in blocks(page))
    ]
    assert with_code == WITH_CODE


def test_links_lead_to_files() -> None:
    for page in PAGES:
        for target in re.findall(r"\]\(([^)#:]+)\)", page.read_text(encoding="utf-8")):
            assert (page.parent / target).is_file(), f"{page.name} links to {target}"


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
    "table", ["summary", "impacts", "episodes", "envelope", "stroboscope", "trajectory"]
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
