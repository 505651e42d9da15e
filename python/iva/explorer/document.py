"""The page of the explorer: its parts in one file that opens from a disk."""

from __future__ import annotations

import json
import lzma
import re
from base64 import b85encode
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


def written(packed: bytes) -> str:
    """Return bytes in base 85; the sign that begins the end of an element is another."""
    return b85encode(packed).decode("ascii").replace("<", "/")


@cache
def simulator() -> str:
    """Return the simulator, a module of WebAssembly in the format .lzma, as a text."""
    return written((WEB / "simulator.wasm.lzma").read_bytes())


@cache
def packed() -> str:
    """Return the script in the format .lzma, as a text."""
    style = json.dumps(re.sub(r"(?m)^ +", "", read("explorer.css")))
    whole = f"{script()}export {{ mount }};\nexport const style = {style};\n"
    return written(lzma.compress(whole.encode(), lzma.FORMAT_ALONE, preset=9))


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
    return plain("\n".join(read(f"{name}.js") for name in MODULES))


def plain(whole: str) -> str:
    """Return modules without what a page does not need."""
    for pattern in SUPERFLUOUS:
        whole = re.sub(pattern, "", whole)
    return whole


def page(scene: Explored, *, brief: bool = False) -> str:
    """Return the page with a scene to begin with; `brief`: the drawing, x(t) and sliders alone."""
    parts = {
        "%UNPACK%": plain(read("unpack.js")),
        "%SCRIPT%": packed(),
        "%WASM%": simulator(),
        # A text in it must not end the element that holds it.
        "%SCENE%": json.dumps(scene).replace("<", "\\u003c"),
        "%VERSION%": VERSION,
        "%BRIEF%": json.dumps(brief),
    }
    return re.sub("|".join(parts), lambda found: parts[found.group()], read("page.html"))
