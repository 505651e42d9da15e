"""What the build makes: pictures and help of the command for the pages, then the explorer.

What pages show goes to docs/_made. A picture of the physics is drawn by a function of `drawings`;
every other one is saved by the code of the page that shows it, which is run for that.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import drawings
import pages
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

from iva.explorer.document import page as explorer
from iva.explorer.scenes import DEFAULT

MADE = pages.DOCS / "_made"
ENVIRONMENT = os.environ | {"MPLBACKEND": "Agg", "COLUMNS": "88", "NO_COLOR": "1"}


def make(_app: Sphinx | None = None) -> None:
    """Make everything."""
    shutil.rmtree(MADE, ignore_errors=True)
    MADE.mkdir()
    for name, draw in drawings.DRAWINGS.items():
        draw(MADE / name)
    for page in pages.pages():
        shown = [file.removeprefix(pages.MADE) for file in pages.pictures(page) if made(file)]
        saved = [file for file in shown if file not in drawings.DRAWINGS]
        if saved:
            from_page(page, saved)
    (MADE / "commands.md").write_text(commands(), encoding="utf-8")


def made(file: str) -> bool:
    """Return whether the build makes a file that a page names."""
    return file.startswith(pages.MADE)


def from_page(page: Path, files: list[str]) -> None:
    """Run a page and take the pictures that it saves.

    Raises
    ------
    ExtensionError
        If it fails, or does not save them.
    """
    with tempfile.TemporaryDirectory() as folder:
        words = [sys.executable, pages.__file__, str(page), folder]
        ran = subprocess.run(words, env=ENVIRONMENT, capture_output=True, text=True)
        if ran.returncode != 0:
            raise ExtensionError(f"the code of {page.name} fails:\n{ran.stdout}{ran.stderr}")
        for file in files:
            if not Path(folder, file).is_file():
                raise ExtensionError(f"{page.name} shows {file} and does not save it")
            shutil.copy(Path(folder, file), MADE / file)


def helped(*words: str) -> str:
    """Return what `iva … --help` prints."""
    command = [sys.executable, "-m", "iva", *words, "--help"]
    ran = subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True, check=True)
    return ran.stdout


def commands() -> str:
    """Return the help of the command and of all its subcommands, as a page."""
    whole = helped()
    listed = whole.partition("Commands:\n")[2].partition("\n\n")[0]
    names = [name for name in re.findall(r"^  (\w+)", listed, re.MULTILINE) if name != "help"]
    parts = [("iva", whole), *((f"iva {name}", helped(name)) for name in names)]
    return "\n".join(f"## {title}\n\n```text\n{text}```\n" for title, text in parts)


def records(app: Sphinx, fault: Exception | None) -> None:
    """Put the records of the pages beside them."""
    if fault is None and app.builder.format == "html":
        for name, record in pages.RECORDS.items():
            shutil.copy(pages.DOCS.parent / record, Path(app.outdir, name))


def explorers(app: Sphinx, fault: Exception | None) -> None:
    """Put the explorer beside the pages: whole, and brief for the front page."""
    if fault is None and app.builder.format == "html":
        for name, brief in {"explore.html": False, "explore_brief.html": True}.items():
            Path(app.outdir, name).write_text(explorer(DEFAULT, brief=brief), encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    """Tell Sphinx."""
    app.connect("builder-inited", make)
    app.connect("build-finished", explorers)
    app.connect("build-finished", records)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
