"""Parameters and results travel between processes."""

from __future__ import annotations

import multiprocessing
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from functools import partial

import pytest

import iva
from patience import PATIENCE


def test_process_pool() -> None:
    simulate = partial(
        iva.simulate,
        primary=iva.Primary(damping_ratio=0.01),
        start=iva.Start(displacement=1.0),
        periods=5,
    )
    absorbers: list[iva.Siva | iva.Piva] = [
        iva.Siva(mass_ratio=0.1, relative_clearance=gamma, restitution=0.5)
        for gamma in (0.4, 0.6, 0.8)
    ]
    absorbers.append(
        iva.Piva(
            mass_ratio=0.1,
            relative_clearance=0.6,
            restitution=0.5,
            frequency_ratio=0.4,
            length=10.0,
            impact_law="printed",
        )
    )
    # Spawned processes share nothing with this one, as on Windows.
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        runs = list(pool.map(simulate, absorbers))
    assert runs == [simulate(absorber) for absorber in absorbers]


# The threads of a sweep wait for the next one; a forked process has none of them.
FORKED = """
import os
import iva

def impacts():
    return iva.sweep(
        iva.Siva(mass_ratio=0.1, restitution=0.5), iva.Primary(damping_ratio=0.01),
        over={"relative_clearance": [0.4, 0.6, 0.8]}, start=iva.Start(displacement=1.0),
        periods=5, threads=2)

impacts()
child = os.fork()
if child == 0:
    print(impacts().summary.height, flush=True)
    os._exit(0)
os.waitpid(child, 0)
print(impacts().summary.height, flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="there is no fork")
def test_a_forked_process_starts_its_own_threads() -> None:
    run = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", FORKED],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=True,
    )
    assert run.stdout.split() == ["3", "3"]
