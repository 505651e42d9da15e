"""Waiting for what happens. The seconds here only end what hangs, on the slowest machine."""

from __future__ import annotations

import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

PATIENCE = 300.0


def until(happened: Callable[[], object], job: subprocess.Popen[str] | None = None) -> None:
    """Wait until something has happened, which must be before a process ends."""
    begun = time.monotonic()
    while not happened():
        assert job is None or job.poll() is None, "the process ended before"
        assert time.monotonic() - begun < PATIENCE, "nothing happened"
        time.sleep(0.01)


@contextmanager
def started(command: list[str], **more: Any) -> Iterator[subprocess.Popen[str]]:
    """Start a process that ends with the test at the latest, and is killed if it hangs."""
    with subprocess.Popen(command, text=True, encoding="utf-8", **more) as job:
        guard = threading.Timer(PATIENCE, job.kill)
        guard.start()
        try:
            yield job
        finally:
            guard.cancel()
            job.kill()
