"""How Sphinx builds the site: `make docs`, into target/docs/html."""

from __future__ import annotations

import sys
from pathlib import Path

import iva

DOCS = Path(__file__).resolve().parent
sys.path.insert(0, str(DOCS))

project = "iva-dynamics"
author = "The iva-dynamics developers"
release = version = iva.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "bars",
    "formulas",
    "made",
]
exclude_patterns = ["_made"]
nitpicky = True

# Pages. Anchors of headings are those of GitHub, so that links serve in both places.
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
myst_dmath_double_inline = True
highlight_language = "none"

# Docstrings. Types stand in them in words; only names of this package are links.
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
napoleon_google_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False
nitpick_ignore_regex = [("py:.*", r"(?!iva\.).*")]

html_theme = "furo"
html_title = f"{project} {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_math_renderer = "formulas"
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
