"""Figs 3 to 5, 10 and 11: single decays with the free mass."""

from __future__ import annotations

from functools import cache, partial

import numpy as np
import polars as pl

import iva
from iva.paper import drawing, scenes
from iva.paper.assumptions import Assumptions
from iva.paper.made import Made
from iva.paper.measures import SETTLING, less, mean_size, percent, shown, until_settled
from iva.paper.verdicts import Finding, View

#: The mass ratio of Figs 4 and 5; Fig. 3 does not say its own, and stands beside them.
MASS_RATIO = 0.15
CLEARANCES = (0.1, 0.6, 0.8)


def fig3(a: Assumptions) -> Made:
    """Decay at three clearances, and without absorber."""
    absorber = scenes.siva(a, mass_ratio=MASS_RATIO)
    runs = {
        f"γ = {gamma}": scenes.decay(
            scenes.siva(a, mass_ratio=MASS_RATIO, relative_clearance=gamma), scenes.primary(a)
        )
        for gamma in CLEARANCES
    }
    without = scenes.bare(a)
    table = scenes.decays(
        absorber,
        scenes.primary(a),
        {"damping_ratio": a.dampings, "relative_clearance": CLEARANCES},
        periods=120.0,
    ).summary
    return Made(
        f"μ = {MASS_RATIO}, e = {a.restitution:g}, ζ = {a.damping_ratio:g}, γ = 0.1, 0.6, 0.8",
        {"decays": drawing.motions(runs | {"without": without}), "settling": table},
        [settles_sooner(table, a.dampings)],
        partial(drawing.decays, runs, without, until=60.0),
    )


def settles_sooner(table: pl.DataFrame, dampings: tuple[float, ...]) -> Finding:
    """S1: γ = 0.6 settles sooner than 0.1 and 0.8."""
    views = []
    sooner = [0, 0]
    for measure in SETTLING:
        times = table[measure.column].fill_null(np.inf).to_numpy().reshape(len(dampings), 3)
        for damping, (small, middle, large) in zip(dampings, times, strict=True):
            than = (less(middle, small), less(middle, large))
            sooner = [sooner[0] + (than[0] is True), sooner[1] + (than[1] is True)]
            holds = None if None in than else all(than)
            value = " / ".join(shown(time, 0) for time in (small, middle, large))
            views.append(View(f"{measure.label}, ζ = {damping:g}", holds, value))
    return Finding(
        "S1",
        "Fig. 3",
        "The response dies out sooner with γ = 0.6 than with 0.1 and 0.8.",
        views,
        f"Of {len(views)} views 0.6 is sooner than 0.1 in {sooner[0]} and sooner than 0.8 in "
        f"{sooner[1]} (values: settling times at γ = 0.1 / 0.6 / 0.8). The damping of the "
        "structure, which decides it, is not given.",
    )


@cache
def velocity_runs(a: Assumptions) -> tuple[iva.Run, iva.Run]:
    """Return the runs of Figs 4 and 5, ten periods each."""
    made = [
        scenes.decay(
            scenes.siva(a, mass_ratio=MASS_RATIO, restitution=0.5, relative_clearance=gamma),
            scenes.primary(a),
            periods=10.0,
        )
        for gamma in (0.1, 0.6)
    ]
    return made[0], made[1]


def fig4(a: Assumptions) -> Made:
    """Velocities in a small gap."""
    return velocities(a, velocity_runs(a)[0], 0.1)


def fig5(a: Assumptions) -> Made:
    """Velocities in a middle gap."""
    return velocities(a, velocity_runs(a)[1], 0.6)


def velocities(a: Assumptions, run: iva.Run, gamma: float) -> Made:
    """Return the study of one of these figures; what is said of them is said of both."""
    return Made(
        f"μ = {MASS_RATIO}, γ = {gamma}, e = 0.5, ζ = {a.damping_ratio:g}",
        {"trajectory": run.trajectory(200), "impacts": run.impacts},
        [directions(a)],
        partial(drawing.velocities, run),
    )


