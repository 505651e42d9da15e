"""The page of the explorer: its parts in one file that opens from a disk."""

from __future__ import annotations

import json
import re
from base64 import b64encode
from functools import cache
from gzip import compress
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
def packed() -> str:
    """Return the script, compressed by gzip, in base64."""
    style = json.dumps(re.sub(r"(?m)^ +", "", read("explorer.css")))
    whole = f"{script()}export {{ mount }};\nexport const style = {style};\n"
    return b64encode(compress(whole.encode(), 9, mtime=0)).decode("ascii")


#: What a page does not need of its modules: imports, for names stand in one scope, comments that
#: fill lines, and indentation.
SUPERFLUOUS = (
    r"(?ms)^import\s.*?;$\n?",
    r"(?m)^export ",
    r"(?ms)^ */\*\*.*?\*/\n",
    r"(?m)^ *//.*\n",
    r"(?m)^ +|^\n",
)


@cache
def script() -> str:
    """Return all modules as one."""
    whole = "\n".join(read(f"{name}.js") for name in MODULES)
    for pattern in SUPERFLUOUS:
        whole = re.sub(pattern, "", whole)
    return whole


def page(scene: Explored, *, brief: bool = False) -> str:
    """Return the page with a scene to begin with; `brief`: the drawing, x(t) and sliders alone."""
    parts = {
        "%SCRIPT%": packed(),
        "%WASM%": simulator(),
        # A text in it must not end the element that holds it.
        "%SCENE%": json.dumps(scene).replace("<", "\\u003c"),
        "%VERSION%": VERSION,
        "%BRIEF%": json.dumps(brief),
    }
    return re.sub("|".join(parts), lambda found: parts[found.group()], read("page.html"))
