"""numba: the closed form sampled every 0.05 and bisected, the loop of :mod:`work_precision`."""

from __future__ import annotations

import numpy as np
from numba import njit
from work_precision.with_numba import solve

from sweep_peers.grid import Grid
from sweep_peers.with_scipy import impacts, scene


def sweep(grid: Grid, points: np.ndarray) -> list[int]:
    """Run points one by one."""
    return [impacts(solve(scene(grid, int(point)), "closed 0.05")) for point in points]


@njit(nogil=True)
def empty_loop(rounds: int) -> int:
    """Do nothing that a compiler can leave out, without holding Python's lock."""
    word = 1
    for _ in range(rounds):
        word = (word * 5 + 1) & 0xFFFF
    return word
