r"""Formulas as outlines, made by the build: SVG in the page, drawn by matplotlib from LaTeX.

So that they look the same everywhere, without a script, a network or a font for mathematics. What
is understood is the mathtext of matplotlib, and ``\begin{aligned}`` with one ``&`` a line.
"""

from __future__ import annotations

import html
import re

import matplotlib as mpl
from docutils import nodes
from matplotlib.font_manager import FontProperties
from matplotlib.path import Path
from matplotlib.textpath import TextPath, text_to_path
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

logger = logging.getLogger(__name__)
#: Units of the outlines in an em.
EM = 100.0
#: Beside and between lines, in em.
MARGIN, LEADING = 0.06, 0.75
COMMANDS = {Path.MOVETO: "M", Path.LINETO: "L", Path.CURVE3: "Q", Path.CURVE4: "C"}
ALIGNED = re.compile(r"\\begin\{aligned\}(?P<lines>.*?)\\end\{aligned\}", re.DOTALL)


class Piece:
    """A part of a formula that stands in one line: its outline, and its size in em."""

    def __init__(self, tex: str) -> None:
        self.outline, self.width, self.height, self.depth = "", 0.0, 0.0, 0.0
        if tex.strip():
            font = FontProperties(size=EM)
            text = f"${' '.join(tex.split())}$"
            self.outline = outline(TextPath((0, 0), text, prop=font))
            sizes = text_to_path.get_text_width_height_descent(text, font, ismath=True)
            width, height, self.depth = (size / EM for size in sizes)
            self.width, self.height = width, height - self.depth


def outline(path: Path) -> str:
    """Return a path in the words of SVG, y downwards."""
    words = []
    for points, code in path.iter_segments(simplify=False, curves=True):
        if code == Path.CLOSEPOLY:
            words.append("Z")
            continue
        flipped = (f"{-v:.1f}" if index % 2 else f"{v:.1f}" for index, v in enumerate(points))
        words.append(COMMANDS[code] + " ".join(flipped))
    return "".join(words)


def rows_of(tex: str) -> list[list[Piece]]:
    """Return the lines of a formula, each cut where lines are aligned."""
    aligned = ALIGNED.fullmatch(tex.strip())
    lines = re.split(r"\\\\", aligned["lines"]) if aligned else [tex]
    return [[Piece(part) for part in line.split("&")] for line in lines if line.strip()]


def drawing(tex: str) -> str:
    """Return a formula as an image within a page, of the colour and size of its text."""
    with mpl.rc_context({"mathtext.fontset": "stix"}):
        rows = rows_of(tex)
    first = max(row[0].width for row in rows)
    down, wide, paths = 0.0, 0.0, []
    for index, row in enumerate(rows):
        high = max(0.7, *(piece.height for piece in row))
        down += high + (LEADING if index else 0.0)
        # The first pieces end where the others begin.
        across = MARGIN + (first - row[0].width if len(row) > 1 else 0.0)
        for piece in row:
            place = f"translate({EM * across:.1f} {EM * down:.1f})"
            paths.append(f'<path transform="{place}" d="{piece.outline}"/>')
            across += piece.width
        wide, base = max(wide, across + MARGIN), down
        down += max(0.22, *(piece.depth for piece in row))
    depth = down - base
    size = f"width:{wide:.3f}em;height:{down:.3f}em;vertical-align:{-depth:.3f}em"
    return (
        f'<svg class="formula" role="img" aria-label="{html.escape(tex.strip())}" style="{size}" '
        f'viewBox="0 0 {EM * wide:.1f} {EM * down:.1f}">{"".join(paths)}</svg>'
    )


def converted(node: nodes.math | nodes.math_block, tex: str) -> str:
    """Return a formula as an image; a warning, which ends the build, if it is not understood."""
    try:
        return drawing(tex)
    except ValueError as error:
        logger.warning("formula: %s", error, location=node)
        return ""


def inline(self: HTML5Translator, node: nodes.math) -> None:
    """Write a formula within a line."""
    self.body.append(converted(node, node.astext()))
    raise nodes.SkipNode


def block(self: HTML5Translator, node: nodes.math_block) -> None:
    """Write a formula of its own line."""
    tex = node.astext().replace(r"\frac", r"\dfrac")
    self.body.append(f'<div class="formula">{converted(node, tex)}</div>\n')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Tell Sphinx."""
    app.add_html_math_renderer("formulas", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
