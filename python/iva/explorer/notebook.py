"""The explorer as a widget of notebooks: Jupyter, marimo and others, by anywidget."""

from __future__ import annotations

import json
from functools import cache

import anywidget
import traitlets

from iva._iva import VERSION
from iva.explorer.document import plain, read, script, simulator
from iva.explorer.scenes import Explored


@cache
def module() -> str:
    """Return what a notebook runs: the page's script, its simulator, and the widget's functions."""
    given = f"const WASM = {json.dumps(simulator())};\nconst VERSION = {json.dumps(VERSION)};\n"
    return plain(read("unpack.js")) + script() + given + read("notebook.js")


class Widget(anywidget.AnyWidget):
    """A scene to be dragged; `scene` is what the sliders say."""

    scene = traitlets.Dict().tag(sync=True)
    _esm = traitlets.Unicode().tag(sync=True)
    _css = traitlets.Unicode().tag(sync=True)

    def __init__(self, scene: Explored) -> None:
        super().__init__(scene=scene, _esm=module(), _css=read("explorer.css"))
