"""The code in the pages: found, and run, by the tests and for the pictures of the site.

A page is a document of Markdown. What a fence holds is run if its language is one of `RUNNABLE`,
in the order of the page and in one folder:

* `python`: all blocks of a page share their names;
* `sh`: lines of `iva …`, each of which must end with the exit code of its comment, else with 0;
* `toml`: a whole study, kept as `study.toml` and given to `iva check`.

A comment just before a fence may say `<!-- not run: reason -->`, or `<!-- file: name.toml -->`. A
fence of `text` after `<!-- printed -->` is what the block before it prints, where `...` stands for
anything.

    python docs/pages.py PAGE FOLDER

runs a page in a folder, from which the build takes the pictures that it saved.
"""

from __future__ import annotations

import contextlib
import doctest
import io
import os
import re
import shlex
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

DOCS = Path(__file__).resolve().parent
RUNNABLE = ("python", "sh", "toml")
# What Sphinx is told in a fence; nothing of it is code.
DIRECTIVES = ("{eval-rst}", "{include}", "{literalinclude}", "{raw}", "{toctree}")
FENCE = re.compile(
    r"^```(?P<language>\{[\w-]+\}|\w*)(?P<argument> [^\n]*)?\n(?P<code>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
REMARK = re.compile(r"<!-- (?P<key>not run|file|printed)(?:: (?P<value>.+))? -->\n\Z")
PICTURE = re.compile(r"!\[[^\]]*\]\((?P<file>[^)]+)\)")
#: Where the build puts what it makes, seen from a page.
MADE = "_made/"
#: Measured records that pages read: a name in the folder of the page → its file.
RECORDS = {"decay.csv": "studies/decay.csv"}


@dataclass(frozen=True)
class Block:
    """A fenced block of a page, and what the comment just before it says."""

    language: str
    argument: str
    code: str
    line: int
    remark: dict[str, str]

    @property
    def runs(self) -> bool:
        """Whether it is run."""
        return self.language in RUNNABLE and "not run" not in self.remark

    @property
    def is_printed(self) -> bool:
        """Whether it is what the block before it prints."""
        return self.language == "text" and "printed" in self.remark


def pages() -> list[Path]:
    """Return all pages, those in folders too."""
    return sorted(page for page in DOCS.rglob("*.md") if "_made" not in page.parts)


def blocks(page: Path) -> list[Block]:
    """Return the fenced blocks of a page."""
    text = page.read_text(encoding="utf-8")
    found = []
    for match in FENCE.finditer(text):
        remark = REMARK.search(text, 0, match.start())
        said = {remark["key"]: remark["value"] or ""} if remark else {}
        line = text.count("\n", 0, match.start()) + 2
        argument = (match["argument"] or "").strip()
        found.append(Block(match["language"], argument, match["code"], line, said))
    return found


def pictures(page: Path) -> list[str]:
    """Return the files of the pictures that a page shows, as it names them."""
    return [match["file"] for match in PICTURE.finditer(page.read_text(encoding="utf-8"))]


def run_page(page: Path, folder: Path) -> int:
    """Run the blocks of a page in a folder; return how many there were."""
    studies = folder / "studies"
    if not studies.exists():
        studies.symlink_to(DOCS.parent / "studies")
    for name, record in RECORDS.items():
        shutil.copy(DOCS.parent / record, Path(folder, name))
    names: dict[str, object] = {"__name__": "__main__"}
    ran = 0
    printed = ""
    with contextlib.chdir(folder):
        for block in blocks(page):
            if block.runs:
                with output() as printing:
                    run_block(block, page, names)
                printed = printing()
                ran += 1
            elif block.is_printed:
                place = f"{page.name}:{block.line}"
                assert matches(block.code, printed), f"{place}: printed was\n{printed}"
    return ran


@contextlib.contextmanager
def output() -> Iterator[Callable[[], str]]:
    """Catch what Python and the command print; give a function that tells it afterwards."""
    with tempfile.TemporaryFile() as file:
        python = io.TextIOWrapper(file, encoding="utf-8", write_through=True)
        sys.stdout.flush()
        kept = os.dup(1)
        os.dup2(file.fileno(), 1)
        text = ""

        def told() -> str:
            return text

        try:
            with contextlib.redirect_stdout(python):
                yield told
        finally:
            os.dup2(kept, 1)
            os.close(kept)
            file.seek(0)
            text = file.read().decode()
            python.detach()
            print(text, end="")


def matches(told: str, printed: str) -> bool:
    """Return whether a page tells what was printed, up to blanks; `...` stands for anything."""
    flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    return doctest.OutputChecker().check_output(told, printed, flags)


def run_block(block: Block, page: Path, names: dict[str, object]) -> None:
    """Run one block in the current folder.

    Raises
    ------
    AssertionError
        If it does not do what it says.
    """
    from iva import _iva

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
        if "[optimise]" in block.code:  # for a command in Python
            from iva.optimisation.studies import of_study

            of_study(file)
            return
        assert _iva.main(["iva", "check", str(file)]) == 0, f"{place}: the study is refused"


def run_commands(code: str, place: str) -> None:
    """Run lines of `iva …`; a comment `# exit code N` says what is expected, else 0.

    Lines of `make` and `source` are those of the front page, for a clone: they are left out.
    """
    from iva import _iva

    for line in code.splitlines():
        words = shlex.split(line, comments=True)
        if words[0] in ("make", "source") and place.startswith("README.md:"):
            continue
        assert words[0] == "iva", f"{place}: only iva is run here, not {line!r}"
        expected = re.search(r"# exit code (\d+)$", line)
        if words[1] == "reproduce":
            from iva.paper.command import main

            code_of_exit = main(words[2:])
        elif words[1] == "optimise":
            from iva.optimisation.command import main as optimise

            code_of_exit = optimise(words[2:])
        elif words[1] == "identify":
            from iva.identification.command import main as identify

            code_of_exit = identify(words[2:])
        elif words[1] == "explore":
            from iva.explorer.command import main as explore

            code_of_exit = explore(words[2:])
        else:
            code_of_exit = _iva.main(words)
        assert code_of_exit == (int(expected[1]) if expected else 0), f"{place}: {line}"


if __name__ == "__main__":
    run_page(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve())
