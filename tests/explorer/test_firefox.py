"""The same page in another browser."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

import iva
from firefox import PROGRAM, Firefox


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Firefox]:
    """Return a browser with the page."""
    if PROGRAM is None:
        pytest.skip("no Firefox")
    page = tmp_path_factory.mktemp("page") / "explorer.html"
    iva.explore().write(page)
    firefox = Firefox()
    firefox.open(page.as_uri())
    yield firefox
    firefox.close()


def test_it_runs_from_a_disk_with_the_numbers_of_the_wheel(browser: Firefox) -> None:
    browser.value("void explorer.ready.then((page) => { page.play(false); window.now = page; })")
    browser.wait("window.now !== undefined")
    run = iva.simulate(
        iva.Siva(mass_ratio=0.1, clearance=0.5, restitution=0.6),
        iva.Primary(damping_ratio=0.005),
        start=iva.Start(displacement=1.0),
        periods=20,
    )
    times = browser.value("Array.from(window.now.data.run.impacts.time)")
    assert times == run.impacts["time"].to_list()


def test_its_map_fills_in_a_worker(browser: Firefox) -> None:
    browser.wait("window.now.map.known.every(Boolean)")
    assert browser.value("window.now.map.worker.workers.length > 0")


def test_a_slider_changes_the_scene(browser: Firefox) -> None:
    browser.value(
        "void (() => { const it ="
        "document.querySelector('input[type=range][aria-label=Clearance]');"
        "it.value = '300'; it.dispatchEvent(new Event('input')); })()"
    )
    assert browser.value("window.now.state.scene.values['absorber.clearance']") != 0.5
