"""The examples of the docstrings."""

from __future__ import annotations

import doctest
import importlib
import pkgutil

import pytest

import iva

MODULES = [
    f"iva.{module.name}"
    for module in pkgutil.iter_modules(iva.__path__)
    if not module.name.startswith("_")
]


@pytest.mark.parametrize("name", ["iva", *MODULES])
def test_examples(name: str) -> None:
    module = importlib.import_module(name)
    found = doctest.testmod(module, extraglobs={"iva": iva}, optionflags=doctest.ELLIPSIS)
    assert found.failed == 0
