"""The examples of the docstrings and of the front page."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
import re
from pathlib import Path

import pytest

import iva
from iva import _iva

ROOT = Path(__file__).parents[2]
MODULES = ["iva"] + [
    f"iva.{module.name}"
    for module in pkgutil.iter_modules(iva.__path__)
    if not module.name.startswith("_")
]
# Nothing in them is called by users, or all of it needs files.
WITHOUT = {
    f"iva.{name}"
    for name in (
        "distributed frames manifests markup parts progress reading remote scanning scenes tables"
    ).split()
}


@pytest.mark.parametrize("name", MODULES)
def test_examples(name: str) -> None:
    module = importlib.import_module(name)
    found = doctest.testmod(module, extraglobs={"iva": iva}, optionflags=doctest.ELLIPSIS)
    assert found.failed == 0
    assert (found.attempted == 0) == (name in WITHOUT)


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
periods = 5
tables = ["summary", "impacts"]
[sweep]
mass_ratio = [0.05, 0.1]
"""


def test_front_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    # What the command on the front page writes, of a smaller study.
    Path("study.toml").write_text(STUDY, encoding="utf-8")
    assert _iva.main(["iva", "sweep", "study.toml", "--out", "results/clearance", "--quiet"]) == 0
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)
    assert len(blocks) == text.count("```python") > 0
    names: dict[str, object] = {}
    for block in blocks:
        exec(block, names)
    assert isinstance(names["run"], iva.Run)
    assert isinstance(names["table"], iva.Table)
