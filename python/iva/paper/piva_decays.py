"""Figs 12 to 14: single decays with the pendulum."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import polars as pl

import iva
from iva.paper import drawing, scenes
from iva.paper.assumptions import Assumptions
from iva.paper.made import Made
from iva.paper.measures import FIRST, FIT, SETTLING, THREE, mean_size
from iva.paper.verdicts import Finding, View


def under_both_laws(claim: Callable[[Assumptions], Finding], a: Assumptions) -> Finding:
    """Judge a claim by the law assumed, and say what the law as printed makes of it."""
    found = claim(a)
    if a.impact_law == "printed":
        return found
    printed = claim(replace(a, impact_law="printed"))
    holds = sum(view.holds is True for view in printed.views)
    said = (
        f"{found.model} With Eqs. 16 and 17 as printed: {printed.verdict.value} "
        f"({holds} of {len(printed.views)} views)."
    )
    return replace(found, model=said)


@cache
def runs(a: Assumptions) -> dict[float, iva.Run]:
    """Return the decays with the long and the short pendulum, e = 0.5, μ = 0.1."""
    return {
        r: scenes.decay(
            scenes.piva(a, mass_ratio=0.1, restitution=0.5, frequency_ratio=r), scenes.primary(a)
        )
        for r in (a.frequency_ratio, 2.0 * a.frequency_ratio)
    }


def named(a: Assumptions) -> dict[str, iva.Run]:
    """Return these decays by the names of their curves."""
    return {f"r = {r:g}": run for r, run in runs(a).items()}


def fig12(a: Assumptions) -> Made:
    """Decay with a long and a short pendulum."""
    without = scenes.bare(a)
    return Made(
        f"μ = 0.1, e = 0.5, γ = {a.relative_clearance:g}, ζ = {a.damping_ratio:g}, "
        f"r = {a.frequency_ratio:g} and {2 * a.frequency_ratio:g}",
        {"decays": drawing.motions(named(a) | {"without": without})},
        [under_both_laws(long_settles_sooner, a)],
        lambda: drawing.decays(named(a), without, until=60.0),
    )


def long_settles_sooner(a: Assumptions) -> Finding:
    """P1: the long pendulum settles sooner."""
    views = []
    long, short = (run.summary for run in runs(a).values())
    for measure in (FIRST, THREE, FIT, *SETTLING):
        one, other = float(measure.of(long)[0]), float(measure.of(short)[0])
        holds = None if np.isnan(one) or np.isnan(other) or one == other == 0.0 else one > other
        views.append(View(measure.label, holds, f"{one:.3f} / {other:.3f}"))
    return Finding(
        "P1",
        "Fig. 12",
        "The long pendulum (r = 0.4) settles sooner than the short one (r = 0.8).",
        views,
        "Values are damping ratios, 0 where it does not settle within the run. A pendulum that "
        "no longer reaches its stops is not damped by anything and keeps the structure moving: "
        "the late levels may never be reached.",
    )


def fig13(a: Assumptions) -> Made:
    """Phase plane with the long pendulum."""
    run = runs(a)[a.frequency_ratio]
    return Made(
        f"μ = 0.1, e = 0.5, γ = {a.relative_clearance:g}, r = {a.frequency_ratio:g}",
        {"trajectory": run.trajectory(100), "impacts": run.impacts},
        [],
        lambda: drawing.phase(run),
    )


def fig14(a: Assumptions) -> Made:
    """Phase plane with the short pendulum, and what the two tell."""
    run = runs(a)[2.0 * a.frequency_ratio]
    return Made(
        f"μ = 0.1, e = 0.5, γ = {a.relative_clearance:g}, r = {2 * a.frequency_ratio:g}",
        {"trajectory": run.trajectory(100), "impacts": run.impacts},
        [under_both_laws(two_a_cycle, a), under_both_laws(slow_takes_more, a)],
        lambda: drawing.phase(run),
    )


def until_settled(run: iva.Run) -> pl.DataFrame:
    """Return the impacts until |x| stays below 5 %, all if it does not."""
    settled = run.summary["settling_time_5"].item()
    return run.impacts if settled is None else run.impacts.filter(pl.col("time") <= settled)


def two_a_cycle(a: Assumptions) -> Finding:
    """P2: more impacts with the short pendulum; two in every cycle."""
    long, short = runs(a).values()
    counts = [until_settled(run).height for run in (long, short)]
    cycles = [
        long.impacts.filter(pl.col("time").is_between(begin, end, closed="left")).height
        for begin, end in pairwise(2.0 * np.pi * np.arange(9.0))
    ]
    return Finding(
        "P2",
        "Figs 13 and 14",
        "The number of impacts rises with the frequency of the pendulum, two in every cycle.",
        [
            View("impacts until 5 %", counts[0] < counts[1], f"{counts[0]} / {counts[1]}"),
            View(
                "two each, cycles 1 to 3", cycles[:3] == [2, 2, 2], " ".join(map(str, cycles[:3]))
            ),
            View("two each, cycles 1 to 8", cycles == [2] * 8, " ".join(map(str, cycles))),
        ],
        f"{counts[0]} and {counts[1]} impacts. Two a cycle only while the structure swings enough: "
        f"{' '.join(map(str, cycles))} in the first eight cycles.",
    )


def slow_takes_more(a: Assumptions) -> Finding:
    """P3: the slower pendulum takes more in each impact."""
    losses, speeds = [], []
    for run in runs(a).values():
        impacts = until_settled(run)
        losses.append(mean_size(impacts["energy_loss"]))
        speeds.append(mean_size(impacts["approach_velocity"]))
    return Finding(
        "P3",
        "4.2",
        "A smaller frequency of the pendulum makes each impact dissipate more.",
        [
            View(
                "mean loss an impact", losses[0] > losses[1], f"{losses[0]:.4f} / {losses[1]:.4f}"
            ),
            View(
                "mean approach speed", speeds[0] > speeds[1], f"{speeds[0]:.3f} / {speeds[1]:.3f}"
            ),
        ],
        "Mean over the impacts until 5 %, long pendulum against short.",
    )
