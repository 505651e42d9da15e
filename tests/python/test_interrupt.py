"""Ctrl-C, with real signals, in calls that would take hours by themselves."""

from __future__ import annotations

import signal
import subprocess
import sys

import pytest

from patience import started

# The thread says "running" once the main thread is in compiled code: its line in the package stays
# the same while it holds up nobody. So the signal comes neither before the call nor after it.
PROGRAM = """
import sys, threading, time
from pathlib import Path
import numpy as np
import iva

def place():
    frame = sys._current_frames()[threading.main_thread().ident]
    return frame.f_code.co_filename, frame.f_lasti

def watch():
    before = None
    while (now := place()) != before or Path(iva.__file__).parent not in Path(now[0]).parents:
        before = now
        time.sleep(0.1)
    print("running", flush=True)

start = iva.Start(displacement=1.0)
elastic = {"absorber": iva.Siva(mass_ratio=0.1, restitution=1.0), "primary": iva.Primary()}
points = {
    "relative_clearance": np.linspace(0.1, 0.9, 1000), "mass_ratio": np.linspace(0.05, 0.2, 1000)
}
scene = {
    "absorber": iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=3.85),
    "primary": iva.Primary(damping_ratio=0.05),
    "force": iva.Harmonic(amplitude=1.0, frequency=1.0),
}
grid = {"displacement": np.linspace(-4, 4, 300), "velocity": np.linspace(-4, 4, 300)}
threading.Thread(target=watch, daemon=True).start()
try:
    iva.%s
except KeyboardInterrupt:
    print("interrupted", flush=True)
    sys.exit(130)
print("finished", flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="sends a POSIX signal to one process")
@pytest.mark.parametrize(
    "call",
    [
        "sweep(**elastic, over=points, start=start, periods=20_000, progress=True)",
        "dynamics.orbit(**scene, start=(0, 0, 0, 0.1), settle=10**9)",
        "dynamics.diagram(**scene, over={'clearance': np.linspace(1, 5, 99)}, discard=10**9)",
        "dynamics.lyapunov(**scene, cycles=10**9)",
        "dynamics.attractors(**scene, starts=1000, most_cycles=10**9)",
        "dynamics.basins(**scene, over=grid, most_cycles=10**6)",
    ],
    ids=lambda call: call.partition("(")[0],
)
def test_a_signal_ends_a_call(call: str) -> None:
    with started([sys.executable, "-c", PROGRAM % call], stdout=subprocess.PIPE) as job:
        assert job.stdout is not None
        assert job.stdout.readline() == "running\n"
        job.send_signal(signal.SIGINT)
        assert job.stdout.read() == "interrupted\n"
        assert job.wait() == 130
