"""What is shown of a sweep while it runs."""

from __future__ import annotations

import io
import sys

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
