"""Scenes of several parts on the page: each absorber has a drawing, the wheel the same numbers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import iva
from chromium import Chromium
from test_chromium import run_of_the_copied_program, values

pytest_plugins = ["browsing"]

TOWER = iva.Structure(
    frequencies_hz=[3.0, 11.0],
    damping_ratios=[0.01, 0.01],
    points={"the top": [0.1, 0.08], "half way": [0.06, -0.09]},
    absorber_at=["the top", "half way"],
)
BALL = iva.Siva(mass=8.0, restitution=0.6, gap_mm=20.0, friction=0.01)
PENDULUM = iva.Piva(mass=4.0, restitution=0.5, gap_mm=25.0, length=0.3)
STEEL = iva.Primary(mass=100.0, frequency_hz=3.0, damping_ratio=0.01)
#: Scenes of several parts: absorbers, structure, forces, and how many drawings they have.
SEVERAL: dict[str, tuple[Any, Any, Any, int]] = {
    "friction and a spring": (replace(BALL, spring_ratio=0.8), STEEL, None, 1),
    "a stop": (iva.Stop(gap_mm=36.0, restitution=0.6), STEEL, iva.Impulse(impulse=60.0), 1),
    "two masses": ([BALL, replace(BALL, mass=4.0)], STEEL, None, 2),
    "a mass and a pendulum": ([BALL, PENDULUM], STEEL, iva.Impulse(impulse=20.0, time=0.3), 2),
    "modes": ([BALL, PENDULUM], TOWER, None, 2),
    "units and forces": (
        replace(BALL, units=2, friction=None),
        STEEL,
        [
            iva.Harmonic(force=50.0, frequency_hz=3.0),
            iva.Recorded([0.0, 1.0, 2.0], [0.0, 90.0, 0.0], kind="force_newtons"),
        ],
        2,
    ),
}


@pytest.mark.parametrize("name", SEVERAL)
def test_a_scene_of_several_parts_is_drawn_dragged_and_copied(
    browser: Chromium, tmp_path: Path, pictures: Path, name: str
) -> None:
    absorber, primary, force, drawings = SEVERAL[name]
    start = iva.Start(displacement_mm=15.0)
    run = iva.simulate(absorber, primary, start=start, force=force, duration=3.0)
    path = tmp_path / "page.html"
    iva.explore(run).write(path)
    browser.console.clear()
    browser.open(path.as_uri())
    browser.value("explorer.ready.then((page) => { page.play(false); globalThis.now = page; })")
    assert browser.value("now.state.fault") is None
    assert run_of_the_copied_program(browser) == run
    assert browser.value("Array.from(now.data.run.impacts.time)") == run.impacts["time"].to_list()
    shown = "[...document.querySelectorAll('.pad.drawn')].filter((it) => it.offsetHeight).length"
    assert browser.value(shown) == drawings
    browser.value("now.goTo(0.6)")
    for theme in ("light", "dark"):
        browser.theme(theme)
        browser.picture(pictures / f"{name.replace(' ', '_')}_{theme}.png", whole=True)
    browser.theme("light")
    path_of = "absorber.1.gap_mm" if isinstance(absorber, list) else "absorber.gap_mm"
    before = values(browser)
    # The window has its size again, and the handles their places.
    browser.value("new Promise((done) => requestAnimationFrame(() => setTimeout(done, 200)))")
    browser.drag(f".view-drawing{'_1' if drawings > 1 else ''} .handle.plus", 6)
    after = values(browser)
    assert after[path_of] > before[path_of]
    assert {**after, path_of: before[path_of]} == before
    if not isinstance(force, list):
        browser.wait(f"location.hash.includes('gapmm={after[path_of]:g}')")
        browser.open(f"{path.as_uri()}{browser.value('location.hash')}")
        browser.value("explorer.ready.then((page) => { globalThis.now = page; })")
        assert values(browser) == after
    assert browser.console == []
