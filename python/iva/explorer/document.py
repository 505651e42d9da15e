"""The page of the explorer: its parts in one file that opens from a disk."""

from __future__ import annotations

import json
import re
from base64 import b64encode
from functools import cache
from importlib.resources import files

from iva._iva import VERSION
from iva.explorer.scenes import Explored

#: The modules of the page, each after those that it uses.
MODULES = (
    "engine format takeaway plot slots units address state motion measures worker time_views "
    "planes drawing controls map forced explorer"
).split()

WEB = files("iva.explorer") / "web"


def read(name: str) -> str:
    """Return the text of a file of the page."""
    return (WEB / name).read_text(encoding="utf-8")


@cache
def simulator() -> str:
    """Return the simulator, a module of WebAssembly compressed by gzip, in base64."""
    return b64encode((WEB / "simulator.wasm.gz").read_bytes()).decode("ascii")


@cache
def script() -> str:
    """Return all modules as one: names stand in one scope, so that nothing is imported."""
    whole = "\n".join(read(f"{name}.js") for name in MODULES)
    without_imports = re.sub(r"(?ms)^import\s.*?;$\n?", "", whole)
    return re.sub(r"(?m)^export ", "", without_imports)


def page(scene: Explored, *, brief: bool = False) -> str:
    """Return the page with a scene to begin with; `brief`: the drawing, x(t) and sliders alone."""
    parts = {
        "%STYLE%": read("explorer.css"),
        "%SCRIPT%": script(),
        "%WASM%": simulator(),
        # A text in it must not end the element that holds it.
        "%SCENE%": json.dumps(scene).replace("<", "\\u003c"),
        "%VERSION%": VERSION,
        "%BRIEF%": json.dumps(brief),
    }
    return re.sub("|".join(parts), lambda found: parts[found.group()], read("page.html"))
