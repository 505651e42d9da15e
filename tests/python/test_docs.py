"""The examples of the docstrings."""

from __future__ import annotations

import doctest
import importlib
import pkgutil

import pytest

import iva
from iva import dynamics, identification, measured, optimisation

MODULES = ["iva"] + [
    f"iva.{module.name}"
    for module in pkgutil.iter_modules(iva.__path__)
    if not module.name.startswith("_")
]
# Nothing in them is called by users, or all of it needs files.
WITHOUT = {
    f"iva.{name}"
    for name in (
        "commands design distributed frames identification manifests markup modal_masses own_files "
        "parts progress reading remote scanning scenes"
    ).split()
}


IN_PACKAGES = [
    module.name
    for package in (dynamics, identification, measured, optimisation)
    for module in pkgutil.iter_modules(package.__path__, f"{package.__name__}.")
]


@pytest.mark.parametrize("name", IN_PACKAGES)
def test_examples_in_packages(name: str) -> None:
    module = importlib.import_module(name)
    found = doctest.testmod(module, extraglobs={"iva": iva}, optionflags=doctest.ELLIPSIS)
    assert found.failed == 0


@pytest.mark.parametrize("name", MODULES)
def test_examples(name: str) -> None:
    module = importlib.import_module(name)
    found = doctest.testmod(module, extraglobs={"iva": iva}, optionflags=doctest.ELLIPSIS)
    assert found.failed == 0
    assert (found.attempted == 0) == (name in WITHOUT)
