"""Bars in docstrings: |x| is the size of x there, and not the name of something to put in."""

from __future__ import annotations

import re

from sphinx.application import Sphinx

# Code between backticks, which stays as it is, or a bar.
PIECE = re.compile(r"``.*?``|`[^`]*`|\|")


def escape(
    _app: Sphinx, _what: str, _name: str, _thing: object, _options: object, lines: list[str]
) -> None:
    """Escape the bars of a docstring in its place."""
    lines[:] = [PIECE.sub(lambda m: r"\|" if m[0] == "|" else m[0], line) for line in lines]


def setup(app: Sphinx) -> dict[str, bool]:
    """Tell Sphinx."""
    app.connect("autodoc-process-docstring", escape)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