def directions(a: Assumptions) -> Finding:
    """S2: the masses move together at γ = 0.1, against each other at 0.6."""
    runs = velocity_runs(a)
    counts = [run.impacts.height for run in runs]
    against = [mean_size(run.impacts["effective"].cast(pl.Float64)) for run in runs]
    speeds = [mean_size(run.impacts["approach_velocity"]) for run in runs]
    parts = [less(counts[1], counts[0]), less(speeds[0], speeds[1])]
    parts += [less(against[0], 0.5), less(0.5, against[1])]
    episodes = runs[0].episodes.height
    return Finding(
        "S2",
        "Figs 4 and 5",
        "At γ = 0.1 both masses move the same way, with small relative velocities and many "
        "impacts; at 0.6 they move against each other, faster.",
        [
            View(
                "ten periods: number, mean approach speed, share against each other",
                None if None in parts else all(parts),
                f"{counts[0]} / {counts[1]}, {shown(speeds[0], 3)} / {shown(speeds[1], 3)}, "
                f"{percent(against[0])} / {percent(against[1])}",
            )
        ],
        f"In ten periods {counts[0]} listed impacts at a mean of {shown(speeds[0], 3)} x₀ωn, "
        f"{percent(against[0])} of them with the masses moving against each other, and "
        f"{counts[1]} at {shown(speeds[1], 3)}, {percent(against[1])}."
        + (
            f" At γ = 0.1 chatter ends in stick {episodes} times: the rebounds are infinitely "
            "many, and their number is one of the floor below which they are summed."
            if episodes
            else ""
        ),
    )


@cache
def phase_runs(a: Assumptions) -> tuple[iva.Run, iva.Run]:
    """Return the runs of Figs 10 and 11."""
    made = [
        scenes.decay(
            scenes.siva(a, mass_ratio=0.1, relative_clearance=0.5, restitution=e),
            scenes.primary(a),
        )
        for e in (0.5, 0.9)
    ]
    return made[0], made[1]


def fig10(a: Assumptions) -> Made:
    """Phase plane at e = 0.5."""
    return phase(a, phase_runs(a)[0], 0.5)


def fig11(a: Assumptions) -> Made:
    """Phase plane at e = 0.9."""
    return phase(a, phase_runs(a)[1], 0.9)


def phase(a: Assumptions, run: iva.Run, e: float) -> Made:
    """Return the study of one of these figures; what is said of them is said of both."""
    return Made(
        f"μ = 0.1, γ = 0.5, e = {e}, ζ = {a.damping_ratio:g}",
        {"trajectory": run.trajectory(100), "impacts": run.impacts},
        [fewer_and_harder(a)],
        partial(drawing.phase, run),
    )


def fewer_and_harder(a: Assumptions) -> Finding:
    """S9: at e = 0.5 fewer impacts, each with more loss, than at 0.9."""
    views = []
    times = [run.summary["settling_time_5"].item() or np.inf for run in phase_runs(a)]
    spans = {
        "until 5 %": [until_settled(run) for run in phase_runs(a)],
        "first 10 periods": [
            run.impacts.filter(pl.col("time") <= 20.0 * np.pi) for run in phase_runs(a)
        ],
    }
    for name, (half, high) in spans.items():
        losses = [mean_size(part["energy_loss"]) for part in (half, high)]
        sums = [float(part["energy_loss"].sum()) for part in (half, high)]
        parts = [less(half.height, high.height), less(losses[1], losses[0])]
        parts.append(less(times[0], times[1]) if name == "until 5 %" else less(sums[1], sums[0]))
        value = (
            f"{half.height} / {high.height} impacts of {shown(losses[0], 4)} / "
            f"{shown(losses[1], 4)}"
        )
        views.append(View(name, None if None in parts else all(parts), value))
    return Finding(
        "S9",
        "Figs 10 and 11",
        "With e = 0.5 there are fewer impacts than with 0.9, each takes more energy, and together "
        "they take more.",
        views,
        f"Values: number and mean loss in M x₀² ωn² at e = 0.5 / 0.9. |x| stays below 5 % from "
        f"{shown(times[0], 0)}/ωn and {shown(times[1], 0)}/ωn on.",
    )
