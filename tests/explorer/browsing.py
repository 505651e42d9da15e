"""A browser for the tests of a module, and the folder for its pictures."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from chromium import PROGRAM, Chromium


@pytest.fixture(scope="module")
def browser() -> Iterator[Chromium]:
    """Return a browser for the tests of a module."""
    if PROGRAM is None:
        pytest.skip("no Chromium")
    chromium = Chromium()
    yield chromium
    chromium.close()


@pytest.fixture(scope="session")
def pictures() -> Path:
    """Return the folder for pictures that somebody looks at."""
    folder = Path(__file__).parents[2] / "target" / "explorer"
    folder.mkdir(parents=True, exist_ok=True)
    return folder
