"""Ctrl-C, with real signals."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import pytest

# The point in time at which the exception arrives is printed: what follows is the interpreter's.
SWEEP = """
import sys, time
import numpy as np
import iva
print("ready", flush=True)
try:
    iva.sweep(
        iva.Siva(mass_ratio=0.1, restitution=0.9), iva.Primary(damping_ratio=0.001),
        over={"relative_clearance": np.linspace(0.1, 1.2, 20_000), "mass_ratio": [0.1, 0.2]},
        start=iva.Start(displacement=1.0), periods=2000, progress=True)
except KeyboardInterrupt:
    print("interrupted", time.time(), flush=True)
    sys.exit(130)
print("finished", flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="sends a POSIX signal to one process")
def test_a_signal_ends_a_sweep_within_about_a_second() -> None:
    with subprocess.Popen([sys.executable, "-c", SWEEP], stdout=subprocess.PIPE, text=True) as job:
        assert job.stdout is not None
        assert job.stdout.readline() == "ready\n"
        time.sleep(0.5)
        sent = time.time()
        os.kill(job.pid, signal.SIGINT)
        said = job.stdout.readline().split()
        job.wait(timeout=30)
    assert said[0] == "interrupted"
    # A second is the aim; a busy machine may need more.
    assert float(said[1]) - sent < 3.0
    assert job.returncode == 130


SETTLING = """
import sys, time
import iva
print("ready", flush=True)
try:
    iva.dynamics.orbit(
        iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5), iva.Primary(damping_ratio=0.05),
        force=iva.Harmonic(amplitude=1.0, frequency=1.0), start=(0, 0, 0, 0.1), settle=10**9)
except KeyboardInterrupt:
    print("interrupted", time.time(), flush=True)
    sys.exit(130)
print("finished", flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="sends a POSIX signal to one process")
def test_a_signal_ends_the_search_for_an_orbit() -> None:
    with subprocess.Popen(
        [sys.executable, "-c", SETTLING], stdout=subprocess.PIPE, text=True
    ) as job:
        assert job.stdout is not None
        assert job.stdout.readline() == "ready\n"
        time.sleep(0.5)
        sent = time.time()
        os.kill(job.pid, signal.SIGINT)
        said = job.stdout.readline().split()
        job.wait(timeout=30)
    assert said[0] == "interrupted"
    assert float(said[1]) - sent < 3.0
    assert job.returncode == 130


STEADY = """
import sys, time
import numpy as np
import iva
siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=3.85)
scene = {"absorber": siva, "primary": iva.Primary(damping_ratio=0.05)}
scene["force"] = iva.Harmonic(amplitude=1.0, frequency=1.0)
grid = {"displacement": np.linspace(-4, 4, 300), "velocity": np.linspace(-4, 4, 300)}
print("ready", flush=True)
try:
    iva.dynamics.%s
except KeyboardInterrupt:
    print("interrupted", time.time(), flush=True)
    sys.exit(130)
print("finished", flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="sends a POSIX signal to one process")
@pytest.mark.parametrize(
    "call",
    [
        "diagram(**scene, over={'clearance': np.linspace(1, 5, 99)}, discard=10**7)",
        "lyapunov(**scene, cycles=10**8)",
        "attractors(**scene, starts=1000, most_cycles=10**8)",
        "basins(**scene, over=grid, most_cycles=10**6)",
    ],
)
def test_a_signal_ends_the_search_for_steady_states(call: str) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", STEADY % call], stdout=subprocess.PIPE, text=True
    ) as job:
        assert job.stdout is not None
        assert job.stdout.readline() == "ready\n"
        time.sleep(0.5)
        sent = time.time()
        os.kill(job.pid, signal.SIGINT)
        said = job.stdout.readline().split()
        job.wait(timeout=30)
    assert said[0] == "interrupted"
    assert float(said[1]) - sent < 3.0
    assert job.returncode == 130
