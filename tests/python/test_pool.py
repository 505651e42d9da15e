"""Parameters and results travel between processes."""

from __future__ import annotations

import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from functools import partial

import iva


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
