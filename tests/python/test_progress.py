"""What is shown of a sweep while it runs."""

from __future__ import annotations

import io
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import iva
from iva import progress
from iva.progress import reporting


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self) -> bool:
        """Return True."""
        return True


def on_terminal(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    """Put a terminal in the place of stderr; a fixture would do so too early, before pytest."""
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    return terminal


def sweep() -> iva.Table:
    return iva.sweep(
        iva.Siva(mass_ratio=0.1, restitution=0.8),
        iva.Primary(damping_ratio=0.01),
        over={"relative_clearance": [0.3, 0.4, 0.5, 0.6]},
        start=iva.Start(displacement=1.0),
        periods=5,
        progress=True,
    )


def test_tqdm_draws_a_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    stderr = on_terminal(monkeypatch)
    sweep()
    assert "100%" in stderr.getvalue()
    assert "4.00/4.00" in stderr.getvalue()
    assert stderr.getvalue().endswith("\n")


def test_without_tqdm_a_line(monkeypatch: pytest.MonkeyPatch) -> None:
    stderr = on_terminal(monkeypatch)
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)  # as if it were not installed
    # After a tenth of a second the line would say how fast it is.
    monkeypatch.setattr(progress, "perf_counter", lambda: 0.0)
    sweep()
    assert stderr.getvalue().endswith("\r4 of 4 points\n")


@pytest.mark.parametrize("tqdm", [True, False])
def test_what_was_begun_is_ended(monkeypatch: pytest.MonkeyPatch, tqdm: bool) -> None:
    stderr = on_terminal(monkeypatch)
    if not tqdm:
        monkeypatch.setitem(sys.modules, "tqdm.auto", None)

    def interrupted() -> None:
        with reporting(True) as tell:
            assert tell is not None
            tell(1, 4, 0)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert stderr.getvalue().endswith("\n")
    assert stderr.getvalue().strip() != ""


def test_nothing_is_drawn_where_nobody_watches(monkeypatch: pytest.MonkeyPatch) -> None:
    silent = io.StringIO()
    monkeypatch.setattr(sys, "stderr", silent)
    sweep()
    assert silent.getvalue() == ""
    monkeypatch.setattr(sys, "stderr", None)  # as in a program without a console
    sweep()


def test_a_notebook_is_no_terminal_but_watched(monkeypatch: pytest.MonkeyPatch) -> None:
    pane = io.StringIO()
    monkeypatch.setattr(sys, "stderr", pane)
    monkeypatch.setitem(sys.modules, "ipykernel", sys)
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    sweep()
    assert "4 of 4 points" in pane.getvalue()


def test_ctrl_c_ends_branches_and_diagrams_with_what_they_have() -> None:
    # The points that were found are those of the whole branch or diagram.
    siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5)
    scene: dict[str, Any] = {
        "primary": iva.Primary(damping_ratio=0.05),
        "force": iva.Harmonic(amplitude=1.0, frequency=1.0),
    }
    told: list[tuple[int, int]] = []

    def after(count: int) -> Callable[[int, int], None]:
        def interrupt(done: int, total: int) -> None:
            told.append((done, total))
            if done >= count:
                raise KeyboardInterrupt

        return interrupt

    orbit = iva.dynamics.orbit(siva, **scene, start=(0, 0, 0, 0.1), settle=200)
    assert isinstance(orbit, iva.dynamics.Orbit)
    wide: dict[str, Any] = {"over": "clearance", "between": (3.0, 8.0), "step": 1e-5}
    cut = iva.dynamics.follow(orbit, **wide, most_points=100_000, progress=after(3))
    assert isinstance(cut, iva.dynamics.Branch)
    assert "cancelled" in cut.ends
    assert len(cut.rows) > 3
    assert told[-1][1] == 0
    values = np.linspace(3.0, 8.0, 400)
    long: dict[str, Any] = {"direction": "up", "discard": 3000, "keep": 2}
    part = iva.dynamics.diagram(
        siva, **scene, over={"clearance": values}, **long, progress=after(2)
    )
    outcomes = [one.outcome for one in part.outcomes]
    done = outcomes.index("cancelled")
    assert outcomes == ["finished"] * done + ["cancelled"] * (len(values) - done)
    assert done >= 2
    assert told[-1][1] == len(values)
    whole = iva.dynamics.diagram(siva, **scene, over={"clearance": values[:2]}, **long)
    assert part.strobes[:4] == whole.strobes
