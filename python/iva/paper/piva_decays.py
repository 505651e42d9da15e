"""Figs 12 to 14: single decays with the pendulum."""

from __future__ import annotations

from functools import cache, partial
from itertools import pairwise

import numpy as np
import polars as pl

import iva
from iva.paper import drawing, scenes
from iva.paper.assumptions import Assumptions
from iva.paper.laws import told, under_both_laws
from iva.paper.made import Made
from iva.paper.measures import FIRST, FIT, SETTLING, THREE, less, mean_size, shown, worse
from iva.paper.verdicts import Finding, View

#: Frequency ratios of the long and the short pendulum, as the captions have them.
LONG, SHORT = 0.4, 0.8


@cache
def runs(a: Assumptions) -> tuple[iva.Run, iva.Run]:
    """Return the decays with the long and the short pendulum, μ = 0.1 and e = 0.5."""
    long, short = (
        scenes.decay(
            scenes.piva(a, mass_ratio=0.1, restitution=0.5, frequency_ratio=r), scenes.primary(a)
        )
        for r in (LONG, SHORT)
    )
    return long, short


def parameters(a: Assumptions, r: str) -> str:
    """Return what was run."""
    return (
        f"μ = 0.1, e = 0.5, γ = {a.relative_clearance:g}, r = {r}, ζ = {a.damping_ratio:g}, "
        f"{told(a)}"
    )


def fig12(a: Assumptions) -> Made:
    """Decay with a long and a short pendulum."""
    without = scenes.bare(a)
    named = dict(zip((f"r = {LONG}", f"r = {SHORT}"), runs(a), strict=True))
    return Made(
        parameters(a, f"{LONG} and {SHORT}"),
        {"decays": drawing.motions(named | {"without": without})},
        [under_both_laws(long_settles_sooner, a)],
        partial(drawing.decays, named, without, until=60.0),
    )


def long_settles_sooner(a: Assumptions) -> Finding:
    """P1: the long pendulum settles sooner."""
    views = []
    long, short = (run.summary for run in runs(a))
    for measure in (FIRST, THREE, FIT, *SETTLING):
        one, other = float(measure.of(long)[0]), float(measure.of(short)[0])
        views.append(View(measure.label, worse(other, one), f"{shown(one, 3)} / {shown(other, 3)}"))
    return Finding(
        "P1",
        "Fig. 12",
        "The long pendulum (r = 0.4) settles sooner than the short one (r = 0.8).",
        views,
        "Values are damping ratios, 0 where it does not settle within the run. A pendulum that "
        "no longer reaches its stops is not damped by anything and keeps the structure moving, "
        "so that late levels may never be reached.",
    )


def fig13(a: Assumptions) -> Made:
    """Phase plane with the long pendulum."""
    return phase(a, runs(a)[0], LONG)


def fig14(a: Assumptions) -> Made:
    """Phase plane with the short pendulum."""
    return phase(a, runs(a)[1], SHORT)


def phase(a: Assumptions, run: iva.Run, r: float) -> Made:
    """Return the study of one of these figures; what is said of them is said of both."""
    return Made(
        parameters(a, f"{r}"),
        {"trajectory": run.trajectory(100), "impacts": run.impacts},
        [under_both_laws(two_a_cycle, a), under_both_laws(slow_takes_more, a)],
        partial(drawing.phase, run),
    )


def in_periods(run: iva.Run, periods: float) -> pl.DataFrame:
    """Return the impacts of the first periods."""
    return run.impacts.filter(pl.col("time") <= 2.0 * np.pi * periods)


def two_a_cycle(a: Assumptions) -> Finding:
    """P2: more impacts with the short pendulum; two in every cycle."""
    views = []
    some = any(run.impacts.height for run in runs(a))
    for periods in (5, 10, 20):
        counts = [in_periods(run, periods).height for run in runs(a)]
        holds = counts[0] < counts[1] if some else None
        views.append(View(f"more in {periods} periods", holds, f"{counts[0]} / {counts[1]}"))
    for run, r in zip(runs(a), (LONG, SHORT), strict=True):
        cycles = [
            run.impacts.filter(pl.col("time").is_between(begin, end, closed="left")).height
            for begin, end in pairwise(2.0 * np.pi * np.arange(9.0))
        ]
        for count in (3, 8):
            said = cycles[:count]
            name = f"two in each of {count} cycles, r = {r}"
            views.append(
                View(name, said == [2] * count if some else None, " ".join(map(str, said)))
            )
    return Finding(
        "P2",
        "Figs 13 and 14",
        "The number of impacts rises with the frequency of the pendulum, two in every cycle.",
        views,
        "Numbers at r = 0.4 / 0.8, and cycle by cycle. There are fewer as the structure dies down.",
    )


def slow_takes_more(a: Assumptions) -> Finding:
    """P3: the slower pendulum takes more in each impact."""
    views = []
    for periods in (5, 10, 20):
        parts = [in_periods(run, periods) for run in runs(a)]
        long, short = (mean_size(part["energy_loss"]) for part in parts)
        value = f"{shown(long, 4)} / {shown(short, 4)}"
        views.append(View(f"mean loss in {periods} periods", less(short, long), value))
    speeds = [mean_size(in_periods(run, 10)["approach_velocity"]) for run in runs(a)]
    return Finding(
        "P3",
        "4.2",
        "A smaller frequency of the pendulum makes each impact dissipate more.",
        views,
        "Mean energy an impact in M x₀² ωn², r = 0.4 / 0.8. Mean approach speeds in ten periods: "
        f"{shown(speeds[0], 3)} / {shown(speeds[1], 3)} x₀ωn.",
    )
