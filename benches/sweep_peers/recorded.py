"""Sweeps under a recorded force: iva, a numba loop around the closed form, and SciPy.

The force on the structure is 40 s of filtered noise at 100 Hz with the envelope of an earthquake.
The structure has 1 Hz, so that two points of the record are 2π/100 apart in natural time.
"""

from __future__ import annotations

import math
import time
from itertools import product

import numpy as np
import polars as pl
from numba import njit
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import iva

Array = NDArray[np.float64]

DAMPING = 0.02
MASS_RATIO = 0.1
POINTS = 4001
STEP = 2 * math.pi / 100
OVER = {
    "clearance": np.linspace(0.05, 0.8, 40),
    "restitution": np.linspace(0.5, 0.85, 25),
}
BISECTIONS = 52
#: A rebound slower than this ends a chatter of the loops; iva sums it.
LOW = 1e-4
#: SciPy runs so many scenes.
FEW = 2


def record() -> tuple[Array, Array]:
    """Return times and values of the force, in natural units."""
    times = STEP * np.arange(POINTS)
    noise = np.random.default_rng(1940).standard_normal(POINTS)
    smooth = np.convolve(noise, np.hanning(21) / np.hanning(21).sum(), mode="same")
    share = np.arange(POINTS) / POINTS
    values = 1.5 * smooth * np.minimum(1, share / 0.1) * np.exp(-4 * np.maximum(0, share - 0.3))
    values[[0, -1]] = 0
    return times, values


def with_iva(measures: tuple[str, ...] = ("impacts", "amplitude_max")) -> pl.DataFrame:
    """Run all scenes on one thread; return their summary."""
    times, values = record()
    result = iva.sweep(
        primary=iva.Primary(damping_ratio=DAMPING),
        absorber=iva.Siva(mass_ratio=MASS_RATIO, clearance=0.5, restitution=0.6),
        start=iva.Start(),
        force=iva.Recorded(times, values),
        duration=float(times[-1]),
        over=OVER,
        measures=measures,
        tables=("summary",),
        threads=1,
    )
    return result.summary


@njit
def _advance(x, v, force, slope, h):
    """Return x and v after h under force + slope t, in closed form."""
    omega = math.sqrt(1 - DAMPING * DAMPING)
    still = force - 2 * DAMPING * slope
    a = x - still
    b = (v - slope + DAMPING * a) / omega
    decay = math.exp(-DAMPING * h)
    even, odd = decay * math.cos(omega * h), decay * math.sin(omega * h)
    free = a * even + b * odd
    rate = omega * (b * even - a * odd) - DAMPING * free
    return free + still + slope * h, rate + slope


@njit
def _count(values, clearance, restitution):
    """Return the number of impacts, looking at the gap at each point of the record."""
    x, v, y, w = 0.0, 0.0, 0.0, 0.0
    count, side = 0, 0.0
    for k in range(values.size - 1):
        slope, done = (values[k + 1] - values[k]) / STEP, 0.0
        while done < STEP:
            force, h = values[k] + slope * done, STEP - done
            x1, v1 = _advance(x, v, force, slope, h)
            y1 = y + x + (w + v) * h - x1
            if abs(y1) <= clearance:
                y, w, x, v = y1, w + v - v1, x1, v1
                break
            side = 1.0 if y1 > 0 else -1.0
            low, high = 0.0, h
            for _ in range(BISECTIONS):
                middle = 0.5 * (low + high)
                there, _speed = _advance(x, v, force, slope, middle)
                if side * (y + x + (w + v) * middle - there) > clearance:
                    high = middle
                else:
                    low = middle
            x1, v1 = _advance(x, v, force, slope, low)
            w1 = w + v - v1
            y, x, v, w = side * clearance, x1, v1, w1
            impulse = (1 + restitution) * MASS_RATIO / (1 + MASS_RATIO) * w
            v, w = v + impulse, -restitution * w
            count += 1
            done += low
            if abs(w) < LOW:  # the tail of a chatter: at rest on the wall until the next point
                y, w = y * (1 - 1e-12), 0.0
                x, v = _advance(x, v, values[k] + slope * done, slope, STEP - done)
                break
    return count


def with_numba() -> pl.Series:
    """Run all scenes one by one."""
    _, values = record()
    return pl.Series([_count(values, *map(float, point)) for point in product(*OVER.values())])


def with_scipy(scenes: pl.DataFrame) -> float:
    """Return the seconds that scenes without chatter take: DOP853 1e-9, no step beyond a point."""
    times, values = record()
    begin = time.process_time()
    for clearance, restitution in scenes.select(*OVER).iter_rows():
        state, t, side = np.zeros(4), 0.0, 0

        def rates(t: float, s: Array) -> list[float]:
            push = float(np.interp(t, times, values)) - 2 * DAMPING * s[1] - s[0]
            return [s[1], push, s[3], -push]

        def wall(_: float, s: Array, clearance: float = clearance) -> float:
            return clearance - abs(s[2])

        wall.terminal, wall.direction = True, -1  # type: ignore[attr-defined]
        # Steps no longer than a piece of the record, which a longer one would look past.
        while t < times[-1]:
            run = solve_ivp(
                rates,
                (t, times[-1]),
                state,
                method="DOP853",
                rtol=1e-9,
                atol=1e-9,
                max_step=STEP,
                events=wall,
            )
            t, state = float(run.t[-1]), run.y[:, -1]
            if run.status != 1:
                break
            side = 1 if state[2] > 0 else -1
            impulse = (1 + restitution) * MASS_RATIO / (1 + MASS_RATIO) * state[3]
            state[1] += impulse
            state[3] *= -restitution
            state[2] = side * clearance * (1 - 1e-12)
    return time.process_time() - begin


def table(rounds: int) -> str:
    """Compare the three: CPU seconds for 1000 scenes."""
    _count(record()[1][:100], 0.5, 0.6)  # compiles
    spent: dict[str, list[float]] = {"iva": [], "numba": []}
    for _ in range(rounds):
        for name, sweep in (("iva", with_iva), ("numba", with_numba)):
            begin = time.process_time()
            sweep()
            spent[name].append(time.process_time() - begin)
    ours, loop = (float(np.median(spent[name])) for name in ("iva", "numba"))
    counts = with_iva(("impacts", "episodes")).with_columns(loop=with_numba())
    smooth = counts.filter(pl.col("episodes") == 0, pl.col("impacts") > 0)
    few = smooth.head(FEW)
    scipy = 1000 / few.height * with_scipy(few)
    differ = smooth.filter(pl.col("impacts") != pl.col("loop")).height
    return "\n".join(
        (
            f"| siva under {POINTS} points, {counts.height} scenes | CPU s per 1000 | over iva |",
            "|---|--:|--:|",
            f"| iva, impacts and largest displacement | {ours:.3f} | 1 |",
            f"| numba, closed form at each point | {loop:.3f} | {loop / ours:.2f} |",
            f"| SciPy DOP853 1e-9 ({few.height} scenes) | {scipy:.1f} | {scipy / ours:.0f} |",
            "",
            f"{counts['impacts'].sum()} impacts in all; of {smooth.height} scenes without chatter "
            f"the loop counts others in {differ}.",
        )
    )
